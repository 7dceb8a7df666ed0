"""Polygons of curves within a bound, distances by bounds, and positions of plates."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.plane.primitives import Circle, Polyline
from geomkin.plane.region import Edges
from geomkin.verification.comparison import Shape, likely_positions
from geomkin.verification.outline import Outline, arc_points, deviation, farthest, outline_of


def dense(curve, count=40):
    """Points of a curve, far more than any polygon of these tests has corners."""
    b = curve.breaks
    return curve.point(np.unique(np.concatenate([np.linspace(*ends, count) for ends in zip(b, b[1:])])))


# A centre-point curve that comes from far away, at a speed that grows without bound.
POSES = [[0, 0, 0], [40, 20, 30], [60, 57, 80], [40, 94, 110]]
CENTRES = gk.load({"kind": "burmester-curves", "wanted": {"poses": POSES}}).parts[0].marks[0]


@pytest.mark.parametrize("error", [1e-2, 1e-4])
@pytest.mark.parametrize(
    "curve", [Circle(3 + 1j, 25.0), gk.SpurGear(17, 2).outline, Polyline(np.array([0, 60, 60 + 20j, 20j])), CENTRES]
)
def test_polygon_stays_within_its_error(curve, error):
    outline = outline_of(curve, error)
    _, distance = Edges(outline.starts, outline.ends).nearest(dense(curve))
    assert distance.max() <= error * (1 + 1e-6)


def test_largest_distance_between_two_corners_is_found():
    """A bulge between two vertices: every vertex of the file is exact, and a check at vertices alone passes it."""
    circle = Circle(0j, 30.0)
    vertices = circle.point(np.linspace(0, circle.breaks[-1], 91)[:-1])
    bulged = np.full(90, np.tan(np.pi / 180))
    bulged[7] *= 1.04  # one arc bulges by 4 % of its height more
    points = np.concatenate([arc_points(a, b, t, 1e-6) for a, b, t in zip(vertices, np.roll(vertices, -1), bulged)])
    exact = outline_of(circle, 1e-5)
    found, place = deviation(Outline(points, 1e-6), exact, 1e-5)
    chord = abs(vertices[1] - vertices[0])
    height = chord / 2 * np.tan(np.pi / 180)
    assert found == pytest.approx(0.04 * height, rel=0.1)
    assert abs(np.angle(place) - np.radians(30)) < np.radians(2)
    at_vertices = np.abs(np.abs(vertices) - 30).max()
    assert at_vertices < 1e-12


def test_distance_is_that_of_dense_samples():
    rng = np.random.default_rng(3)
    for _ in range(10):
        one, two = (rng.normal(size=12) + 1j * rng.normal(size=12) for _ in range(2))
        found, _ = farthest(Outline(one), Edges(two, np.roll(two, -1)), 1e-4)
        t = np.linspace(0, 1, 2000)
        samples = np.concatenate([a + t * (b - a) for a, b in zip(one, np.roll(one, -1))])
        start, edge = two, np.roll(two, -1) - two
        share = np.clip(((samples[:, None] - start) * edge.conj()).real / abs(edge) ** 2, 0, 1)
        brute = abs(samples[:, None] - start - share * edge).min(axis=1).max()
        assert brute - 1e-9 < found < 1.02 * brute + 1.5e-3


@pytest.mark.parametrize("turn_deg", [0, 37, 90.5, 211.3])
def test_position_of_a_plate_is_found(turn_deg):
    gear = gk.SpurGear(19, 1.5)
    holes = (Circle(0j, 3.0), Circle(6 + 2j, 1.0))
    exact = Shape(outline_of(gear.outline, 1e-4), tuple(outline_of(hole, 1e-4) for hole in holes))
    turn, shift = np.exp(1j * np.radians(turn_deg)), 31.4 - 7.7j
    curves = [gk.flatten(curve, 0.005) * turn + shift for curve in (gear.outline, *holes)]
    plate = Shape(Outline(curves[0]), tuple(map(Outline, curves[1:])))
    found_turn, found_shift = next(likely_positions(plate, exact, 0.005))
    assert abs(found_turn - turn) < 1e-5
    assert abs(found_shift - shift) < 2e-4
