"""STL and 3MF as a printer gets them: sections of the meshes against the curves of the parts, offset by shapely."""

import zipfile
from xml.etree import ElementTree

import numpy as np
import pytest
import trimesh
from shapely import distance, get_coordinates, get_parts, linestrings, points, polygonize, union_all
from shapely.affinity import affine_transform
from shapely.geometry import Polygon

import geomkin as gk
from geomkin.build import check_recipe
from geomkin.plane.flatten import flatten
from geomkin.plane.vec import xy
from geomkin.verification.comparison import exact_part
from geomkin.verification.read_back import read_stl
from geomkin.verification.solids import measure_mesh

GAP, GROWTH, FOOT, TOLERANCE = 0.3, 0.16, 0.4, 0.02
GEARS = {
    "kind": "gear-pair",
    "first": {"teeth": 12, "module": 2, "profile_shift": 0.3},
    "second": {"teeth": 16, "module": 2},
    "first_stock": {"bore": 5, "thickness": 5},
    "second_stock": {},
}
PRINTING = {"clearance": GAP, "growth": GROWTH, "foot": FOOT}
CORE = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"


def exact(part, growth=GROWTH):
    """The section of a part as it must be printed."""
    rings = [xy(flatten(curve, 1e-3)) for curve in (part.outline, *part.holes)]
    return Polygon(rings[0], rings[1:]).buffer(-growth / 2, quad_segs=12)


def section(mesh, height):
    """The section of a mesh as one shape."""
    lines = trimesh.intersections.mesh_plane(mesh, [0, 0, 1], [0, 0, height])[:, :, :2]
    # Holes are faces of their own; the plate is the largest, with its holes.
    return max(get_parts(polygonize(list(linestrings(np.round(lines, 6))))), key=lambda shape: shape.area)


def apart(one, other):
    return max(distance(points(get_coordinates(a)), b.boundary).max() for a, b in ((one, other), (other, one)))


