"""A format added from outside by one row of WRITERS: everything that lists formats knows it.

It takes three files: the writer, its row, and its test.
"""

import json
from importlib.metadata import version

import pytest
from click.testing import CliRunner

import geomkin as gk
from geomkin.cli import cli
from geomkin.export import WRITERS, Job, Writer

GEAR = 'kind = "spur-gear"\ngear = { teeth = 17, module = 2 }\nfiles = { write = [%s] }\n'


def outlines(job: Job) -> dict[str, bytes]:
    """A toy: the corners of all outlines as text, one file."""
    lines = [f"{c.part.name} {len(c.loops[0].points)} {c.area:.3f}" for c in job.flats]
    return {f"{job.name}.txt": "\n".join(lines).encode()}


def lone(job: Job) -> dict[str, bytes]:
    """A toy with a file for each part."""
    return {f"{c.part.name}.lone": str(c.chord_area).encode() for c in job.solids}


@pytest.fixture(autouse=True)
def toys(monkeypatch):
    monkeypatch.setitem(WRITERS, "txt", Writer("parts", outlines, ("click", "shapely"), flat=True))
    monkeypatch.setitem(WRITERS, "lone", Writer("parts", lone))


def test_recipe_writes_the_added_format_and_lists_it_in_the_summary(tmp_path):
    recipe = gk.load(GEAR % '"txt", "csv", "lone"').with_name("gear")
    made = gk.make(recipe, tmp_path)
    assert [path.name for path in made.files] == ["gear.csv", "gear.txt", "gear.lone", "summary.json"]
    name, corners, area = (tmp_path / "gear" / "gear.txt").read_text().split()
    data = json.loads((tmp_path / "gear" / "summary.json").read_text())
    assert data["files"] == ["gear.csv", "gear.lone", "gear.txt"] and data["recipe"]["files"]["write"] == [
        "txt",
        "csv",
        "lone",
    ]
    (part,) = data["parts"]
    assert name == part["name"] == "gear" and int(corners) > 17 and float(area) == round(part["written_area_mm2"], 3)
    assert part["written_volume_mm3"] > 0
    # In the order of the rows, those of the formats that were written alone.
    named = [(name, version(name)) for name in ("numpy", "click", "shapely")]
    assert list(data["versions"].items())[1:] == named


def test_the_command_knows_it(tmp_path):
    (tmp_path / "gear.toml").write_text(GEAR % '"txt", "csv"')
    call = ["run", str(tmp_path / "gear.toml"), "--out", str(tmp_path), "--only", "txt"]
    result = CliRunner().invoke(cli, call)
    assert result.exit_code == 0
    assert sorted(p.name for p in (tmp_path / "gear").iterdir()) == ["gear.txt", "summary.json"]
    assert CliRunner().invoke(cli, [*call[:-1], "text"]).exit_code == 2
