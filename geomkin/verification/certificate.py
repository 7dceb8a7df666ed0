"""Certificates: every file of a folder compared with that made again, or measured against the exact curves."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from math import inf, isfinite, nan
from pathlib import Path

from ..build import computed
from ..core.arguments import checked
from ..core.errors import FileError, GeomkinError, harmless, printable
from ..core.fields import to_digits
from ..core.names import PathName, file_name_flaw
from ..core.processes import report
from ..core.records import record
from ..core.units import MM, UNITS, LengthUnit, Sentence, bare_mm, marked, mm, sentences
from ..export.cut import LayerStyles
from ..export.formats import format_in, format_of
from ..export.summary import CERTIFICATE, FOUND, LAYOUT, NAME, Stamp, read_summary, recipe_hash
from ..model.machinability import beam_checks, relieved
from ..plane.vec import box_of
from ..recipe.load import from_table
from ..recipe.recipe import AbstractGoal, AbstractRecipe
from ..recipe.settings import Format
from .comparison import (
    FINENESS,
    MOST_PLATES,
    ExactPart,
    Measured,
    colliding,
    exact_part,
    measure_drawing,
    refuse_more,
    worst_of,
)
from .made_again import Difference, difference
from .outline import LARGEST, Drawing, UnreadableError
from .read_back import content_of, read_3mf, read_dxf, read_stl, read_svg
from .solids import Mesh, measure_mesh

# Share of the tolerance by which a deviation may exceed it: the error of the measurement itself.
MEASURED = 2 * FINENESS
# Largest number of files of a folder that are measured.
MOST_FILES = 10_000
CUT_SHORT = (
    "its search was ended by search.time_limit, so its result depends on the computer and cannot be certified; run the "
    "recipe with a longer time_limit"
)


@record(eq=False)
class FileReport:
    """The result of verifying one file.

    Parameters
    ----------
    file : str
        Name of the file.
    format : str
        Its format, as `files.write` names it; that of other files is "recipe" or "summary".
    proof : {"made again", "measured", ""}
        What proves the file: it is the one that its recipe makes again, or its geometry was measured and everything
        else in it is as geomkin writes it; empty if neither does.
    note : str
        How the file differs from the one made again; empty if its bytes are equal.
    deviation : float
        Largest distance between the file and the exact curves, either way, mm; nan if it was not measured.
    allowed : float
        The tolerance, mm.
    place : complex
        Position of the largest deviation, mm, in the frame of the part.
    part : str
        Name of that part.
    parts, holes : int
        Numbers of measured parts and of their holes in the file.
    problems : tuple of str
        Problems of the file, a sentence each.
    worst : Measured, optional
        The plate with the largest deviation, and the exact one.
    """

    file: str
    format: str
    proof: str = ""
    note: str = ""
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
        entries: dict[str, object] = {"file": self.file, "format": self.format, "proved_by": self.proof}
        entries |= {"difference": self.note} if self.note else {}
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
    reports : mapping of str to bytes
        The reports of the recipe by file name, with these results.
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
    reports: Mapping[str, bytes] = field(default_factory=dict)

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
    """Compare the files of recipes with those made again, and measure those that differ against the exact curves.

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

    See Also
    --------
    make

    Notes
    -----
    A file that is the same as the one made again, but for the last digits of its numbers, needs no other proof. The
    lines or solids of a DXF, SVG, STL or 3MF file that differs are measured, and whatever else is in the file must be
    as geomkin writes it. DXF is read by ezdxf, STL by trimesh, SVG, 3MF and CSV by the standard library, STEP by a
    reader of its own; none shares code with a writer. Deviations are bounded, not sampled: along an edge the distance
    to another edge is convex, and a piece of a curve of length L between two points at the distance c lies in the
    ellipse about them whose axis is L.

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
    listed = {str(name) for name in names[:MOST_FILES] if not file_name_flaw(str(name))}
    try:
        recipe = _recipe(folder, summary, data)
        formats = {format_in(name, file) for file in listed if not file.endswith(FOUND)}
        expected = Expected(recipe, computed(recipe, sorted(formats) or None)[1], hashed)
    except GeomkinError as error:
        problem = f"the recipe in {NAME} cannot be made again: {harmless(error)}"
        return Certificate(folder, harmless(name), harmless(kind), hashed, nan, nan, (), (problem,))
    present = {path.name for path in folder.iterdir() if format_of(path.name) or path.name.endswith(FOUND)}
    wanted = sorted(listed | expected.contents.keys() | present - {*CERTIFICATE})
    reports = []
    for k, file in enumerate(wanted[:MOST_FILES]):
        report(k / len(wanted), f"{name}: {file}")
        reports.append(_report(folder / file, expected))
    files, unit = recipe.files, UNITS[recipe.units]
    certified = _certified_reports(expected, formats, reports, unit)
    reports = [_as_certified(folder, file, certified.get(file.file)) for file in reports]
    # A report with problems is left as it is.
    certified = {file.file: certified[file.file] for file in reports if file.passed and file.file in certified}
    report(1.0, name)
    is_cut = summary.get("cut_short") or (isinstance(recipe, AbstractGoal) and recipe.cut_short)
    problems = (CUT_SHORT,) if is_cut and not all(file.passed for file in reports) else ()
    own = harmless(name), harmless(kind), hashed, files.tolerance, files.kerf
    return Certificate(folder, *own, tuple(reports), problems, unit, certified)


