"""What is measured besides distances: numbers of parts and marks, lines that enclose nothing, tabs, places and folds."""

import re
import shutil
import zipfile
from dataclasses import replace

import ezdxf
import numpy as np
import pytest

import geomkin as gk
from geomkin.plane.primitives import Circle
from geomkin.recipe.settings import Files
from geomkin.verification import comparison
from geomkin.verification.comparison import Shape, colliding, exact_part, measure_drawing
from geomkin.verification.outline import Drawing, Line, UnreadableError, outline_of
from geomkin.verification.read_back import read_stl, read_svg
from geomkin.verification.solids import Mesh, measure_mesh, merged
from tests.campaign import by_default
from tests.verification.damage import RECIPE, wrong

BARE = f"{RECIPE}labels = false\n".replace('"csv", "bom", "step", "3mf", "glb"', '"3mf"')
MODEL = "3D/3dmodel.model"


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """The four-bar with tabs on a sheet, without labels."""
    folder = tmp_path_factory.mktemp("written")
    gk.make(gk.load(f'{BARE}tab_width = 4\nsheet = [150, 150]\ncurves = "arcs"\n').with_name("tabs"), folder)
    gk.make(gk.load(f"{BARE}sheet = [150, 150]\n").with_name("bare"), folder)
    return folder


@pytest.fixture
def tabs(written, tmp_path):
    return shutil.copytree(written / "tabs", tmp_path / "tabs")


@pytest.fixture
def bare(written, tmp_path):
    return shutil.copytree(written / "bare", tmp_path / "bare")


def problems(report):
    return [str(problem) for problem in report.problems]


@pytest.mark.parametrize("name", by_default(["tabs", "bare"], ["bare"]))
def test_good_files_pass(written, measuring, name):
    (certificate,) = gk.verify(written / name)
    assert certificate.passed, [(file.file, problems(file)) for file in certificate.files if file.problems]
    assert {file.file: file.parts for file in certificate.files if file.parts > 1} == {
        f"{name}.{ending}": 8 for ending in ("dxf", "svg", "3mf")
    }


def redrawn(path, monkeypatch, change):
    """A drawing read, changed and written by another program."""
    monkeypatch.setattr(ezdxf.options, "write_fixed_meta_data_for_testing", True)
    drawing = ezdxf.readfile(path)
    change(list(drawing.modelspace()))
    drawing.saveas(path)


def test_a_part_in_place_of_another_is_found(bare, monkeypatch):
    """The lines are those of parts of the recipe, and as many."""

    def change(lines):
        outlines = [k for k, line in enumerate(lines) if line.dxftype() == "LWPOLYLINE"]
        points = {k: np.array(lines[k].get_points("xy")) for k in outlines}
        *_, rocker, coupler, _ = sorted(outlines, key=lambda k: np.ptp(points[k][:, 0]))
        shift = points[coupler].min(axis=0) - points[rocker].min(axis=0)
        lines[coupler].set_points(points[rocker] + shift, format="xy")
        for k in (1, 2):
            hole = lines[rocker - k].dxf.center
            lines[coupler - k].dxf.center = (hole.x + shift[0], hole.y + shift[1])

    redrawn(bare / "bare.dxf", monkeypatch, change)
    (report,) = wrong(bare).values()
    assert sorted(problem.partition(":")[0] for problem in problems(report)) == ["coupler", "rocker"]
    assert all(re.search(r"\b[02]\b.*\b1\b", problem) for problem in problems(report))


EXTRA = {
    "a closed line of two points": ("CUT", r"\g<0> M0,50 L80,50 Z"),
    "a point": ("CUT", r"\g<0> M3,3 Z"),
    "a mark next to the parts": ("LABEL", r"\g<0> M1,1 L1,2"),
    "a mark five times": ("LABEL", r"\g<0>" + r" \g<0>" * 4),
    "a mark to and fro": ("LABEL", r"\g<0> L\g<start> L\g<second>"),
}  # fmt: skip


@pytest.mark.parametrize("extra", by_default(EXTRA, slice(2)))
def test_lines_added_to_a_path_are_found(copy, extra):
    layer, pattern = EXTRA[extra]
    path = copy / "bars.svg"
    line = rf'(?<=d=")M(?P<start>\S+) (?P<second>[^ Z"]+)[^"]*(?=" class="{layer}")'
    text = re.sub(line, pattern, path.read_text(), count=1)
    assert text != path.read_text()
    path.write_text(text)
    (report,) = wrong(copy).values()
    assert report.file == path.name and len(report.problems) == 1


