"""A text or a table to a recipe, or all that is wrong with it at once."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from ..errors import DesignError, FileError, Problem, RecipeError, printable, shown
from ..scaling import scaled
from ..sizes import KindTable
from .recipe import AbstractRecipe

# No recipe comes near this, in bytes; a larger file is something else by mistake, and may take minutes to read.
LARGEST = 500_000
# A key with so many parts, bare or quoted, that no recipe has it. A start inside a word or after a backslash would
# read the same parts again and again.
DEEP_KEY = re.compile(r"""(?<![\w\\-])(?:(?:[\w-]++|"(?:[^"\\\n]|\\.)*+"|'[^'\n]*+')[ \t]*+\.[ \t]*+){100}""")


Kinds = Mapping[str, type[AbstractRecipe]]


def read(kinds: Kinds, path: Path) -> AbstractRecipe:
    """The recipe in a TOML file, called as the file is.

    Raises FileError where the file cannot be read, and RecipeError with every problem, key by key.
    """
    return told(kinds, table_of(path), str(path), str(path.parent)).called(path.stem)


def table_of(path: Path) -> dict[str, Any]:
    """What a TOML file holds, as yet no recipe. Raises FileError, and RecipeError where it is not TOML."""
    return parsed(_text(path), str(path))


def parse(kinds: Kinds, text: str, file: str = "recipe", folder: str = ".") -> AbstractRecipe:
    """The recipe in a TOML text; `file` is what messages call it, `folder` where files that it names lie, or below."""
    return told(kinds, parsed(text, file), file, folder)


def parsed(text: str, file: str = "recipe") -> dict[str, Any]:
    """What a TOML text holds, as yet no recipe; `file` is what messages call it."""
    # The reader's time grows with the square of a key's parts.
    if DEEP_KEY.search(text):
        raise _whole(file, "a key has more than a hundred parts", "give keys at most three deep")
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise _whole(file, "it nests too deep", "give tables at most three deep") from None
    except ValueError as error:
        # Only what is wrong needs the words for it, here and below.
        from .explain import slip

        slipped = slip(text, str(error))
        if slipped:
            raise RecipeError(file, [slipped]) from None
        raise _whole(file, f"it is not TOML: {printable(error, 200)}", "mend the line named") from None


def told(kinds: Kinds, data: Mapping[str, Any], file: str = "recipe", folder: str = ".") -> AbstractRecipe:
    """The recipe in a table as TOML gives it: tables as dicts, points as [x, y]."""
    name = data.get("kind")
    if not isinstance(name, str) or name not in kinds:
        from .explain import nearest

        found = "is missing" if "kind" not in data else f"found {shown(name)}"
        inner = {table: held.get("kind") for table, held in data.items() if isinstance(held, dict)}
        held = next((table for table, named in inner.items() if isinstance(named, str) and named in kinds), None)
        near = f"it stands under [{printable(held)}]: put it above the first table; " if held else nearest(name, kinds)
        raise RecipeError(file, [Problem("kind", found, f"{near}give one of {', '.join(kinds)}")])
    kind = kinds[name]
    # A key of the text alone: what it makes of the lengths is the recipe.
    fields = {key: value for key, value in data.items() if key != "scale" or not kind.can_be_scaled}
    try:
        recipe = adapter(kind).validate_python(fields, extra="forbid", context={"folder": folder})
    except ValidationError as error:
        from .explain import explain

        raise RecipeError(file, explain(error, kind)) from None
    try:
        return scaled(recipe, data.get("scale", 1.0)) if kind.can_be_scaled else recipe
    except DesignError as error:
        raise RecipeError(file, [Problem(error.field, error.problem, error.remedy)]) from None


def adapter(recipe: type[AbstractRecipe]) -> TypeAdapter[AbstractRecipe]:
    """Validator and serialiser of a kind's recipes, with the rows that tables of kinds have by now."""
    return _adapter(recipe, KindTable.changes)


@cache
def _adapter(recipe: type[AbstractRecipe], changes: int) -> TypeAdapter[AbstractRecipe]:
    return TypeAdapter(recipe)


def _text(path: Path) -> str:
    try:
        if not path.is_file():
            raise FileNotFoundError(0, "it is no file")
        with path.open("rb") as file:
            content = file.read(LARGEST + 1)
    except OSError as error:
        raise FileError(f"{printable(path)}: cannot be read ({error.strerror}); give a recipe file") from error
    if len(content) > LARGEST:
        raise _whole(str(path), f"it is larger than {LARGEST:,} bytes", "give a recipe, a short TOML file")
    try:
        return content.decode("utf-8-sig").replace("\r\n", "\n")
    except UnicodeDecodeError as error:
        raise _whole(str(path), f"byte {error.start} is not UTF-8", "save it as UTF-8 text") from None


def _whole(file: str, problem: str, remedy: str) -> RecipeError:
    return RecipeError(file, [Problem("", problem, remedy)])
