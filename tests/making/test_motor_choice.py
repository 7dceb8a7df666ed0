"""Which motor turns a mechanism: torque over speed, margins and the choice from the table."""

import re
import tomllib
from pathlib import Path

import numpy as np
import pytest

import geomkin as gk
from geomkin.model import Motor, MotorDuty
from geomkin.recipe.load import from_table
from tests.campaign import by_default

TURN = np.linspace(0, 2 * np.pi, 73)


@pytest.mark.parametrize(("name", "watt"), [("n20-100", 0.25), ("n20-298", 0.22)])
def test_greatest_power_of_gear_motors_is_that_of_the_maker_s_sheet(name, watt):
    """Pololu, Micro Metal Gearmotors, May 2018: maximal output power, printed with two digits."""
    speeds = np.linspace(0, 20, 2001)
    power = gk.making.motor(name).torque_at(speeds) * speeds / 1000
    assert power.max() == pytest.approx(watt, rel=0.06)


@pytest.mark.parametrize("seed", by_default(range(5), slice(2)))
def test_margin_is_the_largest_factor_on_the_torque_at_which_nothing_is_exceeded(seed):
    """The factor found by bisection, frame by frame; the mean square by a sum over many more places."""
    random = np.random.default_rng(seed)
    torque, speed = random.normal(0, 50, TURN.shape), random.uniform(0, 6)
    duty = MotorDuty(torque, np.full(TURN.shape, -speed), TURN)
    fine = np.interp(np.linspace(0, 2 * np.pi, 720_001), TURN, torque**2)
    for motor in gk.making.MOTORS.values():

        def carries(factor, motor=motor):
            if motor.range_deg is not None or speed * 30 / np.pi > motor.speed_rpm:
                return False
            share = 1 if motor.constant_torque else 1 - speed * 30 / np.pi / motor.speed_rpm
            at_all = all(factor * abs(value) <= motor.torque_n_mm * share for value in torque.tolist())
            return at_all and factor * np.sqrt(fine.mean()) <= motor.lasting_torque_n_mm

        low, high = 0.0, 1e6
        for _ in range(80):
            middle = (low + high) / 2
            low, high = (middle, high) if carries(middle) else (low, middle)
        assert motor.margin(duty) == pytest.approx(low, rel=1e-5)


def test_the_smallest_motor_is_lighter_than_all_others_that_suffice():
    for torque, speed in ((5, 1.0), (60, 4.0), (200, 12.0), (400, 1.0), (400, 30.0)):
        duty = MotorDuty(torque * np.cos(TURN), np.full(TURN.shape, speed), TURN)
        chosen = gk.making.smallest_motor(duty)
        sufficient = {m.mass_g for m in gk.making.MOTORS.values() if m.margin(duty) >= 1.5}
        assert chosen.mass_g == min(sufficient)
    assert gk.making.smallest_motor(MotorDuty(1e6 * np.cos(TURN), np.full(TURN.shape, 1.0), TURN)) is None


def test_a_servo_turns_no_farther_than_its_range_and_an_unknown_torque_has_no_margin():
    for extent, turns in ((180, True), (181, False)):
        angle = np.radians(np.linspace(-30, extent - 30, 50))
        duty = MotorDuty(np.full(50, 1.0), np.full(50, 0.5), angle)
        assert (gk.making.motor("mg996r").margin(duty) > 0) == turns
    # At its largest speed a motor supplies only rounding.
    fastest = np.full(2, np.nextafter(100 * np.pi / 30, 0))
    own = Motor("own", torque_n_mm=1000, speed_rpm=100, lasting_torque_n_mm=200, mass_g=50)
    assert own.margin(MotorDuty(np.ones(2), fastest, np.arange(2.0))) == 0
    torque = np.where(np.arange(73) == 5, np.nan, 10.0)
    motor = Motor("own", torque_n_mm=100, speed_rpm=60, lasting_torque_n_mm=40, mass_g=1)
    assert motor.margin(MotorDuty(np.full(73, 10.0), np.full(73, np.pi), TURN)) == pytest.approx(4)
    assert np.isnan(motor.margin(MotorDuty(torque, np.full(73, np.pi), TURN)))
    assert gk.making.smallest_motor(MotorDuty(torque, np.full(73, np.pi), TURN)) is None


