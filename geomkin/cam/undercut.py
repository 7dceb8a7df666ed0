"""Undercut: where the follower cuts away what it ought to touch, the cam that is left, and the lift that is lost."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import checked
from ..plane.curve import AbstractCurve
from ..plane.joined import Path
from ..plane.vec import Array, dot
from .cam import Cam
from .crossings import crossings
from .extremes import climb, largest, samples
from .raw_outline import RawOutline

# Chords over the width of a reversed stretch and, to either side, over four times its width, where the
# profile crosses itself.
CHORDS_PER_LOOP = 8
# A reversed stretch whose ends lie nearer than this share of the base radius is a point: its loop is lost in
# rounding, and so is the lift that it costs.
POINT = 3e-10
# So is what a backward jump smaller than this share costs: the branches beside it meet too flat to be solved for.
JUMP = 1e-6

# Share by which two losses of lift may differ and still count as equal: far above what rounding makes of equals.
TIED = 1e-9

Span = tuple[float, float]


@dataclass(frozen=True, eq=False)
class Undercut:
    """What undercut does to a cam.

    outline: closed, what the follower leaves as a cutter: all that it covers nowhere, round the cam's axis. The
    cam's own profile where there is no undercut. spans: (n, 2), cam angles, rad, from and to, between which the
    follower does not touch where it should, in order; the last may end beyond one turn. corners: (n,) complex,
    mm, on the cam: the sharp points on which it rests meanwhile.
    """

    cam: Cam
    outline: AbstractCurve
    spans: Array
    corners: Array

    @property
    def found(self) -> bool:
        """Whether there is any."""
        return len(self.spans) > 0

    def lost_lift(self, angle: ArrayLike) -> Array:
        """How far the follower's lift stays below the programme's, mm or rad, at cam angles in rad."""
        angle = np.asarray(angle, dtype=float)
        lost = np.zeros(angle.shape)
        if not self.found:
            return lost
        since = np.mod(angle[..., None] - self.spans[:, 0], 2 * np.pi)
        missing = (since < self.spans[:, 1] - self.spans[:, 0]).any(axis=-1)
        at = angle[missing]
        corners = self.corners * np.exp(1j * self.cam.sense * at)[:, None]
        rest = self.cam.follower.resting_lift(corners, self.cam.base_radius).max(axis=-1)
        # It rests on a corner always: on a smooth part it would stand where the programme puts it.
        lost[missing] = np.maximum(self.cam.program.motion(at).lift - rest, 0)
        return lost

    @cached_property
    def worst(self) -> tuple[float, float]:
        """Largest lost lift, mm or rad, and the cam angle there, rad; 0 at 0 without undercut."""
        if not self.found:
            return 0.0, 0.0
        joints = np.concatenate([self.cam.program.breaks, self.cam.program.breaks[1:] + 2 * np.pi])
        tops = [
            largest(np.array([start, *joints[(joints > start) & (joints < end)], end]), self.lost_lift)
            for start, end in self.spans.tolist()
        ]
        # Of equals, as a symmetric cam has them, the first: rounding must not choose.
        most = max(lost for lost, _ in tops)
        lost, angle = next(top for top in tops if top[0] >= (1 - TIED) * most)
        return lost, angle % (2 * np.pi)


@checked
def undercut(cam: Cam) -> Undercut:
    """Undercut of a cam: local, at joints where the velocity jumps, and where one flank cuts into another.

    The curve of all contacts divides the plane. The cam is the part that holds the axis: each other part is
    covered by the follower at some cam angle, or falls off. So the outline follows the curve from the point
    nearest to the axis, and leaves it at every crossing for the other branch.
    """
    raw = RawOutline(cam)
    loops, points = _backward(raw)
    points += _small_jumps(raw)
    grid = _grid(raw, loops, points)
    pairs = [*crossings(raw.curve, grid), *points]
    if not pairs:
        outline = raw.pieces[0] if len(raw.pieces) == 1 else raw.curve
        return Undercut(cam, outline, np.empty((0, 2)), np.empty(0, complex))
    nearest = float(grid[np.abs(raw.curve.point(grid)).argmin()])
    kept, skipped = _trace(pairs, nearest, len(raw.pieces))
    spans = np.array([[raw.cam_angle(a), raw.cam_angle(b)] for a, b in skipped])
    spans[:, 1] += np.where(spans[:, 1] < spans[:, 0], 2 * np.pi, 0)
    outline = Path(tuple(part for a, b in kept for part in raw.between(a, b)))
    return Undercut(cam, outline, spans[spans[:, 0].argsort()], raw.curve.point(np.array([a for a, _ in skipped])))


def _trace(pairs: list[Span], start: float, end: float) -> tuple[list[Span], list[Span]]:
    """Stretches of the parameter that are kept, from that which holds `start`, and those skipped between them."""
    leave, enter = np.array(sorted([*pairs, *(pair[::-1] for pair in pairs)])).T
    kept: list[Span] = []
    skipped: list[Span] = []
    first = here = (int(np.searchsorted(leave, start, side="right")) - 1) % len(leave)
    for _ in pairs:
        a, b = float(leave[here]), float(leave[(here + 1) % len(leave)])
        kept += [(a, b)] if a < b else [(a, end), (0.0, b)]
        into = float(enter[(here + 1) % len(leave)])
        skipped.append((b, into))
        here = int(np.searchsorted(leave, into))
        if here == first:
            break
    return [(a, b) for a, b in kept if b > a], skipped


def _backward(raw: RawOutline) -> tuple[list[Span], list[Span]]:
    """Stretches of the curve's parameter along which the contact runs backwards within a piece.

    Of those too small to have a loop, which come apart from the others, it is the pairs of places where the
    branches would meet.
    """

    def advance(angle: Array) -> Array:
        return raw.cam.contact(angle).advance

    places = samples(raw.cam.program.breaks)
    values = advance(places)
    row, column = np.nonzero((values[:, 1:-1] < values[:, :-2]) & (values[:, 1:-1] <= values[:, 2:]))
    if len(row):
        # A dip may go below zero between two samples.
        _, dips = climb(places[row, column], places[row, column + 2], lambda t: -advance(t))
        places = np.union1d(places, dips)
    places = places.ravel()
    change = np.diff(np.concatenate([[False], advance(places) < 0, [False]]).astype(int))
    starts, ends = np.flatnonzero(change == 1), np.flatnonzero(change == -1) - 1
    if not len(starts):
        return [], []
    low = _turning(advance, places[np.maximum(starts - 1, 0)], places[starts]).tolist()
    high = _turning(advance, places[np.minimum(ends + 1, len(places) - 1)], places[ends]).tolist()
    loops: list[Span] = []
    points: list[Span] = []
    for a, b in zip(low, high):
        start, end = raw.parameter(a, ending=False), raw.parameter(b, ending=True)
        piece = float(np.floor(start))
        if end > piece + 1:
            # The profile jumps in between: each side by itself.
            loops += [(start, piece + 1), (float(np.floor(end)), end)]
        elif abs(np.subtract(*raw.curve.point(np.array([start, end])))) > POINT * raw.cam.base_radius:
            loops.append((start, end))
        else:
            # The two branches of a small loop meet this much beyond its cusps, where the contact stands still.
            beyond = (np.sqrt(3) - 1) / 2 * (end - start)
            points.append((max(start - beyond, piece), min(end + beyond, piece + 1)))
    return loops, points


def _small_jumps(raw: RawOutline) -> list[Span]:
    """Where the profile jumps a little backwards: the pairs of places before and after where it meets itself."""
    found: list[Span] = []
    for k in range(1, len(raw.pieces), 2):
        before, jump, after = (raw.pieces[j % len(raw.pieces)] for j in (k - 1, k, k + 1))
        way = complex(jump.point(jump.breaks[-1]) - jump.point(jump.breaks[0]))
        leaving, entering = complex(before.velocity(before.breaks[-1])), complex(after.velocity(after.breaks[0]))
        if abs(way) <= JUMP * raw.cam.base_radius and dot(way, leaving) < 0 and dot(way, entering) < 0:
            # Half the way back on one branch, and half of it on along the other.
            back, on = (
                abs(way) / 2 / abs(v) / (b[-1] - b[0]) for v, b in ((leaving, before.breaks), (entering, after.breaks))
            )
            found.append((k - back, (k + 1) % len(raw.pieces) + on))
    return found


def _turning(f: Callable[[Array], Array], outside: Array, inside: Array) -> Array:
    """Where f, negative inside, stops being so towards outside; `inside` where both are one place."""
    for _ in range(60):
        middle = 0.5 * (outside + inside)
        negative = f(middle) < 0
        outside, inside = np.where(negative, outside, middle), np.where(negative, middle, inside)
    return inside


def _grid(raw: RawOutline, loops: list[Span], points: list[Span]) -> Array:
    """Parameters of the raw outline whose chords cross where it does, loops included."""
    grid = [raw.places]
    for a, b in loops:
        near = np.linspace(5 * a - 4 * b, 5 * b - 4 * a, 9 * CHORDS_PER_LOOP + 1)
        grid.append(near[(near >= np.floor(a)) & (near < np.ceil(b))])
    chosen = np.unique(np.concatenate(grid))
    for a, b in points:
        before, after = chosen <= a, chosen >= b
        chosen = chosen[before | after if a < b else before & after]
    return chosen
