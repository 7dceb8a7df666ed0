"""The inflection circle from motion, from cranks alone, of rolling wheels, and where it is a straight line."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import geomkin as gk
from geomkin.linkage.instant.curvature import PathCurvature, crank_path, euler_savary, path_curvature
from geomkin.linkage.instant.inflection import InflectionCircle, inflection_circle, inflection_circle_of_cranks
from tests.linkage.examples import crank_paths

TURN = np.linspace(0.05, 2 * np.pi + 0.05, 73)
PLACED = {"origin": 12 - 7j, "ground_angle_deg": 33.0}
FOUR_BAR = gk.FourBar(100, 30, 90, 70, **PLACED)
# At 90 deg of the crank both cranks stand upright.
PARALLEL_CRANKS = gk.FourBar(100, 30, float(np.hypot(100, 30)), 60)


@given(st.lists(st.floats(0.2, 5), min_size=4, max_size=4), st.floats(0, 6.28), st.sampled_from([1, -1]))
def test_motion_and_cranks_alone_give_the_same_circle(lengths, angle, branch):
    longest = max(lengths)
    assume(longest < 0.99 * (sum(lengths) - longest))
    motion = gk.move(gk.FourBar(*lengths), [angle], branch)
    assume(motion.assembled[0] and motion.transmission_angle[0] > 0.05)
    by_motion, by_cranks = inflection_circle(motion, "coupler"), inflection_circle_of_cranks(*crank_paths(motion))
    assume(np.isfinite(by_motion.nearest[0]) and abs(by_motion.nearest[0]) < 1e3)
    # Digits that the two roads lose in common: the first by the transmission angle, both by the angle of the cranks.
    assert abs(by_cranks.nearest[0] - by_motion.nearest[0]) < 1e-6 * longest * 10
    if by_motion.diameter[0] < 1e6:
        assert by_cranks.diameter[0] == pytest.approx(by_motion.diameter[0], rel=1e-6, abs=1e-9)
        assert abs(by_cranks.pole[0] - by_motion.pole[0]) < 1e-6 * (1 + by_motion.diameter[0])
    for place in (0.3 + 0.4j, -2j):
        bends = [abs(circle.path(place).curvature[0]) for circle in (by_motion, by_cranks)]
        assert bends[0] == pytest.approx(bends[1], rel=1e-5, abs=1e-8)


def test_paths_are_straight_on_the_circle_and_bent_off_it():
    motion = gk.move(FOUR_BAR, TURN)
    circle = inflection_circle(motion, "coupler")
    middle = circle.pole - circle.diameter * circle.normal / 2
    for turn in np.exp(1j * np.array([0.0, 0.3, 2.0, -1.5])):
        place = middle + circle.diameter / 2 * circle.normal * turn
        inside = middle + 0.9 * (place - middle)
        local = [(z - motion.coupler.origin.position) * np.conj(motion.coupler.direction) for z in (place, inside)]
        on, off = (path_curvature(motion, "coupler", z) for z in local)
        assert np.all(np.abs(on.curvature) * circle.diameter < 1e-8)
        assert np.all(np.abs(off.curvature) * circle.diameter > 0.04)
    assert np.abs(np.abs(circle.nearest - middle) / (circle.diameter / 2) - 1).max() < 1e-9
    gap = np.abs(np.abs(circle.reference - middle) - circle.diameter / 2)
    assert np.abs(np.abs(circle.reference - circle.nearest) - gap).max() < 1e-9 * circle.diameter.max()


def test_euler_savary_along_the_ray_gives_the_centre_that_the_motion_gives():
    motion = gk.move(FOUR_BAR, TURN)
    circle = inflection_circle(motion, "coupler")
    centre = circle.instant_centre.position
    for local in (40 + 25j, -60 - 5j, 90 + 0j):
        path = path_curvature(motion, "coupler", local)
        ray = (path.position - centre) / np.abs(path.position - centre)
        cut = circle.inflection(ray)
        assert (
            np.abs(cut - circle.diameter * np.cos(np.angle(ray / circle.normal))).max() < 1e-9 * circle.diameter.max()
        )
        found = euler_savary(instant_centre=0, point=np.abs(path.position - centre), inflection=cut)
        assert (np.abs(centre + ray * found - path.centre) / (1 + np.abs(found))).max() < 1e-9
        drawn = circle.path(path.position)
        assert np.abs(drawn.curvature - path.curvature).max() < 1e-11
        assert np.abs(drawn.tangent - path.tangent).max() < 1e-12


def test_a_sliders_pin_and_the_pole_of_a_slider_crank_stand_on_the_slide():
    motion = gk.move(gk.SliderCrank(30, 90, 10), TURN)
    circle = inflection_circle(motion, "coupler")
    assert np.abs(circle.pole.imag - 10).max() < 1e-12 * np.nanmax(circle.diameter)
    crank = crank_path(motion.point("crank_pin").position, motion.point("crank_pivot").position)
    slider = PathCurvature(motion.point("slider_pin").position, 1 + 0j, 0.0)
    for pair in ((crank, slider), (slider, crank)):
        alone = inflection_circle_of_cranks(*pair)
        assert np.abs(alone.pole / circle.pole - 1).max() < 1e-10


def test_wheels_have_the_curvature_of_their_cycloids():
    """A wheel of radius 10 that rolls along the x axis: radius of curvature twice the distance from the ground."""
    wheel = InflectionCircle(*(np.array(v) for v in (10j, 10 + 0j, 0j, -1.0, 0.0)))
    assert wheel.diameter == 10 and wheel.pole == 10j and wheel.instant_centre.position == 0
    assert abs(wheel.tangent - 1) < 1e-15 and wheel.centre_velocity == 10
    for angle in np.linspace(0.1, 6.2, 7):
        rim = 10j - 10j * np.exp(1j * angle)
        assert abs(wheel.path(rim).radius) == pytest.approx(2 * abs(rim))
        assert abs(wheel.path(rim).centre - -rim) < 1e-12
    touching = wheel.path(0j)
    assert touching.radius == 0 and touching.centre == 0 and np.isnan(touching.tangent)
    # A point near by along the tangent has its own distance for radius, which rounding hides: not a straight path.
    assert abs(wheel.path(1e-3).radius) == pytest.approx(1e-3) and np.isnan(wheel.path(1e-9).curvature)
    # Inside a ring of radius 25 the diameter is r R / (R - r); the hypocycloid of a wheel half the ring is straight.
    for ring, diameter in [(25.0, 10 * 25 / 15), (20.0, 20.0)]:
        arm = ring - 10
        inside = InflectionCircle(*(np.array(v) for v in (arm + 0j, 1j * arm, -arm + 0j, -arm / 10, 0.0)))
        assert inside.diameter == pytest.approx(diameter)
        assert inside.instant_centre.position == pytest.approx(ring)


def test_the_published_velocity_and_acceleration_state():
    """Velocity 1 along x and turning 4 at the origin, acceleration 10 along y and -10 of the turning."""
    state = InflectionCircle(*(np.array(v) for v in (0j, 1 + 0j, 10j, 4.0, -10.0)))
    assert state.instant_centre.position == pytest.approx(0.25j)
    # (1, 1) moves (-3, 4) with (-6, -16), (2, 0) moves (1, 8) with (-32, -10).
    assert state.path(1 + 1j).curvature == pytest.approx((3 * 16 + 4 * 6) / 5**3)
    assert state.path(2 + 0j).curvature == pytest.approx((-10 + 8 * 32) / 65**1.5)


def test_parallel_cranks_make_it_a_straight_line_along_the_cranks():
    step = 1e-4
    motion = gk.move(PARALLEL_CRANKS, np.pi / 2 + np.array([-step, 0, step]))
    exact = gk.move(PARALLEL_CRANKS, [np.pi / 2])
    for circle in (inflection_circle(exact, "coupler"), inflection_circle_of_cranks(*crank_paths(exact))):
        assert circle.angular_velocity[0] == 0 and circle.diameter[0] == np.inf
        assert np.isnan(circle.pole[0]) and np.isnan(circle.instant_centre.position[0])
        assert np.isnan(circle.centre_velocity[0])
        assert abs(circle.tangent[0].real) < 1e-12
        # Curvature 1/30 at x = 0 and 1/60 at x = 100, and linear across the cranks: 0 at x = 200.
        assert circle.nearest[0] == pytest.approx(200 + 30j)
        for place, bend in [(200 - 50j, 0), (0, 1 / 30), (100, 1 / 60), (50 + 70j, 1 / 40), (300, -1 / 60)]:
            assert abs(circle.path(place).curvature[0]) == pytest.approx(abs(bend), abs=1e-12)
            local = (place - exact.coupler.origin.position[0]) / exact.coupler.direction[0]
            p, q, r = motion.coupler.point(local).position
            a, b = q - p, r - p
            chord = 2 * np.imag(np.conj(a) * b) / (abs(a) * abs(b) * abs(r - q))
            assert abs(chord) == pytest.approx(abs(bend), abs=1e-5)


def test_circle_is_continuous_through_infinity():
    steps = np.array([-1e-3, -1e-5, -1e-7, -1e-10, 0, 1e-10, 1e-7, 1e-5, 1e-3])
    motion = gk.move(PARALLEL_CRANKS, np.pi / 2 + steps)
    for circle in (inflection_circle(motion, "coupler"), inflection_circle_of_cranks(*crank_paths(motion))):
        for places in (circle.nearest, circle.tangent_foot):
            # Both move by some 80 mm per radian of the crank.
            assert np.all(np.abs(places - places[4]) < 80 * np.abs(steps) + 1e-9)
        assert np.abs(np.imag(np.conj(circle.tangent) * circle.tangent[4])).max() < 1e-2
        assert np.array_equal(np.isfinite(circle.pole), steps != 0)


def test_a_parallelogram_has_none_and_all_its_paths_are_alike():
    motion = gk.move(gk.FourBar(100, 30, 100, 30), np.linspace(0.1, 3, 9))
    for circle in (inflection_circle(motion, "coupler"), inflection_circle_of_cranks(*crank_paths(motion))):
        for part in (circle.diameter, circle.pole, circle.normal, circle.tangent, circle.nearest, circle.tangent_foot):
            assert np.isnan(part).all()
        assert np.abs(np.abs(circle.path(17 - 80j).curvature) * 30 - 1).max() < 1e-12


def test_circle_is_found_with_a_pin_at_the_instant_centre():
    """Rocker and coupler in line: the crank pin is at rest for a moment, and the tangent along the crank."""
    a, end = 30 * np.exp(1j * 0.9), 100 + 0j
    pin = a + (end - a) / abs(end - a) * 45  # coupler of 45 that points at the rocker's pivot
    circle = inflection_circle_of_cranks(crank_path(a, 0), crank_path(pin, end))
    assert abs(circle.instant_centre.position - a) < 1e-13
    # By the second crank alone: its ray's inflection point, and the tangent along the first crank.
    ray = (pin - a) / 45
    cut = euler_savary(instant_centre=0, point=45.0, centre=abs(end - a))
    assert abs(np.imag(np.conj(a) * circle.tangent)) < 1e-12
    assert circle.inflection(ray) == pytest.approx(cut)
    across = 1j * a / abs(a)
    assert circle.diameter == pytest.approx(abs(cut / np.real(np.conj(across) * ray)))


def test_a_pinned_body_has_a_circle_of_no_size_and_a_slider_none():
    motion = gk.move(gk.SliderCrank(30, 90, 10, **PLACED), TURN)
    crank = inflection_circle(motion, "crank")
    assert np.all(crank.diameter == 0) and np.abs(crank.pole - PLACED["origin"]).max() < 1e-12
    assert np.all(crank.centre_velocity == 0)
    slider = inflection_circle(motion, "slider")
    assert np.isnan(slider.diameter).all() and np.all(slider.path(1 + 1j).curvature == 0)


def test_open_frames_dead_centres_and_rest_are_nan():
    motion = gk.move(gk.FourBar(3, 2, 2.5, 4), TURN)
    assert np.array_equal(np.isnan(inflection_circle(motion, "coupler").diameter), ~motion.assembled)
    assert np.isnan(inflection_circle(motion, "ground").path(1j).curvature).all()
    stuck = inflection_circle(gk.move(gk.SliderCrank(30, 90, driver="slider"), [100.0, 120.0]), "coupler")
    assert np.isfinite(stuck.diameter[0]) and np.isnan(stuck.diameter[1])
