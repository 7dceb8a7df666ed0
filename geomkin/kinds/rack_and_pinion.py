"""Recipe of a pinion on a rack."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

from ..check import Check
from ..gear.measures import contact_table
from ..gear.rack import GearRack, RackPair
from ..gear.spur import SpurGear
from ..judge.gear import gear_checks, mesh_checks
from ..part import Part
from ..recipe.settings import Files
from ..scene import Scene
from ..scenes.gear import pair_scene
from ..shop.assembling import Assembly
from ..shop.base import RackBaseStock
from ..shop.gear.assemblies import rack_assembly
from ..shop.gear.bases import rack_base
from ..shop.gear.gears import GearStock, gear_parts
from ..sizes import entry, quantity
from ..table import Table
from .gear_recipes import AbstractHelicalRecipe, check_tooth_points, gear_notes, helices_notes, overlap_notes, shown


@dataclass(frozen=True, kw_only=True)
class RackAndPinionRecipe(AbstractHelicalRecipe):
    """A pinion and the rack it drives."""

    kind: Literal["rack-and-pinion"] = "rack-and-pinion"
    pinion: SpurGear = entry("the driving gear", example=SpurGear(20, 2))
    rack: GearRack = entry("the rack", example=GearRack(12, 2))
    distance: float | None = quantity(
        "distance of the pinion's axis from the rack's reference line; left out, the one without backlash",
        "mm",
        default=None,
        above=0,
        at_most=1e9,
    )
    stock: GearStock = entry("what both are cut from", default=GearStock())
    base: RackBaseStock | None = entry("a base plate that guides the rack; left out, none", default=None)
    files: Files = entry("what is written", default=Files())

    def __post_init__(self) -> None:
        super().__post_init__()
        self.design  # noqa: B018  refuses gears that cannot mesh

    @cached_property
    def design(self) -> RackPair:
        """Both in mesh."""
        given = (self.pinion, self.rack)
        return RackPair(*given) if self.distance is None else RackPair(*given, self.distance)

    @cached_property
    def table(self) -> Table:
        return contact_table(self.design)

    @property
    def judged(self) -> tuple[Check, ...]:
        own = gear_checks(self.pinion, self.stock.rim_under(self.pinion), "pinion")
        return (*mesh_checks(self.design), *own)

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        check_tooth_points(self.files, [self.pinion.outline])
        (pinion,) = gear_parts(self.pinion, self.stock, "pinion", helix=self.helix)
        (rack,) = gear_parts(self.rack, self.stock, "rack", helix=self.helix)
        if self.base is None:
            return pinion, rack, *self.stock.motor_parts
        held = rack_base(self.design, rack, self.stock.bore, self.base, motor=self.stock.motor)
        return replace(pinion, hole_names=("A",)), *held

    @cached_property
    def assembly(self) -> Assembly:
        """The pinion's shaft, the rack's pins, what the base takes, and how all of it goes together."""
        return rack_assembly(self.stock, self.design.distance, self.base, self.helix)

    @cached_property
    def scene(self) -> Scene:
        """Both in mesh."""
        return pair_scene(self.design, self.parts)

    @classmethod
    def fit(cls, asked: Mapping[str, str]) -> Mapping[str, object]:
        """A shaft, and pins that leave a thin rack its walls, where a base is asked for."""
        if "base" not in asked:
            return {}
        return {"stock.bore": 8.0, "stock.thickness": 4.0, "base": RackBaseStock(guide_pin=3.0)}

    @property
    def notes(self) -> Mapping[str, object]:
        pair, width = self.design, self.stock.thickness
        mesh = {
            "distance_mm": shown(pair.distance),
            "travel_per_turn_mm": shown(pair.travel),
            "contact_ratio": shown(pair.contact_ratio),
            **overlap_notes(pair.contact_ratio, pair.module, self.helix, width),
            "backlash_mm": round(pair.backlash, 9) + 0.0,
            "clearances_mm": [shown(c) for c in pair.clearances],
            "interferences": list(pair.interferences),
        }
        sizes = {"pinion": (self.pinion, self.helix, width)}
        measures = {"pinion": gear_notes(*sizes["pinion"])}
        return {"pair": mesh, **helices_notes(sizes), "measures_mm": measures, **self.joined}
