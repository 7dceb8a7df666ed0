"""Chords of curves made of arcs and straight edges, such as the outlines of plates: by rule, nothing to search."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .curve import AbstractCurve
from .joined import Path
from .primitives import Arc, Polyline, Segment
from .spread import CORNER, direction
from .vec import Array


def edges_of(curve: AbstractCurve) -> tuple[Array, Array] | None:
    """Sweep, rad, and radius, mm, of each edge, 0 and 1 of a straight one; None for curves with other pieces.

    Edge k runs evenly over k <= t <= k + 1.
    """
    pieces = curve.pieces if isinstance(curve, (Path, Polyline)) else (curve,)
    if not all(isinstance(piece, (Arc, Segment)) for piece in pieces):
        return None
    sizes = [(abs(p.sweep), abs(p.start - p.centre)) if isinstance(p, Arc) else (0.0, 1.0) for p in pieces]
    sweep, radius = np.array(sizes).T
    return sweep, radius


def chords_of_arc(radius: ArrayLike, sweep: ArrayLike, tolerance: float) -> Array:
    """Least number of equal chords of an arc, as a fraction; none turns by more than a third of a circle."""
    half = 2 * np.arcsin(np.sqrt(np.minimum(tolerance / (2 * np.asarray(radius)), 0.25)))
    # A circle asked for with a tolerance that just gives a whole number gets that.
    return np.asarray(sweep) / (2 * half) - 1e-9


def chain_points(curve: AbstractCurve, sweep: Array, radius: Array, tolerance: float) -> Array:
    """Points whose chords keep the tolerance, the end of an open curve included.

    Straight edges stay where they are: they guide and carry, and a chord that reached into the arc beyond one, for
    the sake of one point less, would shift it by the tolerance.
    """
    bent, edge = sweep > 0, np.arange(len(sweep), dtype=float)
    chords = np.where(bent, np.ceil(chords_of_arc(radius, sweep, tolerance)), 1).astype(int)
    smooth = np.abs(direction(curve, edge, True) - np.roll(direction(curve, edge + 1, False), 1)) <= CORNER
    smooth[0] &= curve.closed
    # Where one straight edge goes on in the next there is nothing to tell.
    chords[smooth & ~bent & ~np.roll(bent, 1)] = 0
    if curve.closed and chords.sum() < 3:
        # A tolerance as large as the curve would leave no area.
        chords = chords + 1
    first = np.repeat(np.cumsum(chords) - chords, chords)
    t = np.repeat(edge, chords) + (np.arange(len(first)) - first) / np.repeat(chords, chords)
    return curve.point(t if curve.closed else np.append(t, edge[-1] + 1))
