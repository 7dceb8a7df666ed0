"""Coefficients whose largest row is least, by linear programming, and the bound that proves it.

Throughout, c are the coefficients (n,) of a family; equal c = values are the conditions it must meet,
rows c the accelerations that count, limited c the jerks as a share of their limit.
"""

from __future__ import annotations

import numpy as np

from ...plane.vec import Array

# The solver's tolerance of what must hold, absolute: its least.
TOLERANCE = 1e-10


def least_peak(equal: Array, values: Array, rows: Array, limited: Array) -> tuple[Array, Array, Array] | None:
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
    solver = highspy.Highs()
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


def bound(
    equal: Array, values: Array, rows: Array, weights: Array, limited: Array, shares: Array, near: Array
) -> float:
    """What max |rows c| is at least, for every c with equal c = values and |limited c| <= 1.

    For weights w of the rows with sum |w| = 1, shares u of the limited rows and any m with
    equal^T m = rows^T w + limited^T u, max |rows c| >= w rows c = m values - u limited c >= m values - sum |u|.
    near: coefficients near the optimum; what rounding leaves of the equation is worth that much there.
    """
    total = np.abs(weights).sum()
    if total == 0:
        return 0.0
    pull = rows.T @ weights + limited.T @ shares
    m = np.linalg.lstsq(equal.T, pull, rcond=None)[0]
    missed = np.abs(pull - equal.T @ m) @ np.abs(near)
    return max(float(m @ values - np.abs(shares).sum() - missed) / total, 0.0)
