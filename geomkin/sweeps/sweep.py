"""Sweeps: a recipe evaluated for all combinations of some values, by one process, several, or an executor."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import field, replace
from functools import partial
from itertools import islice, repeat
from pathlib import Path
from typing import Annotated, Any

from ..build import Readable, valid_recipe_name
from ..core.arguments import ArgumentType, checked
from ..core.errors import DesignError, GeomkinError
from ..core.names import PathName
from ..core.processes import Runner, by, by_this_process
from ..core.progress import report as report_progress
from ..core.records import record
from ..core.version import __version__
from ..export.csv import csv
from ..export.files import system_errors_as_file_errors, write_whole
from ..model.check import Check
from ..model.table import Table
from ..recipe.recipe import AbstractRecipe
from ..recipe.varied import varied
from .evaluation import SweepTask, check_results, combinations, evaluate, file_hashes, is_row, parsed_values
from .report import sweep_columns, sweep_page

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
        raise DesignError(
            "values", "found none", 'give a key and its values, such as {"gear.teeth": [8, 12]}', "missing-key"
        )
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
    contents = {
        f"{name}{ENDING}.csv": csv(result.table, "inf"),
        f"{name}{ENDING}.html": sweep_page(name, keyed, rows),
    }
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
