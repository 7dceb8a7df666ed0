"""JSON Schema of all recipes, for editors that complete and check TOML."""

from __future__ import annotations

import re
from typing import Any, Literal

from pydantic import TypeAdapter

from .load import Kinds, adapter


def schema(kinds: Kinds) -> dict[str, Any]:
    """A schema in which a wrong key or value is wrong at its own place, not at the whole recipe or segment.

    Which table stands somewhere is told by its `kind` alone: each has its `if` and `then`. Of a plain choice between
    them (`oneOf`) an editor only sees that none fits, and marks the whole.
    """
    inputs: list[tuple[str, Literal["validation"], TypeAdapter[Any]]] = [
        (name, "validation", adapter(kinds[name])) for name in kinds
    ]
    by_kind, shared = TypeAdapter.json_schemas(inputs, title="geomkin recipe")
    for table in shared["$defs"].values():
        table["additionalProperties"] = False
    recipes = _by_kind({name: by_kind[name, "validation"]["$ref"] for name in kinds})
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **_plain(shared), **recipes}


def _by_kind(tables: dict[str, str]) -> dict[str, Any]:
    """A table that is one of several, told apart by its `kind`. tables: the reference to each."""
    return {
        "type": "object",
        "required": ["kind"],
        "properties": {"kind": {"enum": list(tables)}},
        "allOf": [
            {
                "if": {"required": ["kind"], "properties": {"kind": {"const": name}}},
                "then": {"$ref": reference},
            }
            for name, reference in tables.items()
        ],
    }  # fmt: skip


def _plain(node: Any) -> Any:
    """The same without what TOML does not know (null, complex numbers), and with choices told apart by `kind`."""
    if isinstance(node, list):
        return [_plain(part) for part in node]
    if not isinstance(node, dict):
        return node
    node = {key: part if key in ("default", "enum", "const") else _plain(part) for key, part in node.items()}
    # Where a formula is from is for those who read the code.
    if isinstance(node.get("description"), str):
        node["description"] = re.split(r"\n\nSource\b", node["description"])[0]
    # Examples are written as Python has them; templates show them as TOML.
    if isinstance(node.get("examples"), list):
        del node["examples"]
    if "discriminator" in node:
        tables = node.pop("discriminator")["mapping"]
        del node["oneOf"]
        node |= _by_kind(tables)
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
