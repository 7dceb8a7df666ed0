"""Motion of one body, one point and one slide of a linkage, as arrays over frames."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from ..brief import one_line, short
from ..plane.vec import Complex, Real
from .solve.placement import Numbers
from .solve.solution import LinkageSolution


@dataclass(frozen=True, eq=False)
class Timing:
    """The driver's speed and acceleration: rad/s and rad/s2, or mm/s and mm/s2 where a slider drives."""

    speed: Real
    acceleration: Real

    __repr__ = one_line

    def rate(self, first: Numbers) -> Numbers:
        """d/dt of what has the first kinematic coefficient `first`."""
        with np.errstate(invalid="ignore"):
            return first * self.speed

    def gain(self, first: Numbers, second: Numbers) -> Numbers:
        """d2/dt2 of what has these first and second kinematic coefficients."""
        with np.errstate(invalid="ignore", over="ignore"):
            gain = second * self.speed**2
            return (
                gain if np.ndim(self.acceleration) == 0 and self.acceleration == 0 else gain + first * self.acceleration
            )


@dataclass(frozen=True, eq=False)
class PointMotion:
    """A point of a body over the frames; all (frames,) complex, nan where the linkage is open."""

    body: Body
    local: complex | Complex

    def __repr__(self) -> str:
        return f"PointMotion(body={short(self.body.name)}, local={short(self.local)})"

    # A fresh one each time: it is written over.
    def _arm(self) -> Complex:
        return self.body.direction * self.local

    @cached_property
    def position(self) -> Complex:
        """mm."""
        place = self._arm()
        place += self.body.solution.origin(self.body.name, 0)
        return place

    @cached_property
    def first(self) -> Complex:
        """First kinematic coefficient: dP/dq, mm per unit of drive."""
        with np.errstate(invalid="ignore"):  # rates are not finite at a dead centre of the driver
            turned = self._arm()
            turned *= self.body.first
            turned *= 1j
            turned += self.body.solution.origin(self.body.name, 1)
            return turned

    @cached_property
    def second(self) -> Complex:
        """Second kinematic coefficient: d2P/dq2, mm per unit of drive squared."""
        with np.errstate(invalid="ignore"):
            arm = self._arm()
            turned = np.empty(arm.shape, dtype=complex)
            turned.real, turned.imag = -(self.body.first**2), self.body.second
            turned *= arm
            turned += self.body.solution.origin(self.body.name, 2)
            return turned

    @cached_property
    def velocity(self) -> Complex:
        """mm/s."""
        return self.body.timing.rate(self.first)

    @cached_property
    def acceleration(self) -> Complex:
        """mm/s2."""
        second = self.second  # first of all, so that the lower orders come with it
        return self.body.timing.gain(self.first, second)


@dataclass(frozen=True, eq=False)
class Body:
    """A rigid body over the frames; all (frames,), angles counterclockwise, nan where the linkage is open."""

    name: str
    solution: LinkageSolution = field(repr=False)
    timing: Timing = field(repr=False)

    __repr__ = one_line

    @property
    def direction(self) -> Complex:
        """The body's x axis, unit complex."""
        return self.solution.direction(self.name)

    @property
    def first(self) -> Real:
        """First kinematic coefficient: d(angle)/dq, rad per unit of drive."""
        return self.solution.turning(self.name, 1)

    @property
    def second(self) -> Real:
        """Second kinematic coefficient: d2(angle)/dq2, rad per unit of drive squared."""
        return self.solution.turning(self.name, 2)

    @cached_property
    def omega(self) -> Real:
        """Angular velocity, rad/s."""
        return self.timing.rate(self.first)

    @cached_property
    def alpha(self) -> Real:
        """Angular acceleration, rad/s2."""
        second = self.second  # first of all, so that the lower orders come with it
        return self.timing.gain(self.first, second)

    @property
    def origin(self) -> PointMotion:
        """Motion of the body's own origin."""
        return self.point(0j)

    def point(self, local: complex | Complex) -> PointMotion:
        """Motion of the body's own point `local`, mm in the body's frame."""
        return PointMotion(self, local)


@dataclass(frozen=True, eq=False)
class SlideMotion:
    """How a sliding joint slides; all (frames,), positive along the line's direction.

    displacement mm from the line's own point `through`; velocity mm/s and acceleration mm/s2 of the
    sliding alone; coriolis mm/s2, complex: 2 omega v at right angles to the line, omega that of the guide.
    """

    displacement: Real
    velocity: Real
    acceleration: Real
    coriolis: Complex

    __repr__ = one_line
