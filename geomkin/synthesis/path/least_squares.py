"""Least squares from many starts at once (Levenberg and Marquardt), within bounds, local unknowns eliminated."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ...plane.vec import Mask, Real, Whole
from ...progress import Watch

# Damping: where it starts, beyond which a start is given up, and its least. A start that is too small wanders off far
# in the first steps and forgets where it was; too large takes more steps.
DAMPED, MOST_DAMPED, LEAST_DAMPED = 1e-3, 1e12, 1e-15
# Share by which a step must still lessen the sum for the search to go on, so many times in a row. Larger stops in
# valleys, of which these problems are full.
GAIN, STILL = 1e-9, 8
# Sums of squares below which nothing but rounding is left, in units of the problem.
NOTHING_LEFT = 1e-29

# Undamped steps at the end, and how long the first may be: a longer one is of a start that was not brought to its end.
SETTLING, LOOSE = 40, 1e-4


@dataclass(frozen=True, eq=False)
class Linearised:
    """Residuals of s starts and their derivatives by the p shared unknowns and, block by block, by one local unknown.

    blocks: (s, n, k) residuals; by_shared: (s, n, k, p); by_local: (s, n, k), None where there are no local unknowns.
    rest, rest_by_shared: (s, m) residuals and (s, m, p) without local unknowns. nan where there is none.
    """

    blocks: Real
    by_shared: Real
    by_local: Real | None
    rest: Real
    rest_by_shared: Real

    @property
    def sums(self) -> Real:
        """Sums of squares (s,); infinite where there is none."""
        total = np.einsum("snk,snk->s", self.blocks, self.blocks) + np.einsum("sm,sm->s", self.rest, self.rest)
        return np.where(np.isfinite(total), total, np.inf)


class Residuals(Protocol):
    """What is made small: of the starts numbered `which` at shared unknowns x (s, p) and local ones t (s, n)."""

    def __call__(self, which: Whole, x: Real, t: Real) -> Linearised: ...

    def settled(self, which: Whole, x: Real, t: Real) -> Real:
        """Local unknowns nearer to the best ones at these shared ones; t itself will do."""
        ...


def least_squares(
    residuals: Residuals, x: Real, t: Real, low: Real, high: Real, steps: int, watch: Watch | None = None
) -> tuple[Real, Real, Real]:
    """Shared unknowns (s, p), local ones (s, n) and sums of squares (s,) after at most so many steps.

    x, t: the starts. low, high: (p,) or (s, p) bounds of x, which hold at every step: at a bound an unknown that is
    pressed against it waits. The normal equations' local part is diagonal and is eliminated (Schur complement). After
    Marquardt, An algorithm for least-squares estimation of nonlinear parameters, J. SIAM 11, 1963, with the damping of
    Nielsen (1999); bounds and blocks are derived here.
    """
    low, high = np.broadcast_to(low, x.shape), np.broadcast_to(high, x.shape)
    best_x, best_t = np.clip(x, low, high), t.copy()
    which = np.arange(len(x))
    now = residuals(which, best_x, best_t)
    best = now.sums
    x, t, sums = best_x.copy(), best_t.copy(), best.copy()
    damping, growth, still = np.full(len(x), DAMPED), np.full(len(x), 2.0), np.zeros(len(x), dtype=int)
    for step in range(steps):
        going = np.isfinite(sums) & (sums > NOTHING_LEFT) & (damping < MOST_DAMPED) & (still < STILL)
        if not going.any() or (watch and watch.over()):
            break
        if going.sum() <= 0.8 * len(going) or step == 0:
            best_x[which], best_t[which], best[which] = x, t, sums
            x, t, sums, damping, growth = (row[going] for row in (x, t, sums, damping, growth))
            which, still = which[going], still[going]
            now = _some(now, going)
        new_x, new_t, promised = _step(now, x, t, low[which], high[which], damping)
        new_t = residuals.settled(which, new_x, new_t)
        new = residuals(which, new_x, new_t)
        new_sums = new.sums
        with np.errstate(invalid="ignore", divide="ignore"):
            ratio = np.nan_to_num((sums - new_sums) / promised, nan=-1.0, neginf=-1.0)
            gained = np.nan_to_num((sums - new_sums) / sums, nan=-1.0, neginf=-1.0)
        better = gained > 0
        still = np.where(better & (gained < GAIN), still + 1, np.where(better, 0, still))
        cube = (2 * np.clip(ratio, -1, 1.5) - 1) ** 3
        damping = np.where(
            better, np.maximum(damping * np.maximum(1 / 3, 1 - cube), LEAST_DAMPED), np.minimum(damping * growth, 1e20)
        )
        growth = np.where(better, 2.0, np.minimum(2 * growth, 1e3))
        x, t = np.where(better[:, None], new_x, x), np.where(better[:, None], new_t, t)
        sums = np.where(better, new_sums, sums)
        now = _either(better, new, now)
    best_x[which], best_t[which], best[which] = x, t, sums
    return best_x, best_t, best


def settled(residuals: Residuals, x: Real, t: Real, low: Real, high: Real) -> tuple[Real, Real]:
    """Solutions of `least_squares` followed on by undamped steps, as long as each step is shorter than the one before.

    Sums of squares stop falling where half of all digits of the unknowns are still open, and the rest would be decided
    by a processor's rounding.
    """
    low, high = np.broadcast_to(low, x.shape), np.broadcast_to(high, x.shape)
    which, before = np.arange(len(x)), np.full(len(x), LOOSE)
    for _ in range(SETTLING):
        new_x, new_t, _ = _step(residuals(which, x, t), x, t, low, high, np.full(len(x), LEAST_DAMPED))
        length = np.linalg.norm(new_x - x, axis=1)
        shorter = length < before
        if not shorter.any():
            break
        x, t = np.where(shorter[:, None], new_x, x), np.where(shorter[:, None], new_t, t)
        before = np.where(shorter, length, 0.0)
    return x, t


def _step(now: Linearised, x: Real, t: Real, low: Real, high: Real, damping: Real) -> tuple[Real, Real, Real]:
    """The damped step, held within the bounds, and the fall of the sum of squares that it promises."""
    s, n, k, p = now.by_shared.shape
    flat = now.by_shared.reshape(s, n * k, p)
    square = np.swapaxes(flat, 1, 2) @ flat + np.swapaxes(now.rest_by_shared, 1, 2) @ now.rest_by_shared
    slope = np.einsum("sip,si->sp", flat, now.blocks.reshape(s, n * k))
    slope += np.einsum("smp,sm->sp", now.rest_by_shared, now.rest)
    diagonal = np.einsum("spp->sp", square)
    # Of an unknown that moves nothing the diagonal is 0: it then stays where it is.
    scale = np.maximum(diagonal, 1e-12 * diagonal.max(axis=1, keepdims=True) + 1e-300)
    held = ((x <= low) & (slope > 0)) | ((x >= high) & (slope < 0))
    damped = square + damping[:, None, None] * (scale[:, :, None] * np.eye(p))
    right = slope
    if now.by_local is not None:
        mixed = np.einsum("snkp,snk->snp", now.by_shared, now.by_local)
        local = np.einsum("snk,snk->sn", now.by_local, now.by_local)
        local_slope = np.einsum("snk,snk->sn", now.by_local, now.blocks)
        firm = local * (1 + damping[:, None]) + 1e-300 + 1e-14 * local.max(axis=1, keepdims=True)
        eased = mixed / firm[:, :, None]
        damped = damped - np.swapaxes(eased, 1, 2) @ mixed
        right = slope - np.einsum("snp,sn->sp", eased, local_slope)
    shift = np.zeros_like(x)
    for _ in range(3):
        # What a bound holds leaves the system; what the step drives through one is held there as well.
        free = ~held
        kept = free[:, :, None] & free[:, None, :]
        system = np.where(kept, damped, np.where(np.eye(p, dtype=bool), scale[:, :, None], 0.0))
        fixed = np.where(held, shift, 0.0)
        pull = right + np.einsum("spq,sq->sp", damped, fixed)
        moved = _solved(system, np.where(free, -pull, 0.0))
        moved = np.where(held, fixed, moved)
        shift = np.clip(x + moved, low, high) - x
        through = free & (np.abs(shift - moved) > 0)
        if not through.any():
            break
        held = held | through
    new_x = np.clip(x + shift, low, high)
    new_t = t
    if now.by_local is not None:
        turn = -(local_slope + np.einsum("snp,sp->sn", mixed, shift)) / firm
        # No more than a third of a turn at once: beyond it the linear model says nothing.
        new_t = t + np.clip(turn, -2.0, 2.0)
    # Exact for a free step; where bounds cut it, near enough to steer the damping by.
    promised = -np.einsum("sp,sp->s", right, shift)
    if now.by_local is not None:
        promised = promised + np.einsum("sn,sn->s", local_slope**2, 1 / firm)
    return new_x, new_t, np.maximum(promised, 1e-300)


def _solved(system: Real, right: Real) -> Real:
    """Solutions (s, p) of symmetric systems (s, p, p), each scaled; 0 for those that are singular."""
    scale = 1 / np.sqrt(np.maximum(np.einsum("spp->sp", system), 1e-300))
    scaled = system * scale[:, :, None] * scale[:, None, :]
    bad = ~np.isfinite(scaled).all(axis=(1, 2))
    scaled[bad] = np.eye(scaled.shape[-1])
    scaled = scaled + 1e-15 * np.eye(scaled.shape[-1])
    try:
        found = np.linalg.solve(scaled, (right * scale)[..., None])[..., 0] * scale
    except np.linalg.LinAlgError:
        found = np.einsum("spq,sq->sp", np.linalg.pinv(scaled), right * scale) * scale
    return np.where(bad[:, None] | ~np.isfinite(found), 0.0, found)


def _some(of: Linearised, which: Mask) -> Linearised:
    local = None if of.by_local is None else of.by_local[which]
    return Linearised(of.blocks[which], of.by_shared[which], local, of.rest[which], of.rest_by_shared[which])


def _either(first: Mask, one: Linearised, other: Linearised) -> Linearised:
    """The one where `first` says so, the other elsewhere."""

    def chosen(a: Real, b: Real) -> Real:
        return np.where(first.reshape(-1, *[1] * (a.ndim - 1)), a, b)

    local = None if one.by_local is None or other.by_local is None else chosen(one.by_local, other.by_local)
    return Linearised(
        chosen(one.blocks, other.blocks),
        chosen(one.by_shared, other.by_shared),
        local,
        chosen(one.rest, other.rest),
        chosen(one.rest_by_shared, other.rest_by_shared),
    )
