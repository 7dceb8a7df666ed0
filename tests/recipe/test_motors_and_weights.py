"""Recipes that no motor drives, and walkers whose feet carry nothing."""

import tomllib
from pathlib import Path

import numpy as np
import pytest

import geomkin as gk

CASES = Path(__file__).parents[1] / "cases"


def check(recipe, id):
    return next(check for check in recipe.checks if check.id == id)


def test_the_nearest_motor_is_named_if_none_suffices():
    recipe = gk.load(CASES / "no-motor-suffices.toml")
    torque = np.abs(recipe.table["driver_torque"]).max()
    failed = check(recipe, "motor_torque")
    margins = [motor.margin(recipe.aspect("loads").duty) for motor in gk.making.MOTORS.values()]
    assert not failed.passed and failed.value == max(margins) < 1.5
    # 60 rpm: the torque and the power that are required stand in the advice.
    assert f"{torque:.3g}"[:3] in failed.advice and f"{torque * 2 * np.pi / 1000:.3g}" in failed.advice


def test_a_cam_that_no_motor_turns_is_reported_too():
    program = [
        {"kind": "rise", "law": "cycloidal", "rise": 20, "end_deg": 180},
        {"kind": "return", "law": "cycloidal", "end_deg": 360},
    ]
    cam = {"base_radius": 40, "follower": {"kind": "translating-roller", "roller_radius": 8}, "program": program}
    loads = {"follower": {"mass_kg": 1}, "preload_n": 1e5}
    assert not check(gk.load({"kind": "disk-cam", "cam": cam, "loads": loads}), "motor_torque").passed


@pytest.mark.campaign
def test_a_walker_whose_feet_carry_nothing_is_reported():
    walker = gk.load(CASES / "walker-without-weight.toml")
    assert check(walker, "weight_carried").value == 0 and not check(walker, "weight_carried").passed


@pytest.mark.campaign
def test_feet_that_carry_the_weight_pass_by_the_mean_of_their_forces():
    """Six feet of 2.2 N over 174 of 360 deg, against the masses of the summary, the motor and what is carried."""
    table = tomllib.loads(gk.recipe.to_toml(gk.load("recipes/motor-walker.toml")))
    pushed = [[0, 0, 0], [100, 0, 0], [100, 0, 2.2], [274, 0, 2.2], [274, 0, 0], [360, 0, 0]]
    force = {"body": "leg", "point": "foot", "over_deg": pushed}
    walker = gk.load({**table, "loads": {"forces": [force], "carried": [{"mass_kg": 0.1}]}})
    mass = 0.1 + 6 * sum(body["mass_kg"] for body in walker.notes["masses"].values())
    mass += gk.making.motor("37d-50").mass_g / 1000
    share = 100 * 6 * 2.2 * 174 / 360 / (9.81 * mass)
    assert check(walker, "weight_carried").value == pytest.approx(share, rel=1e-2) and share > 100


@pytest.mark.parametrize("masses", [{}, {"leg": {"mass_kg": 0.5}}])
def test_a_walker_without_a_material_weighs_what_its_loads_state(masses):
    """Four legs of 0.5 kg and a motor; without either nothing is known of the weight, and nothing is said of it."""
    table = tomllib.loads((CASES / "walker-without-weight.toml").read_text("utf-8"))
    del table["stock"]["material"], table["stock"]["motor"]
    force = {"body": "leg", "point": "foot", "force_n": [0, 0.5 * 9.81 / 2]}
    checks = {check.id: check for check in gk.load({**table, "loads": {"masses": masses, "forces": [force]}}).checks}
    if not masses:
        assert "weight_carried" not in checks
    else:
        assert checks["weight_carried"].value == pytest.approx(50)


@pytest.mark.campaign
@pytest.mark.parametrize("measure", ["root_mean_square", "maximum"])
def test_counterweights_for_an_even_torque_reduce_the_ripple_of_the_column(measure):
    text = (Path(__file__).parents[2] / "recipes" / "balanced-rocker.toml").read_text()
    table = tomllib.loads(text)
    plain = gk.load({**table, "loads": {"gravity_m_per_s2": [0, -9.81]}})
    table["loads"]["counterweights"] |= {"objective": "driver", "measure": measure}
    recipe = gk.load(table)

    def ripple(of):
        torque = of.table["driver_torque"]
        deviation = np.abs(torque - torque.mean())
        return deviation.max() if measure == "maximum" else np.sqrt(np.mean(deviation**2))

    check = next(check for check in recipe.checks if check.id == "counterweights")
    # The same screws, at the same places, are on both.
    assert check.value == pytest.approx(ripple(recipe) / ripple(plain), rel=0.02)
    assert check.value < 0.75
