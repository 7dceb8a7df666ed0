"""What a shell shows of results, which hold arrays over all frames: one line."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.linkage import (
    CentrodeCurve,
    Centrodes,
    DirectContact,
    SliderCrankMasses,
    best_counterbalance,
    bobillier,
    cognates,
    crank_path,
    inflection_circle,
    instant_centre,
    path_curvature,
    velocity_polygon,
)

FOUR_BAR = gk.FourBar(100, 30, 90, 70, 40 + 25j)
MOTION = gk.move(FOUR_BAR, np.linspace(0.1, 6, 361))
STACK = gk.linkage.stack_links(MOTION)
SHOWN = [
    instant_centre(MOTION, "coupler", "ground"),
    inflection_circle(MOTION, "coupler"),
    path_curvature(MOTION, "coupler", 10j),
    bobillier(crank_path(30j, 0), crank_path(90 + 40j, 100)),
    *cognates(FOUR_BAR),
    velocity_polygon(MOTION),
    *velocity_polygon(MOTION).vectors,
    Centrodes(MOTION, "coupler"),
    CentrodeCurve(FOUR_BAR, "coupler", (0.5, 0.7)),
    gk.CouplerCurve(FOUR_BAR, "coupler_point"),
    SliderCrankMasses(0.5, 0.6, 0.8),
    best_counterbalance(gk.SliderCrank(30, 90), SliderCrankMasses(0.5, 0.6, 0.8)),
    DirectContact(10 + 5j, 1j, np.full(9, 12.0), 8.0, follower_pivot=50 + 0j),
    STACK,
    *STACK.pins,
    *STACK.plates.values(),
    gk.linkage.LinkStock(),
    gk.linkage.PlateStock(),
]


@pytest.mark.parametrize("thing", SHOWN, ids=lambda thing: type(thing).__name__)
def test_results_are_shown_on_one_line(thing):
    text = repr(thing)
    assert text.startswith(f"{type(thing).__name__}(") and "\n" not in text and len(text) <= 120
