"""Poses and kinematic coefficients of bodies, and the placements that involve no choice of branch.

A placement computes the poses of its bodies and their first and second kinematic coefficients: derivatives by the drive
q, which do not depend on the driver's speed (Uicker, Pennock, Shigley, Theory of Machines and Mechanisms, chapters 3,
4).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import field
from functools import cached_property
from typing import Any, TypeVar

import numpy as np

from ...core.records import record
from ...plane.vec import Complex, Real, Whole, cross, dot
from .recording import paired

Numbers = TypeVar("Numbers", Real, Complex)


@record(eq=False)
class Coefficients:
    """Kinematic coefficients of one order over the frames, in the fixed body's frame.

    origin: derivatives of the bodies' origins, mm per unit of drive to that order; theta_prime: of their angles, rad.
    """

    origin: dict[str, Complex] = field(default_factory=dict)
    theta_prime: dict[str, Real] = field(default_factory=dict)


@record(eq=False)
class Poses:
    """Poses of bodies over the frames, in the fixed body's frame.

    origin: positions, mm, of the bodies' origins; direction: of their x axes, unit complex. drive: q, rad or mm. cache:
    intermediate results of a placement. elsewhere: poses and first coefficients at other drives, of the placements
    before one that needs poses between the frames.
    """

    origin: dict[str, Complex] = field(default_factory=dict)
    direction: dict[str, Complex] = field(default_factory=dict)
    drive: Real = field(default_factory=lambda: np.zeros(()))
    cache: dict[Placement, Any] = field(default_factory=dict)
    elsewhere: Callable[[Real], tuple[Poses, Coefficients]] | None = None

    @cached_property
    def half(self) -> tuple[Real, Real]:
        """Cosine and sine of q/2, computed once, as they are the most expensive numbers of a frame."""
        half = 0.5 * self.drive
        return np.cos(half), np.sin(half)


@record(eq=False)
class Anchor:
    """A point of a placed body plus arms that turn with bodies: origin + direction place + sum(direction arm)."""

    body: str
    place: complex | Complex
    arms: tuple[tuple[str, complex | Complex], ...] = ()

    @cached_property
    def _arms(self) -> list[tuple[str, complex | Complex]]:
        return [(b, z) for b, z in ((self.body, self.place), *self.arms) if np.any(z != 0)]

    def at(self, p0: Poses) -> Complex:
        """Position, mm."""
        return _sum(p0.origin[self.body], [p0.direction[b] * z for b, z in self._arms])

    def first(self, p0: Poses, p1: Coefficients) -> Complex:
        """First derivative of the position."""
        arms = [1j * p1.theta_prime[b] * (p0.direction[b] * z) for b, z in self._arms]
        return _sum(p1.origin[self.body], arms)

    def second(self, p0: Poses, p1: Coefficients, p2: Coefficients) -> Complex:
        """Second derivative of the position."""
        arms = [(1j * p2.theta_prime[b] - p1.theta_prime[b] ** 2) * (p0.direction[b] * z) for b, z in self._arms]
        return _sum(p2.origin[self.body], arms)


def _sum(origin: Complex, arms: list[Complex]) -> Complex:
    """The sum; an origin at zero, as of most grounds, is not added to every frame."""
    if arms and np.ndim(origin) == 0 and origin == 0:
        origin, *arms = arms
    for arm in arms:
        origin = origin + arm
    return origin


@record(eq=False)
class SlideAxis:
    """A direction that turns with a body."""

    body: str
    direction: complex | Complex

    def at(self, p0: Poses) -> Complex:
        """The direction in the fixed body's frame."""
        return p0.direction[self.body] * self.direction


class Placement(ABC):
    """Places one or two bodies, or all remaining ones, on those that are placed already."""

    @abstractmethod
    def place(self, p0: Poses, branch: Whole | int) -> None:
        """Compute the poses, on one branch of a dyad; nan where it cannot close."""

    def reached(self, p0: Poses) -> Complex | None:
        """An array that is nan where the bodies cannot be placed; None if they always can."""
        return None

    @abstractmethod
    def first(self, p0: Poses, p1: Coefficients) -> None:
        """Compute the first derivatives by the drive."""

    @abstractmethod
    def second(self, p0: Poses, p1: Coefficients, p2: Coefficients) -> None:
        """Compute the second derivatives by the drive."""

    def joint_directions(self, p0: Poses) -> tuple[Complex, Complex] | None:
        """Directions, of any length, in which a joint's two members let it move: parallel at a dead centre; or None."""
        return None

    def transmission_angle(self, p0: Poses) -> Real | None:
        """Smallest acute angle between the directions in which two members let their joint move, rad; or None."""
        directions = self.joint_directions(p0)
        return None if directions is None else np.arctan2(np.abs(cross(*directions)), np.abs(dot(*directions)))


