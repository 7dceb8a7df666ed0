"""The commands: run, verify, check, columns, sweep, optimise, studio, list, new, schema, chart."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable
from contextlib import AbstractContextManager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, NoReturn, TextIO, TypeVar

import click

from .export.formats import WRITERS

if TYPE_CHECKING:
    from click._termui_impl import ProgressBar

    from .build import Made
    from .core.errors import Problem


R = TypeVar("R")
# Remedy if memory runs out.
LARGER = "give a larger tolerance"

_recipes = click.argument(
    "recipes", nargs=-1, required=True, type=click.Path(exists=True, path_type=Path), metavar="RECIPE_OR_FOLDER..."
)


_as_json = click.option(
    "--json", "as_json", is_flag=True,
    help='Print one JSON object per recipe instead of text; nan is null, infinite is "inf".',
)  # fmt: skip

EXIT_STATUS = """\b
Exit status:
  0  done; checks of a design may have failed
  1  a recipe was refused or could not be made (the other recipes were made), or a file is not as designed
  2  the command was called wrongly; nothing was done"""


def _formats(context: click.Context, parameter: click.Parameter, value: str | None) -> list[str] | None:
    """The formats in a comma-separated list."""
    chosen = None if value is None else [part.strip() for part in value.split(",")]
    if unknown := [ending for ending in chosen or () if ending not in WRITERS]:
        raise click.BadParameter(f"unknown format {unknown[0]!r}; choose from {', '.join(WRITERS)}")
    return chosen


@click.group(context_settings={"help_option_names": ["-h", "--help"]}, epilog=EXIT_STATUS)
@click.version_option(package_name="geomkin")
def cli() -> None:
    """Turn text recipes into planar mechanisms: linkages, cams and gears.

    Start with `geomkin list` and `geomkin new KIND > my.toml`; then `geomkin run my.toml` writes drawings to cut,
    solids to print, the motion as CSV, and an animated page.
    """


@cli.command()
@_recipes
@click.option("--out", default="out", show_default=True, type=click.Path(path_type=Path), help="Folder for the files.")
@click.option(
    "--only", callback=_formats, metavar="FORMAT,...",
    help=f"Write only these formats ({', '.join(WRITERS)}).",
)  # fmt: skip
@click.option(
    "--verify",
    "verified",
    is_flag=True,
    help="Afterwards read the files back and measure them, as `geomkin verify` does.",
)
@_as_json
def run(recipes: tuple[Path, ...], out: Path, only: list[str] | None, verified: bool, as_json: bool) -> None:
    """Write the files of recipes into OUT/<recipe>/.

    A folder stands for all recipes in it. With several recipes it also writes OUT/index.html, a page with a card for
    each.
    """
    from .build import index, make
    from .core.errors import FileError, harmless, printable

    files = _files(recipes)
    _refuse_twins(files)
    outcomes = _each(files, partial(make, out=out, only=only))
    made = _made(outcomes)
    sound = not verified or all(_verified([out / result.name for result in made], as_json))
    if made and only is None and (len(files) > 1 or recipes[0].is_dir()):
        try:
            index(out)
        except FileError as error:
            click.secho(str(error), fg="yellow", err=True)
    if as_json:
        _end(outcomes, as_json)
    _print_refusals(outcomes)
    if made:
        click.echo(_report(made) if _is_terminal(sys.stdout) else "\n".join(map(_line, made)))
    for result in made:
        for remark in result.remarks:
            click.echo(f"{printable(result.name)}: {remark}", err=True)
        for check in result.checks:
            if not check.passed:
                click.secho(f"{printable(result.name)}: check failed: {harmless(check)}", fg="yellow", err=True)
    if not sound:
        sys.exit(1)
    _end(outcomes)


@cli.command()
@click.argument("folders", nargs=-1, required=True, type=click.Path(exists=True, file_okay=False, path_type=Path))
@_as_json
def verify(folders: tuple[Path, ...], as_json: bool) -> None:
    """Measure the files in FOLDERS against their recipes.

    Reads every file back and compares it with the exact curves of its recipe. A folder is that of one recipe, or
    contains such folders. Writes verify.json and verify.html into the folder of each recipe. The exit status is 1 if a
    file is not as designed.
    """
    if not all(_verified(folders, as_json)):
        sys.exit(1)


def _verified(folders: Iterable[Path], as_json: bool) -> list[bool]:
    """Verify folders and print the result of each recipe. Returns whether each is as designed."""
    from .core.errors import FileError, harmless, printable
    from .verification.certificate import recipe_folders
    from .verification.certificate_files import certify

    results: list[bool] = []
    to_verify: list[Path] = []
    for folder in folders:
        try:
            to_verify += recipe_folders(folder)
        except FileError as error:
            click.secho(str(error), fg="red", err=True)
            results.append(False)
    outcomes = _each(to_verify, certify) if to_verify else []
    _print_refusals(outcomes)
    results += [False] * (len(outcomes) - len(_made(outcomes)))
    for certificate in _made(outcomes):
        results.append(certificate.passed)
        if as_json:
            _print_json(certificate.to_dict())
            continue
        measured = [file for file in certificate.files if file.measured]
        verdict = "as designed" if certificate.passed else "NOT as designed"
        click.echo(f"{printable(certificate.folder)}: {len(measured)} files measured, {verdict}")
        problems = [f"{file.file}: {problem}" for file in certificate.files for problem in file.problems]
        for problem in [*certificate.problems, *problems]:
            click.secho(f"  {harmless(problem)}", fg="yellow")
    return results


@cli.command("check")
@_recipes
@_as_json
def check_command(recipes: tuple[Path, ...], as_json: bool) -> None:
    """Validate recipes and show their checks; write nothing."""
    from .build import check_recipe
    from .core.errors import harmless, printable

    outcomes = _each(_files(recipes), check_recipe)
    if as_json:
        _end(outcomes, as_json)
    _print_refusals(outcomes)
    for result in _made(outcomes):
        click.echo(printable(result.name))
        for check in result.checks:
            click.echo(f"  {'pass' if check.passed else 'FAIL'}  {harmless(check)}")
        for fact in result.facts:
            click.echo(f"        {printable(fact)}")
        for remark in result.remarks:
            click.echo(f"        {printable(remark)}")
    _end(outcomes)


@cli.command()
@click.argument("recipe", type=click.Path(exists=True, dir_okay=False, path_type=Path))
def columns(recipe: Path) -> None:
    """List the columns of a RECIPE's table.

    Each line has the id, the unit and the meaning of a column.
    """
    from .build import errors_named_by_key, load
    from .core.errors import GeomkinError, printable

    try:
        loaded = load(recipe)
        with errors_named_by_key(str(recipe), loaded):
            lines = [(column.id, column.unit, column.meaning) for column in loaded.table.columns]
    except GeomkinError as error:
        click.secho(str(error), fg="red", err=True)
        sys.exit(1)
    wide, units = (max(len(line[k]) for line in lines) for k in (0, 1))
    for id, unit, meaning in lines:
        click.echo(printable(f"{id:<{wide}}  {unit:<{units}}  {meaning}", 500))


@cli.command()
@click.argument("recipe", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option(
    "--set", "settings", multiple=True, required=True, metavar="KEY=VALUES",
    help="Values of a key: gear.teeth=8:120:4 (start:stop:step) or gear.profile_shift=-0.5,0,0.5; once for each key. "
    "Items of a list are numbered from [0]: cam.program[1].rise=10,20.",
)  # fmt: skip
@click.option(
    "--result", "results", multiple=True, metavar="NAME",
    help="A result besides the checks: COLUMN:least, COLUMN:largest or COLUMN:last, or an entry of summary.json.",
)  # fmt: skip
@click.option("--out", default="out", show_default=True, type=click.Path(path_type=Path), help="Folder for the files.")
@_as_json
def sweep(recipe: Path, settings: tuple[str, ...], results: tuple[str, ...], out: Path, as_json: bool) -> None:
    """Evaluate a RECIPE for all combinations of values.

    Writes a table and a page, OUT/<recipe>/<recipe>.sweep.csv and .html. A sweep that was stopped continues with
    the same command.
    """
    from .core.errors import GeomkinError, harmless, printable
    from .sweeps.sweep import by_processes, swept

    values: dict[str, str] = {}
    for setting in settings:
        key, equals, listed = setting.partition("=")
        if not equals or key.strip() in values:
            problem = "is given twice" if equals else "has no values"
            raise click.BadParameter(f"{printable(key.strip())} {problem}; give KEY=VALUES once for each key")
        values[key.strip()] = listed
    try:
        with _progress():
            result = swept(recipe, values, results, out, by_processes)
    except GeomkinError as error:
        refused = _refused(recipe, error)
        _end([(recipe, refused)], True) if as_json else click.secho(refused.text, fg="red", err=True)
        sys.exit(1)
    if result.is_restarted:
        why = "the earlier run is of another recipe, other results or another version, or damaged"
        click.echo(f"started again: {why}", err=True)
    refusals = [row.refused for row in result.rows if row.refused]
    if as_json:
        rows = [
            {"values": row.values, "refused": row.refused, "checks": [c.to_dict() for c in row.checks]}
            | {"results": row.results}
            for row in result.rows
        ]
        about = {"name": result.name, "kind": result.kind, "file": str(recipe)}
        _print_json({**about, "rows": rows, "files": list(map(str, result.files))})
    else:
        counts = f"{len(result.rows):,} combinations, {result.reused:,} of them reused, {len(refusals):,} refused"
        click.echo(f"{', '.join(map(printable, result.files))}: {counts}")
    if len(refusals) == len(result.rows):
        click.secho(f"all combinations are refused; the first one: {harmless(refusals[0])}", fg="red", err=True)
        sys.exit(1)


@cli.command("optimise")
@click.argument("recipe", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option(
    "--vary", "ranges", multiple=True, metavar="KEY=LOW:HIGH",
    help="Range of a number: linkage.crank=20:40; once for each key. If the key holds a whole number, every "
    "whole number in the range is tried.",
)  # fmt: skip
@click.option(
    "--minimise", "objectives", multiple=True, metavar="FORMULA",
    help="Result to minimise: max(rocker_omega), or -min(transmission_angle) for a maximum; several: Pareto front.",
)  # fmt: skip
@click.option(
    "--subject-to", "constraints", multiple=True, metavar="CONSTRAINT",
    help="A constraint, such as 'min(transmission_angle) >= 40'.",
)  # fmt: skip
@click.option("--starts", default=6, show_default=True, help="Number of gradient searches.")
@click.option("--seed", default=0, show_default=True, help="Seed of the random designs.")
@click.option("--time-limit", default=60.0, show_default=True, help="Time limit, s; the best design by then is taken.")
@click.option("--out", default="out", show_default=True, type=click.Path(path_type=Path), help="Folder for the file.")
def optimise_command(
    recipe: Path, ranges: tuple[str, ...], objectives: tuple[str, ...], constraints: tuple[str, ...],
    starts: int, seed: int, time_limit: float, out: Path,
) -> None:  # fmt: skip
    """Find the best values of a RECIPE's keys.

    The recipe's table [optimise] or these options state the task; an option replaces its entry in the table. Writes
    OUT/<recipe>/<recipe>.optimum.toml, a recipe with these values; with several objectives a table, a picture and a
    recipe for each design of their Pareto front. Ctrl-C ends the search; the best so far is written.
    """
    import signal

    from .core.errors import GeomkinError, harmless, printable
    from .optimisation.optimiser import optimise, ranges_of

    try:
        vary = ranges_of(ranges) or None
    except GeomkinError as error:
        raise click.BadParameter(harmless(error), param_hint="--vary") from None
    # Ctrl-C ends the search, not the process.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with _progress():
            minimise = objectives[0] if len(objectives) == 1 else objectives or None
            best = optimise(recipe, vary, minimise, list(constraints) or None, starts, seed, time_limit, out)
    except GeomkinError as error:
        click.secho(_refused(recipe, error).text, fg="red", err=True)
        sys.exit(1)
    for line in best.lines:
        click.echo(harmless(line))
    note = ", ended before it was complete" if best.cut_short else ""
    click.echo(f"{', '.join(map(printable, best.files))}: {best.evaluations:,} designs tried{note}")


def _progress() -> AbstractContextManager[None]:
    """Within this context, progress is shown on one line of the terminal."""
    from .core.progress import shown

    def show(share: float, what: str) -> None:
        if _is_terminal(sys.stderr):
            _overwrite(f"{what}: {share:.0%}" if share < 1 else "")

    return shown(show)


def _overwrite(line: str) -> None:
    """Replace the last line on the terminal."""
    click.echo(f"\r\x1b[K{line}", nl=False, err=True)


@cli.command()
@click.argument("recipe", required=False, type=click.Path(exists=True, path_type=Path), metavar="[RECIPE_OR_FOLDER]")
@click.option(
    "--port", default=8017, show_default=True, type=click.IntRange(1, 65535), help="Port, or the next free one."
)
@click.option("--no-browser", is_flag=True, help="Only print the address.")
def studio(recipe: Path | None, port: int, no_browser: bool) -> None:
    """Edit recipes in the browser by dragging the mechanism.

    Shows the motion and the checks while you drag and type. Without a recipe it offers all kinds and the recipes of the
    working folder. Ctrl-C ends it.
    """
    import gc
    import signal
    import webbrowser
    from contextlib import suppress

    from .studio.server import Studio, StudioServer
    from .studio.workspace import Workspace

    # A server runs for long: it must handle Ctrl-C itself and free its memory.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    gc.set_threshold(700, 10, 10)
    place = recipe or Path()
    folder, first = (place, "") if place.is_dir() else (place.parent, place.stem)
    with StudioServer(Studio(Workspace(folder), first), port) as server, suppress(KeyboardInterrupt):
        click.echo(server.url)
        if not no_browser:
            webbrowser.open(server.url)
        server.serve_forever(poll_interval=0.2)


@cli.command("list")
def list_command() -> None:
    """List the kinds of mechanism."""
    from .recipe.kinds import all_kinds, recipe_class

    kinds = all_kinds()
    width = max(map(len, kinds))
    for group in dict.fromkeys(row.group for row in kinds.values()):
        click.echo(group)
        for name in (name for name, row in kinds.items() if row.group == group):
            click.echo(f"  {name:<{width}}  {recipe_class(name).about()}")


@cli.command()
@click.argument("name", metavar="KIND")
@click.option(
    "--with", "options", multiple=True, metavar="TABLE[=KIND]",
    help="Show another kind of table (follower=oscillating-roller), or an optional table (web).",
)  # fmt: skip
def new(name: str, options: tuple[str, ...]) -> None:
    """Print a recipe of a KIND with every key explained.

    The recipe runs without changes.
    """
    from .core.errors import DesignError, printable
    from .recipe.kinds import kind_names, recipe_class

    try:
        recipe = recipe_class(name)
    except KeyError:
        from .recipe.messages import nearest

        kinds = kind_names()
        remedy = f"{nearest(name, kinds)}choose from {', '.join(kinds)}"
        raise click.BadParameter(f"unknown kind {printable(name)!r}; {remedy}") from None
    from .recipe.template import template

    try:
        text = template(recipe, options)
    except DesignError as error:
        raise click.BadParameter(f"{error.problem}; {error.remedy}", param_hint="--with") from None
    click.echo(text, nl=False)


@cli.command()
def schema() -> None:
    """Print a JSON Schema of all recipes, for editors."""
    import json

    from .recipe.template import schema

    click.echo(json.dumps(schema(), indent=1))


@cli.command("chart")
@click.argument("families", nargs=-1, metavar="[FAMILY]...")
@click.option("--quick", is_flag=True, help="Take about a minute: fewer settings, without the slowest methods.")
@click.option("--out", default="out", show_default=True, type=click.Path(path_type=Path), help="Folder for the files.")
def chart_command(families: tuple[str, ...], quick: bool, out: Path) -> None:
    """Measure the methods: time per result against error.

    Measures all families of methods, or only those given, and writes tables, pictures and a page into OUT/chart/.
    """
    from importlib.util import find_spec

    from .core.errors import DesignError, GeomkinError, printable
    from .export.files import write_whole
    from .tradeoff.files import chart_files
    from .tradeoff.results import chart
    from .tradeoff.study import stability

    try:
        with _progress():
            measured = chart(families, quick)
        # The study of where methods lose digits needs mpmath.
        study = stability() if not families and find_spec("mpmath") else None
        write_whole(out / "chart", chart_files(measured, study))
    except DesignError as error:
        raise click.BadParameter(f"{error.problem}; {error.remedy}", param_hint="FAMILY") from None
    except GeomkinError as error:
        raise click.ClickException(str(error)) from None
    count, points = len(measured.families), sum(len(family.points) for family in measured.families)
    click.echo(f"{printable(out / 'chart', 200)}: {count} famil{'y' if count == 1 else 'ies'}, {points} points")


def _files(paths: Iterable[Path]) -> list[Path]:
    """The named recipes, and those in the named folders, in order."""
    from .core.errors import printable

    files: list[Path] = []
    for path in paths:
        inside = sorted(path.glob("*.toml")) if path.is_dir() else [path]
        if not inside:
            raise click.UsageError(f"no recipe (*.toml) in {printable(path)}")
        files += [f for f in inside if f not in files]
    return files


def _refuse_twins(files: list[Path]) -> None:
    stems = [f.stem for f in files]
    twins = [f for f in files if stems.count(f.stem) > 1]
    if twins:
        from .core.errors import printable

        named = " and ".join(map(printable, twins))
        raise click.UsageError(f"{named} would write the same folder; run them with another --out")


class Refused(NamedTuple):
    """The reason why a recipe was not made, as text and as problems."""

    text: str
    problems: tuple[Problem, ...]


Outcomes = list[tuple[Path, "R | Refused"]]


def _each(files: list[Path], action: Callable[[Path], R]) -> Outcomes[R]:
    """The outcome of each recipe, in the order of the files."""
    from .core.errors import Problem, printable
    from .core.processes import each
    from .core.progress import shown

    outcomes: list[R | Refused] = []
    hidden = len(files) < 2 or not _is_terminal(sys.stderr)

    def show(share: float, what: str) -> None:
        """Show the progress within a recipe: on a line with a single recipe, otherwise in the bar."""
        if not _is_terminal(sys.stderr):
            return
        if hidden:
            _overwrite(f"{what}: {share:.0%}" if share < 1 else "")
        else:
            bar.label = f"Recipes, {what}: {share:.0%}" if share < 1 else "Recipes"
            bar.render_progress()

    counted: ProgressBar[Path] = click.progressbar(
        length=len(files),
        label="Recipes",
        item_show_func=lambda f: printable(f.stem) if f else "",
        file=sys.stderr,
        hidden=hidden,
    )
    with counted as bar, shown(show):
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
        return _refused(file, error)


def _refused(file: Path, error: Exception) -> Refused:
    from .core.errors import DesignError, FileError, GeomkinError, Problem, RecipeError, printable

    match error:
        case RecipeError():
            return Refused(str(error), error.problems)
        case DesignError():
            return Refused(str(error), (Problem(error.field, error.problem, error.remedy, error.id),))
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


def _made(outcomes: Outcomes[R]) -> list[R]:
    return [outcome for _, outcome in outcomes if not isinstance(outcome, Refused)]


def _print_refusals(outcomes: Outcomes[R]) -> None:
    for _, outcome in outcomes:
        if isinstance(outcome, Refused):
            click.secho(outcome.text, fg="red", err=True)


def _end(outcomes: Outcomes[Made], as_json: bool = False) -> NoReturn:
    """End the command with the exit status of the outcomes; with `as_json` print them first."""
    for file, outcome in outcomes if as_json else ():
        if isinstance(outcome, Refused):
            names = ("id", "key", "problem", "remedy")
            problems = [{name: getattr(problem, name) for name in names} for problem in outcome.problems]
            _print_json({"name": file.stem, "file": str(file), "problems": problems})
        else:
            about = {"name": outcome.name, "kind": outcome.kind, "file": str(file)}
            checks = [check.to_dict() for check in outcome.checks]
            _print_json({**about, "checks": checks, "files": list(map(str, outcome.files)), "remarks": outcome.remarks})
    sys.exit(1 if len(_made(outcomes)) < len(outcomes) else 0)


def _print_json(data: dict[str, object]) -> None:
    """Print JSON on one line."""
    import json

    from .export.summary import as_json

    click.echo(json.dumps(as_json(data)))


def _is_terminal(stream: TextIO | None) -> bool:
    """Whether a stream is a terminal; a closed stream is None."""
    return stream is not None and stream.isatty()


def _row(result: Made) -> tuple[str, str, str, str]:
    """Cells of a recipe in the report: folder, endings and size of its files, and the checks that passed."""
    from .core.errors import printable

    endings = list(dict.fromkeys(path.suffix[1:] for path in result.files))
    size = sum(result.files.values()) / 1000
    passed = sum(c.passed for c in result.checks)
    folder = next(iter(result.files)).parent if result.files else ""
    return printable(folder), " ".join(endings), f"{size:,.0f} kB", f"{passed} of {len(result.checks)} passed"


def _line(result: Made) -> str:
    """The result of a recipe on one line, for files and other programs."""
    folder, endings, size, checks = _row(result)
    return f"{folder}: {endings}, {size}, checks {checks}"


def _report(made: list[Made]) -> str:
    """A table with one row for each recipe."""
    rows = [("recipe", "files", "size", "checks"), *map(_row, made)]
    widths = [max(len(row[k]) for row in rows) for k in range(4)]
    return "\n".join("  ".join(cell.ljust(w) for cell, w in zip(row, widths)).rstrip() for row in rows)
