"""Files read back: by the libraries that wrote them, by plain parsing, and against the exact curves."""

import csv as plain_csv
import io
import re
import struct
import xml.etree.ElementTree as ET

import ezdxf
import numpy as np
import pytest
import shapely

import geomkin as gk
from geomkin.export.cut import cut
from geomkin.export.dxf import dxf
from geomkin.export.layout import lay_out
from geomkin.export.solids import stl
from geomkin.export.svg import svg
from geomkin.export.tables import csv
from geomkin.model.table import xy_columns

TOLERANCE = 0.005
PLATE = gk.Part(
    "plate",
    gk.plane.rounded_hull([0, 90, 40 + 25j], 8),
    (gk.plane.Circle(0, 2.1), gk.plane.Circle(90, 2.1)),
    3.0,
    count=3,
)
GEAR = gk.Part("gear", gk.SpurGear(17, 2).outline, (gk.plane.Circle(0, 4),), 6.0)
CLOCKWISE = gk.Part(
    "clockwise",
    gk.plane.Reversed(gk.plane.slot(-10, 30j, 6)),
    (gk.plane.Reversed(gk.plane.slot(-10, -6 + 12j, 2)),),
    2.0,
)
PARTS = [PLATE, GEAR, CLOCKWISE]


def exact_area(part):
    return gk.area(part.outline) - sum(gk.area(h) for h in part.holes)


def sheet_of(parts, **how):
    return lay_out([cut(p, TOLERANCE, **how) for p in parts])


def read_dxf(content):
    return ezdxf.read(io.StringIO(content.decode()))


def polygons(document):
    """(layer, polygon) for each closed entity, arcs flattened finely."""
    for entity in document.modelspace():
        path = ezdxf.path.make_path(entity)
        yield entity.dxf.layer, shapely.Polygon([(v.x, v.y) for v in path.flattening(1e-4)])


@pytest.mark.parametrize("arcs", [False, True])
def test_dxf_says_millimetres_has_clean_layers_and_the_right_area(arcs):
    document = read_dxf(dxf(sheet_of(PARTS, arcs=arcs)))
    audit = document.audit()
    assert not audit.errors and not audit.fixes
    assert document.dxfversion >= "AC1015"
    assert document.header["$INSUNITS"] == 4 and document.header["$MEASUREMENT"] == 1
    assert {"CUT", "HOLE", "ENGRAVE", "REFERENCE"} <= {layer.dxf.name for layer in document.layers}
    kinds = {e.dxftype() for e in document.modelspace()}
    assert kinds == {"LWPOLYLINE", "CIRCLE"}
    assert all(e.closed for e in document.modelspace().query("LWPOLYLINE"))
    net = sum(p.area if layer == "CUT" else -p.area for layer, p in polygons(document))
    wanted = sum(exact_area(p) * p.count for p in PARTS)
    outlines = sum(gk.length(p.outline) * p.count for p in PARTS)
    assert abs(net - wanted) < TOLERANCE * outlines
    has_bulges = any(v[2] for e in document.modelspace().query("LWPOLYLINE") for v in e.get_points("xyb"))
    assert has_bulges == arcs


@pytest.mark.parametrize("arcs", [False, True])
@pytest.mark.parametrize("count", [1, 4])
def test_dxf_extents_are_those_of_the_parts(arcs, count):
    """Against every arc and line of it, in fine steps, as the library reads them."""
    hook = gk.Part(
        "hook", gk.plane.Polyline(np.array([0, 10 - 5j, 20 + 5j, 3j]), np.array([0.9, -0.3, 1.0, 0.2])), (), 1
    )
    document = read_dxf(dxf(sheet_of([hook, *PARTS][:count], arcs=arcs)))
    space = document.modelspace()
    edges = [edge for e in space.query("LWPOLYLINE") for edge in e.virtual_entities()]
    places = [edge.flattening(1e-5) if edge.dxftype() == "ARC" else (edge.dxf.start, edge.dxf.end) for edge in edges]
    x, y, _ = np.array([p.xyz for row in places for p in row]).T
    assert np.array(document.header["$EXTMIN"])[:2] == pytest.approx([x.min(), y.min()], abs=3e-5)
    assert np.array(document.header["$EXTMAX"])[:2] == pytest.approx([x.max(), y.max()], abs=3e-5)


