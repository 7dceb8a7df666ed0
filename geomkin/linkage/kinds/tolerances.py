"""Tolerances in a recipe of a linkage: their table, and the columns, check, plots and summary that result."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cached_property
from typing import Annotated, Any

import numpy as np

from ...core.arguments import between
from ...core.errors import DesignError
from ...core.fields import FARTHEST, entry, quantity, to_digits
from ...core.records import record
from ...model.check import Check
from ...model.scene import Limit, Plot, SceneRegion
from ...model.table import Column, Table
from ...plane.primitives import Polyline
from ...plane.vec import Complex, Real, first_largest, unit
from ..checks import driver_at
from ..motion import Motion
from ..moving import move
from ..sensitivity import quantities
from ..tolerance_analysis import SampledDeviations, ToleranceAnalysis, tolerances

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
        "tolerance of every length: from its value minus to its value plus this",
        "mm",
        default=0.1,
        at_least=0,
        at_most=FARTHEST,
    )
    lengths: dict[str, Annotated[float, between(0, FARTHEST, "mm")]] = entry(
        "tolerances of single lengths in place of that, such as crank = 0.05", default_factory=dict, units=("mm",)
    )
    clearance: float | None = quantity(
        "by how much the holes are wider than their pins; by default the clearance of the stock",
        "mm",
        default=None,
        at_least=0,
        at_most=FARTHEST,
    )
    limit: float | None = quantity(
        "largest deviation of the output that passes, in the unit of its column; by default there is no limit",
        default=None,
        above=0,
        at_most=FARTHEST,
        example=2,
    )
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
            raise DesignError(f"tolerances.{error.field}", error.problem, error.remedy, error.id) from None


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
class OutputDeviation:
    """The deviation of a recipe's output, in the unit of its column.

    Parameters
    ----------
    given : TolerancesTable
        The table of the recipe.
    analysis : ToleranceAnalysis
        Its analysis.
    """

    given: TolerancesTable
    analysis: ToleranceAnalysis

    @cached_property
    def unit(self) -> str:
        """Unit of the output's column."""
        output = quantities(self.analysis.motion.linkage)[self.given.of]
        return UNITS[output.kind][output.order]

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
    def largest(self) -> tuple[float, float, int]:
        """Largest worst case and root sum square, and the frame of the former; nan if none is known."""
        if not np.isfinite(self.worst_case).any():
            return np.nan, np.nan, 0
        frame = first_largest(self.worst_case)
        return float(self.worst_case[frame]), float(np.nanmax(self.analysis.root_sum_square)) * self.factor, frame

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
        yield Column(f"{of}_root_sum_square", self.unit, f"deviation of {words} by root sum square", squares)
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
        limits = [] if self.given.limit is None else [Limit(ids[0], self.given.limit, f"at most {self.given.limit:g}")]
        if np.isfinite(self.worst_case).any():
            yield Plot(f"deviation of {words}", ids).with_limits(limits)
            if f"{of}_lower" in table.ids:
                yield Plot(f"{words} within its deviation", (of, f"{of}_lower", f"{of}_upper"))

    @property
    def checks(self) -> tuple[Check, ...]:
        """The largest worst-case deviation, if there is a limit."""
        limit = self.given.limit
        if limit is None:
            return ()
        worst, _, frame = self.largest
        at = driver_at(self.analysis.motion, frame) if np.isfinite(worst) else None
        name = f"worst-case deviation of {self.given.of}"
        column = f"{self.given.of}_worst_case"
        return (Check("deviation", name, worst, "at most", limit, self.unit, self._advice(limit), column, at),)

    def _advice(self, limit: float) -> str:
        if not np.isfinite(self.largest[0]):
            return "give another output"
        try:
            loosest = self.analysis.loosest(limit / self.factor)
        except DesignError:
            return "the clearance alone exceeds it: give a smaller clearance, or other lengths"
        return f"cut all lengths to {loosest:.3g} mm, or give a smaller clearance"

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
        frames = np.unique([*range(0, len(motion.drive), step), self.largest[2]])
        try:
            speed, acceleration = float(motion.timing.speed), float(motion.timing.acceleration)
            some = move(motion.given, motion.drive[frames], motion.solution.spec, speed, acceleration)
            return replace(self.analysis, motion=some).monte_carlo(self.given.linkages)
        except DesignError:
            return None

    @property
    def remark(self) -> str:
        """One sentence on the largest deviation."""
        worst, squares, _ = self.largest
        if not np.isfinite(worst):
            return f"The deviation of {self.given.of} is not known at any position."
        clearance = max(self.analysis.clearances.values(), default=0.0)
        band = f" The band about its path is enlarged {self.enlarged:g} times." if self.enlarged else ""
        return (
            f"If lengths are cut to {self.given.tolerance:g} mm and holes are {clearance:g} mm wider than their pins, "
            f"{self.given.of} deviates by at most {worst:.3g} {self.unit}, and by less than {squares:.3g} {self.unit} "
            f"in 99.7 % of all linkages.{band}"
        )

    @property
    def summary(self) -> Mapping[str, object]:
        """Entries of the summary."""
        worst, squares, frame = self.largest
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
            f"worst_case_at_{driver}": to_digits(driver_at(self.analysis.motion, frame), 6),
            f"root_sum_square_{unit}": to_digits(squares, 6),
            # Smaller ones are rounding.
            f"contributions_{unit}": {
                name: to_digits(value, 6) for name, value in contributions.items() if value > ROUNDING * worst
            },
        }
        if np.isfinite(self.analysis.range_worst_case):
            entries[f"range_worst_case_{unit}"] = to_digits(self.analysis.range_worst_case * self.factor, 6)
            entries[f"range_root_sum_square_{unit}"] = to_digits(self.analysis.range_root_sum_square * self.factor, 6)
        if self.given.limit is not None:
            entries["loosest_tolerance_mm"] = self._loosest(self.given.limit)
        if self.sampled is not None:
            largest = self.sampled.largest() * self.factor
            entries["random"] = {
                "linkages": self.given.linkages,
                f"largest_of_99.73_percent_{unit}": to_digits(np.nanmax(largest), 6),
                "not_assembled": int(self.sampled.not_assembled.max()),
            }
            if self.given.limit is not None:
                share = self.sampled.share_within(self.given.limit / self.factor)
                entries["random"]["within_limit_percent"] = to_digits(100 * share, 6)  # type: ignore[index]
        return {"tolerances": entries}

    def _loosest(self, limit: float) -> Mapping[str, float | None]:
        """By the rule; None if the clearances alone exceed the limit."""
        found: dict[str, float | None] = {}
        for rule in ("worst_case", "root_sum_square"):
            try:
                found[rule] = to_digits(self.analysis.loosest(limit / self.factor, rule), 6)
            except DesignError:
                found[rule] = None
        return found


def _convex(quad: Complex) -> Complex:
    """The four corners, in an order in which their sides do not cross."""
    return quad[np.argsort(np.angle(quad - quad.mean()))]


def _round_number(value: float) -> float:
    """The largest of 1, 2, 5, 10, ... that does not exceed a value; 1 at least."""
    power = 10.0 ** np.floor(np.log10(max(value, 1.0)))
    return float(next(digit for digit in (5, 2, 1) if digit * power <= max(value, 1.0)) * power)
