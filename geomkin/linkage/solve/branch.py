"""The branch of each dyad: by sign, nearest to given positions of pins, or followed along the motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Literal

import numpy as np

from ...core.errors import DesignError, shown
from ...core.records import record
from ...plane.vec import Real, Whole
from ..linkage import Linkage

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
