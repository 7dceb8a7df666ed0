"""Motion of a linkage as arrays over frames."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..plane.vec import Array, cross, dot
from .linkage import Linkage, Slider


class Solution(ABC):
    """Where all bodies are, and the derivatives of that by the driver, each worked out when first asked for."""

    @abstractmethod
    def origin(self, body: str, order: int) -> Array:
        """The place of a body's origin, mm, or its derivative of order 1 or 2 by the drive."""

    @abstractmethod
    def turn(self, body: str, order: int) -> Array:
        """A body's direction, unit complex, or the derivative of order 1 or 2 of its angle, rad, by the drive."""

    @property
    @abstractmethod
    def closed(self) -> Array:
        """Whether every body can be where its joints want it."""

    @property
    @abstractmethod
    def signs(self) -> Mapping[str, Array]:
        """The sign of each dyad, by its inner joint, also where the linkage is open; 0 where both branches meet."""

    @property
    @abstractmethod
    def branches(self) -> Mapping[str, Array]:
        """The branch of each dyad, by its inner joint."""

    @property
    @abstractmethod
    def transmission_angle(self) -> Array:
        """Least over the joints that it is told of, rad; nan where there is none."""


@dataclass(frozen=True, eq=False)
class Timing:
    """The driver's speed and acceleration: rad/s and rad/s2, or mm/s and mm/s2 where a slider drives."""

    speed: Array
    acceleration: Array

    def rate(self, first: Array) -> Array:
        """d/dt of what has the first kinematic coefficient `first`."""
        with np.errstate(invalid="ignore"):
            return first * self.speed

    def gain(self, first: Array, second: Array) -> Array:
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
    local: complex

    @cached_property
    def _arm(self) -> Array:
        return self.body.direction * self.local

    @cached_property
    def position(self) -> Array:
        """mm."""
        return self.body.solution.origin(self.body.name, 0) + self._arm

    @cached_property
    def first(self) -> Array:
        """First kinematic coefficient: dP/dq, mm per unit of drive."""
        with np.errstate(invalid="ignore"):  # rates are not finite at a dead centre of the driver
            turned = self._arm * self.body.first
            turned *= 1j
            turned += self.body.solution.origin(self.body.name, 1)
            return turned

    @cached_property
    def second(self) -> Array:
        """Second kinematic coefficient: d2P/dq2, mm per unit of drive squared."""
        with np.errstate(invalid="ignore"):
            turned = np.empty(self._arm.shape, dtype=complex)
            turned.real, turned.imag = -(self.body.first**2), self.body.second
            turned *= self._arm
            turned += self.body.solution.origin(self.body.name, 2)
            return turned

    @cached_property
    def velocity(self) -> Array:
        """mm/s."""
        return self.body.timing.rate(self.first)

    @cached_property
    def acceleration(self) -> Array:
        """mm/s2."""
        second = self.second  # first of all, so that the lower orders come with it
        return self.body.timing.gain(self.first, second)


@dataclass(frozen=True, eq=False)
class Body:
    """A rigid body over the frames; all (frames,), angles counterclockwise, nan where the linkage is open."""

    name: str
    solution: Solution
    timing: Timing

    @property
    def direction(self) -> Array:
        """The body's x axis, unit complex."""
        return self.solution.turn(self.name, 0)

    @property
    def first(self) -> Array:
        """First kinematic coefficient: d(angle)/dq, rad per unit of drive."""
        return self.solution.turn(self.name, 1)

    @property
    def second(self) -> Array:
        """Second kinematic coefficient: d2(angle)/dq2, rad per unit of drive squared."""
        return self.solution.turn(self.name, 2)

    @cached_property
    def omega(self) -> Array:
        """Angular velocity, rad/s."""
        return self.timing.rate(self.first)

    @cached_property
    def alpha(self) -> Array:
        """Angular acceleration, rad/s2."""
        second = self.second  # first of all, so that the lower orders come with it
        return self.timing.gain(self.first, second)

    @property
    def origin(self) -> PointMotion:
        """Motion of the body's own origin."""
        return self.point(0j)

    def point(self, local: complex) -> PointMotion:
        """Motion of the body's own point `local`, mm in the body's frame."""
        return PointMotion(self, local)


