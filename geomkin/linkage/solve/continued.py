"""The branches of a motion's dyads: by sign, near given points, or followed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ...plane.vec import Array
from .branch import Chosen
from .change_points import change_points
from .driver_dyads import Driven
from .dyads import Dyad
from ..linkage import Linkage
from .iterate import Loops
from .row import Row
from .steps import Pass, Step, Turned

# Gap, as a share of the reach, below which rounding alone keeps it from zero: true meetings come out below 2e-16 behind
# chains of five dyads. Larger takes a near miss for a meeting, smaller misses meetings behind a dyad at bad angles.
ROUNDING = 1e-14


def reach_of(linkage: Linkage) -> float:
    """A length, mm, that no two points of the linkage can be apart while it is together."""
    bodies = sum(
        max((float(np.abs(z).max()) for z in points.values()), default=0) for points in linkage.bodies.values()
    )
    return 2 * (bodies + sum(abs(s.point) + abs(s.through) for s in linkage.sliders))


def sides_along(
    linkage: Linkage, steps: Sequence[Step], drive: Array, linkages: tuple[int, ...], branch: Chosen
) -> Row:
    """The row of a motion with the side of every dyad."""
    reach = reach_of(linkage)
    row = Row(linkage, steps, drive, linkages, 1.0 if isinstance(steps[0], Turned) else reach, {})
    with np.errstate(all="ignore"):
        for k, step in enumerate(steps):
            if not isinstance(step, Dyad):
                continue
            sign: Array | int = branch.signs.get(step.joint, branch.default)
            told = _nearest(row, k, branch.near) if step.joint not in branch.signs else None
            frame, sign = told or (0, sign)
            row.sides[step.joint] = sign
            if branch.follow and drive.size and not isinstance(step, Driven):
                row.sides[step.joint] = change_points(row, k, sign, drive[frame:], ROUNDING * reach)
            elif branch.follow and isinstance(step, Driven) and told is None:
                row.sides[step.joint] = step.sign_from(drive, int(sign))
    return row


def _nearest(row: Row, k: int, near: Mapping[str, complex]) -> tuple[int, Array] | None:
    """The first frame at which a dyad closes, and the side on which what it places there is nearest to given points."""
    later = (j for j, step in enumerate(row.steps) if j > k and isinstance(step, Dyad | Loops))
    end = next(later, len(row.steps))
    ahead = np.exp(1j * np.radians(row.linkage.ground_angle_deg))
    for frames in (row.drive[:1], row.drive):
        before = row.placed(frames, k)
        offs = []
        for side in (1, -1):
            p = Pass(dict(before.origin), dict(before.turn), before.drive, dict(before.kept))
            for step in row.steps[k:end]:
                step.place(p, side)
            own = [
                p.origin[body] + p.turn[body] * row.linkage.bodies[body][name] - (z - row.linkage.origin) / ahead
                for body in set(p.origin) - set(before.origin)
                for name, z in near.items()
                if name in row.linkage.bodies[body]
            ]
            if not own:
                return None
            offs.append(np.sum(np.abs(own) ** 2, axis=0))
        known = np.isfinite(offs[0]) | np.isfinite(offs[1])
        share = known.reshape(len(frames), -1).mean(axis=1)
        if share.size and share.any():
            frame = int(np.argmax(share))
            return frame, np.where(offs[1][frame] < offs[0][frame], -1, 1)
    return None
