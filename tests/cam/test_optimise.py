"""Segments of least peak acceleration by second roads: published optima, scans, duality, the exact bounds."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.polynomial import Polynomial

import geomkin as gk
from geomkin.cam.program.optimise import optimal_polynomial, optimal_spline
from geomkin.cam.program.program import Program
from geomkin.cam.program.segments import OptimisedPolynomial, OptimisedSpline

REST = (0.0, 0.0)
X = np.linspace(0, 1, 100_001)


def rising(segment):
    """The segment as a rise of 2 in 90 deg between dwells."""
    return Program([gk.Dwell(end_deg=90), segment, gk.Dwell(end_deg=270), gk.Return("cycloidal", end_deg=360)])


def peaks(program, low, high):
    """Largest acceleration and jerk met on a fine walk between two angles, deg."""
    motion = program.motion(np.radians(np.linspace(low, high, 200_001)[:-1]))
    return np.abs(motion.acceleration).max(), np.abs(motion.jerk).max()


@pytest.mark.parametrize(
    ("segment", "published"),
    [
        # A rise of 2 in 90 deg: solved elsewhere as linear programmes over the same families.
        (OptimisedPolynomial(5, rise=2, end_deg=180), 4.680),
        (OptimisedPolynomial(7, rise=2, end_deg=180), 4.548),
        (OptimisedPolynomial(9, rise=2, end_deg=180), 3.775),
        (OptimisedPolynomial(12, rise=2, end_deg=180), 3.751),
        (OptimisedSpline(20, rise=2, end_deg=180), 3.603),
        (OptimisedSpline(80, rise=2, end_deg=180), 3.325),
    ],
    ids=str,
)
def test_the_published_optima_are_met(segment, published):
    program = rising(segment)
    optimum = program.optima[1]
    assert optimum.peak_acceleration == pytest.approx(published, abs=6e-4)
    assert optimum.gap <= 1e-9
    walked, jerk = peaks(program, 90, 180)
    assert walked == pytest.approx(optimum.peak_acceleration, rel=1e-7)
    assert jerk == pytest.approx(optimum.peak_jerk, rel=1e-7)
    # The bang-bang motion is below them all, cycloidal above.
    assert 4 * 2 / (np.pi / 2) ** 2 < walked < 2 * np.pi * 2 / (np.pi / 2) ** 2


@pytest.mark.campaign
def test_degree_5_is_the_345_law_and_degree_7_with_jerk_the_4567_law():
    own, named = optimal_polynomial(5, 1.0, REST, REST, None).law(X), Program(
        [gk.Rise("3-4-5", rise=1, end_deg=180), gk.Return("4-5-6-7", end_deg=360)]
    ).motion(np.append(np.pi * X[:-1], 2 * np.pi - np.pi * X[1:]))  # fmt: skip
    half = len(X) - 1
    assert own[0, :-1] == pytest.approx(named.lift[:half], abs=1e-13)
    own = optimal_polynomial(7, 1.0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), None).law(X)
    assert own[0, 1:] == pytest.approx(named.lift[half:], abs=1e-12)


@pytest.mark.campaign
@settings(deadline=None, max_examples=15)
@given(
    st.integers(5, 12),
    st.tuples(st.floats(-2, 2), st.floats(-20, 20), st.floats(-2, 2), st.floats(-20, 20)),
    st.lists(st.floats(-30, 30), min_size=7, max_size=7),
)
def test_no_motion_of_the_family_is_below_the_bound(degree, ends, stray):
    ends = tuple(round(v, 3) for v in ends)
    optimum = optimal_polynomial(degree, 1.0, ends[:2], ends[2:], None)
    assert optimum.gap <= 2e-9
    found = optimum.law(X)
    assert found[:3, 0] == pytest.approx([0, *ends[:2]], abs=1e-9)
    assert found[:3, -1] == pytest.approx([1, *ends[2:]], abs=1e-9)
    assert np.abs(found[2]).max() == pytest.approx(optimum.peak_acceleration, rel=1e-6)
    # Any other: what is added vanishes three times at both ends.
    added = Polynomial([0, 0, 0, 1]) * Polynomial([1, -1]) ** 3 * Polynomial(stray[: max(degree - 5, 0)] or [0])
    assert np.abs(found[2] + added.deriv(2)(X)).max() >= optimum.bound * (1 - 1e-9)


@settings(deadline=None, max_examples=15)
@given(
    st.integers(4, 60),
    st.tuples(st.floats(-2, 2), st.floats(-20, 20), st.floats(-2, 2), st.floats(-20, 20)),
    st.floats(100, 1000),
    st.integers(0, 2**32 - 1),
)
def test_no_acceleration_spline_is_below_the_bound(intervals, ends, limit, seed):
    ends = tuple(round(v, 3) for v in ends)
    try:
        optimum = optimal_spline(intervals, 1.0, ends[:2], ends[2:], limit)
    except gk.DesignError as error:
        assert error.field == "jerk_limit"
        return
    assert optimum.gap <= 2e-9 and optimum.peak_jerk <= limit * (1 + 1e-9)
    found = optimum.law(X)
    assert found[:3, 0] == pytest.approx([0, *ends[:2]], abs=1e-8)
    assert found[:3, -1] == pytest.approx([1, *ends[2:]], abs=1e-8)
    # Another of the family: any knots, then put right at two of them so that slope and lift at the end fit.
    x = np.linspace(0, 1, intervals + 1)
    knots = optimum.law(x)[2] + np.pad(np.random.default_rng(seed).normal(size=intervals - 1), 1)
    hats = np.eye(intervals + 1)[[1, -2]]

    def reached(a):
        """Slope and lift gained, by Simpson's rule, exact for cubics."""
        weight = np.array([1, 4, 1]) / (6 * intervals)
        fine = x[:-1, None] + np.array([0, 0.5, 1]) / intervals
        a = np.interp(fine, x, a)
        return np.array([(a @ weight).sum(), ((1 - fine) * a @ weight).sum()])

    missing = np.array([ends[2] - ends[0], 1 - ends[0]]) - reached(knots)
    put = np.linalg.solve(np.column_stack([reached(hat) for hat in hats]), missing)
    other = knots + put @ hats
    within = np.abs(np.diff(other)).max() * intervals <= limit
    assert not within or np.abs(other).max() >= optimum.bound * (1 - 1e-9)


