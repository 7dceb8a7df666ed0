"""Four- to eight-bars whose traced points follow a closed curve, both ways: from the curve and to the curve.

Random chains with similar curves are refined by least squares, all at once, in rounds that keep the best; better ones
grow from chains with two bars less. The work depends on the seed alone.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...core.processes import Watch
from ...core.records import record
from ...plane.vec import Complex, Mask, Real, cross, dot
from .closed_lines import evenly
from .curve_library import TargetCurve, closed_paths, curve_library
from .dyad_chains import CRANK, GROUND, PER_DYAD, Chains, extended, joined, stacks, traced

# Distance of the search's limits from the wanted ones: a margin in deg, and a factor of the ratio of lengths.
MARGIN_DEG, MARGIN_RATIO = 1.0, 0.98
# Pins of one body are at least this share of the shortest link apart, so that their holes can be cut.
APART = 0.4
# Largest step of the logarithm of a length, of a crank angle, rad, and of a place on the curve, as a share of it.
LONGEST_STEP, CRANK_STEP, PLACE_STEP = 0.5, 0.15, 0.02
# Least sine of a transmission angle; a step beyond it is refused.
TOGGLE = 0.03
# Chains refined at once: more do not fit the processor's cache.
AT_ONCE = 24


# Lower left and upper right corner.
Box = tuple[complex, complex]


@record(eq=False)
class CurveTask:
    """A wanted curve and the limits of chains for it.

    target: the curve. least_deg: transmission angle. ratio: longest link over the shortest. longest: of any link, in
    units of the search. crank_box, ground_box: where the crank pivot and the other ground pivots may be.
    """

    target: TargetCurve
    least_deg: float
    ratio: float
    longest: float
    crank_box: Box
    ground_box: Box

    def within(self, chains: Chains) -> Chains:
        """The chains with ground pivots moved into their boxes."""
        x = chains.x.copy()
        for k in range(chains.head):
            x[:, k] = _clipped(x[:, k], self.ground_box if k > 1 else self.crank_box, k % 2)
        parts = x[:, chains.head : -2].reshape(len(x), chains.dyads, PER_DYAD)
        for k in (0, 1, 2, 3):
            parts[..., k] = np.where(
                chains.bodies[..., k // 2] == GROUND, _clipped(parts[..., k], self.ground_box, k % 2), parts[..., k]
            )
        x[:, chains.head : -2] = parts.reshape(len(x), -1)
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


@record(eq=False)
class CurveFit:
    """Normal equations of s chains: cost (s,), gradient (s, p), square (s, p, p); point, tangents, and derivatives."""

    cost: Real
    gradient: Real
    square: Real
    traced: Complex
    by: Complex


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


def linearised(task: CurveTask, state: State, along: float, limits: float, weights: Real) -> CurveFit:
    """The normal equations: distances across the curve and across the path, a share of those along them, and limits."""
    half = state.cranks.shape[1] // 2
    moved = traced(state.chains, state.cranks)
    place, tangent = task.target.at(state.places)
    off = moved.point - place
    by_crank = moved.by[:, 0]
    speed = np.abs(by_crank)
    with np.errstate(invalid="ignore", divide="ignore"):
        direction = np.concatenate([tangent[:, :half], by_crank[:, half:] / speed[:, half:]], axis=1)
        weight = np.concatenate(
            [speed[:, :half] / (2 * speed[:, :half].sum(axis=1, keepdims=True)), weights[:, half:]], axis=1
        )
    weight[:, :half] *= weights[:, :half] * 2 * half
    root = np.sqrt(weight)
    turned = np.conj(direction) * root
    off = off * turned
    by = moved.by[:, 1:] * turned[:, None]
    residual = np.concatenate([off.imag, along * off.real], axis=1)
    jacobian = np.concatenate([by.imag, along * by.real], axis=2)
    # The extreme transmission angles of each dyad.
    folding = moved.folding
    at = np.stack([np.argmax(folding, axis=2), np.argmin(folding, axis=2)], axis=2)
    cosine = np.take_along_axis(folding, at, axis=2)
    slope = np.take_along_axis(moved.folding_by, at[:, :, None, :], axis=3)[:, :, 1:]
    over = np.abs(cosine) - np.cos(np.radians(task.least_deg + MARGIN_DEG))
    hinge = limits * np.maximum(over, 0)
    hinge_by = (limits * (over > 0) * np.sign(cosine))[:, :, None] * slope
    residual = np.concatenate([residual, hinge.reshape(len(hinge), -1)], axis=1)
    rows = np.moveaxis(hinge_by, 2, 1).reshape(len(hinge), slope.shape[2], -1)
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


def _length_limits(task: CurveTask, chains: Chains) -> tuple[Real, Real]:
    """Violations (s, m) of the limits of lengths, logarithmic, and their derivatives."""
    value, by, is_link, here = lengths(chains)
    links = np.where(is_link & here, value, np.nan)
    half = np.log(task.ratio * MARGIN_RATIO) / 2
    middle = (np.nanmax(links, axis=1) + np.nanmin(links, axis=1))[:, None] / 2
    middle = np.minimum(middle, np.log(task.longest) - half)
    low = middle - half + np.where(is_link, 0.0, np.log(APART))
    over, under = np.maximum(value - middle - half, 0), np.maximum(low - value, 0)
    over, under = (np.where(here, part, 0) for part in (over, under))
    return over - under, by * ((over > 0) | (under > 0))[..., None]


def refined(
    task: CurveTask, state: State, steps: int, along: float, limits: float, weights: Real | None = None
) -> tuple[State, Real]:
    """States after so many Levenberg-Marquardt steps, and their costs (s,); infinite if a chain does not close."""
    samples = state.cranks.shape[1]
    half = samples // 2
    if weights is None:
        weights = np.full(state.cranks.shape, 1 / samples)
    now = linearised(task, state, along, limits, weights)
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
        moved = now.traced + np.einsum("spt,sp->st", now.by[:, 1:], step)
        place, tangent = task.target.at(places)
        off = moved - place
        with np.errstate(invalid="ignore", divide="ignore"):
            by_place = np.nan_to_num(dot(tangent, off)[:, :half] / task.target.perimeter)
            by_crank = np.nan_to_num(-dot(now.by[:, 0], off)[:, half:] / np.abs(now.by[:, 0, half:]) ** 2)
        new_places, new_cranks = places.copy(), cranks.copy()
        if along < 1:
            new_places[:, :half] += np.clip(by_place, -PLACE_STEP, PLACE_STEP)
            new_cranks[:, half:] += np.clip(by_crank, -CRANK_STEP, CRANK_STEP)
        new = linearised(task, State(x, new_cranks, new_places), along, limits, weights)
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
    """Work of a search for chains of so many bars.

    similar: chains of the library that are refined. grown: chains that grow from each of the best with two bars less.
    hops: shares by which the best are changed at random, one round each; copies: chains of a round.
    """

    similar: int
    grown: int
    hops: tuple[float, ...]
    copies: int = 240


EFFORT = {
    4: Effort(300, 0, ()),
    5: Effort(400, 0, (0.08,)),
    6: Effort(500, 60, (0.08,)),
    7: Effort(700, 80, (0.1, 0.05)),
    8: Effort(1200, 110, (0.12, 0.07, 0.04), 300),
}
# Chains that are kept after each round, and the best that grow, hop and are finished.
KEPT, BEST = (120, 24, 8), 8
# Relative difference of costs below which two chains of one kind count as copies.
COPY = 2e-3
# Rounds in which large distances get larger weights, and the largest weight of a square in units of the mean.
ROUNDS_OF_WEIGHTS, HEAVIEST = 8, 50.0


class CurveSearch:
    """A search for chains of at most so many bars; `best` has the best of each number of bars as far as it came."""

    def __init__(self, task: CurveTask, bars: int, is_geared: bool, seed: int, watch: Watch):
        self.task, self.watch = task, watch
        self.numbers = [number for number in range(4, bars + 1) if is_geared or number % 2 == 0]
        self.rng = np.random.default_rng(seed)
        self.best: dict[int, Chains] = {}

    def run(self) -> dict[int, Chains]:
        """The best chains by number of bars."""
        for k, bars in enumerate(self.numbers):
            effort = EFFORT[bars]
            similar = curve_library(bars).nearest(self.task.target, effort.similar)[0]
            chains = self.halved(self.task.within(similar), first=True)
            if effort.grown and len(self.best.get(bars - 2, ())):
                grown = self.halved(self.grown(self.best[bars - 2], effort.grown))
                chains = self.chosen(joined([chains[0], grown[0]]), np.concatenate([chains[1], grown[1]]), BEST)
            for hop, share in enumerate(effort.hops, 1):
                near = self.halved(self.hopped(chains[0], share, effort.copies))
                chains = self.chosen(joined([chains[0], near[0]]), np.concatenate([chains[1], near[1]]), BEST)
                self.watch.report((k + hop / (len(effort.hops) + 1)) / len(self.numbers))
            self.best[bars] = self.finished(chains[0])
            if len(chains[1]):
                best = np.sqrt(chains[1][0])
                self.watch.what = f"linkages for the curve, so far {best:.2g} % of its size away (rms)"
            self.watch.report((k + 1) / len(self.numbers))
        return self.best

    def halved(self, chains: Chains, first: bool = False) -> tuple[Chains, Real]:
        """The best after rounds of least squares with more steps and fewer chains each, and their costs."""
        chains = chains[np.flatnonzero(np.isfinite(closed_paths(chains)).all(axis=1))]
        cost = np.full(len(chains), np.inf)
        plans = (
            ((80, ((3, 1.0, 30.0), (3, 1.0, 60.0), (4, 0.25, 100.0), (10, 0.05, 200.0))), KEPT[0]),
            ((80, ((30, 0.05, 300.0),)), KEPT[1]),
            ((160, ((40, 0.03, 400.0),)), KEPT[2]),
        )
        for (samples, stages), kept in plans:
            done, costs = [], []
            for k in range(0, len(chains), AT_ONCE):
                if self.watch.over():
                    break
                some = chains[k : k + AT_ONCE]
                now = matched(self.task, some, samples)
                for steps, along, limits in stages if first or samples > 80 else stages[-1:]:
                    now, cost = refined(self.task, now, steps, along, limits)
                    if along == 1:
                        now = matched(self.task, now.chains, samples)
                done.append(now.chains)
                costs.append(cost)
            if not done or not sum(map(len, done)):
                break
            chains, cost = self.chosen(joined(done), np.concatenate(costs), kept)
        good = np.flatnonzero(np.isfinite(cost)[: len(chains)])
        return chains[good], cost[good]

    def chosen(self, chains: Chains, cost: Real, count: int) -> tuple[Chains, Real]:
        """The best distinct chains, at most half of them of one kind, and at most half of kinds that seldom stack."""
        order, stacking = np.argsort(cost, kind="stable"), stacks(chains.bodies)
        rows: list[int] = []
        for row in order[np.isfinite(cost[order])].tolist():
            kind = [one for one in rows if (chains.bodies[row] == chains.bodies[one]).all()]
            copy = any(cost[row] <= cost[one] * (1 + COPY) + 1e-14 for one in kind)
            alike = kind if stacking[row] else [one for one in rows if not stacking[one]]
            if not copy and (chains.dyads == 1 or len(alike) < count / 2):
                rows.append(row)
            if len(rows) == count:
                break
        return chains[np.array(rows, dtype=int)], cost[np.array(rows, dtype=int)]

    def grown(self, chains: Chains, count: int) -> Chains:
        """The chains with random third and fourth links of a dyad at the traced point, which stays where it is."""
        rows = np.repeat(np.arange(len(chains)), count)
        ends, traced_body = chains[rows], 2 * chains.dyads
        others = np.array([b for b in range(-chains.is_geared, 2 + 2 * chains.dyads) if b != traced_body])
        pair = np.stack([np.full(len(rows), traced_body), others[self.rng.integers(0, len(others), len(rows))]], axis=1)
        return self.task.within(extended(ends, pair, self.rng, ends.x[:, -2] + 1j * ends.x[:, -1])[0])

    def hopped(self, chains: Chains, share: float, count: int) -> Chains:
        """Copies with all sizes changed at random by about this share."""
        ends = chains[np.repeat(np.arange(len(chains)), -(-count // max(len(chains), 1)))]
        spread = share * np.exp(self.rng.normal(size=(len(ends), 1)))
        change = spread * self.rng.normal(size=ends.x.shape)
        x = ends.x.copy()
        logs = np.add.outer(ends.head + PER_DYAD * np.arange(ends.dyads), [4, 5]).ravel()
        size = np.abs(ends.pins[:, 0, 0])[:, None]
        scale = np.maximum(np.abs(x), 0.1)
        scale[:, logs] = 1
        scale[:, : ends.head] = size
        parts = scale[:, ends.head : -2].reshape(len(ends), -1, PER_DYAD)
        parts[..., :4] = np.where(np.repeat(ends.bodies == GROUND, 2, axis=2), size[:, None], parts[..., :4])
        scale[:, ends.head : -2] = parts.reshape(len(ends), -1)
        return self.task.within(replace(ends, x=x + scale * change))

    def finished(self, chains: Chains) -> Chains:
        """The chains, and copies whose largest distances are smaller (least fourth powers)."""
        if not len(chains) or self.watch.over():
            return chains
        state, _ = refined(self.task, matched(self.task, chains, 192), 40, 0.02, 600.0)
        weights, level = np.full(state.cranks.shape, 1 / state.cranks.shape[1]), state
        for _ in range(ROUNDS_OF_WEIGHTS):
            place, tangent = self.task.target.at(level.places)
            square = cross(tangent, traced(level.chains, level.cranks, derivatives=False).point - place) ** 2
            square = np.nan_to_num(square / np.maximum(square.mean(axis=1, keepdims=True), 1e-20))
            weights = weights ** (2 / 3) * np.minimum(square + 0.05, HEAVIEST) ** (1 / 3)
            weights /= weights.sum(axis=1, keepdims=True)
            level, _ = refined(self.task, level, 8, 0.02, 600.0, weights)
        return joined([state.chains, level.chains])
