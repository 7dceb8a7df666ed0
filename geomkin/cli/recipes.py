"""The recipes that a command is given, and the outcome of each: progress, refusals, text or JSON, exit status."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import AbstractContextManager, contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, NoReturn, TextIO, TypeVar

import click

if TYPE_CHECKING:
    from click._termui_impl import ProgressBar

    from ..build import Made
    from ..core.errors import Problem


R = TypeVar("R")
# Remedy if memory runs out.
LARGER = "give a larger tolerance"

recipe_arguments = click.argument(
    "recipes", nargs=-1, required=True, type=click.Path(exists=True, path_type=Path), metavar="RECIPE_OR_FOLDER..."
)
one_recipe = click.argument("recipe", type=click.Path(exists=True, dir_okay=False, path_type=Path))
out_folder = click.option(
    "--out", default="out", show_default=True, type=click.Path(path_type=Path), help="Folder for the files."
)
json_option = click.option(
    "--json", "as_json", is_flag=True,
    help='Print one JSON object per recipe instead of text; nan is null, infinite is "inf".',
)  # fmt: skip


def recipe_files(paths: Iterable[Path]) -> list[Path]:
    """The named recipes, and those in the named folders, in order."""
    from ..core.errors import printable

    files: list[Path] = []
    for path in paths:
        inside = sorted(path.glob("*.toml")) if path.is_dir() else [path]
        if not inside:
            raise click.UsageError(f"no recipe (*.toml) in {printable(path)}")
        files += [f for f in inside if f not in files]
    return files


class Refused(NamedTuple):
    """The reason why a recipe was not made, as text and as problems."""

    text: str
    problems: tuple[Problem, ...]


Outcomes = list[tuple[Path, "R | Refused"]]


def outcomes_of(files: list[Path], action: Callable[[Path], R]) -> Outcomes[R]:
    """The outcome of each recipe, in the order of the files."""
    from ..core.errors import Problem, printable
    from ..core.processes import each
    from ..core.progress import progress_to

    outcomes: list[R | Refused] = []
    hidden = len(files) < 2 or not _is_terminal(sys.stderr)

    def show(share: float, what: str) -> None:
        """Show the progress within a recipe in the bar."""
        bar.label = f"Recipes, {what}: {share:.0%}" if share < 1 else "Recipes"
        bar.render_progress()

    counted: ProgressBar[Path] = click.progressbar(
        length=len(files),
        label="Recipes",
        item_show_func=lambda f: printable(f.stem) if f else "",
        file=sys.stderr,
        hidden=hidden,
    )
    with counted as bar, progress_shown() if hidden else progress_to(show):
        bar.update(0, files[0])
        killed = Problem("", "its process was killed", LARGER, "too-much-work")
        for file, following, outcome in zip(files, [*files[1:], None], each(partial(_tried, action), files)):
            outcomes.append(outcome or Refused(f"{printable(file)}: {killed.problem}; {LARGER}", (killed,)))
            bar.update(1, following)
    return list(zip(files, outcomes))


def _tried(action: Callable[[Path], R], file: Path) -> R | Refused:
    """The result of an action on a recipe, or the reason why there is none."""
    try:
        return action(file)
    except Exception as error:
        # An internal error is reported too, and the other recipes are made.
        return refusal(file, error)


def refusal(file: Path, error: Exception) -> Refused:
    """The reason why a recipe was not made, from an error."""
    from ..core.errors import DesignError, FileError, GeomkinError, Problem, RecipeError, printable

    match error:
        case RecipeError():
            return Refused(str(error), error.problems)
        case DesignError():
            return Refused(str(error), (error.as_problem,))
        case FileError():
            return Refused(str(error), (Problem("", f"{error.file} {error.problem}", error.remedy, error.id),))
        case GeomkinError():
            return Refused(str(error), (Problem("", str(error), "", "internal"),))
        case MemoryError():
            problem = Problem("", "not enough memory", LARGER, "too-much-work")
        case _:
            fault = printable(f"{type(error).__name__}: {error}", 200)
            problem = Problem("", f"internal error ({fault})", "please report it with this recipe", "internal")
    return Refused(f"{printable(file)}: {problem.problem}; {problem.remedy}", (problem,))


@contextmanager
def ended_if_refused(file: Path, as_json: bool = False) -> Iterator[None]:
    """Within this context progress is shown, and an error of the recipe ends the command."""
    from ..core.errors import GeomkinError

    try:
        with progress_shown():
            yield
    except GeomkinError as error:
        refused = refusal(file, error)
        end([(file, refused)], True) if as_json else click.secho(refused.text, fg="red", err=True)
        sys.exit(1)


@contextmanager
def option_errors(name: str) -> Iterator[None]:
    """Within this context a DesignError is an error of the option or argument `name` of the command."""
    from ..core.errors import DesignError, harmless

    try:
        yield
    except DesignError as error:
        raise click.BadParameter(harmless(f"{error.problem}; {error.remedy}"), param_hint=name) from None


def made_of(outcomes: Outcomes[R]) -> list[R]:
    """The results of the recipes that were not refused."""
    return [outcome for _, outcome in outcomes if not isinstance(outcome, Refused)]


def print_refusals(outcomes: Outcomes[R]) -> None:
    """Print the reasons of the recipes that were refused, to the stream of errors."""
    for _, outcome in outcomes:
        if isinstance(outcome, Refused):
            click.secho(outcome.text, fg="red", err=True)


def end(outcomes: Outcomes[Made], as_json: bool = False) -> NoReturn:
    """End the command with the exit status of the outcomes; with `as_json` print them first."""
    for file, outcome in outcomes if as_json else ():
        if isinstance(outcome, Refused):
            problems = [problem.to_dict() for problem in outcome.problems]
            print_json({"name": file.stem, "file": str(file), "problems": problems})
        else:
            about = {"name": outcome.name, "kind": outcome.kind, "file": str(file)}
            checks = [check.to_dict() for check in outcome.checks]
            print_json({**about, "checks": checks, "files": list(map(str, outcome.files)), "remarks": outcome.remarks})
    sys.exit(1 if len(made_of(outcomes)) < len(outcomes) else 0)


def print_json(data: dict[str, object]) -> None:
    """Print JSON on one line."""
    import json

    from ..export.summary import as_json

    click.echo(json.dumps(as_json(data)))


def progress_shown() -> AbstractContextManager[None]:
    """Within this context, progress is shown on one line of the terminal."""
    from ..core.progress import progress_to

    def show(share: float, what: str) -> None:
        if _is_terminal(sys.stderr):
            click.echo("\r\x1b[K" + (f"{what}: {share:.0%}" if share < 1 else ""), nl=False, err=True)

    return progress_to(show)


def _is_terminal(stream: TextIO | None) -> bool:
    """Whether a stream is a terminal; a closed stream is None."""
    return stream is not None and stream.isatty()


def _row(result: Made) -> tuple[str, str, str, str]:
    """Cells of a recipe in the report: folder, endings and size of its files, and the checks that passed."""
    from ..core.errors import printable

    endings = list(dict.fromkeys(path.suffix[1:] for path in result.files))
    size = sum(result.files.values()) / 1000
    passed = sum(c.passed for c in result.checks)
    folder = next(iter(result.files)).parent if result.files else ""
    return printable(folder), " ".join(endings), f"{size:,.0f} kB", f"{passed} of {len(result.checks)} passed"


def _line(result: Made) -> str:
    """The result of a recipe on one line, for files and other programs."""
    folder, endings, size, checks = _row(result)
    return f"{folder}: {endings}, {size}, checks {checks}"


def print_made(made: list[Made]) -> None:
    """Print a line for each recipe; on a terminal, a table."""
    if not _is_terminal(sys.stdout):
        click.echo("\n".join(map(_line, made)))
        return
    rows = [("recipe", "files", "size", "checks"), *map(_row, made)]
    widths = [max(len(row[k]) for row in rows) for k in range(4)]
    for row in rows:
        click.echo("  ".join(cell.ljust(w) for cell, w in zip(row, widths)).rstrip())
