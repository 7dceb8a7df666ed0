"""The commands that print or show something: check, columns, list, new, schema, studio."""

from __future__ import annotations

from pathlib import Path

import click

from .recipes import (
    end,
    ended_if_refused,
    json_option,
    made_of,
    one_recipe,
    option_errors,
    outcomes_of,
    print_refusals,
    recipe_arguments,
    recipe_files,
)


@click.command("check")
@recipe_arguments
@json_option
def check_command(recipes: tuple[Path, ...], as_json: bool) -> None:
    """Validate recipes and show their checks; write nothing."""
    from ..build import check_recipe
    from ..core.errors import harmless, printable

    outcomes = outcomes_of(recipe_files(recipes), check_recipe)
    if as_json:
        end(outcomes, as_json)
    print_refusals(outcomes)
    for result in made_of(outcomes):
        click.echo(printable(result.name))
        for check in result.checks:
            click.echo(f"  {'pass' if check.passed else 'FAIL'}  {harmless(check)}")
        for fact in result.facts:
            click.echo(f"        {printable(fact, 200)}")
        for remark in result.remarks:
            click.echo(f"        {printable(remark)}")
    end(outcomes)


@click.command("columns")
@one_recipe
def columns_command(recipe: Path) -> None:
    """List the columns of a RECIPE's table.

    Each line has the id, the unit and the meaning of a column.
    """
    from ..build import errors_named_by_key, load
    from ..core.errors import printable
    from ..recipe.shown import ShownRecipe

    with ended_if_refused(recipe):
        loaded = load(recipe)
        with errors_named_by_key(str(recipe), loaded):
            lines = [(column.id, column.unit, column.meaning) for column in ShownRecipe(loaded).table.columns]
    wide, units = (max(len(line[k]) for line in lines) for k in (0, 1))
    for id, unit, meaning in lines:
        click.echo(printable(f"{id:<{wide}}  {unit:<{units}}  {meaning}", 500))


@click.command("list")
def list_command() -> None:
    """List the kinds of mechanism."""
    from ..recipe.kinds import all_kinds, recipe_class

    kinds = all_kinds()
    width = max(map(len, kinds))
    for group in dict.fromkeys(row.group for row in kinds.values()):
        click.echo(group)
        for name in (name for name, row in kinds.items() if row.group == group):
            click.echo(f"  {name:<{width}}  {recipe_class(name).about()}")


@click.command()
@click.argument("name", metavar="KIND")
@click.option(
    "--with", "options", multiple=True, metavar="TABLE[=KIND]",
    help="Show another kind of table (follower=oscillating-roller), or an optional table (web).",
)  # fmt: skip
def new(name: str, options: tuple[str, ...]) -> None:
    """Print a recipe of a KIND with every key explained.

    The recipe runs without changes.
    """
    from ..core.errors import printable
    from ..recipe.kinds import kind_names, recipe_class

    try:
        recipe = recipe_class(name)
    except KeyError:
        from ..recipe.messages import did_you_mean

        kinds = kind_names()
        remedy = f"{did_you_mean(name, kinds)}choose from {', '.join(kinds)}"
        raise click.BadParameter(f"unknown kind {printable(name)!r}; {remedy}") from None
    from ..recipe.template import template

    with option_errors("--with"):
        text = template(recipe, options)
    click.echo(text, nl=False)


@click.command("schema")
def schema_command() -> None:
    """Print a JSON Schema of all recipes, for editors."""
    import json

    from ..recipe.schema import schema

    click.echo(json.dumps(schema(), indent=1))


@click.command()
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

    from ..studio.server import Studio, StudioServer
    from ..studio.workspace import Workspace

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
