"""Pages without a browser: one file, the same each time, that lets run what stands in it, whatever a recipe's texts hold."""

import dataclasses
import json
import re
import struct
from base64 import b64decode, b64encode
from hashlib import sha256
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

import geomkin as gk
from geomkin.export import Job
from geomkin.export.job import StaticSource
from geomkin.export.still import MOST_FRAMES, kept_frames
from geomkin.export.svg_path import path
from geomkin.model.scene import Limit, Plot, Scene, SceneBody, SceneCurve, SceneMark
from geomkin.page.page import mechanism_page, scene_data, scene_json
from geomkin.recipe.aspect import ShaftPlacement
from tests.export.stills import stepped

RECIPES = Path(__file__).parent.parent.parent / "recipes"
NASTY = '</script><img src=x onerror="alert(1)">\'&\u202etxet\u202c <!--'


class Elements(HTMLParser):
    """Every element with its attributes, and the text of scripts and styles."""

    def __init__(self, text):
        super().__init__()
        self.found, self.inside, self.open = [], {}, ""
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.found.append((tag, dict(attributes)))
        self.open = {"style": "style", "script": f"script {dict(attributes).get('type')}"}.get(tag, "")

    def handle_endtag(self, tag):
        self.open = ""

    def handle_data(self, data):
        if self.open:
            self.inside[self.open] = self.inside.get(self.open, "") + data


def unpacked(row, count):
    """A row of the page's data, read number by number."""
    if isinstance(row, str):
        return np.array([value for (value,) in struct.iter_unpack("<f", b64decode(row))])
    if not isinstance(row, list):
        return np.full(count, np.nan if row is None else row)
    values, (decimals, *differences) = [], row
    known = [0, 0]
    for difference in differences:
        if difference is not None:
            known.append(2 * known[-1] - known[-2] + difference)
        values.append(np.nan if difference is None else float(f"{known[-1]}e{-decimals}"))
    return np.array(values)


def test_data_never_spells_nan_which_would_look_like_an_unknown_number():
    scene = turning("nAn nan bananan")
    written = scene_json(scene, "NAN")
    assert not re.search("nan", written, re.IGNORECASE)
    assert json.loads(written) == json.loads(json.dumps(scene_data(scene, "NAN")))


def turning(text="washer", frames=9, radius=20.0):
    """A plate that turns, with a text wherever a scene holds one."""
    turn = np.linspace(0, 2 * np.pi, frames)
    table = gk.Table(
        (gk.Column("turn", "deg", text, np.degrees(turn)), gk.Column("height", "mm", text, radius * np.sin(turn)))
    )
    part = gk.Part("plate", gk.plane.Circle(0, radius), (gk.plane.Circle(1, radius / 5),), 2.0)
    place = np.zeros(frames, dtype=complex)
    return Scene(
        table,
        turn,
        np.full(frames, True),
        (SceneBody(text, (part,), place, np.exp(1j * turn)),),
        (SceneCurve(gk.plane.Circle(0, 2 * radius), "wanted", text, text),),
        (SceneMark("point", radius * np.exp(1j * turn), "traced", text, trail=True),),
        (Plot(text, ("height",), (Limit("height", 3.0, text),)),),
        others={text: dataclasses.replace(turning(frames=frames), others={})} if text != "washer" else {},
    )


def job_of(scene, name="page", **besides):
    parts = tuple(part for body in scene.bodies for part in body.parts)
    checks = besides.pop("checks", ())
    return Job(name, StaticSource(parts, scene.table, scene, checks, besides.pop("notes", {})), 0.005, **besides)


def nasty():
    checks = (gk.Check("nasty", NASTY, 1.0, "at least", 2.0, NASTY, NASTY),)
    return job_of(
        turning(NASTY), NASTY, checks=checks, about=NASTY, recipe=lambda: f"a = 1\n{NASTY}\n", notes={NASTY: NASTY}
    )


