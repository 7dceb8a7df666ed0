"""The rotations in the tables of gear scenes are those of their bodies."""

import numpy as np
import pytest

from tests.gallery import named, recipe

NAMES = [
    "spur-gear",
    "rack-and-pinion",
    "lantern",
    "straight-sided-ring",
]


@pytest.mark.parametrize("name", NAMES)
def test_each_turn_in_the_table_is_that_of_its_body(name):
    scene = recipe(name).scene
    turns = [column for column in scene.table.columns if column.id.endswith("_turn")]
    for column in turns:
        body = named(scene, column.id.removesuffix("_turn"))
        seen = np.unwrap(np.angle(body.direction))
        reported = np.radians(column.values)
        assert np.abs(seen - seen[0] - (reported - reported[0])).max() < 1e-9 and np.ptp(reported) > 0, column.id
    for column in (column for column in scene.table.columns if column.id.endswith("_way")):
        body = named(scene, column.id.removesuffix("_way"))
        reported = np.asarray(column.values)
        assert np.abs(np.abs(body.origin - body.origin[0]) - np.abs(reported - reported[0])).max() < 1e-9
        turns.append(column)
    assert len(turns) == len([body for body in scene.bodies if not body.fixed and body.name != "tool"])


def test_planets_and_carrier_turn_as_the_table_says():
    scene = recipe("planetary").scene
    for header, name in (("sun_angle", "sun"), ("carrier_angle", "carrier"), ("planet_angle", "planet 1")):
        seen = np.unwrap(np.angle(named(scene, name).direction))
        reported = np.radians(np.asarray(scene.table[header]))
        assert np.abs(seen - seen[0] - (reported - reported[0])).max() < 1e-9, name
    (plot,) = scene.plots
    assert plot.columns == ("carrier_angle", "planet_angle")
