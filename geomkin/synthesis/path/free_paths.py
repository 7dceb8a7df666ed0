"""Starts for untimed paths: tens of thousands of random coupler curves held against the wanted one."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...plane.vec import Complex, Real, Whole
from ...progress import Watch
from .coupler_paths import ARM_X, ARM_Y, COUPLER, CRANK, GROUND, ORIGIN_X, ORIGIN_Y, ROCKER, TURN, closing, points_of
from .fits import PathTask, nearest
from .random_linkages import random_linkages, unlike
from .timed_paths import linear_fit

# Curves tried, so many at a time; those whose points are fitted as well; those that are improved. Fewer curves miss
# rare shapes such as narrow eights; more take longer.
TRIED, AT_ONCE, FITTED, STARTS = 80_000, 4_000, 4_000, 400
# Points of an open path that are few.
FEW = 6
# Cranks at which a curve is worked out, and places at equal lengths of it that are compared.
CRANKS, PLACES = 64, 32


def free_starts(task: PathTask, rng: np.random.Generator, watch: Watch) -> tuple[Real, Real, Real]:
    """Linkages (s, 10), cranks (s, n) at the points and branches (s,): those whose curves are most alike.

    Curves are compared at equal shares of their length, turned, scaled and moved onto each other in closed form; a
    closed one from each place on, by Fourier transforms, in both senses. Derived here.
    """
    rows: list[tuple[Real, Real, Real, Real]] = []
    # Of few points nearly every linkage can be made to fit.
    tried = TRIED if len(task.wanted) > FEW else TRIED // 4
    for k in range(tried // AT_ONCE):
        if watch.over():
            break
        watch.tell(0.3 * k * AT_ONCE / tried)
        x = np.zeros((AT_ONCE, 10))
        x[:, [GROUND, CRANK, COUPLER, ROCKER]] = random_linkages(task, rng, AT_ONCE)
        arm = x[:, COUPLER] * (0.5 + rng.normal(size=AT_ONCE) + 1j * rng.normal(size=AT_ONCE))
        x[:, ARM_X], x[:, ARM_Y] = arm.real, arm.imag
        branch = rng.choice([-1.0, 1.0], AT_ONCE)
        start = rng.uniform(0, 2 * np.pi, AT_ONCE)
        way = np.where(rng.random(AT_ONCE) < 0.5, -1, 1) * rng.uniform(0.3, 2 * np.pi, AT_ONCE)
        if task.closed:
            start, way = np.zeros(AT_ONCE), np.full(AT_ONCE, 2 * np.pi)
        cranks = start[:, None] + way[:, None] * np.linspace(0, 1, CRANKS + 1)
        path = points_of(x, cranks, branch, task.slides)
        good = np.isfinite(path).all(axis=1)
        if not task.closed:
            good &= task.passed(x, cranks) < 0.05
        x, cranks, branch, path = x[good], cranks[good], branch[good], path[good]
        if len(x):
            placed, score, of = _closed(task, x, path) if task.closed else _open(task, x, path, cranks)
            best = np.argsort(score, kind="stable")[: FITTED * AT_ONCE // tried]
            rows.append((placed[best], of(best), branch[best], score[best]))
    if not rows:
        return np.zeros((0, 10)), np.zeros((0, len(task.wanted))), np.zeros(0)
    x, cranks, branch, _ = (np.concatenate(column) for column in zip(*rows))
    t = nearest(task, x, cranks, branch) if task.closed else cranks
    crank, coupler = closing(x, t, branch, task.slides)
    fitted, score = linear_fit(task, x, crank, coupler)
    chosen = unlike(fitted, branch, score, STARTS if len(task.wanted) > FEW else STARTS // 2)
    return fitted[chosen], t[chosen], branch[chosen]


def _placed(x: Real, turned: Complex, at: Complex, middle: Complex) -> Real:
    """The linkages turned and scaled by `turned` (s,), the middle of their paths brought to `at`."""
    found = x.copy()
    size = np.abs(turned)
    found[:, [GROUND, CRANK, COUPLER, ROCKER, ARM_X, ARM_Y]] *= size[:, None]
    origin = at - turned * middle
    found[:, ORIGIN_X], found[:, ORIGIN_Y], found[:, TURN] = origin.real, origin.imag, np.angle(turned)
    return found


def _evenly(path: Complex, ends: bool) -> tuple[Complex, Real]:
    """Places (s, PLACES) at equal shares of the paths' lengths, both ends or the first only, and the shares (s, k)."""
    length = np.cumsum(np.abs(np.diff(path, axis=1)), axis=1)
    share = np.concatenate([np.zeros((len(path), 1)), length], axis=1) / np.maximum(length[:, -1:], 1e-300)
    row = np.arange(len(path))[:, None]
    at = row + np.linspace(0, 1, PLACES, endpoint=ends) * (1 - 1e-9)
    return np.interp(at.ravel(), (row + share * (1 - 1e-9)).ravel(), path.ravel()).reshape(at.shape), share


