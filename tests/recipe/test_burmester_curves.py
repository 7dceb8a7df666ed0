"""The recipe of Burmester's curves: its table, drawing and summary, and what it refuses."""

import csv
import json

import numpy as np
import pytest

import geomkin as gk

POSES = [[0, 0, 0], [15, 21, 25], [36, 30, 60], [55, 20, 105]]


def recipe(poses=POSES, **more):
    return gk.load({"kind": "burmester-curves", "wanted": {"poses": poses, **more.pop("wanted", {})}, **more})


@pytest.mark.campaign
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


@pytest.mark.campaign
def test_poles_and_slides_are_reported(tmp_path):
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
