"""Recipes of gears and the mates they shape: what the table states, and backlash that is too much."""

import numpy as np
import pytest

import geomkin as gk
from tests.campaign import by_default
from tests.texts import parse

STRAIGHT = 'kind = "straight-sided-gears"\ngear = { teeth = 40, module = 2, addendum = 0.8 }\n'
POINTS = (
    'kind = "point-tooth-gears"\n[gear]\nteeth = 24\nmodule = 3\n'
    "points = [[3.55, 32.6], [2.95, 34.4], [2.35, 36.0], [1.75, 37.4], [1.2, 38.4], [0.75, 39.0]]\n"
)
LANTERN = 'kind = "lantern-gears"\npinion = { pins = 12, module = 4, pin_diameter = 5.5 }\n'
TEXTS = {
    "straight": STRAIGHT + "mate = { teeth = 50, addendum = 1.6, backlash = BACKLASH }\n",
    "ring": STRAIGHT + "mate = { teeth = 64, addendum = 1.6, internal = true, backlash = BACKLASH }\n",
    "points": POINTS + "[mate]\nteeth = 32\naddendum = 2.6\nbacklash = BACKLASH\n",
    "lantern": LANTERN + "mate = { teeth = 48, addendum = 7, backlash = BACKLASH }\n",
}


def read(name, backlash):
    return parse(TEXTS[name].replace("BACKLASH", str(backlash)))


@pytest.mark.parametrize("name", by_default(TEXTS, ["straight", "ring"]))
def test_the_table_s_angles_bring_its_points_of_both_gears_to_its_contact(name):
    recipe = read(name, 0.2)
    table, mate = recipe.table, recipe.design
    columns = {column.id: np.asarray(column.values) for column in table.columns}

    def place(what):
        return columns[f"{what}_x"] + 1j * columns[f"{what}_y"]

    on = np.isfinite(columns["gear_angle"])
    turns = {gear: np.exp(1j * np.radians(columns[f"{gear}_angle"])) for gear in ("gear", "mate")}
    contact = place("contact")[on]
    assert on.sum() > 20
    assert np.abs(place("tooth") * turns["gear"] - place("contact"))[on].max() < 1e-9
    seen = mate.pose.origin + mate.pose.direction * place("mate_tooth") * turns["mate"]
    assert np.abs(seen[on] - contact).max() < 1e-9
    # The points are the gear's own, not its cutter's, and the mate's.
    own = recipe.pinion.circles[0] if name == "lantern" else recipe.gear.outline
    assert gk.nearest(own, place("tooth")[on])[1].max() < 1e-9
    assert gk.nearest(mate.outline, place("mate_tooth")[on])[1].max() < 1e-9
    ratio = np.diff(columns["mate_angle"][on]) / np.diff(columns["gear_angle"][on])
    expected = mate.gear_teeth / mate.teeth * (1 if mate.is_ring else -1)
    assert ratio == pytest.approx(np.full(len(ratio), expected), rel=1e-6)


@pytest.mark.parametrize("name", by_default(TEXTS, ["straight", "points"]))
def test_backlash_that_leaves_no_tooth_is_refused_with_a_number_that_works(name):
    with pytest.raises(gk.DesignError) as caught:
        _ = read(name, 20).design
    assert caught.value.field == "mate.backlash"
    most = float(caught.value.remedy.split("at most ")[1])
    mate = read(name, most).design
    assert mate.tip_thickness > 0
    with pytest.raises(gk.DesignError, match="backlash"):
        _ = read(name, most * 1.001).design
