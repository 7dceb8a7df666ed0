"""Motion of a linkage as arrays over frames."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..plane.vec import Array


@dataclass(frozen=True, eq=False)
class PointMotion:
    """A point over the frames: position mm, velocity mm/s, acceleration mm/s2, (frames,) complex."""

    position: Array
    velocity: Array
    acceleration: Array


@dataclass(frozen=True, eq=False)
class Body:
    """A rigid body over the frames.

    origin: the motion of its own origin; direction: unit complex, its x axis; omega rad/s and alpha
    rad/s2, counterclockwise positive. All (frames,), nan where the linkage is open.
    """

    origin: PointMotion
    direction: Array
    omega: Array
    alpha: Array

    def point(self, local: complex) -> PointMotion:
        """Motion of the body's own point `local`, mm in the body's frame."""
        arm = self.direction * local
        return PointMotion(
            self.origin.position + arm,
            self.origin.velocity + 1j * self.omega * arm,
            self.origin.acceleration + (1j * self.alpha - self.omega**2) * arm,
        )


@dataclass(frozen=True, eq=False)
class Motion:
    """What a linkage does over its frames: `motion.coupler.direction`, `motion.point("coupler_point")`.

    drive: the driver's angle, rad, (frames,). bodies: by name, also as attributes. named_points: a
    body and a place on it for each name. closed: (frames,) bool, whether the linkage reaches the pose;
    everything else is nan where it does not. transmission_angle: rad, (frames,).
    """

    drive: Array
    bodies: Mapping[str, Body]
    named_points: Mapping[str, tuple[str, complex]]
    closed: Array
    transmission_angle: Array

    def __getattr__(self, name: str) -> Body:
        # `bodies` itself is asked for here while a copy is being unpickled, before it exists.
        bodies = self.__dict__.get("bodies", {})
        if name in bodies:
            return bodies[name]
        raise AttributeError(f"no body named {name!r}; there are {', '.join(bodies)}")

    def point(self, name: str) -> PointMotion:
        """Motion of a named point."""
        if name not in self.named_points:
            raise KeyError(f"no point named {name!r}; there are {', '.join(self.named_points)}")
        body, local = self.named_points[name]
        return self.bodies[body].point(local)


def still(place: complex, frames: int) -> PointMotion:
    """A point that does not move."""
    zero = np.zeros(frames, dtype=complex)
    return PointMotion(zero + place, zero, zero)
