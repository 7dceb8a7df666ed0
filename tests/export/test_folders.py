"""Folders that are written to and looked over: interrupts that wait, what killed runs left, what cannot be read."""

import json
import os
import signal
import time
from pathlib import Path
from urllib.parse import unquote

import pytest

import geomkin as gk
from geomkin.export import files
from geomkin.export.summary import LARGEST, listed_files
from geomkin.export.summary import read_summary as told_by_summary
from geomkin.page import index
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


def test_where_no_interrupt_can_wait_files_are_written_all_the_same(tmp_path, monkeypatch):
    monkeypatch.delattr(signal, "pthread_sigmask", raising=False)
    files.write_whole(tmp_path, {"a": b"1"})
    assert (tmp_path / "a").read_bytes() == b"1"


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
@pytest.mark.parametrize("mask", [0o022, 0o027, 0o077, 0o000])
def test_files_may_be_read_by_those_whom_the_user_lets_read_new_files(tmp_path, mask):
    before = os.umask(mask)
    try:
        files.write_whole(tmp_path, {"a": b"1"})
        assert os.umask(mask) == mask
    finally:
        os.umask(before)
    assert (tmp_path / "a").stat().st_mode & 0o777 == 0o666 & ~mask


def test_a_file_that_is_gone_is_removed_and_what_is_none_is_told(tmp_path):
    (tmp_path / "a").write_text("x")
    for _ in range(2):
        files.remove(tmp_path / "a")
    assert not (tmp_path / "a").exists()
    (tmp_path / "b").mkdir()
    with pytest.raises(gk.FileError, match=r"b: cannot be removed \(.*\); remove it yourself"):
        files.remove(tmp_path / "b")


def made(folder, name, summary=None, *own):
    """A folder as a recipe was made into it."""
    (folder / name).mkdir(parents=True)
    checks = [{"name": "a", "passed": True}]
    held = {"recipe": {"kind": "four-bar"}, "checks": checks, "files": list(own)} | (summary or {})
    (folder / name / "summary.json").write_text(json.dumps(held))
    for file in own:
        (folder / name / file).write_text("x")
    return folder / name


def test_cards_say_how_many_checks_hold_and_which_fails_first(tmp_path):
    sound, bad, worse = ({"name": name, "passed": name == "sound"} for name in ("sound", "bad", "worse"))
    for name, checks in (
        ("one", [sound]), ("two", 2 * [sound]), ("fails", [sound, bad]), ("both", [worse, sound, bad]),
        ("none", []), ("odd", [sound, {"name": 3, "passed": True}]), ("odder", [{"name": "a", "passed": 1}]),
    ):  # fmt: skip
        made(tmp_path, name, {"checks": checks})
    gk.index(tmp_path)
    cards = (tmp_path / "index.html").read_text().split('<ul class="cards">')[1].split("\n")
    said = {
        name: next(card for card in cards if f"<bdi>{name}</bdi>" in card)
        for name in ("one", "two", "fails", "both", "none", "odd", "odder")
    }
    assert "Its one check holds." in said["one"] and "All 2 checks hold." in said["two"]
    assert '<p class="fails">1 of 2 checks fails: bad.</p>' in said["fails"]
    assert '<p class="fails">2 of 3 checks fail: worse and others.</p>' in said["both"]
    assert not any("check" in said[name] for name in ("none", "odd", "odder"))


def test_cards_name_files_that_are_there_up_to_a_number(tmp_path, monkeypatch):
    monkeypatch.setattr(index, "MOST_FILES", 2)
    made(tmp_path, "a", None, "a.csv")
    made(tmp_path, "b", None, "b.csv", "b.svg", "b.dxf", "b.html")
    gk.index(tmp_path)
    page = read(tmp_path)
    links = [one["href"] for one in page.of("a")]
    assert links == ["./a/a.csv", "./b/b.html", "./b/b.csv", "./b/b.dxf"]
    assert "1 file" in page.text and "4 files" in page.text and "and 2 more" in page.text and "2 recipes" in page.text
    assert page.text.count("more") == 1


