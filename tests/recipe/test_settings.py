"""A way of the driver that was meant in radians gets a word, and one that was meant in degrees does not."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.recipe.settings import Stroke, Turn


def test_ranges_that_look_like_radians_fail_a_check():
    for start, end, meant in [
        (0, 6.283, 360),
        (0, 6.28, 360),
        (0, 2 * np.pi, 360),
        (-3.14, 3.14, 360),
        (0, 1.5708, 90),
        (0, 3.14159, 180),
        (1.5708, 4.7124, 180),
        (0, 12.566, 720),
    ]:
        (check,) = Turn(start_deg=start, end_deg=end).checks
        assert check.limit == meant and not check.passed


def test_a_stroke_ends_beyond_its_start():
    assert Stroke(start=70, end=70.001).end == 70.001
    for end in (70, 69.999):
        with pytest.raises(gk.DesignError, match="70"):
            Stroke(start=70, end=end)
