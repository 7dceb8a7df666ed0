"""Places parameters along a curve so that every interval between them has the same error.

Both ways of simplifying a curve, chords and arcs, are this one task with another error.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Generator, Sequence
from itertools import accumulate, pairwise
from typing import NamedTuple, TypeVar

import numpy as np

from .curve import AbstractCurve
from .vec import Complex, Mask, Real, Whole, unit

# A tangent that jumps by more than this, rad, is a corner and gets a point of its own. Smaller takes
# rounding for corners and spends points on them; larger lets a chord cut a visible corner.
CORNER = 1e-6
# Share of the tolerance that is aimed at. Larger, and what lies between two probes may exceed the
# tolerance; smaller costs intervals (half this margin in chords).
AIM = 0.998
# Cells per smooth piece in the first look. Fewer miss wiggles inside a piece; more cost time.
CELLS = 32
_FIRST = np.arange(CELLS) / CELLS
# Most that one interval may turn, rad. A chord or a pair of arcs that turns by more is no longer
# described by the laws of small intervals, and a closed curve might come back as a single one.
MOST_TURN = 2.2
# Looks at most; smooth pieces need three or four. Fewer leave intervals unequal, and more of them.
ROUNDS = 12
# An interval that is over the tolerance after two looks counts for this times its share, so that it shrinks by more
# than the law of small intervals asks. Smaller, and it stays just over; larger, and its neighbours grow too long.
PUSH = 1.05
# Steps of an interval's share. The last bits of an error differ from processor to processor; where intervals do not
# settle, round after round would multiply them until they show in files. Finer lets more of them through, coarser
# makes intervals unequal.
GRAIN = 2.0**-20
# How near the count must come to what the errors ask for, or within one, to spare the second half of the looks.
ENOUGH = 1.005
# Share of the distance from the origin below which a distance from a chord or an arc is rounding.
ROUNDING = 1e-13
# Share of all use that straight stretches are given, which use nothing. Smaller, and the last bit of the errors moves
# points along them as far as files tell; larger makes intervals unequal.
TRACE = 1e-4

T = TypeVar("T")


class Intervals(NamedTuple):
    """Intervals of one run or several, one run after the other: ends (n,), and the first of each run."""

    low: Real
    high: Real
    first: Whole


Judge = Callable[[Intervals], tuple[Real, Real]]
# Work on one run, which yields edges, is sent the errors and turns of the intervals between them, and ends in a T.
Work = Generator[Real, tuple[Real, Real], T]


def adaptive_subdivision(judge: Judge, runs: Sequence[Real], tolerance: float, order: int) -> list[Real]:
    """Of each run of breaks the fewest parameters, first and last included, whose intervals all keep the tolerance.

    judge(intervals) gives each interval's error, mm, and its turn, rad; for small intervals the error
    falls with the `order`-th power of their length. The error is measured, never predicted, so the
    result keeps the tolerance wherever the judge looks.
    """
    settled = _together(judge, [_settle(run, tolerance, order) for run in runs])
    # Jumps of curvature keep the chords across them from settling: each smooth piece by itself does.
    loose = [k for k, (_, sure) in enumerate(settled) if not sure and len(runs[k]) > 2]
    pieces = [_settle(runs[k][j : j + 2], tolerance, order) for k in loose for j in range(len(runs[k]) - 1)]
    found, apart = [edges for edges, _ in settled], iter(_together(judge, pieces))
    for k in loose:
        piecewise = np.concatenate([next(apart)[0][:-1] for _ in runs[k][1:]] + [runs[k][-1:]])
        found[k] = piecewise if len(piecewise) < len(found[k]) else found[k]
    return found


def _together(judge: Judge, works: Sequence[Work[T]]) -> list[T]:
    """What each of several works comes to. All that they ask in a round is judged in one go: calls cost, not places."""
    found: dict[int, T] = {}
    asked = {k: next(work) for k, work in enumerate(works)}
    while asked:
        edges = list(asked.values())
        bounds = [0, *accumulate(len(e) - 1 for e in edges)]
        if len(edges) == 1:
            low, high = edges[0][:-1], edges[0][1:]
        else:
            low, high = np.concatenate([e[:-1] for e in edges]), np.concatenate([e[1:] for e in edges])
        error, turn = judge(Intervals(low, high, np.array(bounds[:-1])))
        for k, (start, end) in zip(list(asked), pairwise(bounds)):
            try:
                asked[k] = works[k].send((error[start:end], turn[start:end]))
            except StopIteration as over:
                found[k] = over.value
                del asked[k]
    return [found[k] for k in range(len(works))]


def _settle(breaks: Real, tolerance: float, order: int) -> Work[tuple[Real, bool]]:
    """The fewest edges met while making all shares equal, and whether they are as few as the errors ask for."""
    edges = np.append((breaks[:-1, None] + (breaks[1:] - breaks[:-1])[:, None] * _FIRST).ravel(), breaks[-1])
    fewest, settled = math.inf, False
    for k in range(ROUNDS):
        error, turn = yield edges
        share = _share(error, turn, tolerance, order)
        over = share > 1
        # An interval across a jump of curvature may never settle: split in two, it costs one more.
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
        # Where errors do not follow the law, as across jumps of curvature, full steps go to and fro for ever.
        edges = edges + min(1.0, 2 / (k + 1)) * (wanted - edges) if len(wanted) == len(edges) else wanted
    return (yield from _halve(best, _spoilt(*seen, tolerance), breaks, tolerance)), settled


def _spoilt(error: Real, turn: Real, tolerance: float) -> Mask:
    """Which intervals are over the tolerance."""
    return (error > tolerance) | (turn > 1.5 * MOST_TURN)


def _share(error: Real, turn: Real, tolerance: float, order: int) -> Real:
    """How many intervals each interval ought to be, in whole GRAINs: 1 when it just keeps the tolerance."""
    grains: Real = np.rint(np.maximum((error / (AIM * tolerance)) ** (1 / order), turn / MOST_TURN) / GRAIN)
    return grains * GRAIN


def _divide(edges: Real, used: Real, count: int) -> Real:
    """Edges of `count` intervals of equal share, from what the present ones use up to each edge.

    Between present edges t follows `used` by the monotone cubic of Fritsch and Butland (SIAM J. Sci. Stat. Comput. 5,
    1984, 300-304; slopes by the harmonic mean): shares change smoothly along a smooth curve, and a straight line
    between edges would leave steps of some percent that never settle.
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
    """Split what is over the tolerance, at a break inside it or in half, until nothing is or digits end."""
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
        over = _spoilt(error, turn, tolerance)
    return edges