def _certified_reports(
    expected: Expected, formats: Collection[str | None], files: Sequence[FileReport], unit: LengthUnit
) -> Mapping[str, bytes]:
    """The reports of a recipe with the results for its other files."""
    wanted = [name for name in REPORTS if name in formats]
    if not wanted:
        return {}
    rows = []
    for file in files:
        deviation = f"{unit.of(file.deviation):.3g}" if isfinite(file.deviation) else ""
        verdict = "as designed" if file.passed else "NOT as designed"
        # The report and its pictures are not listed in itself.
        if not file.file.startswith(f"{expected.recipe.name}-report"):
            rows.append((file.file, file.proof, deviation, verdict))
    made = computed(expected.recipe, wanted, tuple(rows))[1]
    return {name: content for name, content in made.items() if format_of(name) in REPORTS}


def _as_certified(folder: Path, file: FileReport, certified: bytes | None) -> FileReport:
    """A report that has the results already is made again too; one that has others is named as such."""
    path = folder / file.file
    is_read = not path.is_symlink() and path.is_file() and path.stat().st_size <= LARGEST
    if certified is None or file.passed or not is_read:
        return file
    content = path.read_bytes()
    apart = difference(content, certified, file.format)
    if apart is None or not apart.problems:
        return FileReport(file.file, file.format, "made again", apart.note if apart else "")
    rest = difference(VERDICT.sub(b"", content), VERDICT.sub(b"", certified), file.format)
    is_earlier = file.format == "report-md" and (rest is None or not rest.problems)
    problem = "it states the results of another verification: make the files again"
    return FileReport(file.file, file.format, problems=(problem,)) if is_earlier else file


def _recipe(folder: Path, summary: Mapping[str, object], data: Mapping[str, object]) -> AbstractRecipe:
    """The recipe of a summary, under its name, with the fits that nobody stated and the workshop file that did."""
    sources, name = summary.get("sources"), str(summary.get("name", folder.name))
    recipe = from_table(data, NAME, str(folder) if not isinstance(sources, dict) else sources).with_name(name)
    assumed = [entry for key, entry in summary.items() if key.startswith("assumed_") and isinstance(entry, dict)]
    for key in (key for entry in assumed for key in entry):
        _leave_out(recipe, key)
    if "workshop" in summary:
        object.__setattr__(recipe, "loaded_table", {**(recipe.loaded_table or {}), "workshop": summary["workshop"]})
    return recipe


