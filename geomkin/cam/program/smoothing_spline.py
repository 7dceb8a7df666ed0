"""The smoothest lift within a band about given rows.

The curve has the least integral of squared jerk of all quintic splines over equal intervals that deviate from no row
by more than the band. It is the smoothing spline of Reinsch (Numer. Math. 10, 1967, 177-183), with jerk instead of
curvature, and with a bound for each row instead of one for the sum of squares, so that the lift stays within the band
everywhere. The B-spline coefficients are bounded from below, and with them the curve between the rows (de Boor, A
Practical Guide to Splines, 1978). This quadratic programme is solved by the primal-dual interior-point method (Wright,
Primal-Dual Interior-Point Methods, 1997, ch. 5); each of its steps is a smoothing spline with other weights. All sums
have a fixed order, so that the same rows give the same digits on every processor.
"""

from __future__ import annotations

import numpy as np

from ...core.records import record
from ...plane.vec import Mask, Real, Whole
from .laws import Ends, PiecewisePolynomial

# The number of intervals is doubled until the integral is at least this share of that with half as many. A larger
# value takes four times as many intervals without a visible difference, a smaller one stops too early.
GAIN = 0.98
# Largest number of intervals: more take seconds. Intervals for each row up to which the number is doubled if a spline
# was found, and between adjacent rows if none was: with six, each row has B-splines of its own. Least number of rows:
# two are the ends alone.
MOST_INTERVALS, FOR_EACH_ROW, IF_NONE, FEWEST = 4096, 4, 8, 3
# Largest number of steps of the interior-point method, which needs 15 to 30, or 55 for very uneven rows. With fewer it
# would not converge.
STEPS = 80
# Relative difference of the integral from the least at which the method ends. A larger value is visible in the
# acceleration, a smaller one is lost in rounding.
GAP = 1e-7
# Distance below the least lift, in units of the band, that counts as rounding.
INSIDE = 1e-9
# Width of the matrix on either side of its diagonal: a quintic B-spline overlaps five others on each side.
BAND = 5
# Share of the distance to the band's edge that a step may take; with 1 it would end on the edge and stay there.
LONGEST_STEP = 0.98
# Factor by which a step should reduce the gap. A larger one takes more steps, a smaller one meets the edge too soon.
REDUCTION = 0.1


def smoothest_within(
    x: Real, values: Real, ends: Ends, within: float, least: float = -np.inf
) -> PiecewisePolynomial | None:
    """The smoothest quintic spline within a band.

    Parameters
    ----------
    x : ndarray, shape (n,)
        Rising numbers from 0 to 1.
    values : ndarray, shape (n,)
        Lifts at x. The first and the last are met exactly, unless the spline is periodic.
    ends : pair of pairs of float, or None
        Slope and curvature at 0 and at 1; None for a periodic spline.
    within : float
        Largest deviation from `values`, above 0.
    least : float
        Least lift of the whole spline, also between the rows.

    Returns
    -------
    PiecewisePolynomial or None
        None for fewer than three rows, or if no spline of up to `MOST_INTERVALS` intervals lies in the band.
    """
    if len(x) < FEWEST:
        return None
    # In a periodic spline of fewer intervals a B-spline would overlap itself.
    count, best, least_roughness = 16 if ends is None else 2, None, np.inf
    narrowest = float(np.diff(x).min())
    while count <= min(MOST_INTERVALS, max(32, FOR_EACH_ROW * len(x) if best else IF_NONE / narrowest)):
        basis = _Basis(x, values, ends, within, count, least)
        coefficients = basis.smoothest()
        if coefficients is not None:
            best, roughness = basis.spline(coefficients), basis.roughness(coefficients)
            if roughness >= GAIN * least_roughness:
                break
            least_roughness = roughness
        count *= 2
    return best


