"""Recipes of linkages whose output follows a function of their input."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any, Literal

import numpy as np

from ...core.errors import DesignError
from ...core.expressions import Expression
from ...core.fields import FARTHEST, SMALLEST, Ratio, Rows, entry, quantity
from ...core.records import record
from ...linkage.parts.stock import LinkStock
from ...model.check import Check
from ...model.scene import Limit, Plot, SceneHandle, point_handle
from ...model.table import Column, Table
from ...plane.vec import Real
from ...recipe.settings import Drive, Files
from ..function.function import function_generator, slider_function_generator
from ..function.results import AbstractFunctionGenerator, FunctionGenerator, SliderFunctionGenerator
from ..function.wanted import NAMED, Function, named_function
from .linkage_goals import AbstractLinkageGoal, choose_entry

Method = Literal["minimax", "least-squares", "points"]


def _start_deg(meaning: str) -> Any:
    return quantity(f"{meaning}; found if left out", "deg", default=None, at_least=-360, at_most=360)


@record(checked=True, kw_only=True)
class RequiredFunction:
    """The function, its range, and the method of approximation."""

    function: str = entry(
        "y as a text in x, such as log10(x), angles in rad; or a named function with coefficients; or table, with rows",
        example="log10(x)",
    )
    coefficients: tuple[float, ...] = entry(
        f"coefficients of a named function: {', '.join(f'{name}: {row[0]}' for name, row in NAMED.items())}", default=()
    )
    rows: Rows = entry("rows [x, y] of rising x, joined by a cubic spline; with function = table", default=())
    x_start: float = quantity("start of the range of x", at_least=-FARTHEST, at_most=FARTHEST, example=1)
    x_end: float = quantity("end of the range of x", at_least=-FARTHEST, at_most=FARTHEST, example=2)
    input_deg: float = quantity(
        "rotation of the crank from x_start to x_end, counterclockwise", "deg", default=60.0, at_least=-359, at_most=359
    )
    input_start_deg: float | None = _start_deg("crank's angle from the ground line at x_start")
    least_transmission_angle_deg: float = quantity(
        "least transmission angle over the range", "deg", default=40.0, at_least=5, at_most=85
    )
    largest_ratio: Ratio = quantity("longest link over the shortest", default=10.0, at_least=1.1, at_most=100)
    method: Method = entry(
        "minimax: least largest error; least-squares: least mean square error; points: no error at precision points",
        default="minimax",
    )
    points: int = quantity(
        "number of precision points in Chebyshev's spacing", default=3, at_least=3, at_most=5, whole=True
    )
    points_at: tuple[float, ...] = entry("x of three to five precision points, instead of points", default=())

    def __post_init__(self) -> None:
        if not self.x_start < self.x_end:
            raise DesignError(
                "x_end", f"found {self.x_end:g}", f"give more than {self.x_start:g}, the start", "out-of-range"
            )
        if bool(self.rows) != (self.function == "table"):
            given = "is given" if self.rows else "is missing"
            raise DesignError(
                "rows", f"{given}, with function = {self.function!r}", "give rows with function = 'table'", "conflict"
            )
        if self.coefficients and self.function not in NAMED:
            problem = f"is given, with function = {self.function!r}"
            raise DesignError("coefficients", problem, f"give them with {', '.join(NAMED)}", "conflict")
        if (self.points != 3 or self.points_at) and self.method != "points":
            raise DesignError(
                "method", f"found {self.method}, with precision points", "give points, or leave those out", "conflict"
            )
        if self.points_at and not 3 <= len(self.points_at) <= 5:
            raise DesignError("points_at", f"found {len(self.points_at)}", "give three to five", "out-of-range")
        # A wrong function is refused when the recipe is read.
        _ = self.read

    @cached_property
    def read(self) -> Function:
        """The function as the library takes it."""
        if self.function in NAMED:
            return named_function(self.function, self.coefficients)
        return self.rows if self.function == "table" else Expression(self.function)

    @property
    def given(self) -> Mapping[str, Any]:
        """Arguments common to both searches."""
        return {
            "function": self.read,
            "span": (self.x_start, self.x_end),
            "input_deg": self.input_deg,
            "input_start_deg": self.input_start_deg,
            "least_transmission_angle_deg": self.least_transmission_angle_deg,
            "largest_ratio": self.largest_ratio,
            "method": self.method,
            "points": self.points_at or self.points,
        }


@record(kw_only=True)
class RequiredAngle(RequiredFunction):
    """A function with a rocker's angle as the output."""

    output_deg: float = quantity(
        "rotation of the rocker from y(x_start) to y(x_end), counterclockwise", "deg", default=90.0, at_least=-359,
        at_most=359,
    )  # fmt: skip
    output_start_deg: float | None = _start_deg("rocker's angle from the ground line at x_start")
    ground: float = quantity(
        "distance between the two ground pivots", "mm", default=100.0, at_least=SMALLEST, at_most=FARTHEST
    )
    largest_error_deg: float | None = quantity(
        "largest error of the output that passes the check; a hundredth of its range if left out", "deg",
        default=None, above=0, at_most=360,
    )  # fmt: skip


@record(kw_only=True)
class RequiredSliderPosition(RequiredFunction):
    """A function with a slider's position as the output."""

    output_mm: float = quantity(
        "travel of the slider from y(x_start) to y(x_end), along +x", "mm", default=50.0, at_least=-FARTHEST,
        at_most=FARTHEST,
    )  # fmt: skip
    output_start_mm: float | None = quantity(
        "slider's x at x_start, from the crank pivot; found if left out", "mm", default=None, at_least=-FARTHEST,
        at_most=FARTHEST,
    )  # fmt: skip
    largest_error_mm: float | None = quantity(
        "largest error of the output that passes the check; a hundredth of its range if left out", "mm", default=None,
        above=0, at_most=FARTHEST,
    )  # fmt: skip


