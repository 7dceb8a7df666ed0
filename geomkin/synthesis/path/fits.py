"""Least squares from many starts at once (Levenberg-Marquardt) within bounds, with local unknowns eliminated."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from types import MappingProxyType
from typing import Protocol

import numpy as np

from ...core.processes import Watch
from ...core.records import record
from ...plane.vec import Complex, Mask, Real, Whole, dot
from .coupler_paths import (
    COUPLER,
    CRANK,
    GROUND,
    ROCKER,
    START,
    along,
    folding,
    paths,
    points_of,
    signed_transmission_cosine,
)

# First damping, the one beyond which a start is given up, and the least. A first value that is too small lets the first
# steps diverge; one that is too large costs steps.
DAMPED, MOST_DAMPED, LEAST_DAMPED = 1e-3, 1e12, 1e-15
# Least relative gain of a step, and the number of successive steps below it that end the search. A larger gain stops in
# valleys, which these problems have in great number.
GAIN, STILL = 1e-9, 8
# Sums of squares below which only rounding is left, in units of the problem.
NOTHING_LEFT = 1e-29

# Undamped steps at the end, and the largest first one; a longer one shows a start that has not converged.
SETTLING, LOOSE = 40, 1e-4


@record(eq=False)
class Linearised:
    """Residuals of s starts and their derivatives by the p shared unknowns and, block by block, by one local unknown.

    `blocks`: (s, n, k) residuals; `by_shared`: (s, n, k, p); `by_local`: (s, n, k), None without local unknowns.
    `rest`, `rest_by_shared`: (s, m) residuals and (s, m, p) without local unknowns. nan if undefined.
    """

    blocks: Real
    by_shared: Real
    by_local: Real | None
    rest: Real
    rest_by_shared: Real

    @property
    def sums(self) -> Real:
        """Sums of squares (s,); infinite if undefined."""
        total = np.einsum("snk,snk->s", self.blocks, self.blocks) + np.einsum("sm,sm->s", self.rest, self.rest)
        return np.where(np.isfinite(total), total, np.inf)


class Residuals(Protocol):
    """Residuals of the starts numbered `which` at shared unknowns x (s, p) and local ones t (s, n)."""

    def __call__(self, which: Whole, x: Real, t: Real) -> Linearised: ...

    def settled(self, which: Whole, x: Real, t: Real) -> Real:
        """Improved local unknowns for these shared ones; t itself is allowed."""
        ...


def shared_least_squares(
    residuals: Residuals, x: Real, t: Real, low: Real, high: Real, steps: int, watch: Watch | None = None
) -> tuple[Real, Real, Real]:
    """Shared unknowns (s, p), local ones (s, n) and sums of squares (s,) after at most so many steps.

    x and t are the starts; `low` and `high`, (p,) or (s, p), are bounds of x at every step: an unknown that is pressed
    against its bound is held there. The local part of the normal equations is diagonal and is eliminated (Schur
    complement). After Marquardt, An algorithm for least-squares estimation of nonlinear parameters, J. SIAM 11, 1963,
    with the damping of Nielsen (1999); bounds and blocks are derived here.
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
            now = _selected(now, going)
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
        now = _where(better, new, now)
    best_x[which], best_t[which], best[which] = x, t, sums
    return best_x, best_t, best


