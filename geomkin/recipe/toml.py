"""TOML: texts and files to tables, and values to text."""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path
from typing import Any

from ..core.errors import FileError, Problem, ProblemId, RecipeError, printable

# Largest recipe, bytes. A larger file is no recipe, and may take minutes to parse.
LARGEST = 500_000
# A key with at least a hundred parts, bare or quoted, more than any recipe has. A match must not start inside a word or
# after a backslash, or the search would read the same parts many times.
DEEP_KEY = re.compile(r"""(?<![\w\\-])(?:(?:[\w-]++|"(?:[^"\\\n]|\\.)*+"|'[^'\n]*+')[ \t]*+\.[ \t]*+){100}""")


def table_of(path: Path) -> dict[str, Any]:
    """The table of a TOML file. Raises FileError, and RecipeError if it is not TOML."""
    return parsed(_text(path), str(path))


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
        from .reader import toml_mistake

        mistake = toml_mistake(text, str(error))
        if mistake:
            raise RecipeError(file, [mistake]) from None
        complaint = str(error).replace("Cannot overwrite a value", "a key is given twice")
        problem = f"it is not TOML: {printable(complaint, 200)}"
        raise _whole(file, problem, "correct this line", "invalid-toml") from None


def _text(path: Path) -> str:
    try:
        if not path.is_file():
            raise FileNotFoundError(0, "it is not a file")
        with path.open("rb") as file:
            content = file.read(LARGEST + 1)
    except OSError as error:
        problem = f"cannot be read ({error.strerror})"
        remedy = "give a recipe file, or in Python a text of several lines"
        raise FileError(path, problem, remedy, "file-unreadable") from error
    if len(content) > LARGEST:
        problem = f"it is larger than {LARGEST:,} bytes"
        raise _whole(str(path), problem, "give a recipe, a short TOML file", "too-much-work")
    try:
        return content.decode("utf-8-sig").replace("\r\n", "\n")
    except UnicodeDecodeError as error:
        problem = f"byte {error.start} is not UTF-8"
        raise _whole(str(path), problem, "save it as UTF-8 text", "file-unreadable") from None


def _whole(file: str, problem: str, remedy: str, id: ProblemId) -> RecipeError:
    return RecipeError(file, [Problem("", problem, remedy, id)])


def without_none(table: dict[str, Any], with_empty: bool = True) -> dict[str, Any]:
    """The table without None, which TOML cannot write, and without empty tables and lists unless `with_empty`."""
    return {key: value for key, value in table.items() if value is not None and (with_empty or value not in ({}, []))}


def toml_value(value: Any) -> str:
    """The TOML text of a value inside a line."""
    match value:
        case dict():
            inside = ", ".join(f"{toml_key(key)} = {toml_value(item)}" for key, item in without_none(value).items())
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


def toml_key(name: str) -> str:
    """A key as TOML writes it, in quotes if it needs them."""
    return name if name.isascii() and name.replace("_", "").replace("-", "").isalnum() else toml_value(name)
