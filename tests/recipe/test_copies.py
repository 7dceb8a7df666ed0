"""Further ones of a linkage on one shaft: where they are, that they hold together, and how many parts they take."""

import csv
import json
from pathlib import Path

import ezdxf
import numpy as np
import pytest

import geomkin as gk
from geomkin.linkage.parts.stack import stack_links

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


@pytest.mark.campaign
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


MOTOR_CRANK = {
    "kind": "four-bar",
    "linkage": {"ground": 120, "crank": 30, "coupler": 100, "rocker": 70},
    "drive": {"step_deg": 15},
    "stock": {"thickness": 4, "bar_width": 16, "motor": "nema17", "fit": "press"},
}
ALTERNATING = [{"mirrored": True}, {"phase_deg": 180}, {"phase_deg": 180, "mirrored": True}]


@pytest.fixture(scope="module")
def driven():
    """Four linkages, the first of which is on a motor."""
    return gk.load({**MOTOR_CRANK, "copies": ALTERNATING})


def test_only_the_first_linkage_has_the_holes_of_the_motor_and_the_others_hold_together_on_pins(driven):
    alone, plain = gk.load(MOTOR_CRANK), gk.load({**MOTOR_CRANK, "stock": {"thickness": 4, "bar_width": 16}})
    for number in (2, 3, 4):
        for part in plain.parts:
            if part.name != "spacer":
                (copied,) = next(b for b in driven.scene.bodies if b.name == f"{part.name}, copy {number}").parts
                areas = [sorted(abs(gk.plane.signed_area(hole)) for hole in p.holes) for p in (part, copied)]
                assert areas[0] == pytest.approx(areas[1])
        assert all(np.ptp(rows, axis=0).max() < 1e-9 for rows in places(driven.scene, number).values())
    assert sum(item.count for item in driven.bought if item.name.startswith("motor")) == 1
    counts = {part.name: part.count for part in driven.parts if part.name != "spacer"}
    assert counts == {p.name: 1 if p.name in ("ground", "crank") else 4 for p in alone.parts if p.name in counts} | {
        f"plain_{name}": 3 for name in ("ground", "crank")
    }


def test_files_of_driven_copies_have_all_parts(driven, tmp_path):
    gk.make(driven.with_name("driven"), tmp_path, ["dxf", "bom"])
    outlines = ezdxf.readfile(tmp_path / "driven" / "driven.dxf").modelspace().query("*[layer=='CUT']")
    drawn = sum(len(body.parts) for body in driven.scene.bodies)
    assert len(outlines) == sum(part.count for part in driven.parts)
    assert drawn == sum(part.count for part in driven.parts if part.name != "spacer")


@pytest.mark.parametrize(
    ("copies", "loose"),
    [(ALTERNATING, 0), ([{}], 1), ([{"mirrored": True}, {"mirrored": True}, {}], 2), ([{"phase_deg": 90}, {}], 2)],
)
def test_motor_turns_the_copies_up_to_the_first_that_no_rod_joins(copies, loose):
    recipe = gk.load({**MOTOR_CRANK, "copies": copies})
    (check,) = (check for check in recipe.checks if check.id == "copies_not_driven")
    assert check.value == loose and check.passed == (not loose)
    rods = sum(item.count for item in recipe.bought if item.name.startswith("rod"))
    # Rods between copies that are joined to each other, but not to the first, do not help.
    assert rods >= len(copies) - loose and (rods == 0) == (loose == len(copies))


@pytest.mark.parametrize(("at", "rods"), [([99, 67], True), ([29, 117], False)])
def test_layers_leave_the_rods_between_cranks_or_the_attachment_in_their_way_is_named(at, rods):
    """A rocker that is wide enough to pass over the crank's pin at the first place, and over its shaft at the second."""
    arm = {"name": "wing", "body": "rocker", "at": at, "screw": "M2"}
    made = gk.load({**MOTOR_CRANK, "copies": ALTERNATING, "stock": {**MOTOR_CRANK["stock"], "attachments": [arm]}})
    fewest = stack_links(made.made.fine_motion, made.stock)
    assert fewest.layers["rocker"] > fewest.layers["coupler"] and not made.made.stack.collisions
    assert all(rod.pin for rod in made.made.shared) == rods
    (check,) = (check for check in made.checks if check.id == "copies_not_driven")
    assert check.passed == rods and (rods or "wing" in check.advice)
