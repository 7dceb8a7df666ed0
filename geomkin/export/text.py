"""A line of text in a drawing."""

from __future__ import annotations

from dataclasses import dataclass
from unicodedata import east_asian_width

from ..brief import one_line

# Width of a letter in the height of capitals: that of the widest fonts of programs for drawings, and of letters as wide
# as a line is high, as in Chinese. Less, and texts meet.
WIDE, WIDEST = 1.0, 1.5


@dataclass(frozen=True, eq=False)
class Text:
    """A line of text; place: its middle, or its left end at half its height where it starts there, mm.

    height: of its capitals, mm.
    """

    layer: str
    text: str
    place: complex
    height: float
    starts: bool = False

    __repr__ = one_line

    @property
    def box(self) -> tuple[complex, complex]:
        """Lower left and upper right corner of the room that it takes at most, mm."""
        half = complex(width_of(self.text, self.height), self.height) / 2
        middle = self.place + half.real if self.starts else self.place
        return middle - half, middle + half


def width_of(words: str, height: float) -> float:
    """Room that a text takes at most, mm."""
    return height * sum(WIDEST if east_asian_width(letter) in "WF" else WIDE for letter in words)
