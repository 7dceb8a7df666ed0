"""Recipes of gears with teeth of any form, or with round pins, and of the mates that they generate."""

from __future__ import annotations

import dataclasses
from abc import abstractmethod
from collections.abc import Mapping
from functools import cached_property
from typing import Literal

import numpy as np

from ...core.errors import DesignError
from ...core.fields import FARTHEST, entry, inside, quantity, to_digits
from ...core.records import record
from ...core.units import bare_mm, mm
from ...making.assembly import PLAY, Assembly, BaseStock
from ...making.attachments import Attachment
from ...making.materials import STEEL_DENSITY
from ...model.check import Check
from ...model.material import Mass
from ...model.part import Part
from ...model.scene import Scene, SceneHandle
from ...model.table import Table
from ...plane.curve import AbstractCurve
from ...recipe.recipe import AbstractAssembledRecipe, assembly_summary, part_masses
from ...recipe.settings import Files
from ..checks import conjugate_checks, touch_check
from ..conjugate.conjugate import Conjugate, conjugate, flank_table, pin_table
from ..conjugate.parametric_gear import ParametricToothGear
from ..conjugate.shaping_gears import AbstractFlankGear, LanternPinion, PointToothGear, StraightSidedGear
from ..contract import AbstractShaper
from ..parts import LanternStock, PairStock, lantern_parts, pair_parts
from ..parts_assembly import Wheel, lantern_assembly, pair_assembly, pair_base
from ..scene_pairs import conjugate_handles, conjugate_scene
from .helical import backlash_remarks, boss_checks, check_tooth_points, least_backlash
from .loaded import NO_INVOLUTE


@record(checked=True)
class Mate:
    """The mate of a given gear."""

    teeth: int = quantity("number of the mate's teeth", whole=True, at_least=2, at_most=10_000, example=60)
    addendum: float = quantity(
        "height of the mate's teeth beyond its pitch circle", "mm", above=0, at_most=FARTHEST, example=2
    )
    internal: bool = entry("whether the mate is a ring round the gear", default=False)
    clearance: float = quantity(
        "clearance between the gear's tips and the mate's roots", "mm", default=0.5, at_least=0, at_most=FARTHEST
    )
    backlash: float = quantity(
        "backlash along the pitch circle, by which the mate's teeth are thinner", "mm",
        default=0.0, at_least=0, at_most=FARTHEST, printed=1.0,
    )  # fmt: skip


# Arguments of `conjugate` and of the cutters -> keys of the recipe.
KEYS = {"mate_teeth": "mate.teeth"} | {name: f"mate.{name}" for name in ("addendum", "clearance", "backlash")}


class AbstractShapedRecipe(AbstractAssembledRecipe):
    """Base class of recipes of a gear and the mate that its teeth generate."""

    mate: Mate
    stock: PairStock | LanternStock
    base: BaseStock | None

    @property
    @abstractmethod
    def shaper(self) -> AbstractShaper:
        """The gear that generates the mate."""

    @cached_property
    def design(self) -> Conjugate:
        """The generated mate."""
        return _mate(self.shaper, self.mate)

    @property
    def quantities(self) -> Mapping[str, str]:
        """Ratio and centre distance."""
        mate = self.design
        return {"ratio": f"{mate.teeth / mate.gear_teeth:.5g}", "centre distance": f"{mm(mate.distance):.6g}"}

    @property
    def notes(self) -> Mapping[str, object]:
        """Derived sizes, and the parts of the tooth that never touch, by their distance from the gear's axis."""
        mate = self.design
        least = least_backlash(mate.distance, 2 * mate.pitch_radius / mate.teeth)
        jams = f"teeth without backlash jam: give mate.backlash, about {mm(least):.2f}"
        return {
            "ratio": to_digits(mate.teeth / self.shaper.teeth * (1 if mate.is_ring else -1), 10),
            **({} if self.mate.backlash else {"backlash_advice": jams}),
            "centre_distance_mm": to_digits(mate.distance, 10),
            "never_touching": [
                {
                    "inner_radius_mm": to_digits(u.inner_radius, 7),
                    "outer_radius_mm": to_digits(u.outer_radius, 7),
                    "why": u.why,
                }
                for u in mate.untouched
                # The other side of the tooth is the mirror image.
                if u.start < 1
            ],
            **assembly_summary(self),
        }

    @property
    def remarks(self) -> tuple[str, ...]:
        return backlash_remarks(self.notes)

    @property
    def forces_missing(self) -> str:
        return NO_INVOLUTE

    def on_base(self, parts: tuple[Part, ...], reach: float) -> tuple[Part, ...]:
        """Gear and mate, and their base if there is one. reach: largest radius of the gear, mm."""
        if self.base is None:
            return *parts, *self.stock.motor_parts
        mate, stock = self.design, self.stock
        if mate.is_ring:
            raise DesignError("base", "found a base for a ring, which has no shaft", "omit base", "conflict")
        reaches, shafts = (reach, mate.tip_radius), (stock.bore, stock.mate_bore)
        keys = ("stock.bore", "stock.mate_bore")
        plate = pair_base(mate.distance, reaches, shafts, stock.thickness, self.base, keys, stock.motor, stock.material)
        return *(dataclasses.replace(part, hole_names=(letter,)) for part, letter in zip(parts, "AB")), plate

    def check_points(self, gears: list[AbstractCurve]) -> None:
        """Raise DesignError if the teeth of gears and mate have too many points."""
        mate = [self.design.outline]
        check_tooth_points(self.files, gears if self.design.is_ring else gears + mate, mate * self.design.is_ring)


