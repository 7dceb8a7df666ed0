"""Racks and trains under a load at their output, by virtual work, by forces along tangents, and by a limit."""

import json

import numpy as np
import pytest

import geomkin as gk
from geomkin.build import check_recipe
from geomkin.gear import GearRack, PairStrength, RackLoads, RackPair, RackStrength, TrainLoads, TrainStrength

POM = gk.making.material("POM")
STAGES = ((15, 45), (12, 48), (14, 29))


def loaded_train(friction=0.0, directions=(20.0, 250.0, 90.0), **factors):
    train = gk.GearTrain(STAGES, 2, directions, friction=friction)
    return TrainStrength(train, TrainLoads(output_torque_n_mm=900, **factors), 6, (POM,) * 6)


def test_torques_of_a_train_do_no_work_without_friction():
    loaded = loaded_train()
    turns = gk.gear.train_table(loaded.train)
    out = abs(turns["driven_3_turn"][-1])
    assert loaded.input_torque * turns["driver_1_turn"][-1] == pytest.approx(900 * out, rel=1e-12)


def test_friction_of_the_flanks_raises_the_input_torque_by_the_lost_work():
    """The lost work of each mesh, integrated along the path of contact as its pairs of flanks slide."""
    loaded = loaded_train(friction=0.05)
    shares = 1.0
    for stage, pair in zip(loaded.stages, loaded.train.pairs):
        start, end = pair.contact_lengths
        pitch = pair.first.base_pitch
        along = np.linspace(start, end, 40_001)
        pairs = sum((along + k * pitch >= start) & (along + k * pitch <= end) for k in (-2, -1, 0, 1, 2))
        pitch_point = pair.first.base_radius * np.tan(pair.working_pressure_angle)
        sliding = np.abs(along - pitch_point) * (1 / pair.first.base_radius + 1 / pair.second.base_radius)
        lost = 0.05 * stage.normal_force * np.trapezoid(sliding / pairs, along)
        shares *= 1 - lost / (stage.normal_force * pitch)
    assert loaded.input_torque == pytest.approx(loaded_train().input_torque / shares, rel=2e-3)


def test_loss_of_a_ring_and_its_pinion_is_that_of_the_sliding_along_the_path_of_contact():
    pair = gk.gear.InternalGearPair(gk.SpurGear(18, 2), gk.RingGear(60, 2, addendum=0.8))
    start, end = pair.contact_lengths
    pitch = pair.first.base_pitch
    along = np.linspace(start, end, 40_001)
    pairs = sum((along + k * pitch >= start) & (along + k * pitch <= end) for k in (-2, -1, 0, 1, 2))
    pitch_point = pair.first.base_radius * np.tan(pair.working_pressure_angle)
    # Both turn the same way.
    sliding = np.abs(along - pitch_point) * (1 / pair.first.base_radius - 1 / pair.second.base_radius)
    lost = np.trapezoid(sliding / pairs, along) / pitch
    assert gk.gear.loss_factor(pair) == pytest.approx(lost, rel=2e-3)


@pytest.mark.parametrize(
    ("driver", "fixed", "published"),
    [
        ("sun", "ring", lambda k, e: (1 + k * e) / (1 + k)),
        ("carrier", "ring", lambda k, e: (1 + k) / (1 + k / e)),
        ("ring", "sun", lambda k, e: (k + e) / (k + 1)),
        ("carrier", "sun", lambda k, e: (k + 1) / (k + 1 / e)),
        ("sun", "carrier", lambda k, e: e),
        ("ring", "carrier", lambda k, e: e),
    ],
)
def test_efficiency_of_a_planetary_set_is_the_published_one_of_its_members(driver, fixed, published):
    gears = gk.gear.PlanetarySet(gk.SpurGear(24, 2), gk.SpurGear(18, 2), gk.RingGear(60, 2, addendum=0.8))
    held = (1 - 0.1 * gk.gear.loss_factor(gears.inner)) * (1 - 0.1 * gk.gear.loss_factor(gears.outer))
    assert gears.efficiency(0.1, driver, fixed) == pytest.approx(published(60 / 24, held), rel=1e-12)
    assert gears.efficiency(0.0, driver, fixed) == pytest.approx(1)


