"""Distances of moving plates and pins, also between frames."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field
from functools import cached_property

import numpy as np

from ...core.errors import DesignError
from ...core.records import record
from ...plane.measure import separation
from ...plane.vec import Array, Complex, Mask, Real, Whole, dot
from ..motion import Motion

# Largest number of elements of an array, so that it stays in the processor's cache.
AT_ONCE = 1 << 15


@record(eq=False)
class PointPaths:
    """Paths of points from frame to frame: a step leads from each closed frame to the next, if that is closed.

    drive: (frames,), rad or mm. points: (frames, n) complex, mm, nan where open. Each path is within `bulge` of its
    chords, so that no collision between two frames is missed if a bound includes it.
    """

    drive: Real
    points: Complex

    @cached_property
    def frames(self) -> Whole:
        """Frames at which a step starts: the closed ones. The step of a frame before an open one has no length."""
        return np.flatnonzero(np.isfinite(self.points).all(axis=1))

    @cached_property
    def _steps(self) -> tuple[Complex, Complex, Real]:
        start, end, bulge = path_steps(with_unknown(self.drive), with_unknown(self.points.T))
        return start[:, self.frames].T, end[:, self.frames].T, bulge[:, self.frames].T

    @property
    def ends(self) -> tuple[Complex, Complex]:
        """Start and end of each step, (steps, n)."""
        return self._steps[:2]

    @property
    def bulge(self) -> Real:
        """Largest distance of the paths from their chords, mm, (steps, n)."""
        return self._steps[2]

    def extent(self, direction: complex) -> float:
        """Largest coordinate of the paths along a direction, mm from the origin."""
        start, end = (dot(direction, z) for z in self.ends)
        return float((np.maximum(start, end) + self.bulge).max())

    def gap(self, corners: Complex) -> Real:
        """Smallest distance, mm, (steps,), between the convex hulls of the points and of fixed `corners` (m,).

        A lower bound: the hull of a step's two ends contains all chords between them. It is too small by the bulge, and
        near the middle of a turning bar by half of the travel of its ends. 0 or less if they meet.
        """
        start, end = self.ends
        bulge: Real = self.bulge.max(axis=1)
        gaps = np.empty(len(bulge))
        count = AT_ONCE // (2 * start.shape[1] + len(corners)) ** 2 + 1
        for some in (slice(k, k + count) for k in range(0, len(bulge), count)):
            moving = np.concatenate([start[some], end[some]], axis=1)
            still = np.broadcast_to(np.asarray(corners, dtype=complex), (len(moving), len(corners)))
            gaps[some] = separation(moving, still) - bulge[some]
        return gaps


def path_steps(drive: Real, points: Complex) -> tuple[Complex, Complex, Real]:
    """Start and end of the steps from each frame to the next, and the largest distance of the path from its chord.

    Results are (..., steps). points: (..., steps + 3), at a frame before the first step, at its start and so on, and at
    two more after the last start; nan where open or unknown. drive: likewise. A path of second derivative P'' over a
    step h leaves its chord by |P''| h^2 / 8. P'' is the second divided difference about either end, whichever is
    larger; the bound is twice that, since P'' changes within a step. If no neighbour gives P'' the bound is half a
    chord, as for a half circle.
    """
    start, end = points[..., 1:-2], points[..., 2:-1]
    end = np.where(np.isfinite(end), end, start)
    step = np.diff(drive)
    with np.errstate(invalid="ignore", divide="ignore"):
        slope = np.diff(points) / step
        second = np.abs(2 * np.diff(slope) / (step[1:] + step[:-1]))
        bound = np.fmax(second[..., :-1], second[..., 1:]) * step[1:-1] ** 2 / 4
    return start, end, np.where(np.isfinite(bound), bound, np.abs(end - start) / 2)


def with_unknown(values: Array) -> Array:
    """Values (..., frames) with a nan before the first and two after the last, as `steps` takes them."""
    unknown = np.full_like(values[..., :1], np.nan)
    return np.concatenate([unknown, values, unknown, unknown], axis=-1)


def relative_paths(motion: Motion, frame: str, body: str, places: complex | Complex) -> PointPaths:
    """Paths of points of one body in the frame of another."""
    reference, moving = motion.bodies[frame], motion.bodies[body]
    local = np.atleast_1d(np.asarray(places, dtype=complex))
    world = moving.origin.position[:, None] + moving.direction[:, None] * local
    relative = (world - reference.origin.position[:, None]) * np.conj(reference.direction[:, None])
    return PointPaths(motion.drive, np.where(motion.assembled[:, None], relative, np.nan))


# Interval of the frames that are examined first.
EVERY = 16
# Largest number of distances of corners: about ten seconds.
MOST = 10**9
# Share of the sizes by which quick bounds must differ from the limit to decide: far above their rounding, so that they
# agree with the exact test.
HAIR = 1e-9
# Square of an edge's length, mm2, below which it counts as a point, to avoid a division by zero.
POINT = 1e-300


@record(eq=False)
class Pair:
    """Two plates, a plate and a pin, or two pins, and their smallest permitted distance `near`, mm.

    body, corners: a convex hull fixed in the frame of a body; other, places: the one that moves past it, in the frame
    of another. Corners of hulls, counterclockwise, complex mm; a pin has one.
    """

    body: str
    corners: Complex
    other: str
    places: Complex
    near: float


@record(eq=False)
class PosesOverFrames:
    """Poses of bodies at the frames, and nan before the first and at two after the last."""

    motion: Motion
    _known: dict[str, Complex] = field(default_factory=dict)

    def paths(self, pairs: Sequence[Pair], frames: slice) -> Complex:
        """Paths of the places of pairs in the frames of their bodies, mm, (places, pairs, frames), nan where open."""
        base, base_direction = self._poses([pair.body for pair in pairs], frames)
        origin, direction = self._poses([pair.other for pair in pairs], frames)
        local = np.array([pair.places for pair in pairs]).T[..., None]
        paths: Complex = (origin + direction * local - base) * np.conj(base_direction)
        return paths

    @cached_property
    def drive(self) -> Real:
        """The driver at all these frames, rad or mm."""
        return with_unknown(self.motion.drive)

    def _poses(self, names: Sequence[str], frames: slice) -> Complex:
        for name in set(names) - set(self._known):
            body = self.motion.bodies[name]
            pose = [np.where(self.motion.assembled, z, np.nan) for z in (body.origin.position, body.direction)]
            self._known[name] = with_unknown(np.array(pose))
        return np.stack([self._known[name][:, frames] for name in names], axis=1)


def meeting(motion: Motion, pairs: Sequence[Pair]) -> Mask:
    """Whether each pair comes nearer than permitted, at any frame or between two, as by `PointPaths.gap`.

    Clear cases are decided by bounds, many pairs at once, with memory proportional to the frames; the exact test
    decides the rest. DesignError if that is too much work. Derived here.
    """
    frames, distances = len(motion.drive), sum(len(pair.corners) * len(pair.places) for pair in pairs)
    if distances * frames > MOST:
        problem = f"found {frames} frames, and in each {distances} distances of the plates' corners"
        remedy = f"give at most {MOST // distances} frames, or fewer points"
        raise DesignError("motion", problem, remedy, "too-much-work")
    poses, met = PosesOverFrames(motion), np.zeros(len(pairs), dtype=bool)
    by_shape: dict[tuple[int, int], list[int]] = {}
    for number, pair in enumerate(pairs):
        by_shape.setdefault((len(pair.corners), len(pair.places)), []).append(number)
    for shape, numbers in by_shape.items():
        length = min(frames, AT_ONCE // max(shape) + 1)
        count = AT_ONCE // (max(shape) * length) + 1
        for some in (numbers[k : k + count] for k in range(0, len(numbers), count)):
            for first in range(0, frames, length):
                undecided = [number for number in some if not met[number]]
                if undecided:
                    met[undecided] = _meet(poses, [pairs[k] for k in undecided], first, min(frames, first + length))
    return met


def _meet(poses: PosesOverFrames, pairs: Sequence[Pair], first: int, last: int) -> Mask:
    """The same between two frames, for pairs with equal numbers of corners."""
    around, half = slice(first, last + 3), EVERY // 2
    places, corners = poses.paths(pairs, around), np.array([pair.corners for pair in pairs]).T[..., None]
    near = np.array([pair.near for pair in pairs])[:, None]
    hair = HAIR * (near + np.abs(corners).max(axis=0) + np.fmax.reduce(np.abs(places), (0, 2), initial=0.0)[:, None])
    # Pairs that meet at one of a few frames are decided.
    apart = distance(corners, places[..., 1 + half : -2 : EVERY])
    met: Mask = (apart < near - hair).any(axis=1)
    undecided = np.flatnonzero(~met)
    if not len(undecided):
        return met
    places, corners, near, hair, apart = (
        places[:, undecided],
        corners[:, undecided],
        near[undecided],
        hair[undecided],
        apart[undecided],
    )
    start, end, bulges = path_steps(poses.drive[around], places)
    bulge, chord = bulges.max(axis=0), np.abs(end - start).max(axis=0)
    closed = np.isfinite(bulge)
    # Around such a frame nothing comes nearer by more than its path length, unless the path is interrupted.
    lengths = _rows(np.where(closed & np.isfinite(places[..., 2:-1]).all(axis=0), chord, np.inf))
    travel = np.maximum(lengths[..., :half].sum(axis=-1), lengths[..., half:].sum(axis=-1))
    travel += _rows(np.where(closed, bulge, 0.0)).max(axis=-1)
    far = np.zeros(lengths.shape, dtype=bool)
    count = apart.shape[1]
    far[:, :count] = (apart - travel[:, :count] > near + hair)[..., None]
    one, step = np.nonzero(closed & ~far.reshape(len(undecided), -1)[:, : closed.shape[1]])
    limit, hair = near[one, 0] + bulge[one, step], hair[one, 0]
    met[undecided] = _on_steps(
        one, len(undecided), start[:, one, step], end[:, one, step], corners[:, one, 0], limit, hair
    )
    return met


def _on_steps(pair: Whole, pairs: int, start: Complex, end: Complex, corners: Complex, limit: Real, hair: Real) -> Mask:
    """Whether the points of each pair come nearer to its corners than a limit on any of some steps.

    pair: index of the pair of each step, (steps,); start, end, corners: (points, steps).
    """
    met = np.zeros(pairs, dtype=bool)
    # No point of a step's hull is farther from the hull of the midpoints than half of the longest chord.
    least = distance(corners, (start + end) / 2) - np.abs(end - start).max(axis=0) / 2
    unsure = np.flatnonzero(least < limit + hair)
    most = distance(corners[:, unsure], start[:, unsure])
    met[pair[unsure[most < limit[unsure] - hair[unsure]]]] = True
    # So near the limit that only the exact test decides.
    count = AT_ONCE // (len(start) + len(corners)) ** 2 + 1
    while len(unsure := unsure[~met[pair[unsure]]]):
        some, unsure = unsure[:count], unsure[count:]
        hull = np.concatenate([start[:, some], end[:, some]])
        hits = separation(hull.T, corners[:, some].T) < limit[some]
        met[pair[some[hits]]] = True
    return met


def _rows(values: Real) -> Real:
    """Steps (pairs, steps) grouped by frame of the first scan, (pairs, rows, `EVERY`), filled with zeros."""
    pairs, count = values.shape
    rows = np.zeros((pairs, -(-count // EVERY), EVERY))
    rows.reshape(pairs, -1)[:, :count] = values
    return rows


def distance(one: Complex, two: Complex) -> Real:
    """Distance, mm, of convex hulls by their corners (n, ...) and (m, ...), counterclockwise; 0 if they meet."""
    if len(one) == len(two) == 1:
        apart: Real = np.abs(two[0] - one[0])
        return apart
    (a, left_of_one), (b, left_of_two) = _from_edges(one, two), _from_edges(two, one)
    meet = np.zeros(a.shape, dtype=bool)
    # Two edges cross if the ends of each lie on both sides of the other; otherwise one hull may contain the other.
    for k, these in enumerate(left_of_one):
        for j, those in enumerate(left_of_two):
            meet |= (these[j] * these[j + 1 - len(two)] < 0) & (those[k] * those[k + 1 - len(one)] < 0)
    for sides in (left_of_one, left_of_two):
        if len(sides) > 2:
            meet |= np.min([side[0] for side in sides], axis=0) > 0
    return np.where(meet, 0.0, np.minimum(a, b))


def _from_edges(corners: Complex, places: Complex) -> tuple[Real, list[Real]]:
    """Smallest distance of points (m, ...) from a hull's edges, mm; and by edge, positive to its left."""
    least, sides = np.full(np.broadcast_shapes(corners.shape[1:], places.shape[1:]), np.inf), []
    for k in range(len(corners) if len(corners) > 2 else len(corners) - 1):
        edge = corners[k + 1 - len(corners)] - corners[k]
        square = np.maximum(edge.real**2 + edge.imag**2, POINT)
        seen: Complex = np.conj(edge) * (places - corners[k])
        beyond = seen.real - np.clip(seen.real, 0.0, square)
        least = np.minimum(least, ((seen.imag**2 + beyond**2) / square).min(axis=0))
        sides.append(seen.imag)
    return np.sqrt(least), sides
