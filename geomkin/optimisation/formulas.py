"""Objectives and constraints as text: formulas of a recipe's columns and checks."""

from __future__ import annotations

import ast
from collections.abc import Callable
from typing import Any

import numpy as np

from ..core.errors import DesignError, GeomkinError, printable, shown
from ..core.expressions import FUNCTIONS, LONGEST, evaluate
from ..core.records import record
from ..model.check import Check
from ..plane.vec import Complex, Real

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
            raise DesignError(
                self.field, f"{shown(self.text)} has a value at each frame", f"give one of {', '.join(SUMMARIES)} of it"
            )
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
        raise DesignError(
            field, f"found {shown(text)}, which is no formula", COMPARISON if field == "subject_to" else REMEDY
        ) from None


def polyline_distances(points: Complex, path: Complex) -> Real:
    """Distance of each point from a polyline."""
    start, along = path[:-1], np.diff(path)
    from_start = points[:, None] - start
    with np.errstate(invalid="ignore", divide="ignore"):
        share = np.clip(np.nan_to_num((from_start * np.conj(along)).real / np.abs(along) ** 2), 0, 1)
    nearest: Real = np.abs(from_start - share * along).min(axis=1)
    return nearest
