"""The lines of a drawing that is read from a file, on their layers, and the problems of the file itself."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from ..core.records import record
from ..plane.vec import Complex
from .outline import Outline, arc_points, circle_points

# Largest file that is read, bytes, and largest number of vertices of one drawing: more would take minutes.
LARGEST, MOST_VERTICES = 50_000_000, 500_000
TOO_MANY = f"it has more than {MOST_VERTICES:,} vertices, those of its arcs as chords included"
# Largest distance from the origin, mm.
FARTHEST = 1e9
# Layers of lines that are engraved, not cut.
MARKED = ("ENGRAVE", "LABEL")


class UnreadableError(Exception):
    """A file that cannot be read; its text is the reason."""


@record(eq=False)
class Line:
    """A line of a drawing as a polygon, mm, with the operation that its layer stands for."""

    outline: Outline
    layer: str


@record(eq=False)
class Drawing:
    """The lines of a drawing, its stamp ("" if there is none), and problems of the file itself, a sentence each."""

    lines: tuple[Line, ...]
    stamp: str = ""
    problems: tuple[str, ...] = ()

    @property
    def cuts(self) -> list[Line]:
        """Lines that are cut."""
        return [line for line in self.lines if line.layer not in MARKED]

    @property
    def marks(self) -> list[Line]:
        """Engraved lines that belong to the parts, without the engraved names of parts."""
        return [line for line in self.lines if line.layer == "ENGRAVE"]


def collected(lines: Iterable[Line]) -> tuple[Line, ...]:
    """All lines; UnreadableError as soon as they have too many vertices."""
    read: list[Line] = []
    vertices = 0
    for line in lines:
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
            raise UnreadableError(f"a coordinate is not a number below {FARTHEST:,.0f} mm")
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
        raise UnreadableError(f"the radius of a circle is not above 0, or it is not within {FARTHEST:,.0f} mm")
    return Outline(circle_points(centre, radius, error), error)
