"""Engraved marks, read back from the files."""

import io
import re
import xml.etree.ElementTree as ET

import ezdxf
import numpy as np
import pytest
import shapely

import geomkin as gk
from geomkin.export.cut import cut
from geomkin.export.dxf import dxf
from geomkin.export.layout import lay_out
from geomkin.export.svg import svg

TOLERANCE = 0.005
OUTLINE = gk.plane.rounded_hull([0, 90, 40 + 25j], 12)
HOLES = (gk.plane.Circle(0, 2.1), gk.plane.Circle(90, 2.1))
TURN = np.linspace(0, 2 * np.pi, 200)[:-1]
MARKS = {
    "circle": gk.plane.Circle(90, 6),
    "line across a hole": gk.plane.Segment(-8, 60 - 6j),
    "open arc": gk.plane.Arc(40 + 25j, 46 + 25j, 4.0),
    "closed": gk.plane.slot(60 + 5j, 70 + 2j, 3),
    "figure of eight": gk.plane.Polyline(30 + 18 * np.sin(TURN) + 8j * np.sin(2 * TURN)),
}


def part(*marks):
    return gk.Part("plate", OUTLINE, HOLES, 3.0, marks=marks)


def sheet(*marks, **how):
    return lay_out([cut(part(*marks), TOLERANCE, **how)])


def line_of(curve):
    """The exact curve, so finely that its chords do not count."""
    z = curve.point(np.linspace(curve.breaks[0], curve.breaks[-1], 4001))
    return shapely.LineString(gk.plane.xy(z))


def engraved(content):
    space = ezdxf.read(io.StringIO(content.decode())).modelspace()
    return list(space.query('*[layer=="ENGRAVE"]'))


@pytest.mark.parametrize("how", [{"kerf": 0.4}, {"arcs": True}], ids=str)
@pytest.mark.parametrize("name", MARKS)
def test_a_mark_is_in_the_dxf_where_it_was_asked_for(name, how):
    curve = MARKS[name]
    made = sheet(curve, **how)
    (entity,) = engraved(dxf(made))
    path = ezdxf.path.make_path(entity)
    shift = made.placed[0].shift
    drawn = shapely.LineString([(v.x - shift.real, v.y - shift.imag) for v in path.flattening(1e-4)])
    assert drawn.hausdorff_distance(line_of(curve)) < 1.2 * TOLERANCE
    assert entity.dxftype() == ("CIRCLE" if name == "circle" else "LWPOLYLINE")
    if name != "circle":
        assert entity.closed == curve.closed


def test_marks_in_the_svg_are_open_where_their_curves_are():
    made = sheet(*MARKS.values())
    root = ET.fromstring(svg(made, "marks"))
    drawn = [e for e in root.iter() if e.get("class") == "ENGRAVE"]
    assert len(drawn) == len(MARKS)
    for element, curve in zip(drawn, MARKS.values()):
        if isinstance(curve, gk.plane.Circle):
            assert float(element.get("r")) == curve.radius
            continue
        assert element.get("d").endswith("Z") == curve.closed
        places = [complex(*map(float, p)) for p in re.findall(r"([-\d.]+),([-\d.]+)", element.get("d"))]
        z = (np.array(places) - 1j * made.height).conj() - made.placed[0].shift
        assert max(line_of(curve).distance(shapely.Point(p.real, p.imag)) for p in z) < TOLERANCE / 5
        assert curve.closed or abs(z[-1] - curve.point(curve.breaks[-1])) < 1e-6
