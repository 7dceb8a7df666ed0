"""Straight parts of paths against brute force over very many frames, and against published linkages."""

import tomllib

import numpy as np
import pytest

import geomkin as gk
from geomkin.core.errors import RecipeError
from geomkin.recipe.load import from_table
from tests.gallery import RECIPES, recipe
from tests.recipe.test_inches import in_inches

NAMED = ["klann", "chebyshev", "hoecken", "peaucellier", "watt", "roberts", "evans", "parallel-gripper"]


def narrowest_strip(z):
    """Half the width of the narrowest strip around points: every direction is tried, then ever closer ones."""
    low, high = 0.0, np.pi
    for _ in range(12):
        angles = np.linspace(low, high, 61)
        widths = np.array([np.ptp((z * np.exp(-1j * angle)).imag) for angle in angles])
        best, step = angles[widths.argmin()], angles[1] - angles[0]
        low, high = best - step, best + step
    return widths.min() / 2, best


@pytest.mark.parametrize("name", NAMED)
def test_lines_of_the_gallery_are_those_of_very_many_frames(name):
    own = recipe(name)
    aspect = own.aspect("straight_line")
    start, end = aspect.given.part_of(own.input_range)
    drives = np.linspace(start, end, 1001)
    path = gk.move(own.linkage, drives, own.made.branch).point(aspect.point)
    deviation, angle = narrowest_strip(path.position)
    size = abs(path.position).max()
    assert aspect.part.deviation == pytest.approx(deviation, abs=1e-7 * size, rel=1e-4)
    along = (path.position * np.exp(-1j * angle)).real
    assert aspect.part.length == pytest.approx(np.ptp(along), rel=1e-6)
    rate = np.gradient(along, drives)[1:-1]
    assert aspect.part.speed_variation == pytest.approx(np.ptp(rate) / abs(rate.mean()), rel=0.02)


# Crank range, ground, stroke and width of the strip in percent of the stroke, for a crank of 1.
@pytest.mark.parametrize(
    "part_deg, ground, stroke, percent",
    [(60, 2.9, 1.763, 0.00027), (120, 2.625, 3.238, 0.0103), (180, 2.2, 4.181, 0.0963), (180, 2.0, 4.0, 0.244)],
)
def test_hoecken_linkages_have_the_published_lines(part_deg, ground, stroke, percent):
    coupler = 2.5 if ground == 2 else (3 * ground - 1) / 2
    motion = gk.move(gk.FourBar(ground, 1, coupler, coupler, coupler_point=2 * coupler), np.linspace(0, 2 * np.pi, 37))
    ends = np.radians([180 - part_deg / 2, 180 + part_deg / 2])
    part = gk.linkage.straight_part(motion, "coupler_point", *ends)
    assert part.length == pytest.approx(stroke, abs=2e-3)
    assert 200 * part.deviation / part.length == pytest.approx(percent, rel=0.02)
    backwards = gk.linkage.straight_part(motion, "coupler_point", *ends[::-1])
    assert backwards.deviation == pytest.approx(part.deviation, abs=1e-13)


def test_klann_s_foot_and_peaucellier_s_line_are_the_published_ones():
    foot = recipe("klann").motion.point("foot").position
    assert foot[[0, 90]] == pytest.approx(np.array([-59.8 - 75.1j, -159.9 - 75.1j]), abs=0.15)
    assert recipe("klann").aspect("straight_line").part.length == pytest.approx(100.06, abs=1)
    pen = recipe("peaucellier").motion.point("pen").position
    assert pen.real == pytest.approx((130**2 - 60**2) / 90, abs=1e-11)


def table(name, **changes):
    read = tomllib.loads((RECIPES / f"{name}.toml").read_text("utf-8"))
    return read | {key: {**read.get(key, {}), **value} for key, value in changes.items()}


def found(recipe):
    return {c.id: c.value for c in recipe.checks if c.id.startswith("straight")}


def test_a_line_depends_on_no_step_and_on_no_turn_of_the_driver():
    lines = [found(from_table(table("hoecken", drive={"step_deg": step}))) for step in (1.0, 30.0)]
    lines.append(found(from_table(table("hoecken", drive={"speed_rpm": -7}, straight_line={"over_deg": [-250, -110]}))))
    lines.append(found(from_table(table("hoecken", linkage={"ground_angle_deg": 33}))))
    for line in lines:
        assert line == pytest.approx(found(recipe("hoecken")), rel=1e-6)
    assert lines[0]["straight_speed"] == pytest.approx(20.43, abs=0.01)


def test_a_line_in_inches_is_that_in_mm():
    inches = from_table(in_inches(table("hoecken"), recipe("hoecken")))
    assert found(inches) == pytest.approx(found(recipe("hoecken")), rel=1e-9)


def test_the_column_is_the_distance_in_the_straight_part_only():
    own = recipe("hoecken")
    column, drive = own.table["coupler_point_off_line"], np.degrees(own.motion.drive)
    inside = (drive >= 110 - 1e-9) & (drive <= 250 + 1e-9)
    assert np.isfinite(column[inside]).all() and np.isnan(column[~inside]).all()
    assert np.abs(column[inside]).max() == pytest.approx(found(own)["straightness"], rel=0.02)


@pytest.mark.parametrize(
    "name, line, key",
    [
        ("hoecken", {"over_deg": [250, 110]}, "straight_line.over_deg"),
        ("hoecken", {"over_deg": [0, 361]}, "straight_line.over_deg"),
        ("watt", {"over_deg": [-50, -20]}, "straight_line.over_deg"),
        ("parallel-gripper", {"over_deg": [0, 20]}, "straight_line.over_deg"),
        ("hoecken", {"point": "crank_pivot"}, "straight_line.point"),
    ],
)
def test_a_part_that_the_driver_or_the_linkage_does_not_have_is_refused(name, line, key):
    with pytest.raises(RecipeError) as caught:
        from_table(table(name, straight_line=line))
    assert [problem.key for problem in caught.value.problems] == [key]


def test_an_open_part_fails_its_checks_without_a_number():
    own = from_table(table("watt", drive={"start_deg": -90, "end_deg": 60}))
    assert not own.motion.assembled.all()
    assert np.isnan(found(own)["straightness"]) and own.scene is not None
