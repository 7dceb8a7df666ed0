"""Laws that are polynomials: one from conditions at its ends and between, or a spline through given values."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike

from ...errors import DesignError
from ...plane.vec import Real, Whole

# Conditions whose equations multiply rounding by more than this do not settle the polynomial: a slope without its
# lift, or so many places between that it swings far beyond them. Larger lets such polynomials pass, smaller refuses
# sound ones of a high degree.
WORST = 1e10
# Slope and curvature at the start and at the end, by x; None for a spline that closes on itself.
Ends = tuple[tuple[float, float], tuple[float, float]] | None


@dataclass(frozen=True, eq=False)
class ChebyshevLaw:
    """A law as one polynomial. rows (degree + 1, 4): Chebyshev coefficients over 0 <= x <= 1 of f, f', f'', f'''.

    Chebyshev's and not plain powers: at degree 15 those lose half their digits.
    """

    rows: Real

    def __call__(self, x: Real) -> Real:
        return np.asarray(chebyshev.chebval(2 * x - 1, self.rows), dtype=float)


def chebyshev_law(series: Sequence[Real]) -> ChebyshevLaw:
    """The law from the Chebyshev coefficients of f and its three derivatives over 0 <= x <= 1."""
    rows = np.zeros((len(series[0]), 4))
    for k, coefficients in enumerate(series):
        rows[: len(coefficients), k] = coefficients
    return ChebyshevLaw(rows)


def derive(coefficients: Real, order: int) -> Real:
    """Chebyshev coefficients of a derivative by x, of each column by itself."""
    # x runs from 0 to 1 and a Chebyshev polynomial's own variable from -1 to 1.
    return chebyshev.chebder(coefficients, order, scl=2) if order else coefficients


def condition_row(x: ArrayLike, order: int, degree: int) -> Real:
    """What each Chebyshev polynomial to `degree` adds to the derivative of that order at x (...): (degree + 1, ...)."""
    return chebyshev.chebval(2 * np.asarray(x) - 1, derive(np.eye(degree + 1), order))


def polynomial_from(conditions: Sequence[tuple[float, int, float]]) -> ChebyshevLaw:
    """The polynomial of least degree that meets conditions (x, order of the derivative, its value by x)."""
    degree = len(conditions) - 1
    rows = np.array([condition_row(x, order, degree) for x, order, _ in conditions])
    # Scaled, since a row of the third derivative is thousands of times one of the value.
    size = np.abs(rows).max(axis=1)
    if not size.all() or np.linalg.cond(rows / size[:, None]) > WORST:
        raise DesignError(
            "",
            "its conditions do not settle one polynomial",
            "give the lower derivatives before the higher ones, or fewer places between",
        )
    f = np.linalg.solve(rows / size[:, None], np.array([v for _, _, v in conditions]) / size)
    return chebyshev_law([derive(f, k) for k in range(4)])


@dataclass(frozen=True, eq=False)
class PiecewisePolynomial:
    """A law in polynomial pieces. knots (n + 1,) over x; coefficients (degree + 1, n) of the powers of x - knot.

    breaks: those places of x, 0 and 1 among them, where a derivative up to the third may jump.
    """

    knots: Real
    coefficients: Real
    breaks: Real

    def __call__(self, x: Real) -> Real:
        piece = np.clip(np.searchsorted(self.knots, x, side="right") - 1, 0, len(self.knots) - 2)
        u = x - self.knots[piece]
        value: Real = np.zeros((4, *np.shape(x)))
        for coefficient in self.coefficients[::-1]:
            # Horner for the Taylor coefficients, f^(k) / k!.
            value[1:] = value[1:] * u + value[:-1]
            value[0] = value[0] * u + coefficient[piece]
        factorials: Real = np.array([1.0, 1, 2, 6]).reshape(4, *[1] * np.ndim(x))
        return value * factorials


def spline_through(x: Real, values: Real, ends: Ends) -> PiecewisePolynomial:
    """Quintic spline through values (n + 1,) at rising x (n + 1,) from 0 to 1, with the slopes and curvatures `ends`.

    Of all curves through the values and ends the one with the least integral of squared jerk. The
    jerk and its slope are continuous, so it has no breaks inside. Closed (ends None), it needs equal
    first and last values.
    """
    return PiecewisePolynomial(x, _quintic(x, values[:, None], ends)[..., 0], np.array([0.0, 1.0]))


def _times(a: Real, b: Real) -> Real:
    """Products of 2 x 2 matrices with matrices of two rows, in a fixed order."""
    return a[..., :1] * b[..., :1, :] + a[..., 1:] * b[..., 1:, :]


def _inverse(a: Real) -> Real:
    """Of a 2 x 2 matrix."""
    (p, q), (r, s) = a.tolist()
    return np.array([[s, -q], [-r, p]]) / float(p * s - q * r)


def _quintic(knots: Real, values: Real, ends: Ends) -> Real:
    """Coefficients (6, n, columns) of quintic splines through values (n + 1, columns).

    Unknown at each knot are slope and curvature; third and fourth derivatives on both sides of it
    must agree, which links it to its neighbours: block-tridiagonal, solved from knot 1 to knot n - 1
    for any state of knots 0 and n, which the ends then settle.
    """
    n, columns = len(knots) - 1, values.shape[1]
    scale = n / (knots[-1] - knots[0])  # intervals of about 1 keep the equations' numbers alike
    width = np.diff(knots) * scale
    step = np.diff(values, axis=0)
    # State of each knot as columns for the values, then two for the state of knot 0 and two for that of knot n.
    first, last = columns, columns + 2
    state = np.zeros((n + 1, 2, columns + 4))
    state[0, :, first : first + 2] = state[n, :, last : last + 2] = np.eye(2)
    before, here, after, right = _links(width, step, np.arange(1, n))
    right = np.concatenate([right, np.zeros((n - 1, 2, 4))], axis=2)
    if n > 1:
        right[0] -= _times(before[0], state[0])
        right[-1] -= _times(after[-1], state[n])
    for i in range(1, n - 1):
        factor = _times(before[i], _inverse(here[i - 1]))
        here[i] -= _times(factor, after[i - 1])
        right[i] -= _times(factor, right[i - 1])
    for i in range(n - 2, -1, -1):
        rest = right[i] - _times(after[i], state[i + 2]) if i < n - 2 else right[i]
        state[i + 1] = _times(_inverse(here[i]), rest)
    if ends is None:
        before, here, after, right = _links(width, step, np.array([0]))
        around = _times(before[0], state[n - 1]) + _times(here[0], state[0]) + _times(after[0], state[1])
        around_ends = around[:, first : first + 2] + around[:, last : last + 2]
        start = end = _times(_inverse(around_ends), right[0] - around[:, :columns])
    else:
        # Slopes and curvatures by the scaled x.
        start, end = (np.array([[v / scale], [a / scale**2]]) * np.ones(columns) for v, a in ends)
    state = (
        state[..., :columns] + _times(state[..., first : first + 2], start) + _times(state[..., last : last + 2], end)
    )
    v0, a0, v1, a1 = state[:-1, 0], state[:-1, 1], state[1:, 0], state[1:, 1]
    h = width[:, None]
    v0h, v1h, a0h, a1h = v0 * h, v1 * h, a0 * h**2 / 2, a1 * h**2 / 2
    powers = [
        values[:-1],
        v0h,
        a0h,
        10 * step - 6 * v0h - 4 * v1h - 3 * a0h + a1h,
        -15 * step + 8 * v0h + 7 * v1h + 3 * a0h - 2 * a1h,
        6 * step - 3 * (v0h + v1h) - a0h + a1h,
    ]
    return np.array([p / (h / scale) ** k for k, p in enumerate(powers)])


def _links(width: Real, step: Real, i: Whole) -> tuple[Real, Real, Real, Real]:
    """What knots i ask of the states before, at and after them, (len(i), 2, 2) each, and the right side."""
    h, g = width[i - 1][:, None], width[i][:, None]
    third = [-24 / h**2, -3 / h, 36 / g**2 - 36 / h**2, 9 / h + 9 / g, 24 / g**2, -3 / g]
    fourth = [-168 / h**3, -24 / h**2, -192 / h**3 - 192 / g**3, 36 / h**2 - 36 / g**2, -168 / g**3, 24 / g**2]
    rows = np.stack([np.concatenate(third, axis=1), np.concatenate(fourth, axis=1)], axis=1)
    rises, falls = step[i] / g**3, step[i - 1] / h**3
    right = np.stack([60 * (rises - falls), -360 * (rises / g + falls / h)], axis=1)
    return rows[:, :, :2], rows[:, :, 2:4], rows[:, :, 4:], right