def exchanged(text):
    """The geometry of a tab exchanged with that of the piece after it."""
    tab = re.search(r'd="([^"]*)" class="TAB"', text)
    cut = re.compile(r'd="([^"]*)" class="CUT"').search(text, tab.end())
    return f"{text[: tab.start(1)]}{cut[1]}{text[tab.end(1) : cut.start(1)]}{tab[1]}{text[cut.end(1) :]}"


def shortened(text):
    """Both ends of the straight tabs moved by 0.5 mm, with the ends of the pieces next to them."""
    for x, y, other, same in re.findall(r'd="M([\d.]+),([\d.]+)L([\d.]+),([\d.]+)" class="TAB"', text):
        if y == same:
            step = 0.5 if float(x) < float(other) else -0.5
            text = text.replace(f"{x},{y}", f"{float(x) + step:.7f},{y}")
            text = text.replace(f"{other},{y}", f"{float(other) - step:.7f},{y}")
    return text


@pytest.mark.parametrize("change", [exchanged, shortened])
def test_tabs_of_svg_are_measured(tabs, change):
    path = tabs / "tabs.svg"
    text = change(path.read_text())
    assert text != path.read_text()
    path.write_text(text)
    (report,) = wrong(tabs).values()
    assert report.file == path.name and report.deviation < 1.08 * 0.005
    assert all("tabs" in problem for problem in problems(report))


def test_tabs_of_dxf_are_measured(tabs, monkeypatch):
    def change(lines):
        k = next(k for k, line in enumerate(lines) if line.dxf.layer == "TAB")
        points = [line.get_points() for line in lines[k : k + 2]]
        for line, others in zip(lines[k : k + 2], points[::-1]):
            line.set_points(others)

    redrawn(tabs / "tabs.dxf", monkeypatch, change)
    (report,) = wrong(tabs).values()
    assert "tabs" in problems(report)[0] and len(report.problems) == 1


@pytest.mark.parametrize("text", ["2.5mm", "2_5", "25%", "nan", " 2.5"])
def test_a_size_of_a_circle_is_a_number_without_a_unit(copy, text):
    """Programs that read an SVG file take a millimetre for 3.78 units, whatever the view box."""
    path = copy / "bars.svg"
    path.write_text(re.sub(r' r="[^"]*"', f' r="{text}"', path.read_text(), count=1))
    assert text in problems(wrong(copy)["bars.svg"])[0]


def test_plates_in_each_other_meet_unless_one_is_in_a_hole():
    disk, ring = (outline_of(Circle(20 + 5j, radius), 1e-3) for radius in (10.0, 7.0))
    small = outline_of(Circle(20 + 5j, 3.0), 1e-3)
    assert colliding([Shape(disk, ()), Shape(small, ())]) == [(0, 1)]
    assert colliding([Shape(disk, (ring,)), Shape(small, ())]) == []
    assert colliding([Shape(disk, (ring,)), Shape(small.placed(1 + 0j, 5 + 0j), ())]) == [(0, 1)]
    assert colliding([Shape(disk, (ring,)), Shape(small.placed(1 + 0j, 14 + 0j), ())]) == []


def moved(folder, name, place):
    """The first copy of a solid moved to a place, as a function of those of all, mm."""
    path = next(folder.glob("*.3mf"))
    with zipfile.ZipFile(path) as package:
        inside = {name: package.read(name).decode() for name in package.namelist()}
    names = dict(re.findall(r'<object id="(\d+)" name="(\w+)"', inside[MODEL]))
    items = {names[item[1]]: item for item in re.finditer(r'<item objectid="(\d+)" transform="(.*?)"/>', inside[MODEL])}
    numbers = {name: np.array(item[2].split(), dtype=float).reshape(4, 3) for name, item in items.items()}
    (start, end), matrix = items[name].span(2), numbers[name]
    matrix[3, :2] = place(numbers)
    text = " ".join(f"{number:g}" for number in matrix.ravel())
    inside[MODEL] = inside[MODEL][:start] + text + inside[MODEL][end:]
    with zipfile.ZipFile(path, "w") as package:
        for name, text in inside.items():
            package.writestr(zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0)), text)


PLACES = {
    "as it is": (lambda solids: solids["spacer"][3, :2], True),
    "within the ground": (lambda solids: (np.array([50, 0, 0]) @ solids["ground"][:3] + solids["ground"][3])[:2], False),
    "half a metre away": (lambda solids: (500, 20), False),
    "next to the corner of the bed": (lambda solids: (20, -20), False),
    "above the bed": (lambda solids: (20, 160), False),
}  # fmt: skip


@pytest.mark.parametrize("place", by_default(PLACES, slice(2)))
def test_solids_are_apart_and_on_the_bed(bare, place):
    moved(bare, "spacer", PLACES[place][0])
    assert set(wrong(bare)) == (set() if PLACES[place][1] else {"bare.3mf"})


