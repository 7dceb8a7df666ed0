"""Families of methods that are measured, and the brute-force reference for envelopes: a moving convex tool."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, TypeVar

import numpy as np

from ..core.errors import DesignError
from ..core.records import record
from ..plane.primitives import Polyline
from ..plane.vec import Complex, Pose, Real, Whole, unit

# Number of first positions. With fewer the valley of the least distance may be missed; more take longer.
POSITIONS = 241
# Steps of the golden section, which narrow a valley to 1e-11 of its width. Since a distance is flat at its minimum,
# fewer steps affect only its last digits.
STEPS = 54
# Points per batch; more take more memory.
AT_ONCE = 256
# Positions along an edge, as shares of it, at which its distance is measured.
SHARES = np.array([0.25, 0.5, 0.75])


@record(eq=False)
class Tool:
    """A convex polygon grown by `rounding`, mm, that moves in the frame of the part it cuts.

    `corners` are (n,) counterclockwise, mm; a single one is a roller. `pose` gives its pose at each t of `span`.
    """

    corners: Complex
    rounding: float
    pose: Callable[[Real], Pose]
    span: tuple[float, float]

    def clearance(self, points: Complex) -> Real:
        """Least distance (n,) of points from the tool over all its positions, mm, negative if it cuts deeper.

        It is 0 on the cut outline, and near it the distance from the outline. Found by sampling the span and a golden
        section in each valley, without tangents or the law of gearing. Derived here.
        """
        parts = np.array_split(points, len(points) // AT_ONCE + 1)
        return np.concatenate([self._clearance(part) for part in parts])

    def corner_error(self, line: Polyline) -> Real:
        """Distances of a line's corners from the cut outline, mm."""
        return np.abs(self.clearance(np.asarray(line.vertices, dtype=complex)))

    def edge_error(self, line: Polyline) -> Real:
        """Distances of points on the line's edges, arcs or straight, from the cut outline, mm."""
        return np.abs(self.clearance(line.point((line.breaks[:-1, None] + SHARES).ravel())))

    def polygons(self, count: int, chord: float) -> list[Complex]:
        """The tool at `count` evenly spaced positions of its span, with chords of the given length, mm, for its
        roundings.
        """
        pose = self.pose(np.linspace(*self.span, count))
        shape = self._shape(chord)
        return list(np.asarray(pose.origin)[:, None] + np.asarray(pose.direction)[:, None] * shape)

    def distance(self, points: Complex, t: Real) -> Real:
        """Distances of points from the tool at t, arrays of equal shape, mm, negative inside."""
        seen = self.pose(t).locate(points)[..., None] - self.corners
        edges = np.roll(self.corners, -1) - self.corners
        length = np.abs(edges)
        along = seen * (np.conj(unit(edges)) if len(edges) > 1 else 1.0)
        off = np.hypot(np.maximum(np.maximum(-along.real, along.real - length), 0), along.imag).min(axis=-1)
        inside = (along.imag > 0).all(axis=-1) & (len(edges) > 2)
        deep: Real = np.where(inside, -off, off) - self.rounding
        return deep

    def _clearance(self, points: Complex) -> Real:
        t = np.linspace(*self.span, POSITIONS)
        off = self.distance(*np.broadcast_arrays(points[:, None], t))
        padded = np.pad(off, ((0, 0), (1, 1)), constant_values=np.inf)
        # A valley is deeper than its sample by at most the tool's motion in a step.
        step = np.abs(np.diff(off, axis=1)).max(axis=1, keepdims=True)
        valley = (off <= padded[:, :-2]) & (off <= padded[:, 2:]) & (off <= off.min(axis=1, keepdims=True) + step)
        row, column = np.nonzero(valley)
        low, high = t[np.maximum(column - 1, 0)], t[np.minimum(column + 1, POSITIONS - 1)]
        least = np.full(len(points), np.inf)
        np.minimum.at(least, row, self._deepest(points[row], low, high))
        return least

    def _deepest(self, points: Complex, low: Real, high: Real) -> Real:
        """Least distance of each point between two t, by the golden section."""
        share = (np.sqrt(5) - 1) / 2
        a, b = high - share * (high - low), low + share * (high - low)
        at_a, at_b = self.distance(points, a), self.distance(points, b)
        for _ in range(STEPS):
            left = at_a <= at_b
            low, high = np.where(left, low, a), np.where(left, b, high)
            fresh = np.where(left, high - share * (high - low), low + share * (high - low))
            off = self.distance(points, fresh)
            a, b = np.where(left, fresh, b), np.where(left, a, fresh)
            at_a, at_b = np.where(left, off, at_b), np.where(left, at_a, off)
        return np.minimum(at_a, at_b)

    def _shape(self, chord: float) -> Complex:
        """The grown polygon in the tool's frame."""
        if not self.rounding:
            return self.corners
        normals = -1j * unit(np.roll(self.corners, -1) - self.corners) if len(self.corners) > 1 else np.array([1 + 0j])
        before = np.roll(normals, 1)
        turns = np.angle(normals / before) if len(normals) > 1 else np.array([2 * np.pi])
        counts: Whole = np.maximum(1, np.ceil(np.abs(turns) * self.rounding / chord)).astype(int)
        arcs = [
            corner + self.rounding * normal * np.exp(1j * turn * np.arange(n + (len(normals) > 1)) / n)
            for corner, normal, turn, n in zip(self.corners, before, turns, counts.tolist())
        ]
        return np.concatenate(arcs)


