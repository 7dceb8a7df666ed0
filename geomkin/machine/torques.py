"""Torques on the drivers of a machine's mechanisms under their loads, those of walking among them, and its motor."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cached_property

import numpy as np

from ..core.errors import DesignError
from ..core.fields import entry, quantity, to_digits
from ..core.records import record
from ..linkage.dynamics.wrenches import NEWTON
from ..linkage.kinds.loaded import LEAST_CARRIED
from ..linkage.kinds.loads import CarriedMass
from ..linkage.kinds.stance import FEWEST_FEET, POSITIONS, UNKNOWN_STANCE, UPRIGHT, Stance, Walking, stance_with
from ..making.motors import (
    MotorKeys,
    motor_check,
    motor_keys,
    motor_name,
    motor_summary,
    nearest_motor,
    power_summary,
    smallest_motor,
)
from ..model.check import Check
from ..model.motor import RPM, Motor, MotorDuty
from ..model.scene import Plot
from ..model.table import Column, vector_columns
from ..plane.vec import Complex, Pose, Real, cross
from ..recipe.aspect import FootForces, Setting, ShaftPlacement, Standing
from ..recipe.recipe import AbstractRecipe
from .mechanisms import TORQUE, Mechanism, errors_of
from .shafts import ShaftGraph, motor_key, mounted_motor

# Gravity, mm/s2; it points down in the machine.
GRAVITY = 9810.0


@record(checked=True)
class WalkerTable:
    """What a machine that walks carries, in a recipe."""

    carried: tuple[CarriedMass, ...] = entry(
        "what it carries besides its parts and its motor, each with mass_kg, along and across; along is in the frame "
        "of the machine, and across from the lower face of the lowest mechanism",
        default=(),
    )
    foot_friction: float = quantity(
        "coefficient of dry friction between feet and ground", default=0.0, at_least=0, at_most=10
    )


def feet_of(mechanisms: Mapping[str, Mechanism]) -> dict[str, str]:
    """The point on which each leg of a machine stands, by its name; empty if it has none."""
    feet = {name: mechanism.foot or mechanism.recipe.standing_point for name, mechanism in mechanisms.items()}
    return {name: foot for name, foot in feet.items() if foot}


def check_walker(mechanisms: Mapping[str, Mechanism], graph: ShaftGraph, table: WalkerTable | None) -> None:
    """DesignError for feet that cannot stand or walk, and for what is carried without feet."""
    feet, count = feet_of(mechanisms), 0
    if not feet:
        if table is not None:
            remedy = "give foot to its legs, or omit it"
            raise DesignError("walker", "is given, but no mechanism has a foot", remedy, "conflict")
        return
    first = next(iter(feet))
    for name, foot in feet.items():
        try:
            count += mechanisms[name].recipe.number_of_feet(foot)
        except DesignError as error:
            raise error.named(f"mechanisms.{name}.{error.field}") from None
        ratio = abs(graph.speeds[name] / graph.speeds[first])
        if ratio != 1:
            problem = f"found {foot}, but it turns at {ratio} times the speed of {first}, so that they do not walk"
            raise DesignError(f"mechanisms.{name}.foot", problem, "let both turn at the same speed", "conflict")
    if count < FEWEST_FEET:
        remedy = f"give foot to at least {FEWEST_FEET} legs or copies"
        raise DesignError(f"mechanisms.{first}.foot", f"found {count} feet, which cannot stand", remedy, "conflict")


@record(eq=False)
class TurningMachine:
    """A machine over rotations of its driver.

    graph: its shafts. mechanisms, recipes, poses: by name. turns: rotations of the driver at the frames. speed_rpm: of
    the driver.
    """

    graph: ShaftGraph
    mechanisms: Mapping[str, Mechanism]
    recipes: Mapping[str, AbstractRecipe]
    poses: Mapping[str, Pose]
    turns: Real
    speed_rpm: float

    def turn(self, name: str, turns: Real) -> Real:
        """Angle of a mechanism's driver, rad, at rotations of that of the machine."""
        phase = np.radians(self.mechanisms[name].phase_deg)
        return np.asarray(2 * np.pi * float(self.graph.speeds[name]) * turns + phase)