def test_forces_on_the_arbors_act_along_tangents_of_the_base_circles():
    loaded = loaded_train()
    train = loaded.train
    # The force on a driven gear acts along the crossed tangent of both base circles that turns it against the driver.
    forces = np.zeros(4, complex)
    for k, (pair, torque) in enumerate(zip(train.pairs, loaded.torques)):
        span = train.axes[k + 1] - train.axes[k]
        reach = np.arccos((pair.first.base_radius + pair.second.base_radius) / abs(span))
        sides = [np.exp(1j * (np.angle(span) + side * reach)) for side in (1, -1)]
        turning = 1 if k % 2 == 0 else -1
        foot = sides[0 if turning < 0 else 1]
        push = torque / pair.first.base_radius * 1j * turning * foot
        # It resists the driver and turns the driven gear.
        at = train.axes[k] + pair.first.base_radius * foot
        for axis, force in ((train.axes[k], -push), (train.axes[k + 1], push)):
            assert np.imag(np.conj(at - axis) * force) * turning < 0
        forces[k] -= push
        forces[k + 1] += push
    assert np.abs(loaded.bearing_loads - forces).max() < 1e-9 * np.abs(forces).max()


def test_output_torque_at_the_limit_leaves_one_safety_at_its_limit():
    loaded = loaded_train(friction=0.1, application_factor=1.5)
    loads = TrainLoads(output_torque_n_mm=loaded.torque_limit, application_factor=1.5)
    at_limit = TrainStrength(loaded.train, loads, 6, (POM,) * 6)
    checks = [check for stage in at_limit.stages for check in gk.gear.strength_checks(stage)]
    assert min(check.value / check.limit for check in checks) == pytest.approx(1)


def test_a_rack_is_a_wheel_with_ever_more_teeth():
    pinion = gk.SpurGear(20, 2)
    rack = RackStrength(RackPair(pinion, GearRack(12, 2)), RackLoads(force_n=100), 6, (POM, POM))
    wheel = PairStrength(gk.GearPair(pinion, gk.SpurGear(10_000, 2)), 2000, 6, (POM, POM))
    for name in ("normal_force", "radial_force", "contact_pressure", "contact_safety"):
        assert getattr(rack, name) == pytest.approx(getattr(wheel, name), rel=2e-3)
    assert rack.teeth[0].root_stress == pytest.approx(wheel.teeth[0].root_stress, rel=2e-3)


def test_the_force_on_a_rack_does_the_work_of_the_pinion():
    recipe = gk.load("recipes/loaded-rack.toml")
    torque = recipe.notes["loads"]["pinion_torque_n_mm"]
    assert torque * 2 * np.pi == pytest.approx(20 * recipe.design.travel)
    assert {"pinion_root_safety", "contact_safety"} < {check.id for check in recipe.checks}


@pytest.mark.parametrize("kind", ("gear-train", "rack-and-pinion"))
def test_loads_need_a_material(kind):
    loads = {"output_torque_n_mm": 1} if kind == "gear-train" else {"force_n": 1}
    gears = {
        "gear-train": {"train": {"stages": [[20, 40]], "module": 1}},
        "rack-and-pinion": {"pinion": {"teeth": 20, "module": 1}, "rack": {"teeth": 9, "module": 1}},
    }
    with pytest.raises(gk.RecipeError) as refused:
        gk.load({"kind": kind, **gears[kind], "loads": loads})
    assert refused.value.problems[0].key == "stock.material"


@pytest.mark.campaign
def test_a_kind_without_forces_states_why(tmp_path):
    own = gk.load("recipes/lantern.toml")
    made = gk.make(own, tmp_path, ["page"])
    reason = own.forces_missing
    page, summary = ((tmp_path / "lantern" / name).read_text() for name in ("lantern.html", "summary.json"))
    assert reason in check_recipe(own).facts
    assert made.checks and reason in page and json.loads(summary)["loads"] == {"not_computed": reason}
