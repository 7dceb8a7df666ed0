"""The rows of a sweep: all combinations of its values, and the checks and results of a recipe for one of them."""

from __future__ import annotations

import hashlib
import itertools
import math
import re
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from decimal import ROUND_CEILING, Context, Decimal
from pathlib import Path
from typing import Any

import numpy as np

from ..build import errors_named_by_key
from ..core.errors import DesignError, GeomkinError, printable, shown
from ..core.fields import rounded_up
from ..core.names import Folder
from ..core.processes import progress_to
from ..core.records import record
from ..model.check import Check
from ..plane.vec import Real
from ..recipe.keys import VariedRecipe
from ..recipe.recipe import AbstractRecipe
from ..recipe.search import did_you_mean
from ..recipe.shown import ShownRecipe

# Largest number of combinations, with which slow kinds already take hours.
MOST = 10_000
# A range start:stop:step.
NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,3})?"
RANGE = re.compile(rf"\s*({NUMBER})\s*:\s*({NUMBER})\s*:\s*({NUMBER})\s*")
WITHOUT_STEP = re.compile(rf"\s*{NUMBER}\s*[:-]\s*{NUMBER}\s*")
# A dotted key, such as gear.teeth or program[0].rise.
KEY = re.compile(r"[^\W_][\w -]*(?:\[\d{1,6}\])*(?:\.[^\W_][\w -]*(?:\[\d{1,6}\])*)*")
PLAIN = (str, int, float)
# Decimal arithmetic, in which 3 x 0.1 is 0.3, with enough digits for any written step and without overflow.
EXACT = Context(prec=60, traps=[])


def parsed_values(key: str, given: object) -> tuple[Any, ...]:
    """The values of a key, without duplicates, from a text such as `8:120:4` or `-0.5,0,0.5`, or from a sequence."""
    if not isinstance(key, str) or not KEY.fullmatch(key):
        problem = f"found the key {shown(key)}"
        raise DesignError("values", problem, "give one such as gear.teeth or program[0].rise", "unknown-key")
    if isinstance(given, str):
        values = [value for entry in _split(key, given) for value in _parsed(key, entry)]
    else:
        values = [_checked(key, value) for value in _sequence(key, given)]
    if not values:
        raise DesignError(key, "found no value", "give one or more, such as 8,12 or 8:120:4", "missing-key")
    # 1 and 1.0 are the same value, 1 and true are not.
    return tuple({(isinstance(v, bool), repr(v) if isinstance(v, list) else v): v for v in values}.values())


def combinations(values: Mapping[str, Sequence[Any]]) -> Iterator[dict[str, Any]]:
    """All combinations; the values of the last key change fastest. DesignError if there are too many."""
    counts = [len(row) for row in values.values()]
    if math.prod(counts) > MOST:
        product = " x ".join(f"{count:,}" for count in counts)
        longest = max(values, key=lambda key: len(values[key]))
        most = MOST * len(values[longest]) // math.prod(counts)
        remedy = f"at most {most:,} values of {longest}" if most else f"values that make at most {MOST:,}"
        raise DesignError(
            "values", f"found {product} = {math.prod(counts):,} combinations", f"give {remedy}", "too-much-work"
        )
    return (dict(zip(values, row)) for row in itertools.product(*values.values()))


def _split(key: str, text: str) -> list[str]:
    """Parts of a text between its commas, except those inside brackets or quotes."""
    parts, depth, quote = [""], 0, ""
    for sign in text:
        quote = (sign if not quote else "" if sign == quote else quote) if sign in "\"'" else quote
        depth += 0 if quote else (sign == "[") - (sign == "]")
        if sign == "," and not quote and not depth:
            parts.append("")
        else:
            parts[-1] += sign
    if any(not part.strip() for part in parts):
        problem = f"found {shown(text)}, in which a value is missing"
        raise DesignError(key, problem, "give a value between two commas", "wrong-type")
    return parts


def _parsed(key: str, entry: str) -> list[Any]:
    """The values of one entry: those of a range, a TOML value, or the entry itself as a text."""
    if (match := RANGE.fullmatch(entry)) is not None:
        return _range(key, entry, *(Decimal(number) for number in match.groups()))
    if WITHOUT_STEP.fullmatch(entry):
        raise DesignError(key, f"found {shown(entry.strip())}", "give start:stop:step, such as 50:80:5", "wrong-type")
    try:
        table = tomllib.loads(f"value = {entry.strip()}\n")
    except (ValueError, RecursionError):
        table = {}
    return [_checked(key, table["value"] if set(table) == {"value"} else entry.strip())]


