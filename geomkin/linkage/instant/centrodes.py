"""Centrodes: the curves of the instant centre on the ground and on the body, which roll on each other."""

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

# Largest distance between the centres of two frames, relative to what its speed accounts for. With a larger value a
# linkage that changes its branch draws a false line; with a smaller one a true curve in coarse steps is broken.
LEAP = 4.0
# Distance, as a share of the linkage's size, that counts as zero, so that rounding does not break the curve of a centre
# at rest.
ROUNDING = 1e-9


@record(checked=True, eq=False)
class Centrodes:
    """Paths of a body's instant centre on the ground and on the body; the second curve rolls on the first.

    Parameters
    ----------
    motion : Motion
        Motion of the linkage.
    body : str
        Name of the body. A name that the linkage does not have is a DesignError when a curve is used.

    Notes
    -----
    Rolling: Dijksman, Motion Geometry of Mechanisms, 1976; the breaks of the curves are derived here.
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
        """From the body's origin to the instant centre, mm; computed in one step, since both may be far away."""
        body = self.motion.bodies[self.body]
        start = self.centre.reference - body.origin.position
        return InstantCentre(start, self.centre.arm, self.centre.weight).position

    @property
    def moving(self) -> Complex:
        """The moving centrode: the instant centre in the body's frame, mm, (frames,); nan as `fixed`."""
        return self._arm * np.conj(self.motion.bodies[self.body].direction)

    @property
    def velocity(self) -> Complex:
        """Velocity of the instant centre along the fixed centrode, mm/s, (frames,); nan at infinity.

        It is |omega| D along the centrode tangent, D the diameter of the inflection circle.
        """
        return self.motion.timing.rate(self._first)

    @cached_property
    def _first(self) -> Complex:
        """The same per unit of drive, mm."""
        return inflection_circle(self.motion, self.body).centre_velocity

    def runs(self, reach: float) -> list[slice]:
        """Runs of at least two frames over which both centrodes are unbroken.

        They break at every centre farther than `reach` from the body's origin, at infinity, where the linkage is open,
        and between two frames if the centre passes through infinity or jumps, as when a linkage changes its branch.
        `fixed[run]` and `moving[run]` may be drawn as they are.

        Parameters
        ----------
        reach : float
            mm; above 0.

        Returns
        -------
        list of slice

        Raises
        ------
        DesignError
            If `reach` is not above 0, or the motion is of arrays of linkages.
        """
        if not reach > 0:
            raise DesignError("reach", f"found {reach}", "give a distance above 0, in mm", "out-of-range")
        if self.motion.assembled.ndim > 1:
            raise DesignError(
                "motion", "found many linkages at once", "give one, for the runs of each differ", "wrong-type"
            )
        with np.errstate(invalid="ignore"):
            within = abs(self._arm) <= reach
        weight, arm = self.centre.weight, self.centre.arm
        # A centre that passes through infinity returns from the other side: only the weight changes its sign. If the
        # body stops and reverses, the arm changes its sign as well, and the centre is continuous.
        through = (weight[:-1] * weight[1:] < 0) & (dot(arm[:-1], arm[1:]) > 0)
        speed = abs(self._first)
        expected = np.fmax(speed[:-1], speed[1:]) * abs(np.diff(self.motion.drive))
        leap = abs(np.diff(self.fixed)) > LEAP * expected + ROUNDING * self.motion.linkage.size
        joined = within[:-1] & within[1:] & ~through & ~leap
        edges = np.flatnonzero(np.diff(np.concatenate([[False], joined, [False]]).astype(int)))
        return [slice(int(start), int(end) + 1) for start, end in zip(edges[::2], edges[1::2])]


@record(checked=True, eq=False)
class CentrodeCurve(AbstractCurve):
    """A centrode as a curve whose parameter t is the drive, rad or mm.

    Each point of the curve solves the linkage exactly.

    Parameters
    ----------
    linkage : Linkage or any named linkage
        One linkage, its sizes numbers.
    body : str
        Name of the body.
    span : (float, float)
        First and last drive, rising, rad or mm; within one run of `Centrodes.runs`, since the curve breaks at infinity.
    moving : bool
        Whether it is the centrode on the body, rather than the one on the ground.
    branch : {+1, -1, "follow"}, mapping or Continuation
        As for `move`.
    start : float
        Drive from which a branch is followed.

    Raises
    ------
    DesignError
        If the linkage has no such body, or the span does not rise.

    Notes
    -----
    Derived here.
    """

    linkage: OneLinkage
    body: str
    span: tuple[float, float]
    moving: bool = False
    branch: Branch = 1
    start: float = 0.0

    def __post_init__(self) -> None:
        if not self.span[0] < self.span[1]:
            raise DesignError("span", f"found {self.span}", "give a rising pair", "out-of-range")
        bodies = self.linkage.linkage.bodies
        if self.body not in bodies:
            raise DesignError("body", f"found {self.body!r}", f"give one of {', '.join(bodies)}", "unknown-key")

    def _centrodes(self, t: ArrayLike) -> tuple[Centrodes, Whole]:
        motion, frames = motion_at(self.linkage, t, self.branch, self.start)
        return Centrodes(motion, self.body), frames

    def point(self, t: ArrayLike) -> Complex:
        centrodes, frames = self._centrodes(t)
        return (centrodes.moving if self.moving else centrodes.fixed)[frames]

    def velocity(self, t: ArrayLike) -> Complex:
        centrodes, frames = self._centrodes(t)
        # The moving centrode rolls on the fixed one: the centre has the same velocity along both, in different frames.
        rotation = np.conj(centrodes.motion.bodies[self.body].direction) if self.moving else 1.0
        return (centrodes.velocity * rotation)[frames]

    @property
    def breaks(self) -> Real:
        return np.array(self.span)

    @property
    def closed(self) -> bool:
        return False
