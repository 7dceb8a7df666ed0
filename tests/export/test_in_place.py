"""Assemblies as solids, of scenes made by hand: how high layers stand, what parts are called, in which colours."""

import io
import json
import xml.etree.ElementTree as ET
import zipfile

import numpy as np
import pytest
import trimesh

import geomkin as gk
from geomkin.export.job import Job, StaticSource
from geomkin.export.solids import assembly_package, glb
from geomkin.export.still import in_place, palette
from geomkin.model.scene import SceneBody
from tests.export.test_animated_marks import FRAMES, scene_of
from tests.export.test_assembly_3mf import CORE, matrix, read

ONE = np.ones(FRAMES, dtype=complex)
TURN = np.exp(0.2j * np.arange(FRAMES))
TRIANGLE = gk.plane.Polyline(np.array([-3 - 2j, 9 - 2j, -3 + 14j]))


def part(name, thick, twist=None):
    return gk.Part(name, TRIANGLE, (), thick, twist=twist)


# Of layers 2 and 4 nothing is cut, and 3 lies between them.
BODIES = (
    SceneBody("low", (part("plate", 3.0),), -40 * ONE + 10j, TURN, 1),
    SceneBody("thick", (part("plate", 5.0), part("other", 1.0)), 40 * ONE, ONE, 1),
    SceneBody("bare", (), 0 * ONE, ONE, 4),
    SceneBody("middle", (part("plate", 2.0),), 25j * TURN, TURN**2, 3),
    SceneBody("base", (part("top", 4.0),), -70 * ONE - 30j, ONE, 5, True),
    SceneBody("last", (part("last", 4.0),), -3 * ONE + 60j, ONE, 5),
)
LOW = {"plate": 0, "plate 2": 0, "other": 0, "plate 3": 10, "top": 17, "last": 17}


def job(at=30.0, bodies=BODIES):
    scene = scene_of(bodies=bodies)
    return Job("a", StaticSource(tuple(p for b in bodies for p in b.parts), scene.table, scene), 0.01, assembly_at=at)


def test_a_layer_is_as_thick_as_its_thickest_part_and_an_empty_one_as_the_thickest_of_all():
    _, placed = in_place(job())
    assert {one.name: one.height for one in placed} == LOW
    assert [one.body.name for one in placed] == ["low", "thick", "thick", "middle", "base", "last"]
    for one in placed:
        assert (one.origin, one.direction) == (one.body.origin[3], one.body.direction[3])


@pytest.mark.parametrize("write", [glb, assembly_package])
def test_solids_of_an_assembly_without_parts_are_refused(write):
    with pytest.raises(gk.DesignError) as refusal:
        write(job(bodies=(SceneBody("bare", (), 0 * ONE, ONE),)))
    assert refusal.value.field == "write"


def test_parts_of_a_package_stand_where_they_are_as_near_to_the_corner_as_a_hundredth():
    content = assembly_package(job())
    found = dict(read(content))
    assert set(found) == set(LOW)
    for one in in_place(job())[1]:
        corners = found[one.name]
        assert (corners[..., 2].min(), corners[..., 2].max()) == (LOW[one.name], LOW[one.name] + one.part.thickness)
        seen = np.unique(np.round(corners[..., 0] + 1j * corners[..., 1], 4))
        wanted = one.origin + one.direction * np.asarray(TRIANGLE.vertices)
        assert np.sort_complex(seen) == pytest.approx(np.sort_complex(np.round(wanted, 4)), abs=2e-3)
    model = ET.fromstring(zipfile.ZipFile(io.BytesIO(content)).read("3D/3dmodel.model"))
    (item,) = model.iter(f"{CORE}item")
    shift = matrix(item.get("transform"))[3]
    low = np.min([corners.reshape(-1, 3).min(axis=0) for corners in found.values()], axis=0)
    assert (0 <= low + shift).all() and (low + shift < [0.02, 0.02, 1e-9]).all()
    numbers = [one.get("id") for one in model.iter(f"{CORE}object")]
    assert numbers == [str(k) for k in range(1, 8)] and item.get("objectid") == "7"


def test_a_model_has_every_part_where_it_stands_in_the_colour_of_its_body():
    content = glb(job())
    # A block of JSON, its length before it, states the nodes; their matrices by columns.
    nodes = json.loads(content[20 : 20 + int.from_bytes(content[12:16], "little")])["nodes"]
    assert [one["matrix"][3::4] for one in nodes if "matrix" in one] == [[0, 0, 0, 1]] * len(LOW)
    scene = trimesh.load(io.BytesIO(content), file_type="glb")
    colours = {"low": "t0", "thick": "t1", "bare": "t2", "middle": "t3", "base": "ground", "last": "t4"}
    for one in in_place(job())[1]:
        transform, geometry = scene.graph[one.name]
        mesh = scene.geometry[geometry].copy()
        colour = palette()[colours[one.body.name]].lstrip("#")
        red, green, blue = (int(colour[k : k + 2], 16) for k in (0, 2, 4))
        assert (mesh.visual.vertex_colors == [red, green, blue, 255]).all()
        mesh.apply_transform(transform)
        x, y, z = 1e3 * mesh.vertices.T
        # Metres, y up.
        assert (y.min(), y.max()) == pytest.approx((LOW[one.name], LOW[one.name] + one.part.thickness), abs=1e-4)
        wanted = one.origin + one.direction * np.asarray(TRIANGLE.vertices)
        seen = np.unique(np.round(x - 1j * z, 3))
        assert np.sort_complex(seen) == pytest.approx(np.sort_complex(np.round(wanted, 3)), abs=2e-3)
        assert mesh.volume == pytest.approx(96e-9 * one.part.thickness, rel=1e-5)
