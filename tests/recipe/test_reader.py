"""The reader of recipes: TOML values become those of the classes, and each wrong value is refused under its own key."""

import copy
import dataclasses
import tomllib

import pytest

import geomkin as gk
from geomkin.core.errors import RecipeError
from geomkin.recipe.keys import with_values
from geomkin.recipe.load import from_table, whole_table
from geomkin.recipe.toml import without_none
from tests.gallery import FIRST_OF_KIND, RECIPES, recipe

FOUR_BAR = {
    "kind": "four-bar",
    "linkage": {"ground": 100, "crank": 30, "coupler": 90, "rocker": 70, "coupler_point": [40, 25]},
    "loads": {"forces": [{"body": "coupler", "point": [1, 2], "over_deg": [[0, 1, 2], [90, 3, 4]]}]},
}
TRAIN = tomllib.loads((RECIPES / "loaded-train.toml").read_text("utf-8"))
# A table, a key, a value that is refused there, the key under which it is refused and the kind of refusal.
REFUSED = [
    (FOUR_BAR, "linkage.crank", True, "linkage.crank", "wrong-type"),
    (FOUR_BAR, "linkage.crank", "30", "linkage.crank", "wrong-type"),
    (FOUR_BAR, "linkage.crank", [30], "linkage.crank", "wrong-type"),
    (FOUR_BAR, "linkage.crank", [float("nan"), 0], "linkage.crank", "wrong-type"),
    (FOUR_BAR, "linkage.crank", -30, "linkage.crank", "out-of-range"),
    (FOUR_BAR, "linkage.crank", float("nan"), "linkage.crank", "not-finite"),
    (FOUR_BAR, "linkage.crank", 1e30, "linkage.crank", "out-of-range"),
    (FOUR_BAR, "linkage.coupler_point", [1], "linkage.coupler_point[1]", "missing-key"),
    (FOUR_BAR, "linkage.coupler_point", [1, 2, 3], "linkage.coupler_point", "wrong-type"),
    (FOUR_BAR, "linkage.coupler_point", [1, 1e12], "linkage.coupler_point[1]", "out-of-range"),
    (FOUR_BAR, "linkage.coupler_point", [1, "2"], "linkage.coupler_point[1]", "wrong-type"),
    (FOUR_BAR, "linkage.driver", "krank", "linkage.driver", "out-of-range"),
    (FOUR_BAR, "branch", True, "branch", "out-of-range"),
    (FOUR_BAR, "branch", 1.0, "branch", "out-of-range"),
    (FOUR_BAR, "branches", {"rocker_pin": 2}, "branches.rocker_pin", "wrong-type"),
    (FOUR_BAR, "coefficients", 1, "coefficients", "wrong-type"),
    (FOUR_BAR, "loads.forces[0].over_deg[1]", [90, 3], "loads.forces[0].over_deg[1][2]", "missing-key"),
    (FOUR_BAR, "loads.forces[0].over_deg[1][2]", 10**30, "loads.forces[0].over_deg[1][2]", "out-of-range"),
    (FOUR_BAR, "linkage.origin", [10**400, 0], "linkage.origin[0]", "out-of-range"),
    (FOUR_BAR, "loads.forces[0].point", 3, "loads.forces[0].point", "wrong-type"),
    (FOUR_BAR, "loads.forces", 3, "loads.forces", "wrong-type"),
    (FOUR_BAR, "files.write", ["dxf", "dfx"], "files.write[1]", "out-of-range"),
    (FOUR_BAR, "stock", 3, "stock", "wrong-type"),
    (FOUR_BAR, "expected_failures", {"deviation\ue000": "x"}, "expected_failures", "out-of-range"),
    (FOUR_BAR, "loads.masses", {"crank\u3164": {"mass_kg": 1}}, "loads.masses", "out-of-range"),
    (FOUR_BAR, "stock.material", {"name": "oak\u200b", "density": 700}, "stock.material.name", "out-of-range"),
    (FOUR_BAR, "stock.material", {"name": "", "density": 700}, "stock.material.name", "out-of-range"),
    (FOUR_BAR, "stock.attachments", [{"name": " ", "body": "rocker"}], "stock.attachments[0].name", "out-of-range"),
    (
        FOUR_BAR,
        "loads.motors",
        [{"name": "", "torque_n_mm": 1, "speed_rpm": 1, "lasting_torque_n_mm": 1, "mass_g": 1}],
        "loads.motors[0].name",
        "out-of-range",
    ),
    (
        FOUR_BAR,
        "loads.actuator",
        {"name": "", "force_n": 9, "no_load_speed": 9, "full_load_speed": 9, "stroke": 9},
        "loads.actuator.name",
        "out-of-range",
    ),
    (FOUR_BAR, "loads.masses", {"": {"mass_kg": 1}}, "loads.masses", "out-of-range"),
    (FOUR_BAR, "loads.forces[0].body", "", "loads.forces[0].body", "out-of-range"),
    (FOUR_BAR, "expected_failures", {"undercut": ""}, "expected_failures.undercut", "out-of-range"),
    (TRAIN, "kind", ["gear-train"], "kind", "unknown-kind"),
    (TRAIN, "train.stages[0][1]", 7.5, "train.stages[0][1]", "wrong-type"),
    (TRAIN, "train.stages[0][1]", 3, "train.stages[0][1]", "out-of-range"),
]


