"""Recipe of a slider-crank's shaking force and the counterbalance that makes it least."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Any, Literal

import numpy as np

from ..check import Check
from ..errors import DesignError
from ..linkage.motion import Motion
from ..linkage.shaking import (
    Counterbalance,
    SliderCrankMasses,
    best_counterbalance,
    judged_counterbalance,
    shaking_force,
)
from ..linkage.slider_crank import SliderCrank
from ..linkage.solve import move
from ..part import Part
from ..plane.primitives import Circle
from ..shop.links import link_parts
from ..shop.stack import Stack, stack_links
from ..shop.stock import LinkStock
from ..sizes import NotBoolean, check_sizes, entry, quantity
from ..table import Column, Table, xy_columns
from .kind import Kind
from .settings import Files, Turn

# Of the largest force, what counts as none. A smaller share is that of the force's own rounding.
ROUNDING = 1e-9


@dataclass(frozen=True)
class ShakingForceRecipe:
    """The shaking force of a slider-crank without, with a given and with the best counterbalance, and its plates."""

    kind: Literal["shaking-force"]
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
    branch: Annotated[Literal[1, -1], NotBoolean()] = entry("1 or -1: slider right or left of the crank pin", default=1)
    drive: Turn = entry("how the crank turns", default=Turn())
    stock: LinkStock = entry("what the links are cut from", default=LinkStock())
    files: Files = entry("what is written", default=Files())

    def __post_init__(self) -> None:
        check_sizes(self)
        self.drive.check_rows()
        if self.linkage.driver != "crank":
            raise DesignError(
                "linkage.driver", f"found {self.linkage.driver}", "give crank: the force is over its turn"
            )

    @cached_property
    def motion(self) -> Motion:
        return move(self.linkage, self.drive.frames, self.branch, self.drive.speed)

    @cached_property
    def fine_motion(self) -> Motion:
        """In steps in which nothing slips through between two plates."""
        return move(self.linkage, self.drive.fine, self.branch, self.drive.speed)

    @cached_property
    def stack(self) -> Stack:
        return stack_links(self.fine_motion, self.stock)

    @cached_property
    def best(self) -> Counterbalance:
        """The counterbalance along the crank that makes the largest force least."""
        return best_counterbalance(self.linkage, self.masses, self.branch)

    @property
    def largest(self) -> dict[str, float]:
        """Largest force over the turn, N, with none, the given and the best counterbalance."""
        judged = {
            "none": judged_counterbalance(self.linkage, self.masses, 0.0, self.branch),
            "given": judged_counterbalance(self.linkage, self.masses, self.counterbalance, self.branch),
            "best": self.best,
        }
        return {name: c.largest * self.drive.speed**2 for name, c in judged.items()}


def _table(recipe: ShakingForceRecipe) -> Table:
    motion = recipe.motion
    columns = [
        Column("crank_angle", "deg", "angle of the crank from the ground line", np.degrees(motion.drive)),
        Column("time", "s", "time at the recipe's speed", (motion.drive - motion.drive[0]) / recipe.drive.speed),
    ]
    for name, product in (("none", 0.0), ("given", recipe.counterbalance), ("best", recipe.best.product)):
        force = shaking_force(motion, recipe.masses, product)
        columns += xy_columns(f"force_{name}", "N", f"shaking force, counterbalance: {name}", force)
        columns.append(Column(f"force_{name}", "N", f"its size, counterbalance: {name}", np.abs(force)))
    return Table(tuple(columns))


def _checks(recipe: ShakingForceRecipe) -> list[Check]:
    largest = recipe.largest
    # Where the best leaves nothing, the rest is rounding, and so would be a quotient by it.
    least = max(largest["best"], ROUNDING * max(largest.values()))
    return [
        Check("share of the crank's turn reached", 100 * recipe.motion.closed.mean(), "at least", 100, "%"),
        Check(
            "largest force, given to best counterbalance", max(largest["given"], least) / least if least > 0 else 1.0,
            "at most", 1.05, "",
            f"give counterbalance = {recipe.best.product.real + 0.0:.6g}",
        ),
        Check("plates and pins that collide", len(recipe.stack.collisions), "at most", 0, "", "see summary.json"),
        *recipe.drive.checks,
    ]  # fmt: skip


def _parts(recipe: ShakingForceRecipe) -> list[Part]:
    return [*link_parts(recipe.fine_motion, recipe.stock, recipe.stack), *_counterweight(recipe)]


def _counterweight(recipe: ShakingForceRecipe) -> list[Part]:
    """An eccentric disc with the best product: its shaft hole at half its radius, opposite the crank pin."""
    product = recipe.best.product.real
    if product <= 0:
        return []
    stock, hole = recipe.stock, recipe.stock.hole_diameter / 2
    # The hole lies on the shaft and takes nothing from the product: density thickness pi r^2 times r / 2.
    radius = float((2 * product / (np.pi * recipe.weight_density * 1e-9 * stock.thickness)) ** (1 / 3))
    if radius <= 4 * hole:
        return []
    holes = (Circle(0j, hole), Circle(complex(-radius), hole))
    return [Part("counterweight", Circle(complex(-radius / 2), radius), holes, stock.thickness)]


def _notes(recipe: ShakingForceRecipe) -> dict[str, Any]:
    return {
        "best_counterbalance_kg_mm": float(f"{recipe.best.product.real:.9g}"),
        "largest_force_N": {name: float(f"{force:.9g}") for name, force in recipe.largest.items()},
        "stack": recipe.stack.summary(),
    }


KINDS = {"shaking-force": Kind(ShakingForceRecipe, _table, _checks, _parts, _notes)}
