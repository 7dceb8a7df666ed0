"""The smoothest lift inside a band about given rows.

Of all quintic splines over equal intervals that leave no row by more than the band, the one with the least integral
of squared jerk: the smoothing spline of Reinsch (Numer. Math. 10, 1967, 177-183), with jerk in place of curvature
and a bound for each row in place of one for the sum of squares, so that every row counts alike and the lift is sure
to stay inside. A quadratic programme with bands, solved by the primal-dual interior-point method (Wright,
Primal-Dual Interior-Point Methods, 1997, ch. 5), each of whose steps is a smoothing spline with other weights.
Everything is plain sums in a fixed order, so that the same rows give the same digits on every processor.
"""

from __future__ import annotations

import numpy as np

from ...core.records import record
from ...plane.vec import Mask, Real, Whole
from .laws import Ends, PiecewisePolynomial

# Intervals are doubled until that leaves at least this share of the jerk's integral, which is then taken for the least.
# Nearer to 1 takes four times the intervals for what does not show, farther from it stops too early.
GAIN = 0.98
# Most intervals that are tried: more take seconds. Fewest rows: fewer leave the spline no freedom.
MOST_INTERVALS, FEWEST = 2048, 5
# Steps of the interior-point method, which takes 10 to 25: fewer stop before the end, more are never reached.
STEPS = 60
# How far the integral may lie above the least, relative, where the method ends: more shows in the acceleration, less is
# lost in rounding.
GAP = 1e-7
# Neighbours to either side that an unknown meets: those of a quintic spline.
BAND = 5
# Share of the way to the band's edge that a step may go: at 1 it would end on the edge, and stay there. By how much a
# step aims to lessen the gap: less of it takes more steps, more of it runs into the edge.
BACK, AIM = 0.98, 0.1


def smoothest_within(x: Real, values: Real, ends: Ends, within: float) -> PiecewisePolynomial | None:
    """Quintic spline that leaves `values` (n,) at rising x (n,), from 0 to 1, by at most `within`, with least jerk.

    The first and last values and `ends` are met; closed (ends None), no value is met in particular. None where no
    spline of as many intervals as there are rows stays inside: rows nearer together than their number suggests.
    """
    if len(x) < FEWEST:
        return None
    # Round a ring of fewer, a spline would meet itself.
    count, best, least = 16 if ends is None else 2, None, np.inf
    while count <= min(MOST_INTERVALS, max(32, 2 * len(x))):
        basis = _Basis(x, values, ends, within, count)
        coefficients = basis.smoothest()
        if coefficients is not None:
            rough = basis.roughness(coefficients)
            best, smooth = basis.spline(coefficients), rough >= GAIN * least
            if smooth:
                break
            least = rough
        count *= 2
    return best


class _Basis:
    """Quintic B-splines over `count` equal intervals; lifts in units of the band."""

    def __init__(self, x: Real, values: Real, ends: Ends, within: float, count: int):
        self.count, self.closed, self.within = count, ends is None, within
        inner = np.arange(count + 1) / count
        self.knots = inner
        before, after = np.arange(-5, 0) / count, 1 + np.arange(1, 6) / count
        if not self.closed:
            before, after = 0 * before, 0 * after + 1
        self.all_knots = np.concatenate([before, inner, after])
        self.size = count if self.closed else count + 5
        self.fixed = np.zeros(self.size)
        self.free = np.full(self.size, self.closed)
        if ends is not None:
            self._fix_ends(values[[0, -1]] / within, np.array(ends) / within)
            # Both ends are met exactly, so that their rows ask nothing more.
            x, values = x[1:-1], values[1:-1]
        else:
            # The last row is the first again.
            x, values = x[:-1], values[:-1]
        piece = np.clip(np.searchsorted(inner, x, side="right") - 1, 0, count - 1)
        self.rows = _Rows(self._numbers(piece), _basis(self.all_knots, piece + 5, x, 0))
        self.values = values / within
        # Jerk is quadratic over an interval: three nodes give the integral of its square exactly.
        nodes, weights = np.polynomial.legendre.leggauss(3)
        piece = np.repeat(np.arange(count), 3)
        at = (piece + np.tile((nodes + 1) / 2, count)) / count
        scale = np.tile(np.sqrt(weights / 2 / count), count) / count**2.5
        self.jerks = _Rows(self._numbers(piece), _basis(self.all_knots, piece + 5, at, 3) * scale)

    def _numbers(self, piece: Whole) -> Whole:
        numbers = piece + np.arange(6)[:, None]
        return numbers % self.size if self.closed else numbers

    def _fix_ends(self, values: Real, ends: Real) -> None:
        self.free[3:-3] = True
        for side, piece, x in ((0, 0, 0.0), (1, self.count - 1, 1.0)):
            numbers = np.arange(3) if side == 0 else np.arange(self.size - 1, self.size - 4, -1)
            wanted = [values[side], *ends[side]]
            for order in range(3):
                row = _basis(self.all_knots, np.array([piece + 5]), np.array([x]), order)[:, 0]
                row = row if side == 0 else row[::-1]
                known = sum(row[k] * self.fixed[numbers[k]] for k in range(order))
                self.fixed[numbers[order]] = (wanted[order] - known) / row[order]

    def roughness(self, c: Real) -> float:
        """Integral of the squared jerk by x."""
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
        """Coefficients, or None where no spline over these intervals lies in the band."""
        started = self._start()
        if started is None:
            return None
        c, stiffness = started
        jerk = self.jerks.normal(np.full(self.jerks.basis.shape[1], stiffness), self.size, self.free)
        left = self.rows.times(c) - self.values
        # Room to both edges of the band, and how hard each row holds the spline there.
        room = np.array([1 - left, 1 + left])
        hold = np.array([np.maximum(left, 0), np.maximum(-left, 0)]) + 0.1
        for _ in range(STEPS):
            gap = float(np.sum(room * hold))
            if gap <= GAP * stiffness * float(np.sum(self.jerks.times(c) ** 2)) or gap < 1e-12:
                break
            aim = AIM * gap / hold.size
            weight = hold / room
            matrix = jerk.plus(self.rows.normal(weight[0] + weight[1], self.size, self.free))
            pull = aim / room
            right = -self.jerks.back(stiffness * self.jerks.times(c), self.size) - self.rows.back(
                pull[0] - pull[1], self.size
            )
            step = matrix.solve(right)
            if not np.isfinite(step).all():
                break
            moved = self.rows.times(step)
            change = np.array([-moved, moved])
            held = pull - hold - weight * change
            far = max(float(np.max(-change / room)), float(np.max(-held / hold)), BACK)
            share = BACK / far
            c, room, hold = c + share * step, room + share * change, hold + share * held
        return c

    def _start(self) -> tuple[Real, float] | None:
        """A smoothing spline well inside the band, and how stiff it is; None where none is."""
        rows = self.rows.normal(np.ones(len(self.values)), self.size, self.free)
        wanted = self.values - self.rows.times(self.fixed)
        right = self.rows.back(wanted, self.size)
        jerks = self.jerks.times(self.fixed)
        # From so stiff that only waves as long as the whole bend, to so soft that waves of two intervals do, and on.
        most = len(self.values) * float(self.count) ** 5
        for stiffness in most * 10.0 ** -np.arange(0.0, 8 + 6 * np.log10(self.count)):
            matrix = rows.plus(self.jerks.normal(np.full(len(jerks), stiffness), self.size, self.free))
            c = self.fixed + matrix.solve(right - self.jerks.back(stiffness * jerks, self.size))
            if np.abs(self.rows.times(c) - self.values).max() < 0.95:
                return c, float(stiffness)
        return None


