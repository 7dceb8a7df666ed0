"""The crank shaper: a slotted lever that drives a ram."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Annotated

from ...errors import DesignError
from ...sizes import FARTHEST, PointXY, check_sizes, entry, quantity
from ..linkage import Linkage, Slider


@dataclass(frozen=True)
class Shaper:
    """A crank pin in the slot of a lever, whose tip moves a ram through a connecting rod; lengths in mm.

    The crank turns about the origin; the lever's pivot is `ground` away, the ram's line at right angles to
    that on the other side of the crank. The ram cuts slowly and comes back quickly. As it stands by default
    the lever's pivot is below and +x the ram's way. Joints for branches: `slide`, and `ram_pin`: +1, the ram
    on the +x side of the lever's tip.
    """

    ground: float = quantity("from crank pivot to lever pivot", "mm", above=0, at_most=FARTHEST, example=90)
    crank: float = quantity("length of the crank", "mm", above=0, at_most=FARTHEST, example=30)
    lever: float = quantity("from lever pivot to the lever's tip", "mm", above=0, at_most=FARTHEST, example=180)
    link: float = quantity("connecting rod, from lever tip to ram", "mm", above=0, at_most=FARTHEST, example=60)
    ram_height: float = quantity(
        "from crank pivot to the ram's line, away from the lever pivot", "mm", above=0, at_most=FARTHEST, example=85
    )
    origin: Annotated[complex, PointXY()] = entry("crank's ground pivot, [x, y] in mm", default=0j)
    ground_angle_deg: float = quantity(
        "direction from crank pivot to lever pivot", "deg", default=-90.0, at_least=-360, at_most=360
    )

    def __post_init__(self) -> None:
        check_sizes(self)
        if self.crank >= self.ground:
            raise DesignError(
                "crank",
                f"found {self.crank:g} mm, but the lever turns over at the {self.ground:g} mm to its pivot and more",
                f"give less than {self.ground:g} mm",
            )

    @cached_property
    def linkage(self) -> Linkage:
        """The general linkage: the sliding joints are "slide", crank pin on lever, and "ram_slide"."""
        return Linkage(
            bodies={
                "ground": {"crank_pivot": 0j, "lever_pivot": self.ground + 0j},
                "crank": {"crank_pivot": 0j, "crank_pin": self.crank + 0j},
                "lever": {"lever_pivot": 0j, "lever_tip": self.lever + 0j},
                "block": {"crank_pin": 0j},
                "link": {"lever_tip": 0j, "ram_pin": self.link + 0j},
                "ram": {"ram_pin": 0j},
            },
            driver="crank",
            sliders=(
                Slider("slide", "block", "lever"),
                Slider("ram_slide", "ram", "ground", through=-self.ram_height + 0j, direction_deg=90.0),
            ),
            origin=self.origin,
            ground_angle_deg=self.ground_angle_deg,
        )
