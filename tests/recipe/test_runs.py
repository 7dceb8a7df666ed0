"""The table `[loads.run]`: speed under a torque or a motor, by the energy of the scene's masses and by closed forms."""

import numpy as np
import pytest

import geomkin as gk

FOUR_BAR = {"ground": 120, "crank": 30, "coupler": 100, "rocker": 70}
MASSES = {
    "crank": {"mass_kg": 0.2, "centre": [10, 0], "inertia_kg_mm2": 100},
    "coupler": {"mass_kg": 0.3, "centre": [55, 10], "inertia_kg_mm2": 400},
    "rocker": {"mass_kg": 0.2, "centre": [35, 0], "inertia_kg_mm2": 150},
}


def run(run, loads=None, linkage=FOUR_BAR, **more):
    loads = {"masses": MASSES, "gravity_m_per_s2": [0, -9], "run": run, **(loads or {})}
    return gk.load({"kind": "four-bar", "linkage": linkage, "drive": {"step_deg": 1}, **more, "loads": loads})


def energy(recipe):
    """Kinetic energy and weight of all bodies, N mm, with the speeds of the run, from the linkage at unit speed."""
    speed, turn = recipe.table["run_speed"], gk.move(recipe.linkage, recipe.motion.drive, speed=1.0)
    total = np.zeros(len(speed))
    for name, mass in recipe.loads.masses.items():
        body = turn.bodies[name]
        arm = mass.centre * body.direction
        place, velocity = body.origin.position + arm, body.origin.velocity + 1j * body.omega * arm
        kinetic = mass.mass_kg * np.abs(velocity) ** 2 + mass.inertia_kg_mm2 * body.omega**2
        total += 1e-3 * (kinetic * speed**2 / 2 + 9000 * mass.mass_kg * place.imag)
    return total


def test_the_energy_under_a_constant_torque_grows_with_the_angle():
    recipe = run({"torque_n_mm": 40, "start_rpm": 200, "turns": 2})
    gained = energy(recipe) - energy(run({"torque_n_mm": 40, "start_rpm": 200}))[0]
    # The table has the second turn.
    work = 40 * (2 * np.pi + np.radians(np.arange(361)))
    assert gained == pytest.approx(work, abs=1e-4 * work.max())
    assert recipe.table["run_speed"][0] > 200 * np.pi / 30
    checks = {check.id: check for check in recipe.checks}
    assert checks["run_energy"].passed and checks["run_turns"].passed


def test_the_times_are_those_of_the_speeds():
    recipe = run({"torque_n_mm": 90, "turns": 1})
    time, speed = recipe.table["run_time"], recipe.table["run_speed"]
    # From rest; the drive between two frames is the integral of the speed over time.
    assert time[0] == 0 and speed[0] == 0
    assert np.trapezoid(speed[5:], time[5:]) == pytest.approx(np.radians(355), rel=1e-4)


def test_a_motor_turns_a_balanced_crank_up_to_its_speed_without_load():
    motor = {"name": "own", "torque_n_mm": 500, "speed_rpm": 120, "lasting_torque_n_mm": 500, "mass_g": 1}
    loads = {"masses": {"crank": {"mass_kg": 0, "inertia_kg_mm2": 40_000}}, "motor": motor}
    recipe = run({"turns": 3}, loads)
    # J w' = T (1 - w / w0): an exponential with the time constant J w0 / T.
    w0 = 120 * np.pi / 30
    tau = 1e-3 * 40_000 * w0 / 500
    time, speed = recipe.table["run_time"], recipe.table["run_speed"]
    assert speed == pytest.approx(w0 * (1 - np.exp(-time / tau)), rel=1e-5)
    turned = w0 * (time - tau * (1 - np.exp(-time / tau)))
    assert turned == pytest.approx(np.radians(720 + np.arange(361)), rel=1e-5)
    assert recipe.notes["loads"]["run"]["mean_speeds_rpm"][-1] == pytest.approx(60 / (time[-1] - time[0]), rel=1e-6)


def test_a_torque_that_does_not_lift_the_weight_stalls():
    recipe = run({"torque_n_mm": 15, "start_rpm": 1})
    (check,) = (check for check in recipe.checks if check.id == "run_turns")
    reached = np.isfinite(recipe.table["run_speed"])
    assert not check.passed and reached[0] and not reached[-1] and not np.any(np.diff(reached.astype(int)) > 0)


@pytest.mark.parametrize("torque", [-10, 0])
def test_a_torque_that_turns_nothing_forwards_fails_one_check_and_stays_at_its_start(torque):
    recipe = run({"torque_n_mm": torque}, {"gravity_m_per_s2": [0, 0]})
    assert [check.id for check in recipe.checks if not check.passed] == ["run_turns"]
    for column in ("run_time", "run_speed"):
        assert recipe.table[column][0] == 0 and np.isnan(recipe.table[column][1:]).all()


@pytest.mark.parametrize("linkage", [{"ground": 20, "coupler": 60}, {"ground": 100, "coupler": 100}])
def test_a_run_needs_a_start_at_which_the_linkage_closes_and_can_move(linkage):
    recipe = run({"torque_n_mm": 15}, linkage=FOUR_BAR | {"rocker": 30} | linkage)
    with pytest.raises(gk.DesignError) as refused:
        recipe.table
    assert refused.value.field == "drive.start_deg"


def test_what_a_run_cannot_have_is_named_by_its_key():
    stepper = {"motor": "nema17"}
    dry = {"pin_friction": [{"pin": "crank_pin", "coefficient": 0.1, "radius": 2}]}
    cases = (
        ({}, {}, {}, "loads.run.torque_n_mm"),
        ({}, stepper, {}, "loads.run.torque_n_mm"),
        ({"torque_n_mm": 10}, dry, {}, "loads.run"),
        ({"torque_n_mm": 10}, {}, {"copies": [{"phase_deg": 180}]}, "loads.run"),
        ({"torque_n_mm": 10, "turns": 0}, {}, {}, "loads.run.turns"),
        ({"torque_n_mm": 10}, {}, {"drive": {"end_deg": 90}}, "loads.run"),
        ({"torque_n_mm": 10}, {}, {"drive": {"speed_rpm": -60}}, "loads.run"),
    )
    for table, loads, more, key in cases:
        with pytest.raises(gk.RecipeError) as refused:
            run(table, loads, **more)
        assert refused.value.problems[0].key == key
