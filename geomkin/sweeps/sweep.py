"""Sweeps: a recipe evaluated for all combinations of some values, by one process, several, or an executor."""

from __future__ import annotations

import hashlib
import json
import math
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import field, replace
from functools import partial
from itertools import islice, product, repeat
from pathlib import Path
from typing import Annotated, Any, Protocol

import numpy as np

from ..build import Readable, valid_recipe_name
from ..core.arguments import ArgumentType, checked
from ..core.errors import DesignError, GeomkinError, harmless
from ..core.fields import to_digits_or_none
from ..core.names import PathName
from ..core.processes import Runner, by, by_this_process
from ..core.processes import report as report_progress
from ..core.records import record
from ..core.version import __version__
from ..export.summary import system_errors_as_file_errors, write_whole
from ..export.tables import csv
from ..export.text import capital, number, text
from ..model.check import Check
from ..model.table import Column, Table
from ..page.page import rows_document
from ..page.sections import MOST_ROWS, html_section, wide, with_unit_of_name
from ..plane.vec import Array
from ..recipe.keys import varied
from ..recipe.recipe import AbstractRecipe
from .evaluation import SweepTask, check_results, combinations, evaluate, file_hashes, is_row, parsed_values


class Row(Protocol):
    """Results for one combination; `SweepRow` is one."""

    @property
    def values(self) -> Mapping[str, Any]: ...
    @property
    def refused(self) -> str: ...
    @property
    def checks(self) -> Sequence[Check]: ...
    @property
    def results(self) -> Mapping[str, Any]: ...


def sweep_columns(keys: Sequence[str], rows: Sequence[Row]) -> tuple[Column, ...]:
    """Columns: values of the keys, reason of a refusal, failed checks, values of checks, results."""
    failed = ["; ".join(check.id for check in row.checks if not check.passed) for row in rows]
    columns = [
        *(Column(key, "", "value under this key", _array([row.values[key] for row in rows])) for key in keys),
        Column("refused", "", "why there is no such mechanism", _array([row.refused for row in rows])),
        Column("failed", "", "the checks that failed", _array(failed)),
        *check_columns(rows),
        *result_columns(rows),
    ]
    return tuple(_with_unique_names(columns))


def check_columns(rows: Sequence[Row]) -> list[Column]:
    """One column for each check of any row; nan if a row has no such check."""
    by_id = [{check.id: check for check in row.checks} for row in rows]
    columns = []
    for id in dict.fromkeys(id for checks in by_id for id in checks):
        first = next(checks[id] for checks in by_id if id in checks)
        values = [checks[id].value if id in checks else np.nan for checks in by_id]
        columns.append(Column(id, first.unit, first.name, np.array(values)))
    return columns


def result_columns(rows: Sequence[Row]) -> list[Column]:
    """One column for each requested result."""
    names = dict.fromkeys(name for row in rows for name in row.results)
    return [
        Column(name.replace(":", "_"), "", _heading(name), _array([row.results.get(name) for row in rows]))
        for name in names
    ]


def _heading(name: str) -> str:
    """A result for people: the column after its statistic, or an entry of the summary with its unit at the end."""
    column, colon, statistic = name.rpartition(":")
    if colon:
        return f"{statistic} {column}"
    first, *inner = name.split(".")
    first, comma, unit = with_unit_of_name(first).partition(", ")
    return with_unit_of_name(", ".join((first, *inner))) + comma + unit


def _array(values: Sequence[Any]) -> Array:
    """An array of numbers, with nan for None, or of texts."""
    if all(isinstance(value, int) and not isinstance(value, bool) for value in values):
        return np.array(values, dtype=object if any(abs(v) >= 2**63 for v in values) else int)
    if all(value is None or (isinstance(value, (int, float)) and not isinstance(value, bool)) for value in values):
        return np.array([np.nan if value is None else float(value) for value in values])
    return np.array([as_text(value) for value in values], dtype=object)


