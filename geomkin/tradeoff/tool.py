"""The brute-force reference for envelopes: the distance of points from a convex tool at all positions of its motion."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

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
# Positions along an edge, as shares of it, at which its distance is measured. Fewer let an S pass for straight.
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
