"""Loads of mechanisms that a machine turns, at its speed and angle, against formulas of their own."""

from pathlib import Path

import numpy as np
import pytest

import geomkin as gk
from geomkin.core.errors import RecipeError

CASES = Path(__file__).parents[1] / "cases"
PAIR = {"recipe": {"kind": "gear-pair", "first": {"teeth": 12, "module": 2, "profile_shift": 0.3},
                   "second": {"teeth": 24, "module": 2}}}  # fmt: skip
MASS, GRAVITY = 0.7, 9.81
PUMP = {"kind": "slider-crank", "linkage": {"crank": 20, "coupler": 70}, "drive": {"speed_rpm": 30},
        "loads": {"masses": {"slider": {"mass_kg": MASS}}}}  # fmt: skip
RISE = [{"kind": "rise", "law": "cycloidal", "rise": 12, "end_deg": 150},
        {"kind": "return", "law": "cycloidal", "end_deg": 360}]  # fmt: skip
PLACES = [(60, 0, 0), (60, 90, 0), (600, 0, 0), (600, 37, 20), (-300, -120, 20)]


def cam(direction, loads, **more):
    follower = {"kind": "translating-roller", "roller_radius": 8}
    shape = {"base_radius": 30, "follower": follower, "program": RISE, "direction": direction}
    return {"kind": "disk-cam", "cam": shape, "loads": {"follower": {"mass_kg": MASS}, **loads}, **more}


def placed(recipe, speed, angle=0, phase=0):
    body = {"recipe": recipe, "turned_by": "pair.second", "angle_deg": angle, "phase_deg": phase}
    return gk.load({"kind": "machine", "mechanisms": {"pair": PAIR, "body": body}, "drive": {"speed_rpm": speed}})


def cycloidal_motion(angle):
    """Lift with its first two derivatives by the cam angle; lifts in mm, angles in rad."""
    up, width = angle < np.radians(150), np.radians(np.where(angle < np.radians(150), 150, 210))
    share = np.where(up, angle, angle - np.radians(150)) / width
    lift = 12 * (share - np.sin(2 * np.pi * share) / (2 * np.pi))
    velocity = 12 / width * (1 - np.cos(2 * np.pi * share))
    acceleration = 12 / width**2 * 2 * np.pi * np.sin(2 * np.pi * share)
    return np.where(up, lift, 12 - lift), np.where(up, velocity, -velocity), np.where(up, acceleration, -acceleration)


@pytest.mark.parametrize(("speed", "angle", "phase"), PLACES)
def test_slider_of_a_pump_has_the_speed_and_the_weight_of_its_place_in_the_machine(speed, angle, phase):
    made = placed(PUMP, speed, angle, phase)
    turn, rate = -made.turns * np.pi + np.radians(phase), -speed / 2 * np.pi / 30
    sine, cosine = np.sin(turn), np.cos(turn)
    s = np.sqrt(70**2 - 20**2 * sine**2)
    first = -20 * sine - 20**2 * sine * cosine / s
    second = -20 * cosine - 20**2 * (cosine**2 - sine**2) / s - 20**4 * sine**2 * cosine**2 / s**3
    force = MASS * (1e-3 * second * rate**2 + GRAVITY * np.sin(np.radians(angle)))
    assert made.torques.input == pytest.approx(-0.5 * force * first, abs=3e-10 * np.abs(force * first).max())


@pytest.mark.parametrize("direction", ["clockwise", "counterclockwise"])
@pytest.mark.parametrize(("speed", "angle", "phase"), [(120, 90, 0), (-600, 0, 0), (-600, 60, 15)])
def test_follower_of_a_cam_has_the_speed_and_the_weight_of_its_place_in_the_machine(direction, speed, angle, phase):
    made = placed(cam(direction, {"preload_n": 40, "spring_rate_n_per_mm": 3}), speed, angle, phase)
    ratio = 0.5 if direction == "clockwise" else -0.5
    turn = np.remainder(ratio * 2 * np.pi * made.turns + np.radians(phase), 2 * np.pi)
    lift, velocity, acceleration = cycloidal_motion(turn)
    inertia = 1e-3 * acceleration * (ratio * speed * np.pi / 30) ** 2
    force = 40 + 3 * lift + MASS * (inertia + GRAVITY * np.cos(np.radians(angle)))
    torque = ratio * force * velocity
    assert made.torques.input == pytest.approx(torque, abs=1e-9 * np.abs(torque).max())


@pytest.mark.parametrize("speed", [60, -60])
def test_friction_of_a_guide_takes_work_in_either_direction(speed):
    friction = {"coefficient": 0.15, "length": 40, "overhang": 20}
    work = {}
    for name, more in (("without", {}), ("with", {"friction": friction})):
        made = placed(cam("counterclockwise", {"preload_n": 40, **more}), speed)
        work[name] = np.trapezoid(made.torques.input, 2 * np.pi * made.turns)
    assert work["without"] == pytest.approx(0, abs=1e-3 * work["with"]) and work["with"] > 10


