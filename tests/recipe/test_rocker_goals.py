"""Recipes of a swing, of two rockers and of a stroke: what is made, reported and refused."""

import json
from pathlib import Path

import pytest

import geomkin as gk

RECIPES = Path(__file__).parent.parent.parent / "recipes"
SWING = {"kind": "crank-rocker-synthesis", "wanted": {"swing_deg": 50, "crank_turn_deg": 200, "ground": 100}}
SWINGS = {
    "kind": "double-rocker-synthesis",
    "wanted": {
        "crank_start_deg": 60,
        "crank_swing_deg": 60,
        "rocker_start_deg": 80,
        "rocker_swing_deg": 40,
        "ground": 100,
    },
}
STROKE = {"kind": "slider-crank-stroke", "wanted": {"stroke": 80, "time_ratio": 1.2}}


def changed(recipe, **wanted):
    """The recipe with other wishes; None leaves one out."""
    data = recipe["wanted"] | wanted
    return recipe | {"wanted": {key: value for key, value in data.items() if value is not None}}


@pytest.mark.parametrize(("name", "links"), [("pump-stroke", 4), pytest.param("wiper", 5, marks=pytest.mark.campaign)])
def test_gallery_goal_is_made_and_its_found_recipe_runs(tmp_path, name, links):
    goal = gk.load(RECIPES / f"{name}.toml")
    made = gk.make(goal, tmp_path)
    assert all(check.passed for check in made.checks)
    assert len([file for file in made.files if file.suffix == ".stl"]) == links
    data = json.loads((tmp_path / name / "summary.json").read_text())
    assert data["number_found"] == len(goal.ranked) and data["ranked"][0] == data["found"]
    assert data["found"]["defects"] == [] and len(data["family"]["free_angle_deg"]) == 2
    angles = [(one.get("overshoot_deg", 0) > 1e-6, -one["transmission_angle_deg"]) for one in data["ranked"]]
    assert len(angles) > 5 and angles == sorted(angles)
    found = gk.load(tmp_path / name / f"{name}.found.toml")
    assert found == goal.design
    again = gk.make(found, tmp_path)
    assert all(check.passed for check in again.checks)
    for file in (tmp_path / name).glob("*.stl"):
        # The header states the recipe.
        assert file.read_bytes()[80:] == (tmp_path / f"{name}.found" / file.name).read_bytes()[80:]


def test_another_of_the_family_is_chosen_by_its_rank_or_its_place():
    recipe = gk.load(SWING)
    third = gk.load(SWING | {"choose": 3})
    assert third.found.linkage == third.design.linkage != recipe.design.linkage
    assert third.found.lengths == pytest.approx(recipe.ranked[2].lengths, abs=1e-4)
    assert all(check.passed for check in third.design_checks[:3])
    placed = gk.load(changed(SWING, free_angle_deg=30))
    assert placed.found.free_angle_deg == pytest.approx(30) and len(placed.ranked) == 1
    assert gk.load(changed(SWINGS, crank=40)).found.linkage.crank == 40
    assert gk.load(changed(SWINGS, rocker=60)).found.linkage.rocker == 60
    assert gk.load(changed(STROKE, crank=38)).found.linkage.crank == 38
    assert gk.load(changed(STROKE, coupler=120)).found.linkage.coupler == 120


@pytest.mark.parametrize(
    ("goal", "size"),
    [(SWINGS, {"crank": 40}), (SWINGS, {"rocker": 60}), (STROKE, {"crank": 38}), (STROKE, {"offset": -9})],
)
def test_a_member_is_the_same_by_its_size_and_by_its_free_angle(goal, size):
    by_size = gk.load(changed(goal, **size))
    angle = by_size.found.free_angle_deg
    by_angle = gk.load(changed(goal, free_angle_deg=angle))
    assert by_angle.ranked[0].lengths == pytest.approx(by_size.ranked[0].lengths, rel=1e-9)
    # Where a member is given by its size, the key of the free angle takes its place.
    (name,) = size
    assert by_size.choice.instead_of == (f"wanted.{name}",) and not by_angle.choice.instead_of
    with pytest.raises(gk.DesignError) as refused:
        gk.load(changed(goal, free_angle_deg=angle, **size)).ranked
    assert refused.value.id == "conflict"


def test_a_branch_defect_is_a_check_that_fails_and_is_reported():
    wish = {"crank_start_deg": 30, "crank_swing_deg": 100, "rocker_start_deg": 120, "rocker_swing_deg": -60}
    recipe = gk.load(changed(SWINGS, **wish))
    assert {"defects", "missed swing"} <= {check.name for check in recipe.design_checks if not check.passed}
    assert recipe.notes["found"]["defects"] == ["circuit"]


def test_invalid_goals_are_refused_by_key(tmp_path):
    for recipe, text in [
        (
            changed(SWING, swing_deg=45, crank_turn_deg=100),
            "wanted.crank_turn_deg: found 100 deg, which no crank-rocker",
        ),
        (
            changed(SWING, swing_deg=45, crank_turn_deg=None, time_ratio=0.3),
            "wanted.time_ratio: found 0.3, which no crank-rocker.*give 0.4548[0-9]* to 4.32",
        ),
        (changed(SWING, time_ratio=1.1), "wanted.time_ratio: is given together with crank_turn_deg"),
        (changed(SWING, ground=None), "wanted.ground: no length is given; give one of"),
        (changed(SWING, crank=30), "wanted.crank: is given together with ground"),
        (changed(SWING, largest_ratio=2.0), "wanted.largest_ratio: found 2, but"),
        (changed(SWING, free_angle_deg=1.0), "wanted.free_angle_deg: found 1; give more than"),
        (SWING | {"choose": 30}, "choose: found 30; give at most"),
        (changed(SWINGS, crank_swing_deg=0), "wanted.crank_swing_deg: found 0 deg; give at least 0.1 deg"),
        (changed(SWINGS, crank=40, rocker=60), "wanted.rocker: is given together with crank"),
        (changed(SWINGS, rocker_start_deg=-60, crank_start_deg=-30, rocker_swing_deg=120), "mirror each other"),
        (
            changed(STROKE, time_ratio=3.5),
            "wanted.time_ratio: found 3.5, which no slider-crank has; give 0.33358[0-9]* to 2.9977",
        ),
        (changed(STROKE, time_ratio=None, crank_turn_deg=80), "wanted.crank_turn_deg: found 80 deg"),
        (changed(STROKE, crank=45), "wanted.crank: found 45 mm, which no such slider-crank has; give more than"),
        (changed(STROKE, crank=38, offset=4), "wanted.crank: is given together with offset"),
    ]:
        with pytest.raises(gk.RecipeError, match=text):
            gk.make(recipe, tmp_path)
