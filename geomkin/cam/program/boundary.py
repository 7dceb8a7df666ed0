"""Polynomials of lift from conditions at both ends and at places between."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike

from ...errors import DesignError
from ...plane.vec import Array


@dataclass(frozen=True, eq=False)
class ChebyshevLaw:
    """A law as one polynomial. rows (degree + 1, 4): Chebyshev coefficients over 0 <= x <= 1 of f, f', f'', f'''.

    Chebyshev's and not plain powers: at degree 15 those lose half their digits.
    """

    rows: Array

    def __call__(self, x: Array) -> Array:
        return chebyshev.chebval(2 * x - 1, self.rows)


def chebyshev_law(series: Sequence[Array]) -> ChebyshevLaw:
    """The law from the Chebyshev coefficients of f and its three derivatives over 0 <= x <= 1."""
    rows = np.zeros((len(series[0]), 4))
    for k, coefficients in enumerate(series):
        rows[: len(coefficients), k] = coefficients
    return ChebyshevLaw(rows)


def derive(coefficients: Array, order: int) -> Array:
    """Chebyshev coefficients of a derivative by x; columns are taken one by one."""
    # x runs from 0 to 1 and a Chebyshev polynomial's own variable from -1 to 1.
    return chebyshev.chebder(coefficients, order, scl=2) if order else coefficients


def condition_row(x: ArrayLike, order: int, degree: int) -> Array:
    """What each Chebyshev polynomial to `degree` adds to the derivative of that order at x (...): (degree + 1, ...)."""
    return chebyshev.chebval(2 * np.asarray(x) - 1, derive(np.eye(degree + 1), order))


# Conditions whose equations lose more than this factor of digits do not settle the polynomial: a slope
# without its lift, or as many places between as let it swing to the moon.
WORST = 1e10


def polynomial_from(conditions: Sequence[tuple[float, int, float]]) -> ChebyshevLaw:
    """The polynomial of least degree that meets conditions (x, order of the derivative, its value by x)."""
    degree = len(conditions) - 1
    rows = np.array([condition_row(x, order, degree) for x, order, _ in conditions])
    # A row of the third derivative is thousands of times one of the value.
    size = np.abs(rows).max(axis=1)
    if not size.all() or np.linalg.cond(rows / size[:, None]) > WORST:
        raise DesignError(
            "",
            "its conditions do not settle one polynomial",
            "give the lower derivatives before the higher ones, or fewer places between",
        )
    f = np.linalg.solve(rows / size[:, None], np.array([v for _, _, v in conditions]) / size)
    return chebyshev_law([derive(f, k) for k in range(4)])
