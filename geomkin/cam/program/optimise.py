"""Segments of least peak acceleration: found by linear programming and Newton's method, and proven by a lower bound.

In all functions c (n,) are the coefficients of a motion, for example of a Chebyshev series. `equal c = values` are the
conditions at its ends, `rows c` its accelerations at some places, and `limited c` its jerks as a share of their limit.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.polynomial import chebyshev

from ...core.errors import DesignError
from ...core.records import record
from ...plane.vec import Real
from .laws import Law, PiecewisePolynomial, chebyshev_law, condition_row, derive

# Absolute error of the conditions in the solver's result: the least that the solver accepts. A larger one takes more
# steps of Newton's method.
TOLERANCE = 1e-10


def least_peak(equal: Real, values: Real, rows: Real, limited: Real) -> tuple[Real, Real, Real] | None:
    """The c with equal c = values, |limited c| <= 1 and least max |rows c|, and the multipliers that prove it.

    The multipliers are those of `rows` and of `limited`, as for `bound`. None if no c meets the conditions.
    """
    # HiGHS needs 5 MB and only NumPy; SciPy, which contains it, is thirty times as large and imports in 0.25 s.
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
    # One thread and no presolve, so that every run takes the same steps; problems this small are not slower.
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
    near: coefficients near the optimum, which weight the rounding errors of the equation for m.
    """
    total = float(np.abs(weights).sum())
    if total == 0:
        return 0.0
    pull = rows.T @ weights + limited.T @ shares
    m = np.linalg.lstsq(equal.T, pull, rcond=None)[0]
    error = np.abs(pull - equal.T @ m) @ np.abs(near)
    return max(float(m @ values - np.abs(shares).sum() - error) / total, 0.0)


@record(eq=False)
class LevelPeaks:
    """The result of `level_peaks`: coefficients (n,), and places and multipliers of the active peaks, for `bound`."""

    coefficients: Real
    places: Real
    weights: Real
    limited_places: Real
    shares: Real


def level_peaks(c: Real, equal: Real, values: Real, peaked: int, limited: int, limit: float, near: float) -> LevelPeaks:
    """Improve a Chebyshev series c by Newton's method on the conditions of an optimum.

    The derivative of order `peaked` has the least peak, and that of order `limited` is at most `limit`, which may be
    inf. At the optimum all active peaks of the first have equal height, those of the second are at the limit, and a
    weighted sum of their gradients is a combination of the conditions `equal`. The curvature of a peak is included,
    since a peak moves with c: without it the method does not converge if c has more freedoms than active peaks. near:
    relative distance from the highest peak within which a peak is active.
    """
    n, e = len(c), len(equal)
    weight: Real = np.zeros(0)
    # From an error of 1 % Newton's method converges in seven steps; the eighth is a reserve.
    for _ in range(8):
        series = derive(c, peaked)
        places, signs, gain = _high_extremes(series, (1 - near) * peak(series))
        limited_places, limited_signs, limited_gain = _high_extremes(derive(c, limited), (1 - near) * limit)
        k, j = len(places), len(limited_places)
        if len(weight) != k + j:
            weight = np.concatenate([np.full(k, 1 / k), np.zeros(j)])
        active, active_slopes = (
            np.vstack(
                [
                    signs[:, None] * _rows(places, peaked + up, n),
                    limited_signs[:, None] * _rows(limited_places, limited + up, n) / limit,
                ]
            )
            for up in (0, 1)
        )
        gains = np.maximum(weight, 0) * np.append(gain, limited_gain * limit)
        # Unknowns: the step of c, the weights, the multipliers of the conditions, and the height of the peaks.
        a, m, t = slice(n, n + k + j), slice(n + k + j, n + k + j + e), n + k + j + e
        system, right = np.zeros((t + 1, t + 1)), np.zeros(t + 1)
        system[:n, :n] = active_slopes.T @ (gains[:, None] * active_slopes)
        system[a, :n], system[:n, a] = active, active.T
        system[m, :n], system[:n, m] = equal, equal.T
        system[n : n + k, t] = system[t, n : n + k] = -1
        right[a] = np.append(np.zeros(k), np.ones(j)) - active @ c
        right[m] = values - equal @ c
        right[t] = -1
        solution = np.linalg.lstsq(system, right, rcond=1e-14)[0]
        c, weight = c + solution[:n], solution[a]
    return LevelPeaks(c, places, signs * weight[:k], limited_places, limited_signs * weight[k:])


def _high_extremes(series: Real, least: float) -> tuple[Real, Real, Real]:
    """Places of the extremes whose size is at least `least`, their signs, and 1 / |second derivative| there.

    The last is twice the gain of a peak from a unit slope; it is 0 at both ends, since these do not move.
    """
    places = extremes(series)
    value, second = (chebyshev.chebval(2 * places - 1, derive(series, k)) for k in (0, 2))
    gain = np.zeros(len(places))
    # Bounded, since the gain of a very flat peak would exceed all others by far; this only slows convergence.
    gain[1:-1] = 1 / np.maximum(np.abs(second[1:-1]), 1e-3 * np.abs(second).max(initial=1e-300))
    high = np.abs(value) >= least
    return places[high], np.sign(value[high]), gain[high]