@record(kw_only=True)
class AbstractFunctionRecipe(AbstractLinkageGoal[AbstractFunctionGenerator]):
    """Common base of the recipes of function generators."""

    kind: str
    wanted: RequiredFunction
    choose: int = choose_entry()
    drive: Drive = entry("how the crank turns", default=Drive())
    stock: LinkStock = entry("what the links are cut from", default=LinkStock())
    files: Files = entry("what is written", default=Files())

    def __post_init__(self) -> None:
        super().__post_init__()
        # Checked before any search.
        self.drive.check_rows(abs(self.wanted.input_deg) / 360)

    @property
    @abstractmethod
    def best(self) -> AbstractFunctionGenerator:
        """The best result of the search."""

    @property
    @abstractmethod
    def reached(self) -> Real:
        """Output over the frames: deg, in the same turn as the wanted output, or mm."""

    @property
    @abstractmethod
    def most_error(self) -> float:
        """Largest error that passes the check, deg or mm."""

    @property
    @abstractmethod
    def unit(self) -> str:
        """Unit of the output."""

    @property
    def ranked(self) -> Sequence[AbstractFunctionGenerator]:
        return (self.best, *self.best.others)

    @cached_property
    def x(self) -> Real:
        """x over the frames."""
        first, last = self.found.drive
        share = np.clip((self.design.input_range.frames - first) / (last - first), 0, 1)
        return np.asarray(self.wanted.x_start + (self.wanted.x_end - self.wanted.x_start) * share)

    @cached_property
    def table(self) -> Table:
        wanted = self.found.wanted_at(self.x)
        return Table(
            (
                *self.design.table.columns,
                Column("x", "", "the function's x", self.x),
                Column("wanted", self.unit, "wanted output", wanted),
                Column("reached", self.unit, "actual output, in the same turn as the wanted one", self.reached),
                Column("error", self.unit, "actual minus wanted output", self.reached - wanted, float(np.ptp(wanted))),
            )
        )

    @property
    def plotted(self) -> Sequence[Plot]:
        limits = tuple(Limit("error", side * self.most_error, "largest error allowed") for side in (1, -1))
        return (Plot("error of the output", ("error",), limits), Plot("output", ("wanted", "reached")))

    @property
    def size_bounds(self) -> Mapping[str, tuple[float, float]]:
        names = ("ground", "input_start_deg", "output_start_deg", "output_start_mm")
        given = {name: getattr(self.wanted, name, None) for name in names}
        return {name: (size, size) for name, size in given.items() if size is not None}

    @property
    def search_limits(self) -> tuple[float, float]:
        return self.wanted.least_transmission_angle_deg, self.wanted.largest_ratio

    def met_by(self, found: AbstractFunctionGenerator) -> tuple[Check, ...]:
        advice = "give other swings, a shorter range, or leave the starts free"
        peak, wanted = max(found.alternation, key=lambda peak: abs(peak.error)), self.wanted
        share = (peak.x - wanted.x_start) / (wanted.x_end - wanted.x_start)
        at = float(np.degrees(found.drive[0] + share * (found.drive[1] - found.drive[0])))
        name, most = "largest error of the output", self.most_error
        return (Check("output_error", name, found.largest, "at most", most, self.unit, advice, "error", at),)

    @property
    def notes(self) -> Mapping[str, object]:
        return {**super().notes, **self.found.proof()}


@record(kw_only=True)
class FunctionGeneratorRecipe(AbstractFunctionRecipe):
    """A four-bar whose rocker follows a function of its crank's angle, with its plates and its error."""

    kind: Literal["function-generator"] = "function-generator"
    wanted: RequiredAngle
    unit = "deg"

    @property
    def handles(self) -> tuple[SceneHandle, ...]:
        """The second pivot."""
        return (point_handle("wanted.ground", at=self.wanted.ground),)

    @cached_property
    def best(self) -> FunctionGenerator:
        wanted = self.wanted
        return function_generator(
            **wanted.given, output_deg=wanted.output_deg, output_start_deg=wanted.output_start_deg, ground=wanted.ground
        )

    @cached_property
    def reached(self) -> Real:
        angle = np.degrees(np.angle(self.design.motion.bodies["rocker"].direction))
        wanted = self.found.wanted_at(self.x)
        return np.asarray(angle + 360 * np.round((wanted - angle) / 360))

    @property
    def most_error(self) -> float:
        return self.wanted.largest_error_deg or MOST_ERROR_OF_FUNCTION * abs(self.wanted.output_deg)


@record(kw_only=True)
class SliderFunctionGeneratorRecipe(AbstractFunctionRecipe):
    """A slider-crank whose slider follows a function of its crank's angle, with its plates and its error."""

    kind: Literal["slider-function-generator"] = "slider-function-generator"
    wanted: RequiredSliderPosition
    unit = "mm"

    @cached_property
    def best(self) -> SliderFunctionGenerator:
        wanted = self.wanted
        return slider_function_generator(
            **wanted.given, output_mm=wanted.output_mm, output_start_mm=wanted.output_start_mm
        )

    @cached_property
    def reached(self) -> Real:
        return np.real(self.design.motion.bodies["slider"].origin.position)

    @property
    def most_error(self) -> float:
        return self.wanted.largest_error_mm or MOST_ERROR_OF_FUNCTION * abs(self.wanted.output_mm)


# Largest error as a share of the output range; a larger one is visible on any scale. Derived here.
MOST_ERROR_OF_FUNCTION = 0.01
