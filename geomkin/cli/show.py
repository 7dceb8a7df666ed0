"""The commands that print or show something: check, columns, examples, explain, import, list, new, schema, studio."""

from __future__ import annotations

from pathlib import Path

import click

from .recipes import (
    end,
    ended_if_refused,
    json_option,
    one_recipe,
    option_errors,
    outcomes_of,
    print_results,
    recipe_arguments,
    recipe_files,
    source_of,
    strict_option,
)


@click.command("check")
@recipe_arguments
@strict_option
@json_option
def check_command(recipes: tuple[Path, ...], strict: bool, as_json: bool) -> None:
    """Check recipes as `run` does, and write nothing.

    `-` reads a recipe from the standard input. Of several recipes only failed checks and advice are listed.
    """
    from ..build import check_recipe

    outcomes = outcomes_of(recipe_files(recipes), check_recipe)
    if not as_json:
        print_results(outcomes)
    end(outcomes, as_json, strict)


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
        loaded = load(source_of(recipe))
        with errors_named_by_key(str(recipe), loaded):
            lines = [(column.id, column.unit, column.meaning) for column in ShownRecipe(loaded).table.columns]
    wide, units = (max(len(line[k]) for line in lines) for k in (0, 1))
    for id, unit, meaning in lines:
        click.echo(printable(f"{id:<{wide}}  {unit:<{units}}  {meaning}", 500))


@click.command()
@click.argument("words", nargs=-1, required=True, metavar="ID_OR_TERM...")
def explain(words: tuple[str, ...]) -> None:
    """Explain checks and refusals, by their ids, or a term of the field.

    The id of a check is that of `summary.json`, such as `transmission_angle` or `wall_rocker`; that of a refusal is in
    the output of `--json`, such as `out-of-range`.
    """
    from ..core.errors import harmless, printable
    from ..model.explanations import CHECKS, REFUSALS, TERMS, explained, named_like
    from ..recipe.search import did_you_mean

    text = " ".join(words)
    # A term may have several words; otherwise each word is an id.
    each = [explained(word) for word in words]
    found = explained(text) if len(words) == 1 or None in each else "\n".join(filter(None, each))
    similar = [] if found else named_like(text)
    if len(similar) == 1:
        found = explained(similar[0])
    if found is None:
        known = [*CHECKS, *REFUSALS, *TERMS]
        meant = f"did you mean {' or '.join(similar)}?" if 0 < len(similar) < 9 else did_you_mean(text, known).rstrip()
        remedy = meant or f"the terms are {', '.join(TERMS)}"
        raise click.BadParameter(f"nothing is known of {printable(text)!r}; {remedy}", param_hint="ID_OR_TERM")
    click.echo("\n".join(map(harmless, found.split("\n"))))


@click.command("import")
@click.argument("file", type=click.Path(dir_okay=False, path_type=Path))
def import_command(file: Path) -> None:
    """Print a recipe with the linkage of a FILE of pylinkage, PMKS+ or Linkage.

    FILE is JSON of pylinkage, a text file with a link that PMKS+ shares, or a .linkage2 file. What is not understood is
    refused by name.
    """
    from ..foreign.programs import imported

    with ended_if_refused(file):
        click.echo(imported(file), nl=False)


@click.command("examples")
@click.argument("words", nargs=-1, metavar="[WORD]...")
def examples_command(words: tuple[str, ...]) -> None:
    """List the recipes of the gallery that have each WORD in their text, or most of them.

    A word may be a kind, a key such as `springs`, a motion such as `dwell`, or the name of a part; or they are a wish,
    such as "something that dwells".
    """
    from ..core.errors import harmless, printable
    from ..recipe.kinds import gallery
    from ..recipe.search import other_names, wished

    folder, recipes = gallery()
    texts = {
        file: f"{file} {(folder / file).read_text('utf-8')} {other_names(kind)}" for file, (kind, _) in recipes.items()
    }
    found = {file: recipes[file] for file in wished(" ".join(words), texts)}
    if not found:
        problem = f"no recipe of the gallery has {printable(' '.join(words))!r}"
        raise click.BadParameter(f"{problem}; `geomkin examples` lists all", param_hint="WORD")
    width = max(map(len, found))
    click.echo(harmless(f"in {folder}"))
    for file, (kind, about) in found.items():
        click.echo(harmless(f"  {file:<{width}}  {kind}: {about}"))


