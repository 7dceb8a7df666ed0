"""Linkages with a name: four-bar, slider-crank and its inversions, trammel, yoke, Oldham coupling."""

from __future__ import annotations

from functools import cached_property
from typing import Literal

import numpy as np

from ..core.errors import DesignError
from ..core.fields import FARTHEST, ComplexOrArray, ComplexPoint, FloatOrArray, entry, inside, quantity
from ..core.records import record
from ..core.units import mm
from .joints.slide import Slider
from .linkage import AbstractLinkage, BodyPoints, Linkage, points_entry, with_points


@record(checked=True, arrays=True)
class SliderCrank(AbstractLinkage):
    """Slider-crank: crank, connecting rod and slider; either the crank or the slider drives.

    The crank turns about `origin`. The slider runs along a line parallel to +x at the height `offset`, before
    `ground_angle_deg` turns the whole linkage. Branch +1: the slider is on the +x side of the crank pin; if the
    slider drives, the crank pin is left of the line from the crank pivot to the slider pin.

    Parameters
    ----------
    crank, coupler : float or array
        Lengths of crank and connecting rod, mm, pin to pin; above 0.
    offset : float or array
        Height of the slide line above the crank pivot, mm.
    coupler_point : complex or array
        Point traced by the connecting rod, mm from its crank pin, x towards the slider pin.
    driver : {"crank", "coupler", "slider"}
        Driven body: crank and coupler by their angle, the slider by its displacement.
    origin : complex
        Position of the crank's ground pivot, mm.
    ground_angle_deg : float
        Direction of the slide line, deg, from -360 to 360.
    points : dict of str to dict of str to complex
        Further points of bodies by name, mm in the frame of the body.

    Raises
    ------
    DesignError
        If a size is out of range, or crank and coupler together do not reach the slide line.

    See Also
    --------
    FourBar, InvertedSliderCrank, Shaper, move

    Notes
    -----
    Lengths may be arrays, one value for each of many linkages.

    Examples
    --------
    >>> import numpy as np
    >>> import geomkin as gk
    >>> motion = gk.move(gk.SliderCrank(crank=30, coupler=90), [0.0, np.pi])
    >>> motion.slide("slide").displacement.round(6)
    array([120.,  60.])
    """

    crank: FloatOrArray = quantity("length of the crank", "mm", above=0, at_most=FARTHEST, example=30)
    coupler: FloatOrArray = quantity("length of the connecting rod", "mm", above=0, at_most=FARTHEST, example=90)
    offset: FloatOrArray = quantity(
        "height of the slide line above the crank pivot", "mm", default=0.0, at_least=-FARTHEST, at_most=FARTHEST
    )
    coupler_point: ComplexOrArray = entry(
        "point traced by the connecting rod, from its crank pin, x towards the slider pin, [x, y] in mm", default=0j
    )
    driver: Literal["crank", "coupler", "slider"] = entry(
        "body that is driven: crank and coupler by their angle, the slider by its x", default="crank"
    )
    origin: ComplexPoint = entry("crank's ground pivot, [x, y] in mm", default=0j)
    ground_angle_deg: float = quantity("direction of the slide line", "deg", default=0.0, at_least=-360, at_most=360)
    points: BodyPoints = points_entry()

    def __post_init__(self) -> None:
        if np.ndim(self.crank + self.coupler + self.offset):
            return
        if np.abs(self.offset) >= self.crank + self.coupler:
            raise DesignError(
                "offset",
                f"found {mm(self.offset):g}, but crank and coupler together reach only "
                f"{mm(self.crank + self.coupler):g}, so the loop cannot close",
                f"give less than {mm(float(self.crank + self.coupler)):down} or lengthen the others",
                "does-not-assemble",
                inside(float(self.crank + self.coupler), 1),
            )

    @cached_property
    @with_points
    def linkage(self) -> Linkage:
        """The general linkage: the coupler's frame is at the crank pin, the slider's at its pin."""
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
    """Inverted slider-crank: a crank pin that slides along a rocker, or a coupler that slides through a rocking block.

    The crank turns about `origin`, the rocker about a point on +x at the distance `ground`. With `line` "rocker" the
    coupler is a block on the crank pin and the rocker a slotted lever: it swings if the crank is shorter
    than the ground, and turns fully (Whitworth) if it is longer. With `line` "coupler" the coupler is a rod
    and the rocker the block that it slides through. Branch +1: the rocker's x axis points from its pivot to the crank
    pin; with a sliding coupler, the coupler's x axis points from the crank pin to the block.

    Parameters
    ----------
    ground : float or array
        Distance between the two ground pivots, mm; above 0.
    crank : float or array
        Length of the crank, mm; above 0.
    offset : float or array
        Distance of the slide line from the pin about which its body turns, mm, positive to the left.
    line : {"rocker", "coupler"}
        Body that has the slide line.
    point : complex or array
        Point traced by the body with the slide line, mm from its pin, x along the line.
    driver : {"crank", "rocker"}
        Link whose angle is driven.
    origin : complex
        Position of the crank's ground pivot, mm.
    ground_angle_deg : float
        Direction from the crank pivot to the rocker pivot, deg, from -360 to 360.
    points : dict of str to dict of str to complex
        Further points of bodies by name, mm in the frame of the body.

    Raises
    ------
    DesignError
        If a size is out of range, or the offset is larger than the distance that the crank pin reaches.

    See Also
    --------
    SliderCrank, Shaper, PinInSlot, move
    """

    ground: FloatOrArray = quantity(
        "distance between the two ground pivots", "mm", above=0, at_most=FARTHEST, example=80
    )
    crank: FloatOrArray = quantity("length of the crank", "mm", above=0, at_most=FARTHEST, example=30)
    offset: FloatOrArray = quantity(
        "distance of the slide line from the pin at which its body turns, to the left", "mm", default=0.0,
        at_least=-FARTHEST, at_most=FARTHEST,
    )  # fmt: skip
    line: Literal["rocker", "coupler"] = entry("body that has the slide line", default="rocker")
    point: ComplexOrArray = entry(
        "point traced by the body with the slide line, from its pin, x along the line, [x, y] in mm",
        default=0j,
        example=130 + 0j,
    )
    driver: Literal["crank", "rocker"] = entry("link whose angle is driven", default="crank")
    origin: ComplexPoint = entry("crank's ground pivot, [x, y] in mm", default=0j)
    ground_angle_deg: float = quantity(
        "direction from crank pivot to rocker pivot", "deg", default=0.0, at_least=-360, at_most=360
    )
    points: BodyPoints = points_entry()

    def __post_init__(self) -> None:
        farthest = self.ground + self.crank
        if np.ndim(farthest + self.offset) == 0 and np.abs(self.offset) >= farthest:
            problem = (
                f"found {mm(self.offset):g}, but the crank pin is at most {mm(farthest):down6} from the rocker pivot"
            )
            remedy = f"give less than {mm(float(farthest)):down}"
            raise DesignError("offset", problem, remedy, "does-not-assemble", inside(float(farthest), 1))

    @cached_property
    @with_points
    def linkage(self) -> Linkage:
        """The general linkage; the sliding joint is named "slide"."""
        through = 1j * self.offset
        crank_bodies = {
            "ground": {"crank_pivot": 0j, "rocker_pivot": self.ground + 0j},
            "crank": {"crank_pivot": 0j, "crank_pin": self.crank + 0j},
        }
        if self.line == "rocker":
            bodies = crank_bodies | {
                "rocker": {"rocker_pivot": 0j, "rocker_point": self.point},
                "coupler": {"crank_pin": 0j},
            }
            slide = Slider("slide", "coupler", "rocker", through=through)
        else:
            bodies = crank_bodies | {
                "coupler": {"crank_pin": 0j, "coupler_point": self.point},
                "rocker": {"rocker_pivot": 0j},
            }
            slide = Slider("slide", "rocker", "coupler", through=through)
        return Linkage(bodies, self.driver, (slide,), self.origin, self.ground_angle_deg)


