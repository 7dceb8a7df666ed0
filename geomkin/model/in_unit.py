"""Tables, checks and scenes whose lengths are in the unit in which they are shown."""

from __future__ import annotations

from dataclasses import replace

from ..core.units import MM, LengthUnit
from .check import Check, Suggestion
from .scene import Choice, Limit, Plot, Scene
from .table import Column, Table


def column_in(unit: LengthUnit, column: Column) -> Column:
    """The column in this unit."""
    if unit.factor(column.unit) == 1:
        return column
    values, scale = (unit.of(numbers, column.unit) for numbers in (column.values, column.scale))
    return Column(column.id, unit.unit(column.unit), unit.text(column.meaning), values, scale)


def table_in(unit: LengthUnit, table: Table) -> Table:
    """The table in this unit."""
    return table if unit is MM else Table(tuple(column_in(unit, column) for column in table.columns))


def check_in(unit: LengthUnit, check: Check, slides: bool = False) -> Check:
    """The check in this unit; slides: whether the driver slides, so that its position is a length too."""
    if unit is MM:
        return check
    at = check.at if check.at is None or not slides else unit.of(check.at)
    return replace(
        check,
        name=unit.text(check.name),
        value=unit.of(check.value, check.unit),
        limit=unit.of(check.limit, check.unit),
        unit=unit.unit(check.unit),
        advice=unit.text(check.advice),
        at=at,
        suggestions=tuple(suggestion_in(unit, suggestion) for suggestion in check.suggestions),
    )


def suggestion_in(unit: LengthUnit, suggestion: Suggestion) -> Suggestion:
    """The suggestion in this unit."""
    values = {
        key: value if isinstance(value, str) else unit.in_digits(value, suggestion.unit)
        for key, value in suggestion.values.items()
    }
    return Suggestion(values, unit.unit(suggestion.unit))


def scene_in(unit: LengthUnit, scene: Scene) -> Scene:
    """The scene with its table, plots and texts in this unit; positions stay in mm."""
    if unit is MM:
        return scene
    choice = scene.choice
    return replace(
        scene,
        table=table_in(unit, scene.table),
        plots=_plots(unit, scene.plots, scene.table),
        curves=tuple(replace(curve, label=unit.text(curve.label)) for curve in scene.curves),
        marks=tuple(replace(mark, label=unit.text(mark.label)) for mark in scene.marks),
        others={label: scene_in(unit, other) for label, other in scene.others.items()},
        choice=choice and _choice(unit, choice),
    )


def _choice(unit: LengthUnit, choice: Choice) -> Choice:
    return replace(choice, table=table_in(unit, choice.table), plots=_plots(unit, choice.plots, choice.table))


def _plots(unit: LengthUnit, plots: tuple[Plot, ...], table: Table) -> tuple[Plot, ...]:
    def in_unit(limit: Limit) -> Limit:
        return replace(limit, value=unit.of(limit.value, table.column(limit.column).unit), label=unit.text(limit.label))

    return tuple(replace(plot, title=unit.text(plot.title), limits=tuple(map(in_unit, plot.limits))) for plot in plots)
