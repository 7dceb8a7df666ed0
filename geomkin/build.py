"""Making a recipe's files. All contents are computed in memory first, so that an error writes nothing."""

from __future__ import annotations

import dataclasses
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Annotated, Any, Literal

from .core.arguments import ArgumentType, checked
from .core.errors import DesignError, GeomkinError, Problem, RecipeError, harmless, printable
from .core.field_visitor import fields_of
from .core.fields import to_digits
from .core.names import PathName, file_name_flaw
from .core.records import record
from .core.units import UNITS
from .export.cut import LayerStyles
from .export.formats import WRITERS, format_in, format_of, tail_of
from .export.job import Job, StaticSource
from .export.summary import CERTIFICATE, FOUND, NAME, Stamp, listed_files, recipe_hash, remove, summary, write_whole
from .model.check import Check
from .model.part import Part
from .model.table import Table
from .recipe import load as reading
from .recipe.load import to_toml
from .recipe.reader import of_default
from .recipe.recipe import SHARED, AbstractGoal, AbstractRecipe
from .recipe.settings import Files, Format
from .recipe.shown import ShownRecipe

# Largest number of bytes of a recipe's name, so that a name with an ending suits every file system.
LONGEST_NAME = 200
# A path, a TOML text, or a mapping such as a TOML parser returns.
Readable = str | Path | Annotated[Mapping[str, Any], ArgumentType(lambda value: isinstance(value, Mapping), "a table")]


@record
class Made:
    """The result of making or checking a recipe.

    Parameters
    ----------
    name : str
        Name of the recipe.
    checks : tuple of Check
        The checks of its design.
    files : mapping of Path to int
        Size of each written file in bytes; empty if nothing was to be written.
    facts : tuple of str
        Further results, one line each, such as the peak factors of a cam's segments.
    remarks : tuple of str
        Advice and other sentences on the result, for example that a list may be incomplete.
    """

    name: str
    kind: str
    checks: tuple[Check, ...]
    files: Mapping[Path, int]
    facts: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()

    @property
    def failed_checks(self) -> tuple[Check, ...]:
        """The checks that failed, without those that the recipe expects to fail."""
        return tuple(check for check in self.checks if not check.passed and not check.expected)


class FailedChecksError(GeomkinError):
    """Checks failed that a recipe does not expect to fail; raised by `make(strict=True)` after its files are written.

    Parameters
    ----------
    made : Made
        The files, and all checks.

    See Also
    --------
    Check, make
    """

    def __init__(self, made: Made):
        super().__init__("\n".join(f"{printable(made.name)}: {harmless(check)}" for check in made.failed_checks))
        self.made = made

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.made,)


@checked
def load(source: Readable) -> AbstractRecipe:
    """Read and validate a recipe.

    Parameters
    ----------
    source : str, Path or mapping
        A path, a TOML text (recognised by a line break), or a table as a TOML parser returns it. Files that a recipe
        names are looked for in its own folder or below; for a text or a table in the working folder or below.

    Returns
    -------
    AbstractRecipe
        The recipe, named after its file, or after its kind if there is none.

    Raises
    ------
    FileError
        If a file cannot be read.
    RecipeError
        With every problem, key by key.

    See Also
    --------
    make, edit, scaled, write

    Examples
    --------
    >>> import geomkin as gk
    >>> recipe = gk.load({"kind": "four-bar", "linkage": {"ground": 100, "crank": 30, "coupler": 90, "rocker": 70}})
    >>> recipe.kind
    'four-bar'
    """
    if isinstance(source, Mapping):
        return reading.from_table(source)
    if isinstance(source, str) and "\n" in source:
        return reading.parse(source)
    return reading.read(Path(source))


