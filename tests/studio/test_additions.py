"""Tables and items of lists that the form adds: each that is offered gives a valid recipe."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.recipe.kinds import kind_names, recipe_class
from geomkin.recipe.template import template
from geomkin.studio.drafts import Draft
from geomkin.studio.edit import answer
from geomkin.studio.form import recipe_form
from tests.campaign import by_default


def addable():
    """Kinds with each table and list of their forms, of which a template has none or a list."""
    for kind in kind_names():
        text = template(recipe_class(kind))
        values = Draft(text, {}).values
        for group in recipe_form(kind, values)["groups"]:
            key, within = group["key"], group["within"]
            is_there = any(other.startswith(f"{key}.") for other in values)
            is_of_kind = not within or values.get(f"{key.rpartition('.')[0]}.kind") == within
            if key and not is_there and is_of_kind and (group["rows"] or group["optional"]):
                yield kind, key


ADDABLE = list(addable())
# Of each table that several kinds have, the one of the last kind; a table of loads takes longest.
LAST = {key.rpartition(".recipe.")[2]: (kind, key) for kind, key in ADDABLE if kind != "machine" or "base" in key}
DEFAULT = [
    case for case in LAST.values() if case[0] in ("disk-cam", "gear-pair", "gear-train", "polygons", "spur-gear")
]


@pytest.mark.parametrize(("kind", "key"), by_default(ADDABLE, DEFAULT))
def test_every_table_can_be_added(kind, key):
    text = template(recipe_class(kind))
    reply = answer(text, {}, {"add": key})
    assert not reply["problems"]
    keys = key.removesuffix("[]").split(".")
    if {".".join(keys[:k]) for k in range(1, len(keys) + 1)} & {*reply["unavailable"]}:
        # The page does not offer it, nor a table inside it.
        assert reply["limit"]["reason"] and reply["text"] == text
        return
    assert reply["limit"] is None
    assert not answer(reply["text"], {}, {"lane": "checks"})["problems"]
    before, after = (Draft(recipe, {}).values for recipe in (text, reply["text"]))
    new = {name for name in after if name not in before or before[name] in (None, {}, [])}
    assert any(name.startswith(key.removesuffix("[]")) for name in new)


def test_what_a_machine_that_walks_carries_can_be_added():
    text = template(recipe_class("machine"), ["walker"])
    reply = answer(text, {}, {"add": "walker.carried[]"})
    assert reply["limit"] is None and not reply["problems"] and not reply["unavailable"].count("walker")
    assert len(gk.load(reply["text"]).walker.carried) == len(gk.load(text).walker.carried) + 1


def test_an_added_table_of_a_recipe_in_inches_has_the_same_sizes():
    text = 'kind = "four-bar"\n{}[linkage]\nground = {}\ncrank = {}\ncoupler = {}\nrocker = {}\n'
    sizes = (100, 30, 90, 70)
    inches = text.format('units = "in"\n', *(size / 25.4 for size in sizes))
    recipes = (text.format("", *sizes), inches)
    (spring,), (other,) = (gk.load(answer(r, {}, {"add": "loads.springs"})["text"]).loads.springs for r in recipes)
    assert (spring.body, spring.point) == (other.body, other.point)
    assert other.free_length == pytest.approx(spring.free_length)


@pytest.mark.parametrize("units", ["mm", "in"])
def test_a_table_of_another_kind_keeps_what_both_have(units):
    scale = 1 if units == "mm" else 25.4
    text = f"""kind = "disk-cam"
units = "{units}"
[cam]
base_radius = {40 / scale}
follower = {{ kind = "translating-roller", roller_radius = {8 / scale}, offset = {3 / scale} }}  # bought
[[cam.program]]
kind = "rise"
law = "cycloidal"
rise_deg = 10
end_deg = 120
[[cam.program]]
kind = "return"
law = "cycloidal"
end_deg = 360
"""
    text = text.replace("rise_deg = 10", f"rise = {5 / scale}")
    reply = answer(text, {}, {"add": "cam.follower=translating-flat"})
    assert reply["limit"] is None and not reply["problems"] and "# bought" in reply["text"]
    follower = gk.load(reply["text"]).cam.follower
    assert follower.kind == "translating-flat"
    back = gk.load(answer(reply["text"], {}, {"add": "cam.follower=translating-roller"})["text"]).cam.follower
    assert back.kind == "translating-roller" and back.roller_radius > 0
    # An unknown kind, and one that the mechanism refuses, change nothing.
    for wrong in ("cam.follower=belt", "cam.follower=oscillating-flat", "cam=disk", "cam.program[7]=rise"):
        refused = answer(text, {}, {"add": wrong})
        assert refused["text"] == text and refused["limit"]["reason"] and not refused["problems"]


@pytest.mark.parametrize("unit", [1.0, 25.4], ids=["mm", "in"])
def test_attachments_of_a_ring_are_screwed_to_the_middle_of_its_rim(unit):
    units = "mm" if unit == 1 else "in"
    gear = f"[gear]\nteeth = 40\nmodule = {1.5 / unit}\n[stock]\nrim = {7 / unit}\nthickness = {4 / unit}\n"
    text = f'kind = "ring-gear"\nunits = "{units}"\n{gear}'
    recipe = gk.load(answer(text, {}, {"add": "stock.attachments"})["text"])
    (ring,) = recipe.parts
    teeth = np.abs(gk.flatten(next(hole for hole in ring.holes if not isinstance(hole, gk.plane.Circle)), 1e-3)).max()
    edge = np.abs(gk.flatten(ring.outline, 1e-3)).max()
    screws = [hole for hole in ring.holes if isinstance(hole, gk.plane.Circle)]
    assert np.abs([hole.centre for hole in screws]) == pytest.approx([(teeth + edge) / 2] * 3, abs=0.01)
    assert all(check.passed for check in recipe.checks if check.id.startswith("wall"))
