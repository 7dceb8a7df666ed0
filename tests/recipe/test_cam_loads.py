"""The table `[loads]` of a cam's recipe, against Newton's law and virtual work with differences of the written motion."""

import numpy as np
import pytest

import geomkin as gk

LIFTS = [
    {"kind": "rise", "law": "3-4-5", "rise": 16, "end_deg": 140},
    {"kind": "dwell", "end_deg": 180},
    {"kind": "return", "law": "cycloidal", "end_deg": 360},
]
SWINGS = [{"rise_deg" if key == "rise" else key: value for key, value in lift.items()} for lift in LIFTS]
ROLLER = {"kind": "translating-roller", "roller_radius": 10, "offset": 4}
ARM = {"kind": "oscillating-roller", "roller_radius": 10, "pivot_distance": 95, "arm_length": 80}
DRIVE = {"speed_rpm": 400, "step_deg": 0.2}
SPRING = {"follower": {"mass_kg": 0.5}, "spring_rate_n_per_mm": 0.8, "preload_n": 60, "force_n": 7}


def cam(loads, follower=ROLLER, **more):
    shape = {"base_radius": 40, "follower": follower, "program": SWINGS if "pivot_distance" in follower else LIFTS}
    return gk.load({"kind": "disk-cam", "cam": shape | more.pop("cam", {}), "drive": DRIVE, "loads": loads, **more})


def check(recipe, id):
    return next(check for check in recipe.checks if check.id == id)


def test_the_contact_force_accelerates_the_follower_against_spring_force_and_weight():
    table = cam(SPRING).table
    lift, step = table["lift"], table["time"][1]
    accelerated = 1e-3 * 0.5 * np.diff(lift, 2) / step**2
    pull = accelerated + 0.8 * lift[1:-1] + 60 + 7 + 0.5 * 9.81
    # The normal runs from the contact to the roller's centre, whose height is the lift above the lowest one.
    height = np.sqrt(50**2 - 4**2) + lift - table["contact_y"]
    assert table["contact_force"][1:-1] * height[1:-1] / 10 == pytest.approx(pull, rel=1e-3)
    # The joints of the programme aside, where the acceleration's slope jumps.
    power = table["camshaft_torque"][1:-1] * np.radians(0.2)
    assert power == pytest.approx(pull * (lift[2:] - lift[:-2]) / 2, abs=1e-3 * np.abs(power).max())


def test_the_torque_is_the_gain_of_energy_of_all_parts_of_an_arm():
    """Kinetic and potential energy of the parts at their places in the scene, and the energy of the spring."""
    loads = {"spring_rate_n_mm_per_rad": 9000, "preload_n_mm": 2500, "torque_n_mm": 300, "gravity_m_per_s2": [2, -9]}
    recipe = cam(loads, ARM, stock={"material": "steel-S235"}, base={})
    table, step = recipe.table, recipe.table["time"][1]
    swing = np.radians(table["lift"])
    energy = 4500 * swing**2 + (2500 + 300) * swing
    moving = [body for body in recipe.scene.bodies if body.name in ("arm", "roller")]
    assert len(moving) == 2
    for body in moving:
        mass = recipe.body_masses[body.name]
        place = body.origin + body.direction * mass.centre
        speed = np.gradient(place, step, edge_order=2)
        turning = np.gradient(np.unwrap(np.angle(body.direction)), step, edge_order=2)
        energy = energy + 5e-4 * (mass.mass * np.abs(speed) ** 2 + mass.inertia * turning**2)
        energy = energy - mass.mass * np.real(place * np.conj(2 - 9j))
    torque = np.gradient(energy, np.radians(table["cam_angle"]))
    assert table["camshaft_torque"][5:-5] == pytest.approx(torque[5:-5], abs=2e-3 * np.abs(torque).max())


@pytest.mark.parametrize("key", ["preload_n", "spring_rate_n_per_mm"])
def test_the_least_spring_of_the_summary_just_keeps_the_follower_on_the_cam(key):
    loose = SPRING | {"preload_n": 0.1, "spring_rate_n_per_mm": 0.1, "force_n": 0}
    fast = {"drive": {"speed_rpm": 600}}
    lost = cam(loose, **fast)
    assert not check(lost, "follower_contact").passed
    least = lost.notes["loads"][f"least_{key.replace('_n', '_N')}"]
    for factor, holds in ((1.001, True), (0.999, False)):
        assert check(cam(loose | {key: factor * least}, **fast), "follower_contact").passed == holds


def test_the_follower_leaves_the_cam_above_the_jump_speed_of_the_summary():
    speed = cam(SPRING).notes["loads"]["jump_speed_rpm"]
    for factor, holds in ((0.999, True), (1.001, False)):
        recipe = cam(SPRING, drive={"speed_rpm": factor * speed})
        kept = check(recipe, "follower_contact")
        assert kept.passed == holds and recipe.table["contact_force"].min() == pytest.approx(kept.value, abs=0.05)


