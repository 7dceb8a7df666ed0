"""Measured lifts of a whole turn: dwells at 0, scatter, rows from -180 deg; returns by their fall."""

import re
from pathlib import Path

import numpy as np
import pytest

import geomkin as gk
from geomkin.cam.program.program import Program
from geomkin.cam.program.segments import LiftTable
from geomkin.cam.program.smoothing_spline import smoothest_within
from geomkin.core.units import UNITS
from tests.campaign import by_default

CASES = Path(__file__).parents[1] / "cases"
TURN = np.linspace(0, 2 * np.pi, 7001)


def lobe(law, span=60):
    """9 mm over twice `span` deg about 180 deg, otherwise at rest."""
    flanks = gk.Rise(law, rise=9, end_deg=180), gk.Return(law, end_deg=180 + span)
    return Program([gk.Dwell(end_deg=180 - span), *flanks, gk.Dwell(end_deg=360)])


def table(degrees, lifts, **how):
    return LiftTable(rows=tuple(zip(degrees.tolist(), lifts.tolist())), **how)


def assert_within(program, degrees, lifts, within):
    assert np.abs(program.motion(np.radians(degrees)).lift - lifts).max() <= within * (1 + 1e-6)
    assert program.motion(TURN).lift.min() >= -within * (1 + 1e-6)


@pytest.mark.campaign
@pytest.mark.parametrize("within", [0.001, 0.05])
@pytest.mark.parametrize(("law", "step"), [("harmonic", 2), ("cycloidal", 5), ("parabolic", 5), ("modified-sine", 5)])
def test_lobe_with_a_dwell_at_zero_stays_within_the_band_and_above_the_base_circle(law, step, within):
    degrees = np.arange(0, 360, step)
    lifts = np.round(lobe(law).motion(np.radians(degrees)).lift, 3)
    assert_within(Program([table(degrees, lifts, within=within)]), degrees, lifts, within)


@pytest.mark.campaign
def test_corners_and_scatter_wider_than_the_band_are_followed_above_the_base_circle():
    degrees = np.arange(0, 360, 5)
    lifts = lobe("uniform", 30).motion(np.radians(degrees)).lift
    scattered = np.maximum(lifts + np.random.default_rng(1).normal(0, 0.02, len(degrees)), 0)
    for rows in (lifts, scattered):
        assert_within(Program([table(degrees, rows, within=0.001)]), degrees, rows, 0.001)


def test_table_between_dwells_stays_above_the_base_circle():
    degrees = np.arange(100, 261, 2)
    lifts = np.round(lobe("harmonic").motion(np.radians(degrees)).lift, 3)
    program = Program([gk.Dwell(end_deg=100), table(degrees, lifts, within=0.002), gk.Dwell(end_deg=360)])
    assert_within(program, degrees, lifts, 0.002)


def test_bound_between_the_rows():
    """Without the bound it is smoother and dips; with it, it is rougher and does not."""
    x = np.linspace(0, 1, 41)
    lifts = np.maximum(np.sin(2 * np.pi * x - 1), 0) ** 2
    lifts[-1] = lifts[0]
    free, held = (smoothest_within(x, lifts, None, 0.02, least) for least in (-np.inf, -1e-3))
    places = np.linspace(0, 1, 4001)
    assert free(places)[0].min() < -5e-3 and held(places)[0].min() >= -1e-3 * (1 + 1e-9)
    rough = [np.mean(spline(places)[3] ** 2) for spline in (free, held)]
    assert rough[0] < rough[1] < 3 * rough[0]
    # A bound that the curve does not touch changes nothing.
    loose = smoothest_within(x, lifts, None, 0.02, -1.0)
    assert loose(places)[0] == pytest.approx(free(places)[0], abs=1e-4)


