"""The files of a recipe: written whole, and listed with sizes, checks, areas and volumes in summary.json."""

from __future__ import annotations

import json
import os
import re
import signal
import sys
import tempfile
import time
from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from functools import cache
from hashlib import sha256
from math import inf
from pathlib import Path

from ..core.errors import FileError, shown
from ..core.fields import to_digits
from ..core.names import file_name_flaw, folded_name
from ..core.records import record
from ..core.version import __version__
from ..model.check import Check
from ..model.part import Part
from ..plane.measure import area
from .formats import WRITERS, format_of
from .job import Job
from .mesh import solid_volume
from .text import as_json

# Prefix of temporary files, which are hidden so that nobody mistakes one for a part.
PREFIX = ".making-"
# Age, s, after which a temporary file counts as left by a killed run. Writing a file takes far less.
LEFT_BEHIND = 3600


def write_whole(folder: Path, contents: Mapping[str, bytes]) -> None:
    """Write files, by name: all under temporary names first, then each renamed over the old one.

    A full disk leaves all old files. A kill or a simultaneous second run leaves each file old or new, never partial.
    Raises FileError with the reason, and as `check_file_names`.
    """
    check_file_names(folder, contents)
    with _uninterrupted():
        temporary: dict[str, Path] = {}
        try:
            for name, content in contents.items():
                with system_errors_as_file_errors(folder / name):
                    temporary[name] = _write_temporary(folder / name, content)
            for name in contents:
                with system_errors_as_file_errors(folder / name):
                    temporary[name].replace(folder / name)
                del temporary[name]
        finally:
            for path in temporary.values():
                path.unlink(missing_ok=True)
        for home in {folder, *((folder / name).parent for name in contents)}:
            _remove_leftovers(home)


def check_file_names(folder: Path, names: Iterable[str]) -> None:
    """Raise FileError for a name that is not that of a file in the folder or below, and for two that differ by case."""
    seen: set[str] = set()
    for name in names:
        flaw = next(filter(None, map(file_name_flaw, name.split("/"))), "")
        flaw = flaw or ("another file has the same name" if folded_name(name) in seen else "")
        if flaw:
            problem = f"no file can be written as {shown(name)} ({flaw})"
            raise FileError(folder, problem, "give another name", "file-unwritable")
        seen.add(folded_name(name))


def _write_temporary(path: Path, content: bytes) -> Path:
    """A complete temporary file with this content in the same folder, flushed to the disk."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if path.exists() and not path.is_file():
        raise FileExistsError("this name belongs to something that is not a file")
    handle, name = tempfile.mkstemp(prefix=PREFIX, dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        os.chmod(name, 0o666 & ~_umask())
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise
    return Path(name)


def _remove_leftovers(folder: Path) -> None:
    """Remove temporary files of killed runs; those of running ones are younger."""
    for path in folder.glob(f"{PREFIX}*"):
        with suppress(OSError):
            if time.time() - path.stat().st_mtime > LEFT_BEHIND:
                path.unlink()


@contextmanager
def system_errors_as_file_errors(path: Path, done: str = "written") -> Iterator[None]:
    """Turn a system error into a FileError for a file that cannot be read, written or removed; done: which of these."""
    try:
        yield
    except (OSError, ValueError) as error:
        # A path with an invalid character raises ValueError.
        reason = getattr(error, "strerror", None) or str(error)
        problem = f"cannot be {done} ({reason})"
        raise FileError(path, problem, "choose another folder (--out)", "file-unwritable") from error


def remove(path: Path) -> None:
    """Remove a file, which may be gone already; FileError with the reason if that fails."""
    try:
        path.unlink(missing_ok=True)
    except OSError as error:
        problem = f"cannot be removed ({error.strerror})"
        raise FileError(path, problem, "remove it yourself", "file-unwritable") from error


@contextmanager
def _uninterrupted() -> Iterator[None]:
    """Delay Ctrl-C until the temporary files are gone, if the system allows it."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _umask() -> int:
    """The permission bits removed from new files; temporary files start private."""
    mask = os.umask(0)
    os.umask(mask)
    return mask


NAME = "summary.json"
# Ending of the file of the recipe that a goal found.
FOUND = ".found.toml"
# Files of a certificate. They refer to the measured files, hence not to those of a later run.
CERTIFICATE = ("verify.json", "verify.html")
# Largest summary that is read back, in bytes; those written here are far smaller.
LARGEST = 10_000_000


def summary(
    job: Job,
    recipe: object,
    checks: Collection[Check],
    notes: Mapping[str, object],
    written: Mapping[str, Collection[str]],
    further_files: Collection[str] = (),
) -> bytes:
    """The contents of summary.json.

    `recipe` is the data of the recipe file, `notes` are further entries, `written` lists names of files by format,
    `further_files` other files.
    """
    files = sorted({*(name for names in written.values() for name in names), *further_files})
    parts = [_part(part) | _wall(job, part) | sizes for part, sizes in zip(job.source.parts, _as_written(job, written))]
    entries = {
        "name": job.name,
        "recipe": recipe,
        "checks": [check.to_dict() for check in checks],
        "parts": job.unit.entries(parts),
        **job.unit.entries(_sheets(job, written)),
        **notes,
        "files": files,
        "versions": _versions(written),
    }
    return (json.dumps(as_json(entries), indent=1, ensure_ascii=False) + "\n").encode("utf-8", "replace")


def _part(part: Part) -> dict[str, object]:
    exact = area(part.outline) - sum(area(hole) for hole in part.holes)
    return (
        {
            "name": part.name,
            "count": part.count,
            "layer": part.layer,
            "thickness_mm": part.thickness,
            "area_mm2": to_digits(exact, 10),
            "volume_mm3": to_digits(exact * part.thickness, 10),
        }
        | _limits(part)
        | ({} if part.mass is None else {"mass_kg": to_digits(float(part.mass.mass))})
    )


