"""What the follower touches all the way round, as one closed curve, loops and all, and where a curve crosses itself."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from ..core.records import record
from ..plane.curve import AbstractCurve, SubCurve, just_before
from ..plane.joined import Path
from ..plane.vec import Complex, Mask, Pose, Real, Whole, cross
from .cam import Cam
from .extrema import samples

# Contacts on the two sides of a joint that differ by more than this share of the base radius lie apart, and
# what joins them is a piece of the outline. Smaller makes pieces out of the rounding at a law's ends; larger
# leaves gaps, with which a path of pieces is not closed.
APART = 5e-10
# Chords over one turn in the search for crossings, and at least in each segment. Loops of the profile are looked
# at more closely. Fewer miss flanks that just cross; these, crossings less deep than 3e-7 of the radius of curvature.
CHORDS, CHORDS_PER_SEGMENT = 4096, 64
# Share of the curve's size by which a chord may miss the curve; where it misses by more it is halved, so often at most.
# Larger loses crossings of steep short segments, whose contact runs far in a small cam angle; smaller takes longer.
MISS, HALVINGS = 1e-7, 16
# Newton's steps before a crossing of chords is taken for no crossing of the curve. Where branches cross at an angle
# six are enough; where they touch each step only halves the gap, and fewer would lose that crossing.
STEPS = 60
# Last bits of the parameter by which two branches of one place may lie apart: one for each branch, and as much for what
# is rounded on the way. Fewer lose crossings of what runs fast, more take a near miss there for one.
BITS = 4
# Share of the curve's size from which a loop is one: less is a single place that rounding found twice. A smaller share
# takes rounding at joints for crossings, a larger one loses loops that can be found.
ONE_PLACE = 3e-11
# Width, as a share of the reach, below which two pieces that meet enclose nothing. Less takes rounding for crossings,
# more loses slivers that nobody sees.
THIN = 1e-11
# Pairs of chords looked at in one go: more takes more memory; fewer than a thousand take longer.
BLOCK = 1_000_000


@record(eq=False)
class UntrimmedOutline:
    """What a follower touches all the way round: the profile and, where it jumps, what joins its ends.

    Where the programme's velocity jumps, the follower stands still while the contact runs along it: along
    the face, or round the roller. So pieces of the profile, each over a stretch of cam angles, are followed
    each by such a joint; but one piece, the profile itself, where nothing jumps.
    """

    cam: Cam

    @cached_property
    def pieces(self) -> tuple[AbstractCurve, ...]:
        """Pieces end to end, all the way round; every second one is a joint."""
        profile, breaks = self.cam.profile, self.cam.program.breaks
        ends = just_before(breaks[1:], breaks[1:])
        after = profile.point(np.append(breaks[1:-1], breaks[0]))
        jumps = np.flatnonzero(np.abs(after - profile.point(ends)) > APART * self.cam.base_radius)
        if not len(jumps):
            return (profile,)
        pieces: list[AbstractCurve] = []
        first = 0
        for k in jumps.tolist():
            piece = SubCurve(profile, breaks[first : k + 2])
            joint = _joint(self.cam, float(breaks[k + 1]), complex(piece.point(breaks[k + 1])), complex(after[k]))
            pieces += [piece, joint]
            first = k + 1
        return (*pieces, SubCurve(profile, breaks[first:])) if first < len(breaks) - 1 else tuple(pieces)

    @cached_property
    def reach(self) -> float:
        """Distance from the axis, mm, beyond which no cam is left: the follower covers all of a curve round the axis.

        That is the pitch curve, or the feet of the perpendiculars from the axis to the face.
        """
        cam = self.cam
        motion = cam.program.motion(samples(cam.program.breaks))
        return float(cam.follower.outer_radius_bound(motion, cam.base_radius, cam.sense).max())

    @cached_property
    def curve(self) -> Path:
        """The pieces as one closed curve; piece k runs over k <= t <= k + 1."""
        return Path(self.pieces)

    def cam_angle(self, t: float) -> float:
        """Cam angle, rad, at a parameter of the curve."""
        k = min(int(t), len(self.pieces) - 1)
        if k % 2:
            return float(self.pieces[k - 1].breaks[-1])
        first, last = map(float, self.pieces[k].breaks[[0, -1]])
        return first + (t - k) * (last - first)

    def parameter(self, angle: float, ending: bool) -> float:
        """Parameter of the curve at a cam angle; at a joint, that where it is reached if `ending`, else left."""
        ends = np.array([piece.breaks[-1] for piece in self.pieces[::2]])
        k = min(int(np.searchsorted(ends, angle, side="left" if ending else "right")), len(ends) - 1)
        first, last = map(float, self.pieces[2 * k].breaks[[0, -1]])
        return 2 * k + (angle - first) / (last - first)

    def last_bit(self, t: Real) -> Real:
        """What rounding moves parameters by: that of their own or, on a short piece, that of the cam angles."""
        ends = np.array([piece.breaks[[0, -1]] for piece in self.pieces])
        own = np.abs(ends).max(axis=1) / np.diff(ends, axis=1)[:, 0]
        piece = np.clip(t.astype(int), 0, len(self.pieces) - 1)
        return np.asarray(np.finfo(float).eps * np.maximum(np.abs(t), own[piece]))

    def touches(self, pairs: Real) -> Mask:
        """Which pairs of parameters (n, 2) are of a piece and the next where these only touch, at their common end.

        There the follower's surface is tangent to the profile, so that both are in one place to rounding for some way,
        and enclose nothing; where they cross, they do.
        """
        whole, share = len(self.pieces), np.linspace(0, 1, 17)
        way = pairs[:, 1] - pairs[:, 0]
        way -= whole * np.rint(way / whole)
        low = np.where(way > 0, pairs[:, 0], pairs[:, 1])[:, None]
        high = low + np.abs(way)[:, None]
        tip = np.floor(high)
        t = np.concatenate([low + (tip - low) * share, tip + (high - tip) * share[1:]], axis=1)
        z = self.curve.point(np.mod(t, whole))
        z = z - z[:, :1]
        enclosed = np.abs(cross(z[:, :-1], z[:, 1:]).sum(axis=1)) / 2
        return np.asarray((np.floor(low) == tip - 1)[:, 0] & (enclosed <= THIN * self.reach * np.abs(z).max(axis=1)))

    def between(self, start: float, end: float) -> list[AbstractCurve]:
        """The curves between two parameters."""
        parts: list[AbstractCurve] = []
        for k in range(int(start), int(np.ceil(end))):
            b = self.pieces[k].breaks
            # Its own ends exactly: beside them by rounding, its last break would lie within.
            low = b[0] if start <= k else b[0] + (start - k) * (b[-1] - b[0])
            high = b[-1] if end >= k + 1 else min(b[0] + (end - k) * (b[-1] - b[0]), b[-1])
            # What is left of a piece beyond a crossing at its very end is rounding.
            if high - low > 1e-13 * (b[-1] - b[0]):
                parts.append(SubCurve(self.pieces[k], np.array([low, *b[(b > low) & (b < high)], high])))
        return parts

    @cached_property
    def places(self) -> Real:
        """Rising parameters. The chords between them cross where the curve does, except in its loops."""
        return np.concatenate([k + self._shares(k) for k in range(len(self.pieces))])

    def _shares(self, number: int) -> Real:
        """From 0 to 1 along a piece, its end excluded."""
        b = self.pieces[number].breaks
        if number % 2:
            return np.linspace(0, 1, CHORDS_PER_SEGMENT + 1)[:-1]
        counts = np.maximum(CHORDS_PER_SEGMENT, CHORDS * np.diff(b) / (2 * np.pi)).astype(int).tolist()
        t = np.concatenate([np.linspace(first, last, n + 1)[:-1] for first, last, n in zip(b, b[1:], counts)])
        shares: Real = (t - b[0]) / (b[-1] - b[0])
        return shares


def _joint(cam: Cam, angle: float, before: complex, after: complex) -> AbstractCurve:
    on_ground, to_cam = cam.follower_pose(angle), np.exp(-1j * cam.sense * angle)
    return cam.follower.surface_between(Pose(to_cam * on_ground.origin, to_cam * on_ground.direction), before, after)


def crossings(curve: AbstractCurve, start: Real, low: Real, high: Real, bit: Real | None = None) -> Real:
    """Parameters (n, 2) at which a closed curve is in the same place, near `start` (n, 2), between `low` and `high`.

    bit: what rounding moves the parameters by, (n, 2); unless given, their own last bit. nan where there are none:
    where chords cross, the curve itself may pass by.
    """
    first, last = curve.breaks[[0, -1]].tolist()
    size = float(np.abs(curve.point(np.linspace(first, last, 65))).max())
    best, least = np.array(start, dtype=float), np.full(len(start), np.inf)
    # Where a curve runs fast, the last bit of its parameter alone is more than that.
    close = np.full(len(start), 1e-12 * size)
    live, t = np.arange(len(start)), best
    bit = np.finfo(float).eps * np.abs(best) if bit is None else bit
    for _ in range(STEPS):
        apart, v = np.subtract(*curve.point(t).T), curve.velocity(t)
        nearer = np.abs(apart) < least[live]
        least[live[nearer]], best[live[nearer]] = np.abs(apart[nearer]), t[nearer]
        close[live] = np.maximum(1e-12 * size, BITS * (bit[live] * np.abs(v)).max(axis=1))
        turned = cross(v[:, 0], v[:, 1])
        # At its limit Newton's step is rounding, and brings nothing nearer.
        going = (turned != 0) & (nearer | (least[live] > close[live]))
        live, t, apart, v, turned = live[going], t[going], apart[going], v[going], turned[going]
        if not len(live):
            break
        step = np.stack([cross(apart, v[:, 1]), cross(apart, v[:, 0])], axis=1) / -turned[:, None]
        t = np.clip(t + step, low[live], high[live])
    best[(least >= close) | _is_one_place(curve, best, ONE_PLACE * size)] = np.nan
    return best


def _is_one_place(curve: AbstractCurve, pairs: Real, small: float) -> Mask:
    """Whether a closed curve stays within `small`, mm, from one parameter of a pair to the other: the shorter way."""
    first, last = curve.breaks[[0, -1]].tolist()
    way = pairs[:, 1] - pairs[:, 0]
    way -= (last - first) * np.rint(way / (last - first))
    between = pairs[:, :1] + way[:, None] * np.linspace(0, 1, 5)
    z = curve.point(first + np.mod(between - first, last - first))
    return np.asarray(np.abs(z - z[:, :1]).max(axis=1) <= small)


def refined(curve: AbstractCurve, places: Real) -> Real:
    """Rising parameters of a closed curve, with as many more between them as its chords need to follow it."""
    end = float(curve.breaks[-1])
    low, high = places, np.append(places[1:], end)
    found = [places]
    miss = MISS * float(np.abs(curve.point(places)).max())
    for _ in range(HALVINGS):
        # Not at the middle, where an S crosses its chord.
        chord = 0.6 * curve.point(low) + 0.4 * curve.point(np.minimum(high, np.nextafter(end, 0)))
        bad = np.abs(curve.point(0.6 * low + 0.4 * high) - chord) > miss
        if not bad.any():
            break
        low, high = low[bad], high[bad]
        middle = 0.5 * (low + high)
        found.append(middle)
        low, high = np.concatenate([low, middle]), np.concatenate([middle, high])
    return np.unique(np.concatenate(found))


def chord_crossings(z: Complex, reach: float = np.inf) -> tuple[Whole, Whole, Real, Real]:
    """Crossings of a closed polygon's chords: numbers i < j of the chords, and the share along each.

    Of chords that come nearer to the origin than `reach`; others may be left out.
    """
    # Turned by an odd angle: drawn shapes may have many upright chords at the same x, whose boxes would all meet.
    a = z * np.exp(0.7j)
    b = np.roll(a, -1)
    near = np.flatnonzero(np.minimum(np.abs(a), np.abs(b)) - np.abs(b - a) / 2 < reach)
    i, j = (near[k] for k in _boxes_that_meet(a[near], b[near]))
    i, j = np.minimum(i, j), np.maximum(i, j)
    apart = (j - i > 1) & (j - i < len(a) - 1)
    i, j = i[apart], j[apart]
    gap, one, other = a[j] - a[i], b[i] - a[i], b[j] - a[j]
    turned = cross(one, other)
    with np.errstate(divide="ignore", invalid="ignore"):
        s, t = cross(gap, other) / turned, cross(gap, one) / turned
        hit = (s >= 0) & (s < 1) & (t >= 0) & (t < 1)
    order = np.lexsort([j[hit], i[hit]])
    return i[hit][order], j[hit][order], s[hit][order], t[hit][order]


def _boxes_that_meet(a: Complex, b: Complex) -> tuple[Whole, Whole]:
    """Pairs of chords a to b whose upright boxes meet, once each.

    The chords are sorted along x within bands of y no higher than they are themselves, so that nearly all that
    are next to each other there do meet.
    """
    if not len(a):
        return np.zeros(0, int), np.zeros(0, int)
    left, right = np.minimum(a.real, b.real), np.maximum(a.real, b.real)
    low, high = np.minimum(a.imag, b.imag), np.maximum(a.imag, b.imag)
    # On average a chord lies in two bands; in a shape without height all lie in one.
    height = max(float((high - low).mean()), float(high.max() - low.min()) / len(a)) or 1.0
    first, last = (np.floor((y - low.min()) / height).astype(int) for y in (low, high))
    chord = np.repeat(np.arange(len(a)), last - first + 1)
    band = np.arange(len(chord)) - np.repeat(np.cumsum(last - first + 1) - (last - first + 1) - first, last - first + 1)
    order = np.lexsort([left[chord], band])
    chord, band = chord[order], band[order]
    # One rising number for band and place: bands lie farther apart than the shape is wide.
    width = 2 * float(right.max() - left.min()) or 1.0
    start, end = (band * width + (x[chord] - left.min()) for x in (left, right))
    ends = np.searchsorted(start, end + 1e-12 * (1 + band) * width, side="right")
    counts = np.maximum(ends - np.arange(1, len(chord) + 1), 0)
    total = np.cumsum(counts)
    found = []
    for since in range(0, int(total[-1]), BLOCK):
        k = np.arange(since, min(since + BLOCK, int(total[-1])))
        one = np.searchsorted(total, k, side="right")
        other = one + 1 + k - (total[one] - counts[one])
        i, j = chord[one], chord[other]
        # Two chords that share several bands are counted in the lowest of them.
        meet = (low[i] <= high[j]) & (low[j] <= high[i]) & (band[one] == np.maximum(first[i], first[j]))
        found.append(np.stack([i[meet], j[meet]]))
    i, j = np.concatenate([np.zeros((2, 0), int), *found], axis=1)
    return i, j
