"""One combination of a sweep worked out, from plain data to plain data, so that any process can do it."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..build import naming
from ..check import Check
from ..errors import DesignError, GeomkinError, printable, shown
from ..kinds import KINDS
from ..plane.vec import Real
from ..progress import shown as told_to
from ..recipe.explain import nearest
from ..recipe.load import told
from ..recipe.recipe import AbstractRecipe
from .values import with_values

# What is told of a table's column, and how it is found among its values that are not nan.
WAYS: dict[str, Callable[[Real], float]] = {"least": np.min, "largest": np.max, "last": lambda values: values[-1]}
# What any number that is told of stays below; a larger whole number is no float.
LARGEST_NUMBER = 1e300
# Bytes of a file that a recipe names; see `beside`.
LARGEST = 10_000_000


@dataclass(frozen=True)
class Task:
    """What is the same for all combinations. recipe: its table as TOML gives it; folder: where files it names lie."""

    recipe: Mapping[str, Any]
    file: str
    folder: str
    tell: tuple[str, ...]

    def opened(self, changes: Mapping[str, Any]) -> AbstractRecipe:
        """The recipe with these changes. Raises what `gk.load` does, and DesignError for a key that leads nowhere."""
        return told(KINDS, with_values(self.recipe, changes), self.file, self.folder)


def worked_out(task: Task, several: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """What came of each of several combinations, as JSON has it; nothing that one does ends the others."""
    return [_worked_out(task, changes) for changes in several]


def _worked_out(task: Task, changes: Mapping[str, Any]) -> dict[str, Any]:
    row: dict[str, Any] = {"refused": "", "checks": [], "told": {}}
    try:
        # Whoever watches a sweep is told of its combinations, and not of what each is busy with.
        with told_to(lambda *_: None):
            recipe = task.opened(changes)
            with naming(task.file, recipe):
                checks = [[c.name, float(c.value), c.side, float(c.limit), c.unit] for c in recipe.checks]
                row |= {"checks": checks, "told": {name: _told(recipe, name) for name in task.tell}}
    except GeomkinError as error:
        first = str(error).split("\n")[0]
        row["refused"] = first.removeprefix(f"{printable(task.file)}: ")
    except MemoryError:
        row["refused"] = "not enough memory"
    except Exception as error:
        row["refused"] = f"geomkin failed by a fault of its own ({printable(error, 200)}); please report it"
    return row


def is_row(task: Task, row: Any) -> bool:
    """Whether a row that a file has kept is such as `worked_out` gives."""
    if not isinstance(row, dict) or row.keys() != {"refused", "checks", "told"}:
        return False
    refused, checks, told = row["refused"], row["checks"], row["told"]
    if not (isinstance(refused, str) and isinstance(checks, list) and isinstance(told, dict)):
        return False
    try:
        judged = [Check(*check) for check in checks]
    except (TypeError, DesignError):
        return False
    texts = [refused, *(text for check in judged for text in (check.name, check.unit))]
    texts += [value for value in told.values() if isinstance(value, str)]
    numbers = [value for value in told.values() if value is not None and not isinstance(value, str)]
    return (
        told.keys() <= set(task.tell)
        and all(map(str.isprintable, texts))
        and all(isinstance(number, float) for check in judged for number in (check.value, check.limit))
        and all(isinstance(value, (int, float)) and not abs(value) > LARGEST_NUMBER for value in numbers)
    )


def check_tell(task: Task, recipe: AbstractRecipe) -> None:
    """Refuse what the first recipe that works knows nothing of, with the nearest of what it knows."""
    for name in task.tell:
        column, colon, way = name.rpartition(":")
        if colon and way in WAYS:
            known = [c.header for c in recipe.table.columns if c.values.dtype.kind in "fiub"]
            found, what = column in known, f"columns: {', '.join(known)}"
        else:
            column, known = name, list(_entries("", recipe.notes))
            entries = f", or one of {', '.join(known)}" if known else ""
            found, what = name in known, f"COLUMN:{', COLUMN:'.join(WAYS)}{entries}"
        if not found:
            raise DesignError("tell", f"found {shown(name)}", f"{nearest(column, known)}give {what}")


def _told(recipe: AbstractRecipe, name: str) -> Any:
    """A column's least, largest or last value that is not nan, or an entry of the notes; None where there is none."""
    column, colon, way = name.rpartition(":")
    if not (colon and way in WAYS):
        return _entries("", recipe.notes).get(name)
    held = next((c.values for c in recipe.table.columns if c.header == column), np.empty(0))
    values = np.asarray(held, dtype=float)
    known = ~np.isnan(values)
    # The last row's own: where it cannot be, nothing came last.
    if not known.any() or (way == "last" and not known[-1]):
        return None
    return float(WAYS[way](values[known]))


def _entries(path: str, held: Mapping[str, object]) -> dict[str, Any]:
    """Numbers, texts and yes or no among the notes, by dotted name."""
    found: dict[str, Any] = {}
    for name, value in held.items():
        key = f"{path}{name}"
        value = value.item() if isinstance(value, np.generic) else value
        if isinstance(value, Mapping):
            found |= _entries(f"{key}.", value)
        elif isinstance(value, (str, int, float)):
            found[key] = value
    return found


def file_marks(held: object, folder: str) -> list[str]:
    """Digests of the files that texts of a recipe name: a change of one is a change of the recipe."""
    if isinstance(held, Mapping):
        return [mark for value in held.values() for mark in file_marks(value, folder)]
    if isinstance(held, (list, tuple)):
        return [mark for value in held for mark in file_marks(value, folder)]
    if not isinstance(held, str) or not held or len(held) > 1000:
        return []
    try:
        home = Path(folder).resolve()
        path = (home / held).resolve()
        if not path.is_relative_to(home) or not path.is_file() or path.stat().st_size > LARGEST:
            return []
        return [hashlib.sha256(path.read_bytes()).hexdigest()]
    except (OSError, ValueError, RuntimeError):
        return []
