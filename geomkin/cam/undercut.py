"""Undercut of a cam: the cam angles at which it occurs, the trimmed outline, and the lost lift."""

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
from ..plane.vec import Complex, Mask, Real, Whole, first_largest
from .cam import Cam
from .program.laws import exceeds, highest_between, refine_peak, samples
from .untrimmed_outline import UntrimmedOutline, chord_crossings, refined_parameters, self_crossings

# Chords along each backward stretch of the profile; the same density is used over four times its length to either side,
# where its loop closes. Fewer may miss a small loop, more take longer.
CHORDS_PER_LOOP = 8
# A backward stretch shorter than this share of the base radius counts as a point: its loop and the lift that it costs
# are lost in rounding. A smaller value searches crossings in rounding errors; a larger one misses real loops.
POINT = 3e-10
# Angles times corners evaluated at once: more need more memory, fewer take longer.
BLOCK = 1_000_000
# Chords to either side in which a crossing is searched, tried in this order: chords of a steep branch are far from the
# curve. Fewer miss such crossings, and with them the undercut; more find other crossings.
SEARCH_CHORDS = (1, 4, 16)

# Two parameters of the untrimmed outline.
Interval = tuple[float, float]


@record(eq=False)
class Undercut:
    """The undercut of a cam and its trimmed outline.

    Parameters
    ----------
    cam : Cam
        The cam and its follower.
    outline : AbstractCurve
        Closed outline of the cam that the follower, as a cutter, leaves round the cam's axis, mm. Without undercut it
        is the cam's profile.
    spans : ndarray, shape (n, 2)
        Ranges of cam angles in which the follower does not touch its profile, rad, in order; the last may end beyond
        one turn. n is 0 without undercut.
    corners : ndarray of complex, shape (n,)
        The corners on which the follower rests in these ranges, mm, on the cam.

    Notes
    -----
    Derived here.
    """

    cam: Cam
    outline: AbstractCurve
    spans: Real
    corners: Complex

    @property
    def found(self) -> bool:
        """Whether there is any undercut."""
        return len(self.spans) > 0

    def lost_lift(self, angle: ArrayLike) -> Real:
        """Lift that the follower loses by undercut.

        Parameters
        ----------
        angle : array_like
            Cam angles, rad, any shape.

        Returns
        -------
        ndarray
            mm, or rad for an oscillating follower; same shape.
        """
        return self._resting(angle)[0]

    def corner(self, angle: ArrayLike) -> Complex:
        """Corner on which the follower rests.

        Parameters
        ----------
        angle : array_like
            Cam angles, rad, any shape.

        Returns
        -------
        ndarray of complex
            Point in the ground's frame, mm, same shape; nan where no lift is lost.
        """
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
        from_start = np.mod(angle[:, None] - self.spans[:, 0], 2 * np.pi)
        missing = (from_start < self.spans[:, 1] - self.spans[:, 0]).any(axis=-1)
        at = angle[missing]
        corners = self.corners * np.exp(1j * self.cam.sense * at)[:, None]
        rest = self.cam.follower.resting_lift(corners, self.cam.base_radius)
        # Where lift is lost the follower rests on a corner; on a smooth part it has the lift of the programme.
        lost[missing] = np.maximum(self.cam.program.motion(at).lift - rest.max(axis=-1), 0)
        highest = np.take_along_axis(corners, rest.argmax(axis=-1)[:, None], axis=-1)[:, 0]
        corner[missing] = np.where(lost[missing] > 0, highest, corner[missing])
        return lost, corner

    @cached_property
    def worst(self) -> tuple[float, float]:
        """Largest lost lift, mm or rad, and its cam angle, rad; both 0 without undercut."""
        if not self.found:
            return 0.0, 0.0
        joints = np.concatenate([self.cam.program.breaks, self.cam.program.breaks[1:] + 2 * np.pi])
        ends = [np.array([a, *joints[(joints > a) & (joints < b)], b]) for a, b in self.spans.tolist()]
        low, high = (np.concatenate([b[which] for b in ends]) for which in (slice(None, -1), slice(1, None)))
        tops = highest_between(low, high, self.lost_lift)
        first = first_largest(tops[0])
        return float(tops[0][first]), float(tops[1][first] % (2 * np.pi))


