"""Names chosen by users, plain enough for file names, layers, columns and messages; text files named in recipes."""

from __future__ import annotations

import csv
import errno
import os
import re
import unicodedata
from collections.abc import Iterable, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Any

from .arguments import ArgumentType
from .errors import DesignError, printable, shown

# Largest number of letters of a name. With a suffix such as `_mechanical_advantage` it still fits a column and a file.
LONGEST = 40
# Number of checked names in the cache.
NAMES = 4096
# Bytes of a file's name in common file systems.
LONGEST_FILE = 255
# Names of devices in Windows, with any ending (Microsoft, "Naming Files, Paths, and Namespaces"). Superscript digits
# are reserved too; `folded_name` turns them into plain ones.
DEVICES = {"con", "prn", "aux", "nul", "conin$", "conout$"} | {f"{d}{n}" for d in ("com", "lpt") for n in range(10)}
# Names that programs read as a number that is not finite.
NOT_FINITE = {"nan", "inf", "infinity"}
# Categories of Unicode: letters, digits, and combining marks.
LETTERS = {"Lu", "Ll", "Lt", "Lm", "Lo", "Nd"}
MARKS = {"Mn", "Mc"}
# Letters by category that are invisible, so that two names would look alike: the Hangul fillers.
UNSEEN = "\u115f\u1160\u3164\uffa0"
ALLOWED = f"letters, digits, spaces, _ and -, beginning with a letter or digit, at most {LONGEST} letters"


def _is_path(value: Any) -> bool:
    """Whether a value is a path that the file system can look for, whatever is there."""
    if not isinstance(value, (str, Path)):
        return False
    try:
        os.lstat(value)
    except OSError as error:
        return error.errno != errno.ENAMETOOLONG
    except ValueError:
        # A zero byte, or a letter that has no bytes.
        return False
    return True


# A file or folder given as an argument.
PathName = Annotated[
    str | Path, ArgumentType(_is_path, "a path without zero bytes, not longer than the file system allows", (str, Path))
]
# Source of the files that a recipe names: a folder and those below it, any folder (None), or a mapping of name to text.
Folder = str | Path | Mapping[str, str] | None


def check_names(field: str, names: Iterable[str], what: str) -> None:
    """Raise DesignError unless every name is plain and no two differ only by case.

    field: the size that contains them; what: the kind of thing named, for the message. A plain name has letters and
    digits of any script, space, `_` and `-`, begins with a letter or digit, does not end with a space, has at most 40
    letters, and is neither the name of a Windows device nor nan or infinity.
    """
    seen: dict[str, str] = {}
    for name in names:
        flaw = _flaw(name)
        if flaw:
            raise DesignError(field, f"{what} is named {shown(name)}, which {flaw}", f"give {ALLOWED}", "out-of-range")
        same = seen.setdefault(folded_name(name), name)
        if same != name:
            problem = f"{shown(same)} and {shown(name)} differ only by case or look the same"
            remedy = "give names that differ, since some file systems treat these as equal"
            raise DesignError(field, problem, remedy, "conflict")


@lru_cache(NAMES)
def folded_name(name: str) -> str:
    """The name as compared by a file system that ignores case and the composition of letters."""
    return unicodedata.normalize("NFKC", unicodedata.normalize("NFKC", name).casefold())


def _flaw(name: object) -> str:
    """The reason why a name is not plain; empty if it is."""
    if not isinstance(name, str):
        return "is not a text"
    if not name:
        return "is empty"
    if len(name) > LONGEST:
        return f"has {len(name)} letters"
    return _letters_flaw(name)


@lru_cache(NAMES)
def _letters_flaw(name: str) -> str:
    """The reason why a text is not plain, apart from its length."""
    for before, letter in zip(f" {name}", name):
        if not (is_letter(letter, before) or letter in " _-"):
            return f"has the sign {shown(letter)}"
    if not is_letter(name[0]):
        return f"begins with {shown(name[0])}"
    if name[-1] == " ":
        return "ends with a space"
    if folded_name(name) in DEVICES:
        return "is the name of a device in Windows"
    return "reads as a number in tables" if folded_name(name) in NOT_FINITE else ""


def is_letter(letter: str, before: str = "") -> bool:
    """Whether a character is a visible letter or digit of any script, or a combining mark after the letter `before`."""
    category = unicodedata.category(letter)
    on_letter = bool(before) and unicodedata.category(before) in LETTERS | MARKS
    return letter not in UNSEEN and (category in LETTERS or (category in MARKS and on_letter))


