"""Motion that is known at even times alone: its rates by differences, and what it was by adding the rates up again.

A linkage's own rates are exact (`move`); these are for what was measured, or comes from elsewhere. Each result tells
how far it may be off. Differences lose digits: a step h blows what the samples are off up by 1/h, or 1/h^2, while what
the formula misses falls with a power of h, so that there is a best step, and smaller ones are worse.
"""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np

from ..core.arguments import ArgumentType, Places, Positive, checked, is_real
from ..core.errors import DesignError
from ..core.records import record
from ..plane.vec import Array, Real

# Rounding of a number as a share of it: what samples are off at least.
ROUNDING = 2.0**-53
Inexact = Annotated[float, ArgumentType(lambda value: is_real(value) and value >= 0, "a number from 0 on")]


@record(eq=False)
class SampledRates:
    """Numbers found from samples. interval: of the samples.

    times: (m,), in the interval's unit, from the first sample on; values: (m,), real or complex as the samples; error:
    (m,), how far each may be off: what the formula misses, judged by a finer one, and what comes of the samples being
    off. No bound: what happens between two samples is known to none.
    """

    times: Real
    values: Array
    error: Real


@checked
def velocity_difference(samples: Places, interval: Positive, inexact: Inexact = 0.0) -> SampledRates:
    """Mean rate over each interval, taken for the rate in its middle: the velocity-difference method.

    samples: (n,) at even times, n at least 4, real or complex, nan where unknown; interval: between two, s; inexact:
    how far a sample may be off, in its unit. Rates (n - 1,) at the middles of the intervals, in units of the samples
    per s. It misses h^2 s''' / 24. The chord of a strip for the tangent at its mid-ordinate is the same: the drawing
    office's graphical differentiation. Taken again of the rates it gives the acceleration at the samples from the
    second to the last but one. Errors derived here.
    """
    z = _row("samples", samples, 4)
    values = np.diff(z) / interval
    # A cubic through the four samples around knows the rate in the middle to h^4; the ends take their neighbours'.
    missed = np.abs(np.convolve(z, [1, -3, 3, -1], "valid")) / (24 * interval)
    error = np.concatenate([missed[:1], missed, missed[-1:]]) + 2 * _off(z, inexact) / interval
    return SampledRates((np.arange(len(values)) + 0.5) * interval, values, error)


@checked
def central_difference(
    samples: Places,
    interval: Positive,
    derivative: Literal[1, 2] = 1,
    order: Literal[2, 4, 6, 8] = 4,
    periodic: bool = False,
    inexact: Inexact = 0.0,
) -> SampledRates:
    """First or second derivative at every sample, by central differences that miss no more than a power of the step.

    samples: (n,) at even times, n at least order + 5, real or complex, nan where unknown; interval: between two, s;
    order: the power; periodic: the first sample follows on the last, as over whole turns; otherwise the ends take
    one-sided differences of the same order. inexact: how far a sample may be off, in its unit. Values (n,) in units of
    the samples per s or s2. Weights: those of the polynomial through the samples (Fornberg, Mathematics of
    Computation 51, 1988).
    """
    z = _row("samples", samples, order + 5)
    scale = interval**-derivative
    values, weight = _differences(z, derivative, order, periodic)
    finer, _ = _differences(z, derivative, order + 2, periodic)
    error = (np.abs(finer - values) + weight * _off(z, inexact)) * scale
    return SampledRates(np.arange(len(z)) * interval, values * scale, error)


@checked
def mid_ordinate_integral(
    rates: Places, interval: Positive, start: complex = 0.0, inexact: Inexact = 0.0
) -> SampledRates:
    """What has these rates in the middles of even intervals, at their ends: each strip is its mid-ordinate wide h.

    rates: (n,) in the middles, n at least 4, real or complex; interval: of time, s; start: the value at the first end;
    inexact: how far a rate may be off. Values (n + 1,), in units of the rates times s. It misses h^2 (r' - r'(0)) / 24
    at the end of the way, and what rates are off adds up. Undoes `velocity_difference`. The drawing office's
    graphical integration; errors derived here.
    """
    r = _row("rates", rates, 4)
    if np.imag(start) or np.iscomplexobj(r):
        r, first = r.astype(complex), complex(start)
    else:
        first = float(np.real(start))
    values = np.concatenate([[first], first + np.cumsum(r) * interval])
    # Each strip misses h^3 r'' / 24.
    bend = np.convolve(r, [1, -2, 1], "valid") / 24
    missed = np.cumsum(np.concatenate([bend[:1], bend, bend[-1:]]))
    ends = np.arange(len(values))
    error = np.concatenate([[0.0], np.abs(missed)]) * interval + ends * interval * _off(r, inexact)
    return SampledRates(ends * interval, values, error)


def _row(name: str, numbers: Places, least: int) -> Array:
    """The numbers as floats or complex; DesignError where they are no row or too few."""
    z = np.asarray(numbers)
    if z.ndim != 1 or len(z) < least:
        raise DesignError(name, f"found shape {z.shape}", f"give one row of at least {least}")
    return z.astype(complex if np.iscomplexobj(z) else float)


def _off(z: Array, inexact: float) -> float:
    """How far a sample may be off: as told, and rounding of the largest."""
    return float(inexact + ROUNDING * np.nanmax(np.abs(z), initial=0.0))


def _differences(z: Array, derivative: int, order: int, periodic: bool) -> tuple[Array, Real]:
    """Derivatives at every sample times a power of the step, (n,), and the sum of their weights' sizes, (n,)."""
    half = order // 2
    middle = weights(np.arange(-half, half + 1.0), derivative)
    if periodic:
        around = np.concatenate([z[-half:], z, z[:half]])
        return np.convolve(around, middle[::-1], "valid"), np.full(len(z), np.abs(middle).sum())
    values, size = np.empty_like(z), np.full(len(z), np.abs(middle).sum())
    values[half:-half] = np.convolve(z, middle[::-1], "valid")
    count = order + derivative
    for k in range(half):
        near = weights(np.arange(count) - float(k), derivative)
        values[k], values[-1 - k] = near @ z[:count], (-1) ** derivative * (near @ z[: -count - 1 : -1])
        size[k] = size[-1 - k] = np.abs(near).sum()
    return values, size


def weights(places: Real, derivative: int) -> Real:
    """Weights (n,) of numbers at these places, in steps, that give the derivative at 0 of the polynomial through them.

    Fornberg's recursion, which goes from place to place and loses no digits.
    """
    found = np.zeros((derivative + 1, len(places)))
    found[0, 0] = 1.0
    before = 1.0
    for k in range(1, len(places)):
        product = 1.0
        for j in range(k):
            apart = places[k] - places[j]
            product *= apart
            if j == k - 1:
                for m in range(derivative, -1, -1):
                    lower = m * found[m - 1, k - 1] if m else 0.0
                    found[m, k] = before / product * (lower - places[k - 1] * found[m, k - 1])
            for m in range(derivative, -1, -1):
                lower = m * found[m - 1, j] if m else 0.0
                found[m, j] = (places[k] * found[m, j] - lower) / apart
        before = product
    row: Real = found[derivative]
    return row
