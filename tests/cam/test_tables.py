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


def test_rates_of_an_accelerating_cam_are_differences_of_its_lift(tmp_path):
    """Lift sampled along theta + speed t + acceleration t^2 / 2, by a recipe and its columns."""
    recipe = gk.load({
        "kind": "disk-cam",
        "cam": {
            "base_radius": 40,
            "direction": "clockwise",
            "follower": {"kind": "translating-roller", "roller_radius": 10},
            "program": [{"kind": "rise", "law": "3-4-5", "rise": 20, "end_deg": 150}, {"kind": "return", "law": "3-4-5", "end_deg": 360}],
        },
        "drive": {"speed_rpm": 90, "step_deg": 7, "acceleration_rad_per_s2": 60},
    })  # fmt: skip
    columns, h = recipe.table.to_columns(), 2e-4
    angle, speed, acceleration = np.radians(columns["cam_angle_deg"]), recipe.drive.speed, 60.0
    t = h * np.arange(-2, 3)[:, None]
    lift = recipe.cam.program.motion(angle + speed * t + acceleration * t**2 / 2).lift
    smooth = np.abs((columns["cam_angle_deg"] - 150) % 360) > 5
    smooth &= np.minimum(columns["cam_angle_deg"], 360 - columns["cam_angle_deg"]) > 5
    first = (lift[0] - 8 * lift[1] + 8 * lift[3] - lift[4]) / (12 * h)
    second = (-lift[0] + 16 * lift[1] - 30 * lift[2] + 16 * lift[3] - lift[4]) / (12 * h**2)
    third = (-lift[0] + 2 * lift[1] - 2 * lift[3] + lift[4]) / (2 * h**3)
    assert columns["velocity_mm_per_s"][smooth] == pytest.approx(first[smooth], abs=1e-5)
    assert columns["acceleration_mm_per_s2"][smooth] == pytest.approx(second[smooth], abs=0.05)
    assert columns["jerk_mm_per_s3"][smooth] == pytest.approx(third[smooth], abs=1e-3 * np.abs(third[smooth]).max())
    assert np.isnan(columns["time_s"]).all() and np.isfinite(recipe.scene.time).all()
