"""Parts nested on sheets, by polygons read back from the DXF: apart, within the sheet, and less wasted than in rows."""

import io
from itertools import combinations

import ezdxf
import numpy as np
import pytest
import shapely
from ezdxf import path as dxf_path

import geomkin as gk
from geomkin.export.cut import cut
from geomkin.export.dxf import dxf
from geomkin.export.layout import GAP, lay_out, lay_out_on, least_turn
from geomkin.model.part import Part, Twist
from geomkin.plane.vec import xy
from tests.campaign import by_default

# Chords of what is read back, mm.
FINE = 1e-3


def plates(sheet):
    """The parts of a sheet in the order in which they are cut, as polygons with holes, from its DXF."""
    found, holes = [], []
    for entity in ezdxf.read(io.StringIO(dxf(sheet).decode())).modelspace().query('*[layer=="CUT" | layer=="HOLE"]'):
        round_one = entity.dxftype() == "CIRCLE"
        points = (entity if round_one else dxf_path.make_path(entity)).flattening(FINE)
        ring = [(p.x, p.y) for p in points]
        if entity.dxf.layer == "HOLE":
            holes.append(ring)
        else:
            found.append(shapely.Polygon(ring, holes))
            holes = []
    assert not holes
    return found


def assert_sound(sheet):
    """All apart by the gap, as far from the edges, and what lies in a hole cut before the part round it."""
    found = plates(sheet)
    low, high = np.array([p.bounds for p in found]).T.reshape(2, 2, -1)
    assert low.min() >= GAP - FINE
    assert (high.max(axis=1) <= np.array([sheet.width, sheet.height]) - GAP + FINE).all()
    for k, one in enumerate(found):
        assert one.is_valid and all(one.distance(other) >= GAP - 2 * FINE for other in found[:k])
        assert not any(shapely.Polygon(other.exterior).contains(one) for other in found[:k])
    used = sum(p.area for p in found) / (sheet.width * sheet.height)
    assert sheet.filled == pytest.approx(used, rel=1e-3)
    return found


def flats(parts, tolerance=0.01, **how):
    return [cut(part, tolerance, **how) for part in parts]


def blob(rng, name, size):
    """A polygon of any form, with a hole where it is large."""
    turn = np.sort(rng.uniform(0, 2 * np.pi, rng.integers(3, 12)))
    turn = turn + np.linspace(0, 0.2, len(turn))
    outline = gk.plane.Polyline(size * rng.uniform(0.3, 1, len(turn)) * np.exp(1j * turn) + rng.normal() * 100)
    centre = complex(rng.normal(), rng.normal()) * 50
    ring = gk.Part(name, gk.plane.Circle(centre, size), (gk.plane.Circle(centre, 0.8 * size),), 3.0)
    return ring if rng.random() < 0.2 else gk.Part(name, outline, (), 3.0, count=int(rng.integers(1, 4)))


def simple(part):
    z = gk.flatten(part.outline, 0.01)
    return shapely.LinearRing(gk.plane.xy(z)).is_simple


@pytest.mark.parametrize("seed", by_default(range(4), slice(2)))
def test_parts_of_any_form_lie_apart_and_on_the_sheet(seed):
    rng = np.random.default_rng(seed)
    size = 10.0 ** rng.uniform(0.5, 2.3)
    parts = [p for p in (blob(rng, f"p{k}", size * rng.uniform(0.2, 1)) for k in range(9)) if simple(p)]
    cuts = flats(parts, kerf=0.3 * (seed % 2))
    found = assert_sound(lay_out(cuts))
    assert len(found) == sum(p.count for p in parts)
    side = 2.3 * size + 2 * GAP
    sheets = lay_out_on(cuts, side, 1.5 * side)
    assert sum(len(assert_sound(sheet)) for sheet in sheets) == len(found)
    assert all(sheet.width == side and sheet.height == 1.5 * side for sheet in sheets)


def test_small_parts_lie_in_large_holes_and_are_cut_before():
    ring = gk.Part("ring", gk.plane.Circle(0, 60), (gk.plane.Circle(0, 50),), 3.0)
    disc = gk.Part("disc", gk.plane.Circle(0, 20), (), 3.0)
    sheet = lay_out(flats([ring, disc]))
    assert (sheet.width, sheet.height) == (130, 130)
    inner, outer = assert_sound(sheet)
    assert shapely.Polygon(outer.exterior).contains(inner)


