"""A linkage under its loads, in a recipe: the columns, plots, checks and summary of the forces that result."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cached_property, partial

import numpy as np

from ...core.errors import DesignError
from ...core.fields import to_digits, to_digits_or_none
from ...core.records import record
from ...core.units import marked, mm, rounded_down
from ...making.attachments import ActuatorDuty
from ...making.motors import (
    motor_check,
    motor_keys,
    motor_summary,
    nearest_motor,
    power_summary,
    smallest_motor,
)
from ...model.check import Check, Suggestion
from ...model.motor import RPM, Motor, effective_value
from ...model.scene import Hodograph, Plot, Scene, SceneHandle, SceneMark
from ...model.table import Column, Table, vector_columns
from ...recipe.aspect import ALONE
from ...recipe.recipe import part_masses
from ..checks import in_driver_unit
from ..dynamics.inverse import WATT
from ..linkage import Linkage
from ..parts.rotating_masses import Flywheel, RoundEnd, flywheel_of
from ..parts.strength import linkage_strength_checks
from ..scene import vector_marks
from .copies import is_whole_turn
from .linkage_forces import EFFORT, AbstractLinkageForces, ComparedMotor, compared_motor
from .load_tables import ROUNDS, UNBALANCED, BalancedPlates, LinkageRun, balanced_plates, linkage_run
from .loads import LoadsTable
from .made import MadeLinkage

# Least share of the weight of its parts and its motor that the feet of a walker carry, %: the forces are estimates, and
# nothing that is carried besides the parts is known; chosen here.
LEAST_CARRIED = 90.0
# Share of the largest speed at which a motor suffices that is advised: peaks between the positions count too.
SLOWER = 0.99


@record(eq=False)
class LoadsAspect(AbstractLinkageForces):
    """The forces of a linkage in motion, and the torque of the shaft that it shares with its copies."""

    key = "loads"

    @property
    def most_columns(self) -> int:
        made = self.mechanism
        forces = 13 + 3 * sum(joint.count for joint in self.linkage.joints)
        return forces + (2 + len(made.copies) if made.foot else 0)

    def check(self) -> None:
        made, table = self.mechanism, self.given
        table.check(made.moved(made.input_range.frames[:1]))
        motor_keys(table.motor, made.stock.motor)
        steady = is_whole_turn(made.input_range) and not made.input_range.acceleration
        if table.speed_fluctuation and not (steady and self.linkage.driver_pivot is not None):
            problem = "is given, but the driver makes no whole turn at a constant speed on a fixed shaft"
            remedy = "let it turn by 360 deg without acceleration, or omit it"
            raise DesignError("loads.speed_fluctuation", problem, remedy, "conflict")
        if table.flywheel_sheets:
            table.check_flywheel(self.linkage.driver, made.stock, bool(made.copies))
        for key in ("carried", "foot_friction"):
            if getattr(table, key) and made.foot is None:
                problem = "is given, but the linkage has no feet on which it walks"
                raise DesignError(f"loads.{key}", problem, "give foot and copies, or omit it", "conflict")
        if table.counterweights:
            table.counterweights.check(self.linkage, made.stock, table.masses)
        if table.run:
            friction, copies = table.has_dry_friction, bool(made.copies)
            table.run.check(self.linkage, made.input_range, self.given_motor, friction, copies)

    @property
    def given_motor(self) -> Motor | None:
        """The motor of the table, or the mounted one."""
        return self.given.motor or self.mechanism.mounted_motor

    @cached_property
    def balanced(self) -> BalancedPlates | None:
        """Plates with counterweights; None if none are requested."""
        made = self.mechanism
        if self.given.counterweights is None:
            return None
        forces_of = partial(self.given.forces_of, made.motion, setting=made.setting)
        return balanced_plates(self.given.counterweights, forces_of, made.fine_motion, made.stock)

    @property
    def round_ends(self) -> Mapping[str, RoundEnd]:
        return self.balanced.ends if self.balanced else {}

    @cached_property
    def flywheel(self) -> Flywheel | None:
        """The flywheel that is cut; its holes and pins change the torque a little, and so its size."""
        table, stock, wheel = self.given, self.mechanism.stock, None
        if not table.flywheel_sheets or table.speed_fluctuation is None or stock.material is None:
            return None
        for _ in range(ROUNDS):
            with_wheel = replace(self, mechanism=replace(self.mechanism, flywheel=partial(_same, wheel)))
            inertia = with_wheel.dense_duty.steadying_inertia / table.speed_fluctuation
            if not np.isfinite(inertia):
                problem = "is given, but the torque is unknown where the linkage is open or locked by friction"
                raise DesignError("loads.flywheel_sheets", problem, "let the driver turn fully, or omit it", "conflict")
            wheel = flywheel_of(inertia, table.flywheel_sheets, stock.material, self.linkage, stock)
        return wheel

    @property
    def _flywheel_summary(self) -> Mapping[str, object]:
        """Inertia of the flywheel for `speed_fluctuation`, and its discs, or the one it would be; empty if none."""
        stock, allowed = self.mechanism.stock, self.given.speed_fluctuation
        if allowed is None or not np.isfinite(inertia := self.dense_duty.steadying_inertia / allowed):
            return {}
        entries: dict[str, object] = {"inertia_kg_mm2": to_digits(inertia)}
        if stock.material is not None and inertia:
            wheel = self.flywheel or flywheel_of(inertia, 1, stock.material, self.linkage, stock)
            mass = wheel.mass(stock.material, stock.thickness)
            entries |= {"disc_diameter_mm": to_digits(2 * wheel.radius), "disc_mass_kg": to_digits(mass)}
        return {"flywheel": entries}

    @property
    def _fluctuation_check(self) -> Check:
        """Whether the flywheel as cut keeps the fluctuation."""
        assert self.flywheel is not None and self.given.speed_fluctuation is not None
        driver = self.linkage.driver
        pivot = complex(self.linkage.bodies[driver][str(self.linkage.driver_pivot)])
        discs = part_masses(part for part in self.mechanism.own_parts if part.body == driver != part.name)[driver]
        inertia = float(discs.inertia + discs.mass * np.abs(discs.centre - pivot) ** 2)
        advice = "its pins unbalance the driver: give more loads.flywheel_sheets, or a larger loads.speed_fluctuation"
        name = "fluctuation of the speed with the flywheel under a constant torque"
        value, limit = self.dense_duty.steadying_inertia / inertia, self.given.speed_fluctuation
        return Check("speed_fluctuation", name, value, "at most", limit, "", advice)

    @cached_property
    def motor(self) -> Motor | None:
        """The given motor; without one the smallest that suffices, None if no motor can drive the linkage."""
        turns = self.linkage.driver_pivot is not None
        return self.given_motor or (smallest_motor(self.duty) if turns else None)

    @cached_property
    def compared(self) -> tuple[ComparedMotor, ...]:
        """The motors of `motors`, each with its own mass on a walker."""
        return tuple(compared for motor in self.given.motors if (compared := self._compared(motor)))

    def _compared(self, motor: Motor) -> ComparedMotor | None:
        """A motor with its own mass on a walker; None if this falls over, or is in the air."""
        walking = self.walking_with(motor)
        if self.mechanism.foot and not walking and not self._pushed:
            return None
        step = walking.step if walking else 0.0
        torque_in = partial(self.effort_in, feet=self.feet_of(walking))
        return compared_motor(self.mechanism, motor, torque_in, step, self.given.battery_wh)

    @property
    def remarks(self) -> Iterator[str]:
        yield from (motor.remark for motor in self.compared)
        if self.linkage.driven_slider is not None and not self.given.actuator and np.isfinite(self.dense[1]).all():
            yield self.actuator_duty.remark

    @property
    def actuator_duty(self) -> ActuatorDuty:
        """Force, speed and stroke of the driven slide."""
        motion, force = self.dense
        speed = np.full(motion.drive.shape, np.abs(np.asarray(motion.timing.speed, dtype=float)))
        return ActuatorDuty(force, speed, float(np.ptp(self.mechanism.input_range.frames)))

    @cached_property
    def run(self) -> LinkageRun | None:
        """The motion that follows from a torque or the given motor; None if none is requested."""
        if self.given.run is None:
            return None
        return linkage_run(self.given.run, self.mechanism.motion, self.analysis.loads, self.given_motor)

    def columns(self, table: Table) -> Iterator[Column]:
        """Driver effort, joint forces, and the force and moment by which the masses shake the ground."""
        analysis, linkage = self.analysis, self.linkage
        if linkage.driven_slider is None:
            yield Column("driver_torque", "N mm", "torque of the driver, counterclockwise positive", analysis.driver)
        else:
            yield Column("driver_force", "N", "force of the driver along its line", analysis.driver)
        if self.mechanism.copies:
            meaning = "torque of the shaft: that of the linkage and its copies"
            yield Column("shaft_torque", "N mm", meaning, self.effort)
        power = WATT * self.effort * self.mechanism.motion.timing.speed
        of = " and those of the copies" if self.mechanism.copies else ""
        yield Column("input_power", "W", f"power of the driver{of}, negative where the loads drive it", power)
        if analysis.loads.friction:
            locked = "1 where friction holds the loads that would drive the linkage, so that it stays at rest, else 0"
            yield Column("self_locking", "", locked, analysis.self_locking.astype(float))
        for joint in linkage.joints:
            yield from joint.force_columns(analysis)
        meaning = "shaking force of the masses on the ground"
        yield from vector_columns("shaking_force", "N", meaning, analysis.shaking_force)
        at = "the driver's pivot" if linkage.driver_pivot is not None else "the origin"
        moment = f"shaking moment of the masses about {at}"
        yield Column("shaking_moment", "N mm", moment, analysis.shaking_moment)
        if self.walking:
            yield from self.walking.columns(self.mechanism.motion.drive)
        if self.balanced:
            yield from self.balanced.columns
        if self.run:
            yield from self.run.columns

    def plots(self, table: Table) -> Iterator[Plot]:
        """Plots of the columns."""
        linkage = self.linkage
        effort = "torque" if linkage.driven_slider is None else "force"
        plots = [
            Plot(f"driver {effort}", (f"driver_{effort}", *(("shaft_torque",) if self.mechanism.copies else ()))),
            Plot("power of the driver", ("input_power",)),
            Plot("pin forces", _pin_forces(linkage)),
            Plot("normal forces of slides", tuple(f"{slide.name}_normal_force" for slide in linkage.slides)),
            Plot("moments of slides", tuple(f"{slide.name}_moment" for slide in linkage.slides if slide.is_aligned)),
            Plot("forces of teeth", tuple(f"{mesh.name}_tooth_force" for mesh in linkage.meshes)),
            Plot("shaking force", ("shaking_force",)),
            *(self.walking.plots if self.walking else ()),
        ]
        yield from self.run.plots if self.run else ()
        yield from (plot for plot in plots if plot.columns)

    @property
    def hodographs(self) -> tuple[Hodograph, ...]:
        """Polar diagrams of the shaking force and of the pin forces."""
        ids = ("shaking_force", *((UNBALANCED,) if self.balanced else ()))
        shaking = Hodograph("polar diagram of the shaking force", ids)
        pins = Hodograph("polar diagram of the pin forces", _pin_forces(self.linkage))
        return (shaking, pins) if pins.columns else (shaking,)

    @property
    def marks(self) -> Iterator[SceneMark]:
        """An arrow at each pin for the force on each body but the first, all at one scale."""
        arrows = {}
        for pin, bodies in self.linkage.pins.items():
            for body in bodies[1:]:
                force = self.analysis.pin(pin, body)
                if np.isfinite(force).any():
                    arrows[f"{pin} on {body}"] = self.mechanism.motion.point(pin).position, force
        yield from vector_marks(self.mechanism.motion, arrows, "force", "N")

    def on_scene(self, scene: Scene) -> Scene:
        return replace(scene, marks=(*scene.marks, *self.marks), hodographs=self.hodographs)

    @property
    def handles(self) -> Iterator[SceneHandle]:
        yield from self.given.handles(self.mechanism.motion)

    @property
    def checks(self) -> Iterator[Check]:
        """Checks of the motor, the counterweights and the run, and of pins and plates if the material is known."""
        stock = self.mechanism.stock
        if self.given.has_dry_friction:
            yield self.movable_check
        yield from self._motor_checks
        if self.given.actuator:
            yield from self.actuator_duty.checks(self.given.actuator)
        for k, spring in enumerate(self.given.gas_springs, 1):
            if spring.stroke is not None:
                length = spring.length(self.dense[0])
                room = float(np.nanmin(np.minimum(spring.extended - length, length - spring.extended + spring.stroke)))
                least, most = np.nanmin(length), np.nanmax(length)
                advice = (
                    f"it is {mm(least, most, between=' to '):.5g} long: give another stroke or extended, or move an end"
                )
                name = f"least distance of gas spring {k} from the ends of its stroke"
                yield Check(f"gas_spring_{k}_stroke", name, room, "at least", 0.0, "mm", advice)
        if not self.feet and self.mechanism.setting.feet is None:
            yield from weight_checks(self.mechanism, self.given)
        if self.balanced:
            yield self.balanced.check(self._analysis(self.mechanism.motion, ()))
        if self.flywheel:
            yield self._fluctuation_check
        yield from self.run.checks if self.run else ()
        if stock.material:
            leg = self.dense_legs[self._most_loaded][0]
            yield from linkage_strength_checks(leg, stock, self.mechanism.stack)

    @property
    def _motor_checks(self) -> Iterator[Check]:
        peak, drive = self.peaks[EFFORT]
        motor = self.motor or (nearest_motor(self.duty) if self.linkage.driver_pivot is not None else None)
        if motor is None:
            return
        at = None if np.isnan(peak) else in_driver_unit(self.mechanism.motion, drive)
        column = "shaft_torque" if self.mechanism.copies else "driver_torque"
        keys = motor_keys(self.given.motor, self.mechanism.stock.motor)
        check = motor_check(motor, self.duty, column, at, keys)
        if check.passed or not (rpm := self._slower_rpm(motor)):
            yield check
        else:
            slower = Suggestion({"drive.speed_rpm": rpm}, "rpm")
            words = f"{marked(check.advice)}; or give speed_rpm = {rpm:g} in [drive]"
            yield replace(check, advice=words, suggestions=(*check.suggestions, slower))

    def _slower_rpm(self, motor: Motor) -> float:
        """A speed of the recipe's driver, rpm, at which a motor suffices; 0 if none is known."""
        made = self.mechanism
        if made.setting != ALONE or made.acceleration or (compared := self._compared(motor)) is None:
            return 0.0
        return float(np.copysign(float(rounded_down(SLOWER * compared.largest_speed / RPM, 3)), made.speed))

    @property
    def entries(self) -> Mapping[str, object]:
        return {"loads": self.summary}

    @property
    def summary(self) -> Mapping[str, object]:
        """Peak and rms driver effort, largest pin forces, efficiency and motor; without unknown ones."""
        analysis, slides = self.analysis, self.linkage.driven_slider is not None
        effort, unit = ("driver_force_N", "mm") if slides else ("driver_torque_N_mm", "deg")
        (dense, total), copies = self.dense, self.mechanism.copies
        driver = self._analysis(dense, self.feet).driver if copies else total
        efforts = {effort: ("driver", driver, analysis.driver)}
        efforts |= {"shaft_torque_N_mm": (EFFORT, total, self.effort)} if copies else {}
        result: dict[str, object] = {}
        for key, (name, values, at_frames) in efforts.items():
            peak, drive = self.peaks[name]
            if np.isfinite(peak):
                motion = self.mechanism.motion
                nearest = np.argmin(np.abs(motion.drive - drive))
                result[key] = {
                    "peak": to_digits(np.copysign(peak, at_frames[nearest])),
                    f"peak_at_{unit}": to_digits(in_driver_unit(motion, drive), 6),
                    "rms": to_digits(effective_value(values, self.dense[0].drive)),
                }
        result["largest_pin_force_N"] = {
            pin: to_digits(self.peaks[pin][0]) for pin in self.linkage.pins if np.isfinite(self.peaks[pin][0])
        }
        known = {
            "efficiency": float(analysis.efficiency) if analysis.loads.friction else np.nan,
            "largest_condition": to_digits(float(np.fmax.reduce(analysis.condition)), 4),
        }
        result |= power_summary(self.dense_duty)
        result |= {key: value for key, number in known.items() if (value := to_digits_or_none(number)) is not None}
        if analysis.loads.friction:
            result["self_locking_percent"] = to_digits(100 * float(np.mean(analysis.self_locking)), 6)
        result |= self._flywheel_summary
        if self.motor:
            result["motor"] = motor_summary(self.motor, self.duty)
        if self.walking:
            result |= self.walking.summary
        if self.compared:
            result["motors"] = [motor.summary for motor in self.compared]
        if self.balanced:
            result |= self.balanced.summary(self._analysis(self.mechanism.motion, ()))
        if self.run:
            result["run"] = self.run.summary
        return {**result, "undetermined": list(analysis.undetermined)}


