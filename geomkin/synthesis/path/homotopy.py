"""Solutions of the nine-point equations followed along straight lines of the parameters, all at once as arrays."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...core.records import record
from ...plane.vec import Complex, Mask, Real
from .double_double import ComplexDoubleDouble, DoubleDouble, two_sum
from .nine_point_equations import precise_residuals, residuals, slopes, solve

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
