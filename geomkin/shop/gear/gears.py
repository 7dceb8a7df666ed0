"""Gear blanks: wheels, rings, racks, and the plates that hold them at their distances."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...errors import DesignError
from ...gear.gear_rack import GearRack
from ...gear.planetary import PlanetarySet
from ...gear.ring import RingGear
from ...gear.spur import SpurGear
from ...part import Part
from ...plane.curve import AbstractCurve
from ...plane.primitives import Circle, rounded_hull
from ...sizes import FARTHEST, check_sizes, entry, quantity
from ..bore import bore, clearance, shaft, widened
from ..keyway import keyed_bore
from .spokes import Web, openings


@dataclass(frozen=True)
class GearStock:
    """What a gear is cut from."""

    thickness: float = quantity("thickness of the sheet", "mm", default=6.0, at_least=0.01, at_most=1000)
    bore: float = shaft("the shaft", 0.0)
    keyway_width: float = quantity(
        "width of the keyway in the bore, 0 for none", "mm", default=0.0, at_least=0, at_most=FARTHEST
    )
    keyway_depth: float = quantity(
        "depth of the keyway beyond the bore, along its middle", "mm", default=0.0, at_least=0, at_most=FARTHEST
    )
    clearance: float = clearance(0.0)
    web: Web | None = entry("openings between hub and rim; left out, none", default=None)

    def __post_init__(self) -> None:
        check_sizes(self)

    @property
    def hole_diameter(self) -> float:
        """Diameter of the hole, mm, 0 for none."""
        return widened(self.bore, self.clearance)

    @property
    def hole_reach(self) -> float:
        """Radius, mm, within which hole and keyway lie."""
        return float(abs(self.hole_diameter / 2 + self.keyway_depth + 0.5j * self.keyway_width))

    def rim_under(self, gear: SpurGear) -> float:
        """What holds a gear's teeth: the thickness under them, mm."""
        return gear.root_radius - self.hole_reach if self.web is None else self.web.rim


@dataclass(frozen=True)
class RingStock:
    """What a ring gear is cut from."""

    thickness: float = quantity("thickness of the sheet", "mm", default=6.0, at_least=0.01, at_most=1000)
    rim: float = quantity("thickness of the ring outside its teeth", "mm", default=8.0, at_least=0.1, at_most=FARTHEST)

    def __post_init__(self) -> None:
        check_sizes(self)


def gear_parts(gear: SpurGear, stock: GearStock, name: str = "gear", key: str = "stock", count: int = 1) -> list[Part]:
    """The gear about its axis. key: of the stock in a recipe; count: how many to make."""
    widest = 2 * gear.root_radius
    # The keyway stands under the tooth on +y, so that the gear is put on its shaft with that tooth known.
    hole = keyed_bore(stock.bore, stock.clearance, stock.keyway_width, stock.keyway_depth, 1j, widest, key)
    cut = openings(stock.web, stock.hole_reach if hole else 0.0, gear.root_radius, f"{key}.web")
    return [Part(name, gear.outline, (*hole, *cut), stock.thickness, count=count, body=name)]


def ring_part(ring: RingGear, stock: RingStock) -> Part:
    """The ring: a round plate, the teeth its hole."""
    return Part("ring", Circle(0j, ring.root_radius + stock.rim), (ring.outline,), stock.thickness, body="ring")


def rack_part(rack: GearRack, thickness: float) -> Part:
    """The bar with its teeth up."""
    return Part("rack", rack.outline, (), thickness, body="rack")


def base_plate(name: str, axes: list[complex], holes: list[float], margin: float, thickness: float) -> Part:
    """A plate with a hole of a diameter for each axis, mm; it reaches `margin` beyond the widest hole."""
    apart = abs(axes[0] - axes[1])
    if apart <= (holes[0] + holes[1]) / 2:
        raise DesignError(
            "stock.bore",
            f"the holes of two shafts, {holes[0]:g} and {holes[1]:g} mm wide and {apart:.6g} mm apart, meet in the plate",
            f"give bores and clearances of less than {2 * apart:.6g} mm together",
        )
    circles = tuple(Circle(z, d / 2) for z, d in zip(axes, holes) if d)
    return Part(name, rounded_hull(axes, max(holes) / 2 + margin), circles, thickness, body="ground")


def carrier(gears: PlanetarySet, diameters: tuple[float, float], margin: float, thickness: float) -> Part:
    """The plate that holds the planets at their distance, the sun's shaft passing its middle.

    diameters: of the holes for the shafts of sun and planets, mm.
    """
    sun, planet = diameters
    around = 1j * gears.inner.centre_distance * np.exp(2j * np.pi * np.arange(gears.planets) / gears.planets)
    outline: AbstractCurve = rounded_hull([0j, *around], max(diameters) / 2 + margin)
    holes = [*bore(sun, 0.0, 2 * gears.inner.centre_distance - planet, "sun_stock.bore")]
    holes += [Circle(complex(z), planet / 2) for z in around if planet]
    return Part("carrier", outline, tuple(holes), thickness, body="carrier")
