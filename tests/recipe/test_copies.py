"""Further ones of a linkage on one shaft: where they are, that they hold together, and how many parts they take."""

import csv
import json
import re
from pathlib import Path

import ezdxf
import numpy as np
import pytest

import geomkin as gk
from geomkin.linkage.kinds.copies import _beyond
from geomkin.linkage.parts.stack import PinSpan

RECIPES = Path(__file__).parent.parent.parent / "recipes"
LEG = (RECIPES / "walking-leg.toml").read_text("utf-8").replace('"csv"', '"csv", "bom"')
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


def test_a_copy_walks_as_the_first_one_did_and_one_turned_over_the_other_way(walker):
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


def test_a_copy_stays_on_the_branch_that_the_first_has_at_its_first_frame():
    """A frame later, half a turn of the rocker on, the place that tells the branch is nearer to the other one."""
    bar, drive = gk.FourBar(100, 95, 110, 112), np.radians(np.arange(320, 681, 60))
    own, other = (gk.move(bar, drive, side).point("rocker_pin").position for side in (1, -1))
    assert abs(own[0] - other[1]) < abs(own[0] - own[1])
    recipe = gk.load({
        "kind": "four-bar",
        "linkage": {"ground": 100, "crank": 95, "coupler": 110, "rocker": 112},
        "branches": {"rocker_pin": [own[0].real, own[0].imag]},
        "drive": {"start_deg": 320, "end_deg": 680, "step_deg": 60},
        "copies": [{"phase_deg": 90}, {"phase_deg": -100}, {"phase_deg": 50, "mirrored": True}],
    })  # fmt: skip
    found = {body.name: body.direction for body in recipe.scene.bodies}
    assert found["rocker"] == pytest.approx(gk.move(bar, drive).bodies["rocker"].direction)
    for name, phase in (("rocker, copy 2", 90), ("rocker, copy 3", -100)):
        wanted = gk.move(bar, drive + np.radians(phase)).bodies["rocker"].direction
        assert found[name] == pytest.approx(wanted, abs=1e-9)
    # Turned over, it is seen from behind, with its crank as far ahead.
    pins = {body.name: body.origin for body in recipe.scene.bodies}
    assert pins["coupler, copy 4"] == pytest.approx(np.exp(1j * np.radians(50)) * pins["coupler"], abs=1e-9)
    at = np.angle(-np.conj(pins["coupler, copy 4"]))
    wanted = gk.move(bar, np.unwrap(at)[::-1]).bodies["rocker"].direction[::-1]
    assert found["rocker, copy 4"] == pytest.approx(np.conj(wanted), abs=1e-9)


def test_files_count_the_parts_of_all_and_what_joins_them(walker, tmp_path):
    alone = gk.load(LEG)
    gk.make(walker.with_name("walker"), tmp_path, ["dxf", "bom"])
    outlines = ezdxf.readfile(tmp_path / "walker" / "walker.dxf").modelspace().query("*[layer=='CUT']")
    assert len(outlines) == 3 * sum(part.count for part in alone.parts)
    bill = (tmp_path / "walker" / "walker-bom.csv").read_text("utf-8").splitlines()
    rows = {row["item"]: int(row["count"]) for row in csv.DictReader(bill)}
    assert rows["leg"] == 3
    told = json.loads((tmp_path / "walker" / "summary.json").read_text("utf-8"))
    assert {part["name"]: part["count"] for part in told["parts"]}["crank"] == 3
    assert told["stack"]["bought"] == [
        {"name": b.name, "count": b.count, "joints": list(b.joints)} for b in walker.bought
    ]
    (told,) = [step for step in walker.steps if step.startswith("3 of these")]
    assert "turned over" in told and walker.steps[: len(alone.steps)] == alone.steps


