"""A way of the driver that was meant in radians gets a word, and one that was meant in degrees does not."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.recipe.settings import Stroke, Turn


@pytest.mark.parametrize(
    ("start", "end", "meant"),
    [(0, 6.283, 360), (0, 6.28, 360), (0, 2 * np.pi, 360), (-3.14, 3.14, 360), (0, 1.5708, 90), (0, 3.14159, 180),
     (1.5708, 4.7124, 180), (0, 12.566, 720)],
)  # fmt: skip
def test_what_looks_like_radians(start, end, meant):
    (check,) = Turn(start_deg=start, end_deg=end).checks
    assert check.limit == meant and not check.passed


def test_what_is_meant_in_degrees():
    for way in (360, 180, 90, 1, 2, 3, 6, 6.25, 6.3, 12.5, 1.5, 3.1, 0.01, 45, 314, 157, 628):
        assert Turn(start_deg=10, end_deg=10 + way).checks == ()


def test_a_stroke_ends_beyond_its_start():
    assert Stroke(start=70, end=70.001).end == 70.001
    for end in (70, 69.999):
        with pytest.raises(gk.DesignError, match="give more than 70, the start"):
            Stroke(start=70, end=end)
