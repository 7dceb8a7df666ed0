"""Closed curves of a file as polygons with a bound on their error, and the drawings made of them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from ..core.errors import printable
from ..core.records import record
from ..core.units import mm
from ..plane.curve import AbstractCurve
from ..plane.region import Edges, distance_from_segment
from ..plane.vec import Complex, Real, Whole, cross

# Nodes and weights of Gauss's rule for arc lengths.
NODES, WEIGHTS = np.polynomial.legendre.leggauss(8)
# Largest number of halvings of a piece of a curve or of an edge; further ones are below the resolution of the numbers.
HALVINGS = 40
# Relative difference below which two distances count as equal.
EVEN = 1e-6
# Largest relative error of a distance. A smaller one takes long if the shapes are very different.
COARSE = 0.02
# Most pieces of a polygon that are halved at once, and most edges of a chain that one piece may lie along.
MOST_PIECES, LONGEST_CHAIN = 1_000_000, 64


@record(eq=False)
class Outline:
    """A closed or open polygon that approximates a curve.

    points: (n,) complex, mm; a closed polygon does not repeat its start. error: largest distance between the curve and
    the polygon, mm.
    """

    points: Complex
    error: float = 0.0
    closed: bool = True

    @property
    def starts(self) -> Complex:
        """Starts of the edges, mm."""
        return self.points if self.closed else self.points[:-1]

    @property
    def ends(self) -> Complex:
        """Ends of the edges, mm."""
        return np.roll(self.points, -1) if self.closed else self.points[1:]

    @property
    def length(self) -> float:
        """mm."""
        return float(np.abs(self.ends - self.starts).sum())

    @property
    def area(self) -> float:
        """Signed area, mm2; positive if counterclockwise."""
        return float(cross(self.starts - self.points[0], self.ends - self.points[0]).sum()) / 2

    @property
    def centroid(self) -> complex:
        """Centre of the area, mm."""
        a, b = self.starts - self.points[0], self.ends - self.points[0]
        return complex(self.points[0] + (cross(a, b) * (a + b)).sum() / (3 * cross(a, b).sum()))

    def reversed(self) -> Outline:
        """The polygon in the opposite direction."""
        return Outline(self.points[::-1], self.error, self.closed)

    def placed(self, turn: complex, shift: complex) -> Outline:
        """The polygon rotated about the origin by a unit complex number, then shifted, mm."""
        return Outline(self.points * turn + shift, self.error, self.closed)


def outline_of(curve: AbstractCurve, error: float) -> Outline:
    """A polygon whose distance from a curve is at most `error`, mm: a bound, not a value at samples.

    A piece of a curve of length L between two points at the distance c lies within sqrt(L^2 - c^2) / 2 of its chord,
    since it lies in the ellipse about the two points whose axis is L. Lengths are integrals of the speed; if one is
    shorter than its chord, its speed changes too much for the integral, and the piece is halved.
    """
    starts, ends = curve.breaks[:-1], curve.breaks[1:]
    done: list[Real] = []
    for _ in range(HALVINGS):
        middle, half = (starts + ends) / 2, (ends - starts) / 2
        speed = np.abs(curve.velocity(middle[:, None] + half[:, None] * NODES))
        length = half * (speed @ WEIGHTS)
        # Just before a break, since at a break a curve may already be on its next piece.
        chord = np.abs(curve.point(ends) - curve.point(starts))
        bound = np.sqrt(np.abs(length**2 - chord**2)) / 2
        fine = (bound <= error) & (length < 2 * chord + error)
        done.append(starts[fine])
        starts, middle, ends = starts[~fine], middle[~fine], ends[~fine]
        if not len(starts):
            break
        starts, ends = np.concatenate([starts, middle]), np.concatenate([middle, ends])
    t = np.sort(np.concatenate(done))
    points = np.asarray(curve.point(t if curve.closed else np.append(t, curve.breaks[-1])), dtype=complex)
    return Outline(points, error, curve.closed)


def farthest(outline: Outline, edges: Edges, resolution: float) -> tuple[float, complex]:
    """The largest distance of the points of a polygon from a set of edges, mm, and the point with this distance.

    The distance is rounded up by at most `resolution` or COARSE of itself. Pieces of the polygon are halved until the
    upper bound on their distances is that close to the largest distance found. If they become too many, which happens
    only between very different shapes, the upper bound is returned.
    """
    starts, ends, points = outline.starts, outline.ends, outline.points
    nearest, distance = edges.nearest(points)
    first, last = nearest[: len(starts)], np.roll(nearest, -1)[: len(starts)]
    least, place, most = 0.0, complex(points[0]), 0.0
    for _ in range(HALVINGS):
        # The first of equal distances, so that the place is the same on every processor.
        at = int(np.argmax(distance >= (1 - EVEN) * distance.max()))
        if distance[at] > least * (1 + EVEN):
            least, place = float(distance[at]), complex(points[at])
        bound = _bounds(starts, ends, first, last, edges)
        resolution = max(resolution, COARSE * least)
        wide = bound > least + resolution
        most = max(most, float(bound[~wide].max(initial=0.0)))
        starts, ends, first, last = starts[wide], ends[wide], first[wide], last[wide]
        if not len(starts):
            break
        if len(starts) > MOST_PIECES:
            return float(bound.max()), place
        points = (starts + ends) / 2
        nearest, distance = edges.nearest(points)
        starts, ends = np.concatenate([starts, points]), np.concatenate([points, ends])
        first, last = np.concatenate([first, nearest]), np.concatenate([nearest, last])
    return max(least, min(most, least + resolution)), place


def _bounds(starts: Complex, ends: Complex, first: Whole, last: Whole, edges: Edges) -> Real:
    """Bounds on the distance of straight pieces from a set of edges, mm; first, last: edges nearest to their ends.

    The distance to one edge is convex along a piece, hence at most that at its ends. Where a chain of edges leads from
    the first to the last, the piece is divided at the points nearest to the vertices of the chain: between two of them
    it lies along one edge, from which its ends are no farther than from the vertices.
    """
    at_first = np.maximum(edges.distance(starts, first), edges.distance(ends, first))
    at_last = np.maximum(edges.distance(starts, last), edges.distance(ends, last))
    bound: Real = np.minimum(at_first, at_last)
    chain = np.cumsum(np.append(False, edges.starts[1:] != edges.ends[:-1]))
    low, high = np.minimum(first, last), np.maximum(first, last)
    k = np.flatnonzero((high > low) & (high <= low + LONGEST_CHAIN) & (chain[high] == chain[low]))
    along = np.maximum(edges.distance(starts[k], first[k]), edges.distance(ends[k], last[k]))
    for step in range(1, int((high[k] - low[k]).max(initial=0)) + 1):
        vertex = np.minimum(low[k] + step, high[k])
        along = np.maximum(along, distance_from_segment(edges.starts[vertex], starts[k], ends[k]))
    bound[k] = np.minimum(bound[k], along)
    return bound


def deviation(outline: Outline, exact: Outline, resolution: float) -> tuple[float, complex]:
    """The largest distance of each curve's points from the other one, mm, without polygon errors, and its place."""
    there = farthest(outline, Edges(exact.starts, exact.ends), resolution)
    back = farthest(exact, Edges(outline.starts, outline.ends), resolution)
    return larger(there, back)


