"""Every recipe of the gallery is made, and its files are read back and measured."""

import csv
import json
import re
from functools import lru_cache
from pathlib import Path

import ezdxf
import numpy as np
import pytest
import shapely
import trimesh
from ezdxf import path as dxf_path

import geomkin as gk
from geomkin.export.still import kept_frames
from geomkin.model.scene import shown_columns
from tests.export.test_page import unpacked
from tests.watching import ORDERS, Watch

RECIPES = sorted((Path(__file__).parent.parent / "recipes").glob("*.toml"))


# What each recipe worked out while each of its files was made.
LOGS = {}
# Kinds whose parts or checks are made of velocities, and of accelerations: every other drawing is made without.
BY_VELOCITY = {
    "pump-stroke": "swing and stroke end where the slider stands still",
    "wiper": "so does the rocker's swing",
}
BY_ACCELERATION = {
    "centrodes": "a run ends where the instant centre's velocity does",
    "rolling-ellipses": "so it does there",
    "inflection-circle": "the circle is engraved",
    "polygons": "the polygon of accelerations is cut",
    "shaking-force": "the force is checked",
}


@pytest.fixture(scope="module", params=RECIPES, ids=lambda f: f.stem)
def made(request, tmp_path_factory):
    out = tmp_path_factory.mktemp("out")
    with Watch() as watch:
        result = gk.make(request.param, out)
    LOGS[request.param.stem] = watch.log
    return request.param, out / request.param.stem, result


def test_each_file_works_out_what_it_shows_and_no_more(made):
    """Files come in the order of the formats, after the checks: drawings and solids before table and page."""
    name, log = made[0].stem, LOGS[made[0].stem]
    where = {what: {stage for stage in log if log[stage][what]} for what in ("loops", "table", "scene", *ORDERS)}
    assert where["loops"] <= {"dxf", "stl"}
    assert where["table"] <= {"csv", "page"} and where["scene"] == {"page"}
    first, second = (where[order] - {"csv", "page"} for order in ORDERS)
    assert second - {"assembly-svg"} == ({"checks"} if name in BY_ACCELERATION else set())
    # A curve that the linkage draws is flattened by its tangents.
    assert first - {"dxf", "assembly-svg"} == ({"checks"} if name in BY_ACCELERATION or name in BY_VELOCITY else set())


# Tests of one recipe follow each other.
drawing = lru_cache(maxsize=1)(ezdxf.readfile)


@lru_cache(maxsize=1)
def rings(folder, name):
    """Outlines and holes of the DXF as polygons, arcs flattened finely."""
    document = drawing(folder / f"{name}.dxf")
    out = {"CUT": [], "HOLE": []}
    for entity in document.modelspace().query('*[layer=="CUT" | layer=="HOLE"]'):
        # A path of a circle is of Bezier curves, which are a 3700th of the radius off.
        round_one = entity.dxftype() == "CIRCLE"
        points = entity.flattening(1e-3) if round_one else dxf_path.make_path(entity).flattening(1e-3)
        out[entity.dxf.layer].append(shapely.Polygon([(v.x, v.y) for v in points]))
    return out


def part_of(hole, found):
    """The least outline round a hole, which may have a part in it."""
    return min((c for c in found["CUT"] if c.contains_properly(hole)), key=lambda c: c.area, default=None)


def test_checks_of_the_gallery_pass_but_for_those_that_show_a_failing_one_and_say_so(made):
    failed = {check.id for check in made[2].checks if not check.passed}
    assert failed == set(gk.load(made[0]).expected_failures)


def test_every_part_is_in_the_dxf_with_the_area_that_its_solid_stands_on(made):
    file, folder, _ = made
    summary = json.loads((folder / "summary.json").read_text())
    found = rings(folder, file.stem)
    net = sorted(c.area - sum(h.area for h in found["HOLE"] if part_of(h, found) is c) for c in found["CUT"])
    parts = [p for p in summary["parts"] for _ in range(p["count"])]
    assert net == pytest.approx(sorted(p["area_mm2"] for p in parts), rel=1e-3)
    for part in summary["parts"]:
        mesh = trimesh.load(folder / f"{part['name']}.stl")
        assert mesh.is_watertight and mesh.is_winding_consistent
        # Chords leave out of a small disc more than a thousandth.
        assert mesh.volume == pytest.approx(part["volume_mm3"], rel=1e-3, abs=0.005 * mesh.area)
        nearest_area = min(net, key=lambda a: abs(a - part["area_mm2"]))
        assert mesh.volume == pytest.approx(nearest_area * part["thickness_mm"], rel=1e-3, abs=0.005 * mesh.area)


