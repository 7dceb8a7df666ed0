"""The drawing with sizes: its numbers against distances in the DXF that is cut; no text on another or on a line."""

import re
import xml.etree.ElementTree as ET
from collections import Counter
from dataclasses import replace
from pathlib import Path

import ezdxf
import numpy as np
import pytest
import shapely
from ezdxf.lldxf.encoding import decode_dxf_unicode

import geomkin as gk
from geomkin.export.cut import cut
from geomkin.export.dimensioned import dimensioned_drawing, drawing_scale, scale_text
from geomkin.export.job import Job, StaticSource
from geomkin.plane.primitives import Circle
from tests.campaign import by_default

RECIPES = Path(__file__).parent.parent.parent / "recipes"


def job_of(name):
    recipe = gk.load(RECIPES / f"{name}.toml")
    return Job(name, recipe, recipe.files.tolerance)


def read(path):
    return ezdxf.readfile(path).modelspace()


LEGIBLE = ["whitworth", "lantern", "herringbone-pair"]


@pytest.mark.parametrize("name", by_default(sorted(path.stem for path in RECIPES.glob("*.toml")), LEGIBLE))
def test_no_text_lies_on_another_or_on_a_line(name):
    made = dimensioned_drawing(job_of(name))
    is_legible(made)
    # A4 to A0 by the standard: each has twice the area of the one before.
    assert (made.width, made.height) in [(297, 210), (420, 297), (594, 420), (841, 594), (1189, 841)]


@pytest.mark.parametrize("count, paper", [(4, 297), (5, 420), (11, 420), (12, 594)])
def test_discs_are_on_the_smallest_paper_that_has_room_for_them(count, paper):
    """Each takes 66 mm by 66.5 mm with its sentences: three or four in a row of the two papers, less beside the title."""
    parts = tuple(gk.Part(f"disc_{k}", Circle(0j, 25.0), (), 3.0) for k in range(count))
    made = dimensioned_drawing(Job("discs", StaticSource(parts), 1e-3))
    is_legible(made)
    assert made.width == paper and sum(layer == "PART" for layer, _ in made.shapes) == count


def is_legible(made):
    texts = [*made.texts, *(dimension.text for dimension in made.dimensions)]
    boxes = [shapely.box(low.real, low.imag, high.real, high.imag) for low, high in (t.box for t in texts)]
    lines = []
    for shape in (*(shape for _, shape in made.shapes), *(line for d in made.dimensions for line in d.lines)):
        ring = gk.flatten(shape, 0.01)
        lines.append(
            (shapely.LinearRing if isinstance(shape, Circle) or shape.closed else shapely.LineString)(gk.plane.xy(ring))
        )
    assert len(boxes) > 5
    # Engraved letters: open lines of a few mm. Only their own strokes and the edges of the part may meet their boxes.
    strokes = [
        gk.flatten(s, 0.01)
        for layer, s in made.shapes
        if layer == "ENGRAVE" and not (isinstance(s, Circle) or s.closed)
    ]
    letters = [z for z in strokes if max(np.ptp(z.real), np.ptp(z.imag)) < 6 * made.scale]
    letters = [shapely.box(z.real.min(), z.imag.min(), z.real.max(), z.imag.max()) for z in letters]
    kept = [layer not in ("ENGRAVE", "PART") for layer, _ in made.shapes] + [True] * sum(
        len(d.lines) for d in made.dimensions
    )
    others = [*boxes, *(line for line, is_other in zip(lines, kept, strict=True) if is_other)]
    assert not shapely.STRtree(others).query(np.array(letters, dtype=object), predicate="intersects").size
    tree = shapely.STRtree([*boxes, *lines])
    one, two = tree.query(boxes, predicate="intersects")
    assert (one == two).all()
    assert shapely.box(0, 0, made.width, made.height).contains(shapely.union_all([*boxes, *lines]))


def callouts(source, path, number=0):
    """The texts at holes in a drawing, each with the number of holes."""
    gk.write(source, path / "b-sheet.dxf")
    dimensions = [entity for entity in read(path / "b-sheet.dxf").query("DIMENSION") if entity.dimtype == 3]
    texts = [entity.dxf.text for entity in dimensions]
    # The tip circle of a gear is no hole.
    is_gear = [
        len(d.get_geometry_block().query("TEXT")) and abs(d.dxf.defpoint - d.dxf.defpoint4) > 45 for d in dimensions
    ]
    return [text if re.match(r"\d+ x ", text) else f"1 x {text}" for text, gear in zip(texts, is_gear) if not gear]


