"""Tables and items of lists that the form adds: each that is offered gives a valid recipe."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.recipe.kinds import kind_names, recipe_class
from geomkin.recipe.template import template
from geomkin.studio.edit import _values, answer
from geomkin.studio.form import recipe_form
from tests.campaign import by_default


def addable():
    """Kinds with each table and list of their forms, of which a template has none or a list."""
    for kind in kind_names():
        text = template(recipe_class(kind))
        values = _values(gk.load(text))
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
    if key.removesuffix("[]") in reply["unavailable"]:
        # The page does not offer it.
        assert reply["limit"]["reason"] and reply["text"] == text
        return
    assert reply["limit"] is None
    assert not answer(reply["text"], {}, {"lane": "checks"})["problems"]
    before, after = (_values(gk.load(recipe)) for recipe in (text, reply["text"]))
    new = {name for name in after if name not in before or before[name] in (None, {}, [])}
    assert any(name.startswith(key.removesuffix("[]")) for name in new)


def test_an_added_table_of_a_recipe_in_inches_has_the_same_sizes():
    text = 'kind = "four-bar"\n{}[linkage]\nground = {}\ncrank = {}\ncoupler = {}\nrocker = {}\n'
    sizes = (100, 30, 90, 70)
    inches = text.format('units = "in"\n', *(size / 25.4 for size in sizes))
    recipes = (text.format("", *sizes), inches)
    (spring,), (other,) = (gk.load(answer(r, {}, {"add": "loads.springs"})["text"]).loads.springs for r in recipes)
    assert (spring.body, spring.point) == (other.body, other.point)
    assert other.free_length == pytest.approx(spring.free_length)


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