@pytest.mark.parametrize(("table", "key", "value", "at", "id"), REFUSED, ids=map(str, range(len(REFUSED))))
def test_a_wrong_value_is_refused_under_its_key(table, key, value, at, id):
    with pytest.raises(RecipeError) as refused:
        from_table(with_values(table, {key: value}))
    assert [(problem.key, problem.id) for problem in refused.value.problems] == [(at, id)]


def test_all_problems_are_listed_in_the_order_of_the_template():
    table = copy.deepcopy(FOUR_BAR)
    table["linkage"] |= {"crank": 0, "crnk": 1}
    table["files"] = {"tolerance": "x", "write": 3}
    del table["linkage"]["ground"]
    with pytest.raises(RecipeError) as refused:
        from_table(table)
    keys = [problem.key for problem in refused.value.problems]
    assert keys == ["linkage.ground", "linkage.crank", "linkage.crnk", "files.write", "files.tolerance"]


@pytest.mark.parametrize("kind", FIRST_OF_KIND)
def test_a_recipe_is_read_back_from_its_table(kind):
    made = recipe(FIRST_OF_KIND[kind])
    table = whole_table(made)
    assert from_table(without_none(table), made.name, str(RECIPES)) == made

    def values(thing):
        if isinstance(thing, dict | list):
            return [v for item in (thing.values() if isinstance(thing, dict) else thing) for v in values(item)]
        return [thing]

    # As JSON and TOML have them.
    assert {type(value) for value in values(table)} <= {str, int, float, bool, type(None)}


def test_rows_have_the_same_limits_in_python_and_in_a_recipe():
    wanted = recipe("five-poses").wanted
    poses = ((1e12, 0.0, 0.0), *wanted.poses[1:])
    with pytest.raises(gk.DesignError) as refused:
        dataclasses.replace(wanted, poses=poses)
    assert refused.value.field == "poses[0][0]"


@pytest.mark.parametrize(
    ("name", "key", "is_covered"),
    [
        ("loaded-train", "efficiency", True), ("loaded-train", "train.efficiencies", True),
        ("gear-pair", "efficiency", True), ("rack-and-pinion", "efficiency", False),
    ],
)  # fmt: skip
def test_an_unknown_key_names_the_key_that_covers_its_topic_if_there_is_one(name, key, is_covered):
    """The efficiency of gears follows from their friction."""
    table = tomllib.loads((RECIPES / f"{name}.toml").read_text("utf-8"))
    outer, _, inner = key.rpartition(".")
    (table[outer] if outer else table)[inner] = 0.9
    with pytest.raises(RecipeError) as refused:
        from_table(table)
    (problem,) = refused.value.problems
    words = f"{problem.problem}; {problem.remedy.partition('known here')[0]}"
    assert problem.key == key and ("friction" in words.replace("friction and wear", "")) == is_covered


@pytest.mark.parametrize("is_written", [False, True])
@pytest.mark.parametrize(
    ("table", "key", "value"),
    [
        ({"kind": "geneva", "geneva": {"distance": 10, "slots": 12, "roller": 2}}, "geneva.tip_width", 2.0),
        (
            {"kind": "ratchet", "ratchet": {"diameter": 80, "teeth": 24, "pawl_length": 60, "pawl_width": 40}},
            "stock.spring",
            20.0,
        ),
    ],
)
def test_a_value_that_nobody_wrote_is_named_as_the_default(table, key, value, is_written):
    outer, _, inner = key.partition(".")
    written = {**table, outer: {**table.get(outer, {}), **({inner: value} if is_written else {})}}
    with pytest.raises(RecipeError) as refused:
        from_table(written)
    (problem,) = refused.value.problems
    assert problem.key == key and f"{value:g}" in problem.problem and ("default" in problem.problem) != is_written


@pytest.mark.parametrize(
    ("change", "key", "advised", "not_advised"),
    [
        ({"linkages": {"crank": 1}}, "linkages", "linkage?", "[tolerances]"),
        ({"loads": {"mass_lb": 1}}, "loads.mass_lb", "carried", "under [["),
        ({"loads": {"carried": [{"mass_lb": 1}]}}, "loads.carried[0].mass_lb", "mass_kg", "under ["),
        ({"scales": 2}, "scales", "scale", "under ["),
    ],
)
def test_unknown_key_is_not_sent_where_it_stands_or_does_not_belong(change, key, advised, not_advised):
    with pytest.raises(RecipeError) as refused:
        gk.load(FOUR_BAR | change)
    (remedy,) = (problem.remedy for problem in refused.value.problems if problem.key == key)
    assert advised in remedy and not_advised not in remedy
