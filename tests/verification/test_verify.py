"""Certificates: good files pass, and every kind of damage is found at its file and place."""

import random
import re
import shutil
import struct
import time
import zipfile
from dataclasses import replace

import ezdxf
import numpy as np
import pytest

import geomkin as gk
from geomkin.core.units import marked
from geomkin.verification import comparison, made_again, outline
from tests.campaign import by_default
from tests.verification.damage import RECIPE, damage_folder, wrong


def test_good_files_are_made_again(copy):
    (certificate,) = gk.verify(copy)
    assert certificate.passed
    assert {file.proof for file in certificate.files} == {"made again"}
    assert {file.file for file in certificate.files} == {path.name for path in copy.iterdir()}


@pytest.mark.parametrize("units", ["mm", "in"])
def test_lengths_of_what_is_wrong_are_in_the_unit_of_the_recipe(tmp_path, units):
    sizes = {"mm": (100, 30, 90, 70), "in": (4, 1.2, 3.6, 2.8)}[units]
    linkage = dict(zip(("ground", "crank", "coupler", "rocker"), sizes))
    gk.make(gk.load({"kind": "four-bar", "units": units, "linkage": linkage}).with_name("bars"), tmp_path, ["stl"])
    shutil.copy(tmp_path / "bars/crank.stl", tmp_path / "bars/coupler.stl")
    (certificate,) = gk.verify(tmp_path / "bars")
    (report,) = [file for file in certificate.files if file.problems]
    text = certificate.unit.text(" ".join(marked(problem) for problem in report.problems))
    assert re.search(rf"volume is [\d.]+ {units}3", text) and re.search(rf"[\d.]+ {units} off its curve", text)
    assert text.isprintable()


def test_whole_numbers_given_in_python_are_those_of_the_recipe(tmp_path):
    recipe = gk.load('kind = "four-bar"\nlinkage = {ground = 100, crank = 30, coupler = 90, rocker = 70}')
    whole = replace(recipe, linkage=gk.FourBar(ground=100, crank=30, coupler=90, rocker=70))
    gk.make(whole.with_name("whole"), tmp_path, ["svg"])
    (certificate,) = gk.verify(tmp_path / "whole")
    assert certificate.passed and {file.proof for file in certificate.files} == {"made again"}


def test_good_files_deviate_by_less_than_the_tolerance(disk, measuring):
    (certificate,) = gk.verify(disk)
    measured = {file.file: file for file in certificate.files if np.isfinite(file.deviation)}
    assert set(measured) == {"disk.dxf", "disk.svg", "disk.3mf", "gear.stl"}
    assert all(0 < file.deviation < 1.08 * file.allowed == 1.08 * 0.02 for file in measured.values())
    assert all(file.proof == "measured" and file.parts == 1 for file in measured.values())


@pytest.mark.parametrize(
    ("settings", "ending"), [('curves = "arcs"\nkerf = 0.2', "dxf"), ('style = "laser"\nsheet = [130, 60]', "svg")]
)
def test_other_ways_of_writing_pass(tmp_path, measuring, settings, ending):
    gk.make(gk.load(RECIPE.replace("write =", f"{settings}\nwrite =")).with_name("bars"), tmp_path, [ending])
    assert not wrong(tmp_path / "bars")


def moved_vertex(folder, by):
    """A vertex of the longest outline of the SVG moved across its curve."""
    path = folder / "bars.svg"
    text = path.read_text()
    found = max(re.finditer(r'd="M([^"]+)Z" class="CUT"', text), key=lambda one: len(one.group(1)))
    pairs = found.group(1).split()
    z = [complex(*map(float, pair.split(","))) for pair in pairs[:3]]
    moved = z[1] + by * 1j * (z[2] - z[0]) / abs(z[2] - z[0])
    pairs[1] = f"{moved.real:.7f},{moved.imag:.7f}"
    path.write_text(text[: found.start(1)] + " ".join(pairs) + text[found.end(1) :])


@pytest.mark.campaign
def test_a_vertex_off_its_curve_is_named_with_its_place(copy):
    moved_vertex(copy, 0.02)
    ((name, file),) = wrong(copy).items()
    assert name == "bars.svg" and 0.014 < file.deviation < 0.0215
    assert file.part and len(file.problems) == 1 and not file.proof and file.note


@pytest.mark.campaign
def test_a_vertex_moved_within_the_tolerance_passes_by_measurement(copy):
    moved_vertex(copy, 1e-4)
    (certificate,) = gk.verify(copy)
    (file,) = [file for file in certificate.files if file.file == "bars.svg"]
    assert certificate.passed and file.proof == "measured" and "line" in file.note


LAST_DIGITS = [
    ("12.3456780", "12.3456781", False),
    ("12.345", "12.346", True),
    ("7", "8", True),
    ("0.0", "1e-17", False),
]


