"""What is wrong with a table's rows and file, word by word."""

import pytest

import geomkin as gk
from geomkin.cam.program.given_lifts import read_lifts
from geomkin.cam.program.segments import LiftSpline, LiftTable

HEAD = "cam_angle_deg,lift_mm\n"
CONTENTS = [
    "",
    "angle,lift_mm\n0,0\n",
    "angle\n0\n",
    "cam_angle_deg,lift\n0,0\n",
    "lift_mm,cam_angle_deg,lift_deg\n",
    HEAD + "0,0\n\n180,two\n",
    HEAD + "0,0\n,\n180\n",
    "lift_mm, note,cam_angle_deg\n0,begins,\n",
    HEAD + "0,0\n",
    HEAD,
    HEAD + "0,0\n5,2\n5,3\n360,0\n",
    HEAD + "2,0\n5,2\n360,0\n",
    HEAD + "0,0\n5,-2\n6,-3\n7,-3\n360,0\n",
    "cam_angle_deg,lift_deg\n0,0\n5,-2\n360,0\n",
]
BINARY = [b"cam_angle_deg,lift_mm\n0,0\n180,5,1,5\n360,0\n", b"cam_angle_deg;lift_mm\n0;0\n180;1.234,5\n360;0\n",
          b"\xff\xfe\x00", b"cam_angle_deg,lift_mm\n0,%s\n" % (b"0" * 200_000), b"cam_angle_deg,lift_mm\n180,inf\n360,0\n"]  # fmt: skip


@pytest.mark.parametrize(
    "content", [*(text.encode() for text in CONTENTS), *BINARY], ids=range(len(CONTENTS) + len(BINARY))
)
def test_invalid_file_is_refused(tmp_path, content):
    (tmp_path / "lift.csv").write_bytes(content)
    for name in ("lift.csv", "missing.csv", "."):
        with pytest.raises(gk.DesignError) as caught:
            gk.Program([LiftTable(3, file=name)], tmp_path)
        assert caught.value.field == "program[0].file" and caught.value.remedy


def test_longest_file(tmp_path):
    rows = "".join(f"{360 * k / 9_999:.9g},1\n" for k in range(10_000))
    (tmp_path / "long.csv").write_text(HEAD + rows)
    field, points, swings = read_lifts(LiftTable(3, file="long.csv"), tmp_path)
    assert (field, points.shape, swings) == ("file", (10_000, 2), False) and points[-1].tolist() == [360, 1]
    (tmp_path / "longer.csv").write_text(HEAD + rows + "\n")
    with pytest.raises(gk.DesignError):
        read_lifts(LiftTable(3, file="longer.csv"), tmp_path)
    # Without an end of its last line, one more row is as many lines.
    (tmp_path / "one more.csv").write_text(HEAD + rows + "361,1")
    with pytest.raises(gk.DesignError):
        read_lifts(LiftTable(3, file="one more.csv"), tmp_path)


ROWS = ((0.0, 0.0), (180.0, 5.0), (360.0, 0.0))


@pytest.mark.parametrize(
    ("segment", "field"),
    [
        (LiftTable(3), "rows"),
        (LiftTable(3, rows=ROWS, rows_deg=ROWS), "rows"),
        (LiftTable(3, rows=ROWS, file="a"), "rows"),
        (LiftSpline(), "points"),
        (LiftSpline(ROWS, ROWS), "points"),
    ],
)
def test_rows_are_given_once(segment, field):
    with pytest.raises(gk.DesignError) as caught:
        gk.Program([segment])
    assert caught.value.field == f"program[0].{field}"
