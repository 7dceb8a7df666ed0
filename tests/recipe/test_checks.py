"""Checks of recipes on a design just inside their limit and on one just outside, as worked out by hand or by table."""

import numpy as np
import pytest

from tests.texts import parse

FOUR_BAR = 'kind = "four-bar"\n[linkage]\nground = {}\ncrank = 30\ncoupler = 90\nrocker = 70\n'
# Where crank and ground line up, the pins of coupler and rocker are this far apart at 40 deg and at 5 deg.
AT_40, AT_5 = (np.sqrt(90**2 + 70**2 - 2 * 90 * 70 * np.cos(np.radians(deg))) for deg in (40, 5))
PLANETARY = 'kind = "planetary"\n[gears]\nplanets = 6\nsun = {{teeth = 24, module = 2}}\nplanet = {{teeth = 18, module = 2, addendum = {}}}\n'
PLANETARY += "ring = {{teeth = 60, module = 2}}\n"
POLYGONS = """kind = "polygons"
position = 0
[linkage]
driver = "crank"
[linkage.bodies]
ground = {{ O = [0, 0], C = [{}, 0] }}
crank = {{ O = [0, 0], A = [30, 0] }}
coupler = {{ A = [0, 0], B = [90, 0] }}
rocker = {{ C = [0, 0], B = [70, 0] }}
"""
SPUR = 'kind = "spur-gear"\ngear = {{teeth = 20, module = 2}}\nstock = {{bore = {}}}\n'
RING = 'kind = "ring-gear"\ngear = {{teeth = 60, module = 2}}\nstock = {{rim = {}}}\n'
PAIR = 'kind = "gear-pair"\nfirst = {{teeth = 20, module = 2}}\nsecond = {{teeth = 30, module = 2, addendum = {}}}\n'
RACK = (
    'kind = "rack-and-pinion"\npinion = {{teeth = 20, module = 2, addendum = {}}}\nrack = {{teeth = 12, module = 2}}\n'
)

# recipe with a place for a number, check, number at which it is just met, value there, which way is worse, unit
LIMITS = [
    (FOUR_BAR, "least transmission angle", 30 + AT_40, 40, -1, "deg"),
    (FOUR_BAR.format(100) + "[stock]\nthickness = {}\n", "pin hole to thickness", 8.4, 0.5, 1, ""),
    (SPUR, "rim under the teeth", 31, 1, 1, "modules"),
    (RING, "rim outside the teeth", 2, 1, -1, "modules"),
    (PAIR, "clearance of tips from roots", 1.15, 0.1, 1, "modules"),
    (RACK, "clearance of tips from roots", 1.15, 0.1, 1, "modules"),
    (PLANETARY, "room between planets", 1.25, 0.5, 1, "modules"),
    (POLYGONS, "transmission angle here", 30 + AT_5, 5, -1, "deg"),
]  # fmt: skip


def checks(text):
    recipe = parse(text)
    return {check.name: check for check in recipe.design_checks}


def test_a_check_turns_at_its_limit():
    for text, name, edge, limit, worse, unit in LIMITS:
        for step in (-1e-4, 1e-4):
            check = checks(text.format(edge * (1 + step)))[name]
            assert (check.passed, check.unit) == (step * worse < 0, unit)
            assert check.value == pytest.approx(limit, rel=1e-2) and check.limit == limit


CAM = """kind = "disk-cam"
[cam]
base_radius = {}
follower = {{kind = "{}", {}}}
program = [{{kind = "{}", law = "cycloidal", rise = {}, end_deg = 150}},
           {{kind = "{}", law = "cycloidal", end_deg = 360}}]
[drive]
step_deg = 0.1
"""
STRAIGHT, ARM = "translating-roller", "oscillating-roller"


def table(text):
    recipe = parse(text)
    return {column.id: np.asarray(column.values) for column in recipe.table.columns}


@pytest.mark.parametrize(
    ("sizes", "column", "name", "limit", "unit"),
    [("roller_radius = 5", "pitch_curvature", "least pitch radius to roller radius", 7.5, ""),
     ("roller_radius = 0", "profile_curvature", "least convex radius of the profile", 1, "mm")],
)  # fmt: skip
def test_checks_of_sharp_cams_agree_with_the_table(sizes, column, name, limit, unit):
    seen = set()
    for radius in (0.6, 2, 5):
        text = CAM.format(radius, STRAIGHT, sizes, "rise", 2, "return")
        found = checks(text)
        if name in found:
            least = 1 / table(text)[column].max()
            assert found[name].value == pytest.approx(least / (5 if unit == "" else 1), rel=1e-3)
            assert found[name].limit == (1.5 if unit == "" else 1)
            assert found[name].passed == (least >= limit) and found[name].unit == unit
            seen.add((found[name].passed, round(float(least), 2)))
    assert {passed for passed, _ in seen} == {True, False}, seen


@pytest.mark.parametrize("of", ["turn", "stroke"])
def test_unreached_input_range_is_reported_as_a_share(of):
    """A crank of 80 on a ground of 100 before links of 60 and 60; a slide as far as crank and rod reach."""
    if of == "turn":
        text = FOUR_BAR.format(100).replace("30", "80").replace("90", "60").replace("70", "60")
        share = np.degrees(np.arccos((100**2 + 80**2 - 120**2) / (2 * 100 * 80))) / 180
        body, advice = "crank", "give a smaller range of the driver"
    else:
        text = 'kind = "slider-crank"\nlinkage = {crank = 30, coupler = 90, driver = "slider"}\n'
        text += "stroke = {start = 70, end = 130, step = 0.1}\n"
        share, body, advice = 50 / 60, "slider", "give a shorter stroke"
    check = checks(text)[f"share of the {body}'s {of} reached"]
    assert check.value == pytest.approx(100 * share, abs=0.3) and check.limit == 100 and not check.passed
    assert check.advice.endswith(advice)
