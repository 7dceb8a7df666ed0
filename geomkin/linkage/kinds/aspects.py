"""The base class of aspects of linkages, and the short ones: dwell, straight lines, components, both modes, copies."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cached_property
from typing import Annotated, Any, Generic, TypeVar

import numpy as np

from ...core.arguments import between
from ...core.errors import DesignError, shown
from ...core.fields import FARTHEST, entry, quantity, to_digits
from ...core.records import record
from ...core.units import marked, mm
from ...model.check import Check
from ...model.scene import Limit, Plot, Scene, SceneCurve, SceneHandle, point_handle
from ...model.table import Column, Table
from ...plane.primitives import Segment
from ...plane.vec import dot, rounded
from ...recipe.aspect import AbstractAspect
from ...recipe.settings import Stroke, Turn
from ..checks import assembly_failure
from ..dwell import longest_dwell
from ..instant.polygons import component_plots, components_check
from ..linkage import Linkage
from ..measures import StraightPart, straight_part, transmission_extreme
from ..motion import Motion, is_translating, on_ground
from ..parts.rotating_masses import Flywheel, RoundEnd
from ..scene import linkage_scene, with_components
from .copies import Copy, check_copies, driven_check, is_whole_turn, with_copies
from .made import MadeLinkage

# Least number of positions over the range of the driver in which a dwell is looked for.
DWELL_FRAMES = 3601


@record(checked=True)
class DwellBand:
    """The band within which an output counts as standing still, in a recipe."""

    band_deg: float | None = quantity(
        "largest less smallest angle of the output in its dwell; for an output that turns", "deg", default=None,
        above=0, at_most=360, example=0.5,
    )  # fmt: skip
    band_mm: float | None = quantity(
        "largest less smallest displacement of the output in its dwell; for an output that slides", "mm",
        default=None, above=0, at_most=FARTHEST, example=0.5,
    )  # fmt: skip
    output: str = entry("the body; by default the last one on the ground that does not drive", default="")

    def body(self, linkage: Linkage) -> str:
        """Name of the output; DesignError if it does not move, or there is none."""
        moving = list(linkage.bodies)[1:]
        driven = [name for name in moving if name in on_ground(linkage) and name != linkage.driver]
        if self.output in moving or (driven and not self.output):
            return self.output or driven[-1]
        raise DesignError(
            "dwell.output", f"found {shown(self.output)}", f"give one of {', '.join(moving)}", "unknown-key"
        )

    def found(self, motion: Motion) -> Mapping[str, Any]:
        """The longest dwell, as entries of the summary."""
        output = self.body(motion.linkage)
        slides = is_translating(motion, output)
        unit, factor = ("mm", 1.0) if slides else ("deg", 180 / np.pi)
        band = self.band_mm if slides else self.band_deg
        if band is None:
            verb = "slides" if slides else "turns"
            raise DesignError(f"dwell.band_{unit}", "is missing", f"give band_{unit}: {output} {verb}", "missing-key")
        by, driver_factor = ("mm", 1.0) if motion.linkage.driven_slider else ("deg", 180 / np.pi)
        dwell = longest_dwell(motion, output, band / factor)
        values = {
            f"from_{by}": dwell.start * driver_factor,
            f"to_{by}": dwell.end * driver_factor,
            f"driver_range_{by}": dwell.range * driver_factor,
            f"least_{unit}": dwell.low * factor,
            f"greatest_{unit}": dwell.high * factor,
        }
        rounded = {name: to_digits(value, 10) for name, value in values.items()}
        return {"output": output, f"band_{unit}": band, **rounded}


T = TypeVar("T")


@record(eq=False)
class AbstractLinkageAspect(AbstractAspect[MadeLinkage, T], Generic[T]):
    """Base class of aspects of linkages."""

    @property
    def round_ends(self) -> Mapping[str, RoundEnd]:
        """Counterweights of the plates of bodies."""
        return {}

    @property
    def flywheel(self) -> Flywheel | None:
        """The flywheel on the driver."""
        return None

    def with_bodies(self, scene: Scene, motion: Motion) -> Scene:
        """The scene of a motion with the bodies that this aspect adds."""
        return scene


@record(eq=False)
class DwellAspect(AbstractLinkageAspect[DwellBand]):
    """The longest dwell of an output."""

    key = "dwell"

    def check(self) -> None:
        self.given.body(self.mechanism.linkage.linkage)

    @cached_property
    def found(self) -> Mapping[str, Any]:
        """The longest dwell in a motion of small steps, whatever those of the table are."""
        frames = self.mechanism.input_range.frames
        return self.given.found(
            self.mechanism.moved(np.linspace(frames[0], frames[-1], max(DWELL_FRAMES, len(frames))))
        )

    @property
    def entries(self) -> Mapping[str, object]:
        return {"dwell": self.found}

    @property
    def quantities(self) -> Mapping[str, str]:
        found = self.found
        slid = "driver_range_mm" in found
        way, start, end = (found[f"{name}_{'mm' if slid else 'deg'}"] for name in ("driver_range", "from", "to"))
        ways = f"{mm(way):.4g} of the driver, from {mm(start, end, between=' to '):.4g}"
        return {
            f"dwell of {found['output']}": ways
            if slid
            else f"{way:.4g} deg of the driver, from {start:.4g} to {end:.4g}"
        }


@record(eq=False)
class BothModesAspect(AbstractLinkageAspect[bool]):
    """The other assembly mode."""

    key = "both_modes"

    @property
    def most_columns(self) -> int:
        return self.mechanism.most_columns

    def check(self) -> None:
        if self.mechanism.other is None:
            problem = "found true, but there is no other mode: it cannot be assembled, or there are more than two dyads"
            raise DesignError("both_modes", problem, "omit it", "conflict")

    @property
    def other(self) -> tuple[str, Motion]:
        """The joint on its other side, and the motion."""
        assert self.mechanism.other is not None
        return self.mechanism.other

    def columns(self, table: Table) -> Iterator[Column]:
        # Both modes have the same columns of driver and time.
        for column in self.mechanism.table_of(self.other[1]).columns[2:]:
            if (id := f"other_{column.id}") in table.ids:
                linkage = self.mechanism.motion.linkage
                points = (point for points in linkage.bodies.values() for point in points)
                names = (*linkage.bodies, *points, *(joint.name for joint in linkage.joints))
                name = max((name for name in names if id.startswith(f"{name}_")), key=len, default=id)
                problem = f"found true, whose columns begin with other_, and {shown(id)} is already a column of {name}"
                raise DesignError("both_modes", problem, f"give {name} another name, or omit both_modes", "conflict")
            yield replace(column, id=id, meaning=f"in the other mode, {marked(column.meaning)}")

    @property
    def entries(self) -> Mapping[str, object]:
        joint, motion = self.other
        angle = {"least_transmission_angle_deg": to_digits(transmission_extreme(motion, -1)[0], 10)}
        return {"other_mode": {"joint": joint, **self.mechanism.reaches(motion.solution.spec), **angle}}


@record(eq=False)
class CopiesAspect(AbstractLinkageAspect[tuple[Copy, ...]]):
    """Copies on the same shaft."""

    key = "copies"

    def check(self) -> None:
        check_copies(self.given, self.mechanism.linkage, self.mechanism.input_range)

    def with_bodies(self, scene: Scene, motion: Motion) -> Scene:
        made = self.mechanism
        copies = made.moving_copies if motion is made.motion else made.copies_of(motion)
        lowest = 1 + max(made.stack.layers.values())
        return with_copies(scene, copies, made.copy_parts, made.copy_stack.layers, lowest)

    def on_scene(self, scene: Scene) -> Scene:
        scene = self.with_bodies(scene, self.mechanism.motion)
        if not scene.assembled.any() and (failure := assembly_failure(self.mechanism.motion)):
            problem = f"the linkage and its copies close in no common position; {marked(failure.text)}"
            raise DesignError("copies", problem, f"{marked(failure.remedy)}, or omit copies", "does-not-assemble")
        return scene

    @property
    def checks(self) -> Iterator[Check]:
        if self.mechanism.stock.motor:
            attached = [item.name for item in self.mechanism.stock.attachments]
            yield driven_check(self.given, self.mechanism.shared, attached)


def other_mode_scene(made: MadeLinkage) -> dict[str, Scene]:
    """The plates in the other assembly mode, by its name; empty if it is open."""
    if made.other is None:
        return {}
    joint, motion = made.other
    # The slots of a ground are for the requested mode only.
    slotted = made.motion.linkage.ground if made.motion.linkage.slides else ""
    parts = [part for part in made.own_parts if not slotted or part.body != slotted]
    # Plots are those of the requested mode, or of both.
    table = Table(made.table_of(made.motion).columns[:2])
    return {f"{joint} on its other side": linkage_scene(motion, table, parts, made.stack.layers, rates=False)}


@record(eq=False)
class ComponentsAspect(AbstractLinkageAspect[bool]):
    """The components of each pin's velocity and acceleration along and across its link, columns of either mode."""

    key = "effective_components"

    def plots(self, table: Table) -> Iterator[Plot]:
        return component_plots(self.mechanism.motion)

    def on_scene(self, scene: Scene) -> Scene:
        return with_components(scene, self.mechanism.motion)

    @property
    def checks(self) -> Iterator[Check]:
        yield components_check(self.mechanism.motion)


