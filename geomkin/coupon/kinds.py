"""Recipe of a fit test."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import Literal

from ..core.fields import entry
from ..core.records import record
from ..core.units import UNITS, Sentence, mm
from ..making.materials import MATERIALS, MaterialKey, material_entry
from ..model.check import Check
from ..model.part import Bought, Part
from ..model.scene import Scene
from ..model.table import Table
from ..recipe.recipe import AbstractRecipe, assembly_summary
from ..recipe.settings import Files
from ..recipe.toml import toml_key
from .parts import GAUGE_WIDTH, FitTest, fit_test_parts, fit_test_scene

# How much smaller than the pin the smallest hole should be, mm: a kerf of 0.2 and an interference of 0.1, chosen here.
# With less, a laser may leave every hole loose.
LEAST_RANGE = 0.3


@record(checked=True, kw_only=True)
class FitTestRecipe(AbstractRecipe):
    """A coupon with stepped holes and slots, and a gauge, which show the kerf and fits of machine and material."""

    kind: Literal["fit-test"] = "fit-test"
    openings: FitTest
    material: MaterialKey | None = material_entry("the sheet or print")
    files: Files = entry("what is written; leave kerf at 0 to measure it", default=Files())

    @property
    def design(self) -> FitTest:
        return self.openings

    @cached_property
    def table(self) -> Table:
        return self.openings.table

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        return fit_test_parts(self.openings, self.material, self.units)

    @property
    def bought(self) -> tuple[Bought, ...]:
        return (Bought(f"pin or shaft {mm(self.openings.pin):g}, to try", 1, ("coupon",)),)

    @property
    def steps(self) -> tuple[str, ...]:
        """How to measure the coupon."""
        gauge = f"{mm(GAUGE_WIDTH + self.files.kerf):g}"
        return (
            f"measure the width of the gauge: the kerf is {gauge} minus this width",
            "push the pin into the holes from the left: note the largest that it must be pressed into, and the "
            "first in which it turns freely",
            "push the end of the gauge, upright, into the slots from the left: note the first that holds it",
            "fill in the workshop file, and name it in your recipes",
        )

    @property
    def workshop_file(self) -> tuple[str, ...]:
        """Lines of a workshop file whose values, each a `?`, are to be filled in from the measurements."""
        known = next((name for name, material in MATERIALS.items() if material == self.material), None)
        name = known or (self.material.name if self.material else "the material of your recipes")
        lengths = (GAUGE_WIDTH + self.files.kerf, self.openings.pin, self.files.kerf)
        gauge, pin, compensated = (f"{UNITS[self.units].of(length):g}" for length in lengths)
        # Holes are drawn narrower by the kerf that is compensated already.
        kerf = f"(kerf - {compensated})" if self.files.kerf else "kerf"
        return (
            *([] if self.units == "mm" else [f'units = "{self.units}"']),
            f"[{toml_key(name)}]",
            f"kerf = ?          # {gauge} - width of the gauge",
            f"clearance = ?     # first hole in which the pin turns freely - {pin} + {kerf}",
            f"interference = ?  # {pin} - largest hole that grips the pin - {kerf}",
        )

    @property
    def facts(self) -> tuple[str, ...]:
        return self.workshop_file

    @property
    def design_checks(self) -> tuple[Check, ...]:
        advice = "give a larger step or count; otherwise all holes may be loose"
        name = "smallest hole, less than the pin by"
        return (Check("range_below", name, -float(self.openings.offsets[0]), "at least", LEAST_RANGE, "mm", advice),)

    @cached_property
    def scene(self) -> Scene:
        """The coupon and the gauge, with a circle of the pin's size passing over the holes."""
        return fit_test_scene(self.openings, self.parts)

    @property
    def quantities(self) -> Mapping[str, str]:
        holes, slots = self.openings.hole_diameters, self.openings.slot_widths
        return {
            "holes": Sentence(f"{mm(holes[0], holes[-1], between=' to '):g}"),
            "slots": Sentence(f"{mm(slots[0], slots[-1], between=' to '):g}"),
        }

    @property
    def notes(self) -> Mapping[str, object]:
        return {"gauge_width_mm": GAUGE_WIDTH, "workshop_file": list(self.workshop_file), **assembly_summary(self)}
