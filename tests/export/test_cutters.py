"""Drawings for milling cutters: relief judged by a rolling disk, tabs, R12, layers by key, and the certificate."""

import io
import re
from dataclasses import replace

import numpy as np
import pytest
import shapely
from ezdxf.filemanagement import read

import geomkin as gk
from geomkin.export.cut import LayerStyle, LayerStyles, cut
from geomkin.export.dxf import dxf
from geomkin.export.job import Job, StaticSource
from geomkin.export.svg import svg
from geomkin.making.bores import AbstractBored
from geomkin.model.machinability import relieved
from geomkin.plane.flatten import flatten
from geomkin.plane.measure import length
from geomkin.recipe.settings import Files
from tests.campaign import by_default

BORES = {
    "keyed": ({"bore": 10}, 2.8),
    "D": ({"bore": 5}, 3.175),
    "double-D": ({"bore": 10, "flat": 7}, 3.8),
    "square": ({"bore": 8}, 2.5),
    "hexagonal": ({"bore": 12}, 2.9),
}
MILLED = {"write": ["dxf", "svg"], "dxf_version": "R12", "cutter": 2.0, "tab_width": 2.0}


def bored(form, **sizes):
    stock = AbstractBored(bore_form=form, **sizes)
    return gk.Part("hub", gk.plane.Circle(0j, 20.0), stock.hole(1j, 40.0, "stock"), 3.0, fits=stock.fits)


def polygon(curve):
    points = flatten(curve, 1e-5)
    return shapely.Polygon(np.column_stack([points.real, points.imag]))


def milled(hole, cutter):
    """What a disk covers that rolls inside a hole."""
    return hole.buffer(-cutter / 2 + 1e-4, quad_segs=400).buffer(cutter / 2, quad_segs=400)


@pytest.mark.parametrize("share", [1.0, 0.3])
@pytest.mark.parametrize("form", BORES)
def test_a_cutter_reaches_the_whole_designed_bore_through_its_relief(form, share):
    sizes, cutter = BORES[form]
    cutter *= share
    part = bored(form, **sizes)
    designed, drawn = polygon(part.holes[0]), polygon(relieved(part, cutter).holes[0])
    assert designed.difference(milled(designed, cutter)).area > 1e-3 * cutter**2
    assert designed.difference(milled(drawn, cutter)).area < 2e-4
    # The drawn hole is no more than the cutter makes of the designed one, and its relief is near corners only.
    assert drawn.difference(milled(drawn, cutter).buffer(2e-4)).area < 1e-5
    corners = shapely.MultiPoint([(z.real, z.imag) for z in part.holes[0].vertices])
    assert drawn.difference(designed).difference(corners.buffer(1.5 * cutter)).area < 1e-4
    # At least half of the length of its sides remains.
    assert designed.exterior.intersection(drawn.exterior.buffer(1e-4)).length > 0.5 * designed.exterior.length


def test_only_seats_are_relieved():
    plain = bored("round", bore=10)
    angular = gk.Part(
        "plate", gk.plane.Polyline(np.array([0, 9, 9 + 9j, 9j])), (gk.plane.Polyline(np.array([2, 4, 4j + 3])),), 3.0
    )
    for part in (plain, angular):
        assert [a is b for a, b in zip(relieved(part, 2.0).holes, part.holes)] == [True]
    assert relieved(angular, 2.0).outline is angular.outline


@pytest.mark.parametrize("form", BORES)
def test_too_wide_a_cutter_is_refused_with_the_widest_that_works(form):
    part = bored(form, **BORES[form][0])
    with pytest.raises(gk.DesignError) as caught:
        relieved(part, 8.0)
    assert caught.value.field == "cutter" and 0 < caught.value.value < 8
    relieved(part, caught.value.value)
    with pytest.raises(gk.DesignError):
        relieved(part, 1.01 * caught.value.value)


def entities(content):
    return list(read(io.StringIO(content.decode())).modelspace())


def sheet_of(part, **more):
    return Job("a", StaticSource((part,)), 0.005, **more).sheets[0]


