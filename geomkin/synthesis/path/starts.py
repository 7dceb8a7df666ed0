"""Starts of path searches: tens of thousands of random linkages, compared with the wanted curve in closed form."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...core.processes import Watch
from ...plane.vec import Complex, Real, Whole
from .closed_lines import evenly, loop
from .coupler_paths import (
    ARM_X,
    ARM_Y,
    COUPLER,
    CRANK,
    GROUND,
    ORIGIN_X,
    ORIGIN_Y,
    ROCKER,
    START,
    TURN,
    closing,
    points_of,
)
from .fits import PathTask, nearest_angles

# Share of random linkages whose crank turns fully, if a full turn is not required.
TURNING = 0.6
# Least transmission angle, rad, of random linkages; least squares hardly leave a toggle.
LEAST = np.radians(5)
# Largest ratio of lengths of random linkages; beyond it they hardly differ from slider-cranks.
WIDEST = 40.0
# Linkages are of one type if the logarithms of their lengths, and their arms, differ by less. With a larger value types
# are missing; with a smaller one most starts are of one type.
NEAR = 0.3
# For a timed path: number of linkages scored, and number improved. Fewer miss the best of problems with many valleys;
# more take longer and find no better one.
SCORED = 60_000
STARTS = 140
# Number of points below which more starts are improved, and how many more: few points take less time and have more
# valleys.
FEW_TIMED, MORE = 12, 300
# Batch size: larger batches do not fit the processor's cache, smaller ones cost Python overhead.
SCORED_AT_ONCE = 10_000
# For an untimed path: curves tried, batch size, curves whose points are fitted, and curves improved, of open and of
# closed paths. Fewer curves miss rare shapes such as narrow figures of eight; more take longer.
TRIED, TRIED_AT_ONCE, FITTED, IMPROVED, IMPROVED_CLOSED = 80_000, 4_000, 4_000, 400, 1_200
# Number of points below which an open path has few points.
FEW_OPEN = 6
# Crank angles at which a curve is computed, and points at equal arc lengths that are compared.
CRANKS, PLACES = 64, 32


def random_linkages(task: PathTask, rng: np.random.Generator, count: int) -> Real:
    """Random lengths (count, 4) with the crank 1: ground, crank, coupler, rocker, or offset, crank, coupler, 1.

    A four-bar whose crank turns fully is given by coupler, rocker and its two extreme transmission angles, which are
    random between the limits; others by random lengths. Derived here.
    """
    least, ratio = max(task.least_transmission, LEAST), min(task.largest_ratio, WIDEST)
    spread = np.log(ratio)
    turning = np.ones(count, dtype=bool) if task.closed else rng.random(count) < TURNING
    if task.slides:
        coupler = np.exp(rng.uniform(-0.3, 1, count) * spread * 0.7)
        reach = coupler * np.cos(least)
        offset = rng.uniform(-1, 1, count) * np.where(turning, np.maximum(reach - 1, 0.0), reach + 1)
        return np.stack([offset, np.ones(count), coupler, np.ones(count)], axis=1)
    b, c = np.exp(rng.uniform(-0.5, 0.5, (2, count)) * spread)
    first, second = np.sort(rng.uniform(least, np.pi - least, (2, count)), axis=0)
    near, far = (np.sqrt(b**2 + c**2 - 2 * b * c * np.cos(angle)) for angle in (first, second))
    ends = np.stack([far + near, far - near]) / 2
    ends = np.where(rng.random(count) < 0.75, ends, ends[::-1])
    made = np.stack([ends[0], ends[1], b, c], axis=1)
    drawn = np.exp(rng.uniform(-0.5, 0.5, (count, 4)) * spread)
    lengths = np.where(turning[:, None], made, drawn)
    return lengths / lengths[:, 1:2]


def unlike(x: Real, branch: Real, score: Real, count: int) -> Whole:
    """The best linkage of each type; similar ones would converge to the same result."""
    traits = np.concatenate(
        [
            np.log(np.abs(x[:, : ROCKER + 1]) + 1e-9),
            x[:, [ARM_X, ARM_Y]] / np.abs(x[:, COUPLER, None]),
            branch[:, None],
        ],
        axis=1,
    )
    left: Whole = np.argsort(score, kind="stable")
    chosen: list[int] = []
    left = left[np.isfinite(score[left])]
    while len(left) and len(chosen) < count:
        chosen.append(int(left[0]))
        left = left[np.abs(traits[left] - traits[left[0]]).max(axis=1) > NEAR]
    return np.array(chosen, dtype=int)


def timed_starts(task: PathTask, rng: np.random.Generator, watch: Watch) -> tuple[Real, Real]:
    """Linkages (s, 10) and branches (s,), the best of many.

    The coupler point is z + g B + h (C - B) with B, C the pins of a linkage of crank 1: linear in the complex z, g, h,
    which are fitted in closed form for random linkages and starts of the crank. Derived here.
    """
    turns = np.zeros(0) if task.turns is None else task.turns
    found, scores, branches = [], [], []
    for k in range(SCORED // SCORED_AT_ONCE):
        if watch.over():
            break
        watch.report(0.3 * k * SCORED_AT_ONCE / SCORED)
        x = np.zeros((SCORED_AT_ONCE, 10))
        x[:, [GROUND, CRANK, COUPLER, ROCKER]] = random_linkages(task, rng, SCORED_AT_ONCE)
        low, high = task.low[START], task.high[START]
        x[:, START] = (
            rng.uniform(low, high, SCORED_AT_ONCE)
            if high - low < 2 * np.pi
            else rng.uniform(0, 2 * np.pi, SCORED_AT_ONCE)
        )
        branch = rng.choice([-1.0, 1.0], SCORED_AT_ONCE)
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
    chosen = unlike(x, branch, score, STARTS if len(task.wanted) > FEW_TIMED else MORE)
    return x[chosen], branch[chosen]


def linear_fit(task: PathTask, x: Real, crank: Complex, coupler: Complex) -> tuple[Real, Real]:
    """Linkages with the best rotation, scale, position and coupler point, and the sums of squares (s,).

    `crank` and `coupler` are directions (s, n). A bounded pivot is kept; other bounds are met by clipping.
    """
    placed = bool(np.all(task.low[[ORIGIN_X, ORIGIN_Y]] == task.high[[ORIGIN_X, ORIGIN_Y]]))
    pivot = complex(task.low[ORIGIN_X], task.low[ORIGIN_Y])
    one, two = x[:, CRANK, None] * crank, coupler
    wanted = np.broadcast_to(task.wanted, one.shape)
    means = (pivot * np.ones(len(x)), *np.zeros((2, len(x))))
    middle = means if placed else [np.average(v, axis=1, weights=task.weights) for v in (wanted, one, two)]
    wanted, one, two = (task.root * (v - m[:, None]) for v, m in zip((wanted, one, two), middle))
    aa, bb = (np.einsum("sn,sn->s", v.real, v.real) + np.einsum("sn,sn->s", v.imag, v.imag) for v in (one, two))
    ab, aw, bw = (np.einsum("sn,sn->s", np.conj(p), q) for p, q in ((one, two), (one, wanted), (two, wanted)))
    with np.errstate(invalid="ignore", divide="ignore"):
        spread = aa * bb - np.abs(ab) ** 2
        # g scales and turns the linkage, h is the arm of the coupler point, turned with it.
        g = (bb * aw - ab * bw) / spread
        turned = np.angle(g)
        turned = turned + 2 * np.pi * np.ceil((task.low[TURN] - turned) / (2 * np.pi))
        beyond = turned > task.high[TURN]
        # If bounds limit the rotation, it is clipped, and only the size is fitted.
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
        # A linkage that the bounds change much differs from the one that was scored.
        held = np.clip(found, task.low, task.high)
        cut = np.abs(np.log(np.abs(found[:, list(task.links)] / held[:, list(task.links)]))).max(axis=1)
        score = np.where(np.isfinite(found).all(axis=1), total * (1 + cut) ** 2 + 0.01 * cut, np.inf)
    return found, score


def free_starts(task: PathTask, rng: np.random.Generator, watch: Watch) -> tuple[Real, Real, Real]:
    """Linkages (s, 10), crank angles (s, n) at the points and branches (s,) of the most similar curves.

    Curves are compared at equal shares of their length after the best rotation, scaling and shift in closed form;
    closed ones from every starting point and in both senses, by Fourier transforms. Derived here.
    """
    rows: list[tuple[Real, Real, Real, Real]] = []
    # Few points can be fitted by nearly every linkage.
    tried = TRIED if len(task.wanted) > FEW_OPEN else TRIED // 4
    for k in range(tried // TRIED_AT_ONCE):
        if watch.over():
            break
        watch.report(0.3 * k * TRIED_AT_ONCE / tried)
        x = np.zeros((TRIED_AT_ONCE, 10))
        x[:, [GROUND, CRANK, COUPLER, ROCKER]] = random_linkages(task, rng, TRIED_AT_ONCE)
        arm = x[:, COUPLER] * (0.5 + rng.normal(size=TRIED_AT_ONCE) + 1j * rng.normal(size=TRIED_AT_ONCE))
        x[:, ARM_X], x[:, ARM_Y] = arm.real, arm.imag
        branch = rng.choice([-1.0, 1.0], TRIED_AT_ONCE)
        start = rng.uniform(0, 2 * np.pi, TRIED_AT_ONCE)
        span = np.where(rng.random(TRIED_AT_ONCE) < 0.5, -1, 1) * rng.uniform(0.3, 2 * np.pi, TRIED_AT_ONCE)
        if task.closed:
            start, span = np.zeros(TRIED_AT_ONCE), np.full(TRIED_AT_ONCE, 2 * np.pi)
        cranks = start[:, None] + span[:, None] * np.linspace(0, 1, CRANKS + 1)
        path = points_of(x, cranks, branch, task.slides)
        good = np.isfinite(path).all(axis=1)
        if not task.closed:
            good &= task.passed(x, cranks) < 0.05
        x, cranks, branch, path = x[good], cranks[good], branch[good], path[good]
        if len(x):
            placed, score, of = _closed(task, x, path, branch) if task.closed else _open(task, x, path, cranks)
            best = np.argsort(score, kind="stable")[: FITTED * TRIED_AT_ONCE // tried]
            rows.append((placed[best], of(best), branch[best], score[best]))
    if not rows:
        return np.zeros((0, 10)), np.zeros((0, len(task.wanted))), np.zeros(0)
    x, t, branch, _ = (np.concatenate(column) for column in zip(*rows))
    crank, coupler = closing(x, t, branch, task.slides)
    fitted, score = linear_fit(task, x, crank, coupler)
    improved = IMPROVED_CLOSED if task.closed else IMPROVED
    chosen = unlike(fitted, branch, score, improved if len(task.wanted) > FEW_OPEN else improved // 2)
    return fitted[chosen], t[chosen], branch[chosen]


def _placed(x: Real, turned: Complex, at: Complex, middle: Complex) -> Real:
    """The linkages rotated and scaled by `turned` (s,), with the middle of their paths at `at`."""
    placed = x.copy()
    size = np.abs(turned)
    placed[:, [GROUND, CRANK, COUPLER, ROCKER, ARM_X, ARM_Y]] *= size[:, None]
    origin = at - turned * middle
    placed[:, ORIGIN_X], placed[:, ORIGIN_Y], placed[:, TURN] = origin.real, origin.imag, np.angle(turned)
    return placed


def _closed(task: PathTask, x: Real, path: Complex, branch: Real) -> tuple[Real, Real, Callable[[Whole], Real]]:
    """The placed linkages, the difference of their closed paths, and a function for the crank angles at the points."""
    wanted = evenly(loop(task.wanted)[None], PLACES)[0][0]
    even = evenly(path, PLACES)[0]
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
    at_zero = np.zeros((len(x), len(task.wanted)))
    return placed, score, lambda rows: nearest_angles(task, placed[rows], at_zero[rows], branch[rows])


def _open(task: PathTask, x: Real, path: Complex, cranks: Real) -> tuple[Real, Real, Callable[[Whole], Real]]:
    """`_closed` for open paths."""
    target, shares = evenly(task.wanted[None], PLACES, True)
    even, reached = evenly(path, PLACES, True)
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
