"""Recipes that no motor drives, and walkers whose feet carry nothing."""

import tomllib
from pathlib import Path

import numpy as np
import pytest

import geomkin as gk
from geomkin.recipe.keys import varied

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


def jamming_pump(coefficient, **loads):
    """A force of 5 N on the slider; its coupler leans by up to asin(30 / 50) from the guide."""
    friction = [{"slide": "slide", "coefficient": coefficient}]
    return {
        "kind": "slider-crank", "linkage": {"crank": 30, "coupler": 50}, "stock": {"material": "steel-S235"},
        "loads": {"slide_forces": [{"slide": "slide", "force_n": -5}], "slide_friction": friction, **loads},
    }  # fmt: skip


@pytest.mark.parametrize("step", [1, 30])
def test_a_linkage_jams_where_its_coupler_is_steeper_than_the_cone_of_friction(step):
    """Pushed against the force the slider jams where tan(angle of the coupler) > 1 / coefficient."""
    start = 180 + np.degrees(np.arcsin(50 / 30 * np.sin(np.arctan(1 / 2))))
    recipe = gk.load(jamming_pump(2, motor="37d-19") | {"drive": {"step_deg": step}})
    moved = check(recipe, "share_movable")
    assert moved.value == pytest.approx(100 * (1 - 2 * (270 - start) / 360), abs=0.3) and not moved.passed
    assert moved.at == pytest.approx(start, abs=0.6)
    for id in ("motor_torque", "pin_shear", "pin_pressure", "plate_stress"):
        assert np.isnan(check(recipe, id).value) and not check(recipe, id).passed
    assert recipe.notes["loads"]["motor"]["margin"] is None and not recipe.notes["loads"]["largest_pin_force_N"]
    # Without a named motor none is said to suffice.
    assert "motor" not in gk.load(jamming_pump(2)).notes["loads"]
    assert check(gk.load(jamming_pump(1.3)), "share_movable").passed


def test_the_motor_of_a_machine_whose_linkage_jams_has_no_margin():
    pair = {"kind": "gear-pair", "first": {"teeth": 20, "module": 1}, "second": {"teeth": 20, "module": 1}}
    mechanisms = {
        "pump": {"recipe": jamming_pump(2, motor="37d-19")},
        "pair": {"recipe": pair, "turned_by": "pump.crank"},
    }
    machine = gk.load({"kind": "machine", "mechanisms": mechanisms})
    ids = {check.id: check for check in machine.checks}
    assert np.isnan(ids["motor_torque"].value) and not ids["pump_share_movable"].passed


CAM = {
    "kind": "disk-cam",
    "cam": {
        "base_radius": 30,
        "follower": {"kind": "translating-roller", "roller_radius": 8},
        "program": [{"kind": "rise", "law": "cycloidal", "rise": 12, "end_deg": 150}, {"kind": "return", "law": "cycloidal", "end_deg": 360}],
    },
}  # fmt: skip


def test_the_motor_of_a_cam_whose_guide_jams_has_no_margin():
    guide = {"coefficient": 2, "length": 20, "overhang": 40}
    loads = {"follower": {"mass_kg": 0.1}, "preload_n": 20, "friction": guide, "motor": "37d-50"}
    assert np.isnan(check(gk.load(CAM | {"loads": loads}), "motor_torque").value)


# Recipes with a motor in their loads and a mounted one, and the key of the latter.
WITH_TWO_MOTORS = {
    "linkage": ({"kind": "four-bar", "linkage": {"ground": 120, "crank": 30, "coupler": 100, "rocker": 70},
                 "stock": {"thickness": 4, "bar_width": 16, "pin_diameter": 4, "fit": "press"},
                 "loads": {"forces": [{"body": "rocker", "point": "rocker_pin", "force_n": [0, -10]}]}}, "stock"),
    "cam": (CAM | {"loads": {"follower": {"mass_kg": 0.1}, "preload_n": 40}, "stock": {"thickness": 6, "bore": 5, "bore_form": "D"}}, "stock"),
    "belt": ({"kind": "belt-drive", "belt": {"profile": "GT2-3M", "width": 9, "teeth": 80}, "pulleys": [{"teeth": 30}, {"teeth": 30, "at": [75, 0]}],
              "stock": {"thickness": 10}, "first_stock": {"thickness": 10, "bore": 5, "bore_form": "D"},
              "loads": {"torques_n_mm": [300], "speed_rpm": 30}}, "first_stock"),
}  # fmt: skip


def with_motors(name, named, mounted):
    table, stock = WITH_TWO_MOTORS[name]
    loads, own = table["loads"] | ({"motor": named} if named else {}), table[stock] | {"motor": mounted}
    return table | {"loads": loads, stock: own}


@pytest.mark.parametrize("name", WITH_TWO_MOTORS)
def test_two_motors_on_one_shaft_are_refused_by_both_names(name):
    with pytest.raises(gk.RecipeError) as caught:
        gk.load(with_motors(name, "tt", "nema17"))
    (problem,) = caught.value.problems
    assert problem.key == "loads.motor"
    assert all(word in problem.problem for word in ("tt", "nema17", f"{WITH_TWO_MOTORS[name][1]}.motor"))


@pytest.mark.parametrize("name", WITH_TWO_MOTORS)
@pytest.mark.parametrize("named", [None, "nema17-short"])
def test_the_motor_that_is_advised_passes_whichever_key_names_it(name, named):
    recipe = gk.load(with_motors(name, named, "nema17-short"))
    failed = check(recipe, "motor_torque")
    suggestion = next(s for s in failed.suggestions if any("motor" in key for key in s.values))
    assert all(key in failed.advice for key in suggestion.values) and len(suggestion.values) == 1 + bool(named)
    source, _ = varied(recipe)
    assert check(source.opened(suggestion.values), "motor_torque").passed


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
