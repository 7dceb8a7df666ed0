"""How a gear by itself goes on its shaft, or on a motor."""

from __future__ import annotations

from ...core.records import record
from ...making.assembly import PLAY, Assembling, Assembly, collar_width, pin_bill, seated
from ...making.bases import BaseStock, RackBaseStock
from ...making.fits import AbstractBored
from ..helix import Helix
from ..planetary import PlanetarySet
from .bases import RING_SCREWS
from .conjugate import AbstractMated
from .gears import GearStock, RingStock

# mm between a motor's plate and a gear on its shaft: over the heads of the screws.
HEADS = 2.0


def single_assembly(name: str, stock: GearStock) -> Assembly:
    """A gear by itself, on a shaft or a motor."""
    if not stock.bore and stock.motor is None:
        return Assembly((), ())
    told = Assembling(motor=stock.motor)
    told.shaft("", name, stock, stock.thickness, 0)
    told.tell(0, seated(name, "", stock) + clear(stock))
    return told.told()


def clear(stock: AbstractBored, plate: str = "") -> str:
    """How far a gear is from the plate of its motor, where no other plate lies between."""
    return "" if stock.motor is None or plate else f", {HEADS:g} mm above motor_plate, clear of the heads of its screws"


# Teeth are alike, and so are the spaces between them.
MESH = "any tooth in any space"


@record
class Wheel:
    """A gear on its shaft: name, letter at its bore, and stock; a ring has none."""

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
    """Two gears in mesh, or a gear in its ring.

    distance: of the axes, mm; plate: thickness of what holds both shafts, None where nothing does.
    """
    wheels = (first, second)
    motor = first.stock.motor if first.stock else None
    told = Assembling("" if plate is None else "base", plate or 0.0, base, plate is not None, motor)
    layer = told.lowest
    if helix.herringbone:
        told.tell(layer, f"put {first.name} and {second.name} in mesh beside it: herringbones do not slide into mesh")
    for wheel in wheels:
        if wheel.stock is None:
            told.tell(layer, f"lay {wheel.name} round {first.name} in mesh, {MESH}")
            continue
        grip = (plate or 0.0) + wheel.stock.thickness
        told.shaft(wheel.letter, wheel.name, wheel.stock, grip, layer)
        words = seated(wheel.name, wheel.letter if told.lettered else "", wheel.stock) + clear(wheel.stock, told.plate)
        if wheel is second:
            words += ", both together" if helix.herringbone else f", in mesh with {first.name}, {MESH}"
        told.tell(layer, words)
    if plate is None:
        told.end(f"hold the axes {distance:.6g} mm apart: no plate here does")
    return told.told()


def rack_assembly(stock: GearStock, distance: float, base: RackBaseStock | None, helix: Helix = Helix()) -> Assembly:
    """A pinion and its rack. distance: of the pinion's axis from the rack's reference line, mm."""
    thick = stock.thickness
    told = Assembling("" if base is None else "base", thick, base, base is not None, stock.motor)
    layer = told.lowest
    told.shaft("A", "pinion", stock, thick * (1 if base is None else 2), layer)
    if base is None:
        told.tell(layer, seated("pinion", "", stock) + clear(stock))
        told.tell(layer, f"lay rack in mesh with pinion, {MESH}")
        told.end(f"guide rack with its reference line {distance:.6g} mm from the axis: no plate here does")
        return told.told()
    told.tell(layer, "glue 2 pins B into rack, flush above")
    told.pins("B", "rack", base.guide_pin, 2 * thick, 2, under=True)
    if helix.herringbone:
        told.tell(layer, "put pinion and rack in mesh beside it, and lay them on together")
    told.tell(layer, "lay rack, its pins through the slot B of base; 2 collars on B from below, with room to slide")
    told.tell(layer, f"{seated('pinion', 'A', stock)}, in mesh with rack, {MESH}")
    return told.told()