def test_texts_of_a_recipe_are_escaped():
    text = mechanism_page(nasty()).decode()
    elements = Elements(text)
    tags = [tag for tag, _ in elements.found]
    assert tags.count("script") == 2 and "img" not in tags
    assert not any(key.startswith("on") or key == "style" for _, found in elements.found for key in found)
    assert "\u202e" not in text and "\u202c" not in text
    data = json.loads(elements.inside["script application/json"])
    assert (
        data["plots"][0]["title"] == NASTY.replace("\u202e", "?").replace("\u202c", "?") == data["scenes"][1]["label"]
    )
    assert "<" not in elements.inside["script application/json"]


@pytest.mark.parametrize("make", [lambda: mechanism_page(nasty()), lambda: mechanism_page(job_of(turning()))])
def test_policy_allows_only_the_scripts_of_the_page(make):
    elements = Elements(make().decode())
    policy = next(a["content"] for t, a in elements.found if a.get("http-equiv") == "Content-Security-Policy")
    rules = dict(rule.strip().split(" ", 1) for rule in policy.split(";"))
    assert rules["default-src"] == "'none'" and "unsafe" not in policy and "http" not in policy
    for rule, key in (("script-src", "script module"), ("style-src", "style")):
        digest = b64encode(sha256(elements.inside[key].encode()).digest()).decode()
        assert rules[rule] == f"'sha256-{digest}'"


@pytest.mark.campaign
def test_page_lists_checks_parts_and_the_recipe(tmp_path):
    recipe = gk.load(RECIPES / "walking-leg.toml")
    gk.write(recipe, tmp_path / "leg.html")
    text = (tmp_path / "leg.html").read_text()
    rows = re.findall(r'<tr class="(holds|fails)">', text)
    assert rows == ["fails"] + ["holds"] * (len(recipe.checks) - 1)
    assert all(f'<th scope="row">{part.name}</th>' in text for part in recipe.parts)
    reported = re.search(r'<code id="recipe-text">(.*?)</code>', text, re.DOTALL)[1]
    assert gk.load(reported + "\n") == recipe
    assert "geomkin run leg.toml" in text


@pytest.mark.parametrize("count", [2, 40])
def test_long_remarks_are_below_the_drawing(count):
    text = mechanism_page(job_of(turning(), about=" ".join(["A washer."] + ["It is said to turn."] * count))).decode()
    head = text.partition('<section id="player"')[0]
    assert "A washer." in head
    assert (text.count("said to turn"), head.count("said to turn")) == (count, count if count < 40 else 0)


def test_paths_equal_their_curves():
    square = gk.plane.Polyline(np.array([0, 10, 10 + 10j, 10j]))
    assert (
        path([square, gk.plane.Circle(5 + 5j, 2)], 0.01, 3) == "M0 0l10 0 0 10-10 0zM3 5a2 2 0 0 1 4 0a2 2 0 0 1-4 0z"
    )
    bar = path([gk.plane.rounded_hull([0, 30], 5)], 0.01, 3)
    assert bar == "M0 5a5 5 0 0 1 0-10l30 0a5 5 0 0 1 0 10l-30 0z"
    gear = gk.SpurGear(24, 2).outline
    points = np.cumsum(stepped(path([gear], 0.02, 3)))
    assert np.abs(points - gk.flatten(gear, 0.02)).max() < 1e-3


def test_round_outlines_are_arcs():
    cam = gk.load(RECIPES / "roller-cam.toml").parts[0].outline
    text = path([cam], 0.02, 3)
    points = np.cumsum(stepped(text))
    assert gk.nearest(cam, points)[1].max() < 0.021
    assert text.count("a") > 10 and "l" not in text and len(points) < len(gk.flatten(cam, 0.02)) / 2


def test_mirrored_and_placed_copies_of_circles_are_circles():
    placement = ShaftPlacement(gk.plane.Pose(3 + 1j, 1j), mirrored=True)
    circle = placement.curve(gk.plane.Circle(5 + 5j, 2))
    assert isinstance(circle, gk.plane.Circle) and abs(circle.centre - (-2 - 4j)) < 1e-12 and circle.radius == 2


