"""Edges too short for a file, and corners too flat: they go, and what is left keeps its form."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.export.cut import cut
from geomkin.export.mesh import solid
from geomkin.export.solids import TRIANGLE, stl


@pytest.mark.parametrize("size", [3.0, 300.0])
def test_nearly_straight_corners_leave_no_flat_triangles(size):
    flat = size * np.array([0, 0.5 + 2e-7j, 1, 1 + 2e-7j, 1 + 0.5j, 1 + 1j, 0.4 + 1.1j, 1j, 0.5j])
    plate = gk.Part("plate", gk.plane.Polyline(flat), (), 3.0)
    made = cut(plate, 1e-5 * size)
    assert len(made.loops[0].points) == 9
    points, _ = solid(made)
    # The corners of four, and the one above them.
    assert len(points) == 10
    reported = np.frombuffer(stl(made)[84:], dtype=TRIANGLE)
    a, b, c = np.asarray(reported["corners"], dtype=float).swapaxes(0, 1)
    normal = np.cross(b - a, c - b)
    area = np.linalg.norm(normal, axis=1)
    assert area.min() > 0.1 * size and np.isfinite(reported["normal"]).all()
    # Each normal is of length one, and leads outward.
    assert reported["normal"] == pytest.approx(normal / area[:, None], abs=1e-5)
    assert np.vecdot(np.cross(b - a, c - b), a).sum() / 6 == pytest.approx(1.05 * size**2 * 3, rel=1e-5)


@pytest.mark.parametrize("kerf", [0.0, 0.2])
def test_points_that_round_alike_are_merged(kerf):
    twice = np.array([0, 40, 40 + 1e-8j, 40 + 30j, 40 + 30j - 1e-8, 30j, 1e-8j])
    hole = gk.plane.Polyline(np.array([10 + 10j, 20 + 10j, 20 + 10j + 1e-8, 15 + 20j]))
    made = cut(gk.Part("plate", gk.plane.Polyline(twice), (hole,), 3.0), 0.01, kerf=kerf)
    for loop in made.loops:
        apart = np.abs(loop.points - np.roll(loop.points, 1))
        assert apart.min() > 10.0**-made.digits / 2
    if not kerf:
        assert [len(loop.points) for loop in made.loops] == [4, 3]
        assert made.area == pytest.approx(1200 - 50) == made.chord_area
