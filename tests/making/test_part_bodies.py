"""Every part says whose motion it follows."""

from pathlib import Path

import pytest

import geomkin as gk

RECIPES = Path(__file__).parents[2] / "recipes"


def bodies(name):
    return {part.name: part.body for part in gk.load(RECIPES / f"{name}.toml").parts}


@pytest.mark.parametrize("name", ["lift-table", "whitworth"])
def test_a_plate_of_a_linkage_follows_the_body_it_is_cut_for(name):
    recipe = gk.load(RECIPES / f"{name}.toml")
    for part in recipe.parts:
        assert part.body in {*recipe.motion.bodies, ""}
        # A bridge stands still, as the ground does; spacers are on pins of any body.
        assert part.body == {"bridge": recipe.motion.linkage.ground, "spacer": ""}.get(part.name, part.name)


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        (
            "whitworth",
            {"crank": "crank", "rocker": "rocker", "ground": "ground", "bridge": "ground", "spacer": ""},
        ),
        (
            "shaking-force",
            {"ground": "ground", "crank": "crank", "coupler": "coupler", "counterweight": "crank", "spacer": ""},
        ),
        ("rocker-cam", {"cam": "cam", "roller": "roller", "arm": "arm", "base": "ground"}),
        ("gear-pair", {"first": "first", "second": "second", "base": "ground"}),
        ("planetary", {"sun": "sun", "planet": "planet", "ring": "ring", "carrier": "carrier", "base": "ground"}),
        ("rack-and-pinion", {"pinion": "pinion", "rack": "rack", "base": "ground"}),
        ("straight-sided-ring", {"gear": "gear", "ring": "ring"}),
        ("lantern", {"disc": "pinion", "mate": "mate"}),
        # What is engraved on a plate stands for no body.
        ("polygons", {"position": "", "velocity-polygon": "", "acceleration-polygon": ""}),
    ],
)
def test_parts_of_each_kind_name_their_bodies(name, expected):
    assert bodies(name) == expected
