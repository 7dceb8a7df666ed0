"""Slips that people make, told in a person's words with the key they stand under."""

import pytest

import geomkin as gk
from tests.texts import parse

BAR = 'kind = "four-bar"\n[linkage]\nground = 100\ncrank = 30\ncoupler = 90\nrocker = 70\n'
CAM = 'kind = "disk-cam"\n[cam]\nbase_radius = 40\n'


def told(text):
    with pytest.raises(gk.RecipeError) as caught:
        parse(text)
    return {problem.key: f"{problem.problem}; {problem.remedy}" for problem in caught.value.problems}


def test_a_common_mistake_is_answered_with_the_correction():
    for text, key, words in [
        ("kind = four-bar", "kind", 'a text needs quotes: write kind = "four-bar"'),
        (BAR + "driver = crank # by hand", "linkage.driver", 'write driver = "crank"'),
        (BAR.replace("= 30", "= 30,5"), "linkage.crank", "found 30,5; write 30.5, a number with a point"),
        (BAR.replace("= 30", "= 30mm"), "linkage.crank", "found 30mm; write 30, a number"),
        (BAR.replace("= 30", "= 30 mm  # short"), "linkage.crank", "found 30 mm; write 30, a number"),
        (BAR.replace("= 30", "= 3cm"), "linkage.crank", "lengths are in mm, angles in deg, not in cm"),
        (BAR.replace("= 30", '= "30,5"'), "linkage.crank", "found '30,5'; write 30.5, a number"),
        (BAR.replace("= 30", '= "30mm"'), "linkage.crank", "found '30mm'; write 30, a number"),
        (BAR.replace("= 30", '= "30"'), "linkage.crank", "write 30, a number with a point and without unit or quotes"),
        (BAR.replace("= 30", "= .5"), "linkage.crank", "write 0.5"),
        (BAR.replace("= 30", "= 30."), "linkage.crank", "write 30.0"),
        (BAR.replace("= 30", "="), "linkage.crank", "found nothing; give a value"),
        (BAR.replace('"four-bar"', "“four-bar”"), "kind", "curly quotes"),
        (CAM + "[stock]\ntiming_mark = True", "stock.timing_mark", "write true"),
        (CAM + "follower = { kind = translating-flat, tilt_deg = 3 }", "cam.kind", 'kind = "translating-flat"'),
        (CAM + 'follower = { kind = "translating-flat", tilt_deg = 2,5 }', "cam.tilt_deg", "write 2.5"),
    ]:
        found = told(text)
        assert list(found) == [key] and words in found[key], found
