"""How near moving plates and pins come to each other, between frames too."""

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

# Numbers in each array at once, so that they stay in a processor's cache. More take memory and are slower; with fewer,
# most of the time is spent between arrays.
AT_ONCE = 1 << 15


@record(eq=False)
class Sweep:
    """Paths of points from frame to frame: a step leads from each closed frame to the next, if that is closed.

    drive: (frames,), the driver's angle or displacement. points: (frames, n) complex, mm, nan where open.
    Every path is its chords to within `bulge`, so that no bound that adds it lets anything slip through
    between two frames.
    """

    drive: Real
    points: Complex

    @cached_property
    def frames(self) -> Whole:
        """Frames at which a step starts: the closed ones. The step of a frame before an open one stands still."""
        return np.flatnonzero(np.isfinite(self.points).all(axis=1))

    @cached_property
    def _steps(self) -> tuple[Complex, Complex, Real]:
        start, end, bulge = steps(with_unknown(self.drive), with_unknown(self.points.T))
        return start[:, self.frames].T, end[:, self.frames].T, bulge[:, self.frames].T

    @property
    def ends(self) -> tuple[Complex, Complex]:
        """The points where each step starts and where it ends, (steps, n)."""
        return self._steps[:2]

    @property
    def bulge(self) -> Real:
        """How far the paths leave their chords at most, mm, (steps, n)."""
        return self._steps[2]

    def reach(self, direction: complex) -> float:
        """How far the paths go along a direction at most, mm from the origin."""
        start, end = (dot(direction, z) for z in self.ends)
        return float((np.maximum(start, end) + self.bulge).max())

    def gap(self, corners: Complex) -> Real:
        """Least distance, mm, (steps,), between the points' convex hull and that of `corners` (m,), which stand still.

        A lower bound: the hull of a step's two ends holds all chords between them. It falls short by the bulge,
        and beside the middle of a turning bar by half of what the bar's ends travel. 0 or less where they meet.
        """
        start, end = self.ends
        bulge: Real = self.bulge.max(axis=1)
        found = np.empty(len(bulge))
        count = AT_ONCE // (2 * start.shape[1] + len(corners)) ** 2 + 1
        for some in (slice(k, k + count) for k in range(0, len(bulge), count)):
            moving = np.concatenate([start[some], end[some]], axis=1)
            still = np.broadcast_to(np.asarray(corners, dtype=complex), (len(moving), len(corners)))
            found[some] = separation(moving, still) - bulge[some]
        return found


def steps(drive: Real, points: Complex) -> tuple[Complex, Complex, Real]:
    """Of steps from each frame to the next: start, end, and how far the path leaves its chord at most, (..., steps).

    points: (..., steps + 3), at a frame before the first step, at its start and so on, and at two more after the last
    start; nan where open or unknown. drive: likewise. A path of second derivative P'' over a step h leaves its chord
    by |P''| h^2 / 8. P'' is the second divided difference about either end, whichever is larger; the bound is twice
    that, for what P'' itself changes within a step. Where no neighbour tells P'', half a chord: a half circle.
    """
    start, end = points[..., 1:-2], points[..., 2:-1]
    end = np.where(np.isfinite(end), end, start)
    step = np.diff(drive)
    with np.errstate(invalid="ignore", divide="ignore"):
        slope = np.diff(points) / step
        bend = np.abs(2 * np.diff(slope) / (step[1:] + step[:-1]))
        most = np.fmax(bend[..., :-1], bend[..., 1:]) * step[1:-1] ** 2 / 4
    return start, end, np.where(np.isfinite(most), most, np.abs(end - start) / 2)


def with_unknown(values: Array) -> Array:
    """Values (..., frames) with a nan before the first and two after the last, as `steps` takes them."""
    unknown = np.full_like(values[..., :1], np.nan)
    return np.concatenate([unknown, values, unknown, unknown], axis=-1)


def path_in(motion: Motion, frame: str, body: str, places: complex | Complex) -> Sweep:
    """Paths of points of one body as seen from another."""
    seen, moving = motion.bodies[frame], motion.bodies[body]
    local = np.atleast_1d(np.asarray(places, dtype=complex))
    world = moving.origin.position[:, None] + moving.direction[:, None] * local
    here = (world - seen.origin.position[:, None]) * np.conj(seen.direction[:, None])
    return Sweep(motion.drive, np.where(motion.assembled[:, None], here, np.nan))


