"""Certificates: good files pass, and every kind of damage is found at its file and place."""

import json
import re
import struct
import time
import zipfile

import numpy as np
import pytest
import trimesh

import geomkin as gk
from geomkin.verification import comparison, outline
from tests.verification.damage import RECIPE, damaged, damages, dxf_bulge, dxf_vertex, only, wrong

# All files of the four-bar; one part stands for all of them without a campaign.
FILES = ["bars.dxf", "bars.svg", "crank.stl", "crank.step", "bars.3mf", "bars.csv", "bars-bom.csv"]


@pytest.mark.parametrize("files", [FILES, pytest.param(None, marks=pytest.mark.campaign)], ids=["some", "all"])
def test_good_files_pass_and_deviate_by_less_than_the_tolerance(copy, files):
    if files:
        only(copy, *files)
    (certificate,) = gk.verify(copy)
    assert certificate.passed
    measured = {file.file: file for file in certificate.files if np.isfinite(file.deviation)}
    assert {name.rpartition(".")[2] for name in measured} >= {"dxf", "svg", "stl", "step", "3mf"}
    assert ("bars-assembly.glb" in measured) == (files is None)
    assert all(0 < file.deviation < 1.08 * 0.005 for file in measured.values())
    drawing = measured["bars.dxf"]
    counts = json.loads((copy / "summary.json").read_text())["parts"]
    assert drawing.parts == sum(part["count"] for part in counts)


@pytest.mark.parametrize(
    ("settings", "ending"), [('curves = "arcs"\nkerf = 0.2', "dxf"), ('style = "laser"\nsheet = [130, 60]', "svg")]
)
def test_other_ways_of_writing_pass(tmp_path, settings, ending):
    gk.make(gk.load(RECIPE.replace("write =", f"{settings}\nwrite =")).with_name("bars"), tmp_path, [ending])
    assert not wrong(tmp_path / "bars")


def test_a_vertex_off_its_curve_is_named_with_its_place(copy):
    """Moved by 0.02 mm across its curve, in DXF."""
    dxf_vertex(copy, np.random.default_rng(1), 0.02)
    only(copy, "bars.dxf", "crank.stl")
    (name, file), *others = wrong(copy).items()
    assert name == "bars.dxf" and not others
    assert 0.014 < file.deviation < 0.0215
    assert file.part and len(file.problems) == 1


# All kinds of damage are tried in campaigns.
SOME = ("dxf vertex", "layer", "stl vertex", "step radius", "csv number", "bill count", "glb bits", "3mf triangle")
DAMAGES = [damage for damage in damages(np.random.default_rng(5), 30) if damage.kind in SOME]


@pytest.mark.parametrize("damage", DAMAGES, ids=lambda damage: damage.name)
def test_damage_is_found(copy, damage):
    name = damaged(copy, damage)
    only(copy, name)
    assert name in wrong(copy)


def test_a_check_at_vertices_alone_misses_a_bulge(copy, monkeypatch):
    name = dxf_bulge(copy, np.random.default_rng(6))
    only(copy, name)
    assert name in wrong(copy)

    def farthest_vertex(outline, edges, resolution):
        distance = edges.nearest(outline.points)[1]
        return distance.max(), complex(outline.points[distance.argmax()])

    monkeypatch.setattr(outline.Pen, "edge", lambda pen, start, *rest: pen.add(np.array([start])))
    for module in (outline, comparison):
        monkeypatch.setattr(module, "farthest", farthest_vertex)
    assert not wrong(copy)


def test_another_recipe_of_the_same_name_is_recognised(copy, tmp_path_factory):
    other = tmp_path_factory.mktemp("other")
    gk.make(gk.load(RECIPE.replace("rocker = 70", "rocker = 70.001")).with_name("bars"), other, ["svg"])
    (copy / "bars.svg").write_bytes((other / "bars" / "bars.svg").read_bytes())
    only(copy, "bars.svg", "crank.stl")
    assert set(wrong(copy)) == {"bars.svg"}


def test_a_file_of_another_program_is_measured(copy):
    text = (copy / "bars.svg").read_text()
    (copy / "bars.svg").write_text(
        re.sub(r"<desc>.*?</desc>", "", text).replace("<g ", '<g transform="translate(2.5,1.25)" ')
    )
    only(copy, "bars.svg")
    file = wrong(copy)["bars.svg"]
    assert len(file.problems) == 1 and file.deviation < 1.08 * 0.005


def test_hostile_files_are_refused_in_bounded_time(copy):
    bomb = '<?xml version="1.0"?><!DOCTYPE svg [<!ENTITY a "aaaaaaaaaa">]><svg xmlns="http://www.w3.org/2000/svg">&a;</svg>'
    (copy / "bars.svg").write_text(bomb)
    (copy / "bars.step").unlink(missing_ok=True)
    (copy / "crank.step").write_text("ISO-10303-21;HEADER;DATA;" + "#1=EDGE_LOOP('',(#1));" * 1000)
    (copy / "crank.stl").write_bytes(bytes(80) + struct.pack("<I", 2**31) + bytes(50))
    (copy / "bars-bom.csv").write_text('item,count\n"=HYPERLINK(1)",1\n')
    only(copy, "bars.svg", "crank.step", "crank.stl", "bars-bom.csv")
    found = wrong(copy)
    assert {"bars.svg", "crank.step", "crank.stl", "bars-bom.csv"} == set(found)
    # What is wrong is said of the file, not of the program that reads it.
    assert not any("Error" in problem for report in found.values() for problem in report.problems)


