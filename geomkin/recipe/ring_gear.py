"""Recipe of a ring gear."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from ..check import Check
from ..gear.ring import RingGear
from ..part import Part
from ..plane.derived import Reversed
from ..shop.gears import RingStock, ring_part
from ..sizes import entry
from ..table import Table
from .kind import Kind
from .settings import Files
from .spur_gear import gear_notes, tip_check, tooth_table
from .tooth_points import check_tooth_points


@dataclass(frozen=True)
class RingGearRecipe:
    """An internal gear as its pinion cutter leaves it: ring plate and tooth coordinates."""

    kind: Literal["ring-gear"]
    gear: RingGear
    stock: RingStock = entry("what the ring is cut from", default=RingStock())
    files: Files = entry("what is written", default=Files())


def _table(recipe: RingGearRecipe) -> Table:
    """One side of a tooth from tip to root, outwards."""
    gear = recipe.gear
    sides = {"involute": Reversed(gear.flank), "root": Reversed(gear.root_curve)}
    return tooth_table(sides, recipe.files.tolerance)


def ring_checks(gear: RingGear, stock: RingStock, name: str = "") -> list[Check]:
    """Tip and what holds the teeth of one ring, called by its `name`."""
    before = f"{name} " if name else ""
    rim = stock.rim / gear.module
    return [
        tip_check(gear, before),
        Check(f"{before}rim outside the teeth", rim, "at least", 1, "modules", "give a thicker rim"),
    ]


def _checks(recipe: RingGearRecipe) -> list[Check]:
    return ring_checks(recipe.gear, recipe.stock)


def _parts(recipe: RingGearRecipe) -> list[Part]:
    """The ring."""
    check_tooth_points(recipe.files, [], [recipe.gear.outline])
    return [ring_part(recipe.gear, recipe.stock)]


def _notes(recipe: RingGearRecipe) -> dict[str, Any]:
    return {"measures_mm": gear_notes(recipe.gear)}


KINDS = {"ring-gear": Kind(RingGearRecipe, _table, _checks, _parts, _notes)}