@checked
def make(
    recipe: AbstractRecipe | Readable, out: PathName = "out", only: Sequence[Format] | None = None, strict: bool = False
) -> Made:
    """Write the files of a recipe to the folder `out`/<name>/.

    The files of another recipe made under the same name are replaced. Only results that the checks and the requested
    formats need are computed.

    Parameters
    ----------
    recipe : AbstractRecipe, str, Path or mapping
        A recipe, or a source that `load` accepts.
    out : str or Path
        The folder above that of the recipe.
    only : sequence of str, optional
        Formats to write, out of those that the recipe names, or out of all formats if it names none; files of its other
        formats stay. By default all formats of the recipe are written (the default formats of its kind if it names
        none). Either way files that an earlier run wrote and the recipe no longer has are removed.
    strict : bool, optional
        Whether failed checks raise an error after the files are written, except those in `expected_failures`.

    Returns
    -------
    Made
        The checks and the files.

    Raises
    ------
    RecipeError
        If the recipe is invalid or cannot be made.
    FileError
        If a file cannot be written. After either error each file is the old one or the complete new one.
    FailedChecksError
        If `strict` and a check failed.

    See Also
    --------
    load, verify, index, write, show
    """
    made, contents = computed(recipe, only, out=Path(out))
    folder = Path(out) / made.name
    before = listed_files(folder)
    write_whole(folder, contents)
    for path in (*sorted(before - listed_files(folder)), *CERTIFICATE):
        remove(folder / path)
    made = dataclasses.replace(made, files={folder / path: len(content) for path, content in contents.items()})
    if strict and made.failed_checks:
        raise FailedChecksError(made)
    return made


@checked
def check_recipe(recipe: AbstractRecipe | Readable) -> Made:
    """Check a recipe's design and compute the contents of its files without writing them.

    Parameters
    ----------
    recipe : AbstractRecipe, str, Path or mapping
        A recipe, or a source that `load` accepts.

    Returns
    -------
    Made
        The checks, and facts and remarks on the result.

    Raises
    ------
    RecipeError, FileError
        As for `make`.
    """
    return computed(recipe)[0]


def computed(
    recipe: AbstractRecipe | Readable,
    only: Sequence[Format] | None = None,
    certificate: tuple[tuple[str, ...], ...] = (),
    out: Path | None = None,
) -> tuple[Made, Mapping[str, bytes]]:
    """The results of a recipe, and the contents of its files by name, of these formats or of those that it names.

    certificate: rows of the results of verifying the files, for the report. out: the folder above that of the recipe;
    with `only`, the summary lists the files of its other formats that are there too.
    """
    file, recipe = _with_file(recipe)
    offered = WRITERS if only and recipe.files.wants_all else recipe.files.write
    wanted = [name for name in offered if only is None or name in only]
    if only is not None and not wanted:
        found = f"found {', '.join(recipe.files.write)}, but only {', '.join(only)} was requested"
        remedy = "request a format that the recipe writes, or add it to the recipe"
        raise RecipeError(file, [Problem("files.write", found, remedy, "conflict")])
    name = valid_recipe_name(file, recipe.name or recipe.kind)
    with errors_named_by_key(file, recipe):
        results = ShownRecipe(recipe)
        checks = results.checks
        job = dataclasses.replace(_job(name, recipe, recipe.files), certificate=certificate)
        wanted = wanted if only else _formats_of(recipe)
        written = {name: WRITERS[name].write(job) for name in WRITERS if name in wanted}
        contents = {file: content for files in written.values() for file, content in files.items()}
        found_file = {}
        if isinstance(recipe, AbstractGoal):
            found_recipe = dataclasses.replace(recipe.design, units=recipe.units, printing=recipe.printing)
            found_file[f"{name}{FOUND}"] = to_toml(found_recipe).encode()
        others = _kept(out / name, name, {*offered} - {*wanted}) if only and out else {}
        listed: dict[str, Collection[str]] = {**written, **others}
        contents |= {**found_file, NAME: summary(job, _data(recipe), checks, _notes(recipe), listed, list(found_file))}
        facts, remarks = _facts(results), results.remarks
    return Made(name, recipe.kind, checks, {}, facts, remarks), contents


def _kept(folder: Path, name: str, formats: Collection[str]) -> dict[str, list[str]]:
    """The files of these formats, by format, that an earlier run listed and that are still there."""
    kept: dict[str, list[str]] = {}
    for file in listed_files(folder):
        if (one := format_in(name, file)) in formats and (folder / file).is_file():
            kept.setdefault(one, []).append(file)
    return kept


def _facts(results: ShownRecipe) -> tuple[str, ...]:
    """Further results, why there are no forces, and the fits that nobody stated."""
    missing = results.recipe.forces_missing
    assumed = ", ".join(f"{key} {value:.7g} {results.unit.name}" for key, value in results.assumed_fits.items())
    more = f"assumed, not measured: {assumed}" if assumed else ""
    return results.texts(filter(None, (*results.recipe.facts, missing, more)))


