"""Every recipe of the gallery: read, written, drawn and made; its files are read back and measured."""

import csv
import json
import re
import tomllib
from functools import lru_cache

import ezdxf
import numpy as np
import pytest
import shapely
import trimesh
from ezdxf import path as dxf_path
from jsonschema import Draft202012Validator

import geomkin as gk
from geomkin.plane.primitives import mirrored
from tests.campaign import by_default
from tests.gallery import FIRST_OF_KIND, NAMES, RECIPES, recipe
from tests.texts import schema_of_all

KEPT = RECIPES.parent / "out"
# Bodies of gears: at the last frame of a scene they are one pitch ahead of the first.
WHEELS = {"first", "second", "pinion", "gear", "mate", "ring", "tool", "sun"}


@pytest.fixture(scope="module")
def schema():
    whole = schema_of_all()
    Draft202012Validator.check_schema(whole)
    return Draft202012Validator(whole)


# One recipe of each kind always, the others in campaigns, and those that take long.
EACH_KIND = set(FIRST_OF_KIND.values()) - {"balanced-rocker", "log-generator", "kidney-path", "square-root-slide"}
# Of their files those of one recipe of some kinds.
MADE = ["flat-cam", "gear-pair", "ring-gear", "polygons", "scotch-yoke"]


@pytest.mark.parametrize("name", by_default(NAMES, EACH_KIND))
def test_a_recipe_is_written_as_it_was_read_and_its_scene_shows_its_parts(name, schema, monkeypatch):
    monkeypatch.chdir(RECIPES)
    own = recipe(name)
    assert not list(schema.iter_errors(tomllib.loads((RECIPES / f"{name}.toml").read_text("utf-8"))))
    assert gk.load(gk.recipe.to_toml(own)) == own
    for motion in (getattr(own, key) for key in ("motion", "figure") if hasattr(own, key)):
        size = max(abs(z) for points in motion.linkage.bodies.values() for z in points.values())
        assert motion.assembled.all() and motion.residual.max() < 1e-12 * size
    scene = own.scene
    frames = len(scene.drive.values)
    assert frames > 50 and np.all(np.diff(scene.time) > 0) and np.all(np.diff(scene.drive.values) > 0)
    for body in scene.bodies:
        assert body.origin.shape == body.direction.shape == (frames,)
        assert np.abs(body.direction[scene.assembled]) == pytest.approx(1, abs=1e-12)
        if scene.cyclic and body.name not in WHEELS and not body.name.startswith("planet"):
            assert abs(body.direction[-1] - body.direction[0]) < 1e-9 and abs(body.origin[-1] - body.origin[0]) < 1e-6
    for mark in scene.marks:
        rows = (mark.place, mark.vector, mark.direction, mark.radius)
        assert all(row is None or row.shape == (frames,) for row in rows)
    # Outlines of parts that are shown from behind are mirrored; a part of several copies is cut more often than shown.
    cuts = {id(cut.outline) for cut in own.parts}
    behind = [str(mirrored(cut.outline)) for cut in own.parts if isinstance(cut.outline, gk.plane.Circle)]
    for shown in (scene, *scene.others.values()):
        names = [body.name for body in shown.bodies]
        assert len(set(names)) == len(names) and all(curve.body in ("", *names) for curve in shown.curves)
        for part in (part for body in shown.bodies for part in body.parts):
            assert {id(part.outline), id(getattr(part.outline, "curve", None))} & cuts or str(part.outline) in behind
    # Spacers lie between the layers, out of sight.
    held = {id(part.outline) for body in scene.bodies for part in body.parts}
    assert all(id(part.outline) in held for part in own.parts if part.body and not part.name.endswith("spacer"))


@pytest.mark.parametrize("name", by_default(NAMES, MADE))
def test_files_of_a_recipe_are_its_parts_and_its_table_and_those_kept(name, tmp_path):
    own = recipe(name)
    result = gk.make(own, tmp_path)
    assert {check.id for check in result.checks if not check.passed} == {c.id for c in own.checks if c.expected}
    assert not set(own.expected_failures) - {check.id for check in own.checks}
    folder = tmp_path / name
    contours_are_apart_and_engravings_lie_on_one_part(own, folder)
    if own.units == "mm":  # tests/recipe/test_inches.py compares files in inches with those in mm
        drawing_and_solids_are_the_parts(own, folder)
        the_csv_file_has_every_number_of_the_table(own, folder)
    the_kept_files_are_those_that_the_recipe_makes(own, folder)


# Distance at which several sheets are read next to each other, mm.
NEXT_SHEET = 10_000


