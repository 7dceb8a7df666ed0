"""Where bodies are at any drives of a range, and the change points of it, at which the branches of a dyad meet."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property

import numpy as np

from ...core.errors import DesignError
from ...core.records import record
from ...plane.vec import Complex, Real, Whole
from ..linkage import Linkage
from .branch import BESIDE, FollowedBranch
from .dyads import Dyad
from .loops import Loops
from .placement import Coefficients, Placement, Poses, RevoluteInput

# Steps that branches are followed in: rad, and of a slider as a share of the linkage's reach.
# Coarser, and of two change points beside each other both are missed.
FINEST_TURN, FINEST_SHARE = np.pi / 180, 1 / 2880
# Such steps times linkages at most: more take a gigabyte.
MOST = 400_000
# Turn of a body between two nodes, rad, above which more are put between them, and how often at most: a body that
# whips round beside a toggle would carry later dyads past a change point. Coarser, and one may be missed.
WHIP, HALVINGS = 0.2, 24
# Nodes that a least value is looked for with, and how often. Each look narrows it to an eighth, the last to a bit:
# fewer, and a zero is known to fewer digits.
NODES, LOOKS = 17, 22
# Units of drive: APART, from a flat zero to the two places beside it whose values tell where it is (farther, and the
# next order of the curve shifts it; nearer, and rounding does), and AT, within which a first frame stands at a change
# point, wider than either.
APART, AT = 1e-4, 1e-7

# Of the fixed body: its origin, with the derivatives of that, its direction, and the derivatives of its angle. They are
# made once for all poses and cannot be written over.
ORIGIN, AHEAD, STILL = (np.broadcast_to(number, ()) for number in (0j, 1 + 0j, 0.0))


@record(eq=False)
class DriveRange:
    """A linkage's placements at any drives of a range that holds `drive`, with the branches found so far, by joint.

    linkages: shape of the sizes; unit: of the drive, rad or the reach in mm.
    """

    linkage: Linkage
    placements: Sequence[Placement]
    drive: Real
    linkages: tuple[int, ...]
    unit: float
    branches: Mapping[str, Whole | int | FollowedBranch]

    def poses(self, q: Real, count: int | None = None) -> Poses:
        """Poses at drives (n,) by all placements, or the first `count`."""
        return self._posed(self._at(q), self.placements[:count])

    def _at(self, q: Real) -> Poses:
        """Drives against all linkages, with nothing placed but the fixed body."""
        column = q.reshape(-1, *(1,) * len(self.linkages)) if self.linkages else q
        return Poses({self.linkage.ground: ORIGIN}, {self.linkage.ground: AHEAD}, column, {}, self._before_loops)

    def _posed(self, p: Poses, placements: Sequence[Placement]) -> Poses:
        # What cannot close is nan, and what is singular is not finite: both are meant.
        with np.errstate(all="ignore"):
            for placement in placements:
                placement.place(p, self.sign(placement, p))
        return p

    def first(self, p0: Poses) -> Coefficients:
        """First kinematic coefficients at the poses."""
        p1 = self._still()
        with np.errstate(all="ignore"):
            for placement in self.placements:
                placement.first(p0, p1)
        return p1

    def second(self, p0: Poses, p1: Coefficients) -> Coefficients:
        """Second kinematic coefficients at the poses."""
        p2 = self._still()
        with np.errstate(all="ignore"):
            for placement in self.placements:
                placement.second(p0, p1, p2)
        return p2

    def _still(self) -> Coefficients:
        return Coefficients({self.linkage.ground: ORIGIN}, {self.linkage.ground: STILL})

    def _before_loops(self, q: Real) -> tuple[Poses, Coefficients]:
        """Poses and first coefficients at drives (n,) of all placements but those that look between the frames.

        These ask while they are placed, where NumPy does not warn: to say so again takes an eighth of the time.
        """
        p0, p1 = self._at(q), self._still()
        for placement in self._known:
            placement.place(p0, self.sign(placement, p0))
        for placement in self._known:
            placement.first(p0, p1)
        return p0, p1

    @cached_property
    def _known(self) -> list[Placement]:
        return [placement for placement in self.placements if not isinstance(placement, Loops)]

    def sign(self, placement: Placement, p: Poses) -> Whole | int:
        """The sign that a placement takes where those before it stand."""
        if not isinstance(placement, Dyad):
            return 1
        branch = self.branches[placement.joint]
        return branch.sign(p.drive, placement.gaps(p)) if isinstance(branch, FollowedBranch) else branch

    def nodes(self) -> Real:
        """Drives in even steps over the whole range and a little beyond it, within the linkage's reach."""
        low, high = float(self.drive.min()), float(self.drive.max())
        turns, many = isinstance(self.placements[0], RevoluteInput), int(np.prod(self.linkages))
        if not turns:
            low, high = (float(np.clip(q, -self.unit, self.unit)) for q in (low, high))
        finest = FINEST_TURN if turns else FINEST_SHARE * self.unit
        parts = np.ceil((high - low) / finest) + 2
        if parts * many > MOST and turns and many < MOST / 8:
            found, most = np.degrees(high - low), MOST // many - 3
            raise DesignError(
                "drive", f"found {found:.6g} deg to follow a branch over", f"give at most {most} deg", "too-much-work"
            )
        if parts * many > MOST:
            raise DesignError(
                "bodies",
                f"found {many} linkages to follow",
                f"give at most {int(MOST // parts)} at a time",
                "too-much-work",
            )
        return np.linspace(low - finest, high + finest, int(parts) + 1)


