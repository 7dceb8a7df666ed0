"""Shared by recipes of linkages: a linkage as a list of bodies, the branch on which it moves, and its motion."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import field
from functools import cached_property
from types import MappingProxyType
from typing import Any, ClassVar, Literal

import numpy as np

from ...core.errors import DesignError
from ...core.field_visitor import Number
from ...core.fields import ComplexPoint, check_sizes, entry, quantity
from ...core.names import check_names
from ...core.records import record
from ...core.units import UNITS, mm
from ...model.scene import SceneHandle
from ...plane.vec import Complex, Real
from ...recipe.recipe import AbstractRecipe, Additions
from ...recipe.settings import Stroke, Turn
from ..joints.gear_mesh import GearMesh
from ..joints.slide import PinInSlot, Slider
from ..linkage import AbstractLinkage, Linkage
from ..measures import motion_quantities
from ..motion import Motion
from ..scene_handles import handle_position, linkage_handles, preview_data, stroke_handles
from ..solve.branch import BranchSpec
from .made import DrivenLinkage

# The branch of all dyads; the same with "follow"; the branches of single joints.
Side = Literal[1, -1]
SideOrFollow = Literal[1, -1, "follow"]
Branches = dict[str, Side | complex]


def branch_entry() -> Any:
    """Field for the branch of all dyads."""
    return entry(
        "1 or -1: a dyad's joint left or right of the line from its first to its second pivot; "
        "follow: continues smoothly from 1, or from branches, also through change points",
        default=1,
    )


def coefficients_entry() -> Any:
    """Field that adds kinematic coefficients to the table."""
    return entry(
        "whether the table and the plots also have first and second kinematic coefficients: derivatives by the "
        "driver's angle in rad, or by its displacement in mm if a slide drives",
        default=False,
    )


def components_entry() -> Any:
    """Field that adds effective components."""
    return entry(
        "whether table, plots and page also have the effective components of each pin: its velocity and acceleration "
        "along and across its link; a check then compares those along rigid links, which are equal",
        default=False,
    )


def branches_entry() -> Any:
    """Field for the branches of single joints."""
    return entry(
        "branch of single joints: 1 or -1; or the approximate first position of a point, [x, y] in mm: the branch "
        "nearest to it",
        default_factory=dict,
    )


def branch_of(branch: Literal[1, -1, "follow"], branches: Mapping[str, int | complex]) -> BranchSpec:
    """The branch given by a recipe's `branch` and `branches`."""
    signs = {name: value for name, value in branches.items() if not isinstance(value, complex)}
    points = {name: value for name, value in branches.items() if isinstance(value, complex)}
    return BranchSpec(1 if branch == "follow" else branch, signs, points, branch == "follow", "branches")


class JointAdditions(Additions):
    """Slides on the ground, levers with a slot, and the stroke of a slide that the driver moves."""

    def unavailable(self, recipe: Any) -> Iterator[str]:
        yield from super().unavailable(recipe)
        if not recipe.linkage.linkage.sliders:
            yield "stroke"

    def changes(self, recipe: Any, key: str) -> Iterator[Mapping[str, Any]]:
        joints = {"linkage.sliders": added_slides, "linkage.slots": added_slots, "linkage.meshes": added_meshes}
        linkage = recipe.linkage.linkage
        if key in joints:
            yield from joints[key](linkage)
        for slider in linkage.sliders if key == "stroke" and linkage.driven_slider is None else ():
            # The middle of the displacements of a slide while the driver turns.
            places = recipe.motion.slide(slider.name).displacement
            known = places[np.isfinite(places)]
            start, end = (float(f"{place:.4g}") for place in np.quantile(known, [0.4, 0.6]))
            for driver in ("slider", slider.name, slider.body):
                yield {"linkage.driver": driver, "stroke": {"start": start, "end": end}}


