"""Followers that roll: on a straight line and on an arm."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from ...errors import DesignError
from ...plane.pose import Pose
from ...plane.vec import Array
from ...sizes import FARTHEST, check_sizes, entry, quantity
from .contact import AbstractFollower, Contact, on_roller
from ..extremes import largest
from .pivot import Side, arm_direction, check_side, side_sign
from ..program.program import FollowerMotion, Program


@dataclass(frozen=True)
class TranslatingRoller(AbstractFollower):
    """A roller that moves along a straight line parallel to y; radius 0 is a knife edge."""

    roller_radius: float = quantity("radius of the roller", "mm", at_least=0, at_most=FARTHEST, example=10)
    offset: float = quantity(
        "distance of the follower's line from the cam axis, positive to +x",
        "mm",
        default=0.0,
        at_least=-FARTHEST,
        at_most=FARTHEST,
    )
    kind: Literal["translating-roller"] = "translating-roller"
    oscillates: ClassVar[bool] = False
    rolls: ClassVar[bool] = True

    def __post_init__(self) -> None:
        check_sizes(self)

    def check(self, base_radius: float, program: Program, sense: int) -> None:
        prime = base_radius + self.roller_radius
        if abs(self.offset) >= prime:
            raise DesignError(
                "follower.offset",
                f"found {self.offset:g} mm, but the roller's centre starts {prime:g} mm from the axis",
                f"give an offset below {prime:g} mm or a larger base_radius",
            )

    def base_radii(self, largest_lift: float) -> tuple[float, float]:
        return max(0.0, abs(self.offset) - self.roller_radius), np.inf

    def start_height(self, base_radius: float) -> float:
        """Height of the roller's centre above the cam's axis at lift 0, mm."""
        return float(np.sqrt((base_radius + self.roller_radius) ** 2 - self.offset**2))

    def contact(self, motion: FollowerMotion, base_radius: float, sense: int) -> Contact:
        centre = self.offset + 1j * (self.start_height(base_radius) + motion.lift)
        slope, bend = 1j * motion.velocity, 1j * motion.acceleration
        return on_roller(centre, slope, bend, self.roller_radius, sense, 1j, sense)

    def place(self, lift: Array, base_radius: float) -> Pose:
        """Origin at the roller's centre, x axis as the ground's."""
        return Pose(self.offset + 1j * (self.start_height(base_radius) + lift), np.ones(np.shape(lift), complex))

    def resting_lift(self, points: Array, base_radius: float) -> Array:
        aside = points.real - self.offset
        with np.errstate(invalid="ignore"):
            lift = points.imag + np.sqrt(self.roller_radius**2 - aside**2) - self.start_height(base_radius)
        return np.where(np.isfinite(lift), lift, -np.inf)


@dataclass(frozen=True)
class OscillatingRoller(AbstractFollower):
    """A roller on an arm that swings about a pivot at (pivot_distance, 0); radius 0 is a knife edge.

    psi = acos((c^2 + L^2 - Rp^2) / 2 c L) + lift is the angle at the pivot between the lines to the cam's
    axis and to the roller's centre, with c the pivot distance, L the arm length and Rp the prime radius.
    """

    roller_radius: float = quantity("radius of the roller", "mm", at_least=0, at_most=FARTHEST, example=10)
    pivot_distance: float = quantity(
        "distance of the arm's pivot from the cam axis, along +x", "mm", above=0, at_most=FARTHEST, example=100
    )
    arm_length: float = quantity(
        "distance of the roller's centre from the pivot", "mm", above=0, at_most=FARTHEST, example=80
    )
    side: Side = entry("side of the line from cam axis to pivot on which the roller rides", default="above")
    kind: Literal["oscillating-roller"] = "oscillating-roller"
    oscillates: ClassVar[bool] = True
    rolls: ClassVar[bool] = True

    def __post_init__(self) -> None:
        check_sizes(self)
        check_side(self.side)

    def check(self, base_radius: float, program: Program, sense: int) -> None:
        lift = largest(program.breaks, lambda t: program.motion(t).lift)[0]
        low, high = self.base_radii(lift)
        if not low < base_radius < high:
            raise DesignError(
                "follower.arm_length",
                f"found {self.arm_length:g} mm with pivot_distance {self.pivot_distance:g} mm and lifts up to "
                f"{np.degrees(lift):.4g} deg: the arm reaches cams with a base_radius above {low:.4g} and below "
                f"{high:.4g} mm, not {base_radius:g}",
                "change arm_length, pivot_distance or base_radius",
            )

    def base_radii(self, largest_lift: float) -> tuple[float, float]:
        c, arm = self.pivot_distance, self.arm_length
        # At psi = 180 deg the arm points straight away from the axis and can swing no farther from it.
        farthest = np.sqrt(c**2 + arm**2 + 2 * c * arm * np.cos(np.clip(largest_lift, 0, np.pi)))
        return max(0.0, abs(c - arm) - self.roller_radius), max(0.0, float(farthest) - self.roller_radius)

    def start_angle(self, base_radius: float) -> float:
        """psi at lift 0, rad."""
        c, arm, prime = self.pivot_distance, self.arm_length, base_radius + self.roller_radius
        # By the half angle, which keeps its digits where the three points are nearly in line.
        opposite, adjacent = (prime - c + arm) * (prime + c - arm), (c + arm - prime) * (c + arm + prime)
        return 2 * float(np.arctan2(np.sqrt(opposite), np.sqrt(adjacent)))

    def contact(self, motion: FollowerMotion, base_radius: float, sense: int) -> Contact:
        tau = side_sign(self.side)
        reach = self.arm_length * arm_direction(self.start_angle(base_radius) + motion.lift, tau)
        # The arm's direction turns by -tau per unit of lift.
        slope = -1j * tau * motion.velocity * reach
        bend = -1j * tau * motion.acceleration * reach - motion.velocity**2 * reach
        way = -1j * tau * reach / self.arm_length
        return on_roller(self.pivot_distance + reach, slope, bend, self.roller_radius, sense, way, tau)

    def place(self, lift: Array, base_radius: float) -> Pose:
        """Origin at the pivot, x axis towards the roller's centre."""
        direction = arm_direction(self.start_angle(base_radius) + lift, side_sign(self.side))
        return Pose(np.full(np.shape(lift), complex(self.pivot_distance)), direction)

    def resting_lift(self, points: Array, base_radius: float) -> Array:
        away = points - self.pivot_distance
        arm, gap = self.arm_length, np.abs(away)
        with np.errstate(invalid="ignore", divide="ignore"):
            spread = np.arccos((arm**2 + gap**2 - self.roller_radius**2) / (2 * arm * gap))
        # Angle at the pivot from the line to the axis to that to the point, and on to the roller beyond it.
        psi = -side_sign(self.side) * np.angle(-away) + spread
        return np.where(np.isfinite(spread), psi - self.start_angle(base_radius), -np.inf)
