"""The gear mesh: two gears on fixed shafts, by which two bodies turn at a constant ratio."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property
from math import gcd
from typing import Annotated

import numpy as np

from ...core.arguments import ArgumentType, is_whole
from ...core.fields import entry, quantity
from ...core.records import record
from ...model.scene import SceneMark
from ...model.table import Column
from ...plane.vec import Array, Complex, Real
from .joint import (
    AbstractJoint,
    Effect,
    EquilibriumOfJoint,
    ForcesOfJoint,
    JointForce,
    LinkageOfJoint,
    MotionOfJoint,
    WrenchesOfJoint,
)

TEETH = 6, 1000
# Force along the line of the centres by that along the pitch circles; the gears are cut with this pressure angle.
SEPARATION = float(np.tan(np.radians(20)))
Teeth = Annotated[
    tuple[int, int],
    ArgumentType(
        lambda value: (
            isinstance(value, (tuple, list))
            and len(value) == 2
            and all(is_whole(teeth) and TEETH[0] <= teeth <= TEETH[1] for teeth in value)
        ),
        f"two whole numbers from {TEETH[0]} to {TEETH[1]}",
    ),
]


@record(checked=True)
class GearMesh(AbstractJoint):
    """Two external gears in mesh, each fixed on a body with a pivot on the ground; the bodies turn in opposite senses.

    The second body turns teeth[0] / teeth[1] times as fast as the first. For two bodies that turn in one sense give an
    idler, a further body on the ground that is in mesh with both. The driver must be one of the geared bodies.

    Parameters
    ----------
    name : str
        Name of the joint.
    first, second : str
        The two bodies.
    teeth : tuple of int
        Numbers of teeth of their gears, 6 to 1000. The distance of the pivots is the sum of the pitch radii, so that
        it sets the module.
    angle_deg : float
        Angle of the second body from the ground's x axis while that of the first is 0, deg.

    See Also
    --------
    Linkage, Slider, PinInSlot, GearPair

    Notes
    -----
    In equilibrium the teeth press at the pitch point along the pitch circles, and with tan 20 deg of that force along
    the line of the centres, which presses the gears apart and so on their pivots. Friction of the teeth is not
    computed.

    Examples
    --------
    >>> import geomkin as gk
    >>> bodies = {
    ...     "ground": {"O": 0, "C": 80},
    ...     "crank": {"O": 0, "A": 20},
    ...     "other_crank": {"C": 0, "D": 25},
    ...     "coupler": {"A": 0, "pen": 70},
    ...     "link": {"D": 0, "pen": 65},
    ... }
    >>> mesh = gk.GearMesh("gears", "crank", "other_crank", (40, 20))
    >>> motion = gk.move(gk.Linkage(bodies, "crank", meshes=(mesh,)), [0.0, 1.0], speed=2.0)
    >>> motion.other_crank.omega
    array([-4., -4.])
    """

    name: str = entry("its name", example="gears")
    first: str = entry("a body that turns on the ground", example="crank")
    second: str = entry("another one, which its gear turns the other way", example="other_crank")
    teeth: Teeth = entry(
        "numbers of teeth of their gears; the distance of the pivots sets the module", example=(24, 24)
    )
    angle_deg: float = quantity(
        "angle of the second body while that of the first is 0", "deg", default=0.0, at_least=-360, at_most=360
    )

    noun = "gear mesh"
    freedoms = 1

    @property
    def bodies(self) -> tuple[str, str]:
        return self.first, self.second

    @property
    def points(self) -> Mapping[str, tuple[str, ...]]:
        return {}

    @property
    def sizes(self) -> Mapping[str, complex | Array]:
        return {"angle_deg": self.angle_deg}

    @property
    def program_sizes(self) -> tuple[str, ...]:
        return ("angle",)

    @cached_property
    def angle(self) -> float:
        """`angle_deg` in rad."""
        return float(np.radians(self.angle_deg))

    def ratio_of(self, body: str) -> float:
        """Angle of one of the bodies by that of the other."""
        ratio = self.teeth[0] / self.teeth[1]
        return -ratio if body == self.bodies[1] else -1 / ratio

    def pivots(self, linkage: LinkageOfJoint) -> tuple[complex | Complex, complex | Complex]:
        """Shafts of the two gears, mm in the frame of the ground."""
        first, second = (linkage.bodies[linkage.ground][self.pivot(linkage, body)] for body in self.bodies)
        return first, second

    def pivot(self, linkage: LinkageOfJoint, body: str) -> str:
        """The pin on which one of the bodies turns on the ground."""
        return next(point for point in linkage.bodies[body] if point in linkage.bodies[linkage.ground])

    def gap(self, motion: MotionOfJoint) -> Real:
        # Powers of the directions, since a turn of one is a part of a turn of the other.
        common = gcd(*self.teeth)
        one, two = (teeth // common for teeth in self.teeth)
        ground = motion.bodies[motion.linkage.ground].direction
        first, second = (motion.bodies[body].direction / ground for body in self.bodies)
        start, end = self.pivots(motion.linkage)
        radius = np.abs(end - start) * two / (one + two)
        missed: Real = np.abs(np.angle(first**one * (second * np.exp(-1j * self.angle)) ** two)) / two * radius
        return missed

    def marks(self, motion: MotionOfJoint) -> Iterator[SceneMark]:
        """None: the gears are drawn."""
        yield from ()

    def _contact(self, motion: MotionOfJoint) -> tuple[Complex, Complex]:
        """Pitch point, mm, and direction of the pitch circles there, on the ground."""
        ground, (start, end) = motion.bodies[motion.linkage.ground], self.pivots(motion.linkage)
        place = start + (end - start) * (self.teeth[0] / sum(self.teeth))
        along = 1j * (end - start) / np.abs(end - start)
        return ground.point(place).position, along * ground.direction

    def _places(self, motion: MotionOfJoint) -> tuple[list[Complex], Complex]:
        """The pitch point in the frames of both bodies, mm, and the direction of the force on the second."""
        place, along = self._contact(motion)
        bodies = [motion.bodies[body] for body in self.bodies]
        return [(place - body.origin.position) * np.conj(body.direction) for body in bodies], along

    def effects(self, equilibrium: EquilibriumOfJoint) -> Iterator[Effect]:
        """The tangential force on the second body."""
        yield self._effect(equilibrium, 1.0)

    def separating(self, equilibrium: EquilibriumOfJoint) -> Effect:
        """What presses the gears apart, per unit of the size of the tangential force."""
        return self._effect(equilibrium, -1j * SEPARATION)

    def _effect(self, equilibrium: EquilibriumOfJoint, force: complex) -> Effect:
        """Effect of a force on the second body, relative to the direction of the pitch circles, and of its reaction."""
        wrenches = equilibrium.wrenches
        (first, second), along = self._places(wrenches.motion)
        one, two = self.bodies
        on_second = equilibrium.force(two, wrenches.arm(two, second), force * along)
        return [*on_second, *equilibrium.force(one, wrenches.arm(one, first), -force * along)]

    def forces(self, analysis: ForcesOfJoint, wrenches: WrenchesOfJoint) -> Iterator[JointForce]:
        places, along = self._places(analysis.motion)
        tooth = analysis.mesh(self.name)
        force = (tooth - 1j * SEPARATION * np.abs(tooth)) * along
        for body, place, sign in zip(self.bodies, places, (-1, 1)):
            yield body, place, sign * force, np.zeros(())

    def force_columns(self, analysis: ForcesOfJoint) -> Iterator[Column]:
        meaning = f"force of the teeth of {self.name} on {self.bodies[1]} along the pitch circles"
        yield Column(f"{self.name}_tooth_force", "N", meaning, analysis.mesh(self.name))