class _Basis:
    """Quintic B-splines over `count` equal intervals, with lifts in units of the band.

    fixed, free (size,): the coefficients that the ends determine, otherwise 0, and the mask of the others.
    """

    def __init__(self, x: Real, values: Real, ends: Ends, within: float, count: int, least: float):
        self.count, self.closed, self.within, self.least = count, ends is None, within, least / within
        self.knots = np.arange(count + 1) / count
        before, after = np.arange(-5, 0) / count, 1 + np.arange(1, 6) / count
        if not self.closed:
            before, after = 0 * before, 0 * after + 1
        self.all_knots = np.concatenate([before, self.knots, after])
        self.size = count if self.closed else count + 5
        self.fixed = np.zeros(self.size)
        self.free = np.full(self.size, self.closed)
        if ends is not None:
            self._fix_ends(values[[0, -1]] / within, np.array(ends) / within)
            # Both ends are met exactly, so their rows are omitted.
            x, values = x[1:-1], values[1:-1]
        else:
            # The last row equals the first.
            x, values = x[:-1], values[:-1]
        self.bounded = self.free & np.isfinite(self.least)
        piece = np.clip(np.searchsorted(self.knots, x, side="right") - 1, 0, count - 1)
        self.rows = _Rows(self._numbers(piece), _basis(self.all_knots, piece + 5, x, 0))
        self.values = values / within
        # Jerk is quadratic over an interval: three nodes give the integral of its square exactly.
        nodes, weights = np.polynomial.legendre.leggauss(3)
        piece = np.repeat(np.arange(count), 3)
        places = (piece + np.tile((nodes + 1) / 2, count)) / count
        scale = np.tile(np.sqrt(weights / 2 / count), count) / count**2.5
        self.jerks = _Rows(self._numbers(piece), _basis(self.all_knots, piece + 5, places, 3) * scale)

    def _numbers(self, piece: Whole) -> Whole:
        numbers = piece + np.arange(6)[:, None]
        return numbers % self.size if self.closed else numbers

    def _fix_ends(self, values: Real, ends: Real) -> None:
        self.free[3:-3] = True
        for side, piece, x in ((0, 0, 0.0), (1, self.count - 1, 1.0)):
            numbers = np.arange(3) if side == 0 else np.arange(self.size - 1, self.size - 4, -1)
            # Value, slope and curvature determine one coefficient each.
            required = [values[side], *ends[side]]
            for order in range(3):
                row = _basis(self.all_knots, np.array([piece + 5]), np.array([x]), order)[:, 0]
                row = row if side == 0 else row[::-1]
                known = sum(row[k] * self.fixed[numbers[k]] for k in range(order))
                self.fixed[numbers[order]] = (required[order] - known) / row[order]

    def roughness(self, c: Real) -> float:
        """Integral of the squared jerk over x."""
        return float(np.sum(self.jerks.times(c) ** 2)) * self.count**5 * self.within**2

    def spline(self, c: Real) -> PiecewisePolynomial:
        piece = np.arange(self.count)
        coefficients, factorial = [], 1.0
        for order in range(6):
            factorial *= max(order, 1)
            rows = _Rows(self._numbers(piece), _basis(self.all_knots, piece + 5, self.knots[:-1], order))
            coefficients.append(rows.times(c) * (self.within / factorial))
        return PiecewisePolynomial(self.knots, np.array(coefficients), np.array([0.0, 1.0]))

    def smoothest(self) -> Real | None:
        """Coefficients of the smoothest spline; None if no spline over these intervals lies in the band."""
        start = self._start()
        if start is None:
            return None
        c, stiffness = start
        jerk = self.jerks.normal(np.full(self.jerks.basis.shape[1], stiffness), self.size, self.free)
        # Distances from all bounds, which have to stay positive, and their Lagrange multipliers. Coefficients of the
        # start may be below the bound: the first distances are then too large by `excess`, which the steps remove.
        distances = self._distances(c)
        room = np.maximum(distances, 0.05)
        room[2 * len(self.values) :] = np.maximum(room[2 * len(self.values) :], -distances.min())
        excess, multipliers, share = room - distances, 0.1 + np.maximum(1 - room, 0), 1.0
        for _ in range(STEPS):
            gap = float(np.sum(room * multipliers))
            is_inside = float(excess.max()) <= INSIDE
            if is_inside and (gap <= GAP * stiffness * float(np.sum(self.jerks.times(c) ** 2)) or gap < 1e-12):
                break
            # The excess has to vanish before the gap, or the steps become shorter and shorter.
            reduction = REDUCTION if is_inside or share > 0.9 else 0.5 if share > 0.3 else 1.0
            target = reduction * gap / multipliers.size / room
            weight = multipliers / room
            matrix = jerk.plus(self._bounds_matrix(weight))
            right = self._bounds_back(target + weight * excess) - self.jerks.back(
                stiffness * self.jerks.times(c), self.size
            )
            step = matrix.solve(right)
            if not np.isfinite(step).all():
                break
            room_step = self._distance_steps(step) - excess
            multiplier_step = target - multipliers - weight * room_step
            steepest = max(
                float(np.max(-room_step / room)), float(np.max(-multiplier_step / multipliers)), LONGEST_STEP
            )
            share = LONGEST_STEP / steepest
            c, room, multipliers = c + share * step, room + share * room_step, multipliers + share * multiplier_step
            excess = (1 - share) * excess
        return c if float(excess.max()) <= INSIDE else None

    def _distances(self, c: Real) -> Real:
        """Distances of each row's lift from both edges of the band, and of each coefficient from the least lift."""
        deviation = self.rows.times(c) - self.values
        return np.concatenate([1 - deviation, 1 + deviation, c[self.bounded] - self.least])

    def _distance_steps(self, step: Real) -> Real:
        lift_step = self.rows.times(step)
        return np.concatenate([-lift_step, lift_step, step[self.bounded]])

    def _bounds_back(self, v: Real) -> Real:
        """Transposed derivatives of the distances times v."""
        above, below, coefficients = np.split(v, [len(self.values), 2 * len(self.values)])
        total = self.rows.back(below - above, self.size)
        total[self.bounded] += coefficients
        return total

    def _bounds_matrix(self, weight: Real) -> BandMatrix:
        above, below, coefficients = np.split(weight, [len(self.values), 2 * len(self.values)])
        matrix = self.rows.normal(above + below, self.size, self.free)
        matrix.bands[0, self.bounded] += coefficients
        return matrix

    def _start(self) -> tuple[Real, float] | None:
        """Coefficients of a smoothing spline well inside the band, and its stiffness; None if there is none."""
        rows = self.rows.normal(np.ones(len(self.values)), self.size, self.free)
        right = self.rows.back(self.values - self.rows.times(self.fixed), self.size)
        jerks = self.jerks.times(self.fixed)
        # The stiffest spline has only waves as long as all rows, the softest ones shorter than two intervals.
        stiffest = len(self.values) * float(self.count) ** 5
        for stiffness in stiffest * 10.0 ** -np.arange(0.0, 8 + 6 * np.log10(self.count)):
            matrix = rows.plus(self.jerks.normal(np.full(len(jerks), stiffness), self.size, self.free))
            c = self.fixed + matrix.solve(right - self.jerks.back(stiffness * jerks, self.size))
            if np.abs(self.rows.times(c) - self.values).max() < 0.95:
                return c, float(stiffness)
        return None


