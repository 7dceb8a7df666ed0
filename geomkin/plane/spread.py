"""Places parameters along a curve so that every interval between them has the same error.

Both ways of simplifying a curve, chords and arcs, are this one task with another error.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .curve import AbstractCurve
from .vec import Array, unit

# Share of the tolerance that is aimed at. Larger, and what lies between two probes may exceed the
# tolerance; smaller costs intervals (half this margin in chords).
AIM = 0.998
# Cells per smooth piece in the first look. Fewer miss wiggles inside a piece; more cost time.
CELLS = 32
# Most that one interval may turn, rad. A chord or a pair of arcs that turns by more is no longer
# described by the laws of small intervals, and a closed curve might come back as a single one.
MOST_TURN = 2.2
# Corrections before the count is raised. Smooth pieces need two or three.
ROUNDS = 4

Judge = Callable[[Array], tuple[Array, Array]]


def spread(judge: Judge, breaks: Array, tolerance: float, order: int) -> Array:
    """The fewest parameters, first and last break included, whose intervals all keep the tolerance.

    judge(edges) gives each interval's error, mm, and its turn, rad; for small intervals the error
    falls with the `order`-th power of their length. The error is measured, never predicted, so the
    result keeps the tolerance wherever the judge looks.
    """
    grid = np.concatenate([b0 + (b1 - b0) * np.arange(CELLS) / CELLS for b0, b1 in zip(breaks, breaks[1:])])
    nodes = edges = np.append(grid, breaks[-1])
    filled = None
    slack = 1.0
    while True:
        for _ in range(ROUNDS):
            share = _share(*judge(edges), tolerance, order)
            nodes, filled = _fill(nodes, filled, edges, share)
            count = max(1, int(np.ceil(filled[-1] * slack - 1e-9)))
            if share.max() <= 1 and len(edges) - 1 <= count:
                return edges
            edges = _divide(nodes, filled, count)
        share = _share(*judge(edges), tolerance, order)
        over = int((share > 1).sum())
        if over <= len(breaks) - 2 + count // 100 or slack > 4:
            # An interval across a jump of curvature never settles: it costs one more, not a share of all.
            return _halve(judge, edges, breaks, tolerance)
        slack = slack * 1.01 + 0.5 / count


def _share(error: Array, turn: Array, tolerance: float, order: int) -> Array:
    """How many intervals each interval ought to be: 1 when it just keeps the tolerance."""
    return np.maximum((error / (AIM * tolerance)) ** (1 / order), turn / MOST_TURN)


def _fill(nodes: Array, filled: Array | None, edges: Array, share: Array) -> tuple[Array, Array]:
    """Intervals used up to each node, corrected so that each interval between edges uses its share."""
    total = np.concatenate([[0.0], np.cumsum(share)])
    if filled is None:
        return edges, total
    merged = np.union1d(nodes, edges)
    before = np.interp(merged, nodes, filled)
    at_edges = np.interp(edges, nodes, filled)
    i = np.clip(np.searchsorted(edges, merged, side="right") - 1, 0, len(share) - 1)
    span = at_edges[i + 1] - at_edges[i]
    part = np.where(span > 0, (before - at_edges[i]) / np.where(span > 0, span, 1), 0.0)
    return merged, total[i] + share[i] * np.clip(part, 0, 1)


def _divide(nodes: Array, filled: Array, count: int) -> Array:
    """`count` intervals of equal share."""
    if filled[-1] <= 0:
        return np.linspace(nodes[0], nodes[-1], count + 1)
    # Stretches that use nothing (straight ones) would make the inverse ambiguous.
    rising = filled + np.linspace(0, 1e-9 * filled[-1], len(filled))
    edges = np.interp(np.linspace(0, rising[-1], count + 1), rising, nodes)
    edges[0], edges[-1] = nodes[0], nodes[-1]
    return edges


def _halve(judge: Judge, edges: Array, breaks: Array, tolerance: float) -> Array:
    """Split what is over the tolerance, at a break inside it or in half, until nothing is or digits end."""
    for _ in range(60):
        error, turn = judge(edges)
        over = (error > tolerance) | (turn > 1.5 * MOST_TURN)
        low, high = edges[:-1][over], edges[1:][over]
        inside = np.searchsorted(breaks, low, side="right")
        at = breaks[np.minimum(inside, len(breaks) - 1)]
        merged = np.union1d(edges, np.where(at < high, at, 0.5 * (low + high)))
        if len(merged) == len(edges):
            return edges
        edges = merged
    return edges


def probes(edges: Array, shares: Array) -> Array:
    """Parameters (intervals, probes) at the given shares of each interval."""
    return edges[:-1, None] + np.diff(edges)[:, None] * shares


def direction(curve: AbstractCurve, t: Array, after: bool) -> Array:
    """Unit tangent just after, or just before, each parameter: one-sided at breaks, defined at cusps."""
    b = curve.breaks
    i = np.searchsorted(b, t, side="right" if after else "left")
    near = b[np.clip(i if after else i - 1, 0, len(b) - 1)]
    # Far enough into the piece to be on the right side of rounding, and not so far as to turn.
    inward = np.sign(near - t) * np.maximum(1e-12 * np.abs(near - t), 8 * np.spacing(np.abs(t)))
    return unit(curve.velocity(t + inward))


def turns(v: Array) -> Array:
    """Total absolute turn along each row of velocities, rad; standing still turns nothing."""
    ratio = v[:, 1:] * np.conj(v[:, :-1])
    return np.abs(np.angle(np.where(ratio == 0, 1, ratio))).sum(axis=1)
