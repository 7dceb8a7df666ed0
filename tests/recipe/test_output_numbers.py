"""Optional results of a recipe of a linkage: both assembly modes, a dwell, Grashof's sums, cognates one by one."""

import numpy as np
import pytest

import geomkin as gk
from tests.texts import parse

FOUR_BAR = """
kind = "four-bar"
both_modes = true
[linkage]
ground = 100
crank = 30
coupler = 90
rocker = 70
coupler_point = [40, 25]
[drive]
step_deg = 10
[dwell]
band_deg = 2
"""


def test_both_modes_stand_in_the_table() -> None:
    recipe = parse(FOUR_BAR)
    mirrored = gk.move(recipe.linkage, np.radians(np.arange(0, 361, 10)), -1, recipe.drive.speed)
    point = mirrored.point("coupler_point")
    reported = recipe.table
    np.testing.assert_allclose(reported["other_coupler_point_x"], point.position.real, rtol=1e-12)
    np.testing.assert_allclose(reported["other_coupler_point_velocity_y"], point.velocity.imag, rtol=1e-9)
    np.testing.assert_allclose(reported["other_rocker_omega"], mirrored.rocker.omega, rtol=1e-9)
    assert set(reported["rocker_pin_branch"]) == {1} and set(reported["other_rocker_pin_branch"]) == {-1}
    least = np.degrees(gk.least_transmission_angle(mirrored))
    assert recipe.notes["other_mode"]["least_transmission_angle_deg"] == pytest.approx(least, rel=1e-9)
    assert recipe.notes["other_mode"]["driver_reaches_deg"] == [[0.0, 360.0]]
    assert recipe.scene is not None and len(recipe.scene.others) == 1


def test_the_dwell_and_grashof_s_sums_are_in_the_summary(tmp_path) -> None:
    notes = parse(FOUR_BAR).notes
    dwell = notes["dwell"]
    assert dwell["output"] == "rocker" and dwell["band_deg"] == 2
    assert dwell["driver_range_deg"] == pytest.approx(dwell["to_deg"] - dwell["from_deg"])
    drive = np.radians(np.linspace(dwell["from_deg"], dwell["to_deg"], 500))
    angle = np.degrees(np.angle(gk.move(parse(FOUR_BAR).linkage, drive).rocker.direction))
    assert np.ptp(angle) == pytest.approx(2, abs=5e-3)
    assert (angle.min(), angle.max()) == pytest.approx((dwell["least_deg"], dwell["greatest_deg"]), abs=5e-3)
    assert notes["grashof"] == {
        "shortest": "crank", "longest": "ground", "shortest_and_longest_mm": 130, "other_two_mm": 160,
    }  # fmt: skip


def test_a_slide_dwells_in_mm() -> None:
    text = 'kind = "slider-crank"\n[dwell]\nband_mm = 0.5\n[linkage]\ncrank = 30\ncoupler = 90'
    dwell = parse(text).notes["dwell"]
    assert dwell["output"] == "slider" and dwell["band_mm"] == 0.5
    assert dwell["greatest_mm"] - dwell["least_mm"] == pytest.approx(0.5, abs=1e-6)
    with pytest.raises(gk.RecipeError) as caught:
        parse(text.replace("band_mm = 0.5", 'band_deg = 0.5\noutput = "rocker"'))
    assert [problem.key for problem in caught.value.problems] == ["dwell.output"]


def test_a_body_whose_name_begins_like_the_columns_of_the_other_mode_is_refused() -> None:
    bodies = {"ground": {"O": [0, 0], "D": [100, 0]}, "crank": {"O": [0, 0], "B": [30, 0]}}
    bodies |= {"rod": {"B": [0, 0], "C": [90, 0]}, "other_rod": {"D": [0, 0], "C": [70, 0]}}
    recipe = {"kind": "linkage", "linkage": {"driver": "crank", "bodies": bodies}, "both_modes": True}
    with pytest.raises(gk.DesignError) as refusal:
        gk.load(recipe).table
    assert refusal.value.field == "both_modes" and "other_rod" in refusal.value.remedy
    bodies["rocker"] = bodies.pop("other_rod")
    assert "other_rod_angle" in gk.load(recipe).table.ids
