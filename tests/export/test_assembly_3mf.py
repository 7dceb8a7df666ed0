"""The assembly as a 3MF, read back: every part by its name where the motion has it, and helical teeth that mesh."""

import io
import xml.etree.ElementTree as ET
import zipfile

import numpy as np
import pytest

import geomkin as gk
from tests.export.crossed import region

CORE = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
FILES = "[files]\ntolerance = 0.02\nassembly_at = "
PAIR = """kind = "gear-pair"
helix_angle_deg = 30
first = { teeth = 12, module = 2, profile_shift = 0.3, tooth_thickness_allowance = 0.08 }
second = { teeth = 19, module = 2 }
"""
RACK = """kind = "rack-and-pinion"
helix_angle_deg = 25
hand = "left"
pinion = { teeth = 17, module = 2, tooth_thickness_allowance = 0.08 }
rack = { teeth = 9, module = 2 }
"""
PLANETARY = """kind = "planetary"
helix_angle_deg = 20
[gears]
planets = 2
sun = { teeth = 12, module = 2, profile_shift = 0.3, tooth_thickness_allowance = 0.08 }
planet = { teeth = 18, module = 2, profile_shift = -0.3, tooth_thickness_allowance = 0.08 }
ring = { teeth = 48, module = 2, profile_shift = -0.3, addendum = 0.8 }
[planet_stock]
bore = 6
"""
FOUR_BAR = """kind = "four-bar"
linkage = { ground = 100, crank = 30, coupler = 90, rocker = 70 }
files = { assembly_at = 90 }
"""


def matrix(text):
    """(4, 3): a point and a 1 times it."""
    return np.array([float(x) for x in text.split()]).reshape(4, 3)


def read(content):
    """Name and corners (m, 3, 3), mm, of the triangles of each part, where it stands but for the last shift."""
    package = zipfile.ZipFile(io.BytesIO(content))
    model = ET.fromstring(package.read("3D/3dmodel.model"))
    objects = {one.get("id"): one for one in model.iter(f"{CORE}object")}
    (item,) = model.iter(f"{CORE}item")
    whole, shift, found = objects[item.get("objectid")], matrix(item.get("transform")), []
    assert (shift[:3] == np.eye(3)).all() and shift[3, 2] == 0
    for component in whole.iter(f"{CORE}component"):
        one = objects[component.get("objectid")]
        points = np.array([[*(float(v.get(k)) for k in "xyz"), 1] for v in one.iter(f"{CORE}vertex")])
        faces = np.array([[int(t.get(k)) for k in ("v1", "v2", "v3")] for t in one.iter(f"{CORE}triangle")])
        placed = points @ matrix(component.get("transform"))
        assert (placed + shift[3]).min() >= 0
        found.append((one.get("name"), placed[faces]))
    return found


def written(recipe, tmp_path):
    (path,) = gk.write(recipe, tmp_path / "a-assembly.3mf")
    return path.read_bytes()


def test_every_plate_is_where_the_motion_has_it(tmp_path):
    recipe = gk.load(FOUR_BAR)
    found = dict(read(written(recipe, tmp_path)))
    motion = gk.move(recipe.linkage, np.array([np.pi / 2]))
    parts = {part.name: part for part in recipe.parts if part.body}
    assert set(found) == set(parts)
    for name, part in parts.items():
        corners, body = found[name], motion.bodies[part.body]
        low = recipe.made.stack.layers[name] * part.thickness
        assert (corners[..., 2].min(), corners[..., 2].max()) == pytest.approx((low, low + part.thickness))
        z = gk.flatten(part.outline, 1e-3)
        placed = body.origin.position[0] + body.direction[0] * z
        seen = [corners[..., 0].min(), corners[..., 1].min(), corners[..., 0].max(), corners[..., 1].max()]
        assert seen == pytest.approx(
            [placed.real.min(), placed.imag.min(), placed.real.max(), placed.imag.max()], abs=0.01
        )


@pytest.mark.parametrize(
    ("text", "at", "meshes"),
    [
        pytest.param("herringbone = true\n" + PAIR, 11, [("first", "second")], marks=pytest.mark.campaign),
        (RACK, 5, [("pinion", "rack")]),
        pytest.param(PLANETARY, 40, [("sun", "planet"), ("planet", "ring")], marks=pytest.mark.campaign),
    ],
)
def test_helical_teeth_mesh_at_every_height(text, at, meshes, tmp_path):
    """Nowhere into each other, and nowhere apart by more than the play; with the wrong hand they cut each other."""
    parts = dict(reversed(read(written(gk.load(f"{text}\n{FILES}{at}"), tmp_path))))
    low, high = parts[meshes[0][0]][..., 2].min(), parts[meshes[0][0]][..., 2].max()
    for height in low + (high - low) * np.array([0.02, 0.41, 0.9]):
        for one, two in meshes:
            first, second = region(parts[one], height), region(parts[two], height)
            assert first.intersection(second).area < 1e-3
            assert first.distance(second) < 0.11


@pytest.mark.campaign
def test_helical_racks_lie_flat_and_apart_on_the_plate(tmp_path):
    stock = "[stock]\nthickness = 60\n"
    (path,) = gk.write(gk.load(RACK + stock + FILES + "0"), tmp_path / "a.3mf")
    model = ET.fromstring(zipfile.ZipFile(path).read("3D/3dmodel.model"))
    points = {
        one.get("id"): np.array([[*(float(v.get(k)) for k in "xyz"), 1] for v in one.iter(f"{CORE}vertex")])
        for one in model.iter(f"{CORE}object")
    }
    placed = [(points[i.get("objectid")] @ matrix(i.get("transform")))[:, :2] for i in model.iter(f"{CORE}item")]
    one, two = ([p.min(axis=0), p.max(axis=0)] for p in placed)
    # The room between two parts that are cut, of solids within their tolerance.
    assert min(one[0].min(), two[0].min()) >= 5 - 0.02
    assert (one[0] > two[1] + 4.96).any() or (two[0] > one[1] + 4.96).any()
