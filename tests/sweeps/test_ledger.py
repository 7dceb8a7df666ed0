"""The file that keeps a sweep's rows: what it may be, what of it counts, and what becomes of the rest."""

import json

import pytest

import geomkin as gk
from geomkin.sweeps import sweep
from geomkin.sweeps.sweep import Ledger

TITLE = {"geomkin": "1", "results": ["a"]}
ROWS = {"x": {"b": 1}, "y": {"b": None}}


def is_row(row):
    return isinstance(row, dict)


@pytest.fixture
def kept(tmp_path):
    """A ledger's file with two rows, in a folder of its own that the ledger has made."""
    path = tmp_path / "out/bar/kept.jsonl"
    Ledger(path, TITLE, is_row).add(ROWS)
    return path


def test_a_larger_file_than_any_sweep_s_is_left_as_it_is(kept, monkeypatch):
    size = kept.stat().st_size
    monkeypatch.setattr(sweep, "LARGEST", size)
    assert Ledger(kept, TITLE, is_row).known == ROWS
    monkeypatch.setattr(sweep, "LARGEST", size - 1)
    before = kept.read_bytes()
    with pytest.raises(gk.FileError):
        Ledger(kept, TITLE, is_row)
    assert kept.read_bytes() == before


@pytest.mark.parametrize(
    "line",
    ["[1]", "null", '{"key": 3, "row": {}}', '{"key": "z", "row": 3}', '{"row": {}}', "", "no"],
)  # fmt: skip
def test_with_a_damaged_line_it_begins_anew(kept, line):
    with kept.open("a") as file:
        file.write(f"{line}\n")
    found = Ledger(kept, TITLE, is_row)
    assert found.known == {} and found.is_restarted
    again = Ledger(kept, TITLE, is_row)
    assert again.known == {} and not again.is_restarted


@pytest.mark.parametrize("half", ["{", '{"key": "z", "row": {"b": 3}}', "\xff\xfe"])
def test_a_line_without_an_end_is_taken_away(kept, half):
    """Even a whole one: whether it is, nobody knows."""
    before = kept.read_bytes()
    with kept.open("ab") as file:
        file.write(half.encode("latin-1"))
    assert Ledger(kept, TITLE, is_row).known == ROWS and kept.read_bytes() == before


@pytest.mark.parametrize(
    "content", ["", "\n", '{"geomkin": "2"}\n{"key": "x", "row": {}}\n', "no json\n", '{"geomkin"', json.dumps(TITLE)]
)
def test_rows_of_something_else_are_begun_anew_and_a_file_without_a_title_is_just_begun(kept, content):
    kept.write_text(content)
    found = Ledger(kept, TITLE, is_row)
    assert found.known == {} and found.is_restarted == ("\n" in content)
    found.add(ROWS)
    assert Ledger(kept, TITLE, is_row).known == ROWS and kept.read_text().startswith(json.dumps(TITLE) + "\n")


def test_special_files_are_left_alone(kept):
    other = kept.with_name("other")
    kept.rename(other)
    for made in (lambda: kept.symlink_to(other), lambda: kept.symlink_to(kept.with_name("gone")), kept.mkdir):
        made()
        with pytest.raises(gk.FileError):
            Ledger(kept, TITLE, is_row)
        assert kept.is_symlink() or kept.is_dir()
        kept.unlink() if kept.is_symlink() else kept.rmdir()
    assert Ledger(other, TITLE, is_row).known == ROWS
