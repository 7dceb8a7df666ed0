"""Teeth given by formulas: an involute as formulas against spur gears and rings, and formulas that are refused."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.recipe.load import to_toml
from tests.gallery import recipe
from tests.texts import parse

TEETH, MODULE = 24, 3
# Base radius, and half the angle of a tooth there.
BASE, HALF = float(12 * np.cos(np.pi / 9)), float(np.pi / 48 + np.tan(np.pi / 9) - np.pi / 9)
RADIUS, ANGLE = f"{BASE!r}*sqrt(1 + t**2)", f"({HALF!r} - t + atan(t))"
INVOLUTE = {"x": f"{RADIUS}*sin{ANGLE}", "y": f"{RADIUS}*cos{ANGLE} - 12", "t_start": 0.15, "t_end": 0.5}


def gear(**changes):
    return {"teeth": TEETH, "module": MODULE} | INVOLUTE | changes


def gears(mate, **changes):
    table = {
        "kind": "parametric-tooth-gears",
        "gear": gear(**changes),
        "mate": {"addendum": 1.5, "clearance": 0.2} | mate,
    }
    return gk.load(table)


@pytest.mark.parametrize(
    ("mate", "involute"),
    [({"teeth": 32}, gk.SpurGear(32, MODULE)), ({"teeth": 60, "internal": True}, gk.RingGear(60, MODULE))],
    ids=["external", "ring"],
)
def test_the_mate_of_an_involute_by_formulas_is_an_involute(mate, involute):
    given = gears(mate)
    touched = given.design.contact(np.linspace(0, 1, 41))
    points = touched.mate[np.isfinite(touched.angle)]
    assert len(points) > 20
    wanted = [involute.tooth.half_angle(r) for r in np.abs(points).tolist()]
    pitch = 2 * np.pi / involute.teeth
    angle = np.abs(np.mod(np.angle(points / 1j) + pitch / 2, pitch) - pitch / 2)
    assert angle == pytest.approx(wanted, abs=1e-9)


def test_flank_velocity_and_curvature_are_those_of_the_involute():
    flank = gk.gear.ParametricToothGear(**gear()).flank
    t = np.linspace(0.15, 0.5, 30)
    # An involute moves by base radius times roll angle, which is also its radius of curvature.
    assert np.abs(flank.velocity(t)) == pytest.approx(BASE * MODULE * t)
    assert np.abs(flank.curvature(t)) == pytest.approx(1 / (BASE * MODULE * t), rel=1e-6)


def test_points_on_the_formulas_give_the_same_gear_to_the_error_of_a_spline():
    by_formulas = gk.gear.ParametricToothGear(**gear())
    points = by_formulas.flank.point(np.linspace(0.15, 0.5, 40))
    by_points = gk.gear.PointToothGear(TEETH, MODULE, tuple(points.tolist()))
    away = [gk.nearest(by_points.flank, z)[1] for z in by_formulas.flank.point(np.linspace(0.15, 0.5, 23))]
    assert max(away) < 1e-6 * MODULE


def test_a_tooth_by_formulas_is_written_again_and_grows_with_the_module_in_inches():
    given = recipe("parametric-tooth")
    assert parse(to_toml(given)) == given
    table = {"kind": "parametric-tooth-gears", "units": "in", "gear": gear(module=0.125)}
    inches = gk.load(table | {"mate": {"teeth": 32, "addendum": 0.06, "clearance": 0.01}})
    assert inches.gear.tip_radius / 25.4 / 0.125 == pytest.approx(gears({"teeth": 32}).gear.tip_radius / MODULE)


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"x": ""}, "gear.x"),
        ({"y": "t +"}, "gear.y"),
        ({"x": "q"}, "gear.x"),
        ({"x": "__import__('os')"}, "gear.x"),
        ({"t_end": 0.1}, "gear.t_end"),
        ({"x": "1/(t - 0.3)"}, "gear.x"),
        ({"y": "log(t - 0.3)"}, "gear.y"),
        ({"x": "pi/4 - 0.3*t - 0.2*abs(t)", "y": "t", "t_start": -1, "t_end": 1}, "gear.x"),
        ({"x": "pi/4", "y": "0"}, "gear.x"),
        ({"x": "pi/4 - 2*t", "y": "t", "t_start": -1, "t_end": 1}, "gear.x"),
        ({"x": "pi/4 - 0.3*t", "y": "-t", "t_start": -1, "t_end": 1}, "gear.x"),
        ({"x": "t" * 600}, "gear.x"),
        ({"x": 3}, "gear.x"),
    ],
    ids=str,
)
def test_formulas_without_a_tooth_are_refused_by_key(changes, key):
    with pytest.raises(gk.RecipeError) as caught:
        gears({"teeth": 32}, **changes)
    assert caught.value.problems[0].key == key
