"""Where a follower touches a cam: what every follower can tell, and the two shapes of surface."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ...plane.pose import Pose
from ...plane.vec import Array, cross
from ..program.program import FollowerMotion, Program


@dataclass(frozen=True, eq=False)
class Contact:
    """Cam and follower where they touch, over cam angles; arrays of one shape, in the ground's frame.

    point: where they touch, mm. normal: direction from the cam into the follower, unit.
    turn: how fast the normal turns as seen from the cam, rad per rad of cam angle.
    advance: how fast the contact moves along the profile, mm/rad, positive against the cam's turning;
    where it is negative the follower cuts away what it touched before.
    pressure_angle: rad, signed, between the normal and the way the follower is free to go there.
    """

    point: Array
    normal: Array
    turn: Array
    advance: Array
    pressure_angle: Array


class AbstractFollower(ABC):
    """What rides on a cam that turns about the origin. `sense` is +1 for counterclockwise, -1 for clockwise.

    Lifts, mm, or rad where it oscillates, are 0 on the base circle and positive away from the cam.
    """

    oscillates: ClassVar[bool]
    rolls: ClassVar[bool]
    # mm; 0 for a knife edge and for a flat face.
    roller_radius: float = 0.0

    @abstractmethod
    def check(self, base_radius: float, program: Program, sense: int) -> None:
        """Raises DesignError where the follower cannot ride on such a cam."""

    @abstractmethod
    def base_radii(self, largest_lift: float) -> tuple[float, float]:
        """Base radii, mm, between which, both excluded, the follower can reach the cam in all its lifts."""

    @abstractmethod
    def contact(self, motion: FollowerMotion, base_radius: float, sense: int) -> Contact:
        """Where it touches a cam that it undercuts nowhere."""

    @abstractmethod
    def place(self, lift: Array, base_radius: float) -> Pose:
        """Its own frame in the ground's."""

    @abstractmethod
    def resting_lift(self, points: Array, base_radius: float) -> Array:
        """Lift at which it rests on points of the ground, complex mm; minus infinity where it passes them by."""


def on_roller(
    centre: Array, slope: Array, bend: Array, radius: float, sense: int, way: Array | complex, sign: int
) -> Contact:
    """Contact of a roller of a radius, mm, whose centre has the derivatives slope and bend by cam angle.

    way: unit direction in which the centre moves as the lift grows. With B the centre, the pitch curve
    E B has the velocity E u, u = B' - i sgn B, and the roller lies to the left of it for sgn = +1.
    """
    u = slope - 1j * sense * centre
    speed = np.abs(u)
    normal = 1j * sense * u / speed
    turn = cross(u, bend - 2j * sense * slope - centre) / speed**2
    pressure_angle = sign * np.angle(normal * np.conj(way))
    return Contact(centre - radius * normal, normal, turn, speed + sense * radius * turn, pressure_angle)


def on_face(
    normal: Array, distance: tuple[Array, Array, Array], turn: tuple[Array, Array], pressure_angle: Array, sense: int
) -> Contact:
    """Contact of a flat face.

    distance: p, mm, of the face from the cam's axis and its derivatives by cam angle; turn: rate of the
    normal's angle phi as seen from the cam, and its derivative. The cam's support function is p(phi), so
    it touches at n (p + i dp/dphi) with the radius of curvature p + d2p/dphi2.
    """
    p, p1, p2 = distance
    rate, rate1 = turn
    along = p1 / rate
    radius = p + (p2 - along * rate1) / rate**2
    return Contact(normal * (p + 1j * along), normal, rate, -sense * rate * radius, pressure_angle)
