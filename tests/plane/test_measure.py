"""Measures against closed forms, against shapely, and against the nearest of very many points."""

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from geomkin.core.errors import DesignError
from geomkin.gear.spur import SpurGear
from geomkin.plane import measure
from geomkin.plane.curve import Mirrored, Moved, Reversed
from geomkin.plane.flatten import flatten
from geomkin.plane.joined import Path
from geomkin.plane.primitives import Arc, Circle, Polyline, Segment, slot
from geomkin.plane.roulettes import Involute
from geomkin.plane.vec import Pose, xy
from tests.campaign import by_default

from .curves import Flower, cam_profile, examples, flank, size

CURVES = examples() | {"flank": flank(), "cam": cam_profile()}


def wound(radius, t):
    """The region between a circle, its involute up to roll angle t, and the taut string, counterclockwise."""
    curve = Involute(radius, 0.0, t)
    tip, foot = complex(curve.point(t)), radius * np.exp(1j * t)
    return Path((curve, Segment(tip, foot), Arc(0j, foot, -t)))


@settings(deadline=None, max_examples=30)
@given(st.floats(1e-3, 1e4), st.floats(0, 2), st.floats(0.1, 3))
def test_involute_by_its_closed_forms(radius, start, more):
    """Length rb (t1^2 - t0^2) / 2; area swept by the string rb^2 t^3 / 6."""
    end = start + more
    assert np.isclose(measure.length(Involute(radius, start, end)), radius * (end**2 - start**2) / 2, rtol=1e-12)
    assert np.isclose(measure.signed_area(wound(radius, more)), radius**2 * more**3 / 6, rtol=1e-10)


def test_circles_slots_and_half_discs_by_their_closed_forms():
    disc = Circle(2 + 1j, 3.0)
    assert np.isclose(measure.length(disc), 6 * np.pi, rtol=1e-14)
    assert np.isclose(measure.signed_area(disc), 9 * np.pi, rtol=1e-14)
    assert np.isclose(measure.centroid(disc), 2 + 1j, rtol=1e-14)
    pill = slot(1 - 1j, 4 + 3j, 0.7)
    assert np.isclose(measure.length(pill), 10 + 1.4 * np.pi, rtol=1e-14)
    assert np.isclose(measure.signed_area(pill), 7 + 0.49 * np.pi, rtol=1e-14)
    assert np.isclose(measure.centroid(pill), 2.5 + 1j, rtol=1e-14)
    half = Path((Arc(1j, 3 + 1j, np.pi), Segment(-3 + 1j, 3 + 1j)))
    assert np.isclose(measure.signed_area(half), 4.5 * np.pi) and np.isclose(measure.centroid(half), 1j + 4j / np.pi)
    assert np.isclose(measure.length(Arc(0j, 2 + 0j, -4.5)), 9.0)


