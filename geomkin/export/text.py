"""What a drawing office writes into the title of a drawing, besides what the drawing itself tells."""

from __future__ import annotations

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
# Letters of an entry: more make the title wider than most parts.
LONGEST = 60
# Signs besides letters, digits and those of ASCII that the fonts of programs for drawings have.
SIGNS = "°±µ²³Øøß§"
# What such programs read as the beginning of a code.
CODES = "\\^"


@record(checked=True)
class Title:
    """Entries of the title of the drawing with sizes; what is left out is not in it."""

    name: str = entry("what the drawing is of; left out, the recipe's name", default="")
    number: str = entry("the drawing's number", default="")
    revision: str = entry("the drawing's revision", default="")
    material: str = entry("what the parts are cut from", default="")
    general_tolerance: str = entry("tolerance of sizes that have none of their own", default="")
    drawn_by: str = entry("who drew it", default="")
    date: str = entry("when it was drawn, as it is to stand there", default="")

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if flaw := _flaw(value):
                allowed = f"give at most {LONGEST} letters of any script, digits and signs, {SIGNS} too"
                raise DesignError(field.name, f"found {shown(value)}, which {flaw}", allowed)

    def told(self) -> Iterator[str]:
        """What is given besides the name, each with what it is."""
        for field in fields(self)[1:]:
            if value := getattr(self, field.name):
                yield f"{field.name.replace('_', ' ')}: {value}"


def _flaw(text: str) -> str:
    """Why a text cannot stand in a drawing; empty where it can."""
    if len(text) > LONGEST:
        return f"has {len(text)} letters"
    if text != text.strip():
        return "begins or ends with a space"
    before = ""
    for sign in unicodedata.normalize("NFC", text):
        plain = sign.isascii() and sign.isprintable() and sign not in CODES
        if not (plain or sign in SIGNS or is_letter(sign, before)):
            return f"has the sign {shown(sign)}"
        before = sign
    return "has two signs of per cent in a row" if "%%" in text else ""


# Width of a letter in the height of capitals: that of the widest fonts of programs for drawings, and of letters as wide
# as a line is high, as in Chinese. Less, and texts meet.
WIDE, WIDEST = 1.0, 1.5


@record(eq=False)
class Text:
    """A line of text; place: its middle, or its left end at half its height where it starts there, mm.

    height: of its capitals, mm.
    """

    layer: str
    text: str
    place: complex
    height: float
    starts: bool = False

    @property
    def box(self) -> tuple[complex, complex]:
        """Lower left and upper right corner of the room that it takes at most, mm."""
        half = complex(width_of(self.text, self.height), self.height) / 2
        middle = self.place + half.real if self.starts else self.place
        return middle - half, middle + half


def width_of(words: str, height: float) -> float:
    """Room that a text takes at most, mm."""
    return height * sum(WIDEST if east_asian_width(letter) in "WF" else WIDE for letter in words)


def text(raw: str) -> str:
    """A text of a recipe as HTML: nothing in it is markup, and nothing turns what stands beside it."""
    return escape(harmless(raw))


def number(value: float, digits: int = DIGITS) -> str:
    """To so many digits, as a reader takes it in: in full up to ten millions, in groups of three."""
    if not np.isfinite(value):
        return "none" if np.isnan(value) else "infinite"
    decimals = max(0, digits - len(f"{abs(value):.0f}"))
    plain = f"{value:,.{decimals}f}" if 1e4 <= abs(value) < 1e7 else f"{value:.{digits}g}"
    return "0" if plain == "-0" else plain.replace("-", "\N{MINUS SIGN}")


def with_unit(value: float, unit: str, digits: int = 4) -> str:
    """A value with its unit, as a reader takes it in."""
    sign = _unit(unit)
    return f"{number(float(value), digits)}{'' if sign in ('', '°') else ' '}{sign}"


def _unit(unit: str) -> str:
    return unit.replace("deg", "°").replace("2", "²")


def capital(words: str) -> str:
    """Words as a heading begins; a name's words apart."""
    words = words.replace("_", " ")
    return words[:1].upper() + words[1:]
