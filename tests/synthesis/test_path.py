"""Linkages found for paths: known ones given back, published problems met, each moved by the solver of all linkages."""

import dataclasses
from functools import cache

import numpy as np
import pytest

import geomkin as gk
from geomkin.core.processes import progress_to
from geomkin.synthesis.path.coupler_paths import paths
from tests.speed.synthesis_path import CLOSED, FIVE, FIVE_BOUNDS, K18, K18_BOUNDS, LINE6, LINE6_BOUNDS, NINE

TURN = np.linspace(0, 2 * np.pi, 30, endpoint=False)


def moved(found):
    """Where the coupler point is at the drives that were found, by the general solver."""
    motion = gk.move(found.linkage, found.drive, found.branch)
    return motion.point("coupler_point").position


def traced(linkage, drive, branch=1):
    return gk.move(linkage, drive, branch).point("coupler_point").position


def far(points, found, frames=72001):
    """Sum of squared distances from a fine trace of the whole turn: brute force."""
    path = traced(found.linkage, np.linspace(0, 2 * np.pi, frames), found.branch)
    return np.sum(np.abs(points[:, None] - path).min(axis=1) ** 2)


def sound(found, span):
    """On a fine grid it closes over the whole span with the reported transmission angle."""
    motion = gk.move(found.linkage, np.linspace(*span, 4001), found.branch)
    least = np.degrees(gk.least_transmission_angle(motion))
    return (
        motion.assembled.all() and found.transmission_angle_deg - 1e-6 <= least <= found.transmission_angle_deg + 0.01
    )


@pytest.mark.parametrize("slides", [False, True])
def test_derivatives_are_those_of_differences(slides):
    x = np.array([[10.0 if slides else 100, 30, 90, 70, 40, 25, 5, -7, 0.3, 0]])
    cranks, branch = np.linspace(0.2, 6, 7)[None], np.array([-1.0])
    here = paths(x, cranks, branch, slides)
    for k in range(9):
        if slides and k == 3:
            continue
        step = np.zeros((1, 10))
        step[0, k] = 1e-5
        ahead, back = (paths(x + s * step, cranks, branch, slides) for s in (1, -1))
        assert (ahead.point - back.point) / 2e-5 == pytest.approx(here.by_size[..., k], abs=1e-6)
        assert (ahead.folding - back.folding) / 2e-5 == pytest.approx(here.folding_by_size[..., k], abs=1e-8)
    ahead, back = (paths(x, cranks + s * 1e-6, branch, slides) for s in (1, -1))
    assert (ahead.point - back.point) / 2e-6 == pytest.approx(here.by_crank, abs=1e-5)


@cache
def eighteen():
    return gk.path_generator(K18, 20.0 * np.arange(18), bounds=K18_BOUNDS)


@pytest.mark.campaign
def test_eighteen_timed_points():
    found = eighteen()
    assert found.square_error <= 0.00902889
    assert np.sum(np.abs(moved(found) - K18) ** 2) == pytest.approx(found.square_error, rel=1e-9)
    assert np.degrees(np.diff(found.drive)) == pytest.approx(20) and not found.defects and found.least_squares
    assert sound(found, (found.drive[0], found.drive[-1]))
    usable = found.usable
    # With 30 deg it stands on that limit, and is a little worse.
    assert 0.00902889 < usable.square_error < 0.0091152 and usable.transmission_angle_deg == pytest.approx(30, abs=1e-6)
    assert usable.at_limits == ("a transmission angle of 30 deg",)
    assert len(found.cognates) == 3


@pytest.mark.campaign
def test_six_points_of_a_line_within_bounds():
    found = gk.path_generator(LINE6, bounds=LINE6_BOUNDS)
    assert np.sum(np.abs(moved(found) - LINE6) ** 2) <= 1e-20 and not found.least_squares
    for one in found.ranked:
        assert all(0 < length <= 60 for length in one.lengths.values())
        places = np.array([one.linkage.origin, one.coupler_point])
        assert (np.abs(places.real) <= 60).all() and (np.abs(places.imag) <= 60).all()
        if not one.defects:
            steps = np.diff(one.drive)
            assert (steps > 0).all() or (steps < 0).all()
            assert sound(one, sorted((one.drive[0], one.drive[-1])))