@pytest.mark.parametrize("arcs", [False, True])
def test_coordinates_carry_no_more_decimals_than_the_tolerance_asks(arcs):
    """Short decimals plus whole millimetres are not: 1.2345678 + 37 ends in ...0000000000003."""
    text = dxf(sheet_of(PARTS, arcs=arcs)).decode().split("ENTITIES")[1].split("ENDSEC")[0].split("\n")
    coordinates = [value.strip() for code, value in zip(text[1::2], text[2::2]) if code.strip() in ("10", "20", "40")]
    assert len(coordinates) > 100
    assert max(len(value.partition(".")[2]) for value in coordinates) <= 7


def test_holes_and_marks_come_before_the_outline_that_frees_the_part():
    marked = gk.Part(
        "marked",
        gk.plane.Circle(0, 30),
        (gk.plane.Circle(0, 4), gk.plane.Circle(15, 3)),
        2,
        marks=(gk.plane.Circle(-15, 2),),
    )
    sheet = sheet_of([marked, PLATE])
    wanted = ["HOLE", "HOLE", "ENGRAVE", "CUT", *["HOLE", "HOLE", "CUT"] * PLATE.count]
    assert [e.dxf.layer for e in read_dxf(dxf(sheet)).modelspace()] == wanted
    drawn = ET.fromstring(svg(sheet, "order")).iter()
    assert [e.get("class") for e in drawn if e.get("class")] == wanted


def test_the_next_cut_is_the_nearest():
    """Of the sheet's parts from the origin, and of a part's holes: no other that is left lies nearer."""
    row = gk.Part(
        "row", gk.plane.slot(-40, 40, 9), tuple(gk.plane.Circle(x, 2) for x in (30, -30, 10, -10)), 2, count=7
    )
    sheet = sheet_of([row, *PARTS])
    here, left = 0j, [complex(p.loops[-1].points[0]) for p in sheet.placed]
    while left:
        assert abs(left[0] - here) <= min(abs(z - here) for z in left) + 1e-3
        here = left.pop(0)
    (first, *_) = (p for p in sheet.placed if p.cut.part is row)
    assert [round((hole.points[0] - first.shift).real) for hole in first.loops[:4]] == [-28, -8, 12, 32]


@pytest.mark.parametrize(("kerf", "arcs"), [(0.2, True), (1.0, False)])
@pytest.mark.parametrize("part", PARTS, ids=lambda p: p.name)
def test_kerf_moves_outlines_out_and_holes_in(part, kerf, arcs):
    made = cut(part, TOLERANCE, kerf=kerf, arcs=arcs)
    fine = [cut(part, 1e-4).loops[k] for k in range(len(made.loops))]
    for k, (loop, exact) in enumerate(zip(made.loops, fine)):
        grown = shapely.Polygon(gk.plane.xy(exact.points)).buffer(kerf / 2 * (-1 if k else 1), quad_segs=200)
        got = shapely.Polygon(gk.plane.xy(loop.points))
        assert got.symmetric_difference(grown).area < 1.5 * TOLERANCE * grown.length
        shape = gk.flatten(loop.shape, 1e-4)
        assert shapely.Polygon(gk.plane.xy(shape)).symmetric_difference(grown).area < 1.5 * TOLERANCE * grown.length


