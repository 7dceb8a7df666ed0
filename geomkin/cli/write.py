"""The commands that write files: run, verify, sweep, optimise, chart."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from functools import partial
from pathlib import Path

import click

from ..core.units import marked
from ..export.formats import WRITERS
from .recipes import (
    end,
    ended_if_refused,
    json_option,
    made_of,
    one_recipe,
    option_errors,
    out_folder,
    outcomes_of,
    print_json,
    print_refusals,
    print_results,
    progress_shown,
    recipe_arguments,
    recipe_files,
    source_of,
    strict_option,
)

# Gradient searches of an optimisation take longer than the combinations of a sweep: fewer are worth new processes.
FEWEST_SEARCHES = 4
# Written files that a line names; a Pareto front has a recipe for each of its designs.
MOST_NAMED = 3


def _formats(context: click.Context, parameter: click.Parameter, value: str | None) -> list[str] | None:
    """The formats in a comma-separated list."""
    chosen = None if value is None else [part.strip() for part in value.split(",")]
    if unknown := [ending for ending in chosen or () if ending not in WRITERS]:
        raise click.BadParameter(f"unknown format {unknown[0]!r}; choose from {', '.join(WRITERS)}")
    return chosen


@click.command()
@recipe_arguments
@out_folder
@click.option(
    "--only", callback=_formats, metavar="FORMAT,...",
    help=f"Write only these formats ({', '.join(WRITERS)}).",
)  # fmt: skip
@click.option(
    "--verify",
    "verified",
    is_flag=True,
    help="Afterwards compare the files with those made again, as `geomkin verify` does.",
)
@strict_option
@json_option
def run(
    recipes: tuple[Path, ...], out: Path, only: list[str] | None, verified: bool, strict: bool, as_json: bool
) -> None:
    """Write the files of recipes into OUT/<recipe>/.

    A folder stands for all recipes in it, `-` for one on the standard input. With several recipes it also writes
    OUT/index.html, a page with a card for each, and only failed checks and advice are listed.
    """
    from ..build import index, make
    from ..core.errors import FileError, printable

    files = recipe_files(recipes)
    _refuse_twins(files)
    outcomes = outcomes_of(files, partial(make, out=out, only=only))
    made = made_of(outcomes)
    if not as_json:
        print_results(outcomes)
    sound = not verified or all(_verified([out / result.name for result in made], as_json))
    if made and only is None and files != [*recipes[:1]]:
        try:
            pages = index(out)
            if not as_json:
                click.echo(f"{', '.join(printable(page, 200) for page in pages)}: a card for each recipe")
        except FileError as error:
            click.secho(str(error), fg="yellow", err=True)
    end(outcomes, as_json, strict, sound)


def _refuse_twins(files: list[Path]) -> None:
    stems = [f.stem for f in files]
    twins = [f for f in files if stems.count(f.stem) > 1]
    if twins:
        from ..core.errors import printable

        named = " and ".join(map(printable, twins))
        raise click.UsageError(f"{named} would write the same folder; run them with another --out")


@click.command("verify")
@click.argument("folders", nargs=-1, required=True, type=click.Path(exists=True, file_okay=False, path_type=Path))
@json_option
def verify_command(folders: tuple[Path, ...], as_json: bool) -> None:
    """Certify the files in FOLDERS.

    Makes each recipe again, compares its files with the result, and measures those that differ against the exact
    curves. A folder is that of one recipe, or contains such folders. Writes verify.json and verify.html into the
    folder of each recipe. The exit status is 1 if a file is not as designed.
    """
    if not all(_verified(folders, as_json)):
        sys.exit(1)


def _verified(folders: Iterable[Path], as_json: bool) -> list[bool]:
    """Verify folders and print the result of each recipe. Returns whether each is as designed."""
    from ..core.errors import FileError, harmless, printable
    from ..verification.certificate import recipe_folders
    from ..verification.certificate_files import certify

    results: list[bool] = []
    to_verify: list[Path] = []
    for folder in folders:
        try:
            to_verify += recipe_folders(folder)
        except FileError as error:
            click.secho(str(error), fg="red", err=True)
            results.append(False)
    outcomes = outcomes_of(to_verify, certify) if to_verify else []
    print_refusals(outcomes)
    results += [False] * (len(outcomes) - len(made_of(outcomes)))
    for certificate in made_of(outcomes):
        results.append(certificate.passed)
        if as_json:
            print_json(certificate.to_dict())
            continue
        measured = sum(file.proof == "measured" for file in certificate.files)
        again = sum(file.proof == "made again" for file in certificate.files)
        proofs = f"{again} files made again" + f", {measured} measured" * (measured > 0)
        verdict = "as designed" if certificate.passed else "NOT as designed"
        click.echo(f"{printable(certificate.folder)}: {proofs}, {verdict}")
        problems = [f"{file.file}: {marked(problem)}" for file in certificate.files for problem in file.problems]
        for problem in [*certificate.problems, *problems]:
            click.secho(f"  {harmless(certificate.unit.text(problem))}", fg="yellow")
    return results


@click.command("new-kind")
@click.argument("kind")
@click.option(
    "--out", default=".", show_default=True, type=click.Path(path_type=Path), help="Folder for that of the package."
)
def new_kind(kind: str, out: Path) -> None:
    """Write a Python package that adds a KIND of recipe.

    The package OUT/geomkin-KIND has a small mechanism that runs, to be changed into yours, a recipe of it and a test.
    """
    from ..core.errors import printable
    from ..export.summary import write_whole
    from ..recipe.template import kind_package

    with option_errors("KIND"):
        contents = kind_package(kind)
    folder = out / f"geomkin-{kind}"
    if folder.exists():
        raise click.BadParameter(f"{printable(folder, 200)} exists; give another name or --out", param_hint="KIND")
    write_whole(folder, contents)
    click.echo(f"{printable(folder, 200)}: {', '.join(contents)}")
    click.echo(f"next: pip install -e {printable(folder, 200)} && geomkin run {printable(folder, 200)}/{kind}.toml")


@click.command("sweep")
@one_recipe
@click.option(
    "--set", "settings", multiple=True, required=True, metavar="KEY=VALUES",
    help="Values of a key: gear.teeth=8:120:4 (start:stop:step) or gear.profile_shift=-0.5,0,0.5; once for each key. "
    "Items of a list are numbered from [0]: cam.program[1].rise=10,20.",
)  # fmt: skip
@click.option(
    "--result", "results", multiple=True, metavar="NAME",
    help="A result besides the checks: COLUMN:least, COLUMN:largest or COLUMN:last, or an entry of summary.json.",
)  # fmt: skip
@out_folder
@json_option
def sweep_command(recipe: Path, settings: tuple[str, ...], results: tuple[str, ...], out: Path, as_json: bool) -> None:
    """Evaluate a RECIPE for all combinations of values.

    Writes a table and a page, OUT/<recipe>/<recipe>.sweep.csv and .html. A sweep that was stopped continues with
    the same command.
    """
    from ..core.errors import harmless, printable
    from ..core.field_visitor import texts_by_key
    from ..core.processes import by_processes
    from ..sweeps.sweep import swept

    with option_errors("--set"):
        values = texts_by_key("set", settings, "KEY=VALUES")
    with ended_if_refused(recipe, as_json):
        result = swept(source_of(recipe), values, results, out, by_processes)
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
        print_json({**about, "rows": rows, "files": list(map(str, result.files))})
    else:
        counts = f"{len(result.rows):,} combinations, {result.reused:,} of them reused, {len(refusals):,} refused"
        click.echo(f"{', '.join(map(printable, result.files))}: {counts}")
    if len(refusals) == len(result.rows):
        click.secho(f"all combinations are refused; the first one: {harmless(refusals[0])}", fg="red", err=True)
        sys.exit(1)


@click.command("optimise")
@one_recipe
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
@click.option(
    "--starts", default=6, show_default=True, type=click.IntRange(1, 1000), help="Number of gradient searches."
)
@click.option(
    "--seed", default=0, show_default=True, type=click.IntRange(0, 2**32 - 1), help="Seed of the random designs."
)
@click.option(
    "--time-limit", default=60.0, show_default=True, type=click.FloatRange(0, min_open=True),
    help="Time limit, s; the best design by then is taken.",
)  # fmt: skip
@out_folder
def optimise_command(
    recipe: Path, ranges: tuple[str, ...], objectives: tuple[str, ...], constraints: tuple[str, ...],
    starts: int, seed: int, time_limit: float, out: Path,
) -> None:  # fmt: skip
    """Find the best values of a RECIPE's keys.

    The recipe's table [optimise] or these options state the task; an option replaces its entry in the table. Writes
    OUT/<recipe>/<recipe>.optimum.toml, a recipe with these values; with several objectives a table, a picture, a
    page and a recipe for each design of their Pareto front. All cores work. Ctrl-C ends the search; the best so far is
    written.
    """
    import signal

    from ..core.errors import harmless, printable
    from ..core.processes import by_processes
    from ..optimisation.optimiser import optimised, ranges_of

    with option_errors("--vary"):
        vary = ranges_of(ranges) or None
    minimise = objectives[0] if len(objectives) == 1 else objectives or None
    # Ctrl-C ends the search, not the process.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    with ended_if_refused(recipe):
        run = partial(by_processes, fewest=FEWEST_SEARCHES)
        best = optimised(source_of(recipe), vary, minimise, constraints or None, starts, seed, time_limit, out, run)
    for line in best.lines:
        click.echo(harmless(line))
    note = f", ended by Ctrl-C or --time-limit {time_limit:g} s before it was complete" if best.cut_short else ""
    files = [printable(path) for path in best.files]
    more = f" and {len(files) - MOST_NAMED} more" if len(files) > MOST_NAMED else ""
    click.echo(f"{', '.join(files[:MOST_NAMED])}{more}: {best.evaluations:,} designs tried{note}")


@click.command("chart")
@click.argument("families", nargs=-1, metavar="[FAMILY]...")
@click.option("--quick", is_flag=True, help="Take about a minute: fewer settings, without the slowest methods.")
@out_folder
def chart_command(families: tuple[str, ...], quick: bool, out: Path) -> None:
    """Measure the methods: time per result against error.

    Measures all families of methods, or only those given, and writes tables, pictures and a page into OUT/chart/, anew
    after each family. With all families, the page also shows where methods lose digits.
    """
    from importlib.util import find_spec

    from ..core.errors import GeomkinError, printable
    from ..export.summary import write_whole
    from ..tradeoff.files import chart_files
    from ..tradeoff.measurement import MISSING, growing_chart, stability

    try:
        with progress_shown(), option_errors("FAMILY"):
            for measured in growing_chart(families, quick):
                write_whole(out / "chart", chart_files(measured))
        if not families and find_spec("mpmath"):
            write_whole(out / "chart", chart_files(measured, stability()))
    except GeomkinError as error:
        raise click.ClickException(str(error)) from None
    count, points = len(measured.families), sum(len(family.points) for family in measured.families)
    click.echo(f"{printable(out / 'chart', 200)}: {count} famil{'y' if count == 1 else 'ies'}, {points} points")
    if not families and not find_spec("mpmath"):
        click.echo(MISSING, err=True)
