"""Folders that are written to and looked over: interrupts that wait, what killed runs left, what cannot be read."""

import json
import os
import signal
import time
from pathlib import Path

import pytest

import geomkin as gk
from geomkin.export import files
from geomkin.export.summary import LARGEST, listed_files, read_summary
from tests.export.test_index import read


@pytest.mark.skipif(not hasattr(signal, "pthread_sigmask"), reason="the system cannot make an interrupt wait")
@pytest.mark.parametrize("fails", [False, True])
def test_an_interrupt_waits_until_no_half_file_is_left(tmp_path, monkeypatch, fails):
    waits, real = [], files._write_temporary

    def set_down(path, content):
        waits.append(signal.SIGINT in signal.pthread_sigmask(signal.SIG_BLOCK, []))
        if fails:
            raise OSError(28, "No space left on device")
        return real(path, content)

    monkeypatch.setattr(files, "_write_temporary", set_down)
    try:
        files.write_whole(tmp_path, {"a": b"1", "b": b"2"})
    except gk.FileError as error:
        assert fails and "No space left" in str(error)
    assert all(waits) and len(waits) == (1 if fails else 2)
    assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, [])
    assert sorted(path.name for path in tmp_path.iterdir()) == ([] if fails else ["a", "b"])


def test_what_a_killed_run_left_goes_and_what_another_writes_stays(tmp_path):
    old, young, mine = (tmp_path / name for name in (f"{files.PREFIX}old", f"{files.PREFIX}young", "mine"))
    for path, age in ((old, files.LEFT_BEHIND + 60), (young, files.LEFT_BEHIND - 60), (mine, 10 * files.LEFT_BEHIND)):
        path.write_text("x")
        os.utime(path, 2 * (time.time() - age,))
    (tmp_path / f"{files.PREFIX}folder").mkdir()
    os.utime(tmp_path / f"{files.PREFIX}folder", (0, 0))
    files.write_whole(tmp_path, {"a": b"1"})
    left = {path.name for path in tmp_path.iterdir()}
    assert left == {young.name, "mine", "a", f"{files.PREFIX}folder"}


@pytest.mark.skipif(os.name != "posix", reason="permissions are otherwise there")
@pytest.mark.parametrize("mask", [0o022, 0o077])
def test_files_may_be_read_by_those_whom_the_user_lets_read_new_files(tmp_path, mask):
    before = os.umask(mask)
    try:
        files.write_whole(tmp_path, {"a": b"1"})
        assert os.umask(mask) == mask
    finally:
        os.umask(before)
    assert (tmp_path / "a").stat().st_mode & 0o777 == 0o666 & ~mask


def made(folder, name, summary=None, *own):
    """A folder as a recipe was made into it."""
    (folder / name).mkdir(parents=True)
    checks = [{"name": "a", "passed": True}]
    held = {"recipe": {"kind": "four-bar"}, "checks": checks, "files": list(own)} | (summary or {})
    (folder / name / "summary.json").write_text(json.dumps(held))
    for file in own:
        (folder / name / file).write_text("x")
    return folder / name


def test_what_cannot_be_read_is_passed_by_or_reported(tmp_path, monkeypatch):
    own = made(tmp_path, "a", None, "a.csv", "a.svg")
    (own / "a-assembly.svg").write_bytes(b"<svg/>")
    real_file, real_open = Path.is_file, Path.open

    def refused(path, *rest, **more):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "is_file", lambda path: refused(path) if path.name == "a.svg" else real_file(path))
    monkeypatch.setattr(
        Path, "open", lambda path, *r, **m: refused(path) if path.name == "a-assembly.svg" else real_open(path, *r, **m)
    )
    gk.index(tmp_path)
    page = read(tmp_path)
    assert [one["href"] for one in page.of("a")] == ["./a/a.csv"] and not page.of("img")
    before = (tmp_path / "index.html").read_bytes()
    monkeypatch.setattr(Path, "open", refused)
    with pytest.raises(gk.FileError):
        gk.index(tmp_path)
    monkeypatch.undo()
    assert (tmp_path / "index.html").read_bytes() == before
    monkeypatch.setattr(Path, "iterdir", refused)
    with pytest.raises(gk.FileError):
        gk.index(tmp_path)


def test_a_summary_as_large_as_none_of_ours_is_passed_by(tmp_path):
    (tmp_path / "summary.json").write_text(json.dumps({"a": ""}))
    short = len((tmp_path / "summary.json").read_bytes())
    for size, read_back in ((LARGEST, True), (LARGEST + 1, False)):
        (tmp_path / "summary.json").write_text(json.dumps({"a": "x" * (size - short)}))
        assert bool(read_summary(tmp_path)) == read_back
    for strange in ("[1]", "3", '"a"', "null", "{", "[" * 100_000):
        (tmp_path / "summary.json").write_text(strange)
        assert read_summary(tmp_path) == {} and listed_files(tmp_path) == set()


def test_of_the_files_that_a_summary_tells_only_those_that_are_made_are_ours(tmp_path):
    """What it tells is removed before a recipe is made anew: nothing else may be, whatever stands in it."""
    own = ["a.dxf", "A.STL", "a-assembly.svg", "a.found.toml"]
    others = ["a.toml", "notes.txt", "found.toml", ".dxf", "../a.dxf", "b/a.dxf", "a.docx", 3, None, ["a.dxf"], {}]
    folder = made(tmp_path, "a", {"files": [*own, *others]})
    assert listed_files(folder) == set(own)
    for strange in ("a.dxf", {"a.dxf": 1}, None, 7):
        assert listed_files(made(tmp_path, f"b{strange!r:.3}", {"files": strange})) == set()
