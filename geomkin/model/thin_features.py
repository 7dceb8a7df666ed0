"""Where a part is too thin to cut or too narrow for the beam: its thinnest wall, its inner corners and gaps."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from functools import lru_cache

import numpy as np

from ..core.errors import DesignError
from ..core.fields import rounded_up
from ..plane import region as region
from ..plane.curve import AbstractCurve, extent
from ..plane.flatten import flatten
from ..plane.joined import PolarArray
from ..plane.primitives import Circle, slot
from ..plane.vec import Complex, Real, cross
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
