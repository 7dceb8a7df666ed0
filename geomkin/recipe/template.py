"""A recipe to start from: every key with its meaning, written from the same declarations that validate it."""

from __future__ import annotations

import dataclasses
import textwrap
from typing import Any, Literal, get_args, get_origin, get_type_hints

from ..sizes import allowed
from .kinds import kind


def template(name: str) -> str:
    """A commented TOML text of a kind that runs as it is; what may be left out stands commented out."""
    head = textwrap.indent(textwrap.fill(kind(name).about, 90), "# ")
    return f"{head}\n" + "\n".join(_table("", example(kind(name).recipe, name))).rstrip() + "\n"


def example(cls: type, name: str | None = None) -> Any:
    """An instance of a dataclass from the examples its fields give."""
    hints = get_type_hints(cls)
    values = {}
    for field in dataclasses.fields(cls):
        shown = field.metadata.get("examples", [None])[0]
        if field.name == "kind":
            values["kind"] = name or field.default
        elif shown is not None and shown is not dataclasses.MISSING:
            values[field.name] = shown
        elif field.default is dataclasses.MISSING:
            values[field.name] = example(hints[field.name])
    return cls(**values)


def _table(path: str, value: Any) -> list[str]:
    """Lines of a table: plain keys first, then its own tables."""
    plain, tables = [], []
    for field in sorted(dataclasses.fields(value), key=lambda f: f.name != "kind"):
        inner = getattr(value, field.name)
        name = f"{path}.{field.name}" if path else field.name
        rows = getattr(inner, "segments", inner)
        if isinstance(rows, tuple | list) and rows and dataclasses.is_dataclass(rows[0]):
            for row in rows:
                tables += ["", f"[[{name}]]", *_table(name, row)]
        elif isinstance(inner, dict) and inner:
            tables += ["", f"[{name}]  # {field.metadata['description']}"]
            tables += [f"{key} = {_toml(held)}" for key, held in inner.items()]
        elif dataclasses.is_dataclass(inner):
            tables += ["", f"[{name}]", *_table(name, inner)]
        else:
            plain.append(_line(field, inner, get_type_hints(type(value))[field.name]))
    width = min(36, max((len(text) for text, _ in plain), default=0))
    return [f"{text:<{width}}  # {note}" if note else text for text, note in plain] + tables


def _line(field: dataclasses.Field, value: Any, hint: Any) -> tuple[str, str]:
    note = field.metadata.get("description", "")
    if "unit" in field.metadata:
        limits = allowed(field.metadata | {"unit": ""}).removeprefix("a number").removeprefix("a whole number").strip()
        note += f"; {limits}" if limits else ""
    elif get_origin(hint) is Literal and len(get_args(hint)) > 1:
        note += "; " + " or ".join(map(str, get_args(hint)))
    if value is None:
        return f"# {field.name} =", note
    required = field.default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING
    optional = not required and value in (field.default, {}) and field.name != "kind"
    return f"{'# ' if optional else ''}{field.name} = {_toml(value)}", note


def _toml(value: Any) -> str:
    match value:
        case bool():
            return str(value).lower()
        case str():
            return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
        case complex():
            return f"[{value.real:g}, {value.imag:g}]"
        case dict():
            return "{ " + ", ".join(f"{key} = {_toml(held)}" for key, held in value.items()) + " }" if value else "{}"
        case tuple() | list():
            return "[" + ", ".join(map(_toml, value)) + "]"
        case float():
            return f"{value:.12g}"
        case _:
            return str(value)