def test_no_two_contours_touch_and_every_hole_has_its_part(made):
    file, folder, _ = made
    found = rings(folder, file.stem)
    every = [p for group in found.values() for p in group]
    assert all(p.is_valid for p in every)
    edges = shapely.STRtree([p.exterior for p in every])
    assert all(len(edges.query(p.exterior, predicate="intersects")) == 1 for p in every)
    assert all(part_of(h, found) for h in found["HOLE"])
    # What lies within another part lies in a hole of it.
    for cut in found["CUT"]:
        around = [c for c in found["CUT"] if c is not cut and c.contains_properly(cut)]
        holes = [h for h in found["HOLE"] if h.contains_properly(cut)]
        assert {id(part_of(h, found)) for h in holes} == {id(c) for c in around}


def test_what_is_engraved_lies_on_one_part(made):
    file, folder, _ = made
    cuts = rings(folder, file.stem)["CUT"]
    for entity in drawing(folder / f"{file.stem}.dxf").modelspace().query('*[layer=="ENGRAVE"]'):
        line = shapely.LineString([(v.x, v.y) for v in dxf_path.make_path(entity).flattening(1e-2)])
        assert line.length > 0 and sum(c.contains_properly(line) for c in cuts) == 1


def test_motion_table_is_whole_and_rises(made):
    file, folder, _ = made
    rows = list(csv.reader((folder / f"{file.stem}.csv").read_text(encoding="utf-8").splitlines()))
    assert len(rows) > 9 and all(len(row) == len(rows[0]) for row in rows)
    first = np.array([float(row[0]) for row in rows[1:]])
    assert np.all(np.diff(first) > 0)


@pytest.mark.campaign
def test_the_same_recipe_gives_the_same_bytes(made, tmp_path):
    file, folder, _ = made
    gk.make(file, tmp_path)
    names = sorted(p.name for p in folder.iterdir())
    assert names == sorted(p.name for p in (tmp_path / file.stem).iterdir())
    for name in names:
        assert (folder / name).read_bytes() == (tmp_path / file.stem / name).read_bytes(), name


def words_and_numbers(held):
    """Of a nest of tables, or of a drawing: all texts, and all numbers, in order."""
    if isinstance(held, str):
        pieces = re.split(r"(-?\d+(?:\.\d+)?(?:e-?\d+)?)", held)
        return pieces[::2], [float(piece) for piece in pieces[1::2]]
    inner = [*held, *held.values()] if isinstance(held, dict) else held
    if not isinstance(held, dict | list):
        return ([held], []) if held is None or isinstance(held, bool) else ([], [held])
    found = [words_and_numbers(one) for one in inner]
    return [word for words, _ in found for word in words], [number for _, numbers in found for number in numbers]


def test_the_kept_drawings_are_what_the_recipes_make(made):
    """`out` keeps each recipe's drawing and numbers, so that a change of geometry shows as a change of files."""
    file, folder, _ = made
    kept = Path(__file__).parent.parent / "out" / file.stem
    new, old = (json.loads((f / "summary.json").read_text()) for f in (folder, kept))
    for summary in (new, old):
        summary.pop("versions")
    drawings = [(f / f"{file.stem}.svg").read_text() for f in (folder, kept)]
    if not (folder / f"{file.stem}.found.toml").exists():
        assert new == old
        assert drawings[0] == drawings[1]
        return
    # The last digits of what a search finds hang on the processor.
    for one, other in ((new, old), drawings):
        (words, numbers), (other_words, other_numbers) = words_and_numbers(one), words_and_numbers(other)
        assert words == other_words
        assert numbers == pytest.approx(other_numbers, rel=1e-5, abs=2e-4)


def test_every_number_of_the_table_is_in_its_files(made):
    """In the CSV to 1e-9 of each, in the page to more digits than it shows, whatever else is in the column."""
    recipe, folder = gk.load(made[0]), made[1]
    rows = list(csv.reader((folder / f"{made[0].stem}.csv").read_text().splitlines()))
    for header, *cells, column in zip(*rows, recipe.table.columns, strict=True):
        assert header == column.header
        if column.values.dtype.kind == "f":
            told = np.array([float(cell or "nan") for cell in cells])
            known = np.where(np.isfinite(column.values), column.values, np.nan)
            assert told == pytest.approx(known, rel=1e-9, abs=1e-9, nan_ok=True), header
    page = folder / f"{made[0].stem}.html"
    if not page.exists():
        return
    assert page.stat().st_size < 250_000
    data = json.loads(re.search(r'id="scene">(.*?)</script>', page.read_text())[1])
    for shown, column in zip(data["columns"], shown_columns(recipe.scene), strict=True):
        told = unpacked(data["series"][shown["row"]], data["frames"])
        values = np.asarray(column.values, dtype=float)[kept_frames(len(column.values))]
        assert told == pytest.approx(values, rel=1e-6, abs=1e-9, nan_ok=True), column.id


