"""A recipe back to text: TOML that reads as the same recipe, number for number."""

from __future__ import annotations

import json
from typing import Any

from ..arguments import checked
from .load import adapter
from .recipe import AbstractRecipe


@checked
def to_toml(recipe: AbstractRecipe) -> str:
    """The TOML text of a recipe, of which `gk.load` makes an equal one. Files that it reads are named in it."""
    told = adapter(type(recipe)).dump_python(recipe, mode="json")
    plain: list[str] = []
    tables: list[str] = []
    for key, value in _kept(told).items():
        if isinstance(value, dict):
            tables += ["", f"[{key}]", *(f"{_key(name)} = {_toml(held)}" for name, held in value.items())]
        elif isinstance(value, list) and value and all(isinstance(row, dict) for row in value):
            for row in value:
                tables += ["", f"[[{key}]]", *(f"{_key(name)} = {_toml(held)}" for name, held in row.items())]
        else:
            plain.append(f"{key} = {_toml(value)}")
    return "\n".join([*plain, *tables]) + "\n"


def _kept(table: dict[str, Any]) -> dict[str, Any]:
    """Without what is left out, which TOML has no word for, and without empty tables."""
    kept = {key: _kept(value) if isinstance(value, dict) else value for key, value in table.items()}
    return {key: value for key, value in kept.items() if value is not None and value != {}}


def _toml(value: Any) -> str:
    if isinstance(value, dict):
        inside = ", ".join(f"{_key(key)} = {_toml(held)}" for key, held in _kept(value).items())
        return f"{{ {inside} }}"
    if isinstance(value, list):
        return f"[{', '.join(map(_toml, value))}]"
    if isinstance(value, str):
        # JSON's escapes are TOML's, but for the one control character that JSON leaves as it is.
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    return json.dumps(value) if isinstance(value, bool) else repr(value)


def _key(name: str) -> str:
    return name if name.isascii() and name.replace("_", "").replace("-", "").isalnum() else _toml(name)
