"""The way of a linkage's crank through the wanted points: how it goes, and the defects of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...brief import one_line
from ...plane.vec import Real, Whole, cross
from .coupler_paths import COUPLER, CRANK, GROUND, ROCKER, closing, folded
from .fits import PathTask

# Turns nearer to a full one than this are none: the same point twice, and rounding.
NO_TURN = 1e-9
# By how much the cosine of a transmission angle may pass 1 for rounding.
ROUNDED = 1e-12


@dataclass(frozen=True, eq=False)
class Way:
    """The crank's angles (n,), rad, least transmission angle, rad (nan where it does not close), and the defects."""

    drive: Real
    transmission: float
    defects: tuple[str, ...]

    __repr__ = one_line


def way_through(task: PathTask, x: Real, cranks: Real, branch: Whole) -> Way:
    """How the crank of the linkage x (10,) goes through cranks (n,), each known but for turns, on branches (n,).

    It goes one way, no more than one turn, and closes all the way: else the order is wrong, as where the branch or the
    circuit changes. Angles that were prescribed are taken as they are, and a closed path has no order. The rule of
    circuits is that of `linkage.circuits`.
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
        drive, order = _one_way(task, x, cranks, bool(defects))
    if not order:
        defects.append("order")
    most = _most_folded(task, x, drive)
    transmission = float(np.arccos(min(most, 1.0))) if most <= 1 + ROUNDED and not defects else np.nan
    return Way(drive, transmission, tuple(defects))


def _one_way(task: PathTask, x: Real, cranks: Real, defect: bool) -> tuple[Real, bool]:
    """The angles on from each other in the sense that closes all the way, the shorter if both do; whether one does."""
    best: tuple[float, Real] | None = None
    for sense in (1, -1):
        turns = (sense * np.diff(cranks)) % (2 * np.pi)
        turns[turns > 2 * np.pi - NO_TURN] = 0
        drive = cranks[0] + sense * np.concatenate([[0.0], np.cumsum(turns)])
        total = float(turns.sum())
        closes = defect or _most_folded(task, x, drive) <= 1 + ROUNDED
        if total <= 2 * np.pi + NO_TURN and closes and (best is None or total < best[0]):
            best = total, drive
    return (np.unwrap(cranks), False) if best is None else (best[1], True)


def _most_folded(task: PathTask, x: Real, drive: Real) -> float:
    """The largest cosine of the transmission angle, without its sign, over the way from the first to the last."""
    at, inside = task.extremes(drive[None])
    cranks = np.concatenate([drive, at[inside[0]]])
    return float(np.abs(folded(x[None], cranks[None], task.slides)).max())


def _circuits(x: Real, cranks: Real, branch: Whole) -> int:
    """On how many circuits the poses of a four-bar lie."""
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
    # The sign at a joint that is not adjacent to the shortest link.
    sign = cross(coupler, rocker) if shortest in (d, a) else cross(np.ones_like(crank), crank)
    return len(np.unique(np.sign(sign)))
