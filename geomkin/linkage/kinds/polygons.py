"""Recipe of velocity and acceleration polygons of any linkage at one position."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from typing import ClassVar, Literal, Self

import numpy as np

from ...core.errors import DesignError
from ...core.fields import FARTHEST, entry, quantity, to_digits
from ...core.records import record
from ...core.units import marked
from ...model.check import Check
from ...model.part import Part
from ...model.scene import Scene, SceneHandle
from ...model.table import Column, Table
from ...plane.primitives import Circle
from ...plane.vec import Complex, rounded
from ...recipe.recipe import AbstractRecipe, Additions
from ...recipe.settings import Files
from ..assembly_failures import assembly_failure
from ..body_motion import Body
from ..checks import LEAST_ANGLE_OF_POLYGONS_DEG, driver_at
from ..instant.centres import instant_centres
from ..instant.components import RATES, component_columns, component_plots, component_vectors, components_check
from ..instant.polygons import POLE, VectorPolygon, acceleration_polygon, velocity_polygon
from ..motion import Motion, motion_table
from ..moving import move
from ..parts.engraved import PlateStock, arrow, engraved, skeleton
from ..scene_handles import handle_position, linkage_handles
from ..scene_instants import polygons_scene
from .moved import BodyList, Branches, JointAdditions, Side, branch_of, branches_entry, components_entry, shown_joints

# Distance from the linkage's middle, in sizes of it, beyond which instant centres are listed but not drawn.
REACH = 2.0
# Step of the driver in the animation of the polygons, deg.
STEP_DEG = 2


@record(checked=True, kw_only=True)
class PolygonsRecipe(AbstractRecipe):
    """Velocity and acceleration polygons of a linkage at one position, and the position with its instant centres."""

    can_be_scaled: ClassVar[bool] = True
    additions: ClassVar[Additions] = JointAdditions()
    kind: Literal["polygons"] = "polygons"
    linkage: BodyList
    position: float = quantity(
        "angle of the driver, deg, or its displacement, mm, if it slides",
        default=60.0,
        at_least=-FARTHEST,
        at_most=FARTHEST,
    )
    speed: float = quantity("speed of the driver: rad/s or mm/s", default=10.0, at_least=-FARTHEST, at_most=FARTHEST)
    acceleration: float = quantity(
        "acceleration of the driver: rad/s2 or mm/s2", default=0.0, at_least=-FARTHEST, at_most=FARTHEST
    )
    size: float = quantity("longest side that a polygon may have", "mm", default=100.0, at_least=10, at_most=5000)
    branch: Side = entry("branch of every dyad that is not named below", default=1)
    branches: Branches = branches_entry()
    effective_components: bool = components_entry()
    stock: PlateStock = entry("the plates", default=PlateStock())
    files: Files = entry("what is written", default=Files())

    def at_scale(self, scale: float) -> Self:
        if self.linkage.linkage.driven_slider is None:
            return super().at_scale(scale)
        drive = {name: scale * getattr(self, name) for name in ("position", "speed", "acceleration")}
        return replace(super().at_scale(scale), **drive)

    @property
    def design(self) -> BodyList:
        return self.linkage

    @cached_property
    def motion(self) -> Motion:
        """The linkage at its position."""
        place = self.position if self.linkage.linkage.driven_slider else np.radians(self.position)
        motion = move(self.linkage, [place], branch_of(self.branch, self.branches), self.speed, self.acceleration)
        if not motion.assembled[0]:
            problem = f"found {self.position:g}, which is not reached: {marked(str(assembly_failure(motion)))}"
            raise DesignError("position", problem, "give another", "does-not-assemble")
        return motion

    @cached_property
    def polygons(self) -> dict[str, tuple[VectorPolygon, str]]:
        """Each polygon with its unit."""
        return {
            "velocity": (velocity_polygon(self.motion, 0, self.size), "mm/s"),
            "acceleration": (acceleration_polygon(self.motion, 0, self.size), "mm/s2"),
        }

    @cached_property
    def table(self) -> Table:
        rows = [
            (name, unit, v.kind, v.body, v.start, v.end, v.value)
            for name, (polygon, unit) in self.polygons.items()
            for v in polygon.vectors
        ]
        if self.effective_components:
            rows += [
                (rate, unit, part.side, part.link, POLE, part.point, complex(part.vector[0]))
                for rate, unit in RATES.items()
                for part in component_vectors(self.motion, rate)
            ]
        words = {
            "polygon": "velocity or acceleration",
            "kind": "absolute, difference, normal, tangential, sliding, coriolis, or component along or across a link",
            "body": "the body, or the link of a component",
            "from": "the point at its tail",
            "to": "the point at its tip",
        }
        polygons, units, *texts, values = (np.array(column) for column in zip(*rows))
        return Table(
            (
                Column("number", "", "number of the vector", np.arange(1, len(rows) + 1)),
                *(Column(name, "", about, text) for (name, about), text in zip(words.items(), (polygons, *texts))),
                Column("unit", "", "unit of its size", units),
                Column("size", "", "its size in that unit", np.abs(values)),
                Column("direction", "deg", "its direction from +x", np.degrees(np.angle(values))),
            )
        )

    @cached_property
    def shown_motion(self) -> Motion:
        """A turn from the position on; if a slide drives, only the position."""
        motion = self.motion
        if self.linkage.linkage.driven_slider is not None:
            return motion
        turn = motion.drive[0] + np.radians(np.arange(0, 360 + STEP_DEG, STEP_DEG))
        return move(self.linkage, turn, branch_of(self.branch, self.branches), self.speed, self.acceleration)

    @cached_property
    def scene(self) -> Scene:
        """The polygons over that motion."""
        motion, table = self.shown_motion, motion_table(self.shown_motion)
        if not self.effective_components:
            return polygons_scene(motion, table)
        scene = polygons_scene(motion, Table((*table.columns, *component_columns(motion))), True)
        return replace(scene, plots=(*scene.plots, *component_plots(motion)))

    @cached_property
    def handles(self) -> tuple[SceneHandle, ...]:
        """The points, pivots and slides of the linkage."""
        return tuple(linkage_handles(self.linkage, self.shown_motion))

    def handle_position(self, id: str) -> Complex:
        return handle_position(self.shown_motion, id)

    @property
    def design_checks(self) -> tuple[Check, ...]:
        angle, least = np.degrees(self.motion.transmission_angle[0]), LEAST_ANGLE_OF_POLYGONS_DEG
        advice = "near a dead centre the polygons become too large"
        at, name = driver_at(self.motion, 0), "transmission angle here"
        check = Check("transmission_angle", name, angle, "at least", least, "deg", advice, at=at)
        return (check, components_check(self.motion)) if self.effective_components else (check,)

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        radius = self.stock.pin_diameter / 4
        centres = [Circle(z, radius) for z in self._near_centres()]
        parts = [engraved("position", [*skeleton(self.motion, 0, self.stock), *centres], self.stock)]
        for name, (polygon, _) in self.polygons.items():
            # If a difference has parts only these are drawn, so that no line is engraved twice.
            split = {(v.body, v.start, v.end) for v in polygon.vectors if v.kind in ("normal", "tangential")}
            drawn: dict[tuple[complex, complex], None] = {}
            for v in polygon.vectors:
                ends = v.tail, v.tip
                if v.kind == "difference" and (v.body, v.start, v.end) in split:
                    continue
                if ends not in drawn and ends[::-1] not in drawn:
                    drawn[ends] = None
            marks = [mark for tail, tip in drawn for mark in arrow(tail, tip)]
            parts.append(engraved(f"{name}-polygon", marks, self.stock))
        return tuple(parts)

    def _near_centres(self) -> list[complex]:
        """Instant centres that are not pins and near enough to be drawn."""
        motion = self.motion
        points = [z for n, b in motion.bodies.items() for z in _places(b, motion.linkage.bodies[n])]
        middle, size = sum(points) / len(points), max(abs(z - points[0]) for z in points)
        centres: list[complex] = []
        for centre in instant_centres(motion).values():
            z = complex(centre.position[0])
            if abs(z - middle) <= REACH * size and all(abs(z - other) > 1e-6 * size for other in (*points, *centres)):
                centres.append(z)
        return centres

    @property
    def notes(self) -> Mapping[str, object]:
        """Scales of the drawings, and every instant centre: its position, or its direction if it is at infinity."""
        scale = {f"{name}_mm_per_{unit}": polygon.scale for name, (polygon, unit) in self.polygons.items()}
        centres: dict[str, object] = {}
        for pair, centre in instant_centres(self.motion).items():
            z = complex(centre.position[0])
            far = {"at_infinity_deg": to_digits(np.degrees(np.angle(centre.direction[0])), 9)}
            centres[" and ".join(pair)] = _nine_digits(z, float(self.motion.linkage.size)) if np.isfinite(z) else far
        return {"scale": scale, "instant_centres_mm": centres}

    @classmethod
    def example_values(cls, tables: Mapping[str, str]) -> Mapping[str, object]:
        return {"linkage": shown_joints(tables)} if tables else {}


def _places(body: Body, points: Mapping[str, complex | Complex]) -> list[complex]:
    return [complex(body.point(z).position[0]) for z in points.values()]


def _nine_digits(z: complex, size: float) -> list[float]:
    """A position in mm with nine digits, relative to its distance or the linkage's size."""
    digits = 8 - int(np.floor(np.log10(max(abs(z), size))))
    xy = rounded(np.array([z.real, z.imag]), digits)
    return [float(xy[0]), float(xy[1])]