@pytest.mark.parametrize(("old", "new", "is_found"), LAST_DIGITS)
def test_last_digits_far_below_any_tolerance_may_differ(old, new, is_found):
    texts = [f'<svg><path d="M{value},7L3,4"/></svg>'.encode() for value in (old, new)]
    assert bool(made_again.difference(*texts, "svg").problems) == is_found


SVG = (
    ("</g>", '<rect x="1" y="1" width="9" height="9" stroke="#ff0000"/></g>'), ("<g id", '<g style="display:none" id'),
    ("<svg ", '<svg style="transform: scale(1.5)" '), ("<title>", "<style>path{display:none}</style><title>"),
    ("<title>", '<use href="#gear-1"/><title>'), ("gear-1", "gear-2"), ("<svg", '<?xml-stylesheet href="a.css"?><svg'),
)  # fmt: skip


@pytest.mark.parametrize(("old", "new"), SVG)
def test_anything_else_in_a_drawing_is_found(disk, old, new):
    path = disk / "disk.svg"
    assert old in path.read_text()
    path.write_text(path.read_text().replace(old, new, 1))
    assert set(wrong(disk)) == {path.name}


def off(drawing):
    drawing.layers.get("HOLE").off()


def invisible(drawing):
    drawing.modelspace()[0].dxf.invisible = 1


def raised(drawing):
    drawing.modelspace()[0].dxf.extrusion = (0, 0, -1)


def with_block(drawing):
    drawing.blocks.new("MORE").add_line((0, 0), (9, 9), dxfattribs={"layer": "CUT"})
    drawing.modelspace().add_blockref("MORE", (5, 5))


def scaled(drawing):
    drawing.header["$INSUNITS"] = 6


@pytest.mark.parametrize(
    "change", by_default([off, invisible, raised, with_block, scaled], slice(2)), ids=lambda change: change.__name__
)
def test_states_of_a_dxf_drawing_are_part_of_it(disk, monkeypatch, change):
    monkeypatch.setattr(ezdxf.options, "write_fixed_meta_data_for_testing", True)
    drawing = ezdxf.readfile(disk / "disk.dxf")
    drawing.saveas(disk / "disk.dxf")
    assert not wrong(disk)
    change(drawing)
    drawing.saveas(disk / "disk.dxf")
    assert set(wrong(disk)) == {"disk.dxf"}


def shifted(group, by):
    """The shapes of a group of an SVG file, moved along x, mm."""

    def moved(found):
        return f"{found[1]}{float(found[2]) + by:.7g}{found[3]}"

    return re.sub(r'(cx="|(?<=[M ]))([\d.]+)(,|")', moved, group)


@pytest.mark.parametrize(("by", "passes"), by_default([(0.5, True), (-9.0, False), (1000.0, False)], slice(2)))
def test_a_part_moved_on_the_sheet_passes_unless_it_meets_another(copy, by, passes):
    """The nesting may change; lines that cross cut both parts."""
    text = (copy / "bars.svg").read_text()
    wide = float(re.search(r'viewBox="0 0 ([\d.]+)', text)[1])
    group = re.findall(r'<g id=".*?</g>', text, re.DOTALL)[-1]
    right = max(float(x) for x in re.findall(r"[M ]([\d.]+),", group))
    assert wide - right > 0.5
    (copy / "bars.svg").write_text(text.replace(group, shifted(group, by)))
    assert ("bars.svg" not in wrong(copy)) == passes


def test_parts_exchanged_under_their_names_are_found(copy):
    """Each group still has one outline and two holes."""
    text = (copy / "bars.svg").read_text()
    bodies = dict(re.findall(r'<g id="(\w+-\d)">(.*?)</g>', text, re.DOTALL))
    one, other = (next(name for name in bodies if name.startswith(part)) for part in ("crank", "rocker"))
    changed = text.replace(bodies[one], "?").replace(bodies[other], bodies[one]).replace("?", bodies[other])
    (copy / "bars.svg").write_text("<?" + changed.removeprefix(bodies[other]).removeprefix("<?"))
    assert "bars.svg" in wrong(copy)


@pytest.mark.parametrize("seed", by_default(range(24), slice(8)))
def test_damage_is_found(disk, good, seed):
    """One thing changed at random; campaigns try hundreds."""
    order = damage_folder(disk, [disk, good], random.Random(seed))
    assert not (disk / "summary.json").exists() or not gk.verify(disk)[0].passed, order


@pytest.mark.parametrize("colour", ["#9e+73", "#09e073", "#09e72", "#009e74"])
def test_a_colour_that_reads_as_a_number_is_none(colour):
    content = b'<path d="M1.25,2" stroke="#009e73"/>'
    other = content.replace(b"#009e73", colour.encode())
    assert all(made_again.difference(other, content, kind).problems for kind in ("svg", "assembly-svg"))


