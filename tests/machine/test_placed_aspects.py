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
    for key in ("motor", "motors", "battery_wh", "carried"):
        del table["loads"][key]
    del table["files"]
    table["loads"]["foot_friction"] = 0.0
    return table


@pytest.mark.campaign
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


@pytest.mark.campaign
@pytest.mark.parametrize(("angle", "stands"), [(0, True), (90, False)])
def test_a_walker_that_a_machine_turns_is_not_said_to_stand(angle, stands):
    machine = gk.load(placed(walker(), angle_deg=angle))
    checks = {check.id: check for check in machine.torques.walking.checks}
    assert checks["support_margin"].passed == stands == np.isfinite(checks["support_margin"].value)
    # Its feet carry the weight of the machine by statics only if it stands.
    assert ("weight_carried" in checks) != stands
    assert bool(machine.recipes["bar"].aspect("loads").feet) == stands == bool(machine.torques.walking.walking)
    # The machine has these checks, and its mechanism none of its own.
    assert not [check.id for check in machine.recipes["bar"].aspect("foot").checks]


@pytest.mark.parametrize("distance", [40.5, 41, 41.5])
def test_advised_shifts_of_a_ring_leave_teeth_that_do_not_jam(distance):
    table = {"kind": "internal-gear-pair", "centre_distance": distance, "pinion": {"teeth": 18, "module": 2},
             "ring": {"teeth": 60, "module": 2, "addendum": 0.8}}  # fmt: skip
    pair = gk.load(table).design
    shift = np.ceil(1000 * pair.shift_without_backlash) / 1000
    assert f"{shift:g}" in gk.load(table).notes["pair"]["backlash_advice"]
    table["ring"] = table["ring"] | {"profile_shift": shift}
    assert 0 <= gk.load(table).design.backlash < 0.01


LOADED = {"masses": {"coupler": {"mass_kg": 0.4, "centre": [50, 5]}, "rocker": {"mass_kg": 0.6, "centre": [35, 0]}}}


@pytest.mark.parametrize("speed", [60, -60])
def test_copies_of_a_linkage_are_mechanisms_of_a_machine_on_its_shaft(speed):
    """A crank that is 60 deg ahead of the first one's in a mirrored copy is at 180 - 60 deg, seen from its front."""
    copied = gk.load({**BAR, "loads": LOADED, "copies": [{"phase_deg": 40}, {"mirrored": True, "phase_deg": 60}]})
    bar = {"recipe": {**BAR, "loads": LOADED}}
    turned = {"turned_by": "first.crank"}
    machine = gk.load({"kind": "machine", "drive": {"speed_rpm": speed},
                       "mechanisms": {"first": bar, "second": {**bar, **turned, "phase_deg": 40},
                                      "third": {**bar, **turned, "mirrored": True, "phase_deg": 120}}})  # fmt: skip
    turn = 2 * np.pi * machine.turns
    bodies = {body.name: body for body in copied.scene_at(turn).bodies}
    placed = {body.name: body for body in machine.scene.bodies}
    for name, suffix in (("first", ""), ("second", ", copy 2"), ("third", ", copy 3")):
        for body in ("ground", "crank", "coupler", "rocker"):
            one, other = bodies[body + suffix], placed[f"{name}/{body}"]
            for part, twin in zip(one.parts, other.parts):
                points = [curve.point(np.array([curve.breaks[0]])) for curve in (part.outline, twin.outline)]
                at = [np.asarray(b.origin) + np.asarray(b.direction) * z for b, z in zip((one, other), points)]
                assert at[0] == pytest.approx(at[1], abs=1e-9)
    # The copied linkage in the setting of the machine.
    setting = gk.recipe.aspect.Setting(speed * np.pi / 30, 0.0)
    torque = copied.in_setting(setting).torque_at(turn)
    assert machine.torques.input == pytest.approx(torque, abs=1e-9 * np.abs(torque).max())


@pytest.mark.campaign
def test_mirrored_mechanisms_are_made_and_certified(tmp_path):
    machine = gk.load(placed(BAR, mirrored=True, angle_deg=30) | {"files": {"write": ["dxf", "assembly-dxf"]}})
    gk.make(machine, tmp_path)
    assert all(certificate.passed for certificate in gk.verify(tmp_path))
    assert np.isfinite([handle.at[0] for handle in machine.handles]).all()


@pytest.mark.parametrize("units", ["mm", "in"])
def test_the_dwell_of_a_mechanism_is_that_which_it_has_alone(units):
    f = {"mm": 1, "in": 1 / 25.4}[units]
    crank = {"kind": "slider-crank", "linkage": {"crank": 20 * f, "coupler": 70 * f}, "dwell": {"band_mm": 0.5}}
    pair = {"kind": "gear-pair", "first": {"teeth": 20, "module": 2 * f}, "second": {"teeth": 30, "module": 2 * f}}
    pump = {"recipe": crank, "turned_by": "pair.second"}
    table = {"kind": "machine", "units": units, "mechanisms": {"pair": {"recipe": pair}, "pump": pump}}
    machine, alone = gk.load(table), gk.load({"units": units, **crank})
    found = machine.notes["results_of_mechanisms"]["pump"]["dwell"]
    assert found["driver_range_deg"] == pytest.approx(alone.notes["dwell"]["driver_range_deg"], rel=1e-6)
    assert machine.quantities["pump: dwell of slider"].split()[0] == alone.quantities["dwell of slider"].split()[0]
