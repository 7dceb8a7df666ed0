"""The branch of each dyad: by sign, nearest to given pins, or followed along the motion; where two branches meet."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import Literal

import numpy as np

from ...core.errors import DesignError, shown
from ...core.records import record
from ...plane.vec import Complex, Real, Whole
from ..linkage import Linkage
from .dyads import Dyad
from .loops import Loops
from .placement import Coefficients, Placement, Poses, RevoluteInput

# Units of drive around a meeting within which a gap of the size of rounding counts as closed. With a smaller value
# frames beside a meeting of slowly turning links are open by rounding; with a larger one a truly open gap is closed.
BESIDE = 1e-3

Start = int | Mapping[str, int | complex]


@record
class Continuation:
    """Branches that continue smoothly from the first frame, also through change points.

    Parameters
    ----------
    start : {+1, -1} or mapping
        Branches of the first frame: +1 or -1 for all dyads, or a mapping as `move` takes it: signs by joint,
        or positions of pins, complex, mm. The text "follow" is short for Continuation(1).

    Raises
    ------
    DesignError
        If `start` is none of these.

    See Also
    --------
    move, driver_limits
    """

    start: Start = 1

    def __post_init__(self) -> None:
        _parsed(self.start, "start", True)


@record(eq=False)
class BranchSpec:
    """A branch as `move` understands it.

    default: the sign of a dyad that neither `branch` (signs by joint) nor `branch_points` (positions of points, mm)
    determines. follow: whether these are only the start. field: the argument's name in error messages.
    """

    default: int
    branch: Mapping[str, int]
    branch_points: Mapping[str, complex]
    follow: bool
    field: str = "branch"

    def sign(self, joint: str) -> int:
        """Sign of a dyad by its inner joint."""
        return self.branch.get(joint, self.default)

    def check(self, linkage: Linkage, joints: Sequence[str]) -> None:
        """Raise DesignError if a sign belongs to no dyad, or a position to no point."""
        unknown = [name for name in self.branch if name not in joints]
        if unknown:
            raise DesignError(
                self.field, f"found {shown(unknown[0])}", f"give signs of {', '.join(joints) or 'none'}", "unknown-key"
            )
        points = dict.fromkeys(p for body in list(linkage.bodies)[1:] for p in linkage.bodies[body])
        unknown = [name for name in self.branch_points if name not in points]
        if unknown:
            raise DesignError(
                self.field, f"found {shown(unknown[0])}", f"give places of {', '.join(points)}", "unknown-key"
            )


# One sign for all dyads, the most frequent case.
PLAIN = {sign: BranchSpec(sign, {}, {}, False) for sign in (1, -1)}
Branch = int | Literal["follow"] | Mapping[str, int | complex] | Continuation | BranchSpec


def as_branch_spec(branch: Branch) -> BranchSpec:
    """The branch as a BranchSpec; DesignError if it is not a branch."""
    if type(branch) is int and branch in PLAIN:
        return PLAIN[branch]
    if isinstance(branch, BranchSpec):
        return branch
    if isinstance(branch, Continuation):
        return _parsed(branch.start, "start", True)
    if isinstance(branch, str) and branch == "follow":
        return BranchSpec(1, {}, {}, True)
    return _parsed(branch, "branch", False)


def _parsed(start: object, field: str, follow: bool) -> BranchSpec:
    if isinstance(start, Mapping):
        signs = {name: int(sign) for name, sign in start.items() if _is_sign(sign)}
        points = {name: complex(z) for name, z in start.items() if isinstance(z, complex) and np.isfinite(z)}
        if len(signs) + len(points) == len(start):
            return BranchSpec(1, signs, points, follow)
        wrong = next(value for name, value in start.items() if name not in signs and name not in points)
        remedy = "give +1 or -1, or a place as a finite complex number, mm"
        raise DesignError(field, f"found {shown(wrong)}", remedy, "wrong-type")
    if _is_sign(start):
        return BranchSpec(1 if start == 1 else -1, {}, {}, follow)
    words = "+1, -1" if follow else '+1, -1, "follow"'
    remedy = f"give {words}, or a table of signs by joint or of places of pins as complex numbers"
    raise DesignError(field, f"found {shown(start)}", remedy, "wrong-type")


def _is_sign(value: object) -> bool:
    real = isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool)
    return bool(real and value in (1, -1))


@record(eq=False)
class FollowedBranch:
    """The sign of a dyad whose branch is followed: `start` at the drive `first`, changing at each meeting.

    A meeting is a drive at which the dyad's two branches coincide, as at a change point. at: drives of the meetings,
    (n,); of: the linkage that each belongs to, as a flat index. gap: mm below which a gap counts as zero. unit: of the
    drive, rad or mm. linkages: shape of the sizes.
    """

    start: Whole | int
    first: float
    at: Real
    of: Whole
    gap: float
    unit: float
    linkages: tuple[int, ...]

    def sign(self, q: Real, gaps: tuple[Real, ...]) -> Whole:
        """Signs, (drives, linkages), of a dyad with these gaps at the drives q, (drives, 1); 0 at a meeting."""
        row, count = q.reshape(-1), int(np.prod(self.linkages))
        changes, beside = np.zeros((count, len(row)), dtype=int), np.zeros((count, len(row)), dtype=bool)
        for k in np.unique(self.of).tolist():
            at = np.sort(self.at[self.of == k])
            passed, ends = np.searchsorted(at, row), np.concatenate([[-np.inf], at, [np.inf]])
            changes[k] = passed - np.searchsorted(at, self.first)
            beside[k] = np.minimum(row - ends[passed], ends[passed + 1] - row) < BESIDE * self.unit
        signs = self.start * np.where(changes % 2, -1, 1).T.reshape(-1, *self.linkages)
        least = np.fmin.reduce(np.broadcast_arrays(*gaps))
        meets = beside.T.reshape(signs.shape) & (least <= 0) & (least >= -self.gap)
        return np.where(meets, 0, signs)


# Steps in which branches are followed: rad, and for a slider as a share of the linkage's extent. With coarser steps
# two adjacent change points are both missed.
FINEST_TURN, FINEST_SHARE = np.pi / 180, 1 / 2880
# Upper limit of steps times linkages: more take a gigabyte.
MOST = 400_000
# Rotation of a body between two nodes, rad, above which the interval is halved, and the number of halvings: a body that
# turns fast near a toggle would move later dyads past a change point unnoticed.
WHIP, HALVINGS = 0.2, 24
# Nodes of one search for a minimum, and number of searches. Each narrows it to an eighth, the last one to a bit.
NODES, LOOKS = 17, 22
# Units of drive. APART: distance from a flat zero to the two points whose values locate it; at a larger distance the
# next order of the curve shifts it, at a smaller one rounding does. AT: a first frame within this distance is at a
# change point.
APART, AT = 1e-4, 1e-7

# The fixed body's origin and its derivatives, its direction, and the derivatives of its angle; read-only, shared.
ORIGIN, DIRECTION, AT_REST = (np.broadcast_to(number, ()) for number in (0j, 1 + 0j, 0.0))


@record(eq=False)
class DriveRange:
    """A linkage's placements at any drives of a range that contains `drive`, with the branches known so far, by joint.

    linkages: shape of the sizes; unit: of the drive, rad, or the extent in mm.
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
        """Drives as a column against all linkages, with only the fixed body placed."""
        column = q.reshape(-1, *(1,) * len(self.linkages)) if self.linkages else q
        return Poses({self.linkage.ground: ORIGIN}, {self.linkage.ground: DIRECTION}, column, {}, self._before_loops)

    def _posed(self, p: Poses, placements: Sequence[Placement]) -> Poses:
        # Open poses are nan and singular ones are not finite, both intentionally.
        with np.errstate(all="ignore"):
            for placement in placements:
                placement.place(p, self.sign(placement, p))
        return p

    def first(self, p0: Poses) -> Coefficients:
        """First kinematic coefficients at the poses."""
        p1 = self._coefficients()
        with np.errstate(all="ignore"):
            for placement in self.placements:
                placement.first(p0, p1)
        return p1

    def second(self, p0: Poses, p1: Coefficients) -> Coefficients:
        """Second kinematic coefficients at the poses."""
        p2 = self._coefficients()
        with np.errstate(all="ignore"):
            for placement in self.placements:
                placement.second(p0, p1, p2)
        return p2

    def _coefficients(self) -> Coefficients:
        return Coefficients({self.linkage.ground: ORIGIN}, {self.linkage.ground: AT_REST})

    def _before_loops(self, q: Real) -> tuple[Poses, Coefficients]:
        """Poses and first coefficients at drives (n,) of all placements except Loops.

        Loops call this while they are placed, where NumPy warnings are off already; another errstate would take an
        eighth of the time.
        """
        p0, p1 = self._at(q), self._coefficients()
        for placement in self._without_loops:
            placement.place(p0, self.sign(placement, p0))
        for placement in self._without_loops:
            placement.first(p0, p1)
        return p0, p1

    @cached_property
    def _without_loops(self) -> list[Placement]:
        return [placement for placement in self.placements if not isinstance(placement, Loops)]

    def sign(self, placement: Placement, p: Poses) -> Whole | int:
        """The sign of a placement, given the poses before it."""
        if not isinstance(placement, Dyad):
            return 1
        branch = self.branches[placement.joint]
        return branch.sign(p.drive, placement.gaps(p)) if isinstance(branch, FollowedBranch) else branch

    def nodes(self) -> Real:
        """Drives in even steps over the range and a little beyond it, within the linkage's extent."""
        low, high = float(self.drive.min()), float(self.drive.max())
        turns, count = isinstance(self.placements[0], RevoluteInput), int(np.prod(self.linkages))
        if not turns:
            low, high = (float(np.clip(q, -self.unit, self.unit)) for q in (low, high))
        step = FINEST_TURN if turns else FINEST_SHARE * self.unit
        parts = np.ceil((high - low) / step) + 2
        if parts * count > MOST and turns and count < MOST / 8:
            span, most = np.degrees(high - low), MOST // count - 3
            found = f"found {span:.6g} deg to follow a branch over"
            raise DesignError("drive", found, f"give at most {most} deg", "too-much-work")
        if parts * count > MOST:
            remedy = f"give at most {int(MOST // parts)} at a time"
            raise DesignError("bodies", f"found {count} linkages to follow", remedy, "too-much-work")
        return np.linspace(low - step, high + step, int(parts) + 1)


