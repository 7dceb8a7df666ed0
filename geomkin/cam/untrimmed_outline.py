"""The closed curve of all contact points of a cam, with its loops, and the crossings of a curve with itself."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from ..core.records import record
from ..plane.curve import AbstractCurve, SubCurve, just_before
from ..plane.joined import Path
from ..plane.vec import Complex, Mask, Pose, Real, Whole, cross
from .cam import Cam
from .program.laws import samples

# Contacts on the two sides of a joint that differ by more than this share of the base radius are separate, and a piece
# of the outline joins them. A smaller value turns rounding at a law's ends into pieces; a larger one leaves gaps, so
# that a path of pieces is not closed.
GAP = 5e-10
# Chords over one turn in the search for crossings, and the least number in each segment; loops of the profile have
# more. Fewer miss flanks that just cross; these miss crossings less deep than 3e-7 of the radius of curvature.
CHORDS, CHORDS_PER_SEGMENT = 4096, 64
# Largest distance of a chord from the curve as a share of the curve's size, and the largest number of halvings. A
# larger distance misses crossings of steep short segments, whose contact moves far in a small cam angle; a smaller one
# takes longer.
CHORD_ERROR, HALVINGS = 1e-7, 16
# Newton steps before a crossing of chords counts as no crossing of the curve. Six are enough if branches cross at an
# angle; if they are tangent each step only halves the gap, and fewer would lose that crossing.
STEPS = 60
# Largest distance of two branches at one point, in last bits of the parameter: one for each branch, and the same again
# for rounding in between. Fewer lose crossings of fast branches; more count near misses as crossings.
BITS = 4
# Least size of a loop as a share of the curve's size; smaller loops are one point that rounding found twice. A smaller
# share counts rounding at joints as crossings, a larger one loses real loops.
ONE_PLACE = 3e-11
# Width, as a share of the outer radius, below which two adjacent pieces enclose nothing. A smaller value counts
# rounding as crossings, a larger one loses invisible slivers.
THIN = 1e-11
# Pairs of chords tested at once: more need more memory; fewer than a thousand take longer.
BLOCK = 1_000_000


@record(eq=False)
class UntrimmedOutline:
    """The closed curve of all contacts: the profile, with a joining piece at each of its jumps.

    If the programme's velocity jumps, the contact runs along the follower at a fixed cam angle: along the face, or
    round the roller. So each piece of the profile, over a range of cam angles, is followed by such a joint. Without
    jumps there is one piece, the profile.
    """

    cam: Cam

    @cached_property
    def pieces(self) -> tuple[AbstractCurve, ...]:
        """The pieces in order; every second one is a joint."""
        profile, breaks = self.cam.profile, self.cam.program.breaks
        ends = just_before(breaks[1:], breaks[1:])
        after = profile.point(np.append(breaks[1:-1], breaks[0]))
        jumps = np.flatnonzero(np.abs(after - profile.point(ends)) > GAP * self.cam.base_radius)
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
        """Upper bound of the cam's radius, mm: the follower covers a whole curve round the axis at that distance.

        The curve is the pitch curve, or the feet of the perpendiculars from the axis to the face.
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
        """Parameter of the curve at a cam angle; at a joint, the end of the piece before if `ending`, else the start
        of the piece after.
        """
        ends = np.array([piece.breaks[-1] for piece in self.pieces[::2]])
        k = min(int(np.searchsorted(ends, angle, side="left" if ending else "right")), len(ends) - 1)
        first, last = map(float, self.pieces[2 * k].breaks[[0, -1]])
        return 2 * k + (angle - first) / (last - first)

    def last_bit(self, t: Real) -> Real:
        """Rounding error of parameters: their own or, on a short piece, that of the cam angles."""
        ends = np.array([piece.breaks[[0, -1]] for piece in self.pieces])
        sizes = np.abs(ends).max(axis=1) / np.diff(ends, axis=1)[:, 0]
        piece = np.clip(t.astype(int), 0, len(self.pieces) - 1)
        return np.asarray(np.finfo(float).eps * np.maximum(np.abs(t), sizes[piece]))

    def touches(self, pairs: Real) -> Mask:
        """Mask of the pairs of parameters (n, 2) at which adjacent pieces only touch, at their common end.

        There the follower's surface is tangent to the profile, so that both coincide to rounding over some length and
        enclose nothing; pieces that cross enclose an area.
        """
        whole, share = len(self.pieces), np.linspace(0, 1, 17)
        span = pairs[:, 1] - pairs[:, 0]
        span -= whole * np.rint(span / whole)
        low = np.where(span > 0, pairs[:, 0], pairs[:, 1])[:, None]
        high = low + np.abs(span)[:, None]
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
            # The exact ends of a piece: with rounding its last break would be inside.
            low = b[0] if start <= k else b[0] + (start - k) * (b[-1] - b[0])
            high = b[-1] if end >= k + 1 else min(b[0] + (end - k) * (b[-1] - b[0]), b[-1])
            # The remainder of a piece after a crossing at its end is rounding.
            if high - low > 1e-13 * (b[-1] - b[0]):
                parts.append(SubCurve(self.pieces[k], np.array([low, *b[(b > low) & (b < high)], high])))
        return parts

    @cached_property
    def places(self) -> Real:
        """Rising parameters whose chords cross where the curve does, except in its loops."""
        return np.concatenate([k + self._shares(k) for k in range(len(self.pieces))])

    def _shares(self, number: int) -> Real:
        """Shares from 0 to 1 along a piece, its end excluded."""
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