@record(eq=False)
class MachineWalking(TurningMachine):
    """How a machine stands and walks over a turn of its legs."""

    table: WalkerTable

    @cached_property
    def feet(self) -> Mapping[str, str]:
        """The point on which each leg stands, by its name."""
        return feet_of(self.mechanisms)

    def _own(self, name: str, turns: Real) -> Standing:
        speed = float(self.graph.speeds[name]) * self.speed_rpm * np.pi / 30
        with errors_of(name):
            return self.recipes[name].standing_at(self.turn(name, turns), self.feet.get(name, ""), speed)

    @cached_property
    def _carried(self) -> Mapping[str, Standing]:
        """The mechanisms that do not stand, each mass at its mean position over the period."""

        def at_mean(own: Standing) -> Standing:
            masses = ((mass, np.asarray(np.mean(place)), across) for mass, place, across in own.masses)
            return replace(own, masses=tuple(masses))

        return {name: at_mean(self._own(name, self.turns)) for name in self.mechanisms if name not in self.feet}

    def _placed(self, turns: Real) -> Iterator[tuple[str, Standing, float]]:
        """Each mechanism in its place at rotations of the driver, and its lower face, mm."""
        face = 0.0
        for name, mechanism in self.mechanisms.items():
            own = self._carried.get(name) or self._own(name, turns)
            face += mechanism.gap
            placement = ShaftPlacement(self.poses[name], mechanism.mirrored)
            yield name, own.placed(placement, mechanism.is_reversed, face), face
            face += own.height

    def _standing(self, drive: Real) -> Standing:
        """All of the machine at positions of its driver, rad."""
        placed = list(self._placed(drive / (2 * np.pi)))
        _, last, face = placed[-1]
        feet, masses, pivots = (
            tuple(item for _, standing, _ in placed for item in getattr(standing, key))
            for key in ("feet", "masses", "pivots")
        )
        return Standing(feet, masses, pivots, face + last.height)

    @property
    def _motor(self) -> Iterator[tuple[float, complex]]:
        """Mass and place of the mounted motor, at its shaft and at the outer face of the driver's lowest plate."""
        driver = self.graph.driver
        if motor := mounted_motor(self.recipes[driver]):
            own, face = next((own, face) for name, own, face in self._placed(self.turns[:1]) if name == driver)
            axis = complex(self.poses[driver].place(next(iter(self.graph.bodies[driver].values())).axis))
            across = face + own.height if self.mechanisms[driver].is_reversed else face
            yield 1e-3 * motor.mass_g, complex(axis.real, across)

    @property
    def _turned(self) -> list[str]:
        """The legs whose feet are not below them."""
        return [name for name in self.feet if abs(complex(np.asarray(self.poses[name].direction)) - 1) > UPRIGHT]

    @cached_property
    def stance(self) -> Stance | None:
        """How it stands over a turn of its legs.

        None if a leg is not upright, or the height of a mechanism along the shaft is unknown.
        """
        if self._turned:
            return None
        turn = 2 * np.pi / float(abs(self.graph.speeds[next(iter(self.feet))]))
        drive = np.copysign(np.linspace(0, turn, POSITIONS), self.speed_rpm)
        standing = self._standing(drive)
        if not np.isfinite(standing.height):
            return None
        return stance_with(standing, self.table.carried, tuple(self._motor), drive, self._standing)

    @cached_property
    def walking(self) -> Walking | None:
        """The forces at the feet; None if it has no weight, or falls over at some position."""
        stance = self.stance
        if stance is None or not stance.mass or not np.isfinite(stance.shares).all():
            return None
        speed = 2 * np.pi * abs(self.speed_rpm) / 60 * float(abs(self.graph.speeds[next(iter(self.feet))]))
        return Walking(stance, NEWTON * stance.mass * GRAVITY, self.table.foot_friction, speed)

    def on_feet(self, name: str, recipe: AbstractRecipe) -> AbstractRecipe:
        """The recipe of a mechanism with the forces at its feet; none if the machine falls over."""
        if name not in self.feet:
            return recipe
        forces = FootForces(self.feet[name])
        if self.walking is not None:
            counts = {leg: self.recipes[leg].number_of_feet(foot) for leg, foot in self.feet.items()}
            first = sum(list(counts.values())[: list(counts).index(name)])
            forces = self.walking.on_feet(self.feet[name], slice(first, first + counts[name]))
        return recipe.in_setting(replace(recipe.setting, feet=forces))

    @property
    def columns(self) -> Iterator[Column]:
        """Load of each foot and speed of the frame at the frames of the machine."""
        if self.walking:
            yield from self.walking.columns(2 * np.pi * self.turns)

    @property
    def plots(self) -> Iterator[Plot]:
        """Plots of these columns."""
        if self.walking:
            yield from self.walking.plots

    @property
    def checks(self) -> Iterator[Check]:
        """That it stands and rocks little, and that its feet carry its weight."""
        advice = "give its legs phase_deg by which three feet always stand, six legs at best, or feet that keep level"
        yield from self.stance.checks("walker", advice) if self.stance else ()
        if self._turned:
            legs = " and ".join(self._turned)
            words = f"give angle_deg = 0 to {legs}, whose feet are at -y of the recipe"
            name = "least distance of the frame's centre inside its feet"
            yield Check("support_margin", name, np.nan, "at least", 0, "mm", words)
        if self.walking is None:
            advice = "the torque is that of legs in the air: let it stand at all positions by the check support_margin"
            name = "share of the weight of the machine that its feet carry"
            yield Check("weight_carried", name, 0.0, "at least", LEAST_CARRIED, "%", advice)

    @property
    def remarks(self) -> tuple[str, ...]:
        """Where its weight is."""
        return tuple(self.stance.remarks) if self.stance else (UNKNOWN_STANCE,) * (not self._turned)

    @property
    def summary(self) -> Mapping[str, object]:
        """Entries of summary.json."""
        stance = {"stance": self.stance.summary} if self.stance else {}
        return {**stance, **({"walking": self.walking.summary} if self.walking else {})}