def cells_of(intervals: Intervals, breaks: Real) -> tuple[Real, Real, Whole]:
    """The intervals cut at breaks: both ends of the cells, and each cell's interval."""
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


def tops(off: Real, places: Complex, first: Whole) -> Real:
    """Largest distance along each row of probes at `places`, by the parabola through it and its neighbours.

    What rounding alone explains is 0: its root would move points along straight lines, one way on one processor
    and another way on the next. first: of the rows of each run, which has a rounding of its own.
    """
    far = np.abs(places)
    if len(first) == 1:
        off = np.where(off > ROUNDING * far.max(), off, 0)
    else:
        largest = np.maximum.reduceat(far.max(axis=1), first)
        off = np.where(off > ROUNDING * np.repeat(largest, np.diff(first, append=len(off)))[:, None], off, 0)
    count, peak, each = off.shape[1], off.argmax(axis=1), off.ravel()
    i = np.minimum(np.maximum(peak, 1), count - 2)
    at = i + np.arange(0, len(each), count)
    left, mid, right = each[at - 1], each[at], each[at + 1]
    bend, curved = 2 * mid - left - right, peak == i
    curved &= bend > 0
    # A peak at either end has no neighbour beyond, and where all are alike there is no parabola.
    top: Real = each[at + (peak - i)]
    top[curved] = mid[curved] + (right[curved] - left[curved]) ** 2 / (8 * bend[curved])
    return top


def direction(curve: AbstractCurve, t: Real, after: bool | Mask) -> Complex:
    """Unit tangent just after, or just before, each parameter: one-sided at breaks, defined at cusps."""
    b = curve.breaks
    i = np.where(after, b.searchsorted(t, side="right"), b.searchsorted(t, side="left") - 1)
    return towards(curve, t, b[np.minimum(np.maximum(i, 0), len(b) - 1)])


def towards(curve: AbstractCurve, t: Real, near: Real) -> Complex:
    """Unit tangent at each parameter as seen from its side of `near`, the next break there."""
    # Far enough into the piece to be on the right side of rounding, and not so far as to turn.
    inward = np.sign(near - t) * np.maximum(1e-12 * np.abs(near - t), 64 * np.spacing(np.abs(t)))
    return unit(curve.velocity(t + inward))


def turns(v: Complex) -> Real:
    """Total absolute turn along each row of velocities, rad; standing still turns nothing."""
    ratio = v[:, 1:] * np.conj(v[:, :-1])
    total: Real = np.abs(np.angle(np.where(ratio == 0, 1, ratio))).sum(axis=1)
    return total