@checked
def index(out: PathName = "out") -> dict[Path, int]:
    """Write `out`/index.html, a page with a card for each recipe made into `out`.

    A card shows the assembly, the kind and the number of passed checks, with links to the page and the files. The cards
    are in groups of kinds and are searched by words. Other files in the folder stay as they are.

    Parameters
    ----------
    out : str or Path
        The folder given to `make`.

    Returns
    -------
    mapping of Path to int
        The written files with their sizes in bytes.

    Raises
    ------
    FileError
        If the folder has no recipes, has a foreign index.html, or cannot be written.

    See Also
    --------
    make
    """
    folder = Path(out)
    # Imported here, since a run of a single recipe needs no index.
    from .page.cards import index_page
    from .recipe.kinds import all_kinds, recipe_class
    from .recipe.search import other_names

    kinds = {kind: (row.group, recipe_class(kind).about(), other_names(kind)) for kind, row in all_kinds().items()}
    contents = index_page(folder, kinds)
    write_whole(folder, contents)
    return {folder / name: len(content) for name, content in contents.items()}


@checked
def write(
    source: AbstractRecipe | Table | Part | Sequence[Part],
    path: PathName,
    tolerance: float | None = None,
    kerf: float | None = None,
    curves: Literal["chords", "arcs"] | None = None,
) -> dict[Path, int]:
    """Write parts, a table, or an output of a recipe to a file.

    Parameters
    ----------
    source : AbstractRecipe, Table, Part or sequence of Part
        The data to write.
    path : str or Path
        The ending selects the format, such as `.dxf`, `.csv` or `.html` (the page). For a recipe also `-assembly.svg`,
        `-assembly.dxf` and `-animation.svg` for pictures of the assembly, `-plot.svg` for its plots, `-assembly.glb`
        and `-assembly.3mf` for its solids. Formats with one file per part, such as STL, and plots write several files
        next to `path`, named after the parts or plots.
    tolerance : float, optional
        Largest distance between a curve and the written one, mm.
    kerf : float, optional
        Width of the cut, mm. Drawings move outlines outwards and holes inwards by half of it.
    curves : {"chords", "arcs"}, optional
        Whether drawings approximate outlines by chords or by arcs. Omitted options default to those of the recipe, or
        to 0.005 mm, no kerf and chords.

    Returns
    -------
    mapping of Path to int
        The written files with their sizes in bytes.

    Raises
    ------
    DesignError
        If the source has no such format.
    FileError
        If a file cannot be written. After either error each file is the old one or the complete new one.

    See Also
    --------
    load, make
    """
    path = Path(path)
    files = source.files if isinstance(source, AbstractRecipe) else Files(labels=False)
    held, needs = _as_source(source)
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


def _as_source(
    source: AbstractRecipe | Table | Part | Sequence[Part],
) -> tuple[AbstractRecipe | StaticSource, Collection[str]]:
    """The source as writers take it, and the kinds of data that it has."""
    if isinstance(source, AbstractRecipe):
        return source, ("parts", "table", "scene")
    if isinstance(source, Table):
        return StaticSource(table=source), ("table",)
    parts = (source,) if isinstance(source, Part) else tuple(source)
    if not parts:
        raise DesignError("source", "there are no parts", "give at least one", "out-of-range")
    return StaticSource(parts), ("parts",)


def _with_file(recipe: AbstractRecipe | Readable) -> tuple[str, AbstractRecipe]:
    """The name of a recipe in messages, and the recipe."""
    if isinstance(recipe, AbstractRecipe):
        return recipe.name or recipe.kind, recipe
    loaded = load(recipe)
    # Only a recipe from a file has a name.
    return str(recipe) if loaded.name else loaded.kind, loaded


def _formats_of(recipe: AbstractRecipe) -> list[str]:
    """The formats of a recipe, each once; with the default formats, without those for which its kind has no data."""
    wanted = dict.fromkeys(recipe.files.write)
    bare = recipe.files.wants_all and type(recipe).scene in (None, AbstractRecipe.scene)
    return [name for name in wanted if not (bare and WRITERS[name].needs == "scene")]


def _job(name: str, source: AbstractRecipe | StaticSource, files: Files) -> Job:
    results = ShownRecipe(source) if isinstance(source, AbstractRecipe) else source
    held = Job(name, results, files.tolerance, files.kerf, files.curves == "arcs", files.labels)
    laser, at = files.style == "laser", files.assembly_at
    job = dataclasses.replace(held, laser=laser, assembly_at=at, sheet=files.sheet, title=files.title)
    job = dataclasses.replace(
        job,
        cutter=files.cutter,
        tab_width=files.tab_width,
        dxf_version=files.dxf_version,
        layers=files.layers or LayerStyles(),
    )
    if not isinstance(source, AbstractRecipe):
        return job
    stamp = str(Stamp(recipe_hash(_data(source)), files.tolerance))
    unit, about = UNITS[source.units], ShownRecipe(source).introduction
    if (printing := source.printing) is not None:
        job = dataclasses.replace(job, growth=printing.growth, foot=printing.foot, in_place=printing.in_place)
    return dataclasses.replace(job, about=about, recipe=partial(to_toml, source), stamp=stamp, unit=unit)


