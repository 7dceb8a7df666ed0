"""A recipe back to text: TOML that reads as the same recipe, number for number."""

from __future__ import annotations

import json
from dataclasses import fields
from typing import Any

from ..arguments import checked
from .load import adapter
from .recipe import AbstractRecipe

# Tables so deep stand in lines of their own, as `[linkage.bodies]`; deeper ones in one line each. More lines would
# tear apart what belongs together, fewer make lines that nobody reads.
DEEPEST = 2


@checked
def to_toml(recipe: AbstractRecipe) -> str:
    """The TOML text of a recipe, of which `gk.load` makes an equal one. Files that it reads are named in it.

    What is as it is where a recipe leaves it out, such as all of `files`, is left out.
    """
    told = adapter(type(recipe)).dump_python(recipe, mode="json")
    usual = {f.name for f in fields(recipe) if f.name != "kind" and getattr(recipe, f.name) == f.default}
    told = {key: value for key, value in told.items() if key not in usual}
    return "\n".join(_table("", told)).lstrip("\n") + "\n"


def _table(path: str, table: dict[str, Any], depth: int = 0) -> list[str]:
    """Lines of a table: what is plain first, then its own tables."""
    plain: list[str] = []
    tables: list[str] = []
    # What is empty so far up was left out; deeper it may be a body without points.
    for key, value in _kept(table, empty=depth >= DEEPEST).items():
        name = f"{path}.{_key(key)}" if path else _key(key)
        if isinstance(value, dict) and depth < DEEPEST:
            tables += ["", f"[{name}]", *_table(name, value, depth + 1)]
        elif isinstance(value, list) and value and all(isinstance(row, dict) for row in value) and depth < DEEPEST:
            for row in value:
                tables += ["", f"[[{name}]]", *_table(name, row, DEEPEST)]
        else:
            plain.append(f"{_key(key)} = {_toml(value)}")
    return [*plain, *tables]


def _kept(table: dict[str, Any], empty: bool = True) -> dict[str, Any]:
    """Without what is left out, which TOML has no word for. empty: whether empty tables and rows are kept."""
    return {key: value for key, value in table.items() if value is not None and (empty or value not in ({}, []))}


def _toml(value: Any) -> str:
    if isinstance(value, dict):
        inside = ", ".join(f"{_key(key)} = {_toml(held)}" for key, held in _kept(value).items())
        return f"{{ {inside} }}"
    if isinstance(value, list):
        return f"[{', '.join(map(_toml, value))}]"
    if isinstance(value, str):
        # JSON's escapes are TOML's, but for the one control character that JSON leaves as it is.
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, bool):
        return json.dumps(value)
    # A size of 100 is written so by people, too; beyond 2**53 a whole number would not be the one that it was.
    return str(int(value)) if isinstance(value, float) and value.is_integer() and abs(value) < 2**53 else repr(value)


def _key(name: str) -> str:
    return name if name.isascii() and name.replace("_", "").replace("-", "").isalnum() else _toml(name)
