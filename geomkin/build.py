"""A recipe made into files: worked out wholly in memory first, so that an error writes nothing."""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any, Literal

from .arguments import checked
from .check import Check
from .errors import DesignError, Problem, RecipeError, printable
from .export.files import remove, write_whole
from .export.job import Job
from .export.summary import NAME, files_told, summary
from .export.writers import WRITERS
from .kinds import KINDS
from .names import file_name_flaw
from .part import Part
from .recipe import load as reading
from .recipe.recipe import AbstractRecipe
from .recipe.settings import Files

# Bytes of a recipe's name; longer, and with an ending it is more than file systems take.
LONGEST_NAME = 200


@dataclasses.dataclass(frozen=True)
class Made:
    """What became of a recipe. files: path to size in bytes, empty when nothing was to be written."""

    name: str
    checks: tuple[Check, ...]
    files: Mapping[Path, int]


def load(source: str | Path | Mapping[str, Any]) -> AbstractRecipe:
    """The recipe in a file, in a TOML text, or in a table as TOML gives it.

    source: a path; a text that has a line break is taken for the recipe itself. Files that a text or a table names lie
    in the working folder or below. Raises FileError where a file cannot be read, and RecipeError with every problem,
    key by key.
    """
    if isinstance(source, Mapping):
        return reading.told(KINDS, source)
    if isinstance(source, str) and "\n" in source:
        return reading.parse(KINDS, source)
    return reading.read(KINDS, Path(source))


def check_recipe(recipe: AbstractRecipe | str | Path) -> Made:
    """Validate a recipe and judge its design without writing."""
    file, recipe = _opened(recipe)
    with _naming(file, recipe):
        checks = recipe.checks
        job = _job(recipe)
        for ending in recipe.files.write:
            if WRITERS[ending].needs == "parts":
                _ = job.flats if WRITERS[ending].flat else job.solids
    return Made(_name(file, recipe), checks, {})


def make(recipe: AbstractRecipe | str | Path, out: str | Path = "out", only: Sequence[str] | None = None) -> Made:
    """Make a recipe, or the one in a file: its files go to `out`/<name>/.

    The name is the file's, that which `called` gave, or the kind. only: formats to write of those the recipe asks for;
    all of them unless given, and then files of parts that the recipe had when it was last made here, and has no more,
    are removed. Raises RecipeError or FileError; then nothing of this recipe has been written, or what was is whole.
    """
    file, recipe = _opened(recipe)
    wanted = [ending for ending in recipe.files.write if only is None or ending in only]
    if only is not None and not wanted:
        found = f"found {', '.join(recipe.files.write)}, but only {', '.join(only)} is to be written"
        raise RecipeError(file, [Problem("files.write", found, "ask for one that the recipe writes, or add it")])
    name = _name(file, recipe)
    with _naming(file, recipe):
        checks, job = recipe.checks, _job(recipe)
        written = {ending: WRITERS[ending].write(job) for ending in WRITERS if ending in wanted}
        told = reading.adapter(type(recipe)).dump_python(recipe, mode="json")
        contents = {name: content for files in written.values() for name, content in files.items()}
        contents[NAME] = summary(job, told, checks, recipe.notes, written)
    folder = Path(out) / name
    before = files_told(folder) if only is None else set()
    write_whole(folder, contents)
    for path in sorted(before - set(contents)):
        remove(folder / path)
    return Made(name, checks, {folder / path: len(content) for path, content in contents.items()})


@dataclasses.dataclass(frozen=True, eq=False)
class _Loose:
    """Parts that come of no recipe."""

    parts: tuple[Part, ...]

    @property
    def table(self) -> Any:
        raise DesignError("path", "parts have no table", "write the table of a recipe, or of a motion")

    @property
    def scene(self) -> None:
        return None


@checked
def write(
    parts: Part | Sequence[Part],
    path: str | Path,
    tolerance: float = 0.005,
    kerf: float = 0.0,
    curves: Literal["chords", "arcs"] = "chords",
) -> dict[Path, int]:
    """Write parts to a file, or for formats of one part a file to files beside it; path to size in bytes.

    The ending of `path` picks the format; an STL is written for each part, named after it where there are several.
    tolerance: largest distance, mm, between a curve and what is written. kerf: width of the cut, mm: drawings move
    outlines out and holes in by half of it. curves: outlines in drawings as chords or as arcs. Raises DesignError for
    parts that cannot be cut so, and FileError; then nothing has been written, or what was is whole.
    """
    path = Path(path)
    ending = path.suffix[1:].lower()
    if ending not in WRITERS or WRITERS[ending].needs != "parts":
        endings = [name for name, writer in WRITERS.items() if writer.needs == "parts"]
        raise DesignError("path", f"found {printable(path)}", f"give a name that ends in {' or '.join(endings)}")
    files = Files(write=(ending,), tolerance=tolerance, kerf=kerf, curves=curves)
    loose = _Loose((parts,) if isinstance(parts, Part) else tuple(parts))
    if not loose.parts:
        raise DesignError("parts", "there are none", "give at least one")
    contents = WRITERS[ending].write(Job(path.stem, loose, files.tolerance, files.kerf, files.curves == "arcs"))
    if len(contents) == 1:
        contents = {path.name: next(iter(contents.values()))}
    write_whole(path.parent, contents)
    return {path.parent / name: len(content) for name, content in contents.items()}


def _opened(recipe: AbstractRecipe | str | Path) -> tuple[str, AbstractRecipe]:
    """What messages call a recipe, and itself."""
    if isinstance(recipe, AbstractRecipe):
        return recipe.name or recipe.kind, recipe
    return str(recipe), load(Path(recipe))


def _job(recipe: AbstractRecipe) -> Job:
    files = recipe.files
    return Job(recipe.name or recipe.kind, recipe, files.tolerance, files.kerf, files.curves == "arcs")


def _name(file: str, recipe: AbstractRecipe) -> str:
    """The recipe's name, which names its folder and files."""
    name = recipe.name or recipe.kind
    flaw = file_name_flaw(name)
    if flaw and len(os.fsencode(name)) <= LONGEST_NAME:
        problem = f"its name cannot name a folder and files: {flaw}"
        raise RecipeError(file, [Problem("", problem, "rename the file")])
    if len(os.fsencode(name)) > LONGEST_NAME:
        raise RecipeError(file, [Problem("", "its name is too long for the files named after it", "shorten it")])
    return name


class _naming:
    """Turns a design's error into one that names the recipe's file."""

    def __init__(self, file: str, recipe: AbstractRecipe):
        self.file, self.recipe = file, recipe

    def __enter__(self) -> None: ...

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if isinstance(error, DesignError):
            raise RecipeError(self.file, [Problem(self.key(error.field), error.problem, error.remedy)]) from None

    def key(self, field: str) -> str:
        """The recipe's key for a field: those of its tables as they are, else of `files`, else of the mechanism."""
        tables = [f.name for f in dataclasses.fields(self.recipe)]  # type: ignore[arg-type]
        if field.split(".")[0] in tables:
            return field
        if field in (f.name for f in dataclasses.fields(self.recipe.files)):
            return f"files.{field}"
        # The table of the mechanism follows `kind`; a part may have a link's name, or none that a key has.
        mechanism = tables[1]
        named = field in (f.name for f in dataclasses.fields(getattr(self.recipe, mechanism)))
        return f"{mechanism}.{field}" if named else mechanism
