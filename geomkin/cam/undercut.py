"""Undercut: where the follower cuts away what it ought to touch, the cam that is left, and the lift that is lost."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable
from functools import cached_property, partial

import numpy as np
from numpy.typing import ArrayLike

from ..core.arguments import checked
from ..core.records import record
from ..plane.curve import AbstractCurve
from ..plane.joined import Path
from ..plane.vec import Complex, Mask, Real, Whole
from .cam import Cam
from .extrema import highest_between, refine_peak, samples
from .untrimmed_outline import UntrimmedOutline, chord_crossings, crossings, refined

# Chords along each stretch that runs backwards, and as closely set over four times its length to either side, within
# which its loop closes. Fewer may miss a small loop, more take longer.
CHORDS_PER_LOOP = 8
# A stretch that runs backwards over less than this share of the base radius is a point: its loop is lost in rounding,
# and so is the lift that it costs. Smaller looks for crossings in rounding, larger loses loops that can be found.
POINT = 3e-10
# Angles times corners, on which the follower is let down, in one go: more takes more memory, less takes longer.
BLOCK = 1_000_000
# Chords to either side within which a crossing is looked for, and, where there is none, looked for again: where one
# branch is steep its chords run far from it. Fewer lose such crossings, and with them the undercut; more take others.
BESIDE = (1, 4, 16)
# Share by which two losses of lift may differ and still count as equal: less lets rounding choose where a symmetric
# cam is worst, more takes the first of two that differ.
TIED = 1e-9

# From one parameter of the untrimmed outline to another.
Interval = tuple[float, float]


@record(eq=False)
class Undercut:
    """What undercut does to a cam.

    outline: closed, what the follower leaves as a cutter: all that it covers nowhere, round the cam's axis. The
    cam's own profile where there is no undercut. spans: (n, 2), cam angles, rad, from and to, between which the
    follower does not touch where it should, in order; the last may end beyond one turn. corners: (n,) complex,
    mm, on the cam: the sharp points on which it rests meanwhile. Derived here.
    """

    cam: Cam
    outline: AbstractCurve
    spans: Real
    corners: Complex

    @property
    def found(self) -> bool:
        """Whether there is any."""
        return len(self.spans) > 0

    def lost_lift(self, angle: ArrayLike) -> Real:
        """How far the follower's lift stays below the programme's, mm or rad, at cam angles in rad."""
        return self._resting(angle)[0]

    def corner(self, angle: ArrayLike) -> Complex:
        """The corner on which it rests meanwhile, mm, on the ground, at cam angles in rad; nan where it loses none."""
        return self._resting(angle)[1]

    def _resting(self, angle: ArrayLike) -> tuple[Real, Complex]:
        angle = np.asarray(angle, dtype=float)
        if not self.found:
            return np.zeros(angle.shape), np.full(angle.shape, complex(np.nan, np.nan))
        blocks = np.array_split(angle.ravel(), 1 + angle.size * len(self.spans) // BLOCK)
        lost, corner = zip(*map(self._rest, blocks))
        return np.concatenate(lost).reshape(angle.shape), np.concatenate(corner).reshape(angle.shape)

    def _rest(self, angle: Real) -> tuple[Real, Complex]:
        lost, corner = np.zeros(angle.shape), np.full(angle.shape, complex(np.nan, np.nan))
        since = np.mod(angle[:, None] - self.spans[:, 0], 2 * np.pi)
        missing = (since < self.spans[:, 1] - self.spans[:, 0]).any(axis=-1)
        at = angle[missing]
        corners = self.corners * np.exp(1j * self.cam.sense * at)[:, None]
        rest = self.cam.follower.resting_lift(corners, self.cam.base_radius)
        # Where lift is lost it rests on a corner: on a smooth part it would stand where the programme puts it.
        lost[missing] = np.maximum(self.cam.program.motion(at).lift - rest.max(axis=-1), 0)
        highest = np.take_along_axis(corners, rest.argmax(axis=-1)[:, None], axis=-1)[:, 0]
        corner[missing] = np.where(lost[missing] > 0, highest, corner[missing])
        return lost, corner

    @cached_property
    def worst(self) -> tuple[float, float]:
        """Largest lost lift, mm or rad, and the cam angle there, rad; 0 at 0 without undercut."""
        if not self.found:
            return 0.0, 0.0
        joints = np.concatenate([self.cam.program.breaks, self.cam.program.breaks[1:] + 2 * np.pi])
        ends = [np.array([a, *joints[(joints > a) & (joints < b)], b]) for a, b in self.spans.tolist()]
        low, high = (np.concatenate([b[which] for b in ends]) for which in (slice(None, -1), slice(1, None)))
        tops = highest_between(low, high, self.lost_lift)
        # Of equals, as a symmetric cam has them, the first: rounding must not choose.
        first = int((tops[0] >= (1 - TIED) * tops[0].max()).argmax())
        return float(tops[0][first]), float(tops[1][first] % (2 * np.pi))


@checked
def undercut(cam: Cam) -> Undercut:
    """Undercut of a cam: local, at joints where the velocity jumps, and where one flank cuts into another.

    The curve of all contacts divides the plane. The cam is the part that holds the axis: each other part is
    covered by the follower at some cam angle, or falls off. So the outline follows the curve from the point
    nearest to the axis, and leaves it at every crossing for the other branch.

    Source: derived here; undercut itself is that of Rothbart, Cams (1956), on radius of curvature.
    """
    raw = UntrimmedOutline(cam)
    loops, points = _backward(raw)
    grid = _grid(raw, loops, points)
    z = raw.curve.point(grid)
    kept, skipped = _Tracing(raw, grid, z, points).trace(float(grid[np.abs(z).argmin()]))
    if not skipped:
        outline = raw.pieces[0] if len(raw.pieces) == 1 else raw.curve
        return Undercut(cam, outline, np.empty((0, 2)), np.empty(0, complex))
    spans = np.array([[raw.cam_angle(a), raw.cam_angle(b)] for a, b in skipped])
    spans[:, 1] += np.where(spans[:, 1] < spans[:, 0], 2 * np.pi, 0)
    outline = Path(tuple(part for a, b in kept for part in raw.between(a, b)))
    return Undercut(cam, outline, spans[spans[:, 0].argsort()], raw.curve.point(np.array([a for a, _ in skipped])))


class _Tracing:
    """Pairs of places at which the curve meets itself, of which those that its outline passes are found to rounding.

    The others, in what the follower cuts away, are not: there are very many where flanks cross often.
    pairs (n, 2): parameters. chords (n, 2): numbers of the chords that cross there. settled (n,).
    """

    def __init__(self, raw: UntrimmedOutline, grid: Real, z: Complex, points: list[Interval]):
        self.raw, self.grid = raw, grid
        self.end = float(raw.curve.breaks[-1])
        # A touch farther, since chords lie inside the curve.
        i, j, s, t = chord_crossings(z, 1.01 * raw.reach)
        following = np.append(grid, self.end)
        self.chords = np.stack([i, j], axis=1)
        self.pairs = following[self.chords]
        self.pairs += np.stack([s, t], axis=1) * (following[self.chords + 1] - self.pairs)
        self.settled = np.zeros(len(i), bool)
        if points:
            self.pairs = np.concatenate([self.pairs, points])
            self.chords = np.concatenate([self.chords, np.searchsorted(grid, points, side="right") - 1])
            self.settled = np.append(self.settled, np.ones(len(points), bool))

    def trace(self, start: float) -> tuple[list[Interval], list[Interval]]:
        """Stretches of the parameter that are kept, from that which holds `start`, and those skipped between them."""
        while True:
            kept, skipped = _trace(self.pairs, start, self.end)
            passed = ~self.settled & self._near(kept)[self.chords].any(axis=1)
            if not passed.any():
                return kept, skipped
            self._settle(np.flatnonzero(passed))

    def _near(self, kept: list[Interval]) -> Mask:
        """Which chords lie near what is kept: the curve may cross itself two chords away from where its chords do."""
        near = np.zeros(len(self.grid), bool)
        for a, b in kept:
            first, last = np.searchsorted(self.grid, [a, b], side="right").tolist()
            near[np.arange(first - 4, last + 3) % len(near)] = True
        return near

    def _settle(self, which: Whole) -> None:
        self.settled[which] = True
        following = np.append(self.grid, self.end)
        for beside in BESIDE:
            chords = self.chords[which]
            low, high = (
                following[np.maximum(chords - beside, 0)],
                following[np.minimum(chords + beside + 1, len(self.grid))],
            )
            start = self.pairs[which]
            found = crossings(self.raw.curve, start, low, high, self.raw.last_bit(start))
            settled = np.isfinite(found[:, 0])
            settled[settled] = ~self.raw.touches(found[settled])
            self.pairs[which[settled]] = found[settled]
            which = which[~settled]
        # What is found nowhere was none; neighbouring chords may have led to the same crossing: it is kept once.
        self._keep(np.setdiff1d(np.arange(len(self.pairs)), which))
        if len(self.pairs):
            alike = [
                np.cumsum(np.diff(np.sort(t), prepend=t.min()) > 1e-12 * self.end)[t.argsort().argsort()]
                for t in self.pairs.T
            ]
            first = np.unique(np.stack(alike), axis=1, return_index=True)[1]
            self._keep(np.union1d(first, np.flatnonzero(~self.settled)))

    def _keep(self, which: Whole) -> None:
        self.pairs, self.chords, self.settled = self.pairs[which], self.chords[which], self.settled[which]


def _trace(pairs: Real, start: float, end: float) -> tuple[list[Interval], list[Interval]]:
    """The same, by the pairs as they now stand, settled or not."""
    if not len(pairs):
        return [(0.0, end)], []
    both = np.concatenate([pairs, pairs[:, ::-1]])
    both = both[np.lexsort([both[:, 1], both[:, 0]])]
    leave = both[:, 0].tolist()
    into = np.searchsorted(both[:, 0], both[:, 1])
    enter, into = both[:, 1].tolist(), into.tolist()
    kept: list[Interval] = []
    skipped: list[Interval] = []
    first = here = (bisect_right(leave, start) - 1) % len(leave)
    for _ in pairs:
        following = (here + 1) % len(leave)
        a, b = leave[here], leave[following]
        kept += [(a, b)] if a < b else [(a, end), (0.0, b)]
        skipped.append((b, enter[following]))
        here = into[following]
        if here == first:
            break
    return [(a, b) for a, b in kept if b > a], skipped


def _backward(raw: UntrimmedOutline) -> tuple[list[Interval], list[Interval]]:
    """Stretches of the parameter along which contact runs backwards within a piece; then, of those too small for a
    loop to be seen, the two parameters at which the branches beside them would meet.
    """

    def advance(angle: Real) -> Real:
        return raw.cam.contact(angle).profile_speed

    places = samples(raw.cam.program.breaks)
    values = advance(places)
    row, column = np.nonzero((values[:, 1:-1] < values[:, :-2]) & (values[:, 1:-1] <= values[:, 2:]))
    if len(row):
        # A dip may go below zero between two samples.
        _, dips = refine_peak(places[row, column], places[row, column + 2], lambda t: -advance(t))
        places = np.union1d(places, dips)
    places = places.ravel()
    change = np.diff(np.concatenate([[False], advance(places) < 0, [False]]).astype(int))
    starts, ends = np.flatnonzero(change == 1), np.flatnonzero(change == -1) - 1
    if not len(starts):
        return [], []
    low = _turning(advance, places[np.maximum(starts - 1, 0)], places[starts]).tolist()
    high = _turning(advance, places[np.minimum(ends + 1, len(places) - 1)], places[ends]).tolist()
    loops: list[Interval] = []
    points: list[Interval] = []
    for a, b in zip(low, high):
        start, end = raw.parameter(a, ending=False), raw.parameter(b, ending=True)
        piece = float(np.floor(start))
        if end > piece + 1:
            # The profile jumps in between: chords begin and end at the jump, and need be no closer.
            continue
        if (back := abs(np.subtract(*raw.curve.point(np.array([start, end]))))) > POINT * raw.cam.base_radius:
            loops.append((start, end))
        else:
            # The two branches of a small loop meet half the way back from its cusps, whatever the acceleration there.
            cusps = np.array([start, end])
            away = np.array([max(2 * start - end, piece), min(2 * end - start, piece + 1)])
            before, after = _turning(partial(_farther, raw, raw.curve.point(cusps), back / 2), away, cusps).tolist()
            points.append((before, after))
    return loops, points


def _farther(raw: UntrimmedOutline, tips: Complex, way: float, t: Real) -> Real:
    """By how much the curve at parameters is farther than a way, mm, from its places at the cusps."""
    return np.abs(raw.curve.point(t) - tips) - way


def _turning(f: Callable[[Real], Real], outside: Real, inside: Real) -> Real:
    """Where f, negative at `inside`, changes sign on the way to `outside`; `inside` where the two are the same."""
    for _ in range(60):
        middle = 0.5 * (outside + inside)
        negative = f(middle) < 0
        outside, inside = np.where(negative, outside, middle), np.where(negative, middle, inside)
    return inside


def _grid(raw: UntrimmedOutline, loops: list[Interval], points: list[Interval]) -> Real:
    """Parameters of the untrimmed outline whose chords cross where it does, loops included."""
    grid = [raw.places]
    for a, b in loops:
        near = np.linspace(5 * a - 4 * b, 5 * b - 4 * a, 9 * CHORDS_PER_LOOP + 1)
        grid.append(near[(near >= np.floor(a)) & (near < np.ceil(b))])
    chosen = refined(raw.curve, np.unique(np.concatenate(grid)))
    for a, b in points:
        before, after = chosen <= a, chosen >= b
        chosen = chosen[before | after if a < b else before & after]
    return chosen