def settled_solutions(residuals: Residuals, x: Real, t: Real, low: Real, high: Real) -> tuple[Real, Real]:
    """Solutions of `shared_least_squares` improved by undamped steps as long as each is shorter than the one before.

    Sums of squares stop falling when half of all digits of the unknowns are still open; rounding would decide the rest.
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
    """The damped step within the bounds, and the predicted decrease of the sum of squares."""
    s, n, k, p = now.by_shared.shape
    flat = now.by_shared.reshape(s, n * k, p)
    square = np.swapaxes(flat, 1, 2) @ flat + np.swapaxes(now.rest_by_shared, 1, 2) @ now.rest_by_shared
    slope = np.einsum("sip,si->sp", flat, now.blocks.reshape(s, n * k))
    slope += np.einsum("smp,sm->sp", now.rest_by_shared, now.rest)
    diagonal = np.einsum("spp->sp", square)
    # An unknown without effect has a zero diagonal and does not move.
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
        # Unknowns at a bound leave the system, and so do those that the step would drive through one.
        free = ~held
        is_free = free[:, :, None] & free[:, None, :]
        system = np.where(is_free, damped, np.where(np.eye(p, dtype=bool), scale[:, :, None], 0.0))
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
        # At most a third of a turn per step, beyond which the linear model is meaningless.
        new_t = t + np.clip(turn, -2.0, 2.0)
    # Exact for a free step; for one cut by bounds accurate enough to control the damping.
    promised = -np.einsum("sp,sp->s", right, shift)
    if now.by_local is not None:
        promised = promised + np.einsum("sn,sn->s", local_slope**2, 1 / firm)
    return new_x, new_t, np.maximum(promised, 1e-300)


def _solved(system: Real, right: Real) -> Real:
    """Solutions (s, p) of scaled symmetric systems (s, p, p); 0 for singular ones."""
    scale = 1 / np.sqrt(np.maximum(np.einsum("spp->sp", system), 1e-300))
    scaled = system * scale[:, :, None] * scale[:, None, :]
    bad = ~np.isfinite(scaled).all(axis=(1, 2))
    scaled[bad] = np.eye(scaled.shape[-1])
    scaled = scaled + 1e-15 * np.eye(scaled.shape[-1])
    try:
        solutions = np.linalg.solve(scaled, (right * scale)[..., None])[..., 0] * scale
    except np.linalg.LinAlgError:
        solutions = np.einsum("spq,sq->sp", np.linalg.pinv(scaled), right * scale) * scale
    return np.where(bad[:, None] | ~np.isfinite(solutions), 0.0, solutions)


def _selected(of: Linearised, which: Mask) -> Linearised:
    local = None if of.by_local is None else of.by_local[which]
    return Linearised(of.blocks[which], of.by_shared[which], local, of.rest[which], of.rest_by_shared[which])


def _where(first: Mask, one: Linearised, other: Linearised) -> Linearised:
    """Elements of one if `first`, else of the other."""

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


# Weight of a violated limit, in units of the points' sum of squares. A smaller one lets the search go far beyond the
# limits; a larger one makes it creep along them.
WEIGHT = 10.0
# Rounds of least squares, after each of which the multipliers of the limits are updated, and steps per round. With
# fewer rounds a limit is violated in the sixth digit.
ROUNDS, STEPS = 14, 25
# Number of starts that continue after these rounds: fewer lose some that converge slowly at first, more take longer.
KEPT = MappingProxyType({0: 160, 2: 64, 6: 30, 10: 12})
# Rounds in which results for some of the points are adapted to all points.
REFINED = 6
# Steps of the last round; fewer leave some in a long valley.
LAST = 150
# Largest violation of a limit in the end, in its own units. A smaller one refuses linkages at the limit.
PASSED = 1e-11
# Steps that restore violated limits, and the largest violation for which they are tried; beyond it the linkage would
# change too much.
RESTORED, FAR_OUTSIDE = 8, 1e-3
# Number of moves of a crank towards the nearest point of its path after each step.
SETTLED = 1
# Samples of a closed path for the nearest point, and steps from the nearest of them; fewer may miss the tip of a path
# that turns sharply.
LOOKS, REFINED_LOOKS = 192, 3


@record(eq=False)
class PathTask:
    """The task of a path search in its own units: wanted points about 0 with a mean square of 1.

    `turns`: (n,) crank angles at the points from the first on, rad, or None if free. `closed`: the crank turns fully.
    `slides`: a slider-crank. `least_transmission`: rad, above 0. `largest_ratio`: inf for any. `low`, `high`: (10,)
    bounds in the order of `coupler_paths.NAMES`. `weights`: (n,) of the squared distances, None if equal.
    """

    wanted: Complex
    turns: Real | None
    closed: bool
    slides: bool
    least_transmission: float
    largest_ratio: float
    low: Real
    high: Real
    weights: Real | None = None

    @cached_property
    def root(self) -> Real:
        """Factors (n,) of the distances."""
        return np.ones(len(self.wanted)) if self.weights is None else np.sqrt(self.weights / self.weights.mean())

    @property
    def links(self) -> tuple[int, ...]:
        """Indices of the links' lengths; an offset is not a link."""
        return (CRANK, COUPLER) if self.slides else (GROUND, CRANK, COUPLER, ROCKER)

    @property
    def free(self) -> bool:
        """Whether the crank angles are unknown."""
        return self.turns is None

    def thinned(self, most: int) -> PathTask:
        """The task with at most so many of the points, evenly chosen, including the first and the last."""
        if len(self.wanted) <= most:
            return self
        chosen = np.unique(np.linspace(0, len(self.wanted) - 1, most).round().astype(int))
        turns, weights = (None if row is None else row[chosen] for row in (self.turns, self.weights))
        return replace(self, wanted=self.wanted[chosen], turns=turns, weights=weights)

    def cranks(self, x: Real, t: Real) -> Real:
        """Crank angles (s, n) at the points."""
        return t if self.turns is None else x[:, START, None] + self.turns

    def extremes(self, cranks: Real) -> tuple[Real, Mask]:
        """Crank angles (2,) of the extreme transmission angles, and whether each motion (s, 2) includes them."""
        at = np.array([np.pi / 2, -np.pi / 2]) if self.slides else np.array([0.0, np.pi])
        if self.closed:
            return at, np.ones((len(cranks), 2), dtype=bool)
        low, high = cranks.min(axis=1)[:, None], cranks.max(axis=1)[:, None]
        return at, at + 2 * np.pi * np.ceil((low - at) / (2 * np.pi)) < high

    def passed(self, x: Real, cranks: Real) -> Real:
        """Largest violation of the limits by each of s linkages; infinite if one does not close."""
        at, inside = self.extremes(cranks)
        most = np.cos(self.least_transmission)
        ends = np.where(
            inside, np.abs(signed_transmission_cosine(x, np.broadcast_to(at, inside.shape), self.slides)), 0.0
        )
        here = np.abs(signed_transmission_cosine(x, cranks, self.slides))
        lengths = np.log(x[:, self.links])
        ratio = lengths.max(axis=1) - lengths.min(axis=1) - np.log(self.largest_ratio)
        worst = np.maximum(np.maximum(ends.max(axis=1), here.max(axis=1)) - most, ratio)
        return np.where(np.isnan(worst), np.inf, worst)