def change_points(drive_range: DriveRange, k: int, start: Whole | int, drive: Real, gap: float) -> FollowedBranch:
    """The branch of the k-th placement, a dyad, over the whole range: `start` at drive[0], then followed.

    Two branches meet where a gap of the dyad vanishes: its minima are found to rounding, and whether one is zero is
    decided by `gap`, mm. Where a gap comes near zero and does not vanish the branches pass each other, however near.
    """
    dyad = drive_range.placements[k]
    assert isinstance(dyad, Dyad)
    first = float(drive[0])

    def gaps_at(q: Real) -> Real:
        """Gaps, (gaps, drives, linkages), at drives (n,); infinite where a placement before this one is open."""
        broadcast = [np.broadcast_to(g, (len(q), *drive_range.linkages)) for g in dyad.gaps(drive_range.poses(q, k))]
        gaps = np.stack(broadcast).reshape(len(broadcast), len(q), -1)
        return np.where(np.isfinite(gaps), gaps, np.inf)

    nodes = _nodes(drive_range, k)
    values = gaps_at(nodes)
    middle = values[:, 1:-1]
    gap_of, at, linkage_of = np.nonzero((middle < values[:, :-2]) & (middle <= values[:, 2:]) & (middle >= -gap))

    def gap_at(q: Real, some: Whole) -> Real:
        """Gaps at drives (m, nodes), each row of its own gap and linkage: those of the minima `some`, (m,)."""
        drives = np.arange(q.size).reshape(q.shape)
        return gaps_at(q.ravel())[gap_of[some, None], drives, linkage_of[some, None]]

    places, some = _zeros(nodes[at], nodes[at + 2], gap_at, gap, APART * drive_range.unit)
    if places.size:
        # If a gap vanishes to fourth order, its root vanishes to second: the branches touch and do not cross.
        beyond = gap_at(places[:, None] + BESIDE * drive_range.unit * np.array([1, 2]), some)
        crossing = ~(beyond[:, 1] > 8 * beyond[:, 0])
        places, some = places[crossing], some[crossing]
    # A motion that starts at a change point starts just after it.
    moves = drive[drive != first] - first
    towards = float(np.sign(moves[0])) if moves.size else 1.0
    places = np.where(np.abs(places - first) <= AT * drive_range.unit, first - towards * AT * drive_range.unit, places)
    return FollowedBranch(start, first, places, linkage_of[some], gap, drive_range.unit, drive_range.linkages)