def larger(one: tuple[float, complex], other: tuple[float, complex]) -> tuple[float, complex]:
    """The larger of two distances, mm, with its place; the first one if they are equal but for rounding."""
    return other if other[0] > one[0] * (1 + EVEN) else one


def arc_points(start: complex, end: complex, bulge: float, error: float) -> Complex:
    """Points of an arc from its start up to, not including, its end, with chords within `error`, mm.

    bulge: tangent of a quarter of the arc's sweep, positive to the left of the direction of travel.
    """
    sweep = 4 * np.arctan(bulge)
    chord = end - start
    centre = (start + end) / 2 + 1j * chord * (1 - bulge**2) / (4 * bulge)
    radius = abs(start - centre)
    # A chord over the angle a is radius (1 - cos(a / 2)) away from its arc.
    widest = 2 * np.arccos(max(1 - error / radius, 0.0)) if radius > 0 else np.pi
    count = max(1, int(np.ceil(abs(sweep) / max(widest, 1e-4))))
    points: Complex = centre + (start - centre) * np.exp(1j * sweep * np.arange(count) / count)
    return points


def circle_points(centre: complex, radius: float, error: float) -> Complex:
    """Points of a circle, counterclockwise, with chords within `error`, mm."""
    east, west = centre + radius, centre - radius
    return np.concatenate([arc_points(east, west, 1.0, error), arc_points(west, east, 1.0, error)])


# Largest file that is read, bytes, and largest number of vertices of one drawing: more would take minutes.
LARGEST, MOST_VERTICES = 50_000_000, 500_000
TOO_MANY = f"it has more than {MOST_VERTICES:,} vertices, those of its arcs as chords included"
# Largest distance from the origin, mm.
FARTHEST = 1e9
# Largest distance between ends of pieces that meet, mm.
MEETING = 1e-6
# Layers of lines that are engraved, not cut.
MARKED = ("ENGRAVE", "LABEL")


class UnreadableError(Exception):
    """A file that cannot be read; its text is the reason."""


@record(eq=False)
class Line:
    """A line of a drawing as a polygon, mm, with the operation that its layer stands for, and the name of its group.

    tabs: lengths of the tabs that it is joined from, in ascending order, mm.
    """

    outline: Outline
    layer: str
    group: str = ""
    tabs: tuple[float, ...] = ()

    @property
    def part(self) -> str:
        """The name of the part that its group stands for; "" if there is none."""
        return self.group.rpartition("-")[0]


