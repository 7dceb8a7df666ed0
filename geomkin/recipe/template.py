"""Templates of recipes and their JSON Schema, both made from the declarations that validate recipes."""

from __future__ import annotations

import dataclasses
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from ..core.errors import DesignError, printable
from ..core.field_visitor import DeclaredField, fields_of, kind_of
from ..core.fields import allowed
from .load import short_table, table_lines
from .messages import did_you_mean
from .recipe import SHARED, AbstractRecipe
from .toml import toml_value

# Editors look for the schema in the folder of the recipe, so no network is needed.
SCHEMA = "geomkin.schema.json"


def template(recipe: type[AbstractRecipe], options: Sequence[str] = ()) -> str:
    """A recipe of a kind as TOML text that runs without changes; optional keys are commented out.

    options: other kinds of tables, such as `follower=oscillating-roller`, and optional tables, such as `web`.
    DesignError if the kind does not have one of them.
    """
    offered, chosen = choices(recipe), chosen_tables(recipe, options)
    values = recipe.example_values(chosen)
    tables = {key: example(offered[key][kind]) for key, kind in chosen.items() if not _is_given(key, values)}
    shown = example(recipe, {**tables, **values})
    return "\n".join([*_head(recipe, offered), *_table("", shown, offered)]).rstrip() + "\n"


def _is_given(key: str, values: Mapping[str, Any]) -> bool:
    """Whether the values contain a table, by itself or inside another one."""
    return any(key == other or key.startswith(f"{other}.") for other in values)


def example(cls: type, given: Mapping[str, Any] | None = None, base: Any = None) -> Any:
    """An instance of a dataclass, made from the examples of its fields.

    given: values by dotted key that replace examples. base: an instance with the values of all other fields.
    """
    given = given or {}
    values = {}
    for name, declared in fields_of(cls).items():
        inside = {key.partition(".")[2]: value for key, value in given.items() if key.startswith(f"{name}.")}
        shown = declared.about.get("examples", [None])[0] if base is None else getattr(base, name)
        if name == "kind" and base is None:
            values["kind"] = declared.default
        elif name in given:
            values[name] = given[name]
        elif inside:
            is_table = dataclasses.is_dataclass(shown)
            table = type(shown) if is_table else declared.tables[0]
            values[name] = example(table, given=inside, base=shown if is_table else None)
        elif base is not None or (shown is not None and shown is not dataclasses.MISSING):
            values[name] = shown
        elif declared.is_required:
            values[name] = example(declared.tables[0])
    return cls(**values)


def _head(recipe: type[AbstractRecipe], offered: Mapping[str, Mapping[str, type]]) -> list[str]:
    """Comments: the kind, its schema, and the other tables that `new` can show."""
    # Tables that several tables contain, such as `material` of two stocks, are offered once.
    kinds_by_key: dict[str, list[str]] = {}
    for key, kinds in offered.items():
        kinds_by_key.setdefault(key.rsplit(".", 1)[-1], list(kinds))
    options = [key if "" in kinds else f"{key}={kinds[-1]}" for key, kinds in kinds_by_key.items()]
    texts = [
        f"{recipe.about()} {recipe.advice}".strip(),
        f"Run `geomkin schema > {SCHEMA}` in this folder once; then editors mark mistakes while you type.",
        f"To show other tables, add `--with` and one of: {', '.join(options)}.",
    ]
    text = [line for paragraph in texts[: 3 if options else 2] for line in textwrap.wrap(paragraph, 110)]
    return [f"#:schema ./{SCHEMA}", *(f"# {line}" for line in text)]


