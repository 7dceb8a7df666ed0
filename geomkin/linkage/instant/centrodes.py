"""Centrodes: the two curves, one on a body and one on the ground, that roll on each other as the body moves."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ...core.errors import DesignError
from ...core.records import record
from ...plane.curve import AbstractCurve
from ...plane.vec import Complex, Real, Whole, dot
from ..coupler_curve import motion_at
from ..linkage import OneLinkage
from ..motion import Motion
from ..solve.branch import Branch
from .centres import InstantCentre, instant_centre
from .inflection import inflection_circle

# Largest way of a centre from one frame to the next, in ways that its own speed would take it. Larger, and a linkage
# that changes its branch draws a false line; smaller, and a true curve in coarse steps is broken.
LEAP = 4.0
# Way, as a share of the linkage's size, that counts as none. Smaller, and rounding breaks the curve of a centre that
# rests; larger, and leaps of tiny centrodes are not seen.
ROUNDING = 1e-9


@record(checked=True, eq=False)
class Centrodes:
    """Path of a body's instant centre on the ground and on the body, over the frames; the second rolls on the first.

    DesignError for a body that the linkage has not, as soon as a curve is asked for. Rolling: Dijksman, Motion
    Geometry of Mechanisms, 1976; where the curves break is derived here.
    """

    motion: Motion
    body: str

    @cached_property
    def centre(self) -> InstantCentre:
        """The body's instant centre on the ground, (frames,)."""
        return instant_centre(self.motion, self.body, self.motion.linkage.ground)

    @property
    def fixed(self) -> Complex:
        """The fixed centrode: the instant centre, mm, (frames,); nan at infinity and where open."""
        return self.centre.position

    @cached_property
    def _arm(self) -> Complex:
        """From the body's origin to the instant centre, mm; taken together, since both may be far away."""
        body = self.motion.bodies[self.body]
        start = self.centre.reference - body.origin.position
        return InstantCentre(start, self.centre.arm, self.centre.weight).position

    @property
    def moving(self) -> Complex:
        """The moving centrode: the instant centre in the body's own frame, mm, (frames,); nan as `fixed`."""
        return self._arm * np.conj(self.motion.bodies[self.body].direction)

    @property
    def velocity(self) -> Complex:
        """Velocity of the instant centre along the fixed centrode, mm/s, (frames,); nan at infinity.

        |omega| D along the centrode tangent, D the diameter of the inflection circle.
        """
        return self.motion.timing.rate(self._first)

    @cached_property
    def _first(self) -> Complex:
        """The same in drive for time, mm per unit of drive."""
        return inflection_circle(self.motion, self.body).centre_velocity

    def runs(self, reach: float) -> list[slice]:
        """Frames between which both centrodes run unbroken, at least two in each run.

        Broken at every centre farther than `reach`, mm, from the body's origin, at infinity, where the linkage is
        open, and between two frames if the centre passes through infinity there or leaps to another place, as it
        does where a linkage changes its branch. `fixed[run]` and `moving[run]` may be drawn as they are.
        """
        if not reach > 0:
            raise DesignError("reach", f"found {reach}", "give a distance above 0, in mm")
        if self.motion.assembled.ndim > 1:
            raise DesignError("motion", "found many linkages at once", "give one, for the runs of each differ")
        with np.errstate(invalid="ignore"):
            kept = abs(self._arm) <= reach
        weight, arm = self.centre.weight, self.centre.arm
        # A centre that passes through infinity comes back on the other side: the weight alone changes its sign. Where
        # the body comes to rest and turns back, the arm does so too, and the centre goes on where it is.
        through = (weight[:-1] * weight[1:] < 0) & (dot(arm[:-1], arm[1:]) > 0)
        speed = abs(self._first)
        own_step = np.fmax(speed[:-1], speed[1:]) * abs(np.diff(self.motion.drive))
        leap = abs(np.diff(self.fixed)) > LEAP * own_step + ROUNDING * self.motion.linkage.size
        joined = kept[:-1] & kept[1:] & ~through & ~leap
        edges = np.flatnonzero(np.diff(np.concatenate([[False], joined, [False]]).astype(int)))
        return [slice(int(start), int(end) + 1) for start, end in zip(edges[::2], edges[1::2])]


@record(checked=True, eq=False)
class CentrodeCurve(AbstractCurve):
    """The centrode of `body` on the ground, or where `moving` on the body itself; t is the drive over `span`.

    Exact: each point of it solves the linkage. The span is to lie inside one run, as `Centrodes.runs` finds them: at
    infinity the curve breaks. start: the drive from which a branch is followed. DesignError for a body that the
    linkage has not. Derived here.
    """

    linkage: OneLinkage
    body: str
    span: tuple[float, float]
    moving: bool = False
    branch: Branch = 1
    start: float = 0.0

    def __post_init__(self) -> None:
        if not self.span[0] < self.span[1]:
            raise DesignError("span", f"found {self.span}", "give a rising pair")
        bodies = self.linkage.linkage.bodies
        if self.body not in bodies:
            raise DesignError("body", f"found {self.body!r}", f"give one of {', '.join(bodies)}")

    def _centrodes(self, t: ArrayLike) -> tuple[Centrodes, Whole]:
        motion, frames = motion_at(self.linkage, t, self.branch, self.start)
        return Centrodes(motion, self.body), frames

    def point(self, t: ArrayLike) -> Complex:
        centrodes, frames = self._centrodes(t)
        return (centrodes.moving if self.moving else centrodes.fixed)[frames]

    def velocity(self, t: ArrayLike) -> Complex:
        centrodes, frames = self._centrodes(t)
        # The moving centrode rolls on the fixed one: the centre has one velocity along both, turned as the body is.
        turned = np.conj(centrodes.motion.bodies[self.body].direction) if self.moving else 1.0
        return (centrodes.velocity * turned)[frames]

    @property
    def breaks(self) -> Real:
        return np.array(self.span)

    @property
    def closed(self) -> bool:
        return False
