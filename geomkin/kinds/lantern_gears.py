"""Recipe of a lantern pinion and its wheel."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

from ..check import Check
from ..gear.conjugate.lantern import LanternPinion
from ..gear.conjugate.tables import pin_table
from ..judge.gear import conjugate_checks
from ..part import Part
from ..recipe.settings import Files
from ..shop.gear.conjugates import LanternStock, lantern_parts
from ..sizes import entry
from ..table import Table
from .conjugate_gears import AbstractShapedRecipe, Mate


@dataclass(frozen=True, kw_only=True)
class LanternGearsRecipe(AbstractShapedRecipe):
    """A lantern pinion, round pins between two discs, and the wheel whose teeth the pins shape."""

    kind: Literal["lantern-gears"] = "lantern-gears"
    pinion: LanternPinion
    # Pins stay in contact for a pitch only on long teeth.
    mate: Mate = entry("the wheel", example=Mate(48, 7.5))
    stock: LanternStock = entry("what discs and wheel are cut from", default=LanternStock())
    files: Files = entry("what is written", default=Files())

    @property
    def shaper(self) -> LanternPinion:
        return self.pinion

    @property
    def shaper_teeth(self) -> int:
        return self.pinion.pins

    @property
    def own_quarters(self) -> int:
        """Quarters of a pin's right-hand side that touch: the outer one, which some rings need, is not drawn out."""
        return 1 if self.mate.clearance else 2

    @cached_property
    def table(self) -> Table:
        """The pin's right-hand side, as far as its cutter is the pin itself: the quarter drawn out touches nothing."""
        return pin_table(self.design, self.own_quarters, self.mate.backlash)

    @property
    def judged(self) -> tuple[Check, ...]:
        longer = ", or mate.clearance = 0" if self.mate.internal and self.mate.clearance else ""
        return conjugate_checks(self.design, self.pinion.module, self.own_quarters, longer)

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        self.check_points([])
        return tuple(lantern_parts(self.pinion, self.design, self.stock))
