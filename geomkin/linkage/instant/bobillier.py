"""Bobillier's constructions: the centrode tangent from two cranks, and one crank from the tangent and the other.

The angle from the centrode tangent to one crank equals the angle from the other crank to the collineation axis,
the line from the instant centre to the crossing of coupler and frame lines. With parallel cranks, whose instant
centre is at infinity, tangent and axis are parallel to them and the theorem speaks of distances instead of angles.

Inside, points and lines are homogeneous, (..., 3), about the first pin: a point (x, y, 1) or, at infinity,
(x, y, 0); a line (l, m, n) where l x + m y + n = 0. The line through two points and the point on two lines are both
their vector product, at infinity too.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ...arguments import Places, checked
from ...brief import one_line
from ...plane.vec import Complex, Real, dot, unit
from .centres import InstantCentre, settled
from .curvature import PathCurvature
from .inflection import ROUNDING


@dataclass(frozen=True, eq=False)
class Bobillier:
    """What the construction draws, any shape: points mm, directions unit complex, either way along their line.

    instant_centre: where the cranks cross. crossing: where coupler and frame lines cross; nan where parallel.
    axis, tangent: directions of collineation axis and centrode tangent. axis_foot, tangent_foot: the points of these
    lines nearest to the first pin; both lines pass through the instant centre. All but the instant centre are nan
    where the cranks are parallel and coupler and frame too: all paths are then curved alike.
    """

    instant_centre: InstantCentre
    crossing: Complex
    axis: Complex
    axis_foot: Complex
    tangent: Complex
    tangent_foot: Complex

    __repr__ = one_line


@checked
def bobillier(one: PathCurvature, two: PathCurvature) -> Bobillier:
    """From the paths of two points, as two cranks or sliders give them, to the centrode tangent of their body.

    nan where cranks and body lie in one line, which leaves the motion open. Bobillier's theorem: Dijksman, Motion
    Geometry of Mechanisms, 1976; with what is at infinity, derived here.
    """
    base = np.asarray(one.position)
    pins = _point(one.position - base), _point(two.position - base)
    cranks = _line(one.tangent, one.position - base), _line(two.tangent, two.position - base)
    extent = np.abs(two.position - base)
    centre = _settled(np.cross(*cranks), extent)
    crossing = _settled(np.cross(np.cross(*pins), np.cross(_centre(one, base), _centre(two, base))), extent)
    axis = np.cross(centre, crossing)
    tangent = _mirrored(axis, cranks, pins)
    return Bobillier(
        _placed(centre, base), _placed(crossing, base).position, *_drawn(axis, base), *_drawn(tangent, base)
    )


@checked
def bobillier_path(one: PathCurvature, tangent_foot: Places, tangent: Places, position: Places) -> PathCurvature:
    """From one crank and the centrode tangent line to the path of the body's point at `position`, mm; any shape.

    tangent_foot: a point of the line, mm; tangent: its direction. The instant centre is where the line meets the
    crank. nan where `position` is in line with the crank: there the Euler-Savary equation gives the answer; and where
    the tangent lies along the crank, one end of which is the instant centre then: that says nothing of other points.
    Source as of `bobillier`.
    """
    base = np.asarray(one.position)
    away = np.asarray(position) - base
    pins = _point(one.position - base), _point(away)
    line = _line(1j * np.asarray(tangent), np.asarray(tangent_foot) - base)
    crank = _line(one.tangent, one.position - base)
    extent = np.abs(away)
    centre = _settled(_crossing(crank, line, extent), extent)
    ray: Real = np.cross(centre, pins[1])
    with np.errstate(invalid="ignore"):
        ray = ray / np.hypot(ray[..., 0], ray[..., 1])[..., None]
    ray = np.where(np.isnan(_crossing(crank, ray, extent)), np.nan, ray)
    axis = _mirrored(line, (crank, ray), pins)
    crossing = np.cross(axis, np.cross(*pins))
    end = _settled(np.cross(np.cross(crossing, _centre(one, base)), ray), extent)
    run, weight = ray[..., 0] + 1j * ray[..., 1], end[..., 2]
    with np.errstate(divide="ignore", invalid="ignore"):
        curvature = weight / dot(1j * run, end[..., 0] + 1j * end[..., 1] - away * weight)
    return PathCurvature(base + away, run, curvature)


def _point(place: Complex, weight: ArrayLike = 1.0) -> Real:
    return np.stack(np.broadcast_arrays(place.real, place.imag, weight), axis=-1)


def _line(normal: Complex, place: Complex) -> Real:
    """The line through a place, square to the unit vector `normal`."""
    return _point(np.asarray(normal), -dot(normal, place))


def _centre(path: PathCurvature, base: Complex) -> Real:
    """The path's centre of curvature: at infinity where it is straight."""
    return _point((path.position - base) * path.curvature + 1j * np.asarray(path.tangent), path.curvature)


