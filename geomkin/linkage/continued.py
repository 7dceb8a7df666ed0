"""Steps run over a row of drives, and branches kept by the motion itself where no formula continues them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..plane.vec import Array
from .closure import Driven
from .dyads import Dyad
from .loops import Loops
from .steps import Pass, Step, Turned

# Steps of the finer row of drives, rad, and of a slider as a share of its whole way: coarser, and a prediction
# by first and second derivative may take the wrong branch beside a change point.
FINEST_TURN, FINEST_SHARE = np.pi / 180, 1 / 360


def started(ground: str, q: Array) -> Pass:
    """A first pass with nothing placed but the fixed body."""
    return Pass({ground: np.zeros(())}, {ground: np.ones(())}, q)


def run(steps: Sequence[Step], ground: str, branch: Mapping[str, Array | int], passes: list[Pass], order: int) -> None:
    """Carry started passes on up to an order, in the fixed body's frame; what is there is not done again."""
    # What cannot close is nan, and what is singular is not finite: both are meant.
    with np.errstate(all="ignore"):
        if len(passes[0].turn) == 1:
            for step in steps:
                step.place(passes[0], branch[step.joint] if isinstance(step, Dyad) else 1)
        if order > 0 and len(passes) == 1:
            passes.append(_still(ground))
            for step in steps:
                step.first(passes[0], passes[1])
        if order > 1 and len(passes) == 2:
            passes.append(_still(ground))
            for step in steps:
                step.second(passes[0], passes[1], passes[2])


def followed(
    steps: Sequence[Step], ground: str, drive: Array, signs: Mapping[str, int], follow: bool
) -> tuple[list[Pass], Mapping[str, Array | int]]:
    """All passes, and the branches by joint, worked out step by step along a finer row of drives."""
    finest = FINEST_TURN if isinstance(steps[0], Turned) else FINEST_SHARE * np.ptp([*drive, 0])
    fine, places = _finer(drive, finest) if follow else (drive, np.arange(len(drive)))
    branch: dict[str, Array | int] = {}
    rising = np.argsort(fine, kind="stable")

    def before(q: Array) -> list[Pass]:
        # Signs that differ by frame are those of the nearest frame.
        near = np.searchsorted(0.5 * (fine[rising][1:] + fine[rising][:-1]), q)
        signs = {joint: s if np.ndim(s) == 0 else np.asarray(s)[rising][near] for joint, s in branch.items()}
        passes = [started(ground, q)]
        run([step for step in steps if not isinstance(step, Loops)], ground, signs, passes, 1)
        return passes

    p0, p1, p2 = Pass({ground: np.zeros(())}, {ground: np.ones(())}, fine, {}, before), _still(ground), _still(ground)
    with np.errstate(all="ignore"):
        for step in steps:
            side: Array | int = 1
            if isinstance(step, Dyad):
                side = signs[step.joint]
                if follow and isinstance(step, Driven):
                    side = step.sign_from(fine, side)
                elif follow:
                    side = _smooth(step, (p0, p1, p2), fine, side)
                branch[step.joint] = side
            step.place(p0, side)
            step.first(p0, p1)
            step.second(p0, p1, p2)
    return [_taken(p, places) for p in (p0, p1, p2)], {
        joint: np.broadcast_to(sign, fine.shape)[places] for joint, sign in branch.items()
    }


def _smooth(step: Dyad, passes: tuple[Pass, Pass, Pass], q: Array, sign: int) -> Array:
    """Signs, (frames,), that start with `sign` and change where the motion runs smoothly on into the other branch."""
    ways = []
    for side in (1, -1):
        trial = [Pass(dict(p.origin), dict(p.turn), p.drive, dict(p.kept)) for p in passes]
        step.place(trial[0], side)
        step.first(*trial[:2])
        step.second(*trial)
        ways.append([trial[k].turn[step.leader] for k in range(3)])
    (here, h, h2), (there, g, g2) = ways
    usable = np.flatnonzero(np.isfinite(h) & np.isfinite(h2) & np.isfinite(g) & np.isfinite(g2))
    if not usable.size:
        return np.full(len(q), sign)
    here, h, h2, there = here[usable], h[usable], h2[usable], there[usable]
    step_q = np.diff(q[usable])
    predicted = here[:-1] * np.exp(1j * (h[:-1] * step_q + 0.5 * h2[:-1] * step_q**2))
    crossed = np.abs(predicted - there[1:]) < np.abs(predicted - here[1:])
    changed = np.cumprod(np.concatenate([[1], np.where(crossed, -1, 1)]))
    signs = np.full(len(q), sign)
    # A frame at the change point itself belongs to both branches: it takes the sign before it.
    before = np.clip(np.searchsorted(usable, np.arange(len(q)), side="right") - 1, 0, None)
    return signs * changed[before]


def _finer(drive: Array, finest: float) -> tuple[Array, Array]:
    """A row of drives with small steps that has all of `drive` in it, and where."""
    steps = np.abs(np.diff(drive))
    if not steps.size:
        return drive, np.arange(len(drive))
    parts = np.maximum(1, np.ceil(steps / (finest or 1.0) - 1e-9)).astype(int)
    ends = np.concatenate([[0], np.cumsum(parts)])
    return np.interp(np.arange(ends[-1] + 1), ends, drive), ends


def _taken(p: Pass, places: Array) -> Pass:
    def take(values: Mapping[str, Array]) -> dict[str, Array]:
        return {k: v[places] if np.ndim(v) else v for k, v in values.items()}

    return Pass(take(p.origin), take(p.turn), p.drive[places] if np.ndim(p.drive) else p.drive)


def _still(ground: str) -> Pass:
    return Pass({ground: np.zeros(())}, {ground: np.zeros(())})
