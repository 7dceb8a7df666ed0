"""The visitor of fields: the same numbers in a recipe and in its table, and copies with some of them changed."""

import dataclasses
import tomllib
from typing import Literal

import pytest

import geomkin as gk
from geomkin.core.field_visitor import fields_of, key_parts, numbers_in, with_number, with_numbers
from geomkin.core.fields import ComplexPoint, Rows, entry, quantity
from geomkin.core.records import record
from geomkin.recipe.load import whole_table
from tests.gallery import RECIPES, recipe

# Motion programmes, rows, named points, signs of joints, springs and recipes in a recipe.
NAMES = ["roller-cam", "walking-leg", "loaded-crank-rocker", "five-poses", "kidney-path", "geared-legs"]


@record
class Hinge:
    at: ComplexPoint = entry("place, [x, y] in mm", default=3 + 4j)
    play_mm: float = quantity("play", "mm", default=0.5)


@record
class Frame:
    width: float = quantity("width", "mm", default=10.0)
    mass: float = quantity("mass", "kg", default=2.0)
    path: Rows = entry("x and angle", default=((1.0, 90.0), (2.0, 45.0)), units=("mm", "deg"))
    side: Literal[1, -1] | complex = entry("1, -1 or [x, y]", default=1)
    hinges: tuple[Hinge, ...] = entry("hinges", default=(Hinge(), Hinge(5j)))
    named: dict[str, Hinge] = entry("hinges by name", default_factory=lambda: {"top": Hinge()})


def at(table, key):
    for part in key_parts(key):
        table = table[part]
    return table


@pytest.mark.parametrize("name", NAMES)
def test_a_recipe_and_its_table_have_the_same_numbers(name):
    numbers = {n.key: (n.field, n.value, n.unit) for n in numbers_in(recipe(name))}
    table, seen = whole_table(recipe(name)), {}

    def note(number):
        seen[number.key] = (number.field, number.value, number.unit)
        return number.value

    kept = with_numbers(table, note, lambda inner, key: inner, type(recipe(name)))
    assert kept is table
    # A material or a motor of the library is a name in the table, and a recipe in a recipe is read by itself.
    assert seen and seen.items() <= numbers.items()
    assert {key for key in numbers if key not in seen} == {
        key for key in numbers if ".recipe." in key or isinstance(at(table, key.rpartition(".")[0]), str)
    }


def test_every_shape_of_field_is_visited_with_its_unit():
    units = {n.key: n.unit for n in numbers_in(Frame())}
    assert units == {
        "width": "mm", "mass": "kg", "path[0][0]": "mm", "path[0][1]": "deg", "path[1][0]": "mm", "path[1][1]": "deg",
        "side": "", "hinges[0].at[0]": "mm", "hinges[0].at[1]": "mm", "hinges[0].play_mm": "mm", "hinges[1].at[0]": "mm",
        "hinges[1].at[1]": "mm", "hinges[1].play_mm": "mm", "named.top.at[0]": "mm", "named.top.at[1]": "mm",
        "named.top.play_mm": "mm",
    }  # fmt: skip
    assert [n.unit for n in numbers_in(Frame(side=2 + 3j)) if n.field == "side"] == ["mm", "mm"]


@pytest.mark.parametrize("key", [number.key for number in numbers_in(Frame())])
def test_one_number_is_changed_and_the_rest_stays(key):
    changed = with_number(Frame(), key, 7)
    before, after = ({n.key: n.value for n in numbers_in(frame)} for frame in (Frame(), changed))
    assert after == before | {key: 7}
    kept = [f.name for f in dataclasses.fields(Frame) if f.name != key_parts(key)[0]]
    assert all(getattr(changed, name) == getattr(Frame(), name) for name in kept)


def test_a_segment_of_a_motion_programme_is_changed_under_its_key():
    (key,) = (n.key for n in numbers_in(recipe("roller-cam")) if n.key.endswith("].rise"))
    longer = with_number(recipe("roller-cam"), key, 25.0)
    assert longer.table["lift"].max() == pytest.approx(25)
    with pytest.raises(gk.DesignError):
        with_number(recipe("roller-cam"), "cam.program[1].end_deg", -1.0)


def test_fields_know_the_tables_that_they_hold():
    table = tomllib.loads((RECIPES / "walking-leg.toml").read_text("utf-8"))
    fields = fields_of(type(recipe("walking-leg")))
    assert {name for name, field in fields.items() if field.tables and name in table} == {
        name
        for name, value in table.items()
        if isinstance(value, dict) and name not in ("expected_failures", "branches")
    }
    lists = {name for name, field in fields_of(type(recipe("loaded-crank-rocker").loads)).items() if field.is_rows}
    assert "springs" in lists and not lists & {"motor", "masses"}
