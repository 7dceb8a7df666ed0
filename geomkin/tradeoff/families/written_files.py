"""Files: tables with more or fewer digits, drawings of chords or arcs, solids at a tolerance; each read back."""

from __future__ import annotations

import io
from typing import Any

import numpy as np

from ...core.records import record
from ...export.cut import cut
from ...export.tables import csv
from ...model.part import Part
from ...model.table import Column, Table
from ...plane.flatten import flatten
from ...plane.primitives import Circle, Polyline
from ...plane.vec import Complex, Real, Whole, cross, xy
from ..family import Method, MethodFamily, method
from ..tool import Tool
from .curves import TOLERANCES, at_even_parameters, gear, rack

# Rows of the table.
ROWS = 2000
BORE, THICKNESS = 2.5, 5.0
# Points of each smooth piece of the polygon that the plate's true area is taken from: 1e-8 of it.
FINE = 2048
# A triangle of a binary STL.
TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])


# Tables


def table() -> Table:
    """Angles, positions of mm and rates of many sizes."""
    t = np.linspace(0, 2 * np.pi, ROWS)
    values = t, 50 * np.cos(t) + 3, 50 * np.sin(t), 1e3 * np.cos(3 * t), 1e-4 * np.sin(t)
    names = "angle", "x", "y", "rate", "ratio"
    return Table(tuple(Column(name, "mm", name, column) for name, column in zip(names, values)))


@method(
    "ten digits",
    rationale="Further digits differ by processor; without them a recipe gives the same bytes everywhere.",
    caveat="Rounding to ten digits takes time that writing all digits does not need.",
)
def _library_csv(given: Table) -> bytes:
    """Digits counted from each column's largest value (`write`)."""
    return csv(given)


@method("fixed digits", "digits", (4.0, 6.0, 10.0, 17.0))
def _numpy_csv(given: Table, digits: float) -> bytes:
    """So many digits of each number (`numpy.savetxt`)."""
    stream, header = io.StringIO(), ",".join(c.header for c in given.columns)
    np.savetxt(stream, _cells(given), f"%.{int(digits)}g", ",", header=header, comments="")
    return stream.getvalue().encode()


@method("all digits")
def _shortest_csv(given: Table) -> bytes:
    """The shortest text that distinguishes a number from its neighbours."""
    rows = zip(*[map(repr, c.values.tolist()) for c in given.columns])
    return "\n".join([",".join(c.header for c in given.columns), *map(",".join, rows), ""]).encode()


def _cells(given: Table) -> Real:
    return np.stack([c.values for c in given.columns], axis=1)


def csv_error(given: Table, found: bytes) -> Real:
    """Of every cell read back, as a share of the largest of its column."""
    read = np.array([line.split(",") for line in found.decode().splitlines()[1:]], dtype=float)
    return np.asarray(np.abs(read - _cells(given)) / np.abs(_cells(given)).max(axis=0)).ravel()


CSV_WRITING = MethodFamily(
    name="csv-writing", title="CSV writing", per="row", unit="of a column's largest value", floor=1e-17,
    problem=table, error=csv_error, count=lambda *_: ROWS, weighed="bytes",
    weigh=lambda _, found: len(found) / ROWS,
    about=f"A table of {ROWS} rows and five columns of numbers.",
    reference="the numbers themselves, compared with the file read back",
    methods=(_library_csv, _numpy_csv, _shortest_csv),
)  # fmt: skip


# Drawings


@record(eq=False)
class GearPlate:
    """A gear of 12 teeth with a bore: the rack's tooth that cuts its spaces, and its area, mm2."""

    tool: Tool
    area: float

    @classmethod
    def example(cls) -> GearPlate:
        """Its area is that of a far finer polygon, less the bore."""
        z = at_even_parameters(gear().outline, FINE)
        return cls(rack(), float(cross(z, np.roll(z, -1)).sum() / 2 - np.pi * BORE**2))


def part() -> Part:
    """The plate, made anew: a curve may keep computed values."""
    return Part("gear", gear().outline, (Circle(0j, BORE),), THICKNESS)


def _dxf(name: str, about: str, arcs: bool, **reasons: Any) -> Method:
    def library(given: GearPlate, tolerance: float) -> bytes:
        from ...export.dxf import dxf
        from ...export.layout import lay_out

        return dxf(lay_out([cut(part(), tolerance, arcs=arcs)]))

    library.__doc__ = about
    return method(name, "tolerance, mm", TOLERANCES[:3], **reasons)(library)


@method("bare", "tolerance, mm", TOLERANCES[:3])
def _bare_dxf(given: GearPlate, tolerance: float) -> bytes:
    """The same chords as bare text, the least that a reader accepts: no header, so no units; no layers, no check."""
    z = flatten(part().outline, tolerance)
    points = "".join(f"10\n{x:.6f}\n20\n{y:.6f}\n" for x, y in xy(z).tolist())
    bore = f"0\nCIRCLE\n8\nCUT\n10\n0\n20\n0\n40\n{BORE}\n"
    line = f"0\nLWPOLYLINE\n8\nCUT\n90\n{len(z)}\n70\n1\n{points}"
    return f"0\nSECTION\n2\nENTITIES\n{bore}{line}0\nENDSEC\n0\nEOF\n".encode()


