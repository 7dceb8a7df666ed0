"""Base plates and carriers of gears, and their assembly: the items to buy and the steps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..core.arguments import PositiveFloat, checked
from ..core.errors import DesignError
from ..core.fields import Length
from ..core.records import record
from ..core.units import mm
from ..making.assembly import (
    PLAY,
    Assembly,
    AssemblyBuilder,
    BaseOpening,
    BaseStock,
    RackBaseStock,
    collar_across,
    collar_width,
    glue_bill,
    pin_bill,
    seated,
    standing_plate,
)
from ..making.bores import AbstractBored, bore, fits_of
from ..making.materials import MaterialKey
from ..making.motors import HEADS, MountedMotorKey
from ..model.part import Part
from ..plane.curve import AbstractCurve
from ..plane.primitives import Circle, rounded_hull
from ..plane.vec import spaced_directions
from .contract import Helix
from .parts import AbstractMated, GearStock, RingStock
from .planetary import Member, PlanetarySet
from .rack import RackPair

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
    material: MaterialKey | None = None,
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
    material : Material, optional
        Material of the plate, for its mass.

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
    return standing_plate((complex(low, -tall), complex(high, tall)), openings, stock, thickness, material)


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
        problem = f"found {bar.teeth}, too few for two guide pins"
        raise DesignError("rack.teeth", problem, f"give at least {least}, or omit base")
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
    return guided, standing_plate(box, openings, stock, rack.thickness, rack.material)


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
    return drilled, standing_plate((-corner, corner), openings, stock, ring.thickness, ring.material)


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
    around = 1j * gears.inner.centre_distance * spaced_directions(gears.planets)
    outline: AbstractCurve = rounded_hull([0j, *around], max(diameters) / 2 + margin)
    holes = [*bore(sun, 0.0, 2 * gears.inner.centre_distance - planet, "sun_stock.bore")]
    holes += [Circle(complex(z), planet / 2) for z in around if planet]
    return Part("carrier", outline, tuple(holes), thickness, body="carrier")


def single_assembly(name: str, stock: GearStock) -> Assembly:
    """A single gear on a shaft or a motor."""
    if not stock.bore and stock.motor is None:
        return Assembly((), ())
    builder = AssemblyBuilder(motor=stock.motor)
    builder.shaft("", name, stock, stock.thickness, 0)
    builder.add_step(0, seated(name, "", stock) + clear(stock))
    return builder.build()


def clear(stock: AbstractBored, plate: str = "") -> str:
    """Distance of a gear from the plate of its motor, as part of a step; "" if there is a plate between."""
    return (
        "" if stock.motor is None or plate else f", {mm(HEADS):g} above motor_plate, clear of the heads of its screws"
    )


# All teeth of a gear are equal.
MESH = "any tooth in any space"


@record
class Wheel:
    """A gear on its shaft: name, letter at its bore, and stock; None for a ring."""

    name: str
    letter: str
    stock: AbstractBored | None


def pair_assembly(
    first: Wheel,
    second: Wheel,
    distance: float,
    plate: float | None,
    base: BaseStock | None = None,
    helix: Helix = Helix(),
    snaps: bool = False,
) -> Assembly:
    """Two gears in mesh, or a gear in its ring. plate: thickness of the plate that holds both shafts, mm, or None.

    snaps: whether printed pins take the place of the shafts.
    """
    wheels = (first, second)
    motor = first.stock.motor if first.stock else None
    builder = AssemblyBuilder("" if plate is None else "base", plate or 0.0, base, plate is not None, motor, snaps)
    layer = builder.lowest
    if helix.herringbone:
        builder.add_step(
            layer, f"first put {first.name} and {second.name} in mesh: herringbones do not slide into mesh"
        )
    for wheel in wheels:
        if wheel.stock is None:
            builder.add_step(layer, f"lay {wheel.name} round {first.name} in mesh, {MESH}")
            continue
        grip = (plate or 0.0) + wheel.stock.thickness
        builder.shaft(wheel.letter, wheel.name, wheel.stock, grip, layer)
        step = builder.seated(wheel.name, wheel.letter, wheel.stock) + clear(wheel.stock, builder.plate)
        if wheel is second:
            step += ", both together" if helix.herringbone else f", in mesh with {first.name}, {MESH}"
        builder.add_step(layer, step)
    if plate is None:
        builder.add_last_step(f"supply a support that holds the axes {mm(distance):.6g} apart")
    return builder.build()


def rack_assembly(stock: GearStock, distance: float, base: RackBaseStock | None, helix: Helix = Helix()) -> Assembly:
    """A pinion and its rack. distance: from the pinion's axis to the rack's reference line, mm."""
    thick = stock.thickness
    builder = AssemblyBuilder("" if base is None else "base", thick, base, base is not None, stock.motor)
    layer = builder.lowest
    builder.shaft("A", "pinion", stock, thick * (1 if base is None else 2), layer)
    if base is None:
        builder.add_step(layer, seated("pinion", "", stock) + clear(stock))
        builder.add_step(layer, f"lay rack in mesh with pinion, {MESH}")
        builder.add_last_step(f"supply a guide for rack, with its reference line {mm(distance):.6g} from the axis")
        return builder.build()
    builder.add_step(layer, "glue 2 pins B into rack, flush at the top")
    builder.pins("B", "rack", base.guide_pin, 2 * thick, 2, under=True)
    if helix.herringbone:
        builder.add_step(layer, "first put pinion and rack in mesh, then lay both together")
    rack = "lay rack, with its pins through the slot B of base; fit 2 collars on B below base, with play to slide"
    builder.add_step(layer, rack)
    builder.add_step(layer, f"{seated('pinion', 'A', stock)}, in mesh with rack, {MESH}")
    return builder.build()


def planetary_assembly(
    gears: PlanetarySet,
    stocks: tuple[GearStock, GearStock, RingStock],
    base: BaseStock | None,
    helix: Helix = Helix(),
    fixed: Member = "ring",
) -> Assembly:
    """A planetary set. Planets with shafts have a carrier: above the gears with a base, below them without one."""
    sun, planet, ring = stocks
    carrier, has_base = planet.thickness if planet.bore else 0.0, base is not None
    if has_base:
        builder = AssemblyBuilder("base", ring.thickness, base, True, sun.motor)
    else:
        builder = AssemblyBuilder("carrier" if carrier else "", carrier, None, False, sun.motor)
    layer, top = builder.lowest, builder.lowest + (1 if has_base and carrier else 0)
    on_sun, on_planet = ("A", "C") if has_base else ("", "")
    builder.shaft("A", "sun", sun, (ring.thickness if has_base else 0.0) + sun.thickness + carrier, top)
    turning = turns_with_shaft(planet)
    if carrier and not turning and not has_base:
        builder.add_step(0, f"glue {_shafts(gears.planets, '')} into carrier, flush at the bottom")
    builder.add_step(layer, seated("sun", on_sun, sun) + clear(sun, builder.plate))
    if base is not None:
        screws = f"put {RING_SCREWS} screws B through it from above, with a washer and a nut on each from below"
        builder.add_step(layer, f"lay ring; {screws}")
        builder.screws("B", base.screw, 2 * ring.thickness, RING_SCREWS)
    else:
        builder.add_step(layer, "lay ring round sun")
        held = "" if fixed == "ring" else f"; ring turns, and {fixed} is held"
        builder.add_last_step(f"supply a support for ring, and for the shaft of sun at its centre{held}")
    if carrier and turning:
        builder.add_step(layer, f"{seated('each planet', f'a shaft {on_planet}'.rstrip(), planet)}, flush with it")
    builder.add_step(layer, _planets(gears, helix))
    if carrier:
        _add_carrier(builder, gears.planets, planet, top, has_base)
    return builder.build()


def _add_carrier(builder: AssemblyBuilder, count: int, planet: GearStock, layer: int, has_base: bool) -> None:
    """The shafts of planets, their collars, and the carrier if it lies above the gears. count: of planets."""
    turning = turns_with_shaft(planet)
    # Glued shafts end flush with carrier and planets; a shaft that turns, or holds a planet from above, has a collar.
    has_collars, is_free_below = turning or not has_base, turning and not has_base
    if is_free_below:
        builder.keep_free_below(collar_width(planet.bore))
    planets = builder.joint_name("C", "planet")
    builder.planet_shafts(planets, planet, 2 * planet.thickness, count, has_collars)
    if not turning:
        builder.buy(planets, glue_bill(count))
    if has_base:
        if not turning:
            step = f"glue {_shafts(count, 'C')} into carrier so that {mm(planet.thickness):g} project below"
            builder.add_step(layer, step)
        builder.add_step(layer, "lay carrier on A and C" if turning else "lay carrier on A, with C in the planets")
    if has_collars:
        plural = "s" if count > 1 else ""
        shafts = "C" if has_base else f"the shaft{plural} of planet"
        below = " below carrier" if is_free_below else ""
        builder.add_step(layer, f"fit {count} collar{plural} on {shafts}{below}")


def turns_with_shaft(stock: AbstractBored) -> bool:
    """Whether a wheel is fixed to its shaft, by a press fit, a flat or a key, so that the shaft turns with it."""
    return stock.is_pressed or stock.across_flat is not None or bool(stock.keyway[0])


def _shafts(count: int, letter: str) -> str:
    shafts = f"shafts {letter}".rstrip() if count > 1 else f"shaft {letter}".rstrip()
    return f"{count} {shafts}" + ("" if letter else " of planet")


def _planets(gears: PlanetarySet, helix: Helix) -> str:
    count, sun, ring = gears.planets, gears.sun.teeth, gears.ring.teeth
    if count == 1:
        step = "lay planet between sun and ring: turn sun until it slides in"
    else:
        step = (
            f"lay {count} x planet between sun and ring, evenly spaced: turn sun until the first slides in; the others "
            f"then fit too, as {sun} + {ring} teeth are divisible by {count}"
        )
    if helix.herringbone:
        step += "; herringbones do not slide into mesh: make ring in two halves and lay one on from each side"
    return step


def lantern_assembly(
    stock: AbstractMated, pin: float, count: int, ring: bool, distance: float, base: BaseStock | None
) -> Assembly:
    """A lantern pinion, and its wheel or ring between the two discs. pin: diameter, mm; count: of pins."""
    thick = stock.thickness
    builder = AssemblyBuilder("" if base is None else "base", thick, base, base is not None, stock.motor)
    layer, under = builder.lowest, 0.0 if base is None else thick
    on_disc, on_mate, mate = ("A", "B", "mate") if base is not None else ("", "", "ring" if ring else "mate")
    builder.shaft("A", "disc", stock, under + 3 * thick + PLAY, layer + 2, keys=2)
    builder.buy("disc", (*pin_bill(pin, 3 * thick + PLAY, count), *glue_bill(2 * count)))
    builder.add_step(layer, f"glue {count} pins into the first disc, flush at the bottom")
    builder.add_step(layer, seated("it", on_disc, stock) + clear(stock, builder.plate))
    if ring:
        builder.add_step(layer + 1, f"lay ring round the pins, {MESH}")
    else:
        gap = thick if builder.plate else 0.0
        builder.shaft("B", mate, stock.mate, under + gap + thick, layer + 1, gap)
        builder.add_step(layer + 1, f"{seated(mate, on_mate, stock.mate)}, with its teeth between the pins")
    room = f"{mm(thick + PLAY):g} above the first, so that {mate} turns between them"
    builder.add_step(layer + 2, f"glue the second disc onto the pins{_second_disc(stock)}, {room}")
    if base is None:
        builder.add_last_step(f"supply a support that holds the axes {mm(distance):.6g} apart")
    return builder.build()


def _second_disc(stock: AbstractBored) -> str:
    """End of an assembly step: the alignment of a second disc on its shaft."""
    if stock.across_flat is not None:
        return ", its flat on that of the shaft"
    return ", with its own key" if stock.keyway[0] else ""
