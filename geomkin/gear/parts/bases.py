"""Base plates of gear pairs, racks and planetary sets, and carriers of planets."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...core.arguments import PositiveFloat, checked
from ...core.errors import DesignError
from ...core.fields import Length
from ...making.assembly import BaseOpening, BaseStock, RackBaseStock, collar_across, standing_plate
from ...making.bores import bore, fits_of
from ...making.motors import MountedMotorKey
from ...model.part import Part
from ...plane.curve import AbstractCurve
from ...plane.primitives import Circle, rounded_hull
from ..planetary import PlanetarySet
from ..rack import RackPair

# Least distance between a rack's two guide pins, in thicknesses of its bar under the teeth. With less the rack tilts in
# the play of the slot; more needs longer racks.
LEAST_PIN_DISTANCE = 2.0
# Number of screws that hold a ring, evenly spaced: the fewest that keep it flat.
RING_SCREWS = 6


@checked
def pair_base(
    distance: PositiveFloat,
    reaches: tuple[Length, Length],
    shafts: tuple[Length, Length],
    thickness: PositiveFloat,
    stock: BaseStock = BaseStock(),
    keys: tuple[str, str] = ("first_stock.bore", "second_stock.bore"),
    motor: MountedMotorKey | None = None,
) -> Part:
    """The base plate of two wheels.

    Parameters
    ----------
    distance : float
        Distance of the axes, mm, above 0. The first shaft is at the origin (letter A), the second on +x (letter B).
    reaches : tuple of float
        Largest radius of each wheel, mm.
    shafts : tuple of float
        Diameter of each shaft, mm.
    thickness : float
        Thickness of the plate, mm, above 0.
    stock : BaseStock, optional
        Screws, edge and clearance.
    keys : tuple of str, optional
        Keys of the diameters in the recipe, for messages.
    motor : str or MotorFace, optional
        Motor of the first shaft; the plate then has holes for it.

    Returns
    -------
    Part
        The base, of the body "ground".

    Raises
    ------
    DesignError
        If a diameter is 0, the holes meet, or the second hole lies over the motor.
    """
    axes = (0j, complex(distance))
    openings = [
        BaseOpening("a gear's shaft", key, shaft, (axis,), letter, head=collar_across(shaft), motor=below)
        for key, shaft, axis, letter, below in zip(keys, shafts, axes, "AB", (motor, None))
    ]
    # If one wheel surrounds the other, the larger one determines the box.
    low, high = (f(side * r + z.real for z, r in zip(axes, reaches)) for f, side in ((min, -1), (max, 1)))
    tall = max(reaches)
    return standing_plate((complex(low, -tall), complex(high, tall)), openings, stock, thickness)


@checked
def rack_base(
    pair: RackPair,
    rack: Part,
    shaft: Length,
    stock: RackBaseStock = RackBaseStock(),
    motor: MountedMotorKey | None = None,
) -> tuple[Part, Part]:
    """The rack with two guide pins, and the base plate of rack and pinion.

    Parameters
    ----------
    pair : RackPair
        The pinion and its rack.
    rack : Part
        Plate of the rack without the holes of the pins.
    shaft : float
        Diameter of the pinion's shaft, mm.
    stock : RackBaseStock, optional
        Screws, edge, clearance and guide pins.
    motor : str or MotorFace, optional
        Motor of the pinion; the base then has holes for it.

    Returns
    -------
    tuple of Part
        The rack with its holes, and the base: the pinion's shaft at the origin (letter A) and the slot of the pins
        (letter B). The slot lets the rack move until the pinion's axis is opposite the centre of an outer tooth.

    Raises
    ------
    DesignError
        If the rack is too short or too thin for the pins, or the slot lies over the motor.

    Notes
    -----
    Derived here.
    """
    bar, pinion = pair.rack, pair.pinion
    middle = -1j * (bar.root_depth + bar.solid_rim / 2)
    # As far from the ends as from the back.
    left, right = (end - side * bar.solid_rim / 2 for side, end in zip((-1, 1), bar.ends))
    if right - left < LEAST_PIN_DISTANCE * bar.solid_rim:
        least = int(np.ceil((LEAST_PIN_DISTANCE + 1) * bar.solid_rim / bar.pitch))
        raise DesignError(
            "rack.teeth", f"found {bar.teeth}, too few for two guide pins", f"give at least {least}, or omit base"
        )
    pins = [
        bore(stock.guide_pin, stock.clearance, bar.solid_rim, "base.guide_pin", x + middle)[0] for x in (left, right)
    ]
    first, last = (end - side * bar.pitch / 2 for side, end in zip((-1, 1), bar.ends))
    slide, pin, collar = (
        middle - 1j * pair.distance,
        ("base.guide_pin", stock.guide_pin),
        collar_across(stock.guide_pin),
    )
    openings = [
        BaseOpening("the pinion's shaft", "stock.bore", shaft, (0j,), "A", motor=motor),
        BaseOpening("the guide pins", *pin, (slide + left - last, slide + right - first), "B", head=collar),
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
    rim: PositiveFloat,
    shaft: Length,
    stock: BaseStock = BaseStock(),
    motor: MountedMotorKey | None = None,
) -> tuple[Part, Part]:
    """The ring with screw holes in its rim, and the base plate of a planetary set.

    Parameters
    ----------
    gears : PlanetarySet
        The gears.
    ring : Part
        Plate of the ring without the screw holes.
    rim : float
        Width of the ring outside its teeth, mm, above 0.
    shaft : float
        Diameter of the sun's shaft, mm.
    stock : BaseStock, optional
        Screws, edge and clearance.
    motor : str or MotorFace, optional
        Motor of the sun; the base then has holes for it.

    Returns
    -------
    tuple of Part
        The ring with its holes, and the base: the sun's shaft at the origin (letter A) and the screws of the ring
        (letter B). The base is under the gears, the carrier above them.

    Raises
    ------
    DesignError
        If the rim or the sun is too small, or the ring's screws lie over the motor.

    Notes
    -----
    Derived here.
    """
    if not stock.screw:
        raise DesignError("base.screw", "found 0 mm, but the ring is held by screws", "give their diameter", "conflict")
    outer = gears.ring.root_radius + rim
    places = (outer - rim / 2) * np.exp(2j * np.pi * (np.arange(RING_SCREWS) + 0.5) / RING_SCREWS)
    # The ring is rotated by a part of a pitch, so that its teeth mesh with the planets.
    turned = complex(np.asarray(gears.poses(0.0)[2].direction))
    holes = [bore(stock.screw, stock.clearance, rim, "base.screw", complex(z))[0] for z in places / turned]
    openings = [BaseOpening("the sun's shaft", "sun_stock.bore", shaft, (0j,), "A", motor=motor)]
    # Heads and nuts are at most twice as wide as the screws.
    screw = "a screw of the ring", "base.screw", stock.screw
    openings += [BaseOpening(*screw, (complex(z),), "B", head=2 * stock.screw) for z in places]
    fits = (*(None for _ in ring.holes), *(RING_SCREWS * fits_of(stock.screw, stock.clearance)))
    drilled = replace(ring, holes=(*ring.holes, *holes), hole_names=("", *("B" for _ in holes)), fits=fits)
    corner = complex(outer, outer)
    return drilled, standing_plate((-corner, corner), openings, stock, ring.thickness)


@checked
def carrier(
    gears: PlanetarySet, diameters: tuple[float, float], margin: PositiveFloat, thickness: PositiveFloat
) -> Part:
    """The carrier: a plate that holds the planets at their distance from the sun.

    Parameters
    ----------
    gears : PlanetarySet
        The gears.
    diameters : tuple of float
        Diameters of the holes for the shafts of sun and planets, mm; 0 for no hole.
    margin : float
        Width of the plate outside the widest hole, mm, above 0.
    thickness : float
        Thickness of the plate, mm, above 0.

    Returns
    -------
    Part
        The plate, of the body "carrier", with the sun's axis at the origin.
    """
    sun, planet = diameters
    around = 1j * gears.inner.centre_distance * np.exp(2j * np.pi * np.arange(gears.planets) / gears.planets)
    outline: AbstractCurve = rounded_hull([0j, *around], max(diameters) / 2 + margin)
    holes = [*bore(sun, 0.0, 2 * gears.inner.centre_distance - planet, "sun_stock.bore")]
    holes += [Circle(complex(z), planet / 2) for z in around if planet]
    return Part("carrier", outline, tuple(holes), thickness, body="carrier")