def test_parts_that_lean_lie_apart_by_the_room_they_take_and_as_they_are_drawn():
    """Beside them round ones, which would come nearer to what reaches beyond an outline than to the outline."""
    plate = gk.plane.Polyline(60 * np.exp(0.5j) * np.array([-1 - 0.5j, 1 - 0.5j, 1 + 0.5j, -1 + 0.5j]))
    leaning = [
        Part("slides", plate, (gk.plane.Circle(0j, 20.0),), 5.0, count=2, twist=Twist(0.0, 30.0)),
        Part("turns", plate, (gk.plane.Circle(0j, 20.0),), 5.0, count=2, twist=Twist(0.6)),
    ]
    cuts = flats([*leaning, Part("disc", gk.plane.Circle(0j, 9.0), (), 5.0, count=25)])
    assert [least_turn(cut) for cut in cuts] == [1, 1, 1]
    sheet = lay_out(cuts)
    found = []
    for one in sheet.placed:
        low, high = one.cut.box if one.cut.is_twisted else one.cut.loops[0].box
        room = np.array([low, complex(high.real, low.imag), high, complex(low.real, high.imag)]) * one.turn + one.shift
        assert not one.cut.is_twisted or one.turn in (1, 1j, -1, -1j)
        middle = complex(one.shift)
        found.append(
            shapely.Polygon(xy(room)) if one.cut.is_twisted else shapely.Point(middle.real, middle.imag).buffer(9)
        )
    assert len(found) == 29
    assert all(a.distance(b) > GAP - 0.05 for a, b in combinations(found, 2))
    low, high = np.array([one.bounds for one in found]).T.reshape(2, 2, -1)
    assert low.min() > GAP - 0.05 and (high.max(axis=1) < np.array([sheet.width, sheet.height]) - GAP + 0.05).all()
    assert sum(one.area for one in found) > 0.6 * sheet.width * sheet.height


def test_a_bent_part_is_turned_to_its_least_box_and_engraved_as_it_lies():
    slanted = gk.Part("bar", gk.plane.rounded_hull([0, 100 * np.exp(0.6j)], 6), (gk.plane.Circle(0, 2),), 3.0, count=3)
    sheet = lay_out(flats([slanted], number=1))
    (turn,) = {p.turn for p in sheet.placed}
    # Whole degrees.
    assert abs(np.imag(turn * np.exp(0.6j))) < np.sin(np.radians(0.51)) or abs(np.real(turn * np.exp(0.6j))) < 0.01
    found = assert_sound(sheet)
    assert sheet.filled > 0.5
    for placed, plate in zip(sheet.placed, found):
        lines = [shapely.LineString(gk.plane.xy(loop.points)) for loop in placed.loops if loop.layer == "LABEL"]
        assert lines and all(plate.contains(line) for line in lines)


def test_a_part_that_just_fits_is_cut_and_a_larger_one_refused_with_the_least_sheet():
    plate = flats([gk.Part("plate", gk.plane.Polyline(np.array([0.25, 300.25, 300.25 + 90j, 0.25 + 90j])), (), 3.0)])
    for width, height in ((311, 100), (100, 311)):
        (sheet,) = lay_out_on(plate, width, height)
        assert_sound(sheet)
        for wide, high in ((width - 1, height), (width, height - 1)):
            words = rf"found {wide:g} x {high:g} mm, and the plate is 300 x 90 mm; give at least \[311, 100\]"
            with pytest.raises(gk.DesignError, match=words):
                lay_out_on(plate, wide, high)


@pytest.mark.campaign
def test_a_walker_of_many_small_spacers_needs_two_sheets():
    parts = gk.load("recipes/motor-walker.toml").parts
    sheets = lay_out_on(flats(parts), 300, 200)
    assert sum(len(assert_sound(sheet)) for sheet in sheets) == sum(part.count for part in parts)
    assert len(sheets) == 2


def test_each_thickness_has_its_own_sheets_and_each_sheet_its_own_file(tmp_path):
    thin, thick = (gk.Part(f"t{t:g}", gk.plane.Circle(0, 40), (), t, count=4) for t in (3.0, 5.0))
    sheets = lay_out_on(flats([thin, thick]), 200, 100)
    assert [{p.cut.part.thickness for p in sheet.placed} for sheet in sheets] == [{3.0}, {3.0}, {5.0}, {5.0}]
    text = 'kind = "four-bar"\nlinkage = { ground = 100, crank = 30, coupler = 90, rocker = 70 }\n'
    made = gk.make(
        gk.load(text + "[files]\nsheet = [150, 60]\nwrite = ['dxf', 'svg', 'page']").with_name("bars"), tmp_path
    )
    names = {path.name for path in made.files}
    assert {"bars.dxf", "bars-2.dxf", "bars.svg", "bars-2.svg"} <= names
    documents = [ezdxf.readfile(path) for path in sorted(made.files) if path.suffix == ".dxf"]
    outlines = [len(document.modelspace().query('*[layer=="CUT"]')) for document in documents]
    assert min(outlines) > 0 and sum(outlines) == sum(p.count for p in gk.load(text).parts)
    gk.make(gk.load(text + "[files]\nwrite = ['dxf', 'svg']").with_name("bars"), tmp_path)
    assert not (tmp_path / "bars" / "bars-2.dxf").exists()
