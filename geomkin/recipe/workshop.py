"""The workshop file: kerf and fits measured for each material. Recipes that name it take the values that they omit."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Mapping
from typing import Any

from ..core.errors import DesignError, Problem, RecipeError, printable, shown
from ..core.field_visitor import fields_of
from ..core.fields import FARTHEST, quantity
from ..core.names import Folder, read_text_file
from ..core.records import record
from ..core.units import MM, UNITS, LengthUnit, marked, mm
from .lengths import in_mm, shown_problem
from .messages import did_you_mean
from .reader import read_table
from .recipe import FITS, AbstractRecipe, is_stock
from .settings import kerf
from .toml import LARGEST, parsed

# Largest number of materials that a message lists.
MOST_LISTED = 20


@record(checked=True)
class MeasuredFits:
    """Kerf and fits of one material, mm; None if not measured."""

    kerf: float | None = kerf(None)
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
