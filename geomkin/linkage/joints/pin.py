"""The pin: bodies that turn about a common point."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from ...core.records import record
from ...model.scene import SceneMark
from ...model.table import Column, vector_columns
from ...plane.vec import Array, Real
from .joint import (
    AbstractJoint,
    Effect,
    EquilibriumOfJoint,
    ForcesOfJoint,
    JointForce,
    MotionOfJoint,
    Play,
    WrenchesOfJoint,
)


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
