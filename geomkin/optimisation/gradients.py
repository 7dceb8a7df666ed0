"""Gradient searches: the best design that sequential quadratic programming reaches from a given one."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress

import numpy as np

from ..core.records import record
from ..plane.vec import Real
from .designs import Target, Trials, TriedDesign

# Step of a difference quotient, as a share of a key's range.
DIFFERENCE = 1e-7
# Relative change of the objective and of the values at which a gradient search ends, and its most steps.
CONVERGED, MOST_STEPS = 1e-10, 200
# Distance from its limit at which a constraint is kept, as a share of its terms, so that rounding does not violate it.
MARGIN = 1e-9


class TimeOverError(Exception):
    """The time limit, from within a gradient search."""


@record(eq=False)
class Box:
    """Ranges of the keys that vary.

    Parameters
    ----------
    low, high : mapping of str to float
        By key; keys of whole numbers are fixed, with equal values.
    """

    low: Mapping[str, float]
    high: Mapping[str, float]

    @property
    def free(self) -> tuple[str, ...]:
        """Keys whose value varies."""
        return tuple(key for key in self.low if self.low[key] < self.high[key])

    def holds(self, values: Mapping[str, float]) -> bool:
        """Whether the values are within the ranges."""
        return all(low <= values[key] <= self.high[key] for key, low in self.low.items())

    def values(self, shares: Real) -> dict[str, float]:
        """Values by key at shares of the ranges of the free keys."""
        varied = {
            key: min(self.low[key] + float(share) * (self.high[key] - self.low[key]), self.high[key])
            for key, share in zip(self.free, shares)
        }
        return {key: varied.get(key, self.low[key]) for key in self.low}

    def shares(self, values: Mapping[str, float]) -> Real:
        """Shares of the ranges, of values by key."""
        return np.array([(values[key] - self.low[key]) / (self.high[key] - self.low[key]) for key in self.free])


def gradient_search(trials: Trials, box: Box, start: Real, target: Target, of_violation: bool = False) -> None:
    """Sequential quadratic programming from one design; the designs that it tries are added to `trials`.

    The largest of many values is minimised through one more variable that none of them exceeds, so that kinks are no
    obstacle. Gradients are difference quotients. Kraft, A software package for sequential quadratic programming, 1988,
    as NLopt has it. With `of_violation` the largest violation of a constraint is minimised instead of the objective.
    """
    import nlopt

    reference = None if trials.over() else trials.tried(box.values(start))
    if reference is None:
        return
    count = len(start)
    objective_rows, excess_rows = _rows(target, reference, of_violation)
    scale = max(float(np.abs(objective_rows).max()), 1e-12)
    has_bound = len(objective_rows) > 1
    known: dict[bytes, tuple[Real, Real]] = {}

    def results(shares: Real) -> tuple[Real, Real]:
        """Rows of the objective and of the constraints; far above all others where there is no design."""
        if trials.over():
            raise TimeOverError
        key = shares.tobytes()
        if key not in known:
            design = trials.tried(box.values(shares))
            if design is None:
                known[key] = np.full(len(objective_rows), 1e3), np.ones(len(excess_rows))
            else:
                wanted, excess = _rows(target, design, of_violation)
                known[key] = (
                    _resampled(wanted, len(objective_rows)) / scale,
                    _resampled(excess, len(excess_rows)) + MARGIN,
                )
        return known[key]

    def slopes(shares: Real) -> tuple[Real, Real]:
        """Derivatives of both by the shares."""
        here, columns = results(shares), []
        for k in range(count):
            step = DIFFERENCE if shares[k] + DIFFERENCE <= 1 else -DIFFERENCE
            there = results(shares + step * np.eye(count)[k])
            columns.append([(b - a) / step for a, b in zip(here, there)])
        return np.stack([c[0] for c in columns], axis=1), np.stack([c[1] for c in columns], axis=1)

    def objective(x: Real, gradient: Real) -> float:
        if has_bound:
            if gradient.size:
                gradient[:] = np.append(np.zeros(count), 1.0)
            return float(x[count])
        if gradient.size:
            gradient[:] = slopes(x)[0][0]
        return float(results(x)[0][0])

    def constraints(values: Real, x: Real, gradient: Real) -> None:
        wanted_rows, excess = results(x[:count])
        if has_bound:
            values[:] = np.concatenate([wanted_rows - x[count], excess])
        else:
            values[:] = excess
        if gradient.size:
            by_objective, by_excess = slopes(x[:count])
            if has_bound:
                gradient[:, :count] = np.concatenate([by_objective, by_excess])
                gradient[:, count] = np.where(np.arange(len(values)) < len(wanted_rows), -1.0, 0.0)
            else:
                gradient[:] = by_excess

    solver = nlopt.opt(nlopt.LD_SLSQP, count + has_bound)
    solver.set_min_objective(objective)
    rows = len(excess_rows) + (len(objective_rows) if has_bound else 0)
    if rows:
        solver.add_inequality_mconstraint(constraints, np.zeros(rows))
    solver.set_lower_bounds(np.append(np.zeros(count), [-np.inf] * has_bound))
    solver.set_upper_bounds(np.append(np.ones(count), [np.inf] * has_bound))
    solver.set_ftol_rel(CONVERGED)
    solver.set_xtol_rel(CONVERGED)
    solver.set_maxeval(MOST_STEPS)
    # At an optimum where many values are equal there may be no further step; the best design is known.
    with suppress(TimeOverError, nlopt.RoundoffLimited, nlopt.ForcedStop, nlopt.runtime_error):
        solver.optimize(np.append(start, [float(objective_rows.max()) / scale] * has_bound))


def _rows(target: Target, design: TriedDesign, of_violation: bool) -> tuple[Real, Real]:
    """The rows of which the largest is minimised, and those that have to be at most 0."""
    excess = np.concatenate([*design.excess_rows, np.zeros(0)])
    return (excess, np.zeros(0)) if of_violation else (target.rows(design), excess)


def _resampled(rows: Real, count: int) -> Real:
    """The rows, interpolated if a design has another number of them."""
    if len(rows) == count:
        return rows
    resampled: Real = np.interp(np.linspace(0, 1, count), np.linspace(0, 1, len(rows)), rows)
    return resampled