@pytest.mark.parametrize("name", by_default(["cam-table-with-dwell", "centred-rows", "cam-table-scatter"], slice(2)))
def test_measured_table_is_accepted(name):
    recipe = gk.load(CASES / f"{name}.toml")
    fit = recipe.cam.program.tables[0]
    assert np.abs(fit.law(fit.x)[0] - fit.lifts)[:-1].max() <= fit.within * (1 + 1e-6)
    assert recipe.cam.program.motion(TURN).lift.min() >= -fit.within * (1 + 1e-6)


@pytest.mark.campaign
@pytest.mark.parametrize(("unit", "mm"), [("mm", 1.0), ("in", 25.4)])
def test_within_that_a_check_advises_is_accepted_and_passes(unit, mm, tmp_path):
    head, *rows = (CASES / "valve-lift-scatter.csv").read_text().splitlines()
    (tmp_path / "valve-lift-scatter.csv").write_text("\n".join([head, *rows[::2]]))
    text = f'units = "{unit}"\n' + (CASES / "cam-table-scatter.toml").read_text()
    text = text.replace("= 40", f"= {40 / mm}").replace("= 6", f"= {6 / mm}")

    def checks(text):
        (tmp_path / "cam.toml").write_text(text)
        recipe = gk.load(tmp_path / "cam.toml")
        return recipe, [check for check in gk.cam.cam_checks(recipe.cam) if check.id == "scatter_0"]

    recipe, (failed,) = checks(text)
    assert not failed.passed
    advised = re.search(r"at least (\S+) ", UNITS[recipe.units].text(failed.advice))[1]
    _, (followed,) = checks(text.replace("decimals = 3", f"within = {advised}"))
    assert followed.passed


def test_rows_of_a_whole_turn_start_at_any_angle():
    around = np.arange(-180.0, 181, 2)
    lifts = 4 + np.cos(np.radians(around)) + 0.5 * np.sin(2 * np.radians(around))
    from_zero = np.arange(0.0, 361, 2)
    meant = Program([table(from_zero, lifts[np.searchsorted(around, (from_zero + 180) % 360 - 180)], within=0.01)])
    # With the last row, without it, a turn earlier, and as the points of a spline.
    for start, count in ((0, 181), (0, 180), (360, 181)):
        turned = Program([table(around[:count] - start, lifts[:count], within=0.01)])
        assert turned.motion(TURN).lift == pytest.approx(meant.motion(TURN).lift, abs=1e-9)
    rows = tuple(zip(around[::10].tolist(), lifts[::10].tolist()))
    spline = Program([gk.cam.LiftSpline(points=rows)])
    assert spline.motion(np.radians(around[::10])).lift == pytest.approx(lifts[::10], abs=1e-9)


@pytest.mark.parametrize(
    "degrees",
    [np.arange(-179.0, 182, 2), np.arange(-180.0, 100, 7), np.arange(10.0, 300, 7), np.arange(-180.0, 200, 5)],
)
def test_rows_that_are_no_whole_turn_or_have_none_at_zero_are_refused(degrees):
    with pytest.raises(gk.DesignError) as refused:
        Program([table(degrees, 1 + 0 * degrees, within=0.01)])
    assert refused.value.field == "program[0].rows[0]" and "segment before" not in str(refused.value)


def test_a_turn_whose_ends_differ_is_refused():
    with pytest.raises(gk.DesignError):
        Program([LiftTable(within=0.01, rows=((-180, 0), (-90, 1), (0, 9), (90, 0), (180, 1)))])


@pytest.mark.parametrize("arm", ["", "_deg"])
def test_return_by_its_fall(arm):
    rise, fall, end = f"rise{arm}", f"fall{arm}", f"end_lift{arm}"
    up = gk.Rise("harmonic", **{rise: 25}, end_deg=90)
    by_fall = gk.Return("3-4-5", **{fall: 20}, end_deg=180), gk.Return("cycloidal", **{fall: 5}, end_deg=360)
    by_end = gk.Return("3-4-5", **{end: 5}, end_deg=180), gk.Return("cycloidal", end_deg=360)
    first, second = (Program([up, *returns]).motion(TURN) for returns in (by_fall, by_end))
    assert first.lift == pytest.approx(second.lift, abs=1e-12) and (first.jerk == second.jerk).all()
    # From 0.3 down by 0.1 and 0.2 it is 0, without a rounding error.
    tenths = [gk.Rise("harmonic", **{rise: 0.3}, end_deg=90)]
    tenths += [gk.Return("harmonic", **{fall: d}, end_deg=e) for d, e in ((0.1, 180), (0.2, 270))]
    assert Program([*tenths, gk.Dwell(end_deg=360)]).ends[2][1] == 0


