"""The feet of a walker that carry its weight: their forces as loads of each leg, and the speed at which it walks."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from ...core.fields import to_digits
from ...core.records import record
from ...model.motor import Motor
from ...model.table import Column
from ...plane.vec import Real
from ..dynamics.loads import DriveTable, Force
from ..dynamics.wrenches import NEWTON
from .made import MadeLinkage
from .stance import UPRIGHT, Stance, stance_of

# Positions over a turn, besides the frames of the table, between which the forces at the feet are interpolated. They
# jump where a foot takes over, which takes one such step.
POSITIONS = 721


@record(eq=False)
class Walking:
    """The forces of the ground on the feet of a walker, at a constant speed of its frame over short times.

    stance: at the positions of the forces. forces: on each leg, in its own frame. weight: N. friction: of its feet.
    speed: of the frame along the path, mm/s, at these positions.
    """

    stance: Stance
    forces: tuple[Force, ...]
    weight: float
    friction: float
    speed: Real

    @property
    def largest(self) -> Real:
        """Largest load of each foot, N."""
        largest: Real = self.weight * self.stance.shares.max(axis=1)
        return largest

    @property
    def mean_speed(self) -> float:
        """Mean speed of the frame over a turn, mm/s."""
        drive = self.stance.motion.drive
        return float(np.trapezoid(self.speed, drive) / (drive[-1] - drive[0]))

    @property
    def step(self) -> float:
        """Distance walked in a turn of the shaft, mm."""
        return abs(self.mean_speed * 2 * np.pi / float(np.mean(self.stance.motion.timing.speed)))

    @property
    def load_ids(self) -> tuple[str, ...]:
        """Ids of the columns of the loads of the feet."""
        return tuple(f"foot_{k}_load" for k in range(1, 1 + len(self.forces)))

    def columns(self, made: MadeLinkage) -> Iterator[Column]:
        """Load of each foot and speed of the frame at the frames of the table."""
        stance = self.stance.of(made.motion)
        forces, speed = stance.ground_forces(self.weight, self.friction)
        for k, (id, force) in enumerate(zip(self.load_ids, forces), 1):
            yield Column(id, "N", f"load of the foot of copy {k} by the weight of the walker", force.imag)
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
    upright = abs(made.setting.direction - 1) <= UPRIGHT and not gravity.real and gravity.imag < 0
    if made.foot is None or not upright or made.setting.mirrored:
        return None
    frames = made.input_range.frames
    positions = np.unique(np.concatenate([frames, np.linspace(frames[0], frames[-1], POSITIONS)]))
    stance = stance_of(made, made.moved(positions if frames[-1] > frames[0] else positions[::-1]), motor)
    if stance is None or not stance.mass or not np.isfinite(stance.shares).all():
        return None
    weight = NEWTON * stance.mass * abs(gravity)
    forces, speed = stance.ground_forces(weight, friction)
    linkage = stance.motion.linkage
    body = next(name for name, points in linkage.bodies.items() if made.foot in points)
    legs = []
    for copy, force in zip(stance.copies, forces):
        drive, own = copy.motion.drive[copy.rows], -np.conj(force) if copy.mirrored else force
        order = np.argsort(drive, kind="stable")
        legs.append(Force(body, made.foot, DriveTable(drive[order], own[order], 2 * np.pi)))
    return Walking(stance, tuple(legs), weight, friction, speed)