class Fit:
    """Residuals of s linkages of given branches (s,) with multipliers of the limits (augmented Lagrangian)."""

    def __init__(self, task: PathTask, branch: Real):
        self.task, self.branch = task, branch
        n, links = len(task.wanted), len(task.links)
        self.at_points = np.zeros((len(branch), n))
        self.at_ends = np.zeros((len(branch), 2))
        self.at_links = np.zeros((len(branch), links * (links - 1)))
        self.weight = np.sqrt(WEIGHT * n)
        ones = np.eye(links)
        self.pairs = np.array([ones[i] - ones[j] for i in range(links) for j in range(links) if i != j])

    def limits(self, which: Whole, x: Real, cranks: Real) -> tuple[Real, Real, Real, Real, Real, Real, Real]:
        """Violations of limits with multipliers, and their derivatives, at points, at the ends, and of links."""
        task = self.task
        most = np.cos(task.least_transmission) ** 2
        value, by_size, by_crank = folding(x, cranks, task.slides)
        # A full turn passes both extremes, whose limits imply those at the points.
        points = np.full(value.shape, -1.0) if task.closed else value**2 - most + self.at_points[which]
        at, inside = task.extremes(cranks)
        end, end_by_size, _ = folding(x, np.broadcast_to(at, inside.shape), task.slides)
        # An extreme that the motion does not reach violates nothing.
        ends = np.where(inside, end**2 - most + self.at_ends[which], -1.0)
        lengths = x[:, task.links]
        links = np.log(lengths) @ self.pairs.T - np.log(task.largest_ratio) + self.at_links[which]
        by = 2 * value[..., None] * by_size, 2 * value * by_crank, 2 * end[..., None] * end_by_size
        return points, *by[:2], ends, by[2], links, self.pairs / lengths[:, None, :]

    def __call__(self, which: Whole, x: Real, t: Real) -> Linearised:
        task, shared = self.task, 9 if self.task.free else 10
        x = _whole(x)
        cranks = task.cranks(x, t)
        moved = paths(x, cranks, self.branch[which], task.slides)
        off, by_size_of_point = task.root * (moved.point - task.wanted), task.root[:, None] * moved.by_size
        by_crank_of_point = task.root * moved.by_crank
        with np.errstate(divide="ignore", invalid="ignore"):
            points, by_size, by_crank, ends, ends_by_size, links, links_by_size = self.limits(which, x, cranks)
        here = points > 0
        blocks = np.stack([off.real, off.imag, self.weight * np.where(here, points, 0.0)], axis=-1)
        blocks[~np.isfinite(moved.point)] = np.nan
        by_shared = np.zeros((*off.shape, 3, shared))
        by_shared[:, :, 0, :9], by_shared[:, :, 1, :9] = by_size_of_point.real, by_size_of_point.imag
        by_shared[:, :, 2, :9] = self.weight * by_size * here[..., None]
        local = np.stack([by_crank_of_point.real, by_crank_of_point.imag, self.weight * by_crank * here], axis=-1)
        if not task.free:
            by_shared[..., START] = local
        reached, long = ends > 0, links > 0
        rest = self.weight * np.concatenate([np.where(reached, ends, 0.0), np.where(long, links, 0.0)], axis=1)
        rest_by = np.zeros((*rest.shape, shared))
        rest_by[:, :2, :9] = self.weight * ends_by_size * reached[..., None]
        rest_by[:, 2:, task.links] = self.weight * links_by_size * long[..., None]
        return Linearised(blocks, by_shared, local if task.free else None, rest, rest_by)

    def settled(self, which: Whole, x: Real, t: Real) -> Real:
        """Crank angles nearer to the points' nearest positions on the paths, which straightens the valleys of the
        search.
        """
        if not self.task.free:
            return t
        x = _whole(x)
        for _ in range(SETTLED):
            point, by_crank = along(x, t, self.branch[which], self.task.slides)
            with np.errstate(divide="ignore", invalid="ignore"):
                step = dot(by_crank, self.task.wanted - point) / np.abs(by_crank) ** 2
            t = t + np.where(np.abs(step) < 0.2, step, 0.0)
        return t

    def update(self, x: Real, t: Real) -> None:
        """Update the multipliers after a round."""
        x = _whole(x)
        with np.errstate(divide="ignore", invalid="ignore"):
            points, _, _, ends, _, links, _ = self.limits(np.arange(len(x)), x, self.task.cranks(x, t))
        self.at_points, self.at_ends, self.at_links = (
            np.maximum(np.nan_to_num(v, nan=0.0, posinf=0.0, neginf=0.0), 0.0) for v in (points, ends, links)
        )

    def some(self, which: Whole) -> Fit:
        """The residuals of some of the linkages."""
        fit = Fit(self.task, self.branch[which])
        fit.at_points, fit.at_ends, fit.at_links = (v[which] for v in (self.at_points, self.at_ends, self.at_links))
        return fit