@record(eq=False)
class _Rows:
    """Rows of six neighbouring B-splines each: numbers (6, n) of them, basis (6, n) their values."""

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
    """Values at x (n,), or derivatives of an order, of the six quintic B-splines that live over the intervals `at`.

    By the recursion of de Boor and Cox, the last steps of which derive. (6, n)
    """
    values = [np.ones(len(x))]
    for p in range(1, 6):
        zero = [np.zeros(len(x))]
        lower = [*zero, *values, *zero]
        values = []
        for r in range(p + 1):
            i = at - p + r
            # The first and the last have one part only: the other lies beside the interval, where widths may be 0.
            one = 1 / (knots[i + p] - knots[i]) if r else 0.0
            other = 1 / (knots[i + p + 1] - knots[i + 1]) if r < p else 0.0
            if p <= 5 - order:
                values.append((x - knots[i]) * one * lower[r] + (knots[i + p + 1] - x) * other * lower[r + 1])
            else:
                values.append(p * (one * lower[r] - other * lower[r + 1]))
    return np.array(values)


@record(eq=False)
class BandMatrix:
    """bands (BAND + 1, n): entry (i + k) mod n, i at [k, i]. free (n,): unknowns that are; the others stay 0."""

    bands: Real
    free: Mask

    @classmethod
    def of(cls, numbers: Whole, basis: Real, weights: Real, size: int, free: Mask) -> BandMatrix:
        """Sum of weighted squares of rows; rows of neighbouring unknowns: numbers, basis (BAND + 1, rows)."""
        bands = np.zeros((BAND + 1, size))
        for one in range(BAND + 1):
            for other in range(one, BAND + 1):
                bands[other - one] += np.bincount(numbers[one], basis[one] * basis[other] * weights, size)
        return cls(bands, free)

    def plus(self, other: BandMatrix) -> BandMatrix:
        return BandMatrix(self.bands + other.bands, self.free)

    def solve(self, right: Real) -> Real:
        """x with the matrix times x = right (n,): by Gauss, without pivots, which positive equations do not need.

        nan where rounding leaves them not positive.

        Plain numbers one by one: for bands as narrow as these that takes no longer than calls for arrays.
        """
        n = len(right)
        bands = np.where(self.free, self.bands, 0.0)
        for k in range(1, BAND + 1):
            bands[k] *= np.roll(self.free, -k)
        bands[0, ~self.free] = 1.0
        # On a ring, all but the last few unknowns form a line; both of its ends meet those last ones, its border.
        edge = BAND if bands[1, -1] else 0
        line = n - edge
        rows = [[*row, *[0.0] * edge] for row in bands.T.tolist()]
        for i in range(line - BAND, n) if edge else ():
            for k in range(BAND + 1):
                one, other = sorted([i, (i + k) % n])
                if one < line <= other:
                    rows[one][BAND + 1 + other - line], rows[i][k] = rows[i][k], 0.0
        border = [[rows[one + line][other - one] if other >= one else 0.0 for other in range(edge)]
                  for one in range(edge)]  # fmt: skip
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
        for k in range(edge):
            if not border[k][k] > 0:
                return np.full(n, np.nan)
            for under in range(k + 1, edge):
                share = border[k][under] / border[k][k]
                for j in range(under, edge):
                    border[under][j] -= share * border[k][j]
                v[line + under] -= share * v[line + k]
        for k in reversed(range(edge)):
            for j in range(k + 1, edge):
                v[line + k] -= border[k][j] * v[line + j]
            v[line + k] /= border[k][k]
        for i in reversed(range(line)):
            total = v[i]
            for k in range(1, min(BAND, line - 1 - i) + 1):
                total -= rows[i][k] * v[i + k]
            for k in range(edge):
                total -= rows[i][BAND + 1 + k] * v[line + k]
            v[i] = total / rows[i][0]
        return np.array(v)
