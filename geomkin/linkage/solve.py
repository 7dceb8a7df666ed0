"""From sizes and drive to motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal, Protocol

import numpy as np

from ..arguments import Reals, Sort, checked
from ..errors import DesignError
from .chain import Chain
from .dyads import Dyad
from .linkage import Linkage
from .motion import Motion, Timing
from .plan import plan

Branch = int | Literal["follow"] | Mapping[str, int]


class Named(Protocol):
    """Anything that makes the general linkage: FourBar, SliderCrank, ..., Linkage."""

    @property
    def linkage(self) -> Linkage: ...


def _is_linkage(value: Any) -> bool:
    # Of a class it would be the property itself.
    return isinstance(getattr(value, "linkage", None), Linkage)


AnyLinkage = Annotated[Named, Sort(_is_linkage, "a linkage, such as FourBar or Linkage")]
OneLinkage = Annotated[
    Named,
    Sort(lambda value: _is_linkage(value) and not value.linkage.many, "one linkage, its sizes numbers and no arrays"),
]


@checked
def move(
    linkage: AnyLinkage, drive: Reals, branch: Branch = 1, speed: Reals = 1.0, acceleration: Reals = 0.0
) -> Motion:
    """Motion of a linkage whose driver stands at `drive`: rad from the ground's x axis, mm where a slider drives.

    drive: (frames,). speed and acceleration of the driver, rad/s and rad/s2 or mm/s and mm/s2: numbers or
    (frames,). branch: +1 or -1 for all dyads, or for each by the name of its inner joint (+1 where not
    named): +1 puts the joint left of the line from the first body's outer pin to the second's; "follow" starts
    at +1 and keeps the smooth continuation, also through a change point, at any step (branches of a dyad
    that more than the driver moves count as meeting where they pass within a degree of it). A frame that cannot
    be reached is nan with closed False. At a true dead centre of the driver the rates are not finite.
    """
    general = linkage.linkage
    q = np.atleast_1d(np.asarray(drive, dtype=float))
    if q.ndim != 1 or not np.isfinite(q).all():
        raise DesignError("drive", "found something else than one row of finite numbers", "give (frames,) of rad or mm")
    steps = plan(general, branch == "follow")
    joints = [step.joint for step in steps if isinstance(step, Dyad)]
    solution = Chain(general, tuple(steps), q, _signs(branch, joints), branch == "follow")
    times = [np.asarray(v, dtype=float) for v in (speed, acceleration)]
    for name, v in zip(("speed", "acceleration"), times):
        if v.ndim and v.shape != q.shape:
            raise DesignError(name, f"found shape {v.shape}", f"give a number or {q.shape} of them")
    timing = Timing(*(v.reshape(-1, *(1,) * (len(solution.shape) - 1)) if v.ndim else v for v in times))
    return Motion(general, q, timing, solution)


def _signs(branch: Branch, joints: Sequence[str]) -> dict[str, int]:
    if isinstance(branch, Mapping):
        unknown = [name for name in branch if name not in joints]
        if unknown or any(value not in (1, -1) for value in branch.values()):
            raise DesignError(
                "branch", f"found {dict(branch)}", f"give +1 or -1 for any of {', '.join(joints) or 'none'}"
            )
        return {joint: branch.get(joint, 1) for joint in joints}
    if branch not in (1, -1, "follow"):
        raise DesignError("branch", f"found {branch!r}", 'give +1, -1, "follow", or a table of signs by joint')
    return dict.fromkeys(joints, 1 if branch == "follow" else int(branch))
