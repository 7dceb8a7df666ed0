"""Parts that recipes make of what they work out."""

import numpy as np
import pytest

import geomkin as gk
from tests.texts import parse, template_of


def parts(text):
    recipe = parse(text)
    return {part.name: part for part in recipe.parts}


@pytest.mark.parametrize(("share", "made"), [(0.9, False), (1.02, True)])
def test_a_counterweight_is_made_once_it_is_four_times_as_large_as_its_hole(share, made):
    text = template_of("shaking-force").replace("# bar_width = 14 ", "bar_width = 20 ")
    for heavy, light in (("crank = 0.5 ", "crank = 0.02 "), ("coupler = 0.6 ", "coupler = 0.01 "), ("0.8 ", "0.01 ")):
        text = text.replace(heavy, light)
    radius = np.ptp(gk.flatten(parts(text)["counterweight"].outline, 1e-4).real) / 2
    # The hole is wider than its pin by the clearance of 0.2 mm, and a larger hole makes a larger disc, by 4 %.
    pin = radius / share / 2 - 0.2
    assert ("counterweight" in parts(text.replace("# pin_diameter = 4 ", f"pin_diameter = {pin:.6g} "))) is made


def test_the_summary_of_cognates_builds_the_linkages_that_draw_the_same_curve():
    recipe = parse(template_of("cognates"))
    point = recipe.linkage.coupler_point
    traced = gk.move(recipe.linkage, np.linspace(0, 2 * np.pi, 721)).point("coupler_point").position
    for told in recipe.notes["cognates"].values():
        places = {key: complex(*told.pop(key)) for key in ("coupler_point", "origin")}
        other = gk.FourBar(**told, **places)
        ways = [gk.move(other, np.linspace(0, 2 * np.pi, 91), sign).point("coupler_point").position for sign in (1, -1)]
        off = [np.nanmax(np.abs(way[:, None] - traced).min(axis=1)) for way in ways]
        assert point and min(off) < 1
