"""Aspects of mechanisms in a machine: what composes, and what is refused by its name."""

import tomllib

import numpy as np
import pytest

import geomkin as gk

PAIR = {"recipe": {"kind": "gear-pair", "first": {"teeth": 24, "module": 2}, "second": {"teeth": 48, "module": 2}}}
BAR = {"kind": "four-bar", "linkage": {"ground": 120, "crank": 30, "coupler": 100, "rocker": 70}}
WALKER = "recipes/motor-walker.toml"


def placed(recipe, **more):
    return {
        "kind": "machine",
        "mechanisms": {"pair": PAIR, "bar": {"recipe": recipe, "turned_by": "pair.second", **more}},
    }


def walker():
    table = tomllib.loads(gk.recipe.to_toml(gk.load(WALKER)))
    del table["stock"]["motor"]
    del table["files"], table["loads"]["motor"], table["loads"]["motors"], table["loads"]["battery_wh"]
    return table


def test_copies_in_a_machine_are_made_and_certified(tmp_path):
    machine = gk.load(placed({**BAR, "copies": [{"phase_deg": 180}, {"mirrored": True}]}))
    gk.make(machine, tmp_path)
    assert all(certificate.passed for certificate in gk.verify(tmp_path))
    frames = len(machine.scene.time)
    assert all(np.shape(body.origin) in ((), (frames,)) for bodies in machine.scene.units.values() for body in bodies)


def test_a_run_in_a_machine_is_refused_by_its_key():
    loads = {"masses": {"rocker": {"mass_kg": 1}}, "run": {"torque_n_mm": 300}}
    with pytest.raises(gk.RecipeError) as caught:
        gk.load(placed({**BAR, "loads": loads}))
    assert [problem.key for problem in caught.value.problems] == ["mechanisms.bar.recipe.loads.run"]


@pytest.mark.parametrize(("angle", "stands"), [(0, True), (90, False)])
def test_a_walker_that_a_machine_turns_is_not_said_to_stand(angle, stands):
    machine = gk.load(placed(walker(), angle_deg=angle))
    checks = {check.id: check for check in machine.design_checks}
    assert checks["bar_support_margin"].passed == stands == np.isfinite(checks["bar_support_margin"].value)
    # Its feet carry its weight by statics only if it stands.
    assert ("bar_weight_carried" in checks) != stands
    assert bool(machine.recipes["bar"].aspect("loads").walking) == stands


@pytest.mark.parametrize("distance", [40.5, 41, 41.5])
def test_advised_shifts_of_a_ring_leave_teeth_that_do_not_jam(distance):
    table = {"kind": "internal-gear-pair", "centre_distance": distance, "pinion": {"teeth": 18, "module": 2},
             "ring": {"teeth": 60, "module": 2, "addendum": 0.8}}  # fmt: skip
    pair = gk.load(table).design
    shift = np.ceil(1000 * pair.shift_without_backlash) / 1000
    assert f"{shift:g}" in gk.load(table).notes["pair"]["backlash_advice"]
    table["ring"] = table["ring"] | {"profile_shift": shift}
    assert 0 <= gk.load(table).design.backlash < 0.01
