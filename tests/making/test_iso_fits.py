"""Fits of ISO 286: against values of the standard's tables, its formulas, and in parts, drawings and tolerances."""

import re

import numpy as np
import pytest

import geomkin as gk
from geomkin.making.bores import AbstractBored
from geomkin.model.part import GRADES, NARROW, NARROW_SHAFTS, RANGES, SHAFTS, fit_limits, limits

# Micrometres, by nominal size up to 3, 6, 10, 18, 30, 50, 80 and 120 mm: a handbook's table, typed in independently.
HANDBOOK = {
    "IT6": (6, 8, 9, 11, 13, 16, 19, 22),
    "IT7": (10, 12, 15, 18, 21, 25, 30, 35),
    "IT8": (14, 18, 22, 27, 33, 39, 46, 54),
    "g6 upper": (-2, -4, -5, -6, -7, -9, -10, -12),
    "k6 lower": (0, 1, 1, 1, 2, 2, 2, 3),
    "n6 lower": (4, 8, 10, 12, 15, 17, 20, 23),
    "p6 lower": (6, 12, 15, 18, 22, 26, 32, 37),
}
# Lower and upper deviations, micrometres, as ISO 286-2 prints them for holes.
HOLES = {
    ("K7", 20): (-15, 6), ("M7", 20): (-21, 0), ("N7", 20): (-28, -7), ("P7", 20): (-35, -14), ("JS7", 20): (-10.5, 10.5),
    ("R7", 20): (-41, -20), ("S7", 20): (-48, -27), ("F8", 20): (20, 53), ("E9", 20): (40, 92), ("D10", 20): (65, 149),
    ("N9", 20): (-52, 0), ("P9", 20): (-74, -22), ("K6", 20): (-11, 2), ("H7", 3): (0, 10), ("N7", 3): (-14, -4),
    ("S7", 70): (-78, -48), ("G7", 500): (20, 83), ("M6", 300): (-41, -9), ("K7", 100): (-25, 10), ("P7", 100): (-59, -24),
}  # fmt: skip


@pytest.mark.parametrize("row", HANDBOOK)
def test_limits_are_those_of_a_handbook(row):
    kind, _, side = row.partition(" ")
    for size, (below, value) in zip(RANGES, zip((0, *RANGES), HANDBOOK[row])):
        for nominal in (size, below + 1e-9 if below else 0.5):
            low, high = limits(f"h{kind[2:]}" if kind.startswith("IT") else kind, nominal)
            found = high - low if not side else high if side == "upper" else low
            assert found == pytest.approx(value / 1000, abs=1e-9)


@pytest.mark.parametrize(("tolerance", "nominal"), HOLES)
def test_limits_of_holes_are_those_of_the_standard(tolerance, nominal):
    assert np.multiply(limits(tolerance, nominal), 1000) == pytest.approx(HOLES[tolerance, nominal], abs=1e-6)


def test_tables_follow_the_formulas_of_the_standard():
    """i = 0.45 D^(1/3) + 0.001 D at the geometric mean of a range; the standard rounds to whole micrometres."""
    mean = np.sqrt(np.array(RANGES) * np.array([1, *RANGES[:-1]]))
    i = 0.45 * np.cbrt(mean) + 0.001 * mean
    for grade, factor in {6: 10, 7: 16, 8: 25, 9: 40, 10: 64, 11: 100}.items():
        assert np.abs(GRADES[grade] / (factor * i) - 1)[1:].max() < 0.093
    for letter, expected in {
        "d": 16 * mean**0.44,
        "e": 11 * mean**0.41,
        "f": 5.5 * mean**0.41,
        "g": 2.5 * mean**0.34,
    }.items():
        assert np.abs(np.array(SHAFTS[letter]) - expected)[1:].max() < 5
    assert np.abs(SHAFTS["n"] - 5 * mean**0.34)[1:].max() < 1.1
    assert np.abs(np.array(SHAFTS["m"]) - (np.array(GRADES[7]) - np.array(GRADES[6])))[1:].max() <= 2.8
    for letter in NARROW_SHAFTS:
        assert (np.diff(NARROW_SHAFTS[letter]) > 0).all() and len(NARROW_SHAFTS[letter]) == len(NARROW)


def test_clearance_transition_and_press_fits():
    assert (fit_limits("H7/g6", 25).least_clearance, fit_limits("H7/g6", 25).largest_clearance) == (0.007, 0.041)
    assert not fit_limits("H7/g6", 25).is_press and fit_limits("H7/p6", 25).is_press
    assert fit_limits("H7/p6", 25).largest_clearance == -0.001


@pytest.mark.parametrize("fit", ["H7/p6", "N7/h6"])
def test_a_bore_is_drawn_in_the_middle_of_its_limits(fit):
    stock = AbstractBored(bore=20, fit=fit)
    (hole,) = stock.hole(1 + 0j, 40.0, "stock")
    low, high = limits(fit[:2], 20)
    assert 2 * hole.radius == pytest.approx(20 + (low + high) / 2) and stock.is_pressed
    assert AbstractBored(bore=20, bore_tolerance="H7").play == pytest.approx(0.0105)


def gear(units="mm", **stock):
    length = 1.0 if units == "mm" else 0.04
    data = {"kind": "spur-gear", "units": units, "gear": {"teeth": 24, "module": 2 * length}}
    return gk.load({**data, "stock": {"bore": 10 * length, "thickness": 6 * length, **stock}})


