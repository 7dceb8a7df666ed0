"""Motion of one body, one point and one slide of a linkage, as arrays over frames."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..brief import one_line, short
from ..cached import cached_property
from ..plane.vec import Complex, Real
from .solve.formulas import Timing, first_of, second_of
from .solve.solution import LinkageSolution
from .solve.worked import Worked


@dataclass(frozen=True, eq=False)
class PointMotion:
    """A point of a body over the frames; all (frames,) complex, nan where the linkage is open."""

    body: Body
    local: complex | Complex
    # Of a point that the linkage names.
    _name: str = field(default="", repr=False)

    def __repr__(self) -> str:
        return f"PointMotion(body={short(self.body.name)}, local={short(self.local)})"

    @cached_property
    def _worked(self) -> Worked | None:
        return self.body.solution.worked_at(self.body.name, self.local)

    def _told(self, what: str) -> Complex | None:
        """By formulas; None where there are none."""
        body, solution = self.body.name, self.body.solution
        if self._name:
            return None if solution.worked is None else solution.told((what, body, self._name), body)
        if self._worked is None:
            return None
        told: Complex = self._worked.value((what, body), body)
        return solution.over_frames(body, told)

    @property
    def _arm(self) -> Complex:
        return self.body.direction * self.local

    @cached_property
    def position(self) -> Complex:
        """mm."""
        told = self._told("position")
        if told is not None:
            return told
        return self._arm + self.body.solution.origin(self.body.name, 0)

    @cached_property
    def first(self) -> Complex:
        """First kinematic coefficient: dP/dq, mm per unit of drive."""
        told = self._told("first")
        if told is not None:
            return told
        with np.errstate(invalid="ignore"):  # rates are not finite at a dead centre of the driver
            return first_of(self._arm, self.body.first, self.body.solution.origin(self.body.name, 1))

    @cached_property
    def second(self) -> Complex:
        """Second kinematic coefficient: d2P/dq2, mm per unit of drive squared."""
        told = self._told("second")
        if told is not None:
            return told
        with np.errstate(invalid="ignore"):
            origin = self.body.solution.origin(self.body.name, 2)
            return second_of(self._arm, self.body.first, self.body.second, origin)

    @cached_property
    def velocity(self) -> Complex:
        """mm/s."""
        told = self._told("velocity")
        if told is not None:
            return told
        return self.body.timing.rate(self.first)

    @cached_property
    def acceleration(self) -> Complex:
        """mm/s2."""
        told = self._told("acceleration")
        if told is not None:
            return told
        second = self.second  # first of all, so that the lower orders come with it
        return self.body.timing.gain(self.first, second)


@dataclass(frozen=True, eq=False)
class Body:
    """A rigid body over the frames; all (frames,), angles counterclockwise, nan where the linkage is open."""

    name: str
    solution: LinkageSolution = field(repr=False)

    __repr__ = one_line

    @property
    def timing(self) -> Timing:
        """Of the driver."""
        return self.solution.timing

    @property
    def direction(self) -> Complex:
        """The body's x axis, unit complex."""
        return self.solution.told("direction", self.name)

    @property
    def first(self) -> Real:
        """First kinematic coefficient: d(angle)/dq, rad per unit of drive."""
        return self.solution.told("first", self.name)

    @property
    def second(self) -> Real:
        """Second kinematic coefficient: d2(angle)/dq2, rad per unit of drive squared."""
        return self.solution.told("second", self.name)

    @property
    def omega(self) -> Real:
        """Angular velocity, rad/s."""
        return self.solution.told("omega", self.name)

    @property
    def alpha(self) -> Real:
        """Angular acceleration, rad/s2."""
        return self.solution.told("alpha", self.name)

    @cached_property
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
    sliding alone; coriolis mm/s2, complex: 2 omega v at right angles to the line, omega that of the guide. first and
    second: kinematic coefficients, mm per unit of drive and per its square.
    """

    displacement: Real
    velocity: Real
    acceleration: Real
    coriolis: Complex
    first: Real
    second: Real

    __repr__ = one_line
