"""Tolerances in a recipe of a linkage: their table, and the columns, check, plots and summary that result."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import cached_property
from typing import Annotated, Any, Literal

import numpy as np

from ...core.arguments import between
from ...core.errors import DesignError
from ...core.fields import FARTHEST, entry, quantity, rounded_down, to_digits
from ...core.records import record
from ...core.units import mm
from ...model.check import Check, Suggestion
from ...model.scene import Limit, Plot, Scene, SceneRegion
from ...model.table import Column, Table
from ...plane.primitives import Polyline
from ...plane.vec import Complex, Real, first_largest, unit
from ..checks import in_driver_unit
from ..drive_limits import dead_centres, largest_between, moved_to
from ..motion import Motion
from ..moving import move
from ..sensitivity import quantities
from ..tolerance_analysis import SampledDeviations, ToleranceAnalysis, output_values, tolerances
from .aspects import AbstractLinkageAspect

# Frames at which random linkages are compared: more would only take longer, since deviations change slowly.
SAMPLED_FRAMES = 72
# Width of the drawn band on either side of a path, as a share of the linkage's size: true to scale it would not show.
DRAWN = 0.05
# Share of the largest deviation below which a contribution counts as rounding.
ROUNDING = 1e-9
# Units of the columns of a quantity, of its first and of its second derivative by time.
UNITS = {
    "point": ("mm", "mm/s", "mm/s2"),
    "slider": ("mm", "mm/s", "mm/s2"),
    "body": ("deg", "rad/s", "rad/s2"),
    "angle": ("deg",),
}


@record(checked=True)
class TolerancesTable:
    """How exactly a linkage is made, in a recipe, and which output that concerns."""

    of: str = entry(
        "the output: a point such as coupler_point, or a column such as rocker_angle", example="transmission_angle"
    )
    tolerance: float = quantity(
        "tolerance of every length: from its value minus to its value plus this", "mm", default=0.1, at_least=0,
        at_most=FARTHEST,
    )  # fmt: skip
    lengths: dict[str, Annotated[float, between(0, FARTHEST, "mm")]] = entry(
        "tolerances of single lengths in place of that, such as crank = 0.05", default_factory=dict, units=("mm",)
    )
    clearance: float | None = quantity(
        "by how much the holes are wider than their pins; by default the stock's clearance, or the largest by pin_fit",
        "mm", default=None, at_least=0, at_most=FARTHEST,
    )  # fmt: skip
    limit: float | None = quantity(
        "largest deviation of the output that passes, in the unit of its column; by default there is no limit",
        default=None, above=0, at_most=FARTHEST, example=2,
    )  # fmt: skip
    linkages: int = quantity(
        "number of random linkages that are compared; 0 for none", default=1000, at_least=0, at_most=100_000, whole=True
    )

    def analysis(self, motion: Motion, clearance: float) -> ToleranceAnalysis:
        """Deviations of the output; DesignError with the key of the first name that is wrong."""
        try:
            every = tolerances(motion, self.of, self.tolerance)
            lengths = {**every.lengths, **self.lengths}
            return tolerances(motion, self.of, lengths, clearance if self.clearance is None else self.clearance)
        except DesignError as error:
            raise error.named(f"tolerances.{error.field}") from None


def tolerances_entry() -> Any:
    """Field for the tolerances."""
    return entry(
        "tolerances of the lengths and clearance of the pins; table, plots and summary then have the deviation of an "
        "output",
        default=None,
    )


# Columns that a table of tolerances adds.
NUMBER_OF_COLUMNS = 4


@record(eq=False)
class TolerancesAspect(AbstractLinkageAspect[TolerancesTable]):
    """The deviation of an output by tolerances, in the unit of its column."""

    key = "tolerances"

    @property
    def most_columns(self) -> int:
        return NUMBER_OF_COLUMNS

    def check(self) -> None:
        made = self.mechanism
        self.given.analysis(made.moved(made.input_range.frames[:1]), made.stock.largest_clearance)

    @cached_property
    def analysis(self) -> ToleranceAnalysis:
        """The analysis of the motion."""
        return self.given.analysis(self.mechanism.motion, self.mechanism.stock.largest_clearance)

    @cached_property
    def unit(self) -> str:
        """Unit of the output's column."""
        output = quantities(self.analysis.motion.linkage)[self.given.of]
        return UNITS[output.kind][output.order]

    @property
    def limit(self) -> float | None:
        """The limit of the table in the unit of the column, mm for lengths."""
        given = self.given.limit
        return None if given is None else self.mechanism.length_unit.in_mm(given, self.unit)

    @property
    def factor(self) -> float:
        """From the unit of the analysis to that of the column."""
        return 180 / np.pi if self.unit == "deg" else 1.0

    @property
    def is_path(self) -> bool:
        """Whether the output is the position of a point."""
        return self.given.of in {name for points in self.analysis.motion.linkage.bodies.values() for name in points}

    @cached_property
    def worst_case(self) -> Real:
        """Worst-case deviation at each frame."""
        return self.analysis.worst_case * self.factor

    @cached_property
    def largest(self) -> tuple[float, float]:
        """Largest worst case, also between frames, and the driver there as tables state it; nan if none is known."""
        worst, drive = self._largest(lambda analysis: analysis.worst_case * self.factor)
        return worst, in_driver_unit(self.analysis.motion, drive)

    @cached_property
    def root_sum_square(self) -> float:
        """Largest root sum square, also between frames."""
        return self._largest(lambda analysis: analysis.root_sum_square * self.factor)[0]

    def _largest(self, values: Callable[[ToleranceAnalysis], Real]) -> tuple[float, float]:
        largest, drive = largest_between(
            self.analysis.motion, lambda motion: values(replace(self.analysis, motion=motion))
        )
        return float(largest), float(drive)

    @cached_property
    def of_range(self) -> ToleranceAnalysis:
        """The analysis with the positions at which the output is largest and least, also between frames."""
        motion, output = self.analysis.motion, quantities(self.analysis.motion.linkage)[self.given.of]
        drive, (first, last) = motion.drive, motion.drive[[0, -1]].tolist()
        if output.kind == "point" or first == last:
            return self.analysis
        if output.kind == "body" and not output.order:
            ends = dead_centres(motion.given, output.name, motion.solution.spec, (first, last))
        else:

            def both_ways(moved: Motion) -> Real:
                values = output_values(moved, output)
                return np.array([values, -values])

            ends = largest_between(motion, both_ways)[1]
        drives = np.unique([*drive, *ends[np.isfinite(ends)]])
        drives = drives if last > first else drives[::-1]
        return replace(self.analysis, motion=moved_to(motion, drives[1:]))

    def loosest(self, rule: Literal["worst_case", "root_sum_square"]) -> float | None:
        """The loosest tolerance of all lengths that keeps the limit, mm, also between frames; None if there is none."""
        assert self.limit is not None
        bound = self.limit / self.factor
        loosest = -self._largest(lambda analysis: -analysis.loosest_at_frames(bound, rule))[0]
        return loosest if loosest > 0 else None

    @cached_property
    def across(self) -> tuple[Complex, Real]:
        """Unit normals of the path, and the worst-case deviation along them, mm."""
        with np.errstate(all="ignore"):
            normal = 1j * unit(self.analysis.motion.point(self.given.of).first)
        return normal, self.analysis.worst_case_along(normal)

    def columns(self, table: Table) -> Iterator[Column]:
        """Deviation at each frame, and the limits between which the output lies; table: that of the motion."""
        of, words = self.given.of, self.given.of.replace("_", " ")
        yield Column(f"{of}_worst_case", self.unit, f"worst-case deviation of {words}", self.worst_case)
        squares = self.analysis.root_sum_square * self.factor
        meaning = "deviation, a tolerance being three standard deviations, of"
        yield Column(f"{of}_root_sum_square", self.unit, f"{meaning} {words} by root sum square", squares)
        if self.is_path:
            meaning = "worst-case deviation across the path"
            yield Column(f"{of}_across_path", self.unit, f"{meaning} of {words}", self.across[1])
        elif of in table.ids:
            for end, sign in (("lower", -1), ("upper", 1)):
                values = table[of] + sign * self.worst_case
                yield Column(f"{of}_{end}", self.unit, f"{end} limit of {words} in the worst case", values)

    def plots(self, table: Table) -> Iterator[Plot]:
        """Plots of the columns."""
        of, words = self.given.of, self.given.of.replace("_", " ")
        ids = (f"{of}_worst_case", f"{of}_root_sum_square", *([f"{of}_across_path"] if self.is_path else []))
        limits = [] if self.limit is None else [Limit(ids[0], self.limit, f"at most {self.given.limit:g}")]
        if np.isfinite(self.worst_case).any():
            yield Plot(f"deviation of {words}", ids).with_limits(limits)
            if f"{of}_lower" in table.ids:
                yield Plot(f"{words} within its deviation", (of, f"{of}_lower", f"{of}_upper"))

    @property
    def checks(self) -> Iterator[Check]:
        """The largest worst-case deviation, if there is a limit."""
        limit = self.limit
        if limit is None:
            return
        worst, at = self.largest
        name = f"worst-case deviation of {self.given.of}"
        column = f"{self.given.of}_worst_case"
        if np.isnan(worst):
            yield Check("deviation", name, worst, "at most", limit, self.unit, "give another output", column)
            return
        advice, suggestions = self._advice() if worst > limit else ("", ())
        yield Check("deviation", name, worst, "at most", limit, self.unit, advice, column, at, suggestions=suggestions)

    def _advice(self) -> tuple[str, tuple[Suggestion, ...]]:
        loosest = self.loosest("worst_case")
        # By default the clearance is that of the stock, or of its fit.
        has_fit = self.given.clearance is None and self.mechanism.stock.pin_fit
        closer = "a closer stock.pin_fit" if has_fit else "a smaller clearance"
        if not loosest:
            return f"the clearance alone exceeds it: give {closer}, or other lengths", ()
        tolerance = rounded_down(loosest * (1 - ROUNDING), 3)
        keys = ["tolerances.tolerance"] * bool(self.given.tolerance)
        keys += [f"tolerances.lengths.{name}" for name, value in self.given.lengths.items() if value]
        advice = f"cut all lengths to at most {mm(float(tolerance)):down}, or give {closer}"
        return advice, (Suggestion(dict.fromkeys(keys, float(tolerance)), "mm"),)

    @cached_property
    def enlarged(self) -> float:
        """Factor by which the band about a path is enlarged so that it can be seen; 0 if there is none."""
        if not self.is_path:
            return 0.0
        width = float(np.max(self.across[1], where=np.isfinite(self.across[1]), initial=0.0))
        return _round_number(DRAWN * float(np.max(self.analysis.motion.linkage.size)) / width) if width else 0.0

    def regions(self) -> tuple[SceneRegion, ...]:
        """The band about the path of a point."""
        from ...plane.region import union

        if not self.enlarged:
            return ()
        normal, deviation = self.across
        path = self.analysis.motion.point(self.given.of).position
        left, right = (path + sign * self.enlarged * deviation * normal for sign in (1, -1))
        quads = np.stack([left[:-1], right[:-1], right[1:], left[1:]], axis=1)
        areas = union([_convex(quad) for quad in quads if np.isfinite(quad).all()])
        curves = tuple(Polyline(loop) for loops in areas for loop in loops)
        label = f"{self.given.of} deviation, enlarged {self.enlarged:g} times"
        return (SceneRegion(curves, "deviation", label),) if curves else ()

    @cached_property
    def sampled(self) -> SampledDeviations | None:
        """Random linkages at some of the frames; None if there are none, or they can only be solved one by one."""
        motion = self.analysis.motion
        if not self.given.linkages:
            return None
        step = max(1, -(-len(motion.drive) // SAMPLED_FRAMES))
        frames = np.unique([*range(0, len(motion.drive), step), first_largest(self.worst_case)])
        try:
            speed, acceleration = float(motion.timing.speed), float(motion.timing.acceleration)
            some = move(motion.given, motion.drive[frames], motion.solution.spec, speed, acceleration)
            return replace(self.analysis, motion=some).monte_carlo(self.given.linkages)
        except DesignError:
            return None

    @cached_property
    def within(self) -> Mapping[str, float]:
        """Share of the linkages within the root sum square, %, by the distribution of the errors of lengths."""
        errors: tuple[Literal["normal", "uniform"], ...] = ("normal", "uniform")
        return {name: to_digits(100 * self.analysis.share_within_root_sum_square(name), 3) for name in errors}

    def on_scene(self, scene: Scene) -> Scene:
        return replace(scene, regions=self.regions())

    @property
    def remarks(self) -> Iterator[str]:
        """The largest deviation, and what the root sum square assumes."""
        worst, _ = self.largest
        if not np.isfinite(worst):
            yield f"The deviation of {self.given.of} is not known at any position."
            return
        clearance = max(self.analysis.clearances.values(), default=0.0)
        band = f" The band about its path is enlarged {self.enlarged:g} times." if self.enlarged else ""
        normal, uniform = (f"{self.within[errors]:g} %" for errors in ("normal", "uniform"))
        yield (
            f"If lengths are cut to {mm(self.given.tolerance):g} and holes are {mm(clearance):g} wider than their "
            f"pins, {self.given.of} deviates by at most {mm(worst, unit=self.unit):.3g}. The root sum square is "
            f"{mm(self.root_sum_square, unit=self.unit):.3g}: {normal} of all linkages keep within it if errors "
            "of lengths are normally distributed, a tolerance being three standard deviations, and "
            f"{uniform} if they are uniformly distributed.{band}"
        )

    @property
    def entries(self) -> Mapping[str, object]:
        worst, at = self.largest
        unit = self.unit.replace("/", "_per_")
        if not np.isfinite(worst):
            return {"tolerances": {"of": self.given.of, f"worst_case_{unit}": None}}
        driver = "mm" if self.analysis.motion.linkage.driven_slider else "deg"
        contributions = {
            name: float(np.max(term, where=np.isfinite(term), initial=0.0)) * self.factor
            for name, term in self.analysis.contributions.items()
        }
        entries: dict[str, object] = {
            "of": self.given.of,
            f"worst_case_{unit}": to_digits(worst, 6),
            f"worst_case_at_{driver}": to_digits(at, 6),
            f"root_sum_square_{unit}": to_digits(self.root_sum_square, 6),
            "within_root_sum_square_percent": self.within,
            # Smaller ones are rounding.
            f"contributions_{unit}": {
                name: to_digits(value, 6) for name, value in contributions.items() if value > ROUNDING * worst
            },
        }
        if np.isfinite(self.of_range.range_worst_case):
            entries[f"range_worst_case_{unit}"] = to_digits(self.of_range.range_worst_case * self.factor, 6)
            entries[f"range_root_sum_square_{unit}"] = to_digits(self.of_range.range_root_sum_square * self.factor, 6)
        if self.limit is not None:
            rules: tuple[Literal["worst_case", "root_sum_square"], ...] = ("worst_case", "root_sum_square")
            loosest = {rule: self.loosest(rule) for rule in rules}
            entries["loosest_tolerance_mm"] = {rule: value and to_digits(value, 6) for rule, value in loosest.items()}
        if self.sampled is not None:
            largest = self.sampled.largest() * self.factor
            entries["random"] = {
                "linkages": self.given.linkages,
                f"largest_of_99.73_percent_{unit}": to_digits(np.fmax.reduce(largest), 6),
                "not_assembled": int(self.sampled.not_assembled.max()),
            }
            if self.limit is not None:
                share = self.sampled.share_within(self.limit / self.factor)
                entries["random"]["within_limit_percent"] = to_digits(100 * share, 6)  # type: ignore[index]
        return {"tolerances": entries}


def _convex(quad: Complex) -> Complex:
    """The four corners, in an order in which their sides do not cross."""
    return quad[np.argsort(np.angle(quad - quad.mean()))]


def _round_number(value: float) -> float:
    """The largest of 1, 2, 5, 10, ... that does not exceed a value; 1 at least."""
    power = 10.0 ** np.floor(np.log10(max(value, 1.0)))
    return float(next(digit for digit in (5, 2, 1) if digit * power <= max(value, 1.0)) * power)