def _whole(x: Real) -> Real:
    """Ten numbers per linkage; without a start if the crank angles are free."""
    return x if x.shape[1] == 10 else np.concatenate([x, np.zeros((len(x), 1))], axis=1)


def squares(task: PathTask, x: Real, t: Real, branch: Real) -> Real:
    """Weighted sums of squared distances (s,); infinite if a linkage does not close."""
    off = np.abs(task.root * (points_of(x, task.cranks(x, t), branch, task.slides) - task.wanted)) ** 2
    total = off.sum(axis=1)
    return np.where(np.isfinite(total), total, np.inf)


def polished_starts(task: PathTask, x: Real, t: Real, branch: Real, watch: Watch) -> tuple[Real, Real, Real]:
    """Starts x (s, 10), t (s, n) improved to their least squares within the limits: x, t and branch, the best first."""
    shared = 9 if task.free else 10
    low, high = task.low[:shared], task.high[:shared]
    fit, x = Fit(task, branch), x[:, :shared]
    for k in range(ROUNDS):
        x, t, sums = shared_least_squares(fit, x, t, low, high, STEPS if k < ROUNDS - 1 else LAST, watch)
        watch.report(0.3 + 0.7 * (k + 1) / ROUNDS)
        if watch.over():
            break
        if k in KEPT:
            best = np.argsort(sums, kind="stable")[: KEPT[k]]
            fit, x, t, sums = fit.some(best), x[best], t[best], sums[best]
        if task.free and task.closed:
            t = nearest_angles(task, _whole(x), t, fit.branch)
        if k < ROUNDS - 2:
            fit.update(x, t)
    x, t = settled_solutions(fit, x, t, low, high)
    return sorted_out(task, _whole(x), t, fit.branch)


