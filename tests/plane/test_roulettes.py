"""Involute and trochoid against what they are: a string unwound, and what a rolling rack's corner leaves."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geomkin.plane.roulettes import Involute, Trochoid

CORNERS = [(24, 1.74, 0.76), (24, 1.74, 0.0), (12, -0.9, 0.4), (24, 1e-9, 0.5), (9, 0, 1)]
corners = pytest.mark.parametrize("radius, depth, rounding", CORNERS)
LEANS = np.linspace(-1.2, 1.2, 41)


def carried(radius, depth, roll):
    """Centre of the corner when the line has rolled by `roll`: the line's own steps, no formula of the curve.

    The line touches the circle at the end of the radius turned by the roll, and has left behind as much
    of itself as of the circle.
    """
    outward = np.exp(1j * roll)
    touching = radius * outward
    start_of_line = touching - 1j * outward * radius * roll
    return start_of_line - depth * outward


@settings(deadline=None, max_examples=30)
@given(st.floats(1e-3, 1e4), st.floats(1e-3, 6.0))
def test_involute_is_the_end_of_a_taut_string(radius, t):
    """The tangent from the point to the circle is as long as the arc it was unwound from, +x to its foot."""
    z = complex(Involute(radius, 0.0, 7.0).point(t))
    # Foot of the tangent, by Thales' circle over the centre and the point.
    string = np.sqrt((abs(z) - radius) * (abs(z) + radius))
    foot = radius * z / abs(z) * complex(radius, string) / abs(z)
    unwound = np.angle(foot * np.exp(-1j * t)) + t
    assert np.isclose(abs(foot), radius, rtol=1e-12)
    assert np.isclose(string, radius * unwound, rtol=1e-9)
    assert np.isclose(unwound, t, rtol=1e-8)


def test_involute_has_a_cusp_on_the_base_circle():
    curve = Involute(3.0, 0.0, 1.0)
    assert curve.point(0.0) == 3 and curve.velocity(0.0) == 0 and curve.curvature(0.0) == np.inf


@corners
def test_trochoid_touches_the_corner_where_the_normal_passes_the_rolling_point(radius, depth, rounding):
    """Each point is one rounding from the carried centre, along the line to where the rack touches its circle."""
    curve = Trochoid(radius, depth, rounding, -1.3, 1.3)
    z, roll = curve.point(LEANS), depth * np.tan(LEANS) / radius
    centre, rolling_point = carried(radius, depth, roll), radius * np.exp(1j * roll)
    normal = np.exp(1j * (LEANS + roll))
    assert np.allclose(z, centre - rounding * normal, rtol=0, atol=1e-12 * radius)
    across = np.imag(np.conj(normal) * (rolling_point - centre))
    assert np.abs(across).max() < 1e-12 * radius
    assert np.abs(np.real(np.conj(normal) * curve.velocity(LEANS))).max() < 1e-12 * radius


@corners
def test_trochoid_is_the_edge_of_all_that_the_corner_sweeps(radius, depth, rounding):
    """Brute force: of all positions of the rolling corner, the nearest one just reaches the curve."""
    z = Trochoid(radius, depth, rounding, -1.3, 1.3).point(LEANS)
    limit = abs(depth) * np.tan(1.3) / radius

    def away(roll):
        return np.abs(carried(radius, depth, roll) - z[:, None])

    nearest = np.zeros((len(z), 1))
    width = limit
    for _ in range(12):  # every look is 50 times closer than the one before
        roll = np.clip(nearest + width * np.linspace(-1, 1, 201), -limit, limit)
        nearest = np.take_along_axis(roll, away(roll).argmin(axis=1)[:, None], 1)
        width /= 50
    assert np.abs(away(nearest)[:, 0] - rounding).max() < 1e-10 * radius
