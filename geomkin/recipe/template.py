"""What may stand in a recipe, from the declarations that validate it: a recipe to start from, and the JSON Schema."""

from __future__ import annotations

import dataclasses
import re
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from types import UnionType
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

from pydantic import TypeAdapter

from ..core.errors import DesignError, printable
from ..core.fields import allowed
from .kinds import kind_names, recipe_class
from .load import adapter, toml_value
from .messages import kind_of, nearest, tables_in
from .recipe import AbstractRecipe

# Editors look for the schema beside the recipe, which works for everyone who has the command, without a network.
SCHEMA = "geomkin.schema.json"
# What the key `scale` means, which no class has as a field: it is gone once a recipe is loaded.
SCALE = "multiplies all lengths but those of stock, base and files; from 1e-06 to 1e+06"


def template(recipe: type[AbstractRecipe], options: Sequence[str] = ()) -> str:
    """A commented TOML text of a kind that runs as it is; what may be left out stands commented out.

    wishes: tables of another kind than the usual, as `follower=oscillating-roller`, and tables that may be left out,
    as `web`. DesignError for one that the kind does not have.
    """
    offered, wanted = choices(recipe), asked(recipe, options)
    fitted = recipe.example_values(wanted)
    plain = {key: example(offered[key][which]) for key, which in wanted.items() if not _is_given(key, fitted)}
    shown = example(recipe, {**plain, **fitted})
    return "\n".join([*_head(recipe, offered), *_table("", shown, offered)]).rstrip() + "\n"


def _is_given(key: str, fitted: Mapping[str, Any]) -> bool:
    """Whether a table's example stands among others, by itself or inside one."""
    return any(key == other or key.startswith(f"{other}.") for other in fitted)


def example(cls: type, given: Mapping[str, Any] | None = None, base: Any = None) -> Any:
    """An instance of a dataclass from the examples its fields give.

    given: values by dotted key that stand for those; base: an instance that the rest is taken from.
    """
    hints, given = get_type_hints(cls), given or {}
    values = {}
    for field in dataclasses.fields(cls):
        inside = {key.partition(".")[2]: value for key, value in given.items() if key.startswith(f"{field.name}.")}
        shown = field.metadata.get("examples", [None])[0] if base is None else getattr(base, field.name)
        if field.name == "kind" and base is None:
            values["kind"] = field.default
        elif field.name in given:
            values[field.name] = given[field.name]
        elif inside:
            held = type(shown) if dataclasses.is_dataclass(shown) else hints[field.name]
            values[field.name] = example(held, given=inside, base=shown if dataclasses.is_dataclass(shown) else None)
        elif base is not None or (shown is not None and shown is not dataclasses.MISSING):
            values[field.name] = shown
        elif field.default is dataclasses.MISSING:
            values[field.name] = example(hints[field.name])
    return cls(**values)


def _head(recipe: type[AbstractRecipe], offered: Mapping[str, Mapping[str, type]]) -> list[str]:
    """What the recipe is, how an editor gets to know it, and what else `new` can show."""
    text = [
        *textwrap.wrap(f"{recipe.about()} {recipe.advice}".strip(), 110),
        f"An editor marks what is wrong here once `geomkin schema > {SCHEMA}` has been run beside this file.",
    ]
    for key in dict.fromkeys(key.rsplit(".", 1)[-1] for key in offered):
        kinds = next(kinds for other, kinds in offered.items() if other.rsplit(".", 1)[-1] == key)
        wish = f"{key}={list(kinds)[-1]}" if "" not in kinds else key
        text.append(f"Another kind of table, or more: geomkin new {kind_of(recipe)} --with {wish}")
    return [f"#:schema ./{SCHEMA}", *(f"# {line}" for line in text)]


def _table(path: str, value: Any, offered: Mapping[str, Mapping[str, type]]) -> list[str]:
    """Lines of a table: plain keys first, then its own tables."""
    plain, tables = [], []
    if not path and value.can_be_scaled:
        plain.append(("# scale = 1", SCALE))
    for field in sorted(dataclasses.fields(value), key=lambda f: (f.name != "kind", f.name == "expected_failures")):
        inner = getattr(value, field.name)
        name = f"{path}.{field.name}" if path else field.name
        rows = getattr(inner, "segments", inner)
        if isinstance(rows, tuple | list) and rows and dataclasses.is_dataclass(rows[0]):
            for row in rows:
                tables += ["", f"[[{name}]]", *_table(name, row, offered)]
        elif isinstance(inner, dict) and inner:
            tables += ["", f"[{name}]  # {field.metadata['description']}"]
            tables += [f"{key} = {toml_value(held)}" for key, held in inner.items()]
        elif dataclasses.is_dataclass(inner):
            tables += ["", f"[{name}]", *_table(name, inner, offered)]
        else:
            text, note = _line(field, inner, get_type_hints(type(value))[field.name])
            if field.name == "kind" and path in offered:
                note = " or ".join(offered[path])
            if name in offered:
                note += f"; shown by --with {field.name}"
            plain.append((text, note))
    width = min(36, max((len(text) for text, _ in plain), default=0))
    return [f"{text:<{width}}  # {note}" if note else text for text, note in plain] + tables


def _line(field: dataclasses.Field[Any], value: Any, hint: Any) -> tuple[str, str]:
    note = field.metadata.get("description", "")
    if "unit" in field.metadata:
        limits = allowed(field.metadata | {"unit": ""}).removeprefix("a number").removeprefix("a whole number").strip()
        note += f"; {limits}" if limits else ""
    elif len(words := _words(hint)) > (get_origin(hint) is Literal):
        note += "; " + " or ".join(words)
    if value is None:
        return f"# {field.name} =", note
    required = field.default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING
    optional = not required and value in (field.default, field.metadata.get("filled_in"), {}) and field.name != "kind"
    return f"{'# ' if optional else ''}{field.name} = {toml_value(value)}", note