def as_text(value: Any) -> str:
    """A value as a recipe writes it."""
    if value is None or isinstance(value, bool):
        return "" if value is None else str(value).lower()
    return f"[{', '.join(map(as_text, value))}]" if isinstance(value, list) else str(value)


def _with_unique_names(columns: Sequence[Column]) -> Iterator[Column]:
    """The columns, renamed if an id or header repeats."""
    taken: set[str] = set()
    for column in columns:
        id, number = column.id, 1
        while taken & {column.id, column.header}:
            number += 1
            column = Column(f"{id}_{number}", column.unit, column.meaning, column.values)
        taken |= {column.id, column.header}
        yield column


# Largest number of lines in a plot: as many as colours and dashes distinguish.
MOST_LINES = 6
# Largest number of plots and of points of a line. More make pages of megabytes; the CSV file has all values.
MOST_PLOTS, MOST_POINTS = 40, 1001


def sweep_page(name: str, values: Mapping[str, Sequence[Any]], rows: Sequence[Row]) -> bytes:
    """The page of a sweep. name: of the recipe; values: by key; rows: one for each combination, in order."""
    columns = [_without_noise(column) for column in (*check_columns(rows), *result_columns(rows))]
    refused = sum(bool(row.refused) for row in rows)
    passed = sum(not row.refused and all(check.passed for check in row.checks) for row in rows)
    counts = f"{len(rows):,} combinations of {text(' and '.join(values))}: {passed:,} pass all checks"
    about = f"<p>{counts}; {refused:,} are refused.</p>"
    data, note = _plots(values, rows, columns)
    plots = f'<section id="plots" class="values" aria-label="Plots"></section>\n{note}' if data["plots"] else ""
    unplotted = "" if data["plots"] else '<section id="plots" hidden></section>'
    body = f"{plots}{unplotted}{_table(list(values), rows, columns)}\n"
    return rows_document(f"{name}: a sweep", about, body, data)


# Share of the largest value of a column below which a value is rounding noise.
NOISE = 1e-12


def _without_noise(column: Column) -> Column:
    values = column.values
    if values.dtype.kind != "f":
        return column
    size = np.abs(values[np.isfinite(values)]).max(initial=0.0)
    return replace(column, values=np.where(np.abs(values) < NOISE * size, 0.0, values))


def _plots(values: Mapping[str, Sequence[Any]], rows: Sequence[Row], columns: Sequence[Column]) -> tuple[Any, str]:
    """Data of the plots for the player, over the first numeric key, and a note if some lines are left out."""
    data: dict[str, Any] = {"frames": 0, "spots": True, "columns": [], "plots": []}
    along = next((key for key, row in values.items() if len(row) > 1 and all(map(_is_number, row))), None)
    if along is None:
        return data, ""
    others = [key for key in values if key != along]
    abscissas = sorted(values[along])[:MOST_POINTS]
    lines = list(product(*(values[key] for key in others)))
    shown = [lines[k] for k in np.unique(np.rint(np.linspace(0, len(lines) - 1, MOST_LINES)).astype(int))]
    row_of = {(row.values[along], *(as_text(row.values[key]) for key in others)): k for k, row in enumerate(rows)}
    data["frames"], data["columns"] = len(abscissas), [_column(along, "", "", abscissas)]
    limits = [{c.id: (c.limit, f"{c.side} {number(c.limit)}") for c in row.checks} for row in rows]
    for column in [c for c in columns if c.values.dtype.kind in "fi"][:MOST_PLOTS]:
        limit = {by_id[column.id] for by_id in limits if column.id in by_id}
        data["plots"].append(
            {
                "title": harmless(capital(column.meaning)),
                "columns": [len(data["columns"]) + k for k in range(len(shown))],
                # A limit that differs between combinations is not drawn.
                "limits": [[value, label] for value, label in limit if len(limit) == 1 and math.isfinite(value)],
            }
        )
        for line in shown:
            sizes = [f"{key.rpartition('.')[2]} {as_text(value)}" for key, value in zip(others, line)]
            ordinates = [column.values[row_of[x, *map(as_text, line)]] for x in abscissas]
            label = ", ".join(sizes) or capital(column.meaning)
            data["columns"].append(_column(label, column.unit, column.meaning, ordinates))
    note = f"<p>The plots show {len(shown)} of {len(lines):,} lines, evenly chosen; the CSV file has all values.</p>"
    return data, note if len(lines) > len(shown) else ""