@record(eq=False)
class RevoluteInput(Placement):
    """The driver if it is the angle of a body: its direction is e^{iq}."""

    body: str

    def place(self, p0: Poses, branch: Whole | int) -> None:
        cosine, sine = p0.half
        p0.direction[self.body] = paired((cosine - sine) * (cosine + sine), 2 * sine * cosine)

    def first(self, p0: Poses, p1: Coefficients) -> None:
        p1.theta_prime[self.body] = np.asarray(1.0)

    def second(self, p0: Poses, p1: Coefficients, p2: Coefficients) -> None:
        p2.theta_prime[self.body] = np.zeros(())


@record(eq=False)
class PrismaticInput(Placement):
    """The driver if it slides: a body of known direction whose point `local` is at `through` + q along `rail`."""

    body: str
    local: complex | Complex
    through: Anchor
    rail: SlideAxis

    @cached_property
    def _anchor(self) -> Anchor:
        return Anchor(self.through.body, self.through.place, ((self.body, -self.local),))

    def place(self, p0: Poses, branch: Whole | int) -> None:
        p0.origin[self.body] = self._anchor.at(p0) + p0.drive * self.rail.at(p0)

    def first(self, p0: Poses, p1: Coefficients) -> None:
        theta_prime = p1.theta_prime[self.rail.body]
        p1.origin[self.body] = self._anchor.first(p0, p1) + (1 + 1j * theta_prime * p0.drive) * self.rail.at(p0)

    def second(self, p0: Poses, p1: Coefficients, p2: Coefficients) -> None:
        theta_prime, theta_second = p1.theta_prime[self.rail.body], p2.theta_prime[self.rail.body]
        # 2 i theta' is the Coriolis term.
        coefficient = 2j * theta_prime + (1j * theta_second - theta_prime**2) * p0.drive
        p2.origin[self.body] = self._anchor.second(p0, p1, p2) + coefficient * self.rail.at(p0)


@record(eq=False)
class StrokeInput(Placement):
    """The drive as the position of an artificial body `name`, for loops that contain the actuator."""

    name: str

    def place(self, p0: Poses, branch: Whole | int) -> None:
        p0.origin[self.name], p0.direction[self.name] = paired(p0.drive, np.zeros(())), np.ones((), dtype=complex)

    def first(self, p0: Poses, p1: Coefficients) -> None:
        p1.origin[self.name], p1.theta_prime[self.name] = np.ones((), dtype=complex), np.zeros(())

    def second(self, p0: Poses, p1: Coefficients, p2: Coefficients) -> None:
        p2.origin[self.name], p2.theta_prime[self.name] = np.zeros((), dtype=complex), np.zeros(())


@record(eq=False)
class AlignedBody(Placement):
    """A body that turns with another one, at the constant angle of `rotation` from its x axis."""

    body: str
    with_body: str
    rotation: complex | Complex

    def place(self, p0: Poses, branch: Whole | int) -> None:
        p0.direction[self.body] = p0.direction[self.with_body] * self.rotation

    def first(self, p0: Poses, p1: Coefficients) -> None:
        p1.theta_prime[self.body] = p1.theta_prime[self.with_body]

    def second(self, p0: Poses, p1: Coefficients, p2: Coefficients) -> None:
        p2.theta_prime[self.body] = p2.theta_prime[self.with_body]


@record(eq=False)
class GearedBody(Placement):
    """A body that gears turn `ratio` times as fast as the driver; its angle, rad, is `start` where the drive is 0."""

    body: str
    ratio: float
    start: Real | float

    def place(self, p0: Poses, branch: Whole | int) -> None:
        angle = self.ratio * p0.drive + self.start
        p0.direction[self.body] = paired(np.cos(angle), np.sin(angle))

    def first(self, p0: Poses, p1: Coefficients) -> None:
        p1.theta_prime[self.body] = np.asarray(self.ratio)

    def second(self, p0: Poses, p1: Coefficients, p2: Coefficients) -> None:
        p2.theta_prime[self.body] = np.zeros(())


@record(eq=False)
class PinnedBody(Placement):
    """A body of known direction whose point `local` is pinned at a known point `pin`."""

    body: str
    local: complex | Complex
    pin: Anchor

    @cached_property
    def _anchor(self) -> Anchor:
        return Anchor(self.pin.body, self.pin.place, (*self.pin.arms, (self.body, -self.local)))

    def place(self, p0: Poses, branch: Whole | int) -> None:
        p0.origin[self.body] = self._anchor.at(p0)

    def first(self, p0: Poses, p1: Coefficients) -> None:
        p1.origin[self.body] = self._anchor.first(p0, p1)

    def second(self, p0: Poses, p1: Coefficients, p2: Coefficients) -> None:
        p2.origin[self.body] = self._anchor.second(p0, p1, p2)
