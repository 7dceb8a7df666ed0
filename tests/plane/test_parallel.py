"""Outlines at a distance, against shapely's offset of the finely flattened outline and Steiner's formula."""

import numpy as np
import pytest
import shapely

from geomkin.gear.spur import SpurGear
from geomkin.plane import measure
from geomkin.plane.curve import Moved, Offset, Reversed
from geomkin.plane.flatten import flatten
from geomkin.plane.joined import Path, PolarArray
from geomkin.plane.primitives import Arc, Circle, Polyline, Segment, rounded_hull, slot
from geomkin.plane.region import parallel
from geomkin.plane.vec import Pose, xy
from tests.campaign import by_default

from .curves import Flower, cam_profile

FINE = 1e-5
SQUARE = Polyline(np.array([0, 4, 4 + 4j, 4j]))
BULGED = Polyline(np.array([0, 4, 5 + 3j, 1 + 4j]), np.array([0.1, 0.2, 0.05, 0.15]))
HULL = rounded_hull([0, 5, 1 + 3j], 0.8)
STAR = PolarArray(Polyline(np.array([3, 2 * np.exp(1j * np.pi / 5), 3 * np.exp(2j * np.pi / 5)]), None, False), 5)
GEAR = SpurGear(24, 2).outline

GROWN = {
    "square": (SQUARE, 0.5),
    "polygon in a frame": (Moved(SQUARE, Pose(3 - 7j, np.exp(1j))), 0.5),
    "bulged": (BULGED, 0.3),
    "hull": (HULL, 0.4),
    "hull inward": (HULL, -0.4),
    "slot": (slot(0j, 4 + 2j, 1.0), 0.25),
    "flower": (Flower(3.0), 0.2),
    "flower inward": (Flower(3.0), -0.2),
    "cam": (cam_profile(), 0.7),
    "gear": (GEAR, 0.1),
    "gear in a frame": (Moved(GEAR, Pose(3 - 7j, np.exp(1j))), 0.1),
    "lens": (PolarArray(Arc(-2j, 1 + 0j, 2 * np.arctan(0.5)), 2), 0.3),
}


def polygon(curve):
    return shapely.Polygon(xy(flatten(curve, FINE)))


@pytest.mark.parametrize("name", by_default(GROWN, GROWN.keys() - {"gear"}))
def test_parallel_agrees_with_shapely_buffer(name):
    curve, distance = GROWN[name]
    moved = parallel(curve, distance)
    expected = polygon(curve).buffer(distance, quad_segs=500)
    assert moved.closed
    assert np.isclose(measure.signed_area(moved), expected.area, rtol=0, atol=3 * FINE * expected.length)
    assert polygon(moved).symmetric_difference(expected).area < 3 * FINE * expected.length
    # Everywhere at the distance from the outline, corner arcs included.
    middles = moved.point((moved.breaks[1:] + moved.breaks[:-1]) / 2)
    assert np.allclose(measure.nearest(curve, middles)[1], abs(distance), rtol=1e-9)
    # An arc fills every corner that opens: the tangent goes round without a jump.
    b = moved.breaks
    h = 1e-6 * np.diff(b)
    out, into = moved.point(b[1:]) - moved.point(b[1:] - h), moved.point(b[:-1] + h) - moved.point(b[:-1])
    assert np.abs(np.angle(np.roll(into, -1) / out)).max() < 1e-4


@pytest.mark.parametrize("name", ["square", "bulged", "hull", "slot", "lens"])
def test_convex_outline_grows_by_steiners_formula(name):
    """Area + length d + pi d^2 and length + 2 pi d, with no polygon in between."""
    curve, distance = GROWN[name]
    moved = parallel(curve, distance)
    grown = measure.signed_area(curve) + measure.length(curve) * distance + np.pi * distance**2
    assert np.isclose(measure.signed_area(moved), grown, rtol=1e-10)
    assert np.isclose(measure.length(moved), measure.length(curve) + 2 * np.pi * distance, rtol=1e-10)


KEYED = Polyline(
    np.array([3 + 1j, 3 - 1j, 5 - 1j, 5 + 1j]), np.array([np.tan((np.pi - np.arctan(1 / 3)) / 2), 0, 0, 0])
)
CLOSING = [
    (SQUARE, -0.5),
    (Reversed(SQUARE), 0.5),
    (BULGED, -0.1),
    (STAR, 0.1),
    (STAR, -0.1),
    (GEAR, -0.1),
    (GROWN["lens"][0], -0.1),
    (Polyline(np.array([0, 4, 4 + 4j, 2 + 1j, 4j])), 0.1),
    (Path((Arc(0j, 3 + 0j, np.pi), Segment(-3 + 0j, 3 + 0j))), -0.1),
    (KEYED, -0.2),
    (KEYED, 0.2),
    (Moved(KEYED, Pose(2 - 3j, np.exp(2j))), -0.2),
]


