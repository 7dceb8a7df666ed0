"""Printed pins: their outline measured by shapely, their legs bent by numbers, and the mechanisms that they join."""

import re
from collections import Counter
from math import hypot

import numpy as np
import pytest
from shapely.geometry import LineString, Polygon, box

import geomkin as gk
from geomkin.build import check_recipe
from geomkin.making.fasteners import SnapPin
from geomkin.plane.flatten import flatten
from geomkin.plane.measure import area
from geomkin.plane.vec import xy

PRINTING = {"clearance": 0.3, "pins": "snap"}
BAR = {
    "kind": "four-bar",
    "linkage": {"ground": 100, "crank": 30, "coupler": 90, "rocker": 70},
    "stock": {"pin_diameter": 5, "material": "PLA"},
    "drive": {"step_deg": 5},
    "printing": PRINTING,
}
GEARS = {
    "kind": "gear-pair",
    "first": {"teeth": 12, "module": 3, "profile_shift": 0.3},
    "second": {"teeth": 24, "module": 3},
    "first_stock": {"bore": 5},
    "second_stock": {"bore": 5},
    "printing": PRINTING,
}
FLAT = {"kind": "oscillating-flat", "pivot_distance": 80, "face_offset": 6}
CAM = {
    "kind": "disk-cam",
    "cam": {
        "base_radius": 30,
        "follower": FLAT,
        "program": [
            {"kind": "rise", "law": "cycloidal", "rise_deg": 12, "end_deg": 180},
            {"kind": "return", "law": "cycloidal", "end_deg": 360},
        ],
    },
    "stock": {"bore": 5, "pivot_bore": 5},
    "base": {},
    "printing": PRINTING,
}


@pytest.mark.parametrize(
    "diameter, clearance, grip", [(3, 0.2, 6), (4, 0.3, 9), (5, 0.3, 6), (8, 0.0, 20), (12, 0.5, 30)]
)
def test_shape_of_a_pin(diameter, clearance, grip):
    pin = SnapPin(diameter, "snap", 0.2, clearance=clearance)
    shape, half = Polygon(xy(flatten(pin.outline(grip), 1e-4))), pin.thickness / 2
    assert shape.is_valid and shape.area * pin.thickness == pytest.approx(pin.volume(grip), rel=1e-3)
    end = grip + 0.2
    low, _, high, _ = shape.bounds

    def reach(x):
        """Distance of the edges of the solid from its axis at a distance from the head."""
        return hypot(shape.intersection(LineString([(x, 0), (x, 2 * diameter)])).bounds[3], half)

    # The shank fills the circle of the pin over all plates and the play; head and barbs do not pass the hole.
    assert reach(grip / 2) == pytest.approx(diameter / 2) and reach(end - 1e-3) == pytest.approx(diameter / 2)
    assert min(reach(-0.1), reach(end + 0.01)) > (diameter + clearance) / 2 + 0.1 * diameter
    assert max(2 * reach(-0.1), 2 * reach(end + 0.01)) <= pin.across + 1e-9
    assert (-low, high - end) == pytest.approx([size - pin.play for size in pin.ends(grip)])
    # Legs moved inwards until they meet pass the hole, all of them.
    slit = (
        box(end - 0.1, -diameter, end, diameter)
        .difference(shape)
        .intersection(box(end - 0.1, -diameter / 4, end, diameter / 4))
    )
    inwards = (slit.bounds[3] - slit.bounds[1]) / 2
    legs = np.array([z for z in shape.exterior.coords if z[0] >= end and z[1] > 0])
    assert np.hypot(legs[:, 1] - inwards, half).max() == pytest.approx((diameter + clearance) / 2, abs=1e-3)
    assert (legs[:, 1] - inwards).min() >= -1e-3


def test_strain_is_that_of_a_bent_leg():
    """The beam's curvature integrated twice, for the force that bends its end by the deflection."""
    pin, grip = SnapPin(5, "snap", 0.2, clearance=0.3), 6.0
    shape = Polygon(xy(flatten(pin.outline(grip), 1e-4)))
    holes = box(0, -1, grip, 1).difference(shape)
    length, slit = grip + 0.2 - (holes.bounds[3] - holes.bounds[1]) / 2, holes.bounds[3]
    thick = shape.bounds[3] and pin.diameter * np.sqrt(3) / 4 - slit
    x = np.linspace(0, length, 20_001)
    curvature = length - x
    slope = np.concatenate([[0], np.cumsum((curvature[1:] + curvature[:-1]) / 2 * np.diff(x))])
    bent = ((slope[1:] + slope[:-1]) / 2 * np.diff(x)).sum()
    assert pin.strain(grip) == pytest.approx(slit / bent * curvature[0] * thick / 2, rel=2e-3)


