"""CSV read back by the standard library: the motion, and the bill against the parts."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ..model.part import Bought, Part
from ..model.table import Table
from .drawing import LARGEST, UnreadableError

# Relative difference of numbers that were written with ten digits, and absolute one as a share of the column's size.
CLOSE, NOISE = 2e-9, 1e-10


def read_cells(path: Path) -> list[list[str]]:
    """The cells of a CSV file, line by line; UnreadableError if it is not CSV."""
    with path.open("rb") as file:
        content = file.read(LARGEST + 1)
    if len(content) > LARGEST:
        raise UnreadableError(f"it has more than {LARGEST:,} bytes")
    try:
        rows = list(csv.reader(content.decode("utf-8").splitlines()))
    except (UnicodeDecodeError, csv.Error) as fault:
        raise UnreadableError(f"it is not CSV ({type(fault).__name__})") from None
    if not rows or any(len(row) != len(rows[0]) for row in rows):
        raise UnreadableError("its rows have different numbers of cells")
    return rows


def motion_problems(path: Path, table: Table) -> list[str]:
    """Differences between a CSV file and the table of its recipe, a sentence each."""
    header, *rows = read_cells(path)
    expected = {column.header: column.written for column in table.columns}
    if header != list(expected):
        return ["its columns are not those of the recipe"]
    problems = []
    for k, (name, values) in enumerate(expected.items()):
        cells = [row[k] for row in rows]
        if len(cells) != len(values):
            return [f"it has {len(cells)} rows, but the recipe's table has {len(values)}"]
        if np.asarray(values).dtype.kind not in "fiub":
            wrong = [j for j, (cell, value) in enumerate(zip(cells, values)) if cell.lstrip("'") != str(value)]
        else:
            wrong = _wrong_numbers(cells, np.asarray(values, dtype=float))
        if wrong:
            problems.append(f"row {wrong[0] + 2} of {name} is not that of the recipe ({len(wrong)} such rows)")
    return problems


def _wrong_numbers(cells: Sequence[str], values: np.ndarray[tuple[int], np.dtype[np.float64]]) -> list[int]:
    try:
        found = np.array([float(cell) if cell else np.nan for cell in cells])
    except ValueError:
        return [next(k for k, cell in enumerate(cells) if cell and not _is_number(cell))]
    known = np.isfinite(values)
    size = np.abs(values[known]).max(initial=0.0)
    same = np.where(known, np.abs(found - values) <= CLOSE * np.abs(values) + NOISE * size + NOISE, np.isnan(found))
    return [int(k) for k in np.flatnonzero(~same)]


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def bill_problems(path: Path, parts: Sequence[Part], bought: Sequence[Bought]) -> list[str]:
    """Differences between a bill of materials and the parts and bought items, a sentence each."""
    header, *rows = read_cells(path)
    try:
        item, count = header.index("item"), header.index("count")
        listed = [(row[item].lstrip("'"), int(row[count])) for row in rows]
    except ValueError:
        return ["it has no columns of items and counts"]
    expected = [(part.name, part.count) for part in parts] + [(item.name, item.count) for item in bought]
    missing = [line for line in expected if line not in listed]
    further = [line for line in listed if line not in expected]
    return [f"it lacks {count} x {name}" for name, count in missing] + [
        f"it has {count} x {name}, which the recipe does not have" for name, count in further
    ]