@record(checked=True, arrays=True)
class EllipticTrammel(AbstractLinkage):
    """Elliptic trammel: a rod whose two pins run in two straight slots; its points draw ellipses.

    The slots cross at `origin`; the first lies along +x, the second at `angle_deg`. Branch +1, if the shuttle drives:
    the second shuttle is on the positive side of the foot of the first shuttle on its slot.

    Parameters
    ----------
    rod : float or array
        Distance between the rod's two pins, mm; above 0.
    rod_point : complex or array
        Point traced by the rod, mm from its first pin, x towards the second.
    angle_deg : float
        Angle from the first slot to the second, deg, from 10 to 170.
    driver : {"rod", "shuttle"}
        What is driven: the angle of the rod, or the displacement of the first shuttle.
    origin : complex
        Point where the slots cross, mm.
    ground_angle_deg : float
        Direction of the first slot, deg, from -360 to 360.
    points : dict of str to dict of str to complex
        Further points of bodies by name, mm in the frame of the body.

    See Also
    --------
    ScotchYoke, OldhamCoupling, Linkage, move
    """

    rod: FloatOrArray = quantity("distance between the rod's two pins", "mm", above=0, at_most=FARTHEST, example=60)
    rod_point: ComplexOrArray = entry(
        "point traced by the rod, from its first pin, x towards the second, [x, y] in mm", default=0j, example=100 + 0j
    )
    angle_deg: float = quantity(
        "angle from the first slot to the second", "deg", default=90.0, at_least=10, at_most=170
    )
    driver: Literal["rod", "shuttle"] = entry("what is driven: the rod's angle or the first shuttle", default="rod")
    origin: ComplexPoint = entry("where the slots cross, [x, y] in mm", default=0j)
    ground_angle_deg: float = quantity("direction of the first slot", "deg", default=0.0, at_least=-360, at_most=360)
    points: BodyPoints = points_entry()

    @cached_property
    @with_points
    def linkage(self) -> Linkage:
        """The general linkage: bodies "shuttle" and "cross_shuttle" slide in the joints "slot" and "cross_slot"."""
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
    """Scotch yoke: a crank pin in a straight slot of a yoke that slides along x.

    The crank turns about `origin`. With a slot at 90 deg the yoke's motion is exactly harmonic.

    Parameters
    ----------
    crank : float or array
        Length of the crank, mm; above 0.
    guide : float or array
        Distance from the middle of the yoke's slot to the middle of its guide, mm; above 0.
    slot_deg : float
        Angle from the yoke's direction of sliding to its slot, deg, from 10 to 170.
    origin : complex
        Position of the crank's ground pivot, mm.
    ground_angle_deg : float
        Direction in which the yoke slides, deg, from -360 to 360.
    points : dict of str to dict of str to complex
        Further points of bodies by name, mm in the frame of the body.

    See Also
    --------
    EllipticTrammel, OldhamCoupling, Linkage, move

    Examples
    --------
    >>> import geomkin as gk
    >>> motion = gk.move(gk.ScotchYoke(crank=30, guide=100), [0.0, 1.0])
    >>> motion.slide("way").displacement.round(4)
    array([30.    , 16.2091])
    """

    crank: FloatOrArray = quantity("length of the crank", "mm", above=0, at_most=FARTHEST, example=30)
    guide: FloatOrArray = quantity(
        "from the middle of the yoke's slot to the middle of its guide", "mm", above=0, at_most=FARTHEST, example=100
    )
    slot_deg: float = quantity(
        "angle from the yoke's direction of sliding to its slot", "deg", default=90.0, at_least=10, at_most=170
    )
    origin: ComplexPoint = entry("crank's ground pivot, [x, y] in mm", default=0j)
    ground_angle_deg: float = quantity(
        "direction in which the yoke slides", "deg", default=0.0, at_least=-360, at_most=360
    )
    points: BodyPoints = points_entry()

    @cached_property
    @with_points
    def linkage(self) -> Linkage:
        """The general linkage: the sliding joints are "slot" (block in yoke) and "way" (yoke on ground)."""
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
    """Oldham coupling: two parallel, offset shafts and a disc between them that slides in both hubs.

    Both hubs turn through equal angles. The driving hub turns about `origin`, the driven one about a point on +x at
    the distance `shift`. The disc's centre runs twice per turn around the circle over the two shaft centres.

    Parameters
    ----------
    shift : float or array
        Distance between the two shafts, mm; above 0.
    origin : complex
        Centre of the driving shaft, mm.
    ground_angle_deg : float
        Direction from the driving to the driven shaft, deg, from -360 to 360.
    points : dict of str to dict of str to complex
        Further points of bodies by name, mm in the frame of the body.

    See Also
    --------
    ScotchYoke, EllipticTrammel, Linkage, move
    """

    shift: FloatOrArray = quantity("distance between the two shafts", "mm", above=0, at_most=FARTHEST, example=6)
    origin: ComplexPoint = entry("centre of the driving shaft, [x, y] in mm", default=0j)
    ground_angle_deg: float = quantity(
        "direction from driving to driven shaft", "deg", default=0.0, at_least=-360, at_most=360
    )
    points: BodyPoints = points_entry()

    @cached_property
    @with_points
    def linkage(self) -> Linkage:
        """The general linkage: hubs "driving" and "driven"; the disc slides in the joints "first" and "second"."""
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


