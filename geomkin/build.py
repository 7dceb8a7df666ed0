"""A recipe made into files: worked out wholly in memory first, so that an error writes nothing."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Annotated, Any, Literal

from .core.arguments import ArgumentType, checked
from .core.errors import DesignError, Problem, RecipeError, printable
from .core.names import file_name_flaw
from .core.records import record
from .export.files import remove, write_whole
from .export.formats import WRITERS, format_of, tail_of
from .export.job import Job, Source, StaticSource
from .export.summary import FOUND, NAME, files_told, summary
from .model.check import Check
from .model.part import Part
from .model.table import Table
from .recipe import load as reading
from .recipe.load import to_toml
from .recipe.recipe import AbstractRecipe
from .recipe.settings import Files, Format

# Bytes of a recipe's name; longer, and with an ending it is more than file systems take.
LONGEST_NAME = 200
# A file, a TOML text, or a table as TOML gives it.
Readable = str | Path | Annotated[Mapping[str, Any], ArgumentType(lambda value: isinstance(value, Mapping), "a table")]


@record
class Made:
    """What became of a recipe. files: path to size in bytes, empty when nothing was to be written.

    facts: what `check_recipe` found besides, a line each, such as the peak factors of a cam's segments.
    remarks: sentences on the result, such as that a list may be incomplete.
    """

    name: str
    kind: str
    checks: tuple[Check, ...]
    files: Mapping[Path, int]
    facts: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()


@checked
def load(source: Readable) -> AbstractRecipe:
    """The recipe in a file, in a TOML text, or in a table as TOML gives it.

    source: a path; a text that has a line break is taken for the recipe itself. A recipe from a file is called as the
    file is, another one as its kind. Files that a recipe names lie in its own folder or below; those that a text or a
    table names, in the working folder or below. Raises FileError where a file cannot be read, and RecipeError with
    every problem, key by key.
    """
    if isinstance(source, Mapping):
        return reading.told(source)
    if isinstance(source, str) and "\n" in source:
        return reading.parse(source)
    return reading.read(Path(source))


@checked
def make(recipe: AbstractRecipe | Readable, out: str | Path = "out", only: Sequence[Format] | None = None) -> Made:
    """Make a recipe, or what `load` finds: its files go to `out`/<name>/.

    The name is the one of the recipe's file, the one that `called` gave, or the kind; a recipe replaces the files of
    another one that was made under its name. only: formats to write of those the recipe asks for, or of all there are
    where it names none. Unless it is given, all that the recipe asks for are written, and files of parts that it had
    when it was last made here, and has no more, are removed. A recipe that names no formats gets the usual ones that
    its kind has something for.
    Nothing is worked out that neither the checks nor these formats need. Raises RecipeError or FileError; then nothing
    of this recipe has been written, or what was is whole.
    """
    file, recipe = _opened(recipe)
    offered = WRITERS if only and recipe.files.wants_all else recipe.files.write
    wanted = [name for name in offered if only is None or name in only]
    if only is not None and not wanted:
        found = f"found {', '.join(recipe.files.write)}, but only {', '.join(only)} is to be written"
        raise RecipeError(
            file, [Problem("files.write", found, "ask for one that the recipe writes, or add it", "conflict")]
        )
    name = name_of(file, recipe.name or recipe.kind)
    with naming(file, recipe):
        checks, job = recipe.checks, _job(name, recipe, recipe.files)
        wanted = wanted if only else _had(recipe)
        written = {name: WRITERS[name].write(job) for name in WRITERS if name in wanted}
        told = reading.adapter(type(recipe)).dump_python(recipe, mode="json")
        if not recipe.expected_failures:
            del told["expected_failures"]
        contents = {file: content for files in written.values() for file, content in files.items()}
        goal_met = recipe.found_recipe
        besides = {} if goal_met is None else {f"{name}{FOUND}": to_toml(goal_met).encode()}
        contents |= {**besides, NAME: summary(job, told, checks, recipe.notes, written, list(besides))}
    folder = Path(out) / name
    before = files_told(folder) if only is None else set()
    write_whole(folder, contents)
    for path in sorted(before - set(contents)):
        remove(folder / path)
    files = {folder / path: len(content) for path, content in contents.items()}
    return Made(name, recipe.kind, checks, files, (), (*recipe.remarks, *recipe.unknown_expectations))


@checked
def check_recipe(recipe: AbstractRecipe | Readable) -> Made:
    """Judge a recipe's design and work out what its files are made of, without writing. Raises what `make` does."""
    file, recipe = _opened(recipe)
    name = name_of(file, recipe.name or recipe.kind)
    with naming(file, recipe):
        checks, job = recipe.checks, _job(name, recipe, recipe.files)
        for writer in (WRITERS[name] for name in _had(recipe)):
            if writer.needs == "parts":
                _ = job.sheets if writer.flat else job.solids
            else:
                writer.write(job)
        # The summary would refuse what these refuse.
        _ = recipe.notes
        facts, remarks = recipe.facts, (*recipe.remarks, *recipe.unknown_expectations)
    return Made(name, recipe.kind, checks, {}, facts, remarks)


