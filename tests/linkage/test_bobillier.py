"""Bobillier's constructions against the inflection circle of the motion, and the angles he speaks of."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import geomkin as gk
from geomkin.linkage.instant.curvature import PathCurvature, crank_path, path_curvature
from geomkin.linkage.instant.inflection import bobillier, bobillier_path, inflection_circle, inflection_circle_of_cranks
from tests.linkage.examples import crank_paths

TURN = np.linspace(0.05, 2 * np.pi + 0.05, 73)
FOUR_BAR = gk.FourBar(100, 30, 90, 70, origin=12 - 7j, ground_angle_deg=33.0)
PARALLEL_CRANKS = gk.FourBar(100, 30, float(np.hypot(100, 30)), 60)


def aslant(one, other):
    """Sine of the angle between two lines."""
    return np.abs(np.imag(np.conj(one) * other))


def test_the_tangent_is_that_of_the_motion():
    motion = gk.move(FOUR_BAR, TURN)
    drawn, circle = bobillier(*crank_paths(motion)), inflection_circle(motion, "coupler")
    assert aslant(drawn.tangent, circle.tangent).max() < 1e-12
    centre = circle.instant_centre.position
    assert np.abs(drawn.instant_centre.position / centre - 1).max() < 1e-10
    assert np.abs(drawn.tangent_foot - circle.tangent_foot).max() < 1e-9
    for line, foot in ((drawn.axis, drawn.axis_foot), (drawn.tangent, drawn.tangent_foot)):
        assert (np.abs(np.imag(np.conj(line) * (centre - foot))) / np.abs(centre)).max() < 1e-10
    assert aslant(drawn.axis, (drawn.crossing - centre) / np.abs(drawn.crossing - centre)).max() < 1e-9


@given(st.lists(st.floats(0.2, 5), min_size=4, max_size=4), st.floats(0, 6.28), st.sampled_from([1, -1]))
def test_both_constructions_agree_with_the_motion_of_any_four_bar(lengths, angle, branch):
    longest = max(lengths)
    assume(longest < 0.99 * (sum(lengths) - longest))
    motion = gk.move(gk.FourBar(*lengths), [angle], branch)
    assume(motion.assembled[0] and motion.transmission_angle[0] > 0.05)
    one, two = crank_paths(motion)
    circle = inflection_circle(motion, "coupler")
    assume(np.isfinite(circle.tangent[0]) and abs(circle.tangent_foot[0]) < 100)
    assume(max(aslant(one.tangent, two.tangent)[0], 0) > 0.01)
    # A crank along the tangent says nothing of other points.
    for crank in (one, two):
        assume(aslant(1j * crank.tangent, circle.tangent)[0] > 0.01)
    assert aslant(bobillier(one, two).tangent, circle.tangent)[0] < 1e-6
    found = bobillier_path(one, circle.tangent_foot, circle.tangent, two.position)
    assert abs(found.centre[0] - lengths[0]) < 1e-5 * longest


def test_one_crank_and_the_tangent_give_the_path_of_any_point():
    motion = gk.move(FOUR_BAR, TURN)
    circle = inflection_circle(motion, "coupler")
    for local in (40 + 25j, -60 - 5j):
        known = path_curvature(motion, "coupler", local)
        for crank in crank_paths(motion):
            clear = aslant(1j * crank.tangent, circle.tangent) > 0.02
            found = bobillier_path(crank, circle.tangent_foot, circle.tangent, known.position)
            assert clear.sum() > 60
            assert np.abs(np.abs(found.curvature) - np.abs(known.curvature))[clear].max() < 1e-10
            assert (np.abs(found.centre - known.centre) / (1 + known.radius**2))[clear].max() < 1e-10
            assert aslant(found.tangent, known.tangent)[clear].max() < 1e-10


def test_sliders_are_cranks_like_others():
    motion = gk.move(gk.SliderCrank(30, 90, 10), TURN)
    circle = inflection_circle(motion, "coupler")
    crank = crank_path(motion.point("crank_pin").position, motion.point("crank_pivot").position)
    slider = PathCurvature(motion.point("slider_pin").position, 1 + 0j, 0.0)
    for pair in ((crank, slider), (slider, crank)):
        assert aslant(bobillier(*pair).tangent, circle.tangent).max() < 1e-12
    clear = aslant(1j * crank.tangent, circle.tangent) > 0.05
    found = bobillier_path(crank, circle.tangent_foot, circle.tangent, slider.position)
    assert np.abs(found.curvature[clear]).max() < 1e-12 and aslant(found.tangent, 1)[clear].max() < 1e-12
    back = bobillier_path(slider, circle.tangent_foot, circle.tangent, crank.position)
    clear = aslant(1j, circle.tangent) > 0.05
    assert np.abs(back.centre)[clear].max() < 1e-9


@pytest.mark.parametrize("away", [0.0, 1e-7])
def test_parallel_cranks_and_nearly_so(away):
    motion = gk.move(PARALLEL_CRANKS, [np.pi / 2 - away])
    one, two = crank_paths(motion)
    drawn, circle = bobillier(one, two), inflection_circle(motion, "coupler")
    assert np.isnan(drawn.instant_centre.position[0]) == (away == 0)
    # Crossing of coupler and frame at x = -100; cranks at 0 and 100: so the tangent stands at x = 200.
    assert abs(drawn.crossing[0] - -100) < 1e-9 + 40 * away
    assert abs(drawn.axis_foot[0].real - -100) < 1e-9 + 100 * away
    assert abs(drawn.tangent_foot[0] - (200 + 30j)) < 1e-9 + 100 * away
    assert abs(drawn.tangent_foot[0] - circle.tangent_foot[0]) < 1e-9
    found = bobillier_path(one, drawn.tangent_foot, drawn.tangent, two.position)
    assert abs(found.centre[0] - 100) < 1e-9
    found = bobillier_path(two, drawn.tangent_foot, drawn.tangent, 50 + 70j)
    assert abs(found.curvature[0]) == pytest.approx(1 / 40, abs=1e-10 + away)


def test_a_pin_at_the_instant_centre_has_the_tangent_along_its_crank():
    a, end = 30 * np.exp(1j * 0.9), 100 + 0j
    pin = a + (end - a) / abs(end - a) * 45
    one, two = crank_path(a, 0), crank_path(pin, end)
    for pair in ((one, two), (two, one)):
        assert aslant(bobillier(*pair).tangent, a / 30) < 1e-13
    circle = inflection_circle_of_cranks(one, two)
    assert np.isnan(bobillier_path(one, circle.tangent_foot, circle.tangent, 40j).curvature)
    found = bobillier_path(two, circle.tangent_foot, circle.tangent, 40j)
    assert abs(found.curvature) == pytest.approx(abs(circle.path(40j).curvature))