@pytest.mark.parametrize(("degree", "limit"), [(7, 40.0), (9, 75.0), (15, 50.0)])
def test_polynomials_keep_their_jerk_limit_between_the_points_too_and_pay_for_it(degree, limit):
    optimum = optimal_polynomial(degree, 1.0, REST, REST, limit)
    values = optimum.law(X)
    assert np.abs(values[3]).max() <= limit * (1 + 2e-9) and optimum.gap <= 1e-9
    # A bound above a motion that is there would be no bound.
    assert optimum.bound <= np.abs(values[2]).max() * (1 + 1e-6)
    assert np.abs(values[2]).max() == pytest.approx(optimum.peak_acceleration, rel=1e-6)
    free = optimal_polynomial(degree, 1.0, REST, REST, None)
    assert optimum.peak_acceleration >= free.peak_acceleration * (1 - 1e-9)
    assert (free.peak_jerk <= limit) == (abs(optimum.peak_acceleration / free.peak_acceleration - 1) < 1e-9)
    # The trapezoid is the best of all motions with that jerk.
    assert optimum.peak_acceleration > limit / 4 * (1 - np.sqrt(1 - 32 / limit))


@pytest.mark.parametrize(("degree", "jerk"), [(6, 60), (8, 80), (15, 288)])
def test_optima_are_exact_to_the_last_digits_also_where_the_peak_hardly_changes(degree, jerk):
    """These have whole-numbered jerks; a peak good to 1e-9 alone would give them to 1e-5."""
    optimum = optimal_polynomial(degree, 1.0, REST, REST, None)
    assert optimum.peak_jerk == pytest.approx(jerk, rel=1e-11) and optimum.gap < 1e-12


def test_a_jerk_no_motion_keeps_is_refused_with_the_least_that_would_do():
    with pytest.raises(gk.DesignError) as refused:
        optimal_polynomial(7, 1.0, REST, REST, 38.5)
    assert refused.value.field == "jerk_limit" and "38.6" in refused.value.remedy
    assert optimal_polynomial(7, 1.0, REST, REST, 38.62).peak_jerk <= 38.62 * (1 + 1e-9)
    with pytest.raises(gk.DesignError):
        optimal_spline(40, 1.0, REST, REST, 31.0)


def test_segment_starts_and_ends_with_the_rates_of_its_neighbours():
    program = Program(
        [
            gk.Dwell(end_deg=30),
            OptimisedPolynomial(9, rise=3, end_deg=60),
            gk.Rise("uniform", rise=10, end_deg=120),
            OptimisedSpline(40, rise=3, end_deg=150, jerk_limit=800),
            gk.Dwell(end_deg=180),
            gk.Return("harmonic", end_lift=8, end_deg=240),
            OptimisedPolynomial(11, end_lift=0, end_deg=330, match_jerk=True),
            gk.Dwell(end_deg=360),
        ]
    )
    degrees = np.degrees(program.breaks[:-1])
    here = np.isclose(degrees[:, None], [30, 60, 120, 150, 240, 330]).any(axis=1)
    for name in ("lift", "velocity", "acceleration"):
        assert (getattr(program.jumps, name)[here] == 0).all(), name
    assert program.jumps.jerk[np.isclose(degrees, 240) | np.isclose(degrees, 330)] == pytest.approx([0, 0], abs=1e-6)
    # Joining a slope of 10 in 60 deg over 3 in 30 deg: no peak can be below that of one constant acceleration.
    assert program.optima[1].bound > (10 / 60) / 30 * (180 / np.pi) ** 2 * 0.999
    assert set(program.optima) == {1, 3, 6}


