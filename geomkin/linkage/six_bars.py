"""Six-bars: a four-bar that drives two more links, and the crank shaper."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Annotated

from ..errors import DesignError
from ..plane.vec import Array
from ..sizes import FARTHEST, PointXY, check_sizes, entry, quantity
from .four_bar import FourBar
from .linkage import AbstractLinkage, Linkage, Slider


@dataclass(frozen=True, repr=False)
class StephensonSixBar(AbstractLinkage):
    """A four-bar whose coupler point moves an output link through a connecting link; lengths in mm.

    Where the coupler point runs along an arc about the far end of the connecting link, of its length, the
    output dwells. Joints for branches: `rocker_pin`, and `output_pin`: +1, left of the line from the coupler
    point to the output pivot. Angles and `output_pivot` are from the four-bar's ground line.
    """

    four_bar: FourBar
    link: float = quantity(
        "connecting link, from coupler point to output pin", "mm", above=0, at_most=FARTHEST, example=120
    )
    output: float = quantity("output link, from its pivot to its pin", "mm", above=0, at_most=FARTHEST, example=90)
    output_pivot: Annotated[complex, PointXY()] = entry(
        "ground pivot of the output link, from the crank pivot, [x, y] in mm", example=100 + 100j
    )

    def __post_init__(self) -> None:
        check_sizes(self)

    @cached_property
    def linkage(self) -> Linkage:
        """The general linkage: bodies of the four-bar, then link and output."""
        return _with_dyad(self.four_bar, "coupler_point", "coupler", self.four_bar.coupler_point, self)


@dataclass(frozen=True, repr=False)
class WattSixBar(AbstractLinkage):
    """Two four-bars in a row: a point of the first one's rocker moves an output link; lengths in mm.

    Joints for branches: `rocker_pin`, and `output_pin`: +1, left of the line from the rocker's point to the
    output pivot. Angles and `output_pivot` are from the first four-bar's ground line.
    """

    four_bar: FourBar
    rocker_point: Annotated[complex, PointXY()] = entry(
        "point of the rocker that drives on, from its ground pivot, x towards the rocker pin, [x, y] in mm",
        example=50 - 30j,
    )
    link: float = quantity(
        "second coupler, from rocker point to output pin", "mm", above=0, at_most=FARTHEST, example=90
    )
    output: float = quantity("output link, from its pivot to its pin", "mm", above=0, at_most=FARTHEST, example=60)
    output_pivot: Annotated[complex, PointXY()] = entry(
        "ground pivot of the output link, from the crank pivot, [x, y] in mm", example=180 + 0j
    )

    def __post_init__(self) -> None:
        check_sizes(self)

    @cached_property
    def linkage(self) -> Linkage:
        """The general linkage: bodies of the four-bar, then link and output."""
        return _with_dyad(self.four_bar, "rocker_point", "rocker", self.rocker_point, self)


def _with_dyad(
    four_bar: FourBar, point: str, body: str, place: complex | Array, sizes: StephensonSixBar | WattSixBar
) -> Linkage:
    first = four_bar.linkage
    bodies = {name: dict(points) for name, points in first.bodies.items()}
    bodies[body][point] = place
    bodies["ground"]["output_pivot"] = sizes.output_pivot
    bodies["link"] = {point: 0j, "output_pin": sizes.link + 0j}
    bodies["output"] = {"output_pivot": 0j, "output_pin": sizes.output + 0j}
    return Linkage(bodies, first.driver, (), first.origin, first.ground_angle_deg)


@dataclass(frozen=True, repr=False)
class Shaper(AbstractLinkage):
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
