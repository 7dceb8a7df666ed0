"""Certificates: every file of a folder measured against the exact curves of its recipe."""

from __future__ import annotations

import csv
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from math import isfinite, nan
from pathlib import Path

import numpy as np

from ..build import errors_named_by_key
from ..core.arguments import checked
from ..core.errors import FileError, GeomkinError, harmless, printable
from ..core.fields import to_digits
from ..core.names import PathName, file_name_flaw
from ..core.progress import report
from ..core.records import record
from ..core.units import MM, UNITS, LengthUnit, Sentence, bare_mm, marked, mm, sentences
from ..export.cut import LayerStyles
from ..export.formats import format_of
from ..export.summary import FOUND, LAYOUT, NAME, Stamp, read_summary, recipe_hash
from ..model.part import Bought, Part
from ..model.table import Table
from ..recipe.load import from_table, parse
from ..recipe.recipe import AbstractRecipe
from ..recipe.shown import ShownRecipe
from .comparison import (
    FINENESS,
    MOST_PLATES,
    ExactPart,
    Measured,
    exact_part,
    measure_drawing,
    measure_mesh,
    measure_plate,
    refuse_more,
    worst_of,
)  # fmt: skip
from .outline import LARGEST, UnreadableError
from .read_back import read_3mf, read_dxf, read_glb, read_step, read_stl, read_svg

# Relative difference of numbers that were written with ten digits, and absolute one as a share of the column's size.
CLOSE, NOISE = 2e-9, 1e-10


def read_cells(path: Path) -> list[list[str]]:
    """The cells of a CSV file, line by line; UnreadableError if it is not CSV."""
    with path.open("rb") as file:
        content = file.read(LARGEST + 1)
    if len(content) > LARGEST:
        raise UnreadableError(f"it has more than {LARGEST:,} bytes")
    try:
        rows = list(csv.reader(content.decode("utf-8").splitlines()))
    except (UnicodeDecodeError, csv.Error) as fault:
        raise UnreadableError(f"it is not CSV ({type(fault).__name__})") from None
    if not rows or any(len(row) != len(rows[0]) for row in rows):
        raise UnreadableError("its rows have different numbers of cells")
    return rows


def motion_problems(path: Path, table: Table) -> list[str]:
    """Differences between a CSV file and the table of its recipe, a sentence each."""
    header, *rows = read_cells(path)
    expected = {column.header: column.written for column in table.columns}
    if header != list(expected):
        return ["its columns are not those of the recipe"]
    problems = []
    for k, (name, values) in enumerate(expected.items()):
        cells = [row[k] for row in rows]
        if len(cells) != len(values):
            return [f"it has {len(cells)} rows, but the recipe's table has {len(values)}"]
        if np.asarray(values).dtype.kind not in "fiub":
            wrong = [j for j, (cell, value) in enumerate(zip(cells, values)) if cell.lstrip("'") != str(value)]
        else:
            wrong = _wrong_numbers(cells, np.asarray(values, dtype=float))
        if wrong:
            problems.append(f"row {wrong[0] + 2} of {name} is not that of the recipe ({len(wrong)} such rows)")
    return problems


def _wrong_numbers(cells: Sequence[str], values: np.ndarray[tuple[int], np.dtype[np.float64]]) -> list[int]:
    try:
        found = np.array([float(cell) if cell else np.nan for cell in cells])
    except ValueError:
        return [next(k for k, cell in enumerate(cells) if cell and not _is_number(cell))]
    known = np.isfinite(values)
    size = np.abs(values[known]).max(initial=0.0)
    same = np.where(known, np.abs(found - values) <= CLOSE * np.abs(values) + NOISE * size + NOISE, np.isnan(found))
    return [int(k) for k in np.flatnonzero(~same)]


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def bill_problems(path: Path, parts: Sequence[Part], bought: Sequence[Bought]) -> list[str]:
    """Differences between a bill of materials and the parts and bought items, a sentence each."""
    header, *rows = read_cells(path)
    try:
        item, count = header.index("item"), header.index("count")
        listed = [(row[item].lstrip("'"), int(row[count])) for row in rows]
    except ValueError:
        return ["it has no columns of items and counts"]
    expected = [(part.name, part.count) for part in parts] + [(item.name, item.count) for item in bought]
    missing = [line for line in expected if line not in listed]
    further = [line for line in listed if line not in expected]
    return [f"it lacks {count} x {name}" for name, count in missing] + [
        f"it has {count} x {name}, which the recipe does not have" for name, count in further
    ]