def test_the_duty_of_a_linkage_is_its_driver_s_torque_and_refused_without_a_shaft():
    loads = gk.Loads(forces=[gk.Force("rocker", "rocker_pin", -10j)])
    result = gk.forces(gk.move(gk.FourBar(100, 30, 90, 70), TURN, speed=5.0), loads)
    assert result.duty.peak_torque == np.abs(result.driver).max()
    assert result.duty.peak_speed_rpm == pytest.approx(47.746482928)
    # Equal to the energy balance of a generator: the mean square by Parseval over the samples of one turn.
    spectrum = np.abs(np.fft.fft(result.driver[:-1])) ** 2
    assert result.duty.rms_torque == pytest.approx(np.sqrt(spectrum.sum()) / 72)
    slider = gk.move(gk.SliderCrank(30, 90, driver="slider"), np.linspace(70, 110, 20), speed=5.0)
    with pytest.raises(gk.DesignError, match="shaft"):
        _ = gk.forces(slider, gk.Loads(masses={"slider": gk.Mass(1)})).duty


def motor_torque(table):
    return next(check for check in gk.load(table).design_checks if check.id == "motor_torque")


def test_an_advised_motor_is_accepted_by_the_stock_and_suffices():
    """A crank on the plate of its motor, faster than this motor turns: the advice is followed, until it passes."""
    table = tomllib.loads(Path("recipes/motor-crank.toml").read_text())
    force = {"body": "rocker", "point": "rocker_pin", "force_n": [0, -4]}
    table |= {"drive": {"speed_rpm": 90}, "loads": {"forces": [force]}}
    table["stock"] |= {"motor": "25d-75"}
    check = motor_torque(table)
    assert check.value == 0
    assert "90 rpm" in check.advice and "75 rpm" in check.advice
    table["stock"]["motor"] = re.search(r'motor = "([^"]+)"', check.advice)[1]
    assert motor_torque(table).passed
    # The lightest motor of the table that suffices has no drawing of its face, and is advised for the loads alone.
    table["loads"] = {"forces": [force | {"force_n": [0, -0.2]}], "motor": "28byj-48"}
    del table["stock"]["motor"], table["stock"]["fit"]
    table["loads"]["motor"] = re.search(r'motor = "([^"]+)"', motor_torque(table).advice)[1]
    assert table["loads"]["motor"] not in gk.making.MOTOR_FACES
    assert motor_torque(table).passed


def test_electric_power_of_a_motor_is_that_of_its_data_sheet_at_standstill_and_without_load():
    sheet = {"torque_n_mm": 400, "speed_rpm": 120, "lasting_torque_n_mm": 100, "mass_g": 90}
    currents = {"voltage_v": 12, "no_load_current_a": 0.5, "stall_current_a": 4}
    motor, free = gk.Motor("own", **sheet, **currents), gk.Motor("own", **sheet)
    fast = 120 * np.pi / 30
    assert motor.electric_power(400, 0) == pytest.approx(12 * 4)
    assert motor.electric_power(0, fast) == pytest.approx(12 * 0.5)
    # At full voltage the torque falls with the speed along a line, and the power with the current.
    assert motor.electric_power(100, 0.75 * fast) == pytest.approx(12 * (0.5 + 3.5 / 4))
    # Without friction a slow motor takes what heats it, and a fast one what it gives besides.
    assert free.electric_power(100, 0.75 * fast) == pytest.approx(1e-3 * 100 * fast)
    assert motor.electric_power(-200, fast) == 0 == motor.electric_power(200, -fast)
    assert np.isnan(gk.making.motor("nema17").electric_power(10, 1))


LIFT = tomllib.loads((Path(__file__).parents[2] / "recipes" / "lift-table.toml").read_text())
PRESSED = {"forces": [{"body": "table", "point": "load", "force_n": [0, -40]}], "gravity_m_per_s2": [0, 0]}


