"""Coefficients whose largest row is least: by linear programming, to the last digit, and the bound that proves it.

Throughout, c are the coefficients (n,) of a family; equal c = values are the conditions it must meet,
rows c the accelerations that count, limited c the jerks as a share of their limit.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev

from ...plane.vec import Real
from .laws import condition_row, derive

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
    """What max |rows c| is at least, for every c with equal c = values and |limited c| <= 1.

    For weights w of the rows with sum |w| = 1, shares u of the limited rows and any m with
    equal^T m = rows^T w + limited^T u, max |rows c| >= w rows c = m values - u limited c >= m values - sum |u|.
    near: coefficients near the optimum; what rounding leaves of the equation is worth that much there.
    """
    total = float(np.abs(weights).sum())
    if total == 0:
        return 0.0
    pull = rows.T @ weights + limited.T @ shares
    m = np.linalg.lstsq(equal.T, pull, rcond=None)[0]
    missed = np.abs(pull - equal.T @ m) @ np.abs(near)
    return max(float(m @ values - np.abs(shares).sum() - missed) / total, 0.0)


@dataclass(frozen=True, eq=False)
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
                [_rows(signs, places, peaked + up, n), _rows(limited_signs, limited_places, limited + up, n) / limit]
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
        found = np.linalg.lstsq(system, right, rcond=1e-14)[0]
        c, weight = c + found[:n], found[a]
    return LevelPeaks(c, places, signs * weight[:k], limited_places, limited_signs * weight[k:])


def _rows(signs: Real, places: Real, order: int, n: int) -> Real:
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
