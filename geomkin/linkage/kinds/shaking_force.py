"""Recipe of a slider-crank's shaking force and the counterbalance that minimises it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cached_property
from typing import ClassVar, Literal

import numpy as np

from ...core.errors import DesignError
from ...core.fields import entry, quantity, to_digits
from ...core.records import record
from ...model.check import Check, Suggestion
from ...model.material import Material
from ...model.part import HoleFit, Part
from ...model.scene import Hodograph, Limit, Plot, Role, Scene, SceneHandle, point_handle
from ...model.table import Column, Table, xy_columns
from ...plane.primitives import Circle
from ...recipe.recipe import Additions, mass_summary
from ...recipe.settings import Files, Turn
from ..checks import MOST_FORCE_TO_BEST, collision_check, reached
from ..dynamics.shaking import (
    Counterbalance,
    SliderCrankMasses,
    best_counterbalance,
    judged_counterbalance,
    shaking_force,
)
from ..named_linkages import SliderCrank
from ..parts.stack import link_parts
from ..parts.stock import LinkStock
from ..scene import linkage_scene
from ..scene_handles import body_point
from ..scene_instants import force_scene
from .linkages import AbstractLinkageRecipe, LinkageAdditions
from .moved import Side

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
        "given counterbalance, mass times radius opposite the crank pin",
        "kg mm",
        default=0.0,
        example=35,
        at_least=-1e6,
        at_most=1e6,
    )
    weight_density: float = quantity(
        "density of the counterweight's sheet, which is as thick as the links",
        "kg/m3",
        default=7850.0,
        above=0,
        at_most=30000,
    )
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
            collision_check(len(self.made.stack.collisions), "see summary.json"),
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
        fits = 2 * (HoleFit(stock.pin_diameter, stock.clearance, iso_fit=stock.pin_fit),)
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
