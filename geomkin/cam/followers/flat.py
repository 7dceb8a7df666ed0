"""Followers with a flat face: on a straight line and on an arm."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from ...errors import DesignError
from ...plane.pose import Pose
from ...plane.vec import Array
from ...sizes import FARTHEST, check_sizes, entry, quantity
from .contact import AbstractFollower, Contact, on_face
from ..extremes import largest
from .pivot import Side, arm_direction, check_side, side_sign
from ..program.program import FollowerMotion, Program


@dataclass(frozen=True)
class TranslatingFlat(AbstractFollower):
    """A flat face that moves along y. At lift 0 it touches the base circle."""

    tilt_deg: float = quantity(
        "angle of the face from the x axis, counterclockwise", "deg", default=0.0, above=-90, below=90
    )
    kind: Literal["translating-flat"] = "translating-flat"
    oscillates: ClassVar[bool] = False
    rolls: ClassVar[bool] = False

    def __post_init__(self) -> None:
        check_sizes(self)

    @property
    def tilt(self) -> float:
        """rad."""
        return float(np.radians(self.tilt_deg))

    def check(self, base_radius: float, program: Program, sense: int) -> None:
        """Nothing: a face that moves straight reaches every cam."""

    def base_radii(self, largest_lift: float) -> tuple[float, float]:
        return 0.0, np.inf

    def contact(self, motion: FollowerMotion, base_radius: float, sense: int) -> Contact:
        """p = Rb + s cos(tilt), and the normal stands still: the pressure angle is the tilt, times the cam's sense."""
        cosine = np.cos(self.tilt)
        lift, still = base_radius + cosine * motion.lift, 0 * motion.lift
        distance = lift, cosine * motion.velocity, cosine * motion.acceleration
        normal = 1j * np.exp(1j * self.tilt) + still
        return on_face(normal, distance, (still - sense, still), still + sense * self.tilt, sense)

    def place(self, lift: Array, base_radius: float) -> Pose:
        """Origin where the face crosses the y axis, x axis along the face."""
        origin = 1j * (base_radius / np.cos(self.tilt) + lift)
        return Pose(origin, np.full(np.shape(lift), np.exp(1j * self.tilt)))

    def resting_lift(self, points: Array, base_radius: float) -> Array:
        return (np.imag(points * np.exp(-1j * self.tilt)) - base_radius) / np.cos(self.tilt)


@dataclass(frozen=True)
class OscillatingFlat(AbstractFollower):
    """A flat face on an arm that swings about a pivot at (pivot_distance, 0).

    psi = asin((Rb - f) / c) + lift is the angle at the pivot between the line to the cam's axis and the
    face, with Rb the base radius, c the pivot distance and f the face offset.
    """

    pivot_distance: float = quantity(
        "distance of the arm's pivot from the cam axis, along +x", "mm", above=0, at_most=FARTHEST, example=100
    )
    face_offset: float = quantity(
        "distance of the face from the pivot, positive where the pivot lies on the cam's side of it",
        "mm",
        default=0.0,
        at_least=-FARTHEST,
        at_most=FARTHEST,
    )
    side: Side = entry("side of the line from cam axis to pivot on which the face rides", default="above")
    kind: Literal["oscillating-flat"] = "oscillating-flat"
    oscillates: ClassVar[bool] = True
    rolls: ClassVar[bool] = False

    def __post_init__(self) -> None:
        check_sizes(self)
        check_side(self.side)

    def check(self, base_radius: float, program: Program, sense: int) -> None:
        """The face must reach the cam on the cam's side of its pivot, and turn against it all the way round."""
        lift = largest(program.breaks, lambda t: program.motion(t).lift)[0]
        low, high = self.base_radii(lift)
        if not low < base_radius < high:
            raise DesignError(
                "follower.pivot_distance",
                f"found {self.pivot_distance:g} mm with face_offset {self.face_offset:g} mm and lifts up to "
                f"{np.degrees(lift):.4g} deg: the face reaches cams with a base_radius above {low:.4g} and below "
                f"{high:.4g} mm, not {base_radius:g}",
                "change pivot_distance, face_offset or base_radius",
            )
        tau = side_sign(self.side)
        slowest, angle = largest(program.breaks, lambda t: -sense * tau * program.motion(t).velocity)
        if slowest >= 1:
            raise DesignError(
                "program",
                f"at {np.degrees(angle):.4g} deg the face turns with the cam, and {slowest:.4g} times as fast: "
                "no profile can move it so",
                "give a longer segment or a smaller lift there",
            )

    def base_radii(self, largest_lift: float) -> tuple[float, float]:
        c, f = self.pivot_distance, self.face_offset
        # At psi = -90 and 90 deg the face stands square to the line of the two axes, and touches beside its pivot.
        return max(0.0, f - c), max(0.0, f + c * float(np.cos(np.clip(largest_lift, 0, np.pi))))

    def start_angle(self, base_radius: float) -> float:
        """psi at lift 0, rad."""
        return float(np.arcsin((base_radius - self.face_offset) / self.pivot_distance))

    def contact(self, motion: FollowerMotion, base_radius: float, sense: int) -> Contact:
        """p = c sin(psi) + f; it touches at the distance c cos(psi) / (1 + sgn tau s') from the pivot's foot."""
        tau, c = side_sign(self.side), self.pivot_distance
        psi = self.start_angle(base_radius) + motion.lift
        sine, cosine = c * np.sin(psi), c * np.cos(psi)
        v, a = motion.velocity, motion.acceleration
        distance = sine + self.face_offset, cosine * v, cosine * a - sine * v**2
        still = 0 * psi
        turn = -sense - tau * v + still, -tau * a + still
        along = cosine / (1 + sense * tau * v)
        pressure_angle = np.arctan2(self.face_offset + still, along)
        return on_face(-1j * tau * arm_direction(psi, tau), distance, turn, pressure_angle, sense)

    def place(self, lift: Array, base_radius: float) -> Pose:
        """Origin at the pivot, x axis along the face towards the cam."""
        direction = arm_direction(self.start_angle(base_radius) + lift, side_sign(self.side))
        return Pose(np.full(np.shape(lift), complex(self.pivot_distance)), direction)

    def resting_lift(self, points: Array, base_radius: float) -> Array:
        away = points - self.pivot_distance
        with np.errstate(invalid="ignore"):
            along = np.sqrt(np.abs(away) ** 2 - self.face_offset**2)
        psi = -side_sign(self.side) * np.angle(-away) - np.arctan2(self.face_offset, along)
        return np.where(np.isfinite(along), psi - self.start_angle(base_radius), -np.inf)
