"""Measures of any curve: length, area and its moments, curvature, nearest point."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from ..core.arguments import checked
from ..core.errors import DesignError
from ..core.records import record
from .curve import AbstractCurve
from .joined import PolarArray
from .primitives import Circle, Polyline
from .vec import Array, Complex, Real, cross, dot, unit

# Gauss points per smooth piece, the positive ones, and weights (Abramowitz and Stegun, table 25.4). 16 usually
# integrate a piece to rounding; the doubling below confirms it. Computing them takes longer than integrating a gear.
_ABOVE = np.array([
    0.09501250983763744, 0.2816035507792589, 0.45801677765722737, 0.6178762444026438,
    0.755404408355003, 0.8656312023878318, 0.9445750230732326, 0.9894009349916499,
])  # fmt: skip
_HALF = np.array([
    0.18945061045506864, 0.18260341504492364, 0.16915651939500265, 0.1495959888165767,
    0.12462897125553407, 0.0951585116824926, 0.062253523938647456, 0.027152459411754176,
])  # fmt: skip
_NODES, _WEIGHTS = np.concatenate([-_ABOVE[::-1], _ABOVE]), np.concatenate([_HALF[::-1], _HALF])
# Largest number of times that the number of pieces is doubled, for curves that turn sharply.
_DOUBLINGS = 12
# Samples per smooth piece in the search for a nearest point. A smaller feature of the curve may be missed.
_SAMPLES = 48
# Distances between points and samples that are kept at once: 50 MB.
AT_ONCE = 2_000_000


@checked
def length(curve: AbstractCurve, accuracy: float = 1e-12) -> float:
    """Arc length of a curve.

    Parameters
    ----------
    curve : AbstractCurve
        The curve.
    accuracy : float
        Relative accuracy.

    Returns
    -------
    float
        mm.

    See Also
    --------
    area, curvature, nearest, flatten

    Notes
    -----
    The integral of `|dP/dt|` by Gauss' rule.

    Examples
    --------
    >>> import geomkin as gk
    >>> round(gk.length(gk.plane.Circle(0j, 10.0)), 6)
    62.831853
    """
    if isinstance(curve, PolarArray):
        return curve.count * length(curve.piece, accuracy)
    return _integral(curve, lambda t: np.abs(curve.velocity(t)), accuracy)


@checked
def area(curve: AbstractCurve, accuracy: float = 1e-12) -> float:
    """Area enclosed by a closed curve, positive in either direction.

    Parameters
    ----------
    curve : AbstractCurve
        A closed curve. If it crosses itself, the area is that of `signed_area`.
    accuracy : float
        Relative to the square of the curve's length.

    Returns
    -------
    float
        mm2.

    Raises
    ------
    DesignError
        If the curve is open.

    See Also
    --------
    length, flatten

    Examples
    --------
    >>> import geomkin as gk
    >>> round(gk.area(gk.plane.Circle(0j, 10.0)), 6)
    314.159265
    """
    return abs(signed_area(curve, accuracy))


@checked
def signed_area(curve: AbstractCurve, accuracy: float = 1e-12) -> float:
    """Signed area of a closed curve, positive if it runs counterclockwise.

    Each part of the area counts as often as the curve winds around it.

    Parameters
    ----------
    curve : AbstractCurve
        A closed curve.
    accuracy : float
        Relative to the square of the curve's length.

    Returns
    -------
    float
        mm2.

    Raises
    ------
    DesignError
        If the curve is open.

    Notes
    -----
    By Green's theorem, half the integral of P x dP.
    """
    if not curve.closed:
        raise DesignError("curve", "found an open curve, which encloses no area", "give a closed curve", "wrong-type")
    if isinstance(curve, PolarArray):
        return curve.count * _sector(curve.piece, 0j, accuracy)
    if isinstance(curve, Polyline):
        return curve.swept
    return _sector(curve, complex(curve.point(curve.breaks[0])), accuracy)


def _sector(curve: AbstractCurve, about: complex, accuracy: float) -> float:
    def swept(t: Real) -> Real:
        return 0.5 * cross(curve.point(t) - about, curve.velocity(t))

    return _integral(curve, swept, accuracy)


@record
class AreaMoments:
    """Moments of the area enclosed by a closed curve.

    Parameters
    ----------
    area : float
        mm2, positive in either direction of the curve.
    first : complex
        First moment about the origin, the area times its centroid, mm3.
    polar : float
        Polar second moment about the origin, mm4.

    Notes
    -----
    Those of several curves add up; holes count negatively.
    """

    area: float
    first: complex
    polar: float

    def __add__(self, other: AreaMoments) -> AreaMoments:
        return AreaMoments(self.area + other.area, self.first + other.first, self.polar + other.polar)

    def __neg__(self) -> AreaMoments:
        return AreaMoments(-self.area, -self.first, -self.polar)

    @property
    def centroid(self) -> complex:
        """mm; nan if the area is zero."""
        return self.first / self.area if self.area else complex(np.nan, np.nan)


@checked
def area_moments(curve: AbstractCurve, accuracy: float = 1e-12) -> AreaMoments:
    """Area, first moment and polar second moment of the area enclosed by a closed curve.

    Parameters
    ----------
    curve : AbstractCurve
        A closed curve. If it crosses itself, each part counts as often as the curve winds around it.
    accuracy : float
        Relative accuracy of the integrals.

    Returns
    -------
    AreaMoments

    Raises
    ------
    DesignError
        If the curve is open.

    Notes
    -----
    By Green's theorem, from the integrals of P x dP, P (P x dP) and |P|2 (P x dP).

    Examples
    --------
    >>> import geomkin as gk
    >>> disc = gk.plane.area_moments(gk.plane.Circle(3 + 4j, 10.0))
    >>> round(disc.area, 6), round(disc.polar / disc.area, 6), abs(disc.centroid - (3 + 4j)) < 1e-12
    (314.159265, 75.0, True)
    """
    if not curve.closed:
        raise DesignError("curve", "found an open curve, which encloses no area", "give a closed curve")
    if isinstance(curve, Circle):
        disc, square = np.pi * curve.radius**2, abs(curve.centre) ** 2
        return AreaMoments(disc, disc * curve.centre, disc * (curve.radius**2 / 2 + square))
    if isinstance(curve, PolarArray) and curve.count > 1:
        sector = _sector_moments(curve.piece, 0j, accuracy)
        moments = AreaMoments(curve.count * sector.area, 0j, curve.count * sector.polar)
    else:
        # About a point of the curve, so that no digits cancel far from the origin.
        start = complex(curve.point(curve.breaks[0]))
        about = _sector_moments(curve, start, accuracy)
        polar = about.polar + 2 * dot(start, about.first) + abs(start) ** 2 * about.area
        moments = AreaMoments(about.area, about.first + start * about.area, float(polar))
    return moments if moments.area >= 0 else -moments


def _sector_moments(curve: AbstractCurve, about: complex, accuracy: float) -> AreaMoments:
    """Signed moments, about a point, of the area that the line from the point to the curve sweeps."""

    def swept(t: Real) -> Complex:
        z = curve.point(t) - about
        rows: Complex = cross(z, curve.velocity(t)) * np.array([0.5 + 0 * z, z / 3, np.abs(z) ** 2 / 4])
        return rows

    area, first, polar = _integrals(curve, swept, accuracy)
    return AreaMoments(float(area.real), complex(first), float(polar.real))


@checked
def centroid(curve: AbstractCurve, accuracy: float = 1e-12) -> complex:
    """Centroid of the area enclosed by a closed curve.

    Parameters
    ----------
    curve : AbstractCurve
        A closed curve.
    accuracy : float
        Relative accuracy of the integrals.

    Returns
    -------
    complex
        mm; nan if the area is zero.

    Raises
    ------
    DesignError
        If the curve is open.
    """
    return area_moments(curve, accuracy).centroid


@checked
def curvature(curve: AbstractCurve, t: float | ArrayLike) -> Real:
    """Signed curvature of a curve, positive if it turns left along rising t.

    Parameters
    ----------
    curve : AbstractCurve
        The curve.
    t : float or array_like
        Parameters of any shape; at a break the curvature is that of the piece that starts there.

    Returns
    -------
    array
        1/mm, in the shape of t; infinite at a cusp.

    See Also
    --------
    nearest, length
    """
    return curve.curvature(t)


@checked
def convexity(curve: AbstractCurve, t: float | ArrayLike) -> Real:
    """Curvature of a closed curve, positive where it is convex from outside the enclosed area.

    It does not depend on the direction of the curve: the profile of a cam that turns counterclockwise runs clockwise.

    Parameters
    ----------
    curve : AbstractCurve
        A closed curve.
    t : float or array_like
        Parameters of any shape, as for `curvature`.

    Returns
    -------
    array
        1/mm, in the shape of t.

    Raises
    ------
    DesignError
        If the curve is open.
    """
    return curve.curvature(t) * float(np.sign(signed_area(curve, 1e-3)))


@checked
def nearest(curve: AbstractCurve, points: complex | ArrayLike) -> tuple[Real, Real]:
    """The point of a curve nearest to each of some points.

    Parameters
    ----------
    curve : AbstractCurve
        The curve.
    points : complex or array_like
        mm, of any shape.

    Returns
    -------
    t, distance : array
        Parameter of the nearest point, and its distance, mm, in the shape of `points`. The distance is accurate to
        1e-12 of the curve's size, unless the curve has a feature smaller than a 48th of its smooth piece. Of several
        equally near points, one is returned.

    See Also
    --------
    curvature, length

    Notes
    -----
    Derived here.

    Examples
    --------
    >>> import geomkin as gk
    >>> t, distance = gk.nearest(gk.plane.Segment(0j, 10 + 0j), 5 + 2j)
    >>> float(t), float(distance)
    (0.5, 2.0)
    """
    z, b = np.asarray(points, dtype=complex), curve.breaks
    grid = np.concatenate([b0 + (b1 - b0) * np.arange(_SAMPLES) / _SAMPLES for b0, b1 in pairwise(b)])
    grid = np.append(grid, b[-1])
    chunks = np.array_split(z.ravel(), max(1, -(-z.size * len(grid) // AT_ONCE)))
    t, distance = (np.concatenate(parts) for parts in zip(*[_nearest(curve, chunk, grid) for chunk in chunks]))
    return t.reshape(z.shape), distance.reshape(z.shape)


def _nearest(curve: AbstractCurve, flat: Complex, grid: Real) -> tuple[Real, Real]:
    """`nearest` for a row of points, from the samples of the curve at `grid`."""
    samples = curve.point(grid)
    distances = np.abs(samples - flat[:, None])
    padded = np.pad(distances, ((0, 0), (1, 1)), constant_values=np.inf)
    minimum = (distances <= padded[:, :-2]) & (distances <= padded[:, 2:])
    # A minimum is lower than its sample by at most the distance to the next one; other minima are ruled out.
    steps = np.pad(np.abs(np.diff(samples)), 1)
    possible = minimum & (distances - np.maximum(steps[:-1], steps[1:]) <= distances.min(axis=1, keepdims=True))
    row, column = np.nonzero(possible)
    low, high = grid[np.maximum(column - 1, 0)], grid[np.minimum(column + 1, len(grid) - 1)]
    parameters = _golden(curve, flat[row], low, high, grid[column])
    distance = np.abs(curve.point(parameters) - flat[row])
    best = np.lexsort((distance, row))[np.searchsorted(row, np.arange(len(flat)))]
    return parameters[best], distance[best]


def _golden(curve: AbstractCurve, z: Complex, low: Real, high: Real, start: Real) -> Real:
    """Minimise the distance inside brackets by golden section, then by bisection.

    Golden section alone gives half the digits, since a distance is flat at its minimum; the bisection of the sign of
    (P - z) . P' gives all of them if the curve is smooth there.
    """
    ratio = (np.sqrt(5) - 1) / 2
    for _ in range(40):
        a, b = high - ratio * (high - low), low + ratio * (high - low)
        left = np.abs(curve.point(a) - z) <= np.abs(curve.point(b) - z)
        low, high = np.where(left, low, a), np.where(left, b, high)
    middle_t = 0.5 * (low + high)
    width = 64 * (high - low)
    first, last = curve.breaks[0], curve.breaks[-1]
    low, high = np.clip(middle_t - width, first, last), np.clip(middle_t + width, first, last)
    for _ in range(50):
        middle = 0.5 * (low + high)
        before = dot(curve.point(middle) - z, curve.velocity(middle)) < 0
        low, high = np.where(before, middle, low), np.where(before, high, middle)
    options = np.stack(
        [start, middle_t, 0.5 * (low + high), np.full_like(middle_t, first), np.full_like(middle_t, last)]
    )
    best = np.abs(curve.point(options) - z).argmin(axis=0)
    nearest: Real = options[best, np.arange(len(best))]
    return nearest


def _integral(curve: AbstractCurve, f: Callable[[Real], Real], accuracy: float) -> float:
    return float(_integrals(curve, lambda t: f(t)[None], accuracy)[0])


def _integrals(curve: AbstractCurve, f: Callable[[Real], Array], accuracy: float) -> Array:
    """Integrals of the rows of f over the curve's domain by Gauss' rule on more and more pieces, to an accuracy."""
    edges = curve.breaks
    before = None
    for _ in range(_DOUBLINGS):
        half = 0.5 * np.diff(edges)
        t = (edges[:-1] + half)[:, None] + half[:, None] * _NODES
        cells = (f(t) * _WEIGHTS).sum(axis=-1) * half
        total: Array = cells.sum(axis=-1)
        if before is not None and (np.abs(total - before) <= max(accuracy, 1e-15) * np.abs(cells).sum(axis=-1)).all():
            return total
        before = total
        edges = np.sort(np.concatenate([edges, 0.5 * (edges[:-1] + edges[1:])]))
    return total


def separation(a: Complex, b: Complex) -> Real:
    """Distance, mm, (...,), between the convex hulls of points a (..., n) and b (..., m); 0 or less if they meet.

    The distance of two convex shapes is the width of the widest strip between them. Its sides are perpendicular to the
    line between two corners, or parallel to an edge, so that trying all pairs of points is exact.
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
    # Coincident points have no direction between them.
    widest: Real = np.where(np.isfinite(strip), strip, -np.inf).max(axis=-1)
    return widest


def _pairs(z: Complex) -> Complex:
    """Differences of all pairs of points."""
    one, two = np.triu_indices(z.shape[-1], 1)
    return z[..., two] - z[..., one]
