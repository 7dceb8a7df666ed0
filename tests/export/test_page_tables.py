"""Every table of a page has as many cells in each row as heads, whatever is known; notebooks show what recipes do."""

from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

import geomkin as gk
from geomkin.export.job import Job, StaticSource
from geomkin.model.part import Bought
from geomkin.model.scene import Choice, Scene
from geomkin.model.table import Column, Table
from geomkin.page.sections import choice, joined, notes

RECIPES = Path(__file__).parents[2] / "recipes"


class Tables(HTMLParser):
    """Of each table the cells of each row, a wide one counted as many."""

    def __init__(self, text):
        super().__init__()
        self.tables = []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        if tag == "table":
            self.tables.append([])
        elif tag == "tr":
            self.tables[-1].append(0)
        elif tag in ("td", "th"):
            self.tables[-1][-1] += int(dict(attributes).get("colspan", 1))


PLATE = gk.Part("plate", gk.plane.Circle(0j, 20.0), (gk.plane.Circle(0j, 5.0),), 3.0)
SHOWN = {
    "a recipe": lambda: gk.load(RECIPES / "three-poses.toml"),
    "gears": lambda: gk.load(RECIPES / "gear-pair.toml"),
    "parts alone": lambda: [PLATE, replace(PLATE, name="other", count=3)],
    "a pair": lambda: gk.GearPair(gk.SpurGear(20, 2), gk.SpurGear(30, 2)),
    "a planetary set": lambda: gk.load(RECIPES / "planetary.toml").gears,
    "a motion": lambda: gk.move(gk.FourBar(100, 30, 90, 70), np.linspace(0, 6, 13)),
}


@pytest.mark.parametrize("name", SHOWN)
def test_rows_have_as_many_cells_as_heads(name):
    tables = Tables(gk.show(SHOWN[name]()).page.decode()).tables
    for table in tables:
        assert len(set(table)) == 1 and table[0] > 0, (name, table)
    assert tables


def test_a_planetary_set_is_shown_with_all_its_gears_and_their_names():
    shown = gk.show(SHOWN["a planetary set"]())
    page = shown.page.decode()
    assert shown.name == "PlanetarySet" and all(f'"name":"{name}"' in page for name in ("sun", "ring"))


def test_a_recipe_without_a_scene_is_shown_by_its_parts(monkeypatch):
    recipe = gk.load(RECIPES / "spur-gear.toml")
    monkeypatch.setattr(type(recipe), "scene", None)
    shown = gk.show(recipe)
    assert shown.name == "spur-gear" and '"name":"gear"' in shown.page.decode()


def test_a_linkage_that_is_nowhere_is_told_with_what_to_change():
    apart = gk.Linkage(
        {"ground": {"O": 0, "C": 500}, "crank": {"O": 0, "A": 20}, "rod": {"A": 0, "B": 30}, "arm": {"C": 0, "B": 40}},
        "crank",
    )
    with pytest.raises(gk.DesignError, match="it can be put together nowhere; change the sizes"):
        gk.show(apart)


def test_what_it_was_chosen_from_is_told_by_what_its_rows_go_by():
    columns = (
        Column("free_angle", "deg", "angle <b> of one pose", np.arange(3.0)),
        Column("gap", "mm", "or not", np.ones(3)),
    )
    table = Table((Column("angle", "deg", "of the driver", np.arange(2.0)),))
    scene = Scene(table, np.arange(2.0), np.ones(2, dtype=bool), ())
    assert choice(scene) == ""
    told = choice(replace(scene, choice=Choice(Table(columns), 1, ())))
    assert told.startswith(
        '<section id="choice"><h2>What it was chosen from</h2><p>All that do what is wanted, by the '
    )
    assert "by the angle &lt;b&gt; of one pose: the spot and the line are the one that is made.</p>" in told


def test_what_is_so_is_told_with_yes_and_what_is_not_with_no():
    told = notes({"closed": False, "works": True, "sizes_mm": [1, 2.5], "many": list(range(7)), "none": 0.0})
    assert "<dt>Closed</dt><dd>no</dd>" in told and "<dt>Works</dt><dd>yes</dd>" in told
    assert "<dt>Sizes, mm</dt><dd>1, 2.5</dd>" in told and "<dt>None</dt><dd>0</dd>" in told and "Many" not in told


def test_what_is_bought_is_told_with_its_order_where_there_is_one_and_with_letters_where_there_are_some():
    plate = gk.Part("plate", gk.plane.Circle(0j, 9.0), (gk.plane.Circle(0j, 2.0),), 3.0)
    bought = (Bought("pin", 2, ("A", "B")),)
    assert joined(Job("a", StaticSource((plate,)), 0.01)) == ""
    told = joined(Job("a", StaticSource((plate,), bought=bought), 0.01))
    assert "<h2>What is bought</h2>" in told and "<li>2 × pin: A B</li>" in told and "Bottom up" not in told
    for names in ((), ("A",)):
        part = replace(plate, hole_names=names)
        told = joined(Job("a", StaticSource((part,), bought=bought, steps=("Lay it down.", "Pin it.")), 0.01))
        assert "<h2>How it goes together</h2>" in told and "<ul><li>Lay it down.</li><li>Pin it.</li></ul>" in told
        assert ("Letters are at the holes. Bottom up:" in told) == bool(names)