@pytest.mark.parametrize("part", PARTS, ids=lambda p: p.name)
def test_stl_is_closed_upright_and_of_the_right_volume(part):
    """Read by hand: every edge once in each direction, outward normals, volume by the divergence theorem."""
    content = stl(cut(part, TOLERANCE))
    count = struct.unpack("<I", content[80:84])[0]
    assert len(content) == 84 + 50 * count
    rows = np.frombuffer(content[84:], dtype=[("n", "<f4", 3), ("v", "<f4", (3, 3)), ("a", "<u2")])
    corners = rows["v"].astype(float)
    keys = [tuple(map(bytes, triangle)) for triangle in rows["v"]]
    edges = {(t[i], t[(i + 1) % 3]) for t in keys for i in range(3)}
    assert len(edges) == 3 * count and all((b, a) in edges for a, b in edges)
    volume = np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
    assert volume == pytest.approx(exact_area(part) * part.thickness, rel=1e-3)
    assert corners[..., 2].min() == 0 and corners[..., 2].max() == pytest.approx(part.thickness)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert np.einsum("ij,ij->i", normal, rows["n"].astype(float)).min() > 0


@pytest.mark.parametrize("arcs", [False, True])
def test_svg_is_in_millimetres_and_equals_the_dxf(arcs):
    sheet = sheet_of(PARTS, arcs=arcs)
    root = ET.fromstring(svg(sheet, "a <b> & c"))
    assert root.get("width") == f"{sheet.width:g}mm" and root.get("viewBox") == f"0 0 {sheet.width:g} {sheet.height:g}"
    space = "{http://www.w3.org/2000/svg}"
    assert root.find(f"{space}title").text == "a <b> & c"
    shapes = [e for e in root.iter() if e.tag not in {space + name for name in ("svg", "title", "g")}]
    drawn = [e for e in shapes if e.get("class") in ("CUT", "HOLE")]
    # No background either: a cutter would cut it.
    assert shapes == drawn
    # Holes before the outline that holds them.
    cuts = [(loop, p) for p in sheet.placed for loop in (*p.cut.loops[1:], p.cut.loops[0])]
    assert len(drawn) == len(cuts)
    for element, (loop, placed) in zip(drawn, cuts):
        if element.tag == f"{space}circle":
            assert float(element.get("r")) == loop.shape.radius
            continue
        first = complex(*map(float, re.match(r"M([-\d.]+),([-\d.]+)", element.get("d")).groups()))
        start = loop.shape.vertices[0] * placed.turn + placed.shift
        assert first == pytest.approx(start.conjugate() + 1j * sheet.height)
        assert ("A" in element.get("d")) == arcs


def test_csv_reads_back_to_ten_digits_and_hides_no_formula():
    values = np.array([0.0, -0.0, np.pi * 1e6, np.nan, 1e-20])
    table = gk.Table(
        (
            gk.Column("angle", "deg", "", np.arange(5.0)),
            *xy_columns("p", "mm/s", "", values * (1 + 1j)),
            gk.Column("note", "", "", np.array(["=1+1", "@x", "-y", "plain", 'a,"b"'])),
        )
    )
    rows = list(plain_csv.reader(io.StringIO(csv(table).decode())))
    assert rows[0] == ["angle_deg", "p_x_mm_per_s", "p_y_mm_per_s", "note"]
    assert rows[4][1] == "" and "nan" not in csv(table).decode() and "-0.0" not in csv(table).decode()
    assert float(rows[3][1]) == pytest.approx(np.pi * 1e6, rel=5e-10)
    assert [r[3] for r in rows[1:]] == ["'=1+1", "'@x", "'-y", "plain", 'a,"b"']


def test_size_of_file_grows_linearly_with_points():
    """Twice the points, about twice the bytes; the quadratic way would not finish in the time of the suite."""
    sizes = []
    for n in (8_000, 16_000):
        t = np.linspace(0, 2 * np.pi, n, endpoint=False)
        wavy = gk.plane.Polyline((50 + np.cos(40 * t)) * np.exp(1j * t))
        sizes.append(len(dxf(sheet_of([gk.Part("wavy", wavy, (), 1)]))))
    assert sizes[1] / sizes[0] == pytest.approx(2, rel=0.05)
