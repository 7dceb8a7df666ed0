"""What a cam, its checks and its plates ask of a follower, whatever its shape."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal

import numpy as np

from ...arguments import Sort
from ...brief import one_line
from ...plane.curve import AbstractCurve
from ...plane.vec import Complex, Pose, Real
from ...sizes import KindTable, OneOfKinds
from ..program.program import FollowerMotion, Program
from .plates import Bars, Plate

# kind -> class of all followers that a recipe may name; filled in this folder's `__init__`, and open to others.
FOLLOWERS: KindTable[AbstractFollower] = KindTable()

Side = Literal["above", "below"]


@dataclass(frozen=True, eq=False)
class Contact:
    """Cam and follower where they touch, over cam angles; arrays of one shape, in the ground's frame.

    point: where they touch, mm. normal: direction from the cam into the follower, unit.
    turn: how fast the normal turns as seen from the cam, rad per rad of cam angle.
    advance: how fast the contact moves along the profile, mm/rad, positive against the cam's turning;
    where it is negative the follower cuts away what it touched before.
    pressure_angle: rad, signed, between the normal and the way the follower is free to go there.

    Source: the profile as envelope of the follower's positions (Chen, Mechanics and Design of Cam Mechanisms, 1982);
    turn and advance derived here.
    """

    point: Complex
    normal: Complex
    turn: Real
    advance: Real
    pressure_angle: Real

    __repr__ = one_line


class AbstractFollower(ABC):
    """What rides on a cam that turns about the origin: all that cam, judge and shop ask of it.

    A subclass is a frozen dataclass of its sizes with a field `kind`, a Literal with itself as default; with a row in
    `FOLLOWERS`, recipes, templates and the schema know it. Most roll (`AbstractRoller`) or have a flat face
    (`AbstractFace`); those two answer half of these questions.

    Throughout, `sense` is +1 for a cam that turns counterclockwise, -1 for clockwise, `base_radius` is in mm, and
    lifts, mm, or rad where it oscillates, are 0 on the base circle and positive away from the cam. Methods that take
    a `motion` answer at each of its cam angles, those that take the `program` for the whole turn. Derived here.
    """

    kind: str
    # Table that recipes tell followers apart by.
    KINDS: ClassVar[KindTable[AbstractFollower]] = FOLLOWERS
    # mm. Of the cam that a template shows with it, whose lift is 20 mm or deg.
    example_base_radius: ClassVar[float] = 40.0

    @property
    @abstractmethod
    def oscillates(self) -> bool:
        """Whether it swings about a pivot, so that its lifts are angles."""

    @property
    def lift_unit(self) -> tuple[str, float]:
        """Unit in which people are told its lifts, and how many of it are one mm or rad."""
        return ("deg", 180 / np.pi) if self.oscillates else ("mm", 1.0)

    @property
    @abstractmethod
    def size(self) -> float:
        """The largest of its own lengths, mm, 0 where it has none: a cam for it is of about that size or more."""

    @property
    @abstractmethod
    def rounding(self) -> float:
        """Radius of the roller that touches the cam, mm; 0 for a knife edge and for a flat face."""

    @property
    @abstractmethod
    def knife_edge(self) -> AbstractFollower | None:
        """The same shrunk to a knife edge at the roller's centre, whose profile is the pitch curve; None of a face."""

    @abstractmethod
    def check(self, program: Program, base_radius: float, sense: int) -> None:
        """Raises DesignError where the follower cannot ride on such a cam."""

    @abstractmethod
    def base_radii(self, largest_lift: float) -> tuple[float, float]:
        """Base radii, mm, between which, both excluded, the follower can reach the cam in all its lifts."""

    @abstractmethod
    def contact(self, motion: FollowerMotion, base_radius: float, sense: int) -> Contact:
        """Where it touches a cam that it undercuts nowhere."""

    @abstractmethod
    def place(self, lift: Real, base_radius: float) -> Pose:
        """Its own frame in the ground's."""

    @abstractmethod
    def resting_lift(self, points: Complex, base_radius: float) -> Real:
        """Lift at which it rests on points of the ground, complex mm; minus infinity where it passes them by."""

    @abstractmethod
    def joint(self, pose: Pose, start: complex, end: complex) -> AbstractCurve:
        """The part of its surface between two points of contact, mm, along which contact runs while it stands still.

        That is where the programme's velocity jumps. pose: of its own frame, in the frame of the two points.
        """

    @abstractmethod
    def covered_from(self, motion: FollowerMotion, base_radius: float, sense: int) -> Real:
        """Distance from the cam's axis, mm, of a point that it covers, or whose far side it covers.

        Over a whole turn no cam is left beyond the largest of them.
        """

    @abstractmethod
    def convex_radius(self, program: Program, base_radius: float, sense: int) -> tuple[Real, Real]:
        """Least radius of curvature of each stretch of the profile where convex, mm, and the cam angle there, rad.

        Infinite where it is nowhere convex, 0 or less where the follower undercuts.
        """

    @abstractmethod
    def excess(self, motion: FollowerMotion, base_radius: float, sense: int, least_radius: float) -> Real:
        """Above 0 where the profile runs backwards, or has a convex radius of curvature below `least_radius`, mm."""

    @abstractmethod
    def contact_travel(self, program: Program, base_radius: float, sense: int) -> tuple[float, float] | None:
        """Ends of the stretch of its face that the cam touches, mm along its x axis; None of a roller."""

    @abstractmethod
    def plates(self, bars: Bars, program: Program, base_radius: float, sense: int) -> tuple[Plate, ...]:
        """What it is made of, each plate in its own frame. Raises DesignError where the bars' sizes do not fit."""

    def guided_plates(self, bars: Bars, program: Program, base_radius: float, sense: int) -> tuple[Plate, ...]:
        """The same over a base: one that moves straight has two holes `pivot_bore`, whose pins a slot guides.

        They are in line with its motion. Raises DesignError where they find no room.
        """
        return self.plates(bars, program, base_radius, sense)

    def least_base_radius(self, program: Program, least_radius: float) -> float | None:
        """Base radius, mm, at which the least convex radius is just `least_radius`, where a formula tells it."""
        return None


# As a field of a cam, told apart by its kind in a recipe.
Follower = Annotated[
    AbstractFollower,
    OneOfKinds(),
    Sort(
        lambda value: isinstance(value, AbstractFollower),
        "a follower, such as TranslatingRoller",
    ),
]


def side_sign(side: Side) -> int:
    """tau: +1 where an arm rides above the line from the cam's axis to its pivot, -1 below."""
    return 1 if side == "above" else -1


def arm_direction(psi: Real, tau: int) -> Complex:
    """Direction from the pivot along an arm at the angle psi, rad, from the line to the cam's axis."""
    return np.asarray(-np.exp(-1j * tau * psi))
