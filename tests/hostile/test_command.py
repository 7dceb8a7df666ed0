"""The command line: wrong usage, odd names, closed pipes and full disks under its output."""

import json
import os
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

CSV = {"files.write": '["csv"]'}


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (["bogus"], "No such command"),
        (["run", "absent.toml"], "does not exist"),
        (["run", ""], "does not exist"),
        (["run", "."], "no recipe"),
        (["new"], "Missing argument"),
        (["new", "four-bar", "spur-gear"], "unexpected extra argument"),
        (["schema", "all"], "unexpected extra argument"),
    ],
)
def test_wrong_usage_ends_with_2_and_says_what_is_wrong(geomkin, here, arguments, word):
    result = geomkin(*arguments)
    assert result.exit_code == 2 and result.stderr and result.stdout == ""
    assert list(here.iterdir()) == []


@pytest.mark.parametrize("only", ["", "dxf,,svg"])
def test_an_unknown_format_is_wrong_usage(run, recipe, here, only):
    result = run(recipe("four-bar"), "--only", only)
    assert result.exit_code == 2 and result.stderr
    assert not (here / "out").exists()


def test_two_recipes_of_one_name_are_not_written_over_each_other(geomkin, recipe, here):
    for folder in ("a", "b\nc"):
        (here / folder).mkdir()
        (here / folder / "r.toml").write_text(recipe("four-bar"))
    result = geomkin("run", "a", "b\nc")
    assert result.exit_code == 2 and "--out" in result.stderr and not (here / "out").exists()
    assert result.stderr.splitlines()[-1].startswith("Error: "), "a name with a newline broke the line"


def test_one_bad_recipe_does_not_keep_the_others_from_being_made(geomkin, recipe, here):
    (here / "good.toml").write_text(recipe("four-bar", CSV))
    (here / "bad.toml").write_text(recipe("four-bar", {"linkage.crank": "-1"}))
    (here / "last.toml").write_text(recipe("spur-gear", CSV))
    result = geomkin("run", ".")
    assert result.exit_code == 1 and len(result.stderr.splitlines()) == 1
    assert sorted(p.name for p in (here / "out").iterdir()) == ["good", "index.html", "last"]


@pytest.mark.parametrize("fault", [MemoryError])
def test_a_fault_of_our_own_in_one_recipe_does_not_stop_the_others(geomkin, recipe, here, monkeypatch, fault):
    import geomkin.build as build

    for name in ("first", "last"):
        (here / f"{name}.toml").write_text(recipe("spur-gear", CSV))
    real = build.make

    def make(file, **options):
        if Path(file).stem == "first":
            raise fault("out of reach")
        return real(file, **options)

    monkeypatch.setattr(build, "make", make)
    result = geomkin("run", ".")
    assert result.exit_code == 1 and result.stderr.startswith("first.toml: ") and (here / "out/last").exists()


NAMES = ["new\nline", "\x1b[31mred", "дом-日本", "=1+1", "%s{0}", "x" * 240]
DOTS = ["", "..", "~"]


@pytest.mark.parametrize("name", NAMES + DOTS + ["<a&'\">"], ids=ascii)
def test_an_odd_name_writes_only_inside_its_own_folder(geomkin, recipe, here, name):
    file = here / "in" / f"{name}.toml"
    file.parent.mkdir()
    file.write_text(recipe("spur-gear", {"files.write": '["svg"]'}))
    result = geomkin("run", file, "--out", "made/out")
    assert result.exit_code in (0, 1)
    written = [p.relative_to(here) for p in here.rglob("*") if p.is_file() and p != file]
    assert all(p.parts[:2] == ("made", "out") and len(p.parts) == 4 for p in written), written
    assert len(written) == (2 if result.exit_code == 0 else 0)
    for path in written:
        text = path.read_text(encoding="utf-8")
        assert json.loads(text) if path.suffix == ".json" else ElementTree.fromstring(text)


def test_a_name_too_long_for_the_folder_is_reported_in_one_line(geomkin, recipe, here):
    name = "x" * 252  # with ".svg" one more than file systems take
    (here / name).write_text(recipe("spur-gear", {"files.write": '["svg"]'}))
    result = geomkin("run", name)
    assert result.exit_code == 1 and len(result.stderr.splitlines()) == 1


@pytest.mark.parametrize(
    ("verb", "name"), [("run", "a\nb\x1b[31m"), ("check", "-rf"), ("run", "AUX.b"), ("check", "a:b"), ("run", "a\\b")]
)
def test_a_recipe_whose_name_makes_no_plain_files_is_reported_in_one_line(geomkin, recipe, here, verb, name):
    (here / f"{name}.toml").write_text(recipe("four-bar", CSV))
    result = geomkin(verb, f"./{name}.toml")
    assert result.exit_code == 1 and not (here / "out").exists()
    assert len(result.stderr.splitlines()) == 1 and result.stderr.strip().isprintable()


def test_a_path_cannot_spoil_the_terminal(command, here):
    (here / "no\x1b[31m\nsuch").mkdir()
    done = command("run", "no\x1b[31m\nsuch")
    assert done.returncode == 2 and "\x1b" not in done.stderr and "in no?[31m?such" in done.stderr


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere a file's name is text")
def test_a_name_that_is_no_text_is_made_or_reported(command, recipe, here):
    name = os.fsdecode(b"bad\xff.toml")
    Path(name).write_text(recipe("four-bar", CSV))
    done = command("run", name)
    assert done.returncode in (0, 1) and bool(done.stderr) == (done.returncode == 1)


COMMANDS = [["list"], ["run", "r.toml"]]


@pytest.mark.parametrize("arguments", COMMANDS, ids=" ".join)
def test_a_reader_that_left_ends_it_quietly(command, recipe, here, arguments):
    (here / "r.toml").write_text(recipe("four-bar", CSV))
    read, write = os.pipe()
    os.close(read)
    try:
        done = command(*arguments, stdout=write)
    finally:
        os.close(write)
    assert done.stderr == ""


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs a device that is always full")
@pytest.mark.parametrize("arguments", COMMANDS[:2], ids=" ".join)
def test_output_to_a_full_disk_fails_in_one_line(command, recipe, here, arguments):
    (here / "r.toml").write_text(recipe("four-bar", CSV))
    with open("/dev/full", "w") as full:
        done = command(*arguments, stdout=full)
    assert done.returncode == 1 and len(done.stderr.splitlines()) == 1


@pytest.mark.skipif(os.name != "posix", reason="the shell closes the streams")
@pytest.mark.parametrize("closed", [">&-", "<&- >&- 2>&-"])
def test_closed_streams_do_not_matter(recipe, here, closed):
    # Services and cron jobs start programs without streams.
    (here / "r.toml").write_text(recipe("four-bar", CSV))
    call = f'exec "$0" -m geomkin run r.toml {closed}'
    done = subprocess.run(["sh", "-c", call, sys.executable], capture_output=True, text=True, timeout=20)
    assert (done.returncode, done.stderr) == (0, "")
    assert (here / "out/r/summary.json").exists()
