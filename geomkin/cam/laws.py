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
    orders = [f, f.deriv(1), f.deriv(2), f.deriv(3)]

    def law(x: Array) -> Array:
        return np.stack([g(x) for g in orders])

    return law


polynomial_345 = _polynomial([0, 0, 0, 10, -15, 6])

# Names as recipes spell them.
LAWS: dict[str, Law] = {"cycloidal": cycloidal, "harmonic": harmonic, "3-4-5": polynomial_345}
