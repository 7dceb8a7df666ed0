"""What a path search is asked for: limits that are held where none are given, and arguments that are none."""

import numpy as np
import pytest

import geomkin as gk
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
        with pytest.raises(gk.DesignError):
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
    assert one.middle == POINTS.mean() and (one.points == POINTS).all() and (one.seed, one.time_limit) == (7, 3)
    assert one.task.wanted.mean() == pytest.approx(0) and np.mean(np.abs(one.task.wanted) ** 2) == pytest.approx(1)
    assert one.size * one.task.wanted + one.middle == pytest.approx(POINTS) and one.task.closed
    assert np.degrees(one.task.turns) == pytest.approx([0, 20, 80, 90]) and not one.task.free
    assert asked().task.turns is None and asked().task.free
    low, high = one.task.low, asked(bounds={"origin_x": (5.25, 7)}).task.high
    assert low.shape == high.shape == (10,) and high[6] == pytest.approx((7 - 5.25) / one.size)
