"""Checks: values beside their limits, and failures that a recipe expects."""

import json
import re

import pytest

import geomkin as gk

CLOSE = [
    (39.99996, "at least", 40.0),
    (39.99999999999999, "at least", 40.0),
    (0.0500000001, "at most", 0.05),
    (12345.6, "at most", 12345.4),
    (9999.99, "at least", 1e4),
    (1e7, "at most", 9999999.0),
    (-1e-12, "at least", 0.0),
    (2.5e-7, "at most", 2.4999999e-7),
]


def numbers(text):
    plain = text.replace("\N{MINUS SIGN}", "-").replace(",", "")
    return [float(found) for found in re.findall(r"-?\d+\.?\d*(?:e[-+]?\d+)?", plain)]


def test_a_value_that_fails_is_shown_apart_from_its_limit():
    for value, side, limit in CLOSE:
        check = gk.Check("gap", "gap", value, side, limit, "mm")
        shown, bound = numbers(str(check))
        assert (shown < bound) == (value < limit) and shown != bound
        assert shown == pytest.approx(value, rel=5e-3, abs=0)


def test_rounding_of_a_value_that_is_0_is_not_shown():
    assert gk.Check("angle", "angle", 7e-15, "at least", 40.0, "deg").value == 0
    assert gk.Check("gap", "gap", -1e-12, "at least", 0.0, "mm").value < 0


FAILING = """kind = "four-bar"
[linkage]
ground = 80
crank = 30
coupler = 80
rocker = 30
[expected_failures]
{} = "{}"
"""


def test_an_expected_failure_is_still_one_and_is_marked(tmp_path):
    recipe = gk.load(FAILING.format("transmission_angle", "it lies in line"))
    assert gk.load(gk.recipe.to_toml(recipe)) == recipe
    (failed,) = (check for check in recipe.checks if not check.passed)
    assert failed.id == "transmission_angle" and failed.expected == "it lies in line"
    gk.make(recipe, tmp_path, ["page"])
    summary = json.loads((tmp_path / "four-bar" / "summary.json").read_text())
    expected = {entry["id"]: (entry["passed"], entry["expected"]) for entry in summary["checks"] if "expected" in entry}
    assert expected == {failed.id: (False, "it lies in line")}
    (row,) = re.findall(r'<tr class="fails">.*?</tr>', (tmp_path / "four-bar" / "four-bar.html").read_text())
    assert "it lies in line" in row and "expected" in row
