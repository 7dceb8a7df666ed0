"""Flattening: the fewest points of a curve whose chords stay within a distance of it, by adaptive subdivision."""

from __future__ import annotations

import math
from collections.abc import Callable, Generator, Sequence
from itertools import accumulate, pairwise
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from ..core.arguments import checked
from ..core.errors import DesignError
from ..core.fields import rounded_up
from ..core.units import mm
from .curve import AbstractCurve, Mirrored, Moved, Reversed
from .joined import Path, PolarArray
from .primitives import Arc, Circle, Polyline, Segment
from .vec import Complex, Mask, Real, Whole, unit

# A tangent that jumps by more than this, rad, is a corner and gets a point. With a smaller value rounding would give
# corners; with a larger one a chord would cut a visible corner.
CORNER = 1e-6
# Share of the tolerance at which intervals aim, since the error between two probes may be larger.
AIM = 0.998
# Cells per smooth piece in the first round. With fewer, details inside a piece are missed.
CELLS = 32
_FIRST = np.arange(CELLS) / CELLS
# Largest rotation of the tangent in one interval, rad. With more, the error does not follow a power of the length, and
# a closed curve might become a single interval.
MOST_TURN = 2.2
# Largest number of rounds; smooth pieces need three or four.
ROUNDS = 12
# After two rounds the share of an interval that is over the tolerance is multiplied by this, so that it becomes short
# enough.
PUSH = 1.05
# Shares are rounded to multiples of this. The last bits of an error differ between processors; without rounding, rounds
# that do not converge would amplify the difference until it shows in files.
GRAIN = 2.0**-20
# The second half of the rounds is omitted if the number of intervals exceeds the number that the errors require by at
# most this factor, or by one.
ENOUGH = 1.005
# A distance from a chord or an arc is rounding if it is below this share of the distance from the origin.
ROUNDING = 1e-13
# Share of the intervals that straight parts get, although they have no error. Without it the last bit of the errors
# would visibly move points along them.
TRACE = 1e-4

T = TypeVar("T")


class Intervals(NamedTuple):
    """Intervals of one or several consecutive runs: ends (n,), and the first interval of each run."""

    low: Real
    high: Real
    first: Whole


Judge = Callable[[Intervals], tuple[Real, Real]]
# A coroutine that subdivides one run: it yields the edges of intervals, receives their errors and rotations, and
# returns a T.
Work = Generator[Real, tuple[Real, Real], T]


def adaptive_subdivision(judge: Judge, runs: Sequence[Real], tolerance: float, order: int) -> list[Real]:
    """For each run of breaks the fewest parameters, both ends included, whose intervals all keep the tolerance.

    judge(intervals) returns each interval's error, mm, and the rotation of its tangent, rad. The error of small
    intervals is proportional to the power `order` of their length. It is measured, not predicted, so that the result
    keeps the tolerance at all probes.
    """
    settled = _together(judge, [_settle(run, tolerance, order) for run in runs])
    # If chords across jumps of curvature do not converge, each smooth piece is divided separately.
    unsettled = [k for k, (_, converged) in enumerate(settled) if not converged and len(runs[k]) > 2]
    pieces = [_settle(runs[k][j : j + 2], tolerance, order) for k in unsettled for j in range(len(runs[k]) - 1)]
    results, by_piece = [edges for edges, _ in settled], iter(_together(judge, pieces))
    for k in unsettled:
        piecewise = np.concatenate([next(by_piece)[0][:-1] for _ in runs[k][1:]] + [runs[k][-1:]])
        results[k] = piecewise if len(piecewise) < len(results[k]) else results[k]
    return results


def _together(judge: Judge, works: Sequence[Work[T]]) -> list[T]:
    """The results of several coroutines; one call of `judge` serves all of them, since calls are expensive."""
    results: dict[int, T] = {}
    requests = {k: next(work) for k, work in enumerate(works)}
    while requests:
        edges = list(requests.values())
        bounds = [0, *accumulate(len(e) - 1 for e in edges)]
        if len(edges) == 1:
            low, high = edges[0][:-1], edges[0][1:]
        else:
            low, high = np.concatenate([e[:-1] for e in edges]), np.concatenate([e[1:] for e in edges])
        error, turn = judge(Intervals(low, high, np.array(bounds[:-1])))
        for k, (start, end) in zip(list(requests), pairwise(bounds)):
            try:
                requests[k] = works[k].send((error[start:end], turn[start:end]))
            except StopIteration as over:
                results[k] = over.value
                del requests[k]
    return [results[k] for k in range(len(works))]


