"""A part is cut alike whichever way its curves run, and as a library that moves polygons has it."""

from itertools import product

import numpy as np
import pytest
import shapely

import geomkin as gk
from geomkin.export.cut import cut, polygon_area
from geomkin.plane import measure
from geomkin.plane.curve import Reversed
from geomkin.plane.primitives import Polyline
from geomkin.plane.vec import xy
from tests.campaign import by_default

# A fork and its hole, in whose small edges a beam of 3 mm finds no room: those have to be trimmed.
FORK = np.array([0, 40, 40 + 40j, 22 + 40j, 22 + 12.8j, 21.2 + 12j, 18 + 12j, 18 + 40j, 40j])
BENT = Polyline(FORK, np.array([0, 0, 0.4, 0, 0, 0, 0, 0.4, 0]))
_SIX = 6 * np.exp(1j * np.pi / 3 * np.arange(1, 6))
HOLE = 20 + 6j + np.array([*_SIX, 6 - 0.4 * np.exp(1j * np.pi / 3), 6 + 0.4 * np.exp(2j * np.pi / 3)])
OUTLINES = {"sharp": Polyline(FORK), "bent": BENT}


def moved(curve, grow):
    """What a library makes of the curve, moved outwards, by 100 places an edge."""
    t = np.concatenate([a + (b - a) * np.arange(100) / 100 for a, b in zip(curve.breaks, curve.breaks[1:])])
    return shapely.Polygon(xy(curve.point(t))).buffer(grow, quad_segs=64)


@pytest.mark.parametrize("kerf", by_default([0.0, 0.1, 3.0], [0.1]))
@pytest.mark.parametrize(("name", "arcs"), [("sharp", False), ("bent", True)])
def test_cut_does_not_depend_on_the_direction_of_curves(name, kerf, arcs):
    outline, hole, tolerance = OUTLINES[name], Polyline(HOLE), 1e-2
    expected = moved(outline, kerf / 2), moved(hole, -kerf / 2)
    boxes = []
    for turned, turned_hole in product((False, True), repeat=2):
        part = gk.Part(
            "fork", Reversed(outline) if turned else outline, (Reversed(hole) if turned_hole else hole,), 3.0
        )
        made = cut(part, tolerance, kerf, arcs)
        for loop, true in zip(made.loops, expected):
            # Each way: neither a corner nor the middle of a chord is farther off than asked.
            ring, fine = shapely.LinearRing(xy(loop.points)), shapely.get_coordinates(true)
            assert shapely.distance(ring, shapely.points(fine)).max() < 1.02 * tolerance
            assert shapely.distance(true.exterior, shapely.points(xy(loop.points))).max() < 1.02 * tolerance
            assert polygon_area(loop.points) > 0 and (kerf > 1 or not arcs or len(loop.shape.vertices) < 20)
            about = tolerance * measure.length(loop.shape)
            assert measure.signed_area(loop.shape) == pytest.approx(true.area, abs=about)
        boxes.append([loop.box for loop in made.loops])
    assert np.abs(np.array(boxes) - boxes[0]).max() < tolerance