@click.command("list")
@click.argument("words", nargs=-1, metavar="[WORD]...")
def list_command(words: tuple[str, ...]) -> None:
    """List the kinds of mechanism.

    With a WORD, only those with this word in their name or description, and the recipes of the gallery with it; with
    several, such as a wish, those with all or most of them.
    """
    from ..core.errors import harmless, printable
    from ..model.explanations import explained
    from ..recipe.kinds import all_kinds, gallery, recipe_class
    from ..recipe.search import nearest_kind, other_names, wished

    groups: dict[str, list[tuple[str, str]]] = {}
    for kind, row in all_kinds().items():
        groups.setdefault(row.group, []).append((kind, recipe_class(kind).about()))
    if words:
        folder, recipes = gallery()
        groups[f"gallery, in {folder}"] = [(name, f"{kind}: {about}") for name, (kind, about) in recipes.items()]

    texts = {name: f"{name} {about} {other_names(name)}" for lines in groups.values() for name, about in lines}
    meant = {*wished(" ".join(words), texts)}
    groups = {
        group: found for group, lines in groups.items() if (found := [line for line in lines if line[0] in meant])
    }
    if not groups:
        problem = f"no kind and no recipe of the gallery has {printable(' '.join(words))!r}"
        is_explained = explained(" ".join(words)) is not None
        remedy = "`geomkin explain` explains it, and " if is_explained else nearest_kind(" ".join(words), all_kinds())
        raise click.BadParameter(f"{problem}; {remedy}`geomkin list` shows all kinds", param_hint="WORD")
    width = max(len(name) for lines in groups.values() for name, _ in lines)
    for group, lines in groups.items():
        click.echo(harmless(group))
        for name, about in lines:
            click.echo(harmless(f"  {name:<{width}}  {about}"))


@click.command()
@click.argument("name", metavar="KIND_OR_RECIPE")
@click.option(
    "--with", "options", multiple=True, metavar="TABLE[=KIND]",
    help="Show another kind of table (follower=oscillating-roller), or an optional table (web).",
)  # fmt: skip
def new(name: str, options: tuple[str, ...]) -> None:
    """Print a recipe of a KIND with every key explained, or a RECIPE of the gallery by its name, such as klann.

    The recipe runs without changes. Files that a recipe of the gallery reads are named on the standard error.
    """
    from ..core.errors import printable
    from ..recipe.kinds import gallery, kind_names, recipe_class

    try:
        recipe = recipe_class(name)
    except KeyError:
        from ..recipe.search import nearest_kind

        folder, recipes = gallery()
        if f"{name}.toml" in recipes and not options:
            return _print_from_gallery(folder, name)
        kinds = kind_names()
        remedy = nearest_kind(name, kinds) or f"choose from {', '.join(kinds)}, or "
        raise click.BadParameter(f"unknown kind {printable(name)!r}; {remedy}search with `geomkin list WORD`") from None
    from ..recipe.template import template

    with option_errors("--with"):
        text = template(recipe, options)
    click.echo(text, nl=False)


def _print_from_gallery(folder: Path, name: str) -> None:
    """Print a recipe of the gallery, and on the standard error the names of the files that it reads."""
    from ..core.errors import printable
    from ..studio.workspace import Workspace

    text = (folder / f"{name}.toml").read_text("utf-8")
    click.echo(text, nl=False)
    if files := sorted(map(printable, Workspace(folder).files_of(text))):
        place = printable(folder, 200)
        click.echo(
            f"the recipe reads {' and '.join(files)}: copy {'them' if files[1:] else 'it'} from {place}", err=True
        )


@click.command("schema")
def schema_command() -> None:
    """Print a JSON Schema of all recipes, for editors."""
    import json

    from ..recipe.template import schema

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

    from ..studio.server import NOBODY, StudioServer, kept_token
    from ..studio.service import Studio
    from ..studio.workspace import Workspace

    # A server runs for long: it must handle Ctrl-C itself and free its memory.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    gc.set_threshold(700, 10, 10)
    place = recipe or Path()
    folder, first = (place, "") if place.is_dir() else (place.parent, place.stem)
    served = StudioServer(Studio(Workspace(folder), first), port, NOBODY, kept_token(folder))
    with served as server, suppress(KeyboardInterrupt):
        click.echo(server.url)
        if not no_browser:
            webbrowser.open(server.url)
        server.serve_forever(poll_interval=0.2)