@pytest.mark.campaign
def test_five_timed_points_about_a_given_pivot():
    found = gk.path_generator(FIVE, [30, 45, 60, 75, 90], bounds=FIVE_BOUNDS)
    assert found.square_error <= 7.4158e-7 and np.degrees(found.drive) == pytest.approx([30, 45, 60, 75, 90])
    assert np.sum(np.abs(moved(found) - FIVE) ** 2) == pytest.approx(found.square_error, rel=1e-6)
    assert found.linkage.origin == pytest.approx(0, abs=1e-12) and found.linkage.ground_angle_deg == 0


@pytest.mark.campaign
def test_active_bound_is_met_exactly():
    free = gk.path_generator(K18, 20.0 * np.arange(18))
    held = gk.path_generator(K18, 20.0 * np.arange(18), bounds={"crank": (0.1, 0.25)})
    assert free.linkage.crank > 0.3 and held.linkage.crank <= 0.25 * (1 + 1e-12)
    assert held.square_error > free.square_error


@pytest.mark.campaign
def test_nine_points_have_all_their_linkages_with_their_defects():
    found = gk.path_generator(NINE, time_limit=1e-6)
    assert len(found.ranked) == 64 == found.path_count.real and not found.defects and not found.cut_short
    assert [not one.defects for one in found.ranked].count(True) == 1
    assert np.abs(moved(found) - NINE).max() < 1e-8
    for one in found.ranked:
        sides = [traced(one.linkage, one.drive, side) for side in (1, -1)]
        assert np.abs(np.array(sides) - NINE).min(axis=0).max() < 1e-6
    # No two draw the same curve: the three cognates of one have the same pivots.
    pivots = [{complex(np.round(c.linkage.origin, 6)) for c in one.cognates} for one in found.ranked]
    assert len({frozenset(three) for three in pivots}) == len(found.ranked)


@pytest.mark.campaign
def test_nine_points_of_a_circle_have_no_finite_number_of_linkages():
    found = gk.path_generator(10 * np.exp(0.6j * np.arange(9)), time_limit=60)
    assert found.special and found.path_count is None and found.largest_distance < 1e-6


@pytest.mark.campaign
@pytest.mark.parametrize("slides", [False, True])
def test_random_closed_paths_give_their_linkages_back(slides):
    rng = np.random.default_rng(7)
    for _ in range(3):
        n = int(rng.integers(20, 140))
        arm = complex(*rng.uniform(-60, 60, 2))
        linkage = (
            gk.SliderCrank(30, rng.uniform(60, 120), rng.uniform(-20, 20), arm)
            if slides
            else gk.FourBar(100, rng.uniform(15, 35), rng.uniform(75, 90), rng.uniform(65, 80), arm)
        )
        points = traced(linkage, rng.uniform(0, 2 * np.pi, n)) * np.exp(1j * rng.uniform(0, 6)) + 50
        found = gk.path_generator(points, closed=True, slides=slides, time_limit=60)
        size = np.abs(points - points.mean()).max()
        # The line between scattered points is not known as exactly as the points.
        assert np.sqrt(found.square_error) < 1e-6 * size


@pytest.mark.campaign
def test_random_open_paths_are_met():
    rng = np.random.default_rng(8)
    for _ in range(3):
        arm = complex(*rng.uniform(-60, 60, 2))
        linkage = gk.FourBar(100, rng.uniform(15, 35), rng.uniform(75, 90), rng.uniform(65, 80), arm)
        start = rng.uniform(0, 6)
        points = traced(linkage, np.sort(rng.uniform(start, start + rng.uniform(1, 5), 60)))
        found = gk.path_generator(points, time_limit=60)
        assert found.largest_distance < 1e-3 * np.abs(points - points.mean()).max() and not found.defects
        assert np.sum(np.abs(moved(found) - points) ** 2) == pytest.approx(found.square_error, abs=1e-10)


@pytest.mark.campaign
def test_limits_hold_over_the_whole_turn_of_a_closed_path():
    points = 30 * np.cos(TURN) + 10j * np.sin(TURN)
    found = gk.path_generator(points, closed=True, least_transmission_angle_deg=50, largest_ratio=5)
    assert found.transmission_angle_deg >= 50 - 1e-6 and found.ratio <= 5 * (1 + 1e-8)
    assert found.at_limits and sound(found, (0, 2 * np.pi)) and found.usable is found
    # Brute force: the fine trace of the whole turn is no nearer than the error says, and hardly farther.
    assert far(points, found) == pytest.approx(found.square_error, rel=1e-4)


