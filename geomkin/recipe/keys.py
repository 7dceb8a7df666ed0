"""Changes of values by dotted key, in the table of a recipe, and in its text with its comments and order kept."""

from __future__ import annotations

import copy
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import tomlkit
from tomlkit.exceptions import TOMLKitError
from tomlkit.items import AoT

from ..core.errors import DesignError, RecipeError, shown
from ..core.field_visitor import key_parts
from ..core.names import Folder
from ..core.records import record
from .load import from_table, to_toml
from .recipe import AbstractRecipe
from .toml import parsed, table_of


def with_values(recipe: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """A recipe's table with other values under dotted keys; missing tables are added.

    Raises DesignError for a key that leads through something that is not a table, or to a row that a list lacks.
    """
    changed: dict[str, Any] = copy.deepcopy(dict(recipe))
    for key, value in changes.items():
        _set(changed, key, copy.deepcopy(value))
    return changed


def with_added(recipe: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """The same, also if a key names the row after the last one of a list."""
    changed: dict[str, Any] = copy.deepcopy(dict(recipe))
    for key, value in changes.items():
        _make_room(changed, key, copy.deepcopy(value))
        _set(changed, key, copy.deepcopy(value))
    return changed


def edited_text(text: str, changes: Mapping[str, Any]) -> str:
    """A recipe's text with other values under dotted keys; None removes a key or row.

    The index after the last row of a list adds a row.

    Raises RecipeError if the text is not TOML, and DesignError as `with_values` and for a row of tables that is to be
    something else.
    """
    try:
        document = tomlkit.parse(text)
        for key, value in changes.items():
            if value is not None:
                _make_room(document, key, value)
            _set(document, key, value)
        return tomlkit.dumps(document)
    except (TOMLKitError, RecursionError) as error:
        # Its problem names what is wrong in the line.
        parsed(text)
        raise DesignError("", f"the text cannot be edited ({error})", "correct it", "invalid-toml") from None


def _make_room(document: Any, key: str, value: Any) -> None:
    """Add a row if the key names the row after the last one of a list."""
    *parents, last = _parts(key)
    table, parent = document, None
    for part in parents:
        is_table = isinstance(table, Mapping)
        table, parent = (table.get(part) if is_table else None), table
    if isinstance(table, AoT) and not isinstance(value, Mapping):
        raise DesignError(key, f"found {shown(value)}", "give a table", "wrong-type")
    if last == 0 and table is None and isinstance(parent, Mapping):
        parent[parents[-1]] = [value]  # type: ignore[index]
    elif isinstance(table, list) and last == len(table):
        table.append(value)


def _set(table: Any, key: str, value: Any) -> None:
    *parents, last = _parts(key)
    for part in parents:
        _check_step(key, table, part)
        if value is None and not isinstance(part, int) and part not in table:
            return
        table = table[part] if isinstance(part, int) else table.setdefault(part, {})
    _check_step(key, table, last)
    if value is not None:
        table[last] = value
    elif isinstance(last, int) or last in table:
        del table[last]


def _parts(key: str) -> list[str | int]:
    parts = key_parts(key)
    if not parts:
        raise DesignError(key, "found an empty key", "give one such as gear.teeth or program[0].rise", "unknown-key")
    return parts


def _check_step(key: str, table: Any, part: str | int) -> None:
    """DesignError if a part of a key leads through something that is not a table, or to a row that a list lacks."""
    kind, what = (list, "list") if isinstance(part, int) else (Mapping, "table")
    if isinstance(table, str) and f".recipe.{part}" in key:
        remedy = "give the recipe of that file as a table in this one, or use that file itself"
        raise DesignError(key, f"is a key of the file {shown(table)}", remedy, "unknown-key")
    if not isinstance(table, kind):
        raise DesignError(key, f"[{part}] is not inside a {what}", "give a key of the recipe", "unknown-key")
    if isinstance(part, int) and part >= len(table):
        problem = f"found [{part}], but the list has {len(table)}, from [0]"
        raise DesignError(key, problem, "give a smaller number", "out-of-range")


@record
class VariedRecipe:
    """A recipe's table as TOML gives it, its name in messages, and the folder of the files that it names, or these."""

    recipe: Mapping[str, Any]
    file: str
    folder: Folder

    def opened(self, changes: Mapping[str, Any]) -> AbstractRecipe:
        """The recipe with these changes. Raises the errors of `gk.load`, and DesignError for an impossible key."""
        return from_table(with_values(self.recipe, changes), self.file, self.folder)

    def copies(self, folder: Path) -> dict[str, bytes]:
        """The files that the recipe names, for copies of it in a folder; none if that is the folder of the recipe."""
        if isinstance(self.folder, str) and Path(self.folder).resolve() == folder.resolve():
            return {}
        return {name: text.encode() for name, text in self.opened({}).sources.items()}

    def check_keys(self, changes: Mapping[str, Any]) -> None:
        """Raise DesignError for a key that the kind of recipe does not have, with the message of `gk.load`."""
        try:
            self.opened(changes)
        except RecipeError as error:
            for problem in error.problems:
                asked = any(
                    key.startswith(problem.key) and key[len(problem.key) :][:1] in ("", ".", "[") for key in changes
                )
                if problem.id == "unknown-key" and asked:
                    raise DesignError(problem.key, problem.problem, problem.remedy, problem.id, problem.value) from None


def varied(source: AbstractRecipe | str | Path | Mapping[str, Any]) -> tuple[VariedRecipe, str]:
    """A recipe, or anything that `gk.load` reads, and the name of its files."""
    folder: Folder = str(Path.cwd())
    if isinstance(source, AbstractRecipe):
        data, file, name = tomllib.loads(to_toml(source)), source.name or source.kind, source.name
        folder = source.sources or folder
    elif isinstance(source, Mapping):
        data, file, name = dict(source), "recipe", ""
    elif isinstance(source, str) and "\n" in source:
        data, file, name = parsed(source), "recipe", ""
    else:
        path = Path(source)
        # Other processes may work in other folders.
        return VariedRecipe(table_of(path), str(path), str(path.absolute().parent)), path.stem
    return VariedRecipe(data, file, folder), name or str(data.get("kind", "recipe"))