def _limits(part: Part) -> dict[str, object]:
    """Limits of the holes with a fit by ISO 286, by the fit and diameter."""
    fits = {(fit.iso_fit, fit.diameter): fit.limits for fit in part.fits if fit is not None and fit.iso_fit}
    entries = [
        {
            "fit": name,
            "diameter_mm": diameter,
            "hole_deviations_mm": list(limits.hole),
            "shaft_deviations_mm": list(limits.shaft),
            "least_clearance_mm": limits.least_clearance,
            "largest_clearance_mm": limits.largest_clearance,
        }
        for (name, diameter), limits in fits.items()
        if limits is not None
    ]
    return {"fits": entries} if entries else {}


def _wall(job: Job, part: Part) -> dict[str, object]:
    """The thinnest wall; null if the part has none."""
    wall = job.source.walls.get(part.name, inf)
    return {"thinnest_wall_mm": wall if wall < inf else None}


def _sheets(job: Job, written: Collection[str]) -> dict[str, object]:
    """Sizes of the sheets to cut from, if drawings are written, and the share of each that becomes parts."""
    if not any(WRITERS[ending].flat for ending in written):
        return {}
    sizes = (
        {"width_mm": sheet.width, "height_mm": sheet.height, "filled": to_digits(sheet.filled, 4)}
        for sheet in job.sheets
    )
    return {"sheets": list(sizes)}


def _as_written(job: Job, written: Mapping[str, Collection[str]]) -> list[dict[str, float]]:
    """Sizes of each part as written, which differ from the exact ones by the tolerance.

    The area is inside the path of the beam, half a kerf off the part, as in DXF and SVG; the volume is that of the STL.
    """
    sizes: list[dict[str, float]] = [{} for _ in job.source.parts]
    if any(WRITERS[ending].flat for ending in written):
        sizes = [{"written_area_mm2": to_digits(cut.area, 10)} for cut in job.flats]
    if any(WRITERS[ending].needs == "parts" and not WRITERS[ending].flat for ending in written):
        solids = ({"written_volume_mm3": to_digits(solid_volume(cut), 10)} for cut in job.solids)
        sizes = [one | other for one, other in zip(sizes, solids)]
    return sizes


def _versions(written: Collection[str]) -> dict[str, str]:
    """Versions of the packages that the written formats use; others may be loaded for another recipe."""
    packages = [package for ending in WRITERS if ending in written for package in WRITERS[ending].packages]
    return {"geomkin": __version__} | {name: _version(name) for name in (["numpy", *packages] if written else [])}


@cache
def _version(package: str) -> str:
    # Read from the module's dictionary, since some packages warn on access to the attribute.
    if (loaded := sys.modules.get(package)) and (found_version := vars(loaded).get("__version__", "")):
        return str(found_version)
    # Imported only if needed, since reading the metadata loads an e-mail parser.
    from importlib.metadata import version

    return version(package)


def read_summary(folder: Path) -> dict[str, object]:
    """The summary in a folder; empty if there is no valid one."""
    try:
        path = folder / NAME
        # The path may not be a plain file: reading a pipe would block, a device or a huge file would fill the memory.
        if not path.is_file():
            return {}
        with path.open("rb") as file:
            content = file.read(LARGEST + 1)
        data = json.loads(content) if len(content) <= LARGEST else {}
        return data if isinstance(data, dict) else {}
    except (OSError, ValueError, RecursionError):
        return {}


def listed_files(folder: Path) -> set[str]:
    """Names of the files that the summary in a folder lists; empty if there is no valid one."""
    names = read_summary(folder).get("files")
    if not isinstance(names, list):
        return set()
    ours = [name for name in names if isinstance(name, str) and (format_of(name) or name.endswith(FOUND))]
    return {name for name in ours if not file_name_flaw(name)}


# Raised when the meaning of a stamp changes.
LAYOUT = 1
# Hexadecimal digits of the hash: as many as the header of an STL file has room for.
DIGITS = 32
TEXT = re.compile(rf"geomkin (\d{{1,6}}) recipe ([0-9a-f]{{{DIGITS}}}) tolerance (\S{{1,24}}) mm")


# Whole numbers up to this size are exact as floats.
MOST_EXACT = 2**53


def recipe_hash(data: Mapping[str, object]) -> str:
    """SHA-256 of a recipe's data, as summary.json holds it; the same for any order of its keys, and for 3 and 3.0."""
    return sha256(json.dumps(_in_floats(as_json(data)), sort_keys=True, ensure_ascii=True).encode()).hexdigest()


def _in_floats(data: object) -> object:
    if isinstance(data, Mapping):
        return {key: _in_floats(value) for key, value in data.items()}
    if isinstance(data, list):
        return [_in_floats(value) for value in data]
    is_whole = isinstance(data, int) and not isinstance(data, bool) and abs(data) < MOST_EXACT
    return float(data) if is_whole else data  # type: ignore[arg-type]


@record
class Stamp:
    """A stamp as files carry it: number of its layout, start of the recipe's hash, and tolerance, mm."""

    recipe: str
    tolerance: float
    layout: int = LAYOUT

    def __str__(self) -> str:
        return f"geomkin {self.layout} recipe {self.recipe[:DIGITS]} tolerance {self.tolerance!r} mm"

    @classmethod
    def read(cls, text: str) -> Stamp | None:
        """The stamp in a text; None if there is none."""
        found = TEXT.search(text[:1000])
        if not found:
            return None
        try:
            return cls(found.group(2), float(found.group(3)), int(found.group(1)))
        except ValueError:
            return None
