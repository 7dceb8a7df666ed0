"""Chords of curves made of arcs and straight edges, such as the outlines of plates: by rule, nothing to search."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .curve import AbstractCurve
from .joined import Path
from .primitives import Arc, Polyline, Segment
from .spread import CORNER, direction
from .vec import Array


def pieces_of(curve: AbstractCurve) -> tuple[Arc | Segment, ...] | None:
    """The arcs and straight edges that a curve is made of, piece k over k <= t <= k + 1; None for other curves."""
    match curve:
        case Arc() | Segment():
            return (curve,)
        case Path():
            pieces = tuple(piece for piece in curve.pieces if isinstance(piece, (Arc, Segment)))
            return pieces if len(pieces) == len(curve.pieces) else None
        case Polyline():
            return curve.pieces
    return None


def edges_of(curve: AbstractCurve) -> tuple[Array, Array] | None:
    """Sweep, rad, and radius, mm, of each such piece, 0 and 1 of a straight one; None for other curves."""
    if (pieces := pieces_of(curve)) is None:
        return None
    sizes = [(abs(p.sweep), abs(p.start - p.centre)) if isinstance(p, Arc) else (0.0, 1.0) for p in pieces]
    sweep, radius = np.array(sizes).T
    return sweep, radius


def chords_of_arc(radius: ArrayLike, sweep: ArrayLike, tolerance: float) -> Array:
    """How many chords an arc takes, as a fraction; none turns by more than a third of a circle."""
    half = 2 * np.arcsin(np.sqrt(np.minimum(tolerance / (2 * np.asarray(radius)), 0.25)))
    # A circle asked for with a tolerance that just gives a whole number gets that.
    return np.asarray(sweep) / (2 * half) - 1e-9


def chain_points(curve: AbstractCurve, sweep: Array, radius: Array, tolerance: float) -> Array:
    """Points whose chords keep the tolerance, the end of an open curve included.

    Where an arc goes on straight, the chord of the straight edge reaches half a chord's turn into the arc and leaves
    out the point where the two meet, which lies as far from it as an arc from its chord. So an arc between
    two straight edges takes one chord less.
    """
    bent, edge = sweep > 0, np.arange(len(sweep), dtype=float)
    smooth = np.abs(direction(curve, edge, True) - np.roll(direction(curve, edge + 1, False), 1)) <= CORNER
    smooth[0] &= curve.closed
    spanned = smooth & (bent != np.roll(bent, 1))
    first, last = spanned & bent, np.roll(spanned, -1) & bent
    t = _parameters(sweep, chords_of_arc(radius, sweep, tolerance), first, last, bent | ~smooth)
    if curve.closed and len(t) < 3:
        # A tolerance as large as the curve would leave no area.
        none = np.zeros(len(bent), dtype=bool)
        t = np.unique(
            np.append(_parameters(sweep, chords_of_arc(radius, sweep, tolerance), none, none, ~none), edge + 0.5)
        )
    return curve.point(t if curve.closed else np.append(t, edge[-1] + 1))


def _parameters(sweep: Array, chords: Array, first: Array, last: Array, starts: Array) -> Array:
    """Parameters of the points edge by edge, without the end.

    first, last: arcs whose first or last half chord belongs to a straight neighbour; starts: edges that begin with
    a point, if not with such a half.
    """
    half = 0.5 * first + 0.5 * last
    count = np.maximum(np.ceil(chords - half), half == 0)
    # Of the arc, in turns of one chord each: the halves at its ends, and the chords between.
    share = 1 / (count + half)
    points = np.where(sweep > 0, count + last, starts).astype(int)
    edge = np.repeat(np.arange(len(sweep)), points)
    within = np.arange(len(edge)) - np.repeat(np.cumsum(points) - points, points)
    return edge + (within + 0.5 * first[edge]) * share[edge]
