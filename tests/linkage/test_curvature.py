"""Curvature of paths by the circle through three poses, by known curves, and the Euler-Savary equation by its forms."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import geomkin as gk
from geomkin.linkage.instant.curvature import euler_savary, path_curvature
from tests.linkage.examples import ALL, FEW, bar_that_turns_back

TURN = np.linspace(0.05, 2 * np.pi + 0.05, 73)
PLACED = {"origin": 12 - 7j, "ground_angle_deg": 33.0}
FOUR_BAR = gk.FourBar(100, 30, 90, 70, **PLACED)
TRAMMEL = gk.Linkage(
    {"ground": {}, "rod": {"left": 0j, "right": 80 + 0j}, "along": {"left": 0j}, "across": {"right": 0j}},
    driver="rod",
    sliders=(gk.Slider("x", "along", "ground"), gk.Slider("y", "across", "ground", direction_deg=90)),
    **PLACED,
)


def through(p, q, r):
    """Curvature and centre of the circle through three points, left turn positive."""
    a, b = q - p, r - p
    area = np.imag(np.conj(a) * b)
    centre = p + 1j * (a * np.abs(b) ** 2 - b * np.abs(a) ** 2) / (2 * area)
    return 2 * area / (np.abs(a) * np.abs(b) * np.abs(r - q)), centre


@pytest.mark.parametrize(
    ("linkage", "body"),
    [
        (FOUR_BAR, "coupler"),
        (FOUR_BAR, "rocker"),
        (gk.SliderCrank(30, 90, 10, **PLACED), "coupler"),
        (TRAMMEL, "rod"),
    ],
)
@pytest.mark.parametrize("local", [40 + 25j])
def test_curvature_is_that_of_the_circle_through_three_near_poses(linkage, body, local):
    step = 2e-4
    poses = [gk.move(linkage, TURN + dq).bodies[body].point(local).position for dq in (-step, 0, step)]
    bend, centre = through(*poses)
    path = path_curvature(gk.move(linkage, TURN), body, local)
    clear = np.abs(poses[2] - poses[0]) > 1e-3  # off the cusps and the turning points
    assert clear.sum() > 60
    assert np.abs(path.curvature - bend)[clear].max() < 1e-5 * np.abs(bend).max()
    assert (np.abs(path.centre - centre) / (1 + path.radius**2))[clear].max() < 1e-6
    assert np.abs(path.tangent - (poses[2] - poses[0]) / np.abs(poses[2] - poses[0]))[clear].max() < 1e-4


def test_a_trammel_draws_ellipses_with_their_known_curvature():
    """The rod's point at a from one end and b from the other draws the ellipse of half axes a and b."""
    a, b = 55.0, 25.0
    path = path_curvature(gk.move(TRAMMEL, TURN), "rod", a)
    turned = (path.position - (12 - 7j)) * np.exp(-1j * np.radians(33))
    s, c = turned.imag / a, turned.real / b
    assert np.abs(s**2 + c**2 - 1).max() < 1e-13
    assert np.abs(path.radius / ((a**2 * c**2 + b**2 * s**2) ** 1.5 / (a * b)) - -1).max() < 1e-12
    evolute = (b**2 - a**2) / b * c**3 + 1j * (a**2 - b**2) / a * s**3
    assert np.abs((path.centre - (12 - 7j)) * np.exp(-1j * np.radians(33)) - evolute).max() < 1e-11


def test_cranks_turn_about_their_pivots_even_where_they_stand_still():
    limit = np.arccos((120**2 + 100**2 - 70**2) / (2 * 120 * 100))
    motion = gk.move(FOUR_BAR, limit + np.array([-0.1, 0.0, 0.1]))
    assert abs(motion.rocker.first[1]) < 1e-12
    pivot = motion.point("rocker_pivot").position
    path = path_curvature(motion, "rocker", 50 + 20j)
    assert np.abs(path.centre - pivot).max() < 1e-12
    assert np.abs(np.abs(path.radius) / abs(50 + 20j) - 1).max() < 1e-14
    assert np.sign(path.curvature[0]) == -np.sign(path.curvature[2])
    still = path_curvature(motion, "crank", 0.0)
    assert np.all(np.isinf(still.curvature)) and np.abs(still.centre - PLACED["origin"]).max() < 1e-12


def test_a_pin_keeps_its_cranks_circle_where_the_crank_turns_back():
    limit = np.arccos((120**2 + 100**2 - 70**2) / (2 * 120 * 100))
    motion = gk.move(FOUR_BAR, limit + np.array([-1e-3, -1e-7, 0.0, 1e-7, 1e-3]))
    path = path_curvature(motion, "coupler", 90)
    assert np.abs(np.abs(path.radius) - 70).max() < 1e-12
    assert np.abs(path.centre - motion.point("rocker_pivot").position).max() < 1e-12