def test_a_card_says_no_more_than_its_folder_does(tmp_path, monkeypatch):
    monkeypatch.setattr(index, "MOST_FILES", 2)
    made(tmp_path, "bare", {"recipe": {}})
    made(tmp_path, "odd", {"recipe": {"kind": 5}}, "odd.csv")
    made(tmp_path, "full", {"recipe": {"kind": "cam <b>"}}, "full.csv", "full.svg")
    gk.index(tmp_path)
    bare, full, odd = (tmp_path / "index.html").read_text().split('<ul class="cards">\n')[1].split("\n")[:3]
    assert "<details>" not in bare and "kind" not in bare and "kind" not in odd and "<summary>1 file</summary>" in odd
    assert '<p class="kind">cam &lt;b&gt;</p>' in full and full.count("<li>") == 3
    assert "<summary>2 files</summary>" in full and full.endswith("</a></li></ul></details></li>")


def test_more_recipes_than_cards_are_counted_and_pictures_stop_where_they_are_too_many(tmp_path, monkeypatch):
    for name in "abcd":
        own = made(tmp_path, name)
        (own / f"{name}-assembly.svg").write_bytes(b"<svg/>" * 10)
    monkeypatch.setattr(index, "MOST_CARDS", 3)
    gk.index(tmp_path)
    page = read(tmp_path)
    assert "And 1 more." in page.text and "4 recipes" in page.text
    assert f"4 recipes in {tmp_path.name}" in page.text
    monkeypatch.setattr(index, "MOST_CARDS", 4)
    gk.index(tmp_path)
    assert "more." not in read(tmp_path).text
    monkeypatch.setattr(index, "MOST_CARDS", 3)
    (one, *_) = pictures = [image["src"] for image in page.of("img")]
    assert len(pictures) == 3
    # Room for two of them, and not a sign less.
    for room, shown in ((2 * len(one), 2), (2 * len(one) - 1, 1), (0, 0)):
        monkeypatch.setattr(index, "ALL_PICTURES", room)
        gk.index(tmp_path)
        assert len(read(tmp_path).of("img")) == shown
    monkeypatch.undo()
    monkeypatch.setattr(index, "LARGEST_PICTURE", 59)
    gk.index(tmp_path)
    assert not read(tmp_path).of("img")
    monkeypatch.setattr(index, "LARGEST_PICTURE", 60)
    gk.index(tmp_path)
    pictures = read(tmp_path).of("img")
    assert len(pictures) == 4 and all(unquote(image["src"]).endswith("," + 10 * "<svg/>") for image in pictures)


def test_what_cannot_be_read_is_passed_by_or_told(tmp_path, monkeypatch):
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
    with pytest.raises(gk.FileError, match="is not one of ours"):
        gk.index(tmp_path)
    monkeypatch.undo()
    assert (tmp_path / "index.html").read_bytes() == before
    monkeypatch.setattr(Path, "iterdir", refused)
    with pytest.raises(gk.FileError, match=r"cannot be read \(Permission denied\); give a folder"):
        gk.index(tmp_path)


def test_a_summary_as_large_as_none_of_ours_is_passed_by(tmp_path):
    (tmp_path / "summary.json").write_text(json.dumps({"a": ""}))
    short = len((tmp_path / "summary.json").read_bytes())
    for size, read_back in ((LARGEST, True), (LARGEST + 1, False)):
        (tmp_path / "summary.json").write_text(json.dumps({"a": "x" * (size - short)}))
        assert bool(told_by_summary(tmp_path)) == read_back
    for strange in ("[1]", "3", '"a"', "null", "{", "[" * 100_000):
        (tmp_path / "summary.json").write_text(strange)
        assert told_by_summary(tmp_path) == {} and listed_files(tmp_path) == set()


def test_of_the_files_that_a_summary_tells_only_those_that_are_made_are_ours(tmp_path):
    """What it tells is removed before a recipe is made anew: nothing else may be, whatever stands in it."""
    own = ["a.dxf", "A.STL", "a-assembly.svg", "a.found.toml"]
    others = ["a.toml", "notes.txt", "found.toml", ".dxf", "../a.dxf", "b/a.dxf", "a.docx", 3, None, ["a.dxf"], {}]
    folder = made(tmp_path, "a", {"files": [*own, *others]})
    assert listed_files(folder) == set(own)
    for strange in ("a.dxf", {"a.dxf": 1}, None, 7):
        assert listed_files(made(tmp_path, f"b{strange!r:.3}", {"files": strange})) == set()