def test_checks_of_a_mechanism_are_those_of_its_speed_in_the_machine():
    """At its own 60 rpm the follower stays on the cam, at the 3,000 rpm that the machine turns it, it leaves it."""
    slow = cam("clockwise", {"preload_n": 5}, drive={"speed_rpm": 60})
    assert next(c for c in gk.load(slow).checks if c.id == "follower_contact").passed
    assert not next(c for c in placed(slow, 6000).checks if c.id == "body_follower_contact").passed


def test_inertia_counts_at_the_speed_of_the_machine():
    made = gk.load(CASES / "machine-speed.toml")
    efficiency = made.recipes["train"].design.efficiency
    assert np.nanmax(np.abs(made.torques.input)) == pytest.approx(1025 / efficiency, abs=1)
    motor = next(check for check in made.checks if check.id == "motor_torque")
    assert motor.value == pytest.approx(0.50 * efficiency, abs=0.005) and not motor.passed


def test_gravity_points_down_in_the_machine():
    """By the energy of the rocker's mass, whose bar turns against the driver at its speed."""
    made = gk.load(CASES / "machine-gravity.toml")
    turn = np.linspace(0, 2 * np.pi, 3601)
    pin = 30 * np.exp(-1j * turn)
    apart = np.abs(120 - pin)
    along = (apart**2 + 100**2 - 70**2) / (2 * apart)
    end = pin + (120 - pin) / apart * (along + 1j * np.sqrt(100**2 - along**2))
    centre = (120 + (end - 120) / 2) * 1j
    speed = np.abs(np.gradient(centre, turn)) * 2 * np.pi
    energy = 2 * GRAVITY * centre.imag + 1e-3 * speed**2
    torque = np.gradient(energy, turn)
    own = np.interp(2 * np.pi * made.turns, turn, torque)
    assert made.torques.input[5:-5] == pytest.approx(own[5:-5], abs=1e-3 * 290)


def test_mechanism_at_the_ratio_1_has_the_loads_of_its_own_recipe():
    turned = PUMP | {"drive": {"speed_rpm": 60, "step_deg": 1.5}}
    pair = {"recipe": {"kind": "gear-pair", "first": {"teeth": 20, "module": 2}, "second": {"teeth": 20, "module": 2}}}
    both = {"pump": {"recipe": turned}, "pair": pair | {"turned_by": "pump.crank"}}
    made, alone = gk.load({"kind": "machine", "mechanisms": both}), gk.load(turned)
    assert 360 * made.turns == pytest.approx(alone.table["crank_angle"])
    torque = alone.table["driver_torque"]
    assert made.torques.input == pytest.approx(torque, abs=1e-10 * np.abs(torque).max())
    placed = made.recipes["pump"]
    assert placed.notes["loads"] == alone.notes["loads"]
    for column in alone.table.columns:
        assert placed.table[column.id].tobytes() == column.values.tobytes()


@pytest.mark.parametrize("mirrored", [False, True])
def test_weight_of_a_turned_mechanism_is_lifted_in_the_world_also_if_it_is_mirrored(mirrored):
    """So slow that inertia counts for nothing: the work is the weight by the height of the slider in the machine."""
    pump = {"recipe": PUMP, "turned_by": "pair.second", "angle_deg": 37, "mirrored": mirrored}
    made = gk.load({"kind": "machine", "mechanisms": {"pair": PAIR, "pump": pump}, "drive": {"speed_rpm": 0.1}})
    slider = next(body for body in made.scene.bodies if body.name == "pump/slider")
    height = np.asarray(slider.origin).imag
    angle = 2 * np.pi * made.turns
    work = np.concatenate([[0], np.cumsum(np.diff(angle) * (made.torques.input[1:] + made.torques.input[:-1]) / 2)])
    assert work == pytest.approx(MASS * GRAVITY * (height - height[0]), abs=2e-3 * MASS * GRAVITY * np.ptp(height))


def test_machine_has_one_gravity():
    flat = {**PUMP, "loads": {**PUMP["loads"], "gravity_m_per_s2": [0, 0]}}
    one, other = {"recipe": PUMP, "turned_by": "pair.second"}, {"recipe": flat, "turned_by": "pair.second"}
    with pytest.raises(RecipeError) as caught:
        gk.load({"kind": "machine", "mechanisms": {"pair": PAIR, "one": one, "other": other}})
    assert [problem.key for problem in caught.value.problems] == ["mechanisms.other.recipe.loads.gravity_m_per_s2"]
    level = {"pair": PAIR, "one": {**one, "recipe": flat}, "other": other}
    assert gk.load({"kind": "machine", "mechanisms": level}).torques.input is not None