def _words(hint: Any) -> list[str]:
    """The texts that a type hint allows, or that stand there unless it is left out."""
    if get_origin(hint) is Literal:
        return [str(word) for word in get_args(hint)]
    return [word for part in get_args(hint) if get_origin(hint) in (Union, UnionType) for word in _words(part)]


def choices(recipe: type, path: str = "") -> dict[str, dict[str, type]]:
    """Dotted key -> kind -> its dataclass, of all tables that a template shows only one kind of, or not at all.

    Tables that may be left out have the one kind "".
    """
    found: dict[str, dict[str, type]] = {}
    hints = get_type_hints(recipe)
    for field in dataclasses.fields(recipe):
        tables, key = tables_in(hints[field.name]), path + field.name
        kinds = {kind_of(table): table for table in tables if kind_of(table)}
        is_shown = bool(field.metadata.get("examples", [None])[0])
        if len(kinds) > 1:
            found[key] = kinds
        elif tables and not is_shown and (field.default is None or get_origin(hints[field.name]) is tuple):
            found[key] = {"": tables[0]}
        elif len(tables) == 1:
            found |= choices(tables[0], f"{key}.")
    return found


def asked(recipe: type, options: Iterable[str]) -> dict[str, str]:
    """Dotted key -> kind of what is asked for, as `follower=oscillating-roller` or `stock.web`, of a recipe's class.

    The end of a key stands for all keys that end so. DesignError for what there is not.
    """
    offered = choices(recipe)
    found: dict[str, str] = {}
    for wish in options:
        end, _, which = wish.partition("=")
        keys = [key for key in offered if key == end or key.endswith(f".{end}")]
        if not keys:
            short = {key.rsplit(".", 1)[-1]: key for key in offered}
            known = f"{kind_of(recipe)} has {', '.join(short) or 'none'}"
            raise DesignError(
                "--with", f"no such table: {printable(end)}", nearest(end, [*short, *offered]) + known, "unknown-key"
            )
        for key in keys:
            kinds = offered[key]
            if which not in kinds:
                remedy = f"give {' or '.join(f'{end}={k}' if k else end for k in kinds)}"
                raise DesignError("--with", f"found {printable(wish)}", nearest(which, kinds) + remedy, "unknown-kind")
            found[key] = which
    return found


def schema() -> dict[str, Any]:
    """A schema in which a wrong key or value is wrong at its own place, not at the whole recipe or segment.

    A table is recognised by its `kind` alone: each has its `if` and `then`. Of a plain choice between
    them (`oneOf`) an editor only sees that none fits, and marks the whole.
    """
    kinds = {name: recipe_class(name) for name in kind_names()}
    inputs: list[tuple[str, Literal["validation"], TypeAdapter[Any]]] = [
        (name, "validation", adapter(recipe)) for name, recipe in kinds.items()
    ]
    by_kind, shared = TypeAdapter.json_schemas(inputs, title="geomkin recipe")
    for table in shared["$defs"].values():
        table["additionalProperties"] = False
    for name, recipe in kinds.items():
        if recipe.can_be_scaled:
            own = shared["$defs"][by_kind[name, "validation"]["$ref"].rpartition("/")[2]]
            own["properties"]["scale"] = {"type": "number", "minimum": 1e-6, "maximum": 1e6, "description": SCALE}
    recipes = _by_kind({name: by_kind[name, "validation"]["$ref"] for name in kinds})
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **_plain(shared), **recipes}


def _by_kind(tables: dict[str, str], usual: str = "") -> dict[str, Any]:
    """A table that is one of several, by its `kind`. tables: the reference to each; usual: without one."""
    return {
        "type": "object",
        "required": [] if usual else ["kind"],
        "properties": {"kind": {"enum": list(tables)}},
        "allOf": [
            {
                "if": {"required": [] if name == usual else ["kind"], "properties": {"kind": {"const": name}}},
                "then": {"$ref": reference},
            }
            for name, reference in tables.items()
        ],
    }  # fmt: skip


def _plain(node: Any) -> Any:
    """The same without what TOML does not know (null, complex numbers), and with choices distinguished by `kind`."""
    if isinstance(node, list):
        return [_plain(part) for part in node]
    if not isinstance(node, dict):
        return node
    node = {key: part if key in ("default", "enum", "const") else _plain(part) for key, part in node.items()}
    # Where a formula is from is for those who read the code.
    if isinstance(node.get("description"), str):
        node["description"] = re.split(r"\n\n(?:Source\b|\w+\n---)", node["description"])[0]
    # Examples are written as Python has them; templates show them as TOML.
    if isinstance(node.get("examples"), list):
        del node["examples"]
    if "discriminator" in node:
        choice = node.pop("discriminator")
        del node["oneOf"]
        node |= _by_kind(choice["mapping"], choice.get("usual", ""))
    if "anyOf" in node:
        kept = [part for part in node["anyOf"] if part != {"type": "null"}]
        if len(kept) == 1:
            del node["anyOf"]
            node = kept[0] | node
    if "default" in node:
        default = node.pop("default")
        if isinstance(default, str) and node.get("type") == "array":
            point = complex(default)
            default = [point.real, point.imag]
        # An editor has no use for a whole table.
        if default is not None and not isinstance(default, dict):
            node["default"] = default
    return node
