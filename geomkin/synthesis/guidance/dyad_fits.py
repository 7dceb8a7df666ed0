"""Least squares where more is wanted than can be met: circles through points, dyads through more than five poses."""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations, islice

import numpy as np

from ...plane.vec import Complex, Mask, Real, Whole
from .constraint import FAR, Pairs, joined, missed, normalised, pairs_of_least, relations
from .poses import inverse

# Sets of five poses from which fits start besides. Fewer may miss the best fit of poses that no dyad nearly meets;
# more cost time.
MOST_FIVES = 12
# Difference of two fits, in sizes, below which they are one: least squares are flat, and found to half the digits.
# Larger, and two are taken for one; smaller, and one is told twice.
SAME = 1e-4
# Singular value over the largest below which points are at two places only. Larger, and points close together get no
# circle; smaller, and the rounding of two places is taken for a third.
FEWER = 1e-12
# Steps at most, each for all starts together; a start that needs more creeps along a valley that ends at infinity.
STEPS = 300
# Gain of a step, as a share of the squares, below which a start has converged.
CONVERGED = 1e-13
# Largest unknown, of which sizes are about 1. Larger, and fourth powers overflow; smaller stops fits of far pivots.
FARTHEST = 1e12


def fitted_dyads(origins: Complex, directions: Complex) -> tuple[Pairs, Mask]:
    """Dyads at which the sum of squared distances missed is least, near by, best first, and which have converged.

    The others creep towards a dyad at infinity, and are where their steps ended.
    Starts: the dyads of the least three rows of all poses, and those of sets of five of them, evenly chosen.
    """
    z, middle, size = normalised(origins)
    sets = list(combinations(range(len(z)), 5)) if len(z) < 12 else _spread(len(z))
    chosen = np.array(sets)[np.unique(np.linspace(0, len(sets) - 1, MOST_FIVES).astype(int))]
    sets_of_all = relations(z, directions), relations(z[chosen], directions[chosen])
    starts = joined([found.at(there) for found, there in map(pairs_of_least, sets_of_all)])
    body = starts.moving_far | (~starts.fixed_far & (np.abs(starts.moving) > np.abs(starts.fixed)))
    on_ground, settled = _polished(z, directions, starts.at(~body))
    on_body, settled_too = _polished(*inverse(z, directions), starts.at(body).swapped)
    found, converged = joined([on_ground, on_body.swapped]), np.concatenate([settled, settled_too])
    order = np.argsort(missed(z, directions, found), kind="stable")
    order = order[_different(found.at(order))]
    return found.at(order).enlarged(middle, size), converged[order]


def _spread(count: int) -> list[tuple[int, ...]]:
    """Sets of five out of many, each evenly spread, from different firsts."""
    step = count // 5
    return [tuple(first + step * k for k in range(5)) for first in islice(range(step), MOST_FIVES)]


def _polished(z: Complex, u: Complex, starts: Pairs) -> tuple[Pairs, Mask]:
    """The same at their least squares, and which have come there; the pin on the body is no slide."""
    if not starts.fixed.size:
        return starts, np.zeros(0, dtype=bool)
    m = starts.moving[:, None]
    pins = z + u * m
    with np.errstate(invalid="ignore"):
        # |p - f|^2 - r^2 over the length of f, so that a far pivot is a line.
        reach = np.where(starts.fixed_far, 1.0, np.maximum(1.0, np.abs(starts.fixed)))
        bend = np.where(starts.fixed_far, 0.0, 1 / reach)[:, None]
        slope = np.where(starts.fixed_far, -1j * starts.fixed, -2 * starts.fixed / reach)[:, None]
    level = -(bend * np.abs(pins) ** 2 + (np.conj(slope) * pins).real).mean(axis=-1, keepdims=True)

    def cost(x: Real, _: Whole) -> tuple[Real, Real]:
        pins = z + u * (x[:, :1] + 1j * x[:, 1:2])
        away, by = distances(pins, x[:, 2:3], x[:, 3:4] + 1j * x[:, 4:5], x[:, 5:])
        by_x, by_y = by[4] * u.real + by[5] * u.imag, by[5] * u.real - by[4] * u.imag
        return away, np.stack([by_x, by_y, *by[:4]], axis=-1)

    start = np.concatenate([m.real, m.imag, bend, slope.real, slope.imag, level], axis=-1)
    x, converged = least_squares(cost, start)
    bend, slope = x[:, 2], x[:, 3] + 1j * x[:, 4]
    far = 2 * np.abs(bend) * FAR <= np.abs(slope)
    with np.errstate(divide="ignore", invalid="ignore"):
        fixed = np.where(far, 1j * slope / np.abs(slope), -slope / (2 * bend))
    return Pairs(fixed, x[:, 0] + 1j * x[:, 1], far, np.zeros(len(x), dtype=bool)), converged


