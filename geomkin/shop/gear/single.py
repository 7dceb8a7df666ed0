"""How a gear by itself goes on its shaft, or on a motor."""

from __future__ import annotations

from ..assembling import Assembling, Assembly, seated
from ..fits import AbstractBored
from .gears import GearStock

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
