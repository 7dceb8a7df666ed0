"""The thinnest wall of a part: whether heat and handling leave it standing."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import lru_cache

import numpy as np

from ..plane import region as region
from ..plane.curve import AbstractCurve, extent
from ..plane.flatten import flatten
from ..plane.joined import PolarArray
from ..plane.primitives import Circle, slot
from ..plane.vec import Complex, cross
from .check import Check
from .part import Part

# Least wall as a share of the sheet's thickness. Cutting services ask for 0.5 to 1.5 between holes and to an edge. Less
# than the least of them no one cuts; more fails walls that some would.
OF_THICKNESS = 0.5
# Least wall in kerfs; derived here. The zone that a beam heats on either side is about as wide as its cut. In a wall of
# two kerfs two such zones meet, and nothing of the sheet's own strength is left.
OF_KERF = 2.0
# Walls are found to this share of the limit; finer takes longer and tells nothing.
ACCURACY = 1e-4
# ... but within these shares of the part's size. Finer gives a million chords, coarser loses the shape.
FINEST, COARSEST = 2e-6, 1e-4
# Necks are told up to this many limits wide. More takes longer and says nothing of whether the part holds.
NECKS = 2.0
# Plates whose necks are kept, as many as a recipe has whose other sizes are varied. More fill the memory; fewer, and
# plates that stay the same are looked at anew each time.
KEPT = 16


def least_wall(thickness: float, kerf: float) -> float:
    """The thinnest wall that should be cut, mm, in a sheet of a thickness by a beam of a kerf."""
    return max(OF_THICKNESS * thickness, OF_KERF * kerf)


def thinnest_wall(part: Part, limit: float) -> float:
    """Width, mm, of the thinnest wall of a part; inf where it has none.

    A wall stands between two boundaries, hole and edge or hole and hole; also between two places of one boundary
    that face each other squarely, such as a neck or the sides of a bar, if it is less than two limits wide. What
    tapers to an edge or a point is no wall. Found on the exact curves, to a ten-thousandth of the limit (two
    millionths of the part's size at least, a ten-thousandth at most), and rounded to that.
    """
    size = extent(part.outline)
    accuracy = float(np.clip(ACCURACY * limit, FINEST * size, COARSEST * size))
    curves = (part.outline, *part.holes)
    loops = [_loop(curve, accuracy / 2, 1 if k == 0 else -1, limit) for k, curve in enumerate(curves)]
    round_ones = [isinstance(curve, Circle) for curve in curves]
    places = [np.array([curve.centre]) if isinstance(curve, Circle) else z for curve, z in zip(curves, loops)]
    found = region.spacing(places, [curve.radius if isinstance(curve, Circle) else 0.0 for curve in curves])
    if (thin := min(found, NECKS * limit)) > 0:
        # Of equal copies one is tried. A round hole faces itself only across its opening, where there is no material.
        tried = [
            0 if is_round and k else len(z) // curve.count if isinstance(curve, PolarArray) else len(z)
            for k, (curve, z, is_round) in enumerate(zip(curves, loops, round_ones))
        ]
        found = min(found, _neck(tuple(loop.tobytes() for loop in loops), tuple(tried), thin))
    # Half of the last digit is no less than the accuracy, so that a round number comes out as one.
    digits = -int(np.ceil(np.log10(2 * accuracy)))
    return round(found, digits)


@lru_cache(maxsize=KEPT)
def _neck(loops: tuple[bytes, ...], tried: tuple[int, ...], within: float) -> float:
    """The least neck, kept: it takes longest of all, and of a plate that is looked at again it is the same."""
    return region.neck([np.frombuffer(loop, dtype=complex) for loop in loops], tried, within)


def _loop(curve: AbstractCurve, tolerance: float, sense: int, longest: float) -> Complex:
    """Chords of a boundary with the material on their left; sense: +1 for an outline, -1 for a hole.

    Edges longer than `longest` are halved: the ends of two equal ones that face each other see only corners.
    """
    z = flatten(curve, tolerance / 2)
    if not isinstance(curve, PolarArray):
        # Outlines given point by point may have far more than their form asks for; a hole no larger than the tolerance
        # would be thinned away.
        fewer = region.thinned(z, tolerance / 2)
        z = fewer if len(fewer) > 2 else z
    z = z[z != np.roll(z, 1)]
    z = z if cross(z - z[0], np.roll(z, -1) - z[0]).sum() * sense > 0 else z[::-1]
    following = np.roll(z, -1)
    long = np.flatnonzero(np.abs(following - z) > longest)
    return np.insert(z, long + 1, (z + following)[long] / 2)


def thinnest_walls(parts: Iterable[Part], kerf: float) -> dict[str, float]:
    """The same of each part, mm, by its name, with the limit that is asked of it.

    Of what is twisted it is the least that any slice may have, as what turns stands otherwise over what does not.
    """
    return {
        part.name: min(thinnest_wall(one, least_wall(part.thickness, kerf)) for one in _sections(part))
        for part in parts
    }


def _sections(part: Part) -> tuple[Part, ...]:
    """What no slice of a part has thinner walls than: its own section where all of it moves alike."""
    if part.twist is None or not part.holes:
        return (part,)
    if part.twist.shift:
        # As seen by the outline, which slides along x, a round hole is a slot. Holes stand as they do from each other.
        ways = [(c.centre, c.centre - part.twist.shift, c.radius) for c in part.holes if isinstance(c, Circle)]
        return (part, *(replace(part, holes=(slot(*way),), hole_names=(), fits=()) for way in ways))
    sides = region.nearest(flatten(part.outline, FINEST * extent(part.outline)))
    inner = replace(part, outline=Circle(0j, float(np.abs(sides).min())))
    return replace(part, holes=(), hole_names=(), fits=()), inner


def wall_checks(parts: Iterable[Part], kerf: float, walls: Mapping[str, float] | None = None) -> tuple[Check, ...]:
    """The thinnest wall of each part that has one and is cut from a sheet, as what is twisted cannot be.

    walls: of the parts, where they are known already.
    """
    checks = []
    flat = [part for part in parts if part.twist is None]
    walls = thinnest_walls(flat, kerf) if walls is None else walls
    for part in flat:
        limit, wall = least_wall(part.thickness, kerf), walls[part.name]
        if wall < np.inf:
            advice = "make openings smaller, move them apart or from the edge, or cut a thinner sheet"
            name = f"thinnest wall of the {part.name}"
            checks.append(Check(f"wall_{part.name}", name, wall, "at least", limit, "mm", advice))
    return tuple(checks)
