"""What a sweep has worked out so far, kept line by line, so that one that was stopped goes on where it was."""

from __future__ import annotations

import hashlib
import json
import os
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from dataclasses import field, replace
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Annotated, Any

from ..build import Readable, name_of
from ..core.arguments import ArgumentType, checked
from ..core.errors import DesignError, GeomkinError, RecipeError, printable
from ..core.processes import each
from ..core.progress import report as report_progress
from ..core.records import record
from ..core.version import __version__
from ..export.csv import csv
from ..export.files import naming, write_whole
from ..model.check import Check
from ..model.table import Table
from ..recipe.load import parsed, table_of, to_toml
from ..recipe.recipe import AbstractRecipe
from .report import columns, report
from .row import Task, check_tell, combinations, file_marks, is_row, listed, worked_out

# Bytes that are read back; those of the most combinations there may be stay below it.
LARGEST = 500_000_000


class Ledger:
    """Rows by key in a file of JSON lines, whose first says what they are of.

    It begins anew if that is something else, or if any line is damaged: then no other can be relied on.

    Parameters
    ----------
    path : Path
        The file.
    title : Mapping
        What the rows are of: recipe, wishes, version.
    is_row : callable
        Whether a row is one that may be used.

    Attributes
    ----------
    known : dict
        Rows by key.
    anew : bool
        Whether there were rows, of something else or damaged.
    """

    def __init__(self, path: Path, title: Mapping[str, Any], is_row: Callable[[Any], bool]):
        self.path = path
        self.known: dict[str, Any] = {}
        with naming(path, "used"):
            content = self._content()
            # What follows the last end of a line was being written when the run was stopped.
            whole = content[: content.rfind(b"\n") + 1]
            lines = whole.split(b"\n")
            entries = list(map(_read, lines[1:-1]))
            sound = _read(lines[0]) == title and all(
                isinstance(entry, dict) and isinstance(entry.get("key"), str) and is_row(entry.get("row"))
                for entry in entries
            )
            self.anew: bool = bool(whole) and not sound
            if self.anew or not whole:
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(_line(title))
                return
            self.known |= {entry["key"]: entry["row"] for entry in entries}
            if len(whole) < len(content):
                os.truncate(path, len(whole))

    def _content(self) -> bytes:
        if not os.path.lexists(self.path):
            return b""
        # A link may lead to what is no sweep's, and would be written over.
        if self.path.is_symlink() or not self.path.is_file():
            raise FileExistsError(0, "something that is no plain file stands under this name")
        if self.path.stat().st_size > LARGEST:
            raise OSError(0, f"it is larger than {LARGEST:,} bytes")
        return self.path.read_bytes()

    def add(self, rows: Mapping[str, Any]) -> None:
        """Set down further rows, by key, whole lines at once."""
        with naming(self.path, "used"), self.path.open("ab") as file:
            file.write(b"".join(_line({"key": key, "row": row}) for key, row in rows.items()))


def _line(held: Mapping[str, Any]) -> bytes:
    return (json.dumps(held) + "\n").encode()


def _read(line: bytes) -> Any:
    try:
        return json.loads(line)
    except (ValueError, RecursionError):
        return None


# What follows the recipe's name in those of a sweep's files.
ENDING = ".sweep"
# Combinations that a process is given at a time. Fewer, and handing them over shows; more, and what a stop loses, and
# the wait for the last one, grow.
TOGETHER = 4
# Jobs handed to an executor before the first is done. Fewer leave a large cluster idle; more fill its memory.
AHEAD = 256

# What comes of a combination whose process was killed.
ENDED = {"refused": "its process was killed, perhaps for want of memory", "checks": [], "results": {}}

Rows = Iterator[tuple[int, list[dict[str, Any]]]]
# Works out batches of combinations: (task, batches) -> (number of the batch, its rows), in any order.
Worker = Callable[[Task, Sequence[Sequence[Mapping[str, Any]]]], Rows]
Values = Annotated[Mapping[str, Any], ArgumentType(lambda given: isinstance(given, Mapping), "a table, key to values")]
Names = Annotated[
    Sequence[str],
    ArgumentType(
        lambda given: isinstance(given, (list, tuple)) and all(isinstance(n, str) for n in given), "a row of texts"
    ),
]


