"""Velocity and acceleration states: the four-bars found, moved, have a coupler in that state."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.synthesis import BodyState, acceleration_state_four_bar, velocity_state_four_bar

# A published state; of the acceleration of D the text says 20 where it reckons with 10.
TEXT = BodyState(velocity=1, omega=4, acceleration=10j, alpha=-10)


def moved(found, state):
    """Velocity, rate, acceleration and second rate of the coupler at the state's own point, and its place."""
    motion = gk.move(found.linkage, [found.drive], found.branch, found.speed, found.acceleration)
    assert motion.assembled.all()
    body, track = motion.coupler, motion.point("coupler_point")
    near = 1e-8 * (abs(state.position) + found.linkage.ground + found.linkage.crank + found.linkage.coupler)
    assert abs(track.position[0] - state.position) < near
    pins = [motion.point(name).position[0] for name in ("crank_pin", "rocker_pin")]
    assert np.abs(pins - found.moving).max() < near
    return track.velocity[0], body.omega[0], track.acceleration[0], body.alpha[0]


def test_a_published_state():
    points = np.array([1 + 1j, 2])
    assert TEXT.velocity_of(points) == pytest.approx([-3 + 4j, 1 + 8j])
    assert TEXT.acceleration_of(points) == pytest.approx([-6 - 16j, -32 - 10j])
    assert TEXT.instant_centre.position == pytest.approx(0.25j)
    found = acceleration_state_four_bar(TEXT, moving=points)
    assert moved(found, TEXT) == pytest.approx((1, 4, 10j, -10), abs=1e-9)


def states(rng, count):
    for _ in range(count):
        v, a, z = (complex(*rng.normal(size=2)) for _ in range(3))
        yield BodyState(v, rng.normal(), a, rng.normal(), z)


@pytest.mark.parametrize("size", [1e-6])
@pytest.mark.parametrize("given", ["moving", "fixed"])
def test_velocity_states_are_given_back_by_the_linkage(given, size):
    rng = np.random.default_rng(1)
    for one in states(rng, 60):
        state = BodyState(one.velocity * size, one.omega, position=one.position * size)
        points = size * (rng.normal(size=2) + 1j * rng.normal(size=2))
        speeds = rng.uniform(0.3, 3, 2) * rng.choice([-1, 1], 2)
        found = velocity_state_four_bar(state, speeds, **{given: points})
        velocity, omega, _, _ = moved(found, state)
        assert velocity / size == pytest.approx(one.velocity, rel=1e-6, abs=1e-6)
        assert omega == pytest.approx(one.omega, rel=1e-6, abs=1e-6)
        assert found.speed == pytest.approx(speeds[0])
        assert getattr(found, given) == pytest.approx(points)


@pytest.mark.parametrize("size", [1e5])
@pytest.mark.parametrize("given", ["moving", "fixed"])
def test_acceleration_states_are_given_back_by_the_linkage(given, size):
    rng = np.random.default_rng(2)
    for one in states(rng, 60):
        state = BodyState(one.velocity * size, one.omega, one.acceleration * size, one.alpha, one.position * size)
        points = size * (rng.normal(size=2) + 1j * rng.normal(size=2))
        found = acceleration_state_four_bar(state, **{given: points})
        velocity, omega, acceleration, alpha = moved(found, state)
        reported = [velocity / size, omega, acceleration / size, alpha]
        assert reported == pytest.approx([one.velocity, one.omega, one.acceleration, one.alpha], rel=1e-5, abs=1e-5)


def test_a_body_that_does_not_turn():
    state = BodyState(3 + 1j, 0.0, 2 - 1j, 0.7)
    found = acceleration_state_four_bar(state, moving=[0.5 + 1j, 3])
    assert moved(found, state) == pytest.approx((3 + 1j, 0, 2 - 1j, 0.7), abs=1e-9)
    found = velocity_state_four_bar(state, (2, 2), moving=[0.5 + 1j, 3])
    assert found.linkage.crank == pytest.approx(found.linkage.rocker)


@pytest.mark.parametrize(
    ("call", "field"),
    [
        (lambda: BodyState(0, 0.0), "velocity"),
        (lambda: velocity_state_four_bar(TEXT, (1, 0), moving=[1, 2]), "speeds"),
        (lambda: velocity_state_four_bar(TEXT, (1, 4), fixed=[1, 2]), "speeds"),
        (lambda: velocity_state_four_bar(TEXT, (1, 2)), "moving"),
        (lambda: velocity_state_four_bar(TEXT, (1, 2), [1, 2], [1, 2]), "moving"),
        (lambda: velocity_state_four_bar(TEXT, (1, 2), [1, 1]), "moving"),
        (lambda: velocity_state_four_bar(TEXT, (1, 2), [1, 0.25j]), "moving"),
        (lambda: velocity_state_four_bar(TEXT, (1, 2), [0.5j, 2j]), "moving"),
        (lambda: acceleration_state_four_bar(TEXT, [0.25j, 2]), "moving"),
        (lambda: acceleration_state_four_bar(TEXT, [TEXT.inflection_circle.pole, 2]), "moving"),
        (lambda: acceleration_state_four_bar(TEXT, fixed=[1, 2, 3]), "fixed"),
    ],
)
def test_what_makes_no_four_bar_is_refused(call, field):
    with pytest.raises(gk.DesignError) as refusal:
        call()
    assert refusal.value.field == field


@pytest.mark.parametrize("size", [1e-3])
@pytest.mark.parametrize("points", [[1, 0.25j + 1e-11], [1, 1 + 1e-11j], [0.5j, 2j + 1e-11]])
def test_points_that_nearly_leave_the_motion_open_are_refused(points, size):
    state = BodyState(size * TEXT.velocity, TEXT.omega)
    with pytest.raises(gk.DesignError) as refusal:
        velocity_state_four_bar(state, (1, 2), size * np.array(points))
    assert refusal.value.field == "moving"
    # Ten thousand times as far off they make one.
    far = size * (np.array(points) + 1e-5 * np.array([0.3 + 0.1j, -0.2 + 0.7j]))
    assert moved(velocity_state_four_bar(state, (1, 2), far), state)[1] == pytest.approx(TEXT.omega, rel=1e-4)