# Frames from one that is looked at first to the next. With more, the ways between them are longer than the distances,
# and more frames are looked at finely; with fewer, the first look is as long as the fine one.
EVERY = 16
# Distances of corners that are looked at, at most: some ten seconds. More, and a recipe seems to stand still.
MOST = 10**9
# Share of the sizes by which quick bounds must differ from the least distance to decide: far above their rounding.
# Smaller, and rounding may decide otherwise than the exact look; larger, and that has more to do.
HAIR = 1e-9
# Square of an edge's length, mm2, below which it is a point: keeps a division from failing, and decides nothing.
POINT = 1e-300


@record(eq=False)
class Pair:
    """Two plates, a plate and a pin, or two pins, and how near, mm, they may come.

    body, corners: what stands still, a convex hull in the frame of a body; other, places: what moves past it, in the
    frame of another. Corners of hulls, counterclockwise, complex mm; a pin has one.
    """

    body: str
    corners: Complex
    other: str
    places: Complex
    near: float


@record(eq=False)
class Poses:
    """Where bodies are at the frames, at an unknown one before the first, and at two after the last."""

    motion: Motion
    _known: dict[str, Complex] = field(default_factory=dict)

    def seen(self, pairs: Sequence[Pair], frames: slice) -> Complex:
        """Paths of the places of pairs as seen from their bodies, mm, (places, pairs, frames), nan where open."""
        here, turn = self._poses([pair.body for pair in pairs], frames)
        origin, direction = self._poses([pair.other for pair in pairs], frames)
        local = np.array([pair.places for pair in pairs]).T[..., None]
        paths: Complex = (origin + direction * local - here) * np.conj(turn)
        return paths

    @cached_property
    def drive(self) -> Real:
        """The driver at all of them, rad or mm."""
        return with_unknown(self.motion.drive)

    def _poses(self, names: Sequence[str], frames: slice) -> Complex:
        for name in set(names) - set(self._known):
            body = self.motion.bodies[name]
            pose = [np.where(self.motion.assembled, z, np.nan) for z in (body.origin.position, body.direction)]
            self._known[name] = with_unknown(np.array(pose))
        return np.stack([self._known[name][:, frames] for name in names], axis=1)