def lifted(**actuator):
    given = {"name": "own", "force_n": 200, "no_load_speed": 40, "full_load_speed": 10, "stroke": 80, **actuator}
    return from_table({**LIFT, "loads": {**PRESSED, "actuator": given}})


def test_an_actuator_supplies_the_work_that_lifts_the_table():
    recipe = lifted()
    table = recipe.table
    # Virtual work: 40 N times the lift for 1 mm of the rod.
    needed = 40 * np.gradient(table["load_y"], table["lift_displacement"], edge_order=2)
    found = {check.id: check.value for check in recipe.checks}
    # At 20 mm/s it has two thirds of its force.
    assert found["actuator_force"] == pytest.approx(200 * 2 / 3 / np.abs(needed).max(), rel=1e-3)
    assert found["actuator_stroke"] == pytest.approx(80 / 75)


def test_an_actuator_that_is_too_short_or_too_slow_fails_its_check():
    def failed(recipe):
        return {check.id for check in recipe.checks if check.id.startswith("actuator") and not check.passed}

    assert failed(lifted()) == set()
    assert failed(lifted(stroke=74)) == {"actuator_stroke"}
    assert failed(lifted(no_load_speed=20)) == {"actuator_force"}


def pressed(force, **loads):
    return from_table(
        {**LIFT, "loads": {**PRESSED, "forces": [{**PRESSED["forces"][0], "force_n": [0, -force]}], **loads}}
    )


@pytest.mark.parametrize("change", [{"stroke": 74}, {"no_load_speed": 20}])
def test_suggested_actuator_passes_both_checks(change):
    own = {"name": "own", "force_n": 200, "no_load_speed": 40, "full_load_speed": 10, "stroke": 80, **change}
    checks = pressed(2, actuator=own).checks
    failing = next(check for check in checks if check.id.startswith("actuator") and not check.passed)
    ((key, name),) = failing.suggestions[0].values.items()
    checks = [check for check in pressed(2, actuator=name).checks if check.id.startswith("actuator")]
    assert key == "loads.actuator" and len(checks) == 2 and all(check.passed for check in checks)


@pytest.mark.parametrize("force", [2, 5, 40])
def test_smallest_actuator_that_lifts_the_table_is_the_first_of_those_that_do(force):
    """By force and speed of each data sheet on its straight line, with half as much again."""
    table, speed = lifted().table, 20
    needed = force * np.abs(np.gradient(table["load_y"], table["lift_displacement"], edge_order=2)).max()
    # Largest force, speed without load, and slope by the point of the largest power.
    sheets = {35: (50, 32, 16 / 50), 63: (100, 20, 10 / 75), 150: (200, 8, 4 / 175)}
    able = [ratio for ratio, (most, free, slope) in sheets.items() if min(most, (free - speed) / slope) >= 1.5 * needed]
    recipe = pressed(force)
    suitable = recipe.aspect("loads").actuator_duty.suitable
    assert suitable == (f"l16-100-{able[0]}" if able else None) and recipe.remarks


def test_the_book_has_the_tables_of_motors_and_actuators():
    text = (Path(__file__).parents[2] / "docs" / "forces.md").read_text("utf-8")
    rows = [
        [cell.strip(" `") for cell in line.strip("|").split("|")] for line in text.splitlines() if line[:3] == "| `"
    ]
    cells = {row[0]: row[1:] for row in rows}
    for name, motor in gk.making.MOTORS.items():
        figures = motor.torque_n_mm, motor.speed_rpm, motor.lasting_torque_n_mm, motor.mass_g
        assert [float(cell) for cell in cells[name][:4]] == pytest.approx(figures, rel=1e-3)
        assert cells[name][4] == motor.source != ""
    for name, actuator in gk.making.ACTUATORS.items():
        (row,) = (row for row in rows if name in row[0])
        figures = actuator.force_n, actuator.no_load_speed, actuator.full_load_speed
        assert [float(cell) for cell in row[1:]] == pytest.approx(figures) and actuator.source


