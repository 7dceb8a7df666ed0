"""Recipe of a linkage that carries a body through given poses."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import ClassVar, Literal

import numpy as np

from ...core.errors import DesignError
from ...core.fields import ComplexPoint, Coordinate, Ratio, entry, quantity, to_digits
from ...core.records import record
from ...core.units import bare_mm, unit_name
from ...linkage.checks import LEAST_TRANSMISSION_ANGLE_DEG
from ...linkage.motion import Motion, unwrapped_deg
from ...linkage.moving import move
from ...linkage.parts.stock import LinkStock, PlateStock, engraved, pose_axes, skeleton
from ...model.check import Check
from ...model.part import Part
from ...model.scene import Choice, Limit, Plot, Scene, SceneCurve, SceneHandle, SceneRegion, list_handles, pose_handles
from ...model.table import Column, Table
from ...plane.curve import AbstractCurve
from ...plane.primitives import Circle
from ...plane.vec import Complex, direction_deg, rounded
from ...recipe.settings import Drive, Files
from ..guidance.guidance import BodyGuide, body_guides
from ..guidance.guide_groups import LARGEST_RATIO, Kind
from ..guidance.guide_search import Rectification, rectification
from ..guidance.poses import circle_of_sliders, poles
from .linkage_goals import CUT_SHORT, LISTED, AbstractLinkageGoal, Search, choose_entry

# Largest error of a pose, mm and deg, below manufacturing accuracy. Rounding is a billion times smaller, so only
# least-squares fits can fail. Derived here.
MISSED, MISSED_DEG = 0.01, 0.01
# Largest number of poses; the least-squares fit of more takes minutes.
MOST_POSES = 50
# Length of the drawn axes of a pose, in extents of the poses.
AXIS = 0.12
# Margin around the drawing, in its sizes, within which an image-pole circle is drawn; larger ones dominate the drawing.
ROOM = 0.75


FEWER = "five poses or fewer are met exactly"


Rows = tuple[tuple[Coordinate, Coordinate, Coordinate], ...]
PointPair = tuple[ComplexPoint, ComplexPoint]


@record(checked=True, kw_only=True)
class WantedPoses:
    """The poses of a body, and limits of the linkage that carries it."""

    poses: Rows = entry(
        "positions of the body's origin with its angle, [x, y, angle] in mm and deg, three or more, in this order",
        example=((0.0, 0.0, 0.0), (40.0, 20.0, 30.0), (60.0, 60.0, 80.0)),
        units=("mm", "mm", "deg"),
    )
    type: Kind | None = entry(
        "four-bar; crank-slider, driven by its crank; slider-crank, driven by its slider; elliptic-trammel. By "
        "default a four-bar through three poses, and any of them through more",
        default=None,
    )
    moving_points: PointPair | None = entry(
        "the driving and the driven pin on the body, [[x, y], [x, y]] in its own mm, instead of a search", default=None
    )
    fixed_points: PointPair | None = entry(
        "the driving and the driven ground pivot of a four-bar, [[x, y], [x, y]] in mm, instead", default=None
    )
    driving_point: Literal["first", "either"] = entry(
        "which of two given points drives: the first, or either, the better one listed first", default="first"
    )
    region: PointPair | None = entry(
        "corners of the box that holds all pins and pivots, [[x, y], [x, y]] in mm; by default a box about the poses",
        default=None,
    )
    trammel_driver: Literal["shuttle", "rod"] = entry("what drives an elliptic-trammel", default="shuttle")
    least_transmission_angle_deg: float = quantity(
        "least transmission angle", "deg", default=0.0, at_least=0, at_most=89
    )
    largest_ratio: Ratio | None = quantity(
        "longest link over the shortest; 10 by default in a search", default=None, at_least=1, at_most=1e9
    )

    def __post_init__(self) -> None:
        if not 3 <= len(self.poses) <= MOST_POSES:
            raise DesignError("poses", f"found {len(self.poses)}", f"give 3 to {MOST_POSES} of them", "out-of-range")

    @cached_property
    def pairs(self) -> list[tuple[complex, float]]:
        """The poses as the library takes them."""
        return [(complex(x, y), float(np.radians(angle))) for x, y, angle in self.poses]


@record(kw_only=True)
class BodyGuidanceRecipe(AbstractLinkageGoal[BodyGuide]):
    """A body carried through given poses by a linkage that is found: plates, motion, and an engraved drawing of the
    poses.
    """

    kind: Literal["body-guidance"] = "body-guidance"
    wanted: WantedPoses
    search: Search = entry("seed and time limit of the search", default=Search())
    choose: int = choose_entry()
    drive: Drive = entry("how the driver goes", default=Drive())
    stock: LinkStock = entry("what the links are cut from", default=LinkStock())
    files: Files = entry("what is written", default=Files())

    advice: ClassVar[str] = (
        "The drawing uses the coordinates of the poses. If the plates collide or the transmission angle is poor, take "
        "another linkage with choose; summary.json ranks all of them, those with defects last."
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        # Checked before any search; no motion is longer than a turn.
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
            raise error.named(f"wanted.{error.field}") from None

    @property
    def handles(self) -> tuple[SceneHandle, ...]:
        """The poses, the given points, those of the body at the first pose, and the corners of the region."""
        wanted, ((place, angle), *_) = self.wanted, self.wanted.pairs
        handles = list(pose_handles("wanted.poses", wanted.poses))
        at_first = [place + z * np.exp(1j * angle) for z in wanted.moving_points or ()]
        handles += list_handles("wanted.moving_points", at_first, "moving point")
        handles += list_handles("wanted.fixed_points", wanted.fixed_points or (), "fixed point")
        return (*handles, *list_handles("wanted.region", wanted.region or (), "corner of the region"))

    @property
    def choice(self) -> Choice | None:
        """Transmission angle and ratio of links of the linkages found, by their rank."""
        ranked = self.ranked[: max(LISTED, self.choose)]
        if len(ranked) < 2:
            return None
        least, largest = LEAST_TRANSMISSION_ANGLE_DEG, self.search_limits[1]
        angles = np.array([guide.transmission_angle_deg for guide in ranked])
        columns = (
            Column("rank", "", "rank of the linkage", np.arange(1.0, 1 + len(ranked))),
            Column("least_angle", "deg", "least transmission angle; none if the linkage cannot pass the poses", angles),
            Column("link_ratio", "", "longest link over the shortest", np.array([guide.ratio for guide in ranked])),
        )
        plots = (
            Plot(
                "least transmission angle", ("least_angle",), (Limit("least_angle", least, f"at least {least:g} deg"),)
            ),
            Plot("ratio of links", ("link_ratio",), (Limit("link_ratio", largest, f"at most {largest:g}"),)),
        )
        return Choice(Table(columns), self.choose - 1, plots, "choose")

    @property
    def search_limits(self) -> tuple[float, float]:
        wanted = self.wanted
        largest = LARGEST_RATIO if wanted.largest_ratio is None else wanted.largest_ratio
        return wanted.least_transmission_angle_deg, largest

    def met_by(self, found: BodyGuide) -> tuple[Check, ...]:
        return (
            Check(
                "pose_distance",
                "largest distance from a pose",
                _rounded_error(found.pose_error),
                "at most",
                MISSED,
                "mm",
                FEWER,
            ),
            Check(
                "pose_rotation",
                "largest rotation from a pose",
                _rounded_error(found.angle_error_deg),
                "at most",
                MISSED_DEG,
                "deg",
                FEWER,
            ),
        )

    @property
    def table(self) -> Table:
        """The linkage's table with the body's angle; the body's position is that of the coupler point."""
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
        """Positions of the poses, and of the pins at the first pose, mm."""
        motion = move(self.found.linkage, self.found.drive[:1], self.found.branch)
        pins = [complex(motion.point(pin).position[0]) for pin in motion.linkage.pins]
        return np.array([*(z for z, _ in self.wanted.pairs), *pins])

    @property
    def extent(self) -> float:
        """The longer side of the box around the positions in `seen`, mm."""
        return float(max(np.ptp(self.seen.real), np.ptp(self.seen.imag)))

    @property
    def axes(self) -> list[AbstractCurve]:
        """The poses as the body's axes."""
        return pose_axes(self.wanted.pairs, AXIS * self.extent)

    @property
    def shown(self) -> Sequence[SceneCurve]:
        """The poses; the poles of up to five; for three the regions of the pins at the first pose."""
        pairs, near = self.wanted.pairs, 0.01 * self.extent
        shown = [SceneCurve(curve, "wanted", f"pose {k + 1}") for k, curve in enumerate(self.axes)]
        for (j, k), pole in poles(pairs).items() if len(pairs) <= 5 else ():
            place = complex(pole.position)
            if abs(place - self.middle) <= self.room:
                shown.append(SceneCurve(Circle(place, near), "centre", f"pole of poses {j + 1} and {k + 1}"))
        if len(pairs) == 3:
            circles, lines = self.near(self.rectified.circles), self.rectified.lines
            label = "image-pole circle: a driven pin must not lie inside an odd number of them"
            shown += [SceneCurve(curve, "construction", label) for curve in circles]
            label = "line of the driven link: the driving pin must be on the same side of all three"
            shown += [SceneCurve(curve, "construction", label) for curve in lines]
            if self.found.linkage.linkage.sliders:
                sliding = circle_of_sliders(pairs).curve(self.room)
                shown.append(
                    SceneCurve(sliding, "construction", "circle of sliders: possible positions of a sliding pin")
                )
        return shown

    @cached_property
    def scene(self) -> Scene:
        """The scene with the regions of the pins of a linkage through three poses."""
        return replace(super().scene, regions=self.shaded)

    @property
    def shaded(self) -> tuple[SceneRegion, ...]:
        """The forbidden regions of the driven and of the driving pin, within the region of all pins."""
        regions = self.rectified if len(self.wanted.poses) == 3 else None
        if regions is None or regions.driven is None:
            return ()
        half_box = self.room * (1 + 1j)
        box = self.wanted.region or (self.middle - half_box, self.middle + half_box)
        return (
            SceneRegion(regions.no_driven(*box), "driven", "no driven pin here: no pin could drive it"),
            SceneRegion(regions.no_driver(*box), "driving", "no driving pin here: the branch would change"),
        )

    @property
    def middle(self) -> complex:
        """Middle of the poses and the pins, mm."""
        low, high = (complex(end(self.seen.real), end(self.seen.imag)) for end in (np.min, np.max))
        return (low + high) / 2

    @property
    def room(self) -> float:
        """Distance from the middle, mm, beyond which no construction is drawn."""
        return (0.5 + ROOM) * self.extent

    def near(self, curves: Iterable[AbstractCurve]) -> list[AbstractCurve]:
        """The circles near the middle, without lines and larger circles."""
        return [c for c in curves if isinstance(c, Circle) and abs(c.centre - self.middle) + c.radius <= self.room]

    @cached_property
    def rectified(self) -> Rectification:
        """Regions of the pins for three poses, with the driven pin of the chosen linkage."""
        linkage = self.found.linkage.linkage
        driven = [pin for pin, on in linkage.pins.items() if "coupler" in on and linkage.driver not in on]
        motion = move(linkage, self.found.drive[:1], self.found.branch)
        place = complex(motion.point(driven[0]).position[0]) if driven else None
        return rectification(self.wanted.pairs, place, self.extent / 2)

    def marks(self, plate: PlateStock) -> list[AbstractCurve]:
        """Axes of the poses, the linkage at the first one, and for three poses the near image-pole circles."""
        motion = move(self.found.linkage, self.found.drive[:1], self.found.branch)
        circles = self.near(self.rectified.circles) if len(self.wanted.pairs) == 3 else []
        return [*skeleton(motion, 0, plate), *self.axes, *circles]

    @property
    def cut_short(self) -> bool:
        return self.ranked[0].cut_short

    @property
    def remarks(self) -> tuple[str, ...]:
        """Whether the search was cut short, and the driving pin, if points were given."""
        given = self.wanted.moving_points or self.wanted.fixed_points
        cut = (CUT_SHORT,) if self.cut_short else ()
        if given is None or not np.isfinite(self.found.pins).all():
            return cut
        # To a micrometre: the lengths of the found linkage are rounded.
        driving, driven = (
            f"({bare_mm(pin.real, pin.imag):.7g}) {unit_name()}" for pin in rounded(np.array(self.found.pins), 3)
        )
        return (*cut, f"The pin at {driving} on the body drives, and the pin at {driven} is driven.")

    @property
    def notes(self) -> Mapping[str, object]:
        """Adds the poles: their positions, or their directions if they are at infinity."""
        poles_mm: dict[str, object] = {}
        for (j, k), pole in poles(self.wanted.pairs).items() if len(self.wanted.poses) <= 5 else ():
            z = complex(pole.position)
            direction = {"at_infinity_deg": to_digits(np.degrees(np.angle(complex(pole.direction))))}
            position = [to_digits(z.real), to_digits(z.imag)]
            poles_mm[f"{j + 1} and {k + 1}"] = position if np.isfinite(z) else direction
        return {**super().notes, "cut_short": self.cut_short, "poles_mm": poles_mm}


def _rounded_error(missed: float) -> float:
    """An error without rounding noise."""
    return float(rounded(missed, 8))