def _crossing(one: Real, two: Real, extent: Real) -> Real:
    """Where two lines of unit normal cross; nan where they are one line within rounding."""
    point = np.cross(one, two)
    apart = np.abs(point[..., 2]) * extent + np.hypot(point[..., 0], point[..., 1])
    return np.where((apart <= ROUNDING * extent)[..., None], np.nan, point)


def _settled(point: Real, extent: Real) -> Real:
    weight = settled(point[..., 2], np.hypot(point[..., 0], point[..., 1]), extent)
    return np.concatenate([point[..., :2], weight[..., None]], axis=-1)


def _mirrored(line: Real, rays: tuple[Real, Real], pins: tuple[Real, Real]) -> Real:
    """A line through the crossing of two rays, mirrored in the line that halves the angle between the rays.

    With a and b the rays, of unit normal, the mirror takes x a + y b to y a + x b; x and y follow from where the
    line passes a point of each ray. So it holds for parallel rays too.
    """
    (a, b), extent = rays, np.hypot(*np.moveaxis((pins[1] - pins[0])[..., :2], -1, 0))
    on_a, on_b = _beside(a, b, pins[0], extent), _beside(b, a, pins[1], extent)
    first = (_dot(line, on_a) * _dot(a, on_b))[..., None] * a
    second = (_dot(line, on_b) * _dot(b, on_a))[..., None] * b
    # The line at infinity has the normal 0: what two equal terms leave of it is rounding.
    normal = first[..., :2] + second[..., :2]
    rounding = ROUNDING * (np.abs(first[..., :2]).max(axis=-1) + np.abs(second[..., :2]).max(axis=-1))
    normal = np.where((np.abs(normal).max(axis=-1) <= rounding)[..., None], 0.0, normal)
    return np.concatenate([normal, first[..., 2:] + second[..., 2:]], axis=-1)


def _beside(ray: Real, other: Real, pin: Real, extent: Real) -> Real:
    """A point of a ray well away from the other ray: the pin, or one `extent` farther."""
    along = np.stack([-ray[..., 1], ray[..., 0], 0 * ray[..., 2]], axis=-1)
    farther = pin + extent[..., None] * along
    near = np.abs(_dot(other, pin)) < np.abs(_dot(other, farther))
    return np.where(near[..., None], farther, pin)


def _dot(line: Real, point: Real) -> Real:
    product: Real = np.sum(line * point, axis=-1)
    return product


def _placed(point: Real, base: Complex) -> InstantCentre:
    return InstantCentre(base, point[..., 0] + 1j * point[..., 1], point[..., 2])


def _drawn(line: Real, base: Complex) -> tuple[Complex, Complex]:
    """Direction of a line and its point nearest to `base`."""
    normal = line[..., 0] + 1j * line[..., 1]
    with np.errstate(divide="ignore", invalid="ignore"):
        return 1j * unit(normal), base - unit(normal) * (line[..., 2] / np.abs(normal))