def test_where_a_floating_bar_turns_back_its_curvature_is_unknown():
    linkage, limit = bar_that_turns_back()
    motion = gk.move(linkage, limit + np.array([-1e-2, -1e-4, -1e-8, 0, 1e-8, 1e-4, 1e-2]))
    assert abs(motion.bar.first[3]) < 1e-12
    bend = path_curvature(motion, "bar", 50 + 20j).curvature
    assert np.isnan(bend[2:5]).all()
    # Up to there it goes on smoothly, to and fro.
    assert bend[1] == pytest.approx(bend[0], rel=1e-3) and bend[5] == pytest.approx(-bend[1], rel=1e-4)


def test_a_point_at_the_instant_centre_has_a_cusp_and_is_its_own_centre():
    """The trammel's centre stands over the end on the slide and level with the other."""
    motion = gk.move(TRAMMEL, [0.5])
    local = 80j * np.sin(0.5) * np.exp(-0.5j)
    here = motion.rod.point(local)
    path = path_curvature(motion, "rod", local)
    assert abs(here.first[0]) < 1e-12
    assert abs(path.centre[0] - here.position[0]) < 1e-9 and abs(path.radius[0]) < 1e-9


def test_open_frames_and_dead_centres_of_the_driver_are_nan():
    motion = gk.move(gk.FourBar(3, 2, 2.5, 4), TURN)
    path = path_curvature(motion, "coupler", 1 + 1j)
    assert np.array_equal(np.isnan(path.curvature), ~motion.assembled)
    stuck = path_curvature(gk.move(gk.SliderCrank(30, 90, driver="slider"), [100.0, 120.0]), "coupler", 1 + 1j)
    assert np.isfinite(stuck.curvature[0]) and np.isnan(stuck.curvature[1])


places = st.floats(-100, 100).filter(lambda x: abs(x) > 1e-3)


@given(places, places, places, st.floats(-50, 50))
def test_every_form_of_euler_savary_is_the_one_relation(instant, point, centre, shift):
    a, c = point - instant, centre - instant
    assume(min(abs(a), abs(c), abs(a - c)) > 1e-2)
    j = 1 / (1 / a - 1 / c)
    assume(abs(j) < 1e6)
    all_four = {"instant_centre": instant, "point": point, "centre": centre, "inflection": instant + j}
    for name, answer in all_four.items():
        known = {key: place + shift for key, place in all_four.items() if key != name}
        found = euler_savary(**known) - shift
        if name == "instant_centre":
            found = found[np.abs(found - answer).argmin()]
        assert found == pytest.approx(answer, rel=1e-6, abs=1e-6)


@pytest.mark.parametrize(
    ("known", "answer"),
    [
        # A slider's pin lies on the inflection circle; the point at infinity's path is as far behind.
        ({"point": 7.0, "centre": np.inf}, 7.0),
        ({"point": np.inf, "centre": 4.0}, -4.0),
        ({"point": 7.0, "inflection": 7.0}, np.inf),
        ({"point": np.inf, "inflection": 5.0}, -5.0),
        ({"centre": np.inf, "inflection": 5.0}, 5.0),
        ({"centre": -5.0, "inflection": 5.0}, np.inf),
        # Without an inflection point on the ray every point is its own centre.
        ({"point": 7.0, "inflection": np.inf}, 7.0),
        ({"point": 7.0, "centre": 7.0}, np.inf),
        # The instant centre is a cusp; a ray along the tangent does not say where its centre is.
        ({"point": 0.0, "inflection": 5.0}, 0.0),
        ({"point": 0.0, "inflection": 0.0}, np.nan),
        ({"point": 0.0, "centre": 0.0}, np.nan),
    ],
)
def test_infinite_and_vanishing_distances(known, answer):
    for base in (0.0, 3.0):
        found = euler_savary(instant_centre=base, **{name: place + base for name, place in known.items()})
        assert found - base == pytest.approx(answer, nan_ok=True)


def test_an_unknown_instant_centre_has_two_answers_or_none():
    assert euler_savary(point=10.0, centre=6.0, inflection=1.0).tolist() == [16.0, 4.0]
    assert np.isnan(euler_savary(point=10.0, centre=12.0, inflection=1.0)).all()
    assert euler_savary(point=np.inf, centre=6.0, inflection=2.0).tolist() == [np.inf, 4.0]
    assert np.isinf(euler_savary(point=10.0, centre=6.0, inflection=np.inf)).all()


@pytest.mark.parametrize("name", FEW)
def test_curvature_agrees_with_velocity_and_acceleration(name):
    """Of bodies on pivots, on rails that lean, and on neither: all by the same coefficients."""
    linkage, drive, branch = ALL[name]
    motion = gk.move(linkage, drive, branch)
    for body in motion.bodies:
        named = list(motion.linkage.bodies[body].values())
        for local in (3 + 4j, *named):
            path, point = path_curvature(motion, body, complex(local)), motion.bodies[body].point(complex(local))
            first, second = point.first, point.second
            fast = np.abs(first) > max(1e-3 * np.abs(first).max(), 1e-9)
            assert path.position == pytest.approx(point.position)
            assert path.tangent[fast] == pytest.approx(first[fast] / np.abs(first[fast]), abs=1e-8)
            # Turning of the way by the drive, over how far that leads.
            turning = np.imag(second[fast] / first[fast])
            assert path.curvature[fast] * np.abs(first[fast]) == pytest.approx(turning, rel=1e-6, abs=1e-6)
