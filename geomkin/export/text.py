"""Texts of drawings and pages: entries of a title block, numbers with units, and HTML."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterator
from dataclasses import fields
from html import escape
from unicodedata import east_asian_width

import numpy as np

from ..core.errors import DesignError, harmless, shown
from ..core.fields import entry
from ..core.names import is_letter
from ..core.records import record

# Significant digits of a number in a text.
DIGITS = 4
# Most letters of an entry; more make the title wider than most parts.
LONGEST = 60
# Characters of the fonts of CAD programs, besides letters, digits and ASCII.
SIGNS = "°±µ²³Øøß§"
# Characters that CAD programs read as the start of a code.
CODES = "\\^"


@record(checked=True)
class Title:
    """Entries of the title block of a drawing; omitted entries are not drawn.

    Parameters
    ----------
    name : str
        Subject of the drawing; the recipe's name by default.
    number, revision : str
        Number and revision of the drawing.
    material : str
        Material of the parts.
    general_tolerance : str
        Tolerance of sizes without their own; of gears, their accuracy class.
    drawn_by : str
        Name of the draughtsman.
    date : str
        Date of the drawing, as any text.

    Raises
    ------
    DesignError
        If an entry has more than 60 letters, or characters that the fonts of CAD programs lack.
    """

    name: str = entry("subject of the drawing; the recipe's name if left out", default="")
    number: str = entry("the drawing's number", default="")
    revision: str = entry("the drawing's revision", default="")
    material: str = entry("material of the parts", default="")
    general_tolerance: str = entry("tolerance of sizes without their own; of gears, their accuracy class", default="")
    drawn_by: str = entry("name of the draughtsman", default="")
    date: str = entry("date of the drawing, as any text", default="")

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if flaw := _flaw(value):
                allowed = f"give at most {LONGEST} letters of any script, digits and signs, {SIGNS} too"
                raise DesignError(field.name, f"found {shown(value)}, which {flaw}", allowed, "out-of-range")

    def lines(self) -> Iterator[str]:
        """The entries besides the name, each with its label."""
        for field in fields(self)[1:]:
            if value := getattr(self, field.name):
                yield f"{field.name.replace('_', ' ')}: {value}"


def _flaw(text: str) -> str:
    """The reason why a text is not allowed in a drawing; empty if it is."""
    if len(text) > LONGEST:
        return f"has {len(text)} letters"
    if text != text.strip():
        return "begins or ends with a space"
    previous = ""
    for sign in unicodedata.normalize("NFC", text):
        plain = sign.isascii() and sign.isprintable() and sign not in CODES
        if not (plain or sign in SIGNS or is_letter(sign, previous)):
            return f"has the sign {shown(sign)}"
        previous = sign
    return "has two signs of per cent in a row" if "%%" in text else ""


# Width of a letter over the height of capitals: for the widest fonts of CAD programs, and for letters as wide as a
# line is high, as in Chinese. Smaller values let texts overlap.
WIDE, WIDEST = 1.0, 1.5


@record(eq=False)
class Text:
    """A line of text, with its height of capitals, mm.

    `place` is its middle, mm, or the middle of its left end if `starts`, of its right end if `ends`. A `turned` one is
    read from the right.
    """

    layer: str
    text: str
    place: complex
    height: float
    starts: bool = False
    ends: bool = False
    turned: bool = False

    @property
    def box(self) -> tuple[complex, complex]:
        """Lower left and upper right corner of the largest extent of the text, mm."""
        half = complex(width_of(self.text, self.height), self.height) / 2
        along = 1j if self.turned else 1
        middle = self.place + along * half.real * (self.starts - self.ends)
        half = complex(half.imag, half.real) if self.turned else half
        return middle - half, middle + half


def width_of(words: str, height: float) -> float:
    """Largest width of a text, mm."""
    return height * sum(WIDEST if east_asian_width(letter) in "WF" else WIDE for letter in words)


def text(raw: str) -> str:
    """A text of a recipe as HTML without markup or effect on its surroundings."""
    return escape(harmless(raw))


def number(value: float, digits: int = DIGITS) -> str:
    """A number with so many significant digits for readers: in full below ten million, in groups of three."""
    if not np.isfinite(value):
        return "none" if np.isnan(value) else "infinite"
    decimals = max(0, digits - len(f"{abs(value):.0f}"))
    plain = f"{value:,.{decimals}f}" if 1e4 <= abs(value) < 1e7 else f"{value:.{digits}g}"
    return "0" if plain == "-0" else plain.replace("-", "\N{MINUS SIGN}")


def with_unit(value: float, unit: str, digits: int = 4) -> str:
    """A value with its unit for readers."""
    sign = unit_sign(unit)
    return f"{number(float(value), digits)}{'' if sign in ('', '°') else ' '}{sign}"


def unit_sign(unit: str) -> str:
    """A unit, or a text with units, with the signs that print has for degrees and squares."""
    signs = {"2": "²", "3": "³"}
    return re.sub(r"(?<=[a-z])[23]\b", lambda power: signs[power[0]], re.sub(r"\bdeg\b", "°", unit))


def capital(words: str) -> str:
    """Text with a capital first letter and spaces for underscores."""
    words = words.replace("_", " ")
    return words[:1].upper() + words[1:]
