"""Errors go through a pickle, as between processes, and stay what they are."""

import ast
import copy
import pickle
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
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


def told(error):
    """All that a caller can see of an error."""
    return type(error), str(error), vars(error), getattr(error, "errno", None), getattr(error, "filename", None)


@pytest.mark.parametrize("error", ERRORS, ids=lambda error: type(error).__name__)
def test_errors_survive_pickling_and_copying(error):
    for protocol in range(pickle.HIGHEST_PROTOCOL + 1):
        assert told(pickle.loads(pickle.dumps(error, protocol))) == told(error)
    assert told(copy.deepcopy(error)) == told(error)


def test_notes_and_other_additions_survive_too():
    error = gk.DesignError("crank", "found -1", "give a number above 0")
    error.add_note("while drawing")
    assert pickle.loads(pickle.dumps(error)).__notes__ == ["while drawing"]


def test_every_error_there_is_was_tried():
    kinds = {kind for kind in vars(errors).values() if isinstance(kind, type) and issubclass(kind, Exception)}
    assert kinds == {type(error) for error in ERRORS}


def test_a_refusal_in_another_process_arrives_whole():
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        refusal = pool.submit(gk.plane.Circle, 0j, -1.0).exception(timeout=60)
    assert isinstance(refusal, gk.DesignError) and refusal.field == "radius" and "above 0" in refusal.remedy


def test_whatever_a_value_is_it_is_shown_on_one_line():
    class Deep:
        def __repr__(self):
            raise RecursionError

    assert errors.shown("a\x1b\u202eb") == "'a\\x1b\\u202eb'" and errors.shown(10**5000) == "a int too long to print"
    assert errors.shown(Deep()) == "a Deep too long to print" and len(errors.shown("x" * 500)) <= 80
    assert errors.harmless("a\x1b\n\u202e\u2028é 漢") == "a????é 漢"
    assert repr(errors.Problem("k", "found\n1", "x" * 300)).startswith("Problem(k: found?1; xxx")
    assert len(repr(errors.Problem("k", "", "x" * 300))) <= 120


def test_ids_of_problems_are_those_listed_and_each_is_in_use():
    calls = [
        node
        for file in Path(gk.__file__).parent.rglob("*.py")
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8")))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
        if node.func.id in ("DesignError", "Problem", "FileError")
    ]
    ids = [call.args[3] for call in calls if len(call.args) > 3]
    literal = {id.value for id in ids if isinstance(id, ast.Constant)}
    assert literal <= set(get_args(errors.ProblemId))
    # The general id is the default.
    assert set(get_args(errors.ProblemId)) - literal == {"impossible-geometry"}
