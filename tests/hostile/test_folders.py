"""What a run leaves in a folder, and what it makes of names, options and heaps of mistakes."""

import json
import os
import time

import pytest

FILES = {"r-bom.csv", "r.csv", "r.dxf", "r.svg", "summary.json"}


def names(folder):
    """Of the files in a folder, without the page and the picture, which come only of kinds that show something."""
    return {path.name for path in folder.iterdir()} - {"r.html", "r-assembly.svg"}


def test_files_of_parts_that_a_recipe_has_no_more_are_removed_and_nothing_else(run, recipe, here):
    assert run(recipe("four-bar")).exit_code == 0
    (here / "out/r/notes.txt").write_text("mine")
    (here / "out/r/mine.stl").write_text("mine")
    assert names(here / "out/r") == FILES | {"crank.stl", "coupler.stl", "rocker.stl", "ground.stl", "spacer.stl"} | {
        "notes.txt",
        "mine.stl",
    }
    assert run(recipe("spur-gear")).exit_code == 0
    assert names(here / "out/r") == FILES | {"gear.stl", "notes.txt", "mine.stl"}


def test_a_run_for_some_formats_removes_nothing(run, recipe, here):
    assert run(recipe("four-bar")).exit_code == 0
    before = names(here / "out/r")
    assert run(recipe("spur-gear"), "--only", "dxf").exit_code == 0
    assert names(here / "out/r") == before


@pytest.mark.parametrize("content", ["[]", '{"files": ["../x.stl", ".", "x", "/x.stl"]}'])
def test_a_summary_that_is_none_of_ours_removes_nothing(run, recipe, here, content):
    (here / "out/r").mkdir(parents=True)
    (here / "out/x.stl").write_text("mine")
    (here / "out/r/x").write_text("mine")
    (here / "out/r/summary.json").write_text(content)
    assert run(recipe("spur-gear")).exit_code == 0
    assert (here / "out/x.stl").exists() and (here / "out/r/x").exists()
    assert json.loads((here / "out/r/summary.json").read_text())["name"] == "r"


def test_old_remains_of_killed_runs_are_removed(run, recipe, here):
    (here / "out/r").mkdir(parents=True)
    for name, age in ((".making-old", 7200), (".making-now", 60), (".hidden", 7200)):
        (here / "out/r" / name).write_text("half")
        os.utime(here / "out/r" / name, (time.time() - age,) * 2)
    assert run(recipe("spur-gear")).exit_code == 0
    assert names(here / "out/r") == FILES | {"gear.stl", ".making-now", ".hidden"}
