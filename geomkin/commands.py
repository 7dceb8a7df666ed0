"""The commands: run, check, list, new, schema."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import click

FORMATS = ("dxf", "stl", "svg", "csv")

_recipes = click.argument(
    "recipes", nargs=-1, required=True, type=click.Path(exists=True, path_type=Path), metavar="RECIPE_OR_FOLDER..."
)


class _Formats(click.ParamType):
    name = "FORMAT,..."

    def convert(self, value: Any, param: Any, ctx: Any) -> Any:
        chosen = [part.strip() for part in value.split(",")]
        unknown = [c for c in chosen if c not in FORMATS]
        if unknown:
            self.fail(f"unknown format {unknown[0]!r}; choose of {', '.join(FORMATS)}")
        return chosen


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="geomkin")
def cli() -> None:
    """Turn text recipes into planar mechanisms: DXF, STL and SVG to make them, CSV of their motion."""


@cli.command()
@_recipes
@click.option("--out", default="out", show_default=True, type=click.Path(path_type=Path), help="Folder for the files.")
@click.option("--only", type=_Formats(), help=f"Write only these of the recipe's formats ({', '.join(FORMATS)}).")
def run(recipes: tuple[Path, ...], out: Path, only: list[str] | None) -> None:
    """Make recipes, or all recipes of folders, into OUT/<recipe>/."""
    from .build import make

    files = _files(recipes)
    _refuse_twins(files)
    made, failed = _each(files, lambda file: make(file, out, only))
    if sys.stdout.isatty() and made:
        click.echo(_report(made))
    for result in made:
        for check in result.checks:
            if not check.passed:
                click.secho(f"{result.name}: check failed: {check}", fg="yellow", err=True)
    sys.exit(1 if failed else 0)


@cli.command("check")
@_recipes
def check_command(recipes: tuple[Path, ...]) -> None:
    """Validate recipes and show their checks; write nothing."""
    from .build import check_recipe

    made, failed = _each(_files(recipes), check_recipe)
    for result in made:
        click.echo(result.name)
        for check in result.checks:
            click.echo(f"  {'pass' if check.passed else 'FAIL'}  {check}")
    sys.exit(1 if failed else 0)


@cli.command("list")
def list_command() -> None:
    """List the kinds of mechanism."""
    from .recipe.kinds import KINDS, kind

    width = max(map(len, KINDS))
    for name in KINDS:
        click.echo(f"{name:<{width}}  {kind(name).about}")


@cli.command()
@click.argument("name", metavar="KIND")
def new(name: str) -> None:
    """Print a commented recipe of a KIND, ready to run."""
    from .recipe.kinds import KINDS

    if name not in KINDS:
        from .recipe.explain import nearest

        raise click.BadParameter(f"unknown kind {name!r}; choose of {', '.join(KINDS)}{nearest(name, KINDS)}")
    from .recipe.template import template

    click.echo(template(name), nl=False)


@cli.command()
def schema() -> None:
    """Print a JSON Schema of all recipes, for editors."""
    import json

    from .recipe.load import schema

    click.echo(json.dumps(schema(), indent=1))


def _files(paths: Iterable[Path]) -> list[Path]:
    """Recipes named, and those in folders named, in order."""
    files: list[Path] = []
    for path in paths:
        inside = sorted(path.glob("*.toml")) if path.is_dir() else [path]
        if not inside:
            raise click.UsageError(f"no recipe (*.toml) in {path}")
        files += [f for f in inside if f not in files]
    return files


def _refuse_twins(files: list[Path]) -> None:
    stems = [f.stem for f in files]
    twins = [f for f in files if stems.count(f.stem) > 1]
    if twins:
        raise click.UsageError(
            f"{' and '.join(map(str, twins))} would write the same folder; run them with another --out"
        )


def _each(files: list[Path], action: Callable[[Path], Any]) -> tuple[list[Any], int]:
    """Results of those that worked, and how many did not; each failure is told when all is done."""
    from .errors import GeomkinError

    results, failures = [], []
    with click.progressbar(
        files,
        label="Recipes",
        item_show_func=lambda f: f.stem if f else "",
        file=sys.stderr,
        hidden=len(files) < 2 or not sys.stderr.isatty(),
    ) as bar:
        for file in bar:
            try:
                results.append(action(file))
            except GeomkinError as error:
                failures.append(str(error))
            except MemoryError:
                failures.append(f"{file}: not enough memory; give a larger tolerance")
    for failure in failures:
        click.secho(failure, fg="red", err=True)
    return results, len(failures)


def _report(made: list[Any]) -> str:
    """One row for each recipe: where its files are, how large, how its checks came out."""
    rows = [("recipe", "files", "size", "checks")]
    for result in made:
        endings = list(dict.fromkeys(path.suffix[1:] for path in result.files))
        size = sum(result.files.values()) / 1000
        passed = sum(c.passed for c in result.checks)
        folder = next(iter(result.files)).parent if result.files else ""
        rows.append((str(folder), " ".join(endings), f"{size:,.0f} kB", f"{passed} of {len(result.checks)} passed"))
    widths = [max(len(row[k]) for row in rows) for k in range(4)]
    return "\n".join("  ".join(cell.ljust(w) for cell, w in zip(row, widths)).rstrip() for row in rows)
