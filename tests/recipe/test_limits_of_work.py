"""What would take too long or too much memory is counted first, and refused with the number that works."""

import re

import numpy as np
import pytest

import geomkin as gk
from geomkin.core.fields import FARTHEST, SMALLEST
from geomkin.recipe.kinds import KINDS
from tests.texts import parse, template_of


def changed(text, **values):
    """A template with other values, those that stand commented out too."""
    for key, value in values.items():
        text, count = re.subn(rf"^(# )?{key} +=.*$", f"{key} = {value}", text, flags=re.MULTILINE)
        assert count, key
    return text


def refusal(text):
    with pytest.raises(gk.RecipeError) as caught:
        parse(text)
    (problem,) = caught.value.problems
    return problem.key, f"{problem.problem}; {problem.remedy}"


def advised(words):
    return float(re.search(r"at least ([\d.e+-]+)", words)[1])


DRIVEN = [name for name in KINDS if "step_deg" in template_of(name)]


def test_rows_of_a_table_are_counted_before_any_is_worked_out():
    for name in DRIVEN[::4]:
        text = re.sub("^# dash_deg = 5 ", "dash_deg = 90 ", template_of(name), flags=re.MULTILINE)
        if "start_deg = 0 " in text.split("[drive]")[1].split("\n[")[0]:
            drive, rest = text.split("[drive]")
            text = drive + "[drive]" + changed(rest, start_deg=-3600, end_deg=3600)
        key, words = refusal(changed(text, step_deg=0.001))
        assert key == "drive.step_deg" and "rows" in words
        step = advised(words)
        parse(changed(text, step_deg=step))
        assert refusal(changed(text, step_deg=0.998 * step))[0] == key


@pytest.mark.parametrize("name", ["slider-crank", "elliptic-trammel", "linkage"])
def test_rows_of_a_stroke_too(name):
    text = template_of(name, ["stroke"])
    key, words = refusal(changed(text, step=1e-9))
    assert key == "stroke.step"
    parse(changed(text, step=advised(words)))
    assert refusal(changed(text, step=0.998 * advised(words)))[0] == key


ATLAS = template_of("four-bar-atlas")


@pytest.mark.parametrize(("rows", "columns", "end"), [(50, 50, 360), (20, 20, 360), (7, 50, 3600)])
def test_dashes_are_counted_before_any_is_drawn(rows, columns, end):
    text = changed(ATLAS, rows=rows, columns=columns, end_deg=end, step_deg=5)
    key, words = refusal(changed(text, dash_deg=0.5))
    if "points" in words.split(";")[1]:
        most = int(re.search(r"at most (\d+) points", words)[1])
        parse(changed(text, dash_deg=90, rows=1 + (most - 1) // 50, columns=min(50, most)))
        return
    assert key == "grid.dash_deg"
    parse(changed(text, dash_deg=advised(words)))
    assert refusal(changed(text, dash_deg=0.99 * advised(words)))[0] == key


# Sizes that may be 0, and those that may not.
LENGTHS = [("four-bar", "crank", False), ("four-bar", "clearance", True), ("spur-gear", "module", False),
           ("spur-gear", "kerf", True), ("spur-gear", "tooth_thickness_allowance", True), ("disk-cam", "base_radius", False),
           ("gear-pair", "centre_distance", False), ("rack-and-pinion", "distance", False),
           ("shaking-force", "weight_density", False)]  # fmt: skip


def test_the_least_size_works_and_a_tenth_of_a_micrometre_does_all_it_should():
    gk.FourBar(100, SMALLEST, 90, 90)
    assert gk.FourBar(1e-7, 1e-7, 1e-7, 1e-7).ground == 1e-7
    small, plain = (gk.move(gk.FourBar(*(size * np.array([100, 30, 90, 70]))), [0.3]) for size in (1e-9, 1))
    assert small.transmission_angle == pytest.approx(plain.transmission_angle, rel=1e-12)
    with pytest.raises(gk.DesignError, match="1e-12 mm"):
        gk.FourBar(100, 1e-13, 90, 90)
    assert SMALLEST < 1e-7 < FARTHEST
