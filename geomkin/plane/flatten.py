"""Curves as chords: the fewest points whose chords stay within a distance of the curve."""

from __future__ import annotations

import numpy as np

from ..arguments import checked
from ..errors import DesignError
from .arc_chain import chain_points, chords_of_arc, edges_of
from .curve import AbstractCurve
from .derived import Mirrored, Moved, Reversed
from .joined import Path, Ring
from .primitives import Circle, Polyline
from .spread import CORNER, Judge, cells_of, direction, probes, spread, tops, turns
from .vec import Array

# Where a chord is compared with its curve: the middle matters most, the others see an S, a loop, and a
# curve whose parameter runs unevenly. Fewer let the largest deviation slip between two.
SHARES = np.linspace(0, 1, 11)


@checked
def flatten(curve: AbstractCurve, tolerance: float) -> Array:
    """Points (n,) complex on the curve, mm, whose chords are nowhere farther than `tolerance` from it.

    A closed curve does not repeat its start, which need not be among the points; an open one includes both ends.
    Every corner is a point. All chords get the same error instead of the same length, which takes the least count
    possible for chords between points of the curve, within 3 % + 1 for each stretch between corners (measured on
    involutes and cams; up to 8 % where a stretch has an inflection every twenty chords). Of curves made of arcs and
    straight edges alone each arc takes the least count, and the edges stay where they are.
    """
    if not 0 < tolerance < np.inf:
        raise DesignError("tolerance", f"found {tolerance}", "give a distance above 0, in mm")
    return _points(curve, tolerance, {})


def _points(curve: AbstractCurve, tolerance: float, known: dict[AbstractCurve, Array]) -> Array:
    """What `flatten` gives. Congruent pieces are worked out once, and arcs by their own rule.

    known: the points of curves met before.
    """
    if curve in known:
        return known[curve]
    match curve:
        case Ring():
            one = _end_to_end(curve.piece, tolerance, known)[:-1]
            # Two straight copies would leave no area.
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
            chords = max(3, int(np.ceil(chords_of_arc(curve.radius, 2 * np.pi, tolerance))))
            return curve.point(np.linspace(0, 2 * np.pi, chords + 1)[:-1])
        case Polyline() if curve.bulges is None:
            return np.asarray(curve.vertices, dtype=complex)
        case _ if edges := edges_of(curve):
            return chain_points(curve, *edges, tolerance)
    runs = smooth_runs(curve)
    if len(groups := _between_corners(curve, runs)) > 1:
        parts = [_end_to_end(group, tolerance, known) for group in groups]
    else:
        parts = [curve.point(spread(_chord_judge(curve), run, tolerance, order=2)) for run in runs]
    if curve.closed and sum(len(part) - 1 for part in parts) < 3:
        # A tolerance as large as the curve would leave no area: keep a triangle.
        parts = [curve.point(np.linspace(run[0], run[-1], 4)) for run in runs]
    known[curve] = np.concatenate([part[:-1] for part in parts] + ([] if curve.closed else [parts[-1][-1:]]))
    return known[curve]


def _end_to_end(curve: AbstractCurve, tolerance: float, known: dict[AbstractCurve, Array]) -> Array:
    """The same with the end, where that is the start too."""
    points = _points(curve, tolerance, known)
    return np.append(points, points[0]) if curve.closed else points


def _between_corners(curve: AbstractCurve, runs: list[Array]) -> list[AbstractCurve]:
    """A path cut where its pieces meet in corners, so that what is known of a piece's form can be used."""
    if not isinstance(curve, Path):
        return [curve]
    cuts = [0, *(int(run[-1]) for run in runs if run[-1] == int(run[-1]))]
    groups = [curve.pieces[i:j] for i, j in zip(cuts, cuts[1:])]
    return [group[0] if len(group) == 1 else Path(group) for group in groups]


def smooth_runs(curve: AbstractCurve) -> list[Array]:
    """The breaks, cut into stretches without a corner; a chord may well span a jump of curvature."""
    b = curve.breaks
    if not (inner := len(b) - 2):
        return [b]
    after, before = direction(curve, np.tile(b[1:-1], 2), np.repeat([True, False], inner)).reshape(2, inner)
    corners = (np.flatnonzero(~(np.abs(after - before) <= CORNER)) + 1).tolist()
    return [b[i : j + 1] for i, j in zip([0, *corners], [*corners, inner + 1])]


def _chord_judge(curve: AbstractCurve) -> Judge:
    def judge(edges: Array) -> tuple[Array, Array]:
        # A chord across a break is looked at on both sides of it: each side is smooth.
        cells, owner = cells_of(edges, curve.breaks)
        inside = curve.point(probes(cells, SHARES))
        first = owner.searchsorted(np.arange(len(edges)))
        start, end = inside[first[:-1], 0], inside[first[1:] - 1, -1]
        off = _distance(start[owner, None], end[owner, None], inside)
        return np.maximum.reduceat(tops(off, inside), first[:-1]), np.add.reduceat(
            turns(inside[:, 1:] - inside[:, :-1]), first[:-1]
        )

    return judge


def _distance(a: Array, b: Array, p: Array) -> Array:
    """Distance of points from the segments a-b (not from the lines: a loop may pass an end)."""
    chord = b - a
    length = np.abs(chord)
    w = (p - a) * (np.conj(chord) / np.where(length > 0, length, 1))
    return np.hypot(np.maximum(np.maximum(-w.real, w.real - length), 0), w.imag)
