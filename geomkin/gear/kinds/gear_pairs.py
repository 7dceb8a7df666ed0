"""Recipes of pairs: two spur gears in mesh, a pinion in its ring, and a pinion on a rack."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np

from ...core.errors import DesignError
from ...core.fields import entry, quantity, to_digits
from ...core.records import record
from ...core.units import UNITS, mm
from ...making.assembly import Assembly, BaseStock, RackBaseStock
from ...making.fasteners import pin_parts
from ...making.materials import MATERIALS
from ...model.check import Check, WorkedFormula, WorkedFormulas
from ...model.motor import RotatingBody
from ...model.part import Part
from ...model.scene import Scene, SceneHandle
from ...model.table import Table
from ...plane.curve import AbstractCurve
from ...plane.vec import Real
from ...recipe.recipe import Additions, assembly_summary
from ...recipe.settings import Files
from ..checks import RackLoads, RackStrength, gear_checks, mesh_checks
from ..contract import AbstractInvoluteGear, Helix
from ..cutters import balanced_shifts, undercut_free_shift
from ..measures import contact_table
from ..pair import GearPair, InternalGearPair
from ..parts import GearStock, RingStock, base_plate, gear_parts
from ..parts_assembly import Wheel, pair_assembly, pair_base, rack_assembly, rack_base
from ..rack import GearRack, RackPair
from ..ring import RingGear
from ..scene_pairs import pair_handles, pair_scene, rack_handles, turned_pair_scene
from ..spur import SpurGear
from ..strength import GearLoads, PairStrength
from ..train import loss_factor
from .helical import (
    LEAST_EFFICIENCY,
    AbstractHelicalRecipe,
    Measuring,
    RingAdditions,
    Tips,
    backlash_notes,
    boss_checks,
    check_tooth_points,
    friction_entry,
    gear_quantities,
    measuring_entry,
    mesh_notes,
    on_ring,
    overlap_notes,
    pair_quantities,
    tips_entry,
)
from .loaded import (
    RACK_WITHOUT_LOADS,
    AbstractLoadedRecipe,
    LoadedMeshes,
    loaded_materials,
    pair_strength_notes,
    rack_strength_notes,
)


def _centre_distance() -> Any:
    meaning = "distance of the axes; if omitted, the one without backlash"
    return quantity(meaning, "mm", default=None, above=0, at_most=1e9)


def _loads(driver: str) -> Any:
    meaning = f"torque on the {driver}, for forces and strength; both stocks then name their material"
    return entry(meaning, default=None)


@record(kw_only=True)
class AbstractPairRecipe(AbstractHelicalRecipe, AbstractLoadedRecipe):
    """Base class of recipes of two gears in mesh."""

    # The pair; its `names` are the keys of the gears' tables, and of those of their stocks with _stock.
    pair: ClassVar[type[GearPair]] = GearPair
    if TYPE_CHECKING:
        # Declared for the type checker only, since the order of fields is that of their first declaration.
        centre_distance: float | None
        friction: float
        tips: Tips
        base: BaseStock | None
        loads: GearLoads | None
        files: Files

    def __post_init__(self) -> None:
        super().__post_init__()
        (first, _), (second, stock) = zip((f"{name}_stock" for name in self.pair.names), self.stocks)
        self.check_faces({first: self.stocks[0].thickness, second: stock.thickness})
        if isinstance(stock, GearStock) and stock.motor is not None:
            problem = "found a motor for the driven gear"
            raise DesignError(f"{second}.motor", problem, f"give {first}.motor instead", "conflict")
        self.design  # noqa: B018  raises for gears that cannot mesh
        for aspect in self.aspects:
            aspect.check()

    @property
    @abstractmethod
    def stocks(self) -> tuple[GearStock, GearStock | RingStock]:
        """Sheet and bore of both gears."""

    @abstractmethod
    def transverse_gears(self) -> tuple[SpurGear, SpurGear | RingGear]:
        """The transverse sections of both gears, with the requested profile shifts."""

    def loaded(self, loads: GearLoads) -> LoadedMeshes | None:
        materials = {f"{name}_stock": stock.material for name, stock in zip(self.pair.names, self.stocks)}
        first, second = loaded_materials(**materials)
        if self.helix_angle_deg:
            return None
        strength = PairStrength(self.design, loads.torque_n_mm, self.face_width, (first, second), loads)
        summary = pair_strength_notes(strength)
        return LoadedMeshes(strength, {"": strength}, strength.torque_limit, summary, strength.torque)

    @property
    def face_width(self) -> float:
        """Width of the faces in contact, mm."""
        return min(stock.thickness for stock in self.stocks)

    @cached_property
    def design(self) -> GearPair:
        """The gears in mesh, with the requested profile shifts and tips."""
        with self.naming_section():
            gears, distance = self.transverse_gears(), self.centre_distance
            pair = self.pair(*gears) if distance is None else self.pair(*gears, distance)
            return pair.with_full_clearance() if self.tips == "full-clearance" else pair

    @property
    def gears(self) -> tuple[tuple[str, AbstractInvoluteGear, GearStock | RingStock, Helix], ...]:
        """Both gears: name, gear, stock and helix."""
        pair, helix = self.design, self.helix
        helices = helix, helix if pair.is_internal else helix.mate
        return tuple(zip(pair.names, (pair.first, pair.second), self.stocks, helices))

    @property
    def own_table(self) -> Table:
        """Contact of one pair of flanks."""
        return contact_table(self.design)

    @property
    def own_checks(self) -> tuple[Check, ...]:
        gears = [c for name, gear, stock, _ in self.gears for c in gear_checks(gear, stock.rim_under(gear), name)]
        driver, radius = self.pair.names[0], self.design.first.root_radius
        return (*mesh_checks(self.design), *gears, *boss_checks(driver, radius, self.stocks[0].motor, self.base))

    @property
    def plates(self) -> list[Part]:
        """The plates of both gears."""
        wheels: tuple[list[AbstractCurve], list[AbstractCurve]] = ([], [])
        for _, gear, *_ in self.gears:
            wheels[gear.is_ring].append(gear.outline)
        check_tooth_points(self.files, *wheels)
        return [
            part
            for name, gear, stock, helix in self.gears
            for part in gear_parts(gear, stock, name, f"{name}_stock", helix=helix)
        ]

    @property
    def own_scene(self) -> Scene:
        """Both in mesh."""
        return pair_scene(self.design, self.parts)

    @property
    def rotating_bodies(self) -> Mapping[str, RotatingBody]:
        """Both gears."""
        pair = self.design
        side = 1 if pair.is_internal else -1
        speeds = Fraction(1), Fraction(side * pair.first.teeth, pair.second.teeth)
        axes = 0j, complex(0, -side * pair.centre_distance)
        rings, shares = (False, pair.is_internal), (1.0, self.efficiency)
        return {
            name: RotatingBody(axis, speed, True, share, is_ring)
            for name, axis, speed, share, is_ring in zip(pair.names, axes, speeds, shares, rings)
        }

    @property
    def efficiency(self) -> float:
        """Share of the power that reaches the second gear."""
        return max(1 - self.friction * loss_factor(self.design), LEAST_EFFICIENCY)

    def scene_at(self, turn: Real) -> Scene:
        return turned_pair_scene(self.design, self.parts, turn)

    @property
    def quantities(self) -> Mapping[str, str]:
        gears = [gear_quantities(gear, name) for name, gear, *_ in self.gears]
        return pair_quantities(self.design) | gears[0] | gears[1]

    @property
    def handles(self) -> tuple[SceneHandle, ...]:
        return tuple(pair_handles(self.design, self.has_given_shifts, self.centre_distance is not None))

    @property
    def has_given_shifts(self) -> bool:
        """Whether the profile shifts are those of the recipe's gears."""
        return True

    @classmethod
    def example_values(cls, tables: Mapping[str, str]) -> Mapping[str, object]:
        """Shafts, if a base is requested; materials, if loads are; screws in the rim for what a ring has attached."""
        shafts = {f"{name}_stock.bore": 8.0 for name in cls.pair.names} if "base" in tables else {}
        materials = {f"{name}_stock.material": MATERIALS["steel-C45"] for name in cls.pair.names}
        return shafts | (materials if "loads" in tables else {}) | on_ring(tables)

    @property
    def own_notes(self) -> tuple[Mapping[str, object], Mapping[str, object]]:
        sizes = {name: (gear, helix, stock.thickness) for name, gear, stock, helix in self.gears}
        mesh = mesh_notes(self.design, self.helix, self.face_width)
        own = {"efficiency": to_digits(self.efficiency)} if self.friction else {}
        return self.mesh_notes({"pair": {**mesh, **own}}, sizes), assembly_summary(self)

    @property
    def formulas(self) -> tuple[WorkedFormula, ...]:
        """The circles of both gears, and the working pressure angle and contact ratio of external ones."""
        pair, unit = self.design, UNITS[self.units]
        gears, alpha = (pair.first, pair.second), float(np.degrees(pair.first.pressure_angle))
        worked = WorkedFormulas("ISO 21771")
        m = worked.give("m", "module", unit.of(pair.module), unit.name)
        worked.give("alpha", "pressure angle", alpha, "deg")
        a = worked.give("a", "centre distance", unit.of(pair.centre_distance), unit.name)
        for k, gear in enumerate(gears, 1):
            worked.give(f"z_{k}", f"teeth of gear {k}", gear.teeth)
        r_a = [
            worked.give(f"r_a{k}", f"tip radius of gear {k}", unit.of(gear.tip_radius), unit.name)
            for k, gear in enumerate(gears, 1)
        ]
        cos, r_b = np.cos(np.radians(alpha)), []
        for k, gear in enumerate(gears, 1):
            worked.add(f"pitch diameter of gear {k}", f"d_{k}", f"{{m}} {{z_{k}}}", m * gear.teeth, unit.name)
            template, value = f"{{m}} {{z_{k}}} cos({{alpha}} deg) / 2", m * gear.teeth * cos / 2
            r_b.append(worked.add(f"base radius of gear {k}", f"r_b{k}", template, value, unit.name))
        worked.add("teeth of gear 2 for each of gear 1", "i", "{z_2} / {z_1}", gears[1].teeth / gears[0].teeth)
        if not pair.is_internal:
            template, value = "arccos(({r_b1} + {r_b2}) / {a})", np.degrees(np.arccos(sum(r_b) / a))
            working = np.radians(worked.add("working pressure angle", "alpha_w", template, value, "deg"))
            path = sum(np.sqrt(tip * tip - base * base) for tip, base in zip(r_a, r_b)) - a * np.sin(working)
            value = path / (np.pi * m * cos)
            template = "(sqrt({r_a1}^2 - {r_b1}^2) + sqrt({r_a2}^2 - {r_b2}^2) - {a} sin({alpha_w} deg))"
            # Undercut shortens the flanks: contact then ends before the tip circles.
            if abs(value - pair.contact_ratio) < 1e-9:
                worked.add("contact ratio", "epsilon", f"{template} / ({{pi}} {{m}} cos({{alpha}} deg))", value)
        return tuple(worked.formulas)


