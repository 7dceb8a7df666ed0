"""Further ones of a linkage on one shaft: where they are, that they hold together, and how many parts they take."""

import csv
import json
from pathlib import Path

import ezdxf
import numpy as np
import pytest

import geomkin as gk

RECIPES = Path(__file__).parent.parent.parent / "recipes"
LEG = (
    (RECIPES / "walking-leg.toml")
    .read_text("utf-8")
    .replace("[drive]\nstep_deg = 2\n", "")
    .replace('"csv"', '"csv", "bom"')
)
COPIES = """
[drive]
step_deg = 10

[[copies]]
phase_deg = 90

[[copies]]
phase_deg = -35
mirrored = true
"""
PARALLELOGRAM = """
kind = "four-bar"
branch = "follow"
linkage = { ground = 80, crank = 30, coupler = 80, rocker = 30, ground_angle_deg = 20, origin = [5, 3] }
drive = { step_deg = 15 }
copies = [{ phase_deg = 180 }, { phase_deg = 180, mirrored = true }]
"""


@pytest.fixture(scope="module")
def walker():
    return gk.load(LEG + COPIES)


def places(scene, number):
    """Letter of a joint -> where each hole of that letter is, (holes, frames), in one of the copies."""
    found = {}
    for body in scene.bodies:
        if body.name.endswith(f", copy {number}") if number > 1 else ", copy " not in body.name:
            for part in body.parts:
                for hole, letter in zip(part.holes, part.hole_names):
                    middle = hole.point(np.linspace(0, 2 * np.pi, 9)[:-1]).mean()
                    found.setdefault(letter, []).append(body.origin + body.direction * middle)
    return {letter: np.array(rows) for letter, rows in found.items() if letter}


@pytest.mark.parametrize(("number", "phase"), [(1, 0), (2, 90), (3, -35)])
def test_each_copy_holds_together_at_its_pins_with_its_crank_at_its_angle(walker, number, phase):
    joints = places(walker.scene, number)
    assert len(joints) == len(places(walker.scene, 1)) >= 7
    for rows in joints.values():
        assert len(rows) > 1 and np.abs(rows - rows[0]).max() < 1e-9
    angle = np.radians(np.asarray(walker.table.columns[0].values, dtype=float) + phase)
    pin = 15 * np.exp(1j * angle)
    assert min(np.abs(rows[0] - pin).max() for rows in joints.values()) < 1e-9


def test_copy_repeats_the_path_and_a_mirrored_copy_reverses_it(walker):
    feet = {mark.label: mark.place for mark in walker.scene.marks if mark.trail}
    first, ahead, over = (feet[name] for name in ("foot", "foot, copy 2", "foot, copy 3"))
    assert np.abs(ahead[:-1] - np.roll(first[:-1], -9)).max() < 1e-9
    # Turned over it goes the same way from right to left where the first goes from left to right.
    fine = gk.load(LEG + COPIES.replace("step_deg = 10", "step_deg = 5")).scene
    path = next(mark.place for mark in fine.marks if mark.label == "foot")
    assert np.abs(over[:, None] + np.conj(path)).min(axis=1).max() < 1e-9


def test_a_copy_stays_on_the_branch_of_the_first_through_change_points():
    recipe = gk.load(PARALLELOGRAM)
    for number in (2, 3):
        coupler = next(body for body in recipe.scene.bodies if body.name == f"coupler, copy {number}")
        assert np.abs(coupler.direction - coupler.direction[0]).max() < 1e-6
    shaft = 5 + 3j
    pins = [
        next(b.origin for b in recipe.scene.bodies if b.name == f"coupler{copy}")
        for copy in ("", ", copy 2", ", copy 3")
    ]
    assert np.abs(pins[1] - pins[2]).max() < 1e-6 and np.abs(pins[0] + pins[1] - 2 * shaft).max() < 1e-6


def test_files_count_parts_and_hardware_of_all_copies(walker, tmp_path):
    alone = gk.load(LEG)
    gk.make(walker.with_name("walker"), tmp_path, ["dxf", "bom"])
    outlines = ezdxf.readfile(tmp_path / "walker" / "walker.dxf").modelspace().query("*[layer=='CUT']")
    assert len(outlines) == 3 * sum(part.count for part in alone.parts)
    bill = (tmp_path / "walker" / "walker-bom.csv").read_text("utf-8").splitlines()
    rows = {row["item"]: int(row["count"]) for row in csv.DictReader(bill)}
    assert rows["leg"] == 3
    data = json.loads((tmp_path / "walker" / "summary.json").read_text("utf-8"))
    assert {part["name"]: part["count"] for part in data["parts"]}["crank"] == 3
    assert data["stack"]["bought"] == [
        {"name": b.name, "count": b.count, "joints": list(b.joints)} for b in walker.bought
    ]
    assert walker.steps[: len(alone.steps)] == alone.steps