@pytest.mark.parametrize(
    ("phases", "rods"),
    [
        ([(0, True)], {"C": 1}),
        ([(0, True), (180, False)], {"A": 1, "C": 1}),
        ([(0, True), (90, False), (90, True)], {"A": 1, "C": 2}),
        # A crank pin that stands elsewhere is not common, and no shaft goes through the plates over a crank.
        ([(90, True)], {}),
        ([(90, False)], {}),
    ],
)
def test_neighbours_share_a_rod_where_nothing_passes_between_their_cranks(phases, rods):
    """Face to face with cranks alike the pin of both cranks, back to back the shaft; else each has its own screws."""
    copies = "".join(f"[[copies]]\nphase_deg = {p}\nmirrored = {str(m).lower()}\n" for p, m in phases)
    alone, recipe = gk.load(LEG), gk.load(LEG + copies)
    count = 1 + len(phases)

    def screws(of):
        return sum(one.count for one in of.bought if "screw" in one.name)

    found = {joint: one.count for one in recipe.bought if one.name.startswith("rod") for joint in one.joints}
    assert found == rods
    assert screws(recipe) == count * screws(alone) - 2 * sum(rods.values())
    # A joint whose rods take the place of all its screws has none of what goes with them.
    bolted = {joint for one in recipe.bought if not one.name.startswith("rod") for joint in one.joints}
    without = {joint for joint, cut in rods.items() if 2 * cut == count}
    assert bolted == {joint for one in alone.bought for joint in one.joints} - without
    assert all(one.count > 0 for one in recipe.bought)
    told = [step for step in recipe.steps if step.startswith("copies ")]
    assert len(told) == len(phases) and sum("one rod" in step for step in told) == sum(rods.values())
    assert [one.words for one in recipe.shared] == told
    for one in recipe.shared:
        assert bool(one.pin) == (one.length > 0) == ("one rod" in one.words)
    # A rod goes through both stacks and what is kept free between them.
    for one in recipe.bought:
        if one.name.startswith("rod"):
            (pin,) = [pin for pin in recipe.stack.pins if recipe.stack.letters[pin.name] == one.joints[0]]
            ((room, length),) = {
                re.search(r"([\d.]+) mm between.* ([\d.]+) mm long", s).groups()
                for s in told
                if f"rod {one.joints[0]}" in s
            }
            assert float(length) == pytest.approx(2 * pin.length + float(room)) and f"cut to {length} mm" in one.name


def test_room_between_copies_is_what_heads_and_nuts_take_in_whole_sheets():
    """Sheets of 2.5 mm. On top the longest screw from below ends in 6 mm of nut and thread; below, in 3.5 mm of it."""
    copies = "[[copies]]\nmirrored = true\n[[copies]]\nphase_deg = 180\n"
    recipe = gk.load(LEG + copies)
    told = [step for step in recipe.steps if step.startswith("copies ")]
    assert told[0].startswith("copies 1 and 2 face to face, 15 mm between them: one rod C, 35 mm long for both")
    assert told[1].startswith("copies 2 and 3 back to back, 10 mm between their grounds: one rod A, 25 mm long")
    assert told[1].endswith("glued into both cranks 180 deg apart")
    ends = {recipe.stack.letters[pin.name]: recipe.stack.fastener.ends(pin.length)[1] for pin in recipe.stack.pins}
    assert 5 < ends["F"] <= 7.5 and 2.5 < ends["B"] <= 5
    steps = recipe.steps[len(gk.load(LEG).steps) :]
    assert steps[0] == "3 of these on one shaft, copy 2: crank 0 deg ahead, turned over; copy 3: crank 180 deg ahead"
    assert steps[-1].startswith("hold all 3 grounds in a frame")
    # The rods are bought once each; the screws that they replace are not.
    rods = {one.name: (one.count, one.joints) for one in recipe.bought if one.name.startswith("rod")}
    assert rods == {"rod 2 mm, cut to 35 mm": (1, ("C",)), "rod 2 mm, cut to 25 mm": (1, ("A",))}


