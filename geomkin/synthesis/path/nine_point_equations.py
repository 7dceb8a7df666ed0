"""The equations of four-bars through nine points, over the complex numbers, and how their solutions are followed.

A solution is a row of 16 numbers: z, Z, w, W of the first dyad, y, Y, b, B of the second, and the rotations of the
coupler at points 1 to 8 as unit directions (1 at point 0). Point 0 is the origin; z is the dyad's pin and w its ground
pivot at point 0. Capitals are the complex conjugates, treated as independent numbers. Parameters are rows of 16 too:
the displacements d from point 0 to points 1 to 8, and their conjugates D.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...core.records import record
from ...plane.vec import Array, Complex, Mask, Real

# Splits a double into two halves of 26 bits, whose products are exact (Veltkamp).
SPLITTER = 134217729.0


class DoubleDouble:
    """A real array as the sum `high + low`, about 32 digits.

    Notes
    -----
    Sums after Knuth and products after Dekker: Hida, Li and Bailey, Algorithms for quad-double precision floating
    point arithmetic, 15th IEEE Symposium on Computer Arithmetic, 2001. Values above 1e150 overflow.
    """

    __slots__ = ("high", "low")

    def __init__(self, high: Real, low: Real | float = 0.0):
        self.high, self.low = high, low

    def __add__(self, other: DoubleDouble) -> DoubleDouble:
        total, rest = two_sum(self.high, other.high)
        return DoubleDouble(*_short_sum(total, rest + (self.low + other.low)))

    def __neg__(self) -> DoubleDouble:
        return DoubleDouble(-self.high, -self.low)

    def __sub__(self, other: DoubleDouble) -> DoubleDouble:
        return self + -other

    def __mul__(self, other: DoubleDouble) -> DoubleDouble:
        product = self.high * other.high
        (a, b), (c, d) = _halves(self.high), _halves(other.high)
        rest = ((a * c - product) + a * d + b * c) + b * d
        return DoubleDouble(*_short_sum(product, rest + (self.high * other.low + self.low * other.high)))


class ComplexDoubleDouble:
    """A complex array of the same precision.

    Parameters
    ----------
    real, imag : DoubleDouble
        Its parts.
    """

    __slots__ = ("imag", "real")

    def __init__(self, real: DoubleDouble, imag: DoubleDouble):
        self.real, self.imag = real, imag

    @classmethod
    def of(cls, high: Complex, low: Complex | None = None) -> ComplexDoubleDouble:
        """The sum of two complex arrays; of one if `low` is left out."""
        low = np.zeros_like(high) if low is None else low
        return cls(DoubleDouble(high.real, low.real), DoubleDouble(high.imag, low.imag))

    def __add__(self, other: ComplexDoubleDouble) -> ComplexDoubleDouble:
        return ComplexDoubleDouble(self.real + other.real, self.imag + other.imag)

    def __sub__(self, other: ComplexDoubleDouble) -> ComplexDoubleDouble:
        return ComplexDoubleDouble(self.real - other.real, self.imag - other.imag)

    def __mul__(self, other: ComplexDoubleDouble) -> ComplexDoubleDouble:
        return ComplexDoubleDouble(
            self.real * other.real - self.imag * other.imag, self.real * other.imag + self.imag * other.real
        )

    @property
    def parts(self) -> tuple[Complex, Complex]:
        """The two complex arrays, high and low, whose sum it is."""
        return _joined(self.real.high, self.imag.high), _joined(self.real.low, self.imag.low)


def two_sum(a: Array, b: Array) -> tuple[Array, Array]:
    """The rounded sum and its rounding error, for real or complex arrays."""
    total = a + b
    part = total - a
    return total, (a - (total - part)) + (b - part)


def _joined(real: Real | float, imag: Real | float) -> Complex:
    joined: Complex = np.asarray(real, dtype=complex) + 1j * imag
    return joined


def _short_sum(a: Real, b: Real) -> tuple[Real, Real]:
    """`two_sum` if |a| >= |b|."""
    total = a + b
    return total, b - (total - a)


def _halves(a: Real) -> tuple[Real, Real]:
    high = SPLITTER * a - (SPLITTER * a - a)
    return high, a - high


# Coefficients of a solution's key, any complex numbers.
KEY = np.array([0.83 + 0.41j, -0.37 + 0.72j, 0.21 - 0.55j, 0.48 + 0.16j, -0.62 - 0.27j])
# Relative difference of the keys of cognates.
SAME = 1e-7
# Relative difference of two coordinates below which they may be equal.
EQUAL = 1e-6


def residuals(x: Complex, p: Complex) -> Complex:
    """The two dyads' equations at the eight points, (s, 2, 8), of solutions x (s, 16) for parameters p (s, 16).

    The distance from a dyad's pin to its ground pivot is the same at all points: P e + Q + R / e = 0.
    """
    z, Z, w, W, e, d, D = _unknowns_by_name(x, p)
    values: Complex = (z * (D - W) * e + d * (D - W) - w * D + z * W + w * Z) * e + Z * (d - w)
    return values


def precise_residuals(x: Complex, x_low: Complex, p: Complex, p_low: Complex) -> Complex:
    """`residuals` of x + x_low for p + p_low, computed in double-double."""
    z, Z, w, W, e, d, D = (
        ComplexDoubleDouble.of(high, low) for high, low in zip(_unknowns_by_name(x, p), _unknowns_by_name(x_low, p_low))
    )
    values = (z * (D - W) * e + d * (D - W) - w * D + z * W + w * Z) * e + Z * (d - w)
    return values.parts[0]


def slopes(x: Complex, p: Complex) -> tuple[Complex, Complex, Complex, Complex]:
    """Derivatives of `residuals`: by a dyad's coordinates (s, 2, 8, 4), by e, by d and by D (s, 2, 8)."""
    z, Z, w, W, e, d, D = _unknowns_by_name(x, p)
    out, back = D - W, d - w
    by_place = np.empty((len(x), 2, 8, 4), dtype=complex)
    by_place[..., 0] = (out * e + W) * e
    by_place[..., 1] = w * e + back
    by_place[..., 2] = (Z - D) * e - Z
    by_place[..., 3] = ((1 - e) * z - d) * e
    by_rotation = 2 * z * out * e + d * out - w * D + z * W + w * Z
    return by_place, by_rotation, out * e + Z, (z * e + back) * e


