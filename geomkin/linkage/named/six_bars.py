"""Six-bars: a four-bar that drives two more links."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Annotated

from ...sizes import FARTHEST, PointXY, check_sizes, entry, quantity
from .four_bar import FourBar
from ..linkage import Linkage


@dataclass(frozen=True)
class StephensonSixBar:
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


@dataclass(frozen=True)
class WattSixBar:
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
    four_bar: FourBar, point: str, body: str, place: complex, sizes: StephensonSixBar | WattSixBar
) -> Linkage:
    first = four_bar.linkage
    bodies = {name: dict(points) for name, points in first.bodies.items()}
    bodies[body][point] = place
    bodies["ground"]["output_pivot"] = sizes.output_pivot
    bodies["link"] = {point: 0j, "output_pin": sizes.link + 0j}
    bodies["output"] = {"output_pivot": 0j, "output_pin": sizes.output + 0j}
    return Linkage(bodies, first.driver, (), first.origin, first.ground_angle_deg)
