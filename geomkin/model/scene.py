"""The moving drawing of a mechanism: bodies, their parts and poses at each frame, curves, marks, plots and handles."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import field, fields, replace
from typing import Any, Literal, NamedTuple, TypeVar

import numpy as np

from ..core.errors import DesignError
from ..core.fields import to_digits
from ..core.records import record
from ..core.units import as_sentences, bare_mm, converted_power, unit_name
from ..plane.curve import AbstractCurve
from ..plane.primitives import Segment
from ..plane.vec import Array, Complex, Mask, Real, Whole, as_unit, box_of
from .part import Part
from .table import Column, Table

Role = Literal[
    "dimension",  # segments along a length; the label is its size
    "traced",  # paths of points, and curves for which a part is made; in the first accent colour
    "wanted",  # requirements of a synthesis; in the second accent colour
    "construction",  # thin auxiliary lines: centre lines, image poles
    "pitch",  # pitch curve of a cam, pitch circles of gears
    "driven",  # region without usable driven pins of a guided body
    "driving",  # region without usable driving pins
    "deviation",  # band of possible paths, by tolerances and clearances
    "contact",  # contacts of bodies and the path of contact
    "centrode",
    "inflection",
    "bobillier",  # Bobillier's construction
    "centre",  # instant centres
    "velocity",
    "acceleration",
    "force",
]


class RoleStyle(NamedTuple):
    """How a drawing treats a role.

    label: text of its switch. shown: whether it is visible at first and in still pictures. room: largest margin that a
    drawing adds on each side for it, as a share of the mechanism's size; 0 if the drawing always contains all of it.
    """

    label: str
    shown: bool = True
    room: float = 0.0


# `room` of roles whose elements may extend far beyond the mechanism: of those that are the subject of a recipe, and of
# the others.
WIDE, NARROW = 0.5, 0.25

# In the order of the switches.
ROLES: Mapping[Role, RoleStyle] = {
    "dimension": RoleStyle("dimensions", False, NARROW),
    "traced": RoleStyle("traced path"),
    "wanted": RoleStyle("wanted"),
    "construction": RoleStyle("construction"),
    "pitch": RoleStyle("pitch curves"),
    "driven": RoleStyle("no driven pin here", True, NARROW),
    "driving": RoleStyle("no driving pin here", True, NARROW),
    "deviation": RoleStyle("deviation"),
    "contact": RoleStyle("contact"),
    "centrode": RoleStyle("centrodes", True, WIDE),
    "inflection": RoleStyle("inflection circle", True, WIDE),
    "bobillier": RoleStyle("Bobillier construction", False, NARROW),
    "centre": RoleStyle("instant centres", False, NARROW),
    "velocity": RoleStyle("velocities", False, NARROW),
    "acceleration": RoleStyle("accelerations", False, NARROW),
    "force": RoleStyle("forces", False, NARROW),
}


@record(checked=True, eq=False)
class SceneBody:
    """A body with its parts, the same ones that are cut, and its pose at each frame of the scene.

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
    """A curve drawn on a body, in that body's frame, mm; if `body` is "", on the ground."""

    curve: AbstractCurve
    role: Role
    label: str = ""
    body: str = ""

    def __post_init__(self) -> None:
        as_sentences(self, "label")


@record(checked=True, eq=False)
class SceneRegion:
    """A shaded area of the ground: all points inside an odd number of the closed curves, mm."""

    curves: tuple[AbstractCurve, ...]
    role: Role
    label: str = ""


@record(checked=True, eq=False)
class SceneMark:
    """A point that is drawn at each frame.

    Parameters
    ----------
    sort : {"pin", "fixed pin", "slide", "point", "vector", "line", "circle"}
        Symbol: a small circle, a block along `direction`, a dot, an arrow from `place` to `place + vector`, the same
        without a head, or a circle about `place`.
    place : array of complex, shape (frames,)
        mm; nan at frames without the mark.
    role : str
        Role in the drawing, one of `Role`.
    label : str
        Name of the mark; for a vector, the quantity that its length represents.
    trail : bool
        Whether a point leaves a trail, in dashes of equal steps of the drive.
    vector : array of complex, shape (frames,), optional
        mm.
    direction : array of complex, shape (frames,), optional
        Of any length; stored as unit numbers.
    radius : array, shape (frames,), optional
        mm.
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
        as_sentences(self, "label")
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
    arrow : complex
        Vector of the arrow that ends at the handle, mm, such as that of a force; 0 for none.
    anchor : complex array, shape of `at`, optional
        Positions of what it moves, mm, if it is beside that; an editor draws a line to it.
    """

    id: str
    label: str
    keys: tuple[str, ...]
    at: Complex
    shape: Literal["point", "circle", "plot"] = "point"
    radius: float = 0.0
    column: str = ""
    is_one_value: bool = False
    arrow: complex = 0j
    anchor: Complex | None = None


