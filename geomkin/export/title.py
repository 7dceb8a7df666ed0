"""What a drawing office writes into the title of a drawing, besides what the drawing itself tells."""

from __future__ import annotations

import unicodedata
from collections.abc import Iterator
from dataclasses import dataclass, fields

from ..brief import one_line
from ..errors import DesignError, shown
from ..names import is_letter
from ..sizes import check_sizes, entry

# Letters of an entry: more make the title wider than most parts.
LONGEST = 60
# Signs besides letters, digits and those of ASCII that the fonts of programs for drawings have.
SIGNS = "°±µ²³Øøß§"
# What such programs read as the beginning of a code.
CODES = "\\^"


@dataclass(frozen=True)
class Title:
    """Entries of the title of the drawing with sizes; what is left out is not in it."""

    name: str = entry("what the drawing is of; left out, the recipe's name", default="")
    number: str = entry("the drawing's number", default="")
    revision: str = entry("the drawing's revision", default="")
    material: str = entry("what the parts are cut from", default="")
    general_tolerance: str = entry("tolerance of sizes that have none of their own", default="")
    drawn_by: str = entry("who drew it", default="")
    date: str = entry("when it was drawn, as it is to stand there", default="")

    __repr__ = one_line

    def __post_init__(self) -> None:
        check_sizes(self)
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
