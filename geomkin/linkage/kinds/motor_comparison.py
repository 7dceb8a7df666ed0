"""Motors compared for a linkage: margin at its speed, largest speed, and time on a battery."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from ...core.fields import to_digits, to_digits_or_none
from ...core.records import record
from ...core.units import mm
from ...making.motors import LEAST_MOTOR_MARGIN, motor_summary
from ...model.motor import RPM, Motor, MotorDuty
from ...plane.vec import Real, without_rounding
from ..motion import Motion
from ..moving import move
from .made import MadeLinkage

# Positions over the range of the driver at which the torque is computed.
POSITIONS = 721
# Shares of a motor's speed without load at which the torque is computed, between which it is a parabola: exact without
# dry friction, which needs a direction of the motion.
SHARES = np.array([1e-3, 0.5, 1.0])
# Halvings of the range of speeds in which the largest one is found, and digits of the speed that they give.
HALVINGS, DIGITS = 15, 4


@record(eq=False)
class ComparedMotor:
    """A motor on the shaft of a linkage.

    duty: at the speed of the recipe. largest_speed: at which its margin suffices, rad/s; 0 if at none. walks: distance
    per turn of the shaft, mm; 0 if it does not walk. power: mean electric power at the speed of the recipe, W. energy:
    of the battery, Wh.
    """

    motor: Motor
    duty: MotorDuty
    largest_speed: float
    step: float
    power: float
    energy: float | None

    @property
    def suffices(self) -> bool:
        """Whether it has the margin that a motor of the table must have."""
        return self.motor.margin(self.duty) >= LEAST_MOTOR_MARGIN

    @property
    def hours(self) -> float:
        """Time on the battery at the speed of the recipe, h; nan if it is unknown."""
        return self.energy / self.power if self.energy and self.suffices and self.power > 0 else np.nan

    @property
    def summary(self) -> Mapping[str, object]:
        """Entries of summary.json; unknown ones are left out."""
        turns = self.largest_speed / (2 * np.pi)
        values = {
            "largest_speed_rpm": self.largest_speed / RPM,
            "largest_walking_speed_mm_per_s": self.step * turns if self.step else np.nan,
            "electric_power_W": self.power,
            "battery_h": self.hours,
        }
        known = {
            key: number for key, value in values.items() if (number := to_digits_or_none(value, DIGITS)) is not None
        }
        return {**motor_summary(self.motor, self.duty), "suffices": self.suffices, **known}

    @property
    def remark(self) -> str:
        """A sentence for page and terminal."""
        rpm = self.duty.peak_speed_rpm
        if not self.largest_speed:
            return f"{self.motor.name}: does not suffice at any speed."
        most = f"{self.largest_speed / RPM:.4g} rpm"
        if self.step:
            most += f", {mm(self.step * self.largest_speed / (2 * np.pi), unit='mm/s'):.4g}"
        margin = f"at {rpm:.4g} rpm: its margin is {to_digits(self.motor.margin(self.duty), 3):g}"
        verb = "suffices" if self.suffices else "does not suffice"
        least = "" if self.motor.has_currents else " at most"
        lasts = f"; a battery of {self.energy:g} Wh lasts{least} {self.hours:.3g} h" if np.isfinite(self.hours) else ""
        return f"{self.motor.name}: {verb} {margin}; it suffices up to {most}{lasts}."


def compared_motor(
    made: MadeLinkage, motor: Motor, torque_in: Callable[[Motion], Real], step: float, energy: float | None
) -> ComparedMotor:
    """A motor on the shaft of a linkage.

    torque_in: of the shaft in a motion of the linkage, N mm. step, energy: as of `ComparedMotor`.
    """
    frames = made.input_range.frames
    positions = np.linspace(frames[0], frames[-1], POSITIONS)

    def torque_at(speed: float, acceleration: float = 0.0) -> Real:
        return torque_in(move(made.linkage, positions, made.branch, speed, acceleration))

    def duty_of(torque: Real, speed: float) -> MotorDuty:
        return MotorDuty(torque, np.full(positions.shape, speed), positions)

    duty = duty_of(torque_at(made.speed, made.acceleration), made.speed)
    power = motor.electric_power(duty.torque, duty.speed)
    mean = float(np.trapezoid(power, positions) / (positions[-1] - positions[0]))
    # Its margin falls with the speed, apart from inertia that relieves it: the first speed at which it is too small.
    low, high = 0.0, RPM * motor.speed_rpm
    parabolas = np.linalg.solve(
        np.vander(SHARES), [torque_at(np.copysign(share * high, made.speed)) for share in SHARES]
    )
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        torque = (middle / (RPM * motor.speed_rpm)) ** np.arange(2, -1, -1) @ parabolas
        enough = motor.margin(duty_of(torque, middle)) >= LEAST_MOTOR_MARGIN
        low, high = (middle, high) if enough else (low, middle)
    return ComparedMotor(motor, duty, without_rounding(low, RPM * motor.speed_rpm), step, mean, energy)
