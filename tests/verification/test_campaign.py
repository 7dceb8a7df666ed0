"""Campaigns: all of hundreds of damaged files are found, and over a thousand files of random recipes pass."""

import random
import shutil

import numpy as np
import pytest

import geomkin as gk
from tests.gallery import RECIPES
from tests.hostile.mutations import good_recipes, varied
from tests.verification.damage import damaged, damages, only, wrong

DAMAGES = 300
# Sets of random recipes, and recipes in each.
SETS, RECIPES_OF_A_SET = 4, 75


@pytest.mark.campaign
def test_every_damage_is_found(good, tmp_path):
    missed = []
    for damage in damages(np.random.default_rng(9), DAMAGES):
        folder = shutil.copytree(good, tmp_path / damage.name)
        name = damaged(folder, damage)
        only(folder, name)
        if name not in wrong(folder):
            missed.append(damage)
        shutil.rmtree(folder)
    assert not missed


@pytest.mark.campaign
@pytest.mark.parametrize("seed", range(SETS))
def test_files_of_random_recipes_pass(tmp_path, monkeypatch, seed):
    """Recipes of all kinds with a few numbers changed; those that are refused are left out."""
    monkeypatch.chdir(RECIPES)
    rng = random.Random(seed)
    recipes = good_recipes()
    rng.shuffle(recipes)
    measured, faults = 0, []
    for name, recipe in recipes[:RECIPES_OF_A_SET]:
        recipe = varied(recipe, rng)
        recipe.get("files", {}).pop("write", None)
        try:
            made = gk.make(recipe, tmp_path, ["dxf", "svg", "csv", "bom"])
        except gk.GeomkinError:
            continue
        (certificate,) = gk.verify(tmp_path / made.name)
        measured += sum(file.measured for file in certificate.files)
        faults += [(name, file.file, file.problems) for file in certificate.files if not file.passed]
    assert not faults
    assert measured > 3 * RECIPES_OF_A_SET
