"""Rates of motion that is only known at even times, by differences, and its integral from rates.

A linkage's own rates are exact (`move`); these functions are for measured data. Each result includes an error estimate.
Differences amplify errors of the samples by 1/h or 1/h^2 for a step h, while the error of the formula falls with a
power of h, so that there is a best step.
"""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np

from ..core.arguments import ArgumentType, ComplexOrNan, PositiveFloat, checked, is_real
from ..core.errors import DesignError
from ..core.records import record
from ..plane.vec import Array, Real

# Relative rounding error of a number: the least error of a sample.
ROUNDING = 2.0**-53
Inexact = Annotated[float, ArgumentType(lambda value: is_real(value) and value >= 0, "a number from 0 on")]


@record(eq=False)
class SampledRates:
    """Values computed from samples.

    Parameters
    ----------
    times : array, shape (m,)
        In the unit of the interval, from the first sample on.
    values : array, shape (m,)
        Real or complex as the samples.
    error : array, shape (m,)
        Estimated error of each value: that of the formula, from a finer one, and that of the samples. It is not a
        bound, since the motion between two samples is unknown.
    """

    times: Real
    values: Array
    error: Real


@checked
def velocity_difference(samples: ComplexOrNan, interval: PositiveFloat, inexact: Inexact = 0.0) -> SampledRates:
    """Mean rate over each interval, taken as the rate in its middle: the velocity-difference method.

    Parameters
    ----------
    samples : array_like, shape (n,)
        At even times, n at least 4, real or complex, nan where unknown.
    interval : float
        Between two samples, s; above 0.
    inexact : float
        Largest error of a sample, in its unit.

    Returns
    -------
    SampledRates
        n - 1 rates at the middles of the intervals, in units of the samples per s.

    Raises
    ------
    DesignError
        If an argument is not as described.

    Notes
    -----
    The formula's error is h^2 s''' / 24. Taking the chord of a strip for the tangent at its mid-ordinate, the drawing
    office's graphical differentiation, is the same. Applied to the rates again it gives the acceleration at the samples
    from the second to the last but one. Errors derived here.

    Examples
    --------
    >>> import geomkin as gk
    >>> gk.linkage.velocity_difference([0.0, 1.0, 4.0, 9.0], 1.0).values
    array([1., 3., 5.])
    """
    z = _row("samples", samples, 4)
    values = np.diff(z) / interval
    # A cubic through four samples gives the rate in the middle to h^4; the ends use their neighbours' error.
    missed = np.abs(np.convolve(z, [1, -3, 3, -1], "valid")) / (24 * interval)
    error = np.concatenate([missed[:1], missed, missed[-1:]]) + 2 * _off(z, inexact) / interval
    return SampledRates((np.arange(len(values)) + 0.5) * interval, values, error)


@checked
def central_difference(
    samples: ComplexOrNan,
    interval: PositiveFloat,
    derivative: Literal[1, 2] = 1,
    order: Literal[2, 4, 6, 8] = 4,
    periodic: bool = False,
    inexact: Inexact = 0.0,
) -> SampledRates:
    """First or second derivative at every sample, by central differences.

    Parameters
    ----------
    samples : array_like, shape (n,)
        At even times, n at least order + 5, real or complex, nan where unknown.
    interval : float
        Between two samples, s; above 0.
    derivative : {1, 2}
        Which derivative.
    order : {2, 4, 6, 8}
        Power of the interval with which the error falls.
    periodic : bool
        Whether the first sample follows on the last, as over whole turns; otherwise the ends use one-sided
        differences of the same order.
    inexact : float
        Largest error of a sample, in its unit.

    Returns
    -------
    SampledRates
        n values in units of the samples per s or s2.

    Raises
    ------
    DesignError
        If an argument is not as described.

    Notes
    -----
    Weights: those of the polynomial through the samples (Fornberg, Mathematics of Computation 51, 1988).
    """
    z = _row("samples", samples, order + 5)
    scale = interval**-derivative
    values, weight = _differences(z, derivative, order, periodic)
    finer, _ = _differences(z, derivative, order + 2, periodic)
    error = (np.abs(finer - values) + weight * _off(z, inexact)) * scale
    return SampledRates(np.arange(len(z)) * interval, values * scale, error)