# Whose masses shake the frame of a machine.
SHAKING = "linkages with loads and of cycloidal drives with a material"
# Steps of the torques for each row of the table, of which there are at least 72 in a turn of a crank.
BETWEEN = 3


@record(eq=False)
class MachineTorques(TurningMachine):
    """The torques of a machine.

    The recipes are in their settings, without the torques that others take from them. walking: of a walker.
    speed_fluctuation: allowed, for a flywheel.
    """

    walking: MachineWalking | None = None
    speed_fluctuation: float | None = None

    @cached_property
    def input(self) -> Real | None:
        """Torque on the machine's driver at the frames, N mm; None without loads."""
        return self.input_at(self.turns)

    def input_at(self, turns: Real) -> Real | None:
        """Torque on the machine's driver at rotations of it, N mm; None without loads."""
        return self.by_driver_at(turns).get(self.graph.driver)

    @cached_property
    def shaking(self) -> tuple[Complex, Real] | None:
        """Force, N, and moment about the driver's axis, N mm, by which masses shake the frame, at the frames.

        Those of linkages under loads and of cycloidal drives with a material; None without any, or with loads whose
        shaking is not computed, such as those of cams.
        """
        force, moment, is_known, origin = np.zeros(len(self.turns), complex), np.zeros(len(self.turns)), False, None
        for name in self.graph.order:
            recipe, turn = self.recipes[name], self.turn(name, self.turns)
            axis = complex(self.poses[name].place(next(iter(self.graph.bodies[name].values())).axis))
            origin = axis if origin is None else origin
            if (own := recipe.shaking_at(turn)) is not None:
                placement = ShaftPlacement(self.poses[name], self.mechanisms[name].mirrored)
                pull = placement.vector(own[0])
                force = force + pull
                moment = moment + (-own[1] if placement.mirrored else own[1]) + cross(axis - origin, pull)
                is_known = True
            elif not recipe.carries_torques and recipe.torque_at(turn[:1]) is not None:
                return None
        return (force, moment) if is_known else None

    @property
    def columns(self) -> Iterator[Column]:
        """Shaking force and moment of all mechanisms."""
        if self.shaking:
            yield from vector_columns("shaking_force", "N", f"shaking force of {SHAKING}", self.shaking[0])
            meaning = f"shaking moment about the driver's axis, of {SHAKING}"
            yield Column("shaking_moment", "N mm", meaning, self.shaking[1])

    @property
    def plots(self) -> Iterator[Plot]:
        """A plot of the shaking force."""
        if self.shaking:
            yield Plot("shaking force", ("shaking_force",))

    def by_driver_at(self, turns: Real) -> Mapping[str, Real]:
        """Torque on the driver of each mechanism with all that it turns, N mm; without those that need none.

        It is the sum of the powers that the drivers of its mechanisms need. What all bodies beyond a mesh or a belt
        need together goes through it with its losses; power that flows back loses as much. Gears turn at a constant
        speed, so that their inertia needs no torque.
        """
        torques = dict[str, Real]()
        for name in reversed(self.graph.order):
            parts = self.recipes[name].torque_at(self.turn(name, turns)), self._through(name, torques, turns)
            if known := [part for part in parts if part is not None]:
                torques[name] = np.sum(known, axis=0)
        return torques

    def _through(self, name: str, torques: Mapping[str, Real], turns: Real) -> Real | None:
        """Torque on the driver of a mechanism by what its bodies turn and the loads on them; None if they are free."""
        graph, need, share = self.graph, np.zeros(len(turns)), 1.0
        sense, is_loaded = np.sign(float(graph.speeds[name]) * self.speed_rpm), False
        # From the last body to the driver: the efficiency of each is that of all meshes before it.
        for key, body in reversed([*graph.bodies[name].items()]):
            passed = body.efficiency / share
            need = np.where(need * sense > 0, need * passed, need / passed)
            turned = [other for other, source in graph.sources.items() if source == (name, key) and other in torques]
            need = need + sum(float(graph.speeds[other] / graph.speeds[name]) * torques[other] for other in turned)
            need = need + sense * abs(float(body.speed)) * (body.load or 0.0)
            is_loaded, share = is_loaded or bool(turned) or body.load is not None, body.efficiency
        return need if is_loaded else None

    @cached_property
    def dense(self) -> tuple[Real, Mapping[str, Real]]:
        """Rotations of the driver in smaller steps than those of the table, and the torques on all drivers there."""
        turns = np.linspace(0, self.turns[-1], BETWEEN * (len(self.turns) - 1) + 1)
        return turns, self.by_driver_at(turns)

    @cached_property
    def loaded_recipes(self) -> Mapping[str, AbstractRecipe]:
        """The recipes with the torques that what they turn takes from them, for the strength of gears and belts."""
        recipes, placed = dict(self.recipes), dict[tuple[int, Setting], AbstractRecipe]()
        for name, recipe in self.recipes.items():
            if recipe.carries_torques and recipe.depends_on_setting:
                setting = replace(recipe.setting, torques=self._taken_from(name))
                recipes[name] = placed.setdefault((id(recipe), setting), recipe.in_setting(setting))
        return recipes

    def _taken_from(self, name: str) -> tuple[tuple[str, float], ...]:
        """Bodies of a mechanism that turn others, and the largest torque of all these, N mm."""
        taken = dict[str, Real]()
        for other, (turned_by, body) in self.graph.sources.items():
            torque = self.dense[1].get(other)
            if turned_by == name and torque is not None and np.isfinite(torque).all():
                ratio = self.graph.speeds[other] / (self.graph.speeds[name] * self.graph.bodies[name][body].speed)
                taken[body] = taken.get(body, 0.0) + float(ratio) * torque
        return tuple((body, float(np.abs(torque).max())) for body, torque in taken.items())

    @cached_property
    def duty(self) -> MotorDuty | None:
        """Torque and speed of the driver in these steps; None without loads."""
        turns, torques = self.dense
        torque = torques.get(self.graph.driver)
        if torque is None:
            return None
        return MotorDuty(torque, np.full(turns.shape, RPM * self.speed_rpm), 2 * np.pi * turns)

    @cached_property
    def motor(self) -> tuple[Motor, MotorKeys] | None:
        """Motor of the driver and its keys: named in its loads, mounted, the lightest that suffices, or the nearest.

        None without loads, and if none is given and a torque is unknown.
        """
        if (duty := self.duty) is None:
            return None
        recipe, key = self.recipes[self.graph.driver], f"mechanisms.{self.graph.driver}.recipe"
        named, mounted = getattr(getattr(recipe, "loads", None), "motor", None), mounted_motor(recipe)
        keys = motor_keys(named, motor_name(mounted) if mounted else None, motor_key(recipe))
        motor = named or mounted or smallest_motor(duty) or nearest_motor(duty)
        return (motor, tuple(f"{key}.{own}" for own in keys)) if motor else None

    @property
    def checks(self) -> Iterator[Check]:
        """Whether the motor on the driver supplies the torque; DesignError for a flywheel of an unknown size."""
        if self.speed_fluctuation is not None and not np.isfinite(self.flywheel_inertia):
            problem = "is given, but no mechanism has loads that change the speed"
            if self.duty is not None:
                problem = "is given, but the torque is unknown at positions that a mechanism does not reach"
            remedy = "give a mechanism the table loads, such as mechanisms.NAME.recipe.loads, or omit it"
            raise DesignError("drive.speed_fluctuation", problem, remedy, "conflict")
        motor, duty = self.motor, self.duty
        if motor is not None and duty is not None:
            at = float(np.degrees(duty.angle[np.argmax(np.abs(duty.torque))]))
            yield motor_check(motor[0], duty, TORQUE, at, motor[1])

    @property
    def inertia_of_gears(self) -> float:
        """Of all gears, as felt at the driver, kg mm2; 0 if no material is given."""
        return sum(
            float(mass.inertia) * float(self.graph.speeds[name] * body.speed) ** 2
            for name, recipe in self.recipes.items()
            for key, body in self.graph.bodies[name].items()
            if body.is_wheel and (mass := recipe.body_masses.get(key)) is not None
        )

    @property
    def _flywheel(self) -> Mapping[str, object]:
        """The flywheel, and the disc of the driver's sheet that has its inertia, if its material is known."""
        if not np.isfinite(inertia := self.flywheel_inertia):
            return {}
        driver, body = self.recipes[self.graph.driver], next(iter(self.graph.bodies[self.graph.driver]))
        entries: dict[str, object] = {"inertia_kg_mm2": to_digits(inertia)}
        sheets = ((part.material, part.thickness) for part in driver.parts if part.body == body)
        for density, thickness in ((1e-9 * material.density, thickness) for material, thickness in sheets if material):
            radius = (2 * inertia / (np.pi * density * thickness)) ** 0.25
            mass = np.pi * density * thickness * radius**2
            return {**entries, "disc_diameter_mm": to_digits(2 * radius), "disc_mass_kg": to_digits(mass)}
        return entries

    @property
    def flywheel_inertia(self) -> float:
        """Of a flywheel on the driver that keeps `speed_fluctuation` with the gears, kg mm2; nan if none is asked.

        Inertia of cranks and of what moves to and fro is in the torque.
        """
        if self.speed_fluctuation is None or (duty := self.duty) is None:
            return np.nan
        return max(0.0, duty.steadying_inertia / self.speed_fluctuation - self.inertia_of_gears)

    @property
    def summary(self) -> Mapping[str, object]:
        """Torque, power and work of the driver, torques of the mechanisms, motor, flywheel, inertia of the gears."""
        if (duty := self.duty) is None or not np.isfinite(duty.torque).all():
            return {}
        peak = int(np.argmax(np.abs(duty.torque)))
        largest = {name: to_digits(np.max(np.abs(torque))) for name, torque in self.dense[1].items()}
        gears = {"inertia_of_gears_kg_mm2": to_digits(inertia)} if (inertia := self.inertia_of_gears) else {}
        return {
            "loads": {
                "input_torque_N_mm": {
                    "peak": to_digits(duty.torque[peak]),
                    "peak_at_deg": to_digits(np.degrees(duty.angle[peak]), 6),
                    "rms": to_digits(duty.rms_torque),
                },
                "driver_torques_N_mm": largest,
                **power_summary(duty),
                **gears,
                **({"flywheel": wheel} if (wheel := self._flywheel) else {}),
                **({"motor": motor_summary(self.motor[0], duty)} if self.motor else {}),
            }
        }
