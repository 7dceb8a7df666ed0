"""Places parameters along a curve so that every interval between them has the same error.

Both ways of simplifying a curve, chords and arcs, are this one task with another error.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

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


class Intervals(NamedTuple):
    """Intervals of one run or several, one run after the other: ends (n,), and the first of each run."""

    low: Real
    high: Real
    first: Whole


Judge = Callable[[Intervals], tuple[Real, Real]]


def spread(judge: Judge, runs: Sequence[Real], tolerance: float, order: int) -> list[Real]:
    """Of each run of breaks the fewest parameters, first and last included, whose intervals all keep the tolerance.

    judge(intervals) gives each interval's error, mm, and its turn, rad; for small intervals the error
    falls with the `order`-th power of their length. The error is measured, never predicted, so the
    result keeps the tolerance wherever the judge looks.
    """
    found, settled = _settle(judge, runs, tolerance, order)
    # Jumps of curvature keep the chords across them from settling: each smooth piece by itself does.
    loose = [k for k, run in enumerate(runs) if not settled[k] and len(run) > 2]
    pieces = [runs[k][j : j + 2] for k in loose for j in range(len(runs[k]) - 1)]
    apart = iter(_settle(judge, pieces, tolerance, order)[0] if pieces else ())
    for k in loose:
        piecewise = np.concatenate([next(apart)[:-1] for _ in runs[k][1:]] + [runs[k][-1:]])
        found[k] = piecewise if len(piecewise) < len(found[k]) else found[k]
    return found


def _settle(judge: Judge, runs: Sequence[Real], tolerance: float, order: int) -> tuple[list[Real], Mask]:
    """The fewest edges met while making all shares equal, and whether they are as few as the errors ask for.

    Of all runs at once: a round costs hardly more for a hundred than for one. Each run has a row of edges, and what a
    longer one has more of stands at its end there.
    """
    starts = [np.append((b[:-1, None] + (b[1:] - b[:-1])[:, None] * _FIRST).ravel(), b[-1]) for b in runs]
    best, spoilt = list(starts), [np.empty(0, dtype=bool)] * len(runs)
    settled, going = np.zeros(len(runs), dtype=bool), np.arange(len(runs))
    count = np.array([len(edges) - 1 for edges in starts])
    fewest = np.full(len(runs), np.inf)
    edges = starts[0][None]
    if len(runs) > 1:
        edges = np.stack([np.concatenate([one, np.full(count.max() + 1 - len(one), one[-1])]) for one in starts])
    for k in range(ROUNDS):
        inside = np.arange(edges.shape[1] - 1) < count[:, None]
        error, turn = judge(Intervals(edges[:, :-1][inside], edges[:, 1:][inside], count.cumsum() - count))
        share = np.zeros(inside.shape)
        share[inside] = _share(error, turn, tolerance, order)
        over = share > 1
        met = count + over.sum(axis=1)
        # An interval across a jump of curvature may never settle: split in two, it costs one more.
        fewer = (share.max(axis=1) < 1.9) & (met < fewest[going])
        if k == 0 or fewer.any():
            bad = np.split(_spoilt(error, turn, tolerance), count.cumsum()[:-1])
            for row in np.flatnonzero(fewer | (k == 0)).tolist():
                best[going[row]], spoilt[going[row]] = edges[row, : count[row] + 1], bad[row]
            fewest[going[fewer]] = met[fewer]
        used = np.zeros(edges.shape)
        np.cumsum(np.where(over & (k > 1), PUSH, 1) * share, axis=1, out=used[:, 1:])
        wanted_count = np.maximum(1, np.ceil(used[:, -1] - 1e-9)).astype(int)
        least = fewest[going]
        settled[going] = enough = least <= np.maximum(ENOUGH * wanted_count, wanted_count + 1)
        on = ~((least <= wanted_count) | ((k >= ROUNDS // 2) & enough))
        if not on.any():
            break
        if not on.all():
            going, edges, used, count, wanted_count = going[on], edges[on], used[on], count[on], wanted_count[on]
        wanted = _divide(edges, used, count, wanted_count)
        # Where errors do not follow the law, as across jumps of curvature, full steps go to and fro for ever.
        same, width = np.flatnonzero(wanted_count == count), min(edges.shape[1], wanted.shape[1])
        before = edges[same, :width]
        wanted[same, :width] = before + min(1.0, 2 / (k + 1)) * (wanted[same, :width] - before)
        edges, count = wanted, wanted_count
    return [
        _halve(judge, one, bad, run, tolerance) if bad.any() else one for one, bad, run in zip(best, spoilt, runs)
    ], settled


def _spoilt(error: Real, turn: Real, tolerance: float) -> Mask:
    """Which intervals are over the tolerance."""
    return (error > tolerance) | (turn > 1.5 * MOST_TURN)


def _share(error: Real, turn: Real, tolerance: float, order: int) -> Real:
    """How many intervals each interval ought to be, in whole GRAINs: 1 when it just keeps the tolerance."""
    grains: Real = np.rint(np.maximum((error / (AIM * tolerance)) ** (1 / order), turn / MOST_TURN) / GRAIN)
    return grains * GRAIN


def _divide(edges: Real, used: Real, count: Whole, wanted_count: Whole) -> Real:
    """Edges of `wanted_count` intervals of equal share, from what the present ones use up to each edge; rows as they.

    Between present edges t follows `used` by the monotone cubic of Fritsch and Butland (SIAM J. Sci. Stat. Comput. 5,
    1984, 300-304; slopes by the harmonic mean): shares change smoothly along a smooth curve, and a straight line
    between edges would leave steps of some percent that never settle.
    """
    rows, cells = np.arange(len(edges)), edges.shape[1] - 1
    used = used + (TRACE * used[:, -1:] + 1e-300) * np.arange(cells + 1) / count[:, None]
    width = used[:, 1:] - used[:, :-1]
    secant = (edges[:, 1:] - edges[:, :-1]) / width
    slope = np.empty(edges.shape)
    slope[:, 0] = secant[:, 0]
    with np.errstate(divide="ignore"):
        # Beyond a row's end nothing goes on.
        slope[:, 1:-1] = 2 / (1 / secant[:, 1:] + 1 / secant[:, :-1])
    slope[rows, count] = secant[rows, count - 1]
    at = np.arange(wanted_count.max() + 1)
    wanted = used[rows, count][:, None] * at / wanted_count[:, None]
    i = np.stack([u[1:n].searchsorted(w, side="right") for u, w, n in zip(used, wanted, count.tolist())])
    i = np.minimum(i, count[:, None] - 1)
    row = rows[:, None]
    x = (wanted - used[row, i]) / width[row, i]
    out: Real = edges[row, i] + width[row, i] * (
        secant[row, i] * x**2 * (3 - 2 * x) + slope[row, i] * x * (1 - x) ** 2 - slope[row, i + 1] * x**2 * (1 - x)
    )
    out[:, 0] = edges[:, 0]
    return np.where(at < wanted_count[:, None], out, edges[rows, count][:, None])


def _halve(judge: Judge, edges: Real, over: Mask, breaks: Real, tolerance: float) -> Real:
    """Split what is over the tolerance, at a break inside it or in half, until nothing is or digits end."""
    for _ in range(60):
        if not over.any():
            break
        low, high = edges[:-1][over], edges[1:][over]
        inside = np.searchsorted(breaks, low, side="right")
        at = breaks[np.minimum(inside, len(breaks) - 1)]
        merged = np.union1d(edges, np.where(at < high, at, 0.5 * (low + high)))
        if len(merged) == len(edges):
            break
        edges = merged
        over = _spoilt(*judge(Intervals(edges[:-1], edges[1:], np.zeros(1, dtype=int))), tolerance)
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
    rows, peak = np.arange(len(off)), off.argmax(axis=1)
    i = np.minimum(np.maximum(peak, 1), off.shape[1] - 2)
    left, mid, right = off[rows, i - 1], off[rows, i], off[rows, i + 1]
    bend = 2 * mid - left - right
    rise = np.where(bend > 0, (right - left) ** 2 / (8 * np.where(bend > 0, bend, 1)), 0)
    top: Real = np.where(peak == i, mid + rise, off.max(axis=1))
    return top


def direction(curve: AbstractCurve, t: Real, after: bool | Mask) -> Complex:
    """Unit tangent just after, or just before, each parameter: one-sided at breaks, defined at cusps."""
    b = curve.breaks
    i = np.where(after, b.searchsorted(t, side="right"), b.searchsorted(t, side="left") - 1)
    near = b[np.minimum(np.maximum(i, 0), len(b) - 1)]
    # Far enough into the piece to be on the right side of rounding, and not so far as to turn.
    inward = np.sign(near - t) * np.maximum(1e-12 * np.abs(near - t), 64 * np.spacing(np.abs(t)))
    return unit(curve.velocity(t + inward))


def turns(v: Complex) -> Real:
    """Total absolute turn along each row of velocities, rad; standing still turns nothing."""
    ratio = v[:, 1:] * np.conj(v[:, :-1])
    total: Real = np.abs(np.angle(np.where(ratio == 0, 1, ratio))).sum(axis=1)
    return total
