"""A table, or an item of a list, that is added to a recipe: the examples of its fields, with names of that recipe."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import islice, product
from typing import Any

from ..core.errors import DesignError, GeomkinError, RecipeError, shown
from ..core.field_visitor import ROWS, DeclaredField, fields_of, key_parts, kind_of
from ..core.units import MM, UNITS
from ..recipe.load import from_mm, plain_value, shown_numbers
from ..recipe.recipe import AbstractGoal, AbstractRecipe
from ..recipe.template import example

# Largest number of tables that are tried; names of a large mechanism have many combinations.
MOST_TRIALS = 60


def addition(
    recipe: AbstractRecipe, key: str, opened: Callable[[Mapping[str, Any]], AbstractRecipe]
) -> Mapping[str, Any]:
    """Values by dotted key that add a table or an item of a list: the first ones with which the recipe is valid.

    Parameters
    ----------
    recipe : AbstractRecipe
        The recipe before.
    key : str
        The table's key; of a list that of the list, or with `[]`. `key=kind` makes a table that is there one of another
        kind, such as `cam.follower=oscillating-roller`; values that both kinds have stay.
    opened : callable
        The recipe with other values; raises GeomkinError for values that it refuses.

    Raises
    ------
    DesignError
        If the recipe has no such table, or refuses all values; then with the reason for the first ones.
    """
    key, _, kind = key.removesuffix("[]").partition("=")
    around = key.rpartition(".")[0]
    if not kind and around and _declared(*_innermost(recipe, around)[:2])[1] is None:
        first = addition(recipe, around, opened)
        more = addition(opened(first), key, lambda changes: opened({**first, **changes}))
        return {**first, **more}
    refusal: GeomkinError | None = None
    for changes in islice(_of_kind(recipe, key, kind) if kind else _candidates(recipe, key), MOST_TRIALS):
        for _ in range(2):
            try:
                _use(opened(changes))
                return changes
            except GeomkinError as error:
                refusal = refusal or error
                corrected = _corrected(changes, error)
                if corrected == changes:
                    break
                changes = corrected
    if refusal:
        raise refusal
    raise DesignError(key, "names something that this recipe does not have", "add that first", "missing-key")


def _corrected(changes: Mapping[str, Any], error: GeomkinError) -> Mapping[str, Any]:
    """The values with the number that a refusal proposes."""
    problem = error.as_problem if isinstance(error, DesignError) else None
    if isinstance(error, RecipeError):
        problem = error.problems[0]
    if problem is None or problem.value is None:
        return changes
    for place, values in changes.items():
        name = problem.key.removeprefix(f"{place}.")
        if isinstance(values, dict) and name in values:
            return {**changes, place: values | {name: float(f"{0.7 * problem.value:.2g}")}}
    return changes


def _use(recipe: AbstractRecipe) -> None:
    """Compute what an editor shows; a search is only read."""
    if not isinstance(recipe, AbstractGoal):
        _ = recipe.scene, recipe.parts


def _candidates(recipe: AbstractRecipe, key: str) -> Iterator[Mapping[str, Any]]:
    inner, inside, prefix = _innermost(recipe, key)
    yield from (
        {prefix + name: value for name, value in changes.items()} for changes in inner.additions.changes(inner, inside)
    )
    declared, held = _declared(inner, inside)
    index = f"[{len(_rows(held))}]" if declared.is_rows else ""
    given = inner.example_values({inside: ""})
    extra = {
        prefix + name: plain_value(value, _declared(inner, name)[0].shape.form)
        for name, value in given.items()
        if not name.startswith(inside) and _declared(inner, name)[0].default == _held(inner, name)
    }
    known = {**_formulas(inner), **inner.additions.names(inner)}
    for table in declared.tables:
        values = given.get(inside)
        whole = _without_defaults(values if isinstance(values, table) else example(table), inner)
        names = {name: known[name] for name, value in whole.items() if name in known and _has_names(value)}
        required = [name for name, inner_field in fields_of(table).items() if inner_field.is_required or name == "kind"]
        # A table may not have all optional values at once.
        fewer = [{k: v for k, v in whole.items() if k != left_out} for left_out in whole if left_out not in required]
        bare = {name: value for name, value in whole.items() if name in required}
        places = [f"{key}.{name}" for name in known.get(inside, ())] if declared.is_named else [key + index]
        for plain, place, chosen in product([whole, *fewer, bare], places, product(*names.values())):
            yield {**extra, place: plain | {name: value for name, value in zip(names, chosen) if name in plain}}


def _of_kind(recipe: AbstractRecipe, key: str, kind: str) -> Iterator[Mapping[str, Any]]:
    inner, inside, _ = _innermost(recipe, key)
    declared, held = _declared(inner, inside)
    table = next((table for table in declared.tables if kind_of(table) == kind), None)
    if table is None or held is None:
        kinds = ", ".join(filter(None, map(kind_of, declared.tables)))
        raise DesignError(key, f"found {shown(kind)}", f"give one of {kinds}" if kinds else "omit it", "unknown-kind")
    before, whole = (_without_defaults(values, inner) for values in (held, example(table)))
    fields = fields_of(table)
    common = {name: value for name, value in before.items() if name in fields and name != "kind"}
    for values in (whole | common, whole):
        gone = {name: None for name in before if name not in values}
        yield {f"{key}.{name}": value for name, value in {**gone, **values}.items()}


def _has_names(value: Any) -> bool:
    return isinstance(value, str) or (isinstance(value, list) and all(isinstance(item, str) for item in value))


def _formulas(recipe: AbstractRecipe) -> Mapping[str, Sequence[Any]]:
    """Columns of the recipe's table, and a task of optimisation with a length and a column of it."""
    ids = [] if isinstance(recipe, AbstractGoal) else [column.id for column in recipe.table.columns[1:]]
    ids.sort(key=lambda id: id != "transmission_angle")
    sizes = [number for number in shown_numbers(recipe) if number.unit == "mm" and number.value > 0]
    formulas: dict[str, list[Any]] = {
        "of": ids,
        "vary": [[f"{size.key} = {0.8 * size.value:.4g}:{1.2 * size.value:.4g}"] for size in sizes[:1]],
        "minimise": [f"-min({id})" if id == "transmission_angle" else f"max({id})" for id in ids],
    }
    return {name: values for name, values in formulas.items() if values}