@record(checked=True, arrays=True)
class FourBar(AbstractLinkage):
    """Four-bar linkage: ground, crank, coupler and rocker, joined in a loop by four pins.

    The crank turns about `origin`. The rocker's ground pivot is on +x at the distance `ground`, before
    `ground_angle_deg` turns the whole linkage. Branch +1: the rocker pin is left of the line from the crank pin to the
    rocker pivot.

    Parameters
    ----------
    ground : float or array
        Distance between the two ground pivots, mm; above 0.
    crank : float or array
        Length of the driving link, mm, pin to pin; above 0.
    coupler : float or array
        Length of the floating link between crank and rocker, mm, pin to pin; above 0.
    rocker : float or array
        Length of the driven link, mm, pin to pin; above 0.
    coupler_point : complex or array
        Point traced by the coupler, mm from its crank pin, x towards the rocker pin.
    driver : {"crank", "coupler", "rocker"}
        Link whose angle is driven.
    origin : complex
        Position of the crank's ground pivot, mm.
    ground_angle_deg : float
        Direction from the crank pivot to the rocker pivot, deg, from -360 to 360.
    points : dict of str to dict of str to complex
        Further points of bodies by name, mm in the frame of the body.

    Raises
    ------
    DesignError
        If a size is out of range, or one link is as long as the other three together.

    See Also
    --------
    SliderCrank, StephensonSixBar, WattSixBar, Linkage, move, crank_rocker

    Notes
    -----
    Lengths may be arrays of shape (linkages,), one value for each of many four-bars. Those that cannot be assembled are
    open (nan) at every frame.

    Examples
    --------
    >>> import geomkin as gk
    >>> motion = gk.move(gk.FourBar(ground=100, crank=30, coupler=90, rocker=70), [0.0, 1.0], speed=10.0)
    >>> motion.rocker.omega.round(4)
    array([-4.2857,  2.1951])
    """

    ground: FloatOrArray = quantity(
        "distance between the two ground pivots", "mm", above=0, at_most=FARTHEST, example=100
    )
    crank: FloatOrArray = quantity("length of the driving link", "mm", above=0, at_most=FARTHEST, example=30)
    coupler: FloatOrArray = quantity(
        "length of the floating link between crank and rocker", "mm", above=0, at_most=FARTHEST, example=90
    )
    rocker: FloatOrArray = quantity("length of the driven link", "mm", above=0, at_most=FARTHEST, example=70)
    coupler_point: ComplexOrArray = entry(
        "point traced by the coupler, from its crank pin, x towards the rocker pin, [x, y] in mm",
        default=0j,
        example=40 + 25j,
    )
    driver: Literal["crank", "coupler", "rocker"] = entry("link whose angle is driven", default="crank")
    origin: ComplexPoint = entry("crank's ground pivot, [x, y] in mm", default=0j)
    ground_angle_deg: float = quantity(
        "direction from crank pivot to rocker pivot", "deg", default=0.0, at_least=-360, at_most=360
    )
    points: BodyPoints = points_entry()

    def __post_init__(self) -> None:
        if isinstance(self.ground + self.crank + self.coupler + self.rocker, np.ndarray):
            return
        lengths = {"ground": self.ground, "crank": self.crank, "coupler": self.coupler, "rocker": self.rocker}
        longest = max(lengths, key=lengths.__getitem__)
        others = sum(lengths.values()) - lengths[longest]
        if lengths[longest] >= others:
            problem = (
                f"found {mm(lengths[longest]):g}, but the other three links together reach only {mm(others):g}, "
                "so the loop cannot close"
            )
            remedy = f"give {longest} less than {mm(float(others)):down} or lengthen the others"
            raise DesignError(longest, problem, remedy, "does-not-assemble", inside(float(others), 1))

    @cached_property
    @with_points
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
