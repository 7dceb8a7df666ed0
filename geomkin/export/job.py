"""The input of writers: the data to write, and its parts as the loops that a machine follows."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import field, replace
from functools import cached_property
from typing import Literal, Protocol

from ..core.errors import DesignError, shown
from ..core.records import record
from ..core.units import MM, LengthUnit, mm
from ..model.check import Check, WorkedFormula
from ..model.machinability import relieved
from ..model.part import Bought, Part
from ..model.scene import Scene
from ..model.table import Table
from .cut import Cut, LayerStyles, cut
from .layout import Sheet, check_tabs, lay_out, lay_out_on
from .mesh import is_solid_cut, solid_cut
from .text import Title


class Source(Protocol):
    """Data that can be written, such as a recipe; each property is computed when a writer first reads it."""

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

    @property
    def formulas(self) -> tuple[WorkedFormula, ...]: ...


@record(eq=False)
class StaticSource:
    """Given data that does not come from a recipe."""

    parts: tuple[Part, ...] = ()
    table: Table | None = None
    scene: Scene | None = None
    checks: tuple[Check, ...] = ()
    walls: Mapping[str, float] = field(default_factory=dict)
    notes: Mapping[str, object] = field(default_factory=dict)
    bought: tuple[Bought, ...] = ()
    steps: tuple[str, ...] = ()
    formulas: tuple[WorkedFormula, ...] = ()


@record(eq=False)
class Job:
    """The files to be written; each property is computed when a writer first reads it.

    A writer that needs data that the source does not have raises DesignError for the field `write`.

    Parameters
    ----------
    name : str
        Name of files that all parts share.
    source : Source
        The data to write.
    tolerance, kerf : float
        As for `cut`, mm.
    arcs : bool
        Whether drawings use arcs instead of chords.
    labels : bool
        Whether drawings engrave parts with their names.
    laser : bool
        Whether SVG is written for laser cutting programs.
    about : str
        One line that introduces the mechanism; may be empty.
    recipe : callable
        Returns the TOML text of the recipe; empty if there is none.
    assembly_at : float, optional
        Driver position in still pictures, in the driver's unit; by default any.
    sheet : tuple of float, optional
        Width and height of the sheets to cut from, mm; by default one sheet is sized to fit the parts.
    title : Title
        Entries of the title block of the dimensioned drawing.
    stamp : str
        States the recipe and the tolerance in files that have a place for it; empty if there is no recipe.
    unit : LengthUnit
        Unit of the lengths in files; that of the table, the checks and the texts of the source.
    cutter : float
        Diameter of the cutter for which drawings relieve the corners of bores, mm; 0 for none.
    tab_width : float
        Width of the tabs that hold parts in their sheet, mm; 0 for none.
    dxf_version : {"R2000", "R12"}
        Version of the drawings to cut.
    layers : LayerStyles
        Names and colours of their layers.
    growth, foot : float
        Growth of prints, and chamfer of their lower edges, mm.
    in_place : bool
        Whether the assembly is printed in one piece.
    certificate : tuple of tuple of str
        Rows of the results of verifying the files, for the report; empty before they are verified.
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
    stamp: str = ""
    unit: LengthUnit = MM
    cutter: float = 0.0
    tab_width: float = 0.0
    dxf_version: Literal["R2000", "R12"] = "R2000"
    layers: LayerStyles = field(default_factory=LayerStyles)
    growth: float = 0.0
    foot: float = 0.0
    in_place: bool = False
    certificate: tuple[tuple[str, ...], ...] = ()

    @property
    def table(self) -> Table:
        """The table of the motion."""
        if (table := self.source.table) is None:
            raise lacking("table")
        return table

    @property
    def scene(self) -> Scene:
        """The moving picture."""
        if (scene := self.source.scene) is None:
            raise lacking("scene")
        return scene

    @cached_property
    def notes(self) -> Mapping[str, object]:
        """Further entries of the summary."""
        return self.source.notes

    @cached_property
    def flats(self) -> Sequence[Cut]:
        """The parts along the path of the beam, half a kerf off them, with relief for the cutter."""
        cuts = [
            cut(relieved(part, self.cutter), self.tolerance, self.kerf, self.arcs, number if self.labels else 0)
            for number, part in enumerate(self._parts, 1)
        ]
        # A beam or cutter takes half its width off both ends of a tab.
        return [replace(one, tab=self.tab_width + self._cut_width) for one in cuts] if self.tab_width else cuts

    @property
    def _cut_width(self) -> float:
        return max(self.kerf, self.cutter)

    @cached_property
    def solids(self) -> Sequence[Cut]:
        """The parts at their true size."""
        flats = self.flats if self.kerf == 0 and self.cutter == 0 else [None] * len(self._parts)
        return [
            flat if flat and is_solid_cut(flat) else solid_cut(part, self.tolerance)
            for part, flat in zip(self._parts, flats)
        ]

    @cached_property
    def printed(self) -> Sequence[Cut]:
        """The parts as they are printed: less their growth, and with chamfers of the lower edges."""
        if not self.growth and not self.foot:
            return self.solids
        return [self.printed_cut(part) for part in self._parts]

    def printed_cut(self, part: Part) -> Cut:
        """A part as it is printed. DesignError for a growth or chamfer that it cannot have."""
        if self.foot and (part.twist is not None or self.foot >= part.thickness):
            what = "with helical teeth" if part.twist else f"{mm(part.thickness):g} thick"
            problem = f"found {mm(self.foot):g}, but the {part.name} is a part {what}"
            raise DesignError("printing.foot", problem, "give 0, or a smaller one", "conflict")
        try:
            return replace(solid_cut(part, self.tolerance, self.growth), foot=self.foot)
        except DesignError as error:
            if error.field != "kerf":
                raise
            problem = f"found {mm(self.growth):g}, wider than a gap or a neck of the {part.name}"
            raise DesignError("printing.growth", problem, "give a smaller one, or larger parts", "conflict") from None

    @cached_property
    def exact(self) -> Sequence[Cut]:
        """The parts at their true size, with arcs."""
        return [cut(part, self.tolerance, arcs=True) for part in self._parts]

    @cached_property
    def sheets(self) -> tuple[Sheet, ...]:
        """The parts laid out on sheets."""
        if self.tab_width:
            check_tabs(self.flats, self.tab_width, self._cut_width)
        return lay_out_on(self.flats, *self.sheet) if self.sheet else (lay_out(self.flats),)

    def sheet_files(
        self, ending: str, write: Callable[[Sheet], bytes], sheets: Sequence[Sheet] | None = None
    ) -> dict[str, bytes]:
        """One file per sheet, by name; names from the second sheet on have its number."""
        sheets = self.sheets if sheets is None else sheets
        names = [self.name, *(f"{self.name}-{number}" for number in range(2, len(sheets) + 1))]
        return {f"{name}.{ending}": write(sheet) for name, sheet in zip(names, sheets)}

    def part_files(self, ending: str, cuts: Sequence[Cut], write: Callable[[Cut], bytes]) -> dict[str, bytes]:
        """One file for each part, by name. Raises DesignError if two parts have the same name."""
        contents: dict[str, bytes] = {}
        for cut_part in cuts:
            name = f"{cut_part.part.name}.{ending}"
            if name in contents:
                problem = f"two parts are named {shown(cut_part.part.name)}"
                raise DesignError("name", problem, "give each a name of its own", "conflict")
            contents[name] = write(cut_part)
        return contents

    @property
    def _parts(self) -> tuple[Part, ...]:
        if not self.source.parts:
            raise lacking("part")
        return self.source.parts


def lacking(data: str) -> DesignError:
    """The error for a format that needs data which the source does not have."""
    return DesignError("write", f"names a format that needs a {data}, and there is none", "omit it", "conflict")