def sides(entity):
    """Length and width of the least box round a closed outline, as it is cut."""
    points = [(p.x, p.y) for p in ezdxf.path.make_path(entity).flattening(1e-6)]
    x, y = shapely.minimum_rotated_rectangle(shapely.Polygon(points)).exterior.coords.xy
    return sorted(np.hypot(np.diff(x), np.diff(y))[:2])


BORED = 'kind = "spur-gear"\n[gear]\nteeth = 24\nmodule = 2\n[files]\ncurves = "arcs"\nlabels = false\n[stock]\n'


@pytest.mark.parametrize(
    ("stock", "callout", "box"),
    [
        ("bore = 8\nclearance = 0.15", "1 x Ø8.15 (8, clearance +0.15)", (8.15, 8.15)),
        ('bore = 8\nfit = "press"\ninterference = 0.02', "1 x Ø7.98 (8, press -0.02)", (7.98, 7.98)),
        ('bore = 8\nfit = "press"\ninterference = -0.05', "1 x Ø8.05 (8, press +0.05)", (8.05, 8.05)),
        ('bore = 5\nbore_form = "D"', "1 x D Ø5, across flat 4.5", (4.5, 5.0)),
        ('bore = 10\nbore_form = "square"\nflat = 8', "1 x square over corners Ø10, between flats 8", (8.0, 8.0)),
        (
            'bore = 5\nbore_form = "D"\nflat = 4.2\nfit = "press"',
            "1 x D Ø4.9, across flat 4.1 (5, press -0.1)",
            (4.1, 4.9),
        ),
        (
            'bore = 10\nbore_form = "keyed"\nclearance = 0.05',
            "1 x Ø10.05, keyway 3 wide 1.4 deep (10, clearance +0.05)",
            (10.05, 11.45),
        ),
    ],
)
def test_callout_of_a_bore_has_its_cut_size_and_its_shaft(stock, callout, box, tmp_path):
    recipe = gk.load(BORED + stock)
    assert callouts(recipe, tmp_path) == [callout]
    gk.write(recipe, tmp_path / "a.dxf")
    (hole,) = [entity for entity in read(tmp_path / "a.dxf") if entity.dxf.layer == "HOLE"]
    path = hole.flattening(1e-6) if hole.dxftype() == "CIRCLE" else ezdxf.path.make_path(hole).flattening(1e-6)
    assert sorted(np.ptp([(p.x, p.y) for p in path], axis=0)) == pytest.approx(box, abs=1e-3)
    if "keyway" in callout:
        # The slot's bottom is the one edge between two right angles.
        straight = [
            abs(complex(*b[:2]) - complex(*a[:2]))
            for a, b in zip(hole.get_points(), [*hole.get_points()[1:], hole.get_points()[0]])
            if a[4] == 0
        ]
        assert max(straight) == pytest.approx(3.0, abs=1e-3)


@pytest.mark.parametrize("name", by_default(["lift-table", "rocker-cam", "planetary", "motor-gear"], ["rocker-cam"]))
def test_all_holes_of_a_recipe_are_as_wide_and_as_long_as_their_callouts(name, tmp_path):
    """Each fit makes its number, and the file that is cut has just these holes."""
    recipe = gk.load(RECIPES / f"{name}.toml")
    recipe = replace(recipe, files=replace(recipe.files, curves="arcs", labels=False, kerf=0.0))
    wanted = Counter()
    for part in recipe.parts:
        lines = callouts(part, tmp_path)
        if isinstance(part.outline, Circle):
            outer = f"1 x Ø{2 * part.outline.radius:.5g}"
            lines = [line for line in lines if line != outer]
        for line in lines:
            count, *sizes = re.match(
                r"(\d+) x (?:D )?(?:Ø|slot )([\d.]+)(?:(?: wide)?, (?:across flat |\()?([\d.]+))?", line
            ).groups()
            fit = re.search(r"\(([\d.]+), (?:press|clearance) ([-+][\d.]+)\)", line)
            assert not fit or float(fit[1]) + float(fit[2]) == pytest.approx(float(sizes[0]), abs=1e-4)
            wanted[tuple(f"{side:.2f}" for side in sorted(float(size or sizes[0]) for size in sizes))] += (
                int(count) * part.count
            )
    gk.write(recipe, tmp_path / "a.dxf")
    cut = Counter()
    for entity in read(tmp_path / "a.dxf"):
        if entity.dxf.layer == "HOLE":
            is_round = entity.dxftype() == "CIRCLE"
            cut[tuple(f"{side:.2f}" for side in (2 * [2 * entity.dxf.radius] if is_round else sides(entity)))] += 1
    # What teeth and webs leave open is no hole that a callout states.
    assert wanted and not wanted - cut and sum((cut - wanted).values()) <= 1


