"""A mechanism as it looks moving: the parts that are cut, where they are at each frame, and what is drawn with them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import field, fields, replace
from typing import Any, Literal, TypeVar

import numpy as np

from ..core.errors import DesignError
from ..core.records import record
from ..plane.curve import AbstractCurve
from ..plane.primitives import Segment
from ..plane.vec import Array, Complex, Mask, Real, Whole, as_unit
from .part import Part
from .roles import Role
from .table import Column, Table


@record(checked=True, eq=False)
class SceneBody:
    """A body: its parts, which are also those that are cut, and its pose at each frame of the scene.

    Parameters
    ----------
    name : str
        Name of the body.
    parts : tuple of Part
        Parts in the body's frame, the lowest first; may be empty.
    origin : array of complex, shape (frames,)
        Position of the body's origin, mm; nan if the mechanism cannot be assembled.
    direction : array of complex, shape (frames,)
        Direction of the body's x axis; stored as unit numbers.
    layer : int
        Layer of the stack, 0 the lowest; higher layers are drawn over lower ones.
    fixed : bool
        Whether it is the ground, which is hatched.
    named : bool
        Whether drawings show its name.
    """

    name: str
    parts: tuple[Part, ...]
    origin: Complex
    direction: Complex
    layer: int = 0
    fixed: bool = False
    named: bool = True

    def __post_init__(self) -> None:
        object.__setattr__(self, "direction", as_unit(self.direction))


@record(checked=True, eq=False)
class SceneCurve:
    """A curve drawn on a body, in that body's frame, mm; on the ground's x and y where `body` is ""."""

    curve: AbstractCurve
    role: Role
    label: str = ""
    body: str = ""


@record(checked=True, eq=False)
class SceneRegion:
    """An area of the ground that is shaded: what lies within an odd number of closed curves, mm."""

    curves: tuple[AbstractCurve, ...]
    role: Role
    label: str = ""


@record(checked=True, eq=False)
class SceneMark:
    """A point that is drawn at each frame.

    sort: "pin" and "fixed pin" are small circles, "slide" a block along `direction`, "point" a dot; a point leaves a
    trail of where it was, in dashes of equal steps of the drive, when `trail` is true. "vector" is an arrow from
    `place` to `place + vector`, in mm that show what `label` says; "line" one without a head, "circle" one of radius
    `radius` about `place`. place, vector: (frames,) complex, mm; direction: (frames,) of any length; radius: (frames,)
    mm; nan where there is none.
    """

    sort: Literal["pin", "fixed pin", "slide", "point", "vector", "line", "circle"]
    place: Complex
    role: Role = "construction"
    label: str = ""
    trail: bool = False
    vector: Complex | None = None
    direction: Complex | None = None
    radius: Real | None = None

    def __post_init__(self) -> None:
        if self.direction is not None:
            object.__setattr__(self, "direction", as_unit(self.direction))


# What has arrays of a value for each frame, (frames,).
Moving = TypeVar("Moving", Column, SceneBody, SceneMark)


@record(checked=True, eq=False)
class SceneHandle:
    """A point that an editor lets a user drag, and the keys of the recipe that are changed so that it follows.

    Parameters
    ----------
    id : str
        Unique among the handles of a recipe, such as `point:crank_pin`.
    label : str
        For people.
    keys : tuple of str
        Keys of fields that a drag may change.
    at : complex array, shape (frames,) or (1,)
        Positions at the frames of the recipe's scene, mm; a single one if it stays. nan if the mechanism cannot be
        there. For a circle the centre; for a plot x and y in the units of the plot.
    shape : {"point", "circle", "plot"}
        The point follows the pointer; the circle goes through the pointer; a point of a plot follows the pointer.
    radius : float
        Radius of the circle, mm.
    column : str
        Id of the column whose plot has the handle.
    is_one_value : bool
        Whether all keys have one value, as the modules of gears in mesh do.
    """

    id: str
    label: str
    keys: tuple[str, ...]
    at: Complex
    shape: Literal["point", "circle", "plot"] = "point"
    radius: float = 0.0
    column: str = ""
    is_one_value: bool = False


@record
class Limit:
    """A line across the plot of a column, such as the limit of a check. column: its id."""

    column: str
    value: float
    label: str


@record
class Plot:
    """Columns of the scene's table that are drawn in one plot, by their ids; all of one unit.

    bars: whether the values of the frame shown, and the largest ones, are drawn as bars too; they are 0 or more.
    """

    title: str
    columns: tuple[str, ...]
    limits: tuple[Limit, ...] = ()
    bars: bool = False

    def with_limits(self, limits: Iterable[Limit]) -> Plot:
        """A copy with those limits that belong to its columns, column by column."""
        limits = tuple(limits)
        return replace(self, limits=tuple(line for id in self.columns for line in limits if line.column == id))


@record(checked=True, eq=False)
class Choice:
    """A table of solutions, the row that was chosen, and plots. The first column of the table rises."""

    table: Table
    chosen: int
    plots: tuple[Plot, ...]

    def __post_init__(self) -> None:
        _check_plots(self.plots, self.table)
        rows = len(self.table.columns[0].values)
        if not 0 <= self.chosen < rows:
            raise DesignError("chosen", f"found {self.chosen} of {rows} rows", f"give 0 to {rows - 1}", "out-of-range")


def _check_plots(plots: tuple[Plot, ...], table: Table) -> None:
    for plot in plots:
        for id in (*plot.columns, *(limit.column for limit in plot.limits)):
            if id not in table.ids:
                raise DesignError("plots", f"{plot.title} names {id}, which is no column", "give an id", "unknown-key")


@record(checked=True, eq=False)
class Candidate:
    """A design among which a recipe chooses, as a small picture.

    Parameters
    ----------
    key, value : str and int
        What the recipe states to choose it, such as `choose` and 2.
    label : str
        For people.
    lines : tuple of complex arrays
        Strokes of the picture, mm.
    """

    key: str
    value: int
    label: str
    lines: tuple[Complex, ...]


@record(checked=True, eq=False)
class Scene:
    """The moving drawing of a mechanism.

    Parameters
    ----------
    table : Table
        Columns of the plots, a row for each frame; the first column is the driver.
    time : array, shape (frames,)
        Time at the recipe's speed, s.
    assembled : array of bool, shape (frames,)
        Whether the mechanism can be assembled at each frame.
    bodies, curves, marks
        The drawn elements.
    plots : tuple of Plot
        Plots, the most important first.
    cyclic : bool
        Whether the last frame equals the first, so that playing continues.
    others : mapping of str to Scene
        Variants on the same drive, by name, such as the other assembly mode; shown next to it.
    regions : tuple of SceneRegion
        Shaded areas.
    choice : Choice, optional
        The solutions from which the mechanism was chosen.
    """

    table: Table
    time: Real
    assembled: Mask
    bodies: tuple[SceneBody, ...]
    curves: tuple[SceneCurve, ...] = ()
    marks: tuple[SceneMark, ...] = ()
    plots: tuple[Plot, ...] = ()
    cyclic: bool = True
    others: dict[str, Scene] = field(default_factory=dict)
    regions: tuple[SceneRegion, ...] = ()
    choice: Choice | None = None

    def __post_init__(self) -> None:
        frames = len(self.drive.values)
        rows: list[tuple[str, Array]] = [
            (f"time and {name}", row) for name, row in (("drive", self.time), ("closed", self.assembled))
        ]
        rows += [(f"the other {label}", other.time) for label, other in self.others.items()]
        rows += [(f"body {b.name}", row) for b in self.bodies for row in (b.origin, b.direction)]
        rows += [
            (f"mark {m.label or m.sort}", row)
            for m in self.marks
            for row in (m.place, m.vector, m.direction, m.radius)
            if row is not None
        ]
        for what, row in rows:
            if len(row) != frames:
                problem = f"found {frames} rows, but {len(row)} frames of {what}"
                raise DesignError("table", problem, "give as many of each", "conflict")
        _check_plots(self.plots, self.table)

    def at_frames(self, frames: Whole) -> Scene:
        """The scene at some of its frames, in any order and as often as given; without variants and choice."""

        def taken(thing: Moving) -> Moving:
            values = {f.name: getattr(thing, f.name) for f in fields(thing)}
            rows: dict[str, Any] = {n: v[frames] for n, v in values.items() if isinstance(v, np.ndarray)}
            return replace(thing, **rows)

        return replace(
            self,
            table=Table(tuple(map(taken, self.table.columns))),
            time=self.time[frames],
            assembled=self.assembled[frames],
            bodies=tuple(map(taken, self.bodies)),
            marks=tuple(map(taken, self.marks)),
            others={},
            choice=None,
        )

    @property
    def drive(self) -> Column:
        """The driver: the first column of the table."""
        return self.table.columns[0]

    @property
    def box(self) -> tuple[complex, complex]:
        """Lower left and upper right corner, mm, of where all pins, slides, traced points and bodies' origins go."""
        kept = [mark for mark in self.marks if mark.sort in ("pin", "fixed pin", "slide") or mark.trail]
        rows = [mark.place for mark in kept] + [body.origin for body in self.bodies]
        places = np.concatenate([*rows, np.zeros(1, dtype=complex)])
        places = places[np.isfinite(places)]
        return (
            complex(places.real.min(), places.imag.min()),
            complex(places.real.max(), places.imag.max()),
        )


def dimension(start: complex, end: complex, words: str, body: str = "") -> SceneCurve:
    """A length on a body, mm in its frame; words: the number as it stands in the drawing, then what it is."""
    return SceneCurve(Segment(start, end), "dimension", words, body)


def mm(length: float) -> str:
    """A length with its unit, to five digits."""
    return f"{length:.5g} mm"


def shown_columns(scene: Scene) -> list[Column]:
    """The columns of the table that hold numbers."""
    return [column for column in scene.table.columns if np.asarray(column.values).dtype.kind in "fiub"]
