"""The commands: run, check, columns, sweep, studio, list, new, schema, chart."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, NoReturn, TextIO

import click

from .export.formats import WRITERS

if TYPE_CHECKING:
    from click._termui_impl import ProgressBar

    from .build import Made
    from .core.errors import Problem


# What helps where there is not enough memory.
LARGER = "give a larger tolerance"

_recipes = click.argument(
    "recipes", nargs=-1, required=True, type=click.Path(exists=True, path_type=Path), metavar="RECIPE_OR_FOLDER..."
)


_as_json = click.option(
    "--json", "as_json", is_flag=True, help="Print one JSON object per recipe instead; nan is null, infinity a text."
)

EXIT_STATES = """\b
Exit states:
  0  done; checks of a design may have failed
  1  a recipe was refused or could not be made; with several recipes the others were made
  2  the command was called wrongly; nothing was done"""


def _formats(context: click.Context, parameter: click.Parameter, value: str | None) -> list[str] | None:
    """The formats in a list with commas."""
    chosen = None if value is None else [part.strip() for part in value.split(",")]
    if unknown := [ending for ending in chosen or () if ending not in WRITERS]:
        raise click.BadParameter(f"unknown format {unknown[0]!r}; choose of {', '.join(WRITERS)}")
    return chosen


@click.group(context_settings={"help_option_names": ["-h", "--help"]}, epilog=EXIT_STATES)
@click.version_option(package_name="geomkin")
def cli() -> None:
    """Turn text recipes into planar mechanisms: DXF, STL and SVG to make them, their motion as CSV and as a page."""


@cli.command()
@_recipes
@click.option("--out", default="out", show_default=True, type=click.Path(path_type=Path), help="Folder for the files.")
@click.option(
    "--only", callback=_formats, metavar="FORMAT,...",
    help=f"Write only these of the recipe's formats ({', '.join(WRITERS)}).",
)  # fmt: skip
@_as_json
def run(recipes: tuple[Path, ...], out: Path, only: list[str] | None, as_json: bool) -> None:
    """Make recipes, or all recipes of folders, into OUT/<recipe>/, and of several a page over them, OUT/index.html."""
    from .build import index, make
    from .core.errors import FileError, harmless, printable

    files = _files(recipes)
    _refuse_twins(files)
    outcomes = _each(files, partial(make, out=out, only=only))
    made = _made(outcomes)
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
    _end(outcomes)


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
    """List the columns of a RECIPE's table: id, unit and meaning of each."""
    from .build import errors_named_by_key, load
    from .core.errors import GeomkinError, printable

    try:
        found = load(recipe)
        with errors_named_by_key(str(recipe), found):
            lines = [(column.id, column.unit, column.meaning) for column in found.table.columns]
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
    help="Values of a key: gear.teeth=8:120:4 (start:stop:step), gear.profile_shift=-0.5,0,0.5, or of a list's item, "
    "the first being [0]: cam.program[1].rise=10,20; once for each key.",
)  # fmt: skip
@click.option(
    "--result", "results", multiple=True, metavar="NAME",
    help="A result besides the checks: COLUMN:least, :largest or :last of the table, or an entry of the notes.",
)  # fmt: skip
@click.option("--out", default="out", show_default=True, type=click.Path(path_type=Path), help="Folder for the files.")
@_as_json
def sweep(recipe: Path, settings: tuple[str, ...], results: tuple[str, ...], out: Path, as_json: bool) -> None:
    """Work out a RECIPE for all combinations of values, into OUT/<recipe>/<recipe>.sweep.csv and .html.

    One that was stopped goes on where it was.
    """
    from .core.errors import GeomkinError, harmless, printable
    from .core.progress import shown
    from .sweeps.sweep import by_processes, swept

    values: dict[str, str] = {}
    for setting in settings:
        key, equals, listed = setting.partition("=")
        if not equals or key.strip() in values:
            problem = "is given twice" if equals else "has no values"
            raise click.BadParameter(f"{printable(key.strip())} {problem}; give KEY=VALUES once for each key")
        values[key.strip()] = listed
    watched = _is_terminal(sys.stderr)
    try:
        with shown(lambda share, what: _overwrite(f"{what}: {share:.0%}" if share < 1 else "") if watched else None):
            found = swept(recipe, values, results, out, by_processes)
    except GeomkinError as error:
        refused = _refused(recipe, error)
        _end([(recipe, refused)], True) if as_json else click.secho(refused.text, fg="red", err=True)
        sys.exit(1)
    if found.anew:
        click.echo(
            "begun anew: an earlier run was of another recipe, other results or another version, or is damaged",
            err=True,
        )
    refusals = [row.refused for row in found.rows if row.refused]
    if as_json:
        rows = [
            {
                "values": row.values,
                "refused": row.refused,
                "checks": [check.to_dict() for check in row.checks],
                "results": row.results,
            }
            for row in found.rows
        ]
        _print_json(
            {
                "name": found.name,
                "kind": found.kind,
                "file": str(recipe),
                "rows": rows,
                "files": list(map(str, found.files)),
            }
        )
    else:
        counts = f"{len(found.rows):,} combinations, {found.kept:,} of them from before, {len(refusals):,} refused"
        click.echo(f"{', '.join(map(printable, found.files))}: {counts}")
    if len(refusals) == len(found.rows):
        click.secho(f"all are refused, the first for this: {harmless(refusals[0])}", fg="red", err=True)
        sys.exit(1)