def _leave_out(recipe: AbstractRecipe, key: str) -> None:
    """Let a recipe, or that of a mechanism of a machine, be one whose table does not state a fit, by its dotted key."""
    for name, mechanism in getattr(recipe, "mechanisms", {}).items():
        if key.startswith(prefix := f"mechanisms.{name}.recipe."):
            _leave_out(mechanism.recipe, key.removeprefix(prefix))
    table, _, fit = key.partition(".")
    stated = (recipe.loaded_table or {}).get(table)
    if isinstance(stated, Mapping):
        left = {name: value for name, value in stated.items() if name != fit}
        object.__setattr__(recipe, "loaded_table", {**(recipe.loaded_table or {}), table: left})


@dataclass
class Expected:
    """The contents that the files of a recipe should have."""

    recipe: AbstractRecipe
    contents: Mapping[str, bytes]
    hashed: str

    @cached_property
    def parts(self) -> tuple[ExactPart, ...]:
        """The parts with their exact curves."""
        files, parts = self.recipe.files, self.recipe.parts
        numbers = range(1, len(parts) + 1) if files.labels else [0] * len(parts)
        printing = self.recipe.printing
        return tuple(exact_part(part, files, printing, number) for part, number in zip(parts, numbers))

    def named(self, name: str) -> ExactPart:
        """The part of this name."""
        for part in self.parts:
            if part.part.name == name:
                return part
        raise UnreadableError(f"the recipe has no part {printable(name, 60)}")

    @cached_property
    def left(self) -> tuple[str, ...]:
        """A sentence for each part of which the beam leaves a corner or gap."""
        files = self.recipe.files
        wide = max(files.kerf, files.cutter)
        checks = beam_checks([relieved(part, files.cutter) for part in self.recipe.parts], wide, files.tolerance)
        return sentences(
            f"a beam or cutter {mm(wide):g} wide leaves {mm(check.value):g} of a corner or gap, and "
            f"{mm(check.limit):g} are allowed"
            for check in checks
            if not check.passed
        )

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
    return _drawn(path, expected, lambda content, error: read_dxf(content, error, unit.mm).with_layers(layers))


def _svg(path: Path, expected: Expected) -> Content:
    return _drawn(path, expected, read_svg)


def _drawn(path: Path, expected: Expected, read: Callable[[bytes, float], Drawing]) -> Content:
    contents, error = (content_of(path), expected.contents[path.name]), expected.tolerance * FINENESS / 2
    drawing, again = (read(content, error) for content in contents)
    return Content(measure_drawing(drawing, again, expected.parts, expected.tolerance), drawing.stamp, drawing.problems)


def _stl(path: Path, expected: Expected) -> Content:
    meshes, problems, stamp = read_stl(path)
    exact = expected.named(path.stem)
    return Content([measure_mesh(mesh, exact, expected.tolerance) for mesh in meshes], stamp, tuple(problems))


def _threemf(path: Path, expected: Expected) -> Content:
    meshes, places, problems, stamp = read_3mf(path)
    refuse_more(max(len(meshes), len(places)), expected.count, MOST_PLATES, "solids")
    exact = {number: expected.named(mesh.name) for number, mesh in meshes.items()}
    measured = {number: measure_mesh(mesh, exact[number], expected.tolerance) for number, mesh in meshes.items()}
    if pairs := colliding([exact[number].solid.placed(*place) for number, place in places]):
        problems.append(f"{len(pairs)} of its solids meet others")
    # Without a bed, only its corner is known.
    bed = complex(*(expected.recipe.files.sheet or (inf, inf)))
    if off := sum(_is_off(meshes[number], place, bed) for number, place in places):
        problems.append(f"{off} of its solids are not on the bed")
    return Content([measured[number] for number, _ in places], stamp, tuple(problems))


def _is_off(mesh: Mesh, place: tuple[complex, complex], bed: complex) -> bool:
    """Whether a solid is not within the corners of the bed, 0 and `bed`, mm."""
    turn, shift = place
    low, high = box_of((mesh.corners[:, 0] + 1j * mesh.corners[:, 1]) * turn + shift)
    return max(-low.real, -low.imag, high.real - bed.real, high.imag - bed.imag) > mesh.rounding