def self_crossings(curve: AbstractCurve, start: Real, low: Real, high: Real, bit: Real | None = None) -> Real:
    """Pairs of parameters (n, 2) of one point of a closed curve, near `start` (n, 2), between `low` and `high`.

    bit: rounding error of the parameters, (n, 2); by default their last bit. nan for no crossing: the curve need not
    cross where its chords do.
    """
    first, last = curve.breaks[[0, -1]].tolist()
    size = float(np.abs(curve.point(np.linspace(first, last, 65))).max())
    best, least = np.array(start, dtype=float), np.full(len(start), np.inf)
    # On a fast curve the last bit of its parameter exceeds this.
    close = np.full(len(start), 1e-12 * size)
    live, t = np.arange(len(start)), best
    bit = np.finfo(float).eps * np.abs(best) if bit is None else bit
    for _ in range(STEPS):
        gap, v = np.subtract(*curve.point(t).T), curve.velocity(t)
        closer = np.abs(gap) < least[live]
        least[live[closer]], best[live[closer]] = np.abs(gap[closer]), t[closer]
        close[live] = np.maximum(1e-12 * size, BITS * (bit[live] * np.abs(v)).max(axis=1))
        determinant = cross(v[:, 0], v[:, 1])
        # At the limit a Newton step is rounding and does not reduce the gap.
        active = (determinant != 0) & (closer | (least[live] > close[live]))
        live, t, gap, v, determinant = live[active], t[active], gap[active], v[active], determinant[active]
        if not len(live):
            break
        step = np.stack([cross(gap, v[:, 1]), cross(gap, v[:, 0])], axis=1) / -determinant[:, None]
        t = np.clip(t + step, low[live], high[live])
    best[(least >= close) | _is_one_place(curve, best, ONE_PLACE * size)] = np.nan
    return best


def _is_one_place(curve: AbstractCurve, pairs: Real, small: float) -> Mask:
    """Mask of the pairs between whose parameters, along the shorter part, a closed curve stays within `small`, mm."""
    first, last = curve.breaks[[0, -1]].tolist()
    span = pairs[:, 1] - pairs[:, 0]
    span -= (last - first) * np.rint(span / (last - first))
    between = pairs[:, :1] + span[:, None] * np.linspace(0, 1, 5)
    z = curve.point(first + np.mod(between - first, last - first))
    return np.asarray(np.abs(z - z[:, :1]).max(axis=1) <= small)


