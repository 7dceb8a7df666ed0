"""Motion of bodies, their points, and slides, as arrays over frames."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import field
from functools import cached_property
from typing import Annotated

import numpy as np

from ..core.arguments import ArgumentType, checked, is_place
from ..core.records import record
from ..core.reprs import short
from ..plane.vec import Complex, Real
from .solve.placement import Timing
from .solve.program import first_of, second_of
from .solve.solution import LinkageSolution

PointOrPoints = Annotated[
    complex | Complex, ArgumentType(lambda value: is_place(value, True), "a point x + yj, or an array of them")
]


@record(eq=False)
class PointMotion:
    """Motion of one point of a body; every array is (frames,) complex, nan where the linkage is open.

    Obtained from `Motion.point` or `Body.point`. With arrays of linkages the shape is (frames, linkages).

    Parameters
    ----------
    body : Body
        The body that the point belongs to.
    local : complex
        The point, mm in the body's frame.
    """

    body: Body
    local: complex | Complex
    # Set if the linkage names the point.
    _name: str = field(default="", repr=False)

    def __repr__(self) -> str:
        return f"PointMotion(body={short(self.body.name)}, local={short(self.local)})"

    def _value(self, quantity: str, formula: Callable[[], Complex]) -> Complex:
        """A quantity of a named point by the linkage's program if there is one, otherwise by a formula."""
        body, solution = self.body.name, self.body.solution
        if self._name and solution.run is not None:
            return solution.value((quantity, body, self._name), body)
        with np.errstate(invalid="ignore"):  # rates are not finite at a dead centre of the driver
            return formula()

    @property
    def _arm(self) -> Complex:
        return self.body.direction * self.local

    def _origin(self, order: int) -> Complex:
        return self.body.solution.origin(self.body.name, order)

    @cached_property
    def position(self) -> Complex:
        """Position on the ground, mm."""
        return self._value("position", lambda: self._arm + self._origin(0))

    @cached_property
    def first(self) -> Complex:
        """First kinematic coefficient dP/dq, mm per unit of drive (rad, or mm if a slider drives)."""
        return self._value("first", lambda: first_of(self._arm, self.body.first, self._origin(1)))

    @cached_property
    def second(self) -> Complex:
        """Second kinematic coefficient d2P/dq2, mm per unit of drive squared."""
        return self._value("second", lambda: second_of(self._arm, self.body.first, self.body.second, self._origin(2)))

    @cached_property
    def velocity(self) -> Complex:
        """Velocity, mm/s."""
        return self._value("velocity", lambda: self.body.timing.rate(self.first))

    @cached_property
    def acceleration(self) -> Complex:
        """Acceleration, mm/s2."""
        return self._value("acceleration", lambda: self.body.timing.second_rate(self.first, self.second))


@record(eq=False)
class Body:
    """Motion of one rigid body; arrays are (frames,), angles counterclockwise, nan where the linkage is open.

    Obtained as `motion.coupler`, `motion["coupler"]` or `motion.bodies["coupler"]`. With arrays of linkages the shape
    is (frames, linkages).

    Parameters
    ----------
    name : str
        Name of the body in the linkage.
    solution : LinkageSolution
        The solved positions that the body reads.
    """

    name: str
    solution: LinkageSolution = field(repr=False)

    @property
    def timing(self) -> Timing:
        """Speed and acceleration of the driver."""
        return self.solution.timing

    @property
    def direction(self) -> Complex:
        """Direction of the body's x axis, unit complex."""
        return self.solution.value("direction", self.name)

    @property
    def first(self) -> Real:
        """First kinematic coefficient d(angle)/dq, rad per unit of drive (rad, or mm if a slider drives)."""
        return self.solution.value("first", self.name)

    @property
    def second(self) -> Real:
        """Second kinematic coefficient d2(angle)/dq2, rad per unit of drive squared."""
        return self.solution.value("second", self.name)

    @property
    def omega(self) -> Real:
        """Angular velocity, rad/s."""
        return self.solution.value("omega", self.name)

    @property
    def alpha(self) -> Real:
        """Angular acceleration, rad/s2."""
        return self.solution.value("alpha", self.name)

    @cached_property
    def origin(self) -> PointMotion:
        """Motion of the origin of the body's frame."""
        return self.point(0j)

    @checked
    def point(self, local: PointOrPoints) -> PointMotion:
        """Motion of any point of the body.

        Parameters
        ----------
        local : complex or array
            The point, mm in the body's frame; or one point for each frame.

        Returns
        -------
        PointMotion

        Raises
        ------
        DesignError
            If `local` is no point.
        """
        return PointMotion(self, local)


@record(eq=False)
class SlideMotion:
    """Motion of a sliding joint; arrays are (frames,), positive along the line's direction.

    Obtained from `Motion.slide`.

    Parameters
    ----------
    displacement : array
        Displacement from the line's point `through`, mm.
    velocity, acceleration : array
        Sliding velocity and acceleration relative to the guide, mm/s and mm/s2.
    coriolis : array
        Coriolis acceleration, mm/s2, complex: 2 omega v perpendicular to the line, omega that of the guide.
    first, second : array
        Kinematic coefficients, mm per unit of drive and per unit squared.
    """

    displacement: Real
    velocity: Real
    acceleration: Real
    coriolis: Complex
    first: Real
    second: Real