@checked
def index(out: str | Path = "out") -> dict[Path, int]:
    """Write `out`/index.html, a page with a card for each recipe that was made into `out`; path to size in bytes.

    A card has the picture of the assembly, the kind, how many checks hold, and links to the page and the files. What
    else lies in the folder is left alone. Raises FileError where nothing was made into it, where a page that is not
    ours has the name, and for what cannot be written.
    """
    folder = Path(out)
    # A run of one recipe needs none of it, and pages load much.
    from .page import index as overview

    contents = overview.index(folder)
    write_whole(folder, contents)
    return {folder / name: len(content) for name, content in contents.items()}


@checked
def write(
    source: AbstractRecipe | Table | Part | Sequence[Part],
    path: str | Path,
    tolerance: float | None = None,
    kerf: float | None = None,
    curves: Literal["chords", "arcs"] | None = None,
) -> dict[Path, int]:
    """Write parts, a table, or what a recipe has of either, or its page or picture, to a file; path to size in bytes.

    The ending of `path` picks the format, `.html` the page; of a recipe `-assembly.svg`, `-assembly.dxf` and
    `-animation.svg` are pictures of the whole, `-assembly.glb` and `-assembly.3mf` its solids. One that has a file
    for each part, such as STL, writes several beside `path`, named after the parts. tolerance: largest distance,
    mm, between a curve and what is written. kerf: width of the cut, mm: drawings move outlines out and holes in by
    half of it. curves: outlines in drawings as chords or as arcs. What is left out of the three is as the recipe
    says, or as it is in a recipe without `files`: 0.005 mm, no kerf, chords. Raises DesignError for what cannot be
    written so, and FileError; then nothing has been written, or what was is whole.
    """
    path = Path(path)
    files = source.files if isinstance(source, AbstractRecipe) else Files(labels=False)
    held, needs = _held(source)
    name = format_of(path.name, needs)
    if not name:
        tails = [tail_of(name).removeprefix(".") for name, writer in WRITERS.items() if writer.needs in needs]
        raise DesignError(
            "path", f"found {printable(path)}", f"give a name that ends in {' or '.join(tails)}", "out-of-range"
        )
    given = {"tolerance": tolerance, "kerf": kerf, "curves": curves}
    changes: dict[str, Any] = {name: value for name, value in given.items() if value is not None}
    stem = path.name[: -len(tail_of(name))]
    job = _job(stem, held, dataclasses.replace(files, write=(name,), **changes))
    contents = WRITERS[name].write(job)
    if len(contents) == 1:
        contents = {path.name: next(iter(contents.values()))}
    write_whole(path.parent, contents)
    return {path.parent / name: len(content) for name, content in contents.items()}


def _held(source: AbstractRecipe | Table | Part | Sequence[Part]) -> tuple[Source, Collection[str]]:
    """What is to be written as writers take it, and which of their needs it can meet."""
    if isinstance(source, AbstractRecipe):
        return source, ("parts", "table", "scene")
    if isinstance(source, Table):
        return StaticSource(table=source), ("table",)
    parts = (source,) if isinstance(source, Part) else tuple(source)
    if not parts:
        raise DesignError("source", "there are no parts", "give at least one")
    return StaticSource(parts), ("parts",)


