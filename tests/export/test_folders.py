"""Folders that are written to and looked over: interrupts that wait, what killed runs left, what cannot be read."""

import json
import signal
from pathlib import Path

import pytest

import geomkin as gk
from geomkin.export import summary
from tests.export.test_index import read


@pytest.mark.skipif(not hasattr(signal, "pthread_sigmask"), reason="the system cannot make an interrupt wait")
@pytest.mark.parametrize("fails", [False, True])
def test_an_interrupt_waits_until_no_half_file_is_left(tmp_path, monkeypatch, fails):
    waits, real = [], summary._write_temporary

    def set_down(path, content):
        waits.append(signal.SIGINT in signal.pthread_sigmask(signal.SIG_BLOCK, []))
        if fails:
            raise OSError(28, "No space left on device")
        return real(path, content)

    monkeypatch.setattr(summary, "_write_temporary", set_down)
    try:
        summary.write_whole(tmp_path, {"a": b"1", "b": b"2"})
    except gk.FileError as error:
        assert fails and "No space left" in str(error)
    assert all(waits) and len(waits) == (1 if fails else 2)
    assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, [])
    assert sorted(path.name for path in tmp_path.iterdir()) == ([] if fails else ["a", "b"])


def made(folder, name, summary=None, *own):
    """A folder as a recipe was made into it."""
    (folder / name).mkdir(parents=True)
    checks = [{"name": "a", "passed": True}]
    held = {"recipe": {"kind": "four-bar"}, "checks": checks, "files": list(own)} | (summary or {})
    (folder / name / "summary.json").write_text(json.dumps(held))
    for file in own:
        (folder / name / file).write_text("x")
    return folder / name


def test_unreadable_entries_are_skipped_or_reported(tmp_path, monkeypatch):
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
