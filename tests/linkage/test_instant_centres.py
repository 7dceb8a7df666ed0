"""Instant centres by lines through pins, by Kennedy's theorem and by poses a moment apart."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import geomkin as gk
from geomkin.linkage.instant.centres import instant_centre, instant_centres

TURN = np.linspace(0.05, 2 * np.pi + 0.05, 73)
PLACED = {"origin": 12 - 7j, "ground_angle_deg": 33.0}
FOUR_BAR = gk.FourBar(100, 30, 90, 70, 40 + 25j, **PLACED)
SLIDER_CRANK = gk.SliderCrank(30, 90, 10, **PLACED)
PARALLELOGRAM = gk.FourBar(100, 30, 100, 30, **PLACED)


def with_dyad(carrier):
    """A four-bar with a bar from a point of `carrier` to another bar pinned to the ground."""
    bodies = {name: dict(points) for name, points in FOUR_BAR.linkage.bodies.items()}
    bodies["ground"]["output_pivot"] = 60 - 80j
    bodies[carrier]["output_start"] = 40 + 25j
    bodies["bar"] = {"output_start": 0j, "output_pin": 110 + 0j}
    bodies["output"] = {"output_pivot": 0j, "output_pin": 90 + 0j}
    return gk.Linkage(bodies, driver="crank", **PLACED)


LINKAGES = {
    "four-bar": FOUR_BAR,
    "slider-crank": SLIDER_CRANK,
    "parallelogram": PARALLELOGRAM,
    "Stephenson six-bar": with_dyad("coupler"),
    "Watt six-bar": with_dyad("rocker"),
}


def off_line(place, start, end, size):
    """Distance of a place from a line, as a share of its distance from the line's start."""
    away = place - start
    return np.abs(np.imag(np.conj(end - start) * away)) / (np.abs(end - start) * np.maximum(np.abs(away), size))


@given(st.lists(st.floats(0.2, 5), min_size=4, max_size=4), st.floats(0, 6.28), st.sampled_from([1, -1]))
def test_centres_of_a_four_bar_lie_on_the_lines_through_its_pins(lengths, angle, branch):
    longest = max(lengths)
    if longest > 0.99 * (sum(lengths) - longest):
        return
    motion = gk.move(gk.FourBar(*lengths), [angle], branch)
    if not motion.assembled[0] or motion.transmission_angle[0] < 1e-3:
        return
    a, b = (motion.point(name).position[0] for name in ("crank_pin", "rocker_pin"))
    for body, other, lines in [
        ("coupler", "ground", [(0, a), (lengths[0], b)]),
        ("crank", "rocker", [(0, lengths[0]), (a, b)]),
    ]:
        centre = instant_centre(motion, body, other)
        for start, end in lines:
            if centre.weight[0] != 0:
                assert off_line(centre.position[0], start, end, longest) < 1e-9
            else:
                assert abs(np.imag(np.conj(end - start) * centre.direction[0])) < 1e-9 * longest


def test_centres_of_a_slider_crank_lie_on_lines_square_to_the_slide():
    motion = gk.move(SLIDER_CRANK, TURN)
    pivot, a, b = (motion.point(name).position for name in ("crank_pivot", "crank_pin", "slider_pin"))
    across = 1j * motion.ground.direction
    coupler = instant_centre(motion, "coupler", "ground").position
    crank = instant_centre(motion, "crank", "slider").position
    assert off_line(coupler, pivot, a, 30).max() < 1e-13 and off_line(coupler, b, b + across, 30).max() < 1e-13
    assert off_line(crank, a, b, 30).max() < 1e-13 and off_line(crank, pivot, pivot + across, 30).max() < 1e-13
    slider = instant_centre(motion, "slider", "ground")
    assert np.isnan(slider.position).all()
    assert np.abs(np.imag(np.conj(across) * slider.direction)).max() < 1e-15


@pytest.mark.parametrize("name", LINKAGES)
def test_three_centres_of_three_bodies_are_in_line(name):
    motion = gk.move(LINKAGES[name], TURN)
    assert motion.assembled.all()
    centres = instant_centres(motion)
    count = len(motion.bodies)
    assert len(centres) == count * (count - 1) // 2

    def homogeneous(pair):
        centre = centres[pair]
        place = centre.reference * centre.weight + centre.arm
        return np.stack([place.real, place.imag, centre.weight * 100], axis=-1)

    for one, two, three in combinations(motion.bodies, 3):
        rows = np.stack([homogeneous(p) for p in ((one, two), (one, three), (two, three))], axis=-2)
        rows /= np.linalg.norm(rows, axis=-1, keepdims=True)
        assert np.abs(np.linalg.det(rows)).max() < 1e-12, (one, two, three)