@pytest.mark.parametrize(("units", "scale"), [("mm", 1.0), ("in", 25.4)])
def test_drawing_and_summary_state_the_limits(units, scale, tmp_path):
    recipe = gear(units, fit="H7/g6")
    gk.write(recipe, tmp_path / "a-sheet.svg")
    text = (tmp_path / "a-sheet.svg").read_text()
    (stated,) = re.findall(r"H7 \(([-+.\d]+)/0\).*g6 \(([-+.\d]+)/([-+.\d]+)\).*([-+.\d]+) to ([-+.\d]+)", text)
    exact = fit_limits("H7/g6", recipe.stock.bore)
    expected = (exact.hole[1], exact.shaft[1], exact.shaft[0])
    assert [float(value) for value in stated[:3]] == pytest.approx(np.divide(expected, scale), abs=6e-6)
    made = gk.make(recipe, tmp_path, only=["bom"])
    summary = next(path for path in made.files if path.name == "summary.json").read_text()
    assert '"fit": "H7/g6"' in summary and f'"largest_clearance_{units}"' in summary


def test_tolerances_take_the_largest_clearance_of_the_pins():
    data = {
        "kind": "four-bar",
        "linkage": {"ground": 100, "crank": 30, "coupler": 90, "rocker": 70},
        "drive": {"step_deg": 10},
    }

    def deviation(**given):
        tolerances = {"of": "rocker_angle", "linkages": 0, **given.pop("tolerances", {})}
        return gk.load({**data, "stock": given, "tolerances": tolerances}).table["rocker_angle_worst_case"]

    by_fit = deviation(pin_fit="H7/g6")
    assert by_fit == pytest.approx(
        deviation(tolerances={"clearance": fit_limits("H7/g6", 4).largest_clearance}), rel=1e-12
    )
    with pytest.raises(gk.DesignError) as caught:
        gk.linkage.LinkStock(pin_fit="H7/p6")
    assert caught.value.field == "pin_fit"
    assert gk.linkage.LinkStock(pin_fit="H7/g6").hole_diameter == pytest.approx(4.006)


def test_rods_are_bought_by_the_class_of_their_fit():
    stock = {"pin_fit": "H7/g6", "fastener": "rod"}
    data = {"kind": "four-bar", "linkage": {"ground": 100, "crank": 30, "coupler": 90, "rocker": 70}}
    recipe = gk.load(data | {"stock": stock, "tolerances": {"of": "rocker_angle", "limit": 0.01}})
    rods = [item.name for item in recipe.bought if item.name.startswith("rod")]
    assert rods and all(" g6," in rod for rod in rods)
    # What makes the clearance smaller is the fit.
    (check,) = [check for check in recipe.checks if check.id == "deviation"]
    assert "pin_fit" in check.advice


def test_spacers_and_attachments_keep_the_clearance():
    hub = {"body": "coupler", "at": [50, 30], "name": "hub", "bolts": 3, "bolt_circle": 17}
    stock = {"pin_diameter": "M4", "pin_fit": "H7/g6", "clearance": 0.3, "attachments": [hub]}
    linkage = {"crank": 30, "coupler": 100}
    recipe = gk.load({"kind": "slider-crank", "linkage": linkage, "stock": stock})
    fits = {(fit.diameter, fit.iso_fit, round(fit.play, 9)) for part in recipe.parts for fit in part.fits}
    assert fits == {(4.0, "H7/g6", 0.006), (4.0, "", 0.3), (3.0, "", 0.3)}
    assert recipe.stock.clearance == 0.3
    # A thread has no class: the pins are rods, and a screw is refused.
    assert recipe.stock.fastener_used.form == "rod"
    with pytest.raises(gk.RecipeError, match="stock.pin_fit"):
        gk.load({"kind": "slider-crank", "linkage": linkage, "stock": {**stock, "fastener": "screw"}})


def test_a_clearance_is_assumed_if_a_hole_has_it():
    assert "stock.clearance" not in gear(fit="H7/g6").assumed_fits
    # The pin of the roller has no class.
    dwell = {"kind": "dwell", "end_deg": 360}
    cam = {"base_radius": 30, "program": [dwell], "follower": {"kind": "translating-roller", "roller_radius": 8}}
    stock = {"bore": 12, "fit": "H7/k6"}
    assert "stock.clearance" in gk.load({"kind": "disk-cam", "cam": cam, "stock": stock}).assumed_fits
    assert (
        "stock.clearance"
        not in gk.load({"kind": "disk-cam", "cam": cam, "stock": {**stock, "roller_bore": 0}}).assumed_fits
    )


@pytest.mark.parametrize(
    ("stock", "key"),
    [
        ({"fit": "h7/g6"}, "stock.fit"),
        ({"fit": "H7"}, "stock.fit"),
        ({"fit": "H4/g6"}, "stock.fit"),
        ({"bore_tolerance": "H7/g6"}, "stock.bore_tolerance"),
        ({"bore_tolerance": "H7", "fit": "press"}, "stock.bore_tolerance"),
    ],
)
def test_wrong_classes_are_refused_by_key(stock, key):
    with pytest.raises(gk.RecipeError) as caught:
        gear(**stock)
    assert caught.value.problems[0].key == key


def test_sizes_beyond_the_standard_are_refused():
    for nominal in (0.0, 501.0):
        with pytest.raises(gk.DesignError):
            limits("H7", nominal)
