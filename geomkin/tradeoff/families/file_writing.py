"""Files: tables with more or fewer digits, drawings of chords or arcs, solids at a tolerance; each read back."""

from __future__ import annotations

import io
from collections.abc import Callable
from itertools import pairwise

import numpy as np

from ...core.records import record
from ...gear.spur import SpurGear
from ...model.part import Part
from ...model.table import Column, Table
from ...plane.primitives import Circle, Polyline
from ...plane.vec import Complex, Real, Whole, cross, xy
from ..family import Method, MethodFamily, Tool
from . import gear_root as gear_root
from .curve_flattening import at_even_parameters

TOLERANCES = (0.1, 0.01, 1e-3)
# Rows of the table.
ROWS = 2000
BORE, THICKNESS = 2.5, 5.0
# Points of each smooth piece of the polygon that the plate's true area is taken from: 1e-8 of it.
FINE = 2048


# Tables


def table() -> Table:
    """Angles, places of mm and rates of many sizes."""
    t = np.linspace(0, 2 * np.pi, ROWS)
    values = {
        "angle": t,
        "x": 50 * np.cos(t) + 3,
        "y": 50 * np.sin(t),
        "rate": 1e3 * np.cos(3 * t),
        "ratio": 1e-4 * np.sin(t),
    }
    return Table(tuple(Column(name, "mm", name, column) for name, column in values.items()))


def _library_csv(given: Table, _: float) -> Callable[[], bytes]:
    from ...export.csv import csv

    return lambda: csv(given)


def _numpy_csv(given: Table, digits: float) -> Callable[[], bytes]:
    columns = np.stack([c.values for c in given.columns], axis=1)
    header = ",".join(c.header for c in given.columns)

    def text() -> bytes:
        stream = io.StringIO()
        np.savetxt(stream, columns, f"%.{int(digits)}g", ",", header=header, comments="")
        return stream.getvalue().encode()

    return text


def _shortest_csv(given: Table, _: float) -> Callable[[], bytes]:
    """All digits that distinguish a number from its neighbours, as Python's `repr` writes them."""
    header = ",".join(c.header for c in given.columns)

    def text() -> bytes:
        rows = zip(*[map(repr, c.values.tolist()) for c in given.columns])
        return "\n".join([header, *map(",".join, rows), ""]).encode()

    return text


def csv_error(given: Table, found: bytes) -> Real:
    """Of every cell read back, as a share of the largest of its column."""
    read = np.array([line.split(",") for line in found.decode().splitlines()[1:]], dtype=float)
    wanted = np.stack([c.values for c in given.columns], axis=1)
    return np.asarray(np.abs(read - wanted) / np.abs(wanted).max(axis=0)).ravel()


CSV_WRITING: MethodFamily[Table, bytes] = MethodFamily(
    name="csv-writing",
    title="CSV writing",
    about=f"A table of {ROWS} rows and five columns of numbers.",
    per="row",
    unit="of a column's largest value",
    reference="the numbers themselves, held against the file read back",
    floor=1e-17,
    problem=table,
    count=lambda given, _: ROWS,
    error=csv_error,
    methods=(
        Method(
            "ten digits",
            "Digits counted from each column's largest value (`write`).",
            _library_csv,
            rationale="Further digits differ by processor; without them a recipe gives the same bytes everywhere.",
            caveat="Rounding to ten digits takes time that writing all digits does not need.",
        ),
        Method(
            "fixed digits",
            "So many digits of each number (`numpy.savetxt`).",
            _numpy_csv,
            "digits",
            (4.0, 6.0, 10.0, 17.0),
        ),
        Method("all digits", "The shortest text that distinguishes a number from its neighbours.", _shortest_csv),
    ),
    weighed="bytes",
    weigh=lambda _, found: len(found) / ROWS,
)


# Plates


@record(eq=False)
class GearPlate:
    """A gear of 12 teeth with a bore, the rack's tooth that cuts its spaces, and its area, mm2."""

    gear: SpurGear
    tool: Tool
    area: float

    def part(self) -> Part:
        """Made anew: what is worked out for a curve may be kept."""
        outline = SpurGear(self.gear.teeth, self.gear.module).outline
        return Part("gear", outline, (Circle(0j, BORE),), THICKNESS)


