"""Many small linear programmes at once."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np

from ...core.records import record
from ...plane.vec import Mask, Real, Whole

# A rate below which a row counts as not approached. Larger, and rows are passed through; smaller, and a row that is
# nearly a sum of those that hold already makes a corner that rounding alone decides.
FLAT = 1e-8
# Price, of a cost of 1, below which a row counts as holding. Smaller, and rounding alone sets rows free.
PRICELESS = 1e-11


def least(cost: Real, rows: Real, bounds: Real, corner: Whole, steps: int = 100) -> tuple[Real, Real]:
    """Minimises cost x where rows x <= bounds, for each of many programmes; from a corner that is allowed.

    cost: (n,); rows: (many, m, n); bounds: (many, m); corner: (many, n), the rows that hold at the start. Gives x
    (many, n) and what each row costs (many, m), 0 and more: cost + prices rows = 0. Walks from corner to corner along
    the edge of the worst price (the primal simplex method: Dantzig, 1947, on the rows themselves); after so many steps
    the corner reached is given, which is allowed though it may not be the best.
    """
    many, m, _ = rows.shape
    each = np.arange(many)
    corner = corner.copy()
    inverse = np.linalg.inv(rows[each[:, None], corner])
    x = np.einsum("kij,kj->ki", inverse, bounds[each[:, None], corner])
    busy = np.ones(many, bool)
    for _ in range(steps):
        prices = -(cost @ inverse)
        worst = np.argmin(prices, axis=1)
        busy &= prices[each, worst] < -PRICELESS
        if not busy.any():
            break
        way = -inverse[each, :, worst]
        rate = np.einsum("kmn,kn->km", rows, way)
        room = np.maximum(bounds - np.einsum("kmn,kn->km", rows, x), 0.0)
        np.put_along_axis(rate, corner, 0.0, axis=1)
        scale = np.abs(way).max(axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            step = np.where(rate > FLAT * scale[:, None], room / rate, np.inf)
        met = np.argmin(step, axis=1)
        busy &= np.isfinite(step[each, met])
        go = each[busy]
        x[go] += step[go, met[go], None] * way[go]
        # The new row in the place of the one that is left.
        seen = np.einsum("kn,knj->kj", rows[go, met[go]], inverse[go])
        column = inverse[go, :, worst[go]] / seen[np.arange(len(go)), worst[go], None]
        seen[np.arange(len(go)), worst[go]] = 0.0
        inverse[go] -= column[:, :, None] * seen[:, None, :]
        inverse[go, :, worst[go]] = column
        corner[go, worst[go]] = met[go]
    try:
        inverse = np.linalg.inv(rows[each[:, None], corner])
        x = np.einsum("kij,kj->ki", inverse, bounds[each[:, None], corner])
    except np.linalg.LinAlgError:
        # Rows of one corner that rounding alone tells apart: what was reached is good, but for its last digits.
        pass
    prices = np.zeros((many, m))
    np.put_along_axis(prices, corner, np.maximum(-(cost @ inverse), 0.0), axis=1)
    return x, prices


# What a limit that is broken by 1 costs, in units of error. Less, and an optimum at a limit may break it; more, and
# steps along a limit that bends are refused until they are small.
PENALTY = 30.0
# First and largest step of an unknown: logarithms of lengths, and rad. Larger first ones jump to another optimum,
# smaller ones take longer to leave a poor start.
FIRST_STEP, LONGEST_STEP = 0.2, 1.0
# Times that a step is brought back to where the rows that hold meet. Fewer, and steps along a valley that bends stay
# short; more are hardly better.
CORRECTIONS = 3
# Step of the differences of derivatives: an error of 1e-7 in the curvature costs a few digits in one step, which the
# next one has again.
DIFFERENCE = 1e-6
# Share of the largest error that is no gain any more. Less is rounding, with the curvature of peaks in it.
CONVERGED = 1e-12
# Longest of the last steps. Larger ones are on their way to another place; smaller ones leave what is flat unsettled.
SETTLING = 1e-4
# Box below which nothing moves any more.
SMALLEST_STEP = 1e-13
# How near to the largest a peak must be, over it, and a limit to nothing, to hold the error up: what the last step
# leaves. Less, and a peak that holds is taken for one that does not.
LEVEL, ACTIVE = 1e-6, 1e-8


class AbstractTask(ABC):
    """What is to become small, of many candidates at once.

    A candidate is a row of unknowns; those that are not free, such as a branch, stay as they are.
    """

    @property
    @abstractmethod
    def free(self) -> Mask:
        """(unknowns,) which ones may change."""

    @abstractmethod
    def error(self, p: Real, s: Real) -> Real:
        """Errors (many, m) of candidates p (many, unknowns) at s (many or 1, m), 0 to 1; nan where it cannot be."""

    @abstractmethod
    def slopes(self, p: Real, s: Real) -> Real:
        """Their derivatives by the unknowns, (many, m, unknowns)."""

    @abstractmethod
    def limits(self, p: Real) -> tuple[Real, Real]:
        """Limits (many, k), kept where 0 or less, and their derivatives (many, k, unknowns)."""

    def merit(self, p: Real, s: Real, penalty: float = PENALTY) -> Real:
        """(many,) largest error, and what the worst broken limit costs; inf where a candidate cannot be."""
        # A candidate that cannot be says so by nan, and one far outside overflows.
        with np.errstate(all="ignore"):
            worst = np.abs(self.error(p, s)).max(axis=1) + penalty * np.maximum(self.limits(p)[0].max(axis=1), 0)
        return np.where(np.isfinite(worst), worst, np.inf)


def descend(
    task: AbstractTask, p: Real, s: Real, steps: int, first: float = FIRST_STEP, gain_left: float = CONVERGED
) -> tuple[Real, Real, Mask]:
    """From candidates p (many, unknowns) to optima: where they are, their merit, whether they rest (many,).

    s: (many or 1, m), where errors are looked at; gain_left: share of the largest error that is not worth a step. Each
    step is the best one of the errors and limits made straight, inside a box (a linear programme); or, with the rows
    that hold there, Newton's on their curvature; or either brought back to where these rows meet, as they bend;
    whichever is best (Fletcher and Sainz de la Maza, Nonlinear programming and nonsmooth optimization by successive
    linear programming, Mathematical Programming 43, 1989). The first finds which peaks and limits hold; the second ends
    to rounding also where these are fewer than the unknowns.
    """
    p, box = p.copy(), np.full(len(p), first)
    value = task.merit(p, s)
    busy = np.isfinite(value)
    for _ in range(steps):
        k = np.flatnonzero(busy)
        if not k.size:
            break
        at = s if len(s) == 1 else s[k]
        tries, gain = _tries(task, p[k], at, box[k], value[k])
        reached = np.stack([task.merit(q, at) for q in tries])
        take, new = np.argmin(reached, axis=0), reached.min(axis=0)
        best = np.take_along_axis(tries, take[None, :, None], 0)[0]
        with np.errstate(divide="ignore", invalid="ignore"):
            kept = (value[k] - new) / gain
        better = new < value[k]
        length = np.abs(tries[0] - p[k])[:, task.free].max(axis=1)
        p[k[better]], value[k[better]] = best[better], new[better]
        wider, narrower = np.minimum(np.maximum(box[k], 2 * length), LONGEST_STEP), np.minimum(0.3 * box[k], length)
        box[k] = np.where(kept > 0.7, wider, np.where(kept > 0.2, box[k], narrower))
        busy[k] = (gain > gain_left * value[k]) & (box[k] > SMALLEST_STEP)
    return p, value, ~busy


def settled(task: AbstractTask, p: Real, s: Real) -> Real:
    """Candidates p (many, unknowns) after Newton's last steps, whatever rounding makes of their merit.

    Where fewer peaks hold than there are unknowns the merit is flat, and tells only half of the digits that its
    derivatives do; without this the rest would hang on the way that led there.
    """
    value, box = task.merit(p, s), np.full(len(p), SETTLING)
    for _ in range(2):
        new = _tries(task, p, s, box, value)[0][2]
        merit = task.merit(new, s)
        near = (np.abs(new - p).max(axis=1) < SETTLING) & (merit <= value * (1 + SETTLING**2))
        p = np.where(near[:, None], new, p)
    return p


def _tries(task: AbstractTask, p: Real, s: Real, box: Real, value: Real) -> tuple[Real, Real]:
    """Candidates after the straight step, after it and Newton's, both brought back, and what was hoped of the first."""
    free = np.flatnonzero(task.free)
    n = len(free)
    rows, bounds, open_rows = _made_straight(task, p, s, free)
    bounds[:, open_rows + 1 :] = box[:, None]
    # A corner to start from: that of the box where all unknowns go down.
    there = -box[:, None] * rows[:, :, :n].sum(axis=2) - bounds
    limits = _number_of_limits(rows, n)
    worst = np.argmax(there[:, : open_rows - limits], axis=1)
    broken = open_rows - limits + np.argmax(there[:, open_rows - limits : open_rows + 1], axis=1)
    low = np.tile(np.arange(open_rows + 1 + n, open_rows + 1 + 2 * n), (len(p), 1))
    cost = np.zeros(n + 2)
    cost[n:] = 1, PENALTY
    x, prices = least(cost, rows, bounds, np.column_stack([low, worst, broken]))
    # The rows that hold, those of the box let go.
    hold = np.argsort(prices, axis=1)[:, -(n + 2) :]
    paid = (np.take_along_axis(prices, hold, 1) > 0) & (hold <= open_rows)
    held = np.take_along_axis(rows, hold[..., None], 1) * paid[..., None]
    right = np.where(paid, np.take_along_axis(bounds, hold, 1), 0)
    curvature = _curvature(task, p, s, prices[:, :open_rows], free, limits)
    both = np.concatenate([x[:, :n], _newton(held, paid, right, curvature, cost)])
    back = _least_return(held, paid, n)
    for _ in range(CORRECTIONS):
        q = np.concatenate([p, p])
        q[:, free] += both
        with np.errstate(all="ignore"):
            e, c = task.error(q, s if len(s) == 1 else np.concatenate([s, s])), task.limits(q)[0]
        off = np.concatenate([-e, e, -c, np.zeros((len(q), 1 + 2 * n))], axis=1)
        off = np.where(np.tile(paid, (2, 1)), np.take_along_axis(off, np.tile(hold, (2, 1)), 1), 0)
        step = np.einsum("kij,kj->ki", np.concatenate([back, back]), off)
        both += np.where(np.isfinite(step) & (np.abs(step) < LONGEST_STEP), step, 0.0)
    tries = np.stack([p, p, p])
    tries[0][:, free] += x[:, :n]
    tries[1:, :, free] += both.reshape(2, len(p), n)
    return tries, value - x @ cost


