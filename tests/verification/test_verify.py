"""Certificates: good files pass, and every kind of damage is found at its file and place."""

import json
import re
import struct

import numpy as np
import pytest

import geomkin as gk
from tests.verification.damage import damaged, damages, dxf_vertex

RECIPE = """
kind = "four-bar"
[linkage]
ground = 100
crank = 30
coupler = 90
rocker = 70
[files]
write = ["dxf", "svg", "stl", "csv", "bom", "step", "3mf", "glb"]
"""


@pytest.fixture(scope="module")
def good(tmp_path_factory):
    folder = tmp_path_factory.mktemp("good")
    recipe = gk.load(RECIPE).with_name("bars")
    gk.make(recipe, folder)
    return folder / "bars"


@pytest.fixture
def copy(good, tmp_path):
    for file in good.iterdir():
        (tmp_path / file.name).write_bytes(file.read_bytes())
    return tmp_path


def wrong(folder):
    (certificate,) = gk.verify(folder)
    return {file.file: file for file in certificate.files if not file.passed}


def test_good_files_pass_and_deviate_by_less_than_the_tolerance(good):
    (certificate,) = gk.verify(good)
    assert certificate.passed
    measured = {file.file: file for file in certificate.files if np.isfinite(file.deviation)}
    assert {name.rpartition(".")[2] for name in measured} == {"dxf", "svg", "stl", "step", "3mf", "glb"}
    assert all(0 < file.deviation < 1.08 * 0.005 for file in measured.values())
    drawing = measured["bars.dxf"]
    counts = json.loads((good / "summary.json").read_text())["parts"]
    assert drawing.parts == sum(part["count"] for part in counts)


@pytest.mark.parametrize("settings", ['curves = "arcs"\nkerf = 0.2', 'style = "laser"\nsheet = [130, 60]'])
def test_other_ways_of_writing_pass(tmp_path, settings):
    gk.make(gk.load(RECIPE.replace("write =", f"{settings}\nwrite =")).with_name("bars"), tmp_path, ["dxf", "svg"])
    assert not wrong(tmp_path / "bars")


def test_a_vertex_off_its_curve_is_named_with_its_place(copy):
    """Moved by 0.02 mm across its curve, in DXF."""
    dxf_vertex(copy, np.random.default_rng(1), 0.02)
    (name, file), *others = wrong(copy).items()
    assert name == "bars.dxf" and not others
    assert 0.014 < file.deviation < 0.0215
    assert file.part and len(file.problems) == 1


def only(folder, name):
    """Let the summary list one file, so that no other is measured."""
    data = json.loads((folder / "summary.json").read_text())
    (folder / "summary.json").write_text(json.dumps(data | {"files": [name]}))


@pytest.mark.parametrize("damage", damages(np.random.default_rng(5), 20), ids=lambda damage: damage.name)
def test_damage_is_found(copy, damage):
    name = damaged(copy, damage)
    only(copy, name)
    assert name in wrong(copy)


def test_another_recipe_of_the_same_name_is_recognised(copy, tmp_path_factory):
    other = tmp_path_factory.mktemp("other")
    gk.make(gk.load(RECIPE.replace("rocker = 70", "rocker = 70.001")).with_name("bars"), other)
    (copy / "bars.svg").write_bytes((other / "bars" / "bars.svg").read_bytes())
    assert set(wrong(copy)) == {"bars.svg"}


def test_a_file_of_another_program_is_measured(copy):
    text = (copy / "bars.svg").read_text()
    (copy / "bars.svg").write_text(
        re.sub(r"<desc>.*?</desc>", "", text).replace("<g ", '<g transform="translate(2.5,1.25)" ')
    )
    file = wrong(copy)["bars.svg"]
    assert len(file.problems) == 1 and file.deviation < 1.08 * 0.005


def test_hostile_files_are_refused_in_bounded_time(copy):
    bomb = '<?xml version="1.0"?><!DOCTYPE svg [<!ENTITY a "aaaaaaaaaa">]><svg xmlns="http://www.w3.org/2000/svg">&a;</svg>'
    (copy / "bars.svg").write_text(bomb)
    (copy / "bars.step").unlink(missing_ok=True)
    (copy / "crank.step").write_text("ISO-10303-21;HEADER;DATA;" + "#1=EDGE_LOOP('',(#1));" * 1000)
    (copy / "crank.stl").write_bytes(bytes(80) + struct.pack("<I", 2**31) + bytes(50))
    (copy / "bars-bom.csv").write_text('item,count\n"=HYPERLINK(1)",1\n')
    assert {"bars.svg", "crank.step", "crank.stl", "bars-bom.csv"} <= set(wrong(copy))


def test_a_missing_file_and_a_wrong_folder(copy, tmp_path_factory):
    (copy / "crank.stl").unlink()
    assert set(wrong(copy)) == {"crank.stl"}
    with pytest.raises(gk.FileError):
        gk.verify(tmp_path_factory.mktemp("empty"))
