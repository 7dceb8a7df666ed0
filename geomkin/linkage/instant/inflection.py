"""The inflection circle: which points of a moving body pass a straight piece of their path at this instant."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ...arguments import checked
from ...brief import one_line
from ...errors import DesignError
from ...plane.vec import Complex, Real, cross, dot, unit
from ..motion import Motion
from .centres import InstantCentre, settled
from .curvature import PathCurvature, path_in, second_order

# Share of its terms below which a sum is rounding. Smaller, and a body that only translates gets an inflection
# circle; larger, and a true but tiny one is lost.
ROUNDING = 1e-13


@dataclass(frozen=True, eq=False)
class InflectionCircle:
    """A body's motion to second order, and its inflection circle; every part (frames,).

    The motion in any measure of time: `reference`, a place on the body, mm, with its velocity and acceleration, and
    the body's rate of turning and the change of that rate.

    Where the instant centre is at infinity (parallel cranks: `turn` is 0), the circle is a straight line along
    `tangent` through `nearest`; the centre and the pole are nan and the diameter inf. Where all paths have the same
    curvature there (a parallelogram), there is no circle and normal, tangent and nearest are nan too.

    The circle and its use: Dijksman, Motion Geometry of Mechanisms, 1976. That no digits are lost where it grows into
    a line is derived here.
    """

    reference: Complex
    velocity: Complex
    acceleration: Complex
    turn: Real
    turn_rate: Real

    __repr__ = one_line

    # With s from the reference, V = f + i h s and A = f' + (i h' - h^2) s give, with p = h A_I,
    # V x A = c + Re(conj(k) s) + h^3 |s|^2, which is 0 on the circle, and the diameter J = p / h^3.

    @cached_property
    def _p(self) -> Complex:
        h = self.turn
        one, two, three = h * self.acceleration, -self.velocity * self.turn_rate, -1j * h**2 * self.velocity
        total = one + two + three
        return np.where(abs(total) <= ROUNDING * (abs(one) + abs(two) + abs(three)), 0j, total)

    @property
    def instant_centre(self) -> InstantCentre:
        """Where the body has no velocity: the circle passes through it."""
        return InstantCentre(self.reference, 1j * self.velocity, self.turn)

    @property
    def diameter(self) -> Real:
        """Diameter of the circle, mm; inf where it is a line, nan where there is none."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return abs(self._p) / abs(self.turn) ** 3

    @property
    def normal(self) -> Complex:
        """Centrode normal: the direction from the instant centre to the inflection pole, unit complex."""
        return unit(self._p) * np.where(self.turn < 0, -1, 1)

    @property
    def tangent(self) -> Complex:
        """Centrode tangent: the direction in which the instant centre runs, unit complex."""
        return 1j * unit(self._p)

    @property
    def centre_velocity(self) -> Complex:
        """Velocity of the instant centre along both centrodes, mm per unit of time: |turn| D; nan at infinity."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(self.turn == 0, np.nan, 1j * self._p / self.turn**2)

    @property
    def pole(self) -> Complex:
        """Inflection pole, mm: the end of the diameter from the instant centre; its acceleration is along its path."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return self.instant_centre.position + self._p / self.turn**3

    @property
    def nearest(self) -> Complex:
        """The point of the circle nearest to `reference`, mm."""
        k = -(self._p + 2j * self.turn**2 * self.velocity)
        c, extent = cross(self.velocity, self.acceleration), abs(k) + abs(self._p)
        with np.errstate(divide="ignore", invalid="ignore"):
            away = np.where(extent == 0, np.nan, 2 * c / extent)
        # From the circle's centre all its points are equally near: any direction will do.
        along: Complex = np.where(k == 0, 1, unit(k))
        return self.reference - along * away

    @property
    def tangent_foot(self) -> Complex:
        """The point of the centrode tangent line nearest to `reference`, mm: with `tangent` it gives the line.

        It is there also where the instant centre, through which the line passes, is at infinity.
        """
        across: Real = cross(self.acceleration, self.velocity) + self.turn * abs(self.velocity) ** 2
        with np.errstate(divide="ignore", invalid="ignore"):
            return self.reference + 1j * self.tangent * (across / abs(self._p))

    def inflection(self, direction: ArrayLike) -> Real:
        """Signed distance from the instant centre to the circle along a ray, mm: D cos(psi) from the normal."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return dot(self._p, direction) / self.turn**3

    def path(self, position: ArrayLike) -> PathCurvature:
        """Path of the body's point that is at `position` now, mm on the ground; by the Euler-Savary equation."""
        place = np.asarray(position)
        state = self.velocity, self.acceleration, self.turn, self.turn_rate
        return path_in(place, place - self.reference, *state)


@checked
def inflection_circle(motion: Motion, body: str) -> InflectionCircle:
    """Inflection circle of a body's motion on the ground, in drive for time, (frames,).

    nan where the linkage is open, where the driver stands at its own dead centre and where the body turns back.
    DesignError for a body that the linkage has not. Derived here.
    """
    if body not in motion.bodies:
        raise DesignError("body", f"found {body!r}", f"give one of {', '.join(motion.bodies)}")
    return InflectionCircle(motion.bodies[body].origin.position, *second_order(motion, body))


@checked
def inflection_circle_of_cranks(one: PathCurvature, two: PathCurvature) -> InflectionCircle:
    """Inflection circle of a body from the paths of two of its points, as two cranks or sliders give them.

    The body moves so that the first point runs along its tangent or against it: the sense of the centrode
    tangent is arbitrary here. nan where cranks and body are all in line, when the motion is not determined. Derived
    here; `bobillier` is the construction by rule.
    """
    arm = two.position - one.position
    # The body is rigid: both points have the same velocity along the line between them.
    speed = dot(two.tangent, arm), dot(one.tangent, arm)
    velocity = speed[0] * one.tangent, speed[1] * two.tangent
    turn = cross(one.tangent, two.tangent)
    # Accelerations: across the path by the curvatures; along it so that the body stays rigid, and no more.
    across = [k.curvature * v**2 * 1j * k.tangent for k, v in zip((one, two), speed)]
    lacking = dot(arm, across[0] - across[1]) - (turn * abs(arm)) ** 2
    with np.errstate(divide="ignore", invalid="ignore"):
        share = lacking / (speed[0] ** 2 + speed[1] ** 2)
    along = -speed[1] * share * one.tangent, speed[0] * share * two.tangent
    first, second = across[0] + along[0], across[1] + along[1]
    with np.errstate(divide="ignore", invalid="ignore"):
        turn_rate = cross(arm, second - first) / abs(arm) ** 2
    extent = abs(arm)
    return InflectionCircle(
        one.position,
        velocity[0],
        first,
        settled(turn, np.maximum(abs(velocity[0]), abs(velocity[1])), extent),
        settled(turn_rate, np.maximum(abs(first), abs(second)), extent),
    )
