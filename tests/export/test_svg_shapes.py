"""The drawing as SVG read back number by number: arcs by their radius and side, circles, names, numbers."""

import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest

import geomkin as gk
from geomkin.export.cut import cut
from geomkin.export.layout import lay_out
from geomkin.export.svg import svg
from geomkin.plane import measure
from tests.export.stills import SPACE

# Bent to either side, with straight edges between.
UNEVEN = gk.plane.Polyline(
    np.array([-30 - 18j, 34 - 18j, 38 + 19j, 10 + 12j, -14 + 35j]), np.array([0.4, -0.2, 0.0, 0.3, -0.1])
)
HOLES = (gk.plane.Circle(12 - 6j, 4.0), gk.plane.slot(-16 - 4j, -12 + 12j, 2.5))
PARTS = [gk.Part("uneven", UNEVEN, HOLES, 3.0), gk.Part("disc", gk.plane.Circle(0j, 12.0), (), 3.0, count=2)]


def read(path, height):
    """Places along a path of lines and arcs, y up."""
    steps = re.findall(r"([MLA])([^MLAZ]*)", path)
    places, here = [], None
    for kind, told in steps:
        numbers = [float(one) for one in re.findall(r"-?[\d.]+", told)]
        if kind == "M" and len(numbers) > 2:
            ends = [complex(x, height - y) for x, y in zip(numbers[::2], numbers[1::2])]
            return np.array(ends)
        end = complex(numbers[-2], height - numbers[-1])
        if kind == "A":
            across, radius, other, turned, large, sweep = end - here, *numbers[:5]
            assert radius == other and turned == large == 0 and sweep in (0, 1)
            # The middle lies to the left of the way where the arc turns left: y down, a sweep of 0.
            side = 1 if sweep == 0 else -1
            middle = (
                here + across / 2 + side * 1j * across / abs(across) * np.sqrt(max(radius**2 - abs(across) ** 2 / 4, 0))
            )
            turn = np.angle((end - middle) / (here - middle)) * side % (2 * np.pi)
            places.append(middle + (here - middle) * np.exp(1j * side * turn * np.linspace(0, 1, 200)[1:]))
        else:
            places.append(np.array([end]))
        here = end
    return np.concatenate(places)


@pytest.mark.parametrize(("tolerance", "arcs"), [(0.1, True), (1e-3, False)])
def test_every_shape_of_the_drawing_is_the_parts(tolerance, arcs):
    sheet = lay_out([cut(part, tolerance, arcs=arcs) for part in PARTS])
    root = ET.fromstring(svg(sheet, "a\x07<b>"))
    assert root.find(f"{SPACE}title").text == "a <b>"
    groups = root.findall(f"{SPACE}g")
    assert sorted(one.get("id").rpartition("-")[0] for one in groups) == ["disc", "disc", "uneven"]
    assert [one.get("id").rpartition("-")[2] for one in groups] == ["1", "2", "3"]
    for group, placed in zip(groups, sheet.placed):
        curves = {"CUT": [placed.cut.part.outline], "HOLE": list(placed.cut.part.holes)}
        for shape in group:
            colour = {"CUT": "#d55e00", "HOLE": "#0072b2"}[shape.get("class")]
            assert shape.get("stroke") == colour
            if shape.tag == f"{SPACE}circle":
                x, y, radius = (float(shape.get(key)) for key in ("cx", "cy", "r"))
                around = np.exp(2j * np.pi * np.arange(100) / 100)
                places, slack = complex(x, sheet.height - y) + radius * around, 0.005 * np.pi * radius**2
            else:
                places, slack = read(shape.get("d"), sheet.height), 0.0
                assert ("A" in shape.get("d")) == arcs and shape.get("d").endswith("Z")
            own = (places - placed.shift) / placed.turn
            near = [measure.nearest(curve, own)[1].max() for curve in curves[shape.get("class")]]
            assert min(near) < 1.01 * tolerance + 1e-3
            curve = curves[shape.get("class")].pop(int(np.argmin(near)))
            area = abs(np.imag(np.conj(own) * np.roll(own, -1)).sum() / 2)
            assert area == pytest.approx(gk.area(curve), abs=slack + 0.01 + tolerance * gk.length(curve))
        assert not any(curves.values())
    assert root.get("stroke-width") == "0.25"