@lru_cache(maxsize=1)
def drawing(path):
    """Polygons of outlines and of holes on all sheets, arcs flattened finely, and lines that are engraved."""
    found = {"CUT": [], "HOLE": [], "ENGRAVE": []}
    for number, sheet in enumerate([path, *sorted(path.parent.glob(f"{path.stem}-[0-9]*.dxf"))]):
        for entity in ezdxf.readfile(sheet).modelspace().query('*[layer=="CUT" | layer=="HOLE" | layer=="ENGRAVE"]'):
            layer = entity.dxf.layer
            # A path of a circle is of Bezier curves, which are a 3700th of the radius off.
            points = (entity if entity.dxftype() == "CIRCLE" else dxf_path.make_path(entity)).flattening(1e-3)
            shape = shapely.LineString if layer == "ENGRAVE" else shapely.Polygon
            found[layer].append(shape([(v.x + NEXT_SHEET * number, v.y) for v in points]))
    return found


def part_of(hole, found):
    """The smallest outline round a hole, which may have a part in it."""
    return min((c for c in found["CUT"] if c.contains_properly(hole)), key=lambda c: c.area, default=None)


def drawing_and_solids_are_the_parts(own, folder):
    parts, found = json.loads((folder / "summary.json").read_text())["parts"], drawing(folder / f"{own.name}.dxf")
    # The drawing's outlines lie half of the kerf outside those of the parts, and holes half of it inside.
    beam = own.files.kerf / 2
    net = []
    for c in found["CUT"]:
        holes = [h for h in found["HOLE"] if part_of(h, found) is c]
        area = c.buffer(-beam).area - sum(h.buffer(beam).area for h in holes)
        # A chord cuts off two thirds of its length times the tolerance.
        net.append((area, 2 / 3 * own.files.tolerance * sum(shape.length for shape in (c, *holes))))
    stated = sorted(p["area_mm2"] for p in parts for _ in range(p["count"]))
    for (area, chords), size in zip(sorted(net), stated, strict=True):
        assert area == pytest.approx(size, rel=1e-3, abs=chords)
    for part, exact in zip(parts, own.parts):
        mesh = trimesh.load(folder / f"{part['name']}.stl")
        assert mesh.is_watertight and mesh.is_winding_consistent
        printed = printed_volume(exact, own.printing) if own.printing else part["volume_mm3"]
        # Chords leave out of a small disc more than a thousandth.
        assert mesh.volume == pytest.approx(printed, rel=1e-3, abs=0.005 * mesh.area)


def printed_volume(part, printing):
    """Of a part less its growth, with a chamfer of the lower edges: its area at three heights of it, by Simpson."""
    rings = [gk.plane.xy(gk.flatten(curve, 1e-3)) for curve in (part.outline, *part.holes)]
    whole = shapely.Polygon(rings[0], rings[1:]).buffer(-printing.growth / 2)
    low, middle, high = (whole.buffer(-foot * printing.foot).area for foot in (1, 0.5, 0))
    return (part.thickness - printing.foot) * high + printing.foot * (low + 4 * middle + high) / 6


def contours_are_apart_and_engravings_lie_on_one_part(own, folder):
    found = drawing(folder / f"{own.name}.dxf")
    every = found["CUT"] + found["HOLE"]
    assert all(p.is_valid for p in every)
    edges = shapely.STRtree([p.exterior for p in every])
    assert all(len(edges.query(p.exterior, predicate="intersects")) == 1 for p in every)
    assert all(part_of(h, found) for h in found["HOLE"])
    # A part within another part lies in a hole of it.
    for cut in found["CUT"]:
        around = [c for c in found["CUT"] if c is not cut and c.contains_properly(cut)]
        holes = [h for h in found["HOLE"] if h.contains_properly(cut)]
        assert {id(part_of(h, found)) for h in holes} == {id(c) for c in around}
    for line in found["ENGRAVE"]:
        assert line.length > 0 and sum(c.contains_properly(line) for c in found["CUT"]) == 1


def the_csv_file_has_every_number_of_the_table(own, folder):
    rows = list(csv.reader((folder / f"{own.name}.csv").read_text(encoding="utf-8").splitlines()))
    assert len(rows) > 9 and all(len(row) == len(rows[0]) for row in rows)
    for k, (header, *cells, column) in enumerate(zip(*rows, own.table.columns, strict=True)):
        assert header == column.header
        if column.values.dtype.kind == "f":
            written = np.array([float(cell or "nan") for cell in cells])
            known = np.where(np.isfinite(column.values), column.values, np.nan)
            assert written == pytest.approx(known, rel=1e-9, abs=1e-9, nan_ok=True), header
            assert k or np.all(np.diff(written) > 0)
    page = folder / f"{own.name}.html"
    if page.exists():
        text = page.read_text("utf-8")
        shown = json.loads(re.search(r'<script type="application/json" id="scene">(.*?)</script>', text, re.DOTALL)[1])
        rows = sum(len(json.dumps(row, separators=(",", ":"))) for row in shown["series"])
        code = sum(
            len(found[0])
            for found in re.finditer(r"<(script|style)(?! type=.application/json).*?</\1>", text, re.DOTALL)
        )
        bodies = sum(len(scene["bodies"]) for scene in shown["scenes"])
        # A number takes at most 5 bytes, every page has the same player, and a body few bytes besides both.
        assert rows <= 5 * len(shown["series"]) * max(100, shown["frames"])
        assert code < 135_000 and len(text) - rows - code < 60_000 + 600 * bodies