def change_points(whole: DriveRange, k: int, start: Whole | int, drive: Real, gap: float) -> FollowedBranch:
    """The branch of the k-th placement, a dyad, over all of the range: `start` at drive[0], then as the motion runs on.

    Two branches meet where a gap of the dyad vanishes: its least values are found to rounding, and whether one is
    zero is decided by `gap`, mm, alone. Where a gap comes near to zero and does not vanish the branches pass each
    other, however near.
    """
    dyad = whole.placements[k]
    assert isinstance(dyad, Dyad)
    first = float(drive[0])

    def gaps_at(q: Real) -> Real:
        """Gaps, (gaps, drives, linkages), at drives (n,); infinite where a placement before this one is open."""
        found = [np.broadcast_to(g, (len(q), *whole.linkages)) for g in dyad.gaps(whole.poses(q, k))]
        gaps = np.stack(found).reshape(len(found), len(q), -1)
        return np.where(np.isfinite(gaps), gaps, np.inf)

    nodes = _nodes(whole, k)
    values = gaps_at(nodes)
    middle = values[:, 1:-1]
    gap_of, at, linkage_of = np.nonzero((middle < values[:, :-2]) & (middle <= values[:, 2:]) & (middle >= -gap))

    def gap_at(q: Real, some: Whole) -> Real:
        """Gaps at drives (m, nodes), each row of its own gap and linkage: those of the least values `some`, (m,)."""
        drives = np.arange(q.size).reshape(q.shape)
        return gaps_at(q.ravel())[gap_of[some, None], drives, linkage_of[some, None]]

    places, some = _zeros(nodes[at], nodes[at + 2], gap_at, gap, APART * whole.unit)
    if places.size:
        # Where a gap vanishes to fourth order, its root does to second: the branches touch and do not cross.
        beyond = gap_at(places[:, None] + BESIDE * whole.unit * np.array([1, 2]), some)
        through = ~(beyond[:, 1] > 8 * beyond[:, 0])
        places, some = places[through], some[through]
    # A motion that starts at a change point starts just after it.
    moves = drive[drive != first] - first
    towards = float(np.sign(moves[0])) if moves.size else 1.0
    places = np.where(np.abs(places - first) <= AT * whole.unit, first - towards * AT * whole.unit, places)
    return FollowedBranch(start, first, places, linkage_of[some], gap, whole.unit, whole.linkages)


def _nodes(whole: DriveRange, k: int) -> Real:
    """The range's nodes, and more of them where a body of the first k placements turns fast or stops being closed."""

    def turned(q: Real) -> Complex:
        turns = [t for t in whole.poses(q, k).turn.values() if np.ndim(t)]
        spread = [np.broadcast_to(t, (len(q), *whole.linkages)).reshape(len(q), -1) for t in turns]
        return np.concatenate([np.zeros((len(q), 0)), *spread], axis=1)

    nodes = whole.nodes()
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
    low: Real, high: Real, gap_at: Callable[[Real, Whole], Real], gap: float, apart: float
) -> tuple[Real, Whole]:
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
