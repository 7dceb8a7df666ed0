"""Recipe of a planetary set."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from typing import ClassVar, Literal

import numpy as np

from ...core.errors import DesignError
from ...core.fields import entry, to_digits
from ...core.records import record
from ...core.units import mm
from ...making.assembly import Assembly, BaseStock, collar_across
from ...making.motors import plate_radius
from ...model.check import Check
from ...model.material import MATERIALS
from ...model.motor import RotatingBody
from ...model.part import Part
from ...model.scene import Scene, SceneHandle
from ...model.table import Column, Table
from ...plane.vec import Real, without_rounding
from ...recipe.recipe import Additions, assembly_summary
from ...recipe.settings import Drive, Files
from ..checks import gear_checks, planetary_checks
from ..contract import AbstractInvoluteGear
from ..helix import Helix
from ..parts import GearStock, RingStock, gear_parts
from ..parts_assembly import carrier, planetary_assembly, planetary_base, turns_with_shaft
from ..planetary import MEMBERS, Member, PlanetarySet
from ..scene_pairs import planetary_handles, planetary_scene
from ..strength import GearLoads, PlanetaryStrength
from .helical import (
    LEAST_EFFICIENCY,
    AbstractHelicalRecipe,
    Measuring,
    RingAdditions,
    Tips,
    boss_checks,
    check_tooth_points,
    friction_entry,
    gear_quantities,
    measuring_entry,
    mesh_notes,
    on_ring,
    tips_entry,
)
from .loaded import AbstractLoadedRecipe, LoadedMeshes, loaded_materials, planetary_strength_notes


@record(kw_only=True)
class PlanetaryRecipe(AbstractHelicalRecipe, AbstractLoadedRecipe):
    """A sun, planets and a ring: all gears and the carrier of the planets; one member drives, one is fixed."""

    additions: ClassVar[Additions] = RingAdditions(("planet_stock.motor",))
    prints_in_place: ClassVar[bool] = True
    kind: Literal["planetary"] = "planetary"
    gears: PlanetarySet
    tips: Tips = tips_entry()
    driver: Member = entry("member that drives", default="sun")
    fixed: Member = entry("member that is held", default="ring")
    friction: float = friction_entry()
    drive: Drive = entry("how the driver turns", default=Drive())
    sun_stock: GearStock = entry("sheet and bore of the sun", default=GearStock())
    planet_stock: GearStock = entry("sheet and bore of the planets", default=GearStock())
    ring_stock: RingStock = entry("sheet and rim of the ring", default=RingStock())
    base: BaseStock | None = entry(
        "a base plate that holds a fixed ring and the sun's shaft; none if omitted", default=None
    )
    loads: GearLoads | None = entry(
        "torque on the driver, for forces and strength; all stocks then name their material", default=None
    )
    measuring: Measuring | None = measuring_entry()
    files: Files = entry("formats and tolerance of the files", default=Files())

    def __post_init__(self) -> None:
        super().__post_init__()
        sun, planet, ring = self.sun_stock.thickness, self.planet_stock.thickness, self.ring_stock.thickness
        self.check_faces({"sun_stock": sun, "planet_stock": planet, "ring_stock": ring})
        if self.planet_stock.motor is not None:
            raise DesignError(
                "planet_stock.motor", "found a motor for the planets", "give sun_stock.motor instead", "conflict"
            )
        if self.sun_stock.motor is not None and self.driver != "sun":
            problem = f"found a motor for the sun, but the {self.driver} drives"
            raise DesignError("sun_stock.motor", problem, 'omit it, or give driver = "sun"', "conflict")
        if self.base is not None and self.fixed != "ring":
            problem = f"found a base, which holds the ring, but the {self.fixed} is fixed"
            raise DesignError("base", problem, 'omit it, or give fixed = "ring"', "conflict")
        self.design  # noqa: B018  raises for gears without such tips
        self.drive.check_rows(self.driver_turns)
        for aspect in self.aspects:
            aspect.check()

    @cached_property
    def design(self) -> PlanetarySet:
        """The transverse section of all gears, with the requested tips."""
        with self.naming_section():
            gears = self.in_section(self.gears)
            if self.tips == "given":
                return gears
            try:
                return gears.with_full_clearance()
            except DesignError as error:
                raise DesignError(f"gears.{error.field}", error.problem, error.remedy, error.id) from None

    def loaded(self, loads: GearLoads) -> LoadedMeshes | None:
        sun, planet, ring = self.sun_stock, self.planet_stock, self.ring_stock
        materials = loaded_materials(sun_stock=sun.material, planet_stock=planet.material, ring_stock=ring.material)
        if self.helix_angle_deg:
            return None
        widths = min(sun.thickness, planet.thickness), min(planet.thickness, ring.thickness)
        strength = PlanetaryStrength(self.design, loads, widths, materials, self.driver)
        meshes = {"sun": strength.inner, "ring": strength.outer}
        summary = planetary_strength_notes(strength)
        return LoadedMeshes(strength, meshes, strength.torque_limit, summary, loads.torque_n_mm)

    @property
    def output(self) -> Member:
        """The member that is driven."""
        return next(name for name in MEMBERS if name not in (self.driver, self.fixed))

    @property
    def turns(self) -> Mapping[str, Fraction]:
        """Rotations of the members that turn for one of the driver: the driver, the output, the planets."""
        turns = self.gears.turns(self.driver, self.fixed)
        return {name: turns[name] for name in (self.driver, self.output, "planet")}

    @property
    def driver_turns(self) -> float:
        """Rotations of the driver during one of the output, at least one."""
        return max(1.0, 1 / abs(float(self.turns[self.output])))

    @property
    def own_table(self) -> Table:
        """One rotation of the slower of driver and output; with an acceleration also rates of output and planets."""
        steps = int(np.ceil(360 * self.driver_turns / self.drive.step_deg - 1e-9))
        speed, acceleration = self.drive.speed, self.drive.acceleration_rad_per_s2
        turn = np.linspace(0, np.copysign(2 * np.pi * self.driver_turns, speed), steps + 1)
        time = Column("time", "s", "time", turn / (np.nan if acceleration else speed) + 0.0)
        angles = self._angles(turn)
        rates = (
            Column(f"{body}_{name}", unit, f"{word} of the {body}", np.full(len(turn), float(self.turns[body]) * rate))
            for body in (self.output, "planet")
            for name, unit, word, rate in (
                ("omega", "rad/s", "angular velocity", speed),
                ("alpha", "rad/s2", "angular acceleration", acceleration),
            )
            if acceleration
        )
        return Table((angles[0], time, *angles[1:], *rates))

    def _angles(self, turn: Real) -> list[Column]:
        """Rotations of all members that turn, deg, at rotations of the driver, rad."""
        words = {"planet": "each planet relative to the frame"}
        return [
            Column(
                f"{name}_angle", "deg", f"rotation of {words.get(name, f'the {name}')}", np.degrees(turn * float(speed))
            )
            for name, speed in self.turns.items()
        ]

    @property
    def own_checks(self) -> tuple[Check, ...]:
        gears, sun, planet = self.design, self.sun_stock, self.planet_stock
        return (
            *planetary_checks(gears),
            *gear_checks(gears.sun, sun.rim_under(gears.sun), "sun"),
            *gear_checks(gears.planet, planet.rim_under(gears.planet), "planet"),
            *gear_checks(gears.ring, self.ring_stock.rim, "ring"),
            *boss_checks("sun", gears.sun.root_radius, sun.motor, self.base),
            *self._collar_checks(),
        )

    def _collar_checks(self) -> tuple[Check, ...]:
        """Check that collars under the carrier clear the plate of the sun's motor below them."""
        motor, planet = self.sun_stock.motor, self.planet_stock
        if motor is None or self.base is not None or not planet.bore or not turns_with_shaft(planet):
            return ()
        distance = self.design.inner.centre_distance
        room = without_rounding(distance - collar_across(planet.bore) / 2 - plate_radius(motor), distance)
        advice = 'give a base, more teeth, or planets that run on their shafts: fit = "running" in a round bore'
        name = "collars under the carrier beside motor_plate"
        return (Check("collars_beside_motor_plate", name, room, "at least", 0, "mm", advice),)

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        gears, sun, planet = self.design, self.sun_stock, self.planet_stock
        check_tooth_points(self.files, [gears.sun.outline, gears.planet.outline], [gears.ring.outline])
        parts = (
            *gear_parts(gears.sun, sun, "sun", "sun_stock", helix=self.helix),
            *gear_parts(gears.planet, planet, "planet", "planet_stock", gears.planets, self.helix.mate),
            *gear_parts(gears.ring, self.ring_stock, "ring", "ring_stock", helix=self.helix.mate),
        )
        if self.base is not None:
            first, planets, ring = parts
            ring_and_base = planetary_base(gears, ring, self.ring_stock.rim, sun.bore, self.base, sun.motor)
            # Planets without shafts have no holes.
            letters = ("C",) if planet.bore else ()
            parts = (replace(first, hole_names=("A",)), replace(planets, hole_names=letters), *ring_and_base)
        else:
            parts += sun.motor_parts
        if not planet.bore:
            return parts
        holes = sun.hole_diameter, planet.hole_diameter
        fits = (*sun.running_fits, *(gears.planets * planet.running_fits))
        plate = replace(carrier(gears, holes, planet.hole_diameter, planet.thickness), fits=fits)
        plate = replace(plate, material=planet.material)
        if self.base is not None:
            plate = replace(plate, hole_names=("A", *"C" * gears.planets))
        return (*parts, plate)

    @cached_property
    def assembly(self) -> Assembly:
        """Shafts, keys and screws, and the steps of assembly."""
        stocks = self.sun_stock, self.planet_stock, self.ring_stock
        return planetary_assembly(self.design, stocks, self.base, self.helix, self.fixed)

    @property
    def own_scene(self) -> Scene:
        """One rotation of the slower of driver and output."""
        return planetary_scene(self.design, self.table, self.parts, self.driver, self.fixed)

    @property
    def rotating_bodies(self) -> Mapping[str, RotatingBody]:
        """The driver and the output; the planets have no fixed axis."""
        members = (self.driver, self.output)
        shares = {self.driver: 1.0, self.output: self.efficiency}
        return {
            name: RotatingBody(0j, self.turns[name], name != "carrier", shares[name], name == "ring")
            for name in members
        }

    @property
    def efficiency(self) -> float:
        """Share of the power that reaches the output."""
        return max(self.design.efficiency(self.friction, self.driver, self.fixed), LEAST_EFFICIENCY)

    def scene_at(self, turn: Real) -> Scene:
        time = Column("time", "s", "time", np.zeros(turn.shape))
        return planetary_scene(self.design, Table((*self._angles(turn), time)), self.parts, self.driver, self.fixed)

    @property
    def quantities(self) -> Mapping[str, str]:
        gears = self.design
        ratio = {(name := f"{self.driver} to {self.output}"): f"{gears.ratios[name]:.5g}"}
        ratio["centre distance"] = f"{mm(gears.inner.centre_distance):.6g}"
        return ratio | gear_quantities(gears.sun, "sun") | gear_quantities(gears.ring, "ring")

    @property
    def handles(self) -> tuple[SceneHandle, ...]:
        return tuple(planetary_handles(self.design))

    @classmethod
    def example_values(cls, tables: Mapping[str, str]) -> Mapping[str, object]:
        """A shaft, and a rim wide enough for the ring's screws, if a base is requested; screws of attachments in it."""
        shaft = {"sun_stock.bore": 8.0, "ring_stock.rim": 12.0} if "base" in tables else {}
        stocks = ("sun_stock", "planet_stock", "ring_stock") if "loads" in tables else ()
        return shaft | {f"{stock}.material": MATERIALS["steel-C45"] for stock in stocks} | on_ring(tables)

    @property
    def own_notes(self) -> tuple[Mapping[str, object], Mapping[str, object]]:
        gears, helix = self.design, self.helix
        sun, planet, ring = self.sun_stock.thickness, self.planet_stock.thickness, self.ring_stock.thickness
        sizes: dict[str, tuple[AbstractInvoluteGear, Helix, float]] = {
            "sun": (gears.sun, helix, sun),
            "planet": (gears.planet, helix.mate, planet),
            "ring": (gears.ring, helix.mate, ring),
        }
        meshes = {
            "ratios": {name: to_digits(ratio) for name, ratio in gears.ratios.items()},
            "sun_and_planet": mesh_notes(gears.inner, helix, min(sun, planet)),
            "planet_and_ring": mesh_notes(gears.outer, helix, min(planet, ring)),
            **({"efficiency": to_digits(self.efficiency)} if self.friction else {}),
        }
        return self.mesh_notes(meshes, sizes), assembly_summary(self)
