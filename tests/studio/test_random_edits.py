"""Random edits and drags of all kinds: each answer is a scene or an error at a key, and the recipe is never lost."""

import json
import random
import tomllib

import pytest

from geomkin.recipe.kinds import kind_names, recipe_class
from geomkin.recipe.template import template
from geomkin.studio.drafts import read
from geomkin.studio.edit import answer
from tests.campaign import by_default

# Values that nobody should type, and some that somebody does: empty, of another type, huge, tiny, pasted.
WILD = [0, -1, 2, 1e-9, 1e-300, 1e9, 1e308, -0.5, 10**30, float("inf"), float("nan"), True, None]
WILD += ["", "x", "12,5 mm", "\n[files]\n", '"""', "é" * 300, [], {}, [0, 0], [[0, 0]], [{}]]
# Points that coincide, and poses on a line.
WILD += [[[0, 0]] * 3, [[0, 0], [10, 0], [20, 0]], [[0, 0, 0]] * 3, [[0, 0, 0], [10, 0, 0], [20, 0, 0]]]
# Kinds that search for their mechanism or whose pages are large: most of their edits are only read, not drawn.
SLOW = {"path-generator", "function-generator", "slider-function-generator", "body-guidance", "slider-crank-stroke"}
SLOW |= {"crank-rocker-synthesis", "double-rocker-synthesis", "lantern-gears", "point-tooth-gears"}
SLOW |= {"straight-sided-gears", "cognates"}


class OnlyRead(Exception):  # noqa: N818
    """The recipe was read, and is not to be drawn."""


def only_read(draft):
    read(draft)
    raise OnlyRead


def entries(table, path=""):
    """Values of a table by dotted key."""
    for name, value in table.items():
        key = f"{path}.{name}" if path else name
        if isinstance(value, dict):
            yield from entries(value, key)
        elif isinstance(value, list) and value and all(isinstance(row, dict) for row in value):
            for k, row in enumerate(value):
                yield from entries(row, f"{key}[{k}]")
        else:
            yield key, value


def edit(numbers, values):
    """A random key with a random value: often a degenerate one, that of another key, or one close to the present."""
    key = numbers.choice([*values, *values, "no.such", "kind", "", "[3]", next(iter(values)).partition(".")[0]])
    known = values.get(key)
    if isinstance(known, list) and known and numbers.random() < 0.6:
        k = numbers.randrange(len(known))
        key, known = f"{key}[{k}]", known[k]
    if isinstance(known, float | int) and not isinstance(known, bool) and numbers.random() < 0.3:
        return key, known * numbers.choice([0.5, 0.9, 1.01, 1.1, 3])
    return key, numbers.choice([*WILD, numbers.choice(list(values.values()))])


def drag(numbers, handle):
    """A random drag of a handle, often to where nobody can go."""
    x, y = (row[0] or 0.0 if isinstance(row, list) else row or 0.0 for row in handle["at"])
    reach = numbers.choice([0, 1e-6, 1, 10, 100, 1e6])
    to = [x + reach * numbers.uniform(-1, 1), y + reach * numbers.uniform(-1, 1)]
    to = numbers.choice([to, to, to, to, [x, y], [0, 0], [1e300, 0], [None, 1], "here"])
    step = numbers.choice([0.1, 0.25, 3, [0.5, 0.1], 1e-9, 0, -1, "fine"])
    wanted = {"handle": handle["id"], "to": to, "frame": numbers.choice([0, 7, 10**6, -3]), "step": step}
    locks = numbers.sample(handle["keys"], 1)[:: numbers.choice([1, 2])]
    return {"drag": wanted | {"snap": numbers.random() < 0.2}, "locks": locks}


def start(kind):
    """The template of a kind without its comments, which take longer to read than the recipe; a search ends at once."""
    lines = [line for line in template(recipe_class(kind)).splitlines() if not line.startswith("#")]
    text = "\n".join(lines)
    return answer(text, {}, {"set": {"search.time_limit": 0.05}})["text"] if kind == "path-generator" else text


def play(kind, count, drawn=1.0):
    """Make random changes of a kind's template, each of the last text that was drawn, and draw a share of them."""
    numbers, text = random.Random(kind), start(kind)
    good = answer(text, {}, {})
    assert not good["problems"]
    for _ in range(count):
        table = tomllib.loads(text)
        if good["handles"] and numbers.random() < 0.1:
            request, key = drag(numbers, numbers.choice(good["handles"])), ""
        else:
            values = {key: value for key, value in good["values"].items() if not key.startswith("search.")}
            key, value = edit(numbers, values)
            request = {"set": {key: value}}
        try:
            reply = answer(text, {}, request, reader=read if numbers.random() < drawn else only_read)
        except OnlyRead:
            continue
        json.dumps(reply, allow_nan=False)
        changed = dict(entries(tomllib.loads(reply["text"])))
        if "drag" in request:
            assert not reply["problems"] or reply["text"] == text, request
        else:
            # All values but that of the key are kept, also if it is refused.
            kept = {k: v for k, v in entries(table) if not k.startswith(key) and not key.startswith(k)}
            assert kept.items() <= changed.items(), request
        if not reply["problems"]:
            text, good = reply["text"], reply
            continue
        assert reply["scene"] is None, request
        assert all(p["problem"] and (p["key"] or not key) for p in reply["problems"]), (request, reply["problems"])
        if key in good["values"] and numbers.random() < 0.05:
            # The value is typed as it was, or the field is reset.
            before = dict(entries(table)).get(key)
            again = answer(reply["text"], {}, {"set": {key: before}})
            assert (again["scene"], again["problems"]) == (good["scene"], []), request
    assert answer(text, {}, {})["scene"] == good["scene"]


# Others in campaigns.
FEW = ["four-bar", "linkage", "disk-cam", "spur-gear", "crank-rocker-synthesis"]


@pytest.mark.parametrize("kind", by_default(kind_names(), FEW))
def test_a_few_random_edits_and_drags(kind):
    play(kind, 12, 0.2 if kind in SLOW else 1.0)


@pytest.mark.campaign
@pytest.mark.parametrize("kind", kind_names())
def test_a_thousand_random_edits_and_drags(kind):
    play(kind, 1000, 0.01 if kind in SLOW else 0.3)
