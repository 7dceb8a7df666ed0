"""Flattening: the fewest points of a curve whose chords stay within a distance of it."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from ..core.arguments import checked
from ..core.errors import DesignError
from ..core.fields import rounded_up
from .curve import AbstractCurve, Mirrored, Moved, Reversed
from .joined import Path, PolarArray
from .primitives import Arc, Circle, Polyline, Segment
from .subdivision import (
    CORNER,
    Intervals,
    Judge,
    adaptive_subdivision,
    cells_of,
    direction,
    probes,
    tops,
    towards,
    turns,
)
from .vec import Complex, Mask, Real, Whole

# Positions at which a chord is compared with its curve. The middle matters most; the others detect an S, a loop, and an
# uneven parameter.
SHARES = np.linspace(0, 1, 11)
# Largest number of chords of arcs, which take half a second and half a GB: enough for a circle of 1 m within 1e-10 mm.
MOST_CHORDS = 5_000_000


@checked
def flatten(curve: AbstractCurve, tolerance: float) -> Complex:
    """Points of a curve whose chords are nowhere farther than a tolerance from it.

    Parameters
    ----------
    curve : AbstractCurve
        The curve.
    tolerance : float
        mm; above 0.

    Returns
    -------
    array of complex, shape (n,)
        mm. A closed curve does not repeat its start, which need not be among the points; an open one includes both
        ends. Every corner is a point.

    Raises
    ------
    DesignError
        If the tolerance is not above 0, or so small that it takes millions of chords.

    Notes
    -----
    All chords get the same error instead of the same length. This gives the fewest chords between points of
    the curve, within 3 % + 1 between two corners (measured on involutes and cams; up to 8 % if there is an inflection
    every twenty chords). Of curves made of arcs and straight edges each arc gets the fewest chords, and the edges stay
    unchanged. Derived here.

    Examples
    --------
    >>> import geomkin as gk
    >>> len(gk.flatten(gk.plane.Circle(0j, 10.0), 0.01))
    71
    """
    if not 0 < tolerance < np.inf:
        raise DesignError("tolerance", f"found {tolerance}", "give a distance above 0, in mm", "out-of-range")
    return _points(curve, tolerance, {})


def _points(curve: AbstractCurve, tolerance: float, known: dict[AbstractCurve, Complex]) -> Complex:
    """The points of `flatten`. Congruent pieces are computed once, and arcs by a simpler rule.

    known: the points of earlier curves.
    """
    if curve in known:
        return known[curve]
    match curve:
        case PolarArray():
            one = _end_to_end(curve.piece, tolerance, known)[:-1]
            # Two straight copies would enclose no area.
            if len(one) * curve.count > 2:
                return (curve.turns[:, None] * one).ravel()
        case Moved():
            return curve.pose.place(_points(curve.curve, tolerance, known))
        case Mirrored():
            return -np.conj(_points(curve.curve, tolerance, known))
        case Reversed():
            points = _points(curve.curve, tolerance, known)[::-1]
            return np.roll(points, 1) if curve.closed else points
        case Circle():
            chords = max(3, int(np.ceil(_chords_of_arc(curve.radius, 2 * np.pi, tolerance))))
            return curve.point(np.linspace(0, 2 * np.pi, chords + 1)[:-1])
        case Polyline() if curve.bulges is None:
            return np.asarray(curve.vertices, dtype=complex)
        case _ if edges := _edges_of(curve):
            return _chain_points(curve, *edges, tolerance)
    groups, runs = _between_corners(curve)
    parts = [_end_to_end(group, tolerance, known) for group in groups]
    if runs:
        parts = [curve.point(edges) for edges in adaptive_subdivision(_chord_judge(curve), runs, tolerance, order=2)]
    if curve.closed and sum(len(part) - 1 for part in parts) < 3:
        # With a tolerance as large as the curve nothing would be left: keep a triangle.
        parts = [curve.point(np.linspace(run[0], run[-1], 4)) for run in smooth_runs(curve)]
    known[curve] = np.concatenate([part[:-1] for part in parts] + ([] if curve.closed else [parts[-1][-1:]]))
    return known[curve]


def _end_to_end(curve: AbstractCurve, tolerance: float, known: dict[AbstractCurve, Complex]) -> Complex:
    """The points of `flatten`; for a closed curve with the start repeated at the end."""
    points = _points(curve, tolerance, known)
    return np.append(points, points[0]) if curve.closed else points


def _between_corners(curve: AbstractCurve) -> tuple[list[AbstractCurve], list[Real]]:
    """The pieces of a path between its corners, so that congruent pieces are recognised; otherwise the smooth runs."""
    if not isinstance(curve, Path) or len(curve.pieces) == 1:
        return [], smooth_runs(curve)
    joints = np.arange(1, len(curve.pieces))
    if corners := joints[_is_corner(curve, curve.breaks.searchsorted(joints))].tolist():
        groups = [curve.pieces[i:j] for i, j in pairwise([0, *corners, len(curve.pieces)])]
        return [group[0] if len(group) == 1 else Path(group) for group in groups], []
    return [], [curve.breaks] if len(curve.breaks) == len(joints) + 2 else smooth_runs(curve)


def _edges_of(curve: AbstractCurve) -> tuple[Real, Real] | None:
    """Sweep, rad, and radius, mm, of each edge, 0 and 1 for a straight one; None for curves with other pieces.

    Edge k runs evenly over k <= t <= k + 1.
    """
    pieces = curve.pieces if isinstance(curve, (Path, Polyline)) else (curve,)
    if not all(isinstance(piece, (Arc, Segment)) for piece in pieces):
        return None
    sizes = [(abs(p.sweep), abs(p.start - p.centre)) if isinstance(p, Arc) else (0.0, 1.0) for p in pieces]
    sweep, radius = np.array(sizes).T
    return sweep, radius


def _chords_of_arc(radius: ArrayLike, sweep: ArrayLike, tolerance: float) -> Real:
    """Smallest number of equal chords of an arc, as a fraction; none turns by more than a third of a circle."""
    half = 2 * np.arcsin(np.sqrt(np.minimum(tolerance / (2 * np.asarray(radius)), 0.25)))
    # Reduced by 1e-9 below, so that a tolerance that gives exactly a whole number is not rounded up.
    count: Real = np.asarray(sweep) / (2 * half)
    if (total := float(np.sum(count))) > MOST_CHORDS:
        # The count is inversely proportional to the root of the tolerance.
        enough = rounded_up(tolerance * (total / MOST_CHORDS) ** 2, 4)
        remedy = f"give at least {enough} mm"
        raise DesignError(
            "tolerance", f"found {tolerance:g} mm, which takes {total:,.0f} chords", remedy, "too-much-work", enough
        )
    return count - 1e-9


def _chain_points(curve: AbstractCurve, sweep: Real, radius: Real, tolerance: float) -> Complex:
    """Points whose chords keep the tolerance, the end of an open curve included.

    Straight edges stay unchanged, since they may guide or carry another part; a chord that saved a point by extending
    into the next arc would shift the edge.
    """
    is_arc, edge = sweep > 0, np.arange(len(sweep), dtype=float)
    chords = np.where(is_arc, np.ceil(_chords_of_arc(radius, sweep, tolerance)), 1).astype(int)
    if len(edge) > 1 and not is_arc.all():
        smooth = np.abs(direction(curve, edge, True) - np.roll(direction(curve, edge + 1, False), 1)) <= CORNER
        smooth[0] &= curve.closed
        # Between two straight edges in line no point is needed.
        chords[smooth & ~is_arc & ~np.roll(is_arc, 1)] = 0
    if curve.closed and chords.sum() < 3:
        # With a tolerance as large as the curve no area would be left.
        chords = chords + 1
    first = np.repeat(np.cumsum(chords) - chords, chords)
    t = np.repeat(edge, chords) + (np.arange(len(first)) - first) / np.repeat(chords, chords)
    return curve.point(t if curve.closed else np.append(t, edge[-1] + 1))


def smooth_runs(curve: AbstractCurve) -> list[Real]:
    """The breaks, divided into runs without a corner; a chord may span a jump of curvature."""
    b = curve.breaks
    if len(b) == 2:
        # Without inner breaks no tangent is computed, which takes long for a centrode.
        return [b]
    inner = np.arange(1, len(b) - 1)
    corners = inner[_is_corner(curve, inner)].tolist()
    return [b[i : j + 1] for i, j in pairwise([0, *corners, len(b) - 1])]


def _is_corner(curve: AbstractCurve, inner: Whole) -> Mask:
    """Whether each of these inner breaks, given by index, is a corner."""
    b = curve.breaks
    neighbours = (inner[:, None] + np.array([-1, 1])).ravel()
    tangents = towards(curve, b[inner].repeat(2), b[neighbours])
    return ~(np.abs(tangents[1::2] - tangents[::2]) <= CORNER)


def _chord_judge(curve: AbstractCurve) -> Judge:
    def judge(intervals: Intervals) -> tuple[Real, Real]:
        # A chord across a break is compared on both sides of it, each of which is smooth.
        low, high, owner = cells_of(intervals, curve.breaks)
        inside = curve.point(probes(low, high, SHARES))
        if len(low) == len(intervals.low):
            off = _distance(inside[:, :1], inside[:, -1:], inside)
            return tops(off, inside, intervals.first), turns(inside[:, 1:] - inside[:, :-1])
        each = np.arange(len(intervals.low))
        first = owner.searchsorted(each)
        start, end = inside[first, 0], inside[owner.searchsorted(each, side="right") - 1, -1]
        off = _distance(start[owner, None], end[owner, None], inside)
        return np.maximum.reduceat(tops(off, inside, first[intervals.first]), first), np.add.reduceat(
            turns(inside[:, 1:] - inside[:, :-1]), first
        )

    return judge


def _distance(a: Complex, b: Complex, p: Complex) -> Real:
    """Distance of points from the segments a-b (not from the lines, since a loop may extend beyond an end)."""
    chord = b - a
    length = np.abs(chord)
    w = (p - a) * (np.conj(chord) / np.where(length > 0, length, 1))
    return np.hypot(np.maximum(np.maximum(-w.real, w.real - length), 0), w.imag)
