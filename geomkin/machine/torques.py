"""The torques on the drivers of a machine's mechanisms under their loads, and the motor that supplies them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cached_property

import numpy as np

from ..core.errors import DesignError
from ..core.fields import to_digits
from ..core.records import record
from ..making.motors import motor_check, motor_summary, nearest_motor, power_summary, smallest_motor
from ..model.check import Check
from ..model.motor import RPM, Motor, MotorDuty
from ..model.scene import Plot
from ..model.table import Column, vector_columns
from ..plane.vec import Complex, Pose, Real, cross
from ..recipe.aspect import Setting, ShaftPlacement
from ..recipe.recipe import AbstractRecipe
from .mechanism import Mechanism
from .placed import TORQUE
from .shaft_fits import motor_key, mounted_motor
from .shafts import ShaftGraph
from .walking import MachineWalking

# Steps of the torques for each row of the table, of which there are at least 72 in a turn of a crank.
BETWEEN = 3


@record(eq=False)
class MachineTorques:
    """The torques of a machine.

    graph: its shafts. mechanisms, recipes, poses: by name; the recipes are in their settings, without the torques that
    others take from them. turns: rotations of the driver at the frames. speed_rpm: of the driver. walking: of a walker.
    speed_fluctuation: allowed, for a flywheel.
    """

    graph: ShaftGraph
    mechanisms: Mapping[str, Mechanism]
    recipes: Mapping[str, AbstractRecipe]
    poses: Mapping[str, Pose]
    turns: Real
    speed_rpm: float
    walking: MachineWalking | None = None
    speed_fluctuation: float | None = None

    @cached_property
    def input(self) -> Real | None:
        """Torque on the machine's driver at the frames, N mm; None without loads."""
        return self.input_at(self.turns)

    def input_at(self, turns: Real) -> Real | None:
        """Torque on the machine's driver at rotations of it, N mm; None without loads."""
        return self.by_driver_at(turns).get(self.graph.driver)

    def _turn(self, name: str, turns: Real) -> Real:
        phase = np.radians(self.mechanisms[name].phase_deg)
        return np.asarray(2 * np.pi * float(self.graph.speeds[name]) * turns + phase)

    @cached_property
    def shaking(self) -> tuple[Complex, Real] | None:
        """Force, N, and moment about the driver's axis, N mm, by which all masses shake the frame, at the frames.

        None without linkages under loads, or with loads whose shaking is not computed, such as those of cams.
        """
        force, moment, is_known, origin = np.zeros(len(self.turns), complex), np.zeros(len(self.turns)), False, None
        for name in self.graph.order:
            recipe, turn = self.recipes[name], self._turn(name, self.turns)
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
            yield from vector_columns("shaking_force", "N", "shaking force of all masses on the frame", self.shaking[0])
            meaning = "shaking moment of all masses about the driver's axis"
            yield Column("shaking_moment", "N mm", meaning, self.shaking[1])

    @property
    def plots(self) -> Iterator[Plot]:
        """A plot of the shaking force."""
        if self.shaking:
            yield Plot("shaking force", ("shaking_force",))

    def by_driver_at(self, turns: Real) -> Mapping[str, Real]:
        """Torque on the driver of each mechanism with all that it turns, N mm; without those that need none.

        It is the sum of the powers that the drivers of its mechanisms need, over the efficiency of the gears between;
        power that flows back loses as much. Gears turn at a constant speed, so that their inertia needs no torque.
        """
        graph, torques = self.graph, dict[str, Real]()
        for name in reversed(graph.order):
            own = self.recipes[name].torque_at(self._turn(name, turns))
            parts = [] if own is None else [own]
            for other, (turned_by, body) in graph.sources.items():
                if turned_by == name and other in torques:
                    ratio, share = graph.speeds[other] / graph.speeds[name], graph.bodies[name][body].efficiency
                    torque = float(ratio) * torques[other]
                    is_driven = torque * float(graph.speeds[name]) * self.speed_rpm > 0
                    parts.append(np.where(is_driven, torque / share, torque * share))
            if parts:
                torques[name] = np.sum(parts, axis=0)
        return torques

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
    def motor(self) -> tuple[Motor, str] | None:
        """The motor of the driver and its key: mounted, named in its loads, the lightest that suffices, or the nearest.

        None without loads.
        """
        if (duty := self.duty) is None or not np.isfinite(duty.torque).any():
            return None
        recipe, key = self.recipes[self.graph.driver], f"mechanisms.{self.graph.driver}.recipe"
        named = getattr(getattr(recipe, "loads", None), "motor", None)
        if named is not None:
            return named, f"{key}.loads.motor"
        if mounted := mounted_motor(recipe):
            return mounted, f"{key}.{motor_key(recipe)}"
        return smallest_motor(duty) or nearest_motor(duty), f"{key}.loads.motor"

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
            at = float(np.degrees(duty.angle[np.nanargmax(np.abs(duty.torque))]))
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
        if (duty := self.duty) is None or not np.isfinite(duty.torque).any():
            return {}
        peak = int(np.nanargmax(np.abs(duty.torque)))
        largest = {name: to_digits(np.fmax.reduce(np.abs(torque))) for name, torque in self.dense[1].items()}
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