def solve(by_place: Complex, by_rotation: Complex, right: Complex) -> Complex:
    """Changes (s, 16) of solutions that change their residuals by `right` (s, 2, 8).

    Each rotation occurs in two equations only, so that it is eliminated from them: an 8 x 8 system remains.
    """
    f, g = by_rotation[:, 0], by_rotation[:, 1]
    rows = np.concatenate([g[..., None] * by_place[:, 0], -f[..., None] * by_place[:, 1]], axis=-1)
    sizes = np.sqrt(np.einsum("sjk,sjk->sj", rows.real, rows.real) + np.einsum("sjk,sjk->sj", rows.imag, rows.imag))
    values = (g * right[:, 0] - f * right[:, 1]) / sizes
    rows /= sizes[..., None]
    try:
        places = np.linalg.solve(rows, values[..., None])[..., 0]
    except np.linalg.LinAlgError:  # one of them is exactly singular; such a path is given up by its step control
        places = np.linalg.solve(rows + 1e-15 * np.eye(8), values[..., None])[..., 0]
    rest = right - (by_place @ places.reshape(-1, 2, 4, 1))[..., 0]
    rotations = np.sum(np.conj(by_rotation) * rest, axis=1) / np.sum(np.abs(by_rotation) ** 2, axis=1)
    return np.concatenate([places, rotations], axis=1)


def rotations_of(places: Complex, p: Complex) -> Complex:
    """The coupler's rotations (s, 8) of solutions of which only the places (s, 8) are known."""
    z, Z, w, W, _, d, D = _unknowns_by_name(np.concatenate([places, np.ones_like(places)], axis=1), p)
    P, Q, R = z * (D - W), d * (D - W) - w * D + z * W + w * Z, Z * (d - w)
    rotations: Complex = (R[:, 0] * Q[:, 1] - Q[:, 0] * R[:, 1]) / (P[:, 0] * R[:, 1] - R[:, 0] * P[:, 1])
    return rotations


def cognates_of(x: Complex, p: Complex) -> tuple[Complex, Complex]:
    """The two cognates of each solution (s, 16): its first, and its second ground pivot with the third one."""
    places = x[:, :8]
    swapped = places[:, [4, 5, 6, 7, 0, 1, 2, 3]]
    rows = []
    for one in (places, swapped):
        other = np.empty_like(one)
        for k in (0, 1):
            z, w, y, b = one[:, k], one[:, 2 + k], one[:, 4 + k], one[:, 6 + k]
            share = z / (z - y)
            third = w + share * (b - w)
            other[:, k], other[:, 2 + k], other[:, 4 + k], other[:, 6 + k] = w - z, w, third + share * (y - b), third
        rows.append(np.concatenate([other, rotations_of(other, p)], axis=1))
    return rows[0], rows[1]


