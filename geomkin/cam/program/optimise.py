"""Coefficients whose largest row is least: by linear programming, to the last digit, and the bound that proves it.

Throughout, c are the coefficients (n,) of a family; equal c = values are the conditions it must meet,
rows c the accelerations that count, limited c the jerks as a share of their limit.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.polynomial import chebyshev

from ...core.errors import DesignError
from ...core.records import record
from ...plane.vec import Real
from .laws import Law, PiecewisePolynomial, chebyshev_law, condition_row, derive

# By how much the solver may break a condition, absolute: the least it takes. More leaves more for Newton's steps to
# mend.
TOLERANCE = 1e-10


def least_peak(equal: Real, values: Real, rows: Real, limited: Real) -> tuple[Real, Real, Real] | None:
    """c with equal c = values and |limited c| <= 1 and the least max |rows c|, and multipliers that prove it.

    None where the conditions leave no c. The multipliers, of rows and of limited, are those of `bound`.
    """
    # HiGHS: 5 MB to load and nothing but numpy beside it; the well-known scientific library around the same
    # solver is thirty times as large and takes a quarter of a second to import.
    import highspy

    n, k, j = equal.shape[1], len(rows), len(limited)
    infinite = np.full(k, np.inf)
    top = np.concatenate([-np.ones(k), np.ones(k), np.zeros(j + len(equal))])
    matrix = np.column_stack([np.vstack([rows, rows, limited, equal]), top])
    model = highspy.HighsLp()
    model.num_row_, model.num_col_ = matrix.shape
    model.col_cost_ = np.append(np.zeros(n), 1.0)
    model.col_lower_, model.col_upper_ = np.full(n + 1, -np.inf), np.full(n + 1, np.inf)
    model.row_lower_ = np.concatenate([-infinite, np.zeros(k), -np.ones(j), values])
    model.row_upper_ = np.concatenate([np.zeros(k), infinite, np.ones(j), values])
    row, column = np.nonzero(matrix)
    model.a_matrix_.format_ = highspy.MatrixFormat.kRowwise
    model.a_matrix_.start_ = np.searchsorted(row, np.arange(len(matrix) + 1)).astype(np.int32)
    model.a_matrix_.index_ = column.astype(np.int32)
    model.a_matrix_.value_ = matrix[row, column]
    solver = highspy.Highs()  # type: ignore[no-untyped-call]
    solver.setOptionValue("output_flag", False)
    # One thread and no presolve: the same path on every run, and such small problems repay neither.
    solver.setOptionValue("threads", 1)
    solver.setOptionValue("presolve", "off")
    solver.setOptionValue("primal_feasibility_tolerance", TOLERANCE)
    solver.setOptionValue("dual_feasibility_tolerance", TOLERANCE)
    solver.passModel(model)
    solver.run()
    if solver.getModelStatus() != highspy.HighsModelStatus.kOptimal:
        return None
    solution = solver.getSolution()
    dual = -np.array(solution.row_dual)
    return np.array(solution.col_value[:n]), dual[:k] + dual[k : 2 * k], dual[2 * k : 2 * k + j]


def bound(equal: Real, values: Real, rows: Real, weights: Real, limited: Real, shares: Real, near: Real) -> float:
    """A lower bound of max |rows c| for all c with equal c = values and |limited c| <= 1.

    For weights w of the rows with sum |w| = 1, shares u of the limited rows and any m with
    equal^T m = rows^T w + limited^T u, max |rows c| >= w rows c = m values - u limited c >= m values - sum |u|.
    near: coefficients near the optimum, by which the rounding error of the equation is weighted.
    """
    total = float(np.abs(weights).sum())
    if total == 0:
        return 0.0
    pull = rows.T @ weights + limited.T @ shares
    m = np.linalg.lstsq(equal.T, pull, rcond=None)[0]
    missed = np.abs(pull - equal.T @ m) @ np.abs(near)
    return max(float(m @ values - np.abs(shares).sum() - missed) / total, 0.0)


@record(eq=False)
class LevelPeaks:
    """coefficients (n,); places of the peaks that count and their multipliers, as `bound` takes them."""

    coefficients: Real
    places: Real
    weights: Real
    limited_places: Real
    shares: Real


def level_peaks(c: Real, equal: Real, values: Real, peaked: int, limited: int, limit: float, near: float) -> LevelPeaks:
    """Newton's method on the conditions of an optimum, for a Chebyshev series with coefficients c.

    The derivative of order `peaked` has its peaks least, that of order `limited` is at most `limit`,
    infinite for none.
    At the optimum the peaks that count are of one height, the limited ones that count are at the
    limit, and their weights together pull c nowhere that equal c = values leaves free. A peak's
    height bends as its place moves with c: without that term the method would not converge where
    fewer peaks count than c has freedoms. near: how far below the highest, relative, a peak counts.
    """
    n, e = len(c), len(equal)
    weight: Real = np.zeros(0)
    # Newton's method converges quadratically from a percent off: seven steps do, the eighth is to spare.
    for _ in range(8):
        series = derive(c, peaked)
        places, signs, bend = _near(series, (1 - near) * peak(series))
        limited_places, limited_signs, limited_bend = _near(derive(c, limited), (1 - near) * limit)
        k, j = len(places), len(limited_places)
        if len(weight) != k + j:
            weight = np.concatenate([np.full(k, 1 / k), np.zeros(j)])
        active, moved = (
            np.vstack(
                [
                    _signed_rows(signs, places, peaked + up, n),
                    _signed_rows(limited_signs, limited_places, limited + up, n) / limit,
                ]
            )
            for up in (0, 1)
        )
        bends = np.maximum(weight, 0) * np.append(bend, limited_bend * limit)
        # Unknown: the step of c, the weights, the multipliers of the conditions, the height.
        a, m, t = slice(n, n + k + j), slice(n + k + j, n + k + j + e), n + k + j + e
        system, right = np.zeros((t + 1, t + 1)), np.zeros(t + 1)
        system[:n, :n] = moved.T @ (bends[:, None] * moved)
        system[a, :n], system[:n, a] = active, active.T
        system[m, :n], system[:n, m] = equal, equal.T
        system[n : n + k, t] = system[t, n : n + k] = -1
        right[a] = np.append(np.zeros(k), np.ones(j)) - active @ c
        right[m] = values - equal @ c
        right[t] = -1
        solution = np.linalg.lstsq(system, right, rcond=1e-14)[0]
        c, weight = c + solution[:n], solution[a]
    return LevelPeaks(c, places, signs * weight[:k], limited_places, limited_signs * weight[k:])


def _signed_rows(signs: Real, places: Real, order: int, n: int) -> Real:
    return signs[:, None] * condition_row(places, order, n - 1).T


def _near(series: Real, least: float) -> tuple[Real, Real, Real]:
    """Places of the extremes of at least that size, their signs, and how much each gains because its place may move.

    That is 1 / |second derivative|, or 0 at the ends, which do not move.
    """
    places = extremes(series)
    value, second = (chebyshev.chebval(2 * places - 1, derive(series, k)) for k in (0, 2))
    bend = np.zeros(len(places))
    # The term of a very flat peak would drown the others: bounded, it only slows the steps.
    bend[1:-1] = 1 / np.maximum(np.abs(second[1:-1]), 1e-3 * np.abs(second).max(initial=1e-300))
    near = np.abs(value) >= least
    return places[near], np.sign(value[near]), bend[near]


def peak(series: Real) -> float:
    """Largest size of a Chebyshev series over 0 <= x <= 1."""
    return float(np.abs(chebyshev.chebval(2 * extremes(series) - 1, series)).max())


def extremes(series: Real) -> Real:
    """Places in 0 <= x <= 1 where a Chebyshev series is extreme, the ends among them."""
    slope = chebyshev.chebder(series)
    # Leading coefficients that are rounding would send roots to infinity.
    slope = chebyshev.chebtrim(slope, 1e-13 * np.abs(slope).max())
    roots = chebyshev.chebroots(slope)
    # A double root comes out as a pair beside the real axis, off it by the root of the rounding.
    real = np.real(roots)[(np.abs(np.imag(roots)) < 1e-6) & (np.abs(np.real(roots)) < 1)]
    return np.unique(np.concatenate([[0.0], (real + 1) / 2, [1.0]]))


# How far the peak may lie above the bound, and the jerk above its limit, relative. Less is lost in
# rounding at degree 15, more shows in the files.
GAP = 1e-9
# Peaks this near the highest, relative, count in the first round. A solution that saw the curve at a few places only
# comes no nearer: less leaves out peaks that count, more takes in some that do not.
NEAR = 0.01
# Rounds before giving up. One or two do as a rule; where peaks merge, each brings the places twice as near, and fewer
# rounds would refuse the segment.
ROUNDS = 40

# A peak acceleration below this, for a rise or slopes of 1 over an angle of 1, counts as 0: for a motion that may be
# uniform the bound only reaches 0 to rounding. A smaller value would refuse such segments; a larger one would ignore
# small accelerations.
NOTHING = 1e-12


@record(eq=False)
class OptimalLaw:
    """A motion of least peak acceleration within its family, over an angle.

    law: its lift from 0 and the derivatives over 0 <= x <= 1, before any scaling. peak_acceleration, peak_jerk: largest
    magnitudes of the derivatives by angle. bound: proven lower bound of the peak acceleration of the family. Derived
    here.
    """

    law: Law
    peak_acceleration: float
    peak_jerk: float
    bound: float
    rise: float
    angle: float = 1.0

    @property
    def gap(self) -> float:
        """Relative difference of the peak and the bound: 0 proves the optimum."""
        return float(max(self.peak_acceleration / self.bound - 1, 0.0)) if self.bound > 0 else 0.0

    @property
    def acceleration_coefficient(self) -> float:
        """Peak acceleration as a multiple of rise / angle^2 (2 pi for cycloidal motion); nan without a rise."""
        return self.peak_acceleration * self.angle**2 / abs(self.rise) if self.rise else np.nan

    @property
    def jerk_coefficient(self) -> float:
        """Peak jerk as a multiple of rise / angle^3 (4 pi^2 for cycloidal motion); nan without a rise."""
        return self.peak_jerk * self.angle**3 / abs(self.rise) if self.rise else np.nan

    def scaled(self, size: float, angle: float) -> OptimalLaw:
        """The optimum for lifts `size` times as large, over another angle than 1; the law is unchanged."""
        by = abs(size) / angle**2
        peaks = self.peak_acceleration * by, self.peak_jerk * by / angle, self.bound * by
        return OptimalLaw(self.law, *peaks, self.rise * size, angle)


# Optima are kept, so that a recipe solves once for checks, files and plots, and equal segments once for all.
@lru_cache(maxsize=256)
def optimal_polynomial(
    degree: int, rise: float, start: tuple[float, ...], end: tuple[float, ...], jerk_limit: float | None
) -> OptimalLaw:
    """Polynomial motion from 0 to `rise` with given slope, curvature (and jerk) by x at x = 0 and at x = 1.

    Degree 5 at least, 7 where jerks are given. Between two rests the best motion of an even degree is
    that of the odd one below it.
    """
    # The unknown is the acceleration: its Chebyshev coefficients are all of one size.
    n = degree - 1
    once, twice = (chebyshev.chebval(1, chebyshev.chebint(np.eye(n), k, lbnd=-1, scl=0.5)) for k in (1, 2))
    ends = [condition_row(x, k, n - 1) for x in (0.0, 1.0) for k in range(len(start) - 1)]
    equal = np.stack([once, twice, *ends])
    values = np.array([end[0] - start[0], rise - start[0], *start[1:], *end[1:]])
    limit = jerk_limit or np.inf
    grid, jerks = _rows(_grid(n), 0, n), _rows(_grid(n), 1, n)
    _check_jerk(jerk_limit, equal, values, jerks)
    best, proven = None, max(abs(start[1]), abs(end[1]))
    if proven > 0:
        solved = least_peak(equal, values, grid, jerks / limit)
        if solved and np.abs(grid @ solved[0]).max() <= proven * (1 + GAP):
            best, _ = _of_least_peak(1, equal, values, 0, proven * (1 + GAP / 2))
    if best is None or peak(derive(best, 1)) > limit * (1 + GAP):
        best, proven = _of_least_peak(0, equal, values, 1, limit)
    if best is None:
        raise DesignError("degree", f"found {degree}, for which no optimum settles", "give another degree")
    velocity = chebyshev.chebint(best, 1, k=start[0], lbnd=-1, scl=0.5)
    lift = chebyshev.chebint(velocity, 1, lbnd=-1, scl=0.5)
    jerk = derive(best, 1)
    return OptimalLaw(chebyshev_law([lift, velocity, best, jerk]), peak(best), peak(jerk), proven, rise)


def _of_least_peak(peaked: int, equal: Real, values: Real, limited: int, limit: float) -> tuple[Real | None, float]:
    """Chebyshev series whose derivative of order `peaked` has the least peak, and the bound that proves it.

    Its derivative of order `limited` is at most `limit`. The linear programme looks at places, to which
    those of the peaks found are added in each round. None where there is no such series, or none settles.
    """
    n = equal.shape[1]
    places = _grid(n)
    limited_places = places if np.isfinite(limit) else places[:0]
    best, least, proven = None, np.inf, 0.0

    def prove(places: Real, weights: Real, limited_places: Real, shares: Real, c: Real) -> float:
        return bound(
            equal, values, _rows(places, peaked, n), weights, _rows(limited_places, limited, n) / limit, shares, c
        )

    for turn in range(ROUNDS):
        solved = least_peak(equal, values, _rows(places, peaked, n), _rows(limited_places, limited, n) / limit)
        if solved is None:
            return None, proven
        c, weights, shares = solved
        level = level_peaks(c, equal, values, peaked, limited, limit, NEAR / 4**turn)
        proven = max(
            proven,
            prove(places, weights, limited_places, shares, c),
            prove(level.places, level.weights, level.limited_places, level.shares, level.coefficients),
        )
        for found in (c, level.coefficients):
            found = found + np.linalg.pinv(equal) @ (values - equal @ found)
            height = peak(derive(found, peaked))
            if height < least and peak(derive(found, limited)) <= limit * (1 + GAP):
                best, least = found, height
            places = np.union1d(places, extremes(derive(found, peaked)))
            if np.isfinite(limit):
                limited_places = np.union1d(limited_places, extremes(derive(found, limited)))
        if least <= max(proven * (1 + GAP), NOTHING):
            return best, proven if least > NOTHING else 0.0
    return None, proven


def _grid(n: int) -> Real:
    """Eight places for each coefficient, close together at the ends: they see every wave of the series."""
    return 0.5 - 0.5 * np.cos(np.linspace(0, np.pi, 8 * n + 1))


def _rows(places: Real, order: int, n: int) -> Real:
    return condition_row(places, order, n - 1).T


@lru_cache(maxsize=256)
def optimal_spline(
    intervals: int, rise: float, start: tuple[float, ...], end: tuple[float, ...], jerk_limit: float | None
) -> OptimalLaw:
    """Motion from 0 to `rise` whose acceleration is straight over each of equal intervals; its ends as above.

    Peaks lie at knots, so that the linear programme is exact.
    """
    x, step = np.linspace(0, 1, intervals + 1), 1 / intervals
    knots = np.eye(intervals + 1)
    slopes = np.diff(knots, axis=0) * intervals
    # What each knot's acceleration adds to slope and lift at the end: integrals of its hat function.
    once, twice = np.full(intervals + 1, step), step * (1 - x)
    once[[0, -1]] /= 2
    twice[[0, -1]] = step / 2 - step**2 / 6, step**2 / 6
    equal = np.stack([once, twice, knots[0], knots[-1]])
    values = np.array([end[0] - start[0], rise - start[0], start[1], end[1]])
    _check_jerk(jerk_limit, equal, values, slopes)
    limited = slopes / jerk_limit if jerk_limit else slopes[:0]
    solved = least_peak(equal, values, knots, limited)
    if solved is None:
        raise DesignError("intervals", f"found {intervals}, for which no optimum settles", "give another number")
    c, weights, shares = solved
    proven = bound(equal, values, knots, weights, limited, shares, c)
    highest = max(abs(start[1]), abs(end[1]))
    if 0 < np.abs(c).max() <= highest * (1 + GAP):
        c = (least_peak(equal, values, slopes, knots / highest / (1 + GAP / 2)) or solved)[0]
    a = c + np.linalg.pinv(equal) @ (values - equal @ c)
    jerk = slopes @ a
    v = start[0] + np.append(0, np.cumsum(step * (a[:-1] + a[1:]) / 2))
    s = np.append(0, np.cumsum(step * v[:-1] + step**2 * (2 * a[:-1] + a[1:]) / 6))
    # Where the acceleration runs straight through a knot, that is no break.
    bends = np.abs(np.diff(jerk)) > 1e-9 * np.abs(jerk).max()
    breaks = np.concatenate([[0.0], x[1:-1][bends], [1.0]])
    law = PiecewisePolynomial(x, np.stack([s[:-1], v[:-1], a[:-1] / 2, jerk / 6]), breaks)
    return OptimalLaw(law, float(np.abs(a).max()), float(np.abs(jerk).max()), proven, rise)


def _check_jerk(limit: float | None, equal: Real, values: Real, jerks: Real) -> None:
    """Refuse a limit no motion can keep, and say the least that would do: it is a peak as well."""
    if limit is None:
        return
    solved = least_peak(equal, values, jerks, jerks[:0])
    least = bound(equal, values, jerks, solved[1], jerks[:0], np.zeros(0), solved[0]) if solved else np.inf
    if limit < least:
        raise DesignError(
            "jerk_limit",
            f"found {limit:g}, but every motion of this family that meets its ends reaches {least:.6g}",
            f"give at least {1.001 * least:.4g}, or leave it out",
        )