def _overwrite(line: str) -> None:
    """A line in place of the one before."""
    click.echo(f"\r\x1b[K{line}", nl=False, err=True)


@cli.command()
@click.argument("recipe", required=False, type=click.Path(exists=True, path_type=Path), metavar="[RECIPE_OR_FOLDER]")
@click.option("--port", default=8017, show_default=True, type=click.IntRange(1, 65535), help="Or the next free one.")
@click.option("--no-browser", is_flag=True, help="Print the address only.")
def studio(recipe: Path | None, port: int, no_browser: bool) -> None:
    """Edit a RECIPE, or one of a folder, in the browser: drag the mechanism, see its motion and checks, save.

    Without a recipe it shows all kinds and the recipes of the working folder. Ctrl-C ends it.
    """
    import gc
    import signal
    import webbrowser
    from contextlib import suppress

    from .studio.server import Studio, StudioServer
    from .studio.workspace import Workspace

    # The settings of a short process do not suit a server: it ends by itself, and lives long.
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
    help="Show a table of another kind (follower=oscillating-roller), or one that may be left out (web).",
)  # fmt: skip
def new(name: str, options: tuple[str, ...]) -> None:
    """Print a commented recipe of a KIND, ready to run."""
    from .core.errors import DesignError, printable
    from .recipe.kinds import kind_names, recipe_class

    try:
        recipe = recipe_class(name)
    except KeyError:
        from .recipe.messages import nearest

        kinds = kind_names()
        raise click.BadParameter(
            f"unknown kind {printable(name)!r}; {nearest(name, kinds)}choose of {', '.join(kinds)}"
        ) from None
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
@click.option("--quick", is_flag=True, help="Within a minute: fewer settings, the slowest methods left out.")
@click.option("--out", default="out", show_default=True, type=click.Path(path_type=Path), help="Folder for the files.")
def chart_command(families: tuple[str, ...], quick: bool, out: Path) -> None:
    """Measure speed against accuracy, of all FAMILIES of methods or those named, into OUT/chart/."""
    from importlib.util import find_spec

    from .core.errors import DesignError, GeomkinError, printable
    from .core.progress import shown
    from .export.files import write_whole
    from .tradeoff.files import chart_files
    from .tradeoff.results import chart
    from .tradeoff.study import stability

    def show(share: float, what: str) -> None:
        click.echo(f"\r\x1b[K{what}: {share:.0%}" if share < 1 else "\r\x1b[K", nl=False, err=True)

    try:
        with shown(show if _is_terminal(sys.stderr) else lambda share, what: None):
            measured = chart(families, quick)
        # Of all there is: where methods break, too, if what reckons in many digits is installed.
        study = stability() if not families and find_spec("mpmath") else None
        write_whole(out / "chart", chart_files(measured, study))
    except DesignError as error:
        raise click.BadParameter(f"{error.problem}; {error.remedy}", param_hint="FAMILY") from None
    except GeomkinError as error:
        raise click.ClickException(str(error)) from None
    count, points = len(measured.families), sum(len(one.points) for one in measured.families)
    click.echo(f"{printable(out / 'chart', 200)}: {count} famil{'y' if count == 1 else 'ies'}, {points} points")


