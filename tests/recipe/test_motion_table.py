"""What a table of motion writes of quantities that are nothing but rounding: 0, or no column."""

import csv
from pathlib import Path

import numpy as np
import pytest

import geomkin as gk
from geomkin.export.tables import csv as written
from geomkin.linkage.motion import motion_table
from tests.linkage.examples import ALL, two_parallelograms

RECIPES = Path(__file__).parent.parent.parent / "recipes"


def cells(table):
    header, *rows = csv.reader(written(table).decode().splitlines())
    return {name: [row[k] for row in rows] for k, name in enumerate(header)}


def test_a_constant_stroke_and_a_level_table_have_no_rates_but_those_they_have():
    found = cells(motion_table(gk.load(RECIPES / "lift-table.toml").motion))
    assert set(found["lift_acceleration_mm_per_s2"]) == {"0.0"} == set(found["load_velocity_x_mm_per_s"])
    assert len(set(found["lift_velocity_mm_per_s"])) == 1
    assert "table_omega_rad_per_s" not in found and np.ptp([float(v) for v in found["arm_omega_rad_per_s"]]) > 0


BY_CRANK = "{ crank = 30, coupler = 100, offset = 15, coupler_point = [40, 25] }"
DRIVEN = {
    "crank": f'kind = "slider-crank"\ncoefficients = true\nlinkage = {BY_CRANK}\ndrive = {{ step_deg = 0.05, end_deg = 40 }}',
    "slider": 'kind = "slider-crank"\ncoefficients = true\nlinkage = { crank = 30, coupler = 100, driver = "slider", '
    "coupler_point = [40, 25] }\nstroke = { start = 85, end = 100, step = 0.02 }",
    "lever": 'kind = "inverted-slider-crank"\ncoefficients = true\nlinkage = { ground = 100, crank = 40 }\n'
    "drive = { step_deg = 0.05, end_deg = 40 }",
}


@pytest.mark.parametrize("driver", DRIVEN)
def test_kinematic_coefficients_are_derivatives_by_the_driver(driver):
    """Beside differences of the columns that they are derived from, over the drive as the table states it."""
    table = gk.load(DRIVEN[driver]).table
    drive = table.columns[0]
    q = np.radians(drive.values) if drive.unit == "deg" else drive.values
    per = {"deg": "rad", "mm": "mm"}[drive.unit]
    reported = [column for column in table.columns if "_coefficient" in column.id]
    assert len(reported) >= 4
    for column in reported:
        order = 1 + ("_second_" in column.id)
        of = column.id.replace("_first_coefficient", "").replace("_second_coefficient", "")
        row = next(c for c in table.columns if c.id == of)
        values = np.radians(row.values) if row.unit == "deg" else row.values
        for _ in range(order):
            values = np.gradient(values, q)
        inner = slice(3, -3)
        np.testing.assert_allclose(
            column.values[inner], values[inner], rtol=1e-4, atol=1e-5 * np.abs(values).max() + 1e-7
        )
        size = "rad" if row.unit == "deg" else "mm"
        ratio = size == per
        assert column.unit == {1: "" if ratio else f"{size}/{per}", 2: f"1/{per}" if ratio else f"{size}/{per}2"}[order]


def test_kinematic_coefficients_are_the_same_at_any_speed_and_left_out_where_nobody_asks():
    tables = [gk.load(DRIVEN["crank"].replace("drive = {", f"drive = {{ speed_rpm = {rpm},")).table for rpm in (1, 600)]
    reported = [c.header for c in tables[0].columns if "_coefficient" in c.id]
    assert all(np.array_equal(tables[0][header], tables[1][header]) for header in reported)
    plain = gk.load(DRIVEN["crank"].replace("coefficients = true\n", "")).table
    assert [c.header for c in plain.columns] == [c.header for c in tables[0].columns if c.header not in reported]


@pytest.mark.parametrize("name", list(ALL)[::3])
def test_columns_of_rotations_displacements_and_fixed_bodies(name):
    """By poses over the frames alone, whatever their rates are."""
    linkage, drive, branch = ALL[name]
    general = linkage.linkage
    motion = gk.move(linkage, drive, branch)
    every = [column.id for column in motion_table(motion, coefficients=True).columns]
    units = {column.id: column.unit for column in motion_table(motion).columns}
    turning = {n for n, body in motion.bodies.items() if np.ptp(np.unwrap(np.angle(body.direction))) > 1e-9}
    driver = {general.driver}
    assert {n for n in motion.bodies if f"{n}_omega" in units} == turning - driver
    for slider in general.sliders:
        assert (f"{slider.name}_coriolis_x" in units) == (slider.along in turning)
    points = general.bodies[general.ground]
    pinned = {n for n, own in general.bodies.items() if set(own) & set(points)}
    sliding = {n for s in general.sliders if general.ground in (s.body, s.along) for n in (s.body, s.along)}
    held = (pinned | sliding) - driver - {general.ground}
    reported = {n: units[f"{n}_mechanical_advantage"] for n in motion.bodies if f"{n}_mechanical_advantage" in units}
    # A driving slide's force makes a torque, mm times as large, and a crank's torque a force.
    force, torque = ("", "mm") if general.driven_slider else ("1/mm", "")
    assert reported == {n: torque if n in turning else force for n in held}
    free = {p for own in list(general.bodies.values())[1:] for p in own} - set(general.pins)
    assert {n[:-2] for n in units if n.endswith("_x") and f"{n[:-2]}_velocity_x" in units} == free
    of = [f"{n}_angle" for n in turning - driver] + [f"{s.name}_displacement" for s in general.sliders]
    of += [f"{point}{axis}" for point in free for axis in ("_x", "_y")]
    orders = ("first_coefficient", "second_coefficient")
    parted = [(one[:-2], one[-2:]) if one[-2:] in ("_x", "_y") else (one, "") for one in of]
    assert sorted(every) == sorted([*units, *(f"{one}_{order}{axis}" for one, axis in parted for order in orders)])


def test_rates_within_rounding_of_the_fastest_body_are_0():
    """A parallelogram behind another, whose last bar turns evenly but for rounding, and a long rod that hardly moves."""
    bodies = two_parallelograms() | {"rod": {"T": 0, "S": 3000}, "sled": {"S": 0}}
    bodies["last"]["T"] = 1e-3
    linkage = gk.Linkage(bodies, "crank", (gk.Slider("way", "sled", "ground"),))
    for speed in (1e-3, 1e3):
        table = motion_table(gk.move(linkage, np.linspace(0.5, 2.2, 40), 1, speed), coefficients=True)
        found = cells(table)
        for column in table.columns:
            if column.id in ("last_alpha", "last_angle_second_coefficient"):
                assert set(found[column.header]) <= {"0.0", "-0.0"}
            elif column.id in ("rod_omega", "rod_angle_first_coefficient", "rod_angle_second_coefficient"):
                assert np.abs(column.values).max() > 0 and len(set(found[column.header])) > 3


def slider_cranks():
    size = np.array([1.0, 2.0])
    by_crank = gk.SliderCrank(30, 100, 15), gk.SliderCrank(60, 200, 30)
    by_slider = (gk.SliderCrank(30 * k, 100 * k, driver="slider") for k in size)
    return {
        "crank": [gk.move(one, np.linspace(0.3, 2.8, 20)) for one in by_crank],
        "slider": [gk.move(one, k * np.linspace(85.0, 120.0, 20)) for one, k in zip(by_slider, size)],
        "rocker": [gk.move(gk.FourBar(100 * k, 30 * k, 90 * k, 70 * k), np.linspace(0.3, 2.8, 20)) for k in size],
    }
