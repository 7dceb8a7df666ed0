"""The commands: run, check, sweep, list, new, schema, chart."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

import click

from .export.formats import WRITERS

if TYPE_CHECKING:
    from click._termui_impl import ProgressBar

    from .build import Made


# What helps where there is not enough memory.
LARGER = "give a larger tolerance"

_recipes = click.argument(
    "recipes", nargs=-1, required=True, type=click.Path(exists=True, path_type=Path), metavar="RECIPE_OR_FOLDER..."
)


def _formats(context: click.Context, parameter: click.Parameter, value: str | None) -> list[str] | None:
    """The formats in a list with commas."""
    chosen = None if value is None else [part.strip() for part in value.split(",")]
    if unknown := [ending for ending in chosen or () if ending not in WRITERS]:
        raise click.BadParameter(f"unknown format {unknown[0]!r}; choose of {', '.join(WRITERS)}")
    return chosen


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
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
def run(recipes: tuple[Path, ...], out: Path, only: list[str] | None) -> None:
    """Make recipes, or all recipes of folders, into OUT/<recipe>/, and of several a page over them, OUT/index.html."""
    from .build import index, make
    from .core.errors import FileError, harmless, printable

    files = _files(recipes)
    _refuse_twins(files)
    made, failed = _each(files, lambda file: make(file, out, only))
    if made and only is None and (len(files) > 1 or recipes[0].is_dir()):
        try:
            index(out)
        except FileError as error:
            click.secho(str(error), fg="yellow", err=True)
    if made:
        click.echo(_report(made) if _is_terminal(sys.stdout) else "\n".join(map(_line, made)))
    for result in made:
        for remark in result.remarks:
            click.echo(f"{printable(result.name)}: {remark}", err=True)
        for check in result.checks:
            if not check.passed:
                click.secho(f"{printable(result.name)}: check failed: {harmless(check)}", fg="yellow", err=True)
    sys.exit(1 if failed else 0)


@cli.command("check")
@_recipes
def check_command(recipes: tuple[Path, ...]) -> None:
    """Validate recipes and show their checks; write nothing."""
    from .build import check_recipe
    from .core.errors import harmless, printable

    made, failed = _each(_files(recipes), check_recipe)
    for result in made:
        click.echo(printable(result.name))
        for check in result.checks:
            click.echo(f"  {'pass' if check.passed else 'FAIL'}  {harmless(check)}")
        for fact in result.facts:
            click.echo(f"        {printable(fact)}")
        for remark in result.remarks:
            click.echo(f"        {printable(remark)}")
    sys.exit(1 if failed else 0)


@cli.command()
@click.argument("recipe", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option(
    "--set", "settings", multiple=True, required=True, metavar="KEY=VALUES",
    help="Values of a key: gear.teeth=8:120:4 (start:stop:step), gear.profile_shift=-0.5,0,0.5, or of a list's item, "
    "the first being [0]: cam.program[1].rise=10,20; once for each key.",
)  # fmt: skip
@click.option(
    "--tell", multiple=True, metavar="NAME",
    help="Tell besides the checks: COLUMN:least, :largest or :last of the table, or an entry of the notes.",
)  # fmt: skip
@click.option("--out", default="out", show_default=True, type=click.Path(path_type=Path), help="Folder for the files.")
def sweep(recipe: Path, settings: tuple[str, ...], tell: tuple[str, ...], out: Path) -> None:
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
            found = swept(recipe, values, tell, out, by_processes)
    except GeomkinError as error:
        click.secho(str(error), fg="red", err=True)
        sys.exit(1)
    if found.anew:
        click.echo(
            "begun anew: the rows of an earlier run are of another recipe, --tell or version of geomkin, or damaged",
            err=True,
        )
    refused = [row.refused for row in found.rows if row.refused]
    told = f"{len(found.rows):,} combinations, {found.kept:,} of them from before, {len(refused):,} refused"
    click.echo(f"{', '.join(map(printable, found.files))}: {told}")
    if len(refused) == len(found.rows):
        click.secho(f"all are refused, the first for this: {harmless(refused[0])}", fg="red", err=True)
        sys.exit(1)


def _overwrite(line: str) -> None:
    """A line in place of the one before."""
    click.echo(f"\r\x1b[K{line}", nl=False, err=True)


@cli.command("list")
def list_command() -> None:
    """List the kinds of mechanism."""
    from .recipe.kinds import KINDS

    width = max(map(len, KINDS))
    for name in KINDS:
        click.echo(f"{name:<{width}}  {KINDS[name].about()}")


@cli.command()
@click.argument("name", metavar="KIND")
@click.option(
    "--with", "options", multiple=True, metavar="TABLE[=KIND]",
    help="Show a table of another kind (follower=oscillating-roller), or one that may be left out (web).",
)  # fmt: skip
def new(name: str, options: tuple[str, ...]) -> None:
    """Print a commented recipe of a KIND, ready to run."""
    from .core.errors import DesignError, printable
    from .recipe.kinds import KINDS

    if name not in KINDS:
        from .recipe.messages import nearest

        raise click.BadParameter(
            f"unknown kind {printable(name)!r}; {nearest(name, KINDS)}choose of {', '.join(KINDS)}"
        )
    from .recipe.template import template

    try:
        text = template(KINDS[name], options)
    except DesignError as error:
        raise click.BadParameter(f"{error.problem}; {error.remedy}", param_hint="--with") from None
    click.echo(text, nl=False)


@cli.command()
def schema() -> None:
    """Print a JSON Schema of all recipes, for editors."""
    import json

    from .recipe.kinds import KINDS
    from .recipe.template import schema

    click.echo(json.dumps(schema(KINDS), indent=1))


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

    def tell(share: float, what: str) -> None:
        click.echo(f"\r\x1b[K{what}: {share:.0%}" if share < 1 else "\r\x1b[K", nl=False, err=True)

    try:
        with shown(tell if _is_terminal(sys.stderr) else lambda share, what: None):
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


def _each(files: list[Path], action: Callable[[Path], Made]) -> tuple[list[Made], int]:
    """Results of those that worked, and how many did not; each failure is told when all is done."""
    from .core.errors import printable
    from .core.processes import each
    from .core.progress import shown

    outcomes: dict[int, Made | str] = {}
    hidden = len(files) < 2 or not _is_terminal(sys.stderr)

    def tell(share: float, what: str) -> None:
        """Within one recipe: a line of its own where there is one recipe only, in the bar otherwise."""
        if not _is_terminal(sys.stderr):
            return
        if hidden:
            _overwrite(f"{what}: {share:.0%}" if share < 1 else "")
        else:
            bar.label = f"Recipes, {what}: {share:.0%}" if share < 1 else "Recipes"
            bar.render_progress()

    def begun(file: Path) -> None:
        bar.current_item = file
        bar.render_progress()

    counted: ProgressBar[Path] = click.progressbar(
        length=len(files),
        label="Recipes",
        item_show_func=lambda f: printable(f.stem) if f else "",
        file=sys.stderr,
        hidden=hidden,
    )
    with counted as bar, shown(tell):
        for number, outcome in each(partial(_tried, action), files, begun):
            outcomes[number] = outcome or f"{printable(files[number])}: its process was killed; {LARGER}"
            bar.update(1)
    # In the order in which they were named, whichever was done first.
    every = [outcomes[number] for number in sorted(outcomes)]
    failures = [outcome for outcome in every if isinstance(outcome, str)]
    for failure in failures:
        click.secho(failure, fg="red", err=True)
    return [outcome for outcome in every if not isinstance(outcome, str)], len(failures)


def _tried(action: Callable[[Path], Made], file: Path) -> Made | str:
    """What an action makes of a recipe, or in a text why not."""
    from .core.errors import GeomkinError, printable

    try:
        return action(file)
    except GeomkinError as error:
        return str(error)
    except MemoryError:
        return f"{printable(file)}: not enough memory; {LARGER}"
    except Exception as error:
        # A fault of ours in one recipe is told like any other, and the rest are made.
        fault = printable(f"{type(error).__name__}: {error}", 200)
        return f"{printable(file)}: geomkin failed by a fault of its own ({fault}); please report it"


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
