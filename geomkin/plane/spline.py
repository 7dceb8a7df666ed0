"""A smooth curve through given points."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ..core.arguments import ComplexRow
from ..core.errors import DesignError
from ..core.records import record
from .curve import AbstractCurve, curvature_from_derivatives
from .vec import Complex, Real


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

    @property
    def closed(self) -> bool:
        return False

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
        return np.array(
            [
                slope[0] - h[0] * half,
                slope[0] + h[0] * half,
                slope[1] + h[1] * half,
            ]
        )
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