@pytest.mark.parametrize("name", ["slider-crank", "Watt six-bar"])
def test_at_its_centre_two_bodies_move_alike(name):
    step = 1e-5
    before, now, after = (gk.move(LINKAGES[name], TURN + dq) for dq in (-step, 0, step))

    def moved(body, place):
        """How far the body's point that is at `place` now goes, per step."""
        here = now.bodies[body]
        local = (place - here.origin.position) * np.conj(here.direction)
        ends = [m.bodies[body].origin.position + m.bodies[body].direction * local for m in (before, after)]
        return (ends[1] - ends[0]) / (2 * step)

    for (body, other), centre in instant_centres(now).items():
        place = centre.position
        near = np.abs(place) < 1e4
        apart = np.abs(moved(body, place) - moved(other, place))[near]
        assert apart.size == 0 or apart.max() < 1e-5, (body, other)
    # All the centres of a linkage are somewhere at most moments; a slider's own is the exception.
    places = [c.position for pair, c in instant_centres(now).items() if pair != ("ground", "slider")]
    assert np.isfinite(places).all()


def test_a_body_that_only_translates_has_its_centre_at_infinity_along_the_cranks():
    motion = gk.move(PARALLELOGRAM, np.linspace(0.05, 3.1, 40))
    for pair, along in [
        (("coupler", "ground"), motion.crank.direction),
        (("crank", "rocker"), motion.ground.direction),
    ]:
        centre = instant_centre(motion, *pair)
        assert np.isnan(centre.position).all() and np.all(centre.weight == 0)
        assert np.abs(np.imag(np.conj(along) * centre.direction)).max() < 1e-14


def test_a_bar_that_turns_back_has_its_centre_even_while_at_rest():
    sixbar = with_dyad("rocker")
    reach = 90 + 30
    limit = np.arccos((reach**2 + 100**2 - 70**2) / (2 * reach * 100))
    motion = gk.move(sixbar, limit + np.array([-1e-4, 0, 1e-4]))
    assert abs(motion.rocker.first[1]) < 1e-12
    for pair in [("bar", "ground"), ("bar", "rocker"), ("output", "rocker")]:
        place = instant_centre(motion, *pair).position
        assert abs(place[1] - (place[0] + place[2]) / 2) < 1e-5


def test_a_bar_at_rest_against_a_body_that_moves_has_its_centre_too():
    """The same linkage held by its crank, so that its ground and all else turn about that."""
    sixbar, reach = with_dyad("rocker"), 90 + 30
    limit = np.arccos((reach**2 + 100**2 - 70**2) / (2 * reach * 100))
    bodies = {name: sixbar.bodies[name] for name in ("crank", "ground", "coupler", "rocker", "bar", "output")}
    held = gk.Linkage(bodies, driver="ground")
    known = instant_centre(gk.move(gk.Linkage(sixbar.bodies, driver="crank"), [limit - 1e-4]), "bar", "ground")
    for branch in (1, -1):
        motion = gk.move(held, [-limit], branch)
        place = instant_centre(motion, "bar", "ground").position
        seen = (place - motion.ground.origin.position) * np.conj(motion.ground.direction)
        if abs(motion.rocker.first[0] - motion.ground.first[0]) < 1e-9 and abs(seen[0] - known.position[0]) < 1:
            assert abs(seen[0] - known.position[0]) < 1e-5
            break
    else:
        raise AssertionError("neither branch is in the known pose")


def test_open_frames_and_dead_centres_of_the_driver_are_nan():
    motion = gk.move(gk.FourBar(3, 2, 2.5, 4), np.linspace(0, 2 * np.pi, 37))
    for centre in instant_centres(motion).values():
        assert np.array_equal(np.isnan(centre.position), ~motion.assembled)
    stuck = gk.move(gk.SliderCrank(30, 90, driver="slider"), [100.0, 120.0])
    assert stuck.assembled.all()
    centre = instant_centre(stuck, "coupler", "ground").position
    assert np.isfinite(centre[0]) and np.isnan(centre[1])
