"""Tables are read by name, and handed on whole."""

from pathlib import Path

import numpy as np
import pytest

import geomkin as gk

ANGLE = gk.Column("crank_angle", "deg", "angle of the crank", np.arange(4.0))
OMEGA = gk.Column("rocker_omega", "rad/s", "angular velocity of the rocker", np.arange(4.0) ** 2)
LAW = gk.Column("law", "", "law of the segment", np.array(["dwell", "rise", "rise", "return"]))
TABLE = gk.Table((ANGLE, OMEGA, LAW))


@pytest.mark.parametrize("name", ["rocker_omega", "rocker_omega_rad_per_s"])
def test_a_column_is_read_by_its_name_or_its_header(name):
    assert TABLE[name] is OMEGA.values
    assert TABLE["law"] is LAW.values


@pytest.mark.parametrize(
    ("name", "advice"),
    [("rocker_omeg", "give rocker_omega"), ("?", "give a name that"), (0, "give a name"), (None, "give a name")],
)
def test_a_name_that_is_none_is_refused_with_those_near_it(name, advice):
    with pytest.raises(gk.DesignError, match=advice) as refusal:
        _ = TABLE[name]
    assert refusal.value.field == "name"


def test_all_columns_with_their_units_in_order():
    columns = TABLE.to_columns()
    assert list(columns) == ["crank_angle_deg", "rocker_omega_rad_per_s", "law"]
    assert all(values is column.values for values, column in zip(columns.values(), TABLE.columns, strict=True))


def test_a_recipes_table_is_read_so():
    table = gk.load(Path(__file__).parent.parent / "recipes" / "crank-rocker.toml").table
    assert len(table["crank_angle"]) == len(table["rocker_omega"]) == len(table.to_columns()["rocker_omega_rad_per_s"])
