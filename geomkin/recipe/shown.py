"""The results of a recipe in its own unit of length, as files, pages and editors show them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import cached_property
from typing import Any

from ..core.errors import shown
from ..core.field_visitor import key_parts
from ..core.units import MM, START, UNITS, LengthUnit, bare_mm, converted_power, marked
from ..model.check import Check, Suggestion, WorkedFormula
from ..model.part import Bought, Part
from ..model.scene import Choice, Limit, Plot, Scene
from ..model.table import Table, table_in
from ..plane.vec import Real
from .keys import varied
from .load import whole_table
from .recipe import AbstractRecipe
from .search import did_you_mean


class ShownRecipe:
    """A recipe whose table, checks, scene and texts are in its own unit of length.

    Parts, walls and positions of the scene stay in mm; writers convert them.

    Parameters
    ----------
    recipe : AbstractRecipe
        The recipe.
    """

    def __init__(self, recipe: AbstractRecipe):
        self.recipe, self.unit = recipe, UNITS[recipe.units]

    @property
    def parts(self) -> tuple[Part, ...]:
        """The parts, in mm."""
        return self.recipe.parts

    @property
    def walls(self) -> Mapping[str, float]:
        """The thinnest wall of each part, mm."""
        return self.recipe.walls

    @cached_property
    def table(self) -> Table:
        """The table."""
        return table_in(self.unit, self.recipe.table)

    @cached_property
    def scene(self) -> Scene | None:
        """The scene, whose positions are in mm."""
        scene = self.recipe.scene
        return scene and scene_in(self.unit, scene)

    @cached_property
    def checks(self) -> tuple[Check, ...]:
        """All checks."""
        return self._shown(self.recipe.checks)

    @cached_property
    def motion_checks(self) -> tuple[Check, ...]:
        """Checks that an editor shows during a drag."""
        return self._shown(self.recipe.motion_checks)

    def _shown(self, checks: tuple[Check, ...]) -> tuple[Check, ...]:
        has_positions = self.unit is not MM and any(check.at is not None for check in checks)
        slides = has_positions and self.recipe.table.columns[0].unit == "mm"
        return tuple(check_in(self.unit, before_scaling(self.recipe, check), slides) for check in checks)

    @property
    def notes(self) -> Mapping[str, object]:
        """Further results."""
        notes: Mapping[str, object] = self.unit.entries(self.recipe.notes)
        return notes

    @property
    def bought(self) -> tuple[Bought, ...]:
        """Items to buy."""
        if self.unit is MM:
            return self.recipe.bought
        return tuple(replace(item, name=self.unit.text(item.name, keeps_mm=True)) for item in self.recipe.bought)

    @property
    def steps(self) -> tuple[str, ...]:
        """Assembly steps."""
        return tuple(self.unit.text(step, keeps_mm=True) for step in self.recipe.steps)

    @property
    def formulas(self) -> tuple[WorkedFormula, ...]:
        """Formulas with their numbers put in."""
        return self.recipe.formulas

    @property
    def quantities(self) -> Mapping[str, str]:
        """Lengths and other results that an editor shows, by label."""
        return {label: self.unit.text(text) for label, text in self.recipe.quantities.items()}

    @property
    def assumed_fits(self) -> Mapping[str, float]:
        """Kerf and fits that nobody stated."""
        return {key: self.unit.of(value) for key, value in self.recipe.assumed_fits.items()}

    @property
    def further_values(self) -> Mapping[str, Real]:
        """Coordinates that formulas may use besides the columns of the table."""
        return {id: self.unit.of(values) for id, values in self.recipe.further_values.items()}

    @property
    def introduction(self) -> str:
        """The sentences at the head of the page: the subtitle, remarks, and why there are no forces."""
        recipe = self.recipe
        return " ".join(self.texts(filter(None, (recipe.subtitle, *recipe.remarks, recipe.forces_missing))))

    @property
    def remarks(self) -> tuple[str, ...]:
        """Sentences on the result, and on entries of `expected_failures` that are the id of no check."""
        ids = [check.id for check in self.recipe.checks]
        unknown = (
            f"expected_failures.{id}: no check has this id; {did_you_mean(id, ids)}the checks are {', '.join(ids)}"
            for id in self.recipe.expected_failures
            if id not in ids
        )
        return self.texts((*self.recipe.remarks, *unknown))

    def texts(self, lines: Iterable[str]) -> tuple[str, ...]:
        """Lines of text."""
        return tuple(map(self.unit.text, lines))


def before_scaling(recipe: AbstractRecipe, check: Check) -> Check:
    """The check, in mm, with suggestions for the recipe as written: its key `scale` will multiply them again."""
    scale = (recipe.loaded_table or {}).get("scale", 1.0)
    if scale == 1 or check.passed or not (check.suggestions or START in check.advice):
        return check
    suggestions, texts, in_mm = [], [], replace(recipe, units="mm")
    for suggestion in check.suggestions:
        written = whole_table(varied(in_mm)[0].opened(suggestion.values).at_scale(1 / scale))
        values: dict[str, Any] = {}
        for key in suggestion.values:
            place: Any = written
            for part in key_parts(key):
                place = place[part]
            values[key] = place
        suggestions.append(replace(suggestion, values=values))
        power = converted_power(suggestion.unit)
        texts.append(", ".join(f"{key} = {_value(value, power)}" for key, value in values.items()))
    words = f"; in the recipe write {' or '.join(texts)}" if texts else ""
    advice = f"{marked(check.advice)} (sizes after scale = {scale:g}{words})"
    return replace(check, suggestions=tuple(suggestions), advice=advice)


def _value(value: float | str, power: int) -> str:
    return shown(value) if isinstance(value, str) else f"{bare_mm(float(value), power=power):.15g}"


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