def keys_of(x: Complex) -> Complex:
    """A number for each solution that cognates share: a symmetric function of their three ground pivots."""
    keys = np.zeros(len(x), dtype=complex)
    with np.errstate(all="ignore"):
        z, w, y, b = (x[:, 2 * k : 2 * k + 2] for k in range(4))
        for q in (w, b, w + z / (z - y) * (b - w)):
            keys += q @ KEY[:2] + q**2 @ KEY[2:4] + KEY[4] * q[:, 0] * q[:, 1]
    return keys


def is_repeated(x: Complex) -> Mask:
    """Whether an earlier solution is the same one or a cognate of it."""
    keys = keys_of(x)
    with np.errstate(invalid="ignore"):
        same = np.abs(keys[:, None] - keys) < SAME * (1 + np.abs(keys))
    repeated: Mask = np.any(np.tril(same, -1), axis=1)
    return repeated


def may_be_degenerate(x: Complex) -> Mask:
    """Whether two coordinates that differ in every proper four-bar are nearly equal."""
    z, Z, w, W, y, Y, b, B = x[:, :8].T
    pairs = np.array([[z, w], [Z, W], [y, b], [Y, B], [z, y], [Z, Y], [w, b], [W, B]])
    apart: Real = np.abs(pairs[:, 0] - pairs[:, 1])
    near: Mask = np.any(apart < EQUAL * np.abs(pairs).sum(axis=1), axis=0)
    return near


def is_degenerate(x: Complex) -> Mask:
    """Whether a solution belongs to the family Z = W = Y = B or to its mirror, which meet all points as no linkage."""
    found = np.zeros(len(x), dtype=bool)
    for k in (0, 1):
        four = x[:, [k, 2 + k, 4 + k, 6 + k]]
        found |= np.ptp(four.real, axis=1) + np.ptp(four.imag, axis=1) < EQUAL * np.abs(four).max(axis=1)
    return found


def _unknowns_by_name(x: Complex, p: Complex) -> tuple[Array, ...]:
    """z, Z, w, W (s, 2, 1), and e, d, D (s, 1, 8)."""
    dyads = x[:, :8].reshape(-1, 2, 4)
    z, Z, w, W = (dyads[:, :, k, None] for k in range(4))
    return z, Z, w, W, x[:, None, 8:], p[:, None, :8], p[:, None, 8:]


# First and shortest step, as shares of the line. A path that needs shorter ones is given up.
FIRST, SHORTEST = 0.01, 1e-9
# Largest number of steps of a path, also of one in double-double; the longest that were met took 5200.
MOST_STEPS = 20_000
# Size of a prediction's error, as a share of the coordinates. With 1e-3 a path takes 60 to 150 steps; with 1e-4 one and
# a half times as many, and as many paths are lost.
COARSE, FINE = 1e-3, 1e-4
# Most Newton steps at the end, and the last relative correction of a solution. Solutions with close points have
# condition numbers near 1e12, for which only residuals in double-double suffice.
REFINEMENTS, REFINED = 12, 1e-10


@record(eq=False)
class Ends:
    """The ends of the paths.

    Parameters
    ----------
    x : array of complex, shape (s, 16)
        Solutions for the target parameters.
    reached : array of bool, shape (s,)
        Whether a path came to the target and converged there.
    """

    x: Complex
    reached: Mask