def words_and_numbers(held):
    """All texts and all numbers, in order, of a nest of tables or of a drawing."""
    if isinstance(held, str):
        pieces = re.split(r"(-?\d+(?:\.\d+)?(?:e-?\d+)?)", held)
        return pieces[::2], [float(piece) for piece in pieces[1::2]]
    inner = [*held, *held.values()] if isinstance(held, dict) else held
    if not isinstance(held, dict | list):
        return ([held], []) if held is None or isinstance(held, bool) else ([], [held])
    found = [words_and_numbers(one) for one in inner]
    return [word for words, _ in found for word in words], [number for _, numbers in found for number in numbers]


def the_kept_files_are_those_that_the_recipe_makes(own, folder):
    """`out` keeps each recipe's drawing and numbers, so that a change of geometry shows as a change of files."""
    new, old = (json.loads((f / "summary.json").read_text()) for f in (folder, KEPT / own.name))
    for summary in (new, old):
        summary.pop("versions")
    drawings = [(f / f"{own.name}.svg").read_text() for f in (folder, KEPT / own.name)]
    if not (folder / f"{own.name}.found.toml").exists():
        remedy = f"explain it, and keep the files: geomkin run recipes/{own.name}.toml --verify"
        assert not [key for key in sorted({*new, *old}) if new.get(key) != old.get(key)], remedy
        assert drawings[0] == drawings[1], remedy
        return
    # The last digits of a search depend on the processor.
    for one, other in ((new, old), drawings):
        (words, numbers), (other_words, other_numbers) = words_and_numbers(one), words_and_numbers(other)
        assert words == other_words
        assert numbers == pytest.approx(other_numbers, rel=1e-5, abs=2e-4)


def test_a_pole_nearly_at_infinity_costs_the_others_no_digits(tmp_path):
    """At 0 deg by differences: the coupler's point at the instant centre is accelerated towards the inflection pole."""
    gk.make(RECIPES / "inflection-circle.toml", tmp_path, ["csv"])
    first = next(csv.DictReader((tmp_path / "inflection-circle" / "inflection-circle.csv").read_text().splitlines()))
    pole, centre = (
        complex(float(first[f"{name}_x_mm"]), float(first[f"{name}_y_mm"]))
        for name in ("inflection_pole", "instant_centre")
    )
    given, h = recipe("inflection-circle").linkage, 1e-4
    coupler = gk.move(given, np.array([-h, 0, h])).coupler
    places = coupler.origin.position + coupler.direction * (centre - coupler.origin.position[1]) / coupler.direction[1]
    turn = np.angle(coupler.direction[2] / coupler.direction[0]) / (2 * h)
    assert pole == pytest.approx(centre + np.diff(places, 2)[0] / (h * turn) ** 2, rel=1e-6)
    assert abs(pole - centre) == pytest.approx(float(first["inflection_diameter_mm"]), rel=1e-9)
    assert pole == pytest.approx(-133.333 - 41.099j, abs=1e-3)


def test_the_ring_gear_s_table_is_the_side_of_the_tooth_in_its_drawing(tmp_path):
    gk.make(RECIPES / "ring-gear.toml", tmp_path, ["csv", "dxf"])
    rows = list(csv.DictReader((tmp_path / "ring-gear" / "ring-gear.csv").read_text().splitlines()))
    z = np.array([complex(float(r["tooth_x_mm"]), float(r["tooth_y_mm"])) for r in rows])
    found = drawing(tmp_path / "ring-gear" / "ring-gear.dxf")
    plate, hole = found["CUT"][0], found["HOLE"][0]
    middle = complex(plate.centroid.x, plate.centroid.y)
    assert max(hole.exterior.distance(shapely.Point(p.real, p.imag)) for p in z + middle) < 0.006
    regions = list(dict.fromkeys(r["region"] for r in rows))
    assert (regions[0], regions[-1]) == ("tip land", "bottom land") and len(regions) >= 4
    half = np.interp(48.0, np.abs(z), [float(r["half_thickness_angle_deg"]) for r in rows])
    assert 2 * 48 * np.radians(half) == pytest.approx(np.pi - 0.1, abs=0.01)