def _notes(recipe: AbstractRecipe) -> Mapping[str, object]:
    """Further entries of summary.json, such as the files that the recipe reads, and why there are no forces."""
    missing, results = recipe.forces_missing, ShownRecipe(recipe)
    entries = {
        "loads": {"not_computed": missing} if missing else {},
        "workshop": (recipe.loaded_table or {}).get("workshop"),
        f"assumed_{recipe.units}": {key: to_digits(value) for key, value in results.assumed_fits.items()},
        "sources": dict(recipe.sources),
    }
    return {**results.notes, **{name: entry for name, entry in entries.items() if entry}}


def _data(recipe: AbstractRecipe) -> dict[str, Any]:
    """The keys of a recipe and their values, as JSON states them, but those that are off by default."""
    data = reading.whole_table(recipe, has_inner_defaults=False)
    fields = fields_of(type(recipe)).items()
    off = {name for name, declared in fields if not data[name] and getattr(recipe, name) == declared.default}
    return {key: value for key, value in data.items() if key not in off and (key, value) != ("units", "mm")}


def valid_recipe_name(file: str, name: str) -> str:
    """The name, if it is valid for a folder and files; else RecipeError."""
    if len(name.encode("utf-8", "surrogatepass")) > LONGEST_NAME:
        raise RecipeError(file, [Problem("", "its name is too long for file names", "shorten it", "out-of-range")])
    if flaw := file_name_flaw(name):
        problem = f"its name is not valid for a folder and files: {flaw}"
        remedy = "rename the file, or give the recipe another name"
        raise RecipeError(file, [Problem("", problem, remedy, "out-of-range")])
    return name


@contextmanager
def errors_named_by_key(file: str, recipe: AbstractRecipe) -> Iterator[None]:
    """Turn a design's error into one that names the recipe's file and key."""
    try:
        yield
    except DesignError as error:
        key = _key(recipe, error.field)
        problem = of_default(error.problem) if _is_default(recipe, key) else error.problem
        problems = reading.in_unit(
            [Problem(key, problem, error.remedy, error.id, error.value)], type(recipe), UNITS[recipe.units]
        )
        raise RecipeError(file, problems) from None


def _key(recipe: AbstractRecipe, field: str) -> str:
    """The recipe's key for a field: its own, else of `files`, else of the mechanism's table."""
    keys = [f.name for f in dataclasses.fields(recipe)]
    # A table that was left out is not at fault; then the mechanism does not suit its defaults.
    is_table = field in keys and dataclasses.is_dataclass(getattr(recipe, field))
    if field.split(".")[0] in keys and not (is_table and _is_default(recipe, field)):
        return field
    if field in (f.name for f in dataclasses.fields(recipe.files)):
        return f"files.{field}"
    # The mechanism is the first table; texts and numbers, such as a helix angle, are skipped.
    scalars, others = str | float | bool, ("kind", "files", *SHARED)
    mechanism = next((n for n in keys if n not in others and not isinstance(getattr(recipe, n), scalars)), "")
    table = getattr(recipe, mechanism or "files")
    # A field that the recipe leaves out was computed, such as the linkage of a goal.
    is_field = dataclasses.is_dataclass(table) and getattr(table, field, None) is not None
    is_field = is_field and field in (f.name for f in dataclasses.fields(table))
    return f"{mechanism}.{field}" if is_field else mechanism


def _is_default(recipe: AbstractRecipe, key: str) -> bool:
    """Whether a key has its default value, so that most likely nobody wrote it."""
    table: object = recipe
    default: object = dataclasses.MISSING
    for name in key.split("."):
        if isinstance(table, Mapping) and name in table:
            default, table = dataclasses.MISSING, table[name]
            continue
        named = {f.name: f for f in dataclasses.fields(table)} if dataclasses.is_dataclass(table) else {}
        if name not in named:
            return False
        default, table = named[name].default, getattr(table, name)
    return default is not dataclasses.MISSING and bool(table == default)
