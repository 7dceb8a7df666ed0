"""Every table of a page has as many cells in each row as heads, whatever is known; notebooks show what recipes do."""

from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

import geomkin as gk

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