def _nodes(drive_range: DriveRange, k: int) -> Real:
    """The range's nodes, and more of them where one of the first k placements turns a body fast or opens."""

    def directions_at(q: Real) -> Complex:
        directions = [t for t in drive_range.poses(q, k).direction.values() if np.ndim(t)]
        spread = [np.broadcast_to(t, (len(q), *drive_range.linkages)).reshape(len(q), -1) for t in directions]
        return np.concatenate([np.zeros((len(q), 0)), *spread], axis=1)

    nodes = drive_range.nodes()
    directions = directions_at(nodes)
    for _ in range(HALVINGS):
        closed = np.isfinite(directions)
        jump = ((np.abs(np.diff(directions, axis=0)) > WHIP) | (closed[1:] != closed[:-1])).any(axis=1)
        more = 0.5 * (nodes[:-1] + nodes[1:])[jump]
        if not more.size:
            break
        order = np.argsort(np.concatenate([nodes, more]), kind="stable")
        nodes, directions = (
            np.concatenate([nodes, more])[order],
            np.concatenate([directions, directions_at(more)])[order],
        )
    return nodes


def _zeros(
    low: Real, high: Real, gap_at: Callable[[Real, Whole], Real], gap: float, apart: float
) -> tuple[Real, Whole]:
    """Minima between `low` and `high`, (m,), that are zero: their positions, and which of the m they are."""
    share, zeros, numbers = np.linspace(0, 1, NODES), [np.zeros(0)], [np.zeros(0, dtype=int)]
    rows_left = np.arange(len(low))
    for look in range(LOOKS):
        if not rows_left.size:
            break
        nodes = low[:, None] + (high - low)[:, None] * share
        values, rows = gap_at(nodes, rows_left), np.arange(len(nodes))
        best = values.argmin(axis=1)
        left, right = np.maximum(best - 1, 0), np.minimum(best + 1, NODES - 1)
        at, least = nodes[rows, best], values[rows, best]
        # Zero over the whole interval: a closer search gives no more digits.
        is_zero = (least >= -gap) & (values.max(axis=1) <= gap)
        last = (high - low <= 4 * np.spacing(np.abs(at))) | (look == LOOKS - 1)
        is_zero |= last & (np.abs(least) <= gap)
        if is_zero.any():
            beside = gap_at(at[is_zero, None] + apart * np.array([-1, 0, 1]), rows_left[is_zero])
            with np.errstate(all="ignore"):
                off = 0.5 * apart * (beside[:, 0] - beside[:, 2]) / (beside[:, 0] - 2 * beside[:, 1] + beside[:, 2])
            # A zero with a kink, as where a pin passes over a pivot, is already exact.
            flat = (np.abs(off) < apart) & ((high - low)[is_zero] > 1e-5 * apart)
            zeros.append(at[is_zero] + np.where(flat, off, 0.0))
            numbers.append(rows_left[is_zero])
        # A gap that varies by less than its own size up to the next nodes does not vanish between them.
        span = np.maximum(values[rows, left], values[rows, right]) - least
        may_vanish = ~is_zero & ~last & (least >= -gap) & ((least <= gap) | (span > 0.5 * least))
        low, high, rows_left = nodes[rows, left][may_vanish], nodes[rows, right][may_vanish], rows_left[may_vanish]
    return np.concatenate(zeros), np.concatenate(numbers)
