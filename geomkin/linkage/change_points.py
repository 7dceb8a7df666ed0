"""Where the two branches of a dyad meet and the motion runs on from one into the other: its change points."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..plane.vec import Array
from .dyads import Dyad
from .meetings import BESIDE, Meetings
from .row import Row

# Turn of a body between two nodes, rad, above which more are put between them, and how often at most: a body that
# whips round beside a toggle would carry later dyads past a change point. Coarser, and one may be missed.
WHIP, HALVINGS = 0.2, 24
# Nodes that a minimum is looked for with, and how often. Each look narrows it to an eighth, to the last bit at last.
NODES, LOOKS = 17, 22
# Units of drive within which a first frame stands at a change point. Where a gap vanishes twice its place is known to
# the root of rounding: with less, and the first frame may be taken for one behind it.
AT = 1e-7


def change_points(row: Row, k: int, start: Array | int, drive: Array, gap: float) -> Meetings:
    """The sign of the dyad that is step k over all of the row's range: `start` at drive[0], then as the motion runs on.

    Two branches meet where a gap of the dyad vanishes: its least values are found to rounding, and whether one is
    zero is decided by `gap`, mm, alone. Where gaps come near and do not vanish the branches pass each other, however near.
    """
    step = row.steps[k]
    assert isinstance(step, Dyad)
    first = float(drive[0])
    found_at: list[float] = []
    found_of: list[int] = []
    nodes = _nodes(row, k)

    def gaps_at(q: Array) -> list[Array]:
        """Each gap at drives (n,) as (n, linkages); infinite where steps before this one are open."""
        found = [np.broadcast_to(g, (len(q), *row.linkages)) for g in step.gaps(row.placed(q, k))]
        return [np.where(np.isfinite(g), g, np.inf).reshape(len(q), -1) for g in found]

    for which, values in enumerate(gaps_at(nodes)):

        def gap_at(q: Array, of: Array, which: int = which) -> Array:
            """This gap at drives (m, nodes) of the linkages (m,)."""
            return gaps_at(q.ravel())[which].reshape(*q.shape, -1)[np.arange(len(q)), :, of]

        middle = values[1:-1]
        low = (middle < values[:-2]) & (middle <= values[2:]) & (middle >= -gap)
        at, of = np.nonzero(low)
        at, of = _zeros(nodes[at], nodes[at + 2], of, gap_at, gap)
        if at.size:
            # Where a gap vanishes to fourth order, its root does to second: the branches touch and do not cross.
            beyond = gap_at(at[:, None] + BESIDE * row.unit * np.array([1, 2]), of)
            through = ~(beyond[:, 1] > 8 * beyond[:, 0])
            found_at += at[through].tolist()
            found_of += of[through].tolist()
    places = np.array(found_at)
    # A motion that starts at a change point starts just after it.
    moves = drive[drive != first] - first
    towards = float(np.sign(moves[0])) if moves.size else 1.0
    places = np.where(np.abs(places - first) <= AT * row.unit, first - towards * AT * row.unit, places)
    return Meetings(start, first, places, np.array(found_of, dtype=int), gap, row.unit, row.linkages)


def _nodes(row: Row, k: int) -> Array:
    """The row's nodes, and more of them where a body placed by the first k steps turns fast or stops being closed."""
    nodes = row.nodes()
    for _ in range(HALVINGS):
        turns = [t for t in row.placed(nodes, k).turn.values() if np.ndim(t)]
        jump = np.zeros(len(nodes) - 1, dtype=bool)
        for turn in turns:
            closed = np.isfinite(turn)
            far = (np.abs(np.diff(turn, axis=0)) > WHIP) | (closed[1:] != closed[:-1])
            jump |= far.reshape(len(jump), -1).any(axis=1)
        more = 0.5 * (nodes[:-1] + nodes[1:])[jump]
        if not more.size:
            break
        nodes = np.unique(np.concatenate([nodes, more]))
    return nodes


def _zeros(
    low: Array, high: Array, of: Array, gap_at: Callable[[Array, Array], Array], gap: float
) -> tuple[Array, Array]:
    """Where between `low` and `high`, (m,), of the linkages `of` a gap's least value is zero, and of which."""
    share = np.linspace(0, 1, NODES)
    at, least = low, np.zeros(len(low))
    for _ in range(LOOKS):
        if not low.size or np.all(high - low <= 4 * np.spacing(np.abs(at))):
            break
        nodes = low[:, None] + (high - low)[:, None] * share
        values = gap_at(nodes, of)
        best, rows = values.argmin(axis=1), np.arange(len(nodes))
        left, right = np.maximum(best - 1, 0), np.minimum(best + 1, NODES - 1)
        least = values[rows, best]
        span = np.maximum(values[rows, left], values[rows, right]) - least
        # A gap that varies less than its own size from here to the next nodes is not going to vanish between them.
        may = (least >= -gap) & ((least <= gap) | (span > 0.5 * least))
        at, low, high = nodes[rows, best][may], nodes[rows, left][may], nodes[rows, right][may]
        of, least = of[may], least[may]
    zero = np.abs(least) <= gap
    return at[zero], of[zero]
