"""Values that keys of a recipe run through: written as ranges and lists, counted, and put in their places."""

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
from ..core.progress import shown as told_to
from ..core.records import record
from ..model.check import Check
from ..plane.vec import Real
from ..recipe.keys import with_values
from ..recipe.load import from_table
from ..recipe.messages import nearest
from ..recipe.recipe import AbstractRecipe

# Combinations of values at most: hours of slow kinds, and more rows than anybody compares.
MOST = 10_000
# From start to stop in steps.
NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,3})?"
RANGE = re.compile(rf"\s*({NUMBER})\s*:\s*({NUMBER})\s*:\s*({NUMBER})\s*")
# Tables by name, rows of a list by number, as messages about recipes write them.
KEY = re.compile(r"[^\W_][\w -]*(?:\[\d{1,6}\])*(?:\.[^\W_][\w -]*(?:\[\d{1,6}\])*)*")
PLAIN = (str, int, float)
# Of numbers as a person writes them: no step of a range is lost, and nothing overflows or takes long.
EXACT = Context(prec=60, traps=[])


def listed(key: str, given: object) -> tuple[Any, ...]:
    """The values of a key as TOML gives them, each once: of a text such as `8:120:4` or `-0.5,0,0.5`, or of a row."""
    if not isinstance(key, str) or not KEY.fullmatch(key):
        raise DesignError(
            "values", f"found the key {shown(key)}", "give one such as gear.teeth or program[0].rise", "unknown-key"
        )
    if isinstance(given, str):
        values = [value for piece in _pieces(key, given) for value in _read(key, piece)]
    else:
        values = [_plain(key, value) for value in _row(key, given)]
    if not values:
        raise DesignError(key, "found no value", "give one or more, such as 8,12 or 8:120:4", "missing-key")
    # 1 and 1.0 are one number, true is none.
    return tuple({(isinstance(v, bool), repr(v) if isinstance(v, list) else v): v for v in values}.values())


def combinations(values: Mapping[str, Sequence[Any]]) -> Iterator[dict[str, Any]]:
    """Every combination, the last key's values running fastest; refused where there are too many."""
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


def _pieces(key: str, text: str) -> list[str]:
    """A list's parts between the commas that stand in no brackets and no quotes."""
    parts, depth, quote = [""], 0, ""
    for sign in text:
        quote = (sign if not quote else "" if sign == quote else quote) if sign in "\"'" else quote
        depth += 0 if quote else (sign == "[") - (sign == "]")
        if sign == "," and not quote and not depth:
            parts.append("")
        else:
            parts[-1] += sign
    if any(not part.strip() for part in parts):
        raise DesignError(
            key, f"found {shown(text)}, in which a value is missing", "give one between any two", "wrong-type"
        )
    return parts


def _read(key: str, piece: str) -> list[Any]:
    """The values of one part: a range, or a value of TOML, or else a text without its quotes."""
    if (found := RANGE.fullmatch(piece)) is not None:
        return _range(key, piece, *(Decimal(part) for part in found.groups()))
    try:
        read = tomllib.loads(f"value = {piece.strip()}\n")
    except (ValueError, RecursionError):
        read = {}
    return [_plain(key, read["value"] if set(read) == {"value"} else piece.strip())]


def _range(key: str, text: str, start: Decimal, stop: Decimal, step: Decimal) -> list[float | int]:
    """From start in steps as far as stop, worked out in decimals: 0.1 three times is 0.3."""
    ways = EXACT.divide(EXACT.subtract(stop, start), step)
    if not ways.is_finite() or ways < 0:
        raise DesignError(
            key, f"found {shown(text.strip())}", "give start:stop:step, the step towards the stop", "wrong-type"
        )
    if ways >= MOST:
        least = Context(3, ROUND_CEILING, traps=[]).divide(abs(EXACT.subtract(stop, start)), Decimal(MOST - 1))
        problem = f"found {shown(text.strip())}, which is more than {MOST:,} values"
        raise DesignError(key, problem, f"give a step of at least {float(least):g}", "too-much-work")
    whole = all(part == part.to_integral_value() for part in (start, step)) and max(abs(start), abs(stop)) < 2**53
    values = [EXACT.add(start, EXACT.multiply(step, Decimal(k))) for k in range(int(ways) + 1)]
    return [int(value) if whole else float(value) for value in values]


