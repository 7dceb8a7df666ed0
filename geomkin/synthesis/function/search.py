"""The least of the mean square error, under limits: many starts at once."""

from __future__ import annotations

import numpy as np

from ...core.records import record
from ...plane.vec import Mask, Real
from .generators import AbstractGenerator
from .minimax import DIFFERENCE, AbstractTask, descend, settled

# Nodes of the mean over the way, exact for polynomials of twice the degree. Fewer miss the error of a table's spline.
NODES = 48
# What a limit that is broken by 1 costs, squared; rounds in which the price of limits settles, steps in each. A lower
# price takes more rounds, a higher one more steps; fewer of these leave a limit broken by more than 1e-9.
STIFF, MEAN_SQUARE_ROUNDS, MEAN_SQUARE_STEPS = 10.0, 12, 8
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


# Half widths of the parabolas that a peak is followed by, one after the other. Wider, and they tell of more than the
# top; narrower, and rounding moves them.
WIDTHS = (2e-3, 2e-4)


def peaks(task: AbstractTask, p: Real, most: int, looks: int) -> tuple[Real, Real, Mask]:
    """Places s (many, most) at which |error| is largest between its neighbours, to rounding, and the errors there.

    looks: equal parts in which they are looked for. The largest are told; where there are fewer, the rest is the first
    place, and the third result says which are peaks.
    """
    s = np.linspace(0, 1, looks + 1)
    size = np.abs(task.error(p, s[None]))
    edge = np.full((len(p), 1), -np.inf)
    before, after = np.hstack([edge, size[:, :-1]]), np.hstack([size[:, 1:], edge])
    top = np.where((size >= before) & (size > after), size, -np.inf)
    k = np.sort(np.argsort(-top, axis=1)[:, :most], axis=1)
    real = np.isfinite(np.take_along_axis(top, k, 1))
    low, high = s[np.maximum(k - 1, 0)] * real, s[np.minimum(k + 1, looks)] * real
    # An eighth each time: from 1e-2 to where a flat top is level to rounding.
    for _ in range(8):
        places = low[..., None] + (high - low)[..., None] * np.linspace(0, 1, 17)
        e = np.abs(task.error(p, places.reshape(len(p), -1))).reshape(places.shape)
        at = np.argmax(e, axis=2)[..., None]
        low, best, high = (np.take_along_axis(places, np.clip(at + j, 0, 16), 2)[..., 0] for j in (-1, 0, 1))
    return best, task.error(p, best), real


