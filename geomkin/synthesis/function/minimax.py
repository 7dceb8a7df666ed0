"""Minimax approximation under limits by many small linear programmes at once."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np

from ...core.records import record
from ...plane.vec import Mask, Real, Whole

# Rate below which a row is not approached. A larger value lets steps pass rows; with a smaller one a row that nearly
# depends on the active ones makes a corner out of rounding.
FLAT = 1e-8
# Price, relative to a cost of 1, below which a row counts as active; with a smaller value rounding releases rows.
PRICELESS = 1e-11


def least(cost: Real, rows: Real, bounds: Real, corner: Whole, steps: int = 100) -> tuple[Real, Real]:
    """Minimise cost x with rows x <= bounds for many programmes, from a feasible corner.

    cost: (n,); rows: (many, m, n); bounds: (many, m); corner: (many, n), the active rows at the start. Returns x (many,
    n) and the prices of the rows (many, m), not negative: cost + prices rows = 0. It follows the edge of the worst
    price from corner to corner (primal simplex method: Dantzig, 1947, on the rows themselves); after the given number
    of steps the corner reached is feasible, but perhaps not optimal.
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
        direction = -inverse[each, :, worst]
        rate = np.einsum("kmn,kn->km", rows, direction)
        room = np.maximum(bounds - np.einsum("kmn,kn->km", rows, x), 0.0)
        np.put_along_axis(rate, corner, 0.0, axis=1)
        scale = np.abs(direction).max(axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            step = np.where(rate > FLAT * scale[:, None], room / rate, np.inf)
        met = np.argmin(step, axis=1)
        busy &= np.isfinite(step[each, met])
        go = each[busy]
        x[go] += step[go, met[go], None] * direction[go]
        # The new row replaces the one that leaves.
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
        # Rows of a corner that differ only by rounding: the result is right except for its last digits.
        pass
    prices = np.zeros((many, m))
    np.put_along_axis(prices, corner, np.maximum(-(cost @ inverse), 0.0), axis=1)
    return x, prices


# Cost of a limit violated by 1, in units of error. With less an optimum at a limit may violate it; with more, steps
# along a curved limit are refused until they are short.
PENALTY = 30.0
# First and largest step of an unknown: logarithms of lengths, and rad. A larger first one jumps to another optimum; a
# smaller one leaves a poor start slowly.
FIRST_STEP, LONGEST_STEP = 0.2, 1.0
# Number of corrections of a step towards the intersection of the active rows. With fewer, steps along a curved valley
# stay short; more hardly help.
CORRECTIONS = 3
# Step of the differences of derivatives: an error of 1e-7 in the curvature costs a few digits of one step, which the
# next one regains.
DIFFERENCE = 1e-6
# Relative gain below which the search ends; less is rounding, including that of the peaks' curvature.
CONVERGED = 1e-12
# Longest of the last steps. Longer ones lead elsewhere; a smaller limit leaves flat optima unsettled.
SETTLING = 1e-4
# Size of the box at which the search ends.
SMALLEST_STEP = 1e-13
# Relative distance of an active peak from the largest, and value of an active limit: the inaccuracy of the last step.
# With smaller values an active peak is missed.
LEVEL, ACTIVE = 1e-6, 1e-8


class AbstractTask(ABC):
    """A function to be minimised for many candidates at once.

    A candidate is a row of unknowns; those that are not free, such as a branch, do not change.
    """

    @property
    @abstractmethod
    def free(self) -> Mask:
        """(unknowns,) mask of those that may change."""

    @abstractmethod
    def error(self, p: Real, s: Real) -> Real:
        """Errors (many, m) of candidates p (many, unknowns) at s (many or 1, m), 0 to 1; nan if impossible."""

    @abstractmethod
    def slopes(self, p: Real, s: Real) -> Real:
        """Their derivatives by the unknowns, (many, m, unknowns)."""

    @abstractmethod
    def limits(self, p: Real) -> tuple[Real, Real]:
        """Limits (many, k), kept if at most 0, and their derivatives (many, k, unknowns)."""

    def merit(self, p: Real, s: Real, penalty: float = PENALTY) -> Real:
        """(many,) largest error plus the cost of the worst violated limit; inf for an impossible candidate."""
        # An impossible candidate gives nan, and one far outside overflows.
        with np.errstate(all="ignore"):
            worst = np.abs(self.error(p, s)).max(axis=1) + penalty * np.maximum(self.limits(p)[0].max(axis=1), 0)
        return np.where(np.isfinite(worst), worst, np.inf)


def descend(
    task: AbstractTask, p: Real, s: Real, steps: int, first: float = FIRST_STEP, gain_left: float = CONVERGED
) -> tuple[Real, Real, Mask]:
    """Improve candidates p (many, unknowns) to optima: the optima, their merit, and whether they have converged
    (many,).

    s: (many or 1, m), the positions of the errors; gain_left: share of the largest error that is not worth a step. Each
    step is the best of: the optimum of the linearised errors and limits inside a box (a linear programme); Newton's
    step on the curvature with the active rows; either one corrected towards the intersection of these rows (Fletcher
    and Sainz de la Maza, Nonlinear programming and nonsmooth optimization by successive linear programming,
    Mathematical Programming 43, 1989). The first finds the active peaks and limits; the second converges to rounding
    also if these are fewer than the unknowns.
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


def settled_candidates(task: AbstractTask, p: Real, s: Real) -> Real:
    """Candidates p (many, unknowns) after the last Newton steps, whatever rounding does to their merit.

    With fewer active peaks than unknowns the merit is flat and determines only half of the digits that its derivatives
    do; the rest would depend on the path of the search.
    """
    value, box = task.merit(p, s), np.full(len(p), SETTLING)
    for _ in range(2):
        new = _tries(task, p, s, box, value)[0][2]
        merit = task.merit(new, s)
        near = (np.abs(new - p).max(axis=1) < SETTLING) & (merit <= value * (1 + SETTLING**2))
        p = np.where(near[:, None], new, p)
    return p


def _tries(task: AbstractTask, p: Real, s: Real, box: Real, value: Real) -> tuple[Real, Real]:
    """Candidates after the linear step, after it and Newton's, both corrected, and the predicted gain of the first."""
    free = np.flatnonzero(task.free)
    n = len(free)
    rows, bounds, open_rows = _linearised(task, p, s, free)
    bounds[:, open_rows + 1 :] = box[:, None]
    # The start is the corner of the box with all unknowns at their lower ends.
    there = -box[:, None] * rows[:, :, :n].sum(axis=2) - bounds
    # Limits are the rows with the violation, except its own.
    limits = int((rows[0, :, n + 1] < 0).sum()) - 1
    worst = np.argmax(there[:, : open_rows - limits], axis=1)
    broken = open_rows - limits + np.argmax(there[:, open_rows - limits : open_rows + 1], axis=1)
    low = np.tile(np.arange(open_rows + 1 + n, open_rows + 1 + 2 * n), (len(p), 1))
    cost = np.zeros(n + 2)
    cost[n:] = 1, PENALTY
    x, prices = least(cost, rows, bounds, np.column_stack([low, worst, broken]))
    # The active rows without those of the box.
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


def _linearised(task: AbstractTask, p: Real, s: Real, free: Whole) -> tuple[Real, Real, int]:
    """Rows and bounds of the linear programme, with those of the box 0, and the column of `broken`.

    Variables are the step, the largest error, and the violation of limits. Rows are errors from above and below,
    limits, a non-negative violation, and the box.
    """
    n = len(free)
    e, (limits, steep) = task.error(p, s), task.limits(p)
    # At a toggle the error has infinite slope; such a row gives no direction.
    slopes, steep = (np.nan_to_num(slopes, nan=0.0, posinf=0.0, neginf=0.0) for slopes in (task.slopes(p, s), steep))
    m, k = e.shape[1], limits.shape[1]
    end = 2 * m + k
    rows, bounds = np.zeros((len(p), end + 1 + 2 * n, n + 2)), np.zeros((len(p), end + 1 + 2 * n))
    rows[:, :m, :n], rows[:, m : 2 * m, :n] = slopes[..., free], -slopes[..., free]
    rows[:, : 2 * m, n], rows[:, 2 * m : end + 1, n + 1] = -1, -1
    rows[:, 2 * m : end, :n] = steep[..., free]
    rows[:, end + 1 :, :n] = np.vstack([np.eye(n), -np.eye(n)])
    bounds[:, :m], bounds[:, m : 2 * m], bounds[:, 2 * m : end] = -e, e, -limits
    return rows, bounds, end


def _newton(held: Real, paid: Mask, right: Real, curvature: Real, cost: Real) -> Real:
    """Newton's step (many, n): the minimum of cost and curvature with the active rows; 0 if it fails."""
    many, size, _ = held.shape
    n = size - 2
    system, values = np.zeros((many, 2 * size, 2 * size)), np.zeros((many, 2 * size))
    system[:, :n, :n] = curvature
    system[:, :size, size:], system[:, size:, :size] = np.swapaxes(held, 1, 2), held
    system[:, range(size, 2 * size), range(size, 2 * size)] = ~paid
    # A small addition to the diagonal, since a duplicate row makes the system singular.
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
    """(many, n, rows) map from residuals of the active rows to the shortest step that makes all meet."""
    free = np.ones(n + 2)
    free[n:] = 1e4
    square = (held * free) @ np.swapaxes(held, 1, 2)
    # A larger addition to the diagonal, since two rows may nearly coincide.
    square[:, range(n + 2), range(n + 2)] = square[:, range(n + 2), range(n + 2)] * (1 + 1e-10) + ~paid
    try:
        step_map: Real = ((free[:, None] * np.swapaxes(held, 1, 2)) @ np.linalg.inv(square))[:, :n]
    except np.linalg.LinAlgError:
        step_map = np.zeros((len(held), n, n + 2))
    return step_map


def _curvature(task: AbstractTask, p: Real, s: Real, prices: Real, free: Whole, limits: int) -> Real:
    """(many, n, n) second derivatives of the errors and limits, weighted by their prices."""
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
    hessian = np.nan_to_num(np.stack(columns, axis=1), nan=0.0, posinf=0.0, neginf=0.0)
    return 0.5 * (hessian + np.swapaxes(hessian, 1, 2))


@record(eq=False)
class OptimalityCertificate:
    """Multipliers of peaks (peaks,), with sum 1, and of limits (limits,), not negative; and the residual."""

    peaks: Real
    limits: Real
    left: float


def certified(task: AbstractTask, p: Real, s: Real, errors: Real) -> OptimalityCertificate:
    """Multipliers at a candidate p (unknowns,) whose error has its peaks at s (peaks,).

    Kuhn and Tucker's conditions (Nonlinear programming, 1951) of the least largest error: the derivatives of |error| at
    the highest peaks and of the active limits, each times a non-negative multiplier, sum to 0. Found by least squares
    on the active ones, dropping the most negative until none is.
    """
    free = task.free
    limits, steep = (rows[0] for rows in task.limits(p[None]))
    slopes = np.sign(errors)[:, None] * task.slopes(p[None], s[None])[0]
    holds = np.concatenate([np.abs(errors) >= (1 - LEVEL) * np.abs(errors).max(), limits >= -ACTIVE])
    columns = np.concatenate([slopes, steep])[:, free].T
    # The last row makes the multipliers of the peaks sum to 1.
    system = np.vstack([columns, np.concatenate([np.ones(len(s)), np.zeros(len(limits))])])
    right = np.append(np.zeros(len(columns)), 1.0)
    multipliers = np.zeros(len(holds))
    while holds.any():
        multipliers[:] = 0
        multipliers[holds] = np.linalg.lstsq(system[:, holds], right, rcond=None)[0]
        if multipliers.min() >= 0:
            break
        holds[np.argmin(multipliers)] = False
    size = np.linalg.norm(columns, axis=0) @ multipliers
    residual = float(np.linalg.norm(system @ multipliers - right) / max(size, 1.0))
    return OptimalityCertificate(multipliers[: len(s)], multipliers[len(s) :], residual)
