"""The table of a cam row by row: rates by differences of its own columns, curvatures by circles through three places."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.cam.checks import polar_radius
from tests.campaign import by_default

from .cams import CAMS, UNDERCUT, depth, seen_from_cam

NAMES = ["roller, clockwise", "roller on arm below, counterclockwise", "tilted, clockwise", "flat on arm, clockwise"]
SPEED, STEP = 5.0, 1e-4


def columns(cam, angle, cut=None):
    return {column.id: column for column in gk.cam.cam_table(cam, SPEED, angle, cut).columns}


def places(found, name):
    return np.asarray(found[f"{name}_x"].values) + 1j * np.asarray(found[f"{name}_y"].values)


def bend(before, here, after):
    """Curvature of circles through three places, positive where they bend round the origin."""
    a, b, c = after - here, here - before, after - before
    turned = np.imag(np.conj(b) * a)
    return 2 * turned / np.abs(a * b * c) * np.sign(np.imag(np.conj(here) * c))


@pytest.mark.parametrize("name", by_default(NAMES, slice(0, None, 2)))
def test_rates_places_and_curvatures_follow_from_one_another(name):
    cam = CAMS[name]
    swings, sense = cam.follower.oscillates, 1 if cam.direction == "counterclockwise" else -1
    angle = np.array([0.3, 1.2, 1.9, 2.6, 3.0, 3.8, 4.4, 5.0, 5.9])
    early, now, late = (columns(cam, angle + step) for step in (-STEP, 0.0, STEP))
    assert now["cam_angle"].values == pytest.approx(np.degrees(angle)) and now["cam_angle"].unit == "deg"
    assert now["time"].values == pytest.approx(angle / SPEED)
    in_table = np.degrees(1) if swings else 1.0
    assert now["lift"].values == pytest.approx(cam.program.motion(angle).lift * in_table)
    assert now["lift"].unit == ("deg" if swings else "mm")
    for name, rate, size in (
        ("lift", "velocity", in_table),
        ("velocity", "acceleration", 1),
        ("acceleration", "jerk", 1),
    ):
        gained = (late[name].values - early[name].values) / size / (2 * STEP / SPEED)
        assert now[rate].values == pytest.approx(gained, rel=1e-5, abs=1e-5 * np.abs(gained).max())
        assert now[rate].unit.startswith("rad/s" if swings else "mm/s")
    assert now["pressure_angle"].values == pytest.approx(np.degrees(gk.pressure_angle(cam, angle)))
    profile = [places(found, "profile") for found in (early, now, late)]
    assert now["profile_curvature"].values == pytest.approx(bend(*profile), rel=1e-3, abs=1e-5)
    where = seen_from_cam(cam, angle)
    assert depth(cam, where, profile[1]) == pytest.approx(0, abs=1e-10)
    assert np.abs(places(now, "contact") - profile[1] * np.exp(1j * sense * angle)).max() < 1e-10
    assert ("pitch_x" in now) == ("roller" in cam.follower.kind) == ("pitch_curvature" in now)
    if "pitch_x" in now:
        pitch = [places(found, "pitch") for found in (early, now, late)]
        assert np.abs(pitch[1] - where).max() < 1e-10
        assert now["pitch_curvature"].values == pytest.approx(bend(*pitch), rel=1e-3, abs=1e-5)
    outline = gk.flatten(cam.profile, 1e-6)
    way = np.unwrap(np.angle(outline))
    order = np.argsort(np.mod(way, 2 * np.pi))
    far = np.interp(angle, np.mod(way, 2 * np.pi)[order], np.abs(outline)[order], period=2 * np.pi)
    assert now["outline_radius"].values == pytest.approx(far, abs=1e-4)
    assert "lost_lift" not in now


@pytest.mark.parametrize("name", by_default(["flat", "roller on arm"], ["flat"]))
def test_lost_lift_is_a_column_if_some_is_lost(name):
    cam = UNDERCUT[name]
    cut, angle = gk.undercut(cam), np.radians(np.arange(0, 360, 5.0))
    found = columns(cam, angle)
    size, unit = (np.degrees(1), "deg") if cam.follower.oscillates else (1.0, "mm")
    assert found["lost_lift"].unit == unit and 0 < np.max(found["lost_lift"].values)
    assert found["lost_lift"].values == pytest.approx(cut.lost_lift(angle) * size, abs=1e-12)
    assert (columns(cam, angle, cut)["outline_radius"].values == found["outline_radius"].values).all()
    # The outline that is left, not the curve of all contacts with its loops.
    left = gk.flatten(cut.outline, 1e-5)
    assert found["outline_radius"].values.max() <= np.abs(left).max() * (1 + 1e-9)
    rays = gk.nearest(cut.outline, found["outline_radius"].values * np.exp(1j * angle))[1]
    assert rays.max() < 1e-9


def test_an_eccentric_circle_has_the_radius_of_the_cosine_rule():
    angle = np.radians(np.arange(0, 360, 7))
    got = polar_radius(gk.plane.Circle(3 + 4j, 20), angle)
    ahead = np.real((3 + 4j) * np.exp(-1j * angle))
    assert got == pytest.approx(ahead + np.sqrt(ahead**2 - 25 + 400), rel=1e-14)


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
