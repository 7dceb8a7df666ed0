"""Where the two branches of a dyad meet and the motion runs on from one into the other: its change points."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...plane.vec import Array
from .dyads import Dyad
from .meetings import BESIDE, Meetings
from .row import Row

# Turn of a body between two nodes, rad, above which more are put between them, and how often at most: a body that
# whips round beside a toggle would carry later dyads past a change point. Coarser, and one may be missed.
WHIP, HALVINGS = 0.2, 24
# Nodes that a least value is looked for with, and how often. Each look narrows it to an eighth, to the last bit at last.
NODES, LOOKS = 17, 22
# Units of drive: APART, from a flat zero to the two places beside it whose values tell where it is (farther, and the
# next order of the curve shifts it; nearer, and rounding does), and AT, within which a first frame stands at a change
# point, wider than either.
APART, AT = 1e-4, 1e-7


def change_points(row: Row, k: int, start: Array | int, drive: Array, gap: float) -> Meetings:
    """The sign of the dyad that is step k over all of the row's range: `start` at drive[0], then as the motion runs on.

    Two branches meet where a gap of the dyad vanishes: its least values are found to rounding, and whether one is
    zero is decided by `gap`, mm, alone. Where a gap comes near to zero and does not vanish the branches pass each
    other, however near.
    """
    step = row.steps[k]
    assert isinstance(step, Dyad)
    first = float(drive[0])

    def gaps_at(q: Array) -> Array:
        """Gaps, (gaps, drives, linkages), at drives (n,); infinite where steps before this one are open."""
        found = [np.broadcast_to(g, (len(q), *row.linkages)) for g in step.gaps(row.placed(q, k))]
        gaps = np.stack(found).reshape(len(found), len(q), -1)
        return np.where(np.isfinite(gaps), gaps, np.inf)

    nodes = _nodes(row, k)
    values = gaps_at(nodes)
    middle = values[:, 1:-1]
    which, at, of = np.nonzero((middle < values[:, :-2]) & (middle <= values[:, 2:]) & (middle >= -gap))

    def gap_at(q: Array, some: Array) -> Array:
        """Gaps at drives (m, nodes), each row of its own gap and linkage: those of the least values `some`, (m,)."""
        drives = np.arange(q.size).reshape(q.shape)
        return gaps_at(q.ravel())[which[some, None], drives, of[some, None]]

    places, some = _zeros(nodes[at], nodes[at + 2], gap_at, gap, APART * row.unit)
    if places.size:
        # Where a gap vanishes to fourth order, its root does to second: the branches touch and do not cross.
        beyond = gap_at(places[:, None] + BESIDE * row.unit * np.array([1, 2]), some)
        through = ~(beyond[:, 1] > 8 * beyond[:, 0])
        places, some = places[through], some[through]
    # A motion that starts at a change point starts just after it.
    moves = drive[drive != first] - first
    towards = float(np.sign(moves[0])) if moves.size else 1.0
    places = np.where(np.abs(places - first) <= AT * row.unit, first - towards * AT * row.unit, places)
    return Meetings(start, first, places, of[some], gap, row.unit, row.linkages)


def _nodes(row: Row, k: int) -> Array:
    """The row's nodes, and more of them where a body placed by the first k steps turns fast or stops being closed."""

    def turned(q: Array) -> Array:
        turns = [t for t in row.placed(q, k).turn.values() if np.ndim(t)]
        spread = [np.broadcast_to(t, (len(q), *row.linkages)).reshape(len(q), -1) for t in turns]
        return np.concatenate([np.zeros((len(q), 0)), *spread], axis=1)

    nodes = row.nodes()
    turns = turned(nodes)
    for _ in range(HALVINGS):
        closed = np.isfinite(turns)
        jump = ((np.abs(np.diff(turns, axis=0)) > WHIP) | (closed[1:] != closed[:-1])).any(axis=1)
        more = 0.5 * (nodes[:-1] + nodes[1:])[jump]
        if not more.size:
            break
        order = np.argsort(np.concatenate([nodes, more]), kind="stable")
        nodes, turns = np.concatenate([nodes, more])[order], np.concatenate([turns, turned(more)])[order]
    return nodes


def _zeros(
    low: Array, high: Array, gap_at: Callable[[Array, Array], Array], gap: float, apart: float
) -> tuple[Array, Array]:
    """Of least values between `low` and `high`, (m,), those that are zero: where, and which of the m."""
    share, found, numbers = np.linspace(0, 1, NODES), [np.zeros(0)], [np.zeros(0, dtype=int)]
    some = np.arange(len(low))
    for look in range(LOOKS):
        if not some.size:
            break
        nodes = low[:, None] + (high - low)[:, None] * share
        values, rows = gap_at(nodes, some), np.arange(len(nodes))
        best = values.argmin(axis=1)
        left, right = np.maximum(best - 1, 0), np.minimum(best + 1, NODES - 1)
        at, least = nodes[rows, best], values[rows, best]
        # Zero all over: nearer looks tell nothing more.
        told = (least >= -gap) & (values.max(axis=1) <= gap)
        last = (high - low <= 4 * np.spacing(np.abs(at))) | (look == LOOKS - 1)
        told |= last & (np.abs(least) <= gap)
        if told.any():
            beside = gap_at(at[told, None] + apart * np.array([-1, 0, 1]), some[told])
            with np.errstate(all="ignore"):
                off = 0.5 * apart * (beside[:, 0] - beside[:, 2]) / (beside[:, 0] - 2 * beside[:, 1] + beside[:, 2])
            # A zero that is no flat one, as where a pin runs over a pivot, is known to the last bit as it is.
            flat = (np.abs(off) < apart) & ((high - low)[told] > 1e-5 * apart)
            found.append(at[told] + np.where(flat, off, 0.0))
            numbers.append(some[told])
        # A gap that varies less than its own size from here to the next nodes is not going to vanish between them.
        span = np.maximum(values[rows, left], values[rows, right]) - least
        may = ~told & ~last & (least >= -gap) & ((least <= gap) | (span > 0.5 * least))
        low, high, some = nodes[rows, left][may], nodes[rows, right][may], some[may]
    return np.concatenate(found), np.concatenate(numbers)
