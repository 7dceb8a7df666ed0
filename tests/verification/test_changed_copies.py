"""Files changed a little, or written again by other programs: what passes, and what is said of the rest."""

import re
import zipfile

import ezdxf
import numpy as np
import pytest
import trimesh

import geomkin as gk
from geomkin.verification.certificate_files import certify
from geomkin.verification.made_again import difference
from tests.verification.damage import GEAR, wrong


@pytest.mark.parametrize(("code", "by", "passes"), [("10", 1e-3, True), ("10", 1.0, False), ("42", 0.1, False)])
def test_a_vertex_of_an_old_drawing_is_measured(tmp_path, code, by, passes):
    settings = 'dxf_version = "R12"\ncurves = "arcs"\nwrite = ["dxf"]'
    gk.make(gk.load(re.sub(r"write = .*", settings, GEAR)).with_name("disk"), tmp_path)
    path = tmp_path / "disk/disk.dxf"
    text = path.read_text()
    found = re.search(rf"VERTEX\n(?:(?! *0\n).*\n.*\n)*? *{code}\n(.*)\n", text)
    path.write_text(f"{text[: found.start(1)]}{float(found[1]) + by}{text[found.end(1) :]}")
    (certificate,) = gk.verify(tmp_path)
    (file,) = (file for file in certificate.files if file.file == "disk.dxf")
    assert file.passed == passes and np.isfinite(file.deviation) and len(file.problems) == (not passes)


@pytest.mark.parametrize("kind", ["page", "assembly-svg", "assembly-dxf", "steps", "animation", "plots"])
def test_a_number_of_a_picture_may_differ_by_the_last_of_many_digits_alone(kind):
    for old, new, passes in (
        ("143.8", "143.9", False),
        ("100.0", "100.1", False),
        ("324.9151297", "324.9151298", True),
    ):
        one, other = (f"  8\nCUT\n 10\n{number}\n".encode() for number in (old, new))
        apart = difference(other, one, kind)
        assert (not apart.problems) == passes and apart.digits == passes


@pytest.mark.campaign
def test_a_version_is_a_version(disk):
    path = disk / "summary.json"
    text = path.read_text()
    for version, passes in (
        ("9.9", True),
        ("9.9rc1.dev0+g12ab", True),
        ("9.9 certified for 400 kg", False),
        ("a", False),
    ):
        path.write_text(re.sub(r'("numpy": )"[^"]*"', rf'\1"{version}"', text))
        assert (path.name not in wrong(disk)) == passes
    step, made = (f"FILE_NAME('a','geomkin {version}','');".encode() for version in ("9 safe", "0.1.0"))
    assert (
        difference(step, made, "step").problems and not difference(step.replace(b" safe", b""), made, "step").problems
    )


@pytest.mark.campaign
def test_ends_of_lines_and_a_mark_before_the_first_one_may_change(disk, tmp_path):
    report = {"kind": "spur-gear", "gear": {"teeth": 8, "module": 2}, "files": {"write": ["dxf", "report-md"]}}
    gk.make(gk.load(report).with_name("stated"), tmp_path)
    certify(tmp_path / "stated")
    for folder in (disk, tmp_path / "stated"):
        texts = [path for path in folder.iterdir() if path.suffix not in (".stl", ".3mf", ".glb")]
        assert len(texts) > 3
        for path in texts:
            path.write_bytes(path.read_bytes().replace(b"\n", b"\r\n"))
        assert not wrong(folder)
        for path in texts:
            path.write_bytes((b"" if path.suffix in (".dxf", ".step") else "\ufeff".encode()) + path.read_bytes())
        assert not wrong(folder)
    # No program would read it.
    (disk / "disk.dxf").write_bytes("\ufeff".encode() + (disk / "disk.dxf").read_bytes())
    assert set(wrong(disk)) == {"disk.dxf"}


def test_a_report_with_earlier_results_says_so(tmp_path):
    report = {"kind": "spur-gear", "gear": {"teeth": 8, "module": 2}, "files": {"write": ["dxf", "svg", "report-md"]}}
    gk.make(gk.load(report).with_name("stated"), tmp_path)
    certify(tmp_path / "stated")
    (tmp_path / "stated/stated.dxf").write_text("0\nEOF\n")
    found = wrong(tmp_path / "stated")
    assert set(found) == {"stated.dxf", "stated-report.md"}
    (problem,) = found["stated-report.md"].problems
    assert "verification" in problem and "line" not in problem
    path = tmp_path / "stated/stated-report.md"
    path.write_text(path.read_text().replace("module", "modulus"))
    assert "modulus" in wrong(tmp_path / "stated")[path.name].problems[0]


def test_normals_of_a_text_are_not_compared(disk):
    path = disk / "gear.stl"
    path.write_text(trimesh.load(path, process=False).export(file_type="stl_ascii"))
    assert not any("normals" in problem for problem in wrong(disk)[path.name].problems)


def test_what_is_in_the_place_of_a_file_is_named(disk):
    (disk / "disk.svg").rename(disk / "plate")
    (disk / "disk.svg").symlink_to(disk / "plate")
    (disk / "more.dxf").mkdir()
    (disk / "disk.csv").unlink()
    words = {
        name: next(word for word in ("link", "folder", "missing") if word in file.problems[0])
        for name, file in wrong(disk).items()
    }
    assert words == {"disk.svg": "link", "more.dxf": "folder", "disk.csv": "missing"}


def test_a_package_packed_in_another_way_is_named_if_nothing_else_differs(disk):
    path = disk / "disk.3mf"
    with zipfile.ZipFile(path) as package:
        inside = {name: package.read(name) for name in package.namelist()}
    for changed in (False, True):
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as package:
            for name, content in inside.items():
                package.writestr(name, content.replace(b'lang="en"', b'lang="fr"') if changed else content)
        problems = " ".join(wrong(disk)[path.name].problems)
        assert ("packed" in problems) != changed and ("fr" in problems) == changed


def test_extents_that_a_program_has_not_set_are_none(disk):
    drawing = ezdxf.readfile(disk / "disk.dxf")
    drawing.modelspace().reset_extents()
    drawing.saveas(disk / "disk.dxf")
    assert not any("extents" in problem for problem in wrong(disk)["disk.dxf"].problems)
