"""The forces of a linkage and of its copies under the loads of a recipe, and motors compared for them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from ...core.fields import to_digits, to_digits_or_none
from ...core.records import record
from ...core.units import mm
from ...making.motors import LEAST_MOTOR_MARGIN, motor_summary
from ...model.check import Check
from ...model.material import Mass
from ...model.motor import RPM, Motor, MotorDuty
from ...plane.vec import Complex, Mask, Real, without_rounding
from ..checks import in_driver_unit
from ..drive_limits import largest_between
from ..dynamics.inverse import ForceAnalysis
from ..dynamics.loads import Force
from ..linkage import Linkage
from ..motion import Motion
from ..moving import move
from .aspects import AbstractLinkageAspect
from .copies import Copied
from .loads import LoadsTable
from .made import MadeLinkage
from .stance import Walking, forces_on_legs, walking_of

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
    per turn of the shaft, mm; 0 if it does not walk. power: mean electric power at the speed of the recipe, W; nan if
    it is not able to turn it. energy: of the battery, Wh.
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
    can_turn = motor.margin(duty) > 0 and (motor.torque_at(duty.speed) >= np.abs(duty.torque)).all()
    mean = float(np.trapezoid(power, positions) / (positions[-1] - positions[0])) if can_turn else np.nan
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


# Name of the effort with that of the copies among the peaks.
EFFORT = "effort"


@record(eq=False)
class AbstractLinkageForces(AbstractLinkageAspect[LoadsTable]):
    """The forces of a linkage and of its copies under the loads of a recipe, in their setting."""

    @property
    def linkage(self) -> Linkage:
        """The linkage."""
        return self.mechanism.linkage.linkage

    @property
    def masses(self) -> Mapping[str, Mass]:
        """Masses of the parts by body."""
        return self.mechanism.masses if self.mechanism.stock.material else {}

    @cached_property
    def walking(self) -> Walking | None:
        """The feet that carry a walker with its mounted motor; None if they carry nothing or are given forces.

        None also if it is a leg of a machine, whose weight it carries.
        """
        return self.walking_with(None)

    def walking_with(self, motor: Motor | None) -> Walking | None:
        """As `walking`, with another motor at the place of the mounted one."""
        if self._pushed or self.mechanism.setting.feet is not None:
            return None
        gravity = self.given.gravity_in(self.mechanism.setting)
        return walking_of(self.mechanism, gravity, self.given.foot_friction, motor)

    @property
    def _pushed(self) -> bool:
        """Whether forces at the feet of a walker are given."""
        return self.mechanism.foot is not None and self.given.pushes(self.mechanism.foot)

    @cached_property
    def feet(self) -> tuple[Force, ...]:
        """The forces that carry a walker, or its machine, at the foot of the linkage and of each copy."""
        return self.feet_of(self.walking)

    def feet_of(self, walking: Walking | None) -> tuple[Force, ...]:
        """As `feet`, of a walker with another motor."""
        own = walking.on_feet(str(self.mechanism.foot)) if walking else None
        forces = own or self.mechanism.setting.feet
        return forces_on_legs(forces, self.linkage) if forces else ()

    @cached_property
    def analysis(self) -> ForceAnalysis:
        """Driver effort and joint forces of the first linkage."""
        return self._analysis(self.mechanism.motion, self.feet)

    def _analysis(
        self, motion: Motion, feet: tuple[Force, ...], copy: Copied | None = None, leg: int = 0
    ) -> ForceAnalysis:
        """Forces of the first linkage in a motion of it, or of a copy; leg: its number."""
        setting = self.mechanism.setting
        if copy is not None:
            motion, setting = copy.motion, setting.turned_over if copy.mirrored else setting
        return self.given.forces_of(motion, self.masses, setting, feet[leg : leg + 1])

    @cached_property
    def effort(self) -> Real:
        """Torque of the driver, N mm, with those of the copies; the force if a slide drives, N."""
        return self._effort(self._legs(self.mechanism.motion, self.feet))

    def _legs(self, motion: Motion, feet: tuple[Force, ...]) -> list[tuple[ForceAnalysis, Copied | None]]:
        """The forces of the linkage in a motion, and of its copies."""
        made = self.mechanism
        copies = made.moving_copies if motion is made.motion else made.copies_of(motion)
        first = self.analysis if motion is made.motion and feet is self.feet else self._analysis(motion, feet)
        others = ((self._analysis(motion, feet, copy, k), copy) for k, copy in enumerate(copies, 1))
        return [(first, None), *others]

    def _effort(self, legs: Sequence[tuple[ForceAnalysis, Copied | None]]) -> Real:
        total = legs[0][0].driver
        for analysis, copy in legs[1:]:
            assert copy is not None
            torque = analysis.driver[copy.rows]
            total = total - torque if copy.mirrored else total + torque
        return total

    def effort_in(self, motion: Motion, feet: tuple[Force, ...]) -> Real:
        """The torque of the driver with those of the copies in another motion of the linkage, N mm."""
        return self._effort(self._legs(motion, feet))

    def torque_at(self, turn: Real) -> Real:
        motion, rows = self.mechanism.moved_at(turn)
        return self.effort_in(motion, self.feet)[rows]

    def shaking_at(self, turn: Real) -> tuple[Complex, Real]:
        """Shaking force, N, and moment about the shaft, N mm, of the linkage and its copies."""
        motion, rows = self.mechanism.moved_at(turn)
        (first, _), *copies = self._legs(motion, self.feet)
        force, moment = first.shaking_force, first.shaking_moment
        for analysis, copy in copies:
            assert copy is not None
            force = force + copy.placement.vector(analysis.shaking_force[copy.rows])
            own = analysis.shaking_moment[copy.rows]
            moment = moment - own if copy.mirrored else moment + own
        return force[rows], moment[rows]

    @cached_property
    def dense_legs(self) -> list[tuple[ForceAnalysis, Copied | None]]:
        """The forces of the linkage and of its copies in small steps over the range of the driver."""
        frames = self.mechanism.input_range.frames
        motion = self.mechanism.moved(np.linspace(frames[0], frames[-1], max(POSITIONS, len(frames))))
        return self._legs(motion, self.feet)

    @cached_property
    def dense(self) -> tuple[Motion, Real]:
        """The motion in these steps, and the effort with that of the copies in it."""
        return self.dense_legs[0][0].motion, self._effort(self.dense_legs)

    @property
    def jammed(self) -> Mask:
        """Where in these steps no effort of the driver moves the linkage or a copy against its dry friction."""
        motion, effort = self.dense
        return motion.assembled & np.isnan(effort) & self.given.has_dry_friction

    @property
    def movable_check(self) -> Check:
        """Whether some force of the driver moves the linkage against its dry friction."""
        motion, jammed = self.dense[0], self.jammed
        share = 100 * float(np.mean(~jammed[motion.assembled])) if motion.assembled.any() else np.nan
        at = in_driver_unit(motion, float(motion.drive[jammed.argmax()])) if jammed.any() else None
        effort, unit = ("force", "mm") if self.linkage.driven_slider else ("torque", "deg")
        keys = [f"loads.{key}" for key in ("pin_friction", "slide_friction") if getattr(self.given, key)]
        advice = f"give a smaller coefficient, radius or length in {' and '.join(keys)}, or other lengths of the links"
        if at is not None:
            advice = f"at {mm(at, unit=unit):.5g} no {effort} of the driver overcomes the friction: {advice}"
        name = "share of the driven range in which the driver overcomes dry friction"
        return Check("share_movable", name, share, "at least", 100, "%", advice, f"driver_{effort}", at)

    @cached_property
    def peaks(self) -> Mapping[str, tuple[float, float]]:
        """Largest driver effort, that with the copies, and largest force at each pin, also between frames, by name.

        Each with the driver there; nan if friction locks the linkage somewhere. The pins of a walker are those of the
        leg whose foot carries most.
        """
        names = ("driver", EFFORT, *self.linkage.pins)
        if self.jammed.any():
            return dict.fromkeys(names, (np.nan, np.nan))

        def sizes(motion: Motion) -> Real:
            legs = self._legs(motion, self.feet)
            leg, copy = legs[self._most_loaded]
            forces = (
                np.fmax.reduce([np.abs(leg.pin(pin, body))[copy.rows if copy else slice(None)] for body in bodies[1:]])
                for pin, bodies in self.linkage.pins.items()
            )
            return np.array([np.abs(legs[0][0].driver), np.abs(self._effort(legs)), *forces])

        if not self.feet:
            found = largest_between(self.dense[0], sizes)
        else:
            # The forces at the feet are linear between positions of which each is one of these.
            motion = self.dense[0]
            values = sizes(motion)
            at = np.nanargmax(np.where(np.isfinite(values), values, -1.0), axis=1)
            found = values[range(len(values)), at], motion.drive[at]
        return dict(zip(names, zip(*(array.tolist() for array in found))))

    @property
    def _most_loaded(self) -> int:
        """Number of the leg of a walker whose foot carries most."""
        return int(np.argmax([np.abs(foot.force.values).max() for foot in self.feet])) if self.feet else 0

    @property
    def duty(self) -> MotorDuty:
        """Torque and speed of the shaft."""
        peak = self.peaks[EFFORT][0]
        return replace(self.dense_duty, between=0.0 if np.isnan(peak) else peak)

    @property
    def dense_duty(self) -> MotorDuty:
        """As `duty`, without the peaks between small steps."""
        motion, effort = self.dense
        speed = np.broadcast_to(np.asarray(motion.timing.speed, dtype=float), motion.drive.shape)
        return MotorDuty(effort, speed, motion.drive)
