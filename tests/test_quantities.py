"""What a recipe means where it leaves a number out, and between which limits the numbers may lie."""

import csv
import dataclasses
import importlib
import inspect
import pkgutil
from pathlib import Path

import pytest

import geomkin as gk

TABLE = Path(__file__).parent / "tables" / "quantities.csv"
CHOICES = TABLE.with_name("defaults.csv")
LIMITS = ("gt", "ge", "lt", "le")


@pytest.fixture(scope="module")
def classes():
    """Every dataclass of the package by its name."""
    modules = [
        importlib.import_module(m.name)
        for m in pkgutil.walk_packages(gk.__path__, "geomkin.")
        if not m.name.endswith(("__main__", ".compiled"))
    ]
    found = [
        c
        for module in modules
        for c in vars(module).values()
        if isinstance(c, type) and c.__module__ == module.__name__
    ]
    return {c.__name__: c for c in found if dataclasses.is_dataclass(c)}


def test_values_cannot_be_changed_behind_the_back_of_what_was_worked_out_from_them(classes):
    assert [name for name, made in classes.items() if not made.__dataclass_params__.frozen] == []


def test_defaults_and_limits_are_those_that_recipes_were_written_for(classes):
    """A change here changes what is made from recipes that are not touched: change the table on purpose only."""
    found = {}
    for name, made in classes.items():
        for field in dataclasses.fields(made):
            if "unit" in field.metadata:
                default = "" if field.default is dataclasses.MISSING else str(field.default)
                found[f"{name}.{field.name}"] = [default, *(str(field.metadata.get(key, "")) for key in LIMITS)]
    rows = list(csv.reader(TABLE.read_text().splitlines()))
    assert rows[0] == ["quantity", "default", "above", "at least", "below", "at most"]
    assert found == {row[0]: row[1:] for row in rows[1:]}


def test_what_counts_things_is_a_whole_number(classes):
    counts = {
        f"{name}.{field.name}": bool(field.metadata.get("whole"))
        for name, made in classes.items()
        for field in dataclasses.fields(made)
        if "unit" in field.metadata and str(field.type).split(" | ")[0] == "int"
    }
    assert len(counts) > 15 and [name for name, whole in counts.items() if not whole] == []


def test_what_is_left_out_of_a_recipe_or_a_call_means_what_it_meant(classes):
    """What quantities.csv does not tell: tables, words and places that are left out, and arguments of public calls."""
    rooms = (gk.plane, gk.linkage, gk.cam, gk.gear, gk.synthesis, gk.judge, gk.shop, gk.scenes, gk)
    calls = {name: getattr(room, name) for room in rooms for name in dir(room) if not name.startswith("_")}
    calls = {name: call for name, call in calls.items() if inspect.isfunction(call)}
    quantities = {
        f"{name}.{field.name}"
        for name, made in classes.items()
        for field in dataclasses.fields(made)
        if "unit" in field.metadata
    }
    found = {
        f"{name}.{given.name}": str(given.default)
        for name, made in (classes | calls).items()
        for given in inspect.signature(made).parameters.values()
        if given.default is not given.empty
    }
    rows = list(csv.reader(CHOICES.read_text().splitlines()))
    assert rows[0] == ["name", "left out"]
    assert {name: text for name, text in found.items() if name not in quantities} == dict(rows[1:])


def test_what_holds_arrays_is_itself_and_equals_nothing_else(classes):
    """By its values, comparing would fail and no cache could keep it."""
    arrays = ("Array", "Complex", "Mask", "Real", "Whole")
    holders = [
        c
        for c in classes.values()
        if any(kind in str(field.type) for field in dataclasses.fields(c) for kind in arrays)
    ]
    assert len(holders) > 20 and [c.__name__ for c in holders if c.__dataclass_params__.eq] == []
