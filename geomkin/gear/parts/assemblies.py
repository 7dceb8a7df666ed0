"""Assemblies of gears: the items to buy and the steps for single gears, pairs, racks, planetary sets and lanterns."""

from __future__ import annotations

from ...core.records import record
from ...making.assembly import (
    PLAY,
    Assembly,
    AssemblyBuilder,
    BaseStock,
    RackBaseStock,
    collar_width,
    glue_bill,
    pin_bill,
    seated,
)
from ...making.bores import AbstractBored
from ..helix import Helix
from ..planetary import Member, PlanetarySet
from .bases import RING_SCREWS
from .conjugate import AbstractMated
from .gears import GearStock, RingStock

# Distance of a gear from the plate of its motor, mm: above the heads of the screws.
HEADS = 2.0


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
    return "" if stock.motor is None or plate else f", {HEADS:g} mm above motor_plate, clear of the heads of its screws"


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
) -> Assembly:
    """Two gears in mesh, or a gear in its ring. plate: thickness of the plate that holds both shafts, mm, or None."""
    wheels = (first, second)
    motor = first.stock.motor if first.stock else None
    builder = AssemblyBuilder("" if plate is None else "base", plate or 0.0, base, plate is not None, motor)
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
        step = seated(wheel.name, wheel.letter if builder.lettered else "", wheel.stock) + clear(
            wheel.stock, builder.plate
        )
        if wheel is second:
            step += ", both together" if helix.herringbone else f", in mesh with {first.name}, {MESH}"
        builder.add_step(layer, step)
    if plate is None:
        builder.add_last_step(f"supply a support that holds the axes {distance:.6g} mm apart")
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
        builder.add_last_step(f"supply a guide for rack, with its reference line {distance:.6g} mm from the axis")
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
            step = f"glue {_shafts(count, 'C')} into carrier so that {planet.thickness:g} mm project below"
            builder.add_step(layer, step)
        builder.add_step(layer, "lay carrier on A and C" if turning else "lay carrier on A, with C in the planets")
    if has_collars:
        plural = "s" if count > 1 else ""
        shafts = "C" if has_base else f"the shaft{plural} of planet"
        below = " below carrier" if is_free_below else ""
        builder.add_step(layer, f"fit {count} collar{plural} on {shafts}{below}")


def turns_with_shaft(stock: AbstractBored) -> bool:
    """Whether a wheel is fixed to its shaft, by a press fit, a flat or a key, so that the shaft turns with it."""
    return stock.fit == "press" or stock.across_flat is not None or bool(stock.keyway[0])


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
    room = f"{thick + PLAY:g} mm above the first, so that {mate} turns between them"
    builder.add_step(layer + 2, f"glue the second disc onto the pins{_second_disc(stock)}, {room}")
    if base is None:
        builder.add_last_step(f"supply a support that holds the axes {distance:.6g} mm apart")
    return builder.build()


def _second_disc(stock: AbstractBored) -> str:
    """End of an assembly step: the alignment of a second disc on its shaft."""
    if stock.across_flat is not None:
        return ", its flat on that of the shaft"
    return ", with its own key" if stock.keyway[0] else ""
