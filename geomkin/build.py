"""A recipe made into files: worked out wholly in memory first, so that an error writes nothing."""

from __future__ import annotations

import dataclasses
import json
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any, get_args

from .check import Check
from .errors import DesignError, Problem, RecipeError, shown
from .names import file_name_flaw
from .part import Part
from .plane.measure import area
from .recipe.kinds import kind
from .recipe.load import adapter, load
from .recipe.settings import Format

# Bytes of a recipe's name; longer, and with an ending it is more than file systems take.
LONGEST_NAME = 200
# Bytes of a summary that is read back: those of ours stay far below it.
LARGEST_SUMMARY = 10_000_000


@dataclasses.dataclass(frozen=True)
class Made:
    """What became of a recipe. files: path to size in bytes, empty when nothing was to be written."""

    name: str
    checks: tuple[Check, ...]
    files: dict[Path, int]


def check_recipe(file: str | Path) -> Made:
    """Validate a recipe and judge its design without writing."""
    recipe = load(file)
    checks, parts = _work_out(recipe, file)
    with _naming(file, recipe):
        _cuts(recipe, parts, recipe.files.write)
    return Made(_name(file), checks, {})


def make(file: str | Path, out: str | Path = "out", only: Sequence[str] | None = None) -> Made:
    """Make the recipe in `file`: its files go to `out`/<recipe name>/.

    only: formats to write of those the recipe asks for; all of them unless given, and then files of parts that
    the recipe had when it was last made here, and has no more, are removed. Raises RecipeError or FileError; then
    nothing of this recipe has been written, or what was is whole.
    """
    from .export.files import remove, write_whole

    recipe = load(file)
    if only is not None and not set(only) & set(recipe.files.write):
        found = f"found {', '.join(recipe.files.write)}, but only {', '.join(only)} is to be written"
        raise RecipeError(str(file), [Problem("files.write", found, "ask for one that the recipe writes, or add it")])
    checks, parts = _work_out(recipe, file)
    name = _name(file)
    with _naming(file, recipe):
        contents = _contents(recipe, name, parts, checks, only)
    folder = Path(out) / name
    before = _written(folder) if only is None else set()
    write_whole(folder, contents)
    for path in sorted(before - set(contents)):
        remove(folder / path)
    return Made(name, checks, {folder / path: len(content) for path, content in contents.items()})


def _name(file: str | Path) -> str:
    """The recipe's name, which names its folder and files."""
    name = Path(file).stem
    flaw = file_name_flaw(name)
    if flaw and len(os.fsencode(name)) <= LONGEST_NAME:
        raise RecipeError(
            str(file), [Problem("", f"its name cannot name a folder and files: {flaw}", "rename the file")]
        )
    if len(os.fsencode(name)) > LONGEST_NAME:
        raise RecipeError(str(file), [Problem("", "its name is too long for the files named after it", "shorten it")])
    return name


def _written(folder: Path) -> set[str]:
    """Names of the files that the summary in a folder tells of; none where there is no sound one."""
    try:
        summary = folder / "summary.json"
        # What stands there may be anything: a pipe would be waited on, a device or a huge file fill the memory.
        if not summary.is_file():
            return set()
        with summary.open("rb") as file:
            content = file.read(LARGEST_SUMMARY + 1)
        if len(content) > LARGEST_SUMMARY:
            return set()
        names = json.loads(content)["files"]
        return {name for name in names if not file_name_flaw(name) and Path(name).suffix[1:] in get_args(Format)}
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return set()


class _naming:
    """Turns a design's error into one that names the recipe's file."""

    def __init__(self, file: str | Path, recipe: Any):
        self.file, self.recipe = str(file), recipe

    def __enter__(self) -> None: ...

    def __exit__(self, error_type: Any, error: BaseException | None, trace: Any) -> None:
        if isinstance(error, DesignError):
            raise RecipeError(self.file, [Problem(self.key(error.field), error.problem, error.remedy)]) from None

    def key(self, field: str) -> str:
        """The recipe's key for a field: those of its tables as they are, else of `files`, else of the mechanism."""
        tables = [f.name for f in dataclasses.fields(self.recipe)]
        if field.split(".")[0] in tables:
            return field
        if field in (f.name for f in dataclasses.fields(self.recipe.files)):
            return f"files.{field}"
        # The table of the mechanism follows `kind`; a part may have a link's name, or none that a key has.
        mechanism = tables[1]
        named = field in (f.name for f in dataclasses.fields(getattr(self.recipe, mechanism)))
        return f"{mechanism}.{field}" if named else mechanism


def _work_out(recipe: Any, file: str | Path) -> tuple[tuple[Check, ...], list[Part]]:
    from .shop.walls import wall_checks

    with _naming(file, recipe):
        parts = kind(recipe.kind).parts(recipe)
        return (*kind(recipe.kind).checks(recipe), *wall_checks(parts, recipe.files.kerf)), parts