def _files(paths: Iterable[Path]) -> list[Path]:
    """Recipes named, and those in folders named, in order."""
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
    """Why a recipe was not made: as text, and problem by problem."""

    text: str
    problems: tuple[Problem, ...]


Outcomes = list[tuple[Path, "Made | Refused"]]


def _each(files: list[Path], action: Callable[[Path], Made]) -> Outcomes:
    """What became of each recipe, in the order in which they were named."""
    from .core.errors import Problem, printable
    from .core.processes import each
    from .core.progress import shown

    outcomes: list[Made | Refused] = []
    hidden = len(files) < 2 or not _is_terminal(sys.stderr)

    def show(share: float, what: str) -> None:
        """Within one recipe: a line of its own where there is one recipe only, in the bar otherwise."""
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


def _tried(action: Callable[[Path], Made], file: Path) -> Made | Refused:
    """What an action makes of a recipe, or why nothing."""
    try:
        return action(file)
    except Exception as error:
        # A fault of ours in one recipe is reported like any other, and the rest are made.
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
            what = f"geomkin failed by a fault of its own ({fault})"
            problem = Problem("", what, "please report it", "internal")
    return Refused(f"{printable(file)}: {problem.problem}; {problem.remedy}", (problem,))


def _made(outcomes: Outcomes) -> list[Made]:
    return [outcome for _, outcome in outcomes if not isinstance(outcome, Refused)]


def _print_refusals(outcomes: Outcomes) -> None:
    for _, outcome in outcomes:
        if isinstance(outcome, Refused):
            click.secho(outcome.text, fg="red", err=True)


def _end(outcomes: Outcomes, as_json: bool = False) -> NoReturn:
    """End the command with the state that the outcomes give; as JSON print them first."""
    for file, outcome in outcomes if as_json else ():
        if isinstance(outcome, Refused):
            problems = [
                {name: getattr(one, name) for name in ("id", "key", "problem", "remedy")} for one in outcome.problems
            ]
            _print_json({"name": file.stem, "file": str(file), "problems": problems})
        else:
            about = {"name": outcome.name, "kind": outcome.kind, "file": str(file)}
            checks = [check.to_dict() for check in outcome.checks]
            _print_json({**about, "checks": checks, "files": list(map(str, outcome.files)), "remarks": outcome.remarks})
    sys.exit(1 if len(_made(outcomes)) < len(outcomes) else 0)


def _print_json(data: dict[str, object]) -> None:
    """On one line."""
    import json

    from .export.summary import as_json

    click.echo(json.dumps(as_json(data)))


def _is_terminal(stream: TextIO | None) -> bool:
    """Whether someone watches; a closed stream is None."""
    return stream is not None and stream.isatty()


def _row(result: Made) -> tuple[str, str, str, str]:
    """Where a recipe's files are, their endings, how large, how its checks came out."""
    from .core.errors import printable

    endings = list(dict.fromkeys(path.suffix[1:] for path in result.files))
    size = sum(result.files.values()) / 1000
    passed = sum(c.passed for c in result.checks)
    folder = next(iter(result.files)).parent if result.files else ""
    return printable(folder), " ".join(endings), f"{size:,.0f} kB", f"{passed} of {len(result.checks)} passed"


def _line(result: Made) -> str:
    """A recipe in a line of its own, for files and other programs."""
    folder, endings, size, checks = _row(result)
    return f"{folder}: {endings}, {size}, checks {checks}"


def _report(made: list[Made]) -> str:
    """One row for each recipe, under a heading."""
    rows = [("recipe", "files", "size", "checks"), *map(_row, made)]
    widths = [max(len(row[k]) for row in rows) for k in range(4)]
    return "\n".join("  ".join(cell.ljust(w) for cell, w in zip(row, widths)).rstrip() for row in rows)
