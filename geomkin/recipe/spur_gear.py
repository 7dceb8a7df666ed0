"""Recipe of a spur gear."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..check import Check
from ..gear.spur import SpurGear
from ..part import Part
from ..plane.flatten import flatten
from ..shop.gears import GearStock, gear_parts
from ..sizes import entry
from ..table import Column, Table, xy_columns
from .kind import Kind
from .settings import Files


@dataclass(frozen=True)
class SpurGearRecipe:
    """A spur gear with the root curve its rack leaves: gear plate and tooth coordinates."""

    kind: Literal["spur-gear"]
    gear: SpurGear
    stock: GearStock = entry("what the gear is cut from", default=GearStock())
    files: Files = entry("what is written", default=Files())


def _table(recipe: SpurGearRecipe) -> Table:
    """One side of a tooth from root to tip, as finely as the tolerance asks."""
    curves = {"root": recipe.gear.root_curve, "involute": recipe.gear.flank}
    sides = [flatten(curve, recipe.files.tolerance) for curve in curves.values()]
    sides[1] = sides[1][1:]  # the two curves share a point
    z = np.concatenate(sides)
    region = np.repeat(list(curves), [len(side) for side in sides])
    return Table(
        (
            Column("radius", "mm", "distance from the gear's axis", np.abs(z)),
            *xy_columns("tooth", "mm", "right-hand side of the tooth centred on +y", z),
            Column(
                "half_thickness_angle",
                "deg",
                "angle from the tooth's centre line",
                np.degrees(np.arctan2(z.real, z.imag)),
            ),
            Column("region", "", "curve the point lies on", region),
        )
    )


def _checks(recipe: SpurGearRecipe) -> list[Check]:
    """Tip, undercut and what holds the teeth."""
    gear = recipe.gear
    lost = max(0.0, gear.form_radius - gear.base_radius) / gear.module if gear.is_undercut else 0.0
    rim = gear.root_radius - recipe.stock.bore / 2
    return [
        Check("tip thickness", gear.tip_thickness / gear.module, "at least", 0.2, "modules", "give less profile_shift"),
        Check("involute lost to undercut", lost, "at most", 0, "modules", "give more teeth or profile_shift"),
        Check("rim under the teeth", rim / gear.module, "at least", 1, "modules", "give a smaller bore"),
    ]


def _parts(recipe: SpurGearRecipe) -> list[Part]:
    """The gear."""
    return gear_parts(recipe.gear, recipe.stock)


KINDS = {"spur-gear": Kind(SpurGearRecipe, _table, _checks, _parts)}
