"""What a recipe means where it leaves a number out, and between which limits the numbers may lie."""

import dataclasses
import typing

import pytest

from geomkin.plane.curve import AbstractCurve
from tests.tables import left_out


@pytest.fixture(scope="module")
def classes():
    """Every dataclass of the package by its name."""
    return left_out.classes()


def test_values_cannot_be_changed_behind_the_back_of_what_was_worked_out_from_them(classes):
    assert [name for name, made in classes.items() if not made.__dataclass_params__.frozen] == []


def test_defaults_and_limits_are_those_that_recipes_were_written_for(classes):
    """A change here changes what is made from recipes that are not touched: change the table on purpose only."""
    header, kept = left_out.kept(left_out.QUANTITIES)
    assert header == ["quantity", "default", "above", "at least", "below", "at most"]
    assert left_out.quantities(classes) == kept


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
    header, kept = left_out.kept(left_out.CHOICES)
    assert header == ["name", "left out"]
    assert {name: [text] for name, text in left_out.choices(classes).items()} == kept


def test_what_is_allowed_is_what_was_allowed(classes):
    """What neither table tells: limits of places and rows, and of arguments of public calls."""
    header, kept = left_out.kept(left_out.ARGUMENTS)
    assert header == ["name", "allowed"]
    assert {name: [text] for name, text in left_out.arguments(classes).items()} == kept


def test_what_holds_arrays_is_itself_and_equals_nothing_else(classes):
    """By its values, comparing would fail and no cache could keep it."""
    arrays = ("Array", "Complex", "Mask", "Real", "Whole")
    holders = [
        c
        for c in classes.values()
        if any(kind in str(field.type) for field in dataclasses.fields(c) for kind in arrays)
    ]
    assert len(holders) > 20 and [c.__name__ for c in holders if c.__dataclass_params__.eq] == []


def test_what_a_base_shows_on_one_line_its_kinds_do_too(classes):
    """A dataclass writes a text of its own over the inherited one, with all its fields, unless it is told not to."""
    bases = {base for made in classes.values() for base in made.__mro__[1:-1] if "__repr__" in vars(base)}
    # What a dataclass writes guards itself against holding itself, and so is told from what is written here.
    told = {base for base in bases if not hasattr(base.__repr__, "__wrapped__")}
    heirs = [made for made in classes.values() if told & set(made.__mro__[1:])]
    assert len(heirs) > 50 and [made.__name__ for made in heirs if hasattr(made.__repr__, "__wrapped__")] == []


def test_what_holds_such_a_thing_is_itself_too(classes):
    """By its values it would equal nothing else all the same, and only look as if it could."""
    itself = {c for c in classes.values() if not c.__dataclass_params__.eq} | {AbstractCurve}
    # What a writer takes is known to type checkers only.
    fields = {name: typing.get_type_hints(made).values() for name, made in classes.items() if name != "Writer"}
    holders = {name: classes[name] for name, held in fields.items() if itself & {k for one in held for k in kinds(one)}}
    # Those of shop are asked whether they are in a list of one stack's pins.
    alike = {name for name, made in holders.items() if made.__dataclass_params__.eq} - {"Reach", "Disc"}
    assert len(holders) > 50 and alike == set()


def kinds(told):
    """The classes that a type names."""
    return [told] if isinstance(told, type) else [kind for one in typing.get_args(told) for kind in kinds(one)]
