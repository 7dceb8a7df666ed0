"""Which of a dyad's two branches it closes on: by sign, near given pins, or kept by the motion itself."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Literal

import numpy as np

from ...core.errors import DesignError, shown
from ...core.records import record
from ...plane.vec import Real, Whole
from ..linkage import Linkage

# Units of drive about a meeting within which a gap of rounding is taken for none. Smaller, and frames beside a meeting
# of slowly turning links are open by rounding; larger, and a gap that is really open there is taken for closed.
BESIDE = 1e-3

Start = int | Mapping[str, int | complex]


@record
class Continuation:
    """Branches that run smoothly on from the first frame, also through change points.

    start: those of the first frame: +1 or -1 for all dyads, or a table as `move` takes it: signs by joint,
    places of pins, mm. "follow" is short for Continuation(1).
    """

    start: Start = 1

    def __post_init__(self) -> None:
        _told(self.start, "start", True)


@record(eq=False)
class BranchSpec:
    """A branch as asked for.

    default: the sign of a dyad that neither signs, by joint, nor near, places of points in mm, tells of. follow: those
    are where it starts. field: what a refusal calls the table.
    """

    default: int
    branch: Mapping[str, int]
    branch_points: Mapping[str, complex]
    follow: bool
    field: str = "branch"

    def sign(self, joint: str) -> int:
        """Of a dyad by its inner joint, as far as signs tell of it."""
        return self.branch.get(joint, self.default)

    def check(self, linkage: Linkage, joints: Sequence[str]) -> None:
        """Raise DesignError for a sign of no dyad, or a place of no point."""
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


# One sign for all dyads, as most motions have it.
PLAIN = {sign: BranchSpec(sign, {}, {}, False) for sign in (1, -1)}
Branch = int | Literal["follow"] | Mapping[str, int | complex] | Continuation | BranchSpec


def chosen(branch: Branch) -> BranchSpec:
    """What a branch asks for; DesignError for what is none."""
    if type(branch) is int and branch in PLAIN:
        return PLAIN[branch]
    if isinstance(branch, BranchSpec):
        return branch
    if isinstance(branch, Continuation):
        return _told(branch.start, "start", True)
    if isinstance(branch, str) and branch == "follow":
        return BranchSpec(1, {}, {}, True)
    return _told(branch, "branch", False)


def _told(start: object, field: str, follow: bool) -> BranchSpec:
    if isinstance(start, Mapping):
        signs = {name: int(sign) for name, sign in start.items() if _is_sign(sign)}
        near = {name: complex(z) for name, z in start.items() if isinstance(z, complex) and np.isfinite(z)}
        if len(signs) + len(near) == len(start):
            return BranchSpec(1, signs, near, follow)
        wrong = next(value for name, value in start.items() if name not in signs and name not in near)
        raise DesignError(
            field, f"found {shown(wrong)}", "give +1 or -1, or a place as a finite complex number, mm", "wrong-type"
        )
    if _is_sign(start):
        return BranchSpec(1 if start == 1 else -1, {}, {}, follow)
    words = "+1, -1" if follow else '+1, -1, "follow"'
    remedy = f"give {words}, or a table of signs by joint or of places of pins as complex numbers"
    raise DesignError(field, f"found {shown(start)}", remedy)


def _is_sign(value: object) -> bool:
    real = isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool)
    return bool(real and value in (1, -1))


@record(eq=False)
class FollowedBranch:
    """The sign of a dyad whose branch is followed: `start` at the drive `first`, the other beyond each meeting.

    A meeting is where the dyad's two branches are one, as at a change point. at: drives of the meetings, (n,); of: the
    linkage that each belongs to, in a flat count. gap: mm below which rounding alone keeps a gap from zero. unit: of
    the drive, rad or mm. linkages: shape of the sizes.
    """

    start: Whole | int
    first: float
    at: Real
    of: Whole
    gap: float
    unit: float
    linkages: tuple[int, ...]

    def sign(self, q: Real, gaps: tuple[Real, ...]) -> Whole:
        """Signs, (drives, linkages), where the dyad has these gaps at the drives q, (drives, 1); 0 at a meeting."""
        row, many = q.reshape(-1), int(np.prod(self.linkages))
        changes, beside = np.zeros((many, len(row)), dtype=int), np.zeros((many, len(row)), dtype=bool)
        for own in np.unique(self.of).tolist():
            at = np.sort(self.at[self.of == own])
            passed, ends = np.searchsorted(at, row), np.concatenate([[-np.inf], at, [np.inf]])
            changes[own] = passed - np.searchsorted(at, self.first)
            beside[own] = np.minimum(row - ends[passed], ends[passed + 1] - row) < BESIDE * self.unit
        signs = self.start * np.where(changes % 2, -1, 1).T.reshape(-1, *self.linkages)
        least = np.fmin.reduce(np.broadcast_arrays(*gaps))
        meets = beside.T.reshape(signs.shape) & (least <= 0) & (least >= -self.gap)
        return np.where(meets, 0, signs)