def _made_straight(task: AbstractTask, p: Real, s: Real, free: Whole) -> tuple[Real, Real, int]:
    """Rows and bounds of the linear programme, those of the box still 0, and how many stand before that of `broken`.

    Of the step, the largest error, and by how much limits are broken. Rows: errors from above and from below, limits,
    that none is broken by less than nothing, the box.
    """
    n = len(free)
    e, (limits, steep) = task.error(p, s), task.limits(p)
    # At a toggle an error is steep without end: such a row tells nothing of where to go.
    slopes, steep = (np.nan_to_num(one, nan=0.0, posinf=0.0, neginf=0.0) for one in (task.slopes(p, s), steep))
    m, k = e.shape[1], limits.shape[1]
    end = 2 * m + k
    rows, bounds = np.zeros((len(p), end + 1 + 2 * n, n + 2)), np.zeros((len(p), end + 1 + 2 * n))
    rows[:, :m, :n], rows[:, m : 2 * m, :n] = slopes[..., free], -slopes[..., free]
    rows[:, : 2 * m, n], rows[:, 2 * m : end + 1, n + 1] = -1, -1
    rows[:, 2 * m : end, :n] = steep[..., free]
    rows[:, end + 1 :, :n] = np.vstack([np.eye(n), -np.eye(n)])
    bounds[:, :m], bounds[:, m : 2 * m], bounds[:, 2 * m : end] = -e, e, -limits
    return rows, bounds, end


