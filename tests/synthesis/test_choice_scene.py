"""What a linkage was chosen from, as it is plotted, against each of them moved by itself."""

import dataclasses

import numpy as np
import pytest

import geomkin as gk
from tests.gallery import recipe

GOALS = {"wiper": "full turn", "pump-stroke": "full turn", "double-rocker": "swing"}


@pytest.mark.parametrize("name", GOALS)
def test_each_row_is_a_linkage_that_drives_as_it_is_reported(name):
    found, choice = recipe(name).found, recipe(name).scene.choice
    table = choice.table
    assert np.all(np.diff(table["free_angle"]) > 0)
    turn = found.drive if GOALS[name] == "swing" else (0, 2 * np.pi)
    told = table["every_one"]
    for row in [*np.flatnonzero(np.isfinite(told))[3::40], choice.chosen]:
        sizes = {size: table[size][row] for size in found.lengths}
        linkage = dataclasses.replace(found.linkage, **sizes)
        motion = gk.move(linkage, np.linspace(*turn, 3601), found.branch)
        assert np.degrees(gk.least_transmission_angle(motion)) == pytest.approx(told[row], abs=1e-3)
        links = [size for size_name, size in sizes.items() if size_name != "offset"]
        assert table["ratio_of_every_one"][row] == pytest.approx(max(links) / min(links), rel=1e-9)


@pytest.mark.parametrize("name", GOALS)
def test_the_one_that_is_made_stands_alone_and_none_is_better(name):
    choice, found = recipe(name).scene.choice, recipe(name).found
    table, most = choice.table, recipe(name).wanted.largest_ratio or np.inf
    assert np.flatnonzero(np.isfinite(table["made"])).tolist() == [choice.chosen]
    assert table["made"][choice.chosen] == found.transmission_angle_deg
    allowed = table["every_one"][table["ratio_of_every_one"] <= most * (1 + 1e-9)]
    assert np.nanmax(allowed) <= found.transmission_angle_deg + 1e-6
