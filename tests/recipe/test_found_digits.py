"""Linkages that goals found are written in short decimal numbers, and what is reported is true of these."""

import dataclasses
import tomllib
from functools import cache

import numpy as np
import pytest

import geomkin as gk
from geomkin.recipe import to_toml
from tests.campaign import by_default
from tests.recipe.test_rocker_goals import STROKE, SWING, SWINGS, changed

POSES = {"kind": "body-guidance", "wanted": {"poses": [[0, 0, 0], [40, 20, 30], [60, 60, 80]]}}
FUNCTION = {"kind": "function-generator", "wanted": {"function": "x**1.5", "x_start": 1, "x_end": 3, "input_deg": 90}}
PLACE = {
    "kind": "slider-function-generator",
    "wanted": {"function": "x**1.5", "x_start": 1, "x_end": 3, "input_deg": -90, "output_mm": 40},
}
PATH = {
    "kind": "path-generator",
    "wanted": {"points": [[30, 30], [27.59, 33.63], [23.72, 36.63], [18.9, 38.62], [13.55, 39.43]], "step_deg": 15},
    "bounds": {"origin_x": [0, 0], "origin_y": [0, 0]},
    "limits": {"least_transmission_angle_deg": 50},
    "search": {"time_limit": 300},
}
GOALS = {
    "swing": SWING,
    "swings": SWINGS,
    "stroke": STROKE,
    "poses": POSES,
    "slide": {**POSES, "wanted": {**POSES["wanted"], "type": "slider-crank"}},
    "trammel": {**POSES, "wanted": {**POSES["wanted"], "type": "elliptic-trammel"}},
    "function": FUNCTION,
    "place": PLACE,
    "path": PATH,
}


@cache
def goal_of(name):
    return gk.load(GOALS[name])


def numbers(table):
    for value in table.values() if isinstance(table, dict) else table:
        if isinstance(value, dict | list):
            yield from numbers(value)
        elif isinstance(value, int | float):
            yield value


@pytest.mark.parametrize("name", by_default(GOALS, ["swing", "poses"]))
def test_found_recipes_have_short_numbers_within_a_millionth(name):
    goal = goal_of(name)
    table = tomllib.loads(to_toml(goal.design))
    # A step of a stroke is a share of it.
    table.get("stroke", {}).pop("step", None)
    assert max(len(f"{abs(value)!r}".replace(".", "").strip("0")) for value in numbers(table)) <= 9
    exact, found = goal.ranked[0], goal.found
    assert found.lengths == pytest.approx(exact.lengths, rel=0, abs=1e-6 * exact.size)
    assert found.linkage.origin == pytest.approx(exact.linkage.origin, abs=2e-6 * exact.size)
    assert found.linkage.ground_angle_deg == pytest.approx(exact.linkage.ground_angle_deg, abs=1e-4)
    assert found.linkage == goal.design.linkage
    assert gk.load(to_toml(goal.design)) == goal.design


OUTPUTS = {"swing": "rocker", "swings": "rocker", "stroke": "slider"}


@pytest.mark.parametrize("name", by_default(OUTPUTS, ["swing"]))
def test_reported_swings_are_those_of_the_rounded_linkage(name):
    """Moved, and looked at in many frames, as the file has it."""
    goal = goal_of(name)
    design = gk.load(to_toml(goal.design))
    low, high = np.radians(goal.range_of(goal.found))
    motion = gk.move(design.linkage, np.linspace(low, high, 20_001), design.branch)
    if OUTPUTS[name] == "rocker":
        swing = np.degrees(np.ptp(np.unwrap(np.angle(motion.bodies["rocker"].direction))))
        reported = goal.found.swing_deg if name == "swing" else abs(goal.found.rocker_swing_deg)
    else:
        swing, reported = np.ptp(motion.bodies["slider"].origin.position.real), goal.found.stroke
    assert reported == pytest.approx(swing, rel=1e-8)
    least = np.degrees(gk.least_transmission_angle(motion))
    assert goal.found.transmission_angle_deg == pytest.approx(least, abs=1e-5)


@pytest.mark.parametrize("name", by_default(["poses", "slide", "trammel"], ["poses"]))
def test_reported_errors_of_poses_are_those_of_the_rounded_linkage(name):
    goal = goal_of(name)
    point = "rod_point" if name == "trammel" else "coupler_point"
    motion = gk.move(goal.design.linkage, goal.found.drive, goal.found.branch)
    off = np.abs(motion.point(point).position - [complex(x, y) for x, y, _ in goal.wanted.poses])
    assert 1e-9 < goal.found.pose_error == pytest.approx(off.max(), rel=1e-6)
    assert goal.found.pose_error < 1e-5 * np.max(np.abs(goal.seen))


@pytest.mark.campaign
@pytest.mark.parametrize(("name", "unit"), [("function", "deg"), ("place", "mm")])
def test_reported_errors_of_a_function_are_those_of_the_rounded_linkage(name, unit):
    goal = goal_of(name)
    fine = dataclasses.replace(goal, drive=dataclasses.replace(goal.drive, step_deg=0.02))
    largest = goal.found.summary()[f"largest_error_{unit}"]
    assert largest == pytest.approx(np.abs(fine.table.to_columns()[f"error_{unit}"]).max(), rel=1e-5)


@pytest.mark.campaign
def test_reported_errors_of_a_path_are_those_of_the_rounded_linkage():
    goal = goal_of("path")
    motion = gk.move(goal.design.linkage, goal.found.drive, goal.found.branch)
    off = np.abs(motion.point("coupler_point").position - goal.wanted.places)
    assert goal.found.largest_distance == pytest.approx(off.max(), rel=1e-9)
    assert goal.found.square_error == pytest.approx(np.sum(off**2), rel=1e-9)


@pytest.mark.campaign
def test_limits_that_a_search_stands_on_are_kept_by_the_rounded_linkage():
    path, function = goal_of("path"), goal_of("function")
    assert path.ranked[0].at_limits and 50 - 1e-9 <= path.found.transmission_angle_deg < 50.001
    assert function.found.transmission_angle_deg >= 40 - 1e-9


@pytest.mark.parametrize("largest", [3.3, 4.0, 5.7, 10 / 3])
def test_a_largest_ratio_is_kept_by_the_rounded_linkage(largest):
    goal = gk.load(changed(SWING, crank_turn_deg=180, ground=None, crank=30, largest_ratio=largest))
    assert goal.found.ratio == pytest.approx(largest, rel=1e-5) and goal.found.ratio <= largest * (1 + 1e-9)
    assert all(check.passed for check in goal.met)