def test_an_actuator_of_a_crank_is_refused():
    actuator = {"name": "own", "force_n": 1, "no_load_speed": 2, "full_load_speed": 1, "stroke": 3}
    linkage = {"ground": 100, "crank": 30, "coupler": 90, "rocker": 70}
    loads = {"masses": {"rocker": {"mass_kg": 1}}, "actuator": actuator}
    with pytest.raises(gk.RecipeError) as caught:
        from_table({"kind": "four-bar", "linkage": linkage, "loads": loads})
    assert caught.value.problems[0].key == "loads.actuator"


@pytest.mark.parametrize(("extended", "stroke", "room"), [(100, 80, 20), (79, 60, -1), (100, 30, -30), (85, 46, 1)])
def test_a_gas_spring_stays_within_its_stroke(extended, stroke, room):
    """Between the crank's pin and a point in line with its pivot: 40 to 80 mm long."""
    spring = {"body": "crank", "point": [20, 0], "to_body": "ground", "to_point": [60, 0]}
    spring |= {"force": 10, "extended": extended, "gas_length": 200, "stroke": stroke}
    linkage = {"ground": 120, "crank": 30, "coupler": 100, "rocker": 70}
    recipe = from_table({"kind": "four-bar", "linkage": linkage, "loads": {"gas_springs": [spring]}})
    check = next(check for check in recipe.checks if check.id == "gas_spring_1_stroke")
    assert check.value == pytest.approx(min(extended - 80, 40 - extended + stroke)) == pytest.approx(room)
    assert check.passed == (room >= 0)


@pytest.mark.parametrize("speed", [400, -400])
@pytest.mark.parametrize("kind", ["four-bar", "walker"])
def test_advised_slower_speed_is_one_at_which_a_motor_that_is_too_slow_suffices(kind, speed):
    if kind == "walker":
        table = tomllib.loads((Path(__file__).parents[2] / "recipes" / "motor-walker.toml").read_text())
        table["loads"].pop("motors"), table["loads"].pop("battery_wh"), table["expected_failures"].clear()
    else:
        table = {"kind": "four-bar", "linkage": {"ground": 120, "crank": 30, "coupler": 100, "rocker": 70},
                 "loads": {"masses": {"rocker": {"mass_kg": 2, "centre": [35, 0]}}, "motor": "37d-50"}}  # fmt: skip
    table["drive"] = {"speed_rpm": speed, "step_deg": 4}

    def motor_torque(table):
        return next(from_table(table).aspect("loads")._motor_checks)

    check = motor_torque(table)
    (rpm,) = (s.values["drive.speed_rpm"] for s in check.suggestions if "drive.speed_rpm" in s.values)
    assert not check.passed and 0 < rpm / speed < 0.5
    slower = motor_torque({**table, "drive": {**table["drive"], "speed_rpm": rpm}})
    assert (slower.passed and slower.value < 1.1 * 1.5) or (kind == "walker" and slower.passed)


def test_electric_power_is_stated_of_a_motor_that_supplies_the_torque_at_the_speed():
    """2059 N mm at standstill and 200 rpm without load: 1750.15 N mm at 30 rpm; its coil at 1750 N mm, by Ohm's law."""
    motor = gk.making.motor("37d-50")

    def entry(torque, speed=30):
        loads = {"motors": ["37d-50"], "torques": [{"body": "crank", "torque_n_mm": -torque}]}
        linkage = {"ground": 100, "crank": 30, "coupler": 90, "rocker": 70}
        recipe = {"kind": "four-bar", "linkage": linkage, "drive": {"speed_rpm": speed}, "loads": loads}
        return gk.load(recipe).notes["loads"]["motors"][0]

    idle, stall, volts = motor.no_load_current_a, motor.stall_current_a, motor.voltage_v
    current = idle + (stall - idle) * 1750 / 2059
    watts = current * (current * volts / stall + (volts - idle * volts / stall) * 30 / 200)
    assert entry(1750)["electric_power_W"] == pytest.approx(watts, rel=1e-3) and not entry(1750)["suffices"]
    for torque, speed in ((1751, 30), (5000, 30), (100, 200), (100, 250)):
        assert "electric_power_W" not in entry(torque, speed)