@pytest.mark.campaign
def test_another_recipe_of_the_same_name_is_recognised(copy, tmp_path_factory):
    other = tmp_path_factory.mktemp("other")
    gk.make(gk.load(RECIPE.replace("rocker = 70", "rocker = 70.001")).with_name("bars"), other, ["svg"])
    (copy / "bars.svg").write_bytes((other / "bars" / "bars.svg").read_bytes())
    assert set(wrong(copy)) == {"bars.svg"}


@pytest.mark.campaign
def test_a_search_that_its_time_limit_ended_is_named(tmp_path):
    """Another computer finds another linkage, so that its files cannot be compared."""
    wanted = {"poses": [[0, 0, 0], [20, 10, 20], [30, 30, 50]]}
    for limit in (1e-6, 60):
        recipe = {"kind": "body-guidance", "wanted": wanted, "search": {"time_limit": limit}}
        gk.make(gk.load(recipe).with_name("guide"), tmp_path, ["csv"])
        (certificate,) = gk.verify(tmp_path)
        assert certificate.passed and not certificate.problems
        path = tmp_path / "guide/guide.csv"
        path.write_text(path.read_text().replace("1", "2"))
        (certificate,) = gk.verify(tmp_path)
        assert not certificate.passed and any("time_limit" in problem for problem in certificate.problems) == (
            limit < 1
        )


@pytest.mark.parametrize("stated", [{"edge": 7, "clearance": 0.2}, {"edge": 7}])
def test_a_fit_that_a_mechanism_of_a_machine_states_is_not_assumed(tmp_path, stated):
    """Even if it is the default."""
    gears = {"first": {"teeth": 12, "module": 2, "profile_shift": 0.3}, "second": {"teeth": 36, "module": 2}}
    pair = {"kind": "gear-pair", **gears, "first_stock": {"bore": 5}, "second_stock": {"bore": 5}, "base": stated}
    pump = {"turned_by": "pair.second", "recipe": {"kind": "slider-crank", "linkage": {"crank": 20, "coupler": 70}}}
    recipe = gk.load({"kind": "machine", "mechanisms": {"pair": {"recipe": pair}, "pump": pump}})
    gk.make(recipe.with_name("one"), tmp_path, ["bom"])
    (certificate,) = gk.verify(tmp_path)
    assert certificate.passed
    assert any("base.clearance" in key for key in recipe.assumed_fits) == ("clearance" not in stated)


def test_a_file_of_another_program_is_measured(copy):
    """The rest of it is listed as not measured."""
    text = (copy / "bars.svg").read_text()
    (copy / "bars.svg").write_text(
        re.sub(r"<desc>.*?</desc>", "", text).replace("<g ", '<g transform="translate(0.5,0.25)" ')
    )
    file = wrong(copy)["bars.svg"]
    assert len(file.problems) == 2 and file.deviation < 1.08 * 0.005 and file.parts == 8


def test_list_of_files_is_that_of_the_folder(copy):
    text = (copy / "summary.json").read_text()
    for changed in (re.sub(r'"files": \[[^\]]*\]', '"files": []', text), text.replace('  "bars.svg",\n', "")):
        assert changed != text
        (copy / "summary.json").write_text(changed)
        assert not gk.verify(copy)[0].passed
    (copy / "summary.json").write_text(text)
    shutil.copy(copy / "bars.dxf", copy / "old.dxf")
    (copy / "notes.txt").write_text("mine")
    assert set(wrong(copy)) == {"old.dxf"}


def test_hostile_files_are_refused_in_bounded_time(disk):
    bomb = '<?xml version="1.0"?><!DOCTYPE svg [<!ENTITY a "aaaaaaaaaa">]><svg xmlns="http://www.w3.org/2000/svg">&a;</svg>'
    (disk / "disk.svg").write_text(bomb)
    (disk / "x.step").unlink(missing_ok=True)
    (disk / "gear.step").write_text("ISO-10303-21;HEADER;DATA;" + "#1=EDGE_LOOP('',(#1));" * 1000)
    (disk / "gear.stl").write_bytes(bytes(80) + struct.pack("<I", 2**31) + bytes(50))
    (disk / "disk-bom.csv").write_text('item,count\n"=HYPERLINK(1)",1\n')
    found = wrong(disk)
    assert {"disk.svg", "gear.step", "gear.stl", "disk-bom.csv"} == set(found)
    # What is wrong is said of the file, not of the program that reads it.
    assert not any("Error" in problem for report in found.values() for problem in report.problems)