@record
class Limit:
    """A line across the plot of a column, such as the limit of a check.

    column: its id. is_end: whether larger values are not drawn, since they would flatten all others.
    """

    column: str
    value: float
    label: str
    is_end: bool = False

    def __post_init__(self) -> None:
        as_sentences(self, "label")


@record
class Plot:
    """Columns of the scene's table that are drawn in one plot, by their ids; all have the same unit.

    bars: whether bars also show each column's value at the current frame and its largest value; values are at least 0.
    """

    title: str
    columns: tuple[str, ...]
    limits: tuple[Limit, ...] = ()
    bars: bool = False

    @property
    def most(self) -> float:
        """Size of values beyond which they are not drawn."""
        return min((abs(limit.value) for limit in self.limits if limit.is_end), default=math.inf)

    def __post_init__(self) -> None:
        as_sentences(self, "title")

    def with_limits(self, limits: Iterable[Limit]) -> Plot:
        """A copy with the limits of its own columns, in the order of the columns."""
        limits = tuple(limits)
        return replace(self, limits=tuple(line for id in self.columns for line in limits if line.column == id))


@record
class Hodograph:
    """Paths of the tips of vectors drawn from one origin: a polar diagram, in the files of plots.

    columns: ids of the columns of their sizes; each id with `_x` and `_y` is a column too. All have the same unit.
    """

    title: str
    columns: tuple[str, ...]


@record(checked=True, eq=False)
class Choice:
    """A table of solutions, the row that was chosen, and plots.

    Parameters
    ----------
    table : Table
        The solutions; its first column rises.
    chosen : int
        The row that was chosen.
    plots : tuple of Plot
        Plots of the table.
    key : str
        Key of the recipe that chooses the row with its value in the first column; empty if there is none.
    instead_of : tuple of str
        Keys of the recipe that choose a row by something else: they are removed where `key` is given.
    """

    table: Table
    chosen: int
    plots: tuple[Plot, ...]
    key: str = ""
    instead_of: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        _check_plots(self.plots, self.table)
        rows = len(self.table.columns[0].values)
        if not 0 <= self.chosen < rows:
            raise DesignError("chosen", f"found {self.chosen} of {rows} rows", f"give 0 to {rows - 1}", "out-of-range")


def _check_plots(plots: tuple[Plot, ...], table: Table) -> None:
    for plot in plots:
        for id in (*plot.columns, *(limit.column for limit in plot.limits)):
            if id not in table.ids:
                problem = f"{plot.title} names {id}, which is no column"
                raise DesignError("plots", problem, "give the id of one", "unknown-key")


@record(checked=True, eq=False)
class Candidate:
    """A design among which a recipe chooses, as a small picture.

    Parameters
    ----------
    key, value : str and int
        Key of the recipe and the value that chooses this design, such as `choose` and 2.
    label : str
        For people.
    lines : tuple of complex arrays
        Strokes of the picture, mm: points, or frames of them, frame first.
    """

    key: str
    value: int
    label: str
    lines: tuple[Complex, ...]