def plate() -> GearPlate:
    """Its area is that of a far finer polygon, less the bore."""
    cut = gear_root.problem()
    z = at_even_parameters(cut.gear().outline, FINE)
    return GearPlate(cut.gear(), cut.tool, float(cross(z, np.roll(z, -1)).sum() / 2 - np.pi * BORE**2))


def _library_dxf(arcs: bool) -> Callable[[GearPlate, float], Callable[[], bytes]]:
    def make(given: GearPlate, tolerance: float) -> Callable[[], bytes]:
        from ...export.cut import cut
        from ...export.dxf import dxf
        from ...export.layout import lay_out

        return lambda: dxf(lay_out([cut(given.part(), tolerance, arcs=arcs)]))

    return make


def _bare_dxf(given: GearPlate, tolerance: float) -> Callable[[], bytes]:
    """The least that a reader takes: no header, so no units; no layers, no check."""
    from ...plane.flatten import flatten

    def text() -> bytes:
        z = flatten(given.part().outline, tolerance)
        points = "".join(f"10\n{x:.6f}\n20\n{y:.6f}\n" for x, y in xy(z).tolist())
        bore = f"0\nCIRCLE\n8\nCUT\n10\n0\n20\n0\n40\n{BORE}\n"
        line = f"0\nLWPOLYLINE\n8\nCUT\n90\n{len(z)}\n70\n1\n{points}"
        return f"0\nSECTION\n2\nENTITIES\n{bore}{line}0\nENDSEC\n0\nEOF\n".encode()

    return text


def outline_in_file(dxf: bytes) -> Polyline:
    """The polyline of a file with one circle, relative to the circle's centre."""
    lines = dxf.decode().split("\n")
    codes, values = [int(code) for code in lines[:-1:2]], [value.strip() for value in lines[1::2]]
    starts = [k for k, code in enumerate(codes) if code == 0]
    coordinates: dict[str, list[tuple[int, float]]] = {}
    for first, last in pairwise([*starts, len(codes)]):
        if values[first] in ("CIRCLE", "LWPOLYLINE"):
            pairs = zip(codes[first + 1 : last], values[first + 1 : last])
            coordinates[values[first]] = [(code, float(value)) for code, value in pairs if code in (10, 20, 42)]
    centre = complex(*(value for _, value in coordinates["CIRCLE"]))
    x, y = (np.array([value for code, value in coordinates["LWPOLYLINE"] if code == which]) for which in (10, 20))
    bulges, corner = np.zeros(len(x)), -1
    for code, value in coordinates["LWPOLYLINE"]:
        corner += code == 10
        if code == 42:
            bulges[corner] = value
    return Polyline(x + 1j * y - centre, bulges)


def dxf_error(given: GearPlate, found: bytes) -> Real:
    """How far places along the outline are from what the rack and the blank leave, mm."""
    line = outline_in_file(found)
    z = line.point((line.breaks[:-1, None] + np.array([0.0, 0.25, 0.5, 0.75])).ravel())
    # Each place in the one space that the rack's tooth goes through.
    pitch = 2 * np.pi / given.gear.teeth
    turned = np.angle(1j / z)
    z = z * np.exp(1j * pitch * np.floor(turned / pitch))
    off: Real = np.minimum(np.abs(given.tool.clearance(z)), np.abs(np.abs(z) - given.gear.tip_radius))
    return off


DXF_WRITING: MethodFamily[GearPlate, bytes] = MethodFamily(
    name="dxf-writing",
    title="DXF writing",
    about="A gear of 12 teeth of module 2 with a bore, from its sizes to the bytes of its drawing.",
    per="file",
    unit="mm",
    reference="brute force: the file is read back, and four places along every chord or arc are held against the "
    "cutting rack at all positions of its roll, and against the tip circle",
    floor=1e-9,
    problem=plate,
    count=lambda _, found: 1,
    error=dxf_error,
    methods=(
        Method(
            "chords",
            "The outline as chords of equal error, checked for crossings, on named layers with units (`write`).",
            _library_dxf(False),
            "tolerance, mm",
            TOLERANCES,
            rationale="Every cutting program reads chords, and all read them alike.",
            caveat="Most of its time goes into the header, which a bare file leaves out; without it a reader takes "
            "the numbers for inches or metres.",
        ),
        Method(
            "arcs",
            'The outline as tangent arcs, else the same (`curves = "arcs"`).',
            _library_dxf(True),
            "tolerance, mm",
            TOLERANCES,
        ),
        Method(
            "bare",
            "The same chords as bare text: no header, no units, no check.",
            _bare_dxf,
            "tolerance, mm",
            TOLERANCES,
        ),
    ),
    weighed="bytes",
    weigh=lambda _, found: len(found),
)