def _number_of_limits(rows: Real, n: int) -> int:
    """How many rows are limits: those in which breaking counts, but for that of breaking itself."""
    return int((rows[0, :, n + 1] < 0).sum()) - 1


def _newton(held: Real, paid: Mask, right: Real, curvature: Real, cost: Real) -> Real:
    """Newton's step (many, n): the least of cost and curvature where the rows that are held hold; 0 where it fails."""
    many, size, _ = held.shape
    n = size - 2
    system, values = np.zeros((many, 2 * size, 2 * size)), np.zeros((many, 2 * size))
    system[:, :n, :n] = curvature
    system[:, :size, size:], system[:, size:, :size] = np.swapaxes(held, 1, 2), held
    system[:, range(size, 2 * size), range(size, 2 * size)] = ~paid
    # A hair on the diagonal, or a row that is held twice makes it singular.
    system[:, range(2 * size), range(2 * size)] += 1e-14
    values[:, :size], values[:, size:] = -cost, right
    with np.errstate(all="ignore"):
        try:
            step = np.linalg.solve(system, values[..., None])[:, :n, 0]
        except np.linalg.LinAlgError:
            return np.zeros((many, n))
        step *= np.minimum(1.0, LONGEST_STEP / np.abs(step).max(axis=1))[:, None]
    return np.where(np.isfinite(step), step, 0.0)


