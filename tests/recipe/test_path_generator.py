"""The recipe that finds a linkage for a path: what it reads, makes and refuses."""

import json
import re
import tomllib
from dataclasses import replace

import numpy as np
import pytest

import geomkin as gk
from geomkin.build import check_recipe
from geomkin.synthesis.kinds import path_generator
from geomkin.synthesis.path.path_found import PathFound
from tests.texts import template_of

FIVE = """
kind = "path-generator"
[wanted]
points = [[30, 30], [27.59, 33.63], [23.72, 36.63], [18.90, 38.62], [13.55, 39.43]]
step_deg = 15
[bounds]
origin_x = [0, 0]
origin_y = [0, 0]
"""
SVG = '<svg xmlns="http://www.w3.org/2000/svg"><g><path id="a" d="M 0 0 L 40 0 L 40 30 Z"/><path d="M 1 1"/></g></svg>'


@pytest.mark.campaign
def test_goal_is_made_and_its_found_recipe_runs(tmp_path):
    made = gk.make(gk.load(FIVE).with_name("five"), tmp_path)
    folder = tmp_path / "five"
    assert {"five.dxf", "five.csv", "five.svg", "path.stl", "crank.stl", "five.found.toml"} <= {
        p.name for p in made.files
    }
    data = json.loads((folder / "summary.json").read_text())
    assert data["found"]["square_error_mm2"] < 1e-4 and data["points"] == 5 and data["method"] != "least squares"
    assert data["ranked"][0] == data["found"] and len(data["cognates"]) == 3 and not data["cut_short"]
    assert data["usable"]["transmission_angle_deg"] >= 30 - 1e-6 and data["usable"]["ratio"] <= 10 + 1e-6
    first = made.checks[0]
    assert first.name == "largest distance of a point from the path" and first.passed and first.value < 0.01
    # Another road: the found recipe, loaded and moved to the reported drives.
    found = gk.load(folder / "five.found.toml")
    drive = np.radians(data["drive_at_points_deg"])
    track = gk.move(found.linkage, drive, found.branch).point("coupler_point").position
    wanted = np.array([30 + 30j, 27.59 + 33.63j, 23.72 + 36.63j, 18.90 + 38.62j, 13.55 + 39.43j])
    assert np.abs(track - wanted).max() == pytest.approx(first.value, abs=1e-6)
    assert found.drive.start_deg == pytest.approx(data["drive_at_points_deg"][0])
    assert found.drive.end_deg == pytest.approx(data["drive_at_points_deg"][-1])


def test_each_wanted_point_has_a_mark_of_the_same_size_on_the_screen(tmp_path):
    shares = []
    for scale in (1, 20):
        recipe = gk.load(f"scale = {scale}\n{FIVE}")
        (file,) = gk.write(recipe, tmp_path / f"{scale}-assembly.svg")
        text = file.read_text()
        radii = re.findall(r'<circle class="dot wanted" r="([^"]*)"', text)
        width = float(re.search(r'viewBox="\S+ \S+ (\S+) ', text)[1])
        assert len(radii) == 5
        shares.append(float(radii[0]) / width)
    assert shares[1] == pytest.approx(shares[0], rel=0.02) and 0.003 < shares[0] < 0.02


@pytest.mark.parametrize(("key", "is_length"), [("links", True), ("crank", True), ("ground", True), ("offset", False)])
def test_bounds_of_a_length_are_no_less_than_zero(key, is_length):
    text = f"{FIVE}{key} = [-5, 10]"
    if not is_length:
        assert gk.load(text).bounds.given[key] == (-5, 10)
        return
    with pytest.raises(gk.RecipeError) as refused:
        gk.load(text)
    assert [problem.key for problem in refused.value.problems] == [f"bounds.{key}[0]"]
    # Of the library too, for closed paths.
    if key == "links":
        with pytest.raises(gk.DesignError):
            gk.path_generator([0, 40, 40 + 30j, 30j], closed=True, bounds={key: (-5, 10)})


