"""Recipe of a cam with a groove, which moves its roller both ways, and its loads."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cached_property
from typing import Any, ClassVar, Literal

import numpy as np

from ...core.fields import entry, to_digits
from ...core.records import record
from ...core.units import mm
from ...model.check import Check
from ...model.material import hertz_pressure
from ...model.scene import Limit, Plot, Scene, SceneBody, SceneHandle, SceneMark, circle_handle, drawn_at
from ...model.table import Column, Table, xy_columns
from ...plane.vec import Real
from ...recipe.composed import AspectKinds
from ..checks import LEAST_PITCH_TO_ROLLER, cam_table, convex_curvature
from ..scene import cam_scene, with_size_plot
from .disk_cam import AbstractCamRecipe
from .groove import Groove, MadeGrooveCam
from .loads import LONGEST_ARROW, CamLoadsAspect

# Largest play of the roller along its path, in clearances: between parallel walls it is 1 over the cosine of the
# pressure angle, 1.41 at 45 deg. With more, a wall is cut away; chosen here.
MOST_PLAY = 2.0


@record(eq=False)
class GrooveLoadsAspect(CamLoadsAspect):
    """The forces of a groove and its roller: the core pushes it outwards, the ring pulls it inwards."""

    mechanism: MadeGrooveCam

    @property
    def contact_checks(self) -> Iterator[Check]:
        """None: the groove holds the roller."""
        return iter(())

    @property
    def spring_summary(self) -> Mapping[str, object]:
        """Cam angles at which the roller changes from one wall to the other."""
        force = self.forces.contact
        changes = np.flatnonzero((force[1:] * force[:-1] < 0) & np.isfinite(force[1:] * force[:-1]))
        return {"wall_changes_at_deg": [to_digits(np.degrees(self.angles[k + 1]), 5) for k in changes]}

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

    def columns(self, table: Table) -> Iterator[Column]:
        for column in super().columns(table):
            meaning = "force of the groove on the roller along the normal, from the core, or below 0 from the ring"
            yield replace(column, meaning=meaning) if column.id == "contact_force" else column

    def plots(self, table: Table) -> Iterator[Plot]:
        for plot in super().plots(table):
            lines = tuple(replace(line, label="below, the ring carries the roller") for line in plot.limits)
            yield replace(plot, limits=lines) if plot.columns == ("contact_force",) else plot


@record(kw_only=True)
class GrooveCamRecipe(AbstractCamRecipe):
    """A cam with a groove that moves its roller both ways: core and ring on a disc, stem or arm, motion, play."""

    aspect_kinds: ClassVar[AspectKinds] = (GrooveLoadsAspect,)
    kind: Literal["groove-cam"] = "groove-cam"
    groove: Groove = entry("clearance of the roller, and the ring round the groove", default=Groove())

    def __post_init__(self) -> None:
        self.made.check()
        super().__post_init__()

    @cached_property
    def made(self) -> MadeGrooveCam:
        """The cam with its groove in its setting."""
        return MadeGrooveCam(self.cam, self.drive, self.stock, self.base, self.setting, self.groove)

    @property
    def own_table(self) -> Table:
        angle = self.drive.angles
        wall = self.made.outer_wall.point(angle)
        return Table(
            (
                *super().own_table.columns,
                *xy_columns("outer_wall", "mm", "wall outside the roller, in the cam's frame", wall),
                Column("play", "mm", "play of the roller along its path", self.made.play(angle)),
            )
        )

    @property
    def own_checks(self) -> tuple[Check, ...]:
        made, most = self.made, MOST_PLAY * self.groove.clearance
        (least, largest), (radius, at) = made.play_range, made.concave_radius
        advice = "a wall is cut away: give a larger cam.base_radius, a smaller roller or longer segments"
        name, share = "least concave pitch radius to that of the outer wall", radius / made.half_width
        at_deg = float(np.degrees(at)) if np.isfinite(radius) else None
        wider = "give a larger cam.base_radius, a smaller roller or longer segments"
        concave = Check("concave_radius", name, share, "at least", LEAST_PITCH_TO_ROLLER, "", wider, at=at_deg)
        jams = "the roller jams: give a larger groove.clearance"
        return (
            *super().own_checks,
            concave,
            Check("least_play", "least play of the roller along its path", least, "at least", 0, "mm", jams, "play"),
            Check("play", "largest play of the roller along its path", largest, "at most", most, "mm", advice, "play"),
        )

    def _scene(self, table: Table, limits: tuple[Limit, ...] = ()) -> Scene:
        """Cam and follower; disc, core and ring, and stem or arm above each other."""
        disc = next(part for part in self.parts if part.name == "disc")
        scene = cam_scene(self.cam, table, [part for part in self.parts if part is not disc], self.made.cut, limits)
        first = int(self.base is not None)

        def placed(body: SceneBody) -> SceneBody:
            layers = {"cam": first + 1, "roller": first + 1, "ground": 0, "motor_plate": body.layer}
            return replace(body, layer=layers.get(body.name, first + 2))

        bodies = tuple(map(placed, scene.bodies))
        cam = next(body for body in bodies if body.name == "cam")
        under = replace(cam, name="disc", parts=(disc,), layer=first, named=False)
        return replace(scene, bodies=(*bodies, under))

    @property
    def own_scene(self) -> Scene:
        scene = with_size_plot(self._scene(self.table, self._limits()), self.cam)
        most = Limit("play", MOST_PLAY * self.groove.clearance, "more if a wall is cut away")
        return replace(scene, plots=(*scene.plots, Plot("play of the roller", ("play",), (most,))))

    def scene_at(self, turn: Real) -> Scene:
        table = cam_table(self.cam, self.made.speed, np.remainder(turn, 2 * np.pi), self.made.cut)
        return self._scene(table)

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
        least, most = self.made.play_range
        own = {key: value for key, value in super().quantities.items() if key != "undercut"}
        return {**own, "disc": f"{mm(2 * self.made.disc_radius):.5g}", "play": f"{mm(least, most, between=' to '):.3g}"}

    @property
    def own_notes(self) -> tuple[Mapping[str, object], Mapping[str, object]]:
        before, after = super().own_notes
        least, most = self.made.play_range
        groove = {
            "disc_diameter_mm": to_digits(2 * self.made.disc_radius),
            "least_play_mm": to_digits(least, 4),
            "largest_play_mm": to_digits(most, 4),
        }
        return {"groove": groove, **before}, after

    @classmethod
    def example_values(cls, tables: Mapping[str, str]) -> Mapping[str, Any]:
        return {**super().example_values(tables), **({"stock.stem_length": 90.0} if "base" in tables else {})}
