"""Ratchets: polygons that turn past each other, statics with friction, central differences, refusals, machines."""

import numpy as np
import pytest
import shapely

import geomkin as gk
from geomkin.core.errors import DesignError, RecipeError
from geomkin.recipe.load import from_table
from tests.gallery import named, recipe, seen

RATCHETS = [
    {"diameter": 80, "teeth": 24, "pawl_length": 45},
    {"diameter": 80, "teeth": 12, "pawl_length": 45, "depth": 3},
    {"diameter": 60, "teeth": 40, "pawl_length": 30, "pivot_deg": 5, "undercut_deg": 10},
    {"diameter": 200, "teeth": 60, "pawl_length": 100, "undercut_deg": 20, "nose_radius": 0.2},
    {"diameter": 100, "teeth": 8, "pawl_length": 70, "depth": 4, "undercut_deg": 12, "gap": 2},
    {"diameter": 100, "teeth": 150, "pawl_length": 70, "undercut_deg": 25, "pivot_deg": -10, "nose_radius": 0.1},
]


def polygon(z):
    return shapely.Polygon(np.column_stack([z.real, z.imag]))


def shapes(ratchet):
    """Wheel and pawl as functions of their rotations from where the pawl holds a tooth: that of the pawl is its lift."""
    wheel, pawl = (gk.flatten(curve, 1e-4) for curve in (ratchet.outline, ratchet.pawl.outline))
    return (
        lambda turn: polygon(wheel * np.exp(1j * turn)),
        lambda lift: polygon(ratchet.pivot + pawl * np.exp(-1j * lift)),
    )


@pytest.mark.parametrize("given", RATCHETS)
def test_the_pawl_lies_on_the_teeth_and_enters_none(given):
    ratchet = gk.ratchet.Ratchet(**given)
    wheel, pawl = shapes(ratchet)
    assert wheel(0).is_valid and pawl(0).is_valid
    for turn in np.linspace(0, 2 * ratchet.pitch, 31)[:-1]:
        teeth, lift = wheel(ratchet.backlash + turn), float(ratchet.lift(turn))
        assert teeth.intersection(pawl(lift)).area < 1e-9 and teeth.distance(pawl(lift)) < 2e-4
        assert teeth.intersection(pawl(lift - 1e-3)).area > 0


@pytest.mark.parametrize("given", RATCHETS)
def test_the_pawl_drops_freely_once_a_tooth_has_passed_by_the_backlash_and_not_before(given):
    ratchet = gk.ratchet.Ratchet(**given)
    wheel, pawl = shapes(ratchet)
    low, high = float(ratchet.lift(0.0)), ratchet.lifts[1]
    path = np.linspace(low, high, 25)[1:-1]
    assert ratchet.backlash > 0 and high > low
    after, before = (wheel(ratchet.pitch + share * ratchet.backlash) for share in (1.001, 0.97))
    assert max(after.intersection(pawl(lift)).area for lift in path) < 1e-9
    assert max(before.intersection(pawl(lift)).area for lift in path) > 0


@pytest.mark.parametrize("given", RATCHETS)
def test_a_held_tooth_lies_on_the_pawl_with_its_face(given):
    ratchet = gk.ratchet.Ratchet(**given)
    wheel, pawl = shapes(ratchet)
    face = abs(ratchet.tip - ratchet.root)
    common = wheel(0).boundary.buffer(1e-4).intersection(pawl(0).boundary).length
    assert face - 4 * ratchet.nose_radius < common < face + ratchet.nose_radius
    # Turned back by any angle it meets the pawl, however this is lifted within the tooth.
    assert all(wheel(-1e-3).intersection(pawl(lift)).area > 0 for lift in (0, ratchet.lifts[1] / 4))


@pytest.mark.parametrize("given", RATCHETS)
def test_derivative_of_the_lift_is_a_central_difference(given):
    ratchet = gk.ratchet.Ratchet(**given)
    turn, h = np.random.default_rng(1).uniform(0, 3 * ratchet.pitch, 200), 1e-7
    turn = turn[np.abs(turn / ratchet.pitch - np.round(turn / ratchet.pitch)) > 1e-3]
    central = (ratchet.lift(turn + h) - ratchet.lift(turn - h)) / (2 * h)
    near = np.abs(central - ratchet.lift_ratio(turn)) < 1e-5
    # It jumps where the nose comes to a tip.
    assert near.mean() > 0.98


