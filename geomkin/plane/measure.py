"""Measures of any curve from its contract: length, area, centroid, curvature, nearest point."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np

from ..core.arguments import Points, Reals, checked
from ..core.errors import DesignError
from .curve import AbstractCurve
from .joined import PolarArray
from .primitives import Polyline
from .vec import Complex, Real, cross, dot, unit

# Gauss points per smooth piece. 16 integrate the pieces met here to rounding at once; the doubling
# below confirms it, and takes over where they do not. Those above 0, and weights (Abramowitz and Stegun, table 25.4);
# to find them takes longer than what a gear asks of them.
_ABOVE = np.array([
    0.09501250983763744, 0.2816035507792589, 0.45801677765722737, 0.6178762444026438,
    0.755404408355003, 0.8656312023878318, 0.9445750230732326, 0.9894009349916499,
])  # fmt: skip
_HALF = np.array([
    0.18945061045506864, 0.18260341504492364, 0.16915651939500265, 0.1495959888165767,
    0.12462897125553407, 0.0951585116824926, 0.062253523938647456, 0.027152459411754176,
])  # fmt: skip
_NODES, _WEIGHTS = np.concatenate([-_ABOVE[::-1], _ABOVE]), np.concatenate([_HALF[::-1], _HALF])
# Doublings of the number of pieces before an integral is given up as unsmooth. Fewer leave digits where a curve
# turns sharply; each more doubles the time for one that never settles.
_DOUBLINGS = 12
# Samples per smooth piece in the search for a nearest point. Fewer, and a curve that turns away and back between
# two of them hides its nearest point; more cost time.
_SAMPLES = 48


@checked
def length(curve: AbstractCurve, accuracy: float = 1e-12) -> float:
    """Arc length, mm, to a relative `accuracy`: the integral of |dP/dt| by Gauss' rule."""
    if isinstance(curve, PolarArray):
        return curve.count * length(curve.piece, accuracy)
    return float(_integral(curve, lambda t: np.abs(curve.velocity(t)), accuracy).real)


@checked
def area(curve: AbstractCurve, accuracy: float = 1e-12) -> float:
    """Area enclosed by a closed curve, mm2, positive whichever way it runs; where it crosses itself, of `signed_area`.

    To `accuracy` relative to the square of the curve's length.
    """
    return abs(signed_area(curve, accuracy))


@checked
def signed_area(curve: AbstractCurve, accuracy: float = 1e-12) -> float:
    """Area of a closed curve, mm2, positive when it runs counterclockwise, each part as often as the curve winds round.

    By Green's theorem, half the integral of P x dP, to `accuracy` relative to the square of the curve's length.
    DesignError for an open one.
    """
    if not curve.closed:
        raise DesignError("curve", "found an open one, which encloses no area", "give a closed curve")
    if isinstance(curve, PolarArray):
        return curve.count * _sector(curve.piece, 0j, accuracy).real
    if isinstance(curve, Polyline):
        return curve.swept
    return float(_sector(curve, complex(curve.point(curve.breaks[0])), accuracy).real)


def _sector(curve: AbstractCurve, about: complex, accuracy: float) -> complex:
    def swept(t: Real) -> Real:
        return 0.5 * cross(curve.point(t) - about, curve.velocity(t))

    return _integral(curve, swept, accuracy)


@checked
def centroid(curve: AbstractCurve, accuracy: float = 1e-12) -> complex:
    """Centroid of the area enclosed by a closed curve, mm; nan where the area is zero.

    By Green's theorem, a third of the integral of P (P x dP) over the area. DesignError for an open curve.
    """
    if isinstance(curve, PolarArray):
        return 0j if curve.count > 1 else centroid(curve.piece, accuracy)
    start = complex(curve.point(curve.breaks[0]))

    def moment(t: Real) -> Complex:
        z = curve.point(t) - start
        return z * cross(z, curve.velocity(t)) / 3

    enclosed = signed_area(curve, accuracy)
    return start + _integral(curve, moment, accuracy) / enclosed if enclosed else complex(np.nan, np.nan)


@checked
def curvature(curve: AbstractCurve, t: Reals) -> Real:
    """Signed curvature, 1/mm, positive where the curve turns left along rising t; infinite at a cusp.

    At parameters of any shape; at a break, that of the piece that starts there.
    """
    return curve.curvature(t)


@checked
def convexity(curve: AbstractCurve, t: Reals) -> Real:
    """Curvature of a closed curve, 1/mm, positive where it is convex as seen from outside the area it encloses.

    Whichever way it runs: a cam that turns counterclockwise has a profile that runs clockwise. Else as `curvature`,
    which is positive to the left, so that it is the same for an outline that runs counterclockwise.
    """
    return curve.curvature(t) * float(np.sign(signed_area(curve, 1e-3)))