# Share of the tolerance by which a deviation may exceed it: the error of the measurement itself.
MEASURED = 2 * FINENESS
# Largest number of files of a folder that are measured.
MOST_FILES = 10_000


@record(eq=False)
class FileReport:
    """The result of measuring one file.

    Parameters
    ----------
    file : str
        Name of the file.
    format : str
        Its format, as `files.write` names it.
    measured : bool
        Whether its contents were compared with the recipe; pictures and pages are not.
    deviation : float
        Largest distance between the file and the exact curves, either way, mm; nan if it has none.
    allowed : float
        The tolerance, mm.
    place : complex
        Position of the largest deviation, mm, in the frame of the part.
    part : str
        Name of that part.
    parts, holes : int
        Numbers of parts and of their holes in the file.
    problems : tuple of str
        Problems of the file, a sentence each.
    worst : Measured, optional
        The plate with the largest deviation, and the exact one.
    """

    file: str
    format: str
    measured: bool = True
    deviation: float = nan
    allowed: float = nan
    place: complex = 0j
    part: str = ""
    parts: int = 0
    holes: int = 0
    problems: tuple[str, ...] = ()
    worst: Measured | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "problems", sentences(self.problems))

    @property
    def passed(self) -> bool:
        """Whether there are no problems."""
        return not self.problems

    def to_dict(self) -> dict[str, object]:
        """As JSON files state it."""
        entries: dict[str, object] = {"file": self.file, "format": self.format, "measured": self.measured}
        if isfinite(self.deviation):
            entries |= {
                "deviation_mm": to_digits(self.deviation, 3),
                "allowed_mm": self.allowed,
                "part": self.part,
                "at_mm": [round(self.place.real, 4) + 0.0, round(self.place.imag, 4) + 0.0],
            }
        if self.parts:
            entries |= {"parts": self.parts, "holes": self.holes}
        return entries | {"passed": self.passed, "problems": list(self.problems)}


@record(eq=False)
class Certificate:
    """The results of measuring the files of one recipe.

    Parameters
    ----------
    folder : Path
    name, kind : str
        Of the recipe.
    recipe_hash : str
        SHA-256 of the recipe, as the stamps of its files state it.
    tolerance, kerf : float
        Of the recipe, mm.
    files : tuple of FileReport
    problems : tuple of str
        Problems of the folder itself, a sentence each.
    unit : LengthUnit
        Unit of lengths in the files of the certificate: that of the recipe.
    """

    folder: Path
    name: str
    kind: str
    recipe_hash: str
    tolerance: float
    kerf: float
    files: tuple[FileReport, ...]
    problems: tuple[str, ...] = ()
    unit: LengthUnit = MM

    def __post_init__(self) -> None:
        object.__setattr__(self, "problems", sentences(self.problems))

    @property
    def passed(self) -> bool:
        """Whether neither the folder nor any file has problems."""
        return not self.problems and all(file.passed for file in self.files)

    def to_dict(self) -> dict[str, object]:
        """As JSON files state it."""
        data: dict[str, object] = self.unit.entries(self._data)
        return data

    @property
    def _data(self) -> dict[str, object]:
        return {
            "name": self.name,
            "kind": self.kind,
            "recipe_sha256": self.recipe_hash,
            "tolerance_mm": self.tolerance,
            "kerf_mm": self.kerf,
            "passed": self.passed,
            "problems": list(self.problems),
            "files": [file.to_dict() for file in self.files],
        }


