"""What a recipe's template can be shown with: tables of another kind, and tables that may be left out."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable
from typing import get_origin, get_type_hints

from ..errors import DesignError, printable
from .explain import kind_of, nearest, tables_in


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


def asked(recipe: type, wishes: Iterable[str]) -> dict[str, str]:
    """Dotted key -> kind of what is asked for, as `follower=oscillating-roller` or `stock.web`, of a recipe's class.

    The end of a key stands for all keys that end so. DesignError for what there is not.
    """
    offered = choices(recipe)
    found: dict[str, str] = {}
    for wish in wishes:
        end, _, which = wish.partition("=")
        keys = [key for key in offered if key == end or key.endswith(f".{end}")]
        if not keys:
            short = {key.rsplit(".", 1)[-1]: key for key in offered}
            known = f"{kind_of(recipe)} has {', '.join(short) or 'none'}"
            raise DesignError("--with", f"no such table: {printable(end)}", nearest(end, [*short, *offered]) + known)
        for key in keys:
            kinds = offered[key]
            if which not in kinds:
                remedy = f"give {' or '.join(f'{end}={k}' if k else end for k in kinds)}"
                raise DesignError("--with", f"found {printable(wish)}", nearest(which, kinds) + remedy)
            found[key] = which
    return found
