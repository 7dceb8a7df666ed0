"""Lifts given as rows of numbers: read from a segment or a CSV file, and the curve laid through or near them."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path

import numpy as np

from ...core.errors import DesignError, printable, shown
from ...core.fields import FARTHEST
from ...core.names import Folder, csv_cells, read_text_file
from ...core.records import record
from ...core.units import INCH
from ...plane.vec import Real, Whole
from .laws import Ends, Law, PiecewisePolynomial
from .segments import LiftTable, Pointed
from .smoothing_spline import smoothest_within

# Largest number of rows of all tables of a programme: nearly three tables in steps of 0.1 deg. More need seconds.
MOST_ROWS = 10_000
# Columns of a CSV file; of those with lifts, whether these are angles.
ANGLE, LIFTS = "cam_angle_deg", {"lift_mm": False, "lift_in": False, "lift_deg": True}
# Adjacent rows compared with a polynomial of the fifth degree. Fewer count the motion as scatter, more resolve less.
WINDOW = 7
# Least number of rows for an estimate of their scatter.
FEWEST = 24
# Half width, in standard deviations, of a band that contains nearly all rows. In a narrower band the curve follows
# their scatter, in a wider one it leaves the motion.
WIDE = 3.0
# If every second row scatters more than this many times as much as all rows, the rows are too few for the motion. A
# smaller value counts true scatter as motion, a larger one motion as scatter.
MOTION = 3.0
# Samples between two rows in the search for the largest acceleration. Fewer may miss it.
SAMPLES = 8


def read_lifts(segment: Pointed, folder: Folder) -> tuple[str, Real, bool]:
    """The name of the field with rows, the rows (n, 2) of angles in deg and lifts, and whether lifts are in degrees."""
    offered = (
        {"rows": segment.rows, "rows_deg": segment.rows_deg, "file": segment.file}
        if isinstance(segment, LiftTable)
        else {"points": segment.points, "points_deg": segment.points_deg}
    )
    given = [name for name, rows in offered.items() if rows is not None]
    if len(given) != 1:
        found = "none" if not given else " and ".join(given)
        raise DesignError(next(iter(offered)), f"of {', '.join(offered)} found {found}", "give one of them", "conflict")
    field = given[0]
    if field == "file":
        points, swings = _from_csv(offered[field], folder)
        return field, points, swings
    return field, checked_rows(offered[field], field), field.endswith("_deg")


def checked_rows(rows: object, field: str) -> Real:
    """The rows as an array (n, 2). Raises DesignError with the field's name for anything else."""
    try:
        points = np.array(rows, dtype=float)
        fits = points.dtype.kind == "f" and points.ndim == 2 and points.shape[1] == 2 and len(points) <= MOST_ROWS
        fits = fits and bool((np.abs(points) <= FARTHEST).all())
    except (TypeError, ValueError, OverflowError):
        fits = False
    if not fits:
        remedy = f"give at most {MOST_ROWS} rows [angle in deg, lift] of numbers"
        raise DesignError(field, f"found {shown(rows)}", remedy, "wrong-type")
    return points


def _from_csv(name: object, folder: Folder) -> tuple[Real, bool]:
    if not isinstance(name, str | Path):
        raise DesignError("file", f"found {shown(name)}", "give the name of a CSV file", "wrong-type")
    text = read_text_file(name, folder, "a CSV file")
    # Counted first: a much larger file would need a gigabyte as lists of numbers.
    count = text.count("\n")
    if count > MOST_ROWS + 1:
        problem = f"{printable(name)} has {count:,} lines"
        raise DesignError("file", problem, f"give at most {MOST_ROWS:,} rows", "too-much-work")
    lines = csv_cells(text, name)
    header = [cell.strip() for cell in lines[0]] if lines else []
    lifts = [column for column in LIFTS if column in header]
    if ANGLE not in header or len(lifts) != 1:
        lacking = ANGLE if ANGLE not in header else f"just one of {' and '.join(LIFTS)}"
        remedy = f"name its columns: {ANGLE} and one of {' and '.join(LIFTS)}, separated by commas or semicolons"
        raise DesignError("file", f"the first line of {printable(name)} does not name {lacking}", remedy, "missing-key")
    columns = header.index(ANGLE), header.index(lifts[0])
    points = []
    for k, line in enumerate(lines[1:], 2):
        if not "".join(line).strip():
            continue
        if "".join(line[len(header) :]).strip():
            problem = f"line {k} of {printable(name)} has {len(line)} cells, the first line {len(header)}"
            remedy = "give the same number; decimal commas need semicolons between the cells"
            raise DesignError("file", problem, remedy, "wrong-type")
        points.append(
            [_number(line, column, f"line {k} of {printable(name)}, column {column + 1},") for column in columns]
        )
    unit = INCH if lifts[0] == "lift_in" else 1.0
    return checked_rows([(angle, unit * lift) for angle, lift in points], "file"), LIFTS[lifts[0]]


