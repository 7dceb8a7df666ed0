"""Beds of the gallery's printed sets in PrusaSlicer: each part is an object of its own, sound, in its place."""

import re
import shutil
import subprocess
import zipfile
from collections import Counter
from xml.etree import ElementTree

import numpy as np
import pytest
import trimesh

import geomkin as gk
from tests.gallery import NAMES, RECIPES, recipe

CORE = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
TEXTS = {name: (RECIPES / f"{name}.toml").read_text("utf-8") for name in NAMES}
BEDS = [name for name, text in TEXTS.items() if "\n[printing]" in text and '"3mf"' in text]
# Largest difference of sizes, mm, and relative one of volumes: the program stores single precision.
SIZE, VOLUME = 1e-3, 1e-4


def slicer(*arguments, timeout):
    return subprocess.run(["prusa-slicer", *arguments], capture_output=True, text=True, timeout=timeout)


def objects(path):
    """Box and volume of each object as the program states them; none with open or repaired edges."""
    found = []
    for block in slicer("--info", path, timeout=120).stdout.split(f"[{path.name}]")[1:]:
        stated = dict(re.findall(r"^(\w+) = +(\S+)$", block, re.MULTILINE))
        assert stated["manifold"] == "yes" and stated["number_of_parts"] == "1"
        assert not {"open_edges", "edges_fixed", "degenerate_facets", "facets_removed"} & stated.keys()
        box = [float(stated[f"{end}_{axis}"]) for end in ("min", "max") for axis in "xyz"]
        found.append((box, float(stated["volume"])))
    return found


def placed(path):
    """Box and volume of each item of a bed, read by the standard library."""
    root = ElementTree.fromstring(zipfile.ZipFile(path).read("3D/3dmodel.model"))
    meshes = {}
    for item in root.iter(f"{CORE}object"):
        corners = np.array([[float(v.get(axis)) for axis in "xyz"] for v in item.iter(f"{CORE}vertex")])
        faces = [[int(t.get(f"v{k}")) for k in (1, 2, 3)] for t in item.iter(f"{CORE}triangle")]
        meshes[item.get("id")] = item.get("name"), trimesh.Trimesh(corners, faces, process=False)
    for item in root.iter(f"{CORE}item"):
        name, mesh = meshes[item.get("objectid")]
        matrix = np.array(item.get("transform").split(), dtype=float).reshape(4, 3)
        corners = mesh.vertices @ matrix[:3] + matrix[3]
        yield name, [*corners.min(axis=0), *corners.max(axis=0)], mesh.volume


@pytest.mark.campaign
@pytest.mark.skipif(shutil.which("prusa-slicer") is None, reason="no PrusaSlicer")
@pytest.mark.parametrize("name", BEDS)
def test_a_slicer_has_each_part_of_a_bed_as_an_object_in_its_place(name, tmp_path):
    own, names = recipe(name), []
    gk.make(own, tmp_path, only=["3mf"])
    for bed in sorted((tmp_path / name).glob("*.3mf")):
        read, (labels, *wanted) = objects(bed), zip(*placed(bed))
        names += labels
        for (box, volume), wanted_box, wanted_volume in zip(sorted(read), *zip(*sorted(zip(*wanted))), strict=True):
            assert box == pytest.approx(wanted_box, abs=SIZE) and volume == pytest.approx(wanted_volume, rel=VOLUME)
        sliced = slicer("-g", "--dont-arrange", "-o", str(tmp_path / "a.gcode"), bed, timeout=300)
        assert sliced.returncode == 0 and "filament used" in (tmp_path / "a.gcode").read_text()
    assert Counter(names) == {part.name: part.count for part in own.parts}
