"""Advice that names a value: with the value the check passes, and the recipe is accepted."""

import dataclasses
import tomllib
from pathlib import Path

import pytest

import geomkin as gk
from geomkin.build import errors_named_by_key
from geomkin.recipe.keys import varied, with_values
from geomkin.recipe.kinds import kind_names
from geomkin.recipe.load import plain_table, shown_numbers
from geomkin.recipe.shown import ShownRecipe
from tests.gallery import RECIPES
from tests.texts import template_of

CASES = Path(__file__).parents[1] / "cases"
BARS = {"kind": "four-bar", "linkage": {"ground": 100, "crank": 30, "coupler": 90, "rocker": 70}}
STEEL = {"thickness": 4, "material": "steel-C45"}
RISE = [
    {"kind": "rise", "law": "cycloidal", "rise": 17.3, "end_deg": 100},
    {"kind": "return", "law": "cycloidal", "end_deg": 211},
    {"kind": "dwell", "end_deg": 360},
]
SWING = [
    {"kind": "rise", "law": "cycloidal", "rise_deg": 17.3, "end_deg": 100},
    {"kind": "return", "law": "cycloidal", "end_deg": 211},
    {"kind": "dwell", "end_deg": 360},
]
ROLLER = {"kind": "translating-roller", "roller_radius": 8}
ARM = {"kind": "oscillating-roller", "roller_radius": 8, "pivot_distance": 100, "arm_length": 80}


def cam(follower, program, speed):
    return {
        "kind": "disk-cam",
        "cam": {"base_radius": 41.7, "follower": follower, "program": program},
        "drive": {"speed_rpm": speed},
        "loads": {"follower": {"mass_kg": 0.173, **({"inertia_kg_mm2": 300} if follower is ARM else {})}},
    }


def gears(kind, load, *stocks):
    return {**varied(gk.load(template_of(kind)))[0].recipe, "loads": load, **dict.fromkeys(stocks, STEEL)}


# Recipes with a check that fails, and the ids of the checks that suggest values.
FAILING = {
    "tolerances": (lambda: CASES / "rounded-advice.toml", {"deviation"}),
    "tolerance of an angle": (
        lambda: BARS | {"tolerances": {"of": "rocker_angle", "tolerance": 0.37, "clearance": 0.013, "limit": 0.29}},
        {"deviation"},
    ),
    "driver in radians": (lambda: BARS | {"drive": {"start_deg": 1, "end_deg": 7.283}}, {"driver_range"}),
    "motor": (
        lambda: BARS
        | {
            "stock": {"thickness": 5},
            "loads": {"motor": "28byj-48", "forces": [{"body": "rocker", "point": "rocker_pin", "force_n": [3, 0]}]},
        },
        {"motor_torque"},
    ),
    "counterbalance": (lambda: template_of("shaking-force").replace("counterbalance = 35", "counterbalance = 1"), {"force_to_best"}),
    "straight follower": (lambda: cam(ROLLER, RISE, 731), {"follower_contact"}),
    "arm": (lambda: cam(ARM, SWING, 731), {"follower_contact"}),
    "gear pair": (lambda: gears("gear-pair", {"torque_n_mm": 777777}, "first_stock", "second_stock"), {"first_root_safety", "contact_safety"}),
    "rack": (lambda: gears("rack-and-pinion", {"force_n": 77777}, "stock"), {"contact_safety"}),
    "train": (lambda: gears("gear-train", {"output_torque_n_mm": 7777777}, "stock"), {"stage_1_contact_safety"}),
}  # fmt: skip


def failed(recipe):
    """Failed checks with suggestions, by id, in the recipe's unit."""
    return {check.id: check for check in ShownRecipe(recipe).checks if check.suggestions and not check.passed}


@pytest.mark.parametrize("units", ["mm", "in"])
@pytest.mark.parametrize("name", FAILING)
def test_a_check_passes_with_each_value_that_it_suggests(name, units):
    make, ids = FAILING[name]
    recipe = dataclasses.replace(gk.load(make()), units=units)
    if units == "in" and name == "tolerances":
        # The limit of a point's deviation is in the unit of its column.
        limit = recipe.tolerances.limit / 25.4
        recipe = dataclasses.replace(recipe, tolerances=dataclasses.replace(recipe.tolerances, limit=limit))
    source, _ = varied(recipe)
    checks = failed(recipe)
    assert ids <= set(checks)
    for id in ids:
        for suggestion in checks[id].suggestions:
            again = {check.id: check for check in source.opened(suggestion.values).checks}
            assert id not in again or again[id].passed, (suggestion, again[id])


def walker_that_tips():
    table = tomllib.loads((RECIPES / "motor-walker.toml").read_text())
    return with_values(table, {"loads.carried": [{"mass_kg": 2, "along": 100, "across": 20}]})


@pytest.mark.parametrize("units", ["mm", "in"])
@pytest.mark.parametrize("name", ["straight follower", "arm", "counterbalance", "tolerance of an angle", "walker"])
def test_a_check_of_a_scaled_recipe_passes_with_each_value_that_is_written_into_it(name, units):
    """Which its key `scale` multiplies again."""
    make, ids = (walker_that_tips, {"support_margin"}) if name == "walker" else FAILING[name]
    made = make()
    table = (tomllib.loads(made) if isinstance(made, str) else made) | {"scale": 1.7}
    if units == "in":
        table = plain_table(dataclasses.replace(gk.load(table | {"scale": 1}), units="in")) | {"scale": 1.7}
    checks = failed(gk.load(table))
    assert ids <= set(checks)
    for id in ids:
        for suggestion in checks[id].suggestions:
            again = {check.id: check for check in gk.load(with_values(table, suggestion.values)).checks}
            assert id not in again or again[id].passed, (suggestion, again[id])