@pytest.mark.parametrize(
    ("keys", "field"),
    [({"fall": 26}, "fall"), ({"fall": -2}, "fall"), ({"fall": 20, "end_lift": 5}, "fall"), ({"fall_deg": 25}, None)],
)
def test_impossible_fall_is_refused(keys, field):
    with pytest.raises(gk.DesignError) as refused:
        Program([gk.Rise("harmonic", rise=25, end_deg=90), gk.Return("harmonic", end_deg=360, **keys)])
    assert refused.value.field == (f"program[1].{field}" if field else "program")


def test_fall_composes():
    """Mirrored and in inches it is the motion of the same recipe with the end lift; it is written back as it was read."""
    data = {
        "kind": "disk-cam",
        "units": "in",
        "cam": {
            "base_radius": 2,
            "direction": "clockwise",
            "follower": {"kind": "translating-roller", "roller_radius": 0.25},
            "program": [
                {"kind": "rise", "law": "3-4-5", "rise": 0.5, "end_deg": 90},
                {"kind": "return", "law": "3-4-5", "fall": 0.3, "end_deg": 200},
                {"kind": "return", "law": "3-4-5", "end_deg": 360},
            ],
        },
    }
    recipe = gk.load(data)
    assert recipe.cam.program.motion(np.radians(200)).lift == pytest.approx(0.2 * 25.4, abs=1e-9)
    assert gk.load(gk.recipe.to_toml(recipe)) == recipe and "fall = 0.3" in gk.recipe.to_toml(recipe)
    keys = [key for handle in recipe.handles for key in handle.keys]
    assert "cam.program[1].fall" in keys and "cam.program[1].end_lift" not in keys
    doubled = gk.scaled(recipe, 2)
    assert doubled.cam.program.motion(np.radians(200)).lift == pytest.approx(0.4 * 25.4, abs=1e-9)


def test_key_of_another_kind_of_segment_is_not_said_to_belong_where_it_is():
    with pytest.raises(gk.RecipeError) as refused:
        gk.load(CASES / "cam-unknown-key.toml")
    (problem,) = refused.value.problems
    assert problem.key == "cam.program[0].law" and "[[cam.program]]" not in problem.remedy
    assert "'rise'" in problem.remedy and "'return'" in problem.remedy


def test_few_uneven_rows_are_followed_above_the_base_circle():
    degrees, lifts = np.array([0.0, 30, 35, 160, 215, 315, 350, 360]), np.array([0, 8.99, 5.9, 6.98, 0, 0.79, 9.53, 0])
    for within in (0.001, 0.05):
        assert_within(Program([table(degrees, lifts, within=within)]), degrees, lifts, within)
    # Three rows, of which two are the ends.
    assert_within(Program([table(degrees[[0, 3, -1]], lifts[[0, 3, -1]], within=0.01)]), degrees[[3]], lifts[[3]], 0.01)


def test_refusal_of_rows_that_are_met_exactly_advises_a_band_that_is_accepted():
    degrees = np.arange(0, 360, 4.0)
    lifts = lobe("harmonic").motion(np.radians(degrees)).lift
    with pytest.raises(gk.DesignError) as refused:
        Program([table(degrees, lifts, decimals=12)])
    assert refused.value.field == "program[0]" and "`within`" in refused.value.remedy
    assert_within(Program([table(degrees, lifts, within=1e-4)]), degrees, lifts, 1e-4)
