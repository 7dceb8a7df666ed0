"""Recipe of a spur gear."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Literal

import numpy as np

from ..check import Check
from ..errors import DesignError
from ..gear.measures import base_pitch, chord, over_pins, span
from ..gear.ring import RingGear
from ..gear.shifts import undercut_free_shift
from ..gear.spur import SpurGear
from ..part import Part
from ..plane.curve import AbstractCurve
from ..plane.flatten import flatten
from ..shop.gears import GearStock, gear_parts
from ..sizes import entry
from ..table import Column, Table, xy_columns
from .kind import Kind
from .settings import Files
from .tooth_points import check_tooth_points


@dataclass(frozen=True)
class SpurGearRecipe:
    """A spur gear with the root curve its rack leaves: gear plate and tooth coordinates."""

    kind: Literal["spur-gear"]
    gear: SpurGear
    shift: Literal["given", "avoid-undercut"] = entry(
        "the gear's profile_shift as given, or the least that avoids undercut", default="given"
    )
    stock: GearStock = entry("what the gear is cut from", default=GearStock())
    files: Files = entry("what is written", default=Files())

    @cached_property
    def cut_gear(self) -> SpurGear:
        """The gear with the shift that was asked for."""
        if self.shift == "given":
            return self.gear
        return replace(self.gear, profile_shift=undercut_free_shift(self.gear.teeth, self.gear.rack))


def _table(recipe: SpurGearRecipe) -> Table:
    """One side of a tooth from root to tip."""
    gear = recipe.cut_gear
    curves = {"root": gear.root_curve, "involute": gear.flank}
    if gear.tip_edge:
        curves["tip"] = gear.tip_edge
    return tooth_table(curves, recipe.files.tolerance)


def tooth_table(curves: Mapping[str, AbstractCurve], tolerance: float) -> Table:
    """The right-hand side of the tooth on +y, outwards, as finely as the tolerance asks. curves: its own, by name."""
    sides = [flatten(curve, tolerance) for curve in curves.values()]
    sides[1:] = [side[1:] for side in sides[1:]]  # neighbouring curves share a point
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


def tip_check(gear: SpurGear | RingGear, before: str = "") -> Check:
    """Whether the tips are thick enough not to break; before: what the check's name begins with."""
    remedy = "give less profile_shift, addendum or thinning"
    return Check(f"{before}tip thickness", gear.tip_thickness / gear.module, "at least", 0.2, "modules", remedy)


def gear_checks(gear: SpurGear, stock: GearStock, name: str = "") -> list[Check]:
    """Tip, undercut and what holds the teeth of one gear, called by its `name`."""
    lost = max(0.0, gear.form_radius - gear.base_radius) / gear.module if gear.is_undercut else 0.0
    rim = gear.root_radius - stock.hole_reach if stock.web is None else stock.web.rim
    before = f"{name} " if name else ""
    return [
        tip_check(gear, before),
        Check(f"{before}involute lost to undercut", lost, "at most", 0, "modules", "give more teeth or profile_shift"),
        Check(f"{before}rim under the teeth", rim / gear.module, "at least", 1, "modules", "give a smaller bore"),
    ]


def shown(value: float) -> float:
    """A number with the digits that a summary carries."""
    return float(f"{value:.9g}")


def gear_notes(gear: SpurGear | RingGear) -> dict[str, Any]:
    """Radii and measures for the shop, mm; a measure that a gear does not have is left out."""
    notes: dict[str, Any] = {
        "profile_shift": shown(gear.profile_shift),
        "tip_radius": shown(gear.tip_radius),
        "form_radius": shown(gear.form_radius),
        "pitch_radius": shown(gear.pitch_radius),
        "base_radius": shown(gear.base_radius),
        "root_radius": shown(gear.root_radius),
        "base_pitch": shown(base_pitch(gear)),
    }
    try:
        pins = over_pins(gear)
        word = "between_pins" if isinstance(gear, RingGear) else "over_pins"
        notes[word] = {"pin_diameter": shown(pins.pin), "measure": shown(pins.diameter)}
    except DesignError:
        pass
    if isinstance(gear, RingGear):
        return notes
    if gear.is_undercut:
        notes["share_of_involute_lost"] = shown(gear.involute_lost)
    try:
        over = span(gear)
        notes["span"] = {"teeth": over.teeth, "measure": shown(over.length)}
        tooth = chord(gear)
        notes["chordal_thickness"] = {"thickness": shown(tooth.chord), "height": shown(tooth.height)}
    except DesignError:
        pass
    return notes


def _checks(recipe: SpurGearRecipe) -> list[Check]:
    return gear_checks(recipe.cut_gear, recipe.stock)


def _parts(recipe: SpurGearRecipe) -> list[Part]:
    """The gear."""
    check_tooth_points(recipe.files, [recipe.cut_gear.outline])
    return gear_parts(recipe.cut_gear, recipe.stock)


def _notes(recipe: SpurGearRecipe) -> dict[str, Any]:
    return {"measures_mm": gear_notes(recipe.cut_gear)}


KINDS = {"spur-gear": Kind(SpurGearRecipe, _table, _checks, _parts, _notes)}
