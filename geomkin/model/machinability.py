"""What a beam or round cutter cannot make: thin walls, narrow gaps, sharp inner corners; and the relief of corners."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from functools import lru_cache

import numpy as np

from ..core.errors import DesignError
from ..core.fields import last_fit, rounded_down, rounded_up
from ..core.records import record
from ..core.units import mm
from ..plane import region as region
from ..plane.curve import AbstractCurve, extent
from ..plane.flatten import flatten
from ..plane.joined import PolarArray
from ..plane.measure import signed_area
from ..plane.primitives import Circle, Polyline, slot
from ..plane.region import is_simple
from ..plane.vec import Complex, Real, cross, dot, unit
from .check import Check
from .part import Part

# Least wall as a share of the sheet's thickness. Cutting services require 0.5 to 1.5 between holes and to an edge. No
# service cuts thinner walls; a larger share fails walls that some would cut.
OF_THICKNESS = 0.5
# Least wall in kerfs; derived here. A beam heats a zone about as wide as its cut on either side. In a wall of two kerfs
# two such zones meet, and no unheated material is left.
OF_KERF = 2.0
# Accuracy of a wall as a share of the limit. A finer one takes longer without benefit.
ACCURACY = 1e-3
# Limits of that accuracy as shares of the part's size. Finer gives a million chords, coarser loses the shape.
FINEST, COARSEST = 2e-6, 1e-4
# Largest width of a reported neck, in limits. Wider necks take longer to find and are strong enough.
NECKS = 2.0
# Advice about a wall if it is unknown which sizes make it.
ADVICE = "give the part smaller openings, more width or a smaller thickness"
# Number of cached plates. With fewer, a recipe whose sizes are varied measures its unchanged plates again; more need
# memory.
CACHED = 16


def least_wall(thickness: float, kerf: float) -> float:
    """The thinnest wall that should be cut, mm, for a thickness of the sheet and a kerf, mm."""
    return max(OF_THICKNESS * thickness, OF_KERF * kerf)


def thinnest_wall(part: Part, limit: float) -> float:
    """Width of the thinnest wall of a part.

    Parameters
    ----------
    part : Part
        The part; only its own section counts.
    limit : float
        Least width that is required, mm.

    Returns
    -------
    float
        Width, mm; inf if the part has no wall. It is exact to 1e-3 of the limit (at least 2e-6 and at most 1e-4 of the
        part's size), and rounded to that.

    Notes
    -----
    A wall is between two boundaries, hole and edge or hole and hole. It is also between two opposite parallel stretches
    of one boundary, such as a neck or the sides of a bar, if less than two limits wide. Material that tapers to an edge
    or a point is no wall.
    """
    size = extent(part.outline)
    accuracy = float(np.clip(ACCURACY * limit, FINEST * size, COARSEST * size))
    curves = (part.outline, *part.holes)
    loops = [_loop(curve, accuracy / 2, 1 if k == 0 else -1, limit) for k, curve in enumerate(curves)]
    are_round = [isinstance(curve, Circle) for curve in curves]
    points = [np.array([curve.centre]) if isinstance(curve, Circle) else z for curve, z in zip(curves, loops)]
    wall = region.spacing(points, [curve.radius if isinstance(curve, Circle) else 0.0 for curve in curves])
    if (widest := min(wall, NECKS * limit)) > 0:
        # One of several equal copies is enough. A round hole has no neck, since no material is between its sides.
        counts = [
            0 if is_round and k else len(z) // curve.count if isinstance(curve, PolarArray) else len(z)
            for k, (curve, z, is_round) in enumerate(zip(curves, loops, are_round))
        ]
        wall = min(wall, _neck(tuple(loop.tobytes() for loop in loops), tuple(counts), widest))
    # Half of the last digit is at least the accuracy, so that round numbers are exact.
    digits = -int(np.ceil(np.log10(2 * accuracy)))
    return round(wall, digits)


@lru_cache(maxsize=CACHED)
def _neck(loops: tuple[bytes, ...], counts: tuple[int, ...], widest: float) -> float:
    """The narrowest neck. It is cached, as this search takes longest and plates are often measured again."""
    return region.neck([np.frombuffer(loop, dtype=complex) for loop in loops], counts, widest)


def _loop(curve: AbstractCurve, tolerance: float, sense: int, longest: float) -> Complex:
    """Chords of a boundary with the material on their left; sense: +1 for an outline, -1 for a hole.

    Edges longer than `longest` are halved, as the end of an edge may be opposite a corner only.
    """
    z = flatten(curve, tolerance / 2)
    if not isinstance(curve, PolarArray):
        # Outlines given by points may have far more points than necessary; a hole no larger than the tolerance would
        # vanish.
        fewer = region.thinned(z, tolerance / 2)
        z = fewer if len(fewer) > 2 else z
    z = z[z != np.roll(z, 1)]
    z = z if cross(z - z[0], np.roll(z, -1) - z[0]).sum() * sense > 0 else z[::-1]
    following = np.roll(z, -1)
    long = np.flatnonzero(np.abs(following - z) > longest)
    return np.insert(z, long + 1, (z + following)[long] / 2)


def thinnest_walls(parts: Iterable[Part], kerf: float) -> dict[str, float]:
    """The thinnest wall of each part by its name.

    Parameters
    ----------
    parts : iterable of Part
        The parts.
    kerf : float
        Width of the cut, mm, which with the thickness gives the limit.

    Returns
    -------
    dict of str to float
        Width, mm. For a twisted part it is a lower bound for all slices.
    """
    return {
        part.name: min(thinnest_wall(section, least_wall(part.thickness, kerf)) for section in _sections(part))
        for part in parts
    }


def _sections(part: Part) -> tuple[Part, ...]:
    """Sections whose thinnest wall is a lower bound for all slices; the part itself if its whole section moves."""
    if part.twist is None or not part.holes:
        return (part,)
    if part.twist.shift:
        # Relative to the outline, which moves along x, a round hole sweeps a slot. Holes keep their distances.
        slots = [slot(c.centre, c.centre - part.twist.shift, c.radius) for c in part.holes if isinstance(c, Circle)]
        return (part, *(replace(part, holes=(hole,), hole_names=(), fits=()) for hole in slots))
    sides = region.nearest_to_origin(flatten(part.outline, FINEST * extent(part.outline)))
    inner = replace(part, outline=Circle(0j, float(np.abs(sides).min())))
    return replace(part, holes=(), hole_names=(), fits=()), inner


def wall_checks(
    parts: Iterable[Part],
    kerf: float,
    walls: Mapping[str, float] | None = None,
    advice: Callable[[Part], str] = lambda part: ADVICE,
) -> tuple[Check, ...]:
    """Checks of the thinnest wall of each flat part; twisted parts are not cut from a sheet.

    Parameters
    ----------
    parts : iterable of Part
        The parts.
    kerf : float
        Width of the cut, mm.
    walls : mapping of str to float, optional
        The result of `thinnest_walls`, if it is known already.
    advice : callable, optional
        Returns what to change if the wall of a part is too thin.

    Returns
    -------
    tuple of Check
        One for each part with a wall.
    """
    checks = []
    flat = [part for part in parts if part.twist is None]
    walls = thinnest_walls(flat, kerf) if walls is None else walls
    for part in flat:
        limit, wall = least_wall(part.thickness, kerf), walls[part.name]
        if wall < np.inf:
            name = f"thinnest wall of the {part.name}"
            checks.append(Check(f"wall_{part.name}", name, wall, "at least", limit, "mm", advice(part)))
    return tuple(checks)


# Error of the loops that are compared, as a share of the tolerance. A smaller one takes longer and shows the same.
FINENESS = 0.25
# Sharpest inner corner whose rounding by the beam is accepted, deg: that of keyways and slots. A beam of radius r stays
# r (1 / sin(half of the corner) - 1) off the corner, 0.41 r here; in a sharper one it leaves more.
SHARPEST_DEG = 90.0


def beam_checks(parts: Iterable[Part], kerf: float, tolerance: float) -> tuple[Check, ...]:
    """Checks of the depth that a beam does not reach in the inner corners and gaps of flat parts.

    Parameters
    ----------
    parts : iterable of Part
        The parts; twisted ones are not cut from a sheet.
    kerf : float
        Width of the cut, mm.
    tolerance : float
        Depth that is always allowed, mm.

    Returns
    -------
    tuple of Check
        One for each part of which the beam leaves more than the tolerance. Its limit is the tolerance, plus, at a
        corner, what the beam leaves in any corner of this angle, or in a right-angled one if it is sharper.

    Notes
    -----
    The cut part is the closing of the designed one by a disk as wide as the kerf. The depth at a point of the boundary
    is its distance from the boundary of the cut part; it is the largest one of each stretch of the boundary that the
    beam does not reach.
    """
    checks = (beam_check(part, kerf, tolerance) for part in parts if part.twist is None and kerf > 0)
    return tuple(check for check in checks if check is not None)


def beam_check(part: Part, kerf: float, tolerance: float) -> Check | None:
    """The check of one part; None if the beam leaves no more than the tolerance, or the part cannot be cut at all."""
    error, radius = FINENESS * tolerance, kerf / 2
    loops = [_with_material_left(flatten(c, error), k == 0) for k, c in enumerate((part.outline, *part.holes))]
    try:
        (grown,) = region.offset(loops, radius, error)
        (cut,) = region.offset(grown, -radius, error)
    except (DesignError, ValueError):
        # Loops that cross are refused where they are cut.
        return None
    edges = region.Edges(np.concatenate(cut), np.concatenate([np.roll(loop, -1) for loop in cut]))
    found: list[tuple[float, float]] = []
    for loop in loops:
        depth = edges.nearest(loop)[1]
        rounding = radius * (1 / np.cos(np.minimum(_closing(loop), np.pi - np.radians(SHARPEST_DEG)) / 2) - 1)
        for stretch in _stretches(depth > tolerance):
            found.append((float(depth[stretch].max()), tolerance + float(rounding[stretch].max())))
    if not found:
        return None
    left, allowed = max(found, key=lambda pair: (round((pair[0] - pair[1]) / error), pair))
    return Check(
        f"beam_{part.name}",
        f"depth of a corner or gap of the {part.name} that the beam or cutter does not reach",
        round(left, 1 - int(np.floor(np.log10(tolerance)))),
        "at most",
        float(rounded_up(allowed, 3)),
        "mm",
        "cut with a narrower kerf or cutter, or make gaps wider and inner corners rounder than half of it",
    )


def _with_material_left(loop: Complex, is_outline: bool) -> Complex:
    loop = loop[loop != np.roll(loop, 1)]
    return loop if (cross(loop - loop[0], np.roll(loop, -1) - loop[0]).sum() > 0) == is_outline else loop[::-1]


def _closing(loop: Complex) -> Real:
    """Angle by which each inner corner of a loop turns to the right, rad; 0 at outer corners."""
    edge = np.roll(loop, -1) - loop
    return np.maximum(-np.angle(edge / np.roll(edge, 1)), 0)


def _stretches(chosen: np.ndarray[tuple[int], np.dtype[np.bool_]]) -> list[np.ndarray[tuple[int], np.dtype[np.intp]]]:
    """Indices of the runs of chosen points of a closed loop."""
    if chosen.all() or not chosen.any():
        return [np.flatnonzero(chosen)] if chosen.any() else []
    first = int(np.flatnonzero(~chosen)[0])
    indices = (np.arange(len(chosen)) + first) % len(chosen)
    taken = chosen[indices]
    runs = np.split(indices, np.flatnonzero(np.diff(taken)) + 1)
    return [run for run in runs if chosen[run[0]]]


# Least rotation of the outline of a hole at a corner, rad. A smaller one leaves nothing that a part would touch.
CORNER = 0.02
# Share of an edge that a relief leaves. With less, a key or a flat would not bear on it.
KEPT = 0.5
# Radius of a relief over that of the cutter. With less, programs that offset chords find no room for the cutter in it.
WIDER = 1.04


@record(eq=False)
class _Edge:
    """An edge of a hole from `start` to `end`: straight, or an arc of a sweep, rad, about its centre."""

    start: complex
    end: complex
    sweep: float

    @property
    def centre(self) -> complex:
        return self.start + (self.end - self.start) / complex(1 - np.exp(1j * self.sweep))

    def direction(self, share: float) -> complex:
        """Direction along the edge, share: 0 at its start and 1 at its end."""
        return complex(unit(self.end - self.start) * np.exp(1j * self.sweep * (share - 0.5)))

    def second_meeting(self, centre: complex, corner: complex) -> complex:
        """The other point at which a circle through a corner of the edge meets it."""
        if self.sweep == 0:
            along = self.direction(0)
            return corner + 2 * float(dot(centre - corner, along)) * along
        axis = unit(centre - self.centre)
        return self.centre + complex(axis**2 * np.conj(corner - self.centre))

    def share(self, point: complex) -> float:
        """Position of a point on the edge, 0 at its start and 1 at its end."""
        if self.sweep == 0:
            return abs(point - self.start) / abs(self.end - self.start)
        middle = (self.start - self.centre) * np.exp(0.5j * self.sweep)
        return 0.5 + float(np.angle((point - self.centre) / middle)) / self.sweep

    def bulge(self, start: complex, end: complex) -> float:
        """Bulge of the part of the edge between two points on it."""
        return float(np.tan((self.share(end) - self.share(start)) * self.sweep / 4)) if self.sweep else 0.0


def relieved(part: Part, cutter: float) -> Part:
    """The part with relief in the corners of its bores with flats or keyways, where a cutter would leave material.

    Parameters
    ----------
    part : Part
        The part. Only holes whose fit has a flat or a keyway change, since only in these corners a part must seat.
    cutter : float
        Diameter of the cutter, mm; 0 for none.

    Returns
    -------
    Part
        Each relief is an arc, hardly wider than the cutter, through the corner: along the bisector, a dogbone, or
        along one edge, a T-bone, if a dogbone would remove more than half of an edge.

    Raises
    ------
    DesignError
        If the cutter is so wide that the relief of a corner leaves less than half of both its edges.
    """
    if cutter == 0:
        return part
    seats = [fit is not None and bool(fit.flat or any(fit.keyway)) for fit in part.fits]
    holes = [
        _relieved_hole(hole, cutter, part.name) if seat else hole
        for hole, seat in zip(part.holes, [*seats, *[False] * len(part.holes)])
    ]
    return replace(part, holes=tuple(holes))


def _relieved_hole(hole: AbstractCurve, cutter: float, name: str) -> AbstractCurve:
    if not isinstance(hole, Polyline):
        return hole
    if (shape := _with_relief(hole, WIDER * cutter / 2)) is not None:
        return shape
    most = last_fit(lambda diameter: _with_relief(hole, WIDER * diameter / 2) is not None, 0.0, cutter)
    raise DesignError(
        "cutter",
        f"found {mm(cutter):g}, too wide for the corners of a hole of the {name}: their relief would remove the edges "
        "on which its shaft or key bears",
        f"give at most {mm(most):down4}, or 0 for corners without relief",
        value=float(rounded_down(most, 4)),
    )


def _with_relief(hole: Polyline, radius: float) -> Polyline | None:
    """The hole with relieved corners, counterclockwise; None if the cutter is too wide."""
    z = np.asarray(hole.vertices, dtype=complex)
    bulges = np.zeros(len(z)) if hole.bulges is None else np.asarray(hole.bulges, dtype=float)
    if signed_area(hole) < 0:
        z, bulges = z[::-1], -np.roll(bulges[::-1], -1)
    edges = [
        _Edge(a, b, 4 * float(np.arctan(bulge))) for a, b, bulge in zip(z.tolist(), np.roll(z, -1).tolist(), bulges)
    ]
    corners = [k for k, edge in enumerate(edges) if np.angle(edge.direction(0) / edges[k - 1].direction(1)) > CORNER]
    centres: dict[int, complex] = {}
    for k in corners:
        neighbours = (k - 1) % len(edges) in corners, (k + 1) % len(edges) in corners
        if (centre := _relief_centre(edges[k - 1], edges[k], neighbours, radius)) is None:
            return None
        centres[k] = centre
    # The points at which each edge begins and ends.
    starts = [
        edges[k].second_meeting(centres[k], edges[k].start) if k in centres else edges[k].start
        for k in range(len(edges))
    ]
    ends = [
        edge.second_meeting(centres[after], edge.end) if (after := (k + 1) % len(edges)) in centres else edge.end
        for k, edge in enumerate(edges)
    ]
    vertices: list[complex] = []
    arcs: list[float] = []
    joined: set[int] = set()
    for k, edge in enumerate(edges):
        after = (k + 1) % len(edges)
        if k in centres and after in centres and edge.share(starts[k]) + 1e-9 >= edge.share(ends[k]):
            across = centres[after] - centres[k]
            if edge.sweep or float(dot(across, edge.direction(0))) < 0:
                return None
            # Both reliefs meet outside the edge, of which nothing remains.
            height = float(np.sqrt(max(radius**2 - abs(across) ** 2 / 4, 0.0)))
            starts[k] = ends[k] = (centres[k] + centres[after]) / 2 - 1j * edge.direction(0) * height
            joined.add(k)
    for k, edge in enumerate(edges):
        if k in centres:
            sweep = float(np.angle((starts[k] - centres[k]) / (ends[k - 1] - centres[k]))) % (2 * np.pi)
            vertices.append(ends[k - 1])
            arcs.append(float(np.tan(sweep / 4)))
        if k not in joined:
            vertices.append(starts[k])
            arcs.append(edge.bulge(starts[k], ends[k]))
    shape = Polyline(np.array(vertices), np.array(arcs))
    # Reliefs that cross other edges are as wide as the hole.
    return shape if is_simple(flatten(shape, radius / 100)) else None


def _relief_centre(before: _Edge, after: _Edge, shared: tuple[bool, bool], radius: float) -> complex | None:
    """Centre of the relief at the corner between two edges; None if each choice leaves too little of both.

    shared: whether the other end of each edge is relieved too.
    """
    corner, arriving, leaving = after.start, before.direction(1), after.direction(0)
    allowed = [(1 - KEPT) / (2 if is_shared else 1) for is_shared in shared]
    bisector = complex(unit(leaving - arriving))
    taken = _taken(before, after, corner + radius * bisector)
    if all(share <= most for share, most in zip(taken, allowed)):
        return corner + radius * bisector
    # Tangent to one edge, which it keeps: to one that no other corner shortens, or of which a dogbone takes more.
    keeps_first = (not shared[0], taken[0] / allowed[0]) > (not shared[1], taken[1] / allowed[1])
    centre = corner + radius * 1j * (arriving if keeps_first else leaving)
    most = 1.0 if not shared[not keeps_first] else 1 - KEPT
    return centre if _taken(before, after, centre)[int(keeps_first)] <= most else None


def _taken(before: _Edge, after: _Edge, centre: complex) -> tuple[float, float]:
    """Shares of both edges that a relief about a centre removes."""
    corner = after.start
    return 1 - before.share(before.second_meeting(centre, corner)), after.share(after.second_meeting(centre, corner))
