"""Random edits and drags of all kinds: every answer is data, and what was good can be shown again."""

import json
import random

import pytest

from geomkin.recipe.kinds import kind_names, recipe_class
from geomkin.recipe.template import template
from geomkin.studio.edit import answer

# Values that nobody should type, and some that somebody does.
WILD = [
    0,
    -1,
    2,
    1e-9,
    1e9,
    1e308,
    -0.5,
    10**30,
    "",
    "x",
    "\n[files]\n",
    "é" * 300,
    None,
    [],
    {},
    [0, 0],
    [[0, 0]],
    True,
]
# Kinds of which an answer takes half a second, and those that search for seconds, whatever they are given.
HEAVY = {"cognates", "centrodes", "shaking-force", "crank-rocker-synthesis", "double-rocker-synthesis"}
HEAVY |= {"slider-crank-stroke", "straight-sided-gears", "point-tooth-gears", "lantern-gears"}
SLOW = {"path-generator", "function-generator", "slider-function-generator", "body-guidance"}


def changed(random, text, reply):
    """A random request on a text whose answer is known."""
    handles, values = reply["handles"], reply["values"]
    if handles and random.random() < 0.4:
        handle = random.choice(handles)
        x, y = (row[0] or 0.0 if isinstance(row, list) else row or 0.0 for row in handle["at"])
        reach = random.choice([0, 1e-6, 1, 10, 100, 1e6])
        to = [x + reach * random.uniform(-1, 1), y + reach * random.uniform(-1, 1)]
        to = random.choice([to, to, to, to, [x, y], [0, 0], [1e300, 0], [None, 1], "here"])
        step = random.choice([0.1, 0.25, 3, [0.5, 0.1], 1e-9, 0, -1, "fine"])
        drag = {"handle": handle["id"], "to": to, "frame": random.choice([0, 7, 10**6, -3]), "step": step}
        return {
            "drag": drag | {"snap": random.random() < 0.2},
            "locks": random.sample(handle["keys"], 1)[:: random.choice([1, 2])],
        }
    key = random.choice([*values, "no.such", "kind", "", "[3]", "linkage"])
    known = values.get(key)
    scaled = known * random.choice([0.5, 0.9, 1.01, 1.1, 3]) if isinstance(known, float) else known
    return {"set": {key: random.choice([scaled, scaled, *random.sample(WILD, 2)])}}


def play(kind, count, seed=0):
    """Makes random changes of a kind's template, each of the last good text; returns how many were refused."""
    numbers, text = random.Random(f"{kind} {seed}"), template(recipe_class(kind))
    good, refused = answer(text, {}, {}), 0
    assert not good["problems"]
    for _ in range(count):
        request = changed(numbers, text, good)
        reply = answer(text, {}, request)
        json.dumps(reply, allow_nan=False)
        if reply["problems"]:
            refused += 1
            assert reply["scene"] is None and all(problem["problem"] for problem in reply["problems"]), request
        else:
            text, good = reply["text"], reply
        # The recipe is never lost, and a drag that is refused leaves it as it was.
        assert reply["text"].strip() and (not reply["problems"] or "drag" not in request or reply["text"] == text)
    assert answer(text, {}, {})["scene"] == good["scene"]
    return refused


@pytest.mark.campaign
@pytest.mark.parametrize("kind", [kind for kind in kind_names() if kind not in SLOW])
def test_random_edits_and_drags_give_data(kind):
    play(kind, 15 if kind in HEAVY else 45)
