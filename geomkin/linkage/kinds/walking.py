"""The feet of a walker that carry its weight: their forces as loads of each leg, and the speed at which it walks."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property

import numpy as np

from ...core.fields import to_digits
from ...core.records import record
from ...model.motor import Motor
from ...model.scene import Plot
from ...model.table import Column
from ...plane.vec import Complex, Real
from ...recipe.aspect import FootForces
from ..dynamics.loads import DriveTable, Force
from ..dynamics.wrenches import NEWTON
from ..linkage import Linkage
from .made import MadeLinkage
from .stance import Stance, stance_of

# Positions over a turn, besides the frames of the table, between which the forces at the feet are interpolated. They
# jump where a foot takes over, which takes one such step.
POSITIONS = 721


@record(eq=False)
class Walking:
    """The forces of the ground on the feet of a walker, at a constant speed of its frame over short times.

    stance: at the positions of the forces. weight: N. friction: of its feet. driver_speed: of its legs, rad/s.
    """

    stance: Stance
    weight: float
    friction: float
    driver_speed: float

    @cached_property
    def _forces(self) -> tuple[Complex, Real]:
        return self.stance.ground_forces(self.weight, self.friction)

    @property
    def speed(self) -> Real:
        """Speed of the frame along the path, mm/s."""
        return self._forces[1]

    @property
    def largest(self) -> Real:
        """Largest load of each foot, N."""
        largest: Real = self.weight * self.stance.shares.max(axis=1)
        return largest

    def on_feet(self, point: str, numbers: slice = slice(None)) -> FootForces:
        """The forces on some feet, each in the frame of its leg, which is upright; point: that stands."""
        legs, forces = self.stance.legs[numbers], self._forces[0][numbers]
        own = (-np.conj(force) if foot.mirrored else force for foot, force in zip(legs, forces))
        return FootForces(point, tuple(foot.drive for foot in legs), tuple(own))

    @property
    def mean_speed(self) -> float:
        """Mean speed of the frame over a turn, mm/s."""
        drive = self.stance.drive
        return float(np.trapezoid(self.speed, drive) / (drive[-1] - drive[0]))

    @property
    def step(self) -> float:
        """Distance walked in a turn of the shaft, mm."""
        return abs(self.mean_speed * 2 * np.pi / self.driver_speed)

    @property
    def plots(self) -> tuple[Plot, Plot]:
        """Of the loads of the feet, and of the speed."""
        loads = tuple(f"foot_{k}_load" for k in range(1, 1 + len(self.stance.legs)))
        return Plot("loads of the feet", loads), Plot("speed of the walker", ("walking_speed",))

    def columns(self, drive: Real) -> Iterator[Column]:
        """Load of each foot and speed of the frame at positions of the driver."""
        stance = self.stance.of(drive)
        forces, speed = stance.ground_forces(self.weight, self.friction)
        for k, (id, force) in enumerate(zip(self.plots[0].columns, forces), 1):
            yield Column(id, "N", f"load of foot {k} by the weight of the walker", force.imag)
        yield Column("walking_speed", "mm/s", "speed of the walker along its path", speed)

    @property
    def summary(self) -> Mapping[str, object]:
        """Weight, largest load of each foot, and speed."""
        return {
            "weight_N": to_digits(self.weight),
            "largest_foot_loads_N": [to_digits(load) for load in self.largest.tolist()],
            "walking_speed_mm_per_s": to_digits(self.mean_speed),
            "step_mm": to_digits(self.step),
        }


def walking_of(made: MadeLinkage, gravity: complex, friction: float, motor: Motor | None = None) -> Walking | None:
    """The forces at the feet of a walker; None if it has no weight, is not upright, or falls over at some position.

    gravity: in its own frame, mm/s2. motor: that it carries, by default the mounted one.
    """
    if made.foot is None or gravity.real or gravity.imag >= 0:
        return None
    frames = made.input_range.frames
    positions = np.unique(np.concatenate([frames, np.linspace(frames[0], frames[-1], POSITIONS)]))
    stance = stance_of(made, made.moved(positions if frames[-1] > frames[0] else positions[::-1]), motor)
    if stance is None or not stance.mass or not np.isfinite(stance.shares).all():
        return None
    return Walking(stance, NEWTON * stance.mass * abs(gravity), friction, made.speed)


def forces_on_legs(feet: FootForces, linkage: Linkage) -> tuple[Force, ...]:
    """The forces at the feet as loads of a linkage and of its copies."""
    body, legs = next(name for name, points in linkage.bodies.items() if feet.point in points), []
    for drive, force in zip(feet.drives, feet.forces):
        order = np.argsort(drive, kind="stable")
        legs.append(Force(body, feet.point, DriveTable(drive[order], force[order], 2 * np.pi)))
    return tuple(legs)
