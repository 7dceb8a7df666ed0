"""What is wrong with a table's rows and file, word by word."""

import pytest

import geomkin as gk
from geomkin.cam.program.given_lifts import read_rows
from geomkin.cam.program.segments import LiftSpline, LiftTable

HEAD = "cam_angle_deg,lift_mm\n"
COLUMNS = "name its columns there: cam_angle_deg and one of lift_mm and lift_deg, separated by commas or semicolons"
CONTENTS = {
    "": ("the first line of {} does not name cam_angle_deg", COLUMNS),
    "angle,lift_mm\n0,0\n": ("the first line of {} does not name cam_angle_deg", COLUMNS),
    "angle\n0\n": ("the first line of {} does not name cam_angle_deg", COLUMNS),
    "cam_angle_deg,lift\n0,0\n": ("the first line of {} does not name just one of lift_mm and lift_deg", COLUMNS),
    "lift_mm,cam_angle_deg,lift_deg\n": (
        "the first line of {} does not name just one of lift_mm and lift_deg",
        COLUMNS,
    ),
    HEAD + "0,0\n\n180,two\n": ("line 4 of {}, column 2, holds 'two'", "give a number there"),
    HEAD + "0,0\n,\n180\n": ("line 4 of {}, column 2, holds ''", "give a number there"),
    "lift_mm, note,cam_angle_deg\n0,begins,\n": ("line 2 of {}, column 3, holds ''", "give a number there"),
    HEAD + "0,0\n": ("found 1", "give two at least: where it starts and where it ends"),
    HEAD: ("found []", "give at most 10000 rows [angle in deg, lift] of numbers"),
    HEAD + "0,0\n5,2\n5,3\n360,0\n": ("the angle 5 deg follows 5 deg", "let the angles rise"),
    HEAD + "2,0\n5,2\n360,0\n": (
        "found 2, but the segment before ends at 0 deg: a gap",
        "let the angles start at 0 deg",
    ),
    HEAD + "0,0\n5,-2\n6,-3\n7,-3\n360,0\n": (
        "the lift is -3 mm at 6 deg, below the base circle",
        "give 0 mm or more, and a smaller base_radius",
    ),
    "cam_angle_deg,lift_deg\n0,0\n5,-2\n360,0\n": (
        "the lift is -2 deg at 5 deg, below the base circle",
        "give 0 deg or more, and a smaller base_radius",
    ),
}


@pytest.mark.parametrize("content", CONTENTS)
def test_what_is_wrong_with_a_file_is_told_word_by_word(tmp_path, content):
    problem, remedy = CONTENTS[content]
    (tmp_path / "lift.csv").write_text(content)
    with pytest.raises(gk.DesignError) as caught:
        gk.Program([LiftTable(3, file="lift.csv")], tmp_path)
    assert caught.value.field == "program[0].file"
    assert (caught.value.problem, caught.value.remedy) == (problem.format("lift.csv"), remedy)


def test_a_file_of_as_many_rows_as_may_be_is_read_and_one_more_is_not(tmp_path):
    rows = "".join(f"{360 * k / 9_999:.9g},1\n" for k in range(10_000))
    (tmp_path / "long.csv").write_text(HEAD + rows)
    field, points, swings = read_rows(LiftTable(3, file="long.csv"), tmp_path)
    assert (field, points.shape, swings) == ("file", (10_000, 2), False) and points[-1].tolist() == [360, 1]
    (tmp_path / "longer.csv").write_text(HEAD + rows + "\n")
    with pytest.raises(gk.DesignError, match="longer.csv has 10,002 lines; give at most 10,000 rows"):
        read_rows(LiftTable(3, file="longer.csv"), tmp_path)
    # Without an end of its last line, one more row is as many lines.
    (tmp_path / "one more.csv").write_text(HEAD + rows + "361,1")
    with pytest.raises(gk.DesignError, match="file: found .*; give at most 10000 rows .angle in deg, lift. of numbers"):
        read_rows(LiftTable(3, file="one more.csv"), tmp_path)


ROWS = ((0.0, 0.0), (180.0, 5.0), (360.0, 0.0))


@pytest.mark.parametrize(
    ("segment", "field", "problem"),
    [
        (LiftTable(3), "rows", "of rows, rows_deg, file found none"),
        (LiftTable(3, rows=ROWS, rows_deg=ROWS), "rows", "of rows, rows_deg, file found rows and rows_deg"),
        (LiftTable(3, rows=ROWS, file="a"), "rows", "of rows, rows_deg, file found rows and file"),
        (LiftSpline(), "points", "of points, points_deg found none"),
        (LiftSpline(ROWS, ROWS), "points", "of points, points_deg found points and points_deg"),
    ],
)
def test_rows_are_given_once(segment, field, problem):
    with pytest.raises(gk.DesignError) as caught:
        gk.Program([segment])
    assert (caught.value.field, caught.value.problem) == (f"program[0].{field}", problem)
    assert caught.value.remedy == "give one of them"
