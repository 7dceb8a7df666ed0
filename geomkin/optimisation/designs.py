"""Designs that a search tries: a recipe with values for its keys, and the formulas of its objective and constraints."""

from __future__ import annotations

import ast
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import field
from typing import Any

import numpy as np

from ..build import errors_named_by_key
from ..core.errors import DesignError, GeomkinError, printable, shown
from ..core.expressions import FUNCTIONS, LONGEST, evaluate
from ..core.fields import to_digits
from ..core.processes import progress_to
from ..core.records import record
from ..model.check import Check
from ..plane.vec import Complex, Real
from ..recipe.keys import VariedRecipe
from ..recipe.recipe import AbstractRecipe
from ..recipe.search import did_you_mean
from ..recipe.shown import ShownRecipe

# Functions that make one number of a column.
SUMMARIES: dict[str, Callable[[Real], Any]] = {
    "min": np.min, "max": np.max, "mean": np.mean, "range": np.ptp, "rms": lambda values: np.sqrt(np.mean(values**2)),
}  # fmt: skip
CALLS = {name: lambda x, f=f: f(np.asarray(x, dtype=float)) for name, f in SUMMARIES.items()} | FUNCTIONS
REMEDY = (
    f"give columns and checks, numbers, + - * / **, brackets, {', '.join(SUMMARIES)}, {', '.join(FUNCTIONS)}, "
    "or distance(POINT, [[x, y], ...])"
)
COMPARISON = "give two formulas with >= or <= between them, such as min(transmission_angle) >= 40"
# Values of a column or check by its id.
Lookup = Callable[[str], Any]


@record
class Formula:
    """A number that depends on a recipe's results, such as `max(rocker_error_deg)`.

    Parameters
    ----------
    field : str
        The argument that holds it; errors name it.
    text : str
        For messages.
    node : ast.expr
        Its syntax tree.
    """

    field: str
    text: str
    node: ast.expr

    def value(self, lookup: Lookup) -> float:
        """The number; nan if it is not defined."""
        values = self._values(self.node, lookup)
        if np.ndim(values):
            problem = f"{shown(self.text)} has a value at each frame"
            raise DesignError(self.field, problem, f"give one of {', '.join(SUMMARIES)} of it")
        return float(values)

    def rows(self, lookup: Lookup, summary: str) -> Real:
        """The values of which the formula is the `summary`, "max" or "min"; otherwise its own value alone.

        The largest of many values has kinks, at which gradients fail; the values themselves are smooth.
        """
        sign, node = 1.0, self.node
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
            sign, node, summary = -1.0, node.operand, "min" if summary == "max" else "max"
        match node:
            case ast.Call(func=ast.Name(id=name), args=[inner], keywords=[]) if name == summary:
                return sign * np.atleast_1d(np.asarray(self._values(inner, lookup), dtype=float))
        return np.array([self.value(lookup)])

    def _values(self, node: ast.expr, lookup: Lookup) -> Any:
        def distance(inner: ast.expr) -> Any:
            match inner:
                case ast.Call(func=ast.Name(id="distance"), args=[ast.Name(id=name), points], keywords=[]):
                    path = np.asarray(lookup(f"{name}_x")) + 1j * np.asarray(lookup(f"{name}_y"))
                    return polyline_distances(self._points(points), path)
            return None

        try:
            with np.errstate(all="ignore"):
                return evaluate(node, lookup, self._wrong, CALLS, distance)
        except ValueError as error:
            # Columns and rows of points of different lengths, or the smallest of none.
            if isinstance(error, GeomkinError):
                raise
            raise self._wrong(node, f"found {printable(error, 100)}") from None

    def _points(self, node: ast.expr) -> Complex:
        try:
            points = np.array(ast.literal_eval(node), dtype=float)
        except (ValueError, TypeError, SyntaxError, MemoryError, RecursionError):
            points = np.empty(0)
        if points.ndim != 2 or points.shape[1] != 2 or not np.isfinite(points).all():
            raise self._wrong(node, "found no list of points")
        places: Complex = points[:, 0] + 1j * points[:, 1]
        return places

    def _wrong(self, node: ast.expr, problem: str = "", remedy: str = "") -> DesignError:
        problem = problem or f"found {shown(ast.get_source_segment(self.text, node) or self.text)}"
        return DesignError(
            self.field, f"{problem} at character {node.col_offset + 1} of {shown(self.text)}", remedy or REMEDY
        )