def meeting(motion: Motion, pairs: Sequence[Pair]) -> Mask:
    """Of each pair, whether it comes nearer than it may, at any frame or between two: as `Sweep.gap` tells it.

    What is surely near or far is told by bounds, many pairs at once, in memory that grows with the frames alone; the
    exact look is left for the rest. DesignError where that is too much work. Derived here.
    """
    frames, each = len(motion.drive), sum(len(pair.corners) * len(pair.places) for pair in pairs)
    if each * frames > MOST:
        raise DesignError(
            "motion",
            f"found {frames} frames, and in each {each} distances of the plates' corners",
            f"give at most {MOST // each} frames, or fewer points",
        )
    poses, found = Poses(motion), np.zeros(len(pairs), dtype=bool)
    alike: dict[tuple[int, int], list[int]] = {}
    for number, pair in enumerate(pairs):
        alike.setdefault((len(pair.corners), len(pair.places)), []).append(number)
    for shape, numbers in alike.items():
        length = min(frames, AT_ONCE // max(shape) + 1)
        count = AT_ONCE // (max(shape) * length) + 1
        for some in (numbers[k : k + count] for k in range(0, len(numbers), count)):
            for first in range(0, frames, length):
                left = [number for number in some if not found[number]]
                if left:
                    found[left] = _meet(poses, [pairs[k] for k in left], first, min(frames, first + length))
    return found


def _meet(poses: Poses, pairs: Sequence[Pair], first: int, last: int) -> Mask:
    """The same between two frames, of pairs with as many corners as each other."""
    around, half = slice(first, last + 3), EVERY // 2
    places, corners = poses.seen(pairs, around), np.array([pair.corners for pair in pairs]).T[..., None]
    near = np.array([pair.near for pair in pairs])[:, None]
    hair = HAIR * (near + np.abs(corners).max(axis=0) + np.fmax.reduce(np.abs(places), (0, 2), initial=0.0)[:, None])
    # At a few frames: what meets there needs no other look.
    apart = distance(corners, places[..., 1 + half : -2 : EVERY])
    found: Mask = (apart < near - hair).any(axis=1)
    left = np.flatnonzero(~found)
    if not len(left):
        return found
    places, corners, near, hair, apart = places[:, left], corners[:, left], near[left], hair[left], apart[left]
    start, end, bulges = steps(poses.drive[around], places)
    bulge, chord = bulges.max(axis=0), np.abs(end - start).max(axis=0)
    closed = np.isfinite(bulge)
    # About such a frame nothing comes nearer by more than its way, where that is not broken off.
    ways = _rows(np.where(closed & np.isfinite(places[..., 2:-1]).all(axis=0), chord, np.inf))
    way = np.maximum(ways[..., :half].sum(axis=-1), ways[..., half:].sum(axis=-1))
    way += _rows(np.where(closed, bulge, 0.0)).max(axis=-1)
    far = np.zeros(ways.shape, dtype=bool)
    count = apart.shape[1]
    far[:, :count] = (apart - way[:, :count] > near + hair)[..., None]
    one, step = np.nonzero(closed & ~far.reshape(len(left), -1)[:, : closed.shape[1]])
    limit, hair = near[one, 0] + bulge[one, step], hair[one, 0]
    found[left] = _on_steps(one, len(left), start[:, one, step], end[:, one, step], corners[:, one, 0], limit, hair)
    return found


def _on_steps(pair: Whole, pairs: int, start: Complex, end: Complex, corners: Complex, limit: Real, hair: Real) -> Mask:
    """Of each of so many pairs, whether its points come nearer to its corners than a limit on any of some steps.

    pair: whose step it is, (steps,); start, end, corners: (points, steps).
    """
    found = np.zeros(pairs, dtype=bool)
    # No point of a step's hull is farther from that of the points' middles than half of their longest way.
    least = distance(corners, (start + end) / 2) - np.abs(end - start).max(axis=0) / 2
    unsure = np.flatnonzero(least < limit + hair)
    most = distance(corners[:, unsure], start[:, unsure])
    found[pair[unsure[most < limit[unsure] - hair[unsure]]]] = True
    # So near to the limit that only the exact look tells.
    count = AT_ONCE // (len(start) + len(corners)) ** 2 + 1
    while len(unsure := unsure[~found[pair[unsure]]]):
        some, unsure = unsure[:count], unsure[count:]
        hull = np.concatenate([start[:, some], end[:, some]])
        met = separation(hull.T, corners[:, some].T) < limit[some]
        found[pair[some[met]]] = True
    return found


def _rows(values: Real) -> Real:
    """Steps (pairs, steps) as rows of those about one frame, (pairs, rows, `EVERY`), filled with zeros."""
    return np.pad(values, ((0, 0), (0, -values.shape[1] % EVERY))).reshape(len(values), -1, EVERY)


def distance(one: Complex, two: Complex) -> Real:
    """Distance, mm, of convex hulls by their corners (n, ...) and (m, ...), counterclockwise; 0 where they meet."""
    if len(one) == len(two) == 1:
        apart: Real = np.abs(two[0] - one[0])
        return apart
    (a, left_of_one), (b, left_of_two) = _from_edges(one, two), _from_edges(two, one)
    meet = np.zeros(a.shape, dtype=bool)
    # Two edges cross where the ends of each lie on either side of the other; else one hull may hold the other.
    for k, these in enumerate(left_of_one):
        for j, those in enumerate(left_of_two):
            meet |= (these[j] * these[j + 1 - len(two)] < 0) & (those[k] * those[k + 1 - len(one)] < 0)
    for sides in (left_of_one, left_of_two):
        if len(sides) > 2:
            meet |= np.min([side[0] for side in sides], axis=0) > 0
    return np.where(meet, 0.0, np.minimum(a, b))


def _from_edges(corners: Complex, places: Complex) -> tuple[Real, list[Real]]:
    """How far the nearest of places (m, ...) is from a hull's edges, mm; by edges, which lie to its left: positive."""
    least, sides = np.full(np.broadcast_shapes(corners.shape[1:], places.shape[1:]), np.inf), []
    for k in range(len(corners) if len(corners) > 2 else len(corners) - 1):
        edge = corners[k + 1 - len(corners)] - corners[k]
        square = np.maximum(edge.real**2 + edge.imag**2, POINT)
        seen: Complex = np.conj(edge) * (places - corners[k])
        beyond = seen.real - np.clip(seen.real, 0.0, square)
        least = np.minimum(least, ((seen.imag**2 + beyond**2) / square).min(axis=0))
        sides.append(seen.imag)
    return np.sqrt(least), sides
