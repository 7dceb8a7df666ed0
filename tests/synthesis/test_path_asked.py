"""What a path search is asked for: limits that are held where none are given, and arguments that are none."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.core.fields import FARTHEST
from geomkin.synthesis.path import search

POINTS = np.array([0, 3 + 4j, 10, 8 - 6j])
LINKS = dict.fromkeys(("ground", "crank", "coupler", "rocker"), (1, 50))


@pytest.fixture
def asked(monkeypatch):
    """The search that would be made, which finds nothing."""
    seen = []

    def ranked(self, number):
        seen.append((self, number))
        return (), False

    monkeypatch.setattr(search.PathSearch, "ranked", ranked)

    def ask(points=POINTS, **more):
        with pytest.raises(gk.DesignError, match="no linkage was found that moves within the limits"):
            gk.path_generator(points, **more)
        (one, number), *_ = seen
        seen.clear()
        assert number == 0
        return one

    return ask


@pytest.mark.parametrize(
    ("given", "angle", "ratio", "nine"),
    [
        ({}, 5, 100, True),
        ({"least_transmission_angle_deg": 40}, 40, 100, False),
        ({"least_transmission_angle_deg": 0}, 0.1, 100, False),
        ({"largest_ratio": 4}, 5, 4, False),
        ({"bounds": {"crank": (1, 5)}}, 5, 100, False),
        # Where all links are bounded, the bounds alone count.
        ({"bounds": LINKS}, 0.1, 1e6, False),
        ({"bounds": LINKS, "least_transmission_angle_deg": 20, "largest_ratio": 7}, 20, 7, False),
        ({"bounds": dict.fromkeys(("crank", "coupler"), (1, 50)), "slides": True}, 0.1, 1e6, False),
        ({"bounds": dict.fromkeys(("crank", "coupler"), (1, 50))}, 5, 100, False),
    ],
)
def test_limits_that_are_held(asked, given, angle, ratio, nine):
    one = asked(**given)
    assert np.degrees(one.task.least_transmission) == pytest.approx(angle)
    assert (one.task.largest_ratio, one.all_nine) == (ratio, nine)
    assert one.bounded == set(given.get("bounds", ())) and one.task.slides is given.get("slides", False)


def test_points_are_told_about_their_middle_in_their_size(asked):
    one = asked(POINTS, drive_deg=[10, 30, 90, 100], seed=7, time_limit=3, closed=True)
    assert one.middle == POINTS.mean() and (one.points == POINTS).all() and (one.seed, one.seconds) == (7, 3)
    assert one.task.wanted.mean() == pytest.approx(0) and np.mean(np.abs(one.task.wanted) ** 2) == pytest.approx(1)
    assert one.size * one.task.wanted + one.middle == pytest.approx(POINTS) and one.task.closed
    assert np.degrees(one.task.turns) == pytest.approx([0, 20, 80, 90]) and not one.task.free
    assert asked().task.turns is None and asked().task.free
    low, high = one.task.low, asked(bounds={"origin_x": (5.25, 7)}).task.high
    assert low.shape == high.shape == (10,) and high[6] == pytest.approx((7 - 5.25) / one.size)


def test_what_may_be_given_is_taken(asked):
    for bounds in ({"crank": [1, 2]}, {"crank": np.array([1, 2])}, {"origin_x": (-FARTHEST, FARTHEST)}):
        assert asked(bounds=bounds).bounded == set(bounds)
    for points in (POINTS.tolist(), [0, 1, 3], np.array([1, 2.5, 7]), [0, FARTHEST, FARTHEST * 1j]):
        assert len(asked(points).points) == len(points)
    assert len(asked(np.arange(1000)).points) == 1000 and len(asked(np.array([0, 1, 2]) * 1e-9).points) == 3


@pytest.mark.parametrize(
    ("given", "words"),
    [
        *(({"bounds": wrong}, "bounds: found .*; give a table of names, each with its least and its greatest value")
          for wrong in ({"crank": (1,)}, {"crank": 5}, {1: (0, 1)}, [("crank", (1, 2))], {"crank": (0, 1.1e9)},
                        {"crank": (np.nan, 1)}, {"crank": "ab"}, {"crank": (1j, 2)}, {"crank": (1, 2, 3)}, "crank")),
        *(({"points": wrong}, "points: found .*; give a row of points as complex numbers")
          for wrong in ("abc", [[0, 1, 2]], [0, 1, 1.1e9], [0, 1, np.inf], None, 3, ["a", "b", "c"], [True, False, True])),
        *(({"drive_deg": wrong}, "drive_deg: found .*; give a row of angles in deg, one for each point")
          for wrong in ("abc", [[0, 1, 2, 3]], [0, 1, 2, np.nan], [0, 1j, 2, 3], 5)),
        ({"points": [5 + 5j] * 4}, "points: all are the same; give points apart from each other"),
        ({"points": 1e6 + 1e-8 * POINTS}, "points: all are the same"),
        ({"points": np.arange(1001)}, "points: found 1,001; give from 3 to 1,000 points"),
        ({"drive_deg": [0, 10, 20]}, "drive_deg: found 3 angles for 4 points; give one for each point"),
        ({"drive_deg": [0, 10, 10, 30]}, "drive_deg: the angles neither all rise nor all fall; give them in order"),
        ({"seed": -1}, "seed: found -1"), ({"seconds": 0}, "seconds: found 0"),
        ({"largest_ratio": 0.9}, "largest_ratio: found 0.9; give a number from 1 to "),
    ],
)  # fmt: skip
def test_what_is_no_such_thing_is_refused(given, words):
    with pytest.raises(gk.DesignError, match=words):
        gk.path_generator(**{"points": POINTS} | given)