def test_pressure_and_safety_of_a_round_cam_are_those_of_roark():
    """Roark's Formulas for Stress and Strain: 0.591 sqrt(load per length x E / diameter); yield at shear of half of it."""
    loads = {"follower": {"mass_kg": 0}, "preload_n": 600}
    still = {"program": [{"kind": "dwell", "end_deg": 360}], "follower": ROLLER | {"offset": 0}}
    recipe = cam(loads, cam=still, stock={"thickness": 8, "material": "steel-S235"})
    pressure = 0.591 * np.sqrt(600 / 8 * 210_000 / (80 * 20 / 100))
    assert recipe.table["contact_pressure"] == pytest.approx(pressure, rel=1e-3)
    assert check(recipe, "contact_safety").value == pytest.approx(0.5 * 235 / 0.3003 / pressure, rel=1e-3)
    assert "contact_pressure" not in cam(loads, cam=still).table.ids


def test_a_short_guide_jams_and_a_long_one_does_not():
    steep = {"base_radius": 12, "program": [LIFTS[0] | {"rise": 30, "end_deg": 70}, LIFTS[2]]}
    shares = []
    for length in (8, 200):
        recipe = cam(SPRING | {"friction": {"coefficient": 0.4, "length": length, "overhang": 40}}, cam=steep)
        share = check(recipe, "guide_share")
        assert np.isnan(recipe.table["contact_force"]).any() == (share.value <= 0)
        shares.append(share.value)
    assert shares[0] < 0 < shares[1] < 1


def test_where_the_velocity_jumps_the_force_is_unknown_and_contact_is_lost():
    uniform = [{"kind": "rise", "law": "uniform", "rise": 9, "end_deg": 180}, LIFTS[2]]
    recipe = cam(SPRING, cam={"program": uniform})
    table = recipe.table
    unknown = np.isnan(table["contact_force"]) & np.isnan(table["camshaft_torque"])
    assert table["cam_angle"][unknown] == pytest.approx([0, 180, 360])
    assert not check(recipe, "follower_contact").passed and recipe.notes["loads"]["jump_speed_rpm"] == 0


def test_the_arrow_is_the_contact_force():
    recipe = cam(SPRING)
    (arrow,) = [mark for mark in recipe.scene.marks if mark.role == "force"]
    scale = np.abs(arrow.vector) / recipe.table["contact_force"]
    assert scale == pytest.approx(scale[0], rel=1e-9)
    assert f"{1 / scale[0]:.3g}" in arrow.label
    centre = 4 + 1j * (np.sqrt(50**2 - 4**2) + recipe.table["lift"])
    assert np.abs(np.angle(arrow.vector / (centre - arrow.place))).max() < 1e-9


def test_a_scaled_cam_keeps_its_forces_and_multiplies_its_torque():
    """The lift doubles and the rate of the spring halves; at a crawl inertia is nothing."""
    slow = {"speed_rpm": 0.01, "step_deg": 5}
    one, two = (cam(SPRING, drive=slow, scale=scale).table for scale in (1, 2))
    assert two["contact_force"] == pytest.approx(one["contact_force"], rel=1e-9)
    assert two["camshaft_torque"] == pytest.approx(2 * one["camshaft_torque"], rel=1e-9, abs=1e-9)


def test_the_named_motor_is_judged_by_its_torque_at_the_speed():
    recipe = cam(SPRING | {"motor": "nema23"}, drive={"speed_rpm": 200, "step_deg": 1})
    peak = np.abs(recipe.table["camshaft_torque"]).max()
    # Half of the holding torque of 1240 N mm over the peak, which is between two rows; the root mean square is smaller.
    assert 620 / (1.0001 * peak) < check(recipe, "motor_torque").value <= 620 / peak
    assert recipe.notes["loads"]["motor"]["motor"] == "nema23"


@pytest.mark.parametrize(
    ("loads", "follower", "key", "id"),
    [
        ({"preload_n_mm": 5}, ROLLER, "loads.preload_n_mm", "conflict"),
        ({"spring_rate_n_per_mm": 5}, ARM, "loads.spring_rate_n_per_mm", "conflict"),
        ({"force_n": -5}, ARM, "loads.force_n", "conflict"),
        ({"friction": {"coefficient": 0.1, "length": 40, "overhang": 40}}, ARM, "loads.friction", "conflict"),
        (
            {"friction": {"coefficient": 0.1, "length": 40, "overhang": 15}},
            ROLLER, "loads.friction.overhang", "out-of-range",
        ),
        ({"gravity_m_per_s2": [0, -9810]}, ROLLER, "loads.gravity_m_per_s2[1]", "out-of-range"),
    ],
)  # fmt: skip
def test_loads_that_do_not_suit_the_follower_are_refused(loads, follower, key, id):
    with pytest.raises(gk.RecipeError) as error:
        cam({"follower": {"mass_kg": 0.5}} | loads, follower)
    assert [(problem.key, problem.id) for problem in error.value.problems] == [(key, id)]


@pytest.mark.parametrize("stock", [{}, {"material": "POM"}])
def test_a_follower_of_unknown_mass_is_refused(stock):
    """Without a base a straight roller has no stem."""
    with pytest.raises(gk.RecipeError) as error:
        cam({"preload_n": 20}, stock=stock)
    assert [(problem.key, problem.id) for problem in error.value.problems] == [("loads.follower", "missing-key")]
    assert cam({"preload_n": 20}, stock={"material": "POM"}, base={}).aspect("loads").loads.mass.mass > 0
