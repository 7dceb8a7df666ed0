"""The recipe of a ring gear."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

from ..check import Check
from ..gear.measures import tooth_table
from ..gear.ring import RingGear
from ..judge.gear import gear_checks
from ..part import Part
from ..recipe.settings import Files
from ..scene import Scene
from ..scenes.gear import gear_scene
from ..shop.assembling import Assembly
from ..shop.gear.gears import RingStock, gear_parts
from ..sizes import entry
from ..table import Table
from .gear_recipes import AbstractHelicalRecipe, check_tooth_points, gear_notes, helix_notes


@dataclass(frozen=True, kw_only=True)
class RingGearRecipe(AbstractHelicalRecipe):
    """An internal gear as its pinion cutter leaves it: ring plate and tooth coordinates."""

    kind: Literal["ring-gear"] = "ring-gear"
    gear: RingGear
    stock: RingStock = entry("what the ring is cut from", default=RingStock())
    files: Files = entry("what is written", default=Files())

    @property
    def design(self) -> RingGear:
        return self.gear

    @cached_property
    def table(self) -> Table:
        return tooth_table(self.gear, self.files.tolerance)

    @property
    def judged(self) -> tuple[Check, ...]:
        return gear_checks(self.gear, self.stock.rim)

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        check_tooth_points(self.files, [], [self.gear.outline])
        return gear_parts(self.gear, self.stock, "ring", helix=self.helix)

    @property
    def assembly(self) -> Assembly:
        """Of nothing: the ring is all there is."""
        return Assembly((), ())

    @cached_property
    def scene(self) -> Scene:
        """The ring round the pinion that cuts it."""
        return gear_scene(self.gear, self.parts)

    @property
    def notes(self) -> Mapping[str, object]:
        measures = gear_notes(self.gear, self.helix, self.stock.thickness)
        return {**helix_notes(self.gear, self.helix, self.stock.thickness), "measures_mm": measures}