@pytest.mark.parametrize("size", [1e-2, 1e3])
def test_curves_are_as_fine_as_a_screen_shows_and_no_finer(size):
    """A spline round about, in a scene as wide as it: its chords lie off it by a five-thousandth of the size or less."""
    turn = np.linspace(0, 2 * np.pi, 9)
    corners = size * np.exp(1j * turn) * (1 + 0.2 * np.cos(3 * turn))
    corners[-1] = corners[0]
    spline = gk.plane.Spline(corners)
    scene = dataclasses.replace(turning(radius=size), curves=(SceneCurve(spline, "traced"),))
    low, high = scene.box
    data = json.loads(scene_json(scene, "a"))
    text = data["paths"][data["scenes"][0]["curves"][0]["path"]]
    points = np.cumsum(stepped(text))
    assert gk.nearest(spline, points)[1].max() < 8e-5 * size
    off = gk.nearest(spline, (points[1:] + points[:-1]) / 2)[1].max()
    assert 4e-5 * abs(high - low) < off < 2.3e-4 * abs(high - low)


def test_a_long_table_is_thinned_and_keeps_its_ends():
    kept = kept_frames(50_000)
    assert len(kept) == MOST_FRAMES and kept[0] == 0 and kept[-1] == 49_999 and len(np.unique(kept)) == len(kept)
    assert list(kept_frames(5)) == [0, 1, 2, 3, 4]
    assert json.loads(scene_json(turning(frames=5000), "a"))["frames"] == MOST_FRAMES


def test_another_scene_beside_it_is_on_the_same_drive():
    scene = turning()
    with pytest.raises(gk.DesignError, match="9 rows"):
        dataclasses.replace(scene, others={"mode": turning(frames=5)})
    data = json.loads(scene_json(dataclasses.replace(scene, others={"other": scene}), "a"))
    # The same rows and outlines, written once.
    assert data["scenes"][1] | {"label": ""} == data["scenes"][0]


@pytest.mark.parametrize(
    ("stem", "words"), [("three-poses", "pose 1"), ("undercut-cam", "profile"), ("shaking-force", "counterweight")]
)
def test_the_switch_of_what_is_wanted_names_it(stem, words):
    roles = scene_data(gk.load(f"recipes/{stem}.toml").scene, stem)["roles"]
    (label,) = (role["label"] for role in roles if role["id"] == "wanted")
    # The player appends the scale of vectors.
    assert words in label and "1 mm" not in label


def test_pictures_of_layers_show_each_part_once_where_it_is_assembled():
    recipe = gk.load(RECIPES / "motor-crank.toml")
    page = mechanism_page(Job("m", recipe, 0.01)).decode()
    section = re.search(r'<section id="layers">.*?</section>', page, re.DOTALL)[0]
    defined = re.findall(r'<path id="(\w+)"', section)
    uses = [
        re.findall(r'<use href="#(\w+)" class="([^"]*)"([^>]*)>', f)
        for f in re.findall("<figure>.*?</figure>", section)
    ]
    # Every outline is written once, and every part is added in exactly one picture.
    assert len(set(defined)) == len(defined) and {name for row in uses for name, _, _ in row} == set(defined)
    scene = recipe.scene
    layers = sorted({body.layer for body in scene.bodies if body.parts})
    k = int(np.argmin(np.abs(np.asarray(scene.drive.values) - 0.13 * 360)))
    assert len(uses) == len(layers) > 2
    for layer, row in zip(layers, uses):
        new = [where for _, look, where in row if "below" not in look]
        bodies = [body for body in scene.bodies if body.parts and body.layer == layer]
        assert len(new) == sum(len(body.parts) for body in bodies)
        assert len(row) == sum(len(body.parts) for body in scene.bodies if body.layer <= layer)
        for body, where in zip(bodies, new):
            turned = float((re.search(r"rotate\(([-.\d]+)\)", where) or [0, 0])[1])
            assert np.exp(1j * np.radians(turned)) == pytest.approx(complex(body.direction[k]), abs=1e-4)
            moved = re.search(r"translate\(([-.\d]+) ([-.\d]+)\)", where) or [0, 0, 0]
            assert complex(float(moved[1]), float(moved[2])) == pytest.approx(complex(body.origin[k]), abs=0.1)


def test_a_scene_that_is_never_assembled_has_a_page():
    scene = turning()
    never = dataclasses.replace(scene, assembled=np.zeros(len(scene.time), dtype=bool))
    assert b"</html>" in mechanism_page(job_of(never))
