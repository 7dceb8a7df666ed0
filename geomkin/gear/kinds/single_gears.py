"""Recipes of one gear: a spur gear, and a ring gear."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from typing import Literal

from ...core.fields import entry
from ...core.records import record
from ...making.assembly import Assembly
from ...model.check import Check
from ...model.part import Part
from ...model.scene import Scene
from ...model.table import Table
from ...recipe.settings import Files
from ..checks import gear_checks
from ..cutters import undercut_free_shift
from ..measures import tooth_table
from ..parts.assemblies import single_assembly
from ..parts.gears import GearStock, RingStock, gear_parts
from ..ring import RingGear
from ..scene import gear_scene
from ..spur import SpurGear
from .helical import AbstractHelicalRecipe, check_tooth_points, gear_notes, helix_notes


@record(kw_only=True)
class SpurGearRecipe(AbstractHelicalRecipe):
    """A spur gear with the root curve its rack leaves: gear plate and tooth coordinates."""

    kind: Literal["spur-gear"] = "spur-gear"
    gear: SpurGear
    shift: Literal["given", "avoid-undercut"] = entry(
        "the gear's profile_shift as given, or the least that avoids undercut", default="given"
    )
    stock: GearStock = entry("what the gear is cut from", default=GearStock())
    files: Files = entry("what is written", default=Files())

    @cached_property
    def design(self) -> SpurGear:
        """The gear with the shift that was asked for."""
        with self.naming_section():
            gear = self.in_section(self.gear)
            if self.shift == "given":
                return gear
            return replace(gear, profile_shift=undercut_free_shift(gear.teeth, gear.rack))

    @cached_property
    def table(self) -> Table:
        return tooth_table(self.design, self.files.tolerance)

    @property
    def design_checks(self) -> tuple[Check, ...]:
        return gear_checks(self.design, self.stock.rim_under(self.design))

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        check_tooth_points(self.files, [self.design.outline])
        return *gear_parts(self.design, self.stock, helix=self.helix), *self.stock.motor_parts

    @cached_property
    def assembly(self) -> Assembly:
        """The gear's shaft and what holds it there."""
        return single_assembly("gear", self.stock)

    @cached_property
    def scene(self) -> Scene:
        """The gear under the rack that cuts it."""
        return gear_scene(self.design, self.parts)

    @property
    def notes(self) -> Mapping[str, object]:
        measures = gear_notes(self.design, self.helix, self.stock.thickness)
        helix = helix_notes(self.design, self.helix, self.stock.thickness)
        return {**helix, "measures_mm": measures, **self.assembly_summary}


@record(kw_only=True)
class RingGearRecipe(AbstractHelicalRecipe):
    """An internal gear as its pinion cutter leaves it: ring plate and tooth coordinates."""

    kind: Literal["ring-gear"] = "ring-gear"
    gear: RingGear
    stock: RingStock = entry("what the ring is cut from", default=RingStock())
    files: Files = entry("what is written", default=Files())

    @cached_property
    def design(self) -> RingGear:
        """The gear's transverse section."""
        with self.naming_section():
            return self.in_section(self.gear)

    @cached_property
    def table(self) -> Table:
        return tooth_table(self.design, self.files.tolerance)

    @property
    def design_checks(self) -> tuple[Check, ...]:
        return gear_checks(self.design, self.stock.rim)

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        check_tooth_points(self.files, [], [self.design.outline])
        return gear_parts(self.design, self.stock, "ring", helix=self.helix)

    @property
    def assembly(self) -> Assembly:
        """Of nothing: the ring is all there is."""
        return Assembly((), ())

    @cached_property
    def scene(self) -> Scene:
        """The ring round the pinion that cuts it."""
        return gear_scene(self.design, self.parts)

    @property
    def notes(self) -> Mapping[str, object]:
        measures = gear_notes(self.design, self.helix, self.stock.thickness)
        return {**helix_notes(self.design, self.helix, self.stock.thickness), "measures_mm": measures}
