"""The command line: wrong usage, odd names, closed pipes and full disks under its output."""

import json
import os
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

from tests.campaign import by_default

CSV = {"files.write": '["csv"]'}


def test_two_recipes_of_one_name_are_not_written_over_each_other(geomkin, recipe, here):
    for folder in ("a", "b\nc"):
        (here / folder).mkdir()
        (here / folder / "r.toml").write_text(recipe("four-bar"))
    result = geomkin("run", "a", "b\nc")
    assert result.exit_code == 2 and "--out" in result.stderr and not (here / "out").exists()
    assert result.stderr.splitlines()[-1].startswith("Error: "), "a name with a newline broke the line"


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


COMMANDS = [["list"], ["run", "r.toml"]]


@pytest.mark.parametrize("arguments", by_default(COMMANDS, slice(1, None)), ids=" ".join)
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
@pytest.mark.parametrize("arguments", COMMANDS[1:], ids=" ".join)
def test_output_to_a_full_disk_fails_in_one_line(command, recipe, here, arguments):
    (here / "r.toml").write_text(recipe("four-bar", CSV))
    with open("/dev/full", "w") as full:
        done = command(*arguments, stdout=full)
    assert done.returncode == 1 and len(done.stderr.splitlines()) == 1


@pytest.mark.skipif(os.name != "posix", reason="the shell closes the streams")
def test_closed_streams_do_not_matter(recipe, here):
    # Services and cron jobs start programs without streams.
    (here / "r.toml").write_text(recipe("four-bar", CSV))
    call = 'exec "$0" -m geomkin run r.toml <&- >&- 2>&-'
    done = subprocess.run(["sh", "-c", call, sys.executable], capture_output=True, text=True, timeout=20)
    assert (done.returncode, done.stderr) == (0, "")
    assert (here / "out/r/summary.json").exists()