Angle = Annotated[float, between(-3600, 3600, "deg")]
# Decimals of the distance from the line, mm: what follows is rounding noise of coordinates of 100 mm.
DECIMALS = 9


@record(checked=True)
class StraightLineTable:
    """How straight a part of a point's path should be, how long, and how constant the speed along it."""

    most_deviation: float = quantity(
        "largest distance of the path from its best straight line", "mm", at_least=0, at_most=FARTHEST, example=20.0
    )
    point: str = entry("the point; by default the last one of a moving body that is no pin", default="")
    over_deg: tuple[Angle, Angle] | None = entry(
        "[first, last] angle of a turning driver between which the path counts, such as [110, 250]; by default all",
        default=None,
        units=("deg", "deg"),
    )
    least_length: float | None = quantity(
        "least length of the line, such as a stroke or a stride", "mm", default=None, above=0, at_most=FARTHEST,
        example=10,
    )  # fmt: skip
    most_speed_variation_percent: float | None = quantity(
        "largest variation of the speed along the line: largest less least, over the mean, at a constant speed of the "
        "driver",
        "%",
        default=None,
        above=0,
        at_most=FARTHEST,
    )

    def point_of(self, linkage: Linkage) -> str:
        """Name of the point; DesignError if no moving body has it."""
        points = moving_points(linkage)
        if not points:
            problem = "is given, but no moving body has a point that could follow a line"
            raise DesignError("straight_line", problem, "omit it", "conflict")
        if self.point and self.point not in points:
            remedy = f"give a point of a moving body: {', '.join(dict.fromkeys(points))}"
            raise DesignError("straight_line.point", f"found {shown(self.point)}", remedy, "unknown-key")
        return self.point or ([name for name in points if name not in linkage.pins] or points)[-1]

    def part_of(self, input_range: Turn | Stroke) -> tuple[float, float]:
        """The drives between which the path counts, rad or mm; DesignError if the driver does not go there."""
        low, high = input_range.rising
        if self.over_deg is None:
            return low, high
        if isinstance(input_range, Stroke):
            problem, remedy = "is given, but the driver slides", "omit it, and give the stroke of the straight part"
            raise DesignError("straight_line.over_deg", problem, remedy, "conflict")
        start, end = np.radians(self.over_deg).tolist()
        turns = is_whole_turn(input_range)
        first, last = np.degrees([low, high]).tolist()
        remedy = (
            f"give two angles, rising, at most {last - first:g} deg apart"
            if turns
            else f"give two angles, rising, between {first:g} and {last:g} deg"
        )
        is_inside = end - start <= high - low if turns else low <= start and end <= high
        if not (start < end and is_inside):
            raise DesignError("straight_line.over_deg", f"found {list(self.over_deg)}", remedy, "out-of-range")
        return start, end


