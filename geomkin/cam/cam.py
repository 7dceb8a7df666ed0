"""The disk cam and its curves, exact from the motion programme."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from ..errors import DesignError
from ..plane.curve import AbstractCurve
from ..plane.derived import Offset
from ..plane.vec import Array
from ..sizes import FARTHEST, check_sizes, entry, quantity
from .follower import TranslatingRoller
from .program import Dwell, Program, Return, Rise


@dataclass(frozen=True)
class Cam:
    """A disk cam about the origin, drawn at cam angle 0, and its follower above it."""

    follower: TranslatingRoller = entry("what rides on the cam", example=TranslatingRoller(10))
    program: Program = entry(
        "segments that fill one turn",
        example=Program((Dwell(end_deg=120), Rise("3-4-5", rise=20, end_deg=240), Return("cycloidal", end_deg=360))),
    )
    base_radius: float = quantity("radius of the cam where the lift is 0", "mm", above=0, at_most=FARTHEST, example=40)
    direction: Literal["counterclockwise", "clockwise"] = entry("way the cam turns", default="counterclockwise")

    def __post_init__(self) -> None:
        check_sizes(self)
        if self.direction not in ("counterclockwise", "clockwise"):
            raise DesignError("direction", f"found {self.direction!r}", "give counterclockwise or clockwise")
        if abs(self.follower.offset) >= self.prime_radius:
            raise DesignError(
                "follower.offset",
                f"found {self.follower.offset:g} mm, but the roller's centre starts {self.prime_radius:g} mm from "
                "the axis",
                f"give an offset below {self.prime_radius:g} mm or a larger base_radius",
            )

    @property
    def prime_radius(self) -> float:
        """Least distance of the roller's centre from the cam axis: base radius and roller radius, mm."""
        return self.base_radius + self.follower.roller_radius

    @property
    def sense(self) -> int:
        """+1 where the cam turns counterclockwise, -1 clockwise."""
        return 1 if self.direction == "counterclockwise" else -1

    @property
    def pitch_curve(self) -> AbstractCurve:
        """Path of the roller's centre on the cam; t is the cam angle, rad, 0 to 2 pi."""
        return PitchCurve(self)

    @property
    def profile(self) -> AbstractCurve:
        """The cam's outline, one roller radius inside the pitch curve; t as there.

        Exact, loops included where the roller is larger than the pitch curve can bear.
        """
        if self.follower.roller_radius == 0:
            return self.pitch_curve
        return Offset(self.pitch_curve, self.sense * self.follower.roller_radius)


@dataclass(frozen=True, eq=False)
class PitchCurve(AbstractCurve):
    """Path of the roller's centre seen from the cam.

    P = E (e + i H), with E = exp(-i sgn theta) from ground to cam, e the offset, H the centre's height:
    it runs against the cam's turning.
    """

    cam: Cam

    def point(self, t: ArrayLike) -> Array:
        t = np.asarray(t, dtype=float)
        height, _, _ = _height(self.cam, t)
        return np.exp(-1j * self.cam.sense * t) * (self.cam.follower.offset + 1j * height)

    def velocity(self, t: ArrayLike) -> Array:
        t = np.asarray(t, dtype=float)
        height, sideways, _ = _height(self.cam, t)
        return np.exp(-1j * self.cam.sense * t) * (self.cam.sense * height + 1j * sideways)

    def curvature(self, t: ArrayLike) -> Array:
        return -self.cam.sense * convex_curvature(self.cam, t)

    @property
    def breaks(self) -> Array:
        return self.cam.program.breaks

    @property
    def closed(self) -> bool:
        return True


def pressure_angle(cam: Cam, angle: ArrayLike) -> Array:
    """Signed angle, rad, between the follower's path and the force on it, at cam angles in rad.

    tan(alpha) = (s' - sgn e) / H, positive when the cam pushes the follower towards the side its
    contact leads to; above about 30 deg the follower binds in its guide.
    """
    height, sideways, _ = _height(cam, np.asarray(angle, dtype=float))
    return np.arctan2(sideways, height)


def convex_curvature(cam: Cam, angle: ArrayLike) -> Array:
    """Curvature of the pitch curve, 1/mm, positive where convex; the roller fits while it is below 1 / its radius.

    (H^2 + q (q + s') - H s'') / (H^2 + q^2)^(3/2), with q = s' - sgn e.
    """
    height, sideways, motion = _height(cam, np.asarray(angle, dtype=float))
    top = height**2 + sideways * (sideways + motion.velocity) - height * motion.acceleration
    return top / np.hypot(height, sideways) ** 3


def _height(cam: Cam, angle: Array):
    motion = cam.program.motion(angle)
    height = np.sqrt(cam.prime_radius**2 - cam.follower.offset**2) + motion.lift
    return height, motion.velocity - cam.sense * cam.follower.offset, motion
