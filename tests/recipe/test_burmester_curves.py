"""The recipe of Burmester's curves: its table, drawing and summary, and what it refuses."""

import csv
import json

import numpy as np
import pytest

import geomkin as gk

POSES = [[0, 0, 0], [15, 21, 25], [36, 30, 60], [55, 20, 105]]


def recipe(poses=POSES, **more):
    return gk.load({"kind": "burmester-curves", "wanted": {"poses": poses, **more.pop("wanted", {})}, **more})


def test_dyads_of_the_file_go_through_all_poses(tmp_path):
    gk.make(recipe(rows=60).with_name("curves"), tmp_path)
    with (tmp_path / "curves/curves.csv").open() as file:
        rows = list(csv.DictReader(file))
    fixed, moving = (
        np.array([complex(float(row[f"{name}_x_mm"]), float(row[f"{name}_y_mm"])) for row in rows])
        for name in ("fixed", "moving")
    )
    lengths = np.array([abs(x + 1j * y + np.exp(1j * np.radians(a)) * moving - fixed) for x, y, a in POSES])
    assert 58 <= len(rows) <= 62
    assert np.ptp(lengths, axis=0).max() < 1e-4
    assert [float(row["length_mm"]) for row in rows] == pytest.approx(lengths[0], abs=1e-4)
    # Piece by piece, each by its number, and every row by its own.
    pieces = [int(row["piece"]) for row in rows]
    assert pieces == sorted(pieces) and set(pieces) == set(range(1, pieces[-1] + 1))
    assert [int(row["dyad"]) for row in rows] == list(range(1, len(rows) + 1))
    # Evenly along each piece.
    steps = np.abs(np.diff(fixed))[np.diff([int(row["piece"]) for row in rows]) == 0]
    assert np.ptp(steps) < 0.1 * steps.mean()


def test_pins_at_the_first_pose_are_those_of_the_body_there():
    turned = [[x + 7, y - 3, angle + 40] for x, y, angle in POSES]
    table = recipe(turned, rows=50).table
    first, moving, fixed = (table[f"{n}_x"] + 1j * table[f"{n}_y"] for n in ("moving_at_first", "moving", "fixed"))
    assert first == pytest.approx(7 - 3j + np.exp(1j * np.radians(40)) * moving, abs=1e-9)
    assert table["length"] == pytest.approx(np.abs(first - fixed))


def test_poles_and_slides_are_told(tmp_path):
    gk.make(recipe().with_name("curves"), tmp_path)
    summary = json.loads((tmp_path / "curves/summary.json").read_text())
    assert all(check["passed"] for check in summary["checks"])
    assert set(summary["poles_mm"]) == {"1 and 2", "1 and 3", "1 and 4", "2 and 3", "2 and 4", "3 and 4"}
    for pair, place in summary["poles_mm"].items():
        # The point of the body that is at one place in both poses.
        pole, two = complex(*place), [POSES[int(number) - 1] for number in pair.split(" and ")]
        one, other = ((pole - complex(x, y)) * np.exp(-1j * np.radians(angle)) for x, y, angle in two)
        assert one == pytest.approx(other, abs=1e-6)
    slide = summary["slides"]["pin_that_slides"]
    pin = complex(*slide["place_mm"])
    places = np.array([x + 1j * y + np.exp(1j * np.radians(a)) * pin for x, y, a in POSES])
    across = (places * np.exp(-1j * np.radians(slide["direction_deg"]))).imag
    assert np.ptp(across) < 1e-6
    pivot = complex(*summary["slides"]["pivot_that_is_slid_over"]["place_mm"])
    on_body = np.array([(pivot - x - 1j * y) * np.exp(-1j * np.radians(a)) for x, y, a in POSES])
    way = np.exp(-1j * np.radians(summary["slides"]["pivot_that_is_slid_over"]["direction_deg"]))
    assert np.ptp((on_body * way).imag) < 1e-6


def test_what_is_drawn_lies_on_the_curves():
    made = recipe(wanted={"reach": 80.0})
    marks = made.parts[0].marks
    curves = gk.synthesis.burmester_curves(made.wanted.pairs, 80.0)
    assert sum(isinstance(mark, gk.synthesis.BurmesterCurve) for mark in marks) == len(curves.fixed)
    # The dashes are on the body at its first pose, which here is the ground's own frame.
    dashes = [mark for mark in marks if isinstance(mark, gk.plane.Moved)]
    assert len(dashes) > 20
    ends = np.concatenate([dash.point(dash.breaks) for dash in dashes])
    assert np.min([gk.nearest(c, ends)[1] for c in curves.moving], axis=0).max() < 1e-9
    assert sum(isinstance(mark, gk.plane.Circle) for mark in marks) == 6


@pytest.mark.parametrize(
    "poses",
    [
        [[-20, 10, 35], [-10, 20, 12], [10, 20, -12], [20, 10, -35]],
        [[0, 0, 10], [20, 10, 10], [10, 30, 60], [0, 40, 120]],
        [[0, 0, 10], [20, 10, 10], [10, 30, 60], [0, 40, 60]],
        [[100, 100, 0], [115, 121, 25], [136, 130, 60], [155, 120, 105]],
        [[0, 0, 350], [1e-3, 2e-3, 10], [3e-3, 2e-3, 40], [4e-3, 1e-3, 90]],
    ],
    ids=["symmetrical", "one pair parallel", "two pairs parallel", "far from the origin", "tiny"],
)
def test_special_poses_are_drawn(poses):
    made = recipe(poses)
    assert all(check.passed for check in made.checks if "wall" not in check.name)
    assert made.parts[0].marks


def test_the_curves_are_drawn_three_times_as_far_as_the_farthest_pose():
    z = np.array([x + 1j * y for x, y, _ in POSES])
    made = recipe()
    assert made.reach == pytest.approx(3 * max(abs(z - sum(z) / 4))) and recipe(wanted={"reach": 70.0}).reach == 70
    assert made.wanted.middle == pytest.approx(sum(z) / 4)
    # Poles beyond it are left out of the drawing.
    near = [pole for pole in gk.synthesis.poles(made.wanted.pairs).values() if abs(pole.position - sum(z) / 4) <= 30]
    small = recipe(wanted={"reach": 30.0}).parts[0].marks
    assert sum(isinstance(mark, gk.plane.Circle) for mark in small) == len(near) < 6


@pytest.mark.parametrize(
    ("poses", "more", "key"),
    [
        (POSES[:3], {}, "poses"),
        ([*POSES, [1, 2, 3]], {}, "poses"),
        ([*POSES[:3], POSES[0]], {}, "poses"),
        ([*POSES[:3], [0, 0, 360]], {}, "poses"),
        ([*POSES[:3], [0, 0]], {}, "poses"),
        ([*POSES[:3], [0, 0, "1"]], {}, "poses"),
        ([[0, 0, k] for k in (0, 20, 50, 70)], {}, "reach"),
        ([[0, 0, k] for k in (0, 20, 50, 70)], {"wanted": {"reach": 50.0}}, "poses"),
        ([[1, 0, 5], [0, 1, 5], [-1, 0, 5], [0, -1, 5]], {}, "poses"),
        (POSES, {"wanted": {"reach": 1e-3}}, "reach"),
        (POSES, {"rows": 1}, "rows"),
    ],
)
def test_what_cannot_be_is_refused(poses, more, key):
    with pytest.raises(gk.GeomkinError, match=key):
        assert recipe(poses, **more).parts