def _table(path: str, value: Any, offered: Mapping[str, Mapping[str, type]]) -> list[str]:
    """Lines of a table: its keys with plain values first, then the tables in it."""
    plain, tables = [], []
    if not path:
        plain += [_line(declared, declared.default) for declared in value.applied_fields().values()]
    for declared in sorted(fields_of(type(value)).values(), key=lambda f: (f.name != "kind", f.name in SHARED)):
        inner = getattr(value, declared.name)
        name = f"{path}.{declared.name}" if path else declared.name
        rows = getattr(inner, "segments", inner)
        if isinstance(rows, tuple | list) and rows and dataclasses.is_dataclass(rows[0]):
            for row in rows:
                tables += ["", f"[[{name}]]", *_table(name, row, offered)]
        elif isinstance(inner, dict) and any(map(dataclasses.is_dataclass, inner.values())):
            for key, item in inner.items():
                tables += ["", f"[{name}.{key}]", *_table(f"{name}.{key}", item, offered)]
        elif isinstance(inner, AbstractRecipe):
            tables += ["", f"[{name}]", *table_lines(name, short_table(inner))]
        elif isinstance(inner, dict) and inner:
            tables += ["", f"[{name}]  # {declared.about['description']}"]
            tables += [f"{key} = {toml_value(item)}" for key, item in inner.items()]
        elif dataclasses.is_dataclass(inner):
            tables += ["", f"[{name}]", *_table(name, inner, offered)]
        else:
            text, note = _line(declared, inner)
            if declared.name == "kind" and path in offered:
                note = " or ".join(offered[path])
            if name in offered:
                note += f"; shown by --with {declared.name}"
            plain.append((text, note))
    width = min(36, max((len(text) for text, _ in plain), default=0))
    return [f"{text:<{width}}  # {note}" if note else text for text, note in plain] + tables


def _line(declared: DeclaredField, value: Any) -> tuple[str, str]:
    name, about = declared.name, declared.about
    note = about.get("description", "")
    if "unit" in about:
        limits = allowed({**about, "unit": ""}).removeprefix("a number").removeprefix("a whole number").strip()
        note += f"; {limits}" if limits else ""
    elif len(declared.shape.choices) > 1:
        note += "; " + " or ".join(map(str, declared.shape.choices))
    if value is None:
        return f"# {name} =", note
    is_usual = value in (declared.field.default, about.get("filled_in"), {})
    optional = not declared.is_required and is_usual and name != "kind"
    return f"{'# ' if optional else ''}{name} = {toml_value(value)}", note


def choices(recipe: type, path: str = "") -> dict[str, dict[str, type]]:
    """Tables that have several kinds, or that a template leaves out by default: dotted key -> kind -> its dataclass.

    An optional table has the single kind "".
    """
    tables_by_key: dict[str, dict[str, type]] = {}
    for declared in fields_of(recipe).values():
        tables, key = declared.tables, path + declared.name
        if str in declared.shape.options:
            # A table with a name, such as a motor, is given by its name.
            continue
        kinds = {kind_of(table): table for table in tables if kind_of(table)}
        is_shown = bool(declared.about.get("examples", [None])[0])
        if len(kinds) > 1:
            tables_by_key[key] = kinds
        elif tables and not is_shown and (declared.field.default is None or declared.is_rows):
            tables_by_key[key] = {"": tables[0]}
        elif len(tables) == 1:
            tables_by_key |= choices(tables[0], f"{key}.")
    return tables_by_key


def chosen_tables(recipe: type, options: Iterable[str]) -> dict[str, str]:
    """Dotted key -> kind of each table that options such as `follower=oscillating-roller` or `stock.web` name.

    The end of a key stands for all keys with this end. DesignError if there is no such table or kind.
    """
    offered = choices(recipe)
    chosen: dict[str, str] = {}
    for option in options:
        end, _, kind = option.partition("=")
        keys = [key for key in offered if key == end or key.endswith(f".{end}")]
        if not keys:
            short = {key.rsplit(".", 1)[-1]: key for key in offered}
            known = f"{kind_of(recipe)} has {', '.join(short) or 'none'}"
            raise DesignError(
                "--with",
                f"no such table: {printable(end)}",
                did_you_mean(end, [*short, *offered]) + known,
                "unknown-key",
            )
        for key in keys:
            kinds = offered[key]
            if kind not in kinds:
                remedy = f"give {' or '.join(f'{end}={k}' if k else end for k in kinds)}"
                raise DesignError(
                    "--with", f"found {printable(option)}", did_you_mean(kind, kinds) + remedy, "unknown-kind"
                )
            chosen[key] = kind
    return chosen
