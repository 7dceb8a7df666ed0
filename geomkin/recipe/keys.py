"""Values under dotted keys, in the table of a recipe and in its text, which keeps its comments and order."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from typing import Any

import tomlkit
from tomlkit.exceptions import TOMLKitError

from ..core.dotted_keys import key_parts
from ..core.errors import DesignError


def with_values(recipe: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """A recipe's table with other values under dotted keys; missing tables are added.

    Raises DesignError for a key that leads through something that is not a table, or to a row that a list lacks.
    """
    changed: dict[str, Any] = copy.deepcopy(dict(recipe))
    for key, value in changes.items():
        _set(changed, key, copy.deepcopy(value))
    return changed


def edited_text(text: str, changes: Mapping[str, Any]) -> str:
    """A recipe's text with other values under dotted keys; None removes a key or row, the next number adds a row.

    Raises DesignError as `with_values`, and if the text is not TOML.
    """
    try:
        document = tomlkit.parse(text)
        for key, value in changes.items():
            _append_row(document, key)
            _set(document, key, value)
        return tomlkit.dumps(document)
    except (TOMLKitError, RecursionError) as error:
        raise DesignError("", f"the text cannot be edited ({error})", "mend it", "invalid-toml") from None


def _append_row(document: Any, key: str) -> None:
    """Add an empty row if the key is that of the row after a list's last one."""
    *way, last = _parts(key)
    place, parent = document, None
    for part in way:
        is_table = isinstance(place, Mapping)
        place, parent = (place.get(part) if is_table else None), place
    if last == 0 and place is None and isinstance(parent, Mapping):
        parent[way[-1]] = [{}]  # type: ignore[index]
    elif isinstance(place, list) and last == len(place):
        place.append({})


def _set(table: Any, key: str, value: Any) -> None:
    *way, last = _parts(key)
    place = table
    for part in way:
        _check_step(key, place, part)
        if value is None and not isinstance(part, int) and part not in place:
            return
        place = place[part] if isinstance(part, int) else place.setdefault(part, {})
    _check_step(key, place, last)
    if value is not None:
        place[last] = value
    elif isinstance(last, int) or last in place:
        del place[last]


def _parts(key: str) -> list[str | int]:
    parts = key_parts(key)
    if not parts:
        raise DesignError(key, "found an empty key", "give one such as gear.teeth or program[0].rise", "unknown-key")
    return parts


def _check_step(key: str, place: Any, part: str | int) -> None:
    """Refuse one part of a key that leads through something that is not a table, or to a row that a list lacks."""
    kind, what = (list, "list") if isinstance(part, int) else (Mapping, "table")
    if not isinstance(place, kind):
        raise DesignError(
            key, f"there is no {what} that [{part}] could be of", "give a key of the recipe", "unknown-key"
        )
    if isinstance(part, int) and part >= len(place):
        raise DesignError(
            key, f"found [{part}], but there are {len(place)}, from [0]", "give a smaller number", "out-of-range"
        )
