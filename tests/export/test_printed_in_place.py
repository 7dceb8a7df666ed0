"""Sets that are printed in one piece: the written 3MF is sliced, and its bodies are apart in every layer."""

import zipfile
from itertools import combinations
from xml.etree import ElementTree

import numpy as np
import pytest
from shapely import distance

import geomkin as gk
from geomkin.build import check_recipe
from tests.export.crossed import region

CORE = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
STOCK = {"thickness": 6}
SET = {
    "kind": "planetary",
    "helix_angle_deg": 25,
    "herringbone": True,
    "tips": "full-clearance",
    "gears": {
        "planets": 3,
        "sun": {"teeth": 18, "module": 1.5, "profile_shift": 0.1},
        "planet": {"teeth": 15, "module": 1.5, "profile_shift": 0.1},
        "ring": {"teeth": 48, "module": 1.5, "addendum": 0.8, "profile_shift": 0.3},
    },
    "drive": {"step_deg": 30},
    "sun_stock": STOCK,
    "planet_stock": STOCK,
    "ring_stock": STOCK,
    "printing": {"clearance": 0.4, "in_place": True},
    "files": {"write": ["assembly-3mf"], "tolerance": 0.02},
}
PAIR = {
    "kind": "internal-gear-pair",
    "pinion": {"teeth": 18, "module": 2},
    "ring": {"teeth": 60, "module": 2, "addendum": 0.8},
    "printing": {"clearance": 0.5, "growth": 0.1, "foot": 0.4, "in_place": True},
    "files": {"write": ["assembly-3mf"], "tolerance": 0.02},
}


def bodies(path):
    """The triangles (m, 3, 3) of each body of an assembly, which is one object."""
    root = ElementTree.fromstring(zipfile.ZipFile(path).read("3D/3dmodel.model"))
    (whole,), (item,) = root.iter(f"{CORE}object"), root.iter(f"{CORE}item")
    assert item.get("objectid") == whole.get("id") and item.get("transform") is None
    corners = np.array([[float(v.get(axis)) for axis in "xyz"] for v in whole.iter(f"{CORE}vertex")])
    faces = np.array([[int(t.get(f"v{k}")) for k in (1, 2, 3)] for t in whole.iter(f"{CORE}triangle")])
    assert corners.min() >= 0
    # Corners that triangles join have one label, the least of all.
    labels, before = np.arange(len(corners)), None
    while before is None or (labels != before).any():
        before = labels.copy()
        np.minimum.at(labels, faces, labels[faces].min(axis=1)[:, None])
        labels = labels[labels]
    return [corners[faces[labels[faces[:, 0]] == one]] for one in np.unique(labels)]


@pytest.mark.parametrize("table, layers", [(SET, 3), (PAIR, 2)], ids=["planetary", "pinion"])
def test_bodies_are_apart_in_every_layer(table, layers, tmp_path):
    recipe = gk.load(table).with_name("set")
    made = gk.make(recipe, tmp_path)
    (check,) = (check for check in made.checks if check.id == "gap_in_place")
    meshes = bodies(tmp_path / "set" / "set-assembly.3mf")
    assert len(meshes) == sum(part.count for part in recipe.parts)
    height, least = recipe.parts[0].thickness, []
    for level in np.linspace(0.01, 0.99, layers) * height:
        shapes = [region(mesh, level) for mesh in meshes]
        least.append(min(distance(one, other) for one, other in combinations(shapes, 2)))
    growth = recipe.printing.growth
    # The written file is less the growth; the check states a lower bound of the design.
    assert check.value - 1e-6 <= min(least) - growth <= check.value + 0.08 and check.passed
    assert check.value == pytest.approx(table["printing"]["clearance"] / 2 * np.cos(np.radians(20)), abs=0.06)


def test_a_turned_planet_is_found():
    """The gap closes if the file's planet is turned by the backlash, so that slicing can see a fault."""
    recipe = gk.load(PAIR)
    pinion, ring = recipe.parts
    assert pinion.thickness == ring.thickness
    tight = {**PAIR, "printing": {"clearance": 0.05, "in_place": True}}
    (check,) = (check for check in gk.load(tight).checks if check.id == "gap_in_place")
    assert not check.passed


def test_nothing_is_bought_or_assembled():
    recipe = gk.load(SET)
    assert recipe.bought == () and len(recipe.steps) == 1


def test_parts_that_lie_on_each_other_have_no_gap():
    table = {**SET, "planet_stock": {"thickness": 6, "bore": 5}}
    (check,) = (check for check in gk.load(table).checks if check.id == "gap_in_place")
    assert check.value == 0 and not check.passed


@pytest.mark.parametrize(
    "table",
    [
        {"kind": "four-bar", "linkage": {"ground": 100, "crank": 30, "coupler": 90, "rocker": 70}},
        {"kind": "gear-pair", "first": {"teeth": 20, "module": 2}, "second": {"teeth": 30, "module": 2}},
        {**SET, "base": {}, "sun_stock": {"bore": 8}, "ring_stock": {"rim": 12}, "planet_stock": {}},
    ],
    ids=["linkage", "pair", "base"],
)
def test_what_cannot_be_printed_in_place_is_refused_by_name(table):
    with pytest.raises(gk.RecipeError) as refused:
        check_recipe({**table, "printing": {"clearance": 0.4, "in_place": True}})
    assert [problem.key for problem in refused.value.problems] == ["printing.in_place"]
