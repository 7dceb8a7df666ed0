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
from geomkin.export import WRITERS, Job
from geomkin.export.job import StaticSource
from geomkin.export.still import MOST_FRAMES, kept_frames
from geomkin.export.svg_path import path
from geomkin.export.text import with_unit
from geomkin.model.scene import Limit, Plot, Scene, SceneBody, SceneCurve, SceneMark
from geomkin.page.page import page
from geomkin.page.page import write_page as write
from geomkin.page.scene_json import floats, island, steps
from geomkin.page.sections import notes
from geomkin.recipe import Files

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


def test_no_text_of_a_recipe_is_markup_or_turns_what_stands_beside_it():
    text = page(nasty()).decode()
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


@pytest.mark.parametrize("make", [lambda: page(nasty()), lambda: page(job_of(turning()))])
def test_the_policy_lets_run_what_stands_in_the_page_and_nothing_else(make):
    elements = Elements(make().decode())
    policy = next(a["content"] for t, a in elements.found if a.get("http-equiv") == "Content-Security-Policy")
    rules = dict(rule.strip().split(" ", 1) for rule in policy.split(";"))
    assert rules["default-src"] == "'none'" and "unsafe" not in policy and "http" not in policy
    for rule, key in (("script-src", "script module"), ("style-src", "style")):
        digest = b64encode(sha256(elements.inside[key].encode()).digest()).decode()
        assert rules[rule] == f"'sha256-{digest}'"


def test_nothing_is_fetched_and_the_page_says_what_it_is():
    text = page(job_of(turning(), about="A plate that turns.")).decode()
    assert not re.findall(r'(?:src|href)="(?!data:)', text) and "@import" not in text and "url(#" in text
    assert text.startswith('<!doctype html>\n<html lang="en">') and "<title>page</title>" in text
    assert text.count("<h1>") == 1 and "A plate that turns." in text


def test_a_recipe_s_page_is_a_format_like_any_other(tmp_path):
    recipe = gk.load(RECIPES / "crank-rocker.toml")
    made = gk.make(recipe, tmp_path)
    file = tmp_path / "crank-rocker" / "crank-rocker.html"
    assert file in made.files and "crank-rocker.html" in json.loads(file.with_name("summary.json").read_text())["files"]
    (again,) = gk.write(recipe, tmp_path / "mine.html")
    assert again.name == "mine.html" and b"<title>mine</title>" in again.read_bytes()
    only = gk.make(recipe, tmp_path / "only", ["page"])
    assert {path.name for path in only.files} == {"crank-rocker.html", "summary.json"}
    # Told in the summary, and so removed where the recipe asks for it no more.
    gk.make(dataclasses.replace(recipe, files=Files(write=("csv",))).with_name("crank-rocker"), tmp_path)
    assert not file.exists()


def test_the_same_recipe_gives_the_same_bytes(tmp_path):
    pages = []
    for folder in ("one", "two"):
        recipe = gk.load(RECIPES / "walking-leg.toml")
        pages.append(next(iter(gk.write(recipe, tmp_path / folder / "a.html"))).read_bytes())
    assert pages[0] == pages[1]


@pytest.mark.parametrize(("name", "most"), [("crank-rocker", 220_000), ("walking-leg", 250_000)])
def test_a_page_is_light_enough_for_a_mail(name, most, tmp_path):
    (size,) = gk.write(gk.load(RECIPES / f"{name}.toml"), tmp_path / "a.html").values()
    assert size < most


def test_the_page_tells_checks_parts_and_the_recipe(tmp_path):
    recipe = gk.load(RECIPES / "walking-leg.toml")
    gk.write(recipe, tmp_path / "leg.html")
    text = (tmp_path / "leg.html").read_text()
    rows = re.findall(r'<tr class="(holds|fails)">', text)
    assert rows == ["fails"] + ["holds"] * (len(recipe.checks) - 1)
    assert all(f'<th scope="row">{part.name}</th>' in text for part in recipe.parts)
    told = re.search(r'<code id="recipe-text">(.*?)</code>', text, re.DOTALL)[1]
    assert gk.load(told + "\n") == recipe
    assert "geomkin run leg.toml" in text


