"""The motion of a four-bar or slider-crank through the crank angles of a path, and its defects."""

from __future__ import annotations

import numpy as np

from ...core.records import record
from ...plane.vec import Real, Whole, cross
from .coupler_paths import (
    COUPLER,
    CRANK,
    GROUND,
    ROCKER,
    closing,
    signed_transmission_cosine,
)
from .fits import PathTask

# Rotations closer to a full turn than this are 0: the same point twice, with rounding.
NO_TURN = 1e-9
# Tolerance by which rounding may make the cosine of a transmission angle exceed 1.
ROUNDING = 1e-12


@record(eq=False)
class CrankMotion:
    """Crank angles (n,), rad, least transmission angle, rad (nan if the linkage does not close), and the defects."""

    drive: Real
    transmission: float
    defects: tuple[str, ...]


def crank_motion(task: PathTask, x: Real, cranks: Real, branch: Whole) -> CrankMotion:
    """Motion of the linkage x (10,) through crank angles (n,), each known up to full turns, on branches (n,).

    The crank turns in one sense by at most one turn, and the linkage closes everywhere; otherwise the order is wrong,
    as it is if the branch or the circuit changes. Prescribed angles are taken as they are, and a closed path has no
    order. The circuits follow the rule of `linkage.circuits`.
    """
    defects = []
    if not task.slides and not task.closed and _circuits(x, cranks, branch) > 1:
        defects.append("circuit")
    if len(np.unique(branch)) > 1:
        defects.append("branch")
    if task.turns is not None:
        drive, order = cranks, True
    elif task.closed:
        drive, order = cranks % (2 * np.pi), True
    else:
        drive, order = _in_one_sense(task, x, cranks, bool(defects))
    if not order:
        defects.append("order")
    most = _largest_cosine(task, x, drive)
    transmission = float(np.arccos(min(most, 1.0))) if most <= 1 + ROUNDING and not defects else np.nan
    return CrankMotion(drive, transmission, tuple(defects))


def _in_one_sense(task: PathTask, x: Real, cranks: Real, defect: bool) -> tuple[Real, bool]:
    """Angles continued in the sense in which the linkage closes everywhere, and whether there is such a sense.

    If it closes in both senses, the shorter motion is taken.
    """
    best: tuple[float, Real] | None = None
    for sense in (1, -1):
        steps = (sense * np.diff(cranks)) % (2 * np.pi)
        steps[steps > 2 * np.pi - NO_TURN] = 0
        drive = cranks[0] + sense * np.concatenate([[0.0], np.cumsum(steps)])
        total = float(steps.sum())
        closes = defect or _largest_cosine(task, x, drive) <= 1 + ROUNDING
        if total <= 2 * np.pi + NO_TURN and closes and (best is None or total < best[0]):
            best = total, drive
    return (np.unwrap(cranks), False) if best is None else (best[1], True)


def _largest_cosine(task: PathTask, x: Real, drive: Real) -> float:
    """Largest absolute cosine of the transmission angle from the first to the last crank angle."""
    at, inside = task.extremes(drive[None])
    cranks = np.concatenate([drive, at[inside[0]]])
    return float(np.abs(signed_transmission_cosine(x[None], cranks[None], task.slides)).max())


def _circuits(x: Real, cranks: Real, branch: Whole) -> int:
    """Number of circuits on which the positions of a four-bar lie."""
    d, a, b, c = (float(x[k]) for k in (GROUND, CRANK, COUPLER, ROCKER))
    shortest, second, third, longest = sorted((d, a, b, c))
    if shortest + longest >= second + third:
        return 1
    crank, coupler = (
        np.array([v[0, 0] for v in pair])
        for pair in zip(
            *(closing(x[None], np.array([[q]]), np.array([float(s)]), False) for q, s in zip(cranks, branch))
        )
    )
    rocker = a * crank + b * coupler - d
    # The sign at a joint that is not adjacent to the shortest link identifies the circuit.
    sign = cross(coupler, rocker) if shortest in (d, a) else cross(np.ones_like(crank), crank)
    return len(np.unique(np.sign(sign)))
