"""Names that a person chooses: plain enough to stand in a file name, a layer, a column and a message."""

from __future__ import annotations

import csv
import re
import unicodedata
from collections.abc import Iterable
from functools import lru_cache
from pathlib import Path

from .errors import DesignError, printable, shown

# Letters of a name. With a word such as `_mechanical_advantage` behind it, it still fits a column and a file.
LONGEST = 40
# Names of which is kept what was found. Fewer, and those of what is made anew over and over are looked at each time.
NAMES = 4096
# Bytes of a file's name: what the common file systems take.
LONGEST_FILE = 255
# What Windows takes for a device, whatever the ending (Microsoft, "Naming Files, Paths, and Namespaces"); it takes
# superscript digits too, which composing makes plain ones.
DEVICES = {"con", "prn", "aux", "nul", "conin$", "conout$"} | {f"{d}{n}" for d in ("com", "lpt") for n in range(10)}
# Categories of Unicode: letters, digits, and the marks that some scripts write on letters.
LETTERS = {"Lu", "Ll", "Lt", "Lm", "Lo", "Nd"}
MARKS = {"Mn", "Mc"}
# Letters by category that show nothing, so that two names would look alike: the Hangul fillers.
UNSEEN = "\u115f\u1160\u3164\uffa0"
ALLOWED = f"letters, digits, spaces, _ and -, beginning with a letter or digit, at most {LONGEST} letters"


def check_names(field: str, names: Iterable[str], what: str) -> None:
    """Raise DesignError unless every name is plain and no two differ only by case.

    field: the size that holds them; what: what they name, for the message. Plain are letters and digits of any
    script, space, `_` and `-`, first a letter or digit, no space at the end, at most 40, and no word that Windows
    takes for a device.
    """
    seen: dict[str, str] = {}
    for name in names:
        flaw = _flaw(name)
        if flaw:
            raise DesignError(field, f"{what} is named {shown(name)}, which {flaw}", f"give {ALLOWED}", "out-of-range")
        twin = seen.setdefault(folded(name), name)
        if twin != name:
            problem = f"{shown(twin)} and {shown(name)} differ only by case or look the same"
            raise DesignError(
                field, problem, "give names that differ, since some file systems take these for one", "conflict"
            )


@lru_cache(NAMES)
def folded(name: str) -> str:
    """The name as a file system compares it that knows neither case nor how letters are composed."""
    return unicodedata.normalize("NFKC", unicodedata.normalize("NFKC", name).casefold())


def _flaw(name: object) -> str:
    """Why this is no plain name; empty for one."""
    if not isinstance(name, str):
        return "is no text"
    if not name:
        return "is empty"
    if len(name) > LONGEST:
        return f"has {len(name)} letters"
    return _letters_flaw(name)


@lru_cache(NAMES)
def _letters_flaw(name: str) -> str:
    """The same of a text that is neither empty nor too long."""
    for before, letter in zip(f" {name}", name):
        if not (is_letter(letter, before) or letter in " _-"):
            return f"has the sign {shown(letter)}"
    if not is_letter(name[0]):
        return f"begins with {shown(name[0])}"
    if name[-1] == " ":
        return "ends with a space"
    if folded(name) in DEVICES:
        return "Windows takes for a device"
    return ""


def is_letter(letter: str, before: str = "") -> bool:
    """Whether it is a letter or digit of any script that shows, or a mark on the one `before` it."""
    category = unicodedata.category(letter)
    on_letter = bool(before) and unicodedata.category(before) in LETTERS | MARKS
    return letter not in UNSEEN and (category in LETTERS or (category in MARKS and on_letter))


def file_name_flaw(name: str) -> str:
    """Why a name would not make one visible file in the folder it is meant for, on any system; empty where it would.

    A file that a person named may hold dots, brackets and signs that the names inside a recipe may not.
    """
    if not name or set(name) <= {"."}:
        return "it would name another folder"
    if len(name.encode("utf-8", "surrogatepass")) > LONGEST_FILE:
        return "it is too long"
    bad = next((c for c in name if c in '/\\:*?"<>|' or not c.isprintable()), None)
    if bad is not None:
        return f"it has the sign {shown(bad)}, which is no part of a file's name everywhere"
    if name[0] in ".- " or name[-1] in ". ":
        return f"it begins or ends with {shown(name[0] if name[0] in '.- ' else name[-1])}"
    if folded(name).split(".")[0].rstrip(" ") in DEVICES:
        return "Windows takes it for a device"
    return ""


# Bytes of a file at most. A larger one is something else by mistake, and may fill the memory.
LARGEST = 10_000_000
# A number with a decimal comma, as spreadsheets write it where a comma stands for the point.
WITH_COMMA = re.compile(r"\s*[-+]?\d*,\d+(?:[eE][-+]?\d+)?\s*")


def text_beside(name: str | Path, folder: str | Path | None, what: str) -> str:
    """The text of a file, UTF-8, refused under the field `file`.

    folder: it must lie there or below, and be no link that leads out; None, as from a script: anywhere. what: the
    file that is to be given instead, such as "a CSV file".
    """
    try:
        home = Path(folder or ".").resolve()
        path = (home / name).resolve()
        if folder is not None and not path.is_relative_to(home):
            problem = f"found {shown(str(name))}, which lies outside the folder that names it"
            raise DesignError(
                "file", problem, "put it beside the recipe or below, itself and not a link to it", "file-unreadable"
            )
        if not path.is_file():
            raise FileNotFoundError(0, "it is no file")
        with path.open("rb") as file:
            content = file.read(LARGEST + 1)
        if len(content) > LARGEST:
            raise OSError(0, f"it is larger than {LARGEST:,} bytes")
        # As spreadsheets save it, with a mark at the start.
        return content.decode("utf-8-sig")
    except DesignError:
        raise
    except (OSError, ValueError, RuntimeError) as error:
        # A name with a zero byte is a ValueError, a link that leads to itself a RuntimeError.
        told = "it is not UTF-8 text" if isinstance(error, UnicodeDecodeError) else "it is no file's name"
        reason = (error.strerror if isinstance(error, OSError) else None) or told
        raise DesignError(
            "file", f"{printable(name)} cannot be read ({reason})", f"give {what}", "file-unreadable"
        ) from None


def csv_cells(text: str, name: str | Path) -> list[list[str]]:
    """The cells of a CSV file, line by line; refused under the field `file`.

    Semicolons separate them if the first line that is not empty has one, commas if not. Decimal commas of a file with
    semicolons become points.
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
