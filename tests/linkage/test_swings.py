"""How far bodies swing, against the dead centres by the law of cosines."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.linkage.measures import strokes, swings
from geomkin.recipe.shown import ShownRecipe


@pytest.mark.parametrize("frames", [37, 361])
def test_rocker_swings_between_its_dead_centres(frames):
    ground, crank, coupler, rocker = 100, 30, 90, 70
    motion = gk.move(gk.FourBar(ground, crank, coupler, rocker), np.linspace(0, 2 * np.pi, frames))
    ends = []
    for apart in (coupler - crank, coupler + crank):
        corner = np.arccos((ground**2 + rocker**2 - apart**2) / (2 * ground * rocker))
        ends.append(180 - np.degrees(corner))
    assert swings(motion).keys() == {"rocker"}
    assert swings(motion)["rocker"][:2] == pytest.approx(sorted(ends), abs=1e-9)


@pytest.mark.parametrize("turn", [2 * np.pi, -2 * np.pi])
def test_stroke_and_time_ratio_of_an_offset_slider_crank_are_those_of_its_dead_centres(turn):
    crank, coupler, offset = 30, 80, 25
    motion = gk.move(gk.SliderCrank(crank=crank, coupler=coupler, offset=offset), np.linspace(0, turn, 73))
    far, near = (np.sqrt((coupler + way * crank) ** 2 - offset**2) for way in (1, -1))
    # Angle between the two positions in which crank and coupler are in line.
    apart = np.arcsin(offset / (coupler - crank)) - np.arcsin(offset / (coupler + crank))
    (ends,) = strokes(motion).values()
    assert ends.between == pytest.approx(far - near, abs=1e-9)
    assert ends.time_ratio == pytest.approx((np.pi + apart) / (np.pi - apart), abs=1e-6)


def test_part_of_a_turn_has_no_time_ratio():
    motion = gk.move(gk.FourBar(100, 30, 90, 70), np.linspace(0, 6, 73))
    assert np.isnan(swings(motion)["rocker"].time_ratio) and strokes(motion) == {}


def test_bodies_that_turn_fully_or_do_not_close_have_no_swing():
    turns = np.linspace(0, 2 * np.pi, 73)
    assert swings(gk.move(gk.FourBar(30, 80, 70, 90), turns)) == {}
    assert swings(gk.move(gk.FourBar(100, 80, 30, 60), turns)) == {}


@pytest.mark.parametrize("units", ["mm", "in"])
def test_time_ratio_of_a_summary_is_no_length(units):
    recipe = gk.load({"kind": "slider-crank", "units": units, "linkage": {"crank": 30, "coupler": 90, "offset": 30}})
    (entry,) = ShownRecipe(recipe).notes[f"strokes_{units}"].values()
    apart = np.arcsin(1 / 2) - np.arcsin(1 / 4)
    assert entry["time_ratio"] == pytest.approx((np.pi + apart) / (np.pi - apart), rel=1e-3)
    assert entry["stroke"] == pytest.approx(30 * (np.sqrt(15) - np.sqrt(3)), rel=1e-8)
