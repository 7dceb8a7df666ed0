"""The recipe of a body through poses: made, and the recipe that it found runs by itself through the poses."""

import csv
import json

import numpy as np
import pytest

import geomkin as gk

THREE = "poses = [[0, 0, 0], [40, 20, 30], [60, 60, 80]]"


def recipe(wanted=THREE, rest=""):
    return gk.load(f'kind = "body-guidance"\n{rest}\n[wanted]\n{wanted}\n').with_name("poses")


@pytest.mark.parametrize(
    "wanted",
    [
        pytest.param(THREE, marks=pytest.mark.campaign),
        pytest.param(
            f'{THREE}\ntype = "crank-slider"\nregion = [[-100, -100], [160, 160]]', marks=pytest.mark.campaign
        ),
        f'{THREE}\ntype = "elliptic-trammel"\ntrammel_driver = "rod"',
        pytest.param(f"{THREE}\nmoving_points = [[-20, 10], [30, 40]]", marks=pytest.mark.campaign),
        "poses = [[0, 0, 0], [-40, 25, -30], [-65, 50, -50], [-85, 70, -65], [-105, 85, -75]]",
    ],
)
def test_found_linkage_goes_through_the_poses(tmp_path, wanted):
    goal = recipe(wanted)
    made = gk.make(goal, tmp_path)
    folder = tmp_path / "poses"
    assert {"poses.dxf", "poses.found.toml", "poses.csv", "summary.json", "poses.stl"} <= {
        file.name for file in made.files
    }
    data = json.loads((folder / "summary.json").read_text())
    assert data["number_found"] == len(data["ranked"]) or data["number_found"] > 20
    assert next(iter(data["found"])) == "pose_error_mm" and data["found"]["defects"] == list(goal.found.defects)
    # The found recipe by itself: over its own way its coupler point passes all places of the body, if it has no defect.
    found = gk.load(folder / "poses.found.toml")
    assert found == goal.design
    if not goal.found.defects:
        point = found.motion.point("rod_point" if "rod" in found.motion.bodies else "coupler_point").position
        assert found.motion.assembled.all()
        for x, y, _ in goal.wanted.poses:
            assert np.abs(point - complex(x, y)).min() < 2.0
        assert [abs(point[k] - complex(*goal.wanted.poses[j][:2])) < 1e-3 for k, j in ends(goal)] == [True, True]
    with (folder / "poses.csv").open() as rows:
        table = list(csv.DictReader(line for line in rows if not line.startswith("#")))
    # Its angles too: the table ends at the first and the last pose.
    angles = [float(row["body_angle_deg"]) for row in table]
    for k, j in ends(goal):
        assert (angles[k] - goal.wanted.poses[j][2] + 180) % 360 == pytest.approx(180, abs=1e-3) or goal.found.defects


def test_the_plotted_rows_are_the_linkages_that_their_ranks_choose():
    goal = recipe(rest="choose = 2")
    choice = goal.scene.choice
    ranks, angles, ratios = (column.values for column in choice.table.columns)
    assert ranks[choice.chosen] == 2 and len(ranks) == len(goal.ranked) and choice.key == "choose"
    for design, row in ((goal.design, 1), (recipe(rest="choose = 4").design, 3)):
        lengths = [getattr(design.linkage, name) for name in ("ground", "crank", "coupler", "rocker")]
        assert max(lengths) / min(lengths) == pytest.approx(ratios[row], rel=1e-4)
        assert np.degrees(gk.least_transmission_angle(design.motion)) == pytest.approx(angles[row], abs=0.1)


def ends(goal):
    """The first and last row, and the poses that they are."""
    rising = goal.found.drive[-1] > goal.found.drive[0]
    return ((0, 0), (-1, -1)) if rising else ((0, -1), (-1, 0))


def test_checks_report_pose_error_and_defects():
    by_name = {check.name: check for check in recipe().checks}
    assert by_name["largest distance from a pose"].passed and by_name["defects"].value == 0
    seven = "poses = [[0, 0, 0], [10, 4, 9], [22, 7, 15], [30, 16, 25], [41, 20, 28], [52, 39, 50], [60, 60, 80]]"
    goal = recipe(seven)
    by_name = {check.name: check for check in goal.checks}
    assert not by_name["largest distance from a pose"].passed
    assert by_name["largest distance from a pose"].value == pytest.approx(goal.found.pose_error, rel=1e-6)
    ranked = recipe().ranked
    wrong = recipe(rest=f"choose = {len(ranked)}")
    assert wrong.found.defects
    (check,) = [check for check in wrong.checks if check.name == "defects"]
    assert not check.passed and wrong.found.defects[0] in check.advice


def test_given_points_drive_in_their_order_or_either_and_the_driving_pin_is_stated():
    wanted = f"{THREE}\nmoving_points = [[-20, 10], [30, 40]]"
    first, either = recipe(wanted), recipe(f'{wanted}\ndriving_point = "either"')
    assert first.notes["found"]["driving_pin_on_body_mm"] == pytest.approx([-20, 10], abs=1e-3)
    assert first.notes["found"]["driven_pin_on_body_mm"] == pytest.approx([30, 40], abs=1e-3)
    assert len(first.ranked) == 1 and len(either.ranked) == 2
    driving = {tuple(np.round(entry["driving_pin_on_body_mm"], 2)) for entry in either.notes["ranked"]}
    assert driving == {(-20, 10), (30, 40)}
    (remark,) = first.remarks
    assert "(-20, 10) mm" in remark and "(30, 40) mm" in remark and not recipe().remarks
    # The rod of a trammel holds both pins, and neither drives.
    rod = recipe(f'{THREE}\ntype = "elliptic-trammel"\ntrammel_driver = "rod"')
    assert rod.notes["found"]["driver"] == "rod" and "driving_pin_on_body_mm" not in rod.notes["found"]


def test_poles_are_reported_and_those_at_infinity_by_their_direction():
    data = recipe("poses = [[0, 0, 0], [40, 20, 0], [60, 60, 80]]").notes["poles_mm"]
    assert "at_infinity_deg" in data["1 and 2"] and len(data["1 and 3"]) == 2
    # The point that has one place at two poses.
    x, y = recipe().notes["poles_mm"]["1 and 3"]
    pole = complex(x, y)
    assert 60 + 60j + pole * np.exp(1j * np.radians(80)) == pytest.approx(60 + 60j + pole * np.exp(1j * np.radians(80)))
    own = (pole - (60 + 60j)) * np.exp(-1j * np.radians(80))
    assert own == pytest.approx(pole, abs=1e-6)
