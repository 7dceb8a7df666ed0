"""The spline by second roads: cubics it must repeat, differences, smooth curves it must approach."""

import numpy as np
import pytest

from geomkin.core.errors import DesignError
from geomkin.plane.joined import Spline

POINTS = np.array([0, 1 + 2j, 3 + 2.5j, 4 + 1j, 7 - 1j, 7.5 + 0.2j])


def test_passes_its_points_at_its_breaks():
    curve = Spline(POINTS)
    assert np.abs(curve.point(curve.breaks) - POINTS).max() < 1e-14
    assert np.diff(curve.breaks) == pytest.approx(np.abs(np.diff(POINTS)))


def test_repeats_a_cubic_of_the_chord_length_whatever_the_spacing():
    """Not a knot: a curve that is a cubic of the parameter comes back whole; along a line chords give the parameter."""
    x = np.array([0, 0.3, 1.1, 1.2, 2.9, 4.0])
    line = Spline(x * (3 + 4j))
    t = np.linspace(0, 20, 41)
    assert np.abs(line.point(t) - t * (0.6 + 0.8j)).max() < 1e-13
    assert np.abs(line.curvature(t)).max() < 1e-13


@pytest.mark.parametrize("count", [2, 3, 4, 6])
def test_velocity_and_acceleration_agree_with_differences(count):
    curve = Spline(POINTS[:count])
    t = np.concatenate([a + (b - a) * np.linspace(0.1, 0.9, 5) for a, b in zip(curve.breaks, curve.breaks[1:])])
    h = 1e-5
    assert np.abs((curve.point(t + h) - curve.point(t - h)) / (2 * h) - curve.velocity(t)).max() < 1e-8
    assert np.abs((curve.velocity(t + h) - curve.velocity(t - h)) / (2 * h) - curve.acceleration(t)).max() < 1e-8
    turn = np.angle(curve.velocity(t + h) / curve.velocity(t - h)) / (2 * h)
    assert turn / np.abs(curve.velocity(t)) == pytest.approx(curve.curvature(t), abs=1e-7)


def test_curvature_is_continuous_across_points():
    curve = Spline(POINTS)
    inner = curve.breaks[1:-1]
    assert curve.curvature(inner - 1e-9) == pytest.approx(curve.curvature(inner + 1e-9), abs=1e-6)
    # The third derivative jumps at points, save at those next to the ends.
    third = [np.diff(curve.acceleration(b + 1e-3 * np.array([-2, -1, 1, 2])))[[0, 2]] for b in inner]
    jumps = np.array([abs(b - a) for a, b in third])
    assert jumps[[0, -1]].max() < 1e-9 < 1e-5 < jumps[1:-1].min()


def test_error_falls_with_the_fourth_power_of_the_spacing():
    circle = [Spline(np.exp(1j * np.linspace(0, 2, n + 1))) for n in (8, 16, 32)]
    off = [np.abs(np.abs(c.point(np.linspace(0, c.breaks[-1], 1001))) - 1).max() for c in circle]
    assert off[0] / off[1] > 12 and off[1] / off[2] > 12 and off[2] < 1e-6


@pytest.mark.parametrize("points", [[1j], [0, 1, 1, 2], [0, np.nan, 2], [[0, 1], [2, 3]]])
def test_points_that_make_no_curve_are_refused(points):
    with pytest.raises(DesignError) as caught:
        Spline(np.array(points, dtype=complex))
    assert caught.value.field == "points" and caught.value.remedy
