"""Tables of a page read back: verdicts with what to do, parts with their sizes, sheets, notes of every form."""

import shlex
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest

import geomkin as gk
from geomkin.export.job import Job, StaticSource
from geomkin.model.check import Check
from geomkin.model.part import Part
from geomkin.model.scene import Scene, SceneBody
from geomkin.model.table import Column, Table
from geomkin.page import sections
from geomkin.plane.curve import Moved
from geomkin.plane.vec import Pose
from tests.export.test_film import FRAMES, scene_of

ONE = np.ones(FRAMES, dtype=complex)


class Rows(HTMLParser):
    """The words of each cell of each row, pictures left out."""

    def __init__(self, text):
        super().__init__()
        self.rows, self.kept = [], False
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.rows[-1].append("")
            self.kept = True

    def handle_endtag(self, tag):
        self.kept = self.kept and tag not in ("td", "th")

    def handle_data(self, data):
        if self.kept:
            self.rows[-1][-1] += data


def rows_of(told):
    return Rows(told).rows[1:]


def job_of(parts=(), scene=None, **more):
    scene = scene or scene_of(bodies=[SceneBody("a", tuple(parts), ONE, ONE)])
    own = {key: more.pop(key) for key in ("checks", "walls", "bought", "steps", "notes") if key in more}
    return Job("a", StaticSource(tuple(parts), scene.table, scene, **own), 0.01, **more)


def column(unit, *values):
    table = Table((
        Column("angle", "deg", "of the driver", 30.0 * np.arange(len(values))),
        Column("gap", unit, "between plates", np.array(values)),
    ))  # fmt: skip
    return Scene(table, np.arange(float(len(values))), np.ones(len(values), dtype=bool), ())


def test_a_check_says_what_to_do_where_it_fails_and_shows_where():
    held = (
        Check("gap", "gap", 1.0, "at least", 0.5, "mm", "make it wider", "gap", 30.0),
        Check("slot", "slot", 1.0, "at least", 2.0, "mm", "make it wider"),
        Check("other", "other", 1.0, "at most", 0.5, "mm"),
    )
    rows = rows_of(sections.checks(job_of(scene=column("mm", 3.0, 1.0, 2.0), checks=held)))
    assert rows == [
        ["✗ fails", "Slot", "1 mm", "at least 2 mm", "make it wider"],
        ["✗ fails", "Other", "1 mm", "at most 0.5 mm", "see the limit"],
        ["✓ holds", "Gap", "1 mm show at 30°", "at least 0.5 mm", "fine"],
    ]
    assert sections.checks(job_of()) == ""


PLATE = gk.plane.Polyline(500 - 70j + np.array([0, 40, 40 + 25j, 25j]))
HOLES = (gk.plane.Circle(510 - 60j, 2.0), gk.plane.Polyline(520 - 60j + np.array([0, 5, 5 + 4j, 4j])))


def test_parts_are_told_with_their_sizes_wherever_they_lie():
    one = Part("one", PLATE, HOLES, 3.0, count=2)
    two = Part("two", Moved(gk.plane.rounded_hull([0, 1234j], 10.0), Pose(-7e3 + 2j)), (), 0.5)
    dot = Part("dot", gk.plane.Circle(0j, 0.1), (), 3.0)
    told = sections.parts(job_of([one, two, dot], walls={"one": 1.25}))
    length, area = 130 + 4 * np.pi + 18, 1000 - 4 * np.pi - 20
    long, wide = 2 * 1234 + 20 * np.pi, 20 * 1234 + 100 * np.pi
    assert rows_of(told) == [
        ["", "one", "2", "40 × 25", "3", f"{area:.4g}", f"{length:.4g}", "1.25"],
        ["", "two", "1", "20 × 1254", "0.5", f"{wide:,.0f}", f"{long:.4g}"],
        ["", "dot", "1", "0.2 × 0.2", "3", "0.03142", "0.6283"],
    ]
    assert "Thinnest wall" in told and "Sheet" not in told
    bare = sections.parts(job_of([one]))
    assert "Thinnest wall" not in bare and "more" not in bare
    assert sections.parts(job_of()) == ""


def test_of_many_parts_so_many_are_told(monkeypatch):
    monkeypatch.setattr(sections, "MOST_ROWS", 3)
    many = [Part(f"p{k}", PLATE, (), 3.0) for k in range(5)]
    for count, more in ((3, ""), (4, "And 1 more."), (5, "And 2 more.")):
        told = sections.parts(job_of(many[:count]))
        assert len(rows_of(told)) == 3 and told.count("more.") == bool(more) and more in told