# Readers by format; files of other formats must be those made again.
READERS: Mapping[str, Callable[[Path, Expected], Content]] = {"dxf": _dxf, "svg": _svg, "stl": _stl, "3mf": _threemf}
# Formats with the results of the certificate.
REPORTS: tuple[Format, ...] = ("report", "report-md")
# A row of the results in a report.
VERDICT = re.compile(rb"^\|.*\| (?:NOT )?as designed \|\r?\n", re.MULTILINE)
# Formats that a beam cuts.
CUT = ("dxf", "svg")
# Largest size of a file in sizes of the one made again, and the bytes that are added to it: more would take minutes.
MOST_BYTES = (4, 500_000)


def _report(path: Path, expected: Expected) -> FileReport:
    name = path.name
    kind = NAME if name == NAME else "recipe" if name.endswith(FOUND) else format_in(expected.recipe.name, name)
    file = partial(FileReport, name, "summary" if kind == NAME else kind)
    wanted = expected.contents.get(name)
    try:
        if path.is_symlink() or not path.is_file():
            what = "a link" if path.is_symlink() else "a folder" if path.is_dir() else ""
            return file(problems=(f"it is {what}, not a file" if what else "it is missing",))
        if wanted is None:
            return file(problems=("the recipe does not make it",))
        most = min(LARGEST, MOST_BYTES[0] * len(wanted) + MOST_BYTES[1])
        if path.stat().st_size > most:
            return file(problems=(f"it has more than {most:,} bytes, and the one made again has {len(wanted):,}",))
        with path.open("rb") as opened:
            content = opened.read(most)
        left = expected.left if kind in CUT else ()
        apart = difference(content, wanted, kind)
        if apart is None or not apart.problems:
            return file(proof="made again", note=harmless(apart.note) if apart else "", problems=left)
        if kind not in READERS:
            return file(note=harmless(apart.note), problems=tuple(map(harmless, apart.problems)))
        return _measured_report(path, expected, file, apart, difference(content, wanted, kind, measured=True))
    except (UnreadableError, OSError, GeomkinError) as error:
        return file(problems=(Sentence(str(error), harmless),))


def _measured_report(
    path: Path, expected: Expected, file: Callable[..., FileReport], apart: Difference, rest: Difference | None
) -> FileReport:
    """The report on a file that is not the one made again; rest: its differences apart from the geometry."""
    kind = format_of(path.name)
    content = READERS[kind](path, expected)
    stamps = _stamp_problems(content.stamp, expected)
    outside = [f"not measured: {problem}" if stamps else problem for problem in (rest.problems if rest else ())]
    problems = [*content.problems, *stamps, *outside]
    for part in content.measured:
        named = printable(part.part, 60) or "the drawing"
        problems += [f"{named}: {marked(problem)}" for problem in part.problems]
        if part.deviation > expected.tolerance * (1 + MEASURED):
            problems.append(
                f"{named}: {mm(part.deviation):.4g} off its curve at "
                f"({bare_mm(part.place.real, part.place.imag):.3f}), "
                f"and {mm(expected.tolerance):g} are allowed"
            )
    if kind in CUT:
        problems += expected.left
    worst = worst_of(content.measured)
    return file(
        proof="" if problems else "measured",
        note=harmless(apart.note),
        deviation=worst.deviation,
        allowed=expected.tolerance,
        place=worst.place,
        part=worst.part,
        parts=len(content.measured),
        holes=sum(part.holes for part in content.measured),
        problems=tuple(Sentence(problem, harmless) for problem in problems),
        worst=worst if worst.plate else None,
    )


def _stamp_problems(text: str, expected: Expected) -> list[str]:
    stamp = Stamp.read(text)
    if stamp is None:
        return ["it has no stamp: another program wrote it"]
    if stamp.layout != LAYOUT:
        return [f"its stamp has layout {stamp.layout}, but this version reads layout {LAYOUT}"]
    if not expected.hashed.startswith(stamp.recipe) or stamp.tolerance != expected.tolerance:
        return ["its stamp is that of another recipe or tolerance"]
    return []
