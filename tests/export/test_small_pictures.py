"""What a page shows in small: forms of parts, and how plates lie on each other, read back from their SVG."""

import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest

import geomkin as gk
from geomkin.export.svg_path import picture, thumbnail

DISC = gk.plane.Circle(0j, 5.0)


def box_of(svg):
    left, top, wide, high = map(float, svg.get("viewBox").split())
    return complex(left, -top - high), complex(left + wide, -top)


@pytest.mark.parametrize(
    ("k", "wide", "high", "size"), [(1e-3, 60, 40, 100 + 10j), (1.0, 40, 60, 10 + 100j), (4e3, 360, 240, 40 + 40j)]
)
def test_a_form_in_small_fills_its_picture_but_for_two_pixels(size, wide, high, k):
    corners = k * (300 - 70j + np.array([0, size.real, size, 1j * size.imag]))
    hole = gk.plane.Circle(complex(corners.mean()), 3 * k)
    curves = (gk.plane.Polyline(corners), hole)
    svg = ET.fromstring(thumbnail([(curves, 'class="plate"'), ((hole,), 'class="mark"')], wide, high, 'id="small"'))
    low, high_end = box_of(svg)
    across = high_end - low
    pixel = max(k * size.real / (wide - 4), k * size.imag / (high - 4))
    # Numbers are told to some twentieths of a pixel.
    assert across == pytest.approx(pixel * complex(wide, high), abs=0.1 * pixel)
    assert (low + high_end) / 2 == pytest.approx(complex(corners.mean()), abs=0.1 * pixel)
    assert svg.get("id") == "small" and [one.get("class") for one in svg] == ["plate", "mark"]
    assert all(one.get("transform") == "scale(1 -1)" for one in svg)
    start = complex(*map(float, re.match(r"M(-?[\d.]+) ?(-?[\d.]+)", svg[0].get("d")).groups()))
    assert start == pytest.approx(complex(corners[0]), abs=0.06 * pixel)


def test_a_picture_that_stands_alone_fills_what_is_closed_and_says_what_it_is():
    line = gk.plane.Segment(0j, 30 + 4j)
    for curves, marks, fills in (
        ((gk.plane.Circle(0j, 9.0), DISC), (line,), ["#cfe4f3", "none"]),
        ((line,), (), ["none"]),
    ):
        svg = ET.fromstring(picture('<a "part">', curves, marks))
        assert svg.get("aria-label") == '<a "part">' and (svg.get("width"), svg.get("height")) == ("360", "240")
        assert [one.get("fill") for one in svg] == fills
        low, high = box_of(svg)
        assert (high - low).real / (high - low).imag == pytest.approx(1.5, rel=1e-3)
