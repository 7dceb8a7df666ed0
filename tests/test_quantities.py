"""What a recipe means where it leaves a number out, and between which limits the numbers may lie."""

import csv
import dataclasses
import importlib
import pkgutil
from pathlib import Path

import pytest

import geomkin as gk

TABLE = Path(__file__).parent / "tables" / "quantities.csv"
LIMITS = ("gt", "ge", "lt", "le")


@pytest.fixture(scope="module")
def classes():
    """Every dataclass of the package by its name."""
    modules = [
        importlib.import_module(m.name) for m in pkgutil.walk_packages(gk.__path__, "geomkin.") if "main" not in m.name
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