def _opened(recipe: AbstractRecipe | Readable) -> tuple[str, AbstractRecipe]:
    """What messages call a recipe, and itself."""
    if isinstance(recipe, AbstractRecipe):
        return recipe.name or recipe.kind, recipe
    found = load(recipe)
    # Only what a file holds has a name by itself.
    return str(recipe) if found.name else found.kind, found


def _had(recipe: AbstractRecipe) -> list[str]:
    """The formats that a recipe asks for; where that is all of them, without those that its kind shows nothing for."""
    wanted = list(recipe.files.write)
    bare = recipe.files.wants_all and not recipe.has_scene()
    return [name for name in wanted if not (bare and WRITERS[name].needs == "scene")]


def _job(name: str, source: Source, files: Files) -> Job:
    held = Job(name, source, files.tolerance, files.kerf, files.curves == "arcs", files.labels)
    laser, at = files.style == "laser", files.assembly_at
    job = dataclasses.replace(held, laser=laser, assembly_at=at, sheet=files.sheet, title=files.title)
    if not isinstance(source, AbstractRecipe):
        return job
    about = " ".join((source.subtitle, *source.remarks))
    return dataclasses.replace(job, about=about, recipe=partial(to_toml, source))


def name_of(file: str, name: str) -> str:
    """A recipe's name, where it can name its folder and files."""
    if len(name.encode("utf-8", "surrogatepass")) > LONGEST_NAME:
        raise RecipeError(
            file, [Problem("", "its name is too long for the files named after it", "shorten it", "out-of-range")]
        )
    if flaw := file_name_flaw(name):
        problem = f"its name cannot name a folder and files: {flaw}"
        raise RecipeError(file, [Problem("", problem, "rename the file, or call the recipe otherwise", "out-of-range")])
    return name


@contextmanager
def naming(file: str, recipe: AbstractRecipe) -> Iterator[None]:
    """Turns a design's error into one that names the recipe's file and key."""
    try:
        yield
    except DesignError as error:
        key = _key(recipe, error.field)
        problem = (
            re.sub(r"^found (?=[-+\d])", "found the default of ", error.problem)
            if _is_default(recipe, key)
            else error.problem
        )
        raise RecipeError(file, [Problem(key, problem, error.remedy, error.id)]) from None


def _key(recipe: AbstractRecipe, field: str) -> str:
    """The recipe's key for a field: one of its own, else of `files`, else of the mechanism, its table after `kind`."""
    own = [f.name for f in dataclasses.fields(recipe)]
    # A whole table that is left out is not at fault: what does not go with its defaults is the mechanism.
    whole = field in own and dataclasses.is_dataclass(getattr(recipe, field))
    if field.split(".")[0] in own and not (whole and _is_default(recipe, field)):
        return field
    if field in (f.name for f in dataclasses.fields(recipe.files)):
        return f"files.{field}"
    # A part may have a link's name, or none that a key has.
    # Words and numbers of the recipe itself, such as a helix angle, are no mechanism.
    plain = str | float | bool
    mechanism = next(
        n for n in own if n not in ("kind", "expected_failures") and not isinstance(getattr(recipe, n), plain)
    )
    table = getattr(recipe, mechanism)
    # What was left out of the recipe was found, as a goal's linkage is.
    named = dataclasses.is_dataclass(table) and getattr(table, field, None) is not None
    named = named and field in (f.name for f in dataclasses.fields(table))
    return f"{mechanism}.{field}" if named else mechanism


def _is_default(recipe: AbstractRecipe, key: str) -> bool:
    """Whether a key of a recipe has its default, so that most likely nobody wrote it."""
    table: object = recipe
    default: object = dataclasses.MISSING
    for name in key.split("."):
        named = {f.name: f for f in dataclasses.fields(table)} if dataclasses.is_dataclass(table) else {}
        if name not in named:
            return False
        default, table = named[name].default, getattr(table, name)
    return default is not dataclasses.MISSING and bool(table == default)