# Solids


def _library_stl(given: GearPlate, tolerance: float) -> Callable[[], bytes]:
    from ...export.cut import cut
    from ...export.stl import stl

    return lambda: stl(cut(given.part(), tolerance))


def _even_stl(given: GearPlate, count: float) -> Callable[[], bytes]:
    from ...export.cut import cut
    from ...export.stl import stl

    def solid() -> bytes:
        part = given.part()
        even = Polyline(at_even_parameters(part.outline, int(count)))
        # Wide enough that the corners stay as they are.
        return stl(cut(Part("gear", even, part.holes, THICKNESS), 1e-3))

    return solid


def _bare_stl(given: GearPlate, tolerance: float) -> Callable[[], bytes]:
    """Triangles written as they come, with no check that the solid is closed."""
    from ...plane import region as region
    from ...plane.flatten import flatten

    def solid() -> bytes:
        part = given.part()
        loops = [flatten(part.outline, tolerance), flatten(part.holes[0], tolerance)[::-1]]
        return bare_solid(*region.triangulate(loops), loops, THICKNESS)

    return solid


def bare_solid(points: Complex, faces: Whole, loops: list[Complex], height: float) -> bytes:
    """A binary STL: two ends of triangles, and two for each edge between them."""
    flat = np.pad(xy(points), ((0, 0), (0, 1)))
    up = np.array([0.0, 0.0, height])
    walls = []
    for loop in loops:
        a = np.pad(xy(loop), ((0, 0), (0, 1)))
        b = np.roll(a, -1, axis=0)
        walls += [np.stack([a, b, b + up], axis=1), np.stack([a, b + up, a + up], axis=1)]
    triangles = np.concatenate([flat[faces[:, ::-1]], flat[faces] + up, *walls])
    record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])
    written = np.zeros(len(triangles), record)
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    written["normal"] = normal / np.linalg.norm(normal, axis=1, keepdims=True)
    written["corners"] = triangles
    return bytes(80) + np.uint32(len(triangles)).tobytes() + written.tobytes()


def stl_volume(stl: bytes) -> float:
    """Of a binary STL, mm3: the tetrahedra from the origin to its triangles."""
    record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])
    a, b, c = np.frombuffer(stl, record, offset=84)["corners"].astype(float).transpose(1, 0, 2)
    return float((a * np.cross(b, c)).sum() / 6)


STL_WRITING: MethodFamily[GearPlate, bytes] = MethodFamily(
    name="stl-writing",
    title="STL writing",
    about="The same gear, 5 mm thick, from its sizes to the bytes of its solid.",
    per="file",
    unit="of the volume",
    reference=f"a far finer polygon, {FINE} points on every smooth piece, whose area times the thickness is held "
    "against the volume within the triangles that are read back",
    floor=1e-7,
    problem=plate,
    count=lambda _, found: 1,
    error=lambda given, found: np.array([abs(stl_volume(found) / (given.area * THICKNESS) - 1)]),
    methods=(
        Method(
            "chords",
            "Chords of equal error, triangles without added points, a solid that is proved closed (`write`).",
            _library_stl,
            "tolerance, mm",
            TOLERANCES,
            rationale="Its chords keep the tolerance, and every file is watertight.",
            caveat="Half of its time is the check that the solid is closed and has the right volume.",
        ),
        Method(
            "even parameters",
            "The same, but for chords at even steps of each piece's parameter.",
            _even_stl,
            "points a piece",
            (4.0, 16.0, 64.0),
        ),
        Method("bare", "The same triangles written as they come, unchecked.", _bare_stl, "tolerance, mm", TOLERANCES),
    ),
    weighed="bytes",
    weigh=lambda _, found: len(found),
)