def outline_in_file(dxf: bytes) -> Polyline:
    """The polyline of a file with one circle, relative to the circle's centre."""
    lines = dxf.decode().split("\n")
    entities: list[tuple[str, list[tuple[int, float]]]] = []
    for code, content in zip(map(int, lines[:-1:2]), lines[1::2]):
        if code == 0:
            entities.append((content.strip(), []))
        elif code in (10, 20, 42):
            entities[-1][1].append((code, float(content)))
    (line,), (circle,) = ([row for kind, row in entities if kind == name] for name in ("LWPOLYLINE", "CIRCLE"))
    centre = complex(*(value for _, value in circle))
    x, y = (np.array([value for code, value in line if code == which]) for which in (10, 20))
    bulges, corner = np.zeros(len(x)), -1
    for code, value in line:
        corner += code == 10
        if code == 42:
            bulges[corner] = value
    return Polyline(x + 1j * y - centre, bulges)


def dxf_error(given: GearPlate, found: bytes) -> Real:
    """Distances of points along the outline from what the rack and the blank leave, mm."""
    line = outline_in_file(found)
    z = line.point((line.breaks[:-1, None] + np.array([0.0, 0.25, 0.5, 0.75])).ravel())
    # Each point in the one space that the rack's tooth goes through.
    pitch = 2 * np.pi / gear().teeth
    z = z * np.exp(1j * pitch * np.floor(np.angle(1j / z) / pitch))
    return np.asarray(np.minimum(np.abs(given.tool.clearance(z)), np.abs(np.abs(z) - gear().tip_radius)))


DXF_WRITING = MethodFamily(
    name="dxf-writing", title="DXF writing", per="file", unit="mm", floor=1e-9, problem=GearPlate.example,
    error=dxf_error, count=lambda *_: 1, weighed="bytes", weigh=lambda _, found: len(found),
    about="A gear of 12 teeth of module 2 with a bore, from its sizes to the bytes of its drawing.",
    reference="brute force: the file is read back, and four points along every chord or arc are compared with the "
    "cutting rack at all positions of its roll, and with the tip circle",
    methods=(
        _dxf(
            "chords",
            "The outline as chords of equal error, checked for crossings, on named layers with units (`write`).",
            False,
            rationale="Every cutting program reads chords, and all read them alike.",
            caveat="Most of its time goes into the header, which a bare file leaves out; without it a reader takes "
            "the numbers for inches or metres.",
        ),
        _dxf("arcs", 'The outline as tangent arcs, otherwise the same (`curves = "arcs"`).', True),
        _bare_dxf,
    ),
)  # fmt: skip


# Solids


@method(
    "chords",
    "tolerance, mm",
    TOLERANCES[:3],
    rationale="Its chords keep the tolerance, and every file is watertight.",
    caveat="Half of its time is the check that the solid is closed and has the right volume.",
)
def _library_stl(given: GearPlate, tolerance: float) -> bytes:
    """Chords of equal error, triangles without added points, a solid that is proved closed (`write`)."""
    from ...export.solids import stl

    return stl(cut(part(), tolerance))


@method("even parameters", "points a piece", (4.0, 16.0, 64.0))
def _even_stl(given: GearPlate, count: float) -> bytes:
    """The same, but for chords at even steps of each piece's parameter."""
    from ...export.solids import stl

    even = Polyline(at_even_parameters(part().outline, int(count)))
    # Wide enough that the corners stay as they are.
    return stl(cut(Part("gear", even, part().holes, THICKNESS), 1e-3))


@method("bare", "tolerance, mm", TOLERANCES[:3])
def _bare_stl(given: GearPlate, tolerance: float) -> bytes:
    """The same triangles written as they come, with no check that the solid is closed."""
    from ...plane import region as region

    loops = [flatten(part().outline, tolerance), flatten(part().holes[0], tolerance)[::-1]]
    return bare_solid(*region.triangulate(loops), loops, THICKNESS)


def bare_solid(points: Complex, faces: Whole, loops: list[Complex], height: float) -> bytes:
    """A binary STL: two ends of triangles, and two for each edge between them."""
    flat = np.pad(xy(points), ((0, 0), (0, 1)))
    up = np.array([0.0, 0.0, height])
    walls = []
    for loop in loops:
        a = np.pad(xy(loop), ((0, 0), (0, 1)))
        b = np.roll(a, -1, axis=0)
        walls += [np.stack([a, b, b + up], axis=1), np.stack([a, b + up, a + up], axis=1)]
    corners = np.concatenate([flat[faces[:, ::-1]], flat[faces] + up, *walls])
    written = np.zeros(len(corners), TRIANGLE)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    written["normal"] = normal / np.linalg.norm(normal, axis=1, keepdims=True)
    written["corners"] = corners
    return bytes(80) + np.uint32(len(corners)).tobytes() + written.tobytes()


def stl_volume(stl: bytes) -> float:
    """Of a binary STL, mm3: the tetrahedra from the origin to its triangles."""
    a, b, c = np.frombuffer(stl, TRIANGLE, offset=84)["corners"].astype(float).transpose(1, 0, 2)
    return float((a * np.cross(b, c)).sum() / 6)


STL_WRITING = MethodFamily(
    name="stl-writing", title="STL writing", per="file", unit="of the volume", floor=1e-7,
    problem=GearPlate.example,
    error=lambda given, found: np.array([abs(stl_volume(found) / (given.area * THICKNESS) - 1)]), weighed="bytes",
    weigh=lambda _, found: len(found),
    about="The same gear, 5 mm thick, from its sizes to the bytes of its solid.",
    reference=f"a far finer polygon, {FINE} points on every smooth piece, whose area times the thickness is compared "
    "with the volume within the triangles that are read back",
    methods=(_library_stl, _even_stl, _bare_stl),
)  # fmt: skip