class AbstractMovedRecipe(AbstractRecipe):
    """Base class of recipes of a moving linkage."""

    can_be_scaled: ClassVar[bool] = True
    additions: ClassVar[Additions] = JointAdditions()
    linkage: AbstractLinkage
    branch: SideOrFollow
    # Default for kinds without this key.
    branches: Mapping[str, int | complex] = MappingProxyType({})
    drive: Turn
    stroke: Stroke | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        check_sizes(self)
        self.check_stroke()
        self.input_range.check_rows()

    def check_stroke(self) -> None:
        """Refuse a stroke if the driver turns, and a missing one if it slides."""
        try:
            slides = self.linkage.linkage.driven_slider is not None
        except DesignError as error:
            raise error.named(f"linkage.{error.field}") from None
        if slides and self.stroke is None:
            raise DesignError(
                "stroke", "is missing although a slide drives", "give a table with start and end", "missing-key"
            )
        if not slides and self.stroke is not None:
            raise DesignError(
                "stroke", "is given, but the driver turns", "omit it, or let the slider drive", "conflict"
            )

    @property
    def design(self) -> AbstractLinkage:
        return self.linkage

    @property
    def forces_missing(self) -> str:
        return "This kind computes no driver effort and no joint forces; a recipe of the linkage with loads does."

    @property
    def input_range(self) -> Turn | Stroke:
        """Range and speed of the driver."""
        return self.stroke or self.drive

    @cached_property
    def made(self) -> DrivenLinkage:
        """The linkage on its branch, over the range of its driver."""
        return DrivenLinkage(self.linkage, branch_of(self.branch, self.branches), self.input_range, self.setting)

    @property
    def motion(self) -> Motion:
        """The linkage at the frames of the table."""
        return self.made.motion

    @property
    def further_values(self) -> dict[str, Real]:
        """Coordinates of the pins, mm, such as `rocker_pin_x`."""
        places = {pin: self.motion.point(pin).position for pin in self.motion.linkage.pins}
        return {f"{pin}_{axis}": part for pin, z in places.items() for axis, part in (("x", z.real), ("y", z.imag))}

    @property
    def further_handles(self) -> Iterator[SceneHandle]:
        """Handles besides those of the linkage: the ends of a stroke."""
        if self.stroke is not None:
            yield from stroke_handles(self.motion, self.stroke.start, self.stroke.end)

    @cached_property
    def handles(self) -> tuple[SceneHandle, ...]:
        """The points, pivots and slides of the linkage, and the further ones."""
        return (*linkage_handles(self.linkage, self.motion), *self.further_handles)

    def preview(self, has_rates: bool = True) -> Mapping[str, object]:
        unit, scale = UNITS[self.units], (self.loaded_table or {}).get("scale", 1.0)

        def factor(number: Number) -> float:
            return unit.factor(number.unit) * (scale if number.unit == "mm" else 1)

        return preview_data(self.linkage, factor if has_rates else None)

    def handle_position(self, id: str) -> Complex:
        further = next((handle.at for handle in self.further_handles if handle.id == id), None)
        return handle_position(self.motion, id) if further is None else further

    @property
    def quantities(self) -> Mapping[str, str]:
        """Grashof type, distances between the pins of bodies, range of the transmission angle, and those of aspects."""
        return {**motion_quantities(self.linkage, self.motion), **super().quantities}


def both_modes_entry() -> Any:
    """Field that adds the other assembly mode."""
    return entry(
        "whether table, plots and summary also have the other assembly mode, which the page shows: the joint of the "
        "last dyad on its other side",
        default=False,
    )


@record
class TriangleCorner:
    """A point of a body by its distances from two other points of it."""

    body: str = entry("the body it belongs to", example="coupler")
    point: str = entry("its name", example="pen")
    base: tuple[str, str] = entry("two points of the body", example=("A", "B"))
    lengths: tuple[float, float] = entry("its distances from them, mm", example=(50.0, 60.0), units=("mm", "mm"))
    side: Literal["left", "right"] = entry("on which side of the line from the first to the second", default="left")


@record(checked=True)
class SliderTable:
    """A sliding joint in a recipe."""

    name: str = entry("its name", example="slide")
    body: str = entry("the body that slides", example="block")
    along: str = entry("the body it slides along", example="ground")
    point: ComplexPoint = entry("point of the sliding body that stays on the line", default=0j)
    through: ComplexPoint = entry("point of the line, in the frame of the guide", default=0j)
    direction_deg: float = quantity(
        "direction of the line in the guide", "deg", default=0.0, at_least=-360, at_most=360
    )
    angle_deg: float = quantity("the body's x axis from the line", "deg", default=0.0, at_least=-360, at_most=360)