def refined_parameters(curve: AbstractCurve, places: Real) -> tuple[Real, Complex]:
    """Rising parameters of a closed curve, with more between them until the chords follow the curve, and its points."""
    z = curve.point(places)
    tolerance = CHORD_ERROR * float(np.abs(z).max())
    parameters, points = [places], [z]
    low, high, start, end = places, np.append(places[1:], curve.breaks[-1]), z, np.roll(z, -1)
    for _ in range(HALVINGS):
        # Not at the middle, where an S-shaped curve crosses its chord.
        bad = np.abs(curve.point(0.6 * low + 0.4 * high) - (0.6 * start + 0.4 * end)) > tolerance
        if not bad.any():
            break
        low, high, start, end = low[bad], high[bad], start[bad], end[bad]
        middle = 0.5 * (low + high)
        z = curve.point(middle)
        parameters.append(middle)
        points.append(z)
        low, high = np.concatenate([low, middle]), np.concatenate([middle, high])
        start, end = np.concatenate([start, z]), np.concatenate([z, end])
    rising, first = np.unique(np.concatenate(parameters), return_index=True)
    return rising, np.concatenate(points)[first]


def chord_crossings(z: Complex, reach: float = np.inf) -> tuple[Whole, Whole, Real, Real]:
    """Crossings of a closed polygon's chords: indices i < j of the chords, and the share along each.

    Only chords that come closer to the origin than `reach` are certain to be included.
    """
    # Rotated by an arbitrary angle: drawn shapes may have many vertical chords at the same x, whose boxes would all
    # overlap.
    a = z * np.exp(0.7j)
    b = np.roll(a, -1)
    inner = np.flatnonzero(np.minimum(np.abs(a), np.abs(b)) - np.abs(b - a) / 2 < reach)
    i, j = (inner[k] for k in _overlapping_boxes(a[inner], b[inner]))
    i, j = np.minimum(i, j), np.maximum(i, j)
    separate = (j - i > 1) & (j - i < len(a) - 1)
    i, j = i[separate], j[separate]
    gap, chord_i, chord_j = a[j] - a[i], b[i] - a[i], b[j] - a[j]
    determinant = cross(chord_i, chord_j)
    with np.errstate(divide="ignore", invalid="ignore"):
        s, t = cross(gap, chord_j) / determinant, cross(gap, chord_i) / determinant
        hit = (s >= 0) & (s < 1) & (t >= 0) & (t < 1)
    order = np.lexsort([j[hit], i[hit]])
    return i[hit][order], j[hit][order], s[hit][order], t[hit][order]


def _overlapping_boxes(a: Complex, b: Complex) -> tuple[Whole, Whole]:
    """Pairs of chords a to b whose axis-aligned boxes overlap, once each.

    The chords are sorted along x within bands of y about as high as a chord, so that nearly all adjacent ones overlap.
    """
    if not len(a):
        return np.zeros(0, int), np.zeros(0, int)
    left, right = np.minimum(a.real, b.real), np.maximum(a.real, b.real)
    low, high = np.minimum(a.imag, b.imag), np.maximum(a.imag, b.imag)
    # On average a chord is in two bands; in a shape without height there is one band.
    height = max(float((high - low).mean()), float(high.max() - low.min()) / len(a)) or 1.0
    first, last = (np.floor((y - low.min()) / height).astype(int) for y in (low, high))
    chord = np.repeat(np.arange(len(a)), last - first + 1)
    band = np.arange(len(chord)) - np.repeat(np.cumsum(last - first + 1) - (last - first + 1) - first, last - first + 1)
    order = np.lexsort([left[chord], band])
    chord, band = chord[order], band[order]
    # One rising number for band and x: the offset of bands is larger than the width of the shape.
    width = 2 * float(right.max() - left.min()) or 1.0
    start, end = (band * width + (x[chord] - left.min()) for x in (left, right))
    ends = np.searchsorted(start, end + 1e-12 * (1 + band) * width, side="right")
    counts = np.maximum(ends - np.arange(1, len(chord) + 1), 0)
    total = np.cumsum(counts)
    pairs = []
    for block in range(0, int(total[-1]), BLOCK):
        k = np.arange(block, min(block + BLOCK, int(total[-1])))
        left_chord = np.searchsorted(total, k, side="right")
        right_chord = left_chord + 1 + k - (total[left_chord] - counts[left_chord])
        i, j = chord[left_chord], chord[right_chord]
        # Two chords with several common bands count in the lowest of them.
        overlap = (low[i] <= high[j]) & (low[j] <= high[i]) & (band[left_chord] == np.maximum(first[i], first[j]))
        pairs.append(np.stack([i[overlap], j[overlap]]))
    i, j = np.concatenate([np.zeros((2, 0), int), *pairs], axis=1)
    return i, j
