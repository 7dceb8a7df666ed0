"""Areas bounded by polygons: union, offset, overlap, simplicity, triangles. The only place that loads shapely.

A region is given and returned as loops: complex arrays, starts not repeated, outlines
counterclockwise and holes clockwise.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from ..errors import DesignError
from .vec import Array, xy

Loops = list[Array]


def is_simple(loop: Array) -> bool:
    """Whether a closed polygon neither crosses nor touches itself and encloses something."""
    if len(loop) < 3:
        return False
    return bool(shapely.LinearRing(xy(loop)).is_simple and shapely.Polygon(xy(loop)).area > 0)


def union(loops: Sequence[Array]) -> list[Loops]:
    """The area covered by any of the given simple polygons, as separate regions, each outline first."""
    return _regions(shapely.union_all([shapely.Polygon(xy(loop)) for loop in loops]))


def offset(loops: Loops, distance: float, tolerance: float) -> list[Loops]:
    """A region grown (or, negative, shrunk) by `distance`, mm, with round corners within `tolerance`.

    The result may be several regions, or none when it shrinks away. The tolerance is kept down to a
    ten-thousandth of the distance, below which the library that trims drops detail.
    """
    radius = abs(distance)
    if radius == 0:
        return [loops]
    # Chords over an arc of this radius that stay within the tolerance; the library's own default of 8
    # per quarter is 0.0048 of the radius off, whatever the radius.
    half = 2 * np.arcsin(np.sqrt(min(tolerance / (2 * radius), 0.5)))
    per_quarter = max(2, int(np.ceil(np.pi / 4 / half)))
    return _regions(_polygon(loops).buffer(distance, quad_segs=per_quarter))


def overlap(a: Loops, b: Loops) -> float:
    """Area common to two regions, mm2."""
    return float(_polygon(a).intersection(_polygon(b)).area)


def contains(outer: Array, inner: Array) -> bool:
    """Whether polygon `inner` lies wholly inside polygon `outer` without touching it."""
    return bool(shapely.Polygon(xy(outer)).contains_properly(shapely.Polygon(xy(inner))))


def gap(a: Array, b: Array) -> float:
    """Least distance between two polygons' boundaries, mm."""
    return float(shapely.distance(shapely.LinearRing(xy(a)), shapely.LinearRing(xy(b))))


def triangulate(loops: Loops) -> tuple[Array, Array]:
    """Corner points (n,) complex and triangles (m, 3) of a region, counterclockwise, no point added."""
    triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(_polygon(loops)))
    corners = shapely.get_coordinates(triangles).reshape(-1, 4, 2)[:, :3]
    flat = np.ascontiguousarray(corners).view(complex)[..., 0]
    points, index = np.unique(flat.ravel(), return_inverse=True)
    faces = index.reshape(-1, 3)
    edge = points[faces]
    clockwise = np.imag(np.conj(edge[:, 1] - edge[:, 0]) * (edge[:, 2] - edge[:, 0])) < 0
    faces[clockwise] = faces[clockwise][:, ::-1]
    return points, faces


def _polygon(loops: Loops) -> shapely.Polygon:
    polygon = shapely.Polygon(xy(loops[0]), [xy(hole) for hole in loops[1:]])
    if not polygon.is_valid:
        raise DesignError(
            "outline",
            f"it crosses itself or a hole ({shapely.is_valid_reason(polygon)})",
            "give loops that neither touch nor cross",
        )
    return polygon


def _regions(shape: shapely.Geometry) -> list[Loops]:
    polygons = [p for p in shapely.get_parts(shapely.normalize(shape)) if p.geom_type == "Polygon" and not p.is_empty]
    return [[_loop(ring, outer=k == 0) for k, ring in enumerate([p.exterior, *p.interiors])] for p in polygons]


def _loop(ring: shapely.LinearRing, outer: bool) -> Array:
    z = shapely.get_coordinates(ring).view(complex)[:-1, 0]
    return z if shapely.is_ccw(ring) == outer else z[::-1]
