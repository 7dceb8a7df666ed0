"""The branch in a recipe: by sign, near a place, followed from either; alike in every kind that has one."""

import numpy as np
import pytest

import geomkin as gk
from tests.texts import parse

FOUR_BAR = "[linkage]\nground = 100\ncrank = 30\ncoupler = 90\nrocker = 70\n"
BODIES = """[linkage]
driver = "crank"
[linkage.bodies]
ground = { O = [0, 0], C = [100, 0] }
crank = { O = [0, 0], A = [30, 0] }
coupler = { A = [0, 0], B = [90, 0] }
rocker = { C = [0, 0], B = [70, 0] }
"""
# Where the pin is at 0 deg by two circles: right of the line to the pivot, below.
BELOW = -np.sqrt(90**2 - ((70**2 + 90**2 - 70**2) / 140) ** 2)
RIGHT = {"four-bar": (FOUR_BAR, "rocker_pin"), "linkage": (BODIES, "B"), "centrodes": (FOUR_BAR, "rocker_pin")}


def reported(kind, top, branches):
    sizes, joint = RIGHT[kind]
    return parse(f'kind = "{kind}"\n{top}\n[branches]\n{branches.format(joint)}\n{sizes}')


@pytest.mark.parametrize(
    ("top", "branches", "sign"),
    [
        ("", "", 1), ("branch = -1", "", -1), ("", "{} = -1", -1), ("branch = -1", "{} = 1", 1),
        ("", "{} = [90, -60]", -1), ("branch = -1", "{} = [90, 60]", 1), ('branch = "follow"', "{} = -1", -1),
        ('branch = "follow"', "{} = [90.5, -60]", -1), ('branch = "follow"', "", 1),
    ],
)  # fmt: skip
def test_the_branch_is_given_by_sign_or_place(top, branches, sign):
    for kind, (_, joint) in RIGHT.items():
        recipe = reported(kind, top, branches)
        motion = recipe.centrodes.motion if kind == "centrodes" else recipe.motion
        pin = motion.point(joint).position[0]
        assert np.sign(pin.imag) == sign and pin.imag == pytest.approx(-sign * BELOW, rel=1e-12)


def test_polygons_take_the_same_table():
    for top, branches, sign in (("", "B = [60, -70]", -1), ("branch = -1", "", -1), ("branch = -1", "B = 1", 1)):
        recipe = parse(f'kind = "polygons"\nposition = 0\n{top}\n[branches]\n{branches}\n{BODIES}')
        assert np.sign(recipe.motion.point("B").position[0].imag) == sign


def test_invalid_branch_is_refused_by_its_key():
    for branches, key, found in [
        ("{} = 2", "branches.B", "found 2"),
        ("{} = true", "branches.B", "found True"),
        ("{} = [1, 2, 3]", "branches.B", "found [1, 2, 3]"),
        ('{} = "left"', "branches.B", "found 'left'"),
        ("{} = [nan, 0]", "branches.B", "nan"),
        ("{} = [1e300, 0]", "branches.B", "1e+300"),
    ]:
        with pytest.raises(gk.RecipeError) as caught:
            reported("linkage", "", branches)
        (problem,) = caught.value.problems
        assert problem.key == key and found in problem.problem and "[x, y]" in problem.remedy


def test_input_range_that_assembles_nowhere_is_refused_with_one_that_does(tmp_path):
    file = tmp_path / "open.toml"
    text = 'kind = "four-bar"\n[linkage]\nground = 40\ncrank = 30\ncoupler = 20\nrocker = 25\n'
    text += "[stock]\nbar_width = 4\npin_diameter = 2\n"
    file.write_text(text + "[drive]\nstart_deg = 90\nend_deg = 200\n")
    with pytest.raises(gk.RecipeError) as caught:
        gk.make(file, tmp_path / "out")
    (problem,) = caught.value.problems
    assert (
        problem.key == "drive"
        and "rocker_pin opens first, at crank 90 deg: its two links together are 5 mm" in problem.problem
    )
    low, high = (float(word) for word in problem.remedy.split() if word.lstrip("-").replace(".", "").isdigit())
    file.write_text(text + f"[drive]\nstart_deg = {low}\nend_deg = {high}\n")
    checks = {check.name: check for check in gk.make(file, tmp_path / "out").checks}
    assert checks["share of the crank's turn reached"].passed


def test_unreachable_part_of_the_range_is_reported_and_the_rest_is_checked():
    recipe = parse(
        'kind = "four-bar"\n[linkage]\nground = 40\ncrank = 30\ncoupler = 20\nrocker = 25\n[drive]\nend_deg = 180\n'
    )
    checks = {check.name: check for check in recipe.design_checks}
    reached, least = checks["share of the crank's turn reached"], checks["least transmission angle"]
    assert not reached.passed and "rocker_pin opens first, at crank 79 deg" in str(reached)
    # At the limit, between two frames, coupler and rocker are in line: cosine rule at the crank's pivot.
    limit = np.degrees(np.arccos((40**2 + 30**2 - (20 + 25) ** 2) / (2 * 40 * 30)))
    assert reached.value == pytest.approx(100 * limit / 180, rel=1e-9) and least.value == 0
    assert reached.at == pytest.approx(limit) and least.at == pytest.approx(limit)
