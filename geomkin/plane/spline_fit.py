"""Closed curves as few smooth pieces, as CAD programs have them: straight edges, circular arcs and cubic B-splines."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field

import numpy as np

from ..core.errors import DesignError
from ..core.records import record
from ..core.units import mm
from .curve import AbstractCurve
from .joined import PolarArray
from .measure import signed_area
from .primitives import Circle
from .vec import Complex, Mask, Real, rounded, unit

# Largest rotation of the tangent between two pieces that join smoothly, rad. Kernels merge normals to about 1e-4.
SMOOTH = 1e-5
# Largest distance, as a share of the curve's size, of a piece from the line or the circle that it is, and relative
# difference of curvatures of one circle.
EXACT, SAME = 1e-10, 1e-7
# Positions within a piece at which it is compared with a line, a circle or a cubic.
SHARES = np.linspace(0, 1, 9)
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
        points = self.curve.point(b[:-1, None] + np.diff(b)[:, None] * SHARES)
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
        signs = np.sign(np.where(np.abs(bends) < SAME, 0.0, bends))
        self.sign_at_start, self.sign_at_end = (np.tile(signs[:, k], len(turns)) for k in (0, -1))
        # The circle that leaves the start along the tangent and passes through the end; a line has the curvature 0.
        chord = (points[:, -1] - points[:, 0]) / first
        curvature = 2 * chord.imag / np.abs(chord) ** 2
        curvature = np.where(np.abs(curvature) * self.size < SAME, 0.0, curvature)
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
        is_circle = np.abs(self.curvature - self.curvature[before]) * self.size < SAME
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
        probes = t[:-1, None] + np.diff(t)[:, None] * SHARES[1:-1]
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