@pytest.mark.parametrize(("friction", "angle"), [(0.15, 8.53), (0.2, 11.31), (0.3, 16.70), (0.4, 21.80)])
def test_a_pawl_draws_itself_in_above_the_angle_of_friction(friction, angle):
    """Moment about the pivot of the force on the pawl, whose friction resists a pawl that slides into the tooth."""
    for degrees in (angle - 0.02, angle + 0.02):
        for pivot in (-3, 0, 4):
            given = {**RATCHETS[0], "friction": friction, "undercut_deg": degrees - pivot, "pivot_deg": pivot}
            own = from_table({"kind": "ratchet", "ratchet": given})
            tooth = own.ratchet.tip - own.ratchet.root
            outwards = tooth / abs(tooth)
            force = -1j * outwards + friction * outwards
            moment = np.imag(np.conj(own.ratchet.tip - own.ratchet.pivot) * force)
            (check,) = (check for check in own.checks if check.id == "self_engagement")
            assert (moment > 0) == check.passed == (degrees > angle)


def test_advice_of_a_pawl_that_slips_is_followed():
    own = from_table({"kind": "ratchet", "ratchet": {**RATCHETS[0], "friction": 0.35}})
    check = next(check for check in own.checks if check.id == "self_engagement")
    least = float(check.advice.rpartition(" ")[2])
    better = from_table({"kind": "ratchet", "ratchet": {**RATCHETS[0], "friction": 0.35, "undercut_deg": least}})
    assert not check.passed and all(check.passed for check in better.checks)


REFUSED = {
    "ratchet.teeth": {"teeth": 7},
    "ratchet.undercut_deg": {"undercut_deg": 5, "pivot_deg": -5},
    "ratchet.depth": {"depth": 12},
    "ratchet.depth ": {"depth": 39},
    "ratchet.pawl_length": {"pawl_length": 20},
    "ratchet.pawl_length ": {"pawl_length": 2000},
    "ratchet.nose_radius": {"nose_radius": 3},
    "ratchet.gap": {"teeth": 8, "depth": 4, "undercut_deg": 12, "pawl_length": 70},
    "ratchet.pivot_deg": {"pivot_deg": 38, "undercut_deg": 5},
    "drive.speed_rpm": {"drive": {"speed_rpm": -10}},
    "stock.pin": {"stock": {"pin": 12}},
    "stock.bore": {"stock": {"bore": 79}},
    "stock.spring": {"stock": {"spring": 1}},
}


@pytest.mark.parametrize("key", REFUSED)
def test_refused_values_are_named(key):
    given = {**RATCHETS[0], **REFUSED[key]}
    tables = {name: given.pop(name) for name in ("drive", "stock") if name in given}
    with pytest.raises((RecipeError, DesignError)) as caught:
        from_table({"kind": "ratchet", "ratchet": given, **tables}).parts
    error = caught.value
    assert (error.field if isinstance(error, DesignError) else error.problems[0].key) == key.strip()


def test_the_advised_length_of_a_pawl_works():
    with pytest.raises(DesignError) as caught:
        gk.ratchet.Ratchet(80, teeth=24, pawl_length=10, pivot_deg=3)
    gk.ratchet.Ratchet(80, teeth=24, pawl_length=caught.value.value, pivot_deg=3)


@pytest.mark.parametrize("seed", range(6))
def test_ratchets_that_are_accepted_turn_freely(seed):
    random, made = np.random.default_rng(seed), 0
    while made < 3:
        given = {"diameter": 20, "teeth": int(random.integers(8, 60)), "pawl_length": 10 ** random.uniform(0.5, 1.7),
                 "undercut_deg": random.uniform(0, 40), "pivot_deg": random.uniform(-20, 20),
                 "nose_radius": 10 ** random.uniform(-2, 0), "pawl_width": 10 ** random.uniform(-1, 0.7),
                 "gap": 10 ** random.uniform(-3, 0), "depth": 10 ** random.uniform(-1, 0.5)}  # fmt: skip
        try:
            ratchet = gk.ratchet.Ratchet(**given)
        except DesignError:
            continue
        made += 1
        wheel, pawl = shapes(ratchet)
        for turn in np.linspace(0, ratchet.pitch, 9)[:-1]:
            teeth, nose = wheel(ratchet.backlash + turn), pawl(float(ratchet.lift(turn)))
            assert nose.is_valid and teeth.intersection(nose).area < 1e-4 and teeth.distance(nose) < 5e-4