def peak(series: Real) -> float:
    """Largest size of a Chebyshev series over 0 <= x <= 1."""
    return float(np.abs(chebyshev.chebval(2 * extremes(series) - 1, series)).max())


def extremes(series: Real) -> Real:
    """Places in 0 <= x <= 1 of the extremes of a Chebyshev series, and both ends."""
    slope = chebyshev.chebder(series)
    # Leading coefficients that are rounding errors would give huge roots.
    slope = chebyshev.chebtrim(slope, 1e-13 * np.abs(slope).max())
    roots = chebyshev.chebroots(slope)
    # A double root is computed as a complex pair; its distance from the real axis is the square root of rounding.
    real = np.real(roots)[(np.abs(np.imag(roots)) < 1e-6) & (np.abs(np.real(roots)) < 1)]
    return np.unique(np.concatenate([[0.0], (real + 1) / 2, [1.0]]))


# Largest relative difference of the peak from the bound, and of the jerk from its limit. A smaller value is lost in
# rounding at degree 15, a larger one is visible in the files.
GAP = 1e-9
# Relative distance from the highest peak within which peaks are active in the first round. It is the accuracy of a
# solution for a few places: a smaller value omits active peaks, a larger one includes others.
NEAR = 0.01
# Largest number of rounds. Usually one or two suffice. If peaks merge, each round halves the error of their places;
# with fewer rounds such a segment would be refused.
ROUNDS = 40

# A peak acceleration below this, for a rise or slopes of 1 over an angle of 1, counts as 0: for a motion that may be
# uniform the bound only reaches 0 to rounding. A smaller value would refuse such segments; a larger one would ignore
# small accelerations.
NOTHING = 1e-12


@record(eq=False)
class OptimalLaw:
    """A motion of least peak acceleration within its family, over an angle.

    Parameters
    ----------
    law : callable
        Lift from 0 and its derivatives over 0 <= x <= 1, not scaled.
    peak_acceleration, peak_jerk : float
        Largest sizes of the derivatives by the angle.
    bound : float
        Proven lower bound of the peak acceleration of all motions of the family.

    Notes
    -----
    Derived here.
    """

    law: Law
    peak_acceleration: float
    peak_jerk: float
    bound: float

    @property
    def gap(self) -> float:
        """Relative difference of the peak and the bound: 0 proves the optimum."""
        return float(max(self.peak_acceleration / self.bound - 1, 0.0)) if self.bound > 0 else 0.0

    def scaled(self, size: float, angle: float) -> OptimalLaw:
        """The optimum for lifts `size` times as large, over another angle than 1, rad; the law is unchanged."""
        by = abs(size) / angle**2
        return OptimalLaw(self.law, self.peak_acceleration * by, self.peak_jerk * by / angle, self.bound * by)


# Results are cached: programmes are made again at every change in the studio, and many have equal segments.
@lru_cache(maxsize=256)
def optimal_polynomial(
    degree: int, rise: float, start: tuple[float, ...], end: tuple[float, ...], jerk_limit: float | None
) -> OptimalLaw:
    """The polynomial motion of least peak acceleration; of several, the one of least peak jerk.

    Parameters
    ----------
    degree : int
        At least 5, or 7 if jerks are given. Between two rests an even degree gives the motion of the next lower one.
    rise : float
        Lift at x = 1; at x = 0 it is 0.
    start, end : tuple of float
        Slope, curvature and, if given, jerk by x at x = 0 and at x = 1.
    jerk_limit : float or None
        Largest jerk by x.

    Returns
    -------
    OptimalLaw
        Over an angle of 1.

    Raises
    ------
    DesignError
        If no motion keeps the limit, or the search does not converge.
    """
    # The unknowns are Chebyshev coefficients of the acceleration, which are of similar size.
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
        raise DesignError("degree", f"found {degree}, for which the search does not converge", "give another degree")
    velocity = chebyshev.chebint(best, 1, k=start[0], lbnd=-1, scl=0.5)
    lift = chebyshev.chebint(velocity, 1, lbnd=-1, scl=0.5)
    jerk = derive(best, 1)
    return OptimalLaw(chebyshev_law([lift, velocity, best, jerk]), peak(best), peak(jerk), proven)


