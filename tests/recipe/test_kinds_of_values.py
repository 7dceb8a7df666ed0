"""Every number of every recipe, written as another kind of value: text, a truth, a list, a table."""

import copy
import json

import pytest

import geomkin as gk
from tests.hostile.mutations import good_recipes, toml

RECIPES = {name: recipe for name, recipe in good_recipes() if name.startswith("template")}
# What templates leave empty.
_CAM = {"base_radius": 40.0, "follower": {"kind": "translating-roller", "roller_radius": 8.0}}
RECIPES["chosen points"] = RECIPES["template four-bar-atlas"] | {
    "grid": RECIPES["template four-bar-atlas"]["grid"] | {"chosen": [[1, 2], [2, 3]]}
}
RECIPES["an estimate and branches"] = RECIPES["template linkage"] | {
    "linkage": RECIPES["template linkage"]["linkage"] | {"estimate": {"B": [80.0, 60.0]}},
    "branches": {"B": [80.0, 60.0]},
}
RECIPES["points between"] = {
    "kind": "disk-cam",
    "cam": _CAM
    | {
        "program": [
            {
                "kind": "polynomial", "rise": 9.0, "end_deg": 180.0, "through": [[60.0, 2.0], [90.0, 5.0]],
                "start_velocity_per_rad": 0, "start_acceleration_per_rad2": 0, "start_jerk_per_rad3": 0,
                "end_velocity_per_rad": 0, "end_acceleration_per_rad2": 0, "end_jerk_per_rad3": 0,
            },
            {"kind": "return", "law": "3-4-5", "end_deg": 360.0},
        ]
    },
}  # fmt: skip
WRONG = {"text": str, "truth": lambda value: True, "list": lambda value: [value], "table": lambda value: {"x": value}}


def places(held, path=()):
    """Paths of all numbers in a recipe; of rows of points the first two, the last and no more."""
    inner = held.items() if isinstance(held, dict) else enumerate(held) if isinstance(held, list) else ()
    for key, value in inner:
        if isinstance(key, int) and 2 <= key < len(held) - 1:
            continue
        if isinstance(value, int | float) and not isinstance(value, bool):
            yield (*path, key)
        yield from places(value, (*path, key))


def own(name):
    """Paths of the numbers that no recipe of the same kind before this one has."""
    kind, before = RECIPES[name]["kind"], set()
    for other, recipe in RECIPES.items():
        paths = {named(path): path for path in places(recipe)}
        if other == name:
            return [path for keys, path in paths.items() if keys not in before]
        if recipe["kind"] == kind:
            before |= set(paths)
    raise KeyError(name)


def named(path):
    """A path without the numbers of rows, but for whether a place in a row is the first."""
    return tuple(key if isinstance(key, str) else min(key, 1) for key in path)


def put(recipe, path, value):
    recipe = copy.deepcopy(recipe)
    held = recipe
    for key in path[:-1]:
        held = held[key]
    held[path[-1]] = value(held[path[-1]])
    return recipe


def refused(tmp_path, recipe):
    (tmp_path / "r.toml").write_text(toml(recipe))
    try:
        gk.load(tmp_path / "r.toml")
    except gk.RecipeError as error:
        return {problem.key for problem in error.problems}
    return None


@pytest.mark.parametrize("name", RECIPES)
@pytest.mark.parametrize("what", WRONG)
def test_a_number_is_a_number_wherever_it_stands(tmp_path, name, what):
    """Refused under its own key, or that of the table, row or point it stands in."""
    assert refused(tmp_path, RECIPES[name]) is None
    taken = []
    for path in own(name):
        keys = refused(tmp_path, put(RECIPES[name], path, WRONG[what]))
        first = str(path[0])
        if not keys or not all(key.split(".")[0].split("[")[0] == first for key in keys):
            taken.append((path, keys))
    assert taken == [], json.dumps([str(one) for one in taken])


@pytest.mark.parametrize("name", RECIPES)
def test_what_is_counted_is_whole_and_what_is_measured_may_be_written_so(tmp_path, name):
    """A half more than a whole number is refused where things are counted, and only there may 2.0 be."""
    for path in own(name):
        halved = refused(tmp_path, put(RECIPES[name], path, lambda value: value + 0.5))
        written = refused(tmp_path, put(RECIPES[name], path, float))
        assert written is None or halved is not None
