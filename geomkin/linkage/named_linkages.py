"""Linkages with one slide, the slider-crank and its inversions; with two, trammel, yoke, Oldham coupling and shaper."""

from __future__ import annotations

from functools import cached_property
from typing import Annotated, Literal

import numpy as np

from ..core.errors import DesignError
from ..core.fields import FARTHEST, PointsXY, PointXY, Sizes, entry, quantity
from ..core.records import record
from ..plane.vec import Array
from .linkage import AbstractLinkage, Linkage, Slider


@record(checked=True, arrays=True)
class SliderCrank(AbstractLinkage):
    """A crank that drives a slider, or a slider a crank; lengths pin to pin in mm.

    The crank turns about the origin; the slider runs along a line parallel to +x at the height `offset`.
    `origin` and `ground_angle_deg` place the whole. branch +1: the slider stands on the +x side of the crank
    pin; where the slider drives, the crank pin lies left of the line from crank pivot to slider pin.
    """

    crank: Sizes = quantity("length of the crank", "mm", above=0, at_most=FARTHEST, example=30)
    coupler: Sizes = quantity("length of the connecting rod", "mm", above=0, at_most=FARTHEST, example=90)
    offset: Sizes = quantity(
        "height of the slide line above the crank pivot", "mm", default=0.0, at_least=-FARTHEST, at_most=FARTHEST
    )
    coupler_point: PointsXY = entry(
        "point traced by the connecting rod, from its crank pin, x towards the slider pin, [x, y] in mm",
        default=0j,
    )
    driver: Literal["crank", "coupler", "slider"] = entry(
        "body that is driven: crank and coupler by their angle, the slider by its x", default="crank"
    )
    origin: Annotated[complex, PointXY()] = entry("crank's ground pivot, [x, y] in mm", default=0j)
    ground_angle_deg: float = quantity("direction of the slide line", "deg", default=0.0, at_least=-360, at_most=360)

    def __post_init__(self) -> None:
        if np.ndim(self.crank + self.coupler + self.offset):
            return
        if np.abs(self.offset) >= self.crank + self.coupler:
            raise DesignError(
                "offset",
                f"found {self.offset:g} mm, but crank and coupler together reach only "
                f"{self.crank + self.coupler:g} mm, so the loop cannot close",
                f"give less than {self.crank + self.coupler:g} mm or lengthen the others",
            )

    @cached_property
    def linkage(self) -> Linkage:
        """The general linkage: the coupler has its frame at the crank pin, the slider at its pin."""
        return Linkage(
            bodies={
                "ground": {"crank_pivot": 0j},
                "crank": {"crank_pivot": 0j, "crank_pin": self.crank + 0j},
                "coupler": {"crank_pin": 0j, "slider_pin": self.coupler + 0j, "coupler_point": self.coupler_point},
                "slider": {"slider_pin": 0j},
            },
            sliders=(Slider("slide", "slider", "ground", through=1j * self.offset),),
            driver=self.driver,
            origin=self.origin,
            ground_angle_deg=self.ground_angle_deg,
        )


@record(checked=True, arrays=True)
class InvertedSliderCrank(AbstractLinkage):
    """A crank whose pin slides along a rocker, or whose coupler slides through a rocking block; lengths in mm.

    The crank turns about the origin, the rocker about the point `ground` on +x. With `line` "rocker" the
    coupler is a block on the crank pin and the rocker a slotted lever: it swings where the crank is shorter
    than the ground, and turns fully (Whitworth) where it is longer. With `line` "coupler" the coupler is a rod
    and the rocker the block it slides through. branch +1: the rocker's x axis points from its pivot to the crank pin;
    of a sliding coupler, the coupler's from the crank pin to the block.
    """

    ground: Sizes = quantity("distance between the two ground pivots", "mm", above=0, at_most=FARTHEST, example=80)
    crank: Sizes = quantity("length of the crank", "mm", above=0, at_most=FARTHEST, example=30)
    offset: Sizes = quantity(
        "distance of the slide line from the pin at which its body turns, to the left",
        "mm",
        default=0.0,
        at_least=-FARTHEST,
        at_most=FARTHEST,
    )
    line: Literal["rocker", "coupler"] = entry("body that has the slide line", default="rocker")
    point: PointsXY = entry(
        "point traced by the body with the slide line, from its pin, x along the line, [x, y] in mm",
        default=0j,
        example=130 + 0j,
    )
    driver: Literal["crank", "rocker"] = entry("link whose angle is driven", default="crank")
    origin: Annotated[complex, PointXY()] = entry("crank's ground pivot, [x, y] in mm", default=0j)
    ground_angle_deg: float = quantity(
        "direction from crank pivot to rocker pivot", "deg", default=0.0, at_least=-360, at_most=360
    )

    def __post_init__(self) -> None:
        reach = self.ground + self.crank
        if np.ndim(reach + self.offset) == 0 and np.abs(self.offset) >= reach:
            raise DesignError(
                "offset",
                f"found {self.offset:g} mm, but the crank pin comes no farther than {reach:g} mm from the rocker pivot",
                f"give less than {reach:g} mm",
            )

    @cached_property
    def linkage(self) -> Linkage:
        """The general linkage: the sliding joint is named "slide"."""
        through = 1j * self.offset
        crank = {
            "ground": {"crank_pivot": 0j, "rocker_pivot": self.ground + 0j},
            "crank": {"crank_pivot": 0j, "crank_pin": self.crank + 0j},
        }
        if self.line == "rocker":
            bodies = crank | {
                "rocker": {"rocker_pivot": 0j, "rocker_point": self.point},
                "coupler": {"crank_pin": 0j},
            }
            slide = Slider("slide", "coupler", "rocker", through=through)
        else:
            bodies = crank | {
                "coupler": {"crank_pin": 0j, "coupler_point": self.point},
                "rocker": {"rocker_pivot": 0j},
            }
            slide = Slider("slide", "rocker", "coupler", through=through)
        return Linkage(bodies, self.driver, (slide,), self.origin, self.ground_angle_deg)