@checked
def verify(folder: PathName) -> list[Certificate]:
    """Read the files of recipes back and measure them against the exact curves.

    Parameters
    ----------
    folder : str or Path
        The folder of a recipe, as `make` writes it, or one that holds such folders.

    Returns
    -------
    list of Certificate
        One for each recipe, by name.

    Raises
    ------
    FileError
        If there is no folder of a recipe.

    Notes
    -----
    DXF is read by ezdxf, STL and GLB by trimesh, SVG, 3MF and CSV by the standard library, STEP by a reader of its own;
    none shares code with a writer. Deviations are bounded, not sampled: along an edge the distance to another edge is
    convex, and a piece of a curve of length L between two points at the distance c lies in the ellipse about them whose
    axis is L.

    Examples
    --------
    >>> import geomkin as gk, tempfile
    >>> out = tempfile.mkdtemp()
    >>> recipe = gk.load({"kind": "spur-gear", "gear": {"teeth": 12, "module": 2}, "files": {"write": ["dxf"]}})
    >>> _ = gk.make(recipe, out)
    >>> [certificate.passed for certificate in gk.verify(out)]
    [True]
    """
    return [_certificate(inside) for inside in recipe_folders(Path(folder))]


def recipe_folders(folder: Path) -> list[Path]:
    """A folder of a recipe, or those in it, by name. FileError if there are none."""
    if (folder / NAME).is_file():
        return [folder]
    try:
        folders = sorted(inside for inside in folder.iterdir() if (inside / NAME).is_file())
    except OSError as error:
        raise FileError(folder, f"cannot be read ({error.strerror})", "give a folder", "file-unreadable") from error
    if not folders:
        remedy = "give a folder that geomkin run has written"
        raise FileError(folder, f"has no recipe: no {NAME} in it or one level below", remedy, "file-unreadable")
    return folders


def _certificate(folder: Path) -> Certificate:
    summary = read_summary(folder)
    data, names = summary.get("recipe"), summary.get("files")
    name = str(summary.get("name", folder.name))
    if not isinstance(data, dict) or not isinstance(names, list):
        problem = f"{NAME} cannot be read, or has no recipe"
        return Certificate(folder, harmless(name), "", "", nan, nan, (), (problem,))
    kind, hashed = str(data.get("kind", "")), recipe_hash(data)
    try:
        sources = summary.get("sources")
        recipe = from_table(data, NAME, str(folder) if not isinstance(sources, dict) else sources)
        expected = Expected(recipe)
        with errors_named_by_key(NAME, recipe):
            _ = expected.parts
    except GeomkinError as error:
        problem = f"the recipe in {NAME} cannot be made again: {harmless(error)}"
        return Certificate(folder, harmless(name), harmless(kind), hashed, nan, nan, (), (problem,))
    wanted = [str(name) for name in names[:MOST_FILES] if not file_name_flaw(str(name))]
    reports = []
    for k, file in enumerate(wanted):
        report(k / len(wanted), f"{name}: {file}")
        reports.append(_report(folder / file, expected, hashed))
    report(1.0, name)
    files = tuple(_with_counts(reports, expected))
    return Certificate(
        folder,
        harmless(name),
        harmless(kind),
        hashed,
        recipe.files.tolerance,
        recipe.files.kerf,
        files,
        unit=UNITS[recipe.units],
    )


