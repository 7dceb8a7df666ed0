"""The stamp of a file, which identifies its recipe and tolerance."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from hashlib import sha256

from ..core.records import record
from .summary import as_json

# Raised when the meaning of a stamp changes.
LAYOUT = 1
# Hexadecimal digits of the hash: as many as the header of an STL file has room for.
DIGITS = 32
TEXT = re.compile(rf"geomkin (\d{{1,6}}) recipe ([0-9a-f]{{{DIGITS}}}) tolerance (\S{{1,24}}) mm")


def recipe_hash(data: Mapping[str, object]) -> str:
    """SHA-256 of a recipe's data, as summary.json holds it; the same whatever the order of its keys."""
    return sha256(json.dumps(as_json(data), sort_keys=True, ensure_ascii=True).encode()).hexdigest()


@record
class Stamp:
    """A stamp as files carry it: number of its layout, start of the recipe's hash, and tolerance, mm."""

    recipe: str
    tolerance: float
    layout: int = LAYOUT

    def __str__(self) -> str:
        return f"geomkin {self.layout} recipe {self.recipe[:DIGITS]} tolerance {self.tolerance!r} mm"

    @classmethod
    def read(cls, text: str) -> Stamp | None:
        """The stamp in a text; None if there is none."""
        found = TEXT.search(text[:1000])
        if not found:
            return None
        try:
            return cls(found.group(2), float(found.group(3)), int(found.group(1)))
        except ValueError:
            return None