def test_where_a_neighbour_has_the_peak_the_least_jerk_decides():
    program = Program(
        [
            gk.Rise("harmonic", rise=5, end_deg=90),
            OptimisedPolynomial(9, end_lift=2, end_deg=230),
            gk.Dwell(end_deg=270),
            gk.Return("cycloidal", end_deg=360),
        ]
    )
    optimum = program.optima[1]
    start = abs(program.motion(np.radians(90)).acceleration)
    walked, jerk = peaks(program, 90, 230)
    assert walked == pytest.approx(start, rel=1e-8) == optimum.peak_acceleration and optimum.gap < 2e-9
    assert jerk == pytest.approx(optimum.peak_jerk, rel=1e-7)
    # A motion with as low a peak and less jerk: none among many that differ in what the ends leave free.
    added = Polynomial([0, 0, 0, 1]) * Polynomial([1, -1]) ** 3
    x, angle = X[::50], np.radians(140)
    own = optimum.law(x)
    for stray in np.random.default_rng(7).normal(size=(300, 4)) * 10.0 ** -np.arange(300)[:, None].clip(0, 6):
        other = added * Polynomial(stray)
        too_high = np.abs(own[2] + other.deriv(2)(x)).max() > np.abs(own[2]).max() * (1 + 1e-9)
        assert too_high or np.abs(own[3] + other.deriv(3)(x)).max() >= jerk * angle**3 / 3 * (1 - 1e-7)


@pytest.mark.parametrize("ends", [(0.5, -9.0, 0.0, 1.0)])
def test_a_spline_beside_the_peak_has_the_least_jerk_of_all_found_by_a_scan(ends):
    """Of five intervals with two accelerations free: the other two follow from slope and lift at the end."""
    optimum = optimal_spline(5, 1.0, ends[:2], ends[2:], None)
    highest = max(abs(ends[1]), abs(ends[3]))
    assert optimum.peak_acceleration == pytest.approx(highest, rel=1e-8)
    free = np.linspace(-highest, highest, 401)
    one, two = (a.ravel() for a in np.meshgrid(free, free))
    # By trapezoids: a knot adds a fifth to the slope, and that times the way that is left to the lift.
    missing = [ends[2] - ends[0] - 0.1 * (ends[1] + ends[3]) - 0.2 * (one + two),
               1 - ends[0] - ends[1] * (0.1 - 1 / 150) - ends[3] / 150 - 0.2 * (0.8 * one + 0.6 * two)]  # fmt: skip
    three, four = np.linalg.solve([[0.2, 0.2], [0.2 * 0.4, 0.2 * 0.2]], missing)
    knots = np.stack([0 * one + ends[1], one, two, three, four, 0 * one + ends[3]])
    steepest = 5 * np.abs(np.diff(knots, axis=0)).max(axis=0)[np.abs(knots).max(axis=0) <= highest * (1 + 1e-9)]
    step = 5 * (free[1] - free[0])
    assert steepest.min() - 6 * step < optimum.peak_jerk < steepest.min() + 1e-6


def test_a_fall_is_a_rise_upside_down_and_an_arm_a_follower_in_radians():
    program = Program(
        [
            OptimisedPolynomial(9, rise_deg=20, end_deg=90),
            OptimisedPolynomial(9, end_lift_deg=0, end_deg=180),
            gk.Dwell(end_deg=360),
        ]
    )
    angle = np.linspace(0, np.pi / 2, 99)[1:-1]
    up, down = program.motion(angle), program.motion(np.pi - angle)
    assert up.lift == pytest.approx(down.lift, abs=1e-12)
    assert up.acceleration == pytest.approx(down.acceleration, abs=1e-9)
    for k in (0, 1):
        assert program.optima[k].peak_acceleration == pytest.approx(3.7752 / 2 * np.radians(20), rel=1e-4)


@pytest.mark.parametrize(
    "segment", [OptimisedPolynomial(9, rise=0, end_deg=220), OptimisedSpline(30, rise=0, end_deg=220)]
)
def test_a_hill_that_ends_where_it_began_has_its_peaks(segment):
    up, down = gk.Rise("uniform", rise=5, end_deg=140), gk.Return("uniform", end_deg=360)
    optimum = Program([up, segment, down]).optima[1]
    acceleration, jerk = peaks(Program([up, segment, down]), 140, 220)
    assert optimum.peak_acceleration == pytest.approx(acceleration, rel=1e-4) and optimum.gap < 2e-9
    assert optimum.peak_jerk == pytest.approx(jerk, rel=1e-3)