@record(kw_only=True)
class GearPairRecipe(AbstractPairRecipe):
    """Two spur gears at their centre distance: both gears, and a plate with holes for their shafts."""

    additions: ClassVar[Additions] = Additions(("second_stock.motor",))
    takes_snap_pins: ClassVar[bool] = True
    kind: Literal["gear-pair"] = "gear-pair"
    first: SpurGear = entry("the driving gear", example=SpurGear(12, 3, 0.6))
    second: SpurGear = entry("the driven gear", example=SpurGear(24, 3, 0.36))
    shifts: Literal["given", "avoid-undercut", "balance-sliding"] = entry(
        "profile shifts as given, the least without undercut, or of the given sum with equal sliding of both gears",
        default="given",
    )
    tips: Tips = tips_entry()
    centre_distance: float | None = _centre_distance()
    friction: float = friction_entry()
    first_stock: GearStock = entry("sheet and bore of the driving gear", default=GearStock())
    second_stock: GearStock = entry("sheet and bore of the driven gear", default=GearStock())
    base: BaseStock | None = entry(
        "a base plate under both gears; if omitted, a bar that holds their shafts", default=None
    )
    loads: GearLoads | None = _loads("driving gear")
    measuring: Measuring | None = measuring_entry()
    files: Files = entry("formats and tolerance of the files", default=Files())

    @property
    def stocks(self) -> tuple[GearStock, GearStock]:
        return self.first_stock, self.second_stock

    @property
    def has_given_shifts(self) -> bool:
        return self.shifts == "given"

    def transverse_gears(self) -> tuple[SpurGear, SpurGear]:
        first, second = self.in_section(self.first), self.in_section(self.second)
        if self.shifts == "avoid-undercut":
            shifts = undercut_free_shift(first.teeth, first.rack), undercut_free_shift(second.teeth, second.rack)
        elif self.shifts == "balance-sliding":
            total = first.profile_shift + second.profile_shift
            shifts = balanced_shifts(first.teeth, second.teeth, first.rack, total)
        else:
            shifts = first.profile_shift, second.profile_shift
        return replace(first, profile_shift=shifts[0]), replace(second, profile_shift=shifts[1])

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        pair, first, parts = self.design, self.first_stock, self.plates
        if self.base is not None:
            reaches, shafts = (pair.first.tip_radius, pair.second.tip_radius), (first.bore, self.second_stock.bore)
            motor, material = first.motor, first.material
            plate = pair_base(
                pair.centre_distance, reaches, shafts, first.thickness, self.base, motor=motor, material=material
            )
            gears = (replace(part, hole_names=(letter,)) for part, letter in zip(parts, "AB"))
            return *gears, plate, *pin_parts(self.assembly.snap_pins)
        holes = [self.first_stock.hole_diameter, self.second_stock.hole_diameter]
        if all(holes):
            # The width of the plate round a hole equals the widest hole.
            axes = [0j, complex(self.design.centre_distance)]
            keys = ("first_stock.bore", "second_stock.bore")
            bar = base_plate("base", axes, holes, max(holes), self.first_stock.thickness, keys)
            fits = (*self.first_stock.running_fits, *self.second_stock.running_fits)
            bar = replace(bar, fits=fits, material=self.first_stock.material)
            parts = [replace(part, hole_names=tuple(letter)) for part, letter in zip([*parts, bar], ("A", "B", "AB"))]
        return *parts, *self.first_stock.motor_parts, *pin_parts(self.assembly.snap_pins)

    @cached_property
    def assembly(self) -> Assembly:
        """Shafts, keys, collars and screws, and the steps of assembly."""
        first, second = (Wheel(name, letter, stock) for name, letter, stock in zip(self.pair.names, "AB", self.stocks))
        plate = self.first_stock.thickness if self.first_stock.bore and self.second_stock.bore else None
        distance = self.design.centre_distance
        return pair_assembly(first, second, distance, plate, self.base, self.helix, self.has_snap_pins)