def _number(line: list[str], column: int, place: str) -> float:
    cell = line[column] if column < len(line) else ""
    try:
        return float(cell)
    except ValueError:
        problem = f"{place} holds {printable(repr(cell), 20)}"
        raise DesignError("file", problem, "give a number there", "wrong-type") from None


@record(eq=False)
class TableFit:
    """A curve near the lifts of a table.

    Parameters
    ----------
    x : ndarray, shape (n,)
        Rising numbers from 0 to 1.
    lifts : ndarray, shape (n,)
        Lifts at x, mm or deg.
    ends : pair of pairs of float, or None
        Slope and curvature by x at both ends; None for a periodic curve.
    within : float
        Largest deviation of the curve from the lifts, the band; 0 for a curve through all rows.
    base : float
        Lift of the base circle on the scale of `lifts`; the curve is below it by no more than the band.

    Notes
    -----
    Derived here; the curve is that of `smoothest_within`.
    """

    x: Real
    lifts: Real
    ends: Ends
    within: float
    base: float = -np.inf

    @cached_property
    def law(self) -> Law:
        """The smoothest curve within the band; the curve through all rows if there is no band, or no spline in it."""
        return self._law_within(self.within)

    def _law_within(self, within: float) -> Law:
        least = self.base - within
        smooth = smoothest_within(self.x, self.lifts, self.ends, within, least) if within > 0 else None
        return smooth or spline_through(self.x, self.lifts, self.ends)

    @cached_property
    def scatter(self) -> float:
        """Standard deviation of the rows from a smooth motion, mm or deg.

        Estimated from the deviation of adjacent rows from polynomials of the fifth degree. nan for too few rows, or for
        rows too far apart to resolve the motion.
        """
        if len(self.x) < FEWEST:
            return np.nan
        fine, coarse = (_scatter(self.x[::k], self.lifts[::k]) for k in (1, 2))
        return fine if coarse <= MOTION * fine or fine <= 1e-12 * float(np.ptp(self.lifts)) else np.nan

    @property
    def wide(self) -> float:
        """Width of a band in which a curve need not follow the scatter, mm or deg."""
        return WIDE * self.scatter

    @cached_property
    def noise(self) -> float:
        """Part of the acceleration that is due to scatter of the rows, as a share of the motion's peak.

        It is the largest difference from the smoothest curve in the band `wide`. inf if that curve is a dwell or a
        uniform motion within the band: then all of the acceleration is scatter. nan as for `scatter`.
        """
        if not self.wide > self.within:
            return 0.0 * self.scatter
        step = np.diff(self.x)[:, None] * np.arange(SAMPLES) / SAMPLES
        places = (self.x[:-1, None] + step).ravel()
        motion, curve = (np.asarray(law(places)) for law in (self._law_within(self.wide), self.law))
        steady = motion[0, 0] + (motion[0, -1] - motion[0, 0]) * places / places[-1]
        if np.abs(motion[0] - steady).max() <= self.wide:
            return np.inf
        return float(np.abs(curve[2] - motion[2]).max() / np.abs(motion[2]).max())


def _scatter(x: Real, lifts: Real) -> float:
    """Standard deviation from polynomials of the fifth degree, by the upper quartile of all windows.

    Half of the windows may be in an exact dwell; the few at joints of the motion are above the quartile.
    """
    number = np.arange(len(x) - WINDOW + 1)[:, None] + np.arange(WINDOW)
    local = x[number] - x[number[:, :1]]
    local = local / local[:, -1:]
    apart = local[:, :, None] - local[:, None, :] + np.eye(WINDOW)
    # Divided differences, which are 0 for such a polynomial; the squares of the weights add up to 1.
    weights = 1 / np.prod(apart, axis=2)
    weights /= np.sqrt(np.sum(weights**2, axis=1))[:, None]
    deviation = np.abs(np.sum(weights * lifts[number], axis=1))
    # Three quarters of normal errors are below 1.1503 standard deviations.
    return float(np.quantile(deviation, 0.75)) / 1.1503


