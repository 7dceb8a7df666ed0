"""What the bars of a linkage are cut from."""

from __future__ import annotations

from dataclasses import dataclass

from ...errors import DesignError
from ...sizes import FARTHEST, check_sizes, quantity
from ..bore import clearance as wider


@dataclass(frozen=True)
class LinkStock:
    """What links are cut from, and the pins that join them."""

    thickness: float = quantity("thickness of the sheet", "mm", default=3.0, at_least=0.01, at_most=1000)
    bar_width: float = quantity("width of the links", "mm", default=14.0, above=0, at_most=FARTHEST)
    pin_diameter: float = quantity("diameter of the pins", "mm", default=4.0, at_least=1e-12, at_most=FARTHEST)
    clearance: float = wider(0.2)

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
