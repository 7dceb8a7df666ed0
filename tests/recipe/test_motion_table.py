"""What a table of motion writes of quantities that are nothing but rounding: 0, or no column."""

import csv
from pathlib import Path

import numpy as np
import pytest

import geomkin as gk
from geomkin.export.csv import csv as written
from geomkin.linkage.motion import motion_table
from geomkin.table import Column, Table, xy_columns

RECIPES = Path(__file__).parent.parent.parent / "recipes"


def cells(table):
    header, *rows = csv.reader(written(table).decode().splitlines())
    return {name: [row[k] for row in rows] for k, name in enumerate(header)}


def test_a_constant_stroke_and_a_level_table_have_no_rates_but_those_they_have():
    found = cells(motion_table(gk.load(RECIPES / "lift-table.toml").motion))
    assert set(found["lift_acceleration_mm_per_s2"]) == {"0.0"} == set(found["load_velocity_x_mm_per_s"])
    assert len(set(found["lift_velocity_mm_per_s"])) == 1
    assert "table_omega_rad_per_s" not in found and np.ptp([float(v) for v in found["arm_omega_rad_per_s"]]) > 0


def test_the_coupler_of_a_parallelogram_does_not_turn():
    found = cells(motion_table(gk.load(RECIPES / "parallelogram.toml").motion))
    assert not [name for name in found if name.startswith("coupler_angle")] and "rocker_angle_deg" in found


@pytest.mark.parametrize("size", [1e-7, 1.0, 1e7])
def test_digits_are_counted_from_the_scale_or_the_largest_value(size):
    noise, large = size * np.array([1e-16, -3e-17]), size * np.array([1.23456789012345, 2.0])
    assert cells(Table((Column("a", "", "", noise, size),)))["a"] == ["0.0", "0.0"]
    assert float(cells(Table((Column("a", "", "", large, size / 10),)))["a"][0]) == pytest.approx(large[0], rel=1e-9)
    assert set(cells(Table(xy_columns("z", "", "", large + 1j * noise)))["z_y"]) == {"0.0"}


@pytest.mark.parametrize("size", [1e-7, 1e-3, 1.0, 1e7])
def test_the_columns_are_the_same_at_any_size(size):
    four_bar = gk.FourBar(100 * size, 30 * size, 90 * size, 70 * size)
    slow = gk.OldhamCoupling(6 * size)
    for linkage, angles in ((four_bar, ["coupler", "rocker"]), (slow, ["disc", "driven"])):
        columns = motion_table(gk.move(linkage, np.linspace(0, 6, 50))).columns
        assert [name for name in angles if f"{name}_omega" in {c.name for c in columns}] == angles
