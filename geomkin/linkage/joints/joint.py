"""The contract of joints: what a joint answers to motion, forces, tolerances, plates and scene; and the pin."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from typing import Any, ClassVar, Protocol, Self, TypeVar

import numpy as np

from ...core.records import record
from ...model.scene import SceneMark
from ...model.table import Column, vector_columns
from ...plane.vec import Array, Complex, Real

# A size of the linkage that is a place, by owner and name, and the direction in its frame in which a clearance lets it
# move; None for any direction.
Play = tuple[str, str, complex | None]
# Effect of an unknown of 1 on the equations of equilibrium: row, and one value or one for each frame.
Effect = list[tuple[int, "Real | float"]]
# A force on a body at a place, mm in its frame, N on the ground, and a couple there, N mm.
JointForce = tuple[str, complex | Complex, Complex, Real]
Joint = TypeVar("Joint", bound="AbstractJoint")


# --- What joints see of the classes that ask them. Joints are below these, so they import none.


class LinkageOfJoint(Protocol):
    """A general linkage."""

    @property
    def driver(self) -> str: ...
    @property
    def bodies(self) -> Mapping[str, Mapping[str, Any]]: ...
    @property
    def ground(self) -> str: ...
    @property
    def joint_points(self) -> Mapping[str, tuple[str, ...]]: ...
    @property
    def slides(self) -> tuple[Any, ...]: ...
    @property
    def driven_slider(self) -> Any: ...


class MotionOfJoint(Protocol):
    """The motion of a linkage: bodies with origin, direction and points."""

    @property
    def linkage(self) -> LinkageOfJoint: ...
    @property
    def bodies(self) -> Mapping[str, Any]: ...
    def point(self, name: str) -> Any: ...
    def slide(self, name: str) -> Any: ...


class WrenchesOfJoint(Protocol):
    """Arms and positions of points of moving bodies."""

    @property
    def motion(self) -> Any: ...

    def arm(self, body: str, place: complex | Complex) -> Complex: ...
    def position(self, body: str, place: complex | Complex) -> Complex: ...


class EquilibriumOfJoint(Protocol):
    """The equations of equilibrium."""

    @property
    def wrenches(self) -> WrenchesOfJoint: ...
    def force(self, body: str, arm: Complex, force: Complex | complex) -> Effect: ...
    def pressed(self, slider: Any, force: complex | Real) -> Effect: ...
    def turned(self, body: str, other: str, moment: Real | float) -> Effect: ...


class ForcesOfJoint(Protocol):
    """The forces in a motion."""

    @property
    def motion(self) -> MotionOfJoint: ...
    @property
    def driver(self) -> Real: ...
    def pin(self, name: str, on: str) -> Complex: ...
    def slide(self, name: str) -> Any: ...
    def mesh(self, name: str) -> Real: ...


class AbstractJoint(ABC):
    """What holds two or more bodies together.

    noun: of the kind, for messages. freedoms: that it removes between two bodies. name: of the joint. bodies: that it
    joins, in the order in which forces count.
    """

    noun: ClassVar[str]
    freedoms: ClassVar[int]
    name: str

    @property
    @abstractmethod
    def bodies(self) -> tuple[str, ...]: ...

    @property
    def count(self) -> int:
        """Number of joints of two bodies that it stands for."""
        return len(self.bodies) - 1

    @property
    def removes(self) -> int:
        """Freedoms that it removes, which is also the number of its unknown reactions."""
        return self.freedoms * self.count

    @property
    @abstractmethod
    def points(self) -> Mapping[str, tuple[str, ...]]:
        """Named points at which it is, with the bodies to which each belongs."""

    @property
    def sizes(self) -> Mapping[str, complex | Array]:
        """Its own sizes by field: places, mm, and angles, deg, whose names end in _deg."""
        return {}

    @property
    def program_sizes(self) -> tuple[str, ...]:
        """Attributes that the placements read, as inputs of a program."""
        return ()

    def with_sizes(self, sizes: Mapping[str, object]) -> Self:
        """A copy with other values of some attributes, which are not checked again."""
        copy = object.__new__(type(self))
        copy.__dict__.update({**self.__dict__, **sizes})
        return copy

    @property
    def plays(self) -> tuple[Play, ...]:
        """Places that its clearance leaves free to move, by half of it to each side."""
        return ()

    @abstractmethod
    def gap(self, motion: MotionOfJoint) -> Real:
        """Distance, mm, between what it keeps together; zero apart from rounding."""

    def columns(self, motion: MotionOfJoint) -> Iterator[Column]:
        """Its columns in the table of a motion."""
        yield from ()

    def coefficients(self, motion: MotionOfJoint, order: str, unit: str) -> Iterator[Column]:
        """Columns of its kinematic coefficients; order: "first" or "second"."""
        yield from ()

    @abstractmethod
    def marks(self, motion: MotionOfJoint) -> Iterator[SceneMark]:
        """Its marks in the scene."""

    @abstractmethod
    def effects(self, equilibrium: EquilibriumOfJoint) -> Iterator[Effect]:
        """Effect of each of its unknown reactions, `removes` in number, on the equations of equilibrium."""

    @abstractmethod
    def forces(self, analysis: ForcesOfJoint, wrenches: WrenchesOfJoint) -> Iterator[JointForce]:
        """Its forces on the bodies, with that of a driver in it."""

    @abstractmethod
    def force_columns(self, analysis: ForcesOfJoint) -> Iterator[Column]:
        """Columns of its reactions."""


@record(eq=False)
class PinJoint(AbstractJoint):
    """A point that two or more bodies name; places: in the frame of each, mm."""

    noun = "pin"
    freedoms = 2
    name: str
    places: Mapping[str, complex | Array]

    @property
    def bodies(self) -> tuple[str, ...]:
        return tuple(self.places)

    @property
    def points(self) -> Mapping[str, tuple[str, ...]]:
        return {self.name: self.bodies}

    @property
    def plays(self) -> tuple[Play, ...]:
        return tuple((body, self.name, None) for body in self.bodies)

    def gap(self, motion: MotionOfJoint) -> Real:
        first, *others = (motion.bodies[body].point(place).position for body, place in self.places.items())
        gaps: Real = np.max([np.abs(other - first) for other in others], axis=0)
        return gaps

    def marks(self, motion: MotionOfJoint) -> Iterator[SceneMark]:
        kind = "fixed pin" if motion.linkage.ground in self.bodies else "pin"
        yield SceneMark(kind, motion.point(self.name).position, "construction", self.name)  # type: ignore[arg-type]

    def effects(self, equilibrium: EquilibriumOfJoint) -> Iterator[Effect]:
        """A force on each body but the first, its x and y."""
        first, *others = ((body, equilibrium.wrenches.arm(body, place)) for body, place in self.places.items())
        for other in others:
            for unit in (1, 1j):
                yield [*equilibrium.force(*other, unit), *equilibrium.force(*first, -1 * unit)]

    def forces(self, analysis: ForcesOfJoint, wrenches: WrenchesOfJoint) -> Iterator[JointForce]:
        for body, place in self.places.items():
            yield body, place, analysis.pin(self.name, body), np.zeros(())

    def force_columns(self, analysis: ForcesOfJoint) -> Iterator[Column]:
        for body in self.bodies[1:]:
            force, meaning = analysis.pin(self.name, body), f"force at {self.name} on {body}"
            yield from vector_columns(f"{self.name}_force_on_{body}", "N", meaning, force)