@record
class Condition:
    """A constraint: the formula `least` is at most the formula `most`; `is_at_least` if the text has them reversed."""

    text: str
    least: Formula
    most: Formula
    is_at_least: bool

    def excess(self, lookup: Lookup) -> Real:
        """Rows that are at most 0 where the condition holds."""
        left, right = self.least.rows(lookup, "max"), self.most.rows(lookup, "min")
        excess: Real = left.max() - right if len(right) > 1 else left - right[0]
        return excess

    def check(self, id: str, least: float, most: float) -> Check:
        """The constraint as a check, for the values of its two sides."""
        if self.is_at_least:
            return Check(id, self.text, most, "at least", least)
        return Check(id, self.text, least, "at most", most)

    def sides(self, lookup: Lookup) -> tuple[float, float]:
        """The values of `least` and `most`."""
        return self.least.value(lookup), self.most.value(lookup)


def objective(text: str) -> Formula:
    """The formula of an objective."""
    return Formula("minimise", text.strip(), _parsed("minimise", text))


def parsed_constraint(text: str) -> Condition:
    """The constraint that a text such as `min(transmission_angle) >= 40` states."""
    match _parsed("subject_to", text):
        case ast.Compare(left=left, ops=[ast.LtE() | ast.GtE() as sign], comparators=[right]):
            sides = [Formula("subject_to", text.strip(), node) for node in (left, right)]
            is_at_least = isinstance(sign, ast.GtE)
            return Condition(text.strip(), sides[is_at_least], sides[not is_at_least], is_at_least)
    raise DesignError("subject_to", f"found {shown(text)}", COMPARISON)


def _parsed(field: str, text: str) -> ast.expr:
    if len(text) > LONGEST * 20:
        raise DesignError(field, f"found {len(text):,} characters", f"give at most {LONGEST * 20:,}", "too-much-work")
    try:
        return ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        problem = f"found {shown(text)}, which is no formula"
        raise DesignError(field, problem, COMPARISON if field == "subject_to" else REMEDY) from None


def polyline_distances(points: Complex, path: Complex) -> Real:
    """Distance of each point from a polyline."""
    start, along = path[:-1], np.diff(path)
    from_start = points[:, None] - start
    with np.errstate(invalid="ignore", divide="ignore"):
        share = np.clip(np.nan_to_num((from_start * np.conj(along)).real / np.abs(along) ** 2), 0, 1)
    nearest: Real = np.abs(from_start - share * along).min(axis=1)
    return nearest


# Violation of a constraint that counts as none, as a share of its terms.
NO_VIOLATION = 1e-8
# Ends of ids of columns that a recipe with a table [tolerances] has.
OF_TOLERANCES = ("_worst_case", "_root_sum_square", "_across_path", "_lower", "_upper")


@record(eq=False)
class TriedDesign:
    """One design.

    Parameters
    ----------
    values : mapping of str to float
        By key.
    objective_rows : tuple of array
        For each objective the values of which it is the largest.
    excess_rows : tuple of array
        By how much each constraint is violated, as a share of its terms: the largest of them, 0 or less if it is met.
    """

    values: Mapping[str, float]
    objective_rows: tuple[Real, ...]
    excess_rows: tuple[Real, ...]

    @property
    def objectives(self) -> Real:
        """The value of each objective."""
        return np.array([rows.max() for rows in self.objective_rows])

    @property
    def excesses(self) -> Real:
        """The largest row of each constraint."""
        return np.array([rows.max() for rows in self.excess_rows])

    @property
    def violation(self) -> float:
        """The largest violation of a constraint; 0 if all are met."""
        most = float(self.excesses.max(initial=0.0))
        return most if most > NO_VIOLATION else 0.0


@record(eq=False)
class Target:
    """The number that a search minimises: the largest of some objectives, each shifted and scaled.

    Parameters
    ----------
    objectives : tuple of int
        Their numbers.
    shifts, scales : array
        Of each of them; its unit is the unit of the objective.
    """

    objectives: tuple[int, ...] = (0,)
    shifts: Real = field(default_factory=lambda: np.zeros(1))
    scales: Real = field(default_factory=lambda: np.ones(1))

    def rows(self, design: TriedDesign) -> Real:
        """The values of a design of which the largest is minimised."""
        return np.concatenate(
            [
                (design.objective_rows[k] - shift) / scale
                for k, shift, scale in zip(self.objectives, self.shifts, self.scales)
            ]
        )

    def rank(self, design: TriedDesign) -> tuple[float, ...]:
        """For sorting: designs that meet all constraints come first, and of nearly equal ones those that are exact."""
        value, most = float(self.rows(design).max()), float(design.excesses.max(initial=0.0))
        return design.violation, to_digits(value, 6), most, value