@pytest.mark.parametrize(
    ("name", "shape"),
    [
        ("disk.svg", '<circle cx="5" cy="5" r="90000000"/>'),
        ("disk.svg", '<path d="M0,0 A9e7,9e7 0 1 1 1,0 Z"/>'),
        ("disk.svg", '<circle cx="5" cy="5" r="0.1"/>'),
        ("disk.dxf", "  0\nCIRCLE\n  8\nHOLE\n 10\n5.0\n 20\n5.0\n 40\n90000000.0\n"),
    ],
    ids=["large circles", "large arcs", "many parts", "large circles in DXF"],
)
def test_many_shapes_are_refused_before_they_are_measured(disk, name, shape):
    """Their chords or pairs would fill the memory, or take hours."""
    text = (disk / name).read_text()
    end = text.rindex("</svg>" if name.endswith("svg") else "  0\nENDSEC\n  0\nSECTION\n  2\nOBJECTS")
    (disk / name).write_text(text[:end] + 4000 * shape + text[end:])
    start = time.process_time()
    assert name in wrong(disk)
    assert time.process_time() - start < 20


def test_a_package_that_unpacks_to_a_large_text_is_refused(disk, monkeypatch):
    """Even if it states that the text is short, or if only all its texts together are large."""
    path, most = disk / "disk.3mf", 1_000_000
    monkeypatch.setattr(made_again, "LARGEST", most)
    for texts in ([most + 1], [most // 2, most // 2, 2]):
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as package:
            for k, size in enumerate(texts):
                package.writestr(f"{k}.model", " " * size)
        assert "bytes" in wrong(disk)[path.name].problems[0]
    stated, false = (struct.pack("<I", size) for size in (most // 2, 100))
    path.write_bytes(path.read_bytes().replace(stated, false))
    assert path.name in wrong(disk)


ASSEMBLED = """
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
TREE = (
    ('name="crank"', 'name="rest"'), ('transform="', 'transform="-1 0 0 0 1 0 0 0 1 0 0 0" was="'),
    ("<components>", '<components><component objectid="1"/>'), ("</build>", '<item objectid="1"/></build>'),
)  # fmt: skip


@pytest.fixture(scope="module")
def assembled(tmp_path_factory):
    folder = tmp_path_factory.mktemp("assembled")
    gk.make(gk.load(ASSEMBLED).with_name("pair"), folder)
    return folder / "pair"


@pytest.mark.parametrize(("old", "new"), TREE)
def test_tree_of_an_assembly_is_compared(assembled, tmp_path, old, new):
    folder = shutil.copytree(assembled, tmp_path / "pair")
    path = folder / "pair-assembly.3mf"
    with zipfile.ZipFile(path) as package:
        inside = {name: package.read(name).decode() for name in package.namelist()}
    inside["3D/3dmodel.model"] = inside["3D/3dmodel.model"].replace(old, new, 1)
    with zipfile.ZipFile(path, "w") as package:
        for name, text in inside.items():
            package.writestr(zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0)), text)
    assert set(wrong(folder)) == {path.name}


def test_a_part_of_a_glb_moved_by_20_mm_is_found(assembled, tmp_path):
    folder = shutil.copytree(assembled, tmp_path / "pair")
    assert not wrong(folder)
    path = folder / "pair-assembly.glb"
    content = path.read_bytes()
    moved = re.sub(rb'("matrix":\[[^\]]*?)0\.0(\d)', rb"\g<1>0.1\2", content, count=1)
    assert moved != content
    path.write_bytes(moved)
    assert set(wrong(folder)) == {path.name}


def test_a_missing_file_and_a_wrong_folder(copy, tmp_path_factory):
    (copy / "crank.stl").unlink()
    assert set(wrong(copy)) == {"crank.stl"}
    with pytest.raises(gk.FileError):
        gk.verify(tmp_path_factory.mktemp("empty"))


@pytest.mark.campaign
def test_parts_a_little_off_whole_millimetres_of_the_sheet_pass(tmp_path, measuring):
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
    """A gear, in which many places deviate equally."""
    folder = tmp_path_factory.mktemp("symmetric")
    gear = {"kind": "spur-gear", "gear": {"teeth": 8, "module": 2}, "files": {"write": ["svg"], "tolerance": 0.05}}
    gk.make(gk.load(gear), folder)
    return folder


@pytest.mark.parametrize("seed", range(4))
def test_rounding_does_not_move_the_reported_place(symmetric, measuring, monkeypatch, seed):
    """The exact curves are moved by their last bits, as another processor's sine moves them."""
    (known,) = gk.verify(symmetric)
    exact, random = outline.outline_of, np.random.default_rng(seed)

    def moved(curve, error):
        line = exact(curve, error)
        noise = random.standard_normal((2, len(line.points)))
        return outline.Outline(line.points + 4e-16 * np.abs(line.points).max() * ([1, 1j] @ noise), error, line.closed)

    monkeypatch.setattr(comparison, "outline_of", moved)
    (found,) = gk.verify(symmetric)
    assert found.to_dict() == known.to_dict()