@record(kw_only=True)
class InternalGearPairRecipe(AbstractPairRecipe):
    """A pinion and the ring that it drives: the plates of both, and the pinion's shaft."""

    pair = InternalGearPair

    prints_in_place: ClassVar[bool] = True
    additions: ClassVar[Additions] = RingAdditions()
    kind: Literal["internal-gear-pair"] = "internal-gear-pair"
    pinion: SpurGear = entry("the driving gear", example=SpurGear(18, 2))
    ring: RingGear = entry("the ring round the pinion", example=RingGear(60, 2, addendum=0.8))
    tips: Tips = tips_entry()
    centre_distance: float | None = _centre_distance()
    friction: float = friction_entry()
    pinion_stock: GearStock = entry("sheet and bore of the pinion", default=GearStock())
    ring_stock: RingStock = entry("sheet and rim of the ring", default=RingStock())
    loads: GearLoads | None = _loads("pinion")
    measuring: Measuring | None = measuring_entry()
    files: Files = entry("formats and tolerance of the files", default=Files())

    base = None

    @property
    def stocks(self) -> tuple[GearStock, RingStock]:
        return self.pinion_stock, self.ring_stock

    def transverse_gears(self) -> tuple[SpurGear, RingGear]:
        return self.in_section(self.pinion), self.in_section(self.ring)

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        return *self.plates, *self.pinion_stock.motor_parts

    @cached_property
    def assembly(self) -> Assembly:
        """The pinion's shaft and key, and the steps of assembly."""
        pinion, ring = Wheel("pinion", "A", self.pinion_stock), Wheel("ring", "B", None)
        return pair_assembly(pinion, ring, self.design.centre_distance, None, None, self.helix)