@dataclass
class Expected:
    """The contents that the files of a recipe should have."""

    recipe: AbstractRecipe

    @cached_property
    def parts(self) -> tuple[ExactPart, ...]:
        """The parts with their exact curves."""
        files = self.recipe.files
        return tuple(exact_part(part, files.kerf, files.tolerance, files.cutter) for part in self.recipe.parts)

    def named(self, name: str) -> ExactPart:
        """The part of this name, or of this name with the number of a copy."""
        for part in self.parts:
            if part.part.name in (name, name.rpartition(" ")[0]):
                return part
        raise UnreadableError(f"the recipe has no part {printable(name, 60)}")

    @cached_property
    def assembled(self) -> dict[str, ExactPart]:
        """The parts in the assembly, where a repeated name is numbered; those of mirrored copies are turned over."""
        files, counts, named = self.recipe.files, Counter[str](), dict[str, ExactPart]()
        known = {id(exact.part): exact for exact in self.parts}
        bodies = self.recipe.scene.bodies if self.recipe.scene else ()
        for part in (part for body in bodies for part in body.parts):
            counts[part.name] += 1
            name = f"{part.name} {counts[part.name]}" if counts[part.name] > 1 else part.name
            named[name] = known.get(id(part)) or exact_part(part, files.kerf, files.tolerance)
        return named

    def in_assembly(self, name: str) -> ExactPart:
        """The part of this name in the assembly."""
        if name not in self.assembled:
            raise UnreadableError(f"the assembly has no part {printable(name, 60)}")
        return self.assembled[name]

    def missing_problems(self, names: Iterable[str]) -> list[str]:
        """A sentence for each part of the assembly that is not among the names."""
        present = set(names)
        return [f"{printable(name, 60)} is missing" for name in self.assembled if name not in present]

    @property
    def count(self) -> int:
        """Number of all copies of all parts."""
        return sum(part.part.count for part in self.parts)

    @property
    def tolerance(self) -> float:
        """mm."""
        return self.recipe.files.tolerance


@dataclass
class Content:
    """The plates or solids of a file, its stamp, and problems of the file itself."""

    measured: list[Measured]
    stamp: str = ""
    problems: tuple[str, ...] = ()


def _dxf(path: Path, expected: Expected) -> Content:
    files, unit = expected.recipe.files, UNITS[expected.recipe.units]
    layers = {name: layer for layer, name in (files.layers or LayerStyles()).names.items()}
    drawing = read_dxf(path, expected.tolerance * FINENESS / 2, unit.mm).with_layers(layers)
    return Content(measure_drawing(drawing, expected.parts, expected.tolerance), drawing.stamp, drawing.problems)


def _svg(path: Path, expected: Expected) -> Content:
    drawing = read_svg(path, expected.tolerance * FINENESS / 2)
    return Content(measure_drawing(drawing, expected.parts, expected.tolerance), drawing.stamp, drawing.problems)


def _stl(path: Path, expected: Expected) -> Content:
    meshes, problems, stamp = read_stl(path)
    exact = expected.named(path.stem)
    return Content([measure_mesh(mesh, exact, expected.tolerance) for mesh in meshes], stamp, tuple(problems))


def _glb(path: Path, expected: Expected) -> Content:
    meshes, problems, stamp = read_glb(path)
    refuse_more(len(meshes), len(expected.assembled), MOST_PLATES, "solids")
    measured = [measure_mesh(mesh, expected.in_assembly(mesh.name), expected.tolerance) for mesh in meshes]
    return Content(measured, stamp, (*problems, *expected.missing_problems(mesh.name for mesh in meshes)))


def _threemf(path: Path, expected: Expected, assembled: bool = False) -> Content:
    meshes, counts, problems, stamp = read_3mf(path)
    named = expected.in_assembly if assembled else expected.named
    count = len(expected.assembled) if assembled else expected.count
    if assembled:
        problems += expected.missing_problems(counts)
    refuse_more(max(len(meshes), sum(counts.values())), count, MOST_PLATES, "solids")
    measured: list[Measured] = []
    for mesh in meshes:
        found = measure_mesh(mesh, named(mesh.name), expected.tolerance)
        measured += [found] * counts.get(mesh.name, 0)
    return Content(measured, stamp, tuple(problems))


def _step(path: Path, expected: Expected) -> Content:
    plate = read_step(path, expected.tolerance * FINENESS / 2)
    exact = expected.named(path.stem)
    found = measure_plate((plate.lower, plate.upper), plate.thickness, plate.walls, exact, expected.tolerance)
    return Content([found], plate.stamp)


def _csv(path: Path, expected: Expected) -> Content:

    return Content([], problems=tuple(motion_problems(path, ShownRecipe(expected.recipe).table)))


def _bom(path: Path, expected: Expected) -> Content:

    return Content([], problems=tuple(bill_problems(path, expected.recipe.parts, ShownRecipe(expected.recipe).bought)))