def _least_return(held: Real, paid: Mask, n: int) -> Real:
    """(many, n, rows) from how far the held rows are off to the shortest step at which all meet; the error is free."""
    free = np.ones(n + 2)
    free[n:] = 1e4
    square = (held * free) @ np.swapaxes(held, 1, 2)
    # A hair more on the diagonal, as two rows may be nearly one.
    square[:, range(n + 2), range(n + 2)] = square[:, range(n + 2), range(n + 2)] * (1 + 1e-10) + ~paid
    try:
        found: Real = ((free[:, None] * np.swapaxes(held, 1, 2)) @ np.linalg.inv(square))[:, :n]
    except np.linalg.LinAlgError:
        found = np.zeros((len(held), n, n + 2))
    return found


def _curvature(task: AbstractTask, p: Real, s: Real, prices: Real, free: Whole, limits: int) -> Real:
    """(many, n, n): second derivatives of the errors and limits, each at its price."""
    m = (prices.shape[1] - limits) // 2
    weights = prices[:, :m] - prices[:, m : 2 * m]

    def slope(q: Real) -> Real:
        errors = np.einsum("km,kmn->kn", weights, task.slopes(q, s)[..., free])
        bent: Real = errors + np.einsum("km,kmn->kn", prices[:, 2 * m :], task.limits(q)[1][..., free])
        return bent

    columns = []
    for at in free:
        up, down = p.copy(), p.copy()
        up[:, at] += DIFFERENCE
        down[:, at] -= DIFFERENCE
        with np.errstate(all="ignore"):
            columns.append((slope(up) - slope(down)) / (2 * DIFFERENCE))
    found = np.nan_to_num(np.stack(columns, axis=1), nan=0.0, posinf=0.0, neginf=0.0)
    return 0.5 * (found + np.swapaxes(found, 1, 2))


@record(eq=False)
class Certificate:
    """Multipliers of peaks (peaks,), their sum 1, and of limits (limits,), all 0 and more; what their sum leaves."""

    peaks: Real
    limits: Real
    left: float


def certified(task: AbstractTask, p: Real, s: Real, errors: Real) -> Certificate:
    """Multipliers at a candidate p (unknowns,) whose error has its peaks at s (peaks,).

    Kuhn and Tucker's conditions (Nonlinear programming, 1951) of the least largest error: the derivatives of |error|
    at the highest peaks and of the limits that hold, each times a multiplier that is not negative, sum to nothing.
    Found by least squares on those that hold, the most negative left out until none is.
    """
    free = task.free
    limits, steep = (one[0] for one in task.limits(p[None]))
    slopes = np.sign(errors)[:, None] * task.slopes(p[None], s[None])[0]
    holds = np.concatenate([np.abs(errors) >= (1 - LEVEL) * np.abs(errors).max(), limits >= -ACTIVE])
    columns = np.concatenate([slopes, steep])[:, free].T
    # The last row: that the multipliers of peaks sum to 1.
    system = np.vstack([columns, np.concatenate([np.ones(len(s)), np.zeros(len(limits))])])
    right = np.append(np.zeros(len(columns)), 1.0)
    found = np.zeros(len(holds))
    while holds.any():
        found[:] = 0
        found[holds] = np.linalg.lstsq(system[:, holds], right, rcond=None)[0]
        if found.min() >= 0:
            break
        holds[np.argmin(found)] = False
    size = np.linalg.norm(columns, axis=0) @ found
    left = float(np.linalg.norm(system @ found - right) / max(size, 1.0))
    return Certificate(found[: len(s)], found[len(s) :], left)
