"""Lengths in the table of a recipe, found by the declarations of its fields, and converted to another unit."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ..core.dotted_keys import numbers_in
from ..core.errors import Problem
from ..core.field_visitor import Number, names_mm, with_numbers
from ..core.units import MM, UNITS, LengthUnit
from .messages import field_of
from .recipe import AbstractRecipe

# Larger numbers are refused anyway, and may overflow.
LARGEST = 1e300


def in_mm(table: Mapping[str, Any], kind: type, unit: LengthUnit) -> dict[str, Any]:
    """The table of a recipe in this unit with all lengths in mm; recipes in it get the unit, unless they state one."""
    return _converted(table, kind, unit.in_mm, lambda inner: {"units": unit.name, **inner})


def from_mm(table: Mapping[str, Any], kind: type, unit: LengthUnit) -> dict[str, Any]:
    """The reverse; recipes in the table are already in this unit, which they need not state."""

    def inner_recipe(inner: Mapping[str, Any]) -> dict[str, Any]:
        return {key: value for key, value in inner.items() if key != "units"}

    return _converted(table, kind, unit.in_digits, inner_recipe)


def _converted(
    table: Mapping[str, Any], kind: type, convert: Callable[[float, str], float], inner: Callable[[Any], Any]
) -> dict[str, Any]:
    def change(number: Number) -> Any:
        value = float(number.value) if isinstance(number.value, np.number) else number.value
        if isinstance(value, np.ndarray):
            return value  # Refused when the table is read.
        is_kept = names_mm(number.declared.name) or not abs(value) < LARGEST
        return value if is_kept else convert(value, number.unit)

    return dict(with_numbers(table, change, lambda recipe, key: inner(recipe), kind))


def shown_numbers(recipe: AbstractRecipe) -> Iterator[Number]:
    """All numbers of a recipe in its unit of length."""
    unit = UNITS[recipe.units]
    for number in numbers_in(recipe):
        is_kept = unit is MM or names_mm(number.declared.name)
        yield number if is_kept else number._replace(value=unit.in_digits(number.value, number.unit))


def shown_problem(problem: Problem, recipe: type, unit: LengthUnit) -> Problem:
    """A problem of a recipe with its lengths in the recipe's unit."""
    declared = field_of(problem.key, recipe)
    value = problem.value
    if value is not None and declared is not None and declared.is_length:
        value = unit.in_digits(value, "mm")
    return replace(problem, problem=unit.text(problem.problem), remedy=unit.text(problem.remedy), value=value)
