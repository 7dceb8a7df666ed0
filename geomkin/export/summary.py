"""summary.json: sizes, checks, areas and volumes of what was made, and which files it is."""

from __future__ import annotations

import json
import sys
from collections.abc import Collection, Mapping
from functools import cache
from math import inf, isfinite
from pathlib import Path

from ..core.names import file_name_flaw
from ..core.version import __version__
from ..model.check import Check
from ..model.part import Part
from ..plane.measure import area
from .formats import WRITERS, format_of
from .job import Job
from .mesh import volume

NAME = "summary.json"
# What follows a goal's name in that of the file of the recipe it found.
FOUND = ".found.toml"
# Bytes of a summary that is read back: those of ours stay far below it.
LARGEST = 10_000_000


def summary(
    job: Job,
    recipe: object,
    checks: Collection[Check],
    notes: Mapping[str, object],
    written: Mapping[str, Collection[str]],
    besides: Collection[str] = (),
) -> bytes:
    """The summary.

    recipe: as a recipe file gives it; notes: further entries; written: names of files by format; besides: of others.
    """
    files = sorted([*(name for names in written.values() for name in names), *besides])
    sizes = _as_written(job, written)
    told = {
        "name": job.name,
        "recipe": recipe,
        "checks": [check.to_dict() for check in checks],
        "parts": [_part(part) | _wall(job, part) | sizes.get(part, {}) for part in job.source.parts],
        **_sheets(job, written),
        **notes,
        "files": files,
        "versions": _versions(written),
    }
    return (json.dumps(as_json(told), indent=1, ensure_ascii=False) + "\n").encode("utf-8", "replace")


def as_json(held: object) -> object:
    """The same with numbers that JSON has not as "inf", "-inf", or null for nan."""
    if isinstance(held, Mapping):
        return {name: as_json(value) for name, value in held.items()}
    if isinstance(held, (list, tuple)):
        return [as_json(value) for value in held]
    if isinstance(held, float) and not isfinite(held):
        return None if held != held else str(float(held))
    return held


def _part(part: Part) -> dict[str, object]:
    exact = area(part.outline) - sum(area(hole) for hole in part.holes)
    return {
        "name": part.name,
        "count": part.count,
        "layer": part.layer,
        "thickness_mm": part.thickness,
        "area_mm2": float(f"{exact:.10g}"),
        "volume_mm3": float(f"{exact * part.thickness:.10g}"),
    }


def _wall(job: Job, part: Part) -> dict[str, object]:
    """The thinnest wall, null where the part has none."""
    wall = job.source.walls.get(part.name, inf)
    return {"thinnest_wall_mm": wall if wall < inf else None}


def _sheets(job: Job, written: Collection[str]) -> dict[str, object]:
    """Sheets that the drawings to cut from lie on, where there are any, and which share of each becomes parts."""
    if not any(WRITERS[ending].flat for ending in written):
        return {}
    sizes = (
        {"width_mm": sheet.width, "height_mm": sheet.height, "filled": float(f"{sheet.filled:.4g}")}
        for sheet in job.sheets
    )
    return {"sheets": list(sizes)}


def _as_written(job: Job, written: Mapping[str, Collection[str]]) -> dict[Part, dict[str, float]]:
    """Sizes of the parts as files have them, which differ from the exact ones by the tolerance.

    The area is that within the beam's path, half a kerf off the part, as DXF and SVG have it; the volume the STL's.
    """
    sizes: dict[Part, dict[str, float]] = {}
    if any(WRITERS[ending].flat for ending in written):
        sizes = {cut.part: {"written_area_mm2": float(f"{cut.area:.10g}")} for cut in job.flats}
    if any(WRITERS[ending].needs == "parts" and not WRITERS[ending].flat for ending in written):
        for cut in job.solids:
            sizes[cut.part] = sizes.get(cut.part, {}) | {"written_volume_mm3": float(f"{volume(cut):.10g}")}
    return sizes


def _versions(written: Collection[str]) -> dict[str, str]:
    """Versions of what had a hand in the files; other libraries may be loaded for another recipe."""
    hands = [package for ending in WRITERS if ending in written for package in WRITERS[ending].packages]
    return {"geomkin": __version__} | {name: _version(name) for name in (["numpy", *hands] if written else [])}


@cache
def _version(package: str) -> str:
    # What stands there; some packages warn where it is made up when asked for.
    if (loaded := sys.modules.get(package)) and (told := vars(loaded).get("__version__", "")):
        return str(told)
    # Reading it from what was installed loads a parser of mail.
    from importlib.metadata import version

    return version(package)


def told(folder: Path) -> dict[str, object]:
    """What the summary in a folder says; nothing where there is no sound one."""
    try:
        path = folder / NAME
        # What stands there may be anything: a pipe would be waited on, a device or a huge file fill the memory.
        if not path.is_file():
            return {}
        with path.open("rb") as file:
            content = file.read(LARGEST + 1)
        found = json.loads(content) if len(content) <= LARGEST else {}
        return found if isinstance(found, dict) else {}
    except (OSError, ValueError, RecursionError):
        return {}


def files_told(folder: Path) -> set[str]:
    """Names of the files that the summary in a folder tells of; none where there is no sound one."""
    names = told(folder).get("files")
    if not isinstance(names, list):
        return set()
    ours = [name for name in names if isinstance(name, str) and (format_of(name) or name.endswith(FOUND))]
    return {name for name in ours if not file_name_flaw(name)}