def test_suggestions_of_a_scaled_mechanism_in_a_machine_are_those_to_write():
    scaled = cam(ROLLER, RISE, 731) | {"scale": 1.7}
    other = {"recipe": BARS, "turned_by": "lifter.cam"}
    table = {
        "kind": "machine",
        "drive": {"speed_rpm": 731},
        "mechanisms": {"lifter": {"recipe": scaled}, "other": other},
    }
    check = failed(gk.load(table))["lifter_follower_contact"]
    for suggestion in check.suggestions:
        again = gk.load(with_values(table, suggestion.values)).checks
        assert next(c for c in again if c.id == check.id).passed


def test_suggestions_of_a_mechanism_in_a_machine_have_the_keys_of_the_machine():
    slow = {"of": "rocker_angle", "tolerance": 0.37, "clearance": 0.013, "limit": 0.29}
    mechanisms = {
        "wiper": {"recipe": BARS | {"tolerances": slow}},
        "other": {"recipe": BARS, "turned_by": "wiper.crank"},
    }
    recipe = gk.load({"kind": "machine", "mechanisms": mechanisms})
    (check,) = failed(recipe).values()
    (suggestion,) = check.suggestions
    assert set(suggestion.values) == {"mechanisms.wiper.recipe.tolerances.tolerance"}
    again = varied(recipe)[0].opened(suggestion.values)
    assert next(c for c in again.checks if c.id == check.id).passed


def refusal(source, changes):
    """The first problem of a recipe with these changes; None if it is accepted."""
    try:
        source.opened(changes)
    except gk.RecipeError as error:
        return error.problems[0]
    except gk.DesignError as error:
        return error.as_problem
    return None


def check_refusals(recipe, factors):
    source, _ = varied(recipe)
    for number in shown_numbers(recipe):
        for factor in factors:
            wrong = {number.key: type(number.value)(number.value * factor)}
            problem = refusal(source, wrong)
            if problem is not None and problem.value is not None:
                again = refusal(source, wrong | {problem.key: problem.value})
                assert again is None or again.key != problem.key, (problem, again)


@pytest.mark.parametrize("kind", kind_names())
def test_a_recipe_with_the_value_named_by_its_refusal_is_accepted(kind):
    check_refusals(gk.load(template_of(kind)), [4])


@pytest.mark.campaign
@pytest.mark.parametrize("kind", kind_names())
@pytest.mark.parametrize("units", ["mm", "in"])
def test_values_named_by_refusals_are_accepted_for_many_changes(kind, units):
    recipe = gk.load(template_of(kind))
    if kind != "machine":
        recipe = dataclasses.replace(recipe, units=units)
    check_refusals(recipe, [4, 30, 1.5, 0.2, 0.03, 0, -1])


# Limits with more digits than a message shows.
REFUSED = [
    ({"kind": "slider-crank", "linkage": {"crank": 30.123912345, "coupler": 90.98779654321, "offset": 500}}, "linkage.offset"),
    ({"kind": "shaper", "linkage": {"ground": 100.12391234567, "crank": 300, "lever": 250, "link": 60, "ram_height": 85}}, "linkage.crank"),
    ({"kind": "four-bar", "linkage": {"ground": 300.3, "crank": 30.123456789, "coupler": 90.98765432199, "rocker": 70.1234567}}, "linkage.ground"),
    ({"kind": "inverted-slider-crank", "linkage": {"ground": 100.12391234567, "crank": 30.98779654321, "offset": 333}}, "linkage.offset"),
    ({"kind": "spur-gear", "gear": {"teeth": 24, "module": 1.234567891}, "stock": {"bore": 333}}, "stock.bore"),
    ({"kind": "spur-gear", "gear": {"teeth": 24, "module": 1.234567891}, "stock": {"bore": 5, "bore_form": "D", "flat": 2}}, "stock.flat"),
    ({"kind": "disk-cam", "cam": {"base_radius": 41.1234567891, "follower": ROLLER | {"offset": 77}, "program": RISE}}, "cam.follower.offset"),
    ({"kind": "four-bar", **{k: v for k, v in BARS.items() if k != "kind"}, "drive": {"step_deg": 1e-3}}, "drive.step_deg"),
]  # fmt: skip


@pytest.mark.parametrize("units", ["mm", "in"])
@pytest.mark.parametrize(("table", "key"), REFUSED, ids=[f"{table['kind']} {key}" for table, key in REFUSED])
def test_a_limit_is_rounded_to_the_side_that_is_allowed(table, key, units):
    source, _ = varied(table | {"units": units})

    def problem_of(changes):
        try:
            recipe = source.opened(changes)
            with errors_named_by_key("recipe", recipe):
                _ = recipe.checks
        except gk.RecipeError as error:
            return error.problems[0]
        return None

    problem = problem_of({})
    assert problem.key == key and problem.value is not None
    assert problem_of({key: problem.value}) is None