@record(checked=True)
class BodyList(AbstractLinkage):
    """Any linkage as a list of bodies; a pin joins two bodies at each point that both name."""

    bodies: dict[str, dict[str, ComplexPoint]] = entry(
        "bodies, the fixed one first, each a table of points [x, y]",
        example={
            "ground": {"O": 0j, "C": 100 + 0j},
            "crank": {"O": 0j, "A": 30 + 0j},
            "coupler": {"A": 0j, "B": 90 + 0j},
            "rocker": {"C": 0j, "B": 70 + 0j},
        },
    )
    driver: str = entry(
        "the driven body, or the driven slider, such as that of a cylinder and its rod", example="crank"
    )
    corners: tuple[TriangleCorner, ...] = entry(
        "points given by two distances",
        default=(),
        example=(TriangleCorner("coupler", "pen", ("A", "B"), (50.0, 60.0)),),
    )
    sliders: tuple[SliderTable, ...] = entry("sliding joints", default=())
    slots: tuple[PinInSlot, ...] = entry("pins that run in slots", default=())
    meshes: tuple[GearMesh, ...] = entry("gears that couple bodies on the ground", default=())
    estimate: dict[str, ComplexPoint] = field(
        default_factory=dict,
        metadata={
            "description": "approximate first positions of pins, needed if the linkage is not a chain of dyads",
            "examples": [{}],
        },
    )
    origin: ComplexPoint = entry("origin of the fixed body, [x, y] in mm", default=0j)
    ground_angle_deg: float = quantity(
        "direction of the fixed body's x axis", "deg", default=0.0, at_least=-360, at_most=360
    )

    def __post_init__(self) -> None:
        self.linkage  # noqa: B018  so that errors of the joints show when the recipe is read

    @cached_property
    def linkage(self) -> Linkage:
        """The general linkage."""
        bodies = with_corners(self.bodies, self.corners)
        sliders = tuple(
            Slider(s.name, s.body, s.along, s.point, s.through, s.direction_deg, s.angle_deg) for s in self.sliders
        )
        place = self.origin, self.ground_angle_deg
        return Linkage(bodies, self.driver, sliders, *place, self.estimate, self.slots, self.meshes)


def with_corners(
    bodies: Mapping[str, Mapping[str, complex]], corners: Iterable[TriangleCorner]
) -> dict[str, dict[str, complex]]:
    """The points of bodies with those that are given by two distances."""
    whole = {name: dict(points) for name, points in bodies.items()}
    for k, corner in enumerate(corners):
        check_names(f"corners[{k}].body", [corner.body], "a body")
        check_names(f"corners[{k}].point", [corner.point], "a point")
        check_names(f"corners[{k}].base", corner.base, "a point")
        whole.setdefault(corner.body, {})
        missing = [p for p in corner.base if p not in whole[corner.body]]
        if missing:
            problem = f"{corner.body} has no point {missing[0]}"
            raise DesignError(f"corners[{k}]", problem, f"give it under bodies.{corner.body}", "unknown-key")
        whole[corner.body][corner.point] = _corner(k, corner, *(whole[corner.body][p] for p in corner.base))
    return whole


def _corner(k: int, corner: TriangleCorner, one: complex, two: complex) -> complex:
    base, (b, c) = abs(two - one), corner.lengths
    if not abs(b - c) < base < b + c:
        raise DesignError(
            f"corners[{k}]",
            f"{mm(b, c, between=' and '):g} form no triangle with the {mm(base):g} from {corner.base[0]} to "
            f"{corner.base[1]}",
            f"give two lengths that differ by less than {mm(base):down} and together exceed it",
        )
    # Kahan, Miscalculating area and angles of a needle-like triangle: this keeps the digits of a needle's height.
    long, middle, short = sorted((base, b, c), reverse=True)
    area = 0.25 * np.sqrt(
        (long + (middle + short)) * (short - (long - middle)) * (short + (long - middle)) * (long + (middle - short))
    )
    along = 0.5 * (base + (b - c) * (b + c) / base)
    height = 2 * area / base * (1 if corner.side == "left" else -1)
    return complex(one + (two - one) / base * complex(along, float(height)))


