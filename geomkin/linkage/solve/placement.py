"""How bodies are placed one after the other: what that is told by, and the placements without a choice.

A placement writes where its bodies are, and their first and second kinematic coefficients: the derivatives of that by
the drive q, whatever the driver's speed (Uicker, Pennock, Shigley, Theory of Machines and Mechanisms, chapters 3, 4).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import field
from functools import cached_property
from typing import Any, TypeVar

import numpy as np

from ...core.records import record
from ...plane.vec import Array, Complex, Real, Whole, cross, dot
from . import tape as tape
from .tape import Recorded

Numbers = TypeVar("Numbers", Real, Complex)


@record(eq=False)
class Coefficients:
    """Kinematic coefficients of one order over a row of frames, in the fixed body's frame.

    origin: of the bodies' origins, mm per unit of drive to that order; turn: of their angles, rad.
    """

    origin: dict[str, Complex] = field(default_factory=dict)
    turn: dict[str, Real] = field(default_factory=dict)


@record(eq=False)
class Poses:
    """Where bodies are over a row of frames, in the fixed body's frame.

    origin: places, mm, of the bodies' origins; turn: their directions, unit complex. drive: q, rad or mm. kept: what a
    placement worked out and needs again. elsewhere: poses and first coefficients at other drives, of the placements
    before one that looks between the frames.
    """

    origin: dict[str, Complex] = field(default_factory=dict)
    turn: dict[str, Complex] = field(default_factory=dict)
    drive: Real = field(default_factory=lambda: np.zeros(()))
    kept: dict[Placement, Any] = field(default_factory=dict)
    elsewhere: Callable[[Real], tuple[Poses, Coefficients]] | None = None

    @cached_property
    def half(self) -> tuple[Real, Real]:
        """Cosine and sine of q/2: the dearest numbers of a frame, worked out once."""
        half = 0.5 * self.drive
        return np.cos(half), np.sin(half)


@record(eq=False)
class Anchor:
    """A point of a placed body, then along arms that turn with bodies: origin + turn place + sum(turn arm)."""

    body: str
    place: complex | Complex
    arms: tuple[tuple[str, complex | Complex], ...] = ()

    @cached_property
    def _arms(self) -> list[tuple[str, complex | Complex]]:
        return [(b, z) for b, z in ((self.body, self.place), *self.arms) if isinstance(z, np.ndarray) or z != 0]

    def at(self, p0: Poses) -> Complex:
        """Its position, mm."""
        return _sum(p0.origin[self.body], [scaled(p0.turn[b], z) for b, z in self._arms])

    def first(self, p0: Poses, p1: Coefficients) -> Complex:
        """Its first derivative."""
        arms = [times(1j * p1.turn[b], scaled(p0.turn[b], z)) for b, z in self._arms]
        return _sum(p1.origin[self.body], arms)

    def second(self, p0: Poses, p1: Coefficients, p2: Coefficients) -> Complex:
        """Its second derivative."""
        arms = [times(1j * p2.turn[b] - p1.turn[b] ** 2, scaled(p0.turn[b], z)) for b, z in self._arms]
        return _sum(p2.origin[self.body], arms)


def _sum(origin: Complex, arms: list[Complex]) -> Complex:
    """Their sum, written over the arms; an origin at zero, as that of most grounds, is not added to every frame."""
    if not arms:
        return origin
    total = arms[0] if np.ndim(origin) == 0 and origin == 0 else plus(arms[0], origin)
    for arm in arms[1:]:
        total = plus(total, arm)
    return total


# A new row of frames costs as much as what is calculated in it, so that rows nobody needs any more are written over.
def plus(used: Array, other: Array) -> Array:
    """used + other, written over `used` where it has the room."""
    if other.shape and other.shape != used.shape:
        return used + other
    used += other
    return used


def times(used: Array, by: Array | complex) -> Array:
    """used * by, written over `used` where it has the room."""
    if isinstance(by, np.ndarray) and by.shape and by.shape != used.shape:
        return used * by
    used *= by
    return used


def paired(real: Real, imag: Real) -> Complex:
    """Complex numbers of their parts, which 1j * imag would not be where that is not finite."""
    for one in (real, imag):
        if isinstance(one, Recorded):
            recorded: Any = one.tape.record(tape.paired, (real, imag))
            return recorded
    both: Complex = np.empty(real.shape, dtype=complex)
    both.real, both.imag = real, imag
    return both


def scaled(z: Complex, by: Complex | complex, used: bool = False) -> Complex:
    """z times a constant, at a third of the price where that is real; `used`: written over z."""
    real = not (isinstance(by, np.ndarray) and by.ndim) and by.imag == 0
    factor = by.real if real else by
    return times(z, factor) if used else z * factor


@record(eq=False)
class SlideAxis:
    """A direction that turns with a body."""

    body: str
    direction: complex | Complex

    def at(self, p0: Poses) -> Complex:
        """The direction seen from the fixed body."""
        return p0.turn[self.body] * self.direction


class Placement(ABC):
    """Places one or two bodies, or what is left of them, on those that are placed already."""

    @abstractmethod
    def place(self, p0: Poses, branch: Whole | int) -> None:
        """Poses, on one branch of a dyad; nan where it cannot close."""

    def reached(self, p0: Poses) -> Complex | None:
        """What is nan where the bodies cannot be placed; None where they always can."""
        return None

    @abstractmethod
    def first(self, p0: Poses, p1: Coefficients) -> None:
        """First derivatives by the drive."""

    @abstractmethod
    def second(self, p0: Poses, p1: Coefficients, p2: Coefficients) -> None:
        """Second derivatives by the drive."""

    def meeting(self, p0: Poses) -> tuple[Complex, Complex] | None:
        """Where a joint has two ways to go, those directions, of any length: parallel at a dead centre."""
        return None

    def transmission_angle(self, p0: Poses) -> Real | None:
        """Least acute angle between the ways in which a joint's two members let it move, rad; None where none has."""
        ways = self.meeting(p0)
        return None if ways is None else np.arctan2(np.abs(cross(*ways)), np.abs(dot(*ways)))


