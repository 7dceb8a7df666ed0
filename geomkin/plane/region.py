"""Areas bounded by polygons: union, difference, offset, overlap, triangles; and the outline at a distance from another.

Only this module imports shapely. A region is given and returned as loops: complex arrays, starts not repeated, outlines
counterclockwise and holes clockwise.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import shapely

from ..core.errors import DesignError
from .curve import AbstractCurve, Mirrored, Moved, Offset, Reversed, SubCurve
from .flatten import CORNER, direction, smooth_runs
from .joined import Path, PolarArray
from .primitives import Arc, Polyline, Segment
from .vec import Complex, Mask, Real, Whole, cross, dot, unit, xy

Loops = list[Complex]


def is_simple(loop: Complex) -> bool:
    """Whether a closed polygon encloses an area and neither crosses nor touches itself."""
    if len(loop) < 3:
        return False
    return bool(shapely.LinearRing(xy(loop)).is_simple and shapely.Polygon(xy(loop)).area > 0)


def union(loops: Sequence[Complex]) -> list[Loops]:
    """The area covered by any of the given simple polygons, as separate regions, each outline first."""
    return _regions(shapely.union_all([shapely.Polygon(xy(loop)) for loop in loops]))


def without(loops: Loops, others: Sequence[Complex]) -> list[Loops]:
    """A region less some simple polygons, as separate regions, each outline first."""
    return _regions(_polygon(loops).difference(shapely.union_all([shapely.Polygon(xy(loop)) for loop in others])))


def where(outline: Complex, lines: Sequence[Complex], holds: Callable[[Complex], Mask]) -> list[Loops]:
    """A simple polygon is cut by lines; the pieces for which `holds` is true are returned, merged if they touch.

    lines: points of each, open or ending where they start. holds: takes points (n,), one well inside each piece.
    """
    area = shapely.Polygon(xy(outline))
    edges = [shapely.LinearRing(xy(outline)), *(shapely.LineString(xy(line)) for line in lines)]
    pieces = shapely.get_parts(shapely.polygonize(shapely.get_parts(shapely.union_all(edges))))
    inside = shapely.point_on_surface(pieces)
    within = shapely.contains(area, inside)
    pieces, places = pieces[within], shapely.get_coordinates(inside[within]).view(complex)[:, 0]
    return _regions(shapely.union_all(pieces[np.asarray(holds(places), dtype=bool)]))


def offset(loops: Loops, distance: float, tolerance: float) -> list[Loops]:
    """A region grown, or shrunk if negative, by `distance`, mm, with round corners within `tolerance`.

    The result may be several regions, or none if it shrinks away. The tolerance is at least a ten-thousandth of the
    distance, below which shapely drops detail.
    """
    radius = abs(distance)
    if radius == 0:
        return [loops]
    # Number of chords of an arc of this radius that stay within the tolerance; with shapely's default of 8 per quarter
    # the error is 0.0048 of the radius.
    half = 2 * np.arcsin(np.sqrt(min(tolerance / (2 * radius), 0.5)))
    per_quarter = max(2, int(np.ceil(np.pi / 4 / half)))
    return _regions(_polygon(loops).buffer(distance, quad_segs=per_quarter))


def overlap(a: Loops, b: Loops) -> float:
    """Area common to two regions, mm2."""
    return float(_polygon(a).intersection(_polygon(b)).area)


def apart_inside(outer: Complex, inner: Sequence[Complex], distance: float) -> Mask:
    """For each inner polygon, whether it is inside the outer one, at least `distance`, mm, from its boundary."""
    if not inner:
        return np.empty(0, bool)
    area, boundary = shapely.Polygon(xy(outer)), shapely.LinearRing(xy(outer))
    shapes = np.array([shapely.Polygon(xy(loop)) for loop in inner])
    shapely.prepare([area, boundary])
    inside = shapely.contains_properly(area, shapes)
    # The index finds slightly too many near ones; the exact distance decides.
    near = inside & shapely.dwithin(boundary, shapes, distance * (1 + 1e-9))
    inside[near] = shapely.distance(boundary, shapely.get_exterior_ring(shapes[near])) >= distance
    return inside


def overlapping(loops: Sequence[Complex]) -> Whole:
    """All pairs (n, 2) of simple polygons that have an area or a part of a line in common, the smaller index first."""
    shapes = np.array([shapely.Polygon(xy(loop)) for loop in loops], dtype=object)
    one, two = shapely.STRtree(shapes).query(shapes, predicate="intersects")
    one, two = one[one < two], two[one < two]
    common = shapely.length(shapely.intersection(shapes[one], shapes[two])) > 0
    return np.stack([one[common], two[common]], axis=1)


def holds(loops: Loops, boxes: Complex, taken: Sequence[Complex] = ()) -> Mask:
    """Whether each polygon (n, corners) is inside a region, its outline first, and meets no line of `taken`."""
    area, shapes = _polygon(loops), shapely.polygons(xy(boxes))
    shapely.prepare(area)
    contained: Mask = np.asarray(shapely.contains(area, shapes))
    for line in taken:
        contained &= ~shapely.intersects(shapely.LineString(xy(line)), shapes)
    return contained


def distances(loops: Loops, points: Complex) -> Real:
    """Distance of each point (n,) from a region, its outline first, mm; 0 inside, nan for a point that is nan."""
    area = _polygon(loops)
    shapely.prepare(area)
    return np.asarray(shapely.distance(area, shapely.points(xy(points))))


def gap(a: Complex, b: Complex) -> float:
    """Smallest distance between the boundaries of two polygons, mm."""
    return float(shapely.distance(shapely.LinearRing(xy(a)), shapely.LinearRing(xy(b))))


def apart(a: Loops, b: Loops) -> float:
    """Smallest distance of two regions, mm; 0 if they meet."""
    return float(shapely.distance(_polygon(a), _polygon(b)))


def nearest_to_origin(loop: Complex) -> Complex:
    """The point of each side of a polygon nearest to the origin."""
    edge = np.roll(loop, -1) - loop
    points: Complex = loop + edge * np.clip(-dot(edge, loop) / np.abs(edge) ** 2, 0, 1)
    return points


def containers(points: Complex, loops: Sequence[Complex]) -> list[list[int]]:
    """For each point (n,) the indices of the polygons that it is inside, the smallest first."""
    shapes = np.array([shapely.Polygon(xy(loop)) for loop in loops], dtype=object)
    inside, around = shapely.STRtree(shapes).query(shapely.points(xy(points)), predicate="within")
    areas = shapely.area(shapes)
    return [sorted(around[inside == k].tolist(), key=lambda j: float(areas[j])) for k in range(len(points))]


class Edges:
    """Straight edges with an index that finds the nearest one of each point."""

    def __init__(self, starts: Complex, ends: Complex):
        self.starts, self.ends = starts, ends
        self._tree = shapely.STRtree(np.asarray(shapely.linestrings(np.stack([xy(starts), xy(ends)], axis=1))))

    def nearest(self, points: Complex) -> tuple[Whole, Real]:
        """For each point (n,) the index of the nearest edge, and the distance, mm."""
        pairs, distance = self._tree.query_nearest(shapely.points(xy(points)), return_distance=True, all_matches=False)
        return pairs[1], distance

    def distance(self, points: Complex, which: Whole) -> Real:
        """Distance of each point from the edge of a given index, mm."""
        return distance_from_segment(points, self.starts[which], self.ends[which])


def distance_from_segment(points: Complex, starts: Complex, ends: Complex) -> Real:
    """Distance of each point from the straight segment of the same index, mm."""
    edge = ends - starts
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.nan_to_num(np.clip(dot(edge, points - starts) / np.abs(edge) ** 2, 0, 1))
    distance: Real = np.abs(starts + share * edge - points)
    return distance


def thinned(loop: Complex, tolerance: float) -> Complex:
    """A polygon without some of its corners, all of which are within `tolerance`, mm, of the result."""
    return shapely.get_coordinates(shapely.LinearRing(xy(loop)).simplify(tolerance, preserve_topology=False)).view(
        complex
    )[:-1, 0]


def spacing(loops: Sequence[Complex], radii: Sequence[float]) -> float:
    """Smallest distance, mm, between the boundaries of a plate and its openings; inf if there is only one.

    loops: the outline and its openings, not touching each other. A single point represents a circle of its radius,
    exactly; the radii of the others are 0.
    """
    (outline, *holes), (outer, *inner) = loops, radii
    if not holes:
        return np.inf
    shapes = np.array(
        [shapely.Point(z[0].real, z[0].imag) if r else shapely.LinearRing(xy(z)) for z, r in zip(holes, inner)]
    )
    radius = np.array(inner)
    if outer:
        extents = np.array([np.abs(z - outline[0]).max() for z in holes])
        least = float((outer - extents - radius).min())
    else:
        least = float((shapely.distance(shapely.LinearRing(xy(outline)), shapes) - radius).min())
    distance = least + 2 * float(radius.max())
    one, two = shapely.STRtree(shapes).query(shapes, predicate="dwithin", distance=distance)
    one, two = one[one < two], two[one < two]
    between = shapely.distance(shapes[one], shapes[two]) - radius[one] - radius[two]
    return min(least, float(between.min(initial=np.inf)))


def neck(loops: Sequence[Complex], tried: Sequence[int], within: float) -> float:
    """Smallest width, mm, of the material between two points of one boundary; inf if it is not less than `within`.

    A neck is a pair of boundary points whose connecting line is perpendicular to the boundary at both ends, or is not
    made shorter by a step along it. A bar with parallel sides has one, a tapered bar has none. loops: material on their
    left. tried: number of vertices of each loop, from the first on, at which a neck may begin.
    """
    # Rounding of directions. With a larger value sides that are not parallel would count as parallel.
    even = 1e-6
    z = np.concatenate(loops)
    loop = np.repeat(np.arange(len(loops)), [len(points) for points in loops])
    start = np.concatenate([[0], np.cumsum([len(points) for points in loops])])[loop]
    count = np.array([len(points) for points in loops])[loop]
    index = np.arange(len(z))
    after, before = start + (index - start + 1) % count, start + (index - start - 1) % count
    forward = unit(z[after] - z)
    backward = forward[before]
    tree = shapely.STRtree(np.asarray(shapely.linestrings(np.stack([xy(z), xy(z[after])], axis=1))))
    # From a convex corner no line across the material is perpendicular to the boundary.
    starts = index[(index - start < np.asarray(tried)[loop]) & (cross(backward, forward) <= 3 * even)]
    least = within
    # In batches, so that the neighbours of all points fit into memory.
    for some in np.array_split(starts, len(starts) // 64 + 1):
        # A query by boxes suffices: the widths are computed below, faster than by shapely.
        x, y = z[some].real, z[some].imag
        v, e = tree.query(shapely.box(x - least, y - least, x + least, y + least))
        v = some[v]
        same_loop = (loop[v] == loop[e]) & (v != e) & (v != after[e])
        v, e = v[same_loop], e[same_loop]
        edge = z[after[e]] - z[e]
        share = np.clip(dot(edge, z[v] - z[e]) / np.abs(edge) ** 2, 0, 1)
        foot = z[e] + share * edge
        width = np.abs(foot - z[v])
        across = unit(foot - z[v])
        # Directions at the foot; if it is an end of its edge, those of both edges.
        foot_ahead = np.where(share < 1, forward[e], forward[after[e]])
        foot_behind = np.where(share > 0, forward[e], backward[e])
        square = (dot(across, forward[v]) <= even) & (dot(across, backward[v]) >= -even)
        square &= (dot(across, foot_ahead) >= -even) & (dot(across, foot_behind) <= even)
        inward = (cross(forward[v] + backward[v], across) > 0) & (cross(foot_ahead + foot_behind, across) < 0)
        candidates = np.flatnonzero(square & inward & (width < least))
        for k in candidates[np.argsort(width[candidates])]:
            ends = np.array([0.999 * z[v[k]] + 0.001 * foot[k], 0.001 * z[v[k]] + 0.999 * foot[k]])
            # A line that leaves the material is not a neck.
            if not len(tree.query(shapely.LineString(xy(ends)), predicate="intersects")):
                least = float(width[k])
                break
    return least if least < within else np.inf


def triangulate(loops: Loops) -> tuple[Complex, Whole]:
    """Corner points (n,) complex and triangles (m, 3) of a region, counterclockwise, without additional points."""
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
        problem = f"it crosses itself or a hole ({shapely.is_valid_reason(polygon)})"
        raise DesignError("outline", problem, "give loops that neither touch nor cross")
    return polygon


def _regions(shape: shapely.Geometry) -> list[Loops]:
    polygons = [p for p in shapely.get_parts(shapely.normalize(shape)) if p.geom_type == "Polygon" and not p.is_empty]
    return [[_loop(ring, outer=k == 0) for k, ring in enumerate([p.exterior, *p.interiors])] for p in polygons]


def _loop(ring: shapely.LinearRing, outer: bool) -> Complex:
    z = shapely.get_coordinates(ring).view(complex)[:-1, 0]
    return z if shapely.is_ccw(ring) == outer else z[::-1]


# Newton steps to the intersection of two curves. Four suffice if neighbours overlap by far less than their length.
STEPS = 20
Known = dict[tuple[AbstractCurve, float], AbstractCurve]


def parallel(curve: AbstractCurve, distance: float) -> AbstractCurve | None:
    """A closed curve moved by `distance`, mm, to its right, with an arc around every corner that opens.

    At a corner that closes both sides end at their intersection; None if one of them ends before. A distance larger
    than a radius of curvature, or half the width of a gap, gives loops, which are not trimmed.
    """
    if distance == 0:
        return curve
    if isinstance(curve, Moved):
        inner = parallel(curve.curve, distance)
        return Moved(inner, curve.pose) if inner else None
    if isinstance(curve, PolarArray):
        rotation = complex(curve.turns[1 % curve.count])
        pieces = _pieces(curve.piece, distance, first_after=rotation)
        return PolarArray(Path(tuple(pieces)), curve.count) if pieces else None
    if len(runs := smooth_runs(curve)) == 1 and _turn(curve, curve.breaks[-1], curve.breaks[0]) == 0:
        offset = _offset_run(curve, runs[0], distance, {})
        return Path(tuple(offset)) if len(offset) > 1 else Offset(curve, distance)
    pieces = _pieces(curve, distance, first_after=1 + 0j)
    return Path(tuple(pieces)) if pieces else None


def _pieces(curve: AbstractCurve, distance: float, first_after: complex) -> list[AbstractCurve] | None:
    """Offset runs and corner arcs, including the arc at the end; the start follows, rotated by `first_after`.

    None if a side of a corner that closes would be trimmed as a whole.
    """
    runs = smooth_runs(curve)
    pieces: list[AbstractCurve] = []
    closing: list[tuple[int, complex]] = []
    known: Known = {}
    for k, run in enumerate(runs):
        pieces.extend(_offset_run(curve, run, distance, known))
        following = runs[(k + 1) % len(runs)][0]
        turned = first_after if k == len(runs) - 1 else 1 + 0j
        turn = _turn(curve, run[-1], following, turned)
        if turn * distance < 0:
            closing.append((len(pieces) - 1, turned))
        elif turn:
            corner = complex(curve.point(run[-1]))
            start = complex(pieces[-1].point(pieces[-1].breaks[-1]))
            pieces.append(Arc(corner, start, turn))
    return _trimmed(pieces, closing)


def _trimmed(pieces: list[AbstractCurve], closing: list[tuple[int, complex]]) -> list[AbstractCurve] | None:
    """The pieces, with those before and after a corner that closes cut at their intersection.

    closing: index of the piece before each such corner, and the rotation of the piece after it.
    """
    spans = [[float(p.breaks[0]), float(p.breaks[-1])] for p in pieces]
    for before, turned in closing:
        after = (before + 1) % len(pieces)
        spans[before][1], spans[after][0] = _intersection(pieces[before], pieces[after], turned)
    # If there is no intersection (nan), or nothing is left, the comparison is False.
    if not all(low < high for low, high in spans):
        return None
    touched = {k for before, _ in closing for k in (before, (before + 1) % len(pieces))}
    return [_part(piece, *spans[k]) if k in touched else piece for k, piece in enumerate(pieces)]


def _intersection(one: AbstractCurve, two: AbstractCurve, turned: complex) -> tuple[float, float]:
    """Parameters at which the end of one curve meets the start of another, turned about the origin; nan if none."""
    (first, last), (start, end) = one.breaks[[0, -1]], two.breaks[[0, -1]]
    s, t, rounding = last, start, 1e-13 * float(np.abs(one.point(one.breaks)).max())
    for _ in range(STEPS):
        gap = turned * two.point(t) - one.point(s)
        if abs(gap) <= rounding:
            return float(s), float(t)
        u, v = one.velocity(s), turned * two.velocity(t)
        with np.errstate(divide="ignore", invalid="ignore"):
            s, t = s + cross(gap, v) / cross(u, v), t + cross(gap, u) / cross(u, v)
        if not (first <= s <= last and start <= t <= end):
            break
    return np.nan, np.nan


def _part(curve: AbstractCurve, low: float, high: float) -> AbstractCurve:
    """The part of a curve between two parameters; of an arc or a segment again an arc or a segment."""
    match curve:
        case Segment():
            return Segment(complex(curve.point(low)), complex(curve.point(high)))
        case Arc():
            return Arc(curve.centre, complex(curve.point(low)), curve.sweep * (high - low))
    inner = curve.breaks[(curve.breaks > low) & (curve.breaks < high)]
    return SubCurve(curve, np.array([low, *inner, high]))


def _offset_run(curve: AbstractCurve, run: Real, distance: float, known: Known) -> list[AbstractCurve]:
    """A run without a corner moved to its right; piece by piece if it consists of whole pieces."""
    first, last = int(run[0]), int(run[-1])
    if isinstance(curve, (Path, Polyline)) and (run[0], run[-1]) == (first, last):
        return [_offset_piece(piece, distance, known) for piece in curve.pieces[first:last]]
    return [Offset(SubCurve(curve, run), distance)]


def _offset_piece(curve: AbstractCurve, distance: float, known: Known) -> AbstractCurve:
    """A curve moved to its right in its own form: arcs remain arcs, and congruent pieces remain congruent.

    known: the results for earlier curves.
    """
    match curve:
        case Reversed():
            return Reversed(_offset_piece(curve.curve, -distance, known))
        case Mirrored():
            return Mirrored(_offset_piece(curve.curve, -distance, known))
        case Segment() if curve.start != curve.end:
            shift = -1j * distance * (curve.end - curve.start) / abs(curve.end - curve.start)
            return Segment(curve.start + shift, curve.end + shift)
        case Arc() if (grown := 1 + np.sign(curve.sweep) * distance / abs(curve.start - curve.centre)) > 0:
            return Arc(curve.centre, curve.centre + (curve.start - curve.centre) * float(grown), curve.sweep)
    return known.setdefault((curve, distance), Offset(curve, distance))


def _turn(curve: AbstractCurve, before: float, after: float, turned: complex = 1 + 0j) -> float:
    """Rotation at a corner, rad, from the end of one run to the start of the next; 0 if it is smooth."""
    incoming = direction(curve, np.array([before]), after=False)[0]
    outgoing = direction(curve, np.array([after]), after=True)[0] * turned
    turn = float(np.angle(outgoing * incoming.conjugate()))
    return turn if abs(turn) > CORNER else 0.0