# Readers by format; other formats are pictures and pages.
READERS: Mapping[str, Callable[[Path, Expected], Content]] = {
    "dxf": _dxf,
    "svg": _svg,
    "stl": _stl,
    "glb": _glb,
    "3mf": _threemf,
    "assembly-3mf": partial(_threemf, assembled=True),
    "step": _step,
    "csv": _csv,
    "bom": _bom,
}
# Formats whose files together contain every copy of every part.
ALL_COPIES = ("dxf", "svg", "3mf")
# Formats whose files have a place for a stamp.
STAMPED = ("dxf", "svg", "stl", "glb", "3mf", "assembly-3mf", "step")


def _report(path: Path, expected: Expected, hashed: str) -> FileReport:
    if path.name.endswith(FOUND):
        return FileReport(path.name, "recipe", measured=False, problems=_found_problems(path))
    kind = format_of(path.name)
    file = partial(FileReport, path.name, kind, allowed=expected.tolerance)
    try:
        if path.is_symlink() or not path.is_file():
            return file(problems=("it is missing",))
        if path.stat().st_size > LARGEST:
            return file(problems=(f"it has more than {LARGEST:,} bytes",))
        if kind not in READERS:
            return FileReport(path.name, kind, measured=False)
        content = READERS[kind](path, expected)
    except (UnreadableError, OSError, GeomkinError) as error:
        return file(problems=(Sentence(str(error), harmless),))
    problems = [*content.problems, *(_stamp_problems(content.stamp, expected, hashed) if kind in STAMPED else [])]
    for part in content.measured:
        named = printable(part.part, 60) or "the drawing"
        problems += [f"{named}: {marked(problem)}" for problem in part.problems]
        if part.deviation > expected.tolerance * (1 + MEASURED):
            problems.append(
                f"{named}: {mm(part.deviation):.4g} off its curve at "
                f"({bare_mm(part.place.real, part.place.imag):.3f}), "
                f"and {mm(expected.tolerance):g} are allowed"
            )
    worst = worst_of(content.measured)
    return file(
        deviation=worst.deviation,
        place=worst.place,
        part=worst.part,
        parts=len(content.measured),
        holes=sum(part.holes for part in content.measured),
        problems=tuple(map(harmless, problems)),
        worst=worst if worst.plate else None,
    )


def _stamp_problems(text: str, expected: Expected, hashed: str) -> list[str]:
    stamp = Stamp.read(text)
    if stamp is None:
        return ["it has no stamp: another program wrote it"]
    if stamp.layout != LAYOUT:
        return [f"its stamp has layout {stamp.layout}, but this version reads layout {LAYOUT}"]
    if not hashed.startswith(stamp.recipe) or stamp.tolerance != expected.tolerance:
        return ["its stamp is that of another recipe or tolerance"]
    return []


def _found_problems(path: Path) -> tuple[str, ...]:
    """A sentence if the recipe that a goal found cannot be read; otherwise empty."""
    try:
        with path.open("rb") as file:
            parse(file.read(LARGEST).decode("utf-8"), path.name)
    except (GeomkinError, OSError, UnicodeDecodeError) as error:
        return (f"it cannot be read as a recipe: {harmless(error)}",)
    return ()


def _with_counts(reports: Iterable[FileReport], expected: Expected) -> Iterable[FileReport]:
    """The reports. If a format does not have all copies of all parts, its first file gets a problem that states so."""
    reports = list(reports)
    copies = Counter({part.part.name: part.part.count for part in expected.parts})
    for kind in ALL_COPIES:
        indices = [k for k, report in enumerate(reports) if report.format == kind]
        if indices and all(isfinite(reports[k].deviation) for k in indices):
            total = sum(reports[k].parts for k in indices)
            if total != sum(copies.values()):
                first = reports[indices[0]]
                problem = f"{total} parts are drawn, but the recipe has {sum(copies.values())}"
                reports[indices[0]] = replace(first, problems=(*first.problems, problem))
    return reports