@record(kw_only=True)
class RackAndPinionRecipe(AbstractHelicalRecipe, AbstractLoadedRecipe):
    """A pinion and the rack it drives."""

    kind: Literal["rack-and-pinion"] = "rack-and-pinion"
    pinion: SpurGear = entry("the driving gear", example=SpurGear(20, 2))
    rack: GearRack = entry("the rack", example=GearRack(12, 2))
    distance: float | None = quantity(
        "distance of the pinion's axis from the rack's reference line; if omitted, the one without backlash", "mm",
        default=None, above=0, at_most=1e9,
    )  # fmt: skip
    stock: GearStock = entry("sheet of both, and bore of the pinion", default=GearStock())
    base: RackBaseStock | None = entry("a base plate that guides the rack; none if omitted", default=None)
    without_loads: ClassVar[str] = RACK_WITHOUT_LOADS
    loads: RackLoads | None = entry(
        "force on the rack, for pinion torque and strength; the stock then names its material", default=None
    )
    measuring: Measuring | None = measuring_entry()
    files: Files = entry("formats and tolerance of the files", default=Files())

    def __post_init__(self) -> None:
        super().__post_init__()
        self.design  # noqa: B018  raises for gears that cannot mesh
        for aspect in self.aspects:
            aspect.check()

    def loaded(self, loads: RackLoads) -> LoadedMeshes | None:
        (material,) = loaded_materials(stock=self.stock.material)
        if self.helix_angle_deg:
            return None
        strength = RackStrength(self.design, loads, self.stock.thickness, (material, material))
        limit, summary = strength.force_limit, rack_strength_notes(strength)
        return LoadedMeshes(strength, {"": strength}, limit, summary, strength.torque, "loads.force_n")

    @cached_property
    def design(self) -> RackPair:
        """Pinion and rack in mesh."""
        with self.naming_section():
            pinion, rack = self.in_section(self.pinion), self.in_section(self.rack)
            return RackPair(pinion, rack) if self.distance is None else RackPair(pinion, rack, self.distance)

    @property
    def own_table(self) -> Table:
        return contact_table(self.design)

    @property
    def own_checks(self) -> tuple[Check, ...]:
        pinion = self.design.pinion
        gear = gear_checks(pinion, self.stock.rim_under(pinion), "pinion")
        boss = boss_checks("pinion", pinion.root_radius, self.stock.motor, self.base)
        return (*mesh_checks(self.design), *gear, *boss)

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        check_tooth_points(self.files, [self.design.pinion.outline])
        (pinion,) = gear_parts(self.design.pinion, self.stock, "pinion", helix=self.helix)
        (rack,) = gear_parts(self.design.rack, self.stock, "rack", helix=self.helix)
        if self.base is None:
            return pinion, rack, *self.stock.motor_parts
        rack_and_base = rack_base(self.design, rack, self.stock.bore, self.base, self.stock.motor)
        return replace(pinion, hole_names=("A",)), *rack_and_base

    @cached_property
    def assembly(self) -> Assembly:
        """The pinion's shaft, the rack's pins, the screws of the base, and the steps of assembly."""
        return rack_assembly(self.stock, self.design.distance, self.base, self.helix)

    @property
    def own_scene(self) -> Scene:
        """Both in mesh."""
        return pair_scene(self.design, self.parts)

    @property
    def quantities(self) -> Mapping[str, str]:
        distance = {"distance of axis and reference line": f"{mm(self.design.distance):.6g}"}
        return distance | gear_quantities(self.design.pinion, "pinion")

    @property
    def handles(self) -> tuple[SceneHandle, ...]:
        return tuple(rack_handles(self.design, self.distance is not None))

    @classmethod
    def example_values(cls, tables: Mapping[str, str]) -> Mapping[str, object]:
        """A shaft, and pins thin enough for the rack, if a base is requested; a material, if loads are."""
        base = {"stock.bore": 8.0, "stock.thickness": 4.0, "base": RackBaseStock(guide_pin=3.0)}
        material = {"stock.material": MATERIALS["steel-C45"]} if "loads" in tables else {}
        return {**(base if "base" in tables else {}), **material}

    @property
    def own_notes(self) -> tuple[Mapping[str, object], Mapping[str, object]]:
        pair, width = self.design, self.stock.thickness
        mesh = {
            "distance_mm": to_digits(pair.distance),
            "travel_per_turn_mm": to_digits(pair.travel),
            "contact_ratio": to_digits(pair.contact_ratio),
            **overlap_notes(pair.contact_ratio, pair.module, self.helix, width),
            **backlash_notes(pair, pair.distance, self.helix),
            "clearances_mm": [to_digits(c) for c in pair.clearances],
            "interferences": list(pair.interferences),
        }
        sizes = {"pinion": (pair.pinion, self.helix, width)}
        return self.mesh_notes({"pair": mesh}, sizes), assembly_summary(self)