def _cuts(recipe: Any, parts: list[Part], wanted: Sequence[str]) -> tuple[list[Any], list[Any]]:
    """Parts as the cutter must go, for DXF and SVG, and as they are to be, for STL; empty where not wanted."""
    if not {"dxf", "svg", "stl"} & set(wanted):
        return [], []
    from .export.cut import cut

    files = recipe.files
    flats = [cut(part, files.tolerance, files.kerf, files.curves == "arcs") for part in parts]
    if files.kerf == 0 or "stl" not in wanted:
        return flats, flats
    return flats, [cut(part, files.tolerance) for part in parts]


def _contents(
    recipe: Any, name: str, parts: list[Part], checks: tuple[Check, ...], only: Sequence[str] | None
) -> dict[str, bytes]:
    """File name to bytes, everything that is to be written; nothing is loaded that is not needed."""
    wanted = [f for f in recipe.files.write if only is None or f in only]
    contents: dict[str, bytes] = {}
    flats, solids = _cuts(recipe, parts, wanted)
    if "dxf" in wanted or "svg" in wanted:
        from .export.layout import lay_out

        sheet = lay_out(flats)
    if "dxf" in wanted:
        from .export.dxf import dxf

        contents[f"{name}.dxf"] = dxf(sheet)
    if "svg" in wanted:
        from .export.svg import svg

        contents[f"{name}.svg"] = svg(sheet, name)
    if "stl" in wanted:
        from .export.stl import stl

        for cut in solids:
            if f"{cut.part.name}.stl" in contents:
                raise DesignError("name", f"two parts are named {shown(cut.part.name)}", "give each a name of its own")
            contents[f"{cut.part.name}.stl"] = stl(cut)
    if "csv" in wanted:
        from .export.csv import csv

        contents[f"{name}.csv"] = csv(kind(recipe.kind).table(recipe))
    contents["summary.json"] = _summary(recipe, name, parts, checks, contents, _as_written(wanted, flats, solids))
    return contents


def _libraries(contents: dict[str, bytes]) -> list[str]:
    """What had a hand in the files: by their endings, since others may be loaded for another recipe."""
    endings = {Path(name).suffix for name in contents}
    hands = {"numpy": endings, "shapely": endings & {".dxf", ".svg", ".stl"}, "ezdxf": endings & {".dxf"}}
    return [library for library, used in (hands | {"trimesh": endings & {".stl"}}).items() if used]


def _as_written(wanted: Sequence[str], flats: list[Any], solids: list[Any]) -> dict[Part, dict[str, float]]:
    """Sizes of the parts as files have them, which differ from the exact ones by the tolerance.

    The area is that within the beam's path, half a kerf off the part, as DXF and SVG have it; the volume the STL's.
    """
    sizes: dict[Part, dict[str, float]] = {}
    if {"dxf", "svg"} & set(wanted):
        sizes = {cut.part: {"written_area_mm2": float(f"{cut.area:.10g}")} for cut in flats}
    if "stl" in wanted:
        for cut in solids:
            volume = cut.chord_area * cut.part.thickness
            sizes[cut.part] = sizes.get(cut.part, {}) | {"written_volume_mm3": float(f"{volume:.10g}")}
    return sizes


def _summary(
    recipe: Any,
    name: str,
    parts: list[Part],
    checks: tuple[Check, ...],
    contents: dict[str, bytes],
    written: dict[Part, dict[str, float]],
) -> bytes:
    from . import __version__

    def part_summary(part: Part) -> dict[str, Any]:
        exact = area(part.outline) - sum(area(hole) for hole in part.holes)
        return {
            "name": part.name,
            "count": part.count,
            "layer": part.layer,
            "thickness_mm": part.thickness,
            "area_mm2": float(f"{exact:.10g}"),
            "volume_mm3": float(f"{exact * part.thickness:.10g}"),
            **written.get(part, {}),
        }

    summary = {
        "name": name,
        "recipe": adapter(recipe.kind).dump_python(recipe, mode="json"),
        "checks": [
            {
                "name": c.name,
                "value": float(f"{c.value:.10g}") if c.value == c.value else None,
                "side": c.side,
                "limit": c.limit,
                "unit": c.unit,
                "passed": bool(c.passed),
            }
            for c in checks
        ],
        "parts": [part_summary(p) for p in parts],
        **kind(recipe.kind).notes(recipe),
        "files": sorted(contents),
        "versions": {"geomkin": __version__}
        | {library: sys.modules[library].__version__ for library in _libraries(contents)},
    }
    return (json.dumps(summary, indent=1, ensure_ascii=False) + "\n").encode("utf-8", "replace")
