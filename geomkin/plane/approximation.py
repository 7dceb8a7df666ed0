"""Curves as few smooth pieces: a chain of circular arcs, or straight edges, arcs and cubic B-splines."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field

import numpy as np

from ..core.arguments import checked
from ..core.errors import DesignError
from ..core.records import record
from ..core.units import mm
from .curve import AbstractCurve, Mirrored, Moved, Reversed
from .flatten import Intervals, Judge, adaptive_subdivision, check_tolerance, direction, probes, tops, turns
from .joined import Path, PolarArray
from .measure import signed_area
from .primitives import Arc, Circle, Polyline, Segment
from .vec import Complex, Mask, Real, dot, rounded, unit

# Positions at which a biarc is compared with its curve.
ARC_SHARES = np.linspace(0, 1, 26)[1:-1]
# Neighbouring arcs are merged if the difference of their curvatures times their length is less than this, rad. A larger
# value would break the tangent; with a smaller one a true circle stays in pieces.
SAME_ARC = 1e-8
# Vertices, first and last included, and the bulges between them.
Chain = tuple[Complex, Real]


@checked
def to_arcs(curve: AbstractCurve, tolerance: float) -> Polyline:
    """Arcs and straight edges that are nowhere farther than a tolerance from a curve.

    Parameters
    ----------
    curve : AbstractCurve
        The curve.
    tolerance : float
        mm; above 0.

    Returns
    -------
    Polyline
        Its tangent is continuous within each smooth piece of the curve, and the points at which arcs of different
        pieces meet are on the curve. Circles and straight pieces are exact. No arc exceeds half a turn.

    Raises
    ------
    DesignError
        If the tolerance is not above 0.

    See Also
    --------
    flatten

    Notes
    -----
    The arcs are biarcs, two arcs that are tangent to the curve at both ends (Bolton, "Biarc curves",
    Computer-Aided Design 7, 1975, 89-92), all with the same error; their number is within 15 % of that of a greedy
    choice.

    Examples
    --------
    >>> import geomkin as gk
    >>> len(gk.to_arcs(gk.plane.Circle(0j, 10.0), 0.01).vertices)
    2
    """
    check_tolerance(tolerance)
    vertices, bulges = _chain(curve, tolerance, {})
    return Polyline(vertices[:-1] if curve.closed else vertices, bulges, curve.closed)


def _chain(curve: AbstractCurve, tolerance: float, known: dict[AbstractCurve, Chain]) -> Chain:
    """The vertices and bulges of `to_arcs`. Congruent pieces are computed once.

    known: the chains of earlier curves.
    """
    if curve in known:
        return known[curve]
    match curve:
        case PolarArray():
            z, bulges = _over_seam(*_chain(curve.piece, tolerance, known), complex(curve.turns[1 % curve.count]))
            around = (curve.turns[:, None] * z[:-1]).ravel()
            return np.append(around, around[0]), np.tile(bulges, curve.count)
        case Moved():
            z, bulges = _chain(curve.curve, tolerance, known)
            return curve.pose.place(z), bulges
        case Mirrored():
            z, bulges = _chain(curve.curve, tolerance, known)
            return -np.conj(z), -bulges
        case Reversed():
            z, bulges = _chain(curve.curve, tolerance, known)
            return z[::-1], -bulges[::-1]
        case Polyline():
            return _no_large_arcs(curve)
        case Circle():
            return curve.centre + curve.radius * np.array([1, -1, 1]), np.ones(2)
        case Arc():
            count = max(1, int(np.ceil(abs(curve.sweep) / np.pi - SAME_ARC)))
            return curve.point(np.linspace(0, 1, count + 1)), np.full(count, np.tan(curve.sweep / (4 * count)))
        case Segment():
            return np.array([curve.start, curve.end]), np.zeros(1)
        case Path():
            links = [_chain(piece, tolerance, known) for piece in curve.pieces]
        case _:
            judge = _biarc_judge(curve)
            pieces = [curve.breaks[k : k + 2] for k in range(len(curve.breaks) - 1)]
            runs = adaptive_subdivision(judge, pieces, tolerance, order=3)
            links = [_merge(*_alternating(*_biarcs(curve, edges[:-1], edges[1:]))) for edges in runs]
    ends = [z[:-1] for z, _ in links] + [links[-1][0][-1:]]
    known[curve] = np.concatenate(ends), np.concatenate([bulges for _, bulges in links])
    return known[curve]


def _over_seam(z: Complex, bulges: Real, turn: complex) -> Chain:
    """The chain from its second vertex on, if its last edge and the first edge of the next copy form one arc."""
    if len(bulges) < 3:
        return z, bulges
    joint, both = np.array([z[-2], z[-1], turn * z[1]]), bulges[[-1, 0]]
    half = unit(np.diff(joint)) * np.exp(2j * np.array([1, -1]) * np.arctan(both))
    one, bulge = _merge(joint, both)
    if len(bulge) > 1 or abs(half[1] - half[0]) > SAME_ARC:
        return z, bulges
    return np.append(z[1:-1], one[-1]), np.append(bulges[1:-1], bulge)


def _no_large_arcs(curve: Polyline) -> Chain:
    """The chain with arcs of more than half a turn cut in two."""
    edges = len(curve.breaks) - 1
    bulges = np.zeros(edges) if curve.bulges is None else np.asarray(curve.bulges)
    if np.abs(bulges).max() <= 1:
        z = np.asarray(curve.vertices, dtype=complex)
        return np.append(z, z[0]) if curve.closed else z, bulges
    halves = 1 + (np.abs(bulges) > 1)
    starts = np.repeat(np.arange(edges), halves) + np.concatenate([np.arange(n) / n for n in halves.tolist()])
    vertices = np.append(curve.point(starts), np.asarray(curve.vertices)[0 if curve.closed else -1])
    return vertices, np.tan(np.repeat(np.arctan(bulges) / halves, halves))


def _biarcs(curve: AbstractCurve, low: Real, high: Real) -> tuple[Complex, ...]:
    """Ends, joints and end tangents of the biarc over each interval from `low` to `high`.

    The joint is the middle of p0 + d t0 and p1 - d t1 with one d for both ends, in a form without a difference of
    nearly equal numbers.
    """
    p0, p1 = curve.point(low), curve.point(high)
    t0, t1 = direction(curve, low, after=True), direction(curve, high, after=False)
    chord, along = p1 - p0, t0 + t1
    c2 = np.abs(chord) ** 2
    projection = dot(chord, along)
    # 2 (1 - t0 . t1) is |t1 - t0|^2, which keeps its digits for nearly parallel tangents.
    root = np.sqrt(projection**2 + np.abs(t1 - t0) ** 2 * c2)
    with np.errstate(divide="ignore", invalid="ignore"):
        d = c2 / (projection + root)
        return p0, p1, 0.5 * (p0 + p1 + d * (t0 - t1)), t0, t1


def _bulge(chord: Complex, tangent: Complex) -> Real:
    """tan(sweep / 4) of the arc over `chord` that starts along `tangent`: half the angle between the two."""
    w = chord * np.conj(tangent)
    return w.imag / (np.abs(w) + w.real)


def _alternating(p0: Complex, p1: Complex, joint: Complex, t0: Complex, t1: Complex) -> Chain:
    """Vertices and bulges of the biarcs, one after the other."""
    z = np.append(np.stack([p0, joint], axis=1).ravel(), p1[-1])
    first, second = _bulge(joint - p0, t0), -_bulge(joint - p1, -t1)
    return z, np.stack([first, second], axis=1).ravel()


def _merge(z: Complex, bulge: Real) -> Chain:
    """One arc for each sequence of arcs of the same circle, up to half a turn."""
    chord, sweep = np.diff(z), 4 * np.arctan(bulge)
    length = np.abs(chord) / np.sinc(sweep / (2 * np.pi))
    keep, total, arc_length = [0], sweep[0], length[0]
    for k in range(1, len(bulge)):
        same = abs(sweep[k] / length[k] - total / arc_length) * (length[k] + arc_length) < SAME_ARC
        if same and abs(total + sweep[k]) <= np.pi + SAME_ARC:
            total, arc_length = total + sweep[k], arc_length + length[k]
        else:
            keep.append(k)
            total, arc_length = sweep[k], length[k]
    ends = np.append(keep, len(bulge))
    sums = np.add.reduceat(sweep, keep)
    # A sweep of rounding is a straight edge; as an arc its radius would be too large for any reader.
    return z[ends], np.tan(np.where(np.abs(sums) < 1e-12, 0.0, sums) / 4)


def _biarc_judge(curve: AbstractCurve) -> Judge:
    def judge(intervals: Intervals) -> tuple[Real, Real]:
        low, high, first = intervals
        p0, p1, joint, t0, t1 = (a[:, None] for a in _biarcs(curve, low, high))
        inside = probes(low, high, ARC_SHARES)
        z = curve.point(inside)
        # Direction at the joint: the first tangent mirrored in the first arc's chord.
        middle = t0.conj() * unit(joint - p0) ** 2
        in_first = dot(middle, z - joint) < 0
        distance = np.where(in_first, _off_arc(z, p0, t0, joint), _off_arc(z, p1, -t1, joint))
        v = curve.velocity(inside)
        # If no biarc exists (its tangents face each other) the error is the length of the chord.
        distance = np.where(np.isfinite(distance), distance, np.abs(p1 - p0) + np.abs(z - p0))
        return tops(distance, z, first), turns(v)

    return judge


def _off_arc(z: Complex, start: Complex, tangent: Complex, end: Complex) -> Real:
    """Distance of points from the circle that leaves `start` along `tangent` and passes through `end`.

    Written with the curvature, so that a circle as flat as a line keeps its digits.
    """
    w = (end - start) * np.conj(tangent)
    with np.errstate(divide="ignore", invalid="ignore"):
        curvature = 2 * w.imag / np.abs(w) ** 2
    q = (z - start) * np.conj(tangent)
    distance: Real = np.abs(curvature * np.abs(q) ** 2 - 2 * q.imag) / (1 + np.abs(curvature * q - 1j))
    return distance


# Largest rotation of the tangent between two pieces that join smoothly, rad. Kernels merge normals to about 1e-4.
SMOOTH = 1e-5
# Largest distance, as a share of the curve's size, of a piece from the line or the circle that it is, and relative
# difference of curvatures of one circle.
EXACT, SAME_CURVATURE = 1e-10, 1e-7
# Positions within a piece at which it is compared with a line, a circle or a cubic.
PIECE_SHARES = np.linspace(0, 1, 9)
# Nodes and weights of Gauss's rule for lengths, from 0 to 1.
NODES, WEIGHTS = (np.polynomial.legendre.leggauss(12)[0] + 1) / 2, np.polynomial.legendre.leggauss(12)[1] / 2
# Numbers of cubics that are tried for a smooth piece; no curve within the limits of files needs more.
COUNTS = (1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 256, 512, 1024, 4096)


@record(eq=False)
class SmoothPiece:
    """A piece of a closed curve from its `start`, mm; it ends at the start of the next one.

    bulge: tangent of a quarter of the sweep of an arc, 0 for a line. controls, knots: of a cubic B-spline whose
    inner knots are double, its control points, mm, with both ends, and its knots, lengths along it, mm; else empty.
    """

    start: complex
    bulge: float = 0.0
    controls: Complex = field(default_factory=lambda: np.zeros(0, dtype=complex))
    knots: Real = field(default_factory=lambda: np.zeros(0))


def smooth_pieces(
    curve: AbstractCurve, tolerance: float, is_hole: bool, digits: int, splines_only: bool = False
) -> list[SmoothPiece]:
    """The fewest smooth pieces of a closed curve, at least two, with the material on their left.

    Lines and circles stay exact. Other pieces that join with one tangent become one B-spline within `tolerance`, mm,
    unless the sign of the curvature changes where they join, as from the flank of a tooth to its fillet; an arc between
    two fillets is part of their piece. splines_only: arcs and lines too become B-splines. Points have so many `digits`.
    """
    segments = _Segments(curve)
    groups, pieces = segments.groups(), list[SmoothPiece]()
    if len(groups) == 1:
        groups = [groups[0][: len(groups[0]) // 2], groups[0][len(groups[0]) // 2 :]]
    for group in groups:
        is_spline = splines_only or segments.is_spline[group[0]]
        pieces += [segments.spline(group, tolerance)] if is_spline else segments.arcs(group)
    if (signed_area(curve, 1e-3) > 0) == is_hole:
        # Each piece then starts where the one before it, the next one now, started.
        starts = [piece.start for piece in pieces]
        pieces = [
            SmoothPiece(start, -piece.bulge, piece.controls[::-1], (piece.knots[-1:] - piece.knots)[::-1])
            for piece, start in zip(pieces, [*starts[1:], starts[0]])
        ][::-1]
    starts = [rounded(np.asarray(piece.start), digits).item() for piece in pieces]
    closed = []
    for piece, start, end in zip(pieces, starts, [*starts[1:], starts[0]]):
        controls = rounded(piece.controls, digits)
        if len(controls):
            controls[0], controls[-1] = start, end
        closed.append(SmoothPiece(start, piece.bulge, controls, piece.knots))
    return closed


class _Segments:
    """The parts of a curve between its breaks: whether they are lines or arcs, and whether they join smoothly."""

    def __init__(self, curve: AbstractCurve) -> None:
        # Copies of a piece around an axis are equal, so one is enough.
        self.curve, turns = (curve.piece, curve.turns) if isinstance(curve, PolarArray) else (curve, np.ones(1))
        b = self.curve.breaks
        if len(b) == 2 or isinstance(curve, Circle):
            # A single segment that ends at its own start has no chord.
            b = np.linspace(b[0], b[-1], 3)
        points = self.curve.point(b[:-1, None] + np.diff(b)[:, None] * PIECE_SHARES)
        self.size = float(np.abs(points - points[0, 0]).max())
        is_long = np.abs(np.diff(points, axis=1)).sum(axis=1) > EXACT * self.size
        self.low, self.high, points = b[:-1][is_long], b[1:][is_long], points[is_long]
        # At the end of a segment a curve may be on the next one already.
        points[:, -1] = np.append(points[1:, 0], points[0, 0] * turns[1 % len(turns)])
        self.period = len(points)
        self.known: dict[int, tuple[Complex, Real]] = {}
        self.lengths = np.tile(self._length(self.low, self.high), len(turns))
        self.turns = np.repeat(turns, self.period)
        first, last = (self._tangent(ends, middle) for ends, middle in ((self.low, self.high), (self.high, self.low)))
        self.first, self.last = (np.tile(tangents, len(turns)) * self.turns for tangents in (first, last))
        self.starts = np.tile(points[:, 0], len(turns)) * self.turns
        self.ends = np.roll(self.starts, -1)
        # Whether each segment continues the one before it without a corner.
        self.is_smooth: Mask = np.abs(np.angle(self.first / np.roll(self.last, 1))) < SMOOTH
        steps = np.diff(points, axis=1)
        bends = np.angle(steps[:, 1:] / steps[:, :-1])
        signs = np.sign(np.where(np.abs(bends) < SAME_CURVATURE, 0.0, bends))
        self.sign_at_start, self.sign_at_end = (np.tile(signs[:, k], len(turns)) for k in (0, -1))
        # The circle that leaves the start along the tangent and passes through the end; a line has the curvature 0.
        chord = (points[:, -1] - points[:, 0]) / first
        curvature = 2 * chord.imag / np.abs(chord) ** 2
        curvature = np.where(np.abs(curvature) * self.size < SAME_CURVATURE, 0.0, curvature)
        q = (points - points[:, :1]) / first[:, None]
        bend = curvature[:, None]
        off = np.abs(bend * np.abs(q) ** 2 - 2 * q.imag) / (1 + np.abs(bend * q - 1j))
        is_exact = off.max(axis=1) < EXACT * self.size
        self.curvature = np.tile(curvature, len(turns))
        self.is_spline: Mask = np.tile(~is_exact, len(turns))

    def _tangent(self, at: Real, other: Real) -> Complex:
        """Unit tangents at ends of segments, slightly inside them: at a break a curve may be on its next piece."""
        inward = np.sign(other - at) * np.maximum(1e-11 * np.abs(other - at), 64 * np.spacing(np.abs(at)))
        return unit(self.curve.velocity(at + inward))

    def groups(self) -> list[list[int]]:
        """Indices of the segments of each piece, in order."""
        before = np.roll(np.arange(len(self.starts)), 1)
        is_flip = self.sign_at_end[before] * self.sign_at_start < 0
        is_circle = np.abs(self.curvature - self.curvature[before]) * self.size < SAME_CURVATURE
        spline = self.is_spline
        joins = self.is_smooth & np.where(spline, spline[before] & ~is_flip, ~spline[before] & is_circle)
        groups: list[list[int]] = []
        for k in np.roll(np.arange(len(joins)), -int(np.argmin(joins))).tolist():
            if joins[k] and groups:
                groups[-1].append(k)
            else:
                groups.append([k])
        between = [
            self._is_between_fillets(groups[k - 1], group, groups[(k + 1) % len(groups)])
            for k, group in enumerate(groups)
        ]
        first = next((k for k in range(len(groups)) if not between[k] and not between[k - 1]), 0)
        merged: list[list[int]] = []
        for k in (*range(first, len(groups)), *range(first)):
            if merged and (between[k] or between[k - 1]):
                merged[-1] += groups[k]
            else:
                merged.append(groups[k])
        return merged

    def _is_between_fillets(self, before: Sequence[int], arc: Sequence[int], after: Sequence[int]) -> bool:
        """Whether an arc joins two splines smoothly that curve the other way, as the root between two fillets."""
        is_spline = self.is_spline[[before[0], arc[0], after[0]]].tolist()
        sign = np.sign(self.curvature[arc[0]])
        is_opposite = self.sign_at_end[before[-1]] * sign < 0 and self.sign_at_start[after[0]] * sign < 0
        is_smooth = self.is_smooth[arc[0]] and self.is_smooth[after[0]]
        return bool(is_spline == [True, False, True] and is_opposite and is_smooth)

    def arcs(self, group: Sequence[int]) -> list[SmoothPiece]:
        """A line, or an arc in pieces of at most half a turn."""
        start, curvature = complex(self.starts[group[0]]), float(self.curvature[group[0]])
        if curvature == 0:
            return [SmoothPiece(start)]
        sweep = curvature * float(self.lengths[list(group)].sum())
        count = max(1, int(np.ceil(abs(sweep) / np.pi - 1e-9)))
        centre = start + 1j * complex(self.first[group[0]]) / curvature
        places = centre + (start - centre) * np.exp(1j * sweep * np.arange(count) / count)
        return [SmoothPiece(place, float(np.tan(sweep / count / 4))) for place in places.tolist()]

    def spline(self, group: Sequence[int], tolerance: float) -> SmoothPiece:
        """The B-spline through consecutive segments, each as the fewest cubics that keep the tolerance."""
        controls, knots = [self.starts[group[:1]]], [0.0]
        for k in group:
            inner, lengths = self._fewest(k % self.period, tolerance)
            controls.append(inner * self.turns[k])
            knots += (knots[-1] + np.cumsum(lengths)).tolist()
        controls.append(self.ends[list(group[-1:])])
        return SmoothPiece(complex(self.starts[group[0]]), 0.0, np.concatenate(controls), np.array(knots))

    def _fewest(self, k: int, tolerance: float) -> tuple[Complex, Real]:
        """Inner control points and lengths of the fewest cubics for a segment of the first copy."""
        if k not in self.known:
            for count in COUNTS:
                inner, lengths, error = self._cubics(k, count)
                if error <= tolerance:
                    break
            else:
                problem = f"a curve of {mm(self.lengths[k]):.4g} needs more than {COUNTS[-1]} cubics"
                raise DesignError("tolerance", problem, "give a larger tolerance", "too-much-work")
            self.known[k] = inner, lengths
        return self.known[k]

    def _cubics(self, k: int, count: int) -> tuple[Complex, Real, float]:
        """Inner control points of equal parts of a segment, their lengths, mm, and their largest error, mm.

        Each cubic has the length along the curve as its parameter, so that the next one continues it with its tangent.
        """
        t = np.linspace(self.low[k], self.high[k], count + 1)
        points = np.append(self.curve.point(t[:-1]), self.ends[k])
        middle = unit(self.curve.velocity(t[1:-1]))
        tangents = np.concatenate([self.first[k : k + 1], middle, self.last[k : k + 1]])
        lengths = self._length(t[:-1], t[1:])
        a = points[:-1] + tangents[:-1] * lengths / 3
        b = points[1:] - tangents[1:] * lengths / 3
        probes = t[:-1, None] + np.diff(t)[:, None] * PIECE_SHARES[1:-1]
        s = self._length(np.broadcast_to(t[:-1, None], probes.shape), probes) / lengths[:, None]
        weights = np.stack([(1 - s) ** 3, 3 * (1 - s) ** 2 * s, 3 * (1 - s) * s**2, s**3])
        cubic = (np.stack([points[:-1], a, b, points[1:]])[..., None] * weights).sum(axis=0)
        error = float(np.abs(cubic - self.curve.point(probes)).max())
        inner: Complex = np.stack([a, b], axis=1, dtype=complex).ravel()
        return inner, lengths, error

    def _length(self, low: Real, high: Real) -> Real:
        """Length of the curve between two parameters of one segment, mm."""
        speed = np.abs(self.curve.velocity(low[..., None] + (high - low)[..., None] * NODES))
        length: Real = (high - low) * (speed @ WEIGHTS)
        return length
