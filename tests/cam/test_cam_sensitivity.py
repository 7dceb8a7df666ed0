"""Sensitivities of cams by every size of every follower, against differences and 40 digits."""

from dataclasses import fields, replace

import numpy as np
import pytest
from mpmath import mp, mpc, mpf

import geomkin as gk
from tests.gallery import RECIPES


def program(oscillates):
    rise = {"rise_deg": 14} if oscillates else {"rise": 12}
    return gk.Program((gk.Rise("cycloidal", end_deg=180, **rise), gk.Return("3-4-5", end_deg=360)))


FOLLOWERS = {
    "translating roller": (gk.TranslatingRoller(9, offset=7), 38.0),
    "arm above": (gk.OscillatingRoller(8, pivot_distance=92, arm_length=75), 40.0),
    "arm below": (gk.OscillatingRoller(8, pivot_distance=92, arm_length=75, side="below"), 41.0),
    "tilted face": (gk.TranslatingFlat(tilt_deg=11), 40.0),
    "face on an arm": (gk.OscillatingFlat(pivot_distance=110, face_offset=6), 62.0),
}
CAMS = {
    f"{name}, {direction}": gk.Cam(follower, program(follower.oscillates), base, direction)
    for direction in ("counterclockwise", "clockwise")
    for name, (follower, base) in FOLLOWERS.items()
}
ANGLES = np.array([0.3, 1.1, 2.0, 2.9])


def sizes_of(cam):
    own = {f.name: getattr(cam.follower, f.name) for f in fields(cam.follower) if "unit" in f.metadata}
    return {"base_radius": cam.base_radius, **{f"follower.{name}": value for name, value in own.items()}}


def changed(cam, by, value):
    if by == "base_radius":
        return replace(cam, base_radius=value)
    return replace(cam, follower=replace(cam.follower, **{by.split(".")[1]: value}))


@pytest.mark.parametrize("name", CAMS)
def test_sensitivities_agree_with_differences_of_cams(name):
    cam = CAMS[name]
    quantities = {
        "profile": lambda cam: cam.profile.point(ANGLES),
        "pressure_angle": lambda cam: gk.pressure_angle(cam, ANGLES),
    }
    for by, value in sizes_of(cam).items():
        unit = np.pi / 180 if by.endswith("_deg") else 1.0
        for of, quantity in quantities.items():
            slopes = []
            for h in (4e-3, 2e-3):
                ends = [quantity(changed(cam, by, value + step)) for step in (h, -h)]
                slopes.append((ends[0] - ends[1]) / (2 * h * unit))
            wanted = (4 * slopes[1] - slopes[0]) / 3
            np.testing.assert_allclose(cam.sensitivity(of, by=by, angle=ANGLES), wanted, rtol=1e-8, atol=2e-9)


def exact(t, base, roller, offset):
    """Profile point and pressure angle of a translating roller on the cycloidal rise, 40 digits."""
    rise, end = mpf(12), mp.pi

    def centre(u):
        lift = rise * (u / end - mp.sin(2 * mp.pi * u / end) / (2 * mp.pi))
        return offset + 1j * (mp.sqrt((base + roller) ** 2 - offset**2) + lift)

    pitch = mp.diff(lambda u: mp.exp(-1j * u) * centre(u), t)
    normal = 1j * pitch * mp.exp(1j * t) / abs(pitch)
    return mp.exp(-1j * t) * (centre(t) - roller * normal), mp.arg(normal / mpc(0, 1))


def test_sensitivities_of_a_roller_have_ten_digits():
    cam = CAMS["translating roller, counterclockwise"]
    with mp.workdps(50):
        for k, by in enumerate(("base_radius", "follower.roller_radius", "follower.offset")):
            for t in ANGLES.tolist():
                step = mpf(10) ** -12
                sizes = [[mpf(v) + sign * step * (j == k) for j, v in enumerate((38, 9, 7))] for sign in (1, -1)]
                ends = [exact(mpf(t), *each) for each in sizes]
                point, angle = ((one - other) / (2 * step) for one, other in zip(*ends))
                assert abs(cam.sensitivity("profile", by=by, angle=t) - complex(point)) < 1e-12
                assert abs(cam.sensitivity("pressure_angle", by=by, angle=t) - float(angle)) < 1e-13


def test_unknown_sizes_are_refused_with_the_names_of_all():
    with pytest.raises(gk.DesignError, match=r"follower\.offset") as caught:
        CAMS["translating roller, clockwise"].sensitivity("profile", by="offset", angle=0.0)
    assert caught.value.field == "by"


@pytest.mark.parametrize("name", ["roller-cam", "rocker-cam", "flat-rocker-cam"])
def test_the_page_of_a_cam_shows_which_length_turns_the_pressure_angle_most(name):
    """Bars of the change for 1 mm, the largest first, are those of cams whose lengths are changed."""
    recipe = gk.load(RECIPES / f"{name}.toml")
    cam, scene = recipe.cam, recipe.scene
    ids = next(plot.columns for plot in scene.plots if plot.bars)
    angles, largest = np.radians(scene.table["cam_angle"]), []
    for id in ids:
        size = id.removeprefix("pressure_angle_by_")
        ends = []
        for step in (1e-4, -1e-4):
            if size == "base_radius":
                changed = replace(cam, base_radius=cam.base_radius + step)
            else:
                changed = replace(cam, follower=replace(cam.follower, **{size: getattr(cam.follower, size) + step}))
            ends.append(np.degrees(gk.pressure_angle(changed, angles)))
        expected = np.abs(ends[0] - ends[1]) / 2e-4
        assert scene.table[id] == pytest.approx(expected, abs=1e-6)
        largest.append(expected.max())
    assert len(ids) >= 3 and largest == pytest.approx(sorted(largest, reverse=True), rel=1e-6)


def test_a_face_that_does_not_turn_has_no_such_bars():
    assert not any(plot.bars for plot in gk.load(RECIPES / "flat-cam.toml").scene.plots)
