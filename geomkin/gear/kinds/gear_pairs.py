"""Recipes of pairs: two spur gears in mesh, and a pinion on a rack."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from typing import Literal

from ...core.errors import DesignError
from ...core.fields import entry, quantity, to_digits
from ...core.records import record
from ...making.assembly import Assembly
from ...making.bases import BaseStock, RackBaseStock
from ...making.materials import MATERIALS
from ...model.check import Check
from ...model.part import Part
from ...model.rotating import RotatingBody
from ...model.scene import Scene, SceneHandle
from ...model.table import Table
from ...plane.vec import Real
from ...recipe.settings import Files
from ..checks import gear_checks, mesh_checks, strength_checks
from ..contract import AbstractInvoluteGear
from ..cutters import balanced_shifts, undercut_free_shift
from ..helix import Helix
from ..output_loads import RackLoads, RackStrength
from ..pair import GearPair, contact_table
from ..parts.assemblies import Wheel, pair_assembly, rack_assembly
from ..parts.bases import pair_base, rack_base
from ..parts.gears import GearStock, base_plate, gear_parts
from ..rack import GearRack, RackPair
from ..scene_pairs import pair_handles, pair_scene, rack_handles, turned_pair_scene
from ..spur import SpurGear
from ..strength import GearLoads, PairStrength, pressure_column
from .helical import (
    AbstractHelicalRecipe,
    backlash_notes,
    boss_checks,
    check_tooth_points,
    gear_notes,
    gear_quantities,
    helices_notes,
    mesh_notes,
    overlap_notes,
    pair_quantities,
)
from .strength_notes import (
    RACK_WITHOUT_LOADS,
    forces_missing,
    loaded_materials,
    pair_strength_notes,
    rack_strength_notes,
)


@record(kw_only=True)
class GearPairRecipe(AbstractHelicalRecipe):
    """Two spur gears at their centre distance: both gears, and a plate with holes for their shafts.

    Parameters
    ----------
    first, second : SpurGear
        The driving and the driven gear.
    shifts : {"given", "avoid-undercut", "balance-sliding"}, optional
        Profile shifts: as given, the least without undercut, or of the given sum with equal sliding of both gears.
    centre_distance : float, optional
        Distance of the axes, mm; if omitted, the one without backlash.
    first_stock, second_stock : GearStock, optional
        Sheet and bore of each gear.
    base : BaseStock, optional
        Base plate under both gears; if omitted, a bar that holds their shafts.
    loads : GearLoads, optional
        Torque on the driving gear, for forces and strength; both stocks then name their material.
    helix_angle_deg, hand, herringbone, section : optional
        Direction of the teeth, and the section to which the sizes refer.
    files : Files, optional
        Formats and tolerance of the files.
    """

    kind: Literal["gear-pair"] = "gear-pair"
    first: SpurGear = entry("the driving gear", example=SpurGear(12, 3, 0.6))
    second: SpurGear = entry("the driven gear", example=SpurGear(24, 3, 0.36))
    shifts: Literal["given", "avoid-undercut", "balance-sliding"] = entry(
        "profile shifts as given, the least without undercut, or of the given sum with equal sliding of both gears",
        default="given",
    )
    centre_distance: float | None = quantity(
        "distance of the axes; if omitted, the one without backlash", "mm", default=None, above=0, at_most=1e9
    )
    first_stock: GearStock = entry("sheet and bore of the driving gear", default=GearStock())
    second_stock: GearStock = entry("sheet and bore of the driven gear", default=GearStock())
    base: BaseStock | None = entry(
        "a base plate under both gears; if omitted, a bar that holds their shafts", default=None
    )
    loads: GearLoads | None = entry(
        "torque on the driving gear, for forces and strength; both stocks then name their material", default=None
    )
    files: Files = entry("formats and tolerance of the files", default=Files())

    def __post_init__(self) -> None:
        super().__post_init__()
        self.check_faces({"first_stock": self.first_stock.thickness, "second_stock": self.second_stock.thickness})
        if self.second_stock.motor is not None:
            problem = "found a motor for the driven gear"
            raise DesignError("second_stock.motor", problem, "give first_stock.motor instead", "conflict")
        self.design  # noqa: B018  raises for gears that cannot mesh
        self.strength  # noqa: B018  raises if the materials are missing

    @cached_property
    def strength(self) -> PairStrength | None:
        """Forces and stresses under the loads; None without loads, or if the teeth are helical."""
        if self.loads is None:
            return None
        first, second = loaded_materials(first_stock=self.first_stock.material, second_stock=self.second_stock.material)
        if self.helix_angle_deg:
            return None
        width = min(self.first_stock.thickness, self.second_stock.thickness)
        return PairStrength(self.design, self.loads.torque_n_mm, width, (first, second), self.loads)

    @cached_property
    def design(self) -> GearPair:
        """The gears in mesh, with the requested profile shifts."""
        with self.naming_section():
            return self._pair(self.in_section(self.first), self.in_section(self.second))

    def _pair(self, first: SpurGear, second: SpurGear) -> GearPair:
        if self.shifts == "avoid-undercut":
            shifts = undercut_free_shift(first.teeth, first.rack), undercut_free_shift(second.teeth, second.rack)
        elif self.shifts == "balance-sliding":
            total = first.profile_shift + second.profile_shift
            shifts = balanced_shifts(first.teeth, second.teeth, first.rack, total)
        else:
            shifts = first.profile_shift, second.profile_shift
        first, second = (replace(g, profile_shift=x) for g, x in zip((first, second), shifts))
        return GearPair(first, second, self.centre_distance) if self.centre_distance else GearPair(first, second)

    @property
    def gears(self) -> tuple[tuple[str, AbstractInvoluteGear, GearStock, Helix], ...]:
        """Both gears: name, gear, stock and helix."""
        pair, helix = self.design, self.helix
        return ("first", pair.first, self.first_stock, helix), ("second", pair.second, self.second_stock, helix.mate)

    @cached_property
    def table(self) -> Table:
        """Contact of one pair of flanks; under loads also its pressure."""
        table = contact_table(self.design)
        return table if self.strength is None else Table((*table.columns, pressure_column(self.strength, table)))

    @property
    def design_checks(self) -> tuple[Check, ...]:
        gears = [c for name, gear, stock, _ in self.gears for c in gear_checks(gear, stock.rim_under(gear), name)]
        boss = boss_checks("first", self.design.first.root_radius, self.first_stock.motor, self.base)
        loaded = () if self.strength is None else strength_checks(self.strength)
        return (*mesh_checks(self.design), *gears, *boss, *loaded)

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        check_tooth_points(self.files, [gear.outline for _, gear, *_ in self.gears])
        parts = [
            part
            for name, gear, stock, helix in self.gears
            for part in gear_parts(gear, stock, name, f"{name}_stock", helix=helix)
        ]
        if self.base is not None:
            pair, first = self.design, self.first_stock
            reaches, shafts = (pair.first.tip_radius, pair.second.tip_radius), (first.bore, self.second_stock.bore)
            plate = pair_base(pair.centre_distance, reaches, shafts, first.thickness, self.base, motor=first.motor)
            return *(replace(part, hole_names=(letter,)) for part, letter in zip(parts, "AB")), plate
        holes = [self.first_stock.hole_diameter, self.second_stock.hole_diameter]
        if all(holes):
            # The width of the plate round a hole equals the widest hole.
            axes = [0j, complex(self.design.centre_distance)]
            keys = ("first_stock.bore", "second_stock.bore")
            bar = base_plate("base", axes, holes, max(holes), self.first_stock.thickness, keys)
            fits = (*self.first_stock.running_fits, *self.second_stock.running_fits)
            bar = replace(bar, fits=fits, material=self.first_stock.material)
            parts = [replace(part, hole_names=tuple(letter)) for part, letter in zip([*parts, bar], ("A", "B", "AB"))]
        return *parts, *self.first_stock.motor_parts

    @cached_property
    def assembly(self) -> Assembly:
        """Shafts, keys, collars and screws, and the steps of assembly."""
        first, second = (Wheel(name, letter, stock) for (name, _, stock, _), letter in zip(self.gears, "AB"))
        plate = self.first_stock.thickness if self.first_stock.bore and self.second_stock.bore else None
        return pair_assembly(first, second, self.design.centre_distance, plate, self.base, self.helix)

    @cached_property
    def scene(self) -> Scene:
        """Both in mesh."""
        return pair_scene(self.design, self.parts)

    @property
    def rotating_bodies(self) -> Mapping[str, RotatingBody]:
        """Both gears."""
        pair = self.design
        speeds = Fraction(1), Fraction(-pair.first.teeth, pair.second.teeth)
        axes = 0j, complex(0, pair.centre_distance)
        return {name: RotatingBody(axis, v, is_wheel=True) for name, axis, v in zip(pair.names, axes, speeds)}

    def scene_at(self, turn: Real) -> Scene:
        return turned_pair_scene(self.design, self.parts, turn)

    @property
    def quantities(self) -> Mapping[str, str]:
        pair = self.design
        return pair_quantities(pair) | gear_quantities(pair.first, "first") | gear_quantities(pair.second, "second")

    @property
    def handles(self) -> tuple[SceneHandle, ...]:
        return tuple(pair_handles(self.design, self.shifts == "given", self.centre_distance is not None))

    @classmethod
    def example_values(cls, tables: Mapping[str, str]) -> Mapping[str, object]:
        """Shafts, if a base is requested; materials, if loads are."""
        shafts = {"first_stock.bore": 8.0, "second_stock.bore": 8.0} if "base" in tables else {}
        steel = MATERIALS["steel-C45"]
        return shafts | ({"first_stock.material": steel, "second_stock.material": steel} if "loads" in tables else {})

    @property
    def notes(self) -> Mapping[str, object]:
        sizes = {name: (gear, helix, stock.thickness) for name, gear, stock, helix in self.gears}
        width = min(self.first_stock.thickness, self.second_stock.thickness)
        return {
            "pair": mesh_notes(self.design, self.helix, width),
            **helices_notes(sizes),
            "measures_mm": {name: gear_notes(*size) for name, size in sizes.items()},
            **({"loads": pair_strength_notes(self.strength)} if self.strength else {}),
            **self.assembly_summary,
        }

    @property
    def forces_missing(self) -> str:
        return forces_missing(self.loads, self.strength)


@record(kw_only=True)
class RackAndPinionRecipe(AbstractHelicalRecipe):
    """A pinion and the rack it drives.

    Parameters
    ----------
    pinion : SpurGear
        The driving gear.
    rack : GearRack
        The rack.
    distance : float, optional
        Distance of the pinion's axis from the rack's reference line, mm; if omitted, the one without backlash.
    stock : GearStock, optional
        Sheet of both, and bore of the pinion.
    base : RackBaseStock, optional
        Base plate that guides the rack; none if omitted.
    loads : RackLoads, optional
        Force on the rack, for pinion torque and strength; the stock then names its material.
    helix_angle_deg, hand, herringbone, section : optional
        Direction of the teeth, and the section to which the sizes refer.
    files : Files, optional
        Formats and tolerance of the files.
    """

    kind: Literal["rack-and-pinion"] = "rack-and-pinion"
    pinion: SpurGear = entry("the driving gear", example=SpurGear(20, 2))
    rack: GearRack = entry("the rack", example=GearRack(12, 2))
    distance: float | None = quantity(
        "distance of the pinion's axis from the rack's reference line; if omitted, the one without backlash",
        "mm",
        default=None,
        above=0,
        at_most=1e9,
    )
    stock: GearStock = entry("sheet of both, and bore of the pinion", default=GearStock())
    base: RackBaseStock | None = entry("a base plate that guides the rack; none if omitted", default=None)
    loads: RackLoads | None = entry(
        "force on the rack, for pinion torque and strength; the stock then names its material", default=None
    )
    files: Files = entry("formats and tolerance of the files", default=Files())

    def __post_init__(self) -> None:
        super().__post_init__()
        self.design  # noqa: B018  raises for gears that cannot mesh
        self.strength  # noqa: B018  raises if the material is missing

    @cached_property
    def strength(self) -> RackStrength | None:
        """Pinion torque and stresses under the loads; None without loads, or if the teeth are helical."""
        if self.loads is None:
            return None
        (material,) = loaded_materials(stock=self.stock.material)
        if self.helix_angle_deg:
            return None
        return RackStrength(self.design, self.loads, self.stock.thickness, (material, material))

    @cached_property
    def design(self) -> RackPair:
        """Pinion and rack in mesh."""
        with self.naming_section():
            pinion, rack = self.in_section(self.pinion), self.in_section(self.rack)
            return RackPair(pinion, rack) if self.distance is None else RackPair(pinion, rack, self.distance)

    @cached_property
    def table(self) -> Table:
        return contact_table(self.design)

    @property
    def design_checks(self) -> tuple[Check, ...]:
        pinion = self.design.pinion
        gear = gear_checks(pinion, self.stock.rim_under(pinion), "pinion")
        boss = boss_checks("pinion", pinion.root_radius, self.stock.motor, self.base)
        loaded = self.strength
        holds = () if loaded is None else strength_checks(loaded, limit=loaded.force_limit, key="loads.force_n")
        return (*mesh_checks(self.design), *gear, *boss, *holds)

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

    @cached_property
    def scene(self) -> Scene:
        """Both in mesh."""
        return pair_scene(self.design, self.parts)

    @property
    def quantities(self) -> Mapping[str, str]:
        distance = {"distance of axis and reference line": f"{self.design.distance:.6g} mm"}
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
    def notes(self) -> Mapping[str, object]:
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
        measures = {"pinion": gear_notes(*sizes["pinion"])}
        loads = {"loads": rack_strength_notes(self.strength)} if self.strength else {}
        return {"pair": mesh, **helices_notes(sizes), "measures_mm": measures, **loads, **self.assembly_summary}

    @property
    def forces_missing(self) -> str:
        return forces_missing(self.loads, self.strength, RACK_WITHOUT_LOADS)