@record(eq=False)
class SweepRow:
    """One combination. values: by key; refused: why there is no such mechanism, "" where there is one.

    checks: of the recipe; results: those asked for besides, None if there is none.
    """

    values: Mapping[str, Any]
    refused: str
    checks: tuple[Check, ...]
    results: Mapping[str, Any]


@record(eq=False)
class Sweep:
    """What came of a sweep: a row for each combination, the last key's values running fastest.

    kept: rows that an earlier run had worked out; anew: whether what an earlier run kept is of another recipe or
    version, or damaged, and was begun anew; files: path to size in bytes, empty where nothing was to be written.
    """

    name: str
    kind: str
    keys: tuple[str, ...]
    rows: tuple[SweepRow, ...]
    kept: int = 0
    anew: bool = False
    files: Mapping[Path, int] = field(default_factory=dict)

    @property
    def table(self) -> Table:
        """The rows as columns: the keys, why one was refused, which checks failed, what they found, the results."""
        return Table(columns(self.keys, self.rows))


@checked
def sweep(
    recipe: AbstractRecipe | Readable,
    values: Values,
    results: Names = (),
    out: str | Path | None = None,
    executor: Executor | None = None,
) -> Sweep:
    """Evaluate a recipe for all combinations of values of some of its keys.

    Parameters
    ----------
    recipe : AbstractRecipe, str, Path or mapping
        A recipe, or anything that `gk.load` reads.
    values : mapping of str to sequence or str
        Dotted keys, such as "gear.teeth" or "program[0].rise", and their values: a row, or a text as in the command,
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
    return swept(recipe, values, results, out, _here if executor is None else partial(_by_executor, executor))


def swept(
    recipe: AbstractRecipe | Readable,
    values: Mapping[str, Any],
    results: Sequence[str],
    out: str | Path | None,
    by: Worker,
) -> Sweep:
    """The same, worked out by any worker."""
    task, name = _task(recipe, tuple(dict.fromkeys(results)))
    keyed = {key: listed(key, given) for key, given in values.items()}
    if not keyed:
        raise DesignError(
            "values", "found none", 'give a key and its values, such as {"gear.teeth": [8, 12]}', "missing-key"
        )
    every = list(combinations(keyed))
    _check_keys(task, keyed)
    _check_results(task, every)
    kept_in = None if out is None else Path(out) / name / f"{name}{ENDING}.jsonl"
    ledger = None if kept_in is None else Ledger(kept_in, _title(task), partial(is_row, task))
    known: dict[str, Any] = {} if ledger is None else dict(ledger.known)
    keys = [_key_of(task, changes) for changes in every]
    left = [k for k, key in enumerate(keys) if key not in known]
    together = 1 if by is _here else TOGETHER
    batches = [left[k : k + together] for k in range(0, len(left), together)]
    done = len(every) - len(left)
    kept = done
    for number, rows in by(task, [[every[k] for k in batch] for batch in batches]):
        found = dict(zip((keys[k] for k in batches[number]), rows))
        known |= found
        if ledger is not None:
            ledger.add(found)
        done += len(found)
        report_progress(done / len(every), f"{done} of {len(every)} combinations")
    swept_rows = tuple(_row(changes, known[key]) for changes, key in zip(every, keys))
    result = Sweep(
        name, str(task.recipe.get("kind", "")), tuple(keyed), swept_rows, kept, ledger is not None and ledger.anew, {}
    )
    if out is None:
        return result
    folder = Path(out) / name
    contents = {
        f"{name}{ENDING}.csv": csv(result.table, "inf"),
        f"{name}{ENDING}.html": report(name, keyed, swept_rows),
    }
    write_whole(folder, contents)
    return replace(result, files={folder / file: len(content) for file, content in contents.items()})


def _task(recipe: AbstractRecipe | Readable, results: tuple[str, ...]) -> tuple[Task, str]:
    """What is worked out, read once, and the name of its files."""
    if isinstance(recipe, AbstractRecipe):
        data, file, name = tomllib.loads(to_toml(recipe)), recipe.name or recipe.kind, recipe.name
    elif isinstance(recipe, Mapping):
        data, file, name = dict(recipe), "recipe", ""
    elif isinstance(recipe, str) and "\n" in recipe:
        data, file, name = parsed(recipe), "recipe", ""
    else:
        path = Path(recipe)
        data = table_of(path)
        # Other processes may work in other folders.
        return Task(data, str(path), str(path.absolute().parent), results), name_of(str(path), path.stem)
    return Task(data, file, str(Path.cwd()), results), name_of(file, name or str(data.get("kind", "recipe")))


def _check_keys(task: Task, values: Mapping[str, Sequence[Any]]) -> None:
    """Refuse a key that no recipe of its kind knows, in the words in which a recipe that has it is refused."""
    first = {key: row[0] for key, row in values.items()}
    try:
        task.opened(first)
    except RecipeError as error:
        for problem in error.problems:
            asked = any(key.startswith(problem.key) and key[len(problem.key) :][:1] in ("", ".", "[") for key in values)
            if problem.id == "unknown-key" and asked:
                raise DesignError(problem.key, problem.problem, problem.remedy, problem.id) from None


def _check_results(task: Task, every: Iterable[Mapping[str, Any]]) -> None:
    """Refuse names of results that the first recipe that works does not have."""
    if not task.results:
        return
    for changes in islice(every, 20):
        try:
            recipe = task.opened(changes)
            _ = recipe.checks, recipe.table
        except GeomkinError:
            continue
        return check_tell(task, recipe)


def _here(task: Task, batches: Sequence[Sequence[Mapping[str, Any]]]) -> Rows:
    for number, batch in enumerate(batches):
        yield number, worked_out(task, batch)


def by_processes(task: Task, batches: Sequence[Sequence[Mapping[str, Any]]]) -> Rows:
    """By all cores, as the command does; for the main thread of a program that is nothing else."""
    for number, rows in enumerate(each(partial(worked_out, task), batches)):
        yield number, [dict(ENDED) for _ in batches[number]] if rows is None else rows


def _by_executor(executor: Executor, task: Task, batches: Sequence[Sequence[Mapping[str, Any]]]) -> Rows:
    """A window of jobs at a time, so that however many there are, few wait."""
    waiting: dict[Future[list[dict[str, Any]]], int] = {}
    ahead = iter(enumerate(batches))
    try:
        while True:
            for number, batch in islice(ahead, AHEAD - len(waiting)):
                waiting[executor.submit(worked_out, task, batch)] = number
            if not waiting:
                return
            done = wait(waiting, return_when=FIRST_COMPLETED).done
            # What was found is handed on before what went wrong.
            for future in sorted(done, key=lambda one: one.exception() is not None):
                yield waiting.pop(future), future.result()
    except GeomkinError:
        raise
    except Exception as error:
        why = f"it failed ({type(error).__name__}: {printable(error, 200)})"
        raise DesignError(
            "executor", why, "give one that works; with `out`, what was found is kept", "internal"
        ) from error
    finally:
        for future in waiting:
            future.cancel()


def _title(task: Task) -> dict[str, Any]:
    """What all rows of a ledger are of."""
    text = json.dumps([task.recipe, file_marks(task.recipe, task.folder)], sort_keys=True, default=str)
    return {"geomkin": __version__, "recipe": hashlib.sha256(text.encode()).hexdigest(), "results": list(task.results)}


def _key_of(task: Task, changes: Mapping[str, Any]) -> str:
    """A row's key: its values, and the files that they name."""
    return json.dumps([dict(sorted(changes.items())), *file_marks(changes, task.folder)])


def _row(changes: Mapping[str, Any], found: Mapping[str, Any]) -> SweepRow:
    return SweepRow(changes, found["refused"], tuple(Check(*check) for check in found["checks"]), found["results"])
