"""What scenes of gears tell of their turns, in tables, is how their bodies turn."""

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
        told = np.radians(column.values)
        assert np.abs(seen - seen[0] - (told - told[0])).max() < 1e-9 and np.ptp(told) > 0, column.id
    for column in (column for column in scene.table.columns if column.id.endswith("_way")):
        body = named(scene, column.id.removesuffix("_way"))
        told = np.asarray(column.values)
        assert np.abs(np.abs(body.origin - body.origin[0]) - np.abs(told - told[0])).max() < 1e-9
        turns.append(column)
    assert len(turns) == len([body for body in scene.bodies if not body.fixed and body.name != "tool"])


def test_planets_and_carrier_turn_as_the_table_says():
    scene = recipe("planetary").scene
    for header, name in (("sun_angle", "sun"), ("carrier_angle", "carrier"), ("planet_angle", "planet 1")):
        seen = np.unwrap(np.angle(named(scene, name).direction))
        told = np.radians(np.asarray(scene.table[header]))
        assert np.abs(seen - seen[0] - (told - told[0])).max() < 1e-9, name
    (plot,) = scene.plots
    assert plot.columns == ("carrier_angle", "planet_angle")