@pytest.mark.parametrize("material", ["日本の鋼 S45C", "Łódź"])
def test_a_material_in_any_script_comes_back_from_both_formats(material, tmp_path):
    title = {"material": material}
    recipe = gk.load({"kind": "spur-gear", "gear": {"teeth": 24, "module": 2}, "files": {"title": title}})
    drawn, svg = (tmp_path / f"a-sheet.{ending}" for ending in ("dxf", "svg"))
    for path in (drawn, svg):
        gk.write(recipe, path)
    in_dxf = [decode_dxf_unicode(t.dxf.text) for t in read(drawn).query("TEXT")]
    in_svg = [e.text for e in ET.fromstring(svg.read_bytes()).iter("{http://www.w3.org/2000/svg}text")]
    assert f"material: {material}" in in_dxf and f"material: {material}" in in_svg


@pytest.mark.parametrize(("size", "scale"), [(3, "20:1"), (250, "1:1"), (251, "1:2")])
def test_the_scale_is_round_and_the_drawing_has_it(size, scale):
    from geomkin.export.job import StaticSource

    disc = gk.Part("disc", gk.plane.Circle(5 + 3j, size / 2), (), 3.0)
    made = dimensioned_drawing(Job("disc", StaticSource((disc,)), 0.001 * size))
    assert any(text.text == f"scale {scale}, sizes in mm" for text in made.texts)
    paper, part = map(float, scale.split(":"))
    (drawn,) = [shape for layer, shape in made.shapes if layer == "PART"]
    assert drawn.radius == pytest.approx(size / 2 * paper / part) and scale_text(paper / part) == scale
    # The longer side of the largest part decides, whichever that is.
    for long in (size + 1j, 1 + 1j * size):
        corners = np.array([0, long.real, long, 1j * long.imag])
        cuts = [
            cut(gk.Part(name, gk.plane.Polyline(z), (), 3.0), 1e-3) for name, z in (("a", corners), ("b", corners / 9))
        ]
        assert drawing_scale(cuts) == drawing_scale(cuts[::-1]) == pytest.approx(paper / part)


@pytest.mark.parametrize("size", [0.2, 1.0, 7.0])
def test_every_size_stands_at_a_line_as_long_as_it_says(size):
    """Lengths at the drawing's scale: larger than the part, as large, and smaller."""
    outline = gk.plane.Polyline(size * np.array([-20 - 15j, 90 - 15j, 90 + 45j, -20 + 45j]))
    holes = tuple(Circle(size * z, 3.0 * size) for z in (10 + 0j, 70 + 0j, 70 + 30j))
    made = dimensioned_drawing(Job("plate", StaticSource((gk.Part("plate", outline, holes, 3.0),)), 1e-3))
    assert {0.2: made.scale > 1, 1.0: made.scale == 1, 7.0: made.scale < 1}[size]
    dimensions = {kind: [d for d in made.dimensions if d.kind == kind] for kind in ("x", "y", "diameter")}
    # From the hole nearest to the origin of the part: the corners of the plate and the other holes.
    along, up = ([float(d.text.text) for d in dimensions[axis]] for axis in "xy")
    assert along == pytest.approx(size * np.array([-30, 0, 60, 80])) and up == pytest.approx(
        size * np.array([-15, 0, 30, 45])
    )
    for axis, part in (("x", np.real), ("y", np.imag)):
        for dimension in dimensions[axis]:
            datum, feature, _ = dimension.points
            assert part(feature - datum) == pytest.approx(made.scale * float(dimension.text.text), abs=1e-3)
    (hole,) = dimensions["diameter"]
    assert hole.text.text == f"3 x Ø{6 * size:.5g}"
    circles = [shape for layer, shape in made.shapes if layer == "PART" and isinstance(shape, Circle)]
    assert any(abs(hole.points[0] + hole.points[1] - 2 * circle.centre) < 1e-6 for circle in circles)
    assert abs(hole.points[1] - hole.points[0]) == pytest.approx(6 * size * made.scale)