def test_points_come_from_files_and_texts(tmp_path):
    rows = "x_mm, y_mm\n0,0\n10,2\n\n20,3\n30,2.5\n"
    (tmp_path / "path.csv").write_text("\ufeff" + rows)
    (tmp_path / "shape.svg").write_text(SVG)
    recipe = tmp_path / "a.toml"
    recipe.write_text('kind = "path-generator"\nwanted = { file = "path.csv" }\n')
    assert gk.load(recipe).wanted.places == pytest.approx([0, 10 + 2j, 20 + 3j, 30 + 2.5j])
    recipe.write_text('kind = "path-generator"\nwanted = { file = "shape.svg", count = 12, closed = true }\n')
    places = gk.load(recipe).wanted.places
    assert len(places) == 12 and places[1] == 10 and places[5] == pytest.approx(40 - 10j)
    recipe.write_text(
        'kind = "path-generator"\nwanted = { svg = "M 0 0 L 40 0 L 40 30 Z", count = 12, closed = true }\n'
    )
    assert gk.load(recipe).wanted.places == pytest.approx(places)


def test_invalid_values_are_refused_by_key(tmp_path):
    for wanted, message in [
        ("", "points, file and svg"),
        ('svg = "M 0 0 L 1 1", points = [[0, 0]]', "points and svg"),
        ('file = "none.csv"', "wanted.file: none.csv"),
        ('file = "../outside.csv"', "wanted.file: .*outside.csv"),
        ('file = "bad.csv"', "wanted.file: row 2 of bad.csv"),
        ('file = "empty.svg"', "wanted.file: empty.svg"),
        ('file = "photo.png"', "wanted.file: photo.png.*SVG"),
        ('svg = "M 0 0 L 1"', "wanted.svg: its path at character 9 holds"),
        ("points = [[0, 0], [1, 1]]", "wanted.points: found 2"),
        (
            "points = [[0, 0], [1, 1], [2, 0]], drive_deg = [0, 1, 2], step_deg = 3",
            "step_deg",
        ),
        ("points = [[0, 0], [1, 1], [2, 0]], step_deg = 0", "wanted.step_deg: "),
        ("points = [[0, 0], [1, 1], [2, 0]], step_deg = 180, closed = true, bars = 6", "wanted.step_deg: "),
    ]:
        (tmp_path / "bad.csv").write_text("1,2\na,b\n")
        (tmp_path / "empty.svg").write_text("<svg/>")
        (tmp_path / "photo.png").write_bytes(b"\x89PNG\r\n\x1a\n")
        (tmp_path / "a.toml").write_text(f'kind = "path-generator"\nwanted = {{ {wanted} }}\n')
        with pytest.raises(gk.RecipeError, match=message):
            check_recipe(gk.load(tmp_path / "a.toml"))


def test_a_size_of_a_linkage_that_was_found_is_named_by_the_points(monkeypatch):
    """The recipe has no such key."""

    def search(*_):
        raise gk.DesignError("origin", "found 2e9", "give less")

    monkeypatch.setattr(path_generator, "path_generator", search)
    with pytest.raises(gk.DesignError) as caught:
        _ = gk.load(FIVE).best
    assert caught.value.field == "wanted.points" and "origin" in caught.value.problem


@pytest.fixture(scope="module")
def five():
    return gk.load(FIVE)


def test_angles_are_given_one_by_one_or_in_equal_steps():
    wanted = gk.load(FIVE).wanted
    assert wanted.turns_deg == pytest.approx([0, 15, 30, 45, 60])
    one_by_one = gk.load(FIVE.replace("step_deg = 15", "drive_deg = [10, 25, 40, 55, 70]")).wanted
    assert one_by_one.turns_deg == pytest.approx([10, 25, 40, 55, 70])
    assert gk.load(FIVE.replace("step_deg = 15", "")).wanted.turns_deg is None


