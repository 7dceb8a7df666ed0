"""The form of a kind of recipe: every key with its type, unit, limits and meaning, as its fields declare them."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any, Literal, get_origin

from ..core.field_visitor import DeclaredField, fields_of, kind_of, names_mm
from ..core.units import MM, UNITS, LengthUnit
from ..recipe.kinds import recipe_class
from ..recipe.recipe import SHARED, AbstractRecipe


def recipe_form(kind: str, values: Mapping[str, Any] | None = None) -> dict[str, Any]:
    """The form of a kind of recipe, in groups, one for each table.

    Parameters
    ----------
    kind : str
        Name of the kind.
    values : mapping, optional
        A recipe's values by dotted key, as `answer` returns them. Tables whose names the recipe chooses have groups
        under these names, and a recipe inside it has the groups of its own kind.

    Returns
    -------
    dict
        `groups`, each with `key`, `title`, `help`, `optional` (whether the table may be left out), `rows` (whether it
        is a list of tables, whose keys have `[]`), `within` (the kind of the table around it for which it exists), and
        its `fields`, or `kinds`, the fields by the kind of table.

    Raises
    ------
    KeyError
        If no kind has this name.

    Examples
    --------
    >>> from geomkin.studio.form import recipe_form
    >>> [group["key"] for group in recipe_form("spur-gear")["groups"]][:2]
    ['', 'gear']
    """
    recipe = recipe_class(kind)
    # The same table may be inside several kinds of table.
    found = _groups(recipe, "", {"title": f"kind: {kind}", "help": recipe.about()}, values or {})
    groups = list({group["key"]: group for group in found}.values())
    groups[0]["fields"] += [_described(key, declared) for key, declared in recipe.applied_fields().items()]
    unit = UNITS.get((values or {}).get("units", ""), MM)
    for fields in (fields for group in groups for fields in (group["fields"], *group.get("kinds", {}).values())):
        fields[:] = [_in_unit(field, unit) for field in fields]
    return {"kind": kind, "groups": groups}


def _in_unit(field: dict[str, Any], unit: LengthUnit) -> dict[str, Any]:
    """The field with its limits and its default in the unit of the recipe."""
    of = "mm" if field["type"] == "point" else field["unit"]
    if unit.factor(of) == 1 or names_mm(field["key"].rpartition(".")[2]):
        return field
    numbers = {name: _converted(field[name], of, unit) for name in ("least", "most", "default")}
    help = re.sub(r"\bin mm\b", f"in {unit.plural}", field["help"])
    return field | numbers | {"unit": unit.unit(field["unit"]), "help": re.sub(r", mm\b", f", {unit.name}", help)}


def _converted(value: Any, of: str, unit: LengthUnit) -> Any:
    if isinstance(value, list):
        return [_converted(item, of, unit) for item in value]
    return unit.in_digits(value, of) if isinstance(value, int | float) else value


def _groups(
    table: type, path: str, about: Mapping[str, Any], values: Mapping[str, Any], tables: list[type] | None = None
) -> Iterator[dict[str, Any]]:
    """The group of a table and those of the tables inside it."""
    group = {"key": path, "title": _title(path), "help": "", "optional": False, "rows": False, "within": ""}
    group |= about
    kinds = {kind_of(one): list(_fields(one, path, values)) for one in tables or () if kind_of(one)}
    yield group | ({"fields": [], "kinds": kinds} if len(kinds) > 1 else {"fields": list(_fields(table, path, values))})
    for one in tables or [table]:
        for declared in sorted(fields_of(one).values(), key=lambda declared: declared.name in SHARED):
            key = f"{path}.{declared.name}" if path else declared.name
            inner = declared.tables
            if declared.shape.is_recipe and f"{key}.kind" in values:
                yield from _inner_recipe(key, values)
            elif declared.is_named and inner:
                for name in _names(key, values):
                    about = {"help": _file_note(inner[0], f"{key}.{name}", values), "optional": True}
                    yield from _groups(inner[0], f"{key}.{name}", about, values)
                if not any(field.shape.is_recipe for field in fields_of(inner[0]).values()):
                    # Only the button that adds one.
                    yield {**group, "key": key, "title": _title(key), "optional": True, "fields": [], "named": True}
            elif inner:
                about = {
                    "help": declared.about.get("description", ""),
                    "optional": not declared.is_required,
                    "rows": declared.is_rows,
                    "within": kind_of(one) or "" if kinds else "",
                    "by_name": bool(_known_names(declared)),
                }
                yield from _groups(inner[0], f"{key}[]" if declared.is_rows else key, about, values, inner)


def _inner_recipe(key: str, values: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """The groups of a recipe inside another, which does not use its files."""
    kind = values[f"{key}.kind"]
    recipe = recipe_class(kind)
    for group in _groups(recipe, key, {"title": f"{_title(key)}: {kind}", "help": recipe.about()}, values):
        if not group["key"].startswith((f"{key}.files", f"{key}.optimise")):
            yield group


def _file_note(table: type, path: str, values: Mapping[str, Any]) -> str:
    """Where the values of a table's recipe are edited, if it is a file."""
    keys = [f"{path}.{name}" for name, declared in fields_of(table).items() if declared.shape.is_recipe]
    return "; ".join(f"to edit the values of its recipe, open {values[key]}" for key in keys if key in values)