def test_pins_of_a_linkage_reach_through_their_plates():
    recipe = gk.load(BAR)
    stack = recipe.made.stack
    pins = {part.name: part for part in recipe.parts if part.name.startswith("pin_")}
    assert sum(part.count for part in pins.values()) == len(stack.pins) == 4
    lengths = Counter(round(pin.length, 6) for pin in stack.pins)
    assert sorted(lengths.values()) == sorted(part.count for part in pins.values())
    for part in pins.values():
        shape = Polygon(xy(flatten(part.outline, 1e-3)))
        assert shape.bounds[2] > max(lengths) and part.material == recipe.stock.material
    assert recipe.bought == () and not stack.collisions
    # Heads and barbs take layers of their own, as nuts do.
    grips = [stack.fastener.ends(pin.length) for pin in stack.pins]
    assert max(stack.layers.values()) * 3 > 2 * 3 + max(max(ends) for ends in grips)
    assert all(name in " ".join(recipe.steps) for name in pins)


def test_masses_have_pins_of_the_material():
    recipe = gk.load(BAR)
    plates = sum(part.count * part.mass.mass for part in recipe.parts)
    assert sum(mass.mass for mass in recipe.body_masses.values()) == pytest.approx(plates, rel=1e-6)


@pytest.mark.parametrize(
    "table, count",
    [(GEARS, 2), ({**GEARS, "base": {}}, 2), ({**GEARS, "helix_angle_deg": 20}, 2), (CAM, 2)],
    ids=["bar", "base", "helical", "cam"],
)
def test_gears_and_cams_turn_on_pins(table, count):
    recipe = gk.load(table)
    bought = " ".join(item.name for item in recipe.bought)
    pins = [part for part in recipe.parts if part.name.startswith("pin_")]
    assert sum(part.count for part in pins) == count
    assert "shaft" not in bought and "collar" not in bought
    grip = 2 * recipe.parts[0].thickness
    for pin in pins:
        # Head, shank and tip: from the head's lower side at 0 through both plates.
        shape = Polygon(xy(flatten(pin.outline, 1e-3)))
        assert shape.bounds[0] < 0 and shape.bounds[2] > grip + 0.2
    (check,) = recipe.assembly.snap_checks
    assert 0 < check.value < 3


def test_short_pins_fail_their_check():
    thin = {**BAR, "stock": {"pin_diameter": 6, "thickness": 2}}
    (check,) = gk.load(thin).made.snap_checks
    assert not check.passed


@pytest.mark.parametrize(
    "table",
    [
        {"kind": "spur-gear", "gear": {"teeth": 24, "module": 2}, "printing": PRINTING},
        {"kind": "scotch-yoke", "linkage": {"crank": 25, "guide": 90}, "printing": PRINTING},
        {**BAR, "copies": [{"phase_deg": 180}]},
        {**BAR, "stock": {"fastener": "rod"}},
        {**BAR, "stock": {"pin_diameter": 2}},
        {**GEARS, "second_stock": {}},
        {**GEARS, "first_stock": {"bore": 8, "bore_form": "D"}},
        {**GEARS, "first_stock": {"bore": 10, "bore_form": "keyed"}},
        {**GEARS, "first_stock": {"bore": 8, "fit": "press"}},
        {**CAM, "base": None},
        {**CAM, "cam": {**CAM["cam"], "follower": {"kind": "oscillating-roller", "roller_radius": 6, "pivot_distance": 70, "arm_length": 55}}},
    ],
    ids=["kind", "slot", "copies", "rods", "thin", "no bore", "flat", "key", "press", "no base", "roller"],
)  # fmt: skip
def test_what_cannot_turn_on_printed_pins_is_refused_by_name(table):
    with pytest.raises(gk.RecipeError) as refused:
        check_recipe({key: value for key, value in table.items() if value is not None})
    assert [problem.key for problem in refused.value.problems] == ["printing.pins"]


def test_motors_keep_their_shafts():
    motor = {**GEARS, "first_stock": {"bore": 5, "bore_form": "D", "motor": "nema17"}, "base": {}}
    recipe = gk.load(motor)
    pins = [part for part in recipe.parts if part.name.startswith("pin_")]
    assert [part.count for part in pins] == [1] and area(pins[0].outline) > 0
    crank = gk.load({**BAR, "stock": {**BAR["stock"], "motor": "nema17", "thickness": 4}})
    assert sum(part.count for part in crank.parts if part.name.startswith("pin_")) == 3


@pytest.mark.parametrize("clearance", [0.05, 0.3, 0.8])
def test_the_advised_pins_have_legs_that_are_thick_enough(clearance):
    def bar(diameter):
        return BAR | {"stock": {"pin_diameter": diameter}, "printing": {"clearance": clearance, "pins": "snap"}}

    with pytest.raises(gk.RecipeError) as refused:
        gk.load(bar(1.5))
    (problem,) = refused.value.problems
    advised = float(re.search(r"at least ([\d.]+)", problem.remedy)[1])
    assert gk.load(bar(advised)).has_snap_pins
    with pytest.raises(gk.RecipeError):
        gk.load(bar(0.999 * advised))
