"""What a goal says of a linkage that misses what was wanted: the check that fails, by how much, and from where on."""

import dataclasses
from functools import cache

import numpy as np
import pytest

import geomkin as gk
from tests.recipe.test_rocker_goals import STROKE, SWING, SWINGS

GOALS = {
    "swing": SWING,
    "swings": SWINGS,
    "stroke": STROKE,
    "poses": {"kind": "body-guidance", "wanted": {"poses": [[0, 0, 0], [40, 20, 30], [60, 60, 80]]}},
    "path": {"kind": "path-generator", "wanted": {"points": [[0, 0], [10, 5], [30, -5]]}},
}


@cache
def found(goal):
    return gk.load(GOALS[goal])


@pytest.mark.parametrize(
    ("goal", "size", "wanted", "name", "most"),
    [
        ("swing", "swing_deg", 50, "missed swing", 1e-4),
        ("swing", "crank_turn_deg", 200, "missed turn of the crank", 1e-4),
        ("swings", "rocker_swing_deg", 40, "missed swing", 1e-4),
        ("swings", "overshoot_deg", 0, "rotation of the rocker beyond its positions", 1e-4),
        ("stroke", "stroke", 80, "missed stroke", 80e-6),
        ("stroke", "crank_turn_deg", 360 * 1.2 / 2.2, "missed turn of the crank", 1e-4),
        ("poses", "pose_error", 0, "largest distance from a pose", 0.01),
        ("poses", "angle_error_deg", 0, "largest rotation from a pose", 0.01),
        ("path", "largest_distance", 0, "largest distance of a point from the path", np.hypot(30, 5) / 20),
    ],
)
def test_missed_goal_fails_beyond_its_limit_in_its_own_unit(goal, size, wanted, name, most):
    met = found(goal)
    assert all(check.passed for check in met.met)
    for missed in (0.5 * most, 2 * most, 0.3):
        for side in (1, -1) if wanted else (1,):
            spoilt = gk.load(GOALS[goal])
            spoilt.__dict__["found"] = dataclasses.replace(met.found, **{size: wanted + side * missed})
            (check,) = (check for check in spoilt.met if check.name == name)
            assert check.value == pytest.approx(missed, abs=1e-3 * most) and check.passed == (missed < most)
            assert check.limit == pytest.approx(most) and check.side == "at most"
            assert all(other.passed for other in spoilt.met if other.name != name)
