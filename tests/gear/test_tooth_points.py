"""Teeth without number are refused before they are drawn, with a tolerance and a count that can be."""

import re
from dataclasses import replace

import pytest

import geomkin as gk
from geomkin.gear.kinds.helical import MOST, check_tooth_points
from geomkin.recipe.settings import Files
from tests.campaign import by_default


def drawn(outlines, tolerance):
    return sum(len(gk.flatten(outline, tolerance)) for outline in outlines)


def named(remedy, pattern):
    return float(re.search(pattern, remedy)[1].replace(",", ""))


@pytest.mark.parametrize("tolerance", [0.005])
def test_the_tolerance_and_the_teeth_named_in_a_refusal_can_be_drawn(tolerance):
    gears = [gk.SpurGear(10_000, 5).outline, gk.SpurGear(9_000, 5, tip_rounding=0.1).outline]
    assert drawn(gears, tolerance) > MOST
    files = Files(tolerance=tolerance)
    with pytest.raises(gk.DesignError) as caught:
        check_tooth_points(files, gears)
    wider, teeth = (
        named(caught.value.remedy, r"least ([\d.e-]+) mm"),
        named(caught.value.remedy, r"most ([\d,]+) teeth"),
    )
    assert drawn(gears, wider) <= MOST < drawn(gears, wider / 1.4)
    check_tooth_points(replace(files, tolerance=wider), gears)
    fewer = [gk.SpurGear(int(teeth * share), 5, tip_rounding=r).outline for share, r in ((0.52, 0), (0.47, 0.1))]
    check_tooth_points(files, fewer)


@pytest.mark.parametrize(
    "name",
    by_default(
        [
            "spur-gear",
            "ring-gear",
            "gear-pair",
            "rack-and-pinion",
            "planetary",
            "straight-sided",
            "point-tooth",
            "lantern",
        ],
        ["spur-gear", "ring-gear", "gear-pair", "rack-and-pinion", "planetary"],
    ),
)
def test_every_kind_of_gear_counts_its_teeth_before_it_makes_parts(name, monkeypatch):
    """With hardly a point allowed each recipe of the gallery is refused; none that is not drawn."""
    recipe = gk.load(f"recipes/{name}.toml")
    monkeypatch.setattr("geomkin.gear.kinds.helical.MOST", 100)
    with pytest.raises(gk.DesignError):
        recipe.parts