def is_visible(text: object) -> bool:
    """Whether a value is a text of one line whose signs are all visible, and do not change how others are shown."""
    return isinstance(text, str) and not any(sign in UNSEEN or not sign.isprintable() for sign in text)


VisibleText = Annotated[str, ArgumentType(is_visible, "a text of visible signs in one line", (str,))]


def is_name(text: object) -> bool:
    """Whether a value is a visible text that is not empty."""
    return is_visible(text) and bool(str(text).strip())


VisibleName = Annotated[str, ArgumentType(is_name, "a text of visible signs in one line, not empty", (str,))]


def file_name_flaw(name: str) -> str:
    """The reason why a name does not make one visible file in its folder on any system; empty if it does.

    A file named by a user may contain dots, brackets and signs that names inside a recipe may not.
    """
    if not name or set(name) <= {"."}:
        return "it would name another folder"
    if len(name.encode("utf-8", "surrogatepass")) > LONGEST_FILE:
        return "it is too long"
    bad = next((c for c in name if c in '/\\:*?"<>|' or not c.isprintable()), None)
    if bad is not None:
        return f"it has the sign {shown(bad)}, which is not allowed in file names on all systems"
    if name[0] in ".- " or name[-1] in ". ":
        return f"it begins or ends with {shown(name[0] if name[0] in '.- ' else name[-1])}"
    if folded_name(name).split(".")[0].rstrip(" ") in DEVICES:
        return "it is the name of a device in Windows"
    return ""


# Largest size of a text file, bytes: a larger one is a mistake and might fill the memory.
LARGEST = 10_000_000
# A number with a decimal comma, as spreadsheets write it in some languages.
WITH_COMMA = re.compile(r"\s*[-+]?\d*,\d+(?:[eE][-+]?\d+)?\s*")


def read_text_file(name: str | Path, folder: Folder, what: str) -> str:
    """The text of a file, UTF-8; DesignError with the field `file` if it cannot be read.

    folder: the file must be in it or below, and not be a link that leads out; None, as from a script: anywhere; or the
    texts of the files by name. what: the expected file for the message, such as "a CSV file".
    """
    if isinstance(folder, Mapping):
        if str(name) not in folder:
            raise DesignError("file", f"{printable(name)} is not there", f"give {what}", "file-unreadable")
        return folder[str(name)]
    try:
        home = Path(folder or ".").resolve()
        path = (home / name).resolve()
        if folder is not None and not path.is_relative_to(home):
            problem = f"found {shown(str(name))}, which is outside the folder of the recipe"
            raise DesignError("file", problem, "put it next to the recipe or below, not as a link", "file-unreadable")
        if not path.is_file():
            raise FileNotFoundError(0, "it is not a file")
        with path.open("rb") as file:
            content = file.read(LARGEST + 1)
        if len(content) > LARGEST:
            raise OSError(0, f"it is larger than {LARGEST:,} bytes")
        # Spreadsheets write a byte order mark at the start.
        return content.decode("utf-8-sig")
    except DesignError:
        raise
    except (OSError, ValueError, RuntimeError) as error:
        # A name with a zero byte is a ValueError, a link that leads to itself a RuntimeError.
        other = "it is not UTF-8 text" if isinstance(error, UnicodeDecodeError) else "it is not a file name"
        reason = (error.strerror if isinstance(error, OSError) else None) or other
        problem = f"{printable(name)} cannot be read ({reason})"
        raise DesignError("file", problem, f"give {what}", "file-unreadable") from None


def csv_cells(text: str, name: str | Path) -> list[list[str]]:
    """The cells of a CSV file, line by line; DesignError with the field `file` if it is not CSV.

    Semicolons separate them if the first line that is not empty has one, otherwise commas. Decimal commas of a file
    with semicolons become points.
    """
    lines = text.splitlines()
    separator = ";" if ";" in next((line for line in lines if line.strip()), "") else ","
    try:
        cells = list(csv.reader(lines, delimiter=separator))
    except csv.Error as error:
        raise DesignError(
            "file", f"{printable(name)} is not CSV ({error})", "give a CSV file", "file-unreadable"
        ) from None
    if separator == ",":
        return cells
    return [[cell.replace(",", ".") if WITH_COMMA.fullmatch(cell) else cell for cell in line] for line in cells]