@record(eq=False)
class _Rows:
    """Rows of a matrix, each with six B-splines that are not 0. numbers, basis (6, n): their indices and values."""

    numbers: Whole
    basis: Real

    def times(self, c: Real) -> Real:
        total = np.zeros(self.basis.shape[1])
        for number, value in zip(self.numbers, self.basis):
            total = total + value * c[number]
        return total

    def back(self, v: Real, size: int) -> Real:
        """The transposed rows times v."""
        return np.bincount(self.numbers.ravel(), (self.basis * v).ravel(), size).astype(float, copy=False)

    def normal(self, weights: Real, size: int, free: Mask) -> BandMatrix:
        """The transposed rows times weights times the rows."""
        return BandMatrix.of(self.numbers, self.basis, weights, size, free)


def _basis(knots: Real, at: Whole, x: Real, order: int) -> Real:
    """Derivatives of an order at x (n,) of the six quintic B-splines that are not 0 in the intervals `at`: (6, n).

    By the recursion of de Boor and Cox, whose last steps are replaced by differentiation.
    """
    values = [np.ones(len(x))]
    for p in range(1, 6):
        zero = [np.zeros(len(x))]
        lower = [*zero, *values, *zero]
        values = []
        for r in range(p + 1):
            i = at - p + r
            # The first and the last have one term only; the knots of the other one may coincide.
            rising = 1 / (knots[i + p] - knots[i]) if r else 0.0
            falling = 1 / (knots[i + p + 1] - knots[i + 1]) if r < p else 0.0
            if p <= 5 - order:
                values.append((x - knots[i]) * rising * lower[r] + (knots[i + p + 1] - x) * falling * lower[r + 1])
            else:
                values.append(p * (rising * lower[r] - falling * lower[r + 1]))
    return np.array(values)


