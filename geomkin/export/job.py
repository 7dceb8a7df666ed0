"""What writers are given: a thing's parts and table, and its parts as the loops that a machine follows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

from ..part import Part
from ..table import Table
from .cut import Cut, cut
from .layout import Sheet, lay_out


class Source(Protocol):
    """What can be written, such as a recipe; each is worked out when a writer first asks for it."""

    @property
    def table(self) -> Table: ...

    @property
    def parts(self) -> tuple[Part, ...]: ...

    @property
    def scene(self) -> object | None: ...


@dataclass(frozen=True, eq=False)
class Job:
    """Files to be written, worked out no further than writers ask.

    name: of what all parts share one file for. tolerance, kerf: mm, as `cut` has them; arcs: instead of chords.
    """

    name: str
    source: Source
    tolerance: float
    kerf: float = 0.0
    arcs: bool = False

    @cached_property
    def flats(self) -> Sequence[Cut]:
        """The parts as a beam must go, half a kerf off them."""
        return [cut(part, self.tolerance, self.kerf, self.arcs) for part in self.source.parts]

    @cached_property
    def solids(self) -> Sequence[Cut]:
        """The parts as they are to be."""
        return self.flats if self.kerf == 0 else [cut(part, self.tolerance) for part in self.source.parts]

    @cached_property
    def sheet(self) -> Sheet:
        """The parts, laid out flat."""
        return lay_out(self.flats)
