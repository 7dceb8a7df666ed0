"""Newton-Raphson for n equations in n unknowns, from an estimate."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ...arguments import Extended, checked
from ...errors import DesignError
from ...plane.vec import Array


@dataclass(frozen=True, eq=False)
class Root:
    """Where the iteration stopped. value: (n,); converged; residual: largest |f| there; path: (steps + 1, n)."""

    value: Array
    converged: bool
    residual: float
    path: Array


@checked
def newton_raphson(
    f: Callable[[Array], ArrayLike],
    jacobian: Callable[[Array], ArrayLike],
    estimate: Extended,
    tolerance: float = 1e-13,
    steps: int = 50,
) -> Root:
    """Solve f(x) = 0 from an estimate, (n,) or a number, by x - J^-1 f with the jacobian J = df/dx, (n, n).

    Converged when a step is at most `tolerance` of the size of x (of 1 near zero). Where J is singular or f is
    not finite it stops, not converged, and the value is where that happened: never trust it without looking.
    """
    if np.ndim(estimate) > 1 or not np.size(estimate):
        raise DesignError("estimate", f"found shape {np.shape(estimate)}", "give a number or a row (n,)")
    x = np.atleast_1d(np.asarray(estimate, dtype=float)).copy()
    path = [x]
    converged = False
    for _ in range(steps):
        value = np.atleast_1d(np.asarray(f(x), dtype=float))
        slope = np.asarray(jacobian(x), dtype=float).reshape(len(x), len(x))
        try:
            step = np.linalg.solve(slope, value)
        except np.linalg.LinAlgError:
            break
        if not np.isfinite(step).all():
            break
        x = x - step
        path.append(x)
        if np.abs(step).max() <= tolerance * max(1.0, float(np.abs(x).max())):
            converged = True
            break
    return Root(x, converged, float(np.abs(np.atleast_1d(np.asarray(f(x), dtype=float))).max()), np.array(path))


def solved(matrices: Array, right: Array) -> Array:
    """x with matrix x = right for every one of (k, n, n) and (k, n); nan where a matrix is singular or not finite."""
    found = np.full(right.shape, np.nan)
    known = np.isfinite(matrices).all(axis=(1, 2)) & np.isfinite(right).all(axis=1)
    # A sign of zero is a pivot of zero, which `solve` would refuse all of them for.
    known[known] = np.linalg.slogdet(matrices[known])[0] != 0
    found[known] = np.linalg.solve(matrices[known], right[known][..., None])[..., 0]
    return found
