"""Bases of gears, and carriers: what holds pairs, racks and planets at their working distances."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...core.arguments import Positive, checked
from ...core.errors import DesignError
from ...core.fields import Length
from ...making.assembly import collar_across
from ...making.bases import BaseOpening, BaseStock, RackBaseStock, standing_plate
from ...making.bores import bore, fits_of
from ...making.motors import MotorName
from ...model.part import Part
from ...plane.curve import AbstractCurve
from ...plane.primitives import Circle, rounded_hull
from ..planetary import PlanetarySet
from ..rack import RackPair

# Least distance of a rack's two guide pins in thicknesses of its bar under the teeth. Nearer, the play of the pins in
# their slot lets the rack tilt; farther asks for longer racks.
APART = 2.0
# Screws that hold a ring: evenly round it, as few as keep it flat.
RING_SCREWS = 6


@checked
def pair_base(
    distance: Positive,
    reaches: tuple[Length, Length],
    shafts: tuple[Length, Length],
    thickness: Positive,
    stock: BaseStock = BaseStock(),
    keys: tuple[str, str] = ("first_stock.bore", "second_stock.bore"),
    motor: MotorName | None = None,
) -> Part:
    """The base of two wheels: one shaft at the origin, the other at `distance`, mm, on +x; letters A and B.

    reaches: how far each wheel reaches from its axis; shafts: their diameters, mm. keys: of these in a recipe, for
    refusals. motor: what turns the first shaft; the base has its holes there. Raises DesignError where a shaft has no
    diameter, the holes meet, or the second one lies over the motor.
    """
    axes = (0j, complex(distance))
    openings = [
        BaseOpening("a gear's shaft", key, shaft, (axis,), letter, head=collar_across(shaft), motor=below)
        for key, shaft, axis, letter, below in zip(keys, shafts, axes, "AB", (motor, None))
    ]
    # Of wheels within each other the larger one counts.
    low, high = (f(side * r + z.real for z, r in zip(axes, reaches)) for f, side in ((min, -1), (max, 1)))
    tall = max(reaches)
    return standing_plate((complex(low, -tall), complex(high, tall)), openings, stock, thickness)


@checked
def rack_base(
    pair: RackPair,
    rack: Part,
    shaft: Length,
    stock: RackBaseStock = RackBaseStock(),
    key: str = "stock.bore",
    motor: MotorName | None = None,
) -> tuple[Part, Part]:
    """The rack with holes for two guide pins, and the base: the pinion's shaft, A, and the slot of the pins, B.

    The pinion is about the base's origin, the rack below it. The slot lets the rack go as far as the pinion's axis
    stays between the middles of its outer teeth. rack: its plate without the holes. shaft: diameter, mm; key: of it in
    a recipe. motor: what turns it; the base has its holes there. Raises DesignError where the rack is too short or too
    thin for the pins, or the slot lies over the motor. Derived here.
    """
    bar, pinion = pair.rack, pair.pinion
    middle = -1j * (bar.root_depth + bar.solid_rim / 2)
    # As far from the ends as from the back.
    left, right = (end - side * bar.solid_rim / 2 for side, end in zip((-1, 1), bar.ends))
    if right - left < APART * bar.solid_rim:
        least = int(np.ceil((APART + 1) * bar.solid_rim / bar.pitch))
        raise DesignError(
            "rack.teeth", f"found {bar.teeth}, too few for two guide pins", f"give at least {least}, or leave out base"
        )
    pins = [
        bore(stock.guide_pin, stock.clearance, bar.solid_rim, "base.guide_pin", x + middle)[0] for x in (left, right)
    ]
    first, last = (end - side * bar.pitch / 2 for side, end in zip((-1, 1), bar.ends))
    slide = middle - 1j * pair.distance
    openings = [
        BaseOpening("the pinion's shaft", key, shaft, (0j,), "A", motor=motor),
        BaseOpening(
            "the guide pins",
            "base.guide_pin",
            stock.guide_pin,
            (slide + left - last, slide + right - first),
            "B",
            head=collar_across(stock.guide_pin),
        ),
    ]
    half = stock.guide_pin / 2 + stock.clearance / 2
    wide = max(pinion.tip_radius, last - left + half, right - first + half)
    back = pair.distance + bar.root_depth + bar.solid_rim
    box = complex(-wide, -back), complex(wide, pinion.tip_radius)
    fits = 2 * fits_of(stock.guide_pin, stock.clearance)
    guided = replace(rack, holes=(*rack.holes, *pins), hole_names=("B", "B"), fits=fits)
    return guided, standing_plate(box, openings, stock, rack.thickness)


@checked
def planetary_base(
    gears: PlanetarySet,
    ring: Part,
    rim: Positive,
    shaft: Length,
    stock: BaseStock = BaseStock(),
    motor: MotorName | None = None,
) -> tuple[Part, Part]:
    """The ring with holes for screws in its rim, and the base: the sun's shaft, A, and the same screws, B.

    The base lies under the gears, so that the carrier lies over them. ring: its plate without the holes; rim: its
    width, mm, outside the teeth. shaft: diameter of the sun's, mm. motor: what turns it; the base has its holes there.
    Raises DesignError where rim or sun are too small, or the ring's screws lie over the motor. Derived here.
    """
    if not stock.screw:
        raise DesignError("base.screw", "found 0 mm, but screws hold the ring", "give their diameter")
    outer = gears.ring.root_radius + rim
    places = (outer - rim / 2) * np.exp(2j * np.pi * (np.arange(RING_SCREWS) + 0.5) / RING_SCREWS)
    # The ring stands turned by a part of a pitch, so that its teeth meet those of the planets.
    turned = complex(np.asarray(gears.poses(0.0)[2].direction))
    holes = [bore(stock.screw, stock.clearance, rim, "base.screw", complex(z))[0] for z in places / turned]
    openings = [BaseOpening("the sun's shaft", "sun_stock.bore", shaft, (0j,), "A", motor=motor)]
    # Their heads and nuts are at most twice as wide.
    screw = "a screw of the ring", "base.screw", stock.screw
    openings += [BaseOpening(*screw, (complex(z),), "B", head=2 * stock.screw) for z in places]
    fits = (*(None for _ in ring.holes), *(RING_SCREWS * fits_of(stock.screw, stock.clearance)))
    held = replace(ring, holes=(*ring.holes, *holes), hole_names=("", *("B" for _ in holes)), fits=fits)
    corner = complex(outer, outer)
    return held, standing_plate((-corner, corner), openings, stock, ring.thickness)


@checked
def carrier(gears: PlanetarySet, diameters: tuple[float, float], margin: Positive, thickness: Positive) -> Part:
    """The plate that holds the planets at their distance, the sun's shaft passing its middle.

    diameters: of the holes for the shafts of sun and planets, mm.
    """
    sun, planet = diameters
    around = 1j * gears.inner.centre_distance * np.exp(2j * np.pi * np.arange(gears.planets) / gears.planets)
    outline: AbstractCurve = rounded_hull([0j, *around], max(diameters) / 2 + margin)
    holes = [*bore(sun, 0.0, 2 * gears.inner.centre_distance - planet, "sun_stock.bore")]
    holes += [Circle(complex(z), planet / 2) for z in around if planet]
    return Part("carrier", outline, tuple(holes), thickness, body="carrier")
