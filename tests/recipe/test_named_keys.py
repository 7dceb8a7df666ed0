"""A refusal names a key that its author wrote, what stands there, and a range that has something in it."""

import tomllib
from pathlib import Path

import pytest

import geomkin as gk
from geomkin.build import errors_named_by_key
from geomkin.export.mesh import solid_cut

GALLERY = Path(__file__).parent.parent.parent / "recipes"
# Gallery recipe, dotted key, value: each is refused once the parts are worked out.
MUTATED = [
    ("shaper", "linkage.ground", 1e6),
    ("stephenson-dwell", "linkage.link", 1e6),
    ("motor-crank", "linkage.rocker", 2e-4),
    ("walker", "linkage.bodies.leg.E", [1e6, 0]),
    ("motor-gear", "stock.bore", 10),
    ("cognates", "linkage.coupler", 180),
    ("rocker-cam", "cam.program.0.rise_deg", 0),
    ("undercut-cam", "cam.follower.roller_radius", 1e-9),
    ("roller-cam", "cam.base_radius", 1e-9),
    ("rocker-cam", "cam.follower.pivot_distance", 1e-9),
    ("flat-rocker-cam", "cam.follower.pivot_distance", 2e-4),
    ("herringbone-pair", "files.tolerance", 2e-6),
]


def keys_of(held, path=""):
    yield path
    inner = held.items() if isinstance(held, dict) else enumerate(held) if isinstance(held, list) else ()
    for key, value in inner:
        yield from keys_of(value, f"{path}[{key}]" if isinstance(held, list) else f"{path}.{key}".lstrip("."))


def refusal(name, key, value):
    data = tomllib.loads((GALLERY / f"{name}.toml").read_text())
    *above, last = [int(part) if part.isdigit() else part for part in key.split(".")]
    held = data
    for part in above:
        held = held.setdefault(part, {}) if isinstance(held, dict) else held[part]
    held[last] = value
    with pytest.raises(gk.RecipeError) as refused:
        recipe = gk.load(data)
        with errors_named_by_key("recipe", recipe):
            _ = recipe.checks, [solid_cut(part, recipe.files.tolerance) for part in recipe.parts]
    return data, refused.value.problems[0]


@pytest.mark.parametrize(("name", "key", "value"), MUTATED)
def test_a_refusal_names_what_its_author_wrote(name, key, value):
    data, problem = refusal(name, key, value)
    # A key that was left out is said to have its default.
    assert problem.key in set(keys_of(data)) or "default" in problem.problem, problem
    if problem.key == key:
        assert f"{value:g}" in problem.problem
