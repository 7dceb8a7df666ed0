"""The table `[tolerances]` of a linkage's recipe: the deviation of an output in table, checks, scene and summary."""

import json

import numpy as np
import pytest
import shapely

import geomkin as gk

BARS = {"ground": 100, "crank": 30, "coupler": 90, "rocker": 70, "coupler_point": [40, 25]}
MOTION = gk.move(gk.FourBar(100, 30, 90, 70, coupler_point=40 + 25j), np.linspace(0, 2 * np.pi, 73))
KNOWN = {"of": "coupler_point", "tolerance": 0.1, "clearance": 0.05}


def four_bar(tolerances, **more):
    recipe = {"kind": "four-bar", "linkage": BARS, "drive": {"step_deg": 5}, "tolerances": tolerances}
    return gk.load({**recipe, **more})


def test_columns_are_those_of_the_library_in_the_units_of_the_table():
    table = four_bar(KNOWN).table
    analysis = gk.tolerances(MOTION, "coupler_point", 0.1, 0.05)
    assert table["coupler_point_worst_case_mm"] == pytest.approx(analysis.worst_case, rel=1e-9)
    assert table["coupler_point_root_sum_square_mm"] == pytest.approx(analysis.root_sum_square, rel=1e-9)
    assert np.all(table["coupler_point_across_path_mm"] <= table["coupler_point_worst_case_mm"] * (1 + 1e-4))
    table = four_bar(KNOWN | {"of": "rocker_angle"}).table
    deviation = np.degrees(gk.tolerances(MOTION, "rocker_angle", 0.1, 0.05).worst_case)
    assert table["rocker_angle_worst_case_deg"] == pytest.approx(deviation, rel=1e-9)
    assert table["rocker_angle_upper_deg"] - table["rocker_angle"] == pytest.approx(deviation, rel=1e-9)
    assert table["rocker_angle"] - table["rocker_angle_lower_deg"] == pytest.approx(deviation, rel=1e-9)
    assert "rocker_omega_worst_case_rad_per_s" in four_bar(KNOWN | {"of": "rocker_omega"}).table.to_columns()


def test_a_linkage_that_is_open_at_some_positions_has_deviations_at_the_others():
    recipe = four_bar(KNOWN, linkage=BARS | {"crank": 60, "rocker": 55})
    known = np.isfinite(recipe.table["coupler_point_across_path_mm"])
    assert 0 < known.sum() < known.size and np.array_equal(known, recipe.motion.assembled)


def test_single_lengths_and_the_clearance_of_the_stock():
    """Without a clearance of its own, that of the holes; a single length replaces that of all."""
    recipe = four_bar({"of": "rocker_angle", "lengths": {"crank": 0.5}}, stock={"clearance": 0.3})
    lengths = dict.fromkeys(("ground", "coupler", "rocker"), 0.1) | {"crank": 0.5}
    expected = gk.tolerances(MOTION, "rocker_angle", lengths, 0.3).worst_case
    assert recipe.table["rocker_angle_worst_case"] == pytest.approx(np.degrees(expected), rel=1e-9)


@pytest.mark.campaign
def test_the_limit_is_checked_and_the_advised_tolerance_just_passes():
    failed = four_bar(KNOWN | {"limit": 0.4})
    (check,) = [check for check in failed.checks if check.id == "deviation"]
    assert not check.passed and check.column == "coupler_point_worst_case" and check.unit == "mm"
    # The largest value is between two rows.
    assert 0 <= check.value - np.max(failed.table[check.column]) < 1e-3 * check.value
    advised = failed.notes["tolerances"]["loosest_tolerance_mm"]["worst_case"]
    for factor, passes in ((0.999, True), (1.001, False)):
        again = four_bar(KNOWN | {"limit": 0.4, "tolerance": advised * factor})
        assert next(check for check in again.checks if check.id == "deviation").passed is passes
    assert "deviation" not in {check.id for check in four_bar(KNOWN).checks}


def test_a_clearance_beyond_the_limit_has_no_tolerance():
    recipe = four_bar(KNOWN | {"limit": 0.01})
    assert set(recipe.notes["tolerances"]["loosest_tolerance_mm"].values()) == {None}


