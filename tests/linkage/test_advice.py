"""The advice of checks and refusals of linkages: where, by how much, in the unit of the recipe, and which key."""

import re

import numpy as np
import pytest

import geomkin as gk
from geomkin.recipe.shown import ShownRecipe

OPEN = {
    "four-bar": {"ground": 4, "crank": 3, "coupler": 2.5, "rocker": 2.75},
    "slider-crank": {"crank": 3, "coupler": 3.5, "offset": 1},
}


def check_of(recipe, id):
    return next(check for check in ShownRecipe(recipe).checks if check.id == id)


@pytest.mark.parametrize("kind", OPEN)
def test_open_dyad_is_named_in_the_unit_of_the_recipe(kind):
    """By the same recipe in mm, whose numbers are 25.4 times as large."""
    found = {}
    for units, scale in (("in", 1.0), ("mm", 25.4)):
        linkage = {name: scale * value for name, value in OPEN[kind].items()}
        advice = check_of(gk.load({"kind": kind, "units": units, "linkage": linkage}), "share_reached").advice
        found[units] = float(re.search(rf"([\d.]+) {units}\b", advice)[1])
    assert found["mm"] == pytest.approx(25.4 * found["in"], rel=1e-3)


def test_least_transmission_angle_is_where_its_advice_says():
    """Of an offset slider-crank where the crank is upright, away from the slide: no dead centre."""
    recipe = gk.load({"kind": "slider-crank", "linkage": {"crank": 60, "coupler": 130, "offset": 60}})
    check = check_of(recipe, "transmission_angle")
    assert "crank 270 deg" in check.advice and "dead centre" not in check.advice
    assert check.value == pytest.approx(np.degrees(np.arccos(120 / 130)), abs=1e-6)


def test_search_names_its_limit_of_the_transmission_angle():
    """Taken, it leaves the linkages that have the angle."""
    wanted = {"poses": [[0, 0, 0], [50, 20, 60], [80, 0, 160]]}
    check = check_of(gk.load({"kind": "body-guidance", "wanted": wanted, "choose": 9}), "transmission_angle")
    assert not check.passed and "wanted.least_transmission_angle_deg = 40" in check.advice
    limited = gk.load({"kind": "body-guidance", "wanted": {**wanted, "least_transmission_angle_deg": 40}})
    assert len(limited.ranked) >= 8 and not any(found.transmission_angle_deg < 40 for found in limited.ranked)


def test_collisions_are_named_by_the_check():
    linkage = {"ground": 100, "crank": 30, "coupler": 90, "rocker": 70}
    recipe = gk.load({"kind": "four-bar", "linkage": linkage, "stock": {"bar_width": 90}})
    collisions, check = recipe.made.stack.collisions, check_of(recipe, "collisions")
    assert check.value == len(collisions) > 1
    assert str(collisions[0]) in check.advice and f"{len(collisions) - 1} more" in check.advice


def test_copies_that_close_in_no_common_position_are_refused_by_key():
    """Each closes while its crank points away from the rocker's pivot, at most half of the turn."""
    linkage = {"ground": 100, "crank": 60, "coupler": 40, "rocker": 45}
    data = {"kind": "four-bar", "units": "mm", "linkage": linkage, "copies": [{"phase_deg": 180}]}
    assert 0 < gk.load({**data, "copies": []}).motion.assembled.mean() < 0.5
    with pytest.raises(gk.DesignError) as caught:
        _ = gk.load(data).scene
    assert caught.value.field == "copies" and "rocker_pin" in caught.value.problem and " mm" in caught.value.problem