def problems(table):
    with pytest.raises(gk.RecipeError) as refused:
        check_recipe({**table, "files": {"write": ["stl"]}})
    return [problem.key for problem in refused.value.problems]


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The recipe, and the folder of its files."""
    out = tmp_path_factory.mktemp("printed")
    files = {"write": ["stl", "3mf"], "sheet": [50, 50], "tolerance": TOLERANCE, "labels": False}
    recipe = gk.load({**GEARS, "printing": PRINTING, "files": files}).with_name("pair")
    gk.make(recipe, out)
    return recipe, out / "pair"


@pytest.mark.campaign
def test_sections_are_less_the_growth_and_the_chamfer(made):
    recipe, folder = made
    for part in recipe.parts:
        mesh, whole = trimesh.load(folder / f"{part.name}.stl"), exact(part)
        assert mesh.is_watertight and mesh.is_winding_consistent and mesh.volume > 0
        # Rounded corners of the chamfer differ by a little of its size.
        for height, off in ((1e-5, 2 * TOLERANCE), (FOOT / 2, 0.1 * FOOT)):
            assert apart(section(mesh, height), whole.buffer(height - FOOT, quad_segs=12)) < off, part.name
        for height in (FOOT * 1.001, part.thickness / 2, part.thickness - 1e-5):
            assert apart(section(mesh, height), whole) < 1.1 * TOLERANCE, part.name
        ends = whole.area, whole.buffer(-FOOT).area
        assert mesh.volume == pytest.approx(ends[0] * part.thickness - FOOT * (ends[0] - ends[1]) / 2, rel=1e-3)


def test_beds_hold_all_copies_apart(made):
    """3MF read by the standard library: each part with its name and height, on beds of the size, none meeting."""
    recipe, folder = made
    found = []
    beds = sorted(folder.glob("*.3mf"))
    assert [bed.name for bed in beds] == ["pair-2.3mf", "pair.3mf"]
    for bed in beds:
        root = ElementTree.fromstring(zipfile.ZipFile(bed).read("3D/3dmodel.model"))
        meshes = {}
        for item in root.iter(f"{CORE}object"):
            corners = [[float(v.get(axis)) for axis in "xyz"] for v in item.iter(f"{CORE}vertex")]
            faces = [[int(t.get(f"v{k}")) for k in (1, 2, 3)] for t in item.iter(f"{CORE}triangle")]
            meshes[item.get("id")] = item.get("name"), trimesh.Trimesh(corners, faces)
        shapes = []
        for item in root.iter(f"{CORE}item"):
            name, mesh = meshes[item.get("objectid")]
            m = np.array(item.get("transform").split(), dtype=float).reshape(4, 3)
            assert m[3, 2] == mesh.bounds[0, 2] == 0
            shape = section(mesh, mesh.bounds[1, 2] / 2)
            shapes.append(affine_transform(shape, [m[0, 0], m[1, 0], m[0, 1], m[1, 1], m[3, 0], m[3, 1]]))
            found.append((name, round(mesh.bounds[1, 2], 4)))
        assert union_all(shapes).area == pytest.approx(sum(shape.area for shape in shapes))
        low_x, low_y, high_x, high_y = union_all(shapes).bounds
        assert 0 <= low_x and 0 <= low_y and high_x <= 50 and high_y <= 50
    assert sorted(found) == sorted((p.name, p.thickness) for p in recipe.parts for _ in range(p.count))


@pytest.mark.campaign
@pytest.mark.parametrize(
    "growth, foot, passes",
    [(GROWTH, FOOT, True), (GROWTH + 0.01, FOOT, True), (0.0, FOOT, False), (GROWTH, 0.0, False), (GROWTH, 0.3, False)],
)
def test_certificate_measures_printed_solids(made, growth, foot, passes):
    """The solid of another table is measured against the curves of this one."""
    recipe, folder = made
    other = gk.load({**GEARS, "printing": {"clearance": GAP, "growth": growth, "foot": foot}})
    gk.write(other, folder.parent / f"{growth}-{foot}.stl", tolerance=TOLERANCE / 2)
    (mesh,), _, _ = read_stl(folder.parent / "first.stl")
    found = measure_mesh(mesh, exact_part(recipe.parts[0], recipe.files, recipe.printing), TOLERANCE)
    assert (not found.problems and found.deviation <= 1.1 * TOLERANCE) == passes, found.problems


def test_the_folder_is_certified(made):
    (certificate,) = gk.verify(made[1])
    assert certificate.passed


def test_drawings_and_steps_have_the_designed_size(made):
    recipe, folder = made
    plain = gk.load({**GEARS, "printing": {"clearance": GAP}})
    for ending in ("dxf", "step"):
        gk.write(recipe.parts[:1], folder.parent / f"one.{ending}")
        gk.write(plain.parts[:1], folder.parent / f"two.{ending}")
        one, two = (folder.parent / f"{name}.{ending}" for name in ("one", "two"))
        assert one.read_bytes() == two.read_bytes().replace(b"two", b"one")


def test_helical_gears_are_less_the_growth_in_each_layer(tmp_path):
    table = {**GEARS, "helix_angle_deg": 20, "printing": {"clearance": GAP, "growth": GROWTH}}
    gk.make(gk.load(table).with_name("pair"), tmp_path, only=["stl"])
    part = gk.load(table).parts[0]
    mesh = trimesh.load(tmp_path / "pair" / "first.stl")
    assert mesh.is_watertight
    assert apart(section(mesh, 1e-5), exact(part)) < 1.1 * TOLERANCE
    assert problems({**table, "printing": PRINTING}) == ["printing.foot"]


def test_what_does_not_fit_is_refused_by_name():
    small = {**GEARS, "first": {"teeth": 12, "module": 0.8}, "second": {"teeth": 24, "module": 0.8}}
    for key, value in (("foot", 1.9), ("growth", 2), ("growth", -2)):
        table = {**small, "first_stock": {"bore": 4}, "second_stock": {}, "printing": {"clearance": 0.1, key: value}}
        assert problems(table) == [f"printing.{key}"]
    for growth in (2.1, -2.1):
        with pytest.raises(gk.RecipeError):
            gk.load({**GEARS, "printing": {"clearance": 0.1, "growth": growth}})