def moving_points(linkage: Linkage) -> list[str]:
    """Names of points that may follow a line, once for each body that has them."""
    fixed = linkage.bodies[linkage.ground]
    return [name for names in linkage.bodies.values() for name in names if name not in fixed]


def straight_line_entry() -> Any:
    """Field for the straight line."""
    return entry(
        "straight line that a part of a point's path is compared with; checks report how straight it is, how long, and "
        "how constant its speed",
        default=None,
    )


@record(eq=False)
class StraightLineAspect(AbstractLinkageAspect[StraightLineTable]):
    """The straight line that is nearest to a part of a point's path."""

    key = "straight_line"

    @property
    def most_columns(self) -> int:
        return 1

    def check(self) -> None:
        self.given.point_of(self.mechanism.linkage.linkage)
        self.given.part_of(self.mechanism.input_range)

    @cached_property
    def point(self) -> str:
        """Name of the point."""
        return self.given.point_of(self.mechanism.linkage.linkage)

    @cached_property
    def part(self) -> StraightPart:
        """The line, also between frames."""
        return straight_part(self.mechanism.motion, self.point, *self.given.part_of(self.mechanism.input_range))

    def columns(self, table: Table) -> Iterator[Column]:
        motion, part = self.mechanism.motion, self.part
        start, end = self.given.part_of(self.mechanism.input_range)
        rounding = 1e-9 * (end - start)
        drive = motion.drive
        if is_whole_turn(self.mechanism.input_range):
            drive = start + np.remainder(drive - start + rounding, 2 * np.pi) - rounding
        distance = dot(motion.point(self.point).position - part.start, 1j * part.direction)
        inside = (start - rounding <= drive) & (drive <= end + rounding)
        words = f"distance of {self.point} from its straight line, to the left, in the straight part"
        yield Column(f"{self.point}_off_line", "mm", words, np.where(inside, rounded(distance, DECIMALS), np.nan))

    def plots(self, table: Table) -> Iterator[Plot]:
        id, most = f"{self.point}_off_line", self.given.most_deviation
        if np.isfinite(table[id]).any():
            limits = [Limit(id, side * most, f"{side * most:g}") for side in (-1, 1)]
            yield Plot(f"distance of {self.point} from its straight line", (id,)).with_limits(limits)

    def on_scene(self, scene: Scene) -> Scene:
        if not self.part.length > 0:
            return scene
        segment, words = Segment(self.part.start, self.part.end), f"{mm(self.part.length):.4g} straight"
        line = SceneCurve(segment, "construction", words)
        return replace(scene, curves=(*scene.curves, line))

    @property
    def handles(self) -> Iterator[SceneHandle]:
        """The least length, along the line from its start, and the largest deviation, beside its middle."""
        part, given = self.part, self.given
        aside = (part.start + part.end) / 2 + 1j * part.direction * given.most_deviation
        yield point_handle("straight_line.most_deviation", at=aside, label="largest deviation")
        if given.least_length is not None:
            end = part.start + part.direction * given.least_length
            yield point_handle("straight_line.least_length", at=end, label="least length")

    @property
    def checks(self) -> Iterator[Check]:
        part, given = self.part, self.given
        open_advice = "" if np.isfinite(part.deviation) else "the linkage is open there: "
        advice = f"{open_advice}give a shorter part of the turn in straight_line.over_deg, or other lengths"
        name, column = f"largest distance of {self.point} from a straight line", f"{self.point}_off_line"
        yield Check("straightness", name, part.deviation, "at most", given.most_deviation, "mm", advice, column)
        if (least := given.least_length) is not None:
            advice = f"{open_advice}give a longer part of the turn, or a larger linkage"
            yield Check("straight_length", "length of the straight line", part.length, "at least", least, "mm", advice)
        if (most := given.most_speed_variation_percent) is not None:
            advice = f"{open_advice}give a shorter part of the turn, or other lengths"
            name, value = "variation of the speed along the straight line", 100 * part.speed_variation
            yield Check("straight_speed", name, value, "at most", most, "%", advice)

    @property
    def entries(self) -> Mapping[str, object]:
        part = self.part
        values = {
            "deviation_mm": part.deviation,
            "length_mm": part.length,
            "speed_variation_percent": 100 * part.speed_variation,
        }
        known = {name: to_digits(value, 8) if np.isfinite(value) else None for name, value in values.items()}
        return {"straight_line": {"point": self.point, **known}}