@record(eq=False)
class AtPeaks(AbstractTask):
    """A task that is looked at on its peaks, which move with the candidate; the first `fixed` places stay.

    The derivative of a peak's height is that at its place; its curvature is not, which differences of derivatives at
    the place as it moves tell.
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
        """s with all but the fixed places moved to the tops of the parabolas there."""
        s = np.broadcast_to(s, (len(p), s.shape[1]))
        near = s[:, self.fixed :]
        for width in WIDTHS:
            middle = np.clip(near, width, 1 - width)
            places = np.concatenate([middle - width, middle, middle + width], axis=1)
            with np.errstate(all="ignore"):
                low, here, high = np.split(self.task.error(p, places), 3, axis=1)
                top = 0.5 * (low - high) / (low - 2 * here + high)
                ways = np.where(np.isfinite(top), np.clip(top, -2, 2), 0.0)
            near = np.clip(middle + width * ways, 0, 1)
        return np.concatenate([s[:, : self.fixed], near], axis=1)


# Fits over starts of any angle, and sizes spread over what the limits allow; how many of each are followed. Half of
# them find the same in every case tried; the rest are for those that were not.
FITS, SPREAD, FOLLOWED_FITS, FOLLOWED_SPREAD = 10_000, 40_000, 30, 18
# What breaking a limit costs a fit when it is chosen: more, and those are left out that lie near the best one at a
# limit; less, and such as cannot be mended are followed.
MILD = 0.3
# Two candidates are the same where no unknown differs by more: at the start, where a valley would fill the list, and
# at the end.
NEAR, SAME = 0.15, 1e-3
# Steps from a start, and in each round of the end; rounds of it; optima that are told.
STEPS, LAST_STEPS, ROUNDS, TOLD = 14, 15, 12, 12
# Share of the largest error by which peaks may differ from what was last seen of them: what their parabolas leave.
LEVELLED = 1e-9
# Share of the largest error that ends the first steps: what is left is had at the end.
NEARLY = 1e-4
# First step of the end's first round, in each next one a third: a larger one is made smaller again and again.
LAST_FIRST_STEP = 0.02
# Step at which a fit of least squares counts as one that rests: more are places on the floor of a valley.
NEARLY_RESTS = 1e-4
# Parts in which peaks of the error are looked for, and how many peaks are kept.
LOOKS, PEAKS = 256, 16
# Largest error, rad or ways of the slider, that is rounding: nothing is better than a linkage that follows exactly, as
# a parallelogram does, and its peaks mean nothing.
EXACT = 1e-11
# By how much a limit may be broken and yet count as kept: rounding of the last step.
KEPT = 1e-7


@record(eq=False)
class Optimum:
    """A candidate p (unknowns,) that no small step makes better.

    worst: its largest error; s, errors: its peaks; broken: by how much a limit is, 0 and less where all are kept.
    """

    p: Real
    worst: float
    s: Real
    errors: Real
    broken: float


def searched(task: AbstractGenerator, squares: bool) -> tuple[Optimum, ...]:
    """The optima found, the best first; where no limit could be kept, the one that breaks them least.

    squares: of the mean square error; else of the largest.
    """
    starts = _starts(task)
    if not len(starts):
        return ()
    if squares:
        found = _fitted(task, starts)
    else:
        found = starts
        for _ in range(2):
            found, value, _ = descend(task, found, _ends_close(33)[None], STEPS, gain_left=NEARLY)
            found = found[_distinct(task, found, value, TOLD, SAME)]
        found = _finished(task, found)
    found = task.rounded(found)
    s, errors, real = peaks(task, found, PEAKS, LOOKS)
    broken, worst = task.limits(found)[0].max(axis=1), np.abs(errors).max(axis=1)
    told = zip(found, worst.tolist(), s, errors, real, broken.tolist())
    optima = [Optimum(p, most, at[top], e[top], off) for p, most, at, e, top, off in told]
    kept = [one for one in optima if one.broken <= KEPT and np.isfinite(one.worst)]
    if not kept:
        return tuple(sorted(optima, key=lambda one: one.broken)[:1])
    if not squares:
        kept.sort(key=lambda one: one.worst)
        order = _distinct(task, np.stack([one.p for one in kept]), np.array([one.worst for one in kept]), TOLD, SAME)
        kept = [kept[k] for k in order]
    return tuple(kept)


def _ends_close(count: int) -> Real:
    """Places from 0 to 1, closer at the ends, where peaks of the error are."""
    even: Real = 0.5 - 0.5 * np.cos(np.linspace(0, np.pi, count))
    return even


def _starts(task: AbstractGenerator) -> Real:
    """The best of the fits and of the spread candidates, no two alike."""
    s = _ends_close(17)
    fits = task.fitted(FITS, np.array(task.through) if task.through else s)
    chosen = []
    for p, penalty, count in (
        (task.centred(fits, s) if not task.through else fits, MILD, FOLLOWED_FITS),
        (task.centred(task.spread(SPREAD), s), None, FOLLOWED_SPREAD),
    ):
        if len(p):
            value = task.merit(p, s[None], *(() if penalty is None else (penalty,)))
            chosen.append(p[_distinct(task, p, value, count, NEAR)])
    return np.concatenate(chosen) if chosen else np.empty((0, 6))


def _distinct(task: AbstractGenerator, p: Real, value: Real, count: int, apart: float) -> list[int]:
    """The best so many, none as near as `apart` to a better one."""
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
    """The same by the mean square error, the least first; those on their way yet are left out, bar the first."""
    for exact in (False, True):
        p, value, step = fit(task, p, exact)
        value = value + 1e3 * np.maximum(task.limits(p)[0].max(axis=1) - KEPT, 0)
        order = _distinct(task, p, value, TOLD, SAME)
        p, step = p[order], step[order]
    rests = step < NEARLY_RESTS
    rests[:1] = True
    return p[rests]


def _finished(task: AbstractGenerator, p: Real) -> Real:
    """Followed on with the places of their peaks added, until the peaks between the places are no higher."""
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
    p[fine] = settled(AtPeaks(task, even.shape[1]), p[fine], np.concatenate([even, last], axis=1)[fine])
    return p
