"""A recipe made into files: worked out wholly in memory first, so that an error writes nothing."""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .check import Check
from .errors import DesignError, Problem, RecipeError
from .part import Part
from .plane.measure import area
from .recipe.kinds import kind
from .recipe.load import adapter, load


@dataclass(frozen=True)
class Made:
    """What became of a recipe. files: path to size in bytes, empty when nothing was to be written."""

    name: str
    checks: tuple[Check, ...]
    files: dict[Path, int]


def check_recipe(file: str | Path) -> Made:
    """Validate a recipe and judge its design without writing."""
    recipe = load(file)
    checks, parts = _work_out(recipe, file)
    with _naming(file):
        _solids(recipe, parts)
        _flats(recipe, parts)
    return Made(_name(file), checks, {})


def make(file: str | Path, out: str | Path = "out", only: Sequence[str] | None = None) -> Made:
    """Make the recipe in `file`: its files go to `out`/<recipe name>/.

    only: formats to write of those the recipe asks for; all of them unless given. Raises RecipeError or
    FileError; then nothing of this recipe has been written, or what was is whole.
    """
    from .export.files import write_whole

    recipe = load(file)
    checks, parts = _work_out(recipe, file)
    name = _name(file)
    with _naming(file):
        contents = _contents(recipe, name, parts, checks, only)
    folder = Path(out) / name
    for path, content in contents.items():
        write_whole(folder / path, content)
    return Made(name, checks, {folder / path: len(content) for path, content in contents.items()})


def _name(file: str | Path) -> str:
    return Path(file).stem


class _naming:
    """Turns a design's error into one that names the recipe's file."""

    def __init__(self, file: str | Path):
        self.file = str(file)

    def __enter__(self) -> None: ...

    def __exit__(self, error_type: Any, error: BaseException | None, trace: Any) -> None:
        if isinstance(error, DesignError):
            raise RecipeError(self.file, [Problem(error.field, error.problem, error.remedy)]) from None


def _work_out(recipe: Any, file: str | Path) -> tuple[tuple[Check, ...], list[Part]]:
    with _naming(file):
        parts = kind(recipe.kind).parts(recipe)
        return tuple(kind(recipe.kind).checks(recipe)), parts


def _solids(recipe: Any, parts: list[Part]) -> list[Any]:
    """Parts as they are to be: what STL is made from."""
    from .export.cut import cut

    return [cut(part, recipe.files.tolerance) for part in parts]


def _flats(recipe: Any, parts: list[Part]) -> list[Any]:
    """Parts as the cutter must go: what DXF and SVG are made from."""
    from .export.cut import cut

    files = recipe.files
    return [cut(part, files.tolerance, files.kerf, files.curves == "arcs") for part in parts]


def _contents(
    recipe: Any, name: str, parts: list[Part], checks: tuple[Check, ...], only: Sequence[str] | None
) -> dict[str, bytes]:
    """File name to bytes, everything that is to be written; nothing is loaded that is not needed."""
    wanted = [f for f in recipe.files.write if only is None or f in only]
    contents: dict[str, bytes] = {}
    if "dxf" in wanted or "svg" in wanted:
        from .export.layout import lay_out

        sheet = lay_out(_flats(recipe, parts))
    if "dxf" in wanted:
        from .export.dxf import dxf

        contents[f"{name}.dxf"] = dxf(sheet)
    if "svg" in wanted:
        from .export.svg import svg

        contents[f"{name}.svg"] = svg(sheet, name, recipe.files.tolerance)
    if "stl" in wanted:
        from .export.stl import stl

        contents |= {f"{cut.part.name}.stl": stl(cut) for cut in _solids(recipe, parts)}
    if "csv" in wanted:
        from .export.csv import csv

        contents[f"{name}.csv"] = csv(kind(recipe.kind).table(recipe))
    contents["summary.json"] = _summary(recipe, name, parts, checks, contents)
    return contents


def _summary(recipe: Any, name: str, parts: list[Part], checks: tuple[Check, ...], contents: dict[str, bytes]) -> bytes:
    from . import __version__

    def part_summary(part: Part) -> dict[str, Any]:
        exact = abs(area(part.outline)) - sum(abs(area(hole)) for hole in part.holes)
        return {
            "name": part.name,
            "count": part.count,
            "layer": part.layer,
            "thickness_mm": part.thickness,
            "area_mm2": float(f"{exact:.10g}"),
            "volume_mm3": float(f"{exact * part.thickness:.10g}"),
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
        "files": sorted(contents),
        "versions": {"geomkin": __version__}
        | {m: sys.modules[m].__version__ for m in ("numpy", "shapely", "ezdxf", "trimesh") if m in sys.modules},
    }
    return (json.dumps(summary, indent=1, ensure_ascii=False) + "\n").encode("utf-8")
