"""Files and folders in the way: what stands under a name is whole, the old file or the new one."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import geomkin as gk
from tests.campaign import by_default

NAMES = ["coupler.stl", "crank.stl", "ground.stl", "r.csv", "r.dxf", "rocker.stl", "spacer.stl", "summary.json"]


def contents(folder):
    """Name to bytes of every file in a folder."""
    return {p.name: p.read_bytes() for p in Path(folder).iterdir()}


@pytest.fixture(scope="module")
def versions(recipe, tmp_path_factory):
    """Texts of two versions of one recipe, and the files each makes."""
    made = []
    for crank in ("30", "25"):
        text = recipe("four-bar", {"linkage.crank": crank, "files.write": '["dxf", "stl", "csv"]'})
        out = tmp_path_factory.mktemp("version")
        gk.make(gk.load(text).with_name("r"), out)
        made.append((text, contents(out / "r")))
    assert all(made[0][1][name] != made[1][1][name] for name in ("r.dxf", "crank.stl", "summary.json"))
    return made


def in_the_way(here, case):
    """Puts something in the way of out/r/; returns the --out to use."""
    (here / "file").write_text("precious")
    match case:
        case "a file":
            return "file"
        case "under a file":
            return "file/deeper"
        case "no real folder":
            return "/proc/none"
        case "a device":
            return "/dev/null"
        case "a pipe":
            os.mkfifo(here / "pipe")
            return "pipe"
        case "a dangling link":
            (here / "link").symlink_to("nowhere")
            return "link"
        case "a loop of links":
            (here / "loop").symlink_to("loop")
            return "loop"
        case "a name too long":
            return "y" * 300
        case "a file for the folder":
            (here / "out").mkdir()
            (here / "out" / "r").write_text("precious")
            return "out"


CASES = ["a file", "under a file", "no real folder", "a device", "a pipe", "a dangling link", "a loop of links"]


@pytest.mark.parametrize("case", [*CASES[::3], "a file for the folder"])
def test_an_output_folder_that_cannot_be_is_reported_in_one_line(run, recipe, here, case):
    out = in_the_way(here, case)
    before = sorted(here.rglob("*"))
    result = run(recipe("four-bar"), "--out", out)
    assert result.exit_code == 1
    assert len(result.stderr.splitlines()) == 1 and "--out" in result.stderr
    assert sorted(p for p in here.rglob("*") if p.name != "r.toml") == before
    assert (here / "file").read_text() == "precious"


@pytest.mark.parametrize("make", [Path.mkdir, os.mkfifo], ids=["folder", "pipe"])
def test_folders_and_pipes_are_not_replaced(run, recipe, here, make):
    (here / "out/r").mkdir(parents=True)
    make(here / "out/r/crank.stl")
    result = run(recipe("four-bar"))
    assert result.exit_code == 1 and result.stderr.startswith("out/r/crank.stl: ")
    assert not (here / "out/r/crank.stl").is_file()
    assert not list(here.rglob(".making*"))


def test_a_link_under_the_name_is_replaced_and_its_target_kept(run, recipe, here):
    (here / "precious").write_text("precious")
    (here / "out/r").mkdir(parents=True)
    (here / "out/r/r.csv").symlink_to(here / "precious")
    assert run(recipe("four-bar")).exit_code == 0
    assert (here / "precious").read_text() == "precious" and not (here / "out/r/r.csv").is_symlink()


def test_failing_recipe_leaves_earlier_files(run, recipe, here):
    assert run(recipe("four-bar")).exit_code == 0
    before = contents(here / "out/r")
    for spoilt in ({"linkage.ground": "1000"}, {"files.kerf": "5"}, {"stock.bar_width": "4"}):
        assert run(recipe("four-bar", spoilt)).exit_code == 1
        assert contents(here / "out/r") == before


# Full at more places.
FINER = [pytest.param(share, marks=pytest.mark.campaign) for share in (0, 0.9999, *((k + 0.5) / 6 for k in range(6)))]


@pytest.mark.skipif(os.name != "posix", reason="limits the size of files")
@pytest.mark.parametrize("share", [0.3, *FINER])
def test_a_full_disk_leaves_every_file_old(versions, command, here, share):
    (_, old), (text, new) = versions
    limit = int(share * max(map(len, new.values())))
    (here / "out/r").mkdir(parents=True)
    for name, content in old.items():
        (here / "out/r" / name).write_bytes(content)
    (here / "r.toml").write_text(text)
    full = f"import resource; resource.setrlimit(resource.RLIMIT_FSIZE, ({limit}, {limit}))"
    done = command("run", "r.toml", before=full)
    assert done.returncode == 1 and len(done.stderr.splitlines()) == 1
    assert contents(here / "out/r") == old


# Copies of one process, everything loaded, that make two versions into one folder over and over.
AT_ONCE = """
import os
from geomkin import make
import geomkin.export.tables, geomkin.export.dxf, geomkin.export.solids
copies = []
for k in range(2):
    if (copy := os.fork()) == 0:
        status = 1
        try:
            for _ in range(2):
                make(f"{k % 2}/r.toml", "out")
            status = 0
        finally:
            os._exit(status)
    copies.append(copy)
assert [os.waitstatus_to_exitcode(os.waitpid(copy, 0)[1]) for copy in copies] == [0] * 2
"""


@pytest.mark.campaign
@pytest.mark.skipif(os.name != "posix", reason="copies of a process")
def test_runs_at_once_into_one_folder_lose_and_break_nothing(versions, here):
    for k, (text, _) in enumerate(versions):
        (here / str(k)).mkdir()
        (here / str(k) / "r.toml").write_text(text)
    done = subprocess.run([sys.executable, "-c", AT_ONCE], capture_output=True, text=True, timeout=100)
    assert done.returncode == 0, done.stderr
    now, made = contents(here / "out/r"), [files for _, files in versions]
    assert sorted(now) == NAMES
    # The summary names the libraries that were loaded, which differ between this process and its copies.
    assert [n for n in NAMES if n != "summary.json" and now[n] not in (made[0][n], made[1][n])] == []


@pytest.mark.skipif(os.name != "posix", reason="needs named pipes")
@pytest.mark.parametrize("arguments", by_default([["run", "pipe.toml"], ["check", "."]], slice(1)))
def test_a_pipe_that_nobody_writes_to_is_not_waited_for(command, here, arguments):
    os.mkfifo(here / "pipe.toml")
    try:
        done = command(*arguments)
    except subprocess.TimeoutExpired:
        pytest.fail("still waiting")
    assert done.returncode in (1, 2) and done.stderr
