"""Circles and lines that points lie on, one for each row of points: the partner of a chosen pin or pivot."""

from __future__ import annotations

import numpy as np

from ...plane.vec import Complex, Mask, Real, Whole
from .constraint import FAR
from .least_squares import least_squares

# Singular value over the largest below which points are at two places only. Larger, and points close together get no
# circle; smaller, and the rounding of two places is taken for a third.
FEWER = 1e-12


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

    best = least_squares(cost, np.stack([bend, slope.real, slope.imag, level], axis=-1))
    return best[:, 0], best[:, 1] + 1j * best[:, 2], best[:, 3]
