"""Recipe of a cam with a groove, which moves its roller both ways, and its loads."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import ClassVar, Literal

import numpy as np

from ...core.fields import entry
from ...core.records import record
from ...core.units import mm
from ...model.check import Check
from ...model.material import hertz_pressure
from ...model.scene import Limit, Scene, SceneHandle, SceneMark, circle_handle, drawn_at
from ...model.table import Column, Table, xy_columns
from ...plane.vec import Real
from ...recipe.composed import AspectKinds
from ..checks import LEAST_PITCH_TO_ROLLER, convex_curvature
from .groove import Groove, MadeGrooveCam
from .loads import LONGEST_ARROW
from .positive import AbstractPositiveCamRecipe, PositiveLoadsAspect


@record(eq=False)
class GrooveLoadsAspect(PositiveLoadsAspect):
    """The forces of a groove and its roller: the core pushes it outwards, the ring pulls it inwards."""

    mechanism: MadeGrooveCam

    def pressure(self, angle: Real) -> Real:
        """Hertz pressure on the wall that carries the roller, N/mm2; nan if it is unknown."""
        core = super().pressure(angle)
        if self.material is None:
            return core
        curvature, radius = convex_curvature(self.cam, angle), self.cam.follower.roller_radius
        outer = 1 / radius - curvature / (1 + curvature * self.mechanism.half_width)
        force = self.contact(angle)
        ring = hertz_pressure(-force, self.mechanism.stock.thickness, outer, self.material, self.material)
        return np.where(force < 0, ring, core)

    @property
    def arrow(self) -> Iterator[SceneMark]:
        """The force on the roller at each frame, from the wall that carries it."""
        force, at = np.nan_to_num(self.forces.contact), self.cam.contact(self.angles)
        if force.any():
            scale = LONGEST_ARROW * self.cam.prime_radius / np.abs(force).max()
            place = at.point + np.where(force < 0, 2 * self.cam.follower.roller_radius, 0.0) * at.normal
            label = f"contact force, {drawn_at(float(scale), 'N')}"
            yield SceneMark("vector", place, "force", label, vector=scale * force * at.normal)


@record(kw_only=True)
class GrooveCamRecipe(AbstractPositiveCamRecipe):
    """A cam with a groove that moves its roller both ways: core and ring on a disc, stem or arm, motion, play."""

    aspect_kinds: ClassVar[AspectKinds] = (GrooveLoadsAspect,)
    kind: Literal["groove-cam"] = "groove-cam"
    groove: Groove = entry("clearance of the roller, and the ring round the groove", default=Groove())

    @cached_property
    def made(self) -> MadeGrooveCam:
        """The cam with its groove in its setting."""
        return MadeGrooveCam(self.cam, self.drive, self.stock, self.base, self.setting, self.has_snap_pins, self.groove)

    def wall_columns(self, angle: Real) -> Iterator[Column]:
        wall = self.made.outer_wall.point(angle)
        yield from xy_columns("outer_wall", "mm", "wall outside the roller, in the cam's frame", wall)

    @property
    def wall_checks(self) -> Iterator[Check]:
        (radius, at), limit = self.made.concave_radius, LEAST_PITCH_TO_ROLLER
        name, share = "least concave pitch radius to that of the outer wall", radius / self.made.half_width
        advice = "give a larger cam.base_radius, a smaller roller or longer segments"
        at_deg = float(np.degrees(at)) if np.isfinite(radius) else None
        yield Check("concave_radius", name, share, "at least", limit, "", advice, at=at_deg)

    def shown(self, table: Table, limits: Sequence[Limit] = ()) -> Scene:
        """Disc, core and ring, and stem or arm above each other."""
        scene = self.layered(table, limits, ["disc"], 1, 2)
        cam = next(body for body in scene.bodies if body.name == "cam")
        disc = tuple(part for part in self.parts if part.name == "disc")
        under = replace(cam, name="disc", parts=disc, layer=cam.layer - 1, named=False)
        return replace(scene, bodies=(*scene.bodies, under))

    @property
    def handles(self) -> tuple[SceneHandle, ...]:
        contact = self.cam.contact(self.drive.angles)
        centre = contact.point + self.cam.follower.roller_radius * contact.normal
        return (
            *super().handles,
            circle_handle("groove.rim", radius=self.made.disc_radius, label="rim of the disc"),
            circle_handle("groove.clearance", radius=self.made.half_width, centre=centre, label="groove"),
        )

    @property
    def quantities(self) -> Mapping[str, str]:
        return {**super().quantities, "disc": f"{mm(2 * self.made.disc_radius):.5g}"}
