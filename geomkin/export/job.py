"""What writers are given: what is to be written, and its parts as the loops that a machine follows."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import field
from functools import cached_property
from typing import Protocol

from ..core.errors import DesignError
from ..core.records import record
from ..model.check import Check
from ..model.part import Bought, Part
from ..model.scene import Scene
from ..model.table import Table
from .cut import Cut, cut
from .layout import Sheet, lay_out, lay_out_on
from .mesh import solid_cut
from .text import Title


class Source(Protocol):
    """What can be written, such as a recipe; each is worked out when a writer first asks for it."""

    @property
    def parts(self) -> tuple[Part, ...]: ...

    @property
    def table(self) -> Table | None: ...

    @property
    def scene(self) -> Scene | None: ...

    @property
    def checks(self) -> tuple[Check, ...]: ...

    @property
    def walls(self) -> Mapping[str, float]: ...

    @property
    def notes(self) -> Mapping[str, object]: ...

    @property
    def bought(self) -> tuple[Bought, ...]: ...

    @property
    def steps(self) -> tuple[str, ...]: ...


@record(eq=False)
class StaticSource:
    """What comes of no recipe."""

    parts: tuple[Part, ...] = ()
    table: Table | None = None
    scene: Scene | None = None
    checks: tuple[Check, ...] = ()
    walls: Mapping[str, float] = field(default_factory=dict)
    notes: Mapping[str, object] = field(default_factory=dict)
    bought: tuple[Bought, ...] = ()
    steps: tuple[str, ...] = ()


@record(eq=False)
class Job:
    """Files to be written, worked out no further than writers ask.

    name: of what all parts share one file for. tolerance, kerf: mm, as `cut` has them; arcs: instead of chords. labels:
    drawings engrave parts with their names. laser: SVG as laser cutters' programs take it. about: one line that
    introduces it; recipe: gives the text that it is made from; "" where there is none. assembly_at: where the driver
    stands in stills, in its own unit; None for anywhere. sheet: width and height of the sheets that parts are cut from,
    mm; None for one as large as they take. title: of the drawing with sizes, as far as it is given. What a writer asks
    for and the source has not is a DesignError of `write`.
    """

    name: str
    source: Source
    tolerance: float
    kerf: float = 0.0
    arcs: bool = False
    labels: bool = False
    laser: bool = False
    about: str = ""
    recipe: Callable[[], str] = str
    assembly_at: float | None = None
    sheet: tuple[float, float] | None = None
    title: Title = field(default_factory=Title)

    @property
    def table(self) -> Table:
        """What the mechanism does."""
        if (table := self.source.table) is None:
            raise _lacking("table")
        return table

    @property
    def scene(self) -> Scene:
        """How it looks moving."""
        if (scene := self.source.scene) is None:
            raise _lacking("scene")
        return scene

    @cached_property
    def flats(self) -> Sequence[Cut]:
        """The parts as a beam must go, half a kerf off them."""
        return [
            cut(part, self.tolerance, self.kerf, self.arcs, number if self.labels else 0)
            for number, part in enumerate(self._parts, 1)
        ]

    @cached_property
    def solids(self) -> Sequence[Cut]:
        """The parts as they are to be."""
        if self.kerf == 0 and not any(part.twist for part in self._parts):
            return self.flats
        return [solid_cut(part, self.tolerance) for part in self._parts]

    @cached_property
    def exact(self) -> Sequence[Cut]:
        """The parts as they are to be, with arcs."""
        return [cut(part, self.tolerance, arcs=True) for part in self._parts]

    @cached_property
    def sheets(self) -> tuple[Sheet, ...]:
        """The parts, laid out flat."""
        return lay_out_on(self.flats, *self.sheet) if self.sheet else (lay_out(self.flats),)

    def sheet_files(self, ending: str, write: Callable[[Sheet], bytes]) -> dict[str, bytes]:
        """A file for each sheet, by its name; from the second on, with its number."""
        names = [self.name, *(f"{self.name}-{number}" for number in range(2, len(self.sheets) + 1))]
        return {f"{name}.{ending}": write(sheet) for name, sheet in zip(names, self.sheets)}

    @property
    def _parts(self) -> tuple[Part, ...]:
        if not self.source.parts:
            raise _lacking("part")
        return self.source.parts


def _lacking(what: str) -> DesignError:
    return DesignError("write", f"a format that is made of a {what} is asked for, and there is none", "leave it out")
