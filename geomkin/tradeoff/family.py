"""A moving convex tool, and by brute force how far points are from what it cuts: the reference for all envelopes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, TypeVar

import numpy as np

from ..core.errors import DesignError
from ..core.records import record
from ..plane.primitives import Polyline
from ..plane.vec import Complex, Pose, Real, Whole, unit

# Positions tried first. Fewer, and the least distance may lie in a valley that none of them is in; more take longer.
POSITIONS = 241
# Steps of the golden section, which narrow a valley to 1e-11 of itself: a distance is flat at its least, so that fewer
# show in its last digits.
STEPS = 54
# Points that are looked at together: more take more memory.
AT_ONCE = 256
# Places along an edge, as shares of it, at which its distance is looked at.
SHARES = np.array([0.25, 0.5, 0.75])


@record(eq=False)
class Tool:
    """A convex polygon grown by `rounding`, mm, that moves in the frame of what it cuts.

    corners: (n,) counterclockwise, mm; one is a roller. pose: where it is at each t of `span`.
    """

    corners: Complex
    rounding: float
    pose: Callable[[Real], Pose]
    span: tuple[float, float]

    def clearance(self, points: Complex) -> Real:
        """Least distance (n,) of points from the tool over all its positions, mm, below 0 where it has cut deeper.

        On what the tool leaves it is 0, and near by it is the distance from that. Positions all over the span, and in
        each valley between them a golden section: no tangent, no law of gearing. Derived here.
        """
        parts = np.array_split(points, len(points) // AT_ONCE + 1)
        return np.concatenate([self._clearance(part) for part in parts])

    def corner_error(self, line: Polyline) -> Real:
        """How far a line's corners are from what the tool leaves, mm."""
        return np.abs(self.clearance(np.asarray(line.vertices, dtype=complex)))

    def edge_error(self, line: Polyline) -> Real:
        """The same of places along its edges, arcs or straight."""
        return np.abs(self.clearance(line.point((line.breaks[:-1, None] + SHARES).ravel())))

    def polygons(self, count: int, chord: float) -> list[Complex]:
        """The tool at `count` positions spread evenly over its span, roundings as chords of that length, mm."""
        pose = self.pose(np.linspace(*self.span, count))
        shape = self._shape(chord)
        return list(np.asarray(pose.origin)[:, None] + np.asarray(pose.direction)[:, None] * shape)

    def distance(self, points: Complex, t: Real) -> Real:
        """Of points from the tool at t, both of one shape, mm, below 0 inside."""
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
        # Another valley can be deeper than its sample by no more than the tool goes in a step.
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
        """The grown polygon in the tool's own frame."""
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
    """One way to a family's results.

    make: takes the family's problem and a setting, gets ready whatever is not to be timed, and gives the call that is:
    it takes nothing and returns the results. about: how it goes, in a sentence or two, with what was got ready
    beforehand and the source. settings: what it is measured at, from coarse to fine, such as steps or tolerances; left
    out where there is nothing to set. setting: what they are, with the unit, as `step, deg`.
    because: of a default, why it is the default; of all others empty. despite: of a default that is not on the front,
    why it is the default all the same. slow: takes so long that a quick chart leaves it out.
    """

    name: str
    about: str
    make: Callable[[P, float], Callable[[], R]]
    setting: str = ""
    settings: tuple[float, ...] = ()
    because: str = ""
    despite: str = ""
    slow: bool = False

    def __post_init__(self) -> None:
        if bool(self.setting) != bool(len(self.settings)):
            raise DesignError("settings", f"found {len(self.settings)} of {self.setting!r}", "give both or neither")

    @property
    def is_default(self) -> bool:
        """Whether the library takes this way when it is not told otherwise."""
        return bool(self.because)


@record(checked=True, eq=False)
class MethodFamily(Generic[P, R]):
    """All ways to one thing, with a problem to try them on and a reference to judge them by.

    name: as the command takes it; title, about: what is found, of what, in plain words. problem: makes the problem,
    with its reference; it is called once a chart, not timed. count: from problem and results, how many results there
    are, each one `per`, such as `pose`. error: from problem and results, the error of each, (results,) or fewer, in
    `unit`, 0 or more, nan or inf where the method failed; not timed. reference: how the right results are known.
    floor: an error below which there is only rounding: smaller ones count as equal. weigh: from problem and results,
    what they cost whoever goes on with them, such as how many vertices they have; weighed: what that is; left out where
    time alone counts.
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
            raise DesignError("methods", f"found twins among {', '.join(names)}", "give each method its own name")
