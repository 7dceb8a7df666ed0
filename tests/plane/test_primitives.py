"""Bulges, slots and hulls against plain geometry and against shapely."""

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from geomkin.core.errors import DesignError
from geomkin.plane import measure
from geomkin.plane.flatten import flatten
from geomkin.plane.primitives import Arc, Circle, Polyline, rounded_hull
from geomkin.plane.vec import first_largest, xy

grid = st.integers(-20, 20)
places = st.builds(complex, grid, grid)


@pytest.mark.parametrize("sweep", [1.3, -2.0, np.pi, 5.5])
def test_arc_keeps_its_radius_and_turns_by_its_sweep(sweep):
    arc = Arc(2 + 1j, 5 + 1j, sweep)
    arm = arc.point(np.linspace(0, 1, 101)) - (2 + 1j)
    assert np.allclose(np.abs(arm), 3)
    # Step by step, since one angle would not distinguish a sweep from the rest of the turn.
    assert np.isclose(np.angle(arm[1:] / arm[:-1]).sum(), sweep)


@settings(deadline=None, max_examples=30)
@given(places, places, st.floats(-3, 3))
def test_bulge_is_the_rise_over_half_the_chord(a, b, bulge):
    """The middle of the arc stands off the chord by bulge times half of it, to the right where positive.

    All the rest lies on the circle through the two ends and that middle.
    """
    if a == b:
        return
    edge = Polyline(np.array([a, b]), np.array([bulge]), False)
    z = edge.point(np.linspace(0, 1, 9))
    top = (a + b) / 2 - 1j * bulge * (b - a) / 2
    assert np.allclose([z[0], z[4], z[-1]], [a, top, b], atol=1e-12)
    if abs(bulge) < 1e-3:
        return
    # Centre equally far from an end and from the top.
    centre = top + 1j * (b - a) / abs(b - a) * (abs(a - top) ** 2 / 2 / (bulge * abs(b - a) / 2))
    assert np.allclose(np.abs(z - centre), abs(a - centre), rtol=1e-9)
    steps = np.abs(np.diff(z))
    assert np.allclose(steps, steps[0]), "equal steps of t are equal steps of arc"


@settings(deadline=None, max_examples=20)
@given(st.lists(places, min_size=1, max_size=9), st.floats(0.5, 5))
def test_rounded_hull_agrees_with_shapely(centres, radius):
    """Area and length by Steiner's formula from the bare hull, and the outline against shapely's buffer."""
    outline = rounded_hull(centres, radius)
    hull = shapely.MultiPoint(xy(np.array(centres))).convex_hull
    rim = hull.length if hull.geom_type == "Polygon" else 2 * hull.length
    assert outline.closed
    assert np.isclose(measure.length(outline), rim + 2 * np.pi * radius, rtol=1e-9)
    assert np.isclose(measure.signed_area(outline), hull.area + rim * radius + np.pi * radius**2, rtol=1e-9)
    points = shapely.points(xy(outline.point(np.linspace(outline.breaks[0], outline.breaks[-1], 301))))
    assert np.allclose(shapely.distance(hull, points), radius, rtol=1e-9)


@pytest.mark.parametrize("centres", [[0, 1, 2, 3], [0, 3, 1j, 3 + 1j, 1 + 0.5j, 1.5, 3 + 0.2j]])
def test_points_inside_the_hull_or_on_its_rim_add_no_corner(centres):
    corners = 2 if np.isreal(centres).all() else 4
    assert len(rounded_hull(centres, 0.5).breaks) == 2 * corners + 1


def test_centres_that_differ_by_rounding_give_no_edge_shorter_than_rounding():
    """0.1 * 3 is not 0.3: an outline with edges of 5e-17 mm has points that no file can distinguish."""
    for centres in ([0.3, 0.1 * 3], [0, 0.3, 0.1 * 3 + 1e-17j]):
        points = flatten(rounded_hull(centres, 5.0), 0.01)
        assert np.abs(points - np.roll(points, 1)).min() > 1e-9


@pytest.mark.parametrize(
    "make, field",
    [
        (lambda: Circle(0j, 0.0), "radius"),
        (lambda: Circle(0j, -1.0), "radius"),
        (lambda: Circle(0j, np.nan), "radius"),
        (lambda: Circle(complex(np.nan, 0), 1.0), "centre"),
        (lambda: Circle(0j, np.inf), "radius"),
        (lambda: Polyline(np.array([1 + 1j])), "vertices"),
        (lambda: Polyline(np.array([0, 1, np.nan])), "vertices"),
    ],
)
def test_invalid_sizes_are_refused(make, field):
    with pytest.raises(DesignError) as refusal:
        make()
    assert refusal.value.field == field and refusal.value.remedy


@pytest.mark.parametrize("size", [1e-7, 1e7])
@pytest.mark.parametrize("bulge", [0.0, 1e-4, 0.00499, 0.00501, 3.0, -0.4])
def test_the_area_within_edges_and_arcs_is_that_of_many_chords(bulge, size):
    """By Richardson's limit of the chords' areas, which err by the square of their length."""
    curve = Polyline(size * np.array([3 + 1j, 9 + 2j, 8 + 7j, 2 + 5j]), np.array([bulge, 0.0, bulge / 2, 0.0]))

    def chords(count):
        z = curve.point(np.linspace(0, 4, 4 * count, endpoint=False))
        return 0.5 * np.sum(np.conj(z - z[0]) * (np.roll(z, -1) - z[0])).imag

    coarse, fine, finest = (chords(count) for count in (500, 1000, 2000))
    once = [fine + (fine - coarse) / 3, finest + (finest - fine) / 3]
    assert measure.signed_area(curve) == pytest.approx(once[1] + (once[1] - once[0]) / 15, rel=1e-13)


@pytest.mark.parametrize(
    "values, first",
    [
        ([1, 3, 3 * (1 + 1e-15), 2], 1),
        ([1, 3, 3 * (1 + 1e-6), 2], 2),
        ([-2 * (1 + 1e-15), -2, -3], 0),
        ([np.nan, 1, np.inf], 2),
        ([0.0, -1e-300, 0.0], 0),
    ],
)
def test_the_first_of_equal_maxima(values, first):
    assert first_largest(np.array(values, dtype=float)) == first
