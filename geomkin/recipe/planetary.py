"""Recipe of a planetary set."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from ..check import Check
from ..gear.planetary import PlanetarySet
from ..part import Part
from ..shop.gears import GearStock, RingStock, carrier, gear_parts, ring_part
from ..sizes import entry
from ..table import Column, Table
from .gear_pair import mesh_checks, mesh_notes
from .kind import Kind
from .ring_gear import ring_checks
from .settings import Drive, Files
from .spur_gear import gear_checks, gear_notes, shown


@dataclass(frozen=True)
class PlanetaryRecipe:
    """A sun, planets and a ring: all gears and the carrier that holds the planets; the sun drives, the ring stands."""

    kind: Literal["planetary"]
    gears: PlanetarySet
    drive: Drive = entry("how the sun turns", default=Drive())
    sun_stock: GearStock = entry("what the sun is cut from", default=GearStock())
    planet_stock: GearStock = entry("what the planets are cut from", default=GearStock())
    ring_stock: RingStock = entry("what the ring is cut from", default=RingStock())
    files: Files = entry("what is written", default=Files())


def _table(recipe: PlanetaryRecipe) -> Table:
    """A turn of the carrier, in steps of the sun."""
    gears = recipe.gears
    ratio = gears.ratios["sun to carrier"]
    steps = int(np.ceil(360 * ratio / recipe.drive.step_deg - 1e-9))
    sun = np.linspace(0, 2 * np.pi * ratio, steps + 1)
    speeds = gears.speeds(sun=1.0, ring=0.0)
    return Table(
        (
            Column("sun_angle", "deg", "turn of the sun", np.degrees(sun)),
            Column("time", "s", "time", sun / recipe.drive.speed),
            Column("carrier_angle", "deg", "turn of the carrier", np.degrees(sun * speeds["carrier"])),
            Column(
                "planet_angle", "deg", "turn of each planet, seen from the frame", np.degrees(sun * speeds["planet"])
            ),
        )
    )


def _checks(recipe: PlanetaryRecipe) -> list[Check]:
    gears = recipe.gears
    room = gears.planet_gap / gears.sun.module
    ring = [(f"ring: {c.name}", c) for c in mesh_checks(gears.outer)]
    return [
        *(Check(f"sun: {c.name}", c.value, c.side, c.limit, c.unit, c.advice) for c in mesh_checks(gears.inner)),
        *(Check(name, c.value, c.side, c.limit, c.unit, c.advice) for name, c in ring),
        Check("room between planets", min(room, 1e6), "at least", 0.5, "modules", "give fewer planets"),
        *gear_checks(gears.sun, recipe.sun_stock, "sun"),
        *gear_checks(gears.planet, recipe.planet_stock, "planet"),
        *ring_checks(gears.ring, recipe.ring_stock, "ring"),
    ]


def _parts(recipe: PlanetaryRecipe) -> list[Part]:
    gears, sun, planet = recipe.gears, recipe.sun_stock, recipe.planet_stock
    parts = gear_parts(gears.sun, sun, "sun", "sun_stock")
    parts += gear_parts(gears.planet, planet, "planet", "planet_stock", gears.planets)
    parts.append(ring_part(gears.ring, recipe.ring_stock))
    if planet.bore:
        holes = sun.hole_diameter, planet.hole_diameter
        parts.append(carrier(gears, holes, planet.hole_diameter, planet.thickness))
    return parts


def _notes(recipe: PlanetaryRecipe) -> dict[str, Any]:
    gears = recipe.gears
    return {
        "ratios": {name: shown(ratio) for name, ratio in gears.ratios.items()},
        "sun_and_planet": mesh_notes(gears.inner),
        "planet_and_ring": mesh_notes(gears.outer),
        "measures_mm": {name: gear_notes(getattr(gears, name)) for name in ("sun", "planet", "ring")},
    }


KINDS = {"planetary": Kind(PlanetaryRecipe, _table, _checks, _parts, _notes)}
