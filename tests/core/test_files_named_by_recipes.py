"""Files that a recipe names: where they may lie, how large they may be, and how others are refused."""

import pytest

import geomkin as gk
from geomkin.core import names as beside


def refused(name, folder):
    with pytest.raises(gk.DesignError) as refusal:
        beside.read_text_file(name, folder, "a CSV file")
    assert refusal.value.field == "file" and str(refusal.value).isprintable()
    return refusal.value


def test_a_file_beside_or_below_is_read_with_or_without_a_mark_at_its_start(tmp_path):
    (tmp_path / "in").mkdir()
    for content in ("größe".encode(), b"\xef\xbb\xbf" + "größe".encode()):
        (tmp_path / "in/a.csv").write_bytes(content)
        for name, folder in (("in/a.csv", tmp_path), ("a.csv", tmp_path / "in"), ("../in/a.csv", tmp_path / "in")):
            assert beside.read_text_file(name, str(folder), "a CSV file") == "größe"
        assert beside.read_text_file(tmp_path / "in/a.csv", None, "a CSV file") == "größe"


def test_files_outside_the_recipe_folder_are_refused(tmp_path):
    (tmp_path / "in").mkdir()
    (tmp_path / "a.csv").write_text("1")
    (tmp_path / "in/link.csv").symlink_to(tmp_path / "a.csv")
    for name in ("../a.csv", "link.csv", str(tmp_path / "a.csv")):
        refused(name, tmp_path / "in")
        assert beside.read_text_file(tmp_path / "in" / name, None, "a CSV file") == "1"


@pytest.mark.parametrize(
    ("content", "reason"),
    [(b"12345", ""), (b"123456", "5 bytes"), (b"\xff\xfe", "UTF-8")],
)
def test_a_file_is_text_of_bearable_size(tmp_path, monkeypatch, content, reason):
    monkeypatch.setattr(beside, "LARGEST", 5)
    (tmp_path / "a.csv").write_bytes(content)
    if not reason:
        assert beside.read_text_file("a.csv", tmp_path, "a CSV file") == content.decode()
        return
    assert reason in refused("a.csv", tmp_path).problem


@pytest.mark.parametrize(("separator", "point"), [(",", "."), (";", "."), (";", ",")])
def test_cells_are_the_same_whatever_separates_them(separator, point):
    numbers = [["0", "-1.5", ".25"], ["10", "+2.5e-3", "7"]]
    text = "\n".join(separator.join(row).replace(".", point) for row in [["a", "b", "c"], *numbers])
    cells = beside.csv_cells(f"\n{text}\n", "a.csv")
    assert cells[1] == ["a", "b", "c"] and [list(map(float, row)) for row in cells[2:]] == [
        list(map(float, row)) for row in numbers
    ]


def test_only_a_plain_decimal_comma_becomes_a_point():
    cells = beside.csv_cells('a;b\n1.234,5;1,2,3\nx, y;"1,5"', "a.csv")
    assert cells[1:] == [["1.234,5", "1,2,3"], ["x, y", "1.5"]]
