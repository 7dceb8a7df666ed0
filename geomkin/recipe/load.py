"""Loads a recipe from a text or table, or raises an error with all its problems; and writes it as text."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Mapping
from dataclasses import fields
from functools import cache
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from ..core.arguments import checked
from ..core.errors import DesignError, FileError, Problem, ProblemId, RecipeError, printable, shown
from ..core.fields import KindTable
from ..core.names import Folder
from ..core.scaling import scaled
from .kinds import kind_names, recipe_class
from .recipe import AbstractRecipe

# Largest recipe, bytes. A larger file is no recipe, and may take minutes to parse.
LARGEST = 500_000
# A key with at least a hundred parts, bare or quoted, more than any recipe has. A match must not start inside a word or
# after a backslash, or the search would read the same parts many times.
DEEP_KEY = re.compile(r"""(?<![\w\\-])(?:(?:[\w-]++|"(?:[^"\\\n]|\\.)*+"|'[^'\n]*+')[ \t]*+\.[ \t]*+){100}""")


def read(path: Path) -> AbstractRecipe:
    """The recipe in a TOML file, with the name of the file.

    Raises FileError if the file cannot be read, and RecipeError with every problem, key by key.
    """
    return from_table(table_of(path), str(path), str(path.parent)).with_name(path.stem)


def table_of(path: Path) -> dict[str, Any]:
    """The table of a TOML file. Raises FileError, and RecipeError if it is not TOML."""
    return parsed(_text(path), str(path))


def parse(text: str, file: str = "recipe", folder: Folder = ".") -> AbstractRecipe:
    """The recipe in a TOML text. file: its name in messages; folder: holds the files that it names."""
    return from_table(parsed(text, file), file, folder)


def parsed(text: str, file: str = "recipe") -> dict[str, Any]:
    """The table of a TOML text. file: its name in messages."""
    # The parser takes a time that grows with the square of the number of parts of a key.
    if DEEP_KEY.search(text):
        raise _whole(file, "a key has a hundred parts or more", "give keys at most three deep", "invalid-toml")
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise _whole(file, "it nests too deep", "give tables at most three deep", "invalid-toml") from None
    except ValueError as error:
        # Imported only for errors, here and below.
        from .messages import toml_mistake

        mistake = toml_mistake(text, str(error))
        if mistake:
            raise RecipeError(file, [mistake]) from None
        raise _whole(file, f"it is not TOML: {printable(error, 200)}", "correct this line", "invalid-toml") from None


def from_table(data: Mapping[str, Any], file: str = "recipe", folder: Folder = ".") -> AbstractRecipe:
    """The recipe in a table as TOML gives it: tables as dicts, points as [x, y]."""
    name = data.get("kind")
    try:
        kind = recipe_class(name if isinstance(name, str) else "")
    except KeyError:
        from .messages import did_you_mean

        id: ProblemId = "unknown-kind" if "kind" in data else "missing-key"
        kinds = kind_names()
        found = "is missing" if "kind" not in data else f"found {shown(name)}"
        inner = {table: value.get("kind") for table, value in data.items() if isinstance(value, dict)}
        owner = next((table for table, kind in inner.items() if isinstance(kind, str) and kind in kinds), None)
        near = f"move it from [{printable(owner)}] above the first table; " if owner else did_you_mean(name, kinds)
        raise RecipeError(file, [Problem("kind", found, f"{near}give one of {', '.join(kinds)}", id)]) from None
    # `scale` is not a field, since the recipe holds the scaled lengths.
    fields = {key: value for key, value in data.items() if key != "scale" or not kind.can_be_scaled}
    try:
        recipe = adapter(kind).validate_python(fields, extra="forbid", context={"folder": folder})
    except ValidationError as error:
        from .messages import explain

        raise RecipeError(file, explain(error, kind)) from None
    try:
        return scaled(recipe, data.get("scale", 1.0)) if kind.can_be_scaled else recipe
    except DesignError as error:
        raise RecipeError(file, [Problem(error.field, error.problem, error.remedy, error.id)]) from None


def adapter(recipe: type[AbstractRecipe]) -> TypeAdapter[AbstractRecipe]:
    """Validator and serialiser of the recipes of a kind, with the current rows of all tables of kinds."""
    return _adapter(recipe, KindTable.changes)


