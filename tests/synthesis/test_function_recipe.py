"""Recipes of function generators: results, and refusals of wrong ones."""

import json

import numpy as np
import pytest

import geomkin as gk

FOUR_BAR = """
kind = "function-generator"
[wanted]
function = "x**1.5"
x_start = 1
x_end = 3
input_deg = 90
"""
SLIDER = """
kind = "slider-function-generator"
[wanted]
function = "power"
coefficients = [2, 1.5]
x_start = 1
x_end = 3
input_deg = -90
output_mm = -40
"""


@pytest.mark.campaign
@pytest.mark.parametrize("text", [FOUR_BAR, SLIDER])
def test_found_function_generator_is_made(tmp_path, text):
    recipe = gk.load(text).with_name("wish")
    made = gk.make(recipe, tmp_path)
    unit = "mm" if "slider" in text else "deg"
    table = recipe.table.to_columns()
    x, wanted, reached, error = (table[name] for name in ("x", f"wanted_{unit}", f"reached_{unit}", f"error_{unit}"))
    share = (x**1.5 - 1) / (3**1.5 - 1)
    way = -40 if unit == "mm" else 90
    at_start = wanted[np.argmin(x)]
    assert sorted([x[0], x[-1]]) == pytest.approx([1, 3]) and wanted == pytest.approx(at_start + way * share)
    # The columns of the motion agree.
    if unit == "deg":
        turned = table["rocker_angle_deg"] - wanted
        assert error == pytest.approx(turned - 360 * np.round(turned / 360), abs=1e-9)
    assert reached - wanted == pytest.approx(error)
    data = json.loads((tmp_path / "wish" / "summary.json").read_text())
    largest = data["found"][f"largest_error_{unit}"]
    assert np.abs(error).max() <= largest * (1 + 1e-6) and np.abs(error).max() > 0.9 * largest
    assert data["ranked"][0] == data["found"] and data["number_found"] == len(data["ranked"])
    errors = [entry[f"largest_error_{unit}"] for entry in data["ranked"]]
    assert errors == sorted(errors) and sum(peak["multiplier"] for peak in data["alternation"]) == pytest.approx(
        1, abs=1e-5
    )
    assert made.checks[0].name == "largest error of the output" and made.checks[0].passed and made.checks[1].passed
    found = tmp_path / "wish" / "wish.found.toml"
    assert gk.load(found) == recipe.design
    again = gk.make(found, tmp_path)
    assert all(check.passed for check in again.checks)
    for file in (tmp_path / "wish").glob("*.stl"):
        # The header states the recipe.
        assert file.read_bytes()[80:] == (tmp_path / "wish.found" / file.name).read_bytes()[80:]


@pytest.mark.campaign
def test_rows_a_method_and_a_limit_of_the_error(tmp_path):
    rows = [[x / 4, (x / 4) ** 2] for x in range(4, 13)]
    text = FOUR_BAR.replace('"x**1.5"', '"table"') + f"rows = {rows}\n"
    recipe = gk.load(text + 'method = "points"\npoints_at = [1.2, 2, 2.8]\nlargest_error_deg = 0.001\n')
    assert np.abs(recipe.ranked[0].error([1.2, 2, 2.8])).max() < 1e-7
    # Rounded to a millionth of its size.
    assert np.abs(recipe.found.error([1.2, 2, 2.8])).max() < 1e-3
    assert not recipe.design_checks[0].passed and recipe.design_checks[0].limit == 0.001
    assert recipe.found.wanted_at(2.5) - recipe.found.wanted_at(1.0) == pytest.approx(90 * (2.5**2 - 1) / 8)