def _settle(breaks: Real, tolerance: float, order: int) -> Work[tuple[Real, bool]]:
    """The fewest edges in rounds that equalise all shares, and whether they are about as few as the errors require."""
    edges = np.append((breaks[:-1, None] + (breaks[1:] - breaks[:-1])[:, None] * _FIRST).ravel(), breaks[-1])
    fewest, settled = math.inf, False
    for k in range(ROUNDS):
        error, turn = yield edges
        share = _share(error, turn, tolerance, order)
        over = share > 1
        # An interval across a jump of curvature may not converge. Splitting it costs one interval more.
        split = len(share) + int(np.count_nonzero(over)) if share.max() < 1.9 else math.inf
        if k == 0 or split < fewest:
            best, fewest, seen = edges, split, (error, turn)
        used = np.zeros(len(edges))
        (np.where(over, PUSH, 1) * share if k > 1 else share).cumsum(out=used[1:])
        count = max(1, math.ceil(used[-1] - 1e-9))
        settled = fewest <= max(ENOUGH * count, count + 1)
        if fewest <= count or (k >= ROUNDS // 2 and settled):
            break
        wanted = _divide(edges, used, count)
        # If errors do not follow the power law, as across jumps of curvature, full steps would oscillate.
        edges = edges + min(1.0, 2 / (k + 1)) * (wanted - edges) if len(wanted) == len(edges) else wanted
    return (yield from _halve(best, _over_tolerance(*seen, tolerance), breaks, tolerance)), settled


def _over_tolerance(error: Real, turn: Real, tolerance: float) -> Mask:
    """Which intervals are over the tolerance."""
    return (error > tolerance) | (turn > 1.5 * MOST_TURN)


def _share(error: Real, turn: Real, tolerance: float, order: int) -> Real:
    """The number of intervals, a multiple of GRAIN, that should replace each one: 1 if it just keeps the tolerance."""
    grains: Real = np.rint(np.maximum((error / (AIM * tolerance)) ** (1 / order), turn / MOST_TURN) / GRAIN)
    return grains * GRAIN


def _divide(edges: Real, used: Real, count: int) -> Real:
    """Edges of `count` intervals of equal share, from the cumulative shares `used` at the present edges.

    Between present edges t follows `used` by the monotone cubic of Fritsch and Butland (SIAM J. Sci. Stat. Comput. 5,
    1984, 300-304; slopes by the harmonic mean): shares change smoothly along a smooth curve, while linear interpolation
    would leave steps of some percent that never converge.
    """
    used = used + (TRACE * float(used[-1]) + 1e-300) * np.arange(len(used)) / (len(used) - 1)
    width = used[1:] - used[:-1]
    secant = (edges[1:] - edges[:-1]) / width
    slope = np.concatenate([secant[:1], 2 / (1 / secant[1:] + 1 / secant[:-1]), secant[-1:]])
    wanted = used[-1] * np.arange(count + 1) / count
    i = np.minimum(used[1:-1].searchsorted(wanted, side="right"), len(width) - 1)
    across = width[i]
    x = (wanted - used[i]) / across
    square, rest = x**2, 1 - x
    out: Real = edges[i] + across * (
        secant[i] * square * (3 - 2 * x) + slope[i] * x * rest**2 - slope[i + 1] * square * rest
    )
    out[0], out[-1] = edges[0], edges[-1]
    return out


def _halve(edges: Real, over: Mask, breaks: Real, tolerance: float) -> Work[Real]:
    """Split each interval over the tolerance, at a break inside it or in half, until all keep it or are too short."""
    for _ in range(60):
        if not over.any():
            break
        low, high = edges[:-1][over], edges[1:][over]
        inside = np.searchsorted(breaks, low, side="right")
        at = breaks[np.minimum(inside, len(breaks) - 1)]
        new = np.where(at < high, at, 0.5 * (low + high))
        new = new[(low < new) & (new < high)]
        if not len(new):
            break
        edges = np.sort(np.append(edges, new))
        error, turn = yield edges
        over = _over_tolerance(error, turn, tolerance)
    return edges


def cells_of(intervals: Intervals, breaks: Real) -> tuple[Real, Real, Whole]:
    """The intervals cut into cells at breaks: starts and ends of the cells, and the index of each cell's interval."""
    low, high, _ = intervals
    inner = breaks[(breaks > low[0]) & (breaks < high[-1])]
    owner = low.searchsorted(inner, side="right") - 1
    inner = inner[(low[owner] < inner) & (inner < high[owner])]
    if not len(inner):
        return low, high, np.arange(len(low))
    starts, ends = np.concatenate([low, inner]), np.concatenate([high, inner])
    starts.sort()
    ends.sort()
    return starts, ends, low.searchsorted(starts, side="right") - 1


def probes(low: Real, high: Real, shares: Real) -> Real:
    """Parameters (intervals, probes) at the given shares of each interval."""
    return low[:, None] + (high - low)[:, None] * shares


def tops(distance: Real, places: Complex, first: Whole) -> Real:
    """Largest distance along each row of probes at `places`, by the parabola through it and its neighbours.

    Rounding counts as 0: otherwise its root would move points along straight lines, differently on each processor.
    first: the first row of each run, which has its own rounding.
    """
    radius = np.abs(places)
    if len(first) == 1:
        distance = np.where(distance > ROUNDING * radius.max(), distance, 0)
    else:
        largest = np.maximum.reduceat(radius.max(axis=1), first)
        distance = np.where(
            distance > ROUNDING * np.repeat(largest, np.diff(first, append=len(distance)))[:, None], distance, 0
        )
    count, peak, each = distance.shape[1], distance.argmax(axis=1), distance.ravel()
    i = np.minimum(np.maximum(peak, 1), count - 2)
    centre = i + np.arange(0, len(each), count)
    left, mid, right = each[centre - 1], each[centre], each[centre + 1]
    second_difference, curved = 2 * mid - left - right, peak == i
    curved &= second_difference > 0
    # A peak at either end has no neighbour beyond, and for equal values there is no parabola.
    maximum: Real = each[centre + (peak - i)]
    maximum[curved] = mid[curved] + (right[curved] - left[curved]) ** 2 / (8 * second_difference[curved])
    return maximum


def direction(curve: AbstractCurve, t: Real, after: bool | Mask) -> Complex:
    """Unit tangent just after, or just before, each parameter: one-sided at breaks, defined at cusps."""
    b = curve.breaks
    i = np.where(after, b.searchsorted(t, side="right"), b.searchsorted(t, side="left") - 1)
    return towards(curve, t, b[np.minimum(np.maximum(i, 0), len(b) - 1)])


def towards(curve: AbstractCurve, t: Real, near: Real) -> Complex:
    """Unit tangent at each parameter on the side of `near`, the next break in that direction."""
    # This far inside the piece the parameter differs despite rounding, and the tangent is still the same.
    inward = np.sign(near - t) * np.maximum(1e-12 * np.abs(near - t), 64 * np.spacing(np.abs(t)))
    return unit(curve.velocity(t + inward))


def turns(v: Complex) -> Real:
    """Total absolute rotation along each row of velocities, rad; a velocity of zero counts as none."""
    ratio = v[:, 1:] * np.conj(v[:, :-1])
    total: Real = np.abs(np.angle(np.where(ratio == 0, 1, ratio))).sum(axis=1)
    return total


# Positions at which a chord is compared with its curve. The middle matters most; the others detect an S, a loop, and an
# uneven parameter.
SHARES = np.linspace(0, 1, 11)
# Largest number of chords of arcs, which take half a second and half a GB: enough for a circle of 1 m within 1e-10 mm.
MOST_CHORDS = 5_000_000


def check_tolerance(tolerance: float) -> None:
    """Raise DesignError unless the tolerance is above 0."""
    if not 0 < tolerance < np.inf:
        raise DesignError("tolerance", f"found {tolerance}", "give a distance above 0, in mm", "out-of-range")


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

    See Also
    --------
    to_arcs, length, area

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
    check_tolerance(tolerance)
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
    half = 2 * np.arcsin(np.sqrt(tolerance / np.maximum(2 * np.asarray(radius), 4 * tolerance)))
    # Reduced by 1e-9 below, so that a tolerance that gives exactly a whole number is not rounded up.
    count: Real = np.asarray(sweep) / (2 * half)
    if (total := float(np.sum(count))) > MOST_CHORDS:
        # The count is inversely proportional to the root of the tolerance.
        enough = tolerance * (total / MOST_CHORDS) ** 2
        remedy = f"give at least {mm(enough):up4}"
        problem = f"found {mm(tolerance):g}, which takes {total:,.0f} chords"
        raise DesignError("tolerance", problem, remedy, "too-much-work", rounded_up(enough, 4))
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
            return tops(off, inside, intervals.first), turns(_steps(inside))
        each = np.arange(len(intervals.low))
        first = owner.searchsorted(each)
        start, end = inside[first, 0], inside[owner.searchsorted(each, side="right") - 1, -1]
        off = _distance(start[owner, None], end[owner, None], inside)
        error = np.maximum.reduceat(tops(off, inside, first[intervals.first]), first)
        return error, np.add.reduceat(turns(_steps(inside)), first)

    return judge


def _steps(places: Complex) -> Complex:
    """From each probe to the next. Rounding counts as 0: on an arc whose offset is its centre it rotates at random."""
    steps = places[:, 1:] - places[:, :-1]
    return np.where(np.abs(steps) > ROUNDING * np.abs(places[:, 1:]), steps, 0)


def _distance(a: Complex, b: Complex, p: Complex) -> Real:
    """Distance of points from the segments a-b (not from the lines, since a loop may extend beyond an end)."""
    chord = b - a
    length = np.abs(chord)
    w = (p - a) * (np.conj(chord) / np.where(length > 0, length, 1))
    return np.hypot(np.maximum(np.maximum(-w.real, w.real - length), 0), w.imag)
