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
    ("law", "direction"), [("uniform", "clockwise"), ("harmonic", "counterclockwise"), ("4-5-6-7", "clockwise")]
)
@pytest.mark.parametrize("follower", FOLLOWERS)
def test_pressure_angles_are_the_peaks_of_rise_and_return(tmp_path, follower, law, direction):
    (tmp_path / "r.toml").write_text(text(follower, law, direction))
    made = gk.make(tmp_path / "r.toml", tmp_path / "out")
    limits = gk.cam.segment_limits(gk.load(tmp_path / "r.toml").cam)
    found = {check.name: check for check in made.checks}
    # Segments in order: dwell, rise, dwell, return.
    for segment, way in ((1, "rise"), (3, "return")):
        check = found[f"pressure angle on the {way}"]
        assert check.value == pytest.approx(np.degrees(abs(limits.pressure_angle[segment])), rel=1e-7)
        assert check.limit == (45 if "arm" in follower else 30)