def test_force_on_the_pawl_does_the_work_of_the_torque():
    own = recipe("ratchet")
    middle = (own.ratchet.tip + own.ratchet.root) / 2
    turned = middle * np.exp(-1e-6j) - middle
    normal = -1j * own.ratchet.face
    along = float(np.real(np.conj(normal) * turned))
    assert own.aspect("loads").force * along == pytest.approx(own.loads.torque_n_mm * 1e-6, rel=1e-5)


def test_the_spring_is_stretched_as_the_pawl_is_lifted():
    own = recipe("ratchet")
    turn = np.linspace(0, own.ratchet.pitch, 50, endpoint=False)
    order = np.argsort(own.ratchet.lift(turn))
    lengths = own.plates.spring_length(turn)[order]
    assert np.diff(lengths).min() >= 0 and lengths[0] == pytest.approx(own.stock.spring, abs=0.5)
    assert from_table({"kind": "ratchet", "ratchet": RATCHETS[0], "stock": {"spring": 0}}).parts[1].hole_names == ("B",)


@pytest.mark.parametrize("given", RATCHETS[:3])
def test_a_spring_is_so_long_that_its_pin_in_the_base_clears_the_pawl(given):
    stock = {"spring_pin": 3, "clearance": 0}
    with pytest.raises(RecipeError) as caught:
        from_table({"kind": "ratchet", "ratchet": given, "stock": {**stock, "spring": 1}})
    (problem,) = caught.value.problems
    own = from_table({"kind": "ratchet", "ratchet": given, "stock": {**stock, "spring": float(problem.value)}})
    pin = shapely.Point(own.plates.post.real, own.plates.post.imag)
    turns = np.linspace(0, own.ratchet.pitch, 40)
    near = min(shapes(own.ratchet)[1](float(own.ratchet.lift(turn))).distance(pin) for turn in turns)
    assert near == pytest.approx(1.5, abs=2e-3)


def test_scene_moves_the_parts_that_are_cut():
    own = recipe("ratchet")
    scene = own.scene
    for frame in range(0, len(scene.time), 7):
        wheel, pawl = (seen(named(scene, name), frame) for name in ("wheel", "pawl"))
        assert wheel.intersection(pawl).area < 1e-6 and wheel.distance(pawl) < 1e-3
    first, last = (seen(named(scene, "wheel"), frame) for frame in (0, -1))
    assert first.symmetric_difference(last).area < 1e-6


@pytest.mark.parametrize(("upside_down", "mirrored"), [(False, True), (True, False)])
def test_a_shaft_of_a_machine_turns_it_and_one_that_turns_it_back_fails_a_check(upside_down, mirrored):
    pair = {"kind": "gear-pair", "first": {"teeth": 12, "module": 2, "profile_shift": 0.3},
            "second": {"teeth": 36, "module": 2}}  # fmt: skip
    own = {"kind": "ratchet", "ratchet": RATCHETS[0], "loads": {"torque_n_mm": 100}}
    placed = {"recipe": own, "turned_by": "pair.second", "angle_deg": 50, "upside_down": upside_down,
              "mirrored": mirrored}  # fmt: skip
    machine = from_table({"kind": "machine", "mechanisms": {"pair": {"recipe": pair}, "winch": placed}})
    wheel = np.unwrap(np.angle(named(machine.scene, "winch/wheel").direction))
    check = next(check for check in machine.checks if "free_direction" in check.id)
    # Seen from the side on which its pawl holds it against turning clockwise.
    free = wheel[-1] > wheel[0] if not mirrored else wheel[-1] < wheel[0]
    assert check.passed == free
    assert check.passed == mirrored


def test_the_wheel_loses_at_least_the_backlash_and_at_most_a_tooth_more():
    own = recipe("ratchet")
    lost, angle = own.table["lost_angle"], own.table["wheel_angle"]
    backlash, pitch = np.degrees(own.ratchet.backlash), 360 / own.ratchet.teeth
    assert lost.min() == pytest.approx(backlash) and lost.max() < backlash + pitch
    held = (angle + backlash - lost) / pitch
    assert held == pytest.approx(np.round(held), abs=1e-9)