def _of_least_peak(peaked: int, equal: Real, values: Real, limited: int, limit: float) -> tuple[Real | None, float]:
    """The Chebyshev series whose derivative of order `peaked` has the least peak, and a lower bound of that peak.

    Its derivative of order `limited` is at most `limit`. The linear programme considers some places only; each round
    adds the places of the peaks of its result. None if there is no such series or the rounds do not converge.
    """
    n = equal.shape[1]
    places = _grid(n)
    limited_places = places if np.isfinite(limit) else places[:0]
    best, least, proven = None, np.inf, 0.0

    def prove(places: Real, weights: Real, limited_places: Real, shares: Real, c: Real) -> float:
        return bound(
            equal, values, _rows(places, peaked, n), weights, _rows(limited_places, limited, n) / limit, shares, c
        )

    for number in range(ROUNDS):
        solved = least_peak(equal, values, _rows(places, peaked, n), _rows(limited_places, limited, n) / limit)
        if solved is None:
            return None, proven
        c, weights, shares = solved
        level = level_peaks(c, equal, values, peaked, limited, limit, NEAR / 4**number)
        proven = max(
            proven,
            prove(places, weights, limited_places, shares, c),
            prove(level.places, level.weights, level.limited_places, level.shares, level.coefficients),
        )
        for trial in (c, level.coefficients):
            trial = trial + np.linalg.pinv(equal) @ (values - equal @ trial)
            height = peak(derive(trial, peaked))
            if height < least and peak(derive(trial, limited)) <= limit * (1 + GAP):
                best, least = trial, height
            places = np.union1d(places, extremes(derive(trial, peaked)))
            if np.isfinite(limit):
                limited_places = np.union1d(limited_places, extremes(derive(trial, limited)))
        if least <= max(proven * (1 + GAP), NOTHING):
            return best, proven if least > NOTHING else 0.0
    return None, proven


def _grid(n: int) -> Real:
    """Eight places for each coefficient, denser towards both ends, which resolve every wave of the series."""
    return 0.5 - 0.5 * np.cos(np.linspace(0, np.pi, 8 * n + 1))


def _rows(places: Real, order: int, n: int) -> Real:
    """Derivatives of an order of the first n Chebyshev polynomials at places: (places, n)."""
    return condition_row(places, order, n - 1).T


@lru_cache(maxsize=256)
def optimal_spline(
    intervals: int, rise: float, start: tuple[float, ...], end: tuple[float, ...], jerk_limit: float | None
) -> OptimalLaw:
    """The motion of least peak acceleration whose acceleration is linear over each of equal intervals.

    The other parameters and the result are those of `optimal_polynomial`. All peaks are at knots, so that the linear
    programme alone is exact.
    """
    x, step = np.linspace(0, 1, intervals + 1), 1 / intervals
    knots = np.eye(intervals + 1)
    slopes = np.diff(knots, axis=0) * intervals
    # Contribution of each knot's acceleration to slope and lift at the end: integrals of its hat function.
    once, twice = np.full(intervals + 1, step), step * (1 - x)
    once[[0, -1]] /= 2
    twice[[0, -1]] = step / 2 - step**2 / 6, step**2 / 6
    equal = np.stack([once, twice, knots[0], knots[-1]])
    values = np.array([end[0] - start[0], rise - start[0], start[1], end[1]])
    _check_jerk(jerk_limit, equal, values, slopes)
    limited = slopes / jerk_limit if jerk_limit else slopes[:0]
    solved = least_peak(equal, values, knots, limited)
    if solved is None:
        problem = f"found {intervals}, for which the search does not converge"
        raise DesignError("intervals", problem, "give another number")
    c, weights, shares = solved
    proven = bound(equal, values, knots, weights, limited, shares, c)
    highest = max(abs(start[1]), abs(end[1]))
    if 0 < np.abs(c).max() <= highest * (1 + GAP):
        c = (least_peak(equal, values, slopes, knots / highest / (1 + GAP / 2)) or solved)[0]
    a = c + np.linalg.pinv(equal) @ (values - equal @ c)
    jerk = slopes @ a
    v = start[0] + np.append(0, np.cumsum(step * (a[:-1] + a[1:]) / 2))
    s = np.append(0, np.cumsum(step * v[:-1] + step**2 * (2 * a[:-1] + a[1:]) / 6))
    # A knot at which the jerk does not change is no break.
    jumps = np.abs(np.diff(jerk)) > 1e-9 * np.abs(jerk).max()
    breaks = np.concatenate([[0.0], x[1:-1][jumps], [1.0]])
    law = PiecewisePolynomial(x, np.stack([s[:-1], v[:-1], a[:-1] / 2, jerk / 6]), breaks)
    return OptimalLaw(law, float(np.abs(a).max()), float(np.abs(jerk).max()), proven)


def _check_jerk(limit: float | None, equal: Real, values: Real, jerks: Real) -> None:
    """Raise DesignError if no motion keeps the limit of the jerk, and name the least possible limit."""
    if limit is None:
        return
    solved = least_peak(equal, values, jerks, jerks[:0])
    least = bound(equal, values, jerks, solved[1], jerks[:0], np.zeros(0), solved[0]) if solved else np.inf
    if limit < least:
        problem = f"found {limit:g}, but every motion of this family that meets its ends reaches {least:.6g}"
        raise DesignError("jerk_limit", problem, f"give at least {1.001 * least:.4g}, or omit it")
