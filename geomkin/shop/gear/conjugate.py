"""Plates of mates by the law of gearing and of the gears that shape them, and lantern pinions."""

from __future__ import annotations

from dataclasses import dataclass, replace

from ...arguments import checked
from ...brief import one_line
from ...errors import DesignError
from ...gear.conjugate.conjugate import Conjugate
from ...gear.conjugate.lantern import LanternPinion
from ...gear.contract import AbstractGear
from ...part import Part
from ...plane.primitives import Circle
from ...sizes import FARTHEST, quantity
from ..bore import clearance, fits_of, shaft
from .gears import plate_of
from .mated import AbstractMated


@dataclass(frozen=True)
class PairStock(AbstractMated):
    """What a gear and its mate are cut from, and how they sit on their shafts."""

    __repr__ = one_line


@dataclass(frozen=True)
class LanternStock(AbstractMated):
    """What a lantern pinion's discs and its wheel are cut from, and how they sit on their shafts; the pins are rods.

    The wheel is the pinion's mate.
    """

    bore: float = shaft("the pinion's shaft", 8.0, fitted=True)
    clearance: float = clearance(0.1)
    edge: float = quantity("width of a disc outside its pins", "mm", default=4.0, at_least=0.01, at_most=FARTHEST)

    __repr__ = one_line


@checked
def pair_parts(gear: AbstractGear, mate: Conjugate, stock: PairStock) -> tuple[Part, ...]:
    """The gear and the mate that it has shaped, each about its own axis; flat or keyway of a bore lie towards +y."""
    holes = stock.hole(1j, gear.hole_room, "stock")
    plate = plate_of(gear, "gear", holes, stock.thickness, stock.rim)
    return replace(plate, fits=() if gear.is_ring else stock.fits), _mate(mate, stock)


@checked
def lantern_parts(pinion: LanternPinion, mate: Conjugate, stock: LanternStock) -> tuple[Part, ...]:
    """The pinion's two discs with holes for its pins, and the wheel.

    Flat or keyway of the discs' bores lie towards a pin, that of the wheel's towards +y.
    """
    hole = pinion.pin_diameter / 2 + stock.clearance / 2
    apart = abs(pinion.circles[1].centre - pinion.circles[0].centre) - 2 * hole
    if apart <= 0:
        raise DesignError(
            "stock.clearance",
            f"found {stock.clearance:g} mm, with which the pins' holes run into each other",
            f"give less than {stock.clearance + apart:.4g} mm, or thinner pins",
        )
    pins = tuple(Circle(c.centre, hole) for c in pinion.circles)
    first = pinion.circles[0].centre
    middle = stock.hole(first / abs(first), 2 * (pinion.pitch_radius - hole), "stock")
    outer = Circle(0j, pinion.pitch_radius + pinion.pin_diameter / 2 + stock.clearance / 2 + stock.edge)
    fits = (*stock.fits, *(len(pins) * fits_of(pinion.pin_diameter, stock.clearance)))
    disc = Part("disc", outer, (*middle, *pins), stock.thickness, count=2, body="pinion", fits=fits)
    return disc, _mate(mate, stock)


def _mate(mate: Conjugate, stock: PairStock | LanternStock) -> Part:
    if mate.is_ring:
        return plate_of(mate, "ring", (), stock.thickness, stock.rim)
    hole = stock.mate_hole(1j, mate.hole_room, "stock")
    return replace(plate_of(mate, "mate", hole, stock.thickness, stock.rim), fits=stock.mate.fits)