def planetary_assembly(
    gears: PlanetarySet,
    stocks: tuple[GearStock, GearStock, RingStock],
    base: BaseStock | None,
    helix: Helix = Helix(),
) -> Assembly:
    """Sun, planets and ring, and the carrier where planets have shafts: over them on a base, under them without one.

    stocks: of the three.
    """
    sun, planet, ring = stocks
    carried, stands = planet.thickness if planet.bore else 0.0, base is not None
    if stands:
        told = Assembling("base", ring.thickness, base, True, sun.motor)
    else:
        told = Assembling("carrier" if carried else "", carried, None, False, sun.motor)
    layer, top = told.lowest, told.lowest + (1 if stands and carried else 0)
    on_sun, on_planet = ("A", "C") if stands else ("", "")
    told.shaft("A", "sun", sun, (ring.thickness if stands else 0.0) + sun.thickness + carried, top)
    turning = turns_with_shaft(planet)
    if carried and not turning and not stands:
        told.tell(0, f"glue {_shafts(gears.planets, '')} into carrier, flush below")
    told.tell(layer, seated("sun", on_sun, sun) + clear(sun, told.plate))
    if stands:
        assert base is not None
        held = f"{RING_SCREWS} screws B through it from above, a washer and a nut on each from below"
        told.tell(layer, f"lay ring; {held}")
        told.screws("B", base.screw, 2 * ring.thickness, RING_SCREWS)
    else:
        told.tell(layer, "lay ring round it")
        told.end("hold ring, and the shaft of sun in its middle: no plate here does")
    if carried and turning:
        told.tell(layer, f"{seated('each planet', f'a shaft {on_planet}'.rstrip(), planet)}, flush with it")
    told.tell(layer, _planets(gears, helix))
    if not carried:
        return told.told()
    # Glued, shafts end with carrier and planets; turning in the carrier, or under the planets, each has a collar.
    collars, below = turning or not stands, " from below" if turning and not stands else ""
    if below:
        told.room(collar_width(planet.bore))
    told.planet_shafts(told.mark("C", "planet"), planet, 2 * carried, gears.planets, collars)
    if stands and not turning:
        told.tell(top, f"glue {_shafts(gears.planets, 'C')} into carrier, {planet.thickness:g} mm out of it below")
    if stands:
        told.tell(top, "lay carrier on A, C in the planets" if not turning else "lay carrier on A and C")
    if collars:
        several = "s" if gears.planets > 1 else ""
        told.tell(top, f"{gears.planets} collar{several} on {on_planet or f'the shaft{several} of planet'}{below}")
    return told.told()


def turns_with_shaft(stock: AbstractBored) -> bool:
    """Whether a wheel holds its shaft, by a press fit, a flat or a key, so that the shaft turns in what carries it."""
    return stock.fit == "press" or stock.across_flat is not None or bool(stock.keyway[0])


def _shafts(count: int, letter: str) -> str:
    named = f"shafts {letter}".rstrip() if count > 1 else f"shaft {letter}".rstrip()
    return f"{count} {named}" + ("" if letter else " of planet")


def _planets(gears: PlanetarySet, helix: Helix) -> str:
    """How planets find their teeth."""
    count, sun, ring = gears.planets, gears.sun.teeth, gears.ring.teeth
    if count == 1:
        words = "lay planet between sun and ring: it turns sun until it goes in"
    else:
        words = (
            f"lay {count} x planet between sun and ring, evenly round: the first turns sun until it goes in, and so do "
            f"the others, for {sun} + {ring} teeth divide by {count}"
        )
    if helix.herringbone:
        words += "; herringbones do not slide into mesh: make ring in two halves, one laid on from either side"
    return words


def lantern_assembly(
    stock: AbstractMated, pin: float, count: int, ring: bool, distance: float, base: BaseStock | None
) -> Assembly:
    """A lantern pinion and its wheel, or ring, between the two discs. pin: diameter, mm; count: of pins."""
    thick = stock.thickness
    told = Assembling("" if base is None else "base", thick, base, base is not None, stock.motor)
    layer, under = told.lowest, 0.0 if base is None else thick
    on_disc, on_mate, mate = ("A", "B", "mate") if base is not None else ("", "", "ring" if ring else "mate")
    told.shaft("A", "disc", stock, under + 3 * thick + PLAY, layer + 2, keys=2)
    told.buy("disc", pin_bill(pin, 3 * thick + PLAY, count))
    told.tell(layer, f"glue {count} pins into the first disc, flush below")
    told.tell(layer, seated("it", on_disc, stock) + clear(stock, told.plate))
    if ring:
        told.tell(layer + 1, f"lay ring round the pins, {MESH}")
    else:
        gap = thick if told.plate else 0.0
        told.shaft("B", mate, stock.mate, under + gap + thick, layer + 1, gap)
        told.tell(layer + 1, f"{seated(mate, on_mate, stock.mate)}, its teeth between the pins")
    room = f"{thick + PLAY:g} mm over the first, so that {mate} turns between them"
    told.tell(layer + 2, f"glue the second disc on the pins{_alike(stock)}, {room}")
    if base is None:
        told.end(f"hold the axes {distance:.6g} mm apart: no plate here does")
    return told.told()


def _alike(stock: AbstractBored) -> str:
    """How a second disc on a shaft is turned."""
    if stock.across_flat is not None:
        return ", its flat on that of the shaft"
    return ", with a key of its own" if stock.keyway[0] else ""
