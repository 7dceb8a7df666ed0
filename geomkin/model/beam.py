"""Inner corners and gaps into which a cutting beam does not fit."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ..core.errors import DesignError
from ..core.fields import rounded_up
from ..plane import region as region
from ..plane.flatten import flatten
from ..plane.vec import Complex, Real, cross
from .check import Check
from .part import Part

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
        f"depth of a corner or gap of the {part.name} that the beam does not reach",
        round(left, 1 - int(np.floor(np.log10(tolerance)))),
        "at most",
        float(rounded_up(allowed, 3)),
        "mm",
        "cut with a narrower kerf, or make gaps wider and inner corners rounder than half the kerf",
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
