"""The JSON Schema as an editor uses it: good recipes are good, and one wrong key is marked and nothing else."""

import copy
import re
import tomllib

import pytest
from jsonschema import Draft202012Validator

from geomkin.recipe.kinds import KINDS
from tests.campaign import by_default
from tests.texts import schema_of_all, template_of


@pytest.fixture(scope="module")
def marks():
    """marks(recipe): place and message of everything an editor would mark."""
    whole = schema_of_all()
    Draft202012Validator.check_schema(whole)
    validator = Draft202012Validator(whole)
    return lambda recipe: [(tuple(e.absolute_path), e.message) for e in validator.iter_errors(recipe)]


def opened(name):
    """The template with every key that has a value, also those that stand commented out."""
    lines = [re.sub(r"^# (?=\w+ += *[^# ])", "", line) for line in template_of(name).splitlines()]
    return tomllib.loads("\n".join(lines))


def leaves(value, path=()):
    """Places of all values that are no tables."""
    if isinstance(value, dict):
        return [leaf for key, inner in value.items() for leaf in leaves(inner, (*path, key))]
    if isinstance(value, list) and value and isinstance(value[0], dict):
        return [leaf for k, inner in enumerate(value) for leaf in leaves(inner, (*path, k))]
    return [path]


def with_value(recipe, path, value):
    spoiled = copy.deepcopy(recipe)
    table = spoiled
    for part in path[:-1]:
        table = table[part]
    table[path[-1]] = value
    return spoiled


@pytest.mark.parametrize("name", by_default(KINDS, ["fit-test"]))
def test_a_wrong_key_or_value_is_marked_at_its_own_place_alone(marks, name):
    recipe = opened(name)
    assert marks(recipe) == []
    for path in leaves(recipe):
        found = marks(with_value(recipe, path, {"no": "such"}))
        # A table under a name that a person chooses is marked at what it holds.
        assert found and {place[: len(path)] for place, _ in found} == {path}, (path, found)
        unknown = marks(with_value(recipe, (*path[:-1], "unheard_of"), 1))
        free = path[:2] == ("linkage", "bodies")  # names there are a person's own, and a number is no point
        place = (*path[:-1], "unheard_of") if free else path[:-1]
        assert [p for p, _ in unknown] == [place], (path, unknown)


CAM = opened("disk-cam")
TRAIN = {"kind": "gear-train", "train": {"module": 2, "stages": [[12, 40]]}}
LEVER = {"kind": "linkage", "linkage": {"bodies": {"ground": {"A": [0, 0]}}, "driver": "arm"}, "branches": {"A": -1}}


def test_inside_followers_segments_and_lists_too(marks):
    for path, value in [
        (("kind",), "disc-cam"),
        (("cam", "follower", "kind"), "roller"),
        (("cam", "follower", "roller_radius"), "3 mm"),
        (("cam", "program", 1, "law"), "cyclic"),
        (("cam", "program", 1, "kind"), "lift"),
        (("cam", "program", 2, "end_deg"), 361),
        (("stock", "bore"), -1),
        (("files", "write", 1), "dfx"),
    ]:
        assert [place for place, _ in marks(with_value(CAM, path, value))] == [path]


@pytest.mark.parametrize(
    ("recipe", "path", "value"),
    [
        (TRAIN, ("train", "stages", 0, 1), 3),
        (LEVER, ("linkage", "bodies", "ground", "A", 1), 1e12),
        (LEVER, ("branches", "A"), 2),
    ],
)
def test_limits_inside_rows_and_under_names_are_marked(marks, recipe, path, value):
    assert marks(recipe) == []
    assert [place for place, _ in marks(with_value(recipe, path, value))] == [path]