ROWS = (
    np.sin(np.linspace(0, 7, 200)),
    np.random.default_rng(1).normal(size=50),
    np.full(7, 3.25),
    np.array([np.nan, 1.0, np.nan, 2.0, 2.5]),
    np.array([np.nan, 1.0]),
    np.full(4, np.nan),
    np.array([-7.0]),
    np.zeros(3),
)


@pytest.mark.parametrize("row", ROWS)
def test_places_are_read_back_to_their_last_decimal_and_values_to_seven_digits(row):
    for decimals in (-2, 0, 3, 6):
        large = row * 10.0 ** (4 - decimals)
        stored = json.loads(json.dumps(steps(large, decimals)))
        assert unpacked(stored, len(row)) == pytest.approx(np.round(large, decimals), nan_ok=True, rel=1e-12)
    for size in (1e-30, 1e-3, 1.0, 1e30):
        stored = json.loads(json.dumps(floats(size * row)))
        assert unpacked(stored, len(row)) == pytest.approx(size * row, nan_ok=True, rel=1e-7, abs=0)


def test_a_smooth_place_takes_four_signs_a_number_and_a_fixed_one_none():
    turn = np.linspace(0, 2 * np.pi, 361)
    assert len(json.dumps(steps(100 * np.cos(turn), 3), separators=(",", ":"))) < 4 * 361
    assert steps(np.full(361, 2.5), 3) == floats(np.full(361, 2.5)) == 2.5


def test_paths_draw_what_they_are_made_of():
    square = gk.plane.Polyline(np.array([0, 10, 10 + 10j, 10j]))
    assert (
        path([square, gk.plane.Circle(5 + 5j, 2)], 0.01, 3) == "M0 0l10 0 0 10-10 0zM3 5a2 2 0 0 1 4 0a2 2 0 0 1-4 0z"
    )
    bar = path([gk.plane.rounded_hull([0, 30], 5)], 0.01, 3)
    assert bar == "M0 5a5 5 0 0 1 0-10l30 0a5 5 0 0 1 0 10l-30 0z"
    gear = gk.SpurGear(24, 2).outline
    numbers = [float(n) for n in re.findall(r"-?\d*\.?\d+", path([gear], 0.02, 3))]
    points = np.cumsum(np.array(numbers[::2]) + 1j * np.array(numbers[1::2]))
    assert np.abs(points - gk.flatten(gear, 0.02)).max() < 1e-3


@pytest.mark.parametrize("size", [1e-4, 1.0, 1e5])
def test_places_keep_their_digits_whatever_the_size(size):
    scene = turning(radius=size)
    data = json.loads(island(scene, "a"))
    at = data["scenes"][0]["marks"][0]["at"]
    x, y = (unpacked(data["series"][k], 9) for k in at)
    assert np.abs(x + 1j * y - scene.marks[0].place).max() < 1e-4 * size


@pytest.mark.parametrize("size", [1e-2, 1.0, 1e3])
def test_curves_are_as_fine_as_a_screen_shows_and_no_finer(size):
    """A spline round about, in a scene as wide as it: its chords lie off it by a five-thousandth of the size or less."""
    turn = np.linspace(0, 2 * np.pi, 9)
    corners = size * np.exp(1j * turn) * (1 + 0.2 * np.cos(3 * turn))
    corners[-1] = corners[0]
    spline = gk.plane.Spline(corners)
    scene = dataclasses.replace(turning(radius=size), curves=(SceneCurve(spline, "traced"),))
    low, high = scene.box
    data = json.loads(island(scene, "a"))
    text = data["paths"][data["scenes"][0]["curves"][0]["path"]]
    numbers = [float(n) for n in re.findall(r"-?\d*\.?\d+", text)]
    points = np.cumsum(np.array(numbers[::2]) + 1j * np.array(numbers[1::2]))
    assert gk.nearest(spline, points)[1].max() < 8e-5 * size
    off = gk.nearest(spline, (points[1:] + points[:-1]) / 2)[1].max()
    assert 4e-5 * abs(high - low) < off < 2.3e-4 * abs(high - low)


def test_a_huge_value_of_a_table_rounds_no_other():
    scene = turning()
    values = np.array([1e17, -133.3333333, 1.23456789e-5, 2e30, np.nan, 1e-9, 0.0, 41.0987654321, -3e-3])
    table = gk.Table((scene.table.columns[0], gk.Column("force", "N", "of a spring", values)))
    data = json.loads(island(dataclasses.replace(scene, table=table, plots=()), "a"))
    row = unpacked(data["series"][data["columns"][1]["row"]], 9)
    assert row == pytest.approx(values, rel=1e-7, abs=1e-9, nan_ok=True)


