"""Search for function generators: least mean square error under limits for many starts, then peaks and minimax."""

from __future__ import annotations

import numpy as np

from ...core.records import record
from ...plane.vec import Mask, Real
from .generators import AbstractGenerator
from .minimax import DIFFERENCE, AbstractTask, descend, settled_candidates

# Nodes of the mean over the range, exact for polynomials of twice the degree. Fewer miss the error of a table's spline.
NODES = 48
# Squared cost of a limit violated by 1; rounds in which the prices of limits converge; steps per round. A lower cost
# takes more rounds, a higher one more steps; with fewer, limits are violated by more than 1e-9.
STIFF, MEAN_SQUARE_ROUNDS, MEAN_SQUARE_STEPS = 10.0, 12, 8
# Longest step of an unknown: logarithms of lengths, and rad.
LONGEST_STEP = 0.5


def fitted_candidates(task: AbstractTask, p: Real, exact: bool) -> tuple[Real, Real, Real]:
    """Candidates p (many, unknowns) improved to the least mean square error: p, its root, the last step (many,).

    Levenberg-Marquardt for the errors and violated limits, whose prices are raised round by round (augmented
    Lagrangian: Powell 1969, Hestenes 1969). `exact` includes the curvature of the errors, which converges to rounding
    also in a valley at ten times the cost of a step. inf if a candidate is impossible.
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
        values, vectors = np.linalg.eigh(0.5 * (np.stack(columns, 1) + np.stack(columns, 2)))
        # With the absolute values of the curvatures the step descends also where a curvature is negative.
        positive: Real = (vectors * np.abs(values)[:, None]) @ np.swapaxes(vectors, 1, 2)
        return positive

    with np.errstate(all="ignore"):
        for _ in range(MEAN_SQUARE_ROUNDS):
            r = parts(p)
            for _ in range(MEAN_SQUARE_STEPS):
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


# Half widths of the successive parabolas that locate a peak. Wider ones include more than the top; in narrower ones
# rounding dominates.
WIDTHS = (2e-3, 2e-4)


def peaks(task: AbstractTask, p: Real, most: int, looks: int) -> tuple[Real, Real, Mask]:
    """Positions s (many, most) of local maxima of |error|, to rounding, and the errors there.

    The range is sampled in `looks` equal parts. The largest peaks are given; unused entries repeat the first position,
    and the third result masks the real ones.
    """
    s = np.linspace(0, 1, looks + 1)
    size = np.abs(task.error(p, s[None]))
    edge = np.full((len(p), 1), -np.inf)
    before, after = np.hstack([edge, size[:, :-1]]), np.hstack([size[:, 1:], edge])
    top = np.where((size >= before) & (size > after), size, -np.inf)
    k = np.sort(np.argsort(-top, axis=1)[:, :most], axis=1)
    real = np.isfinite(np.take_along_axis(top, k, 1))
    low, high = s[np.maximum(k - 1, 0)] * real, s[np.minimum(k + 1, looks)] * real
    # An eighth each time, from 1e-2 to the width at which a flat maximum is level to rounding.
    for _ in range(8):
        places = low[..., None] + (high - low)[..., None] * np.linspace(0, 1, 17)
        e = np.abs(task.error(p, places.reshape(len(p), -1))).reshape(places.shape)
        at = np.argmax(e, axis=2)[..., None]
        low, best, high = (np.take_along_axis(places, np.clip(at + j, 0, 16), 2)[..., 0] for j in (-1, 0, 1))
    return best, task.error(p, best), real


@record(eq=False)
class AtPeaks(AbstractTask):
    """A task evaluated at its peaks, which move with the candidate; the first `fixed` positions stay.

    The derivative of a peak's height is that at its position; its curvature is not, and follows from differences of
    derivatives at the moving position.
    """

    task: AbstractTask
    fixed: int

    @property
    def free(self) -> Mask:
        return self.task.free

    def error(self, p: Real, s: Real) -> Real:
        return self.task.error(p, self._moved(p, s))

    def slopes(self, p: Real, s: Real) -> Real:
        return self.task.slopes(p, self._moved(p, s))

    def limits(self, p: Real) -> tuple[Real, Real]:
        return self.task.limits(p)

    def _moved(self, p: Real, s: Real) -> Real:
        """s with all but the fixed positions moved to the tops of the parabolas there."""
        s = np.broadcast_to(s, (len(p), s.shape[1]))
        near = s[:, self.fixed :]
        for width in WIDTHS:
            middle = np.clip(near, width, 1 - width)
            places = np.concatenate([middle - width, middle, middle + width], axis=1)
            with np.errstate(all="ignore"):
                low, here, high = np.split(self.task.error(p, places), 3, axis=1)
                top = 0.5 * (low - high) / (low - 2 * here + high)
                shares = np.where(np.isfinite(top), np.clip(top, -2, 2), 0.0)
            near = np.clip(middle + width * shares, 0, 1)
        return np.concatenate([s[:, : self.fixed], near], axis=1)


# Fits over all start angles, sizes spread within the limits, and how many of each are improved. Half of them give the
# same result in every case tried; the rest are a reserve.
FITS, SPREAD, FOLLOWED_FITS, FOLLOWED_SPREAD = 10_000, 40_000, 30, 18
# Cost of violated limits when fits are selected: a higher one drops fits near the best one at a limit; a lower one
# keeps fits that cannot be repaired.
SELECTION_COST = 0.3
# Largest difference of unknowns of equal candidates: at the start, so that one valley does not fill the list, and at
# the end.
NEAR, SAME = 0.15, 1e-3
# Steps from a start, steps per final round, final rounds, and number of reported optima.
STEPS, LAST_STEPS, ROUNDS, MOST_REPORTED = 14, 15, 12, 12
# Share of the largest error by which peaks may change between rounds: the inaccuracy of their parabolas.
LEVELLED = 1e-9
# Share of the largest error at which the first steps end; the final rounds reduce the rest.
NEARLY = 1e-4
# First step of the first final round, a third in each following one; a larger one would be reduced repeatedly.
LAST_FIRST_STEP = 0.02
# Step below which a least-squares fit has converged; longer steps move along a valley.
NEARLY_RESTS = 1e-4
# Parts in which peaks of the error are searched for, and largest number of peaks.
LOOKS, PEAKS = 256, 16
# Largest error, rad or relative to the travel, that counts as rounding: nothing is better than a linkage that follows
# exactly, such as a parallelogram, and its peaks have no meaning.
EXACT = 1e-11
# Largest violation of a limit that counts as kept: rounding of the last step.
KEPT = 1e-7


@record(eq=False)
class LocalOptimum:
    """A candidate p (unknowns,) that no small step improves.

    `worst`: its largest error; `s`, `errors`: its peaks; `broken`: the largest violation of a limit, at most 0 if all
    are kept.
    """

    p: Real
    worst: float
    s: Real
    errors: Real
    broken: float


def best_candidates(task: AbstractGenerator, squares: bool) -> tuple[LocalOptimum, ...]:
    """The optima, the best first; if no limit can be kept, the one with the least violation.

    `squares` selects the mean square error instead of the largest.
    """
    starts = _starts(task)
    if not len(starts):
        return ()
    if squares:
        candidates = _fitted(task, starts)
    else:
        candidates = starts
        for _ in range(2):
            candidates, value, _ = descend(task, candidates, _ends_close(33)[None], STEPS, gain_left=NEARLY)
            candidates = candidates[_distinct(task, candidates, value, MOST_REPORTED, SAME)]
        candidates = _finished(task, candidates)
    candidates = task.rounded(candidates)
    s, errors, real = peaks(task, candidates, PEAKS, LOOKS)
    broken, worst = task.limits(candidates)[0].max(axis=1), np.abs(errors).max(axis=1)
    rows = zip(candidates, worst.tolist(), s, errors, real, broken.tolist())
    optima = [LocalOptimum(p, most, at[top], e[top], off) for p, most, at, e, top, off in rows]
    feasible = [optimum for optimum in optima if optimum.broken <= KEPT and np.isfinite(optimum.worst)]
    if not feasible:
        return tuple(sorted(optima, key=lambda one: one.broken)[:1])
    if not squares:
        feasible.sort(key=lambda one: one.worst)
        order = _distinct(
            task,
            np.stack([optimum.p for optimum in feasible]),
            np.array([optimum.worst for optimum in feasible]),
            MOST_REPORTED,
            SAME,
        )
        feasible = [feasible[k] for k in order]
    return tuple(feasible)


def _ends_close(count: int) -> Real:
    """Positions from 0 to 1, denser at the ends, where the peaks are."""
    even: Real = 0.5 - 0.5 * np.cos(np.linspace(0, np.pi, count))
    return even


def _starts(task: AbstractGenerator) -> Real:
    """The best distinct fits and spread candidates."""
    s = _ends_close(17)
    fits = task.fitted(FITS, np.array(task.through) if task.through else s)
    chosen = []
    for p, penalty, count in (
        (task.centred(fits, s) if not task.through else fits, SELECTION_COST, FOLLOWED_FITS),
        (task.centred(task.spread(SPREAD), s), None, FOLLOWED_SPREAD),
    ):
        if len(p):
            value = task.merit(p, s[None], *(() if penalty is None else (penalty,)))
            chosen.append(p[_distinct(task, p, value, count, NEAR)])
    return np.concatenate(chosen) if chosen else np.empty((0, 6))


def _distinct(task: AbstractGenerator, p: Real, value: Real, count: int, apart: float) -> list[int]:
    """The best so many, each farther than `apart` from all better ones."""
    left, chosen = np.isfinite(value), []
    for k in np.argsort(value, kind="stable").tolist():
        if left[k]:
            chosen.append(k)
            gap = p - p[k]
            turns = gap[:, task.angles] / (2 * np.pi)
            gap[:, task.angles] -= 2 * np.pi * np.round(turns)
            left &= np.abs(gap).max(axis=1) > apart
            if len(chosen) == count:
                break
    return chosen


def _fitted(task: AbstractGenerator, p: Real) -> Real:
    """Fits by the mean square error, the least first; those that have not converged are left out, except the first."""
    for exact in (False, True):
        p, value, step = fitted_candidates(task, p, exact)
        value = value + 1e3 * np.maximum(task.limits(p)[0].max(axis=1) - KEPT, 0)
        order = _distinct(task, p, value, MOST_REPORTED, SAME)
        p, step = p[order], step[order]
    rests = step < NEARLY_RESTS
    rests[:1] = True
    return p[rests]


def _finished(task: AbstractGenerator, p: Real) -> Real:
    """Improve candidates, adding the positions of their peaks until no peak in between is higher."""
    even = np.tile(_ends_close(49), (len(p), 1))
    last = np.zeros((len(p), PEAKS))
    seen, rests = np.full(len(p), np.inf), np.zeros(len(p), bool)
    for k in range(ROUNDS):
        s, e, _ = peaks(task, p, PEAKS, LOOKS)
        worst = np.abs(e).max(axis=1)
        go = np.isfinite(worst) & (worst > EXACT) & ~(rests & (np.abs(seen - worst) <= LEVELLED * worst))
        if not go.any():
            break
        places = np.concatenate([even[go], s[go]], axis=1)
        last[go] = s[go]
        p[go], seen[go], rests[go] = descend(
            AtPeaks(task, even.shape[1]), p[go], places, LAST_STEPS, LAST_FIRST_STEP * 0.3**k
        )
    fine = np.isfinite(task.merit(p, even))
    p[fine] = settled_candidates(AtPeaks(task, even.shape[1]), p[fine], np.concatenate([even, last], axis=1)[fine])
    return p
