"""Recipes of two gears in mesh: spur gears, and a pinion on a rack."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Literal

import numpy as np

from ..check import Check
from ..gear.gear_rack import GearRack
from ..gear.pair import GearPair
from ..gear.rack_pair import RackPair
from ..gear.shifts import balanced_shifts, undercut_free_shift
from ..gear.spur import SpurGear
from ..part import Part
from ..shop.gears import GearStock, base_plate, gear_parts, rack_part
from ..sizes import entry, quantity
from ..table import Column, Table
from .kind import Kind
from .settings import Files
from .spur_gear import gear_checks, gear_notes, shown

# Places along the path of contact that a table tells of: enough to draw its curves.
ROWS = 101


@dataclass(frozen=True)
class GearPairRecipe:
    """Two spur gears at their centre distance: both gears, and a plate with holes for their shafts."""

    kind: Literal["gear-pair"]
    first: SpurGear = entry("the driving gear", example=SpurGear(12, 3, 0.6))
    second: SpurGear = entry("the driven gear", example=SpurGear(24, 3, 0.36))
    shifts: Literal["given", "avoid-undercut", "balance-sliding"] = entry(
        "profile shifts as given, the least that avoid undercut, or of the given sum such that both slide alike",
        default="given",
    )
    centre_distance: float = quantity(
        "distance of the axes; left out, the one without backlash", "mm", default=None, above=0, at_most=1e9
    )
    first_stock: GearStock = entry("what the driving gear is cut from", default=GearStock())
    second_stock: GearStock = entry("what the driven gear is cut from", default=GearStock())
    files: Files = entry("what is written", default=Files())

    def __post_init__(self) -> None:
        self.pair  # refuses gears that cannot mesh

    @cached_property
    def pair(self) -> GearPair:
        """The gears with the shifts that were asked for, in mesh."""
        one, two = self.first, self.second
        if self.shifts == "avoid-undercut":
            shifts = tuple(undercut_free_shift(g.teeth, g.rack) for g in (one, two))
        elif self.shifts == "balance-sliding":
            shifts = balanced_shifts(one.teeth, two.teeth, one.rack, one.profile_shift + two.profile_shift)
        else:
            shifts = one.profile_shift, two.profile_shift
        one, two = (replace(g, profile_shift=x) for g, x in zip((one, two), shifts))
        return GearPair(one, two, self.centre_distance)

    @property
    def gears(self) -> tuple[tuple[str, SpurGear, GearStock], ...]:
        """Both gears as they are cut: name, gear and stock."""
        pair = self.pair
        assert isinstance(pair.second, SpurGear)
        return ("first", pair.first, self.first_stock), ("second", pair.second, self.second_stock)


@dataclass(frozen=True)
class RackAndPinionRecipe:
    """A pinion and the rack it drives."""

    kind: Literal["rack-and-pinion"]
    pinion: SpurGear = entry("the driving gear", example=SpurGear(20, 2))
    rack: GearRack = entry("the rack", example=GearRack(12, 2))
    distance: float = quantity(
        "distance of the pinion's axis from the rack's reference line; left out, the one without backlash",
        "mm",
        default=None,
        above=0,
        at_most=1e9,
    )
    stock: GearStock = entry("what both are cut from", default=GearStock())
    files: Files = entry("what is written", default=Files())

    def __post_init__(self) -> None:
        self.pair  # refuses gears that cannot mesh

    @cached_property
    def pair(self) -> RackPair:
        """Both in mesh."""
        return RackPair(self.pinion, self.rack, self.distance)


def contact_table(pair: GearPair | RackPair, gear: SpurGear, names: tuple[str, str]) -> Table:
    """Contact of one pair of flanks from its beginning to its end, sliding included."""
    start, end = pair.contact_lengths
    along = np.linspace(start, end, ROWS)
    turn = np.degrees((along - np.sqrt(gear.pitch_radius**2 - gear.base_radius**2)) / gear.base_radius)
    first, second = pair.sliding(along)
    pitch = 2 * np.pi * gear.base_radius / gear.teeth
    # Other pairs of flanks are whole base pitches away.
    other = along[:, None] + pitch * np.arange(-9, 10)
    count = ((other >= start - 1e-9) & (other <= end + 1e-9)).sum(axis=1)
    return Table(
        (
            Column(
                f"{names[0]}_turn", "deg", "turn since its pitch circle's flank point was on the line of action", turn
            ),
            Column("along", "mm", f"place on the line of action, from the base circle of the {names[0]}", along),
            Column(f"{names[0]}_radius", "mm", "radius of the contact", np.hypot(gear.base_radius, along)),
            Column(f"{names[0]}_sliding", "", "specific sliding", first),
            Column(f"{names[1]}_sliding", "", "specific sliding", second),
            Column("pairs", "", "pairs of flanks in contact", count),
        )
    )


def mesh_checks(pair: GearPair | RackPair) -> list[Check]:
    """Contact, clearance and interference."""
    module = pair.pinion.module if isinstance(pair, RackPair) else pair.first.module
    clear = min(pair.clearances) / module
    return [
        Check("contact ratio", pair.contact_ratio, "at least", 1.1, "", "give more teeth, less shift or no undercut"),
        Check("clearance of tips from roots", clear, "at least", 0.1, "modules", "give a smaller addendum"),
        Check(
            "interferences",
            len(pair.interferences),
            "at most",
            0,
            "",
            f"at {', '.join(pair.interferences)}: cut the tips",
        ),
    ]


def mesh_notes(pair: GearPair) -> dict[str, Any]:
    """What two gears do together."""
    start, end = pair.contact_lengths
    return {
        "centre_distance_mm": shown(pair.centre_distance),
        "working_pressure_angle_deg": shown(np.degrees(pair.working_pressure_angle)),
        "contact_ratio": shown(pair.contact_ratio),
        "backlash_mm": round(pair.backlash, 9) + 0.0,
        "clearances_mm": [shown(c) for c in pair.clearances],
        "largest_specific_sliding": [shown(float(pair.sliding(start)[0])), shown(float(pair.sliding(end)[1]))],
        "interferences": list(pair.interferences),
    }


def _pair_table(recipe: GearPairRecipe) -> Table:
    return contact_table(recipe.pair, recipe.pair.first, ("first", "second"))


def _pair_checks(recipe: GearPairRecipe) -> list[Check]:
    own = [check for name, gear, stock in recipe.gears for check in gear_checks(gear, stock, name)]
    return [*mesh_checks(recipe.pair), *own]


def _pair_parts(recipe: GearPairRecipe) -> list[Part]:
    parts = [part for name, gear, stock in recipe.gears for part in gear_parts(gear, stock, name, f"{name}_stock")]
    holes = [recipe.first_stock.hole_diameter, recipe.second_stock.hole_diameter]
    if all(holes):
        # As much plate around a hole as the hole is wide.
        axes = [0j, complex(recipe.pair.centre_distance)]
        parts.append(base_plate("base", axes, holes, max(holes), recipe.first_stock.thickness))
    return parts


def _pair_notes(recipe: GearPairRecipe) -> dict[str, Any]:
    measures = {name: gear_notes(gear) for name, gear, _ in recipe.gears}
    return {"pair": mesh_notes(recipe.pair), "measures_mm": measures}


def _rack_table(recipe: RackAndPinionRecipe) -> Table:
    return contact_table(recipe.pair, recipe.pinion, ("pinion", "rack"))


def _rack_checks(recipe: RackAndPinionRecipe) -> list[Check]:
    return [*mesh_checks(recipe.pair), *gear_checks(recipe.pinion, recipe.stock, "pinion")]


def _rack_parts(recipe: RackAndPinionRecipe) -> list[Part]:
    return [*gear_parts(recipe.pinion, recipe.stock, "pinion"), rack_part(recipe.rack, recipe.stock.thickness)]


def _rack_notes(recipe: RackAndPinionRecipe) -> dict[str, Any]:
    pair = recipe.pair
    return {
        "pair": {
            "distance_mm": shown(pair.distance),
            "travel_per_turn_mm": shown(pair.travel),
            "contact_ratio": shown(pair.contact_ratio),
            "backlash_mm": round(pair.backlash, 9) + 0.0,
            "clearances_mm": [shown(c) for c in pair.clearances],
            "interferences": list(pair.interferences),
        },
        "measures_mm": {"pinion": gear_notes(recipe.pinion)},
    }


KINDS = {
    "gear-pair": Kind(GearPairRecipe, _pair_table, _pair_checks, _pair_parts, _pair_notes),
    "rack-and-pinion": Kind(RackAndPinionRecipe, _rack_table, _rack_checks, _rack_parts, _rack_notes),
}
