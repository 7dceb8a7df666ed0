"""Recipes of vector diagrams: velocity and acceleration polygons of a linkage, the shaking force of a slider-crank."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cached_property
from typing import ClassVar, Literal, Self

import numpy as np

from ...core.errors import DesignError
from ...core.fields import FARTHEST, entry, quantity, to_digits
from ...core.records import record
from ...core.units import marked
from ...model.check import Check, Suggestion
from ...model.material import Material
from ...model.part import HoleFit, Part
from ...model.scene import Hodograph, Limit, Plot, Role, Scene, SceneHandle, point_handle
from ...model.table import Column, Table, xy_columns
from ...plane.primitives import Circle
from ...plane.vec import Complex, rounded
from ...recipe.recipe import AbstractRecipe, Additions, mass_summary
from ...recipe.settings import Files, Turn
from ..checks import (
    LEAST_ANGLE_OF_POLYGONS_DEG,
    MOST_FORCE_TO_BEST,
    assembly_failure,
    collision_advice,
    collision_check,
    in_driver_unit,
    reached,
)
from ..dynamics.shaking import (
    Counterbalance,
    SliderCrankMasses,
    best_counterbalance,
    judged_counterbalance,
    shaking_force,
)
from ..instant.centres import instant_centres
from ..instant.polygons import (
    POLE,
    RATES,
    VectorPolygon,
    acceleration_polygon,
    component_columns,
    component_plots,
    component_vectors,
    components_check,
    velocity_polygon,
)
from ..motion import Motion, motion_table
from ..moving import move
from ..named_linkages import SliderCrank
from ..parts.stack import link_parts
from ..parts.stock import LinkStock, PlateStock, arrow, engraved, skeleton
from ..scene import linkage_scene
from ..scene_handles import body_point, handle_position, linkage_handles
from ..scene_instants import force_scene, polygons_scene
from ..solve.solution import Body
from .linkages import AbstractLinkageRecipe, LinkageAdditions
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
        "angle of the driver, deg, or its displacement, mm, if it slides", default=60.0, at_least=-FARTHEST,
        at_most=FARTHEST,
    )  # fmt: skip
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
        at, name = in_driver_unit(self.motion, float(self.motion.drive[0])), "transmission angle here"
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


# Share of the largest force below which a force counts as rounding.
ROUNDING = 1e-9


@record(checked=True, kw_only=True)
class ShakingForceRecipe(AbstractLinkageRecipe):
    """The shaking force of a slider-crank without, with a given and with the best counterbalance, and its plates."""

    aspect_kinds = ()
    additions: ClassVar[Additions] = LinkageAdditions(("stock.motor",))
    kind: Literal["shaking-force"] = "shaking-force"
    linkage: SliderCrank
    masses: SliderCrankMasses
    counterbalance: float = quantity(
        "given counterbalance, mass times radius opposite the crank pin", "kg mm", default=0.0, example=35,
        at_least=-1e6, at_most=1e6,
    )  # fmt: skip
    weight_density: float = quantity(
        "density of the counterweight's sheet, which is as thick as the links", "kg/m3", default=7850.0, above=0,
        at_most=30000,
    )  # fmt: skip
    branch: Side = entry("1 or -1: slider right or left of the crank pin", default=1)
    drive: Turn = entry("how the crank turns", default=Turn())
    stock: LinkStock = entry("sheet and pins of the links", default=LinkStock())
    files: Files = entry("what is written", default=Files())

    def __post_init__(self) -> None:
        super().__post_init__()
        self.drive.check_rows()
        if self.linkage.driver != "crank":
            raise DesignError(
                "linkage.driver", f"found {self.linkage.driver}", "give crank: the force is over its turn", "conflict"
            )

    @cached_property
    def best(self) -> Counterbalance:
        """The counterbalance along the crank that minimises the largest force."""
        return best_counterbalance(self.linkage, self.masses, self.branch, acceleration=self.acceleration)

    @property
    def acceleration(self) -> float:
        """Angular acceleration of the crank over its speed squared."""
        return self.drive.acceleration / self.drive.speed**2

    def _with(self, product: float) -> Counterbalance:
        return judged_counterbalance(self.linkage, self.masses, product, self.branch, self.acceleration)

    @cached_property
    def counterbalances(self) -> Mapping[str, Counterbalance]:
        """Without, with the given and with the best counterbalance."""
        return {"none": self._with(0.0), "given": self._with(self.counterbalance), "best": self.best}

    @property
    def largest(self) -> dict[str, float]:
        """Largest force over the turn, N, without, with the given and with the best counterbalance."""
        return {name: one.largest * self.drive.speed**2 for name, one in self.counterbalances.items()}

    @cached_property
    def table(self) -> Table:
        motion = self.motion
        columns = [
            Column("crank_angle", "deg", "angle of the crank from the ground line", np.degrees(motion.drive)),
            Column("time", "s", "time at the recipe's speed", motion.timing.elapsed(motion.drive)),
        ]
        for name, product in (("none", 0.0), ("given", self.counterbalance), ("best", self.best.product)):
            force = shaking_force(motion, self.masses, product)
            columns += xy_columns(f"force_{name}", "N", f"shaking force, counterbalance: {name}", force)
            columns.append(Column(f"force_{name}", "N", f"its size, counterbalance: {name}", np.abs(force)))
        return Table(tuple(columns))

    @cached_property
    def scene(self) -> Scene:
        """The moving plates, and the force on the ground at the crank's pivot."""
        scene = linkage_scene(self.motion, self.table, self.parts, self.made.stack.layers)
        roles: dict[str, Role] = {"none": "construction", "given": "traced", "best": "wanted"}
        forces = {
            role: np.asarray(self.table[f"force_{name}_x"] + 1j * self.table[f"force_{name}_y"])
            for name, role in roles.items()
        }
        words = {
            "none": "force without counterweight",
            "given": "force with the given counterweight",
            "best": "force with the best counterweight",
        }
        what = {role: words[name] for name, role in roles.items()}
        most = Limit(
            "force_given", MOST_FORCE_TO_BEST * self.best.largest * self.drive.speed**2, "at most, with the one given"
        )
        plots = [Plot("size of the shaking force", tuple(f"force_{name}" for name in roles), (most,))]
        plots += [Plot(f"shaking force along {axis}", tuple(f"force_{name}_{axis}" for name in roles)) for axis in "xy"]
        scene = force_scene(scene, complex(self.linkage.origin), forces, what, tuple(plots))
        return replace(scene, hodographs=(Hodograph("polar diagram of the shaking force", plots[0].columns),))

    @property
    def further_handles(self) -> Iterator[SceneHandle]:
        """The centres of mass."""
        for body in ("crank", "coupler"):
            at = body_point(self.motion, body, getattr(self.masses, f"{body}_centre"))
            yield point_handle(f"masses.{body}_centre", at=at, label=f"centre of mass of the {body}")

    @property
    def design_checks(self) -> tuple[Check, ...]:
        given, best = self.counterbalances["given"], self.best.product.real
        # If the best counterbalance leaves no force, only rounding would be left to divide by.
        least = max(self.best.largest, ROUNDING * max(one.largest for one in self.counterbalances.values()))

        def share(one: Counterbalance) -> float:
            return max(one.largest, least) / least if least > 0 else 1.0

        # As few digits as suffice.
        rounded = (to_digits(best, digits) for digits in range(6, 18))
        product = next((value for value in rounded if share(self._with(value)) <= MOST_FORCE_TO_BEST), best)
        name, advice = "largest force, given to best counterbalance", f"give counterbalance = {product!r}"
        first, worst = min(self.drive.span_deg), float(np.degrees(given.angles[0]))
        at, suggestions = first + (worst - first) % 360, (Suggestion({"counterbalance": product}, "kg mm"),)
        return (
            reached(self.motion, "crank's turn"),
            Check(
                "force_to_best",
                name,
                share(given),
                "at most",
                MOST_FORCE_TO_BEST,
                "",
                advice,
                at=at,
                suggestions=suggestions,
            ),
            collision_check(len(self.made.stack.collisions), collision_advice(self.made.stack.collisions)),
            *self.drive.checks,
        )

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        return (*link_parts(self.made.fine_motion, self.stock, self.made.stack), *self._counterweight())

    @property
    def steps(self) -> tuple[str, ...]:
        if all(part.name != "counterweight" for part in self.parts):
            return self.made.stack.steps
        shaft = "a shaft (not supplied) that turns with crank, instead of the screw"
        return (*self.made.stack.steps, f"glue counterweight on {shaft} A, below ground, its middle opposite to B")

    def _counterweight(self) -> list[Part]:
        """An eccentric disc with the best product: its shaft hole at half its radius, opposite the crank pin."""
        product = self.best.product.real
        if product <= 0:
            return []
        stock, hole = self.stock, self.stock.hole_diameter / 2
        # The product is density thickness pi times r^2 r / 2 - h^2 r: the shaft's hole is at the axis; the second hole,
        # at the distance r, allows the disc to be turned over.
        moment = product / (np.pi * self.weight_density * 1e-9 * stock.thickness)
        radius = float(np.roots([0.5, 0, -(hole**2), -moment]).real.max())
        if radius <= 4 * hole:
            return []
        if stock.motor is not None:
            problem = f"found {stock.motor}, which is below ground, where the counterweight turns on the crank's shaft"
            raise DesignError("stock.motor", problem, "omit it", "conflict")
        holes = (Circle(0j, hole), Circle(complex(-radius), hole))
        fits = 2 * (HoleFit(stock.pin_diameter, stock.pin_clearance, iso_fit=stock.pin_fit),)
        disc, letters = Circle(complex(-radius / 2), radius), ("A", "")
        material = Material("counterweight", self.weight_density)
        return [
            Part(
                "counterweight",
                disc,
                holes,
                stock.thickness,
                body="crank",
                hole_names=letters,
                fits=fits,
                material=material if stock.material else None,
            )
        ]

    @property
    def notes(self) -> Mapping[str, object]:
        return {
            "best_counterbalance_kg_mm": to_digits(self.best.product.real),
            "largest_force_N": {name: to_digits(force) for name, force in self.largest.items()},
            **mass_summary(self),
            "stack": {**self.made.stack.summary(), "steps": list(self.steps)},
        }
