"""Anything shown in a notebook: the page of its scene in a frame, as it moves; pictures of what stands still."""

import json
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

import geomkin as gk
from tests.export.test_page import unpacked

RECIPES = Path(__file__).parents[2] / "recipes"
SMALL = gk.Program(
    (gk.Dwell(end_deg=90), gk.Rise("cycloidal", rise=0.2, end_deg=180), gk.Return("harmonic", end_deg=360))
)
GROUND = {"ground": {"O": 0, "C": 60}, "slider": {"S": 0}, "rod": {"S": 0, "P": 70}, "arm": {"C": 0, "P": 40}}
ROD = gk.Linkage(GROUND, "slider", (gk.Slider("way", "slider", "ground", through=30j),))
# A cart on an endless rail, with another on its rod.
CARTS = {"ground": {"O": 0}, "cart": {"S": 0}, "rod": {"S": 0, "P": 70}, "other": {"P": 0}}
RAILS = gk.Slider("low", "cart", "ground"), gk.Slider("high", "other", "ground", through=30j)
FREE = gk.Linkage(CARTS, "cart", RAILS)


class Elements(HTMLParser):
    """Every element with its attributes, and the texts of scripts by type."""

    def __init__(self, text):
        super().__init__()
        self.found, self.scripts, self.open = [], {}, None
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.found.append((tag, dict(attributes)))
        self.open = dict(attributes).get("type") if tag == "script" else None

    def handle_data(self, data):
        if self.open:
            self.scripts[self.open] = self.scripts.get(self.open, "") + data


def framed(html):
    """The attributes of the one element there is, and the page in it."""
    ((tag, attributes),) = Elements(html).found
    assert tag == "iframe"
    return attributes, attributes.pop("srcdoc")


def scene_of(thing):
    """The scene that the player is given, with its driver's row in numbers."""
    _, page = framed(gk.show(thing)._repr_html_())
    data = json.loads(Elements(page).scripts["application/json"])
    drive = unpacked(data["series"][data["columns"][0]["row"]], data["frames"])
    return data, drive


def test_the_page_of_a_recipe_is_the_one_that_is_written(tmp_path):
    file = RECIPES / "crank-rocker.toml"
    gk.write(gk.load(file), tmp_path / "crank-rocker.html")
    kept = (tmp_path / "crank-rocker.html").read_bytes()
    recipe = gk.load(file)
    for thing in (str(file), recipe):
        shown = gk.show(thing)
        assert shown.page == kept and framed(shown._repr_html_())[1].encode() == kept
    assert framed(recipe._repr_html_())[1].encode() == kept
    assert gk.show(file.read_text()).name == "four-bar"
    saved = shown.save(tmp_path / "saved.html")
    assert saved.read_bytes() == kept


def test_a_frame_runs_its_own_script_and_reaches_nothing_else():
    attributes, page = framed(gk.FourBar(100, 30, 90, 70)._repr_html_())
    assert attributes["sandbox"] == "allow-scripts allow-downloads" and attributes["title"] == "FourBar"
    assert "Content-Security-Policy" in page and "default-src 'none'" in page


def test_a_linkage_goes_its_full_turn_or_as_far_as_its_sides_allow():
    data, drive = scene_of(gk.FourBar(100, 30, 90, 70))
    assert data["cyclic"] and np.ptp(drive) == pytest.approx(360) and data["frames"] == 361
    # On both sides of the ground line, until coupler and rocker are in line: by the law of cosines.
    linkage = gk.FourBar(100, 80, 60, 50)
    data, drive = scene_of(linkage)
    stretched = np.degrees(np.arccos((100**2 + 80**2 - (60 + 50) ** 2) / (2 * 100 * 80)))
    assert not data["cyclic"] and drive[[0, -1]] == pytest.approx([-stretched, stretched], rel=0.005)
    assert 0.01 < stretched - drive.max() and not data["scenes"][0].get("open")
    # A slide from stretched to stretched.
    data, drive = scene_of(ROD)
    reach = np.sqrt((70 + 40) ** 2 - 30**2)
    assert drive[[0, -1]] == pytest.approx([60 - reach, 60 + reach], abs=0.005 * reach)


@pytest.mark.parametrize(
    ("thing", "bodies"),
    [
        (gk.SliderCrank(30, 90, 5, driver="slider"), "crank, coupler, slider"),
        (gk.Cam(gk.TranslatingRoller(0.1, 0), SMALL, 0.4), "cam, roller"),
        (gk.RingGear(60, 0.01), "ring, tool"),
        (gk.GearPair(gk.SpurGear(20, 2), gk.RingGear(60, 2, addendum=0.8)), "first, second"),
        (gk.gear.StraightSidedGear(20, 2), "gear"),
    ],
    ids=repr,
)
def test_bodies_are_those_that_move(thing, bodies):
    data, drive = scene_of(thing)
    assert set(bodies.split(", ")) <= {body["name"] for body in data["scenes"][0]["bodies"]}
    assert data["frames"] == 1 or np.ptp(drive) > 0


def test_parts_lie_apart_and_each_copy_is_there():
    square = gk.Part("plate", gk.plane.Polyline(np.array([0, 10, 10 + 10j, 10j])), (), 3.0, count=3)
    small = gk.Part("washer", gk.plane.Circle(0j, 2.0), (gk.plane.Circle(0j, 1.0),), 1.0)
    data, _ = scene_of([square, small])
    bodies = data["scenes"][0]["bodies"]
    assert sorted(body["name"] for body in bodies) == ["plate 1", "plate 2", "plate 3", "washer"]
    places = [complex(*(float(data["series"][k]) for k in body["at"])) for body in bodies if body["name"] != "washer"]
    apart = [max(abs((a - b).real), abs((a - b).imag)) for k, a in enumerate(places) for b in places[:k]]
    assert min(apart) > 10


def test_a_point_runs_along_a_curve():
    circle = gk.plane.Circle(3 + 4j, 2.0)
    data, drive = scene_of(circle)
    columns = {column["name"]: unpacked(data["series"][column["row"]], data["frames"]) for column in data["columns"]}
    assert data["cyclic"] and drive[[0, -1]] == pytest.approx(circle.breaks[[0, -1]], abs=1e-4)
    assert columns["curvature"] == pytest.approx(np.full(361, 0.5), rel=1e-5)
    assert np.abs(columns["point_x"] + 1j * columns["point_y"] - 3 - 4j) == pytest.approx(np.full(361, 2.0), rel=1e-4)
    assert not scene_of(gk.plane.Segment(0j, 1j))[0]["cyclic"]


@pytest.mark.parametrize(
    ("thing", "filled", "size"),
    [
        (gk.RingGear(60, 2), True, 2 * gk.RingGear(60, 2).root_radius),
        (gk.plane.Segment(0j, 30 + 40j), False, 40),
        (gk.Part("bar", gk.plane.Circle(0j, 9.0), (gk.plane.Circle(0j, 4.0),), 3.0, marks=(gk.plane.Segment(5j, 8j),)), True, 18),
    ],
    ids=repr,
)  # fmt: skip
def test_still_things_are_shown_as_pictures(thing, filled, size):
    svg = ElementTree.fromstring(thing._repr_svg_())
    _, _, wide, high = map(float, svg.get("viewBox").split())
    assert (wide / high, high) == pytest.approx((1.5, size * 240 / 236), rel=0.01)
    first, *marks = svg
    assert (first.get("fill") != "none") == filled and [mark.get("fill") for mark in marks] == ["none"] * len(marks)