def _closed(task: PathTask, x: Real, path: Complex) -> tuple[Real, Real, Callable[[Whole], Real]]:
    """The linkages placed, how unlike their closed paths are, and cranks at the points of some of them."""
    wanted = _evenly(loop(task.wanted)[None], False)[0][0]
    even = _evenly(path, False)[0]
    target, curves = np.fft.fft(wanted), np.fft.fft(even, axis=1)
    middle, at = curves[:, 0] / PLACES, target[0] / PLACES
    target[0], curves[:, 0] = 0, 0
    power = np.einsum("sn,sn->s", np.conj(curves), curves).real
    back = np.roll(curves[:, ::-1], 1, axis=1)
    both = np.concatenate([np.fft.ifft(np.conj(v) * target, axis=1) * PLACES for v in (curves, back)], axis=1)
    best = np.take_along_axis(both, np.argmax(np.abs(both), axis=1)[:, None], axis=1)[:, 0]
    with np.errstate(invalid="ignore", divide="ignore"):
        score = np.nan_to_num(1 - np.abs(best) ** 2 / (power * np.sum(np.abs(target) ** 2)), nan=np.inf)
        placed = _placed(x, best / power, at, middle)
    return placed, score, lambda rows: np.zeros((len(rows), len(task.wanted)))


def _open(task: PathTask, x: Real, path: Complex, cranks: Real) -> tuple[Real, Real, Callable[[Whole], Real]]:
    """The same of paths from end to end."""
    target, shares = _evenly(task.wanted[None], True)
    even, reached = _evenly(path, True)
    at, middle = target[0].mean(), even.mean(axis=1)
    target, even = target[0] - at, even - middle[:, None]
    power = np.einsum("sn,sn->s", np.conj(even), even).real
    with np.errstate(invalid="ignore", divide="ignore"):
        turned = np.conj(even) @ target / power
        score = np.nan_to_num(1 - np.abs(turned) ** 2 * power / np.sum(np.abs(target) ** 2), nan=np.inf)

    def t(rows: Whole) -> Real:
        row = np.arange(len(rows))[:, None]
        asked = row + shares * (1 - 1e-9)
        known = row + reached[rows] * (1 - 1e-9)
        return np.interp(asked.ravel(), known.ravel(), cranks[rows].ravel()).reshape(len(rows), -1)

    return _placed(x, turned, at, middle), score, t


def loop(points: Complex) -> Complex:
    """A smooth closed line (k,) through points in the order of a short tour, its end the start."""
    ahead = points[short_tour(points)]
    before, after, next_but_one = np.roll(ahead, 1), np.roll(ahead, -1), np.roll(ahead, -2)
    t = np.linspace(0, 1, 8, endpoint=False)[:, None]
    slope, slope_after = (after - before) / 2, (next_but_one - ahead) / 2
    bend = 2 * (ahead - after) + slope + slope_after
    line = ahead + t * (slope + t * (3 * (after - ahead) - 2 * slope - slope_after + t * bend))
    line = line.T.ravel()
    return np.append(line, line[0])


def short_tour(points: Complex) -> Whole:
    """An order (n,) in which points lie along a closed line: as given, or a tour by uncrossing if that is shorter."""
    far = np.abs(points[:, None] - points)

    def length(order: Whole) -> float:
        return float(far[order, np.roll(order, -1)].sum())

    given = np.arange(len(points))
    left, tour = set(range(1, len(points))), [0]
    while left:
        tour.append(min(left, key=lambda k: (far[tour[-1], k], k)))
        left.remove(tour[-1])
    order = np.array(tour)
    for _ in range(4 * len(points)):
        after = np.roll(order, -1)
        # What two lines of the tour are longer than those that join their starts, and their ends.
        gain = far[order, after][:, None] + far[order, after] - far[np.ix_(order, order)] - far[np.ix_(after, after)]
        i, j = np.unravel_index(np.argmax(np.triu(gain, 1)), gain.shape)
        if gain[i, j] <= 1e-9 * far.max():
            break
        order[i + 1 : j + 1] = order[i + 1 : j + 1][::-1].copy()
    # As it was given, unless that jumps to and fro: a curve that crosses itself has no shortest tour along it.
    return given if length(given) <= 1.3 * length(order) else order
