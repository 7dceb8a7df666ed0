"""Recipe of a planetary set."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from typing import Literal

import numpy as np

from ...core.errors import DesignError
from ...core.fields import entry, to_digits
from ...core.records import record
from ...making.assembly import Assembly, collar_across
from ...making.bases import BaseStock
from ...making.materials import MATERIALS
from ...making.motor_faces import plate_radius
from ...model.check import Check
from ...model.part import Part
from ...model.rotating import RotatingBody
from ...model.scene import Scene, SceneHandle
from ...model.table import Column, Table
from ...plane.vec import Real, without_rounding
from ...recipe.settings import Drive, Files
from ..checks import gear_checks, planetary_checks, strength_checks
from ..contract import AbstractInvoluteGear
from ..helix import Helix
from ..parts.assemblies import planetary_assembly, turns_with_shaft
from ..parts.bases import carrier, planetary_base
from ..parts.gears import GearStock, RingStock, gear_parts
from ..planetary import PlanetarySet
from ..scene_pairs import planetary_handles, planetary_scene
from ..strength import GearLoads, PlanetaryStrength
from .helical import (
    AbstractHelicalRecipe,
    boss_checks,
    check_tooth_points,
    gear_notes,
    gear_quantities,
    helices_notes,
    mesh_notes,
)
from .strength_notes import forces_missing, loaded_materials, planetary_strength_notes


@record(kw_only=True)
class PlanetaryRecipe(AbstractHelicalRecipe):
    """A sun, planets and a ring: all gears and the carrier of the planets; the sun drives, the ring is fixed.

    Parameters
    ----------
    gears : PlanetarySet
        The gears.
    drive : Drive, optional
        Speed of the sun, rpm, and the steps of the table.
    sun_stock, planet_stock : GearStock, optional
        Sheet and bore of the sun and of the planets.
    ring_stock : RingStock, optional
        Sheet and rim of the ring.
    base : BaseStock, optional
        Base plate that holds the ring and the sun's shaft; none if omitted.
    loads : GearLoads, optional
        Torque on the sun, for forces and strength; all stocks then name their material.
    helix_angle_deg, hand, herringbone, section : optional
        Direction of the teeth, and the section to which the sizes refer.
    files : Files, optional
        Formats and tolerance of the files.
    """

    kind: Literal["planetary"] = "planetary"
    gears: PlanetarySet
    drive: Drive = entry("how the sun turns", default=Drive())
    sun_stock: GearStock = entry("sheet and bore of the sun", default=GearStock())
    planet_stock: GearStock = entry("sheet and bore of the planets", default=GearStock())
    ring_stock: RingStock = entry("sheet and rim of the ring", default=RingStock())
    base: BaseStock | None = entry(
        "a base plate that holds the ring and the sun's shaft; none if omitted", default=None
    )
    loads: GearLoads | None = entry(
        "torque on the sun, for forces and strength; all stocks then name their material", default=None
    )
    files: Files = entry("formats and tolerance of the files", default=Files())

    def __post_init__(self) -> None:
        super().__post_init__()
        sun, planet, ring = self.sun_stock.thickness, self.planet_stock.thickness, self.ring_stock.thickness
        self.check_faces({"sun_stock": sun, "planet_stock": planet, "ring_stock": ring})
        if self.planet_stock.motor is not None:
            raise DesignError(
                "planet_stock.motor", "found a motor for the planets", "give sun_stock.motor instead", "conflict"
            )
        self.drive.check_rows(self.gears.ratios["sun to carrier"])
        self.strength  # noqa: B018  raises if the materials are missing

    @cached_property
    def design(self) -> PlanetarySet:
        """The transverse section of all gears."""
        with self.naming_section():
            return self.in_section(self.gears)

    @cached_property
    def strength(self) -> PlanetaryStrength | None:
        """Forces and stresses under the loads; None without loads, or if the teeth are helical."""
        if self.loads is None:
            return None
        sun, planet, ring = self.sun_stock, self.planet_stock, self.ring_stock
        materials = loaded_materials(sun_stock=sun.material, planet_stock=planet.material, ring_stock=ring.material)
        if self.helix_angle_deg:
            return None
        widths = min(sun.thickness, planet.thickness), min(planet.thickness, ring.thickness)
        return PlanetaryStrength(self.design, self.loads, widths, materials)

    @cached_property
    def table(self) -> Table:
        """One rotation of the carrier in steps of the sun; with an acceleration also rates of carrier and planets."""
        ratio = self.design.ratios["sun to carrier"]
        steps = int(np.ceil(360 * ratio / self.drive.step_deg - 1e-9))
        speed, acceleration = self.drive.speed, self.drive.acceleration_rad_per_s2
        sun = np.linspace(0, np.copysign(2 * np.pi * ratio, speed), steps + 1)
        speeds = self.design.speeds(sun=1.0, ring=0.0)
        planet = np.degrees(sun * speeds["planet"])
        return Table(
            (
                Column("sun_angle", "deg", "rotation of the sun", np.degrees(sun)),
                Column("time", "s", "time", sun / (np.nan if acceleration else speed) + 0.0),
                Column("carrier_angle", "deg", "rotation of the carrier", np.degrees(sun * speeds["carrier"])),
                Column("planet_angle", "deg", "rotation of each planet relative to the frame", planet),
                *(
                    Column(f"{body}_{name}", unit, f"{word} of the {body}", np.full(len(sun), speeds[body] * rate))
                    for body in ("carrier", "planet")
                    for name, unit, word, rate in (
                        ("omega", "rad/s", "angular velocity", speed),
                        ("alpha", "rad/s2", "angular acceleration", acceleration),
                    )
                    if acceleration
                ),
            )
        )

    @property
    def design_checks(self) -> tuple[Check, ...]:
        gears, sun, planet = self.design, self.sun_stock, self.planet_stock
        return (
            *planetary_checks(gears),
            *gear_checks(gears.sun, sun.rim_under(gears.sun), "sun"),
            *gear_checks(gears.planet, planet.rim_under(gears.planet), "planet"),
            *gear_checks(gears.ring, self.ring_stock.rim, "ring"),
            *boss_checks("sun", gears.sun.root_radius, sun.motor, self.base),
            *self._collar_checks(),
            *self._strength_checks(),
        )

    def _strength_checks(self) -> tuple[Check, ...]:
        if self.strength is None:
            return ()
        meshes = {"sun": self.strength.inner, "ring": self.strength.outer}
        limit = self.strength.torque_limit
        return tuple(c for name, mesh in meshes.items() for c in strength_checks(mesh, name, limit))

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
        return planetary_assembly(self.design, stocks, self.base, self.helix)

    @cached_property
    def scene(self) -> Scene:
        """One rotation of the carrier."""
        return planetary_scene(self.design, self.table, self.parts)

    @property
    def rotating_bodies(self) -> Mapping[str, RotatingBody]:
        """The sun and the carrier; the planets have no fixed axis."""
        sun, ring = self.design.sun.teeth, self.design.ring.teeth
        carrier = RotatingBody(0j, Fraction(sun, sun + ring))
        return {"sun": RotatingBody(0j, Fraction(1), is_wheel=True), "carrier": carrier}

    def scene_at(self, turn: Real) -> Scene:
        speeds = self.design.speeds(sun=1.0, ring=0.0)
        columns = (
            Column(f"{body}_angle", "deg", f"rotation of the {body}", np.degrees(turn * speed))
            for body, speed in (("sun", 1.0), ("carrier", speeds["carrier"]), ("planet", speeds["planet"]))
        )
        table = Table((*columns, Column("time", "s", "time", np.zeros(turn.shape))))
        return planetary_scene(self.design, table, self.parts)

    @property
    def quantities(self) -> Mapping[str, str]:
        gears = self.design
        ratio = {"sun to carrier": f"{gears.ratios['sun to carrier']:.5g}"}
        ratio["centre distance"] = f"{gears.inner.centre_distance:.6g} mm"
        return ratio | gear_quantities(gears.sun, "sun") | gear_quantities(gears.ring, "ring")

    @property
    def handles(self) -> tuple[SceneHandle, ...]:
        return tuple(planetary_handles(self.design))

    @classmethod
    def example_values(cls, tables: Mapping[str, str]) -> Mapping[str, object]:
        """A shaft, and a rim wide enough for the ring's screws, if a base is requested."""
        shaft = {"sun_stock.bore": 8.0, "ring_stock.rim": 12.0} if "base" in tables else {}
        stocks = ("sun_stock", "planet_stock", "ring_stock") if "loads" in tables else ()
        return shaft | {f"{stock}.material": MATERIALS["steel-C45"] for stock in stocks}

    @property
    def forces_missing(self) -> str:
        return forces_missing(self.loads, self.strength)

    @property
    def notes(self) -> Mapping[str, object]:
        gears, helix = self.design, self.helix
        sun, planet, ring = self.sun_stock.thickness, self.planet_stock.thickness, self.ring_stock.thickness
        sizes: dict[str, tuple[AbstractInvoluteGear, Helix, float]] = {
            "sun": (gears.sun, helix, sun),
            "planet": (gears.planet, helix.mate, planet),
            "ring": (gears.ring, helix.mate, ring),
        }
        return {
            "ratios": {name: to_digits(ratio) for name, ratio in gears.ratios.items()},
            "sun_and_planet": mesh_notes(gears.inner, helix, min(sun, planet)),
            "planet_and_ring": mesh_notes(gears.outer, helix, min(planet, ring)),
            **helices_notes(sizes),
            "measures_mm": {name: gear_notes(*size) for name, size in sizes.items()},
            **({"loads": planetary_strength_notes(self.strength)} if self.strength else {}),
            **self.assembly_summary,
        }
