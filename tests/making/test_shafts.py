"""What gears and cams turn on, held against the holes of their parts and the keyways that are cut."""

import re

import pytest

import geomkin as gk
from geomkin.core.units import Sentence
from geomkin.making.assembly import shaft_bill

GALLERY = ["rack-and-pinion", "planetary", "lantern", "rocker-cam"]


@pytest.mark.parametrize("name", GALLERY)
def test_every_round_hole_has_a_shaft_or_pin_as_thick_and_no_shaft_is_without_a_hole(name):
    """A hole is wider than what is bought by the clearance of its stock or of the base, and each has the other.

    Of a keyed bore the slot's mouth stands on the round part.
    """
    recipe = gk.load(f"recipes/{name}.toml")
    plays = {getattr(getattr(recipe, "stock", None), "clearance", 0.0)}
    if getattr(recipe, "base", None):
        plays.add(recipe.base.clearance)
    wide = set()
    for part in recipe.parts:
        wide |= {2 * h.radius for h in part.holes if isinstance(h, gk.plane.Circle)}
        if part.name != "base":
            wide |= {2 * abs(h.vertices[0]) for h in part.holes if len(getattr(h, "vertices", ())) == 4}
    found = set()
    for one in recipe.bought:
        if sizes := re.fullmatch(r"(?:(?:shaft|pin|screw) ([\d.]+) mm, at least .*|M(\d) x .* screw .*)", one.name):
            found.add(float(sizes[1] or sizes[2]))

    def fits(hole, bought):
        return any(abs(hole - play - bought) < 1e-9 for play in plays)

    assert found
    assert [hole for hole in wide if not any(fits(hole, bought) for bought in found)] == []
    assert [bought for bought in found if not any(fits(hole, bought) for hole in wide)] == []


KEYS = [
    ({"bore": 20, "thickness": 30}, "parallel key DIN 6885-1 A 6 x 6 x 28"),
    ({"bore": 20, "thickness": 14}, "parallel key DIN 6885-1 A 6 x 6 x 14"),
    ({"bore": 20, "thickness": 13.5}, "key steel DIN 6880 6 x 6, cut to 13.5 mm"),
    ({"bore": 20, "thickness": 900}, "parallel key DIN 6885-1 A 6 x 6 x 70"),
    ({"bore": 20, "thickness": 30, "keyway_width": 5, "keyway_depth": 2}, "parallel key DIN 6885-1 A 5 x 5 x 28"),
    ({"bore": 20, "thickness": 30, "keyway_width": 5.2, "keyway_depth": 2}, "key 5.2 mm wide, cut to 30 mm"),
]


@pytest.mark.parametrize(("sizes", "key"), KEYS)
def test_the_key_is_the_longest_that_the_part_has_room_for(sizes, key):
    stock = gk.gear.GearStock(**{"bore_form": "keyed"} | sizes)
    assert [Sentence(name) for name, _ in shaft_bill(stock, 40.0)] == ["shaft 20 mm, at least 40 mm long", key]
