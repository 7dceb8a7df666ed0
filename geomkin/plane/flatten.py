"""Curves as chords: the fewest points whose chords stay within a distance of the curve."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..errors import DesignError
from .curve import AbstractCurve
from .joined import Ring
from .primitives import Circle, Polyline
from .spread import Judge, cells_of, direction, probes, spread, tops, turns
from .vec import Array

# A tangent that jumps by more than this, rad, is a corner and gets a point of its own. Smaller takes
# rounding for corners and spends points on them; larger lets a chord cut a visible corner.
CORNER = 1e-6
# Where a chord is compared with its curve: the middle matters most, the others see an S, a loop, and a
# curve whose parameter runs unevenly. Fewer let the largest deviation slip between two.
SHARES = np.linspace(0, 1, 11)


def flatten(curve: AbstractCurve, tolerance: float) -> Array:
    """Points (n,) complex on the curve, mm, whose chords are nowhere farther than `tolerance` from it.

    A closed curve does not repeat its start; an open one includes both ends. Every corner is a point.
    All chords get the same error instead of the same length, which takes the least count possible for
    chords between points of the curve, within 3 % + 1 for each stretch between corners (measured on
    involutes and cams; up to 8 % where a stretch has an inflection every twenty chords).
    """
    if not 0 < tolerance < np.inf:
        raise DesignError("tolerance", f"found {tolerance}", "give a distance above 0, in mm")
    if isinstance(curve, Ring):
        one = flatten(curve.piece, tolerance)
        one = one if curve.piece.closed else one[:-1]
        if len(one) * curve.count > 2:
            return (curve.turns[:, None] * one).ravel()
    if isinstance(curve, Polyline):
        return _flatten_polyline(curve, tolerance)
    if isinstance(curve, Circle):
        chords = max(3, int(_chords_of_arc(curve.radius, 2 * np.pi, tolerance)))
        return curve.point(np.linspace(0, 2 * np.pi, chords + 1)[:-1])
    runs = [spread(_chord_judge(curve), run, tolerance, order=2) for run in smooth_runs(curve)]
    if curve.closed and sum(len(r) - 1 for r in runs) < 3:
        # A tolerance as large as the curve would leave no area: keep a triangle.
        runs = [np.linspace(r[0], r[-1], 4) for r in runs]
    t = np.concatenate([r[:-1] for r in runs] + ([] if curve.closed else [runs[-1][-1:]]))
    return curve.point(t)


def smooth_runs(curve: AbstractCurve) -> list[Array]:
    """The breaks, cut into stretches without a corner; a chord may well span a jump of curvature."""
    b = curve.breaks
    jump = np.abs(direction(curve, b[1:-1], after=True) - direction(curve, b[1:-1], after=False))
    corners = np.flatnonzero(~(jump <= CORNER)) + 1
    return [b[i : j + 1] for i, j in zip([0, *corners], [*corners, len(b) - 1])]


def _chord_judge(curve: AbstractCurve) -> Judge:
    def judge(edges: Array) -> tuple[Array, Array]:
        ends = curve.point(edges)
        # A chord across a break is looked at on both sides of it: each side is smooth.
        cells, owner = cells_of(edges, curve.breaks)
        off = _distance(ends[owner, None], ends[owner + 1, None], curve.point(probes(cells, SHARES)))
        first = np.searchsorted(owner, np.arange(len(edges) - 1))
        turn = turns(curve.velocity(probes(cells, SHARES[1:-1])))
        return np.maximum.reduceat(tops(off), first), np.add.reduceat(turn, first)

    return judge


def _distance(a: Array, b: Array, p: Array) -> Array:
    """Distance of points from the segments a-b (not from the lines: a loop may pass an end)."""
    chord = b - a
    length = np.abs(chord)
    w = (p - a) * np.conj(chord) / np.where(length > 0, length, 1)
    beyond = np.where(w.real < 0, w.real, np.maximum(w.real - length, 0))
    return np.abs(beyond + 1j * w.imag)


def _flatten_polyline(curve: Polyline, tolerance: float) -> Array:
    if curve.bulges is None:
        return np.asarray(curve.vertices, dtype=complex)
    starts = curve.breaks[:-1]
    bend = np.abs(curve.curvature(starts))
    sweep = 4 * np.arctan(np.abs(curve.bulges))
    radius = 1 / np.where(bend > 0, bend, 1)
    chords = np.where(bend > 0, _chords_of_arc(radius, sweep, tolerance), 1).astype(int)
    if curve.closed and chords.sum() < 3:
        chords = chords + 1
    t = np.repeat(starts, chords) + np.concatenate([np.arange(n) / n for n in chords.tolist()])
    return curve.point(t if curve.closed else np.append(t, curve.breaks[-1]))


def _chords_of_arc(radius: ArrayLike, sweep: ArrayLike, tolerance: float) -> Array:
    """Least number of equal chords of an arc; none turns by more than a third of a circle."""
    half = 2 * np.arcsin(np.sqrt(np.minimum(tolerance / (2 * np.asarray(radius)), 0.25)))
    return np.maximum(1, np.ceil(sweep / (2 * half) - 1e-9))