def refined_starts(task: PathTask, x: Real, t: Real, branch: Real, watch: Watch) -> tuple[Real, Real, Real]:
    """`polished_starts` for a few starts that have nearly converged, such as results for fewer points."""
    shared = 9 if task.free else 10
    fit, x = Fit(task, branch), x[:, :shared]
    for k in range(REFINED):
        x, t, _ = shared_least_squares(fit, x, t, task.low[:shared], task.high[:shared], STEPS, watch)
        if watch.over():
            break
        if task.free and task.closed:
            t = nearest_angles(task, _whole(x), t, fit.branch)
        if k < REFINED - 2:
            fit.update(x, t)
    x, t = settled_solutions(fit, x, t, task.low[:shared], task.high[:shared])
    return sorted_out(task, _whole(x), t, fit.branch)


def sorted_out(task: PathTask, x: Real, t: Real, branch: Real) -> tuple[Real, Real, Real]:
    """Linkages within the limits, or moved there slightly, the best first."""
    x = np.array([_within(task, *row) for row in zip(x, t, branch)]).reshape(x.shape)
    fit = Fit(task, branch)
    for _ in range(4):
        t = fit.settled(np.arange(len(x)), x, t)
    total = squares(task, x, t, branch)
    fine = np.isfinite(total) & (task.passed(x, task.cranks(x, t)) <= PASSED)
    best = np.argsort(total, kind="stable")
    best = best[fine[best]]
    return x[best], t[best], branch[best]


def _within(task: PathTask, x: Real, t: Real, branch: float) -> Real:
    """The linkage x (10,) with the least change that brings it within the limits, which rounds may leave violated."""
    fit = Fit(task, np.array([branch]))
    low, high = task.low + 0.0, task.high
    for _ in range(RESTORED):
        with np.errstate(divide="ignore", invalid="ignore"):
            points, by_size, _, ends, ends_by, links, links_by = fit.limits(
                np.zeros(1, dtype=int), x[None], task.cranks(x[None], t[None])
            )
        by_links = np.zeros((links.shape[1], 9))
        by_links[:, task.links] = links_by[0]
        passed = np.concatenate([points[0], ends[0], links[0]])
        by = np.concatenate([by_size[0], ends_by[0], by_links])
        outside = passed > 0
        if not outside.any() or not np.isfinite(by[outside]).all() or passed.max() > FAR_OUTSIDE:
            break
        # Unknowns at a bound stay there.
        by = by[outside] * ((x[:9] > low[:9]) & (x[:9] < high[:9]))
        aim = passed[outside] + 1e-12
        x = x.copy()
        x[:9] = np.clip(x[:9] - np.linalg.lstsq(by, aim, rcond=1e-9)[0], low[:9], high[:9])
    return x


def nearest_angles(task: PathTask, x: Real, t: Real, branch: Real) -> Real:
    """Approximate crank angles (s, n) of the points of closed paths that are nearest to the wanted ones."""
    looks = 2 * np.pi * np.arange(LOOKS) / LOOKS
    path = points_of(x, np.broadcast_to(looks, (len(x), LOOKS)), branch, task.slides)
    # Squared distances less those of the wanted points from 0, as a product, which takes a quarter of the time.
    from_zero = np.abs(path) ** 2
    is_open = np.isnan(from_zero)
    path[is_open], from_zero[is_open] = 0.0, np.inf
    wanted, places = (np.stack([z.real, z.imag], axis=-1) for z in (task.wanted, path))
    at = np.argmin(from_zero[:, None, :] - 2 * wanted @ np.swapaxes(places, 1, 2), axis=2)
    found = nearest_from(task, x, looks[at], branch, REFINED_LOOKS)
    distances, now = (np.abs(points_of(x, cranks, branch, task.slides) - task.wanted) for cranks in (found, t))
    return np.where(distances < now, found, t)


def nearest_from(task: PathTask, x: Real, t: Real, branch: Real, steps: int = 20) -> Real:
    """Crank angles (s, n) at which the paths are nearest to the wanted points, found by steps from t."""
    for _ in range(steps):
        point, by_crank = along(x, t, branch, task.slides)
        miss = task.wanted - point
        with np.errstate(divide="ignore", invalid="ignore"):
            step = dot(by_crank, miss) / np.abs(by_crank) ** 2
        new = t + np.clip(step, -0.1, 0.1)
        nearer = np.abs(points_of(x, new, branch, task.slides) - task.wanted) < np.abs(miss)
        if not nearer.any():
            break
        t = np.where(nearer, new, t)
    return t
