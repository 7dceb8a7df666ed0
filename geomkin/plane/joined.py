"""Curves made of pieces: a path of pieces end to end, a polar array of equal copies, a smooth curve through points."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from functools import cached_property
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..core.arguments import ComplexRow, PositiveInt
from ..core.errors import DesignError
from ..core.records import record
from ..core.units import mm
from .curve import AbstractCurve, Mirrored, Reversed, curvature_from_derivatives
from .vec import Complex, Real, Whole, spaced_directions

# Largest distance between the ends of neighbouring pieces, as a share of their distance from the origin.
GAP = 1e-9
# Shares of a curve's parameter range at which `_start_middle_end` takes points.
_SHARES = np.array([0.0, 0.5, 1.0])
Number = TypeVar("Number", np.complex128, np.float64)


@record(checked=True, eq=False)
class Path(AbstractCurve):
    """Pieces end to end; piece k runs over k <= t <= k + 1, whatever its own parameter.

    Parameters
    ----------
    pieces : tuple of AbstractCurve
        At least one; each starts where the previous one ends.

    Raises
    ------
    DesignError
        If there is a gap between two pieces; gives its number and length.
    """

    pieces: tuple[AbstractCurve, ...]

    def __post_init__(self) -> None:
        if not len(self.pieces):
            raise DesignError("pieces", "found none", "give at least one", "out-of-range")
        gaps = np.abs(self._samples[1:, 0] - self._samples[:-1, 2])
        if len(gaps) and gaps.max() > self._rounding:
            worst = int(gaps.argmax())
            problem = f"piece {worst} ends {mm(gaps[worst]):.3g} from the start of the next"
            raise DesignError("pieces", problem, "give pieces that join end to end")

    @cached_property
    def _samples(self) -> Complex:
        """Start, middle and end of each piece, (n, 3)."""
        return np.array([_start_middle_end(piece) for piece in self.pieces])

    @property
    def _rounding(self) -> float:
        """Largest distance between ends, mm, that counts as rounding."""
        return float(GAP * np.abs(self._samples).max())

    @cached_property
    def breaks(self) -> Real:
        breaks = [0.0]
        for k, piece in enumerate(self.pieces):
            b = piece.breaks
            breaks += [k + 1.0] if len(b) == 2 else (k + (b[1:] - b[0]) / (b[-1] - b[0])).tolist()
        return np.array(breaks)

    @cached_property
    def closed(self) -> bool:
        return bool(abs(self._samples[-1, 2] - self._samples[0, 0]) <= self._rounding)

    def point(self, t: ArrayLike) -> Complex:
        return self._each(t, lambda piece, s, span: piece.point(s), np.complex128)

    def velocity(self, t: ArrayLike) -> Complex:
        return self._each(t, lambda piece, s, span: piece.velocity(s) * span, np.complex128)

    def curvature(self, t: ArrayLike) -> Real:
        return self._each(t, lambda piece, s, span: piece.curvature(s), np.float64)

    def _each(
        self, t: ArrayLike, value: Callable[[AbstractCurve, Real, float], Complex | Real], dtype: type[Number]
    ) -> NDArray[Number]:
        """The values of each piece at its own parameters; its range is `span`, that of t is 1."""
        t = np.asarray(t, dtype=float)
        out = np.empty(t.shape, dtype)
        if not t.size:
            return out
        flat, places, (inner, firsts, lasts) = out.ravel(), t.ravel(), self._ends
        which: Whole = inner.searchsorted(places, side="right")
        # Most calls have rising parameters, of which each piece has a contiguous part.
        rising = bool((which[1:] >= which[:-1]).all())
        least: int = int(which[0] if rising else which.min())
        most: int = int(which[-1] if rising else which.max())
        if least == most:
            s, (breaks, first, last, rounding) = t - least, self._domains[least]
            s = first * (1 - s) + last * s
            s = np.minimum(np.maximum(s, first), last) if breaks is None else _at_breaks(s, breaks, rounding)
            out[...] = value(self.pieces[least], s, last - first)
            return out
        # All parameters of a piece in one call, since calls are expensive.
        share, first_of, last_of = places - which, firsts[which], lasts[which]
        local = first_of * (1 - share) + last_of * share
        inside = np.minimum(np.maximum(local, first_of), last_of)
        masks: Iterable[Any]
        if rising:
            ends = [0, *which.searchsorted(range(least + 1, most + 1)).tolist(), t.size]
            masks = map(slice, ends, ends[1:])
        else:
            masks = (which == k for k in range(least, most + 1))
        for k, mask in enumerate(masks, least):
            breaks, first, last, rounding = self._domains[k]
            s = inside[mask] if breaks is None else _at_breaks(local[mask], breaks, rounding)
            if s.size:
                flat[mask] = value(self.pieces[k], s, last - first)
        return out

    @cached_property
    def _domains(self) -> list[tuple[Real | None, float, float, float]]:
        """For each piece its breaks if it has inner ones, the first and the last, and the rounding of t."""
        domains: list[tuple[Real | None, float, float, float]] = []
        for k, b in enumerate(piece.breaks for piece in self.pieces):
            first, last = float(b[0]), float(b[-1])
            domains.append((b if len(b) > 2 else None, first, last, (last - first) * math.ulp(k + 1.0)))
        return domains

    @cached_property
    def _ends(self) -> tuple[Real, Real, Real]:
        """Parameters at which pieces meet; the first and the last of each piece's own parameters."""
        _, first, last, _ = zip(*self._domains)
        return np.arange(1.0, len(self.pieces)), np.array(first), np.array(last)


