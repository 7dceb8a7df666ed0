"""Files that a recipe names: they lie beside it or below, are files, and are of bearable size."""

from __future__ import annotations

import csv
import re
from pathlib import Path

from .errors import DesignError, printable, shown

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
            raise DesignError("file", problem, "put it beside the recipe or below, itself and not a link to it")
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
        raise DesignError("file", f"{printable(name)} cannot be read ({reason})", f"give {what}") from None


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
        raise DesignError("file", f"{printable(name)} is not CSV ({error})", "give a CSV file") from None
    if separator == ",":
        return cells
    return [[cell.replace(",", ".") if WITH_COMMA.fullmatch(cell) else cell for cell in line] for line in cells]
