"""Arrays of numbers with twice the digits of a double: unevaluated sums of two doubles."""

from __future__ import annotations

import numpy as np

from ...plane.vec import Array, Complex, Real

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
