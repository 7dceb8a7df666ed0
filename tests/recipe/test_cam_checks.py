"""Pressure angles of rise and return, against the exact peaks of the segments that rise and return."""

import numpy as np
import pytest

import geomkin as gk

FOLLOWERS = {
    "offset roller": ('{kind = "translating-roller", roller_radius = 8, offset = -9}', "", 40),
    "roller": ('{kind = "translating-roller", roller_radius = 8}', "", 40),
    "tilted face": ('{kind = "translating-flat", tilt_deg = 8}', "", 40),
    "arm": ('{kind = "oscillating-roller", roller_radius = 8, pivot_distance = 90, arm_length = 70}', "_deg", 40),
    "face on an arm": (
        '{kind = "oscillating-flat", pivot_distance = 90, face_offset = -6, side = "below"}',
        "_deg",
        50,
    ),
}


def text(follower, law, direction):
    kind, unit, base = FOLLOWERS[follower]
    return f"""kind = "disk-cam"
[cam]
base_radius = {base}
direction = "{direction}"
follower = {kind}
program = [
  {{kind = "dwell", end_deg = 40}}, {{kind = "rise", law = "{law}", rise{unit} = 12, end_deg = 150}},
  {{kind = "dwell", duration_deg = 40}}, {{kind = "return", law = "{law}", end_deg = 360}},
]
[files]
write = ["csv"]
"""


@pytest.mark.parametrize(
    ("follower", "law", "direction"),
    [
        pytest.param("offset roller", "uniform", "clockwise", marks=pytest.mark.campaign),
        ("offset roller", "4-5-6-7", "counterclockwise"),
        ("roller", "harmonic", "counterclockwise"),
        ("tilted face", "4-5-6-7", "clockwise"),
        pytest.param("arm", "4-5-6-7", "clockwise", marks=pytest.mark.campaign),
        ("face on an arm", "harmonic", "counterclockwise"),
    ],
)
def test_pressure_angles_are_the_peaks_of_rise_and_return(tmp_path, follower, law, direction):
    (tmp_path / "r.toml").write_text(text(follower, law, direction))
    made = gk.make(tmp_path / "r.toml", tmp_path / "out", ["csv"])
    limits = gk.cam.segment_limits(gk.load(tmp_path / "r.toml").cam)
    found = {check.name: check for check in made.checks}
    # Segments in order: dwell, rise, dwell, return.
    for segment, way in ((1, "rise"), (3, "return")):
        check = found[f"pressure angle on the {way}"]
        assert check.value == pytest.approx(np.degrees(abs(limits.pressure_angle[segment])), rel=1e-7)
        assert check.limit == (45 if "arm" in follower else 30)


def design_checks(follower, *segments, base=40):
    return {c.name: c for c in gk.cam.cam_checks(gk.Cam(follower, gk.Program(segments), base))}


def test_level_face_has_no_pressure_angle_and_a_cam_at_rest_has_no_check_of_it():
    way = gk.Dwell(end_deg=90), gk.Rise("cycloidal", rise=5, end_deg=180), gk.Return("cycloidal", end_deg=360)
    level = design_checks(gk.TranslatingFlat(), *way)
    assert [level[f"pressure angle on the {name}"].value for name in ("rise", "return")] == [0, 0]
    for follower in (gk.TranslatingFlat(tilt_deg=5), gk.TranslatingRoller(8, offset=9)):
        still = design_checks(follower, gk.Dwell(end_deg=360))
        assert still and not any("pressure" in name or "jump" in name for name in still)
        assert all(check.passed for check in still.values())


def test_of_several_jumps_in_velocity_the_largest_is_reported_with_its_place():
    steps = [(60, 10), (60, 20), (30, 6)]
    ends = np.cumsum([60, *(turn for turn, _ in steps)])
    rises = [gk.Rise("uniform", rise=rise, end_deg=end) for (_, rise), end in zip(steps, ends[1:])]
    found = design_checks(
        gk.TranslatingRoller(8),
        gk.Dwell(end_deg=60),
        *rises,
        gk.Dwell(end_deg=240),
        gk.Return("cycloidal", end_deg=360),
    )
    slopes = [0, *(rise / np.radians(turn) for turn, rise in steps), 0]
    jump = found["jump in velocity"]
    assert jump.value == pytest.approx(max(np.abs(np.diff(slopes)))) and not jump.passed and jump.limit == 0
    assert f"worst at {ends[np.abs(np.diff(slopes)).argmax()]:.4g} deg" in jump.advice
    smooth = design_checks(
        gk.TranslatingRoller(8), gk.Rise("cycloidal", rise=5, end_deg=180), gk.Return("cycloidal", end_deg=360)
    )
    assert "jump in velocity" not in smooth
