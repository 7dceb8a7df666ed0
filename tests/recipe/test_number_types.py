"""Numbers of a recipe are numbers as they are written: a text that reads like one, or true, is none, wherever it stands."""

import copy
import tomllib
from pathlib import Path

import pytest

import geomkin as gk
from tests.campaign import by_default

GALLERY = [tomllib.loads(file.read_text("utf-8")) for file in sorted(Path("recipes").glob("*.toml"))]


def numbers(held, path=()):
    """(path, number) of all that there are in a table."""
    items = held.items() if isinstance(held, dict) else enumerate(held) if isinstance(held, list) else ()
    for part, value in items:
        if isinstance(value, (dict, list)):
            yield from numbers(value, (*path, part))
        elif isinstance(value, (int, float)) and not isinstance(value, bool):
            yield (*path, part), value


def places():
    """A recipe's table and a path, for each key of each kind once."""
    seen = set()
    for table in GALLERY:
        for path, value in numbers(table):
            place = table["kind"], *(part if isinstance(part, str) else 0 for part in path)
            if place not in seen:
                seen.add(place)
                yield table, path, value


@pytest.mark.parametrize("written", by_default([repr, lambda value: True], [repr]))
def test_texts_and_truth_values_are_not_numbers(written):
    tried = 0
    for table, path, value in places():
        changed = copy.deepcopy(table)
        within = changed
        for part in path[:-1]:
            within = within[part]
        within[path[-1]] = written(value)
        tried += 1
        with pytest.raises(gk.RecipeError) as refusal:
            gk.load(changed)
        name = [part for part in path if isinstance(part, str)][-1]
        assert any(name in str(problem) for problem in refusal.value.problems), (path, refusal.value)
    assert tried > 250


@pytest.mark.parametrize("teeth", ["12.0", "12.5", "'12'", "true", "1e1"])
def test_a_whole_number_has_no_point(teeth):
    text = 'kind = "spur-gear"\ngear = { teeth = %s, module = 2 }\n'
    assert gk.load(text % "12").gear.teeth == 12
    with pytest.raises(gk.RecipeError, match="gear.teeth:"):
        gk.load(text % teeth)
