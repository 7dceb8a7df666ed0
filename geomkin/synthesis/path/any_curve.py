"""Four- to eight-bars whose traced points follow a closed curve, both ways: from the curve and to the curve.

Random chains with similar curves are refined by least squares, all at once, in rounds that keep the best; better ones
grow from chains with two bars less. The work depends on the seed alone.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...core.processes import Watch
from ...core.records import record
from ...plane.vec import Complex, Mask, Real, Whole, cross, dot
from .closed_lines import evenly
from .curve_library import LIMITED, CurveLibrary, TargetCurve, TimedPoints, closed_paths, curve_library
from .dyad_chains import CRANK, GROUND, PER_DYAD, ChainMotion, Chains, extended, joined, stacks, traced

# Distance of the search's limits from the wanted ones: a margin in deg, a factor of the ratio of lengths, and a share
# of bounded lengths.
MARGIN_DEG, MARGIN_RATIO, MARGIN_LINK = 1.0, 0.98, 0.01
# Pins of one body are at least this share of the shortest link apart, so that their holes can be cut.
APART = 0.4
# Largest step of the logarithm of a length, of a crank angle, rad, and of a place on the curve, as a share of it.
LONGEST_STEP, CRANK_STEP, PLACE_STEP = 0.5, 0.15, 0.02
# Steps to the nearest place of a path.
NEAREST_STEPS = 6
# Least sine of a transmission angle; a step beyond it is refused.
TOGGLE = 0.03
# Chains refined at once: more do not fit the processor's cache.
AT_ONCE = 24


# Lower left and upper right corner.
Box = tuple[complex, complex]
ANYWHERE: Box = (complex(-np.inf, -np.inf), complex(np.inf, np.inf))


@record
class ChainBounds:
    """Where the crank pivot and the other ground pivots may be, and least and greatest distance of pins, mm."""

    crank: Box = ANYWHERE
    pivots: Box = ANYWHERE
    links: tuple[float, float] = (0.0, np.inf)

    def scaled(self, scale: float, middle: complex) -> ChainBounds:
        """The bounds in units of `scale` about a middle."""
        crank, pivots = (
            (_corner(low, scale, middle), _corner(high, scale, middle)) for low, high in (self.crank, self.pivots)
        )
        return ChainBounds(crank, pivots, (self.links[0] / scale, self.links[1] / scale))


def _corner(place: complex, scale: float, middle: complex) -> complex:
    # Its parts may be infinite, so that complex arithmetic would give nan.
    return complex((place.real - middle.real) / scale, (place.imag - middle.imag) / scale)


@record(eq=False)
class CurveTask:
    """A wanted curve and the limits of chains for it.

    target: the curve. least_deg: transmission angle. ratio: longest link over the shortest. bounds: in units of the
    search. timed: points at given crank angles, instead of the curve.
    """

    target: TargetCurve
    least_deg: float
    ratio: float
    bounds: ChainBounds
    timed: TimedPoints | None = None

    def timed_state(self, timed: TimedPoints, chains: Chains, starts: Real) -> State:
        """The chains at the angles of timed points."""
        cranks = timed.cranks(starts)
        return State(self.within(chains), cranks, np.zeros(cranks.shape))

    def within(self, chains: Chains) -> Chains:
        """The chains with ground pivots moved into their boxes."""
        x = chains.x.copy()
        for k in range(chains.head):
            x[:, k] = _clipped(x[:, k], self.bounds.pivots if k > 1 else self.bounds.crank, k % 2)
        parts = x[:, chains.head : -2].reshape(len(x), chains.dyads, PER_DYAD)
        for k in (0, 1, 2, 3):
            parts[..., k] = np.where(
                chains.bodies[..., k // 2] == GROUND, _clipped(parts[..., k], self.bounds.pivots, k % 2), parts[..., k]
            )
        x[:, chains.head : -2] = parts.reshape(len(x), chains.dyads * PER_DYAD)
        return replace(chains, x=x)


def _clipped(values: Real, box: Box, axis: int) -> Real:
    low, high = ((z.imag if axis else z.real) for z in box)
    return np.clip(values, low, high)


def lengths(chains: Chains, derivatives: bool = True) -> tuple[Real, Real, Mask, Mask]:
    """Logarithms (s, m) of all lengths, their derivatives (s, m, p), which of them are links, and which exist.

    A length is a link, the distance of a ground pivot from the crank pivot, that of a crank pin from its pivot, or the
    distance of any two pins of a body.
    """
    s, n, p = len(chains), chains.dyads, chains.x.shape[1]
    bodies, pins = chains.bodies.reshape(s, 2 * n), chains.pins.reshape(s, 2 * n)
    logs = chains.logs.reshape(s, 2 * n)
    pivot = chains.x[:, 0] + 1j * chains.x[:, 1]
    # Each pin against the two fixed pins of its body, then against each pin before it.
    starts = [np.where(bodies == GROUND, pivot[:, None], 0), np.where(bodies == GROUND, pivot[:, None], bodies > CRANK)]
    other = [np.full(2 * n, -1), np.full(2 * n, -1)]
    pairs = [(a, b) for a in range(2 * n) for b in range(a)]
    first = np.array([*range(2 * n), *range(2 * n), *(a for a, _ in pairs)])
    second = np.array([*other[0], *other[1], *(b for _, b in pairs)])
    start = np.concatenate([*starts, pins[:, second[4 * n :]]], axis=1)
    apart = pins[:, first] - start
    body = bodies[:, first]
    here = np.ones(apart.shape, dtype=bool)
    here[:, 4 * n :] = body[:, 4 * n :] == bodies[:, second[4 * n :]]
    here[:, 2 * n : 4 * n] = body[:, 2 * n : 4 * n] > CRANK
    here &= np.abs(apart) > 1e-12
    is_link = np.zeros(apart.shape, dtype=bool)
    is_link[:, : 2 * n] = body[:, : 2 * n] <= CRANK
    row, scaled = np.arange(s)[:, None], body > CRANK
    of = np.where(scaled, body - 2, 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        value = np.where(here, np.log(np.abs(apart)) + np.where(scaled, logs[row, of], 0), 0)
        by_pin = np.where(here, apart / np.abs(apart) ** 2, 0)
    value = np.concatenate([logs, value], axis=1)
    here = np.concatenate([np.ones((s, 2 * n), dtype=bool), here], axis=1)
    is_link = np.concatenate([np.ones((s, 2 * n), dtype=bool), is_link], axis=1)
    by = np.zeros((s, value.shape[1], p))
    if derivatives:
        at_log = chains.head + PER_DYAD * (np.arange(2 * n) // 2) + 4 + np.arange(2 * n) % 2
        at_pin = chains.head + PER_DYAD * (np.arange(2 * n) // 2) + 2 * (np.arange(2 * n) % 2)
        by[:, np.arange(2 * n), at_log] = 1
        m = 2 * n + np.arange(apart.shape[1])
        by[row, m, at_pin[first]], by[row, m, at_pin[first] + 1] = by_pin.real, by_pin.imag
        k = np.flatnonzero(second >= 0)
        by[row, m[k], at_pin[second[k]]], by[row, m[k], at_pin[second[k]] + 1] = -by_pin[:, k].real, -by_pin[:, k].imag
        on_ground = (body == GROUND) & (second < 0)
        by[:, m, 0], by[:, m, 1] = (np.where(on_ground, -part, 0) for part in (by_pin.real, by_pin.imag))
        by[row, m, at_log[of]] += scaled & here[:, 2 * n :]
    if chains.is_geared:
        between = chains.x[:, 2] + 1j * chains.x[:, 3] - pivot
        part, one = between / np.abs(between) ** 2, np.ones((s, 1), dtype=bool)
        value = np.append(value, np.log(np.abs(between))[:, None], axis=1)
        more = np.zeros((s, 1, p))
        more[:, 0, :4] = np.stack([-part.real, -part.imag, part.real, part.imag], axis=1)
        by, is_link, here = np.append(by, more, axis=1), np.append(is_link, one, axis=1), np.append(here, one, axis=1)
    return value, by, is_link, here


@record(eq=False)
class State:
    """Chains with samples (s, T): half of them at equal crank angles, half at equal places of the curve.

    `cranks`: crank angles; `places`: shares of the curve's length, the nearest as far as they are not equal.
    """

    chains: Chains
    cranks: Real
    places: Real

    def __len__(self) -> int:
        return len(self.chains)

    def __getitem__(self, rows: Whole | slice) -> State:
        return State(self.chains[rows], self.cranks[rows], self.places[rows])

    def resampled(self, samples: int) -> State:
        """The same with so many samples, whose places and crank angles are interpolated; with 0 as they are."""
        before, half = self.cranks.shape[1] // 2, samples // 2
        if half in (0, before):
            return self
        sense = np.sign(self.places[:, before - 1] - self.places[:, 0])[:, None]
        old, new = np.arange(before) / before, np.arange(half) / half
        # Both grow by one in a turn, or fall; the rest is periodic.
        floating = self.places[:, :before] - sense * old, np.unwrap(self.cranks[:, before:]) / (2 * np.pi) - sense * old
        places, cranks = (
            np.array([np.interp(new, old, row, period=1) for row in rest]).reshape(-1, half) + sense * new
            for rest in floating
        )
        equal = np.broadcast_to(new, places.shape)
        return State(
            self.chains, 2 * np.pi * np.concatenate([equal, cranks], axis=1), np.concatenate([places, equal], axis=1)
        )


def joined_states(states: list[State]) -> State:
    """All of several batches with one number of dyads and of samples."""
    cranks, places = (np.concatenate([getattr(one, name) for one in states]) for name in ("cranks", "places"))
    return State(joined([one.chains for one in states]), cranks, places)


@record(eq=False)
class CurveFit:
    """Normal equations of s chains: cost (s,), gradient (s, p), square (s, p, p); point, tangents, and derivatives."""

    cost: Real
    gradient: Real
    square: Real
    traced: Complex
    by: Complex


@record(eq=False)
class Level:
    """Powers of distances instead of their squares: the power, and the unit (s, 1) of the distances."""

    power: int
    unit: Real


def matched(task: CurveTask, chains: Chains, samples: int) -> State:
    """The chains with samples matched to the curve by arc length, from the best start, in the best sense."""
    s, half = len(chains), samples // 2
    angles = 4 * half
    path = closed_paths(chains, angles)
    # One that does not close has an infinite cost, whatever its places.
    path[~np.isfinite(path).all(axis=1)] = np.exp(2j * np.pi * np.arange(angles + 1) / angles)
    even, share = evenly(path, half)
    target = task.target.at(np.arange(half) / half)[0]
    middle = even.mean(axis=1)[:, None]
    harmonics = np.fft.fft(even - middle, axis=1)
    best, start, sense = np.zeros(s), np.zeros(s), np.ones(s)
    for way, wanted in ((1, target), (-1, np.roll(target[::-1], 1))):
        fits = np.fft.ifft(np.conj(harmonics) * np.fft.fft(wanted - wanted.mean()), axis=1).real
        top = fits.max(axis=1)
        better = top > best if way < 0 else np.ones(s, dtype=bool)
        # The curve is at `at` where the path starts; backwards the curve's places fall.
        at = np.argmax(fits, axis=1) / half
        start, sense, best = (np.where(better, a, b) for a, b in ((way * at, start), (way, sense), (top, best)))
    equal = np.broadcast_to(np.arange(half) / half, (s, half))
    places = start[:, None] + sense[:, None] * share[:, : -1 : angles // half]
    asked = (sense[:, None] * (equal - start[:, None])) % 1.0
    row = 2 * np.arange(s)[:, None]
    crank = np.interp(
        (row + asked).ravel(),
        (row + share * (1 - 1e-9)).ravel(),
        np.broadcast_to(2 * np.pi * np.arange(angles + 1) / angles, share.shape).ravel(),
    )
    cranks = np.concatenate([2 * np.pi * equal, crank.reshape(s, half)], axis=1)
    return State(chains, cranks, np.concatenate([places, equal], axis=1))


def linearised(task: CurveTask, state: State, along: float, limits: float, level: Level | None = None) -> CurveFit:
    """The normal equations: distances across the curve and across the path, a share of those along them, and limits."""
    moved = traced(state.chains, state.cranks)
    place, direction, root, heavy = _aims(task, state, moved) if task.timed is None else _timed_aims(task.timed)
    turned = heavy * np.conj(direction)
    off, by = (moved.point - place) * turned, moved.by[:, 1:] * turned[:, None]
    across, across_by = off.imag, by.imag
    if level is not None:
        # Squares of these residuals are powers of the distances.
        with np.errstate(over="ignore", invalid="ignore"):
            slope = (np.abs(across) / level.unit) ** (level.power / 2 - 1)
        across, across_by = across * slope, across_by * (level.power / 2 * slope)[:, None]
    residual = np.concatenate([across * root, along * off.real * root], axis=1)
    jacobian = np.concatenate([across_by * root[:, None], along * by.real * root[:, None]], axis=2)
    # The extreme transmission angles of each dyad.
    folding = moved.folding
    at = np.stack([np.argmax(folding, axis=2), np.argmin(folding, axis=2)], axis=2)
    cosine = np.take_along_axis(folding, at, axis=2)
    cosine_by = np.take_along_axis(moved.folding_by, at[:, :, None, :], axis=3)[:, :, 1:]
    over = np.abs(cosine) - np.cos(np.radians(task.least_deg + MARGIN_DEG))
    hinge = limits * np.maximum(over, 0)
    hinge_by = (limits * (over > 0) * np.sign(cosine))[:, :, None] * cosine_by
    residual = np.concatenate([residual, hinge.reshape(len(hinge), -1)], axis=1)
    rows = np.moveaxis(hinge_by, 2, 1).reshape(len(hinge), cosine_by.shape[2], -1)
    length, length_by = _length_limits(task, state.chains)
    residual = np.concatenate([residual, limits / 10 * length], axis=1)
    jacobian = np.concatenate([jacobian, rows, limits / 10 * np.swapaxes(length_by, 1, 2)], axis=2)
    cost = np.einsum("sm,sm->s", residual, residual)
    closes = np.isfinite(cost) & (1 - np.max(folding**2, axis=(1, 2), initial=0) > TOGGLE**2)
    cost = np.where(closes, cost, np.inf)
    jacobian[~closes] = 0
    residual[~closes] = 0
    return CurveFit(
        cost, np.einsum("spm,sm->sp", jacobian, residual), jacobian @ np.swapaxes(jacobian, 1, 2), moved.point, moved.by
    )


def _aims(task: CurveTask, state: State, moved: ChainMotion) -> tuple[Complex, Complex, Real, Real]:
    """Places (s, T) that samples should be at, directions along curve or path, and roots of shares and of weights."""
    samples = state.cranks.shape[1]
    half = samples // 2
    place, tangent = task.target.at(state.places)
    by_crank = moved.by[:, 0]
    speed = np.abs(by_crank)
    with np.errstate(invalid="ignore", divide="ignore"):
        direction = np.concatenate([tangent[:, :half], by_crank[:, half:] / speed[:, half:]], axis=1)
        share = speed[:, :half] / (2 * speed[:, :half].sum(axis=1, keepdims=True))
    share = np.concatenate([share, np.full((len(share), half), 1 / samples)], axis=1)
    return place, direction, np.sqrt(share), np.sqrt(task.target.weight_at(state.places))


def _timed_aims(timed: TimedPoints) -> tuple[Complex, Complex, Real, Real]:
    """As `_aims`, the same for all chains (1, T); samples of the limits alone have no share."""
    none = np.zeros(LIMITED)
    place: Complex = np.concatenate([timed.places, none + 0j])[None]
    share = np.append(timed.weights / timed.weights.sum(), none)[None]
    one: Real = np.ones(share.shape)
    return place, one + 0j, np.sqrt(share), one


def _length_limits(task: CurveTask, chains: Chains) -> tuple[Real, Real]:
    """Violations (s, m) of the limits of lengths, logarithmic, and their derivatives."""
    value, by, is_link, here = lengths(chains)
    links = np.where(is_link & here, value, np.nan)
    half = np.log(task.ratio * MARGIN_RATIO) / 2
    middle = (np.nanmax(links, axis=1) + np.nanmin(links, axis=1))[:, None] / 2
    shortest, longest = np.log(np.maximum(task.bounds.links, 1e-12)) + np.array([MARGIN_LINK, -MARGIN_LINK])
    middle = np.minimum(middle, longest - half)
    low = np.maximum(middle - half, shortest) + np.where(is_link, 0.0, np.log(APART))
    over, under = np.maximum(value - np.minimum(middle + half, longest), 0), np.maximum(low - value, 0)
    over, under = (np.where(here, part, 0) for part in (over, under))
    return over - under, by * ((over > 0) | (under > 0))[..., None]


def refined(
    task: CurveTask, state: State, steps: int, along: float, limits: float, power: int = 2
) -> tuple[State, Real]:
    """States after so many Levenberg-Marquardt steps, and their costs (s,); infinite if a chain does not close.

    power: of the distances whose sum is least; a high one makes the largest small.
    """
    half = state.cranks.shape[1] // 2
    level = None
    if power > 2:
        place, tangent = task.target.at(state.places)
        point = traced(state.chains, state.cranks, derivatives=False).point
        across = np.abs(cross(tangent, point - place)) * np.sqrt(task.target.weight_at(state.places))
        level = Level(power, across.max(axis=1, keepdims=True) + 1e-9)
    now = linearised(task, state, along, limits, level)
    chains, cranks, places = state.chains, state.cranks, state.places
    p = chains.x.shape[1]
    damping = np.full(len(chains), 1e-2)
    logs = chains.head + np.add.outer(PER_DYAD * np.arange(chains.dyads), [4, 5]).ravel()
    for _ in range(steps):
        diagonal = np.einsum("spp->sp", now.square)
        added = damping[:, None] * diagonal + 1e-9 * diagonal.max(axis=1, keepdims=True) + 1e-30
        step = -np.linalg.solve(now.square + added[..., None] * np.eye(p), now.gradient[..., None])[..., 0]
        step *= np.minimum(1, LONGEST_STEP / np.maximum(np.abs(step[:, logs]).max(axis=1), 1e-12))[:, None]
        x = task.within(replace(chains, x=chains.x + step))
        new_places, new_cranks = places.copy(), cranks.copy()
        if along < 1:
            moved = now.traced + np.einsum("spt,sp->st", now.by[:, 1:], step)
            place, tangent = task.target.at(places)
            off = moved - place
            with np.errstate(invalid="ignore", divide="ignore"):
                by_place = np.nan_to_num(dot(tangent, off)[:, :half] / task.target.perimeter)
                by_crank = np.nan_to_num(-dot(now.by[:, 0], off)[:, half:] / np.abs(now.by[:, 0, half:]) ** 2)
            new_places[:, :half] += np.clip(by_place, -PLACE_STEP, PLACE_STEP)
            new_cranks[:, half:] += np.clip(by_crank, -CRANK_STEP, CRANK_STEP)
        new = linearised(task, State(x, new_cranks, new_places), along, limits, level)
        better = new.cost < now.cost
        damping = np.clip(np.where(better, 0.3 * damping, 4 * damping), 1e-12, 1e8)
        chains = replace(chains, x=np.where(better[:, None], x.x, chains.x))
        places, cranks = (np.where(better[:, None], a, b) for a, b in ((new_places, places), (new_cranks, cranks)))
        now = CurveFit(
            *(
                np.where(
                    better.reshape(-1, *[1] * (getattr(new, name).ndim - 1)), getattr(new, name), getattr(now, name)
                )
                for name in ("cost", "gradient", "square", "traced", "by")
            )
        )
    return State(chains, cranks, places), now.cost


@record(eq=False)
class Effort:
    """Work of a search for chains of so many bars, for an effort of 1.

    similar: chains of the library that are refined. grown: chains that grow from the best with two bars less. hops:
    shares by which the best are changed at random, one round each, with `copies` of them.
    """

    similar: int
    grown: int
    hops: tuple[float, ...]
    copies: int = 240


EFFORT = {
    4: Effort(300, 0, ()),
    5: Effort(300, 0, (0.08,)),
    6: Effort(300, 300, (0.1,)),
    7: Effort(400, 500, (0.12, 0.06)),
    8: Effort(500, 1000, (0.15, 0.1, 0.07, 0.04)),
}
# Rounds of least squares: number of samples; steps, share along the curve and weight of limits of each stage; number of
# chains that are kept for an effort of 1. With 80 samples at the end large distances lie between them.
ROUNDS = (
    (80, ((3, 1.0, 30.0), (3, 1.0, 60.0), (4, 0.25, 100.0), (10, 0.05, 200.0)), 80),
    (160, ((30, 0.05, 300.0),), 20),
    (256, ((40, 0.03, 400.0),), 12),
)
# The same for timed points, without a change of samples: these are the points, at most so many of them.
TIMED = 60
TIMED_ROUNDS = tuple(
    (0, tuple((steps, 1.0, limits) for steps, _, limits in stages), kept) for _, stages, kept in ROUNDS
)
# Relative difference of costs below which two chains of one kind count as copies, and largest share of one kind.
COPY, ALIKE = 2e-3, 0.25
# Samples of the first and of the last steps, the powers of the distances that the last ones make small one after the
# other, and steps of each.
SAMPLES, POWERS, POWER_STEPS = (80, 256), (4, 8, 16), 15


class CurveSearch:
    """A search for chains of at most so many bars; `best` has the best of each number of bars as far as it came."""

    def __init__(self, task: CurveTask, bars: int, is_geared: bool, effort: int, seed: int, watch: Watch):
        self.all_timed, self.effort, self.watch = task.timed, effort, watch
        self.task = replace(task, timed=task.timed.thinned(TIMED)) if task.timed else task
        self.numbers = [number for number in range(4, bars + 1) if is_geared or number % 2 == 0]
        self.rng = np.random.default_rng(seed)
        self.best: dict[int, State] = {}

    def run(self) -> dict[int, State]:
        """The best chains by number of bars."""
        best: dict[int, State] = {}
        for k, bars in enumerate(self.numbers):
            effort = EFFORT[bars]
            now = self.halved(self.similar(curve_library(bars), self.effort * effort.similar), first=True)
            if effort.grown and len(best.get(bars - 2, ())):
                now = self.better(now, self.halved(self.grown(best[bars - 2], self.effort * effort.grown)))
            for hop, share in enumerate(effort.hops, 1):
                now = self.better(now, self.halved(self.hopped(now[0], share, self.effort * effort.copies)))
                self.watch.report((k + hop / (len(effort.hops) + 1)) / len(self.numbers))
            best[bars] = now[0]
            self.best[bars] = self.finished(now[0])
            if len(now[1]):
                rms = np.sqrt(now[1][0])
                self.watch.what = f"linkages for the curve, so far {rms:.2g} % of its size away (rms)"
            self.watch.report((k + 1) / len(self.numbers))
        return self.best

    def similar(self, library: CurveLibrary, count: int) -> State:
        """The chains of the library that are most similar."""
        if self.task.timed:
            return self.task.timed_state(self.task.timed, *self.task.timed.nearest(library, count))
        chains = self.task.within(library.nearest(self.task.target, count)[0])
        return matched(self.task, chains, SAMPLES[0])

    def better(self, one: tuple[State, Real], other: tuple[State, Real]) -> tuple[State, Real]:
        """The best of both."""
        count = ROUNDS[-1][2] * self.effort
        return self.chosen(joined_states([one[0], other[0]]), np.concatenate([one[1], other[1]]), count)

    def halved(self, state: State, first: bool = False) -> tuple[State, Real]:
        """The best after rounds of least squares with more steps and fewer chains each, and their costs."""
        state = state[np.flatnonzero(np.isfinite(closed_paths(state.chains)).all(axis=1))]
        cost = np.full(len(state), np.inf)
        for samples, stages, kept in ROUNDS if self.task.timed is None else TIMED_ROUNDS:
            done, costs = [state[:0].resampled(samples)], [cost[:0]]
            for k in range(0, len(state), AT_ONCE):
                # The first ones are refined whatever the time limit.
                if k and self.watch.over():
                    break
                now = state[k : k + AT_ONCE].resampled(samples)
                for steps, along, limits in stages:
                    if self.task.timed:
                        now, cost = refined(self.task, now, steps, along, limits)
                    elif first and along == 1:
                        now = matched(self.task, refined(self.task, now, steps, along, limits)[0].chains, samples)
                    elif along < 1:
                        now, cost = refined(self.task, now, steps, along, limits)
                done.append(now)
                costs.append(cost)
            state, cost = self.chosen(joined_states(done), np.concatenate(costs), kept * self.effort)
        return state, cost

    def chosen(self, state: State, cost: Real, count: int) -> tuple[State, Real]:
        """The best distinct chains, few of one kind, and at most half of kinds that seldom stack."""
        bodies, order = state.chains.bodies, np.argsort(cost, kind="stable")
        kinds = np.unique(bodies.reshape(len(bodies), 2 * state.chains.dyads), axis=0, return_inverse=True)[1].ravel()
        stacking, rows, seldom = stacks(bodies), list[int](), 0
        costs: dict[int, list[float]] = {kind: [] for kind in kinds.tolist()}
        for row in order[np.isfinite(cost[order])].tolist():
            alike = costs[kinds[row]]
            copy = alike and cost[row] <= alike[-1] * (1 + COPY) + 1e-14
            full = len(alike) >= ALIKE * count or (not stacking[row] and seldom >= count / 2)
            if len(rows) < count and not copy and (bodies.shape[1] == 1 or not full):
                rows.append(row)
                alike.append(cost[row])
                seldom += not stacking[row]
        best = np.array(rows, dtype=int)
        return state[best], cost[best]

    def grown(self, state: State, count: int) -> State:
        """The chains with random third and fourth links of a dyad at the traced point, which stays where it is."""
        rows = np.arange(count) % len(state)
        ends = state.chains[rows]
        traced_body = 2 * ends.dyads
        others = np.array([b for b in range(-ends.is_geared, 2 + 2 * ends.dyads) if b != traced_body])
        pair = np.stack([np.full(len(rows), traced_body), others[self.rng.integers(0, len(others), len(rows))]], axis=1)
        chains, kept = extended(ends, pair, self.rng, ends.x[:, -2] + 1j * ends.x[:, -1])
        return replace(state[rows[kept]], chains=self.task.within(chains))

    def hopped(self, state: State, share: float, count: int) -> State:
        """Copies with all sizes changed at random by about this share."""
        rows = np.arange(count) % len(state) if len(state) else np.arange(0)
        ends = state.chains[rows]
        spread = share * np.exp(self.rng.normal(size=(len(ends), 1)))
        change = spread * self.rng.normal(size=ends.x.shape)
        x = ends.x.copy()
        logs = np.add.outer(ends.head + PER_DYAD * np.arange(ends.dyads), [4, 5]).ravel()
        size = np.abs(ends.pins[:, 0, 0])[:, None]
        scale = np.maximum(np.abs(x), 0.1)
        scale[:, logs] = 1
        scale[:, : ends.head] = size
        parts = scale[:, ends.head : -2].reshape(len(ends), ends.dyads, PER_DYAD)
        parts[..., :4] = np.where(np.repeat(ends.bodies == GROUND, 2, axis=2), size[:, None], parts[..., :4])
        scale[:, ends.head : -2] = parts.reshape(len(ends), ends.dyads * PER_DYAD)
        return replace(state[rows], chains=self.task.within(replace(ends, x=x + scale * change)))

    def finished(self, state: State) -> State:
        """The chains, and copies whose largest distances are smaller (least high powers)."""
        if not len(state) or self.watch.over():
            return state
        if self.all_timed:
            task = replace(self.task, timed=self.all_timed)
            return refined(task, task.timed_state(self.all_timed, state.chains, state.cranks[:, 0]), 60, 1.0, 600.0)[0]
        state, _ = refined(self.task, state.resampled(SAMPLES[-1]), 40, 0.02, 600.0)
        level = state
        for power in POWERS:
            level, _ = refined(self.task, level, POWER_STEPS, 0.02, 600.0, power)
        return joined_states([state, level])


def cranks_along(task: CurveTask, state: State, shares: Real) -> Real:
    """Crank angles (s, n), rising or falling, at which the chains are nearest to shares (n,) of the curve."""
    half = state.cranks.shape[1] // 2
    sense = np.sign(state.places[:, half - 1] - state.places[:, 0])[:, None]
    equal = np.arange(half + 1) / half
    cranks = np.unwrap(state.cranks[:, half:])
    ends = np.concatenate([cranks, cranks[:, :1] + 2 * np.pi * sense], axis=1)
    cranks = np.array([np.interp(shares, equal, row) for row in ends]).reshape(-1, len(shares))
    place = task.target.at(shares)[0]
    for _ in range(NEAREST_STEPS):
        moved = traced(state.chains, cranks)
        with np.errstate(invalid="ignore", divide="ignore"):
            by_crank = np.nan_to_num(dot(moved.by[:, 0], place - moved.point) / np.abs(moved.by[:, 0]) ** 2)
        cranks = cranks + np.clip(by_crank, -CRANK_STEP, CRANK_STEP)
    return sense * np.maximum.accumulate(sense * cranks, axis=1)
