"""Holes for shafts and pins: wider by the clearance, in every kind of part, and refused where nothing is left."""

import dataclasses

import numpy as np
import pytest

import geomkin as gk
from geomkin.gear.parts.gears import GearStock, gear_parts
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


def test_a_clearance_of_a_bore_that_is_none_makes_no_hole():
    assert not gear_parts(gk.SpurGear(24, 2), GearStock(bore=0, clearance=0.3))[0].holes


def test_a_keyway_keeps_its_width_and_its_depth_beyond_the_wider_bore():
    (tight,), (wide,) = (keyed_bore(20, c, 6, 3, 1 + 0j, 60, "stock") for c in (0, 0.5))
    (a, b), (c, d) = (loop.vertices[[0, 3]] for loop in (tight, wide))
    assert (abs(b.imag), abs(d.imag)) == (3, 3) and d.real - b.real == pytest.approx(0.25)
    assert abs(a) == pytest.approx(10) and abs(c) == pytest.approx(10.25)


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


@pytest.mark.parametrize("pins", [6, 40])
def test_the_clearance_at_which_pins_holes_meet_is_named(tmp_path, pins):
    """Neighbouring holes of a lantern's discs: less than named works, more is refused."""

    def made(clearance):
        (tmp_path / "r.toml").write_text(
            f'kind = "lantern-gears"\npinion = {{pins = {pins}, module = 4, pin_diameter = 5}}\n'
            f'mate = {{teeth = 60, addendum = 1.0}}\nstock = {{bore = 0, clearance = {clearance!r}}}\nfiles = {{write = ["csv"]}}\n'
        )
        return gk.make(tmp_path / "r.toml", tmp_path / "out")

    with pytest.raises(gk.RecipeError, match=r"stock\.clearance") as caught:
        made(12.0)
    named = float(str(caught.value).split("give less than ")[1].split(" ")[0])
    # The chord between two pins on a circle of 4 mm a pin's diameter, less a pin.
    assert named == pytest.approx(4 * pins * np.sin(np.pi / pins) - 5, rel=1e-3)
    assert made(named * (1 - 1e-3))
    with pytest.raises(gk.RecipeError, match=r"stock\.clearance"):
        made(named * (1 + 1e-3))


def test_where_there_is_no_shaft_or_screw_no_clearance_makes_a_hole():
    stocks = {"first_stock": {"bore": 8, "clearance": 0.3}, "second_stock": {"bore": 0, "clearance": 0.3}}
    teeth = {"first": {"teeth": 18, "module": 2}, "second": {"teeth": 30, "module": 2}}
    pair = {"kind": "gear-pair", **teeth, **stocks}
    recipe = gk.load(pair)
    assert [(part.name, len(part.holes)) for part in recipe.parts] == [("first", 1), ("second", 0)]
    assert not any(part.fits for part in recipe.parts[1:])
    # A base without screws ends its edge beyond the wheels, and has the holes of shafts alone.
    stocks["second_stock"]["bore"] = 6
    base = gk.load(pair | stocks | {"base": {"screw": 0, "clearance": 0.4, "edge": 5}}).parts[-1]
    z, (first, second) = gk.flatten(base.outline, 1e-5), base.holes
    assert (first.radius, second.radius) == pytest.approx((4.2, 3.2))
    tips = gk.SpurGear(18, 2).tip_radius, gk.SpurGear(30, 2).tip_radius
    assert (z.real.min(), z.real.max()) == pytest.approx((-tips[0] - 5, second.centre.real + tips[1] + 5), abs=1e-4)
    assert (z.imag.min(), z.imag.max()) == pytest.approx((-tips[1] - 5, tips[1] + 5), abs=1e-4)