def layer_name(layer: int) -> str:
    """Name of a layer for people, who count from 1; the plates of a motor may be below all others."""
    return f"layer {layer + 1}" if layer >= 0 else "under layer 1"


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
    hodographs : tuple of Hodograph
        Polar diagrams of vectors of the table.
    units : mapping of str to tuple of SceneBody
        Bodies of each unit that is assembled for itself, by its name; empty if the whole scene is one unit.
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
    hodographs: tuple[Hodograph, ...] = ()
    units: dict[str, tuple[SceneBody, ...]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        frames = len(self.drive.values)
        rows: list[tuple[str, Array]] = [("time", self.time), ("time and assembled", self.assembled)]
        rows += [(f"the variant {label}", other.time) for label, other in self.others.items()]
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
                raise DesignError("table", problem, "give arrays of the same length", "conflict")
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
            units={title: tuple(map(taken, bodies)) for title, bodies in self.units.items()},
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
        """Lower left and upper right corner, mm, of all pins, slides, traced points and bodies' origins."""
        marks = [mark for mark in self.marks if mark.sort in ("pin", "fixed pin", "slide") or mark.trail]
        rows = [mark.place for mark in marks] + [body.origin for body in self.bodies]
        places = np.concatenate([*rows, np.zeros(1, dtype=complex)])
        return box_of(places[np.isfinite(places)])


def playing_time(table: Table) -> Real:
    """Time of the frames of a table with a column `time`, s; if it is unknown, the scene lasts two seconds."""
    time = np.asarray(table["time"], dtype=float)
    return time if np.isfinite(time).all() else np.linspace(0, 2, len(time))


def dimension(start: complex, end: complex, words: str, body: str = "") -> SceneCurve:
    """The dimension of a length on a body, mm in its frame; words: the number as drawn, then the name of the length."""
    return SceneCurve(Segment(start, end), "dimension", words, body)


def drawn_at(scale: float, unit: str) -> str:
    """Text that states the scale of arrows, if one of the unit is drawn `scale` mm long."""
    value = bare_mm(to_digits(1 / scale, 3), power=converted_power(unit) - 1)
    return f"1 {unit_name()} is {value:.3g} {unit_name(unit)}"


def shown_columns(scene: Scene) -> list[Column]:
    """The columns of the table that hold numbers."""
    return [column for column in scene.table.columns if np.asarray(column.values).dtype.kind in "fiub"]


def plottable(plots: Iterable[Plot], table: Table) -> tuple[Plot, ...]:
    """The plots with those of their columns that the table has and that are not all nan; the driver is no column."""

    def is_known(id: str) -> bool:
        return id in table.ids[1:] and bool(np.isfinite(table[id]).any())

    known_plots = (replace(plot, columns=tuple(filter(is_known, plot.columns))) for plot in plots)
    return tuple(plot.with_limits(plot.limits) for plot in known_plots if plot.columns)


# Distance of the handle of a pose's angle from its origin, as a share of the extent of all poses.
ARM = 0.25


def point_handle(*keys: str, at: Complex | complex, label: str = "", arrow: complex = 0j) -> SceneHandle:
    """A point that the keys place.

    Parameters
    ----------
    *keys : str
        Keys of a point, of its items, or of lengths that end there.
    at : complex or complex array, shape (frames,)
        Its position, mm.
    label : str
        For people; by default the last name of the first key.
    arrow : complex
        Vector of an arrow that ends there, mm.
    """
    places = np.atleast_1d(np.asarray(at, complex))
    return SceneHandle(f"point:{keys[0]}", label or _words(keys[0]), keys, places, arrow=arrow)


def circle_handle(
    *keys: str, radius: float, centre: Complex | complex = 0j, label: str = "", is_one_value: bool = False
) -> SceneHandle:
    """A circle whose radius the keys give, mm; with `is_one_value` all keys have the same value."""
    at = np.atleast_1d(np.asarray(centre, complex))
    label = label or _words(keys[0])
    return SceneHandle(f"circle:{keys[0]}", label, keys, at, "circle", radius, is_one_value=is_one_value)


def plot_handle(*keys: str, at: complex, column: str, label: str = "") -> SceneHandle:
    """A point of the plot of a column: x and y in the plot's units."""
    return SceneHandle(f"plot:{keys[0]}", label or _words(keys[0]), keys, np.array([at]), "plot", column=column)


def pose_handles(key: str, poses: Sequence[Sequence[float]]) -> Iterator[SceneHandle]:
    """Two handles for each pose [x, y, angle in deg] of a list: its origin, and a point on its x axis."""
    rows = np.array(poses, dtype=float).reshape(-1, 3)
    places = rows[:, 0] + 1j * rows[:, 1]
    arm = ARM * (max(np.ptp(places.real), np.ptp(places.imag)) or 1.0)
    for k, (place, turn) in enumerate(zip(places, np.exp(1j * np.radians(rows[:, 2])))):
        row = f"{key}[{k}]"
        yield point_handle(f"{row}[0]", f"{row}[1]", at=place, label=f"pose {k + 1}")
        yield point_handle(f"{row}[2]", at=place + arm * turn, label=f"angle of pose {k + 1}")


def list_handles(key: str, points: Sequence[complex], label: str) -> Iterator[SceneHandle]:
    """A handle for each point of a list, mm."""
    for k, z in enumerate(points):
        yield point_handle(f"{key}[{k}]", at=z, label=f"{label} {k + 1}")


def _words(key: str) -> str:
    return key.rpartition(".")[2].replace("_", " ")