@dataclass(frozen=True, eq=False)
class SlideMotion:
    """How a sliding joint slides; all (frames,), positive along the line's direction.

    displacement mm from the line's own point `through`; velocity mm/s and acceleration mm/s2 of the
    sliding alone; coriolis mm/s2, complex: 2 omega v at right angles to the line, omega that of the guide.
    """

    displacement: Array
    velocity: Array
    acceleration: Array
    coriolis: Array


@dataclass(frozen=True, eq=False)
class Motion:
    """What a linkage does over its frames: `motion.coupler.direction`, `motion.point("coupler_point")`.

    linkage: the general linkage that moved. drive: the driver's angle, rad, or displacement, mm.
    bodies: by name, also as attributes. All arrays (frames,), or (frames, linkages) where sizes are arrays.
    """

    linkage: Linkage
    drive: Array
    timing: Timing
    solution: Solution

    @property
    def closed(self) -> Array:
        """Whether the linkage reaches the pose, bool; everything else is nan where it does not."""
        return self.solution.closed

    @property
    def branches(self) -> Mapping[str, Array]:
        """For each dyad, by its inner joint: +1 or -1, 0 where open or where both branches meet."""
        return self.solution.branches

    @property
    def transmission_angle(self) -> Array:
        """Acute angle between coupler and rocker at their pin, rad: pi/2 at best, 0 at a dead centre.

        Of other dyads, and of loops that are solved together, the angle between the ways in which their two members
        let a joint move; the least of all. nan where the driver drives nothing else.
        """
        return self.solution.transmission_angle

    @property
    def condition(self) -> Array:
        """How many times an error of sizes or drive is seen in where the joint with the least transmission angle stands.

        1/sin of that angle: inf at a limit, nan where there is none.
        """
        with np.errstate(divide="ignore"):
            return 1 / np.sin(self.transmission_angle)

    @cached_property
    def residual(self) -> Array:
        """How far the loops are from closing, mm: the largest distance between points that a joint keeps together."""
        far = np.zeros(self.closed.shape)
        for pin, bodies in self.linkage.pins.items():
            places = [self.bodies[b].point(self.linkage.bodies[b][pin]).position for b in bodies]
            for other in places[1:]:
                far = np.maximum(far, np.abs(other - places[0]))
        for s in self.linkage.sliders:
            guide, body = self.bodies[s.along], self.bodies[s.body]
            apart = body.point(s.point).position - guide.point(s.through).position
            far = np.maximum(far, np.abs(cross(guide.direction * s.direction, apart)))
        return far

    @cached_property
    def bodies(self) -> Mapping[str, Body]:
        """The bodies by name, the ground first."""
        return {name: Body(name, self.solution, self.timing) for name in self.linkage.bodies}

    def __getattr__(self, name: str) -> Body:
        # While a copy is being unpickled nothing is there yet.
        linkage = self.__dict__.get("linkage")
        if linkage is not None and name in linkage.bodies:
            return self.bodies[name]
        raise AttributeError(f"no body named {name!r}; there are {', '.join(linkage.bodies) if linkage else 'none'}")

    def point(self, name: str) -> PointMotion:
        """Motion of a named point; of a pin, as a point of the first body it joins."""
        for body, points in self.linkage.bodies.items():
            if name in points:
                return self.bodies[body].point(points[name])
        named = dict.fromkeys(p for points in self.linkage.bodies.values() for p in points)
        raise KeyError(f"no point named {name!r}; there are {', '.join(named)}")

    def slide(self, name: str) -> SlideMotion:
        """Motion of a sliding joint."""
        for slider in self.linkage.sliders:
            if slider.name == name:
                return _slide(self, slider)
        raise KeyError(f"no slider named {name!r}; there are {', '.join(s.name for s in self.linkage.sliders)}")


def _slide(motion: Motion, slider: Slider) -> SlideMotion:
    guide = motion.bodies[slider.along]
    line = guide.direction * slider.direction
    start, point = guide.point(slider.through), motion.bodies[slider.body].point(slider.point)
    apart = np.conj(line) * (point.position - start.position)
    # Seen from the turning line the point only slides along it: the rest is the line's own turning.
    first = dot(line, point.first - start.first) + guide.first * apart.imag
    second = dot(line, point.second - start.second) + guide.first**2 * apart.real + guide.second * apart.imag
    velocity = motion.timing.rate(first)
    return SlideMotion(apart.real, velocity, motion.timing.gain(first, second), 2j * guide.omega * velocity * line)
