"""Laws of motion from 0 to 1 over 0 <= x <= 1, each with its derivatives to the third.

Every law returns (4, ...): f, f', f'', f''' by x. Scaled to a rise h over an angle beta, the k-th
derivative by angle is h f^(k) / beta^k.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.polynomial import Polynomial

from ..plane.vec import Array

Law = Callable[[Array], Array]


def cycloidal(x: Array) -> Array:
    """f = x - sin(2 pi x) / 2 pi: no acceleration at either end. Peaks 2, 2 pi, 4 pi^2."""
    turn = 2 * np.pi * x
    return np.stack(
        [x - np.sin(turn) / (2 * np.pi), 1 - np.cos(turn), 2 * np.pi * np.sin(turn), 4 * np.pi**2 * np.cos(turn)]
    )


def harmonic(x: Array) -> Array:
    """f = (1 - cos(pi x)) / 2: acceleration jumps against a dwell. Peaks pi / 2, pi^2 / 2."""
    turn = np.pi * x
    return 0.5 * np.stack([1 - np.cos(turn), np.pi * np.sin(turn), np.pi**2 * np.cos(turn), -(np.pi**3) * np.sin(turn)])


def _polynomial(coefficients: list[float]) -> Law:
    f = Polynomial(coefficients)
    # Rows: the polynomial and its derivatives; columns: powers from the highest, as Horner takes them.
    rows = [np.pad(f.deriv(k).coef if k else f.coef, (0, k))[::-1] for k in range(4)]

    def law(x: Array) -> Array:
        value = np.zeros((4, *np.shape(x)))
        for column in np.array(rows).T:
            value = value * x + column.reshape(4, *[1] * np.ndim(x))
        return value

    return law


polynomial_345 = _polynomial([0, 0, 0, 10, -15, 6])

# Names as recipes spell them.
LAWS: dict[str, Law] = {"cycloidal": cycloidal, "harmonic": harmonic, "3-4-5": polynomial_345}