@pytest.mark.parametrize("unit", [gk.core.units.MM, gk.core.units.IN], ids=["mm", "in"])
def test_r12_has_the_polylines_of_r2000_with_their_bulges(unit, capfd):
    sheet = sheet_of(bored("keyed", bore=10), arcs=True)
    old, new = (entities(dxf(sheet, unit=unit, version=version)) for version in ("R12", "R2000"))
    assert [e.dxftype() for e in old] == ["POLYLINE", "CIRCLE"] and [e.dxftype() for e in new] == [
        "LWPOLYLINE",
        "CIRCLE",
    ]
    rows = [(*vertex.dxf.location.xyz[:2], vertex.dxf.bulge) for vertex in old[0].vertices]
    assert np.allclose(rows, new[0].get_points("xyb"), atol=1e-12) and old[0].is_closed
    assert max(abs(bulge) for *_, bulge in rows) > 0.1
    content = dxf(sheet, "stamped", version="R12")
    assert re.search(rb"\$ACADVER\s+1\s+AC1009", content) and b"LWPOLYLINE" not in content and b"stamped" in content
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("arcs", [True, False])
@pytest.mark.parametrize(
    "outline",
    [gk.plane.Circle(0j, 30), gk.plane.slot(0, 90, 12), gk.SpurGear(17, 3).outline],
    ids=["disc", "bar", "gear"],
)
def test_tabs_are_left_in_the_outline(outline, arcs):
    part = gk.Part("part", outline, (), 3.0)
    whole = cut(part, 0.005, arcs=arcs).loops[0].shape
    lines = entities(dxf(sheet_of(part, arcs=arcs, tab_width=1.5, cutter=2.0)))
    lengths = {"CUT": [], "TAB": []}
    for line in lines:
        assert line.dxftype() == "LWPOLYLINE" and not line.closed
        rows = np.array(line.get_points("xyb"))
        curve = gk.plane.Polyline(rows[:, 0] + 1j * rows[:, 1], rows[:-1, 2], is_closed=False)
        lengths[line.dxf.layer].append(length(curve))
    total = length(whole)
    assert len(lengths["TAB"]) == len(lengths["CUT"]) == max(2, int(np.ceil(total / 150)))
    # The width of a tab, and half a cutter at both its ends.
    assert lengths["TAB"] == pytest.approx([3.5] * len(lengths["TAB"]), abs=1e-5)
    assert sum(lengths["CUT"] + lengths["TAB"]) == pytest.approx(total, rel=1e-6)
    ends = [line.get_points("xy")[-1] for line in lines]
    starts = [line.get_points("xy")[0] for line in lines]
    assert starts == ends[-1:] + ends[:-1]


def test_tabs_wider_than_the_outline_are_refused_with_a_width_that_fits():
    part = gk.Part("part", gk.plane.Circle(0j, 5), (), 3.0)
    with pytest.raises(gk.DesignError) as caught:
        dxf(sheet_of(part, tab_width=9.0))
    dxf(sheet_of(part, tab_width=caught.value.value))
    with pytest.raises(gk.DesignError) as caught:
        Files(tab_width=1e-12)
    assert caught.value.field == "tab_width" and Files(tab_width=caught.value.value)


@pytest.mark.parametrize("cut_width", [{}, {"kerf": 0.1}, {"cutter": 2.0}, {"kerf": 0.1, "cutter": 2.0}])
def test_the_widest_tab_is_that_of_the_part_with_least_room(cut_width):
    """Two tabs up to 300 mm of outline, together at most half of it; the number is stated at once and passes."""
    parts = tuple(gk.Part(f"{r:g}", gk.plane.Circle(0j, r), (), 3.0) for r in (20.0, 7.0, 90.0))
    job = Job("a", StaticSource(parts), 0.005, tab_width=20.0, **cut_width)
    with pytest.raises(gk.DesignError) as caught:
        job.sheets
    kerf, taken = cut_width.get("kerf", 0), max([0, *cut_width.values()])
    assert caught.value.value == pytest.approx(np.pi * (7 + kerf / 2) / 2 - taken, abs=0.011)
    assert dxf(replace(job, tab_width=caught.value.value).sheets[0])
    with pytest.raises(gk.DesignError):
        replace(job, tab_width=caught.value.value + 0.011).sheets


