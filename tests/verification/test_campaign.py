"""Campaigns: hundreds of damages of files of all kinds are found, and a thousand folders of good files pass."""

import json
import random
import re
import shutil
from collections import Counter

import pytest

import geomkin as gk
from geomkin import build
from geomkin.verification import certificate
from tests.gallery import FIRST_OF_KIND, RECIPES
from tests.hostile.mutations import good_recipes, varied
from tests.verification.damage import damage_folder, made_in_every_format

DAMAGES, DAMAGED_RECIPES, GOOD = 500, 30, 1000
SHARES = 40


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    """Folders of recipes of different kinds, each in all formats that it has."""
    names, good = sorted(FIRST_OF_KIND.values()), tmp_path_factory.mktemp("good")
    random.Random(1).shuffle(names)
    recipes = dict(good_recipes())
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(RECIPES)
        return [made_in_every_format(recipes[f"gallery {name}"], name, good) for name in names[:DAMAGED_RECIPES]]


def harmless(order, notes):
    """Why a damage that is not found changes nothing that is made; "" if it does."""
    if len(notes) != 1:
        return ""
    if "another order" in notes[0] and ".svg: swap <" in order:
        return "the same lines are cut or engraved in another order"
    if re.search(r"\.(stl: swap \d|3mf: swap <triangle)", order):
        return "the same triangles in another order"
    if re.search(r"^summary.json: .* (geomkin|numpy|shapely|ezdxf|trimesh)$", order):
        return "the version of a program that wrote the files, which may differ"
    return ""


def _stated(tally):
    """The counts of each format, a line each."""
    for name in sorted({name for name, _ in tally}):
        print(f"{name:<14}", ", ".join(f"{what} {tally[one, what]}" for one, what in sorted(tally) if one == name))


@pytest.fixture
def made_once(monkeypatch):
    """A recipe that was made again is kept, since most damages leave it as it is."""
    kept = {}

    def computed(recipe, only=None, rows=()):
        key = (recipe.name, json.dumps(recipe.loaded_table, sort_keys=True, default=str), tuple(only or ()), rows)
        if key not in kept:
            kept[key] = build.computed(recipe, only, rows)
        return kept[key]

    monkeypatch.setattr(certificate, "computed", computed)


@pytest.mark.campaign
@pytest.mark.parametrize("share", range(SHARES))
def test_every_damage_is_found(tmp_path, monkeypatch, made_once, folders, share):
    monkeypatch.chdir(RECIPES)
    missed, tally = [], Counter()
    assert len(folders) == DAMAGED_RECIPES
    for k in range(share, DAMAGES, SHARES):
        rng = random.Random(k)
        folder = shutil.copytree(folders[k % len(folders)], tmp_path / "bad" / folders[k % len(folders)].name)
        order = damage_folder(folder, folders, rng)
        suffix = re.search(r"\.(\w+)", order)[1]
        try:
            (result,) = gk.verify(folder)
        except gk.FileError:
            # The summary is gone.
            tally[suffix, "found"] += 1
            shutil.rmtree(folder)
            continue
        tally[suffix, "not found" if result.passed else "found"] += 1
        if result.passed:
            notes = [file.note for file in result.files if file.note]
            missed.append((harmless(order, notes), f"{folder.name}/{order}: {notes}"))
            print(k, *missed[-1], flush=True)
        shutil.rmtree(folder)
    _stated(tally)
    print(f"{len(missed)} not found")
    assert all(reason for reason, _ in missed), [order for reason, order in missed if not reason]


@pytest.mark.campaign
@pytest.mark.parametrize("share", range(SHARES))
def test_good_folders_pass(tmp_path, monkeypatch, share):
    """Recipes of all kinds with some numbers changed, many at another scale, in one of three sets of formats."""
    monkeypatch.chdir(RECIPES)
    rng, recipes = random.Random(share), good_recipes()[share::SHARES]
    passed, tried, faults, tally = 0, 0, [], Counter()
    while passed + len(faults) < GOOD // SHARES:
        name, recipe = recipes[tried % len(recipes)]
        tried += 1
        recipe = varied(recipe, rng)
        recipe.get("files", {}).pop("write", None)
        formats = rng.choice([None, ["dxf", "svg", "3mf", "step"], ["glb", "assembly-3mf", "sheet-dxf", "bom"]])
        scale = rng.choice([1, 1, 0.02, 25.4, 100])
        table = {**recipe, "files": {**recipe.get("files", {}), **({"write": formats} if formats else {})}}
        if scale != 1 and "units" not in recipe:
            table = {**table, "scale": scale}
            table["files"]["tolerance"] = 0.005 * max(scale, 0.1)
        try:
            loaded = gk.load(table)
            made = gk.make(loaded, tmp_path)
        except (gk.GeomkinError, AssertionError):
            continue
        (result,) = gk.verify(tmp_path / made.name)
        passed += result.passed
        tally.update((one.format, one.proof or "no proof") for one in result.files)
        if not result.passed:
            faults.append(
                (name, scale, result.problems, [(one.file, one.problems) for one in result.files if one.problems])
            )
            print(faults[-1], flush=True)
        shutil.rmtree(tmp_path / made.name)
    _stated(tally)
    print(f"{passed} of {passed + len(faults)} good folders pass; {tried} recipes tried")
    assert not faults, faults
