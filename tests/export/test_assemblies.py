"""Bills, packages for printers and assemblies of solids, read back by other means than they were written with."""

import csv
import io
import xml.etree.ElementTree as ET
import zipfile
from collections import Counter

import numpy as np
import pytest
import trimesh

import geomkin as gk

CORE = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
RECIPE = """kind = "four-bar"
linkage = { ground = 100, crank = 30, coupler = 90, rocker = 70 }
files = { assembly_at = 90 }
"""


@pytest.fixture(scope="module")
def recipe():
    return gk.load(RECIPE)


def volume(part):
    return (gk.area(part.outline) - sum(gk.area(hole) for hole in part.holes)) * part.thickness


def test_bill_lists_parts_and_hardware(recipe, tmp_path):
    (path,) = gk.write(recipe, tmp_path / "four-bar-bom.csv")
    rows = list(csv.DictReader(path.read_text().splitlines()))
    cut = {row["item"]: row for row in rows if row["thickness_mm"]}
    bought = {row["item"]: row for row in rows if not row["thickness_mm"]}
    assert {name: int(row["count"]) for name, row in cut.items()} == {p.name: p.count for p in recipe.parts}
    assert float(cut["crank"]["width_mm"]) == pytest.approx(44) and float(cut["crank"]["height_mm"]) == pytest.approx(
        14
    )
    assert {name: int(row["count"]) for name, row in bought.items()} == {b.name: b.count for b in recipe.bought}
    assert {letter for row in bought.values() for letter in row["joints"].split()} == set("ABCD")


def test_a_package_for_printers_holds_every_copy_flat_and_apart(recipe, tmp_path):
    (path,) = gk.write(recipe, tmp_path / "four-bar.3mf")
    package = zipfile.ZipFile(io.BytesIO(path.read_bytes()))
    assert package.namelist()[0] == "[Content_Types].xml" and package.testzip() is None
    model = ET.fromstring(package.read("3D/3dmodel.model"))
    assert model.get("unit") == "millimeter"
    parts, found, boxes = {part.name: part for part in recipe.parts}, {}, []
    for item in model.iter(f"{CORE}object"):
        points = np.array([[float(v.get(k)) for k in "xyz"] for v in item.iter(f"{CORE}vertex")])
        faces = np.array([[int(t.get(k)) for k in ("v1", "v2", "v3")] for t in item.iter(f"{CORE}triangle")])
        mesh = trimesh.Trimesh(points, faces, process=False)
        part = parts[item.get("name")]
        assert mesh.is_watertight and mesh.volume == pytest.approx(volume(part), rel=2e-3)
        found[item.get("id")] = part, mesh.bounds
    items = [(i.get("objectid"), [float(x) for x in i.get("transform").split()]) for i in model.iter(f"{CORE}item")]
    assert Counter(found[number][0].name for number, _ in items) == {p.name: p.count for p in recipe.parts}
    for number, (*turn, x, y, z) in items:
        cosine, sine = turn[:2]
        assert turn == [cosine, sine, 0, -sine, cosine, 0, 0, 0, 1] and z == 0 and cosine**2 + sine**2 == 1
        corners = found[number][1][:, :2] @ [[cosine, sine], [-sine, cosine]] + [x, y]
        boxes.append((corners.min(axis=0), corners.max(axis=0)))
    for k, (low, high) in enumerate(boxes):
        assert low.min() >= 0
        assert not any((low < up).all() and (down < high).all() for down, up in boxes[:k])


def test_an_assembly_has_every_plate_where_the_motion_has_it(recipe, tmp_path):
    (path,) = gk.write(recipe, tmp_path / "four-bar-assembly.glb")
    scene = trimesh.load(path)
    motion = gk.move(recipe.linkage, np.array([np.pi / 2]))
    parts = {part.name: part for part in recipe.parts if part.body}
    assert set(scene.geometry) == set(parts)
    for name, part in parts.items():
        transform, geometry = scene.graph[name]
        mesh, body = scene.geometry[geometry], motion.bodies[part.body]
        # Metres, y up: back to millimetres, z up.
        origin = 1e3 * transform[:3, 3] @ np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]])
        assert origin[0] + 1j * origin[1] == pytest.approx(body.origin.position[0], abs=1e-6)
        assert origin[2] == pytest.approx(recipe.made.stack.layers[name] * part.thickness)
        ahead = transform[:3, 0] * 1e3
        assert ahead[0] - 1j * ahead[2] == pytest.approx(body.direction[0], abs=1e-9)
        assert mesh.volume == pytest.approx(volume(part), rel=2e-3)