def spline_through(x: Real, values: Real, ends: Ends) -> PiecewisePolynomial:
    """Quintic spline through values (n + 1,) at rising x (n + 1,) from 0 to 1, with the slopes and curvatures `ends`.

    Of all curves through the values with these ends it has the least integral of squared jerk. Jerk and its slope are
    continuous, so it has no breaks inside. With ends None it is periodic and needs equal first and last values.
    """
    n = len(x) - 1
    # With intervals of about 1 the coefficients of the equations are of similar size.
    scale = n / (x[-1] - x[0])
    width, step = np.diff(x) * scale, np.diff(values)[:, None]
    # The unknown state of each knot is its slope and curvature. It is a linear function of those of knots 0 and n:
    # column 0 is the constant, columns 1 and 2 are factors of the first state, columns 3 and 4 of the last one.
    state = np.zeros((n + 1, 2, 5))
    state[0, :, 1:3] = state[n, :, 3:] = np.eye(2)
    # Third and fourth derivatives are continuous at knots 1 to n - 1: a block-tridiagonal system.
    before, here, after, right = _links(width, step, np.arange(1, n))
    right = np.concatenate([right, np.zeros((n - 1, 2, 4))], axis=2)
    if n > 1:
        right[0] -= _times(before[0], state[0])
        right[-1] -= _times(after[-1], state[n])
    for i in range(1, n - 1):
        factor = _times(before[i], _inverse(here[i - 1]))
        here[i] -= _times(factor, after[i - 1])
        right[i] -= _times(factor, right[i - 1])
    for i in range(n - 2, -1, -1):
        rest = right[i] - _times(after[i], state[i + 2]) if i < n - 2 else right[i]
        state[i + 1] = _times(_inverse(here[i]), rest)
    if ends is None:
        before, here, after, right = _links(width, step, np.array([0]))
        around = _times(before[0], state[n - 1]) + _times(here[0], state[0]) + _times(after[0], state[1])
        start = end = _times(_inverse(around[:, 1:3] + around[:, 3:]), right[0] - around[:, :1])
    else:
        # Slopes and curvatures by the scaled x.
        start, end = (np.array([[slope / scale], [curvature / scale**2]]) for slope, curvature in ends)
    states = (state[..., :1] + _times(state[..., 1:3], start) + _times(state[..., 3:], end))[..., 0]
    h, step = width, step[:, 0]
    v0h, a0h = states[:-1, 0] * h, states[:-1, 1] * h**2 / 2
    v1h, a1h = states[1:, 0] * h, states[1:, 1] * h**2 / 2
    powers = [
        values[:-1],
        v0h,
        a0h,
        10 * step - 6 * v0h - 4 * v1h - 3 * a0h + a1h,
        -15 * step + 8 * v0h + 7 * v1h + 3 * a0h - 2 * a1h,
        6 * step - 3 * (v0h + v1h) - a0h + a1h,
    ]
    coefficients = np.array([power / (h / scale) ** k for k, power in enumerate(powers)])
    return PiecewisePolynomial(x, coefficients, np.array([0.0, 1.0]))


def _times(a: Real, b: Real) -> Real:
    """Products of 2 x 2 matrices with matrices of two rows, in a fixed order of summation."""
    return a[..., :1] * b[..., :1, :] + a[..., 1:] * b[..., 1:, :]


def _inverse(a: Real) -> Real:
    """Inverse of a 2 x 2 matrix."""
    (p, q), (r, s) = a.tolist()
    return np.array([[s, -q], [-r, p]]) / float(p * s - q * r)


def _links(width: Real, step: Real, i: Whole) -> tuple[Real, Real, Real, Real]:
    """Equations of knots i: coefficients of the states before, at and after them, (len(i), 2, 2), and right side."""
    h, g = width[i - 1][:, None], width[i][:, None]
    third = [-24 / h**2, -3 / h, 36 / g**2 - 36 / h**2, 9 / h + 9 / g, 24 / g**2, -3 / g]
    fourth = [-168 / h**3, -24 / h**2, -192 / h**3 - 192 / g**3, 36 / h**2 - 36 / g**2, -168 / g**3, 24 / g**2]
    rows = np.stack([np.concatenate(third, axis=1), np.concatenate(fourth, axis=1)], axis=1)
    rises, falls = step[i] / g**3, step[i - 1] / h**3
    right = np.stack([60 * (rises - falls), -360 * (rises / g + falls / h)], axis=1)
    return rows[:, :, :2], rows[:, :, 2:4], rows[:, :, 4:], right