def _mate(gear: AbstractShaper, wanted: Mate) -> Conjugate:
    if wanted.internal and wanted.teeth <= gear.teeth:
        raise DesignError("mate.teeth", f"found {wanted.teeth} for a ring", f"give more than the gear's {gear.teeth}")
    try:
        cutter = gear.cutter(wanted.clearance, wanted.backlash)
        return conjugate(cutter, gear.teeth, gear.pitch_radius, wanted.teeth, wanted.addendum, wanted.internal)
    except DesignError as error:
        most = _most_backlash(gear, wanted)
        if most < wanted.backlash:
            problem = f"found {mm(wanted.backlash):g}, for which the mate has no teeth"
            enough = inside(most, 1, 6)
            remedy = f"give at most {bare_mm(float(enough)):down6}"
            raise DesignError("mate.backlash", problem, remedy, value=enough) from None
        raise error.named(KEYS.get(error.field, error.field)) from None


def _most_backlash(gear: AbstractShaper, wanted: Mate) -> float:
    """Backlash for which the mate's tip lands vanish or its cutter's teeth meet, mm; inf if there is none."""
    if not wanted.backlash:
        return float("inf")
    mate = _mate(gear, dataclasses.replace(wanted, backlash=0.0))
    # Each side of a tooth is rotated as a whole.
    return min(gear.most_backlash, mate.tip_thickness * mate.pitch_radius / mate.tip_radius)


@record(kw_only=True)
class ToothedRecipe(AbstractShapedRecipe):
    """A gear with flanks of some form and the mate that they generate."""

    kind: str
    gear: AbstractFlankGear
    mate: Mate
    stock: PairStock = entry("sheet and bores of the gears", default=PairStock())
    base: BaseStock | None = entry("a base plate under both gears; none if omitted", default=None)
    files: Files = entry("formats and tolerance of the files", default=Files())

    @property
    def shaper(self) -> AbstractShaper:
        return self.gear

    @cached_property
    def table(self) -> Table:
        return flank_table(self.design, self.mate.backlash)

    @property
    def design_checks(self) -> tuple[Check, ...]:
        module = self.gear.module
        boss = boss_checks("gear", self.gear.root_radius, self.stock.motor, self.base)
        return (
            touch_check(self.design, module),
            *conjugate_checks(self.design, module),
            *boss,
            *self.engagement_checks,
        )

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        self.check_points([self.gear.outline])
        return self.on_base(pair_parts(self.gear, self.design, self.stock), self.gear.tip_radius)

    @cached_property
    def assembly(self) -> Assembly:
        stock, is_ring = self.stock, self.design.is_ring
        mate = Wheel("ring", "", None) if is_ring else Wheel("mate", "B", stock.mate)
        plate = None if self.base is None else stock.thickness
        return pair_assembly(Wheel("gear", "A", stock), mate, self.design.distance, plate, self.base)

    @cached_property
    def scene(self) -> Scene:
        """Both gears in mesh."""
        return conjugate_scene(self.design, self.table, self.parts)

    @property
    def handles(self) -> tuple[SceneHandle, ...]:
        return tuple(conjugate_handles(self.design, "gear", "teeth"))


