"""Least squares by damped steps, from many starts at once."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...plane.vec import Real, Whole

# Steps at most, each for all starts together; a start that needs more crawls along a valley that ends at infinity.
STEPS = 300
# Gain of a step, as a share of the squares, below which a start has converged.
CONVERGED = 1e-13
# Largest unknown, of which sizes are about 1. Larger, and fourth powers overflow; smaller stops fits of far pivots.
FARTHEST = 1e12


def least_squares(cost: Callable[[Real, Whole], tuple[Real, Real]], start: Real) -> Real:
    """Unknowns (k, q) at which the squares of residuals are least, each from its own start (Levenberg-Marquardt).

    cost: from unknowns (k, q), and which of the starts they are of, to residuals (k, n) and their derivatives
    (k, n, q). Unknowns that have a scale in common may be among them: the damping keeps what the residuals do not
    tell. Levenberg 1944, Marquardt 1963.
    """
    best = np.array(start)
    rows = np.arange(len(start))
    x, damping, eye = best, np.full(len(start), 1e-3), np.eye(best.shape[-1])
    away, slopes = cost(x, rows)
    for _ in range(STEPS):
        if not len(rows):
            break
        squares = np.sum(away**2, axis=-1)
        normal = np.einsum("kni,knj->kij", slopes, slopes)
        right = np.einsum("kni,kn->ki", slopes, away)
        trace = np.trace(normal, axis1=-2, axis2=-1)[:, None, None]
        damped = normal + (damping[:, None, None] + 1e-14) * (trace + 1e-300) * eye
        tried = x - np.linalg.solve(damped, right[..., None])[..., 0]
        new_away, new_slopes = cost(tried, rows)
        new_squares = np.sum(new_away**2, axis=-1)
        # What runs away has its least at infinity, where numbers end.
        better = (new_squares < squares) & (np.abs(tried).max(axis=-1) < FARTHEST)
        done = np.where(better, squares - new_squares <= CONVERGED * squares, damping > 1e6)
        x = np.where(better[:, None], tried, x)
        away, slopes = np.where(better[:, None], new_away, away), np.where(better[:, None, None], new_slopes, slopes)
        damping = np.clip(np.where(better, damping * 0.1, damping * 5), 1e-15, 1e12)
        best[rows] = x
        left = ~done
        x, away, slopes, damping, rows = x[left], away[left], slopes[left], damping[left], rows[left]
    return best