@pytest.mark.parametrize(
    ("name", "shape"),
    [
        ("bars.svg", '<circle cx="5" cy="5" r="90000000"/>'),
        ("bars.svg", '<path d="M0,0 A9e7,9e7 0 1 1 1,0 Z"/>'),
        ("bars.svg", '<circle cx="5" cy="5" r="0.1"/>'),
        ("bars.dxf", "  0\nCIRCLE\n  8\nHOLE\n 10\n5.0\n 20\n5.0\n 40\n90000000.0\n"),
    ],
    ids=["large circles", "large arcs", "many parts", "large circles in DXF"],
)
def test_many_shapes_are_refused_before_they_are_measured(copy, name, shape):
    """Their chords or pairs would fill the memory, or take hours."""
    text = (copy / name).read_text()
    end = text.rindex("</svg>" if name.endswith("svg") else "  0\nENDSEC\n  0\nSECTION\n  2\nOBJECTS")
    (copy / name).write_text(text[:end] + 4000 * shape + text[end:])
    only(copy, name)
    start = time.process_time()
    assert name in wrong(copy)
    assert time.process_time() - start < 20


def test_a_package_that_unpacks_to_a_large_text_is_refused(copy):
    with zipfile.ZipFile(copy / "bars.3mf", "w", zipfile.ZIP_DEFLATED) as package:
        package.writestr("3D/3dmodel.model", " " * (outline.LARGEST + 1))
    only(copy, "bars.3mf")
    assert "bytes" in wrong(copy)["bars.3mf"].problems[0]


MIRRORED = """
kind = "four-bar"
[linkage]
ground = 100
crank = 30
coupler = 90
rocker = 70
[[copies]]
mirrored = true
[files]
write = ["glb", "assembly-3mf"]
tolerance = 0.05
"""
RENAMED = [
    {"crank": "crank 2", "crank 2": "crank"},
    pytest.param({"crank": "rest"}, marks=pytest.mark.campaign),
    pytest.param({"crank 2": "crank"}, marks=pytest.mark.campaign),
]


@pytest.mark.parametrize("renamed", RENAMED)
def test_mirrored_copies_pass_unless_their_parts_are_renamed_or_lost(tmp_path, renamed):
    """Files have the parts of a mirrored copy turned over, so that exchanging two names makes both wrong."""
    gk.make(gk.load(MIRRORED).with_name("pair"), tmp_path)
    folder = tmp_path / "pair"
    assert not wrong(folder)
    with zipfile.ZipFile(folder / "pair-assembly.3mf") as package:
        model = package.read("3D/3dmodel.model").decode()
    model = re.sub('name="([^"]*)"', lambda name: f'name="{renamed.get(name[1], name[1])}"', model)
    with zipfile.ZipFile(folder / "pair-assembly.3mf", "w") as package:
        package.writestr("3D/3dmodel.model", model)
    scene = trimesh.load(folder / "pair-assembly.glb", process=False)
    changed = trimesh.Scene(metadata=scene.metadata)
    for node in scene.graph.nodes_geometry:
        place, name = scene.graph[node]
        changed.add_geometry(scene.geometry[name], geom_name=renamed.get(name, name), node_name=node, transform=place)
    (folder / "pair-assembly.glb").write_bytes(trimesh.exchange.gltf.export_glb(changed))
    assert set(wrong(folder)) == {"pair-assembly.3mf", "pair-assembly.glb"}


def test_a_missing_file_and_a_wrong_folder(copy, tmp_path_factory):
    (copy / "crank.stl").unlink()
    only(copy, "crank.stl", "rocker.stl")
    assert set(wrong(copy)) == {"crank.stl"}
    with pytest.raises(gk.FileError):
        gk.verify(tmp_path_factory.mktemp("empty"))


def test_parts_a_little_off_whole_millimetres_of_the_sheet_pass(tmp_path):
    """Plates lie with their edges at whole millimetres, so that the origin of the crank is 0.0018 mm off."""
    recipe = {
        "kind": "four-bar",
        "linkage": {"ground": 100, "crank": 30.0018, "coupler": 90, "rocker": 70},
        "stock": {"thickness": 3, "bar_width": 14},
    }
    made = gk.make(recipe, tmp_path, ["dxf"])
    (certificate,) = gk.verify(tmp_path / made.name)
    assert certificate.passed


@pytest.fixture(scope="module")
def symmetric(tmp_path_factory):
    """A gear, in which many places deviate equally, and its certificate."""
    folder = tmp_path_factory.mktemp("symmetric")
    gear = {"kind": "spur-gear", "gear": {"teeth": 8, "module": 2}, "files": {"write": ["svg"], "tolerance": 0.05}}
    gk.make(gk.load(gear), folder)
    return folder, gk.verify(folder)[0].to_dict()


@pytest.mark.parametrize("seed", range(4))
def test_rounding_does_not_move_the_reported_place(symmetric, monkeypatch, seed):
    """The exact curves are moved by their last bits, as another processor's sine moves them."""
    folder, known = symmetric
    exact, random = outline.outline_of, np.random.default_rng(seed)

    def moved(curve, error):
        line = exact(curve, error)
        noise = random.standard_normal((2, len(line.points)))
        return outline.Outline(line.points + 4e-16 * np.abs(line.points).max() * ([1, 1j] @ noise), error, line.closed)

    monkeypatch.setattr(comparison, "outline_of", moved)
    (found,) = gk.verify(folder)
    assert found.to_dict() == known
