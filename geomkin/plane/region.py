"""Areas bounded by polygons: union, difference, offset, overlap, triangles. The only place that loads shapely.

A region is given and returned as loops: complex arrays, starts not repeated, outlines
counterclockwise and holes clockwise.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import shapely

from ..core.errors import DesignError
from .vec import Complex, Mask, Whole, cross, dot, unit, xy

Loops = list[Complex]


def is_simple(loop: Complex) -> bool:
    """Whether a closed polygon neither crosses nor touches itself and encloses something."""
    if len(loop) < 3:
        return False
    return bool(shapely.LinearRing(xy(loop)).is_simple and shapely.Polygon(xy(loop)).area > 0)


def union(loops: Sequence[Complex]) -> list[Loops]:
    """The area covered by any of the given simple polygons, as separate regions, each outline first."""
    return _regions(shapely.union_all([shapely.Polygon(xy(loop)) for loop in loops]))


def without(loops: Loops, others: Sequence[Complex]) -> list[Loops]:
    """What is left of a region where the simple polygons among `others` have been cut away, each outline first."""
    return _regions(_polygon(loops).difference(shapely.union_all([shapely.Polygon(xy(loop)) for loop in others])))


def where(outline: Complex, lines: Sequence[Complex], holds: Callable[[Complex], Mask]) -> list[Loops]:
    """Of a simple polygon that lines cut into pieces those for whose places `holds` is true, joined where they meet.

    lines: of points each, open or ending where they start. holds: of places (n,), one well inside each piece.
    """
    area = shapely.Polygon(xy(outline))
    edges = [shapely.LinearRing(xy(outline)), *(shapely.LineString(xy(line)) for line in lines)]
    pieces = shapely.get_parts(shapely.polygonize(shapely.get_parts(shapely.union_all(edges))))
    inside = shapely.point_on_surface(pieces)
    kept = shapely.contains(area, inside)
    pieces, places = pieces[kept], shapely.get_coordinates(inside[kept]).view(complex)[:, 0]
    return _regions(shapely.union_all(pieces[np.asarray(holds(places), dtype=bool)]))


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


def apart_inside(outer: Complex, inner: Sequence[Complex], distance: float) -> Mask:
    """Of each inner polygon, whether it lies wholly inside the outer one, at least so far, mm, from its boundary."""
    if not inner:
        return np.empty(0, bool)
    area, boundary = shapely.Polygon(xy(outer)), shapely.LinearRing(xy(outer))
    shapes = np.array([shapely.Polygon(xy(loop)) for loop in inner])
    shapely.prepare([area, boundary])
    inside = shapely.contains_properly(area, shapes)
    # The index of the boundary finds which are near, a little too many; the distance itself, without one, tells.
    near = inside & shapely.dwithin(boundary, shapes, distance * (1 + 1e-9))
    inside[near] = shapely.distance(boundary, shapely.get_exterior_ring(shapes[near])) >= distance
    return inside


def overlapping(loops: Sequence[Complex]) -> Whole:
    """All pairs (n, 2) of simple polygons that have an area or a piece of line in common, the smaller index first."""
    shapes = np.array([shapely.Polygon(xy(loop)) for loop in loops], dtype=object)
    one, two = shapely.STRtree(shapes).query(shapes, predicate="intersects")
    one, two = one[one < two], two[one < two]
    common = shapely.length(shapely.intersection(shapes[one], shapes[two])) > 0
    return np.stack([one[common], two[common]], axis=1)


def holds(loops: Loops, boxes: Complex, taken: Sequence[Complex] = ()) -> Mask:
    """Whether a region, its outline first, holds each of the polygons (n, corners), none meeting the lines `taken`."""
    area, shapes = _polygon(loops), shapely.polygons(xy(boxes))
    shapely.prepare(area)
    held: Mask = np.asarray(shapely.contains(area, shapes))
    for line in taken:
        held &= ~shapely.intersects(shapely.LineString(xy(line)), shapes)
    return held


def gap(a: Complex, b: Complex) -> float:
    """Least distance between two polygons' boundaries, mm."""
    return float(shapely.distance(shapely.LinearRing(xy(a)), shapely.LinearRing(xy(b))))


def nearest(loop: Complex) -> Complex:
    """Of each side of a polygon the place that is nearest to the origin."""
    edge = np.roll(loop, -1) - loop
    found: Complex = loop + edge * np.clip(-dot(edge, loop) / np.abs(edge) ** 2, 0, 1)
    return found


def thinned(loop: Complex, tolerance: float) -> Complex:
    """A polygon with fewer corners, nowhere farther than `tolerance`, mm, from what they leave out."""
    return shapely.get_coordinates(shapely.LinearRing(xy(loop)).simplify(tolerance, preserve_topology=False)).view(
        complex
    )[:-1, 0]


