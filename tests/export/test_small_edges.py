"""Edges too short for a file, and corners too flat: they go, and what is left keeps its form."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.export.cut import _rounded_arcs, cut, decimals
from geomkin.export.mesh import solid
from geomkin.export.stl import TRIANGLE, stl


@pytest.mark.parametrize("shift", range(5))
def test_an_arc_shorter_than_a_file_can_tell_goes_and_its_neighbours_keep_their_bulges(shift):
    """Wherever the outline begins."""
    corners = np.array([0, 40, 40 + 5e-5j, 40 + 30j, 5 + 42j])
    bulges = np.array([0.3, 0.9, 0.5, 0.0, -0.2])
    exact = gk.plane.Polyline(np.roll(corners, shift), np.roll(bulges, shift))
    made = _rounded_arcs(exact, 0.01)
    assert len(made.vertices) == 4
    assert gk.area(made) == pytest.approx(gk.area(exact), abs=0.01)
    assert sorted(made.bulges) == pytest.approx([-0.2, 0.0, 0.3, 0.5])
    turned = _rounded_arcs(gk.plane.Polyline(exact.vertices[::-1], -np.roll(exact.bulges[::-1], -1)), 0.01)
    assert gk.plane.signed_area(turned) == pytest.approx(gk.area(exact), abs=0.01)
    assert sorted(turned.bulges) == pytest.approx([-0.2, 0.0, 0.3, 0.5])


@pytest.mark.parametrize("high", [2e-6, 2e-4])
def test_an_arc_that_is_flat_to_the_last_decimal_is_straight(high):
    """As high over its chord as a file tells, or less; its chord is 40 mm long, and the others' bulges are as large."""
    bulge = high / 20
    corners = np.array([0, 40, 40 + 30j, 5 + 42j])
    made = _rounded_arcs(gk.plane.Polyline(corners, np.array([bulge, 0.25, 0.0, -bulge])), 1.0)
    assert decimals(1.0) == 4
    kept = bulge if high > 5e-5 else 0.0
    assert made.bulges == pytest.approx([kept, 0.25, 0.0, -kept], abs=1e-12)


@pytest.mark.parametrize("shift", range(5))
def test_a_gentle_arc_beside_a_short_edge_stays_one(shift):
    """How high it is goes with its own chord: here 0.05 mm over 100 mm, next to a thousandth of a mm."""
    corners = np.roll([0, 100, 100 + 1e-3j, 100 + 40j, 40j], shift)
    exact = gk.plane.Polyline(corners, np.roll([1e-3, 0.0, 1e-3, 0.0, -1e-3], shift))
    for curve in (exact, gk.plane.Polyline(corners[::-1], -np.roll(exact.bulges[::-1], -1))):
        made = _rounded_arcs(curve, 0.05)
        assert sorted(made.bulges) == pytest.approx([-1e-3, 0, 0, 1e-3, 1e-3], abs=1e-9)
        assert gk.plane.signed_area(made) == pytest.approx(gk.area(exact), abs=1e-3)


@pytest.mark.parametrize("size", [3.0, 300.0])
def test_corners_that_the_format_cannot_tell_from_a_straight_line_leave_no_flat_triangles(size):
    flat = size * np.array([0, 0.5 + 2e-7j, 1, 1 + 2e-7j, 1 + 0.5j, 1 + 1j, 0.4 + 1.1j, 1j, 0.5j])
    plate = gk.Part("plate", gk.plane.Polyline(flat), (), 3.0)
    made = cut(plate, 1e-5 * size)
    assert len(made.loops[0].points) == 9
    points, _ = solid(made)
    # The corners of four, and the one above them.
    assert len(points) == 10
    told = np.frombuffer(stl(made)[84:], dtype=TRIANGLE)
    a, b, c = np.asarray(told["corners"], dtype=float).swapaxes(0, 1)
    normal = np.cross(b - a, c - b)
    area = np.linalg.norm(normal, axis=1)
    assert area.min() > 0.1 * size and np.isfinite(told["normal"]).all()
    # Each normal is of length one, and leads outward.
    assert told["normal"] == pytest.approx(normal / area[:, None], abs=1e-5)
    assert np.vecdot(np.cross(b - a, c - b), a).sum() / 6 == pytest.approx(1.05 * size**2 * 3, rel=1e-5)


def test_a_gentle_curve_keeps_its_corners():
    circle = cut(gk.Part("disc", gk.plane.Circle(0j, 50.0), (), 2.0), 1e-6 * 50)
    assert len(solid(circle)[0]) == 2 * len(circle.loops[0].points)


@pytest.mark.parametrize("kerf", [0.0, 0.2])
def test_places_that_a_file_cannot_tell_apart_are_one(kerf):
    twice = np.array([0, 40, 40 + 1e-8j, 40 + 30j, 40 + 30j - 1e-8, 30j, 1e-8j])
    hole = gk.plane.Polyline(np.array([10 + 10j, 20 + 10j, 20 + 10j + 1e-8, 15 + 20j]))
    made = cut(gk.Part("plate", gk.plane.Polyline(twice), (hole,), 3.0), 0.01, kerf=kerf)
    for loop in made.loops:
        apart = np.abs(loop.points - np.roll(loop.points, 1))
        assert apart.min() > 10.0**-made.digits / 2
    if not kerf:
        assert [len(loop.points) for loop in made.loops] == [4, 3]
        assert made.area == pytest.approx(1200 - 50) == made.chord_area