def test_usable_linkage_has_the_rank_after_the_others(monkeypatch):
    """Two linkages of a search, of which the best counts as one that jams and the other as found by the further search."""
    drive = np.linspace(0.5, 2, 5)

    def found_of(linkage):
        points = gk.move(linkage, drive).point("coupler_point").position
        return PathFound(
            linkage=linkage, branch=1, drive=drive, transmission_angle_deg=40.0, defects=(), points=points,
            square_error=0.0, largest_distance=0.0, rms_distance=0.0,
        )  # fmt: skip

    usable = found_of(gk.FourBar(90, 30, 80, 70, 40 + 45j))
    best = replace(found_of(gk.FourBar(90, 25, 80, 70, 40 + 45j)), transmission_angle_deg=9.0, again=lambda: usable)
    monkeypatch.setattr(path_generator, "path_generator", lambda *_: replace(best, ranked=(best, best)))
    recipes = [gk.load(FIVE.replace("[wanted]", f"choose = {k}\n[wanted]")) for k in (1, 2, 3, 4)]
    assert recipes[0].notes["usable"]["choose"] == 3 and len(recipes[0].ranked) == 2
    assert [recipe.found.linkage.crank for recipe in recipes[:3]] == [25, 25, 30]
    with pytest.raises(gk.DesignError) as refused:
        _ = recipes[3].found
    assert refused.value.field == "choose" and "3" in refused.value.remedy
    # A usable best linkage has rank 1.
    monkeypatch.setattr(path_generator, "path_generator", lambda *_: replace(usable, ranked=(usable,)))
    good = gk.load(FIVE)
    assert good.notes["usable"]["choose"] == 1 and good.further == ()


WEIGHTED = """
kind = "path-generator"
[wanted]
svg = "M -40 0 L 40 0 C 40 -30 -40 -30 -40 0 Z"
count = 20
closed = true
[[wanted.weights]]
first = 19
last = 2
weight = 8
[[wanted.weights]]
first = 2
last = 4
weight = 0.5
"""


def test_stretches_with_weights_are_numbered_from_one_and_pass_the_end_of_a_closed_path():
    weights = gk.load(WEIGHTED).wanted.weights_of_points
    assert weights.tolist() == [8, 0.5, 0.5, 0.5, *[1] * 14, 8, 8]
    assert gk.load(FIVE).wanted.weights_of_points is None


@pytest.mark.parametrize(
    ("old", "new", "key"),
    [
        ("last = 2\n", "last = 21\n", "wanted.weights[0].last"),
        ("first = 2\n", "first = 30\n", "wanted.weights[1].first"),
        ("closed = true", "closed = false", "wanted.weights[0].last"),
        ("weight = 8", "weight = 0", "wanted.weights[0].weight"),
        ("first = 19", "first = 0", "wanted.weights[0].first"),
    ],
)
def test_stretches_that_the_path_has_not_are_refused_by_key(old, new, key):
    with pytest.raises(gk.RecipeError, match=re.escape(key)):
        check_recipe(gk.load(WEIGHTED.replace(old, new)))


@pytest.mark.campaign
def test_weights_of_a_recipe_reach_the_search_and_its_summary(tmp_path):
    """Distances of the found recipe by position analysis, from the points of the recipe."""
    recipe = gk.load(WEIGHTED).with_name("w")
    gk.make(recipe, tmp_path)
    data = json.loads((tmp_path / "w" / "summary.json").read_text())["found"]
    found = gk.load(tmp_path / "w" / "w.found.toml")
    path = gk.move(found.linkage, np.linspace(0, 2 * np.pi, 8001), found.branch).point("coupler_point").position
    off = np.abs(path - recipe.wanted.places[:, None]).min(axis=1)
    weights = recipe.wanted.weights_of_points
    assert data["square_error_mm2"] == pytest.approx(np.sum(off**2), rel=1e-2)
    assert data["weighted_largest_distance_mm"] >= (off * np.sqrt(weights / 8)).max() - 1e-3
    assert data["weighted_largest_distance_mm"] < data["largest_distance_mm"]
    larger = gk.load(WEIGHTED.replace("[wanted]", "scale = 2\n[wanted]", 1))
    assert larger.found.weighted_largest_distance == pytest.approx(2 * data["weighted_largest_distance_mm"], rel=1e-2)


@pytest.mark.campaign
def test_a_linkage_that_cannot_be_cut_names_one_that_can():
    """The gears of some five-bars of this path are smaller than their pins."""
    table = tomllib.loads(template_of("path-generator"))
    table["wanted"] |= {"bars": 5, "geared": True}
    first = gk.load(table)
    five = next(k for k, found in enumerate(first.ranked, 1) if found.bars == 5)
    with pytest.raises(gk.DesignError) as caught:
        _ = gk.load(table | {"choose": five}).parts
    assert caught.value.field == "choose" and caught.value.value != five
    assert gk.load(table | {"choose": int(caught.value.value)}).parts
