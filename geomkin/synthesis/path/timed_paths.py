"""Starts for timed paths: tens of thousands of linkages scored in closed form."""

from __future__ import annotations

import numpy as np

from ...plane.vec import Complex, Real
from ...progress import Watch
from .coupler_paths import ARM_X, ARM_Y, COUPLER, CRANK, GROUND, ORIGIN_X, ORIGIN_Y, ROCKER, START, TURN, closing
from .fits import PathTask
from .random_linkages import random_linkages, unlike

# Linkages scored, and those of them that are improved. Fewer miss the best of
# problems with many valleys; more take longer and find no better one.
SCORED = 60_000
STARTS = 140
# Points that are few: so many more starts are then improved in the same time, and more valleys need them.
FEW, MORE = 12, 300
# As many at a time: more do not fit into a processor's memory, fewer wait for Python.
AT_ONCE = 10_000


def timed_starts(task: PathTask, rng: np.random.Generator, watch: Watch) -> tuple[Real, Real]:
    """Linkages (s, 10) and branches (s,), the best of many.

    The coupler point is z + g B + h (C - B) with B, C the pins of a linkage of crank 1: linear in the complex z, g, h,
    which are fitted in closed form to each of the random linkages and starts of the crank. Derived here.
    """
    turns = np.zeros(0) if task.turns is None else task.turns
    found, scores, branches = [], [], []
    for k in range(SCORED // AT_ONCE):
        if watch.over():
            break
        watch.tell(0.3 * k * AT_ONCE / SCORED)
        x = np.zeros((AT_ONCE, 10))
        x[:, [GROUND, CRANK, COUPLER, ROCKER]] = random_linkages(task, rng, AT_ONCE)
        low, high = task.low[START], task.high[START]
        x[:, START] = rng.uniform(low, high, AT_ONCE) if high - low < 2 * np.pi else rng.uniform(0, 2 * np.pi, AT_ONCE)
        branch = rng.choice([-1.0, 1.0], AT_ONCE)
        crank, coupler = closing(x, x[:, START, None] + turns, branch, task.slides)
        good = np.isfinite(coupler).all(axis=1) & (task.passed(x, x[:, START, None] + turns) < 0.05)
        x, branch, crank, coupler = x[good], branch[good], crank[good], coupler[good]
        fitted, score = linear_fit(task, x, crank, coupler)
        best = np.argsort(score, kind="stable")[:MORE]
        found.append(fitted[best])
        scores.append(score[best])
        branches.append(branch[best])
    if not found:
        return np.zeros((0, 10)), np.zeros(0)
    x, score, branch = (np.concatenate(rows) for rows in (found, scores, branches))
    chosen = unlike(x, branch, score, STARTS if len(task.wanted) > FEW else MORE)
    return x[chosen], branch[chosen]


def linear_fit(task: PathTask, x: Real, crank: Complex, coupler: Complex) -> tuple[Real, Real]:
    """The linkages turned, scaled, placed and given the coupler point that fit best, and the sums of squares (s,).

    crank, coupler: their directions (s, n). Where bounds hold the pivot, it is held; the others are met by clipping.
    """
    placed = bool(np.all(task.low[[ORIGIN_X, ORIGIN_Y]] == task.high[[ORIGIN_X, ORIGIN_Y]]))
    pivot = complex(task.low[ORIGIN_X], task.low[ORIGIN_Y])
    one, two = x[:, CRANK, None] * crank, coupler
    wanted = np.broadcast_to(task.wanted, one.shape)
    middle = [pivot * np.ones(len(x)) if placed else wanted.mean(axis=1)]
    middle += [np.zeros(len(x)) if placed else v.mean(axis=1) for v in (one, two)]
    wanted, one, two = (v - m[:, None] for v, m in zip((wanted, one, two), middle))
    aa, bb = (np.einsum("sn,sn->s", v.real, v.real) + np.einsum("sn,sn->s", v.imag, v.imag) for v in (one, two))
    ab, aw, bw = (np.einsum("sn,sn->s", np.conj(p), q) for p, q in ((one, two), (one, wanted), (two, wanted)))
    with np.errstate(invalid="ignore", divide="ignore"):
        spread = aa * bb - np.abs(ab) ** 2
        # g scales and turns the linkage, h is the arm of the coupler point, turned with it.
        g = (bb * aw - ab * bw) / spread
        turned = np.angle(g)
        turned = turned + 2 * np.pi * np.ceil((task.low[TURN] - turned) / (2 * np.pi))
        beyond = turned > task.high[TURN]
        # Where bounds do not let it turn that far, it turns as far as they let it, and only its size is fitted.
        turned = np.where(beyond, np.where(turned - task.high[TURN] < np.pi, task.high[TURN], task.low[TURN]), turned)
        ahead = np.exp(1j * turned)
        size = ((bb * aw - ab * bw) * np.conj(ahead)).real / spread
        g = np.where(beyond, np.where(size > 0, size, np.nan) * ahead, g)
        h = (bw - np.conj(ab) * g) / bb
        off = wanted - g[:, None] * one - h[:, None] * two
        total = np.einsum("sn,sn->s", off.real, off.real) + np.einsum("sn,sn->s", off.imag, off.imag)
        total = np.where(np.isfinite(total) & (spread > 1e-9 * aa * bb), total, np.inf)
        origin = middle[0] - g * middle[1] - h * middle[2]
        arm = h * np.conj(g) / np.abs(g)
        found = x.copy()
        for link in (GROUND, CRANK, COUPLER, *(() if task.slides else (ROCKER,))):
            found[:, link] *= np.abs(g)
        found[:, TURN], found[:, ARM_X], found[:, ARM_Y] = turned, arm.real, arm.imag
        found[:, ORIGIN_X], found[:, ORIGIN_Y] = origin.real, origin.imag
        # A linkage that the bounds change much is no longer the one that was scored.
        held = np.clip(found, task.low, task.high)
        cut = np.abs(np.log(np.abs(found[:, list(task.links)] / held[:, list(task.links)]))).max(axis=1)
        score = np.where(np.isfinite(found).all(axis=1), total * (1 + cut) ** 2 + 0.01 * cut, np.inf)
    return found, score