def _names(key: str, values: Mapping[str, Any]) -> list[str]:
    """The names of the tables inside a table, in the order of the recipe."""
    return list(
        dict.fromkeys(other[len(key) + 1 :].partition(".")[0] for other in values if other.startswith(f"{key}."))
    )


def _fields(table: type, path: str, values: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    for name, declared in fields_of(table).items():
        key = f"{path}.{name}" if path else name
        is_kind = name == "kind" and issubclass(table, AbstractRecipe)
        if _known_names(declared):
            faces = {"faces": _faces(declared.tables[0], declared.shape.form)}
            yield _described(key, declared) | {"type": "named", "choices": _known_names(declared)} | faces
        elif not (declared.tables or f"{key}.kind" in values or is_kind):
            yield _described(key, declared)


def _known_names(declared: DeclaredField) -> list[str]:
    return declared.shape.form.names if declared.shape.form else []


def _faces(table: type, form: Any) -> dict[str, list[list[float]]]:
    """Circles of the faces of motors by name, each [x, y, radius] in mm, with the shaft first."""
    if "screws" not in fields_of(table):
        return {}
    return {
        name: [[0, 0, face.shaft / 2], [0, 0, face.boss_diameter / 2]]
        + [[screw.real, screw.imag, face.thread / 2] for screw in face.screws]
        for name, face in form.entries.items()
    }


def _title(path: str) -> str:
    """A key in words: the names in it, without those of the tables that hold whole mechanisms."""
    names = [name for name in path.replace("[]", "").split(".") if name not in ("mechanisms", "recipe")]
    names = [re.sub(r"^(first|second|last)_stock$", r"\1 gear, stock", name) for name in names]
    return ", ".join(re.sub(r"^(.+)_stock$", r"\1, stock", name).replace("_", " ") for name in names)


def _described(key: str, declared: DeclaredField) -> dict[str, Any]:
    about, choices = declared.about, list(declared.shape.choices)
    types = [option for option in declared.shape.options if get_origin(option) is not Literal]
    return {
        "key": key,
        "type": _type(types, choices, about),
        "unit": about.get("unit", ""),
        "least": about.get("ge", about.get("gt")),
        "most": about.get("le", about.get("lt")),
        "choices": choices,
        "help": about.get("description", ""),
        "default": _json_value(declared.default),
        "optional": not declared.is_required,
    }


def _type(types: list[Any], choices: list[Any], about: Mapping[str, Any]) -> str:
    if bool in types:
        return "boolean"
    if about.get("whole") or (types == [int] and not choices):
        return "integer"
    if "unit" in about or float in types:
        return "number"
    if complex in types and not choices:
        return "point"
    if choices:
        return "choice"
    origins = {get_origin(one) or one for one in types}
    if origins & {dict, Mapping}:
        return "table"
    return "list" if origins & {tuple, list} else "text"


def _json_value(value: Any) -> Any:
    if isinstance(value, complex):
        return [value.real, value.imag]
    if isinstance(value, (list, tuple)):
        return [_json_value(item) for item in value]
    if isinstance(value, Mapping):
        return {name: _json_value(item) for name, item in value.items()}
    return value if isinstance(value, (str, int, float, bool)) else None