def test_sheets_are_told_with_how_full_they_are():
    part = Part("plate", PLATE, (), 3.0)
    job = job_of([part], about="A plate.")
    assert sections.parts(job).endswith("<p>Sheet: 50 × 35 mm, 57 % filled.</p></section>")
    two = job_of([part, replace(part, name="thick", thickness=5.0)], about="Plates.", sheet=(100.0, 50.0))
    assert "<p>2 sheets: 100 × 50 mm, 20 % filled; 100 × 50 mm, 20 % filled.</p>" in sections.parts(two)


def test_letters_are_told_where_any_part_has_some():
    bought, hole = (gk.model.Bought("pin", 1, ("A",)),), (gk.plane.Circle(505 - 60j, 2.0),)
    hole = (*hole, gk.plane.Circle(530 - 60j, 2.0))
    parts = [Part("bare", PLATE, (), 3.0), Part("holed", PLATE, hole, 3.0, hole_names=("A", ""))]
    told = sections.joined(job_of(parts, bought=bought, steps=("Lay it down.",)))
    assert "Letters are at the holes. Bottom up:" in told


@pytest.mark.parametrize(
    ("value", "said"),
    [
        ([1, 2, 3, 4, 5, 6.5], "1, 2, 3, 4, 5, 6.5"),
        ([1, 2, 3, 4, 5, 6, 7], ""),
        ([1, "two"], ""),
        ([[1, 2.5]], "1 to 2.5"),
        ([[1, 2], [3, 4], [5, 6], [7, 8]], "1 to 2; 3 to 4; 5 to 6; 7 to 8"),
        ([[k, k + 1] for k in range(5)], ""),
        ([[1, 2, 3]], ""),
        ([[1, 2], 3], ""),
        ([[1, 2], "ab"], ""),
        ([[1, 2], [3, {}]], ""),
        ([[{}, {}]], ""),
        ([["left", "right"]], "left to right"),
        (None, ""),
        (True, "yes"),
        ("word", "word"),
    ],
)
def test_what_takes_some_numbers_is_said_in_a_line(value, said):
    told = sections.notes({"sizes_mm": value})
    assert told == (
        f'<section id="notes"><h2>About it</h2><dl><dt>Sizes, mm</dt><dd>{said}</dd></dl></section>' if said else ""
    )


def test_alike_things_are_a_table_and_what_differs_from_the_one_found_has_a_column():
    rivals = [{"crank": 10.0, "angle_deg": 3, "way": "open"}, {"crank": 10.0, "angle_deg": 4}]
    found = {"crank": 10.0, "angle_deg": 3}
    told = sections.notes({"rivals": rivals, "found": found})
    heads = [head for head in ("Crank", "Angle, °", "Way") if f'<th scope="col">{head}</th>' in told]
    assert heads == ["Angle, °", "Way"] and rows_of(told) == [["3", "open"], ["4", ""]]
    # One alone is told whole, and so are those that nothing was found beside.
    assert rows_of(sections.notes({"rivals": rivals[:1], "found": found})) == [["10", "3", "open"]]
    assert rows_of(sections.notes({"rivals": rivals})) == [["10", "3", "open"], ["10", "4", ""]]
    # By name, each with its own; what holds words beside things is no table.
    assert rows_of(sections.notes({"gears": {"first_one": {"teeth": 9}, "second": {"teeth": 11}}})) == [
        ["first one", "9"],
        ["second", "11"],
    ]
    mixed = sections.notes({"gears": {"first": {"teeth": 9}, "play_mm": 0.1}})
    assert "<table>" not in mixed and "<dt>First, teeth</dt><dd>9</dd>" in mixed
    assert sections.notes({"odd": [{"a": 1}, 2]}) == sections.notes({"odd": {"a": None, "b": {"c": None}}}) == ""


@pytest.mark.parametrize("name", ["four-bar", "a.b", "my cam", "it's; rm", "$HOME", "ä車"])
def test_the_command_that_makes_it_again_is_one_word_of_a_shell(name):
    job = replace(job_of(), name=name, recipe=lambda: 'kind = "four-bar"\n')
    told = sections.recipe(job)
    command = told.split("<pre><code>")[1].split("</code>")[0]
    for sign, code in (("'", "&#x27;"), ('"', "&quot;"), ("&", "&amp;")):
        command = command.replace(code, sign)
    assert shlex.split(command) == ["geomkin", "run", f"{name}.toml"]
    assert ("'" in command) == (name not in ("four-bar", "a.b", "ä車"))


@pytest.mark.parametrize(
    ("value", "told"),
    [(9999.4, "9999"), (1e4, "10,000"), (-123456.0, "−123,456"), (9999999.0, "9,999,999"), (1.25e7, "1.25e+07"), (-1e-9, "−1e−09"), (-0.0, "0"), (np.nan, "none")],
)  # fmt: skip
def test_numbers_have_four_digits_or_are_whole(value, told):
    assert sections.number(value) == told
