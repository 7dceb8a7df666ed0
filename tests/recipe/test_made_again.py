"""Files of a recipe made again: which are written, which stay, which go; and errors under the recipe's own keys."""

import pytest

import geomkin as gk
from geomkin.build import errors_named_by_key

BARS = """
kind = "four-bar"
[linkage]
ground = 100
crank = 30
coupler = 90
rocker = 70
[drive]
step_deg = 45
[files]
write = ["csv", "svg", "stl"]
"""


def names(folder):
    return {path.name for path in folder.iterdir()}


def test_only_those_of_the_asked_for_are_written_or_of_all_where_none_is_named(tmp_path):
    plain = BARS.partition("[files]")[0]
    assert {p.name for p in gk.make(plain, tmp_path, ["page"]).files} == {"four-bar.html", "summary.json"}
    some = {p.name for p in gk.make(BARS, tmp_path, ["page", "csv"]).files}
    assert some == {"four-bar.csv", "summary.json"}
    with pytest.raises(gk.RecipeError) as refusal:
        gk.make(BARS, tmp_path, ["page", "glb"])
    (problem,) = refusal.value.problems
    assert problem.key == "files.write"


@pytest.mark.parametrize(
    ("field", "key"),
    [
        ("crank", "linkage.crank"),
        ("stock.thickness", "stock.thickness"),
        ("drive", "drive"),
        ("tolerance", "files.tolerance"),
        ("assembly_at", "files.assembly_at"),
        # A part, or a thing that no key has.
        ("coupler-2", "linkage"),
        ("plate", "linkage"),
        ("kind", "kind"),
    ],
)
def test_a_design_s_error_is_reported_under_the_recipe_s_key(field, key):
    recipe = gk.load(BARS)
    with pytest.raises(gk.RecipeError) as refusal, errors_named_by_key("in/a.toml", recipe):
        raise gk.DesignError(field, "found 1", "give 2")
    assert refusal.value.file == "in/a.toml" and [problem.key for problem in refusal.value.problems] == [key]