def added_slides(linkage: Linkage) -> Iterator[Mapping[str, Any]]:
    """Values that add a rod at a point of the last body, and a block at its end that slides on the ground.

    The rod is long enough for any position.
    """
    body, count = [*linkage.bodies][-1], len(linkage.sliders) + 1
    rod, block, pin = f"rod_{count}", f"block_{count}", f"slide_pin_{count}"
    length = float(f"{3 * float(linkage.size):.2g}")
    for point in [*linkage.bodies[body]][::-1]:
        yield {
            f"linkage.bodies.{rod}": {point: [0, 0], pin: [length, 0]},
            f"linkage.bodies.{block}": {pin: [0, 0]},
            f"linkage.sliders[{count - 1}]": {"name": f"slide_{count}", "body": block, "along": linkage.ground},
        }


def added_slots(linkage: Linkage) -> Iterator[Mapping[str, Any]]:
    """Values that add a lever on the ground whose slot takes a point of the last body; its pivot is far from all."""
    body, count = [*linkage.bodies][-1], len(linkage.slots) + 1
    lever, pivot = f"lever_{count}", f"lever_pivot_{count}"
    length = float(f"{3 * float(linkage.size):.2g}")
    for point in [*linkage.bodies[body]][::-1]:
        yield {
            f"linkage.bodies.{linkage.ground}.{pivot}": [0, -length],
            f"linkage.bodies.{lever}": {pivot: [0, 0], f"tip_{count}": [length, 0]},
            f"linkage.slots[{count - 1}]": {"name": f"slot_{count}", "body": body, "pin": point, "along": lever},
        }


def added_meshes(linkage: Linkage) -> Iterator[Mapping[str, Any]]:
    """Values that add a body on the ground, beyond all that moves, which gears turn with the driver."""
    ground, driver, count = linkage.ground, linkage.driver, len(linkage.meshes) + 1
    body, pivot = f"gear_{count}", f"gear_pivot_{count}"
    if linkage.driver_pivot is None or any(driver in mesh.bodies for mesh in linkage.meshes):
        return
    place = complex(linkage.bodies[ground][linkage.driver_pivot]) - 3j * float(f"{float(linkage.size):.2g}")
    yield {
        f"linkage.bodies.{ground}.{pivot}": [place.real, place.imag],
        f"linkage.bodies.{body}": {pivot: [0, 0]},
        f"linkage.meshes[{count - 1}]": {"name": f"mesh_{count}", "first": driver, "second": body, "teeth": [24, 24]},
    }


WITH_SLIDER = BodyList(
    bodies={"ground": {"O": 0j}, "crank": {"O": 0j, "A": 30 + 0j}, "rod": {"A": 0j, "B": 90 + 0j}, "block": {"B": 0j}},
    driver="crank",
    corners=(TriangleCorner("rod", "pen", ("A", "B"), (50.0, 60.0)),),
    sliders=(SliderTable("slide", "block", "ground"),),
)
WITH_SLOT = BodyList(
    bodies={"ground": {"O": 0j, "C": -80j}, "crank": {"O": 0j, "A": 30 + 0j}, "lever": {"C": 0j, "tip": 160 + 0j}},
    driver="crank",
    slots=(PinInSlot("slot", "crank", "A", "lever"),),
)


WITH_MESH = BodyList(
    bodies={
        "ground": {"O": 0j, "C": 80 + 0j},
        "crank": {"O": 0j, "A": 15 + 0j},
        "other_crank": {"C": 0j, "D": 15 + 0j},
        "rod": {"A": 0j, "B": 70 + 0j},
        "other_rod": {"D": 0j, "B": 70 + 0j},
    },
    driver="crank",
    meshes=(GearMesh("gears", "crank", "other_crank", (24, 24), 180.0),),
)


def shown_joints(tables: Collection[str]) -> BodyList:
    """Linkage of a template that shows these tables."""
    return WITH_SLOT if "linkage.slots" in tables else WITH_MESH if "linkage.meshes" in tables else WITH_SLIDER
