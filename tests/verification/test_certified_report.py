"""The report with the results of its certificate."""

import pytest

import geomkin as gk
from geomkin.verification.certificate_files import certify

GEAR = {"kind": "spur-gear", "gear": {"teeth": 12, "module": 2}, "files": {"write": ["dxf", "report-md"]}}


@pytest.fixture
def folder(tmp_path):
    gk.make(gk.load(GEAR).with_name("disk"), tmp_path)
    return tmp_path / "disk"


def rows(folder):
    lines = (folder / "disk-report.md").read_text().split("## Certificate")[1].splitlines()
    cells = [[cell.strip() for cell in line.split("|")[1:-1]] for line in lines if line.startswith("| disk.")]
    return {name: (proof, deviation, verdict) for name, proof, deviation, verdict in cells}


@pytest.mark.campaign
def test_report_has_the_results_and_is_itself_as_designed(folder):
    before = (folder / "disk-report.md").read_bytes()
    assert not rows(folder)
    assert certify(folder).passed
    assert rows(folder) == {"disk.dxf": ("made again", "", "as designed")}
    after = (folder / "disk-report.md").read_bytes()
    # Verified again it is the same, and made again it is as before.
    (again,) = gk.verify(folder)
    assert again.passed and certify(folder).passed and (folder / "disk-report.md").read_bytes() == after
    gk.make(gk.load(GEAR).with_name("disk"), folder.parent)
    assert (folder / "disk-report.md").read_bytes() == before


def test_report_states_a_file_that_is_not_as_designed(folder):
    text = (folder / "disk.dxf").read_text()
    (folder / "disk.dxf").write_text(text.replace("CUT", "CAT"))
    assert not certify(folder).passed
    assert rows(folder)["disk.dxf"][2] == "NOT as designed"


def test_a_report_that_was_changed_is_a_problem_and_is_left_as_it_is(folder):
    certify(folder)
    changed = (folder / "disk-report.md").read_text().replace("as designed", "AS DESIGNED")
    (folder / "disk-report.md").write_text(changed)
    assert not certify(folder).passed
    assert (folder / "disk-report.md").read_text() == changed


def test_a_changed_picture_of_a_report_is_compared_as_a_text(folder):
    path = folder / "disk-report-drawing.svg"
    path.write_text(path.read_text().replace("stroke", "strike", 1))
    (file,) = [file for file in gk.verify(folder)[0].files if not file.passed]
    assert (file.file, file.format, len(file.problems)) == (path.name, "report-md", 1)
