"""The least of the mean square error, under limits: many starts at once."""

from __future__ import annotations

import numpy as np

from ...plane.vec import Real
from .minimax import DIFFERENCE, AbstractTask

# Nodes of the mean over the way, exact for polynomials of twice the degree. Fewer miss the error of a table's spline.
NODES = 48
# What a limit that is broken by 1 costs, squared; rounds in which the price of limits settles, steps in each. A lower
# price takes more rounds, a higher one more steps; fewer of these leave a limit broken by more than 1e-9.
STIFF, ROUNDS, STEPS = 10.0, 12, 8
# Longest step of an unknown: logarithms of lengths, and rad.
LONGEST_STEP = 0.5


def fit(task: AbstractTask, p: Real, exact: bool) -> tuple[Real, Real, Real]:
    """From candidates p (many, unknowns) to where the mean square error is least: p, its root, the last step (many,).

    Levenberg-Marquardt on the errors and on the limits that are broken, whose prices are raised round by round (the
    augmented Lagrangian: Powell 1969, Hestenes 1969). exact: with the curvature of the errors, which the former leaves
    out; that ends to rounding also in a valley, at ten times the price of a step. inf where a candidate cannot be.
    """
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    s, root = (0.5 * (nodes + 1))[None], np.sqrt(0.5 * weights)
    free = np.flatnonzero(task.free)
    n = len(free)
    p, price, damping = p.copy(), np.zeros(task.limits(p)[0].shape), np.full(len(p), 1e-3)

    def parts(q: Real) -> Real:
        broken = np.maximum(task.limits(q)[0] + price / STIFF, 0)
        both: Real = np.concatenate([root * task.error(q, s), np.sqrt(STIFF) * broken], axis=1)
        return both

    def slopes(q: Real) -> Real:
        limits, steep = task.limits(q)
        held = (limits + price / STIFF > 0)[..., None]
        errors, broken = root[:, None] * task.slopes(q, s)[..., free], np.sqrt(STIFF) * steep[..., free] * held
        both: Real = np.nan_to_num(np.concatenate([errors, broken], axis=1), nan=0.0, posinf=0.0, neginf=0.0)
        return both

    def gradient(q: Real) -> Real:
        down: Real = np.einsum("kmn,km->kn", slopes(q), np.nan_to_num(parts(q), nan=0.0, posinf=0.0, neginf=0.0))
        return down

    def square(q: Real) -> Real:
        if not exact:
            plain: Real = np.swapaxes(slopes(q), 1, 2) @ slopes(q)
            return plain
        shifts = DIFFERENCE * np.eye(p.shape[1])[free]
        columns = [(gradient(q + shift) - gradient(q - shift)) / (2 * DIFFERENCE) for shift in shifts]
        values, ways = np.linalg.eigh(0.5 * (np.stack(columns, 1) + np.stack(columns, 2)))
        # Downhill also where it bends down.
        bent: Real = (ways * np.abs(values)[:, None]) @ np.swapaxes(ways, 1, 2)
        return bent

    with np.errstate(all="ignore"):
        for _ in range(ROUNDS):
            r = parts(p)
            for _ in range(STEPS):
                system = square(p)
                size = np.maximum(np.einsum("kii->ki", system), 1e-12)
                system[:, range(n), range(n)] += damping[:, None] * size
                step = -np.linalg.solve(system, gradient(p)[..., None])[..., 0]
                q = p.copy()
                q[:, free] += np.clip(step, -LONGEST_STEP, LONGEST_STEP)
                new = parts(q)
                better = (new**2).sum(axis=1) < (r**2).sum(axis=1)
                p[better], r[better] = q[better], new[better]
                damping = np.clip(np.where(better, damping * 0.1, damping * 8), 1e-12, 1e12)
            price = np.maximum(price + STIFF * task.limits(p)[0], 0)
        found = np.sqrt(((root * task.error(p, s)) ** 2).sum(axis=1))
    return p, np.where(np.isfinite(found), found, np.inf), np.abs(step).max(axis=1)