@record(eq=False)
class RevoluteInput(Placement):
    """The driver where it is a body's angle: its direction is e^{iq}."""

    body: str

    def place(self, p0: Poses, branch: Whole | int) -> None:
        cosine, sine = p0.half
        p0.turn[self.body] = paired((cosine - sine) * (cosine + sine), 2 * sine * cosine)

    def first(self, p0: Poses, p1: Coefficients) -> None:
        p1.turn[self.body] = np.asarray(1.0)

    def second(self, p0: Poses, p1: Coefficients, p2: Coefficients) -> None:
        p2.turn[self.body] = np.zeros(())


@record(eq=False)
class PrismaticInput(Placement):
    """The driver where it slides: a body of known direction whose `local` point is q beyond `through` along `rail`."""

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
        turn = p1.turn[self.rail.body]
        p1.origin[self.body] = self._anchor.first(p0, p1) + (1 + 1j * turn * p0.drive) * self.rail.at(p0)

    def second(self, p0: Poses, p1: Coefficients, p2: Coefficients) -> None:
        turn, turn_2 = p1.turn[self.rail.body], p2.turn[self.rail.body]
        # 2 i turn is the Coriolis term.
        gain = 2j * turn + (1j * turn_2 - turn**2) * p0.drive
        p2.origin[self.body] = self._anchor.second(p0, p1, p2) + gain * self.rail.at(p0)


@record(eq=False)
class StrokeInput(Placement):
    """The drive as the place of a body of its own, `name`, for loops that an actuator among them has to meet."""

    name: str

    def place(self, p0: Poses, branch: Whole | int) -> None:
        p0.origin[self.name], p0.turn[self.name] = paired(p0.drive, np.zeros(())), np.ones((), dtype=complex)

    def first(self, p0: Poses, p1: Coefficients) -> None:
        p1.origin[self.name], p1.turn[self.name] = np.ones((), dtype=complex), np.zeros(())

    def second(self, p0: Poses, p1: Coefficients, p2: Coefficients) -> None:
        p2.origin[self.name], p2.turn[self.name] = np.zeros((), dtype=complex), np.zeros(())


@record(eq=False)
class AlignedBody(Placement):
    """A body that turns with another: `turn` from its x axis."""

    body: str
    with_body: str
    turn: complex | Complex

    def place(self, p0: Poses, branch: Whole | int) -> None:
        p0.turn[self.body] = p0.turn[self.with_body] * self.turn

    def first(self, p0: Poses, p1: Coefficients) -> None:
        p1.turn[self.body] = p1.turn[self.with_body]

    def second(self, p0: Poses, p1: Coefficients, p2: Coefficients) -> None:
        p2.turn[self.body] = p2.turn[self.with_body]


@record(eq=False)
class PinnedBody(Placement):
    """A body whose direction is known, pinned at a point that is: its own `local` on `pin`."""

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
