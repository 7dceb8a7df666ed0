"""Angles and lifts given as numbers: in the segment itself, or in a CSV file."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from ...errors import DesignError, printable, shown
from ...plane.vec import Array
from ...sizes import FARTHEST
from .segments import LiftTable, Pointed

# Nearly three times a table of 0.1 deg; more takes seconds to fit and tells no more.
MOST_ROWS = 10_000
# Bytes of a CSV file: as many rows of fifty columns.
LARGEST = 10_000_000
ANGLE, LIFTS = "cam_angle_deg", {"lift_mm": False, "lift_deg": True}


def read_rows(segment: Pointed, folder: str | Path | None) -> tuple[str, Array, bool]:
    """The field that has them, (n, 2) angles in deg with lifts, and whether the lifts are in degrees."""
    names = ("rows", "rows_deg", "file") if isinstance(segment, LiftTable) else ("points", "points_deg")
    given = [name for name in names if getattr(segment, name) is not None]
    if len(given) != 1:
        found = "none" if not given else " and ".join(given)
        raise DesignError(names[0], f"of {', '.join(names)} found {found}", "give one of them")
    field = given[0]
    if field == "file":
        points, swings = _from_csv(getattr(segment, field), folder)
        return field, points, swings
    return field, checked_rows(getattr(segment, field), field), field.endswith("_deg")


def checked_rows(rows: object, field: str) -> Array:
    try:
        points = np.array(rows, dtype=float)
        fits = points.dtype.kind == "f" and points.ndim == 2 and points.shape[1] == 2 and len(points) <= MOST_ROWS
        fits = fits and bool((np.abs(points) <= FARTHEST).all())
    except (TypeError, ValueError, OverflowError):
        fits = False
    if not fits:
        raise DesignError(
            field, f"found {shown(rows)}", f"give at most {MOST_ROWS} rows [angle in deg, lift] of numbers"
        )
    return points


def _from_csv(name: object, folder: str | Path | None) -> tuple[Array, bool]:
    if not isinstance(name, str | Path):
        raise DesignError("file", f"found {shown(name)}", "give the name of a CSV file")
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
        text = content.decode("utf-8-sig")
    except DesignError:
        raise
    except (OSError, ValueError, RuntimeError) as error:
        # A name with a zero byte is a ValueError, a link that leads to itself a RuntimeError.
        told = "it is not UTF-8 text" if isinstance(error, UnicodeDecodeError) else "it is no file's name"
        reason = getattr(error, "strerror", None) or told
        raise DesignError("file", f"{printable(name)} cannot be read ({reason})", "give a CSV file") from None
    # Counted first: as lists of numbers a file of this size takes a gigabyte.
    count = text.count("\n")
    if count > MOST_ROWS + 1:
        raise DesignError("file", f"{printable(name)} has {count:,} lines", f"give at most {MOST_ROWS:,} rows")
    try:
        lines = list(csv.reader(text.splitlines()))
    except csv.Error as error:
        raise DesignError("file", f"{printable(name)} is not CSV ({error})", "give a CSV file") from None
    header = [cell.strip() for cell in lines[0]] if lines else []
    lifts = [column for column in LIFTS if column in header]
    if ANGLE not in header or len(lifts) != 1:
        lacking = ANGLE if ANGLE not in header else f"just one of {' and '.join(LIFTS)}"
        raise DesignError(
            "file",
            f"the first line of {printable(name)} does not name {lacking}",
            f"name its columns there: {ANGLE} and one of {' and '.join(LIFTS)}, with commas between",
        )
    columns = header.index(ANGLE), header.index(lifts[0])
    points = []
    for k, line in enumerate(lines[1:], 2):
        if not "".join(line).strip():
            continue
        points.append(
            [_number(line, column, f"line {k} of {printable(name)}, column {column + 1},") for column in columns]
        )
    return checked_rows(points, "file"), LIFTS[lifts[0]]


def _number(line: list[str], column: int, place: str) -> float:
    cell = line[column] if column < len(line) else ""
    try:
        return float(cell)
    except ValueError:
        raise DesignError("file", f"{place} holds {printable(repr(cell), 20)}", "give a number there") from None
