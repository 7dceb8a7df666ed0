"""Torques and forces of a loaded planetary set, by virtual work and by equilibrium along tangents of the base circles."""

from itertools import permutations

import numpy as np
import pytest

import geomkin as gk

GEARS = {
    "planets": 3,
    "sun": {"teeth": 24, "module": 2},
    "planet": {"teeth": 18, "module": 2},
    "ring": {"teeth": 60, "module": 2, "addendum": 0.8},
}
POM = {"material": "POM"}


def planetary(torque=900.0, gears=GEARS, **more):
    stocks = {"sun_stock": POM, "planet_stock": POM | {"thickness": 5}, "ring_stock": POM | {"rim": 12}}
    return gk.load({"kind": "planetary", "gears": gears, "loads": {"torque_n_mm": torque}, **stocks, **more})


def test_torques_do_no_work_and_balance():
    recipe = planetary()
    torques = recipe.notes["loads"]["torque_n_mm"]
    turned = recipe.table["sun_angle"][-1], recipe.table["carrier_angle"][-1]
    assert torques["sun"] == 900 and torques["sun"] * turned[0] + torques["carrier"] * turned[1] == pytest.approx(0)
    assert sum(torques.values()) == pytest.approx(0, abs=1e-6)


@pytest.mark.parametrize(("driver", "fixed"), list(permutations(("sun", "carrier", "ring"), 2)))
def test_torques_do_no_work_whichever_member_drives(driver, fixed):
    """The driver's torque is that of the loads; the planets carry the same force as in the set whose sun drives."""
    recipe = planetary(driver=driver, fixed=fixed)
    loads, table = recipe.notes["loads"], recipe.table
    torques = loads["torque_n_mm"]
    assert torques[driver] == 900 and sum(torques.values()) == pytest.approx(0, abs=1e-5)
    turned = {name: table[f"{name}_angle"][-1] for name in torques if name != fixed}
    assert sum(torques[name] * turn for name, turn in turned.items()) == pytest.approx(0, abs=1e-3)
    # One rotation of the slower one.
    assert min(map(abs, turned.values())) == pytest.approx(360)
    by_sun = planetary(torque=abs(torques["sun"])).aspect("loads").meshes.strength
    assert recipe.aspect("loads").meshes.strength.planet_bearing_load == pytest.approx(by_sun.planet_bearing_load)
    assert recipe.aspect("loads").meshes.strength.torque_limit / 900 == pytest.approx(
        by_sun.torque_limit / abs(torques["sun"])
    )


def test_the_scene_moves_the_members_of_the_table():
    recipe = planetary(driver="carrier", fixed="sun")
    bodies = {body.name: np.unwrap(np.angle(body.direction)) for body in recipe.scene.bodies}
    for name in ("carrier", "ring"):
        assert np.degrees(np.ptp(bodies[name])) == pytest.approx(np.ptp(recipe.table[f"{name}_angle"]))
    assert np.ptp(bodies["sun"]) == 0
    assert list(recipe.rotating_bodies) == ["carrier", "ring"]


@pytest.mark.parametrize(
    ("more", "key"),
    [
        ({"driver": "ring"}, "fixed"),
        ({"fixed": "carrier", "base": {}}, "base"),
        ({"driver": "carrier", "sun_stock": {"motor": "nema17", "thickness": 20} | POM}, "sun_stock.motor"),
        ({"gears": GEARS | {"planet": {"teeth": 18, "module": 3}}}, "gears.planet.module"),
    ],
)
def test_sets_that_cannot_be_made_are_refused_by_key(more, key):
    with pytest.raises(gk.RecipeError) as caught:
        gk.load({"kind": "planetary", "gears": GEARS} | more)
    assert caught.value.problems[0].key == key


def shifted():
    """A ring whose working pressure angle differs from that of the sun, with its profile shift from the refusal."""
    gears = GEARS | {"sun": {"teeth": 13, "module": 2, "profile_shift": 0.4}}
    gears |= {"planet": {"teeth": 19, "module": 2, "profile_shift": 0.2}}
    ring = {"teeth": 53, "module": 2, "addendum": 0.7}
    with pytest.raises(gk.RecipeError) as refused:
        planetary(gears=gears | {"ring": ring})
    shift = float(refused.value.problems[0].remedy.removeprefix("give "))
    return gears | {"ring": ring | {"profile_shift": shift}}


def test_tips_of_a_shifted_set_get_full_clearance_in_both_meshes():
    plain, shortened = (planetary(gears=shifted(), tips=tips).design for tips in ("given", "full-clearance"))
    rooms = [room for mesh in (shortened.inner, shortened.outer) for room in mesh.clearances]
    assert min(rooms) == pytest.approx(0.5) and min(plain.inner.clearances) < 0.5 - 1e-3
    assert shortened.inner.centre_distance == plain.inner.centre_distance


@pytest.mark.parametrize("make", [lambda: GEARS, shifted], ids=["plain", "shifted"])
def test_the_bearing_of_a_planet_balances_the_forces_on_its_teeth(make):
    recipe = planetary(gears=make())
    sun, planet, ring = (getattr(recipe.design, name) for name in ("sun", "planet", "ring"))
    distance = recipe.design.inner.centre_distance
    # The force lies on a common tangent of two base circles: between sun and planet, and beside planet and ring. Their
    # levers about the planet's axis are equal, so that both forces are.
    force = 900 / 3 / sun.base_radius
    between = np.arccos((sun.base_radius + planet.base_radius) / distance)
    beside = np.arccos((ring.base_radius - planet.base_radius) / distance)
    on_planet = force * 1j * (np.exp(-1j * between) + np.exp(1j * beside))
    loads = recipe.notes["loads"]
    assert loads["planet_bearing_load_N"] == pytest.approx(abs(on_planet), rel=1e-8)
    for mesh in ("sun_and_planet", "planet_and_ring"):
        forces = loads[mesh]["tangential_force_N"], loads[mesh]["radial_force_N"]
        assert np.hypot(*forces) == pytest.approx(force, rel=1e-8)
    # All planets together turn the carrier against its load.
    assert -3 * distance * on_planet.imag == pytest.approx(loads["torque_n_mm"]["carrier"], rel=1e-8)


def test_the_torque_limit_of_the_summary_is_where_the_first_check_fails():
    limit = planetary().notes["loads"]["torque_limit_n_mm"]
    for factor, holds in ((0.9999, True), (1.0001, False)):
        checks = [check for check in planetary(factor * limit).checks if check.id.endswith("_safety")]
        assert len(checks) == 5 and all(check.passed for check in checks) == holds


def test_the_bearing_of_the_sun_carries_the_force_of_a_single_planet_only():
    single = planetary(gears=GEARS | {"planets": 1}).notes["loads"]["sun_bearing_load_N"]
    assert single == pytest.approx(900 / (24 * np.cos(np.radians(20))))
    assert planetary().notes["loads"]["sun_bearing_load_N"] == 0


def test_a_missing_material_is_named_and_helical_teeth_state_why_strength_is_missing():
    with pytest.raises(gk.RecipeError) as error:
        planetary(ring_stock={"rim": 12})
    assert [(problem.key, problem.id) for problem in error.value.problems] == [("ring_stock.material", "missing-key")]
    assert planetary(helix_angle_deg=15).forces_missing


def test_the_least_torque_of_the_key_is_enough_for_each_planet():
    least, usual = (planetary(torque).notes["loads"]["planet_bearing_load_N"] for torque in (1e-12, 900.0))
    assert least == pytest.approx(usual * 1e-12 / 900)