def _row(key: str, given: object) -> list[Any]:
    if isinstance(given, np.ndarray):
        given = given.tolist()
    if not isinstance(given, (list, tuple, range)):
        raise DesignError(
            "values", f"found {shown(given)} for {printable(key)}", "give a row of values, or a text", "wrong-type"
        )
    if len(given) > MOST:
        raise DesignError(key, f"found {len(given):,} values", f"give at most {MOST:,}", "too-much-work")
    return list(given)


def _plain(key: str, value: Any) -> Any:
    """A value as a recipe has it: a number, a text, true or false, or a point or row of these."""
    value = value.item() if isinstance(value, np.generic) else value
    value = [value.real, value.imag] if isinstance(value, complex) else value
    if isinstance(value, (list, tuple)) and len(value) <= MOST:
        return [_plain(key, one) for one in value]
    if not isinstance(value, PLAIN) or (isinstance(value, float) and not math.isfinite(value)):
        raise DesignError(
            key, f"found {shown(value)}", "give finite numbers, texts, true or false, or points [x, y]", "wrong-type"
        )
    if isinstance(value, int) and abs(value) > 2**63:
        raise DesignError(key, f"found {shown(value)}", "give a smaller number", "out-of-range")
    return value


# What a result states of a table's column, and how it is found among its values that are not nan.
WAYS: dict[str, Callable[[Real], float]] = {"least": np.min, "largest": np.max, "last": lambda values: values[-1]}
# Bound of any number in a result; a larger whole number is no float.
LARGEST_NUMBER = 1e300
# Bytes of a file that a recipe names; see `beside`.
LARGEST = 10_000_000


@record
class Task:
    """What is the same for all combinations. recipe: its table as TOML gives it; folder: where files it names lie."""

    recipe: Mapping[str, Any]
    file: str
    folder: str
    results: tuple[str, ...]

    def opened(self, changes: Mapping[str, Any]) -> AbstractRecipe:
        """The recipe with these changes. Raises what `gk.load` does, and DesignError for a key that leads nowhere."""
        return from_table(with_values(self.recipe, changes), self.file, self.folder)


def worked_out(task: Task, several: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """What came of each of several combinations, as JSON has it; nothing that one does ends the others."""
    return [_worked_out(task, changes) for changes in several]


def _worked_out(task: Task, changes: Mapping[str, Any]) -> dict[str, Any]:
    row: dict[str, Any] = {"refused": "", "checks": [], "results": {}}
    try:
        # A sweep reports its combinations, not the progress within each.
        with told_to(lambda *_: None):
            recipe = task.opened(changes)
            with errors_named_by_key(task.file, recipe):
                checks = [[c.id, c.name, float(c.value), c.side, float(c.limit), c.unit] for c in recipe.checks]
                row |= {"checks": checks, "results": {name: _result(recipe, name) for name in task.results}}
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


def check_tell(task: Task, recipe: AbstractRecipe) -> None:
    """Refuse what the first recipe that works knows nothing of, with the nearest of what it knows."""
    for name in task.results:
        column, colon, way = name.rpartition(":")
        if colon and way in WAYS:
            numbers = [c for c in recipe.table.columns if c.values.dtype.kind in "fiub"]
            known = [c.id for c in numbers]
            found, what = column in known or column in [c.header for c in numbers], f"columns: {', '.join(known)}"
        else:
            column, known = name, list(_entries("", recipe.notes))
            entries = f", or one of {', '.join(known)}" if known else ""
            found, what = name in known, f"COLUMN:{', COLUMN:'.join(WAYS)}{entries}"
        if not found:
            raise DesignError("results", f"found {shown(name)}", f"{nearest(column, known)}give {what}", "unknown-key")


def _result(recipe: AbstractRecipe, name: str) -> Any:
    """A column's least, largest or last value that is not nan, or an entry of the notes; None where there is none."""
    column, colon, way = name.rpartition(":")
    if not (colon and way in WAYS):
        return _entries("", recipe.notes).get(name)
    held = next((c.values for c in recipe.table.columns if column in (c.id, c.header)), np.empty(0))
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