def _same(wheel: Flywheel | None) -> Flywheel | None:
    return wheel


def _pin_forces(linkage: Linkage) -> tuple[str, ...]:
    return tuple(f"{pin}_force_on_{body}" for pin, bodies in linkage.pins.items() for body in bodies[1:])


def weight_checks(made: MadeLinkage, loads: LoadsTable) -> Iterator[Check]:
    """Whether the forces at the feet of a walker carry the weight of its parts and its motor."""
    gravity = made.setting.of_world(complex(*loads.gravity_m_per_s2))
    masses = {**made.masses, **{body: given.mass for body, given in loads.masses.items()}}
    mass = (1 + len(made.copies)) * sum(float(mass.mass) for mass in masses.values())
    mass += 1e-3 * made.mounted_motor.mass_g if made.mounted_motor else 0.0
    mass += sum(carried.mass_kg for carried in made.carried)
    if made.foot is None or not gravity or not mass:
        return
    carried = sum(force.mean_over_turn() for force in loads.forces if force.point == made.foot)
    share = -(carried * gravity.conjugate()).real * (1 + len(made.copies)) / (mass * abs(gravity) ** 2)
    name = "share of the weight of its own parts and motor that the forces at the feet carry"
    advice = (
        f"it weighs {mass * abs(gravity):.3g} N, and the torque and the motor's margin are those of a walker in the "
        f"air: let it stand at all frames by the check support_margin, upright, with rods that join its copies; or "
        f"give [[loads.forces]] at {made.foot} while it stands, by over_deg"
    )
    yield Check("weight_carried", name, 100 * share, "at least", LEAST_CARRIED, "%", advice)
