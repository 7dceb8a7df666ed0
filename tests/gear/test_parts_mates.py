"""Bores of a gear and the mate it shapes, each by its own name: read back from the drawings of their plates."""

import dataclasses
import tomllib

import ezdxf
import ezdxf.path
import numpy as np
import pytest
import shapely

import geomkin as gk
from tests.campaign import by_default
from tests.texts import template_of

STRAIGHT = """
kind = "straight-sided-gears"
gear = { teeth = 30, module = 2, flank_angle_deg = 20, addendum = 0.8, dedendum = 1.2 }
mate = { teeth = 40, addendum = 1.6 }
"""
LANTERN = """
kind = "lantern-gears"
pinion = { pins = 12, module = 4, pin_diameter = 5.5 }
mate = { teeth = 48, addendum = 7 }
"""
BOTH = """
[stock]
clearance = 0.1
interference = 0.08
bore = 5
bore_form = "D"
fit = "press"
mate_bore = 12
mate_bore_form = "keyed"
"""


def drawn(folder, part):
    """The outline's middle and polygons of the holes about it, as written."""
    gk.write([dataclasses.replace(part, count=1)], folder / "part.dxf", curves="arcs")
    found = {}
    for entity in ezdxf.readfile(folder / "part.dxf").modelspace():
        if entity.dxf.layer in ("CUT", "HOLE"):
            loop = shapely.Polygon([(p.x, p.y) for p in ezdxf.path.make_path(entity).flattening(1e-4)])
            found.setdefault(entity.dxf.layer, []).append(loop)
    return found["CUT"][0], found["HOLE"]


def across(hole):
    left, low, right, high = hole.bounds
    return right - left, high - low


@pytest.mark.parametrize("text", by_default([STRAIGHT, LANTERN], [STRAIGHT]))
def test_gear_and_mate_have_the_bores_that_their_keys_name(tmp_path, text):
    driver, mate = gk.load(text + BOTH).parts
    _, holes = drawn(tmp_path, driver)
    flat = min(holes, key=lambda hole: hole.area)
    # A D-shaft of 5 mm is 4.5 mm across its flat, wherever that faces; the hole is 0.08 mm narrower all round.
    box = np.array(flat.minimum_rotated_rectangle.exterior.coords)
    sides = np.sort(np.hypot(*np.diff(box, axis=0).T))[[0, -1]]
    assert sides == pytest.approx([4.42, 4.92], abs=2e-3)
    _, (keyed,) = drawn(tmp_path, mate)
    # The standard measures 13.8 mm over bore and keyway; the bore is 0.1 mm wider.
    assert across(keyed) == pytest.approx((12.1, 13.9), abs=2e-3)


@pytest.mark.parametrize("text", by_default([STRAIGHT, LANTERN], [LANTERN]))
def test_a_motor_turns_the_gear_on_a_plate_of_its_own_or_over_a_base(text):
    asked = text + '[stock]\nbore = 5\nbore_form = "D"\nmotor = "nema17"\nmate_bore = 10\n'
    plain, based = gk.load(asked), gk.load(asked + "[base]\n")
    assert [part.name for part in plain.parts][2:] == ["motor_plate"]
    motor, *others = plain.scene.bodies
    assert (motor.name, motor.layer) == ("motor", 0) and min(body.layer for body in others) >= 1
    base = based.parts[-1]
    assert sorted(round(2 * hole.radius, 6) for hole in base.holes) == [3.4] * 4 + [4.2] * 4 + [10.2, 22.2]
    assert [body.name for body in based.scene.bodies if body.name == "motor"] == []
    for recipe, screw in ((plain, "button head"), (based, "countersunk")):
        assert recipe.bought[0].name.startswith("motor NEMA 17, D-shaft 5 mm") and screw in recipe.bought[1].name


REFUSED = [
    ({"mate_bore": 7, "mate_bore_form": "D"}, "mate_bore", "mate_flat"),
    ({"mate_bore": 2, "mate_bore_form": "keyed"}, "mate_bore", "mate_keyway_width"),
    ({"mate_flat": 3}, "mate_flat", "mate_bore_form"),
    ({"mate_bore": 0, "mate_bore_form": "D"}, "mate_bore", "mate_bore_form"),
    ({"mate_bore": 0.1, "mate_fit": "press"}, "interference", "0.09 mm"),
    ({"bore": 7, "bore_form": "D"}, "bore", "flat"),
    ({"bore": 22, "motor": "nema17"}, "bore", "22 mm"),
]


def test_invalid_bores_are_refused_by_the_name_of_their_own_key():
    for sizes, field, remedy in REFUSED:
        for stock in (gk.gear.PairStock, gk.gear.LanternStock):
            with pytest.raises(gk.DesignError) as caught:
                stock(**sizes)
            assert caught.value.field == field and remedy in caught.value.remedy


@pytest.mark.parametrize(
    "kind", ["gear-pair", "rack-and-pinion", "planetary", "disk-cam", "lantern-gears", "ratchet", "cycloidal-drive"]
)
def test_a_base_has_the_mass_of_its_sheet(kind):
    table = tomllib.loads(template_of(kind))
    stocks = {"gear-pair": ("first_stock", "second_stock"), "planetary": ("sun_stock", "planet_stock", "ring_stock")}
    for key in stocks.get(kind, ("stock",)):
        bore = {} if key == "ring_stock" else {"bore": 5}
        table[key] = {**bore, **table.get(key, {}), "material": "birch-plywood"}
    (base,) = (part for part in gk.load({"base": {}, **table}).parts if part.name == "base")
    outline, *holes = (gk.flatten(curve, 1e-3) for curve in (base.outline, *base.holes))
    plate = shapely.Polygon(np.column_stack([outline.real, outline.imag]))
    area = plate.area - sum(shapely.Polygon(np.column_stack([hole.real, hole.imag])).area for hole in holes)
    assert float(base.mass.mass) == pytest.approx(680e-9 * area * base.thickness, rel=1e-3)