@checked
def mid_ordinate_integral(
    rates: ComplexOrNan, interval: PositiveFloat, start: complex = 0.0, inexact: Inexact = 0.0
) -> SampledRates:
    """Integral of rates given in the middles of even intervals: each strip is its mid-ordinate times its width.

    Parameters
    ----------
    rates : array_like, shape (n,)
        In the middles of the intervals, n at least 4, real or complex.
    interval : float
        Of time, s; above 0.
    start : complex
        Value at the start of the first interval.
    inexact : float
        Largest error of a rate, in its unit.

    Returns
    -------
    SampledRates
        n + 1 values at the ends of the intervals, in units of the rates times s.

    Raises
    ------
    DesignError
        If an argument is not as described.

    Notes
    -----
    The formula's error is h^2 (r' - r'(0)) / 24 at the end, and errors of the rates add up. It is the inverse of
    `velocity_difference`. The drawing office's graphical integration; errors derived here.
    """
    r = _row("rates", rates, 4)
    if np.imag(start) or np.iscomplexobj(r):
        r, first = r.astype(complex), complex(start)
    else:
        first = float(np.real(start))
    values = np.concatenate([[first], first + np.cumsum(r) * interval])
    # The error of each strip is h^3 r'' / 24.
    strip = np.convolve(r, [1, -2, 1], "valid") / 24
    missed = np.cumsum(np.concatenate([strip[:1], strip, strip[-1:]]))
    ends = np.arange(len(values))
    error = np.concatenate([[0.0], np.abs(missed)]) * interval + ends * interval * _off(r, inexact)
    return SampledRates(ends * interval, values, error)


def _row(name: str, numbers: ComplexOrNan, least: int) -> Array:
    """The numbers as floats or complex; DesignError if they are not one row, or too few."""
    z = np.asarray(numbers)
    if z.ndim != 1 or len(z) < least:
        raise DesignError(name, f"found shape {z.shape}", f"give a 1-D array of at least {least}", "wrong-type")
    return z.astype(complex if np.iscomplexobj(z) else float)


def _off(z: Array, inexact: float) -> float:
    """Error of a sample: the given one, and rounding of the largest."""
    return float(inexact + ROUNDING * np.nanmax(np.abs(z), initial=0.0))


def _differences(z: Array, derivative: int, order: int, periodic: bool) -> tuple[Array, Real]:
    """Derivatives at every sample times a power of the step, (n,), and the sum of their weights' magnitudes, (n,)."""
    half = order // 2
    middle = weights(np.arange(-half, half + 1.0), derivative)
    if periodic:
        around = np.concatenate([z[-half:], z, z[:half]])
        return np.convolve(around, middle[::-1], "valid"), np.full(len(z), np.abs(middle).sum())
    values, size = np.empty_like(z), np.full(len(z), np.abs(middle).sum())
    values[half:-half] = np.convolve(z, middle[::-1], "valid")
    count = order + derivative
    for k in range(half):
        one_sided = weights(np.arange(count) - float(k), derivative)
        values[k], values[-1 - k] = one_sided @ z[:count], (-1) ** derivative * (one_sided @ z[: -count - 1 : -1])
        size[k] = size[-1 - k] = np.abs(one_sided).sum()
    return values, size


def weights(places: Real, derivative: int) -> Real:
    """Weights (n,) of values at these positions, in steps, for the derivative at 0 of the polynomial through them.

    Fornberg's recursion, which goes from point to point and loses no digits.
    """
    table = np.zeros((derivative + 1, len(places)))
    table[0, 0] = 1.0
    before = 1.0
    for k in range(1, len(places)):
        product = 1.0
        for j in range(k):
            apart = places[k] - places[j]
            product *= apart
            if j == k - 1:
                for m in range(derivative, -1, -1):
                    lower = m * table[m - 1, k - 1] if m else 0.0
                    table[m, k] = before / product * (lower - places[k - 1] * table[m, k - 1])
            for m in range(derivative, -1, -1):
                lower = m * table[m - 1, j] if m else 0.0
                table[m, j] = (places[k] * table[m, j] - lower) / apart
        before = product
    result: Real = table[derivative]
    return result