@checked
def undercut(cam: Cam) -> Undercut:
    """Find the undercut of a cam: local, at joints at which the velocity jumps, and between flanks that cross.

    Parameters
    ----------
    cam : Cam
        The cam and its follower.

    Returns
    -------
    Undercut
        The trimmed outline, and the ranges of cam angles with undercut.

    See Also
    --------
    Cam, pressure_angle

    Notes
    -----
    The curve of all contacts divides the plane. The cam is the region that contains the axis; every other region is
    covered by the follower at some cam angle, or falls off. So the outline follows the curve from the point nearest to
    the axis and changes to the other branch at every crossing. Derived here; the term undercut as in Rothbart, Cams
    (1956), on radius of curvature.

    Examples
    --------
    >>> program = gk.Program((gk.Rise("3-4-5", rise=20, end_deg=150), gk.Return("cycloidal", end_deg=360)))
    >>> gk.undercut(gk.Cam(gk.TranslatingRoller(10), program, base_radius=40)).found
    False
    """
    raw = UntrimmedOutline(cam)
    loops, points = _backward(raw)
    if len(raw.pieces) == 1 and not loops and not points and _is_star_shaped(cam):
        return Undercut(cam, raw.pieces[0], np.empty((0, 2)), np.empty(0, complex))
    grid, z = _grid(raw, loops, points)
    kept, skipped = _Tracing(raw, grid, z, points).trace(float(grid[np.abs(z).argmin()]))
    if not skipped:
        outline = raw.pieces[0] if len(raw.pieces) == 1 else raw.curve
        return Undercut(cam, outline, np.empty((0, 2)), np.empty(0, complex))
    spans = np.array([[raw.cam_angle(a), raw.cam_angle(b)] for a, b in skipped])
    spans[:, 1] += np.where(spans[:, 1] < spans[:, 0], 2 * np.pi, 0)
    outline = Path(tuple(part for a, b in kept for part in raw.between(a, b)))
    return Undercut(cam, outline, spans[spans[:, 0].argsort()], raw.curve.point(np.array([a for a, _ in skipped])))


def _is_star_shaped(cam: Cam) -> bool:
    """Whether a profile that nowhere runs backwards meets each ray from the axis once and so never crosses itself."""

    def inward(angle: Real) -> Real:
        contact = cam.contact(angle)
        return -(np.conj(contact.point) * contact.normal).real

    angles = samples(cam.program.breaks)
    return not exceeds(angles, inward(angles), inward, 0.0)


class _Tracing:
    """Crossings of the curve with itself. Only those on the outline are refined to rounding.

    The others, in the removed regions, are not refined: there may be very many. pairs (n, 2): parameters. chords
    (n, 2): indices of the chords that cross. settled (n,): whether a pair is refined.
    """

    def __init__(self, raw: UntrimmedOutline, grid: Real, z: Complex, points: list[Interval]):
        self.raw, self.grid = raw, grid
        self.end = float(raw.curve.breaks[-1])
        # Slightly larger, since chords are inside the curve.
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
        """Intervals of the parameter on the outline, starting with the one that contains `start`, and those skipped."""
        while True:
            kept, skipped = _trace(self.pairs, start, self.end)
            passed = ~self.settled & self._near(kept)[self.chords].any(axis=1)
            if not passed.any():
                return kept, skipped
            self._settle(np.flatnonzero(passed))

    def _near(self, kept: list[Interval]) -> Mask:
        """Mask of the chords close to the kept intervals: a crossing may be two chords away from that of the chords."""
        near = np.zeros(len(self.grid), bool)
        for a, b in kept:
            first, last = np.searchsorted(self.grid, [a, b], side="right").tolist()
            near[np.arange(first - 4, last + 3) % len(near)] = True
        return near

    def _settle(self, which: Whole) -> None:
        self.settled[which] = True
        following = np.append(self.grid, self.end)
        for count in SEARCH_CHORDS:
            chords = self.chords[which]
            low, high = (
                following[np.maximum(chords - count, 0)],
                following[np.minimum(chords + count + 1, len(self.grid))],
            )
            start = self.pairs[which]
            refined_pairs = self_crossings(self.raw.curve, start, low, high, self.raw.last_bit(start))
            settled = np.isfinite(refined_pairs[:, 0])
            settled[settled] = ~self.raw.touches(refined_pairs[settled])
            self.pairs[which[settled]] = refined_pairs[settled]
            which = which[~settled]
        # Pairs without a crossing are dropped, and crossings found from several adjacent chords are kept once.
        self._keep(np.setdiff1d(np.arange(len(self.pairs)), which))
        if len(self.pairs):
            groups = [
                np.cumsum(np.diff(np.sort(t), prepend=t.min()) > 1e-12 * self.end)[t.argsort().argsort()]
                for t in self.pairs.T
            ]
            first = np.unique(np.stack(groups), axis=1, return_index=True)[1]
            self._keep(np.union1d(first, np.flatnonzero(~self.settled)))

    def _keep(self, which: Whole) -> None:
        self.pairs, self.chords, self.settled = self.pairs[which], self.chords[which], self.settled[which]