@pytest.mark.campaign
@pytest.mark.parametrize(("name", "known"), [("figure eight", 2.192), ("harmonics 1", 3.146), ("teardrop", 0.488)])
def test_dense_closed_paths_that_no_linkage_draws_are_met_as_well_as_is_known(name, known):
    """Nearly as near, both ways, as searches from many more starts and with several seeds came."""
    _, points = CLOSED[name]
    found = gk.path_generator(points, closed=True, time_limit=100)
    assert found.largest_distance <= 1.04 * known
    # Six digits rank them.
    assert found.largest_distance == pytest.approx(min(one.largest_distance for one in found.ranked), rel=1e-5)
    assert found.transmission_angle_deg >= 5 - 1e-6 and sound(found, (0, 2 * np.pi)) and not found.defects
    assert far(points, found) == pytest.approx(found.square_error, rel=2e-3)


def test_slider_cranks():
    known = gk.SliderCrank(30, 90, 12, 50 + 20j, origin=5 + 5j, ground_angle_deg=-20)
    turns = np.arange(0, 300, 30.0)
    points = traced(known, np.radians(turns + 40))
    found = gk.path_generator(points, turns, slides=True)
    assert isinstance(found.linkage, gk.SliderCrank) and found.square_error < 1e-18
    assert np.abs(moved(found) - points).max() < 1e-8 and found.cognates == ()
    assert (found.linkage.crank, found.linkage.coupler) == pytest.approx((30, 90), rel=1e-6)
    assert abs(found.linkage.offset) == pytest.approx(12, rel=1e-5)


@pytest.mark.campaign
def test_size_and_place_do_not_matter():
    plain = gk.path_generator(K18, 20.0 * np.arange(18))
    for size in (1e-6, 1e6):
        other = gk.path_generator(size * (K18 + 3 - 2j), 20.0 * np.arange(18))
        assert other.square_error == pytest.approx(size**2 * plain.square_error, rel=1e-6)


@pytest.mark.campaign
def test_same_seed_gives_the_same_result_and_progress_is_reported():
    reported = []
    with progress_to(lambda share, what: reported.append((share, what))):
        one = gk.path_generator(K18, 20.0 * np.arange(18), bounds=K18_BOUNDS, time_limit=60)
    other = eighteen()
    assert one.linkage == other.linkage and not one.cut_short
    shares = [share for share, _ in reported]
    assert shares == sorted(shares) and shares[-1] == 1 and reported[0][1] == "linkages for the path"
    assert dataclasses.replace(one, ranked=()).ranked == () and one.ranked[0].linkage == one.linkage


@pytest.mark.parametrize(
    ("given", "field"),
    [
        ({"points": [1 + 1j] * 5}, "points"),
        ({"points": [0, 1j]}, "points"),
        ({"points": np.arange(200_001) * 1j}, "points"),
        ({"points": [0, 1j, np.nan]}, "points"),
        ({"points": "abc"}, "points"),
        ({"drive_deg": [0, 20]}, "drive_deg"),
        ({"drive_deg": [0, 1, 2, 2, 3, 4]}, "drive_deg"),
        ({"drive_deg": [0, 1, 2, np.nan, 3, 4]}, "drive_deg"),
        ({"time_limit": 0}, "time_limit"),
        ({"seed": -1}, "seed"),
        ({"bounds": {"crunk": (0, 1)}}, "bounds"),
        ({"bounds": {"start_deg": (0, 1)}}, "bounds"),
        ({"bounds": {"crank": (2, 1)}}, "bounds"),
        ({"bounds": {"crank": 5}}, "bounds"),
        ({"bounds": {"rocker": (0, 1)}, "slides": True}, "bounds"),
        ({"bounds": {"crank": (-3, 0)}}, "bounds"),
        ({"bounds": {"crank": (9e8, 1e9)}}, "bounds"),
        ({"largest_ratio": 0.9}, "largest_ratio"),
        ({"least_transmission_angle_deg": 90}, "least_transmission_angle_deg"),
    ],
)
def test_invalid_requests_are_refused(given, field):
    with pytest.raises(gk.DesignError) as refusal:
        gk.path_generator(**{"points": LINE6} | given)
    assert refusal.value.field == field and refusal.value.remedy
