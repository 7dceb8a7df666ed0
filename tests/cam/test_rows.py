"""The table of a cam row by row: rates by differences of its own columns, curvatures by circles through three places."""

import numpy as np
import pytest

import geomkin as gk

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


@pytest.mark.parametrize("name", NAMES)
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


@pytest.mark.parametrize("name", ["flat", "roller on arm"])
def test_lost_lift_is_told_where_some_is_lost(name):
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