def _trace(pairs: Real, start: float, end: float) -> tuple[list[Interval], list[Interval]]:
    """Kept and skipped intervals for the current pairs, settled or not."""
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
    """Intervals of the parameter in which contact runs backwards within a piece; and, for those too short for a loop,
    the two parameters at which the adjacent branches would meet.
    """

    def speed(angle: Real) -> Real:
        return raw.cam.contact(angle).profile_speed

    angles = samples(raw.cam.program.breaks)
    values = speed(angles)
    row, column = np.nonzero((values[:, 1:-1] < values[:, :-2]) & (values[:, 1:-1] <= values[:, 2:]))
    if len(row):
        # A minimum may be negative between two samples.
        _, minima = refine_peak(angles[row, column], angles[row, column + 2], lambda t: -speed(t))
        angles = np.union1d(angles, minima)
    angles = angles.ravel()
    change = np.diff(np.concatenate([[False], speed(angles) < 0, [False]]).astype(int))
    starts, ends = np.flatnonzero(change == 1), np.flatnonzero(change == -1) - 1
    if not len(starts):
        return [], []
    low = _sign_change(speed, angles[np.maximum(starts - 1, 0)], angles[starts]).tolist()
    high = _sign_change(speed, angles[np.minimum(ends + 1, len(angles) - 1)], angles[ends]).tolist()
    loops: list[Interval] = []
    points: list[Interval] = []
    for a, b in zip(low, high):
        start, end = raw.parameter(a, ending=False), raw.parameter(b, ending=True)
        piece = float(np.floor(start))
        if end > piece + 1:
            # The profile jumps inside the interval. Chords start and end at the jump, so no more are needed.
            continue
        if (back := abs(np.subtract(*raw.curve.point(np.array([start, end]))))) > POINT * raw.cam.base_radius:
            loops.append((start, end))
        else:
            # The branches of a small loop meet at half the backward length from its cusps, for any acceleration there.
            cusps = np.array([start, end])
            outside = np.array([max(2 * start - end, piece), min(2 * end - start, piece + 1)])
            beyond = partial(_distance_beyond, raw, raw.curve.point(cusps), back / 2)
            before, after = _sign_change(beyond, outside, cusps).tolist()
            points.append((before, after))
    return loops, points


def _distance_beyond(raw: UntrimmedOutline, cusps: Complex, length: float, t: Real) -> Real:
    """Distance of the curve at parameters t from its cusps, minus a length, mm."""
    return np.abs(raw.curve.point(t) - cusps) - length


def _sign_change(f: Callable[[Real], Real], outside: Real, inside: Real) -> Real:
    """Sign change of f, negative at `inside`, between `inside` and `outside`; `inside` if the two are equal."""
    for _ in range(60):
        middle = 0.5 * (outside + inside)
        negative = f(middle) < 0
        outside, inside = np.where(negative, outside, middle), np.where(negative, middle, inside)
    return inside


def _grid(raw: UntrimmedOutline, loops: list[Interval], points: list[Interval]) -> tuple[Real, Complex]:
    """Parameters and points of the untrimmed outline whose chords cross where the curve does, including its loops."""
    grid = [raw.places]
    for a, b in loops:
        dense = np.linspace(5 * a - 4 * b, 5 * b - 4 * a, 9 * CHORDS_PER_LOOP + 1)
        grid.append(dense[(dense >= np.floor(a)) & (dense < np.ceil(b))])
    parameters, z = refined_parameters(raw.curve, np.unique(np.concatenate(grid)))
    for a, b in points:
        before, after = parameters <= a, parameters >= b
        kept = before | after if a < b else before & after
        parameters, z = parameters[kept], z[kept]
    return parameters, z
