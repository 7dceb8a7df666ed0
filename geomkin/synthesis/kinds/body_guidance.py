"""Goal of a body that is to go through poses: the linkage that carries it, found and made."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Annotated, Any, ClassVar, Literal

import numpy as np

from ...core.errors import DesignError
from ...core.fields import PointXY, RowsOf, entry, quantity
from ...core.records import record
from ...linkage.motion import Motion, unwrapped_deg
from ...linkage.moving import move
from ...linkage.parts.engraved import PlateStock, engraved, pose_axes, skeleton
from ...linkage.parts.stock import LinkStock
from ...model.check import Check
from ...model.part import Part
from ...model.scene import Scene, SceneCurve, SceneRegion
from ...model.table import Column, Table
from ...plane.curve import AbstractCurve
from ...plane.primitives import Circle
from ...plane.vec import Complex, direction_deg, rounded
from ...recipe.settings import Drive, Files
from ..guidance.filemon_waldron import Rectification, rectification
from ..guidance.guidance import BodyGuide, body_guides
from ..guidance.guide_groups import KINDS, LARGEST_RATIO, Kind
from ..guidance.poses import circle_of_sliders, poles
from .linkage_goals import AbstractLinkageGoal, Search, choose_entry

# What the body may miss of a pose, mm and deg: finer than any plate is cut. Rounding is a thousand millionth of it, so
# that only poses that are met by least squares can fail. Derived here.
MISSED, MISSED_DEG = 0.01, 0.01
# Poses that are read: more are a path of a body, and their least squares take minutes.
MOST_POSES = 50
# Length of the axes that a pose is drawn with, in extents of the poses.
AXIS = 0.12
# Sizes of the rest of the drawing that an image-pole circle may be off to be drawn. Larger ones hide all else.
ROOM = 0.75


FEWER = "five poses or fewer are met exactly"


class OneOfGuides:
    """Marks the choice of a linkage, so that a wrong one is refused once and not by each word."""

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> Any:
        return {"type": "literal", "expected": list(KINDS)}


Rows = Annotated[tuple[tuple[float, float, float], ...], RowsOf(3)]
PointPair = tuple[Annotated[complex, PointXY()], Annotated[complex, PointXY()]]


@record(checked=True, kw_only=True)
class WantedPoses:
    """Where a body is to be, and what may carry it there."""

    poses: Rows = entry(
        "places of the body's origin and its angle, [x, y, angle] in mm and deg, three or more, in this order",
        example=((0.0, 0.0, 0.0), (40.0, 20.0, 30.0), (60.0, 60.0, 80.0)),
        units=("mm", "mm", "deg"),
    )
    type: Annotated[Kind, OneOfGuides()] | None = entry(
        "four-bar; crank-slider, which its crank drives; slider-crank, which its slider drives; elliptic-trammel. Left "
        "out: a four-bar through three poses, whatever there is through more",
        default=None,
    )
    moving_points: PointPair | None = entry(
        "the driving and the driven pin on the body, [[x, y], [x, y]] in its own mm, instead of a search", default=None
    )
    fixed_points: PointPair | None = entry(
        "the driving and the driven ground pivot of a four-bar, [[x, y], [x, y]] in mm, instead", default=None
    )
    driving_point: Literal["first", "either"] = entry(
        "which of two points that are given drives: the first, or either, the better one first", default="first"
    )
    region: PointPair | None = entry(
        "corners of the box that holds all pins and pivots, [[x, y], [x, y]] in mm; left out, one about the poses",
        default=None,
    )
    trammel_driver: Literal["shuttle", "rod"] = entry("what drives an elliptic-trammel", default="shuttle")
    least_transmission_angle_deg: float = quantity(
        "the least that is taken", "deg", default=0.0, at_least=0, at_most=89
    )
    largest_ratio: float | None = quantity(
        "longest link over the shortest; 10 in a search where it is left out", default=None, at_least=1, at_most=1e9
    )

    def __post_init__(self) -> None:
        if not 3 <= len(self.poses) <= MOST_POSES:
            raise DesignError("poses", f"found {len(self.poses)}", f"give 3 to {MOST_POSES} of them")

    @cached_property
    def pairs(self) -> list[tuple[complex, float]]:
        """As the library takes them."""
        return [(complex(x, y), float(np.radians(angle))) for x, y, angle in self.poses]


@record(kw_only=True)
class BodyGuidanceRecipe(AbstractLinkageGoal[BodyGuide]):
    """A body carried through poses by a linkage that is found: plates, motion, and the poses as an engraved drawing."""

    kind: Literal["body-guidance"] = "body-guidance"
    wanted: WantedPoses
    search: Search = entry("how long to look, and from where", default=Search())
    choose: int = choose_entry()
    drive: Drive = entry("how the driver goes", default=Drive())
    stock: LinkStock = entry("what the links are cut from", default=LinkStock())
    files: Files = entry("what is written", default=Files())

    advice: ClassVar[str] = (
        "The first pose's coordinates are those of the drawing. A linkage whose plates meet, or that drives badly, is "
        "passed over by choose; summary.json ranks what was found, those with defects last, by name."
    )

    def __post_init__(self) -> None:
        # Before any search: no way is longer than a turn.
        self.drive.check_rows()

    @cached_property
    def ranked(self) -> Sequence[BodyGuide]:
        wanted = self.wanted
        try:
            return body_guides(
                wanted.pairs,
                wanted.type,
                wanted.moving_points,
                wanted.fixed_points,
                wanted.region,
                wanted.trammel_driver,
                wanted.least_transmission_angle_deg,
                wanted.largest_ratio,
                self.search.seed,
                self.search.time_limit,
                wanted.driving_point,
            )
        except DesignError as error:
            raise DesignError(f"wanted.{error.field}", error.problem, error.remedy, error.id) from None

    @property
    def search_limits(self) -> tuple[float, float]:
        wanted = self.wanted
        largest = LARGEST_RATIO if wanted.largest_ratio is None else wanted.largest_ratio
        return wanted.least_transmission_angle_deg, largest

    def met_by(self, found: BodyGuide) -> tuple[Check, ...]:
        return (
            Check(
                "pose_distance", "largest distance from a pose", _told(found.pose_error), "at most", MISSED, "mm", FEWER
            ),
            Check(
                "pose_rotation",
                "largest turn from a pose",
                _told(found.angle_error_deg),
                "at most",
                MISSED_DEG,
                "deg",
                FEWER,
            ),
        )

    @property
    def table(self) -> Table:
        """The linkage's, and the body's angle; its place is that of the coupler point."""
        motion: Motion = self.design.motion
        coupler = motion.bodies["rod" if "rod" in motion.linkage.bodies else "coupler"]
        angle = unwrapped_deg(coupler.direction * direction_deg(self.found.body_angle_deg))
        return Table((*super().table.columns, Column("body_angle", "deg", "direction of the body from +x", angle)))

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        plate = PlateStock(thickness=self.stock.thickness, pin_diameter=self.stock.pin_diameter)
        return (*super().parts, engraved("poses", self.marks(plate), plate))

    @cached_property
    def seen(self) -> Complex:
        """Places of the poses, and of the pins at the first, mm."""
        motion = move(self.found.linkage, self.found.drive[:1], self.found.branch)
        pins = [complex(motion.point(pin).position[0]) for pin in motion.linkage.pins]
        return np.array([*(z for z, _ in self.wanted.pairs), *pins])

    @property
    def extent(self) -> float:
        """The longer side of what holds them, mm."""
        return float(max(np.ptp(self.seen.real), np.ptp(self.seen.imag)))

    @property
    def axes(self) -> list[AbstractCurve]:
        """The poses as the body's axes."""
        return pose_axes(self.wanted.pairs, AXIS * self.extent)

    @property
    def shown(self) -> Sequence[SceneCurve]:
        """The poses; of up to five their poles, and of three what its pins were chosen by, where the body is first."""
        pairs, near = self.wanted.pairs, 0.01 * self.extent
        shown = [SceneCurve(curve, "wanted", f"pose {k + 1}") for k, curve in enumerate(self.axes)]
        for (j, k), pole in poles(pairs).items() if len(pairs) <= 5 else ():
            place = complex(pole.position)
            if abs(place - self.middle) <= self.room:
                shown.append(SceneCurve(Circle(place, near), "centre", f"pole of poses {j + 1} and {k + 1}"))
        if len(pairs) == 3:
            circles, lines = self.near(self.rectified.circles), self.rectified.lines
            label = "image-pole circle: no driven pin lies within an odd number of them"
            shown += [SceneCurve(curve, "construction", label) for curve in circles]
            label = "line of the driven link: the driving pin lies on one side of all three"
            shown += [SceneCurve(curve, "construction", label) for curve in lines]
            if self.found.linkage.linkage.sliders:
                sliding = circle_of_sliders(pairs).curve(self.room)
                shown.append(SceneCurve(sliding, "construction", "circle of sliders: where a pin that slides may sit"))
        return shown

    @cached_property
    def scene(self) -> Scene:
        """With the regions that the pins of a linkage through three poses are chosen by."""
        return replace(super().scene, regions=self.shaded)

    @property
    def shaded(self) -> tuple[SceneRegion, ...]:
        """Where the driven pin may not be, and where the driving one does not drive it, in the region of all pins."""
        found = self.rectified if len(self.wanted.poses) == 3 else None
        if found is None or found.driven is None:
            return ()
        half = self.room * (1 + 1j)
        box = self.wanted.region or (self.middle - half, self.middle + half)
        return (
            SceneRegion(found.no_driven(*box), "driven", "no driven pin here: nothing would drive it"),
            SceneRegion(found.no_driver(*box), "driving", "no driving pin here: the branch would change on the way"),
        )

    @property
    def middle(self) -> complex:
        """Of the poses and the pins, mm."""
        low, high = (complex(end(self.seen.real), end(self.seen.imag)) for end in (np.min, np.max))
        return (low + high) / 2

    @property
    def room(self) -> float:
        """Distance from the middle, mm, beyond which a construction hides the rest of a drawing."""
        return (0.5 + ROOM) * self.extent

    def near(self, curves: Iterable[AbstractCurve]) -> list[AbstractCurve]:
        """Those that are circles near by: what is larger or a line hides all else."""
        return [c for c in curves if isinstance(c, Circle) and abs(c.centre - self.middle) + c.radius <= self.room]

    @cached_property
    def rectified(self) -> Rectification:
        """Of three poses: what the driven link, as it was found, lets the driving one be."""
        linkage = self.found.linkage.linkage
        driven = [pin for pin, on in linkage.pins.items() if "coupler" in on and linkage.driver not in on]
        motion = move(linkage, self.found.drive[:1], self.found.branch)
        place = complex(motion.point(driven[0]).position[0]) if driven else None
        return rectification(self.wanted.pairs, place, self.extent / 2)

    def marks(self, plate: PlateStock) -> list[AbstractCurve]:
        """The poses as their axes, the linkage at the first, and of three poses the image-pole circles near by."""
        motion = move(self.found.linkage, self.found.drive[:1], self.found.branch)
        circles = self.near(self.rectified.circles) if len(self.wanted.pairs) == 3 else []
        return [*skeleton(motion, 0, plate), *self.axes, *circles]

    @property
    def remarks(self) -> tuple[str, ...]:
        """Which pin drives, if points were given."""
        given = self.wanted.moving_points or self.wanted.fixed_points
        if given is None or not np.isfinite(self.found.pins).all():
            return ()
        driving, driven = (f"[{pin.real:.6g}, {pin.imag:.6g}]" for pin in self.found.pins)
        return (f"The pin at {driving} on the body drives, and the pin at {driven} is driven.",)

    @property
    def notes(self) -> Mapping[str, object]:
        """The poles too: their places, or their directions where they are at infinity."""
        told: dict[str, object] = {}
        for (j, k), pole in poles(self.wanted.pairs).items() if len(self.wanted.poses) <= 5 else ():
            z = complex(pole.position)
            far = {"at_infinity_deg": float(f"{np.degrees(np.angle(complex(pole.direction))):.9g}")}
            near = [float(f"{z.real:.9g}"), float(f"{z.imag:.9g}")]
            told[f"{j + 1} and {k + 1}"] = near if np.isfinite(z) else far
        return {**super().notes, "poles_mm": told}


def _told(missed: float) -> float:
    """What is missed, without what is rounding."""
    return float(rounded(missed, 8))
