"""From sizes and drive to motion."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...arguments import Reals, checked
from ...errors import DesignError
from ...plane.vec import Real
from ..linkage import AnyLinkage, Linkage
from ..motion import Motion
from .branch import Branch, Chosen, chosen
from .dyads import Dyad
from .formulas import Timing
from .loops import Loops
from .placement import Placement
from .plan import plan
from .solution import LinkageSolution


@checked
def move(
    linkage: AnyLinkage, drive: Reals, branch: Branch = 1, speed: Reals = 1.0, acceleration: Reals = 0.0
) -> Motion:
    """Motion of a linkage whose driver stands at `drive`: rad from the ground's x axis, mm where a slider drives.

    drive: (frames,). speed and acceleration of the driver, rad/s and rad/s2 or mm/s and mm/s2: numbers or
    (frames,). branch: +1 or -1 for all dyads, or for each by the name of its inner joint (+1 where not
    named): +1 puts the joint left of the line from the first body's outer pin to the second's. A point's name with
    its place, a complex number in mm, takes the branch nearest to that at the first frame at which its dyad closes, and
    starts bodies that are no chain of dyads as the linkage's `estimate` does. "follow" starts at +1, `Follow` at any of
    these, and keeps the smooth continuation, at any step: through a change point, where the branches meet, and past a
    place where they only come near. A frame that cannot be reached is nan with closed False. At a true dead centre
    of the driver the rates are not finite. Dyads are solved in closed form, whatever else by Newton's method on their
    loop equations; rates come by the chain rule from kinematic coefficients.
    """
    general = linkage.linkage
    q = np.asarray(drive, dtype=float)
    q = q if q.ndim else q[None]
    if q.ndim != 1:
        raise DesignError("drive", "found something else than one row of finite numbers", "give (frames,) of rad or mm")
    timing = Timing(_time("speed", speed, q, general), _time("acceleration", acceleration, q, general))
    asked = chosen(branch)
    return Motion(general, q, timing, LinkageSolution(general, _planned(general, asked), q, asked, timing))


def _time(name: str, told: Reals, drive: Real, linkage: Linkage) -> Real:
    """Speed or acceleration as a number, or over all frames and linkages."""
    values = np.asarray(told, dtype=float)
    if not values.ndim:
        return values
    if values.shape != drive.shape:
        raise DesignError(name, f"found shape {values.shape}", f"give a number or {drive.shape} of them")
    return values.reshape(-1, *(1,) * len(linkage.shape))


def planned(linkage: Linkage, branch: Branch) -> tuple[Placement, ...]:
    """How the bodies are placed on a branch; DesignError for joints or points that the linkage has not."""
    return _planned(linkage, chosen(branch))


def _planned(linkage: Linkage, asked: Chosen) -> tuple[Placement, ...]:
    told = replace(linkage, estimate={**linkage.estimate, **asked.near}) if asked.near else linkage
    placements = plan(told, asked.follow)
    if asked.near and not any(isinstance(one, Loops) for one in placements):
        # Only what is iterated starts from places. Any other plan is the linkage's own, by which its formulas are kept.
        placements = plan(linkage, asked.follow)
    if asked.signs or asked.near:
        asked.check(linkage, [one.joint for one in placements if isinstance(one, Dyad)])
    return placements
