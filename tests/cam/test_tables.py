"""The outline at equal angles, against circles about other centres and the profile's own points."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.cam.measures import polar_radius


def test_an_eccentric_circle_has_the_radius_of_the_cosine_rule():
    angle = np.radians(np.arange(0, 360, 7))
    got = polar_radius(gk.plane.Circle(3 + 4j, 20), angle)
    ahead = np.real((3 + 4j) * np.exp(-1j * angle))
    assert got == pytest.approx(ahead + np.sqrt(ahead**2 - 25 + 400), rel=1e-14)


def test_a_polygon_has_its_corners_and_edges():
    square = gk.plane.Polyline(np.array([1 - 1j, 1 + 1j, -1 + 1j, -1 - 1j]))
    got = polar_radius(square, np.radians([0, 30, 45, 90, 200]))
    assert got == pytest.approx([1, 1 / np.cos(np.pi / 6), np.sqrt(2), 1, 1 / np.cos(np.radians(20))], rel=1e-12)


def test_a_cam_profile_meets_its_own_points():
    program = gk.Program([gk.Rise("cycloidal", rise=10, end_deg=180), gk.Return("harmonic", end_deg=360)])
    profile = gk.Cam(gk.TranslatingRoller(5, 3), program, 30, "clockwise").profile
    z = profile.point(np.linspace(0.01, 6.2, 50))
    assert polar_radius(profile, np.angle(z)) == pytest.approx(np.abs(z), rel=1e-12)


def test_of_several_crossings_the_farthest_counts():
    hook = gk.plane.Polyline(np.array([1 - 1j, 5 - 1j, 5 + 1j, 4 + 1j, 4 - 0.5j, 2 - 0.5j, 2 + 2j, -2 + 2j, -2 - 1j]))
    assert polar_radius(hook, np.array([0.0])) == pytest.approx([5], rel=1e-14)
