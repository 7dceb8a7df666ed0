"""Parts that recipes make of what they work out."""

import numpy as np

import geomkin as gk
from tests.texts import parse, template_of


def parts(text):
    recipe = parse(text)
    return {part.name: part for part in recipe.parts}


def test_the_summary_of_cognates_builds_the_linkages_that_draw_the_same_curve():
    recipe = parse(template_of("cognates"))
    point = recipe.linkage.coupler_point
    traced = gk.move(recipe.linkage, np.linspace(0, 2 * np.pi, 721)).point("coupler_point").position
    for reported in recipe.notes["cognates"].values():
        places = {key: complex(*reported.pop(key)) for key in ("coupler_point", "origin")}
        other = gk.FourBar(**reported, **places)
        ways = [gk.move(other, np.linspace(0, 2 * np.pi, 91), sign).point("coupler_point").position for sign in (1, -1)]
        off = [np.nanmax(np.abs(way[:, None] - traced).min(axis=1)) for way in ways]
        assert point and min(off) < 1