@record(eq=False)
class Drawing:
    """The lines of a drawing, its stamp ("" if there is none), and problems of the file itself, a sentence each."""

    lines: tuple[Line, ...]
    stamp: str = ""
    problems: tuple[str, ...] = ()

    def with_layers(self, layers: Mapping[str, str]) -> Drawing:
        """The drawing with the operations that names of layers stand for."""
        lines = tuple(Line(line.outline, layers.get(line.layer, line.layer)) for line in self.lines)
        return Drawing(lines, self.stamp, self.problems)

    @cached_property
    def cuts(self) -> list[Line]:
        """Lines that are cut, those with tabs whole."""
        return _joined([line for line in self.lines if line.layer not in MARKED])

    @property
    def marks(self) -> list[Line]:
        """Engraved lines, the names of parts among them."""
        return [line for line in self.lines if line.layer in MARKED]


def _joined(lines: Sequence[Line]) -> list[Line]:
    """The lines with open ones, which tabs have, joined to closed ones if each begins where one ends."""
    pieces = [line for line in lines if not line.outline.closed]
    if not any(line.layer == "TAB" for line in pieces):
        return list(lines)
    left, starts = list(range(len(pieces))), np.array([line.outline.points[0] for line in pieces])
    whole = [line for line in lines if line.outline.closed]
    while left:
        chain = [left.pop(0)]
        is_closed = False
        while not is_closed:
            following = [chain[0], *left]
            gaps = np.abs(starts[following] - pieces[chain[-1]].outline.points[-1])
            nearest = int(np.argmin(gaps))
            if gaps[nearest] > MEETING:
                break
            is_closed = nearest == 0
            chain += [] if is_closed else [left.pop(nearest - 1)]
        layers = {pieces[k].layer for k in chain} - {"TAB"}
        points = np.concatenate([pieces[k].outline.points[: -1 if is_closed else None] for k in chain])
        outline = Outline(points, max(pieces[k].outline.error for k in chain), is_closed)
        tabs = tuple(sorted(pieces[k].outline.length for k in chain if pieces[k].layer == "TAB"))
        layer = layers.pop() if len(layers) == 1 else "TAB"
        whole.append(Line(outline, layer, pieces[chain[0]].group, tabs))
    return whole


def collected(lines: Iterable[Line]) -> tuple[Line, ...]:
    """All lines; UnreadableError for one of no length, and as soon as they have too many vertices."""
    read: list[Line] = []
    vertices = 0
    for line in lines:
        if len(line.outline.points) < 2:
            raise UnreadableError(f"a line on layer {printable(line.layer, 60)} has no length")
        read.append(line)
        vertices += len(line.outline.points)
        if vertices > MOST_VERTICES:
            raise UnreadableError(TOO_MANY)
    return tuple(read)


@dataclass
class Pen:
    """Collects the points of a line from straight steps and arcs; arcs become chords within `error`, mm."""

    error: float
    points: list[Complex] = field(default_factory=list)
    count: int = 0

    def edge(self, start: complex, end: complex, bulge: float = 0.0) -> None:
        """Add an edge, its start included and its end not; bulge: tangent of a quarter of an arc's sweep."""
        self.add(arc_points(start, end, bulge, self.error) if bulge else np.array([start]))

    def add(self, points: Complex) -> None:
        """Add points."""
        self.points.append(points)
        self.count += len(points)
        if self.count > MOST_VERTICES:
            raise UnreadableError(TOO_MANY)

    def outline(self, closed: bool, end: complex | None = None) -> Outline:
        """The line; an open one ends at `end`."""
        points = np.concatenate([*self.points, *([np.array([end])] if end is not None else [])])
        if not (np.abs(points) < FARTHEST).all():
            raise UnreadableError(f"a coordinate is not a number below {mm(FARTHEST):,.0f}")
        is_distinct = np.append(True, points[1:] != points[:-1])
        is_distinct[-1] &= not (closed and len(points) > 1 and points[-1] == points[0])
        return Outline(points[is_distinct], self.error, closed)


def polyline(vertices: Complex, bulges: list[float], closed: bool, error: float) -> Outline:
    """A polyline of DXF, whose bulges are arcs, as a polygon."""
    pen = Pen(error)
    ends = np.roll(vertices, -1)
    edges = len(vertices) if closed else len(vertices) - 1
    for k in range(edges):
        pen.edge(complex(vertices[k]), complex(ends[k]), bulges[k] if vertices[k] != ends[k] else 0.0)
    return pen.outline(closed, None if closed else complex(vertices[-1]))


def circle(centre: complex, radius: float, error: float) -> Outline:
    """A circle as a polygon."""
    if not (abs(centre) < FARTHEST and 0 < radius < FARTHEST):
        raise UnreadableError(f"the radius of a circle is not above 0, or it is not within {mm(FARTHEST):,.0f}")
    return Outline(circle_points(centre, radius, error), error)