@record(checked=True, eq=False)
class PolarArray(AbstractCurve):
    """Equal copies of a piece around the origin, each turned by one count-th of a turn more; closed.

    Each copy takes the same range of t as the piece, from t = 0. The copies are equal to the last bit.

    Parameters
    ----------
    piece : AbstractCurve
        It must end where its next copy starts.
    count : int
        Number of copies; above 0.

    Raises
    ------
    DesignError
        If there is a gap between two copies.
    """

    piece: AbstractCurve
    count: PositiveInt

    def __post_init__(self) -> None:
        start, _, end = _start_middle_end(self.piece).tolist()
        gap = abs(end - start * self.turns[1 % self.count])
        if gap > GAP * abs(start):
            raise DesignError("piece", f"it ends {mm(gap):.3g} from the start of its next copy", "close the gap")

    @cached_property
    def turns(self) -> Complex:
        """Direction of each copy, unit complex, (count,)."""
        turns: Complex = spaced_directions(self.count)
        return turns

    @cached_property
    def breaks(self) -> Real:
        b = self.piece.breaks - self.piece.breaks[0]
        return np.append((np.arange(self.count)[:, None] * b[-1] + b[:-1]).ravel(), self.count * b[-1])

    closed = True

    def point(self, t: ArrayLike) -> Complex:
        copy, s = self._local(t)
        return self.piece.point(s) * self.turns[copy]

    def velocity(self, t: ArrayLike) -> Complex:
        copy, s = self._local(t)
        return self.piece.velocity(s) * self.turns[copy]

    def curvature(self, t: ArrayLike) -> Real:
        return self.piece.curvature(self._local(t)[1])

    def _local(self, t: ArrayLike) -> tuple[Whole, Real]:
        t = np.asarray(t, dtype=float)
        span = self.piece.breaks[-1] - self.piece.breaks[0]
        # At a break between copies the quotient may be below the whole number by rounding.
        copy = np.clip(np.floor(t / span * (1 + 4e-16)), 0, self.count - 1).astype(int)
        return copy, _at_breaks(
            self.piece.breaks[0] + (t - copy * span), self.piece.breaks, np.spacing(self.count * span)
        )


def _start_middle_end(curve: AbstractCurve) -> Complex:
    """The points of a curve at the start, the middle and the end of its parameter, (3,); those of a path are cached."""
    match curve:
        case Path():
            samples, half = curve._samples, len(curve.pieces) / 2
            return np.array([samples[0, 0], samples[int(half), int(half % 1 > 0)], samples[-1, 2]])
        case Mirrored():
            return -np.conj(_start_middle_end(curve.curve))
        case Reversed():
            return _start_middle_end(curve.curve)[::-1]
    return curve.point(curve.breaks[0] * (1 - _SHARES) + curve.breaks[-1] * _SHARES)


def _at_breaks(t: Real, breaks: Real, rounding: float) -> Real:
    """Parameters, with those near an inner break moved onto it, so that rounding does not select the wrong piece."""
    if len(breaks) == 2:
        inside: Real = np.minimum(np.maximum(t, breaks[0]), breaks[1])
        return inside
    k = np.minimum(np.maximum(breaks.searchsorted(t), 1), len(breaks) - 1)
    k = k - (t - breaks[k - 1] < breaks[k] - t)
    return np.where(np.abs(t - breaks[k]) <= 8 * rounding, breaks[k], t)


