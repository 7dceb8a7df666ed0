"""The recipes that a command is given, and the outcome of each: progress, refusals, text or JSON, exit status."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import AbstractContextManager, contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, NoReturn, TextIO, TypeVar

import click

if TYPE_CHECKING:
    from click._termui_impl import ProgressBar

    from ..build import Made
    from ..core.errors import Problem


R = TypeVar("R")
# Exit status if checks failed, with --strict.
FAILED = 3
# Largest number of failed checks whose explanation is offered in one line.
MOST_EXPLAINED = 6
# Remedy if memory runs out.
LARGER = "give a larger tolerance"

# A missing file is refused as any other recipe is, so that a program reads the reason as JSON.
recipe_arguments = click.argument(
    "recipes", nargs=-1, required=True, type=click.Path(path_type=Path), metavar="RECIPE_OR_FOLDER..."
)
one_recipe = click.argument("recipe", type=click.Path(dir_okay=False, path_type=Path))
out_folder = click.option(
    "--out", default="out", show_default=True, type=click.Path(path_type=Path), help="Folder for the files."
)
json_option = click.option(
    "--json", "as_json", is_flag=True,
    help='Print one JSON object per recipe instead of text; nan is null, infinite is "inf".',
)  # fmt: skip
strict_option = click.option(
    "--strict", is_flag=True, help="End with exit status 3 if a check failed that the recipe does not expect to fail."
)
# Stands for the standard input.
STDIN = Path("-")


def source_of(recipe: Path) -> Path | str:
    """A recipe's file, or the text that the standard input holds if its name is `-`."""
    if recipe != STDIN:
        return recipe
    content = sys.stdin.buffer.read()
    try:
        # A text ends with a line break; without one it would be a path.
        return content.decode("utf-8-sig").replace("\r\n", "\n") + "\n"
    except UnicodeDecodeError as error:
        raise click.UsageError(f"byte {error.start} of the standard input is not UTF-8; give a recipe") from None


def recipe_files(paths: Iterable[Path]) -> list[Path]:
    """The named recipes, and those in the named folders, in order."""
    from ..core.errors import printable

    files: list[Path] = []
    for path in paths:
        inside = sorted(path.glob("*.toml")) if os.path.isdir(path) else [path]
        if not inside:
            raise click.UsageError(f"no recipe (*.toml) in {printable(path)}")
        files += [f for f in inside if f not in files]
    return files


class Refused(NamedTuple):
    """The reason why a recipe was not made, as text and as problems."""

    text: str
    problems: tuple[Problem, ...]


Outcomes = list[tuple[Path, "R | Refused"]]


def outcomes_of(files: list[Path], action: Callable[[Any], R]) -> Outcomes[R]:
    """The outcome of each recipe, in the order of the files."""
    from ..core.errors import Problem, printable
    from ..core.processes import each, progress_to

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
        results = each(partial(_tried, action), [*map(source_of, files)])
        for file, following, outcome in zip(files, [*files[1:], None], results):
            outcomes.append(outcome or Refused(f"{printable(file)}: {killed.problem}; {LARGER}", (killed,)))
            bar.update(1, following)
    return list(zip(files, outcomes))


def _tried(action: Callable[[Any], R], source: Path | str) -> R | Refused:
    """The result of an action on a recipe, or the reason why there is none."""
    try:
        return action(source)
    except Exception as error:
        # An internal error is reported too, and the other recipes are made.
        return refusal(source if isinstance(source, Path) else STDIN, error)


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


def end(outcomes: Outcomes[Made], as_json: bool = False, strict: bool = False, sound: bool = True) -> NoReturn:
    """End the command with the exit status of the outcomes; with `as_json` print them first.

    sound: whether all written files are as designed.
    """
    for file, outcome in outcomes if as_json else ():
        if isinstance(outcome, Refused):
            problems = [problem.to_dict() for problem in outcome.problems]
            print_json({"name": file.stem, "file": str(file), "problems": problems})
        else:
            about = {"name": outcome.name, "kind": outcome.kind, "file": str(file)}
            checks = [check.to_dict() for check in outcome.checks]
            texts = {"remarks": outcome.remarks, "facts": outcome.facts}
            print_json({**about, "checks": checks, "files": list(map(str, outcome.files)), **texts})
    made = made_of(outcomes)
    failed = strict and any(result.failed_checks for result in made)
    sys.exit(1 if len(made) < len(outcomes) or not sound else FAILED if failed else 0)


def print_json(data: dict[str, object]) -> None:
    """Print JSON on one line."""
    import json

    from ..export.text import as_json

    click.echo(json.dumps(as_json(data)))


def progress_shown() -> AbstractContextManager[None]:
    """Within this context, progress is shown on one line of the terminal."""
    from ..core.processes import progress_to

    def show(share: float, what: str) -> None:
        if _is_terminal(sys.stderr):
            click.echo("\r\x1b[K" + (f"{what}: {share:.0%}" if share < 1 else ""), nl=False, err=True)

    return progress_to(show)


def _is_terminal(stream: TextIO | None) -> bool:
    """Whether a stream is a terminal; a closed stream is None."""
    return stream is not None and stream.isatty()


def print_results(outcomes: Outcomes[Made]) -> None:
    """Print the results of recipes, and to the stream of errors the reasons of those that were refused.

    `check` and `run` print the same lines. Of several recipes, only checks that failed, advice and files are printed.
    """
    from ..core.errors import harmless, printable

    print_refusals(outcomes)
    for result in made_of(outcomes):
        passed, all_lines = sum(check.passed for check in result.checks), len(outcomes) == 1
        click.echo(f"{printable(result.name)}: {passed} of {len(result.checks)} checks passed")
        for check in result.checks:
            if not check.passed:
                click.secho(f"  FAIL  {harmless(check)}", fg="yellow")
            elif all_lines:
                click.echo(f"  pass  {harmless(check)}")
        if result.failed_checks:
            ids = [check.id for check in result.checks if not check.passed]
            click.echo(f"  more  geomkin explain {harmless(' '.join(ids[:MOST_EXPLAINED]))}")
        for remark in result.remarks:
            click.secho(f"  note  {harmless(remark)}", fg="yellow")
        for fact in result.facts if all_lines else ():
            click.echo(f"        {harmless(fact)}")
        if result.files:
            folder, size = next(iter(result.files)).parent, sum(result.files.values()) / 1000
            endings = " ".join(dict.fromkeys(path.suffix[1:] for path in result.files))
            click.echo(f"  made  {printable(folder, 200)}: {endings}, {size:,.0f} kB")
