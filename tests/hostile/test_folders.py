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


def test_what_a_killed_run_left_long_ago_is_swept_away(run, recipe, here):
    (here / "out/r").mkdir(parents=True)
    for name, age in ((".making-old", 7200), (".making-now", 60), (".hidden", 7200)):
        (here / "out/r" / name).write_text("half")
        os.utime(here / "out/r" / name, (time.time() - age,) * 2)
    assert run(recipe("spur-gear")).exit_code == 0
    assert names(here / "out/r") == FILES | {"gear.stl", ".making-now", ".hidden"}


def test_asking_only_for_what_a_recipe_does_not_write_is_refused(run, refused, recipe):
    refused(run(recipe("spur-gear", {"files.write": '["csv"]'}), "--only", "dxf"), "files.write", "only dxf")


@pytest.mark.parametrize("name", ["\u00e4" * 120])
def test_a_name_too_long_for_its_files_is_refused(geomkin, refused, recipe, here, name):
    (here / f"{name}.toml").write_text(recipe("spur-gear"))
    result = geomkin("run", f"{name}.toml")
    assert result.exit_code == 1 and not (here / "out").exists()


def test_of_many_problems_the_first_are_told_and_the_rest_counted(run, recipe):
    result = run("".join(f"k{i} = 1\n" for i in range(1000)) + recipe("spur-gear").replace("kind =", "\nkind ="))
    lines = result.stderr.splitlines()
    assert result.exit_code == 1 and len(lines) == 21 and "980" in lines[-1]


def test_an_empty_key_is_shown_as_one(run, recipe):
    result = run('"" = 3\n' + recipe("spur-gear"))
    assert result.exit_code == 1 and result.stderr.startswith('r.toml: "": ')


@pytest.mark.parametrize("found", ['"yes"', "1"])
def test_a_choice_of_true_and_false_takes_nothing_else(run, refused, recipe, found):
    refused(run(recipe("disk-cam", {"stock.timing_mark": found})), "stock.timing_mark", "found")