def _different(found: Pairs) -> Whole:
    kept: list[int] = []
    for k in range(found.fixed.size):
        near = [
            j
            for j in kept
            if all(
                far[j] == far[k] and abs(place[j] - place[k]) <= SAME * (1 + abs(place[k]))
                for far, place in ((found.fixed_far, found.fixed), (found.moving_far, found.moving))
            )
        ]
        if not near and np.isfinite(found.fixed[k]) and np.isfinite(found.moving[k]):
            kept.append(k)
    return np.array(kept, dtype=int)


def fitted_circles(points: Complex) -> tuple[Complex, Mask]:
    """Centres (k,) of rows of points (k, n), mm, and which are at infinity: then the line's direction, unit complex.

    The best circle or line in the sense of least squares of distances, through three points exactly. nan where the
    points are at two places: many circles pass them; their own place where they are all at one.
    """
    middle = points.mean(axis=-1, keepdims=True)
    size = np.abs(points - middle).max(axis=-1, keepdims=True)
    still = size[:, 0] <= 1e-14 * np.abs(points).max(axis=-1)
    p = (points - middle) / np.where(size == 0, 1.0, size)
    square = np.abs(p) ** 2
    told = np.stack([square - square.mean(axis=-1, keepdims=True), p.real, p.imag], axis=-1)
    _, sizes, ways = np.linalg.svd(told, full_matrices=False)
    few = sizes[:, 1] <= FEWER * sizes[:, 0]
    bend: Real = ways[:, 2, 0]
    slope: Complex = ways[:, 2, 1] + 1j * ways[:, 2, 2]
    level = -(bend[:, None] * square + (np.conj(slope)[:, None] * p).real).mean(axis=-1)
    if points.shape[-1] > 3 and (sizes[:, 2] > FEWER * sizes[:, 0]).any():
        bend, slope, level = _refined(p, bend, slope, level)
    far = 2 * np.abs(bend) * FAR <= np.abs(slope)
    with np.errstate(divide="ignore", invalid="ignore"):
        centre = np.where(far, 1j * slope / np.abs(slope), middle[:, 0] - size[:, 0] * slope / (2 * bend))
    centre[few] = complex(np.nan, np.nan)
    return np.where(still, middle[:, 0], centre), far & ~few & ~still


