"""Lengths in the table of a recipe, found by the declarations of its fields, and converted to another unit."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, get_args, get_origin

from ..core.dotted_keys import Number, key_parts, numbers_in
from ..core.errors import Problem
from ..core.units import MM, UNITS, LengthUnit
from .messages import field_of, hints_of, kind_of, options_of, tables_in
from .recipe import AbstractRecipe

# A number in its unit to a number in another unit.
Convert = Callable[[float, str], float]
# Larger numbers are refused anyway, and may overflow.
LARGEST = 1e300


def in_mm(table: Mapping[str, Any], kind: type, unit: LengthUnit) -> dict[str, Any]:
    """The table of a recipe in this unit with all lengths in mm; recipes in it get the unit, unless they state one."""
    return _table(table, kind, unit.in_mm, lambda inner: {"units": unit.name, **inner})


def from_mm(table: Mapping[str, Any], kind: type, unit: LengthUnit) -> dict[str, Any]:
    """The reverse; recipes in the table are already in this unit, which they need not state."""

    def inner_recipe(inner: Mapping[str, Any]) -> dict[str, Any]:
        return {key: value for key, value in inner.items() if key != "units"}

    return _table(table, kind, unit.in_digits, inner_recipe)


def shown_numbers(recipe: AbstractRecipe) -> Iterator[Number]:
    """All numbers of a recipe in its unit of length."""
    unit = UNITS[recipe.units]
    for number in numbers_in(recipe):
        names = [part for part in key_parts(number.field) if isinstance(part, str)]
        is_kept = unit is MM or names_mm(names[-1])
        yield number if is_kept else number._replace(value=unit.in_digits(number.value, number.unit))


def shown_problem(problem: Problem, recipe: type, unit: LengthUnit) -> Problem:
    """A problem of a recipe with its lengths in the recipe's unit."""
    field = field_of(problem.key, recipe)
    return unit.problem(problem, field is not None and is_length(field, hints_of(recipe).get(field.name)))


def is_length(field: dataclasses.Field[Any], hint: Any = None) -> bool:
    """Whether a field holds lengths in the recipe's unit."""
    units = _units(field)
    return any("mm" in unit for unit in units) if units else "[x, y]" in field.metadata.get("description", "")


def names_mm(key: str) -> bool:
    """Whether a key names mm as the unit of its value."""
    return "mm" in key.split("_")


def _units(field: dataclasses.Field[Any]) -> Sequence[str]:
    """Units of the numbers of a field; a key that names its unit, such as `position_mm`, keeps it."""
    if names_mm(field.name):
        return ("",)
    about = field.metadata
    return about.get("units") or ([about["unit"]] if "unit" in about else ())


def _table(
    table: Mapping[str, Any], kind: type, convert: Convert, inner: Callable[[Mapping[str, Any]], Any]
) -> dict[str, Any]:
    hints, known = hints_of(kind), {field.name: field for field in dataclasses.fields(kind)}

    def converted(key: str, value: Any) -> Any:
        if key not in known:
            return value
        units = _units(known[key])
        return _numbers(value, units, convert) if units else _value(value, hints[key], convert, inner)

    return {key: converted(key, value) for key, value in table.items()}


def _numbers(value: Any, units: Sequence[str], convert: Convert) -> Any:
    """A number, a row of numbers with a unit each, or several rows."""
    if isinstance(value, Mapping):
        return {name: _numbers(item, units, convert) for name, item in value.items()}
    if isinstance(value, list):
        is_row = not any(isinstance(item, list) for item in value)
        return [_numbers(item, [units[k % len(units)]] if is_row else units, convert) for k, item in enumerate(value)]
    is_number = isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < LARGEST
    return convert(value, units[0]) if is_number else value


def _value(value: Any, hint: Any, convert: Convert, inner: Callable[[Mapping[str, Any]], Any]) -> Any:
    """A value without a unit of its own: points, tables, and lists and mappings of these."""
    options = list(options_of(hint))
    if isinstance(value, Mapping):
        if any(isinstance(option, type) and issubclass(option, AbstractRecipe) for option in options):
            return inner(value)
        if named := [get_args(option)[1] for option in options if get_origin(option) is dict]:
            return {name: _value(item, named[0], convert, inner) for name, item in value.items()}
        kinds = {kind_of(table): table for table in tables_in(hint)}
        if not kinds:
            return value
        return _table(value, kinds.get(value.get("kind")) or next(iter(kinds.values())), convert, inner)
    if isinstance(value, list):
        if complex in options and not any(isinstance(item, list) for item in value):
            return _numbers(value, ("mm",), convert)
        if value and all(isinstance(item, Mapping) for item in value):
            # Also a table that is written as a list, such as a motion program.
            return [_value(item, hint, convert, inner) for item in value]
        inside = next((get_args(option) for option in options if get_origin(option) is tuple), ())
        hints = [inside[0]] * len(value) if inside[1:] == (...,) else inside
        if len(hints) == len(value):
            return [_value(item, one, convert, inner) for item, one in zip(value, hints)]
    return value