@settings(deadline=None, max_examples=40)
@given(st.lists(st.floats(0.5, 5), min_size=3, max_size=9), st.builds(complex, st.floats(-50, 50), st.floats(-50, 50)))
def test_polygons_agree_with_shapely(radii, centre):
    """Star-shaped, so never crossing; any place."""
    z = centre + np.array(radii) * np.exp(2j * np.pi * np.arange(len(radii)) / len(radii))
    polygon, curve = shapely.Polygon(xy(z)), Polyline(z)
    assert np.isclose(measure.signed_area(curve), polygon.area, rtol=1e-10)
    assert np.isclose(measure.length(curve), polygon.length, rtol=1e-12)
    middle = complex(polygon.centroid.x, polygon.centroid.y)
    assert np.isclose(measure.centroid(curve), middle, rtol=1e-9, atol=1e-9)
    assert np.isclose(measure.signed_area(Reversed(curve)), -polygon.area, rtol=1e-10)
    assert np.isclose(measure.centroid(Reversed(curve)), middle, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("curve", [Flower(3.0), cam_profile(), wound(3.0, 1.5), SpurGear(11, 2, 0.4).outline])
def test_curved_outlines_agree_with_shapely(curve):
    polygon = shapely.Polygon(xy(flatten(curve, 1e-5)))
    sense = 1 if measure.signed_area(curve) > 0 else -1
    assert np.isclose(sense * measure.signed_area(curve), polygon.area, atol=1e-5 * polygon.length)
    assert np.isclose(measure.length(curve), polygon.length, rtol=1e-5)
    middle = complex(polygon.centroid.x, polygon.centroid.y)
    assert abs(measure.centroid(curve) - middle) < 1e-5 * polygon.length**2 / polygon.area


def test_centroid_follows_the_outline():
    assert np.isnan(measure.centroid(Polyline(np.array([0, 1 + 1j]))))
    shape, pose = CURVES["bulged"], Pose(30 - 20j, np.exp(2.0j))
    middle = measure.centroid(shape)
    assert np.isclose(measure.centroid(Moved(shape, pose)), pose.place(middle), rtol=1e-12)
    assert np.isclose(measure.centroid(Mirrored(shape)), -np.conj(middle), rtol=1e-12)


@pytest.mark.parametrize("name", by_default(CURVES, slice(0, None, 3)))
def test_nearest_against_the_nearest_of_many(name):
    curve = CURVES[name]
    rng = np.random.default_rng(5)
    low, high = curve.breaks[0], curve.breaks[-1]
    middle = curve.point(0.5 * (low + high))
    z = middle + 2 * size(curve) * (rng.uniform(-1, 1, (6, 5)) + 1j * rng.uniform(-1, 1, (6, 5)))
    t, distance = measure.nearest(curve, z)
    assert t.shape == distance.shape == z.shape and (t >= low).all() and (t <= high).all()
    assert np.allclose(np.abs(curve.point(t) - z), distance, rtol=1e-14)
    many = np.sort(np.concatenate([np.linspace(low, high, 20_000), curve.breaks]))
    dense = curve.point(many)
    best = np.array([np.abs(dense - p).min() for p in z.ravel()]).reshape(z.shape)
    step = np.abs(np.diff(dense)).max()
    assert (distance <= best + 1e-12 * size(curve)).all()
    # Between two samples the curve may be nearer, by less than a step.
    assert (distance >= best - step).all()
    on = curve.point(np.linspace(low, high, 41))
    assert measure.nearest(curve, on)[1].max() < 1e-12 * size(curve)


def test_nearest_of_plain_shapes():
    line, disc = Segment(0j, 4 + 0j), Circle(1 + 1j, 2.0)
    t, distance = measure.nearest(line, np.array([1 + 2j, -3 + 4j, 7 - 4j, 2 + 0j]))
    assert np.allclose(t, [0.25, 0, 1, 0.5]) and np.allclose(distance, [2, 5, 5, 0])
    t, distance = measure.nearest(disc, 1 + 6j)
    assert np.shape(t) == np.shape(distance) == () and np.isclose(t, np.pi / 2) and np.isclose(distance, 3)
    assert np.isclose(measure.nearest(disc, 1 + 1j)[1], 2)
    beyond = 1 + 1j + 5 * np.exp(1j * np.linspace(0, 2 * np.pi, 50))
    assert np.allclose(measure.nearest(disc, beyond)[1], 3, rtol=1e-14), "also across the start of t"
    square = Polyline(np.array([0, 4, 4 + 4j, 4j]))
    t, distance = measure.nearest(square, np.array([5 + 6j, 2 + 1j, -1 - 1j]))
    assert np.allclose(distance, [np.hypot(1, 2), 1, np.sqrt(2)]) and np.allclose(t[:2], [2, 0.5])


@pytest.mark.parametrize("shift", [3.0, 1e-3, 1e-9])
def test_nearest_of_many_sides_that_are_almost_equally_near(shift):
    """All sides of a polygon touch one circle; close to its centre which one is nearest is a matter of digits."""
    rng = np.random.default_rng(2)
    angles = np.sort(2 * np.pi * (np.arange(12) + rng.uniform(0.1, 0.9, 12)) / 12)
    normals, half = np.exp(1j * angles), np.diff(angles, append=angles[0] + 2 * np.pi) / 2
    polygon = Polyline(20 * normals * np.exp(1j * half) / np.cos(half))
    z = shift * np.exp(2j * np.pi * rng.uniform(size=200))
    expected = (20 - np.real(z[:, None] * np.conj(normals))).min(axis=1)
    assert np.abs(measure.nearest(polygon, z)[1] - expected).max() < 1e-12 * 40


def dented():
    """Convex everywhere but on one edge, which is dented by an arc of radius 5 / 3."""
    return Polyline(np.array([0, 2, 2 + 2j, 2j]), np.array([0.4, -1 / 3, 0.4, 0.4]))


@pytest.mark.parametrize("curve", [dented(), Moved(dented(), Pose(1j, 1j))])
def test_convexity_does_not_depend_on_the_direction_of_an_outline(curve):
    middles = np.array([0.5, 1.5, 2.5, 3.5])
    there = measure.convexity(curve, middles)
    back = measure.convexity(Reversed(curve), -middles)
    mirrored = measure.convexity(Mirrored(curve), middles)
    assert np.array_equal(np.sign(there), [1, -1, 1, 1])
    assert np.allclose(there, back) and np.allclose(there, mirrored)
    # Radius from chord and rise: (chord^2 / 4 + rise^2) / (2 rise), with chord 2 and rise a third.
    assert np.isclose(there[1], -1 / ((1 + 1 / 9) / (2 / 3)))


def test_area_is_positive_in_either_direction():
    dent, middles = dented(), np.array([0.5, 1.5, 2.5, 3.5])
    assert measure.area(Reversed(dent)) == measure.area(dent) == measure.signed_area(dent) > 0
    assert np.isclose(measure.signed_area(Reversed(dent)), -measure.area(dent), rtol=1e-12)
    assert np.allclose(measure.curvature(Reversed(dent), -middles), -measure.curvature(dent, middles))
    assert np.array_equal(measure.curvature(dent, middles), measure.convexity(dent, middles))
    for of in (measure.area, measure.signed_area, measure.centroid, lambda curve: measure.convexity(curve, 0.5)):
        with pytest.raises(DesignError) as refusal:
            of(Arc(0j, 2 + 0j, 1.0))
        assert refusal.value.field == "curve"
