"""A recipe written as TOML and read again."""

import geomkin as gk


def test_every_digit_and_every_letter_is_kept():
    crank = 30 + 2**-40
    linkage = gk.FourBar(100, crank, 90, 70, coupler_point=1e-7 / 3 + 1e5j / 3)
    text = gk.recipe.to_toml(gk.linkage.FourBarRecipe(linkage=linkage))
    assert gk.load(text).design == linkage
    bodies = {"ground": {"crank pivot": [0, 0], "C": [60, 0]}, "a-b_c": {"crank pivot": [0, 0], "A": [20, 0]},
              "rod": {"A": [0, 0], "B": [50, 0]}, "arm": {"C": [0, 0], "B": [40, 0]}}  # fmt: skip
    recipe = gk.load({"kind": "linkage", "linkage": {"bodies": bodies, "driver": "a-b_c"}})
    assert gk.load(gk.recipe.to_toml(recipe)) == recipe


def test_a_body_without_points_is_kept():
    sliders = [
        {"name": "way", "body": "block", "along": "ground"},
        {"name": "slot", "body": "frame", "along": "ground"},
    ]
    bodies = {"ground": {}, "block": {"B": [0, 0]}, "rod": {"B": [0, 0], "C": [60, 0]}, "frame": {"C": [0, 0]}}
    sliders[1]["direction_deg"] = 90
    linkage = {"bodies": bodies, "driver": "rod", "sliders": sliders}
    recipe = gk.load({"kind": "linkage", "linkage": linkage, "drive": {"start_deg": 10, "end_deg": 80}})
    text = gk.recipe.to_toml(recipe)
    assert gk.load(text) == recipe and "ground = {}" in text and "branches" not in text
