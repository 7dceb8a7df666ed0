"""`gk.write`: every format from parts, a table or a recipe, read back; whole or not at all; refusals."""

import os
import xml.etree.ElementTree as ElementTree

import ezdxf
import numpy as np
import pytest

import geomkin as gk

PLATE = gk.Part("plate", gk.plane.Circle(0, 20.0), (gk.plane.Circle(5 + 0j, 3.0),), 2.0)
BAR = gk.Part("bar", gk.plane.slot(0j, 40 + 0j, 6.0), (gk.plane.Circle(0, 2.0),), 3.0, count=2)
TABLE = gk.Table((gk.Column("angle", "deg", "of the crank", np.arange(4.0)), gk.Column("lift", "mm", "", np.ones(4))))
GEAR = (
    'kind = "spur-gear"\ngear = { teeth = 17, module = 2 }\nfiles = { tolerance = 0.02, curves = "arcs", kerf = 0.2 }'
)


def entities(path, kind):
    """Of one type, in a DXF."""
    return list(ezdxf.readfile(path).modelspace().query(kind))


def test_a_drawing_holds_every_copy_of_every_part(tmp_path):
    written = gk.write([PLATE, BAR], tmp_path / "both.dxf")
    assert written == {tmp_path / "both.dxf": (tmp_path / "both.dxf").stat().st_size}
    circles = [(e.dxf.layer, e.dxf.radius) for e in entities(tmp_path / "both.dxf", "CIRCLE")]
    assert sorted(circles) == [("CUT", 20.0), ("HOLE", 2.0), ("HOLE", 2.0), ("HOLE", 3.0)]
    assert [e.dxf.layer for e in entities(tmp_path / "both.dxf", "LWPOLYLINE")] == ["CUT"] * 2
    gk.write((PLATE, BAR), str(tmp_path / "both.svg"))
    drawn = ElementTree.parse(tmp_path / "both.svg").iter("{http://www.w3.org/2000/svg}circle")
    assert sorted(float(c.get("r")) for c in drawn) == [2, 2, 3, 20]


def test_half_a_kerf_goes_to_either_side_of_a_drawing_and_none_to_a_solid(tmp_path):
    gk.write(PLATE, tmp_path / "kerf.dxf", kerf=0.5)
    assert sorted(e.dxf.radius for e in entities(tmp_path / "kerf.dxf", "CIRCLE")) == [2.75, 20.25]
    gk.write(PLATE, tmp_path / "a.stl"), gk.write(PLATE, tmp_path / "b.stl", kerf=0.5)
    assert (tmp_path / "a.stl").read_bytes() == (tmp_path / "b.stl").read_bytes()


@pytest.mark.campaign
def test_arcs_are_fewer_points_and_chords_keep_the_tolerance(tmp_path):
    parts = gk.load(GEAR).parts
    counts = {}
    for curves in ("chords", "arcs"):
        gk.write(parts, tmp_path / "gear.dxf", tolerance=0.001, curves=curves)
        (outline,) = entities(tmp_path / "gear.dxf", "LWPOLYLINE")
        assert outline.has_arc is (curves == "arcs")
        counts[curves] = len(outline)
    assert counts["arcs"] < counts["chords"] / 2
    for tolerance in (0.1, 0.001):
        gk.write(parts, tmp_path / "gear.dxf", tolerance)
        (outline,) = entities(tmp_path / "gear.dxf", "LWPOLYLINE")
        x, y = np.array(outline.get_points("xy")).T
        z = x + 1j * y
        (part,) = parts
        # Laid out, the part is moved by whole millimetres.
        shift = np.round((z.real.min() + z.real.max() + 1j * (z.imag.min() + z.imag.max())) / 2)
        middles = (z + np.roll(z, 1)) / 2 - shift
        off = gk.nearest(part.outline, middles)[1]
        assert tolerance / 4 < off.max() < 1.01 * tolerance


def test_files_are_written_whole_or_left_unchanged(tmp_path, monkeypatch):
    (tmp_path / "plate.stl").write_text("old")
    real, calls = os.fsync, []

    def full(handle):
        calls.append(handle)
        if len(calls) == 2:
            raise OSError(28, "No space left on device")
        real(handle)

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(gk.FileError):
        gk.write([PLATE, BAR], tmp_path / "any.stl")
    assert [p.name for p in tmp_path.iterdir()] == ["plate.stl"] and (tmp_path / "plate.stl").read_text() == "old"


ANOTHER = gk.Part("plate", gk.plane.Circle(0, 5.0), (), 2.0)
CROSSED = gk.Part("bow", gk.plane.Polyline(np.array([0, 10 + 10j, 10, 10j])), (), 2.0)


def test_invalid_things_to_write_are_refused_by_name(tmp_path, monkeypatch):
    for source, name, more, words in [
        (
            PLATE,
            "plate.pdf",
            {},
            "path",
        ),
        (PLATE, "plate", {}, "path: found .*give a name that ends in dxf"),
        (PLATE, "", {}, "path: found"),
        (PLATE, ".dxf", {}, "path: found"),
        (PLATE, "lift.csv", {}, "path: found .*lift.csv; give a name that ends in dxf"),
        (TABLE, "lift.dxf", {}, "path: found .*lift.dxf; give a name that ends in csv"),
        ([], "none.dxf", {}, "source: there are no parts"),
        ([PLATE, ANOTHER], "two.stl", {}, "name: two parts are named 'plate'"),
        ([CROSSED], "bow.dxf", {}, "bow: the outline crosses itself"),
        (PLATE, "a.dxf", {"tolerance": 0}, "tolerance: found 0; give a number at least 1e-06 and at most 10, in mm"),
        (PLATE, "a.dxf", {"tolerance": 1e-6}, "tolerance: found 1e-06 mm for the plate.*at least"),
        (PLATE, "a.dxf", {"kerf": -1}, "kerf: found -1"),
        (PLATE, "a.dxf", {"kerf": 7}, "kerf: found 7 mm, wider than a hole of the plate"),
        (PLATE, "a.dxf", {"curves": "splines"}, "curves: found 'splines'; give chords or arcs"),
    ]:
        monkeypatch.chdir(tmp_path)
        with pytest.raises(gk.DesignError, match=words):
            gk.write(source, name, **more)
        assert list(tmp_path.iterdir()) == []
