"""Recipe of conjugate cams, which move their follower both ways, and its loads."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import ClassVar, Literal

import numpy as np

from ...core.errors import DesignError
from ...core.fields import entry
from ...core.records import record
from ...core.units import mm
from ...model.check import Check
from ...model.material import hertz_pressure
from ...model.scene import Limit, Plot, Scene, SceneBody, SceneHandle, SceneMark, circle_handle, drawn_at
from ...model.table import Column, Table, xy_columns
from ...plane.vec import Real
from ...recipe.composed import AspectKinds
from ...recipe.recipe import Additions
from ..checks import cam_checks
from ..dynamics import CamForces
from ..followers.roller import OscillatingRoller
from ..undercut import Undercut
from .conjugate import MadeConjugateCams, SecondCam
from .disk_cam import CamAdditions
from .loads import LONGEST_ARROW
from .positive import FLAT_FOLLOWERS, AbstractPositiveCamRecipe, PositiveLoadsAspect

# Checks of a single cam that hold for the second one too.
OF_BOTH = ("pressure_angle_rise", "pressure_angle_return", "pitch_radius")


@record(eq=False)
class ConjugateLoadsAspect(PositiveLoadsAspect):
    """The forces of two cams and their rollers: the first cam lifts the follower, the second one pulls it back."""

    mechanism: MadeConjugateCams
    names = ("first cam", "second cam")

    def check(self) -> None:
        super().check()
        if self.given.friction:
            problem = "is given, but its effect is known for one cam only"
            raise DesignError("loads.friction", problem, "omit it", "conflict")

    def forces_at(self, angle: Real) -> CamForces:
        forces, other = super().forces_at(angle), self.mechanism.other
        reach = other.follower.arm_length if isinstance(other.follower, OscillatingRoller) else 1.0
        second = forces.stroke_force / (reach * np.cos(other.contact(angle).pressure_angle))
        return replace(forces, contact=np.where(forces.stroke_force < 0, second, forces.contact))

    def pressure(self, angle: Real) -> Real:
        """Hertz pressure on the cam that carries the follower, N/mm2; nan if it is unknown."""
        first = super().pressure(angle)
        if self.material is None:
            return first
        made, force = self.mechanism, self.contact(angle)
        curvature = 1 / made.roller.roller_radius - self.cam.sense * made.other.profile.curvature(angle)
        second = hertz_pressure(-force, made.stock.thickness, curvature, self.material, self.material)
        return np.where(force < 0, second, first)

    @property
    def arrow(self) -> Iterator[SceneMark]:
        """The force on the roller at each frame, from the cam that carries it."""
        made, force = self.mechanism, np.nan_to_num(self.forces.contact)
        if force.any():
            scale = LONGEST_ARROW * self.cam.prime_radius / np.abs(force).max()
            first, second = self.cam.contact(self.angles), made.other.contact(self.angles)
            place = np.where(force < 0, made.turned * second.point, first.point)
            normal = np.where(force < 0, made.turned * second.normal, first.normal)
            label = f"contact force, {drawn_at(float(scale), 'N')}"
            yield SceneMark("vector", place, "force", label, vector=scale * np.abs(force) * normal)


@record(kw_only=True)
class ConjugateCamsRecipe(AbstractPositiveCamRecipe):
    """Two cams on one shaft that move one follower both ways: rollers on an arm or a yoke, motion, play, plates."""

    aspect_kinds: ClassVar[AspectKinds] = (ConjugateLoadsAspect,)
    additions: ClassVar[Additions] = CamAdditions(refused=("loads.friction", *FLAT_FOLLOWERS))
    kind: Literal["conjugate-cams"] = "conjugate-cams"
    second: SecondCam = entry("the second cam and the clearance of both", default=SecondCam())

    @cached_property
    def made(self) -> MadeConjugateCams:
        """The cams in their setting."""
        return MadeConjugateCams(
            self.cam, self.drive, self.stock, self.base, self.setting, self.has_snap_pins, self.second
        )

    def wall_columns(self, angle: Real) -> Iterator[Column]:
        made = self.made
        contact = made.other.contact(angle)
        meaning = "angle between the path of the second roller and the force on it"
        yield Column("second_pressure_angle", "deg", meaning, np.degrees(contact.pressure_angle))
        words, profile = (
            "profile of the second cam, in the frame of both",
            made.turned * made.other.profile.point(angle),
        )
        yield from xy_columns("second_profile", "mm", words, profile)

    @property
    def wall_checks(self) -> Iterator[Check]:
        other = self.made.other
        whole = Undercut(other, other.profile, np.empty((0, 2)), np.empty(0, complex))
        for check in cam_checks(other, whole):
            if check.id in OF_BOTH:
                advice = check.advice.replace("base_radius", "second.base_radius")
                yield replace(
                    check, id=f"second_{check.id}", name=f"{check.name}, second cam", column="", advice=advice
                )

    def shown(self, table: Table, limits: Sequence[Limit] = ()) -> Scene:
        """The first cam and its roller, the arm or yoke, the second cam and its roller above each other."""
        scene = self.layered(table, limits, ["second"], 0, 1)
        cam, roller = (next(body for body in scene.bodies if body.name == name) for name in ("cam", "roller"))
        angle = np.radians(np.asarray(table["cam_angle"], dtype=float))
        centre = np.asarray(self.cam.follower_pose(angle).place(self.made.second_centre))
        second = tuple(part for part in self.parts if part.name == "second")
        above = (
            replace(cam, name="second", parts=second, layer=cam.layer + 2),
            SceneBody("second_roller", roller.parts, centre, roller.direction, cam.layer + 2),
        )
        mark = SceneMark("pin", centre, "construction", "second roller")
        return replace(scene, bodies=(*scene.bodies, *above), marks=(*scene.marks, mark))

    @property
    def own_scene(self) -> Scene:
        scene = super().own_scene
        plots = (Plot("pressure angle of the second cam", ("second_pressure_angle",)),)
        return replace(scene, plots=(*scene.plots, *plots))

    @property
    def handles(self) -> tuple[SceneHandle, ...]:
        made = self.made
        centre = np.asarray(self.cam.follower_pose(self.drive.angles).place(made.second_centre))
        handles = [circle_handle("second.clearance", radius=made.half_width, centre=centre, label="clearance")]
        if self.second.base_radius is not None:
            handles.append(
                circle_handle("second.base_radius", radius=self.second.base_radius, label="second base circle")
            )
        return (*super().handles, *handles)

    @property
    def quantities(self) -> Mapping[str, str]:
        made = self.made
        apart = abs(made.second_centre - made.roller.centre)
        return {**super().quantities, "distance of the rollers": f"{mm(apart):.6g}"}
