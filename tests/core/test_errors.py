"""Errors go through a pickle, as between processes, and stay what they are."""

import ast
import copy
import pickle
import re
from pathlib import Path
from typing import get_args

import pytest

import geomkin as gk
from geomkin.core import errors

ERRORS = [
    gk.GeomkinError("something"),
    gk.DesignError("crank", "found -1", "give a number above 0"),
    gk.RecipeError("a.toml", [errors.Problem(f"k{k}", "found 1", "give 2") for k in range(30)]),
    gk.RecipeError("a\n.toml", []),
    gk.FileError("a.toml", "cannot be read", "give a recipe file", "file-unreadable"),
]


def message_of(error):
    """All that a caller can see of an error."""
    return type(error), str(error), vars(error), getattr(error, "errno", None), getattr(error, "filename", None)


@pytest.mark.parametrize("error", ERRORS, ids=lambda error: type(error).__name__)
def test_errors_survive_pickling_and_copying(error):
    for protocol in range(pickle.HIGHEST_PROTOCOL + 1):
        assert message_of(pickle.loads(pickle.dumps(error, protocol))) == message_of(error)
    assert message_of(copy.deepcopy(error)) == message_of(error)


def test_whatever_a_value_is_it_is_shown_on_one_line():
    class Deep:
        def __repr__(self):
            raise RecursionError

    assert errors.shown("a\x1b\u202eb") == "'a\\x1b\\u202eb'" and errors.shown(10**5000) == "an int too long to print"
    assert errors.shown(Deep()) == "a Deep too long to print" and len(errors.shown("x" * 500)) <= 80
    assert errors.harmless("a\x1b\n\u202e\u2028é 漢") == "a????é 漢"
    assert repr(errors.Problem("k", "found\n1", "x" * 300)).startswith("Problem(k: found?1; xxx")
    assert len(repr(errors.Problem("k", "", "x" * 300))) <= 120


def test_the_article_suits_the_word():
    words = ["ellipse", "Offset", "image", "rect", "Circle", "LWPOLYLINE", "ARC"]
    assert [len(errors.with_article(word).split()[0]) for word in words] == [2, 2, 2, 1, 1, 1, 2]


NAMED = re.compile(r"\b(DesignError|Problem|FileError)\(")


def test_ids_of_problems_are_those_listed_and_each_is_in_use():
    calls = [
        node
        for file in Path(gk.__file__).parent.rglob("*.py")
        if NAMED.search(text := file.read_text(encoding="utf-8"))
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
        if NAMED.fullmatch(f"{node.func.id}(")
    ]
    ids = [call.args[3] for call in calls if len(call.args) > 3]
    literal = {id.value for id in ids if isinstance(id, ast.Constant)}
    assert literal <= set(get_args(errors.ProblemId))
    # The general id is the default.
    assert set(get_args(errors.ProblemId)) - literal == {"impossible-geometry"}
