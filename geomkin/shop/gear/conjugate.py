"""Plates of mates by the law of gearing and of the gears that shape them, and lantern pinions."""

from __future__ import annotations

from dataclasses import dataclass

from ...arguments import checked
from ...errors import DesignError
from ...gear.conjugate.conjugate import Conjugate
from ...gear.conjugate.lantern import LanternPinion
from ...gear.contract import AbstractGear
from ...part import Part
from ...plane.primitives import Circle
from ...sizes import FARTHEST, check_sizes, quantity
from ..bore import bore, clearance, shaft
from .gears import plate_of


@dataclass(frozen=True)
class PairStock:
    """What a gear and its mate are cut from."""

    thickness: float = quantity("thickness of the sheet", "mm", default=6.0, at_least=0.01, at_most=1000)
    bore: float = shaft("the gear's shaft", 8.0)
    mate_bore: float = shaft("the mate's shaft", 8.0)
    clearance: float = clearance(0.0)
    rim: float = quantity("width of a ring outside its teeth", "mm", default=8.0, at_least=0.01, at_most=FARTHEST)

    def __post_init__(self) -> None:
        check_sizes(self)


@dataclass(frozen=True)
class LanternStock:
    """What a lantern pinion's discs and its wheel are cut from; the pins are rods."""

    thickness: float = quantity("thickness of the sheet", "mm", default=6.0, at_least=0.01, at_most=1000)
    bore: float = shaft("the pinion's shaft", 8.0)
    mate_bore: float = shaft("the wheel's shaft", 8.0)
    clearance: float = clearance(0.1)
    edge: float = quantity("width of a disc outside its pins", "mm", default=4.0, at_least=0.01, at_most=FARTHEST)
    rim: float = quantity("width of a ring outside its teeth", "mm", default=8.0, at_least=0.01, at_most=FARTHEST)

    def __post_init__(self) -> None:
        check_sizes(self)


@checked
def pair_parts(gear: AbstractGear, mate: Conjugate, stock: PairStock) -> tuple[Part, ...]:
    """The gear and the mate that it has shaped, each about its own axis."""
    holes = bore(stock.bore, stock.clearance, gear.hole_room, "stock.bore")
    return plate_of(gear, "gear", holes, stock.thickness, stock.rim), _mate(mate, stock)


@checked
def lantern_parts(pinion: LanternPinion, mate: Conjugate, stock: LanternStock) -> tuple[Part, ...]:
    """The pinion's two discs with holes for its pins, and the wheel."""
    hole = pinion.pin_diameter / 2 + stock.clearance / 2
    apart = abs(pinion.circles[1].centre - pinion.circles[0].centre) - 2 * hole
    if apart <= 0:
        raise DesignError(
            "stock.clearance",
            f"found {stock.clearance:g} mm, with which the pins' holes run into each other",
            f"give less than {stock.clearance + apart:.4g} mm, or thinner pins",
        )
    pins = tuple(Circle(c.centre, hole) for c in pinion.circles)
    middle = bore(stock.bore, stock.clearance, 2 * (pinion.pitch_radius - hole), "stock.bore")
    outer = Circle(0j, pinion.pitch_radius + pinion.pin_diameter / 2 + stock.clearance / 2 + stock.edge)
    return Part("disc", outer, (*middle, *pins), stock.thickness, count=2, body="pinion"), _mate(mate, stock)


def _mate(mate: Conjugate, stock: PairStock | LanternStock) -> Part:
    if mate.is_ring:
        return plate_of(mate, "ring", (), stock.thickness, stock.rim)
    hole = bore(stock.mate_bore, stock.clearance, mate.hole_room, "stock.mate_bore")
    return plate_of(mate, "mate", hole, stock.thickness, stock.rim)