@pytest.mark.parametrize(
    ("layer", "but", "room"),
    [(0, "B", 12), (0, "C", 12), (0, "A", 12), (4, "A", 12), (4, "B", 3), (2, "A", 3), (3, "A", 12), (1, "A", 0)],
)
def test_pins_of_the_ground_have_their_nuts_below_and_all_others_above(layer, but, room):
    """M4 in sheets of 3 mm, with 0.2 mm of play: heads 2.4 mm high, nuts and screws 10 mm over 15 mm, 11 over 9."""
    spans = {"A": (0, 4), "B": (2, 4), "C": (0, 2), "D": (1, 3)}
    pins = tuple(PinSpan(name, low, high, 3.0 * (high - low + 1), (), ()) for name, (low, high) in spans.items())
    stack = gk.linkage.Stack({}, pins, (), {}, gk.linkage.LinkStock().fastener_used)
    assert _beyond(stack, 3.0, layer, but) == room


@pytest.mark.parametrize("points", [("O", "Q", "C"), ("Q", "O", "C"), ("C", "Q", "O")])
def test_a_shaft_that_another_link_turns_on_by_another_name_is_shared_all_the_same(points):
    """A six-bar whose output turns about the crank's own pivot, which it calls by a name of its own."""
    places = {"O": [0, 0], "Q": [0, 0], "C": [100, 0]}
    bodies = {
        "ground": {name: places[name] for name in points},
        "crank": {"O": [0, 0], "A": [30, 0]},
        "coupler": {"A": [0, 0], "B": [90, 0], "P": [50, 50]},
        "rocker": {"C": [0, 0], "B": [70, 0]},
        "link": {"P": [0, 0], "F": [100, 0]},
        "out": {"Q": [0, 0], "F": [90, 0]},
    }
    recipe = gk.load({
        "kind": "linkage",
        "linkage": {"driver": "crank", "bodies": bodies},
        "drive": {"step_deg": 15},
        "copies": [{"mirrored": True}, {"phase_deg": 180}],
    })  # fmt: skip
    pin = next(pin for pin in recipe.stack.pins if {"ground", "crank", "out"} <= set(pin.holes))
    letter = recipe.stack.letters[pin.name]
    assert [one.pin for one in recipe.shared] == ["", pin.name]
    told = recipe.shared[1].words
    assert "back to back" in told and f"one rod {letter}, " in told and told.endswith("both cranks 180 deg apart")
    (rod,) = (one for one in recipe.bought if one.name.startswith("rod"))
    assert rod.count == 1 and rod.joints == (letter,)


@pytest.mark.parametrize("fastener", ["screw", "rod"])
def test_copies_whose_rods_are_cut_flush_stand_on_each_other(fastener):
    text = f"{LEG}[[copies]]\nmirrored = true\n[[copies]]\n"
    stock = re.sub(r"\[stock\]", f'[stock]\nfastener = "{fastener}"', text)
    rooms = [re.search(r"([\d.]+) mm between", step) for step in gk.load(stock).steps]
    rooms = [float(found[1]) for found in rooms if found]
    assert len(rooms) == 2 and all((room == 0) == (fastener == "rod") for room in rooms)


def test_copies_lie_over_each_other_along_the_shaft(walker):
    layers = [set(), set(), set()]
    for body in walker.scene.bodies:
        layers[int(body.name.partition(", copy ")[2] or 1) - 1] |= {body.layer} if body.parts else set()
    assert max(layers[0]) < min(layers[1]) and max(layers[1]) < min(layers[2])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (LEG + "[drive]\nend_deg = 180\n[[copies]]\n", "whole turn"),
        (LEG + 24 * "[[copies]]\n", "at most 23"),
        (
            'kind = "slider-crank"\nlinkage = { crank = 30, coupler = 90, driver = "slider" }\n'
            "stroke = { start = 70, end = 110 }\n[[copies]]\n",
            "no fixed shaft",
        ),
        (
            'kind = "four-bar"\nlinkage = { ground = 100, crank = 30, coupler = 90, rocker = 70, driver = "coupler" }\n'
            "[[copies]]\n",
            "no fixed shaft",
        ),
    ],
)
def test_copies_of_what_shares_no_shaft_are_refused(text, words):
    with pytest.raises(gk.GeomkinError, match=words):
        gk.load(text)


def test_a_recipe_with_copies_reads_as_it_was_written(walker):
    assert gk.load(gk.recipe.to_toml(walker)) == walker
