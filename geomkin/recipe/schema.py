"""The JSON Schema of recipes, made from the declarations that validate them."""

from __future__ import annotations

import dataclasses
import inspect
import re
from collections.abc import Mapping, Sequence
from typing import Any, get_args

from ..core.field_visitor import ROWS, DeclaredField, TypeShape, fields_of, item_shape, kind_of
from ..core.fields import Coordinate
from .kinds import kind_names, recipe_class
from .load import plain_value

LIMITS = {"gt": "exclusiveMinimum", "ge": "minimum", "lt": "exclusiveMaximum", "le": "maximum"}
TYPES = {float: "number", int: "integer", bool: "boolean"}
# The file of a recipe, or a recipe in the recipe.
RECIPE = {"type": ["string", "object"], "if": {"type": "object"}, "then": {"$ref": "#"}}


def schema() -> dict[str, Any]:
    """The JSON Schema of all kinds of recipe.

    Each kind of a table has an `if` on its `kind` and a `then`, so that an editor marks only the wrong key. With
    `oneOf`, a choice between all kinds, it would mark the whole table.
    """
    tables: dict[str, Any] = {}
    references: dict[str, dict[str, Any]] = {}
    for name in kind_names():
        recipe = recipe_class(name)
        references[name] = _table(recipe, tables)
        applied = {key: _field(declared, tables) for key, declared in recipe.applied_fields().items()}
        tables[_name(recipe)]["properties"] |= applied
    draft = "https://json-schema.org/draft/2020-12/schema"
    return {"$schema": draft, "$defs": tables, "title": "geomkin recipe", **_by_kind(references)}


def _by_kind(tables: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    """A table of one of several kinds."""
    return {
        "type": "object",
        "required": ["kind"],
        "properties": {"kind": {"enum": list(tables)}},
        "allOf": [
            {"if": {"required": ["kind"], "properties": {"kind": {"const": name}}}, "then": table}
            for name, table in tables.items()
        ],
    }  # fmt: skip


def _name(table: type) -> str:
    """A name of its own: no two classes of the package share one."""
    is_own = table.__module__.startswith("geomkin.")
    return table.__name__ if is_own else f"{table.__module__}.{table.__name__}"


def _table(table: type, tables: dict[str, Any]) -> dict[str, Any]:
    """A reference to the schema of a dataclass, which is added to the tables."""
    if _name(table) not in tables:
        tables[_name(table)] = {}
        # Sections such as Notes are for readers of the code.
        about = re.split(r"\n\n(?:Source\b|\w+\n---)", inspect.cleandoc(table.__doc__ or ""))[0]
        tables[_name(table)] |= {
            "title": table.__name__,
            "description": about,
            "type": "object",
            "properties": {name: _field(declared, tables) for name, declared in fields_of(table).items()},
            "required": [name for name, declared in fields_of(table).items() if declared.is_required],
            "additionalProperties": False,
        }
    return {"$ref": f"#/$defs/{_name(table)}"}


def _field(declared: DeclaredField, tables: dict[str, Any]) -> dict[str, Any]:
    about, default = declared.about, declared.default
    described = {"description": about["description"]} if "description" in about else {}
    # Editors do not use default tables.
    is_table = isinstance(default, Mapping) or dataclasses.is_dataclass(default)
    shown = {} if is_table or default in (None, dataclasses.MISSING) else {"default": plain_value(default)}
    return _type(declared.shape, about, tables) | described | shown


def _type(shape: TypeShape, about: Mapping[str, Any], tables: dict[str, Any]) -> dict[str, Any]:
    """The schema of a type. about: what its field declares."""
    form = shape.form
    if form and form.choices:
        return {"type": "string", "enum": form.choices}
    return form.schema(_shape(shape, about, tables)) if form else _shape(shape, about, tables)


def _shape(shape: TypeShape, about: Mapping[str, Any], tables: dict[str, Any]) -> dict[str, Any]:
    option, origin, inner = shape.options[0], shape.origin, shape.tables
    if shape.is_mixed:
        return {"anyOf": [_type(item_shape(option), about, tables) for option in shape.options]}
    if shape.choices:
        return {"const": shape.choices[0]} if len(shape.choices) == 1 else {"enum": list(shape.choices)}
    if origin is tuple and get_args(option)[-1] is not ...:
        items = [_type(item_shape(item), {}, tables) for item in get_args(option)]
        return {"type": "array", "prefixItems": items, "minItems": len(items), "maxItems": len(items)}
    if origin in (tuple, Sequence):
        return {"type": "array", "items": _type(item_shape(get_args(option)[0]), {}, tables)}
    if origin in (dict, Mapping):
        return {"type": "object", "additionalProperties": _type(item_shape(get_args(option)[1]), {}, tables)}
    if shape.is_recipe:
        return RECIPE
    if inner and dataclasses.is_dataclass(option) and ROWS in fields_of(option):
        return _type(fields_of(option)[ROWS].shape, {}, tables)
    if len(inner) > 1:
        return _by_kind({kind_of(table): _table(table, tables) for table in inner})
    if inner:
        return _table(inner[0], tables)
    if option is complex:
        return _type(item_shape(tuple[Coordinate, Coordinate]), {}, tables)
    limits = {LIMITS[key]: about[key] for key in LIMITS if key in about}
    if shape.mark and shape.mark.limits:
        limits = dict(zip(("minimum", "maximum"), shape.mark.limits))
    return {"type": TYPES.get(option, "string"), **limits}
