"""Approximation of a curve by a smooth chain of circular arcs."""

from __future__ import annotations

import numpy as np

from ..core.arguments import checked
from .curve import AbstractCurve, Mirrored, Moved, Reversed
from .flatten import Intervals, Judge, adaptive_subdivision, check_tolerance, direction, probes, tops, turns
from .joined import Path, PolarArray
from .primitives import Arc, Circle, Polyline, Segment
from .vec import Complex, Real, dot, unit

# Positions at which a biarc is compared with its curve.
SHARES = np.linspace(0, 1, 26)[1:-1]
# Neighbouring arcs are merged if the difference of their curvatures times their length is less than this, rad. A larger
# value would break the tangent; with a smaller one a true circle stays in pieces.
SAME = 1e-8
# Vertices, first and last included, and the bulges between them.
Chain = tuple[Complex, Real]


@checked
def to_arcs(curve: AbstractCurve, tolerance: float) -> Polyline:
    """Arcs and straight edges that are nowhere farther than a tolerance from a curve.

    Parameters
    ----------
    curve : AbstractCurve
        The curve.
    tolerance : float
        mm; above 0.

    Returns
    -------
    Polyline
        Its tangent is continuous within each smooth piece of the curve, and the points at which arcs of different
        pieces meet are on the curve. Circles and straight pieces are exact. No arc exceeds half a turn.

    Raises
    ------
    DesignError
        If the tolerance is not above 0.

    See Also
    --------
    flatten

    Notes
    -----
    The arcs are biarcs, two arcs that are tangent to the curve at both ends (Bolton, "Biarc curves",
    Computer-Aided Design 7, 1975, 89-92), all with the same error; their number is within 15 % of that of a greedy
    choice.

    Examples
    --------
    >>> import geomkin as gk
    >>> len(gk.to_arcs(gk.plane.Circle(0j, 10.0), 0.01).vertices)
    2
    """
    check_tolerance(tolerance)
    vertices, bulges = _chain(curve, tolerance, {})
    return Polyline(vertices[:-1] if curve.closed else vertices, bulges, curve.closed)


def _chain(curve: AbstractCurve, tolerance: float, known: dict[AbstractCurve, Chain]) -> Chain:
    """The vertices and bulges of `to_arcs`. Congruent pieces are computed once.

    known: the chains of earlier curves.
    """
    if curve in known:
        return known[curve]
    match curve:
        case PolarArray():
            z, bulges = _over_seam(*_chain(curve.piece, tolerance, known), complex(curve.turns[1 % curve.count]))
            around = (curve.turns[:, None] * z[:-1]).ravel()
            return np.append(around, around[0]), np.tile(bulges, curve.count)
        case Moved():
            z, bulges = _chain(curve.curve, tolerance, known)
            return curve.pose.place(z), bulges
        case Mirrored():
            z, bulges = _chain(curve.curve, tolerance, known)
            return -np.conj(z), -bulges
        case Reversed():
            z, bulges = _chain(curve.curve, tolerance, known)
            return z[::-1], -bulges[::-1]
        case Polyline():
            return _no_large_arcs(curve)
        case Circle():
            return curve.centre + curve.radius * np.array([1, -1, 1]), np.ones(2)
        case Arc():
            count = max(1, int(np.ceil(abs(curve.sweep) / np.pi - SAME)))
            return curve.point(np.linspace(0, 1, count + 1)), np.full(count, np.tan(curve.sweep / (4 * count)))
        case Segment():
            return np.array([curve.start, curve.end]), np.zeros(1)
        case Path():
            links = [_chain(piece, tolerance, known) for piece in curve.pieces]
        case _:
            judge = _biarc_judge(curve)
            pieces = [curve.breaks[k : k + 2] for k in range(len(curve.breaks) - 1)]
            runs = adaptive_subdivision(judge, pieces, tolerance, order=3)
            links = [_merge(*_alternating(*_biarcs(curve, edges[:-1], edges[1:]))) for edges in runs]
    ends = [z[:-1] for z, _ in links] + [links[-1][0][-1:]]
    known[curve] = np.concatenate(ends), np.concatenate([bulges for _, bulges in links])
    return known[curve]


def _over_seam(z: Complex, bulges: Real, turn: complex) -> Chain:
    """The chain from its second vertex on, if its last edge and the first edge of the next copy form one arc."""
    if len(bulges) < 3:
        return z, bulges
    joint, both = np.array([z[-2], z[-1], turn * z[1]]), bulges[[-1, 0]]
    half = unit(np.diff(joint)) * np.exp(2j * np.array([1, -1]) * np.arctan(both))
    one, bulge = _merge(joint, both)
    if len(bulge) > 1 or abs(half[1] - half[0]) > SAME:
        return z, bulges
    return np.append(z[1:-1], one[-1]), np.append(bulges[1:-1], bulge)


