"""How far bodies swing, against the dead centres by the law of cosines."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.linkage.measures import swings


@pytest.mark.parametrize("frames", [37, 361])
def test_rocker_swings_between_its_dead_centres(frames):
    ground, crank, coupler, rocker = 100, 30, 90, 70
    motion = gk.move(gk.FourBar(ground, crank, coupler, rocker), np.linspace(0, 2 * np.pi, frames))
    ends = []
    for apart in (coupler - crank, coupler + crank):
        corner = np.arccos((ground**2 + rocker**2 - apart**2) / (2 * ground * rocker))
        ends.append(180 - np.degrees(corner))
    assert swings(motion).keys() == {"rocker"}
    assert swings(motion)["rocker"] == pytest.approx(sorted(ends), abs=1e-9)


def test_bodies_that_turn_fully_or_do_not_close_have_no_swing():
    turns = np.linspace(0, 2 * np.pi, 73)
    assert swings(gk.move(gk.FourBar(30, 80, 70, 90), turns)) == {}
    assert swings(gk.move(gk.FourBar(100, 80, 30, 60), turns)) == {}