def test_the_band_holds_the_enlarged_deviation_of_every_position():
    """Across the path; the region of the page, read back as polygons."""
    recipe = four_bar(KNOWN)
    (region,) = recipe.scene.regions
    area = shapely.Polygon()
    for curve in region.curves:
        area = area.symmetric_difference(shapely.Polygon([(z.real, z.imag) for z in curve.vertices]))
    enlarged = recipe.aspect("tolerances").enlarged
    point = MOTION.point("coupler_point")
    normal = 1j * point.first / np.abs(point.first)
    deviation = enlarged * gk.tolerances(MOTION, "coupler_point", 0.1, 0.05).worst_case_along(normal)
    for share, inside in ((0.98, True), (1.1, False)):
        ends = point.position + np.array([[1], [-1]]) * share * deviation * normal
        covered = [area.buffer(1e-6).contains(shapely.Point(z.real, z.imag)) for z in ends.ravel()]
        # A point beyond the band may lie in another part of it, at the tight ends of the curve.
        assert np.mean(covered) > 0.99 if inside else np.mean(covered) < 0.2
    assert not four_bar(KNOWN | {"of": "rocker_angle"}).scene.regions


@pytest.mark.campaign
def test_random_linkages_in_the_summary_agree_with_the_root_sum_square(tmp_path):
    recipe = four_bar(KNOWN | {"of": "rocker_angle", "clearance": 0, "limit": 0.2})
    gk.make(recipe, tmp_path)
    found = json.loads((tmp_path / "four-bar" / "summary.json").read_text())["tolerances"]
    assert found["random"]["largest_of_99.73_percent_deg"] == pytest.approx(found["root_sum_square_deg"], rel=0.15)
    assert found["random"]["not_assembled"] == 0 and 0 < found["random"]["within_limit_percent"] <= 100
    assert sum(found["contributions_deg"].values()) >= found["worst_case_deg"] * (1 - 1e-6)
    ends = gk.move(gk.FourBar(100, 30, 90, 70), gk.linkage.dead_centres(gk.FourBar(100, 30, 90, 70), "rocker"))
    swing = gk.tolerances(ends, "rocker_angle", 0.1).range_worst_case
    # Its ends are between two rows.
    assert found["range_worst_case_deg"] == pytest.approx(np.degrees(swing), rel=1e-5)
    assert "random" not in four_bar(KNOWN | {"linkages": 0}).notes["tolerances"]


def test_linkages_with_slides_and_loops_have_deviations():
    slider = gk.load(
        {"kind": "slider-crank", "linkage": {"crank": 30, "coupler": 90}, "tolerances": {"of": "slide_displacement"}}
    )
    worst = slider.table["slide_displacement_worst_case_mm"]
    # At the ends of the stroke lengths and clearances add up: two lengths, and three pins with two holes each.
    assert worst[0] == pytest.approx(0.2 + 3 * 0.2, rel=1e-6)
    assert four_bar({"of": "transmission_angle"}).table.column("transmission_angle_worst_case").unit == "deg"


def test_an_output_without_derivatives_is_unknown(tmp_path):
    """The angle of a dyad that stays at a right angle, where it is folded back."""
    recipe = gk.load(
        {
            "kind": "scotch-yoke",
            "linkage": {"crank": 30, "guide": 100},
            "tolerances": {"of": "transmission_angle", "limit": 1},
        }
    )
    check = next(check for check in recipe.checks if check.id == "deviation")
    gk.make(recipe, tmp_path)
    found = json.loads((tmp_path / "scotch-yoke" / "summary.json").read_text())["tolerances"]
    assert found["worst_case_deg"] is None and not check.passed and len(recipe.remarks) == 1


@pytest.mark.parametrize(
    ("tolerances", "key"),
    [
        ({"of": "pen"}, "tolerances.of"),
        ({"of": "rocker_angle", "lengths": {"rod": 0.1}}, "tolerances.lengths"),
        ({"of": "rocker_angle", "lengths": {"crank": -1}}, "tolerances.lengths.crank"),
        ({"of": "rocker_angle", "tolerance": -0.1}, "tolerances.tolerance"),
        ({"of": "rocker_angle", "clearance": "0.1 mm"}, "tolerances.clearance"),
        ({"of": "rocker_angle", "limit": 0}, "tolerances.limit"),
        ({"of": "rocker_angle", "linkages": 10**9}, "tolerances.linkages"),
        ({"tolerance": 0.1}, "tolerances.of"),
    ],
)
def test_wrong_entries_are_named_by_their_key(tolerances, key):
    with pytest.raises(gk.RecipeError) as error:
        four_bar(tolerances)
    assert error.value.problems[0].key == key


def test_a_scaled_recipe_is_cut_as_exactly():
    assert gk.scaled(four_bar(KNOWN), 2).tolerances == four_bar(KNOWN).tolerances
