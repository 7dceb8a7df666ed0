"""Loads a recipe from a text or table, or raises an error with all its problems; and writes it as text."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import is_dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from ..core.arguments import checked
from ..core.errors import DesignError, Problem, ProblemId, RecipeError, printable, shown
from ..core.field_visitor import ROWS, Number, WrittenForm, fields_of, names_mm, numbers_in, scaled, with_numbers
from ..core.fields import FARTHEST, quantity
from ..core.names import Folder, read_text_file
from ..core.records import record
from ..core.units import MM, UNITS, LengthUnit, marked, mm
from .kinds import kind_names, recipe_class
from .printing import growth
from .reader import field_of, read_table
from .recipe import FITS, AbstractRecipe, is_stock
from .search import did_you_mean
from .settings import kerf
from .toml import LARGEST, parsed, table_of, toml_key, toml_value, without_none

# Largest number of materials that a message lists.
MOST_LISTED = 20


@record(checked=True)
class MeasuredFits:
    """Kerf or growth, and fits, of one material, mm; None if not measured."""

    kerf: float | None = kerf(None)
    growth: float | None = growth(None)
    clearance: float | None = quantity(
        "how much wider a hole is than its pin or shaft", "mm", default=None, at_least=0, at_most=FARTHEST
    )
    interference: float | None = quantity(
        "interference of a press-fit bore", "mm", default=None, at_least=-1, at_most=FARTHEST
    )


def with_workshop(
    data: Mapping[str, Any], recipe: type[AbstractRecipe], file: str, folder: Folder, unit: LengthUnit = MM
) -> dict[str, Any]:
    """The table of a recipe, with the values of its workshop file for keys that it omits.

    recipe: its class. file: its name in messages. folder: holds the workshop file. unit: of messages. Raises
    RecipeError if the workshop file is wrong or lacks the recipe's material.
    """
    try:
        if not recipe.takes_workshop:
            remedy = "give it in the recipe of each mechanism, and the kerf in [files]"
            raise DesignError("workshop", f"found {shown(data['workshop'])} for all mechanisms", remedy, "conflict")
        name, measured = data["workshop"], _read(data["workshop"], file, folder)
        stocks = _stocks(data, recipe)
        material_of = _materials(data, stocks, printable(name), measured)
        merged = dict(data)
        for key, stock in stocks.items():
            merged[key] = _stated(measured[material_of[key]], FITS & fields_of(stock).keys()) | data.get(key, {})
        if isinstance(printing := data.get("printing"), Mapping):
            merged["printing"] = _stated(measured[material_of[""]], ("clearance", "growth")) | dict(printing)
        files = data.get("files", {})
        if isinstance(files, Mapping) and "kerf" not in files:
            merged["files"] = {**_common_kerf(printable(name), measured, material_of.values()), **files}
        return merged
    except DesignError as error:
        problem = error.as_problem
        raise RecipeError(file, [shown_problem(problem, recipe, unit)]) from None


def _read(name: object, file: str, folder: Folder) -> dict[str, MeasuredFits]:
    """The values in a workshop file, by material."""
    if not isinstance(name, str):
        raise DesignError("workshop", f"found {shown(name)}", 'give a file, as "workshop/laser.toml"', "wrong-type")
    problems: list[Problem] = []
    measured = {}
    try:
        text = read_text_file(name, folder, "a workshop file")
        if len(text) > LARGEST:
            problem = f"{printable(name)} is larger than {LARGEST:,} bytes"
            raise DesignError("file", problem, "give a workshop file, a short TOML file", "too-much-work")
        table = parsed(text)
        units = table.pop("units", "mm")
        if units not in UNITS:
            problem = f"{printable(name)}: units: found {shown(units)}"
            raise DesignError("workshop", problem, 'give "mm" or "in"', "out-of-range")
        for material, values in table.items():
            lengths = in_mm(values, MeasuredFits, UNITS[units]) if isinstance(values, Mapping) else values
            measured[material], wrong = read_table(lengths, MeasuredFits, None)
            found = [shown_problem(p, MeasuredFits, UNITS[units]) for p in wrong]
            problems += [dataclasses.replace(p, key=".".join(filter(None, (material, p.key)))) for p in found]
    except DesignError as error:
        raise error.named("workshop") from None
    except RecipeError as error:
        problems += error.problems
    if problems:
        described = (f"{printable(name)}: {printable(p.key or '(whole file)')}: {marked(p.problem)}" for p in problems)
        raise RecipeError(file, [Problem("workshop", line, p.remedy, p.id) for line, p in zip(described, problems)])
    if not measured:
        remedy = "give a table for each material, such as [birch-plywood], with kerf, clearance and interference"
        raise DesignError("workshop", f"{printable(name)} has no material", remedy, "missing-key")
    return measured


def _stocks(data: Mapping[str, Any], recipe: type) -> dict[str, type]:
    """Classes of the stocks and the base that a recipe has, by key; optional ones only if its table has them."""
    stocks = {key: declared for key, declared in fields_of(recipe).items() if is_stock(key)}
    given = (key for key, declared in stocks.items() if key in data or declared.field.default is not None)
    return {key: stocks[key].tables[0] for key in given if isinstance(data.get(key, {}), Mapping)}


def _materials(
    data: Mapping[str, Any], stocks: Mapping[str, type], name: str, measured: Mapping[str, MeasuredFits]
) -> dict[str, str]:
    """The material of the recipe, "", and of each stock; those that state none have the first that is stated."""
    listed = ", ".join(printable(material) for material in list(measured)[:MOST_LISTED])
    stated = {}
    for key in ("", *stocks):
        table = data.get(key, {}) if key else data
        material = table.get("material")
        material = material.get("name") if isinstance(material, Mapping) else material
        if material is None:
            continue
        if not isinstance(material, str) or material not in measured:
            problem = f"found {shown(material)}, but {name} has values for {listed}"
            remedy = (
                f"{did_you_mean(material, measured)}give one of these, or measure this material and add it to {name}"
            )
            raise DesignError(_key(key), problem, remedy, "conflict")
        stated[key] = material
    if not stated and len(measured) > 1:
        key = next((key for key, stock in stocks.items() if "material" in fields_of(stock)), "")
        problem = f"is missing, and {name} has values for {listed}"
        raise DesignError(_key(key), problem, "give one of these", "missing-key")
    first = next(iter((*stated.values(), *measured)))
    return {"": first, **dict.fromkeys(stocks, first), **stated}


def _key(stock: str) -> str:
    return f"{stock}.material" if stock else "material"


def _stated(fits: MeasuredFits, names: Iterable[str]) -> dict[str, float]:
    values = {name: getattr(fits, name) for name in names}
    return {name: value for name, value in values.items() if value is not None}


def _common_kerf(name: str, measured: Mapping[str, MeasuredFits], materials: Iterable[str]) -> dict[str, float]:
    """The kerf of all materials as an entry of `files`; empty if none is measured."""
    kerfs = {material: width for material in materials if (width := measured[material].kerf) is not None}
    if len(set(kerfs.values())) > 1:
        widths = " and ".join(f"{mm(width):g} for {printable(material)}" for material, width in kerfs.items())
        problem, remedy = f"is missing, and {name} has {widths}", "give the kerf, or make the parts of one material"
        raise DesignError("files.kerf", problem, remedy, "conflict")
    return {"kerf": next(iter(kerfs.values()))} if kerfs else {}


def read(path: Path) -> AbstractRecipe:
    """The recipe in a TOML file, with the name of the file.

    Raises FileError if the file cannot be read, and RecipeError with every problem, key by key.
    """
    return from_table(table_of(path), str(path), str(path.parent)).with_name(path.stem)


def parse(text: str, file: str = "recipe", folder: Folder = ".") -> AbstractRecipe:
    """The recipe in a TOML text. file: its name in messages; folder: holds the files that it names."""
    return from_table(parsed(text, file), file, folder)


def from_table(data: Mapping[str, Any], file: str = "recipe", folder: Folder = ".") -> AbstractRecipe:
    """The recipe in a table as TOML gives it: tables as dicts, points as [x, y]."""
    name = data.get("kind")
    try:
        kind = recipe_class(name if isinstance(name, str) else "")
    except KeyError:
        from .search import nearest_kind

        id: ProblemId = "unknown-kind" if "kind" in data else "missing-key"
        kinds = kind_names()
        found = "is missing" if "kind" not in data else f"found {shown(name)}"
        inner = {table: value.get("kind") for table, value in data.items() if isinstance(value, dict)}
        owner = next((table for table, kind in inner.items() if isinstance(kind, str) and kind in kinds), None)
        near = f"move it from [{printable(owner)}] above the first table; " if owner else nearest_kind(name, kinds)
        if data and all(
            isinstance(table, Mapping) and table.keys() <= {"kerf", "growth", *FITS}
            for key, table in data.items()
            if key != "units"
        ):
            near = "keep a workshop file in a folder below the recipes that name it; of a recipe "
        raise RecipeError(file, [Problem("kind", found, f"{near}give one of {', '.join(kinds)}", id)]) from None
    unit = UNITS.get(str(data.get("units")), MM)
    if unit is not MM:
        # Imported only if needed, as the messages are.

        data = in_mm(data, kind, unit)
    if "workshop" in data:
        data = with_workshop(data, kind, file, folder, unit)
    # `scale` and `workshop` are no fields, since the recipe holds the scaled lengths and the values of the file.
    applied = ("workshop", "scale") if kind.can_be_scaled else ("workshop",)
    fields = {key: value for key, value in data.items() if key not in applied}
    recipe: AbstractRecipe
    recipe, problems = read_table(fields, kind, folder)
    if problems:
        raise RecipeError(file, in_unit(problems, kind, unit))
    try:
        recipe = scaled(recipe, data.get("scale", 1.0)) if kind.can_be_scaled else recipe
    except DesignError as error:
        raise RecipeError(file, in_unit([error.as_problem], kind, unit)) from None
    object.__setattr__(recipe, "loaded_table", data)
    return recipe


def in_unit(problems: list[Problem], kind: type, unit: LengthUnit) -> list[Problem]:
    """The problems with their lengths in the unit of the recipe."""
    if unit is MM:
        return problems

    return [shown_problem(problem, kind, unit) for problem in problems]


# Tables down to this depth have a heading, such as `[linkage.bodies]`; deeper ones are written inline.
DEEPEST = 2


@checked
def to_toml(recipe: AbstractRecipe) -> str:
    """Write a recipe as TOML text.

    Parameters
    ----------
    recipe : AbstractRecipe
        The recipe. Keys that have their default value are omitted; files that it reads are named.

    Returns
    -------
    str
        A text from which `gk.load` makes an equal recipe; in inches with 14 digits of each length.
    """
    return "\n".join(table_lines("", plain_table(recipe))).lstrip("\n") + "\n"


def plain_table(recipe: AbstractRecipe) -> dict[str, Any]:
    """The keys of a recipe as TOML has them, without those that have their default value."""
    table = _without_defaults(recipe, whole_table(recipe, has_inner_defaults=False))
    first = {key: table.pop(key) for key in ("kind", "units") if key in table}
    # The mechanism comes before how it is printed, and the task.
    last = {key: table.pop(key) for key in ("printing", "optimise") if key in table}
    return first | table | last


def whole_table(recipe: AbstractRecipe, has_inner_defaults: bool = True) -> dict[str, Any]:
    """All keys of a recipe, and of recipes inside it, with their values as JSON states them, in its unit of length."""
    table = _plain_fields(recipe, whole_table if has_inner_defaults else short_table)
    if UNITS[recipe.units] is MM:
        return table

    return from_mm(table, type(recipe), UNITS[recipe.units])


def plain_value(
    value: Any, form: WrittenForm | None = None, inner: Callable[[AbstractRecipe], Any] | None = None
) -> Any:
    """A value as JSON states it. form: of its field; inner: the table of a recipe in a recipe."""
    if form and value is not None:
        return form.written(value, lambda value: plain_value(value, None, inner))
    if inner and isinstance(value, AbstractRecipe):
        return inner(value)
    if is_dataclass(value) and ROWS in fields_of(type(value)):
        rows, omitted = getattr(value, ROWS), getattr(value, "OMITTED", ())
        return [{k: v for k, v in plain_value(row).items() if v is not None or k not in omitted} for row in rows]
    if is_dataclass(value):
        return _plain_fields(value, inner)
    if isinstance(value, Mapping):
        return {name: plain_value(item, None, inner) for name, item in value.items()}
    if isinstance(value, (tuple, list)):
        return [plain_value(item, None, inner) for item in value]
    return [value.real, value.imag] if isinstance(value, complex) else value


def _plain_fields(thing: Any, inner: Callable[[AbstractRecipe], Any] | None) -> dict[str, Any]:
    fields = fields_of(type(thing))
    return {name: plain_value(getattr(thing, name), field.shape.form, inner) for name, field in fields.items()}


def short_table(recipe: AbstractRecipe) -> dict[str, Any]:
    """The same without default values in its tables, except stated fits, since the others are reported as assumed."""
    table, whole = _without_defaults(recipe, plain_table(recipe), is_deep=True), whole_table(recipe)
    for key, stated in (recipe.loaded_table or {}).items():
        fits = [fit for fit in sorted(FITS) if fit in stated] if is_stock(key) and isinstance(stated, Mapping) else []
        if fits:
            table[key] = table.get(key, {}) | {fit: whole[key][fit] for fit in fits}
    return table


def _without_defaults(thing: Any, table: dict[str, Any], is_deep: bool = False) -> dict[str, Any]:
    declared = fields_of(type(thing))
    usual = {name for name in declared if name != "kind" and getattr(thing, name) == declared[name].default}
    kept = {key: value for key, value in table.items() if key not in usual}
    for key, value in kept.items() if is_deep else ():
        if isinstance(value, dict) and is_dataclass(inner := getattr(thing, key)):
            # An empty table would not be written.
            kept[key] = _without_defaults(inner, value, is_deep) or value
    return kept


def table_lines(path: str, table: dict[str, Any], depth: int = 0) -> list[str]:
    """Lines of a table: its keys with plain values first, then the tables in it."""
    plain: list[str] = []
    tables: list[str] = []
    # Empty tables near the top are already omitted; a deeper one may be a body without points.
    for key, value in without_none(table, with_empty=depth >= DEEPEST).items():
        name = f"{path}.{toml_key(key)}" if path else toml_key(key)
        if isinstance(value, dict) and depth < DEEPEST:
            tables += ["", f"[{name}]", *table_lines(name, value, depth + 1)]
        elif isinstance(value, list) and value and all(isinstance(row, dict) for row in value) and depth < DEEPEST:
            for row in value:
                tables += ["", f"[[{name}]]", *table_lines(name, row, DEEPEST)]
        else:
            plain.append(f"{toml_key(key)} = {toml_value(value)}")
    return [*plain, *tables]


# Larger numbers are refused anyway, and may overflow.
LARGEST_LENGTH = 1e300


def in_mm(table: Mapping[str, Any], kind: type, unit: LengthUnit) -> dict[str, Any]:
    """The table of a recipe in this unit with all lengths in mm; recipes in it get the unit, unless they state one."""
    return _converted(table, kind, unit.in_mm, lambda inner: {"units": unit.name, **inner})


def from_mm(table: Mapping[str, Any], kind: type, unit: LengthUnit) -> dict[str, Any]:
    """The reverse; recipes in the table are already in this unit, which they need not state."""
    return _converted(table, kind, unit.in_digits, lambda inner: {k: v for k, v in inner.items() if k != "units"})


def _converted(
    table: Mapping[str, Any], kind: type, convert: Callable[[float, str], float], inner: Callable[[Any], Any]
) -> dict[str, Any]:
    def change(number: Number) -> Any:
        value = float(number.value) if isinstance(number.value, np.number) else number.value
        if isinstance(value, np.ndarray):
            return value  # Refused when the table is read.
        is_kept = names_mm(number.declared.name) or not abs(value) < LARGEST_LENGTH
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