@record(checked=True, eq=False)
class Spline(AbstractCurve):
    """Cubic spline through given points: open, with continuous curvature.

    t is the length along the chords from the first point, mm, so that points may be unevenly spaced. Between points of
    a smooth curve its error is of the fourth power of their distance.

    Parameters
    ----------
    points : array of complex, shape (n,)
        mm; at least two.

    Raises
    ------
    DesignError
        If there are fewer than two points, or two neighbours coincide.

    Notes
    -----
    At both ends the first two pieces are one cubic ("not a knot": de Boor, A Practical Guide to Splines,
    chapter IV), which assumes nothing about the ends: three points give a parabola, two a straight line.
    """

    points: ComplexRow

    def __post_init__(self) -> None:
        z = np.asarray(self.points)
        if len(z) < 2:
            raise DesignError("points", "found fewer than two points", "give a list of at least two", "out-of-range")
        steps = np.abs(np.diff(z))
        if steps.min() <= 1e-12 * np.abs(z).max():
            k = int(steps.argmin())
            raise DesignError("points", f"points {k + 1} and {k + 2} coincide", "omit one of them", "conflict")

    @cached_property
    def breaks(self) -> Real:
        return np.concatenate([[0.0], np.cumsum(np.abs(np.diff(self.points)))])

    closed = False

    def point(self, t: ArrayLike) -> Complex:
        u, a, b, c, d = self._local(t)
        return a + u * (b + u * (c + u * d))

    def velocity(self, t: ArrayLike) -> Complex:
        u, _, b, c, d = self._local(t)
        return b + u * (2 * c + u * 3 * d)

    def acceleration(self, t: ArrayLike) -> Complex:
        """Second derivative d2P/dt2, 1/mm; continuous."""
        u, _, _, c, d = self._local(t)
        return 2 * c + 6 * u * d

    def curvature(self, t: ArrayLike) -> Real:
        return curvature_from_derivatives(self.velocity(t), self.acceleration(t))

    def _local(self, t: ArrayLike) -> tuple[Real, Complex, Complex, Complex, Complex]:
        """Distance past the knot, mm, and the coefficients of its powers there."""
        t = np.asarray(t, dtype=float)
        k = np.clip(np.searchsorted(self.breaks, t, side="right") - 1, 0, len(self.breaks) - 2)
        a, b, c, d = self._coefficients
        return t - self.breaks[k], a[k], b[k], c[k], d[k]

    @cached_property
    def _coefficients(self) -> Complex:
        """Coefficients (4, n - 1) of the powers of t - knot."""
        h: Real = np.diff(self.breaks)
        z: Complex = np.asarray(self.points, dtype=complex)
        slope = np.diff(z) / h
        v = _slopes(h, slope)
        c = (3 * slope - 2 * v[:-1] - v[1:]) / h
        return np.array([z[:-1], v[:-1], c, (v[:-1] + v[1:] - 2 * slope) / h**2])


def _slopes(h: Real, slope: Complex) -> Complex:
    """Velocities (n,) at the knots from the widths and mean velocities (n - 1,) between them.

    Each inner row makes the acceleration continuous, the two end rows the third derivative at the knots next to the
    ends; solved by elimination along the three diagonals.
    """
    n = len(h) + 1
    if n == 2:
        return np.array([slope[0], slope[0]])
    if n == 3:
        half = (slope[1] - slope[0]) / (h[0] + h[1])
        return np.array([slope[0] - h[0] * half, slope[0] + h[0] * half, slope[1] + h[1] * half])
    below, diagonal, above = np.zeros(n), np.zeros(n), np.zeros(n)
    right: Complex = np.zeros(n, dtype=complex)
    below[1:-1], diagonal[1:-1], above[1:-1] = h[1:], 2 * (h[:-1] + h[1:]), h[:-1]
    right[1:-1] = 3 * (h[1:] * slope[:-1] + h[:-1] * slope[1:])
    diagonal[0], above[0], right[0] = _end_row(h[0], h[1], slope[0], slope[1])
    diagonal[-1], below[-1], right[-1] = _end_row(h[-1], h[-2], slope[-1], slope[-2])
    for k in range(1, n):
        factor = below[k] / diagonal[k - 1]
        diagonal[k] -= factor * above[k - 1]
        right[k] -= factor * right[k - 1]
    v = right / diagonal
    for k in range(n - 2, -1, -1):
        v[k] = (right[k] - above[k] * v[k + 1]) / diagonal[k]
    return v


def _end_row(h0: float, h1: float, s0: complex, s1: complex) -> tuple[float, float, complex]:
    """The end knot's row with the knot beyond the next one eliminated."""
    return h1, h0 + h1, ((h0 + 2 * (h0 + h1)) * h1 * s0 + h0**2 * s1) / (h0 + h1)