P = TypeVar("P")
R = TypeVar("R")


@record(checked=True, eq=False)
class Method(Generic[P, R]):
    """A method of a family.

    Parameters
    ----------
    name : str
        Its name in charts.
    about : str
        How it works, in one or two sentences, with its preparation and its source.
    make : callable
        From the family's problem and a setting, after all preparation that is not timed, to the timed call, which takes
        nothing and returns the results.
    setting : str
        Name of the setting with its unit, such as `step, deg`; "" if there is none.
    settings : tuple of float
        Values at which it is measured, from coarse to fine; empty if there is no setting.
    rationale : str
        Reason why the library uses it by default; "" for all other methods.
    caveat : str
        Reason why it is the default although it is not on the Pareto front; "" otherwise.
    slow : bool
        Whether a quick chart leaves it out.

    Raises
    ------
    DesignError
        If only one of `setting` and `settings` is given.
    """

    name: str
    about: str
    make: Callable[[P, float], Callable[[], R]]
    setting: str = ""
    settings: tuple[float, ...] = ()
    rationale: str = ""
    caveat: str = ""
    slow: bool = False

    def __post_init__(self) -> None:
        if bool(self.setting) != bool(len(self.settings)):
            raise DesignError(
                "settings", f"found {len(self.settings)} of {self.setting!r}", "give both or neither", "conflict"
            )

    @property
    def is_default(self) -> bool:
        """Whether the library uses this method by default."""
        return bool(self.rationale)


@record(checked=True, eq=False)
class MethodFamily(Generic[P, R]):
    """All methods for one kind of result, with a test problem and a reference.

    Parameters
    ----------
    name : str
        Name in the command and in `FAMILIES`.
    title, about : str
        The kind of result and the problem, in plain words.
    per : str
        Name of one result, such as `pose`.
    unit : str
        Unit of the errors.
    reference : str
        How the right results are known.
    floor : float
        Error below which there is only rounding; smaller errors count as equal.
    problem : callable
        Makes the problem with its reference, once per chart and not timed.
    count : callable
        From problem and results to the number of results.
    error : callable
        From problem and results to the errors, at most one per result, not negative, nan or inf if the method failed.
    methods : tuple of Method
        The methods, with different names.
    weighed : str
        Name of a further cost of the results, such as vertices; "" if only time counts.
    weigh : callable, optional
        From problem and results to that cost.

    Raises
    ------
    DesignError
        If two methods have the same name.
    """

    name: str
    title: str
    about: str
    per: str
    unit: str
    reference: str
    floor: float
    problem: Callable[[], P]
    count: Callable[[P, R], int]
    error: Callable[[P, R], Real]
    methods: tuple[Method[P, R], ...]
    weighed: str = ""
    weigh: Callable[[P, R], float] | None = None

    def __post_init__(self) -> None:
        names = [method.name for method in self.methods]
        if len(set(names)) < len(names):
            raise DesignError(
                "methods", f"found twins among {', '.join(names)}", "give each method its own name", "conflict"
            )