@cache
def _adapter(recipe: type[AbstractRecipe], changes: int) -> TypeAdapter[AbstractRecipe]:
    return TypeAdapter(recipe)


def _text(path: Path) -> str:
    try:
        if not path.is_file():
            raise FileNotFoundError(0, "it is not a file")
        with path.open("rb") as file:
            content = file.read(LARGEST + 1)
    except OSError as error:
        problem = f"cannot be read ({error.strerror})"
        raise FileError(path, problem, "give a recipe file", "file-unreadable") from error
    if len(content) > LARGEST:
        raise _whole(
            str(path), f"it is larger than {LARGEST:,} bytes", "give a recipe, a short TOML file", "too-much-work"
        )
    try:
        return content.decode("utf-8-sig").replace("\r\n", "\n")
    except UnicodeDecodeError as error:
        raise _whole(
            str(path), f"byte {error.start} is not UTF-8", "save it as UTF-8 text", "file-unreadable"
        ) from None


def _whole(file: str, problem: str, remedy: str, id: ProblemId) -> RecipeError:
    return RecipeError(file, [Problem("", problem, remedy, id)])


# Tables down to this depth have a heading, such as `[linkage.bodies]`; deeper ones are written inline.
DEEPEST = 2


@checked
def to_toml(recipe: AbstractRecipe) -> str:
    """Write a recipe as TOML text.

    Parameters
    ----------
    recipe : AbstractRecipe
        The recipe. Keys that have their default value are omitted; files that it reads are named.

    Returns
    -------
    str
        A text from which `gk.load` makes an equal recipe.
    """
    table = adapter(type(recipe)).dump_python(recipe, mode="json")
    usual = {f.name for f in fields(recipe) if f.name != "kind" and getattr(recipe, f.name) == f.default}
    table = {key: value for key, value in table.items() if key not in usual}
    # The mechanism comes first.
    table |= {key: table.pop(key) for key in ("optimise",) if key in table}
    return "\n".join(_table("", table)).lstrip("\n") + "\n"


def _table(path: str, table: dict[str, Any], depth: int = 0) -> list[str]:
    """Lines of a table: its keys with plain values first, then the tables in it."""
    plain: list[str] = []
    tables: list[str] = []
    # Empty tables near the top are already omitted; a deeper one may be a body without points.
    for key, value in _without_none(table, with_empty=depth >= DEEPEST).items():
        name = f"{path}.{_key(key)}" if path else _key(key)
        if isinstance(value, dict) and depth < DEEPEST:
            tables += ["", f"[{name}]", *_table(name, value, depth + 1)]
        elif isinstance(value, list) and value and all(isinstance(row, dict) for row in value) and depth < DEEPEST:
            for row in value:
                tables += ["", f"[[{name}]]", *_table(name, row, DEEPEST)]
        else:
            plain.append(f"{_key(key)} = {toml_value(value)}")
    return [*plain, *tables]


def _without_none(table: dict[str, Any], with_empty: bool = True) -> dict[str, Any]:
    """The table without None, which TOML cannot write, and without empty tables and lists unless `with_empty`."""
    return {key: value for key, value in table.items() if value is not None and (with_empty or value not in ({}, []))}


def toml_value(value: Any) -> str:
    """The TOML text of a value inside a line."""
    match value:
        case dict():
            inside = ", ".join(f"{_key(key)} = {toml_value(item)}" for key, item in _without_none(value).items())
            return f"{{ {inside} }}" if value else "{}"
        case list() | tuple():
            return f"[{', '.join(map(toml_value, value))}]"
        case complex():
            return toml_value([value.real, value.imag])
        case str():
            # JSON's escapes are those of TOML, except for the one control character that JSON does not escape.
            return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
        case bool():
            return json.dumps(value)
        case float() if value.is_integer() and abs(value) < 2**53:
            # People write 100, not 100.0. Beyond 2**53 a whole number could not be read back as the same float.
            return str(int(value))
    return repr(value)


def _key(name: str) -> str:
    return name if name.isascii() and name.replace("_", "").replace("-", "").isalnum() else toml_value(name)