@record(eq=False)
class BandMatrix:
    """A symmetric matrix with `BAND` diagonals on either side of the main one; of a periodic spline they wrap round.

    bands (BAND + 1, n): the entry in row (i + k) mod n and column i is at [k, i]. free (n,): mask of the unknowns; the
    others are 0.
    """

    bands: Real
    free: Mask

    @classmethod
    def of(cls, numbers: Whole, basis: Real, weights: Real, size: int, free: Mask) -> BandMatrix:
        """Weighted sum of the squares of rows. numbers, basis (BAND + 1, rows): their unknowns and entries."""
        bands = np.zeros((BAND + 1, size))
        for i in range(BAND + 1):
            for j in range(i, BAND + 1):
                bands[j - i] += np.bincount(numbers[i], basis[i] * basis[j] * weights, size)
        return cls(bands, free)

    def plus(self, other: BandMatrix) -> BandMatrix:
        return BandMatrix(self.bands + other.bands, self.free)

    def solve(self, right: Real) -> Real:
        """Solution x of matrix x = right (n,), by Gaussian elimination; nan if the matrix is not positive definite.

        The matrix is eliminated number by number: for such narrow bands calls for arrays take no less time.
        """
        rows, border = self._rows_and_border()
        n, edge = len(right), len(border)
        line = n - edge
        v = np.where(self.free, right, 0.0).tolist()
        for i in range(line):
            row = rows[i]
            if not row[0] > 0:
                return np.full(n, np.nan)
            for k in range(1, min(BAND, line - 1 - i) + 1):
                if row[k]:
                    share, below = row[k] / row[0], rows[i + k]
                    for j in range(k, BAND + 1):
                        below[j - k] -= share * row[j]
                    for j in range(BAND + 1, BAND + 1 + edge):
                        below[j] -= share * row[j]
                    v[i + k] -= share * v[i]
            for k in range(edge):
                share = row[BAND + 1 + k] / row[0]
                for j in range(k, edge):
                    border[k][j] -= share * row[BAND + 1 + j]
                v[line + k] -= share * v[i]
        last = _solve_full(border, v[line:])
        if last is None:
            return np.full(n, np.nan)
        v[line:] = last
        for i in reversed(range(line)):
            total = v[i]
            for k in range(1, min(BAND, line - 1 - i) + 1):
                total -= rows[i][k] * v[i + k]
            for k in range(edge):
                total -= rows[i][BAND + 1 + k] * v[line + k]
            v[i] = total / rows[i][0]
        return np.array(v)

    def _rows_and_border(self) -> tuple[list[list[float]], list[list[float]]]:
        """The matrix in two parts, so that each row has its entries on one side of the diagonal.

        Each row holds its BAND + 1 entries from the diagonal on, then those with the last unknowns. The border is the
        matrix of the last BAND unknowns, which wrap round to the first; it is empty if the matrix does not wrap.
        """
        bands = np.where(self.free, self.bands, 0.0)
        for k in range(1, BAND + 1):
            bands[k] *= np.roll(self.free, -k)
        bands[0, ~self.free] = 1.0
        n, edge = bands.shape[1], BAND if bands[1, -1] else 0
        line = n - edge
        rows = [[*row, *[0.0] * edge] for row in bands.T.tolist()]
        for i in range(line - BAND, n) if edge else ():
            for k in range(BAND + 1):
                low, high = sorted([i, (i + k) % n])
                if low < line <= high:
                    rows[low][BAND + 1 + high - line], rows[i][k] = rows[i][k], 0.0
        border = [[rows[line + i][j - i] if j >= i else 0.0 for j in range(edge)] for i in range(edge)]
        return rows, border


def _solve_full(matrix: list[list[float]], right: list[float]) -> list[float] | None:
    """Solution of a symmetric system by its upper half, which is changed; None if it is not positive definite."""
    n, v = len(right), list(right)
    for k in range(n):
        if not matrix[k][k] > 0:
            return None
        for i in range(k + 1, n):
            share = matrix[k][i] / matrix[k][k]
            for j in range(i, n):
                matrix[i][j] -= share * matrix[k][j]
            v[i] -= share * v[k]
    for k in reversed(range(n)):
        for j in range(k + 1, n):
            v[k] -= matrix[k][j] * v[j]
        v[k] /= matrix[k][k]
    return v
