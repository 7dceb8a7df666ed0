"""Recipes from a file, a text, a table and Python: the same recipe, the same files; refusals in a person's words."""

import dataclasses
import tomllib
from pathlib import Path

import numpy as np
import pytest

import geomkin as gk
from geomkin.recipe.kinds import KINDS, recipe_class
from geomkin.recipe.load import whole_table
from tests.campaign import by_default
from tests.texts import template_of

GEAR = 'kind = "spur-gear"\ngear = { teeth = 17, module = 2 }\nfiles = { write = ["csv"] }\n'
TABLE = tomllib.loads(GEAR)


def without_none(reported):
    """The same without what was left out, which TOML cannot say."""
    if isinstance(reported, list):
        return [without_none(part) for part in reported]
    return (
        {k: without_none(v) for k, v in reported.items() if v is not None} if isinstance(reported, dict) else reported
    )


@pytest.mark.parametrize("name", by_default(KINDS, slice(0, None, 2)))
def test_text_table_file_and_class_give_the_same_recipe(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    text = template_of(name)
    Path("new.toml").write_text(text)
    recipe = gk.load(text)
    assert recipe == gk.load(tomllib.loads(text)) == gk.load("new.toml") == gk.load(Path("new.toml"))
    assert gk.load("new.toml").name == "new" and recipe.name == ""
    fields = {f.name: getattr(recipe, f.name) for f in dataclasses.fields(recipe)}
    built = recipe_class(name)(**fields)
    assert built == recipe and type(built) is recipe_class(name)
    # The summary holds the recipe.
    assert gk.load(without_none(whole_table(recipe))) == recipe


def test_recipe_is_named_after_its_file_its_given_name_or_its_kind(tmp_path):
    (tmp_path / "from-file.toml").write_text(GEAR)
    made = [
        gk.make(tmp_path / "from-file.toml", tmp_path),
        gk.make(gk.load(tmp_path / "from-file.toml").with_name("called"), tmp_path),
        gk.make(GEAR, tmp_path),
        gk.make(TABLE, tmp_path),
        gk.make(gk.gear.SpurGearRecipe(gear=gk.SpurGear(17, 2)), tmp_path, only=["csv"]),
    ]
    assert [m.name for m in made] == ["from-file", "called", "spur-gear", "spur-gear", "spur-gear"]
    assert all((tmp_path / m.name / f"{m.name}.csv") in m.files and m.checks for m in made)


def test_properties_are_computed_once_and_kept_when_renamed():
    recipe = gk.load(GEAR)
    for what in ("design", "table", "parts", "checks"):
        first = getattr(recipe, what)
        assert getattr(recipe, what) is first and getattr(recipe.with_name("b"), what) is first
    assert recipe.with_name("b") == recipe and hash(recipe.with_name("b")) == hash(recipe) and recipe.name == ""
    with pytest.raises(dataclasses.FrozenInstanceError):
        recipe.name = "c"


def test_files_that_a_text_or_a_table_names_lie_in_the_working_folder(tmp_path, monkeypatch):
    rows = "cam_angle_deg,lift_mm\n" + "".join(
        f"{k},{10 - 10 * np.cos(np.radians(k)):.3f}\n" for k in range(0, 361, 10)
    )
    (tmp_path / "lift.csv").write_text(rows)
    follower = '{ kind = "translating-roller", roller_radius = 10 }'
    program = '[{ kind = "table", file = "lift.csv", decimals = 3 }]'
    text = f'kind = "disk-cam"\ncam = {{ base_radius = 40, follower = {follower}, program = {program} }}\n'
    with pytest.raises(gk.RecipeError, match="file"):
        gk.load(text)
    monkeypatch.chdir(tmp_path)
    assert gk.load(text) == gk.load(tomllib.loads(text))


def test_invalid_values_of_a_table_are_reported_by_key():
    for table, key in [
        ({}, "kind"),
        ({"kind": ["spur-gear"]}, "kind"),
        ({"kind": "spur-gear"}, "gear"),
        ({"kind": "spur-gear", "gear": None}, "gear"),
        ({"kind": "spur-gear", "gear": {"teeth": 24, "module": float("nan")}}, "gear.module"),
        ({"kind": "spur-gear", "gear": {"teeth": 24, "module": np.array([2.0, 3.0])}}, "gear.module"),
        (TABLE | {"files": {"write": "csv"}}, "files.write"),
        (TABLE | {"files": {"write": [{}]}}, "files.write[0]"),
        (TABLE | {"speed": 3}, "speed"),
        (TABLE | {"new\nline": 3}, "new?line"),
    ]:
        with pytest.raises(gk.RecipeError) as caught:
            gk.load(table)
        assert [p.key for p in caught.value.problems] == [key] and str(caught.value).isprintable()
