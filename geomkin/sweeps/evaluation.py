"""Evaluation of a recipe for combinations of values: its checks and the requested results, as JSON has them."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..build import errors_named_by_key
from ..core.errors import DesignError, GeomkinError, printable, shown
from ..core.progress import progress_to
from ..core.records import record
from ..model.check import Check
from ..plane.vec import Real
from ..recipe.messages import did_you_mean
from ..recipe.recipe import AbstractRecipe
from ..recipe.shown import ShownRecipe
from ..recipe.varied import VariedRecipe

# Values of a column that a result can report, computed from those of its numbers that are not nan.
STATISTICS: dict[str, Callable[[Real], float]] = {"least": np.min, "largest": np.max, "last": lambda values: values[-1]}
# Largest number in a result; a larger integer cannot become a float.
LARGEST_NUMBER = 1e300
# Largest file, in bytes, that a recipe may name.
LARGEST_FILE = 10_000_000


@record
class SweepTask(VariedRecipe):
    """The recipe of a sweep and the requested results."""

    results: tuple[str, ...]


def evaluate(task: SweepTask, batch: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """The row of each combination of a batch; an error in one does not stop the others."""
    return [_evaluate(task, changes) for changes in batch]


def _evaluate(task: SweepTask, changes: Mapping[str, Any]) -> dict[str, Any]:
    row: dict[str, Any] = {"refused": "", "checks": [], "results": {}}
    try:
        # A sweep reports the number of combinations, not the progress of each one.
        with progress_to(lambda *_: None):
            recipe = task.opened(changes)
            with errors_named_by_key(task.file, recipe):
                checks = [
                    [c.id, c.name, float(c.value), c.side, float(c.limit), c.unit] for c in ShownRecipe(recipe).checks
                ]
                row |= {"checks": checks, "results": {name: _result(recipe, name) for name in task.results}}
    except GeomkinError as error:
        first = str(error).split("\n")[0]
        row["refused"] = first.removeprefix(f"{printable(task.file)}: ")
    except MemoryError:
        row["refused"] = "not enough memory"
    except Exception as error:
        row["refused"] = f"internal error ({printable(error, 200)}); please report it with the recipe"
    return row


def is_row(task: SweepTask, row: Any) -> bool:
    """Whether a row read from a file has the form that `evaluate` returns."""
    if not isinstance(row, dict) or row.keys() != {"refused", "checks", "results"}:
        return False
    refused, checks, results = row["refused"], row["checks"], row["results"]
    if not (isinstance(refused, str) and isinstance(checks, list) and isinstance(results, dict)):
        return False
    try:
        design_checks = [Check(*check) for check in checks]
    except (TypeError, DesignError):
        return False
    texts = [refused, *(text for check in design_checks for text in (check.id, check.name, check.unit))]
    texts += [value for value in results.values() if isinstance(value, str)]
    numbers = [value for value in results.values() if value is not None and not isinstance(value, str)]
    return (
        results.keys() <= set(task.results)
        and all(map(str.isprintable, texts))
        and all(isinstance(number, float) for check in design_checks for number in (check.value, check.limit))
        and all(isinstance(value, (int, float)) and not abs(value) > LARGEST_NUMBER for value in numbers)
    )


def check_results(task: SweepTask, recipe: AbstractRecipe) -> None:
    """DesignError for a result that the recipe does not have."""
    for name in task.results:
        column, colon, statistic = name.rpartition(":")
        if colon and statistic in STATISTICS:
            numeric = [c for c in ShownRecipe(recipe).table.columns if c.values.dtype.kind in "fiub"]
            known = [c.id for c in numeric]
            is_known = column in known or column in [c.header for c in numeric]
            remedy = f"give one of the columns {', '.join(known)}"
        else:
            column, known = name, list(_entries("", ShownRecipe(recipe).notes))
            is_known = name in known
            entries = f", or one of {', '.join(known)}" if known else ""
            remedy = f"give COLUMN:{', COLUMN:'.join(STATISTICS)}{entries}"
        if not is_known:
            raise DesignError("results", f"found {shown(name)}", did_you_mean(column, known) + remedy, "unknown-key")


def _result(recipe: AbstractRecipe, name: str) -> Any:
    """The least, largest or last value of a column, or an entry of the notes; None if it does not exist."""
    column, colon, statistic = name.rpartition(":")
    if not (colon and statistic in STATISTICS):
        return _entries("", ShownRecipe(recipe).notes).get(name)
    columns = (c.values for c in ShownRecipe(recipe).table.columns if column in (c.id, c.header))
    values = np.asarray(next(columns, np.empty(0)), dtype=float)
    known = ~np.isnan(values)
    # The last value is that of the last frame, even if it is nan.
    if not known.any() or (statistic == "last" and not known[-1]):
        return None
    return float(STATISTICS[statistic](values[known]))


def _entries(path: str, notes: Mapping[str, object]) -> dict[str, Any]:
    """The numbers, texts and booleans of the notes, by dotted name."""
    entries: dict[str, Any] = {}
    for name, value in notes.items():
        key = f"{path}{name}"
        value = value.item() if isinstance(value, np.generic) else value
        if isinstance(value, Mapping):
            entries |= _entries(f"{key}.", value)
        elif isinstance(value, (str, int, float)):
            entries[key] = value
    return entries


def file_hashes(value: object, folder: str) -> list[str]:
    """Hashes of the files that a recipe names, since a changed file changes the results."""
    if isinstance(value, Mapping):
        return [digest for item in value.values() for digest in file_hashes(item, folder)]
    if isinstance(value, (list, tuple)):
        return [digest for item in value for digest in file_hashes(item, folder)]
    if not isinstance(value, str) or not value or len(value) > 1000:
        return []
    try:
        home = Path(folder).resolve()
        path = (home / value).resolve()
        if not path.is_relative_to(home) or not path.is_file() or path.stat().st_size > LARGEST_FILE:
            return []
        return [hashlib.sha256(path.read_bytes()).hexdigest()]
    except (OSError, ValueError, RuntimeError):
        return []
