"""The drawing with sizes: its numbers against distances in the DXF that is cut; no text on another or on a line."""

import io
import re
import xml.etree.ElementTree as ET
from collections import Counter
from dataclasses import replace
from itertools import combinations
from pathlib import Path

import ezdxf
import numpy as np
import pytest
import shapely

import geomkin as gk
from geomkin.export.dimensioned import drawing, scale_told
from geomkin.export.job import Job
from geomkin.export.sheet_dxf import sheet as sheet_dxf
from geomkin.plane.primitives import Circle

RECIPES = Path(__file__).parent.parent.parent / "recipes"


def job_of(name):
    recipe = gk.load(RECIPES / f"{name}.toml")
    return Job(name, recipe, recipe.files.tolerance)


def read(path):
    return ezdxf.readfile(path).modelspace()


@pytest.mark.parametrize("name", ["crank-rocker", "gear-pair", "double-rocker"])
def test_numbers_are_the_distances_in_the_file_that_is_cut(name, tmp_path):
    recipe = gk.load(RECIPES / f"{name}.toml")
    recipe = replace(recipe, files=replace(recipe.files, curves="arcs", labels=False))
    if getattr(recipe, "base", None):
        # Of more than three holes only the distance from each to the next is told.
        recipe = replace(recipe, base=None)
    gk.write(recipe, tmp_path / "a.dxf")
    gk.write(recipe, tmp_path / "a-sheet.dxf")
    texts = [t.dxf.text for t in read(tmp_path / "a-sheet.dxf").query("TEXT")]
    numbers = Counter(t for t in texts if re.fullmatch(r"[\d.]+", t))
    numbers += Counter(t.split(": ")[1] for t in texts if re.fullmatch(r".+ to .+: [\d.]+", t))
    wanted, seen, holes = Counter(), set(), []
    for entity in read(tmp_path / "a.dxf"):
        if entity.dxf.layer == "HOLE":
            holes += [entity] if entity.dxftype() == "CIRCLE" else []
            continue
        path = (
            ezdxf.path.make_path(entity).flattening(1e-5) if entity.dxftype() != "CIRCLE" else entity.flattening(1e-6)
        )
        size = np.ptp(np.array([(p.x, p.y) for p in path]), axis=0)
        centres = [complex(h.dxf.center.x, h.dxf.center.y) for h in holes]
        lengths = [abs(a - b) for a, b in combinations(centres, 2)]
        told = tuple(sorted(f"{v:.4g}" for v in (*size, *lengths)))
        if told not in seen:
            wanted += Counter(told)
        seen.add(told)
        assert all(f"dia {2 * h.dxf.radius:.5g}" in " ".join(texts) for h in holes)
        holes = []
    assert Counter(f"{float(n):.4g}" for n in numbers.elements()) == wanted and len(wanted) > 4


@pytest.mark.parametrize(
    "name", ["crank-rocker", "walking-leg", "gear-pair", "whitworth", "lantern", "roller-cam", "herringbone-pair"]
)
def test_no_text_lies_on_another_or_on_a_line(name):
    made = drawing(job_of(name))
    boxes = [shapely.box(low.real, low.imag, high.real, high.imag) for low, high in (t.box for t in made.texts)]
    lines = []
    for _, shape in made.shapes:
        ring = gk.flatten(shape, 0.01)
        lines.append(
            (shapely.LinearRing if isinstance(shape, Circle) or shape.closed else shapely.LineString)(gk.plane.xy(ring))
        )
    assert len(boxes) > 5
    tree = shapely.STRtree([*boxes, *lines])
    one, two = tree.query(boxes, predicate="intersects")
    assert (one == two).all()
    assert shapely.box(0, 0, made.width, made.height).contains(shapely.union_all([*boxes, *lines]))


def test_nothing_lies_on_a_layer_that_is_cut():
    document = ezdxf.read(io.StringIO(sheet_dxf(job_of("gear-pair")).decode()))
    assert not document.audit().errors
    assert {e.dxf.layer for e in document.modelspace()} == {"PART", "DIM", "TEXT"}
    assert not {"CUT", "HOLE", "ENGRAVE"} & {layer.dxf.name for layer in document.layers}


def test_a_gears_table_has_what_the_library_measures(tmp_path):
    recipe = gk.load(RECIPES / "spur-gear.toml")
    (path,) = gk.write(recipe, tmp_path / "gear-sheet.svg")
    texts = [e.text for e in ET.fromstring(path.read_bytes()).iter("{http://www.w3.org/2000/svg}text")]
    gear = recipe.design
    over, pins = gk.gear.span(gear), gk.gear.over_pins(gear)
    assert f"teeth {gear.teeth}, module {gear.module:g}, pressure angle 20 deg" in texts
    assert f"tip dia {2 * gear.tip_radius:.5g}" in texts and f"root dia {2 * gear.root_radius:.5g}" in texts
    assert f"span over {over.teeth} teeth {over.length:.5g}" in texts
    assert f"over pins of dia {pins.pin:.5g}: {pins.diameter:.5g}" in texts


def test_teeth_on_helices_are_told_for_each_gear():
    told = [text.text for text in drawing(job_of("herringbone-pair")).texts if "helix" in text.text]
    hands = ["helix angle 30 deg, left hand, herringbone", "helix angle 30 deg, right hand, herringbone"]
    assert sorted(told) == hands
    recipe = replace(gk.load(RECIPES / "spur-gear.toml"), helix_angle_deg=20.0, hand="left")
    texts = [text.text for text in drawing(Job("gear", recipe, 0.01)).texts]
    assert texts.count("helix angle 20 deg, left hand") == 1
    assert not any("helix" in text.text for text in drawing(job_of("gear-pair")).texts)


@pytest.mark.parametrize(
    ("size", "scale"), [(3, "20:1"), (20, "2:1"), (60, "1:1"), (250, "1:1"), (251, "1:2"), (2000, "1:10")]
)
def test_the_scale_is_round_and_the_drawing_has_it(size, scale):
    from geomkin.export.job import Loose

    disc = gk.Part("disc", gk.plane.Circle(5 + 3j, size / 2), (), 3.0)
    made = drawing(Job("disc", Loose((disc,)), 0.001 * size))
    assert any(text.text == f"sheet of 3 mm, scale {scale}" for text in made.texts)
    paper, part = map(float, scale.split(":"))
    (drawn,) = [shape for layer, shape in made.shapes if layer == "PART"]
    assert drawn.radius == pytest.approx(size / 2 * paper / part) and scale_told(paper / part) == scale


def test_it_is_written_where_it_is_asked_for(tmp_path):
    text = 'kind = "spur-gear"\n[gear]\nteeth = 24\nmodule = 2\n[files]\nwrite = ["dxf", "sheet-dxf", "sheet-svg"]\n'
    made = {path.name for path in gk.make(gk.load(text), tmp_path).files}
    assert made == {"spur-gear.dxf", "spur-gear-sheet.dxf", "spur-gear-sheet.svg", "summary.json"}
    assert not any("-sheet" in path.name for path in gk.make(gk.load(text.partition("[files]")[0]), tmp_path).files)
