"""The proof that no small change makes a largest error less."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...plane.vec import Real
from .minimax import AbstractTask

# How near to the largest a peak must be, over it, and a limit to nothing, to hold the error up: what the last step
# leaves. Less, and a peak that holds is taken for one that does not.
LEVEL, ACTIVE = 1e-6, 1e-8


@dataclass(frozen=True, eq=False)
class Certificate:
    """Multipliers of peaks (peaks,), their sum 1, and of limits (limits,), all 0 and more; what their sum leaves."""

    peaks: Real
    limits: Real
    left: float


def certified(task: AbstractTask, p: Real, s: Real, errors: Real) -> Certificate:
    """Multipliers at a candidate p (unknowns,) whose error has its peaks at s (peaks,).

    Kuhn and Tucker's conditions (Nonlinear programming, 1951) of the least largest error: the derivatives of |error|
    at the highest peaks and of the limits that hold, each times a multiplier that is not negative, sum to nothing.
    Found by least squares on those that hold, the most negative left out until none is.
    """
    free = task.free
    limits, steep = (one[0] for one in task.limits(p[None]))
    slopes = np.sign(errors)[:, None] * task.slopes(p[None], s[None])[0]
    holds = np.concatenate([np.abs(errors) >= (1 - LEVEL) * np.abs(errors).max(), limits >= -ACTIVE])
    columns = np.concatenate([slopes, steep])[:, free].T
    # The last row: that the multipliers of peaks sum to 1.
    system = np.vstack([columns, np.concatenate([np.ones(len(s)), np.zeros(len(limits))])])
    right = np.append(np.zeros(len(columns)), 1.0)
    found = np.zeros(len(holds))
    while holds.any():
        found[:] = 0
        found[holds] = np.linalg.lstsq(system[:, holds], right, rcond=None)[0]
        if found.min() >= 0:
            break
        holds[np.argmin(found)] = False
    size = np.linalg.norm(columns, axis=0) @ found
    left = float(np.linalg.norm(system @ found - right) / max(size, 1.0))
    return Certificate(found[: len(s)], found[len(s) :], left)