@pytest.mark.parametrize("curve, distance", CLOSING)
def test_sides_of_a_corner_that_closes_end_where_they_meet(curve, distance):
    moved = parallel(curve, distance)
    sense = np.sign(measure.signed_area(curve))
    expected = polygon(curve).buffer(distance * sense, quad_segs=500, join_style="round")
    assert moved.closed
    assert polygon(moved).symmetric_difference(expected).area < 3 * FINE * expected.length
    # The ends meet to rounding, and no end stands nearer to the outline than the distance.
    ends = moved.point(moved.breaks)
    assert np.allclose(measure.nearest(curve, ends)[1], abs(distance), rtol=1e-9)


@pytest.mark.parametrize("curve, distance", [(SQUARE, -2.5), (KEYED, -1.2)])
def test_no_outline_if_a_side_is_trimmed_away(curve, distance):
    moved = parallel(curve, distance)
    if moved is not None:
        loop = shapely.LinearRing(xy(flatten(moved, 1e-3)))
        assert not loop.is_simple or shapely.is_ccw(loop) != (measure.signed_area(curve) > 0)


def test_reversed_outline_grows_with_the_other_sign():
    for curve, distance in GROWN.values():
        back = parallel(Reversed(curve), -distance)
        assert np.isclose(measure.signed_area(back), -measure.signed_area(parallel(curve, distance)), rtol=1e-9)


def test_outline_whose_only_corner_is_its_start():
    """A drop: one smooth stretch that comes back to its start at an angle."""
    drop = Path((Segment(0j, 3 - 3j), Arc(6 + 0j, 3 - 3j, 1.5 * np.pi), Segment(3 + 3j, 0j)))
    moved = parallel(drop, 0.5)
    expected = measure.signed_area(drop) + 0.5 * measure.length(drop) + 0.25 * np.pi
    assert moved.closed and np.isclose(measure.signed_area(moved), expected, rtol=1e-10)
    inward = parallel(drop, -0.5)
    assert np.isclose(measure.area(inward), polygon(drop).buffer(-0.5, quad_segs=500).area, rtol=1e-5)


def test_smooth_outline_is_kept_as_one_exact_curve():
    moved = parallel(Circle(1j, 3.0), 0.5)
    assert isinstance(moved, Offset) and np.isclose(measure.length(moved), 7 * np.pi, rtol=1e-14)


def test_gear_whose_flanks_start_at_the_cusp():
    """At the very limit of undercut the involute begins where it stands still: one flank starts, the other ends so."""
    gear = SpurGear(12, 2, 0.2981009838206882)
    assert gear.form_radius == gear.base_radius
    moved = parallel(gear.outline, 0.1)
    expected = polygon(gear.outline).buffer(0.1, quad_segs=500)
    assert polygon(moved).symmetric_difference(expected).area < 3 * FINE * expected.length


@pytest.mark.parametrize("curve", [SQUARE, STAR, Circle(0j, 2.0)], ids=["square", "star", "circle"])
def test_no_distance_moves_nothing(curve):
    z = flatten(parallel(curve, 0.0), 1e-3)
    assert np.abs(z - np.roll(z, 1)).min() > 1e-9, "a corner that neither opens nor closes needs no arc"
    assert np.isclose(abs(shapely.Polygon(xy(z)).area), abs(polygon(curve).area), atol=1e-3 * measure.length(curve))


@pytest.mark.parametrize("edge", range(2))
def test_corners_that_close_are_found_wherever_the_origin_lies(edge):
    """Also where the edge moved inward starts or ends at it: rounding is relative to the outline's size."""
    corners, bulges = np.array([0.13, 4.2 - 0.3j, 5.1 + 3.7j, 0.9 + 4.3j]), np.full(4, 0.05)
    outline = Polyline(corners, bulges)
    along = complex(outline.velocity(float(edge)))
    inner = corners[edge] + 0.3j * along / abs(along)
    expected = measure.area(parallel(outline, -0.3))
    for turn in np.exp(1j * np.linspace(0, 6, 7)):
        moved = parallel(Polyline((corners - inner) * turn, bulges), -0.3)
        assert moved is not None and measure.area(moved) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("count", [2, 3, 4])
def test_arcs_without_a_corner_stay_arcs_however_few_they_are(count):
    sweep = 2 * np.pi / count
    path = Path(tuple(Arc(5 + 1j, 5 + 1j + 10 * np.exp(1j * k * sweep), sweep) for k in range(count)))
    moved = parallel(path, 2.0)
    assert isinstance(moved, Path) and [(type(p), p.centre) for p in moved.pieces] == [(Arc, 5 + 1j)] * count
    assert np.abs(moved.point(moved.breaks) - 5 - 1j) == pytest.approx(12)