@record(kw_only=True)
class StraightSidedGearsRecipe(ToothedRecipe):
    """A gear with straight-sided teeth and the mate that they generate, outside it or as a ring round it."""

    kind: Literal["straight-sided-gears"] = "straight-sided-gears"
    gear: StraightSidedGear


@record(kw_only=True)
class PointToothGearsRecipe(ToothedRecipe):
    """A gear with teeth through given points and the mate that they generate, outside it or as a ring round it."""

    kind: Literal["point-tooth-gears"] = "point-tooth-gears"
    gear: PointToothGear


@record(kw_only=True)
class ParametricToothGearsRecipe(ToothedRecipe):
    """A gear with teeth of a parametric curve and the mate that they generate, outside it or as a ring round it."""

    kind: Literal["parametric-tooth-gears"] = "parametric-tooth-gears"
    gear: ParametricToothGear


@record(kw_only=True)
class LanternGearsRecipe(AbstractShapedRecipe):
    """A lantern pinion, round pins between two discs, and the wheel whose teeth the pins generate."""

    kind: Literal["lantern-gears"] = "lantern-gears"
    pinion: LanternPinion
    # Only long teeth keep a pin in contact for one pitch.
    mate: Mate = entry("the wheel", example=Mate(48, 7.5))
    stock: LanternStock = entry("sheet and bores of discs and wheel", default=LanternStock())
    base: BaseStock | None = entry("a base plate under pinion and wheel; none if omitted", default=None)
    files: Files = entry("formats and tolerance of the files", default=Files())

    @property
    def shaper(self) -> LanternPinion:
        return self.pinion

    @property
    def own_quarters(self) -> int:
        """Quarters of the cutter's right-hand side that belong to the pin: with a clearance the outer one does not."""
        return 1 if self.mate.clearance else 2

    @cached_property
    def table(self) -> Table:
        """Contact along the pin's right-hand side, where the cutter coincides with the pin."""
        return pin_table(self.design, self.own_quarters, self.mate.backlash)

    @property
    def design_checks(self) -> tuple[Check, ...]:
        longer = ", or mate.clearance = 0" if self.mate.internal and self.mate.clearance else ""
        checks = conjugate_checks(self.design, self.pinion.module, self.own_quarters, longer)
        return (*checks, *self.engagement_checks)

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        self.check_points([])
        disc, wheel = lantern_parts(self.pinion, self.design, self.stock)
        return self.on_base((disc, wheel), float(np.abs(disc.outline.point(0.0))))

    @cached_property
    def body_masses(self) -> Mapping[str, Mass]:
        """Mass of the pinion, two discs and its steel pins, and of the wheel."""
        bodies = part_masses(self.parts)
        if disc := bodies.get("pinion"):
            stock, pinion = self.stock, self.pinion
            # A pin passes both discs and the wheel between them.
            length = 3 * stock.thickness + PLAY
            pin = np.pi / 4 * pinion.pin_diameter**2 * length * STEEL_DENSITY * 1e-9
            radius = float(abs(pinion.circles[0].centre))
            inertia = pinion.pins * pin * (radius**2 + pinion.pin_diameter**2 / 8)
            bodies["pinion"] = disc + disc + Mass(pinion.pins * pin, 0j, inertia)
        return bodies

    @cached_property
    def assembly(self) -> Assembly:
        pinion, mate = self.pinion, self.design
        return lantern_assembly(self.stock, pinion.pin_diameter, pinion.pins, mate.is_ring, mate.distance, self.base)

    @cached_property
    def scene(self) -> Scene:
        """Both in mesh, with the pins between the pinion's discs."""
        return conjugate_scene(self.design, self.table, self.parts, self.pinion.circles)

    @property
    def handles(self) -> tuple[SceneHandle, ...]:
        return tuple(conjugate_handles(self.design, "pinion", "pins"))

    @classmethod
    def example_values(cls, tables: Mapping[str, str]) -> Mapping[str, object]:
        """Screws that leave a wall round the wheel's bore, if something is attached to it."""
        key = "stock.mate_attachments"
        return {key: Attachment("hub with a set screw", bolts=3, bolt_circle=18.0)} if key in tables else {}