@pytest.fixture(scope="module")
def solid(written):
    """The crank of the file and its exact curves."""
    recipe = gk.load(BARE)
    (mesh,), _, _ = read_stl(written / "bare/crank.stl")
    return mesh, exact_part(next(part for part in recipe.parts if part.name == "crank"), Files())


def with_triangles(mesh, corners, removed=()):
    """A mesh less some triangles, with others by their corners (n, 3, 3)."""
    triangles = np.concatenate([np.delete(mesh.corners[mesh.faces], list(removed), axis=0), corners])
    return Mesh(mesh.name, *merged(triangles))


def folded(mesh, height, corner):
    """A triangle of a face replaced by three that meet in another corner of its plane."""
    k = next(k for k, face in enumerate(mesh.faces) if np.all(mesh.corners[face, 2] == height))
    triangle = mesh.corners[mesh.faces[k]]
    fan = [[a, b, corner] for a, b in zip(triangle, np.roll(triangle, -1, axis=0))]
    return with_triangles(mesh, np.array(fan), [k])


@pytest.mark.parametrize("height", [0.0, 3.0])
@pytest.mark.parametrize("far", [True, False])
def test_folds_of_a_face_are_found(solid, height, far):
    """Their volume and all sections between the faces are those of the part."""
    mesh, exact = solid
    assert not measure_mesh(mesh, exact, 0.005).problems
    level = mesh.corners[mesh.corners[:, 2] == height]
    corner = np.array([300.0, 200.0, height]) if far else level[np.argmax(level[:, 0] - 9 * np.abs(level[:, 1]))]
    changed = folded(mesh, height, corner)
    assert changed.volume == pytest.approx(mesh.volume) and changed.is_closed
    assert len(measure_mesh(changed, exact, 0.005).problems) == 1 + far


@pytest.mark.parametrize("height", [0.0, 3.0])
def test_a_sheet_without_thickness_is_found(solid, height):
    mesh, exact = solid
    sheet = np.array([[0, 100, height], [50, 100, height], [0, 150, height]])
    assert len(measure_mesh(with_triangles(mesh, [sheet, sheet[::-1]]), exact, 0.005).problems) == 2


def test_a_plate_of_another_part_is_not_compared(disk, good, monkeypatch):
    """Its area or number of holes says so, and a comparison of different shapes takes long."""
    shutil.copy(good / "bars.svg", disk / "disk.svg")
    real = comparison.likely_positions

    def likely_positions(found, exact, tolerance):
        assert found.area == pytest.approx(exact.area, rel=0.3)
        return real(found, exact, tolerance)

    monkeypatch.setattr(comparison, "likely_positions", likely_positions)
    assert set(wrong(disk)) == {"disk.svg"}


@pytest.mark.parametrize("groups", [("a-1", "b-2"), ("", "")])
def test_parts_of_equal_shape_count_by_their_groups(groups):
    """Without groups, as in DXF, either of them may be the other one."""
    parts = [replace(gk.load(BARE).parts[0], name=name) for name in "ab"]
    exact = [exact_part(part, Files()) for part in parts]
    lines = [
        Line(loop.placed(1 + 0j, shift + 0j), "HOLE" if k else parts[0].layer, group)
        for shift, group in zip((0, 300), groups)
        for k, loop in enumerate(exact[0].drawn.loops)
    ]
    measured = measure_drawing(Drawing(tuple(lines[::-1])), Drawing(tuple(lines)), exact, 0.005)
    assert len(measured) == 2 and not any(one.problems for one in measured)
    missing = measure_drawing(Drawing(tuple(lines[: len(lines) // 2])), Drawing(tuple(lines)), exact, 0.005)
    assert len([one for one in missing if one.problems]) == 1


@pytest.mark.parametrize("path", ["M3,3", "M3,3 3,3", "M3,3Z"])
def test_a_line_without_length_is_refused(path):
    svg = f'<svg xmlns="http://www.w3.org/2000/svg" width="9mm" height="9mm" viewBox="0 0 9 9"><path d="{path}"/></svg>'
    with pytest.raises(UnreadableError):
        read_svg(svg.encode(), 0.001)


def test_a_picture_of_a_report_is_no_drawing_to_cut(tmp_path):
    """Its dimensions are open lines."""
    gear = {"kind": "spur-gear", "gear": {"teeth": 8, "module": 2}, "files": {"write": ["report-md", "sheet-svg"]}}
    gk.make(gk.load(gear).with_name("gear"), tmp_path)
    path = tmp_path / "gear/gear-report-drawing.svg"
    path.write_text(path.read_text().replace("M1", "M2", 1))
    assert set(wrong(tmp_path / "gear")) == {path.name}