def _range(key: str, text: str, start: Decimal, stop: Decimal, step: Decimal) -> list[float | int]:
    """Values from start in steps; the stop is included if a step meets it."""
    steps = EXACT.divide(EXACT.subtract(stop, start), step)
    if not steps.is_finite() or steps < 0:
        problem = f"found {shown(text.strip())}"
        raise DesignError(key, problem, "give start:stop:step, the step towards the stop", "wrong-type")
    if steps >= MOST:
        least = Context(3, ROUND_CEILING, traps=[]).divide(abs(EXACT.subtract(stop, start)), Decimal(MOST - 1))
        problem = f"found {shown(text.strip())}, which is more than {MOST:,} values"
        raise DesignError(key, problem, f"give a step of at least {rounded_up(float(least), 3)}", "too-much-work")
    whole = all(part == part.to_integral_value() for part in (start, step)) and max(abs(start), abs(stop)) < 2**53
    values = [EXACT.add(start, EXACT.multiply(step, Decimal(k))) for k in range(int(steps) + 1)]
    return [int(value) if whole else float(value) for value in values]


def _sequence(key: str, given: object) -> list[Any]:
    if isinstance(given, np.ndarray):
        given = given.tolist()
    if not isinstance(given, (list, tuple, range)):
        problem = f"found {shown(given)} for {printable(key)}"
        raise DesignError("values", problem, "give a list of values, or a text", "wrong-type")
    if len(given) > MOST:
        raise DesignError(key, f"found {len(given):,} values", f"give at most {MOST:,}", "too-much-work")
    return list(given)


def _checked(key: str, value: Any) -> Any:
    """The value, if TOML can write it: a number, a text, true or false, or a list of these; otherwise DesignError."""
    value = value.item() if isinstance(value, np.generic) else value
    value = [value.real, value.imag] if isinstance(value, complex) else value
    if isinstance(value, (list, tuple)) and len(value) <= MOST:
        return [_checked(key, item) for item in value]
    if not isinstance(value, PLAIN) or (isinstance(value, float) and not math.isfinite(value)):
        problem = f"found {shown(value)}"
        raise DesignError(key, problem, "give finite numbers, texts, true or false, or points [x, y]", "wrong-type")
    if isinstance(value, int) and abs(value) > 2**63:
        raise DesignError(key, f"found {shown(value)}", "give a smaller number", "out-of-range")
    return value


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
            # Of a list, the first item stands for the others.
            shorter = [entry for entry in known if not re.search(r"\[[1-9]", entry)]
            entries = f", or one of {', '.join(shorter)}" if known else ""
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
    """The numbers, texts and booleans of the notes, by dotted name; items of a list are numbered from [0]."""
    entries: dict[str, Any] = {}
    for name, value in notes.items():
        key = f"{path}{name}"
        value = value.item() if isinstance(value, np.generic) else value
        if isinstance(value, Mapping):
            entries |= _entries(f"{key}.", value)
        elif isinstance(value, (list, tuple)):
            entries |= _entries(key, {f"[{k}]": item for k, item in enumerate(value)})
        elif isinstance(value, (str, int, float)):
            entries[key] = value
    return entries


def file_hashes(value: object, folder: Folder) -> list[str]:
    """Hashes of the files that a recipe names, since a changed file changes the results."""
    if isinstance(value, Mapping):
        return [digest for item in value.values() for digest in file_hashes(item, folder)]
    if isinstance(value, (list, tuple)):
        return [digest for item in value for digest in file_hashes(item, folder)]
    if not isinstance(value, str) or not value or len(value) > 1000:
        return []
    if isinstance(folder, Mapping):
        return [hashlib.sha256(folder[value].encode()).hexdigest()] if value in folder else []
    try:
        home = Path(folder or ".").resolve()
        path = (home / value).resolve()
        if not path.is_relative_to(home) or not path.is_file() or path.stat().st_size > LARGEST_FILE:
            return []
        return [hashlib.sha256(path.read_bytes()).hexdigest()]
    except (OSError, ValueError, RuntimeError):
        return []