def _column(name: str, unit: str, meaning: str, row: Sequence[Any]) -> dict[str, Any]:
    values = [to_digits_or_none(value, 6) for value in row]
    return {"name": harmless(name), "unit": harmless(unit), "meaning": harmless(meaning), "row": values}


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _table(keys: Sequence[str], rows: Sequence[Row], columns: Sequence[Column]) -> str:
    """A table of the first `MOST_ROWS` rows."""
    results = [f"{capital(c.meaning)}{f', {c.unit}' if c.unit else ''}" for c in columns]
    heads = "".join(f'<th scope="col">{text(head)}</th>' for head in (*keys, "Checks", *results))
    lines = "".join(_html_row(keys, row, [c.values[k] for c in columns]) for k, row in enumerate(rows[:MOST_ROWS]))
    table = f"<table><thead><tr>{heads}</tr></thead><tbody>{lines}</tbody></table>"
    more = f"<p>The CSV file has {len(rows) - MOST_ROWS:,} more rows.</p>" if len(rows) > MOST_ROWS else ""
    return html_section("rows", "All combinations", wide("Combinations", table) + more)


def _html_row(keys: Sequence[str], row: Row, results: Sequence[Any]) -> str:
    values = "".join(f'<th scope="row">{text(as_text(row.values[key]))}</th>' for key in keys)
    if row.refused:
        return f'<tr class="fails">{values}<td colspan="{1 + len(results)}">{text(row.refused)}</td></tr>'
    failed = [check.name for check in row.checks if not check.passed]
    verdict = text(f"fails: {', '.join(failed)}") if failed else "all pass" if row.checks else "none"
    cells = "".join(f"<td>{text(v) if isinstance(v, str) else number(float(v))}</td>" for v in results)
    return f'<tr class="{"fails" if failed else "holds"}">{values}<td>{verdict}</td>{cells}</tr>'


# Largest file that is read back, bytes; the rows of the most combinations stay below it.
LARGEST = 500_000_000


class Ledger:
    """Rows by key in a file of JSON lines; the first line identifies the sweep.

    The file is emptied if it belongs to another sweep or any line is damaged.

    Parameters
    ----------
    path : Path
        The file.
    title : Mapping
        Identity of the sweep: recipe, results, version.
    is_row : callable
        Whether a row has the right form.

    Attributes
    ----------
    known : dict
        Rows by key.
    is_restarted : bool
        Whether the file had rows of another sweep, or was damaged.
    """

    def __init__(self, path: Path, title: Mapping[str, Any], is_row: Callable[[Any], bool]):
        self.path = path
        self.known: dict[str, Any] = {}
        with system_errors_as_file_errors(path, "used"):
            content = self._content()
            # A last line without a line break was incomplete when the run was stopped.
            whole = content[: content.rfind(b"\n") + 1]
            lines = whole.split(b"\n")
            entries = list(map(_parsed, lines[1:-1]))
            is_valid = _parsed(lines[0]) == title and all(
                isinstance(entry, dict) and isinstance(entry.get("key"), str) and is_row(entry.get("row"))
                for entry in entries
            )
            self.is_restarted: bool = bool(whole) and not is_valid
            if self.is_restarted or not whole:
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(_line(title))
                return
            self.known |= {entry["key"]: entry["row"] for entry in entries}
            if len(whole) < len(content):
                os.truncate(path, len(whole))

    def _content(self) -> bytes:
        if not os.path.lexists(self.path):
            return b""
        # A link may point to another file, which must not be overwritten.
        if self.path.is_symlink() or not self.path.is_file():
            raise FileExistsError(0, "this name belongs to something other than a plain file")
        if self.path.stat().st_size > LARGEST:
            raise OSError(0, f"it is larger than {LARGEST:,} bytes")
        return self.path.read_bytes()

    def add(self, rows: Mapping[str, Any]) -> None:
        """Append rows by key, in one write."""
        with system_errors_as_file_errors(self.path, "used"), self.path.open("ab") as file:
            file.write(b"".join(_line({"key": key, "row": row}) for key, row in rows.items()))