def _without_defaults(values: Any, recipe: AbstractRecipe) -> dict[str, Any]:
    """The values of a table that are not its defaults."""
    table = type(values)
    plain = {
        name: plain_value(value, declared.shape.form)
        for name, declared in fields_of(table).items()
        if (value := getattr(values, name)) is not None and (name == "kind" or value != declared.default)
    }
    return plain if UNITS[recipe.units] is MM else from_mm(plain, table, UNITS[recipe.units])


def _innermost(recipe: AbstractRecipe, key: str) -> tuple[AbstractRecipe, str, str]:
    """The recipe inside a recipe that has the key, the key in it, and the key of that recipe with a dot."""
    parts, prefix = key.split(".recipe."), ""
    for part in parts[:-1]:
        prefix += f"{part}.recipe."
        recipe = _held(recipe, f"{part}.recipe")
        if not isinstance(recipe, AbstractRecipe):
            raise DesignError(key, "is in no recipe", "give a key of the recipe", "unknown-key")
    return recipe, parts[-1], prefix


def _declared(recipe: AbstractRecipe, key: str) -> tuple[DeclaredField, Any]:
    """The field of a key and its value, None if a table around it is omitted."""
    table: type | None = type(recipe)
    held: Any = recipe
    declared = None
    for part in key_parts(key):
        if isinstance(part, int) or isinstance(held, Mapping):
            held = _inside(held, part)
        else:
            declared = fields_of(table).get(part) if table else None
            if declared is None:
                raise DesignError(key, f"found {shown(part)}", "give a key of the recipe", "unknown-key")
            held, tables = getattr(held, part, None), declared.tables
            table = tables[0] if tables else None
        table = type(held) if dataclasses.is_dataclass(held) and ROWS not in fields_of(type(held)) else table
    if declared is None:
        raise DesignError(key, "is no table", "give a key of the recipe", "unknown-key")
    return declared, held


def _held(recipe: AbstractRecipe, key: str) -> Any:
    held: Any = recipe
    for part in key_parts(key):
        held = _inside(held, part)
    return held


def _inside(held: Any, part: str | int) -> Any:
    if isinstance(part, int):
        rows = _rows(held)
        return rows[part] if part < len(rows) else None
    return held.get(part) if isinstance(held, Mapping) else getattr(held, part, None)


def _rows(held: Any) -> tuple[Any, ...]:
    """The rows of a list of tables, also of one that is read as a whole."""
    return tuple(getattr(held, ROWS, held) or ())
