"""The form of a kind of recipe: every key with its type, unit, limits and meaning, as its fields declare them."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping
from dataclasses import MISSING
from types import UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from ..recipe.kinds import recipe_class
from ..recipe.messages import hints_of, kind_of, tables_in
from ..recipe.recipe import SHARED
from ..recipe.template import SCALE, WORKSHOP


def recipe_form(kind: str) -> dict[str, Any]:
    """The form of a kind of recipe, in groups, one for each table.

    Parameters
    ----------
    kind : str
        Name of the kind.

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
    found = _groups(recipe, "", {"title": kind, "help": recipe.about()})
    groups = list({group["key"]: group for group in found}.values())
    groups[0]["fields"].append(_described("workshop", str, {"description": WORKSHOP}, None, True))
    if recipe.can_be_scaled:
        scale = {"unit": "", "ge": 1e-6, "le": 1e6, "description": SCALE}
        groups[0]["fields"].append(_described("scale", float, scale, 1.0, True))
    return {"kind": kind, "groups": groups}


def _groups(
    table: type, path: str, about: Mapping[str, Any], tables: list[type] | None = None
) -> Iterator[dict[str, Any]]:
    """The group of a table and those of the tables inside it."""
    group = {"key": path, "title": path.replace("[]", ""), "help": "", "optional": False, "rows": False, "within": ""}
    group |= about
    kinds = {kind_of(one): list(_fields(one, path)) for one in tables or () if kind_of(one)}
    yield group | ({"fields": [], "kinds": kinds} if len(kinds) > 1 else {"fields": list(_fields(table, path))})
    for one in tables or [table]:
        for field in sorted(dataclasses.fields(one), key=lambda field: field.name in SHARED):
            hint = hints_of(one)[field.name]
            # Tables under names that the recipe chooses are edited in its text.
            if (inner := tables_in(hint)) and get_origin(hint) is not dict:
                key = f"{path}.{field.name}" if path else field.name
                is_rows = get_origin(hint) is tuple or (dataclasses.is_dataclass(hint) and hint not in inner)
                entry = {
                    "help": field.metadata.get("description", ""),
                    "optional": field.default is not MISSING or field.default_factory is not MISSING,
                    "rows": is_rows,
                    "within": kind_of(one) or "" if kinds else "",
                }
                yield from _groups(inner[0], f"{key}[]" if is_rows else key, entry, inner)


def _fields(table: type, path: str) -> Iterator[dict[str, Any]]:
    for field in dataclasses.fields(table):
        hint = hints_of(table)[field.name]
        if (tables_in(hint) and get_origin(hint) is not dict) or (field.name == "kind" and not path):
            continue
        key = f"{path}.{field.name}" if path else field.name
        has_default = field.default is not MISSING or field.default_factory is not MISSING
        default = field.default_factory() if field.default_factory is not MISSING else field.default
        yield _described(key, hint, field.metadata, default, has_default)


def _described(key: str, hint: Any, about: Mapping[str, Any], default: Any, optional: bool) -> dict[str, Any]:
    parts = list(_parts(hint))
    choices = [choice for part in parts if get_origin(part) is Literal for choice in get_args(part)]
    types = [part for part in parts if get_origin(part) is not Literal and part is not type(None)]
    return {
        "key": key,
        "type": _type(types, choices, about),
        "unit": about.get("unit", ""),
        "least": about.get("ge", about.get("gt")),
        "most": about.get("le", about.get("lt")),
        "choices": choices,
        "help": about.get("description", ""),
        "default": None if default is MISSING else _plain(default),
        "optional": optional,
    }


def _parts(hint: Any) -> Iterator[Any]:
    """The types of a union, without annotations."""
    if get_origin(hint) is Annotated:
        yield from _parts(get_args(hint)[0])
    elif get_origin(hint) in (Union, UnionType):
        for part in get_args(hint):
            yield from _parts(part)
    else:
        yield hint


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


def _plain(value: Any) -> Any:
    if isinstance(value, complex):
        return [value.real, value.imag]
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, Mapping):
        return {name: _plain(item) for name, item in value.items()}
    return value if isinstance(value, (str, int, float, bool)) else None
