"""Candidates of function generators, from thousands to the few that are best."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...plane.vec import Real
from .generators import AbstractGenerator
from .mean_square import fit
from .minimax import descend, settled
from .peaks import AtPeaks, peaks

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


@dataclass(frozen=True, eq=False)
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