def distances(
    p: Complex, bend: Real, slope: Complex, level: Real
) -> tuple[Real, tuple[Real, Real, Real, Real, Real, Real]]:
    """Signed distances (..., n) of points from bend |p|^2 + Re(conj(slope) p) + level = 0, and their derivatives.

    The coefficients (..., 1), of any common scale. Derivatives by bend, slope x, slope y, level, then by p x and p y.
    Chernov, Circular and Linear Regression, 2010, section 3.2, has the distance in this form, that holds for lines too.
    """
    value = bend * np.abs(p) ** 2 + (np.conj(slope) * p).real + level
    # A circle without a radius counts as a point.
    terms = np.abs(slope) ** 2 + 4 * np.abs(bend * level) + 1e-300
    size = np.sqrt(np.maximum(np.abs(slope) ** 2 - 4 * bend * level, 1e-28 * terms))
    out = 2 * bend * p + slope
    far = np.maximum(np.abs(out), 1e-14 * np.sqrt(terms))
    total = size + far
    away = 2 * value / total

    def slid(value_by: Real, square_by: Real, far_square_by: Real) -> Real:
        # Of the value, of size^2 and of far^2.
        change: Real = (2 * value_by - away * (square_by / (2 * size) + far_square_by / (2 * far))) / total
        return change

    zero = np.zeros_like(away)
    by_bend = slid(np.abs(p) ** 2 + zero, -4 * level + zero, 4 * (np.conj(p) * out).real)
    by_x = slid(p.real, 2 * slope.real + zero, 2 * out.real)
    by_y = slid(p.imag, 2 * slope.imag + zero, 2 * out.imag)
    by_level = slid(zero + 1, -4 * bend + zero, zero)
    # Along the way out from the circle a distance grows as the way does.
    return away, (by_bend, by_x, by_y, by_level, out.real / far, out.imag / far)


def _refined(p: Complex, bend: Real, slope: Complex, level: Real) -> tuple[Real, Complex, Real]:
    """Coefficients of the circles from which the points' distances are least; damped steps, Levenberg-Marquardt."""

    def cost(x: Real, rows: Whole) -> tuple[Real, Real]:
        away, by = distances(p[rows], x[:, :1], x[:, 1:2] + 1j * x[:, 2:3], x[:, 3:])
        return away, np.stack(by[:4], axis=-1)

    best, _ = least_squares(cost, np.stack([bend, slope.real, slope.imag, level], axis=-1))
    return best[:, 0], best[:, 1] + 1j * best[:, 2], best[:, 3]


def least_squares(cost: Callable[[Real, Whole], tuple[Real, Real]], start: Real) -> tuple[Real, Mask]:
    """Unknowns (k, q) at which the squares of residuals are least, each from its own start (Levenberg-Marquardt).

    Besides, which of them, (k,), came to rest within `STEPS`.

    cost: from unknowns (k, q), and which of the starts they are of, to residuals (k, n) and their derivatives
    (k, n, q). Unknowns that have a scale in common may be among them: the damping keeps what the residuals do not
    tell. Levenberg 1944, Marquardt 1963.
    """
    best = np.array(start)
    rows = np.arange(len(start))
    x, damping, eye = best, np.full(len(start), 1e-3), np.eye(best.shape[-1])
    away, slopes = cost(x, rows)
    for _ in range(STEPS):
        if not len(rows):
            break
        squares = np.sum(away**2, axis=-1)
        normal = np.einsum("kni,knj->kij", slopes, slopes)
        right = np.einsum("kni,kn->ki", slopes, away)
        trace = np.trace(normal, axis1=-2, axis2=-1)[:, None, None]
        damped = normal + (damping[:, None, None] + 1e-14) * (trace + 1e-300) * eye
        tried = x - np.linalg.solve(damped, right[..., None])[..., 0]
        new_away, new_slopes = cost(tried, rows)
        new_squares = np.sum(new_away**2, axis=-1)
        # What runs away has its least at infinity, where numbers end.
        better = (new_squares < squares) & (np.abs(tried).max(axis=-1) < FARTHEST)
        done = np.where(better, squares - new_squares <= CONVERGED * squares, damping > 1e6)
        x = np.where(better[:, None], tried, x)
        away, slopes = np.where(better[:, None], new_away, away), np.where(better[:, None, None], new_slopes, slopes)
        damping = np.clip(np.where(better, damping * 0.1, damping * 5), 1e-15, 1e12)
        best[rows] = x
        left = ~done
        x, away, slopes, damping, rows = x[left], away[left], slopes[left], damping[left], rows[left]
    return best, ~np.isin(np.arange(len(start)), rows)