def _line(entry: Mapping[str, Any]) -> bytes:
    return (json.dumps(entry) + "\n").encode()


def _parsed(line: bytes) -> Any:
    try:
        return json.loads(line)
    except (ValueError, RecursionError):
        return None


# Files of a sweep are named <recipe>.sweep.csv and so on.
ENDING = ".sweep"
# Combinations in a batch of a process. Smaller batches take more time for transfer; larger ones lose more work if the
# sweep is stopped.
BATCH_SIZE = 4

# The row of a combination whose process was killed.
KILLED = {"refused": "its process was killed, perhaps because memory ran out", "checks": [], "results": {}}

Values = Annotated[Mapping[str, Any], ArgumentType(lambda given: isinstance(given, Mapping), "a table, key to values")]
Names = Annotated[
    Sequence[str],
    ArgumentType(
        lambda given: isinstance(given, (list, tuple)) and all(isinstance(n, str) for n in given), "a row of texts"
    ),
]


@record(eq=False)
class SweepRow:
    """Results for one combination.

    Parameters
    ----------
    values : mapping of str to value
        Values by key.
    refused : str
        The reason if there is no such mechanism, otherwise "".
    checks : tuple of Check
        Checks of the recipe.
    results : mapping of str to value
        The requested results; None for one that is not defined.
    """

    values: Mapping[str, Any]
    refused: str
    checks: tuple[Check, ...]
    results: Mapping[str, Any]


@record(eq=False)
class Sweep:
    """Results of a sweep.

    Parameters
    ----------
    name, kind : str
        Name and kind of the recipe.
    keys : tuple of str
        The keys that vary.
    rows : tuple of SweepRow
        One row for each combination; the values of the last key change fastest.
    reused : int
        Number of rows that an earlier run had computed.
    is_restarted : bool
        Whether rows of an earlier run were discarded, because they are of another recipe or version, or damaged.
    files : mapping of Path to int
        Size of each written file, bytes; empty if no folder was given.
    """

    name: str
    kind: str
    keys: tuple[str, ...]
    rows: tuple[SweepRow, ...]
    reused: int = 0
    is_restarted: bool = False
    files: Mapping[Path, int] = field(default_factory=dict)

    @property
    def table(self) -> Table:
        """The rows as a table: keys, reasons of refusals, failed checks, values of checks, results."""
        return Table(sweep_columns(self.keys, self.rows))


@checked
def sweep(
    recipe: AbstractRecipe | Readable,
    values: Values,
    results: Names = (),
    out: PathName | None = None,
    executor: Executor | None = None,
) -> Sweep:
    """Evaluate a recipe for all combinations of values of some of its keys.

    Parameters
    ----------
    recipe : AbstractRecipe, str, Path or mapping
        A recipe, or anything that `gk.load` reads.
    values : mapping of str to sequence or str
        Dotted keys, such as "gear.teeth" or "program[0].rise", and their values: a list, or a text as in the command,
        such as "8:120:4" (start:stop:step; the stop is included if a step meets it) or "-0.5,0,0.5".
        At most 10,000 combinations.
    results : sequence of str
        Results besides the checks: a column of the table as "transmission_angle:least" (or `largest`, `last`), or an
        entry of the notes by its dotted name.
    out : str or Path, optional
        Folder for <name>/<name>.sweep.csv, a page, and each row as it is computed, so that the same call continues
        where it was stopped. By default nothing is written.
    executor : Executor, optional
        Of `concurrent.futures`, or of a cluster with the same interface, such as Dask's `client.get_executor()`. By
        default this process computes the rows.

    Returns
    -------
    Sweep
        One row for each combination. A combination that the recipe refuses has the reason in its row.

    Raises
    ------
    RecipeError, FileError
        As for `gk.load`.
    DesignError
        If a key or a result is unknown, there are too many combinations, or the executor fails. Rows that were
        written remain.

    See Also
    --------
    optimise, load
    """
    return swept(recipe, values, results, out, by(executor))