def test_an_outline_without_room_for_tabs_is_cut_without_them():
    job = Job("a", StaticSource((gk.Part("pin", gk.plane.Circle(0j, 1), (), 3.0),)), 0.005, cutter=2.0, tab_width=0.5)
    with pytest.raises(gk.DesignError) as caught:
        job.sheets
    assert caught.value.value == 0 and replace(job, tab_width=0.0).sheets


def test_layers_have_the_names_and_colours_of_the_recipe():
    styles = LayerStyles(cut=LayerStyle("Outside 3 mm", "#00ff01"), hole=LayerStyle(colour="#123456"))
    sheet = sheet_of(bored("keyed", bore=10))
    document = read(io.StringIO(dxf(sheet, styles=styles).decode()))
    assert [e.dxf.layer for e in document.modelspace()] == ["HOLE", "Outside 3 mm"]
    # Pure green is number 3 of the palette.
    assert document.layers.get("Outside 3 mm").color == 3
    assert b'class="HOLE" stroke="#123456"' in svg(sheet, "a", laser=True, styles=styles)
    for wrong in ({"name": "a|b"}, {"name": "x" * 32}, {"colour": "red"}):
        with pytest.raises(gk.DesignError):
            LayerStyle(**wrong)
    with pytest.raises(gk.DesignError):
        LayerStyles(cut=LayerStyle("hole"))


def cam(units, length, files):
    follower = {"kind": "translating-roller", "roller_radius": 10 * length}
    program = [
        {"kind": "rise", "law": "cycloidal", "rise": 10 * length, "end_deg": 180},
        {"kind": "return", "law": "cycloidal", "end_deg": 360},
    ]
    return {
        "kind": "disk-cam",
        "units": units,
        "cam": {"base_radius": 40 * length, "follower": follower, "program": program},
        "stock": {"thickness": 5 * length, "bore": 10 * length, "bore_form": "keyed"},
        "files": files,
    }


@pytest.mark.parametrize("units", ["mm", "in"])
@pytest.mark.parametrize("curves", by_default(["arcs", "chords"], ["arcs"]))
def test_a_certificate_measures_files_for_a_cutter(tmp_path, units, curves):
    files = {**MILLED, "curves": curves, "layers": {"cut": {"name": "OUT"}, "tab": {"name": "STAY"}}}
    sizes = (1.0, files) if units == "mm" else (0.04, {**files, "cutter": 0.0625, "tab_width": 0.08})
    gk.make(gk.load(cam(units, *sizes)), tmp_path)
    (certificate,) = gk.verify(tmp_path)
    assert certificate.passed, [file.problems for file in certificate.files]
    path = next(tmp_path.glob("*/*.dxf"))
    # Without its tabs an outline is open.
    lines = re.split(r"(?=^  0\n(?:POLYLINE|CIRCLE|ENDSEC)\n)", path.read_text(), flags=re.MULTILINE)
    path.write_text("".join(line for line in lines if not (line.startswith("  0\nPOLYLINE") and "\nSTAY\n" in line)))
    assert not gk.verify(tmp_path)[0].passed


@pytest.mark.parametrize("version", ["R12", "R2000"])
def test_the_layer_that_every_file_has_may_be_used(tmp_path, version):
    text = f'kind = "spur-gear"\ngear = {{teeth = 24, module = 2}}\n[files]\ndxf_version = "{version}"\nlayers = {{cut = {{name = "0"}}}}'
    made = gk.make(gk.load(text).with_name("gear"), tmp_path, ["dxf"])
    document = read(io.StringIO((tmp_path / "gear/gear.dxf").read_text()))
    assert made and any(entity.dxf.layer == "0" for entity in document.modelspace())
    assert gk.verify(tmp_path / "gear")[0].passed
