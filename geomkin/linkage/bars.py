"""Linkages of bars and pins alone: the four-bar, and six-bars, in which it drives two more links."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np

from ..cached import cached_property
from ..errors import DesignError
from ..plane.vec import Array
from ..sizes import FARTHEST, PointsXY, PointXY, Sizes, check_sizes, entry, quantity
from .linkage import AbstractLinkage, Linkage


@dataclass(frozen=True, repr=False)
class FourBar(AbstractLinkage):
    """Four links pinned in a loop: ground, crank, coupler, rocker; lengths pin to pin in mm.

    The crank turns about the origin; the rocker's ground pivot lies on +x at `ground`. `origin` and
    `ground_angle_deg` place the whole. Lengths may be arrays (linkages,): many four-bars at once, of
    which those that cannot be assembled are open at every frame.
    """

    ground: Sizes = quantity("distance between the two ground pivots", "mm", above=0, at_most=FARTHEST, example=100)
    crank: Sizes = quantity("length of the driving link", "mm", above=0, at_most=FARTHEST, example=30)
    coupler: Sizes = quantity(
        "length of the floating link between crank and rocker", "mm", above=0, at_most=FARTHEST, example=90
    )
    rocker: Sizes = quantity("length of the driven link", "mm", above=0, at_most=FARTHEST, example=70)
    coupler_point: PointsXY = entry(
        "point traced by the coupler, from its crank pin, x towards the rocker pin, [x, y] in mm",
        default=0j,
    )
    driver: Literal["crank", "coupler", "rocker"] = entry("link whose angle is driven", default="crank")
    origin: Annotated[complex, PointXY()] = entry("crank's ground pivot, [x, y] in mm", default=0j)
    ground_angle_deg: float = quantity(
        "direction from crank pivot to rocker pivot", "deg", default=0.0, at_least=-360, at_most=360
    )

    def __post_init__(self) -> None:
        check_sizes(self, many=True)
        if np.ndim(self.ground + self.crank + self.coupler + self.rocker):
            return
        lengths = {"ground": self.ground, "crank": self.crank, "coupler": self.coupler, "rocker": self.rocker}
        longest = max(lengths, key=lengths.__getitem__)
        others = sum(lengths.values()) - lengths[longest]
        if lengths[longest] >= others:
            raise DesignError(
                longest,
                f"found {lengths[longest]:g} mm, but the other three links together reach only {others:g} mm, "
                "so the loop cannot close",
                f"give {longest} less than {others:g} mm or lengthen the others",
            )

    @cached_property
    def linkage(self) -> Linkage:
        """The general linkage: ground and rocker have their frames at their pivots, the coupler at the crank pin."""
        return Linkage(
            bodies={
                "ground": {"crank_pivot": 0j, "rocker_pivot": self.ground + 0j},
                "crank": {"crank_pivot": 0j, "crank_pin": self.crank + 0j},
                "coupler": {"crank_pin": 0j, "rocker_pin": self.coupler + 0j, "coupler_point": self.coupler_point},
                "rocker": {"rocker_pivot": 0j, "rocker_pin": self.rocker + 0j},
            },
            driver=self.driver,
            origin=self.origin,
            ground_angle_deg=self.ground_angle_deg,
        )


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
