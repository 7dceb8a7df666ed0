"""Gear blanks."""

from __future__ import annotations

from dataclasses import dataclass

from ..gear.spur import SpurGear
from ..part import Part
from ..sizes import check_sizes, quantity
from .bore import bore


@dataclass(frozen=True)
class GearStock:
    """What a gear is cut from."""

    thickness: float = quantity("thickness of the sheet", "mm", default=6.0, at_least=0.01, at_most=1000)
    bore: float = quantity("diameter of the hole for the shaft, 0 for none", "mm", default=0.0, at_least=0)

    def __post_init__(self) -> None:
        check_sizes(self)


def gear_parts(gear: SpurGear, stock: GearStock) -> list[Part]:
    """The gear about its axis."""
    hole = bore(stock.bore, 2 * gear.root_radius, "stock.bore")
    return [Part("gear", gear.outline, hole, stock.thickness)]