@record(checked=True, arrays=True)
class EllipticTrammel(AbstractLinkage):
    """A rod whose two pins run in two straight slots that cross at the origin: its points draw ellipses.

    The first slot lies along +x, the second at `angle_deg`; lengths in mm. Driven by the rod's angle or by the first
    shuttle's x; then branch +1 puts the second shuttle on the positive side of its slot's foot.
    """

    rod: Sizes = quantity("distance between the rod's two pins", "mm", above=0, at_most=FARTHEST, example=60)
    rod_point: PointsXY = entry(
        "point traced by the rod, from its first pin, x towards the second, [x, y] in mm", default=0j, example=100 + 0j
    )
    angle_deg: float = quantity(
        "angle from the first slot to the second", "deg", default=90.0, at_least=10, at_most=170
    )
    driver: Literal["rod", "shuttle"] = entry("what is driven: the rod's angle or the first shuttle", default="rod")
    origin: Annotated[complex, PointXY()] = entry("where the slots cross, [x, y] in mm", default=0j)
    ground_angle_deg: float = quantity("direction of the first slot", "deg", default=0.0, at_least=-360, at_most=360)

    @cached_property
    def linkage(self) -> Linkage:
        """The general linkage: shuttles "shuttle" and "cross_shuttle" in "slot" and "cross_slot"."""
        return Linkage(
            bodies={
                "ground": {},
                "shuttle": {"shuttle_pin": 0j},
                "rod": {"shuttle_pin": 0j, "cross_pin": self.rod + 0j, "rod_point": self.rod_point},
                "cross_shuttle": {"cross_pin": 0j},
            },
            driver=self.driver,
            sliders=(
                Slider("slot", "shuttle", "ground"),
                Slider("cross_slot", "cross_shuttle", "ground", direction_deg=self.angle_deg),
            ),
            origin=self.origin,
            ground_angle_deg=self.ground_angle_deg,
        )


@record(checked=True, arrays=True)
class ScotchYoke(AbstractLinkage):
    """A crank pin in a straight slot of a yoke that slides along x: exact harmonic motion at a slot of 90 deg.

    The crank turns about the origin; the yoke is guided `guide` beyond its slot; lengths in mm.
    """

    crank: Sizes = quantity("length of the crank", "mm", above=0, at_most=FARTHEST, example=30)
    guide: Sizes = quantity(
        "from the middle of the yoke's slot to the middle of its guide", "mm", above=0, at_most=FARTHEST, example=100
    )
    slot_deg: float = quantity(
        "direction of the yoke's slot from its way", "deg", default=90.0, at_least=10, at_most=170
    )
    origin: Annotated[complex, PointXY()] = entry("crank's ground pivot, [x, y] in mm", default=0j)
    ground_angle_deg: float = quantity("direction of the yoke's way", "deg", default=0.0, at_least=-360, at_most=360)

    @cached_property
    def linkage(self) -> Linkage:
        """The general linkage: the sliding joints are "slot", block in yoke, and "way", yoke on ground."""
        return Linkage(
            bodies={
                "ground": {"crank_pivot": 0j},
                "crank": {"crank_pivot": 0j, "crank_pin": self.crank + 0j},
                "block": {"crank_pin": 0j},
                "yoke": {"yoke_end": self.guide + 0j},
            },
            driver="crank",
            sliders=(
                Slider("slot", "block", "yoke", direction_deg=self.slot_deg),
                Slider("way", "yoke", "ground", point=self.guide + 0j, through=self.guide + 0j),
            ),
            origin=self.origin,
            ground_angle_deg=self.ground_angle_deg,
        )


@record(checked=True, arrays=True)
class OldhamCoupling(AbstractLinkage):
    """Two shafts side by side, each slotted, and a disc between them that slides in both: they turn alike.

    The driving hub turns about the origin, the driven one about `shift` on +x; the disc's middle runs twice a
    turn around the circle over the two centres; lengths in mm.
    """

    shift: Sizes = quantity("distance between the two shafts", "mm", above=0, at_most=FARTHEST, example=6)
    origin: Annotated[complex, PointXY()] = entry("centre of the driving shaft, [x, y] in mm", default=0j)
    ground_angle_deg: float = quantity(
        "direction from driving to driven shaft", "deg", default=0.0, at_least=-360, at_most=360
    )

    @cached_property
    def linkage(self) -> Linkage:
        """The general linkage: hubs "driving" and "driven", the disc's tongues "first" and "second" at right angles."""
        return Linkage(
            bodies={
                "ground": {"driving_pivot": 0j, "driven_pivot": self.shift + 0j},
                "driving": {"driving_pivot": 0j},
                "disc": {},
                "driven": {"driven_pivot": 0j},
            },
            driver="driving",
            sliders=(
                Slider("first", "disc", "driving"),
                Slider("second", "disc", "driven", direction_deg=90.0, angle_deg=-90.0),
            ),
            origin=self.origin,
            ground_angle_deg=self.ground_angle_deg,
        )


@record(checked=True)
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


@record(checked=True, arrays=True)
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


@record(checked=True)
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

    @cached_property
    def linkage(self) -> Linkage:
        """The general linkage: bodies of the four-bar, then link and output."""
        return _with_dyad(self.four_bar, "coupler_point", "coupler", self.four_bar.coupler_point, self)


@record(checked=True)
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
