"""Curves as chords: the fewest points whose chords stay within a distance of the curve."""

from __future__ import annotations

import numpy as np

from ..errors import DesignError
from .curve import AbstractCurve
from .joined import Ring
from .primitives import Circle, Polyline
from .spread import direction, probes, spread, turns
from .vec import Array

# A tangent that jumps by more than this, rad, is a corner and gets a point of its own. Smaller takes
# rounding for corners and spends points on them; larger lets a chord cut a visible corner.
CORNER = 1e-6
# Where a chord is compared with its curve. The middle one matters most; the others see an S, a loop,
# and a curve whose parameter runs unevenly.
SHARES = np.linspace(0, 1, 10)[1:-1]


def flatten(curve: AbstractCurve, tolerance: float) -> Array:
    """Points (n,) complex on the curve, mm, whose chords are nowhere farther than `tolerance` from it.

    A closed curve does not repeat its start; an open one includes both ends. Every corner is a point.
    The count is the least possible for chords between points of the curve, within 3 % + 1 for each
    stretch between corners: all chords get the same error instead of the same length.
    """
    if not 0 < tolerance < np.inf:
        raise DesignError("tolerance", f"found {tolerance}", "give a distance above 0, in mm")
    if isinstance(curve, Ring):
        one = flatten(curve.piece, tolerance)[:-1]
        return (curve.turns[:, None] * one).ravel()
    if isinstance(curve, Polyline) and curve.bulges is None:
        return np.asarray(curve.vertices, dtype=complex)
    if isinstance(curve, Circle):
        return curve.point(np.linspace(0, 2 * np.pi, _chords_of_circle(curve.radius, tolerance) + 1)[:-1])
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


def _chord_judge(curve: AbstractCurve):
    def judge(edges: Array) -> tuple[Array, Array]:
        ends = curve.point(edges)
        inside = probes(edges, SHARES)
        off = _distance(ends[:-1, None], ends[1:, None], curve.point(inside))
        rows, last = np.arange(len(off)), off.shape[1] - 1
        i = np.clip(off.argmax(axis=1), 1, last - 1)
        left, mid, right = off[rows, i - 1], off[rows, i], off[rows, i + 1]
        # The top of the parabola through the three largest probes.
        bend = 2 * mid - left - right
        rise = np.where(bend > 0, (right - left) ** 2 / (8 * np.where(bend > 0, bend, 1)), 0)
        top = np.maximum(off.max(axis=1), np.where(off.argmax(axis=1) == i, mid + rise, 0))
        return top, turns(curve.velocity(inside))

    return judge


def _distance(a: Array, b: Array, p: Array) -> Array:
    """Distance of points from the segments a-b (not from the lines: a loop may pass an end)."""
    chord = b - a
    length = np.abs(chord)
    w = (p - a) * np.conj(chord) / np.where(length > 0, length, 1)
    beyond = np.where(w.real < 0, w.real, np.maximum(w.real - length, 0))
    return np.abs(beyond + 1j * w.imag)


def _chords_of_circle(radius: float, tolerance: float) -> int:
    """Least number of chords of a full circle; three at least, for an area."""
    if tolerance >= radius:
        return 3
    half = 2 * np.arcsin(np.sqrt(tolerance / (2 * radius)))
    return max(3, int(np.ceil(np.pi / half - 1e-9)))