def spacing(loops: Sequence[Complex], radii: Sequence[float]) -> float:
    """Least distance, mm, between the boundaries of a plate and its openings; inf where there is but one.

    loops: the outline and what lies in it, apart from each other. One place stands for a circle of its radius about
    it, which is exact; the radii of the others are 0.
    """
    (outline, *holes), (outer, *inner) = loops, radii
    if not holes:
        return np.inf
    shapes = np.array(
        [shapely.Point(z[0].real, z[0].imag) if r else shapely.LinearRing(xy(z)) for z, r in zip(holes, inner)]
    )
    radius = np.array(inner)
    if outer:
        reach = np.array([np.abs(z - outline[0]).max() for z in holes])
        least = float((outer - reach - radius).min())
    else:
        least = float((shapely.distance(shapely.LinearRing(xy(outline)), shapes) - radius).min())
    near = least + 2 * float(radius.max())
    one, two = shapely.STRtree(shapes).query(shapes, predicate="dwithin", distance=near)
    one, two = one[one < two], two[one < two]
    between = shapely.distance(shapes[one], shapes[two]) - radius[one] - radius[two]
    return min(least, float(between.min(initial=np.inf)))


def neck(loops: Sequence[Complex], tried: Sequence[int], within: float) -> float:
    """Least width, mm, of material between two places of one boundary; inf where none is less than `within`.

    A neck is where the boundary faces itself squarely: a step along it from either end makes the way across no
    shorter. So has a bar with parallel sides, and a tapered one has none. loops: material on their left. tried: of
    how many vertices of each, from the first on, necks are sought that begin there.
    """
    # Rounding of directions; larger takes sides for parallel that are not.
    even = 1e-6
    z = np.concatenate(loops)
    loop = np.repeat(np.arange(len(loops)), [len(one) for one in loops])
    start = np.concatenate([[0], np.cumsum([len(one) for one in loops])])[loop]
    count = np.array([len(one) for one in loops])[loop]
    index = np.arange(len(z))
    after, before = start + (index - start + 1) % count, start + (index - start - 1) % count
    ahead = unit(z[after] - z)
    behind = ahead[before]
    tree = shapely.STRtree(np.asarray(shapely.linestrings(np.stack([xy(z), xy(z[after])], axis=1))))
    # From a corner that sticks out of the material no way across is square, beyond what rounding takes for one.
    sought = index[(index - start < np.asarray(tried)[loop]) & (cross(behind, ahead) <= 3 * even)]
    least = within
    # So many at a time that a place's neighbours fit into memory, however far the neck reaches.
    for some in np.array_split(sought, len(sought) // 64 + 1):
        # What is near by its box is enough: how wide each is comes below, and faster than the library tells.
        x, y = z[some].real, z[some].imag
        v, e = tree.query(shapely.box(x - least, y - least, x + least, y + least))
        v = some[v]
        own = (loop[v] == loop[e]) & (v != e) & (v != after[e])
        v, e = v[own], e[own]
        edge = z[after[e]] - z[e]
        share = np.clip(dot(edge, z[v] - z[e]) / np.abs(edge) ** 2, 0, 1)
        foot = z[e] + share * edge
        width = np.abs(foot - z[v])
        across = unit(foot - z[v])
        # Where the foot is an end of its edge, the directions there.
        foot_ahead = np.where(share < 1, ahead[e], ahead[after[e]])
        foot_behind = np.where(share > 0, ahead[e], behind[e])
        square = (dot(across, ahead[v]) <= even) & (dot(across, behind[v]) >= -even)
        square &= (dot(across, foot_ahead) >= -even) & (dot(across, foot_behind) <= even)
        inward = (cross(ahead[v] + behind[v], across) > 0) & (cross(foot_ahead + foot_behind, across) < 0)
        found = np.flatnonzero(square & inward & (width < least))
        for k in found[np.argsort(width[found])]:
            ends = np.array([0.999 * z[v[k]] + 0.001 * foot[k], 0.001 * z[v[k]] + 0.999 * foot[k]])
            # What leaves the material on its way is no neck.
            if not len(tree.query(shapely.LineString(xy(ends)), predicate="intersects")):
                least = float(width[k])
                break
    return least if least < within else np.inf


def triangulate(loops: Loops) -> tuple[Complex, Whole]:
    """Corner points (n,) complex and triangles (m, 3) of a region, counterclockwise, no point added."""
    triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(_polygon(loops)))
    corners = shapely.get_coordinates(triangles).reshape(-1, 4, 2)[:, :3]
    flat = np.ascontiguousarray(corners).view(complex)[..., 0]
    points, index = np.unique(flat.ravel(), return_inverse=True)
    faces = index.reshape(-1, 3)
    edge = points[faces]
    clockwise = cross(edge[:, 1] - edge[:, 0], edge[:, 2] - edge[:, 0]) < 0
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


def _loop(ring: shapely.LinearRing, outer: bool) -> Complex:
    z = shapely.get_coordinates(ring).view(complex)[:-1, 0]
    return z if shapely.is_ccw(ring) == outer else z[::-1]
