"""Holes for shafts and pins: wider by the clearance, in every kind of part, and refused where nothing is left."""

import dataclasses

import numpy as np
import pytest

import geomkin as gk
from geomkin.making.bores import bore, keyed_bore
from tests.texts import parse, template_of

PLAY = 0.4
KINDS = ["four-bar", "gear-pair", "rack-and-pinion", "planetary", "lantern-gears"]
# Followers on stems and arms.
GALLERY = ["flat-cam", "rocker-cam"]


def round_holes(recipe, clearance):
    """Diameters of the round holes of each part when all stock tables have that clearance, and every shaft a hole."""
    tables = {}
    for field in dataclasses.fields(recipe):
        table = getattr(recipe, field.name)
        if ("stock" in field.name or field.name == "base") and hasattr(table, "clearance"):
            bores = {"bore": 8.0} if getattr(table, "bore", None) == 0 else {}
            tables[field.name] = dataclasses.replace(table, clearance=clearance, **bores)
    assert tables
    recipe = dataclasses.replace(recipe, **tables)
    return {
        part.name: [2 * hole.radius for hole in part.holes if isinstance(hole, gk.plane.Circle)]
        for part in recipe.parts
    }


@pytest.mark.parametrize("name", KINDS + GALLERY)
def test_every_hole_for_a_shaft_or_pin_takes_the_clearance(name):
    recipe = parse(template_of(name)) if name in KINDS else gk.load(f"recipes/{name}.toml")
    tight, wide = (round_holes(recipe, clearance) for clearance in (0.0, PLAY))
    assert any(tight.values()) and set(tight) == set(wide)
    for part in tight:
        assert wide[part] == pytest.approx([d + PLAY for d in tight[part]], rel=1e-12), part


@pytest.mark.parametrize("clearance", [0.0, 0.5])
def test_the_bore_that_is_advised_works_and_a_little_more_does_not(clearance):
    with pytest.raises(gk.DesignError, match="stock.bore") as caught:
        bore(40, clearance, 30, "stock.bore")
    most = float(caught.value.remedy.split("less than ")[1].split()[0])
    (hole,) = bore(most - 1e-6, clearance, 30, "stock.bore")
    assert 2 * hole.radius == pytest.approx(30, abs=1e-5)
    with pytest.raises(gk.DesignError):
        bore(most, clearance, 30, "stock.bore")


def test_the_clearance_that_is_advised_works_and_a_little_more_does_not():
    with pytest.raises(gk.DesignError, match="stock.clearance") as caught:
        bore(29, 1.5, 30, "stock.roller_bore")
    most = float(caught.value.remedy.split("less than ")[1].split()[0])
    assert bore(29, most - 1e-6, 30, "stock.roller_bore") and "roller_bore" in caught.value.remedy
    with pytest.raises(gk.DesignError):
        bore(29, most, 30, "stock.roller_bore")


@pytest.mark.parametrize("size", [1e-3, 1e4])
def test_a_keyway_may_reach_as_far_as_the_part_and_no_farther(size):
    """The corner of the slot, 13 from the axis by 5-12-13, lies just within the part or just beyond it."""
    sizes = {"diameter": 18 * size, "clearance": 0.0, "width": 10 * size, "depth": 3 * size}
    (hole,) = keyed_bore(*sizes.values(), 1 + 0j, 26 * size * (1 + 1e-9), "stock")
    assert np.abs(hole.vertices).max() == pytest.approx(13 * size)
    with pytest.raises(gk.DesignError, match="keyway"):
        keyed_bore(*sizes.values(), 1 + 0j, 26 * size * (1 - 1e-9), "stock")