def follow(
    starts: Complex,
    base: Complex,
    target: Complex,
    report: Callable[[float], None],
    precise: bool = False,
) -> Ends:
    """Follow solutions (s, 16) for the parameters `base` (16,) to those for `target` (16,).

    Predictor of Runge and Kutta, fourth order; two Newton steps; the step length follows from the first correction
    (Sommese and Wampler, The numerical solution of systems of polynomials, 2005, chapter 2). With `precise`, residuals
    are computed in double-double, and steps are shorter. `report` receives the share of finished paths.
    """
    count, goal, speed = len(starts), FINE if precise else COARSE, target - base
    final: Complex = np.full((count, 16), np.nan, dtype=complex)
    which = np.arange(count)
    x, low = starts.astype(complex), np.zeros_like(starts, dtype=complex)
    t, h = np.zeros(count), np.full(count, FIRST)
    with np.errstate(all="ignore"):
        for _ in range(MOST_STEPS):
            if not len(which):
                break
            report(1 - len(which) / count)
            step = np.minimum(h, 1 - t)
            ahead = np.where(step < 1 - t, t + step, 1.0)
            predicted = _predicted(x, base, speed, t, step)
            p, p_low = _parameters(base, target, ahead, precise)
            derivatives = slopes(predicted, p)[:2]
            change = -solve(*derivatives, _off(predicted, low, p, p_low, precise))
            first = _relative(change, predicted)
            corrected, corrected_low = _moved(predicted, low, change)
            change = -solve(*slopes(corrected, p)[:2], _off(corrected, corrected_low, p, p_low, precise))
            second = _relative(change, corrected)
            good = (first < 20 * goal) & (second < 0.05 * first + 1e-8)
            corrected, corrected_low = _moved(corrected, corrected_low, change)
            x, low = np.where(good[:, None], corrected, x), np.where(good[:, None], corrected_low, low)
            t = np.where(good, ahead, t)
            factor = 0.9 * (goal / np.maximum(first, 1e-30)) ** 0.2
            factor = np.where(good, np.clip(factor, 0.3, 3.0), np.clip(0.9 * factor, 0.1, 0.5))
            h = step * np.where(np.isfinite(factor), factor, 0.1)
            done = t == 1
            final[which[done]] = x[done]
            going = ~done & (h > SHORTEST)
            if not going.all():
                x, low, t, h, which = (values[going] for values in (x, low, t, h, which))
    return refine(final, target)


def refine(x: Complex, target: Complex) -> Ends:
    """Newton steps with residuals in double-double; `reached` is false for rows that do not converge."""
    x, p = x.copy(), np.broadcast_to(target, x.shape)
    reached = np.zeros(len(x), dtype=bool)
    rows = np.flatnonzero(np.isfinite(x).all(axis=1))
    low = np.zeros_like(x)
    with np.errstate(all="ignore"):
        for _ in range(REFINEMENTS):
            if not len(rows):
                break
            here, here_p = x[rows], p[rows]
            change = -solve(*slopes(here, here_p)[:2], precise_residuals(here, low[rows], here_p, np.zeros_like(here)))
            size = _relative(change, here)
            x[rows], low[rows] = _moved(here, low[rows], change)
            reached[rows] = size < REFINED
            rows = rows[(size > 1e-15) & np.isfinite(size)]
    return Ends(x, reached & np.isfinite(x).all(axis=1))


def _off(x: Complex, low: Complex, p: Complex, p_low: Complex, precise: bool) -> Complex:
    return precise_residuals(x, low, p, p_low) if precise else residuals(x, p)


def _moved(x: Complex, low: Complex, change: Complex) -> tuple[Complex, Complex]:
    """x + low + change as a double-double."""
    return two_sum(x, low + change)


def _parameters(base: Complex, target: Complex, t: Real, precise: bool) -> tuple[Complex, Complex]:
    """Parameters (s, 16) at shares t of the line, the target's own at 1; as the sum of two doubles if `precise`."""
    at_end = (t == 1)[:, None]
    if not precise:
        p = np.where(at_end, target, base + t[:, None] * (target - base))
        return p, np.zeros_like(p)
    wide, zero = np.broadcast_to(t[:, None], (len(t), len(base))), np.zeros((len(t), len(base)))
    share = ComplexDoubleDouble(DoubleDouble(wide), DoubleDouble(zero))
    ends = [ComplexDoubleDouble.of(np.broadcast_to(p, wide.shape)) for p in (base, target)]
    p, p_low = (ends[0] + share * (ends[1] - ends[0])).parts
    return np.where(at_end, target, p), np.where(at_end, 0, p_low)


def _predicted(x: Complex, base: Complex, speed: Complex, t: Real, step: Real) -> Complex:
    def tangent(x: Complex, t: Real) -> Complex:
        by_place, by_rotation, by_d, by_conjugate = slopes(x, base + t[:, None] * speed)
        return solve(by_place, by_rotation, -(by_d * speed[:8] + by_conjugate * speed[8:]))

    wide = step[:, None]
    k1 = tangent(x, t)
    k2 = tangent(x + wide / 2 * k1, t + step / 2)
    k3 = tangent(x + wide / 2 * k2, t + step / 2)
    k4 = tangent(x + wide * k3, t + step)
    return x + wide / 6 * (k1 + 2 * k2 + 2 * k3 + k4)


def _relative(change: Complex, x: Complex) -> Real:
    """Largest change of a coordinate or a rotation, as a share of its size."""
    places = np.abs(change[:, :8]) / np.sqrt(np.abs(x[:, :8]) ** 2 + 0.01)
    rotations = np.abs(change[:, 8:]) / np.abs(x[:, 8:])
    largest: Real = np.maximum(places.max(axis=1), rotations.max(axis=1))
    return largest