def _no_large_arcs(curve: Polyline) -> Chain:
    """The chain with arcs of more than half a turn cut in two."""
    edges = len(curve.breaks) - 1
    bulges = np.zeros(edges) if curve.bulges is None else np.asarray(curve.bulges)
    if np.abs(bulges).max() <= 1:
        z = np.asarray(curve.vertices, dtype=complex)
        return np.append(z, z[0]) if curve.closed else z, bulges
    halves = 1 + (np.abs(bulges) > 1)
    starts = np.repeat(np.arange(edges), halves) + np.concatenate([np.arange(n) / n for n in halves.tolist()])
    vertices = np.append(curve.point(starts), np.asarray(curve.vertices)[0 if curve.closed else -1])
    return vertices, np.tan(np.repeat(np.arctan(bulges) / halves, halves))


def _biarcs(curve: AbstractCurve, low: Real, high: Real) -> tuple[Complex, ...]:
    """Ends, joints and end tangents of the biarc over each interval from `low` to `high`.

    The joint is the middle of p0 + d t0 and p1 - d t1 with one d for both ends, in a form without a difference of
    nearly equal numbers.
    """
    p0, p1 = curve.point(low), curve.point(high)
    t0, t1 = direction(curve, low, after=True), direction(curve, high, after=False)
    chord, along = p1 - p0, t0 + t1
    c2 = np.abs(chord) ** 2
    projection = dot(chord, along)
    # 2 (1 - t0 . t1) is |t1 - t0|^2, which keeps its digits for nearly parallel tangents.
    root = np.sqrt(projection**2 + np.abs(t1 - t0) ** 2 * c2)
    with np.errstate(divide="ignore", invalid="ignore"):
        d = c2 / (projection + root)
        return p0, p1, 0.5 * (p0 + p1 + d * (t0 - t1)), t0, t1


def _bulge(chord: Complex, tangent: Complex) -> Real:
    """tan(sweep / 4) of the arc over `chord` that starts along `tangent`: half the angle between the two."""
    w = chord * np.conj(tangent)
    return w.imag / (np.abs(w) + w.real)


def _alternating(p0: Complex, p1: Complex, joint: Complex, t0: Complex, t1: Complex) -> Chain:
    """Vertices and bulges of the biarcs, one after the other."""
    z = np.append(np.stack([p0, joint], axis=1).ravel(), p1[-1])
    first, second = _bulge(joint - p0, t0), -_bulge(joint - p1, -t1)
    return z, np.stack([first, second], axis=1).ravel()


def _merge(z: Complex, bulge: Real) -> Chain:
    """One arc for each sequence of arcs of the same circle, up to half a turn."""
    chord, sweep = np.diff(z), 4 * np.arctan(bulge)
    length = np.abs(chord) / np.sinc(sweep / (2 * np.pi))
    keep, total, arc_length = [0], sweep[0], length[0]
    for k in range(1, len(bulge)):
        same = abs(sweep[k] / length[k] - total / arc_length) * (length[k] + arc_length) < SAME
        if same and abs(total + sweep[k]) <= np.pi + SAME:
            total, arc_length = total + sweep[k], arc_length + length[k]
        else:
            keep.append(k)
            total, arc_length = sweep[k], length[k]
    ends = np.append(keep, len(bulge))
    sums = np.add.reduceat(sweep, keep)
    # A sweep of rounding is a straight edge; as an arc its radius would be too large for any reader.
    return z[ends], np.tan(np.where(np.abs(sums) < 1e-12, 0.0, sums) / 4)


def _biarc_judge(curve: AbstractCurve) -> Judge:
    def judge(intervals: Intervals) -> tuple[Real, Real]:
        low, high, first = intervals
        p0, p1, joint, t0, t1 = (a[:, None] for a in _biarcs(curve, low, high))
        inside = probes(low, high, SHARES)
        z = curve.point(inside)
        # Direction at the joint: the first tangent mirrored in the first arc's chord.
        middle = t0.conj() * unit(joint - p0) ** 2
        in_first = dot(middle, z - joint) < 0
        distance = np.where(in_first, _off_arc(z, p0, t0, joint), _off_arc(z, p1, -t1, joint))
        v = curve.velocity(inside)
        # If no biarc exists (its tangents face each other) the error is the length of the chord.
        distance = np.where(np.isfinite(distance), distance, np.abs(p1 - p0) + np.abs(z - p0))
        return tops(distance, z, first), turns(v)

    return judge


def _off_arc(z: Complex, start: Complex, tangent: Complex, end: Complex) -> Real:
    """Distance of points from the circle that leaves `start` along `tangent` and passes through `end`.

    Written with the curvature, so that a circle as flat as a line keeps its digits.
    """
    w = (end - start) * np.conj(tangent)
    with np.errstate(divide="ignore", invalid="ignore"):
        curvature = 2 * w.imag / np.abs(w) ** 2
    q = (z - start) * np.conj(tangent)
    distance: Real = np.abs(curvature * np.abs(q) ** 2 - 2 * q.imag) / (1 + np.abs(curvature * q - 1j))
    return distance