@checked
def nearest(curve: AbstractCurve, points: Points) -> tuple[Real, Real]:
    """Parameter and distance, mm, of the curve's point nearest to each of `points` (any shape).

    The distance is within 1e-12 of the curve's size of the least one, unless the curve has a feature
    smaller than a 48th of its smooth piece. Of places equally near, one. Derived here.
    """
    z = np.asarray(points, dtype=complex)
    flat, b = z.ravel(), curve.breaks
    grid = np.concatenate([b0 + (b1 - b0) * np.arange(_SAMPLES) / _SAMPLES for b0, b1 in pairwise(b)])
    grid = np.append(grid, b[-1])
    samples = curve.point(grid)
    away = np.abs(samples - flat[:, None])
    padded = np.pad(away, ((0, 0), (1, 1)), constant_values=np.inf)
    valley = (away <= padded[:, :-2]) & (away <= padded[:, 2:])
    # A valley can be deeper than its sample by the way to the next one, at most: the rest are out.
    steps = np.pad(np.abs(np.diff(samples)), 1)
    hopeful = valley & (away - np.maximum(steps[:-1], steps[1:]) <= away.min(axis=1, keepdims=True))
    row, column = np.nonzero(hopeful)
    low, high = grid[np.maximum(column - 1, 0)], grid[np.minimum(column + 1, len(grid) - 1)]
    found = _golden(curve, flat[row], low, high, grid[column])
    distance = np.abs(curve.point(found) - flat[row])
    best = np.lexsort((distance, row))[np.searchsorted(row, np.arange(len(flat)))]
    return found[best].reshape(z.shape), distance[best].reshape(z.shape)


def _golden(curve: AbstractCurve, z: Complex, low: Real, high: Real, start: Real) -> Real:
    """Minimise the distance inside brackets by golden section, then sharpen where the foot is square.

    Golden section alone stops at half the digits, since a distance is flat at its least; the bisection
    of the sign of (P - z) . P' has them all, where the curve is smooth there.
    """
    ratio = (np.sqrt(5) - 1) / 2
    for _ in range(40):
        a, b = high - ratio * (high - low), low + ratio * (high - low)
        left = np.abs(curve.point(a) - z) <= np.abs(curve.point(b) - z)
        low, high = np.where(left, low, a), np.where(left, b, high)
    found = 0.5 * (low + high)
    width = 64 * (high - low)
    first, last = curve.breaks[0], curve.breaks[-1]
    low, high = np.clip(found - width, first, last), np.clip(found + width, first, last)
    for _ in range(50):
        middle = 0.5 * (low + high)
        before = dot(curve.point(middle) - z, curve.velocity(middle)) < 0
        low, high = np.where(before, middle, low), np.where(before, high, middle)
    options = np.stack([start, found, 0.5 * (low + high), np.full_like(found, first), np.full_like(found, last)])
    best = np.abs(curve.point(options) - z).argmin(axis=0)
    nearest: Real = options[best, np.arange(len(best))]
    return nearest


def _integral(curve: AbstractCurve, f: Callable[[Real], Real | Complex], accuracy: float) -> complex:
    """Integral of f over the curve's domain by Gauss' rule on ever more pieces, to a relative accuracy."""
    edges = curve.breaks
    before = None
    for _ in range(_DOUBLINGS):
        half = 0.5 * np.diff(edges)
        t = (edges[:-1] + half)[:, None] + half[:, None] * _NODES
        cells = (f(t) * _WEIGHTS).sum(axis=-1) * half
        total, scale = complex(cells.sum()), float(np.abs(cells).sum())
        if before is not None and abs(total - before) <= max(accuracy, 1e-15) * scale:
            return total
        before = total
        edges = np.sort(np.concatenate([edges, 0.5 * (edges[:-1] + edges[1:])]))
    return total


def separation(a: Complex, b: Complex) -> Real:
    """Distance, mm, (...,), between the convex hulls of points a (..., n) and b (..., m); 0 or less where they meet.

    Two convex shapes are as far apart as the widest strip between them. Its sides stand square to the line
    between two corners, or lie along an edge, so that trying all pairs of points is exact.
    """
    across = (b[..., None, :] - a[..., :, None]).reshape(*a.shape[:-1], -1)
    normals = [1j * _pairs(a), 1j * _pairs(b)]
    directions = unit(np.concatenate([across, *normals, *(-n for n in normals)], axis=-1))
    upper, lower = np.full(directions.shape, np.inf), np.full(directions.shape, -np.inf)
    for k in range(b.shape[-1]):
        upper = np.minimum(upper, dot(directions, b[..., k, None]))
    for k in range(a.shape[-1]):
        lower = np.maximum(lower, dot(directions, a[..., k, None]))
    strip = upper - lower
    # Points that fall together have no direction between them.
    widest: Real = np.where(np.isfinite(strip), strip, -np.inf).max(axis=-1)
    return widest


def _pairs(z: Complex) -> Complex:
    """Differences of all pairs of points."""
    one, two = np.triu_indices(z.shape[-1], 1)
    return z[..., two] - z[..., one]
