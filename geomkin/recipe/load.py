"""A recipe file to its frozen dataclass, or all that is wrong with it at once."""

from __future__ import annotations

import re
import tomllib
from functools import cache
from pathlib import Path
from typing import Any, Literal

from pydantic import TypeAdapter, ValidationError

from ..errors import FileError, Problem, RecipeError, printable, shown
from .explain import explain, nearest
from .kinds import KINDS, kind

# No recipe comes near this, in bytes; a larger file is something else by mistake.
LARGEST = 10_000_000


def load(file: str | Path) -> Any:
    """The recipe in a TOML file, as the dataclass of its kind.

    Raises FileError where the file cannot be read, and RecipeError with every problem, key by key.
    """
    path = Path(file)
    return parse(_read(path), str(file), str(path.parent))


def parse(text: str, file: str = "recipe", folder: str = ".") -> Any:
    """The recipe in a TOML text; `file` is what messages call it, `folder` where files that it names lie, or below."""
    # The reader's time grows with the square of a key's parts.
    if re.search(r"(?<![\w\"'-])(?:[\w\"'-]++[ \t]*+\.[ \t]*+){100}", text):
        raise _whole(file, "a key has more than a hundred parts", "give keys at most three deep")
    try:
        data = tomllib.loads(text)
    except RecursionError:
        raise _whole(file, "it nests too deep", "give tables at most three deep") from None
    except ValueError as error:
        raise _whole(file, f"it is not TOML: {printable(error, 200)}", "mend the line named") from None
    name = data.get("kind")
    if not isinstance(name, str) or name not in KINDS:
        found = "is missing" if "kind" not in data else f"found {shown(name)}"
        hint = nearest(name, KINDS) if isinstance(name, str) else ""
        raise RecipeError(file, [Problem("kind", found, f"give one of {', '.join(KINDS)}{hint}")])
    try:
        return adapter(name).validate_python(data, extra="forbid", context={"folder": folder})
    except ValidationError as error:
        raise RecipeError(file, explain(error, kind(name).recipe)) from None


@cache
def adapter(name: str) -> TypeAdapter:
    """Validator and serialiser of a kind's recipes."""
    return TypeAdapter(kind(name).recipe)


def schema() -> dict:
    """JSON Schema of all recipes, for editors that complete and check TOML."""
    inputs: list[tuple[str, Literal["validation"], TypeAdapter]] = [(k, "validation", adapter(k)) for k in KINDS]
    by_kind, shared = TypeAdapter.json_schemas(inputs, title="geomkin recipe")
    for table in shared["$defs"].values():
        table["additionalProperties"] = False
    return shared | {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "oneOf": [by_kind[name, "validation"] for name in KINDS],
    }


def _read(path: Path) -> str:
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