class Trials:
    """All designs that a search, or one of its jobs, has tried.

    Parameters
    ----------
    recipe : VariedRecipe
        The recipe that is varied.
    objectives : sequence of Formula
        The numbers to minimise.
    conditions : sequence of Condition
        The constraints.
    end : float
        Time at which the search ends, s since 1970, so that it is the same on all machines.
    scales : sequence of float, optional
        Size of the terms of each constraint; by default those of the first design that works.
    """

    def __init__(
        self,
        recipe: VariedRecipe,
        objectives: Sequence[Formula],
        conditions: Sequence[Condition],
        end: float,
        scales: Sequence[float] | None = None,
    ):
        self.recipe, self.objectives, self.conditions, self.end = recipe, objectives, conditions, end
        self.scales = scales
        self.designs: list[TriedDesign] = []
        self.count = 0
        self.refusal = ""
        self.is_cut = self.is_interrupted = False

    def without_designs(self) -> Trials:
        """The same search before its first design."""
        return Trials(self.recipe, self.objectives, self.conditions, self.end, self.scales)

    def add(self, other: Trials) -> None:
        """Add the designs of a job."""
        self.designs += other.designs
        self.count += other.count
        self.refusal = self.refusal or other.refusal
        self.scales = other.scales if self.scales is None else self.scales
        self.is_cut = self.is_cut or other.is_cut

    def over(self) -> bool:
        """Whether the time is over; `is_cut` then records that the search was cut short."""
        self.is_cut = self.is_cut or time.time() >= self.end
        return self.is_cut

    def tried(self, values: Mapping[str, float]) -> TriedDesign | None:
        """The design with these values; None if there is none, or a result is undefined for it."""
        self.count += 1
        try:
            # A search reports its own progress, not that of each design.
            with progress_to(lambda *_: None):
                recipe = self.recipe.opened(values)
                with errors_named_by_key(self.recipe.file, recipe):
                    _ = recipe.table
        except GeomkinError as error:
            self.refusal = self.refusal or str(error).split("\n")[0]
            return None
        try:
            objective_rows = tuple(one.rows(_Results("minimise", recipe), "max") for one in self.objectives)
            excess_rows = [one.excess(_Results("subject_to", recipe)) for one in self.conditions]
        except DesignError as error:
            # Some checks are made only if they matter; a wrong id is unknown from the first design.
            if error.id != "unknown-key" or self.scales is None:
                raise
            self.refusal = self.refusal or str(error)
            return None
        if not all(np.isfinite(rows).all() for rows in (*objective_rows, *excess_rows)):
            self.refusal = self.refusal or "a result that the formulas name is undefined at some positions"
            return None
        if self.scales is None:
            self.scales = [max(map(abs, sides)) or 1.0 for sides in self.sides(recipe)]
        scaled = tuple(rows / scale for rows, scale in zip(excess_rows, self.scales))
        design = TriedDesign(dict(values), objective_rows, scaled)
        self.designs.append(design)
        return design

    def sides(self, recipe: AbstractRecipe) -> list[tuple[float, float]]:
        """The values of both sides of each constraint."""
        return [one.sides(_Results("subject_to", recipe)) for one in self.conditions]


class _Results:
    """Values of a recipe's columns and checks by id, for formulas."""

    def __init__(self, field: str, recipe: AbstractRecipe):
        self.field, self.recipe = field, ShownRecipe(recipe)

    def __call__(self, name: str) -> Any:
        columns = [c for c in self.recipe.table.columns if c.values.dtype.kind in "fiub"]
        named = [c for c in columns if c.id == name] or [c for c in columns if c.header == name]
        if named:
            return named[0].values
        further = self.recipe.further_values
        if name in further:
            return further[name]
        checks = {check.id: check.value for check in self.recipe.checks}
        if name in checks:
            return checks[name]
        known = list(dict.fromkeys([*(column.id for column in columns), *further, *checks]))
        lacks_table = name.endswith(OF_TOLERANCES) and getattr(self.recipe.recipe, "tolerances", True) is None
        near = "add a table [tolerances], or " if lacks_table else did_you_mean(name, known)
        remedy = f"{near}give a column or a check: {printable(', '.join(known), 2000)}"
        raise DesignError(self.field, f"found {shown(name)}", remedy, "unknown-key")