def test_a_pole_nearly_at_infinity_costs_the_others_no_digits(tmp_path):
    """At 0 deg by differences: the coupler's point at the instant centre is accelerated towards the inflection pole."""
    file = RECIPES[0].parent / "inflection-circle.toml"
    gk.make(file, tmp_path, ["csv"])
    first = next(csv.DictReader((tmp_path / "inflection-circle" / "inflection-circle.csv").read_text().splitlines()))
    pole, centre = (
        complex(float(first[f"{name}_x_mm"]), float(first[f"{name}_y_mm"]))
        for name in ("inflection_pole", "instant_centre")
    )
    given, h = gk.load(file).linkage, 1e-4
    coupler = gk.move(given, np.array([-h, 0, h])).coupler
    places = coupler.origin.position + coupler.direction * (centre - coupler.origin.position[1]) / coupler.direction[1]
    turn = np.angle(coupler.direction[2] / coupler.direction[0]) / (2 * h)
    assert pole == pytest.approx(centre + np.diff(places, 2)[0] / (h * turn) ** 2, rel=1e-6)
    assert abs(pole - centre) == pytest.approx(float(first["inflection_diameter_mm"]), rel=1e-9)
    assert pole == pytest.approx(-133.333 - 41.099j, abs=1e-3)


def test_the_crank_rocker_table_agrees_with_the_library():
    """Numbers of the file against the linkage put together by hand: two circles that meet."""
    recipe = gk.load(RECIPES[0].parent / "crank-rocker.toml")
    f = recipe.linkage
    from geomkin.export.csv import csv as write

    rows = list(csv.DictReader(write(recipe.table).decode().splitlines()))
    for row in rows[::30]:
        pin = f.crank * np.exp(1j * np.radians(float(row["crank_angle_deg"])))
        coupler = np.exp(1j * np.radians(float(row["coupler_angle_deg"])))
        point = complex(float(row["coupler_point_x_mm"]), float(row["coupler_point_y_mm"]))
        assert abs(abs(pin + f.coupler * coupler - f.ground) - f.rocker) < 1e-7
        assert abs(pin + f.coupler_point * coupler - point) < 1e-7
    times = np.array([float(r["time_s"]) for r in rows])
    x = np.array([float(r["coupler_point_x_mm"]) for r in rows])
    speed = np.array([float(r["coupler_point_velocity_x_mm_per_s"]) for r in rows])
    assert np.abs(np.gradient(x, times)[1:-1] - speed[1:-1]).max() < 2e-3 * np.abs(speed).max()


def test_the_ring_gear_s_table_is_the_side_of_the_tooth_in_its_drawing(tmp_path):
    gk.make(RECIPES[0].parent / "ring-gear.toml", tmp_path, ["csv", "dxf"])
    rows = list(csv.DictReader((tmp_path / "ring-gear" / "ring-gear.csv").read_text().splitlines()))
    z = np.array([complex(float(r["tooth_x_mm"]), float(r["tooth_y_mm"])) for r in rows])
    found = rings(tmp_path / "ring-gear", "ring-gear")
    plate, hole = found["CUT"][0], found["HOLE"][0]
    middle = complex(plate.centroid.x, plate.centroid.y)
    assert max(hole.exterior.distance(shapely.Point(p.real, p.imag)) for p in z + middle) < 0.006
    regions = list(dict.fromkeys(r["region"] for r in rows))
    assert (regions[0], regions[-1]) == ("tip land", "bottom land") and len(regions) >= 4
    half = np.interp(48.0, np.abs(z), [float(r["half_thickness_angle_deg"]) for r in rows])
    assert 2 * 48 * np.radians(half) == pytest.approx(np.pi - 0.1, abs=0.01)


def test_every_linkage_of_the_gallery_closes_its_loops_over_its_whole_way(made):
    recipe = gk.load(made[0])
    motions = [getattr(recipe, name) for name in ("motion", "figure") if hasattr(recipe, name)]
    for motion in motions:
        size = max(abs(z) for points in motion.linkage.bodies.values() for z in points.values())
        assert motion.assembled.all() and motion.residual.max() < 1e-12 * size
