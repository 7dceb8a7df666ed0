"""Lengths typed on the drawing: the link has that length, and no other link another one."""

import tomllib

import numpy as np
import pytest

import geomkin as gk
from geomkin.studio.drafts import Draft
from geomkin.studio.edit import answer, with_length
from tests.campaign import by_default

from ..browser.test_editor import RECIPES

NAMES = ["crank-rocker", "inch-wiper", "slotted-lever", "walking-leg", "slider-crank", "sieve", "stephenson-dwell"]


def lengths(text):
    """Distances of all pairs of joints of each body, in the unit of the recipe."""
    linkage = gk.load(text).linkage.linkage
    mm = 25.4 if tomllib.loads(text).get("units") == "in" else 1.0
    return {(body, one, other): abs(complex(points[one]) - complex(points[other])) / mm
            for body, points in linkage.bodies.items() for one in points for other in points}  # fmt: skip


@pytest.mark.parametrize("name", by_default(NAMES, ["crank-rocker", "inch-wiper"]))
def test_a_typed_length_is_that_of_the_link(name):
    text = (RECIPES / f"{name}.toml").read_text()
    reply = answer(text, {}, {})
    drawn = [curve for curve in reply["scene"]["scenes"][0]["curves"] if curve["role"] == "dimension"]
    assert len(reply["dimensions"]) <= len(drawn)
    before = lengths(text)
    for dimension in reply["dimensions"]:
        ends = tuple(dimension[key] for key in ("body", "from", "to"))
        after = lengths(with_length(Draft(text, {}), {**dimension, "length": 1.02 * before[ends]}))
        assert after[ends] == pytest.approx(1.02 * before[ends], rel=1e-8)
        # A bar of two joints in another body keeps its length.
        others = [key for key in before if key[0] != ends[0]]
        assert np.allclose([after[key] for key in others], [before[key] for key in others], rtol=1e-9)


def test_a_length_of_a_bar_stays_a_round_number_along_it():
    text = (RECIPES / "walking-leg.toml").read_text()
    wanted = {"body": "upper_rod", "from": "M", "to": "B", "length": 52}
    linkage = tomllib.loads(with_length(Draft(text, {}), wanted))["linkage"]
    assert linkage["bodies"]["upper_rod"] == {"M": [0, 0], "B": [52, 0]}
    wanted = {"body": "triangle", "from": "F", "to": "D", "length": 41}
    linkage = tomllib.loads(with_length(Draft(text, {}), wanted))["linkage"]
    assert linkage["corners"][0]["lengths"] == [41, 55.8]


COUPLER = {"body": "coupler", "from": "crank_pin", "to": "rocker_pin"}


@pytest.mark.parametrize(
    ("wanted", "locks"),
    [({}, []), ({**COUPLER, "length": -1}, []), ({**COUPLER, "length": "5"}, []), ({**COUPLER, "length": None}, []),
     ({**COUPLER, "to": "nobody", "length": 5}, []), ({**COUPLER, "length": 91}, ["linkage.coupler"]),
     ({**COUPLER, "length": 91}, ["linkage"])],
)  # fmt: skip
def test_an_impossible_length_is_refused_and_changes_nothing(wanted, locks):
    text = (RECIPES / "crank-rocker.toml").read_text()
    reply = answer(text, {}, {"length": wanted or {"body": 1}, "locks": locks})
    assert reply["text"] == text and reply["limit"]["reason"]


@pytest.mark.parametrize("head", ["", 'units = "in"\n', "scale = 2\n"])
def test_a_length_that_is_too_large_is_refused_with_the_limit(head):
    text = head + (RECIPES / "crank-rocker.toml").read_text()
    reason = answer(text, {}, {"length": {**COUPLER, "length": 10**12}})["limit"]["reason"]
    assert f"{10**12} " in reason.replace(";", " ")
    limit = float(reason.rpartition("below ")[2])
    for length, is_refused in ((1.001 * limit, True), (0.999 * limit, False)):
        reply = answer(text, {}, {"length": {**COUPLER, "length": length}})
        assert (reply["limit"] is not None and "below" in reply["limit"]["reason"]) == is_refused