def swept(
    recipe: AbstractRecipe | Readable,
    values: Mapping[str, Any],
    results: Sequence[str],
    out: str | Path | None,
    run: Runner,
) -> Sweep:
    """A sweep whose batches of combinations are evaluated by `run`; see `sweep`."""
    source, name = varied(recipe)
    task, name = (
        SweepTask(source.recipe, source.file, source.folder, tuple(dict.fromkeys(results))),
        valid_recipe_name(source.file, name),
    )
    keyed = {key: parsed_values(key, given) for key, given in values.items()}
    if not keyed:
        remedy = 'give a key and its values, such as {"gear.teeth": [8, 12]}'
        raise DesignError("values", "found none", remedy, "missing-key")
    changes = list(combinations(keyed))
    task.check_keys({key: row[0] for key, row in keyed.items()})
    _check_results(task, changes)
    ledger = None
    if out is not None:
        ledger = Ledger(Path(out) / name / f"{name}{ENDING}.jsonl", _title(task), partial(is_row, task))
    known: dict[str, Any] = {} if ledger is None else dict(ledger.known)
    keys = [_key_of(task, values) for values in changes]
    remaining = [k for k, key in enumerate(keys) if key not in known]
    size = 1 if run is by_this_process else BATCH_SIZE
    batches = [remaining[k : k + size] for k in range(0, len(remaining), size)]
    done = reused = len(changes) - len(remaining)
    for index, batch_rows in run(partial(evaluate, task), [[changes[k] for k in batch] for batch in batches]):
        new = dict(zip((keys[k] for k in batches[index]), batch_rows or map(dict, repeat(KILLED))))
        known |= new
        if ledger is not None:
            ledger.add(new)
        done += len(new)
        report_progress(done / len(changes), f"{done} of {len(changes)} combinations")
    rows = tuple(_row(values, known[key]) for values, key in zip(changes, keys))
    is_restarted = ledger is not None and ledger.is_restarted
    result = Sweep(name, str(task.recipe.get("kind", "")), tuple(keyed), rows, reused, is_restarted)
    if out is None:
        return result
    folder = Path(out) / name
    contents = {f"{name}{ENDING}.csv": csv(result.table, "inf"), f"{name}{ENDING}.html": sweep_page(name, keyed, rows)}
    write_whole(folder, contents)
    return replace(result, files={folder / file: len(content) for file, content in contents.items()})


def _check_results(task: SweepTask, candidates: Iterable[Mapping[str, Any]]) -> None:
    """DesignError for a result that the first valid recipe does not have."""
    if not task.results:
        return
    for changes in islice(candidates, 20):
        try:
            recipe = task.opened(changes)
            _ = recipe.checks, recipe.table
        except GeomkinError:
            continue
        return check_results(task, recipe)


def _title(task: SweepTask) -> dict[str, Any]:
    """Identity of the sweep: version, recipe with its files, results."""
    text = json.dumps([task.recipe, file_hashes(task.recipe, task.folder)], sort_keys=True, default=str)
    return {"geomkin": __version__, "recipe": hashlib.sha256(text.encode()).hexdigest(), "results": list(task.results)}


def _key_of(task: SweepTask, changes: Mapping[str, Any]) -> str:
    """Key of a row in the ledger: its values, and hashes of the files that they name."""
    return json.dumps([dict(sorted(changes.items())), *file_hashes(changes, task.folder)])


def _row(values: Mapping[str, Any], row: Mapping[str, Any]) -> SweepRow:
    return SweepRow(values, row["refused"], tuple(Check(*check) for check in row["checks"]), row["results"])
