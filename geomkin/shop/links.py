"""Bars and plates of a linkage."""

from __future__ import annotations

from dataclasses import dataclass

from ..errors import DesignError
from ..linkage.four_bar import FourBar
from ..part import Part
from ..plane.primitives import Circle, rounded_hull
from ..sizes import FARTHEST, check_sizes, quantity


@dataclass(frozen=True)
class LinkStock:
    """What links are cut from, and the pins that join them."""

    thickness: float = quantity("thickness of the sheet", "mm", default=3.0, at_least=0.01, at_most=1000)
    bar_width: float = quantity("width of the links", "mm", default=14.0, above=0, at_most=FARTHEST)
    pin_diameter: float = quantity("diameter of the pins", "mm", default=4.0, at_least=1e-12, at_most=FARTHEST)
    clearance: float = quantity(
        "how much wider than its pin a hole is", "mm", default=0.2, at_least=0, at_most=FARTHEST
    )

    def __post_init__(self) -> None:
        check_sizes(self)
        if self.bar_width <= self.hole_diameter:
            raise DesignError(
                "bar_width",
                f"found {self.bar_width:g} mm, but the pin holes are {self.hole_diameter:g} mm wide",
                "give wider bars or thinner pins",
            )

    @property
    def hole_diameter(self) -> float:
        """Diameter of a pin hole, mm."""
        return self.pin_diameter + self.clearance


def four_bar_parts(linkage: FourBar, stock: LinkStock) -> list[Part]:
    """A plate for each link, its first pin at its own origin, with a hole for each pin and the coupler point."""
    pins = {
        "ground": [0j, complex(linkage.ground)],
        "crank": [0j, complex(linkage.crank)],
        "coupler": [0j, complex(linkage.coupler)],
        "rocker": [0j, complex(linkage.rocker)],
    }
    if linkage.coupler_point not in pins["coupler"]:
        pins["coupler"].append(complex(linkage.coupler_point))
    return [_plate(name, places, stock) for name, places in pins.items()]


def _plate(name: str, pins: list[complex], stock: LinkStock) -> Part:
    for k, pin in enumerate(pins):
        apart = min((abs(pin - other) for other in pins[:k]), default=float("inf"))
        if apart <= stock.hole_diameter:
            raise DesignError(
                f"linkage.{'coupler_point' if k == 2 else name}",
                f"two pins of the {name} are {apart:.4g} mm apart, and its holes are {stock.hole_diameter:g} mm wide",
                "move them apart or give a smaller pin_diameter",
            )
    holes = tuple(Circle(pin, stock.hole_diameter / 2) for pin in pins)
    return Part(name, rounded_hull(pins, stock.bar_width / 2), holes, stock.thickness)