def test_a_long_table_is_thinned_and_keeps_its_ends():
    kept = kept_frames(50_000)
    assert len(kept) == MOST_FRAMES and kept[0] == 0 and kept[-1] == 49_999 and len(np.unique(kept)) == len(kept)
    assert list(kept_frames(5)) == [0, 1, 2, 3, 4]
    assert json.loads(island(turning(frames=5000), "a"))["frames"] == MOST_FRAMES


def test_another_scene_beside_it_is_on_the_same_drive():
    scene = turning()
    with pytest.raises(gk.DesignError, match="found 9 rows, but 5 frames of the other mode"):
        dataclasses.replace(scene, others={"mode": turning(frames=5)})
    data = json.loads(island(dataclasses.replace(scene, others={"other": scene}), "a"))
    # The same rows and outlines, told once.
    assert data["scenes"][1] | {"label": ""} == data["scenes"][0]


def test_what_is_nan_or_infinite_is_left_out_of_the_data():
    scene = turning()
    column = scene.table.columns[1]
    odd = gk.Column("height", "mm", "odd", np.where(column.values > 1, np.inf, np.where(column.values < -1, np.nan, 0)))
    data = json.loads(island(dataclasses.replace(scene, table=gk.Table((scene.table.columns[0], odd))), "a"))
    assert np.isfinite(unpacked(data["series"][data["columns"][1]["row"]], 9)).sum() == 3


def test_the_writer_is_in_the_table_under_its_own_name():
    assert WRITERS["page"].needs == "scene" and WRITERS["page"].tail == ".html"
    assert list(write(job_of(turning()))) == ["page.html"]


def test_the_plot_library_keeps_its_licence_beside_it():
    folder = Path(gk.__file__).parent / "web" / "uplot"
    assert "MIT" in (folder / "LICENSE").read_text() and "v1.6.32" in (folder / "uPlot.iife.min.js").read_text()[:100]
    assert b"uPlot (v1.6.32)" in page(job_of(turning()))


def test_what_is_known_besides_is_told_in_words_sizes_and_tables():
    """Rivals of what was found are told by what sets them apart; nothing of it is markup."""
    found = {"ground": 10.0, "crank": 2.5, "origin_mm": [0.0, 0.0]}
    held = {
        "family": {"free_angle_deg": [0.0, 45.0]},
        "found": found,
        "ranked": [found, {**found, "crank": 3.0}],
        "segments": [{"peak": 1.0, "units": "mm"}, {"peak": 2.0, "units": "mm"}],
        "measures_mm": {"first_<b>": {"span": {"teeth": 3, "measure": 15.4}}, "second": {"span": {"teeth": 4}}},
        "none": {"defects": []},
        "empty": [],
        "stack": {"layers": [["ground"]], "pins": [{"name": "a"}]},
    }
    told = notes(held)
    tables = [re.findall(r"<t[hd]\b[^>]*>(.*?)</t[hd]>", table) for table in told.split("<h3>")[1:]]
    assert [title.split("</h3>")[0] for title in told.split("<h3>")[1:]] == [
        "Family",
        "Found",
        "Ranked",
        "Segments",
        "Measures, mm",
    ]
    assert "<dt>Free angle, °</dt><dd>0, 45</dd>" in told and "<dt>Origin, mm</dt><dd>0, 0</dd>" in told
    assert tables[2] == ["Crank", "2.5", "3"]
    assert tables[3] == ["Peak", "Units", "1", "mm", "2", "mm"]
    assert tables[4] == ["Name", "Span, teeth", "Span, measure", "first &lt;b&gt;", "3", "15.4", "second", "4", ""]
    assert notes({"stack": held["stack"], "found": {}}) == ""


def test_values_stand_by_their_units_as_people_write_them():
    told = [
        with_unit(40.25, "deg"),
        with_unit(-3, "mm"),
        with_unit(0.5, ""),
        with_unit(12345.6, "N"),
        with_unit(np.nan, "mm"),
    ]
    assert told == ["40.25°", "−3 mm", "0.5", "12,346 N", "none mm"]
