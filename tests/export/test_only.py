"""A run of some formats of a recipe, into a folder that has its others."""

import json

import pytest

import geomkin as gk

GEAR = 'kind = "spur-gear"\ngear = {teeth = 8, module = 2}\nfiles.tolerance = 0.05\n'


def verdicts(folder):
    (certificate,) = gk.verify(folder)
    return {file.file: file.passed for file in certificate.files}


@pytest.mark.parametrize("write", ['files.write = ["dxf", "svg", "stl"]', ""])
def test_files_of_other_formats_stay_and_are_listed_and_verified(tmp_path, write):
    recipe = gk.load(GEAR + write).with_name("disk")
    gk.make(recipe, tmp_path)
    whole = {path.name: path.read_bytes() for path in (tmp_path / "disk").iterdir()}
    (tmp_path / "disk/gear.stl").unlink()
    gk.make(recipe, tmp_path, ["dxf"])
    left = json.loads((tmp_path / "disk/summary.json").read_text())["files"]
    assert left == sorted({*whole} - {"gear.stl", "summary.json"})
    assert verdicts(tmp_path) == dict.fromkeys({*whole} - {"gear.stl"}, True)
    gk.make(recipe, tmp_path, ["stl"])
    assert {path.name: path.read_bytes() for path in (tmp_path / "disk").iterdir()} == whole
    assert all(verdicts(tmp_path).values())


def test_what_the_recipe_no_longer_makes_goes_and_what_changed_is_named(tmp_path):
    gk.make(gk.load(GEAR + 'files.write = ["dxf", "svg", "stl"]').with_name("disk"), tmp_path)
    changed = gk.load(GEAR.replace("8", "9") + 'files.write = ["dxf", "stl"]').with_name("disk")
    gk.make(changed, tmp_path, ["dxf"])
    found = verdicts(tmp_path)
    assert "disk.svg" not in found and not (tmp_path / "disk/disk.svg").exists()
    assert [name for name, passed in found.items() if not passed] == ["gear.stl"]
    (tmp_path / "disk/notes.svg").write_text("mine")
    gk.make(changed, tmp_path)
    assert all(passed for name, passed in verdicts(tmp_path).items() if name != "notes.svg")


@pytest.mark.parametrize("only", [["report-md"], ["report-md", "plots"]])
def test_pictures_of_a_report_are_of_no_other_format(tmp_path, only):
    gk.make(gk.load(GEAR).with_name("disk"), tmp_path, only)
    assert all(verdicts(tmp_path).values())
