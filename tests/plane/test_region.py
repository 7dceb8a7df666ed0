"""Regions against exact areas and distances worked out by hand."""

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from geomkin.core.errors import DesignError
from geomkin.plane import region
from geomkin.plane.flatten import flatten
from geomkin.plane.primitives import Circle, rounded_hull
from geomkin.plane.vec import xy
from tests.campaign import by_default

from .curves import Flower


def square(side, corner=0j):
    return corner + side * np.array([0, 1, 1 + 1j, 1j])


def signed_area(loop):
    return 0.5 * np.imag(np.conj(loop) * np.roll(loop, -1)).sum()


def disc(radius, tolerance, centre=0j):
    return flatten(Circle(centre, radius), tolerance)


def test_simple_means_no_crossing_no_touching_and_some_area():
    assert region.is_simple(square(2)) and region.is_simple(square(2)[::-1])
    bow_tie = np.array([0, 2 + 2j, 2, 2j])
    touching = np.array([0, 4, 4 + 4j, 2, 4j])  # its dent reaches the opposite side
    there_and_back = np.array([0, 1 + 1j, 2 + 2j])
    twice_round = np.array([0, 2, 2 + 2j, 2j] * 2)
    for loop in (bow_tie, touching, there_and_back, twice_round):
        assert not region.is_simple(loop)


def test_union_of_four_bars_leaves_a_hole():
    """Outline counterclockwise, hole clockwise, no start repeated, whichever way the bars run."""
    bars = [np.array([0, 6, 6 + 1j, 1j]) + shift for shift in (0, 5j)]
    bars += [1j * (bars[0].conj())[::-1] + shift for shift in (0, 5)]
    for given_as in (bars, [b[::-1] for b in bars]):
        (loops,) = region.union(given_as)
        assert [np.round(signed_area(loop), 12) for loop in loops] == [36, -16]
        assert all(np.abs(loop - np.roll(loop, 1)).min() > 0.5 for loop in loops)


@settings(deadline=None, max_examples=20)
@given(st.floats(1, 50), st.floats(-0.9, 2), st.floats(-4, -1), st.floats(-4, -1))
def test_offset_of_a_disc_is_a_disc(radius, share, power, fineness):
    """Against the exact disc: the polygon's own error and the tolerance together; growing and shrinking.

    The tolerance goes down to a thousandth of the distance, ten times below what kerfs ask for.
    """
    distance = share * radius
    tolerance = max(10**power, 1e-3 * abs(distance))
    own = 10**fineness * radius
    ((outline,),) = region.offset([disc(radius, own)], distance, tolerance)
    rim = np.concatenate([outline, (outline + np.roll(outline, 1)) / 2])
    off = np.abs(np.abs(rim) - (radius + distance)).max()
    assert off <= own * (1 + 1e-6) + tolerance * 1.1


@pytest.mark.parametrize("distance", by_default([-1.0, 3.0], [-1.0]))
def test_offset_keeps_a_tolerance_that_is_very_small_beside_the_distance(distance):
    """Down to a ten-thousandth of the distance; measured from the very polygon that was given."""
    outline, tolerance = disc(30.0, 1e-5), max(1e-4, 1e-4 * abs(distance))
    ((moved,),) = region.offset([outline], distance, tolerance)
    rim = np.concatenate([moved, (moved + np.roll(moved, 1)) / 2])
    away = shapely.distance(shapely.LinearRing(xy(outline)), shapely.points(xy(rim)))
    assert np.abs(away - abs(distance)).max() <= tolerance * (1 + 1e-3)


@pytest.mark.parametrize("tolerance", [1e-2])
def test_offset_of_a_square_has_round_corners(tolerance):
    ((grown,),) = region.offset([square(10)], 2.0, tolerance)
    exact = 100 + 80 + 4 * np.pi
    assert exact - 4 * np.pi * tolerance <= signed_area(grown) <= exact * (1 + 1e-12)
    away = shapely.distance(shapely.Polygon(xy(square(10))), shapely.points(xy((grown + np.roll(grown, 1)) / 2)))
    assert np.abs(away - 2).max() <= tolerance * (1 + 1e-6)
    ((shrunk,),) = region.offset([square(10)], -2.0, tolerance)
    assert np.isclose(signed_area(shrunk), 36) and len(shrunk) == 4


@pytest.mark.parametrize("distance", [-0.4, 0.4])
def test_offset_of_a_wavy_outline_is_everywhere_at_the_distance(distance):
    outline = flatten(Flower(5.0), 1e-4)
    ((moved,),) = region.offset([outline], distance, 1e-3)
    rim = np.concatenate([moved, (moved + np.roll(moved, 1)) / 2])
    away = shapely.distance(shapely.LinearRing(xy(outline)), shapely.points(xy(rim)))
    assert np.abs(away - abs(distance)).max() <= 1e-3 * (1 + 1e-3)


def test_offset_shrinks_holes_and_splits_necks():
    plate = [square(10), square(4, 3 + 3j)[::-1]]
    (loops,) = region.offset(plate, 1.0, 1e-3)
    assert signed_area(loops[0]) > 100 and np.isclose(signed_area(loops[1]), -4)
    neck = np.array([0, 4, 4 + 1.5j, 8 + 1.5j, 8, 12, 12 + 4j, 8 + 4j, 8 + 2.5j, 4 + 2.5j, 4 + 4j, 4j])
    assert len(region.offset([neck], -0.6, 1e-3)) == 2
    assert np.array_equal(region.offset([square(2)], 0.0, 1e-3)[0][0], square(2))


def test_overlap():
    lens = 2 * (np.pi / 3 - np.sqrt(3) / 4)  # two unit discs a unit apart
    assert np.isclose(region.overlap([disc(1.0, 1e-7)], [disc(1.0, 1e-7, 1 + 0j)]), lens, atol=1e-6)
    assert region.overlap([square(2)], [square(2, 2)]) == 0, "sharing a side is no overlap"
    assert region.overlap([square(2)], [square(2, 5)]) == 0
    plate = [square(10), square(4, 3 + 3j)[::-1]]
    assert np.isclose(region.overlap(plate, [square(3, 2 + 2j)]), 5), "the hole is not part of the plate"


def test_apart_inside():
    outside = [square(2, 2), square(2, 2 + 2j), square(2, 5), square(4), square(6, -1 - 1j), square(2, 1)]
    for outer in (square(4), square(4)[::-1]):
        assert region.apart_inside(outer, [square(2, 1 + 1j), *outside], 0).tolist() == [True] + [False] * 6
        assert region.apart_inside(outer, [square(2, 1 + 1j)] * 2, 1).all()
        assert not region.apart_inside(outer, [square(2, 1 + 1j)], 1 + 1e-12).any()
    assert region.apart_inside(square(4), [], 1).tolist() == []


def test_crossing_outlines_are_refused():
    for loops in ([np.array([0, 2 + 2j, 2, 2j])], [square(4), square(2, 3 + 1j)]):
        with pytest.raises(DesignError) as refusal:
            region.overlap(loops, [square(1)])
        assert refusal.value.field == "outline" and refusal.value.remedy


PLATES = {
    "square": [square(2)],
    "clockwise": [square(2)[::-1]],
    "flower": [flatten(Flower(5.0), 1e-2)],
    "plate with holes": [
        flatten(rounded_hull([0, 20, 5 + 12j], 4.0), 1e-2),
        *(flatten(Circle(c, 2.0), 1e-2)[::-1] for c in (0j, 20 + 0j, 5 + 12j)),
    ],
}


@pytest.mark.parametrize("loops", PLATES.values(), ids=PLATES.keys())
def test_triangles_cover_the_region_and_add_no_point(loops):
    points, faces = region.triangulate(loops)
    given = np.concatenate(loops)
    assert set(points.tolist()) == set(given.tolist()) and len(points) == len(set(points.tolist()))
    a, b, c = points[faces].T
    areas = 0.5 * np.imag(np.conj(b - a) * (c - a))
    assert (areas > 0).all(), "counterclockwise"
    assert np.isclose(areas.sum(), abs(signed_area(loops[0])) - sum(abs(signed_area(h)) for h in loops[1:]))
    # Euler: a polygon of n corners with h holes takes n + 2 h - 2 triangles.
    assert len(faces) == len(given) + 2 * (len(loops) - 1) - 2
    # Every inner side belongs to two triangles that run it opposite ways; every rim side to one.
    sides = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    directed = set(map(tuple, sides.tolist()))
    assert len(directed) == len(sides)
    assert sum((q, p) not in directed for p, q in directed) == len(given)


def by_definition(loop, within):
    """Least way across the material, from a corner to an edge, that no small step of either end shortens."""
    area, least, step = shapely.Polygon(xy(loop)), within, 1e-3
    ring = shapely.LinearRing(xy(loop))

    def steps(place):
        at = ring.project(shapely.Point(place.real, place.imag))
        for near in (at - step, at + step):
            point = ring.interpolate(near % ring.length)
            yield complex(point.x, point.y)

    for k, corner in enumerate(loop):
        for j in range(len(loop)):
            a, b = loop[j], loop[(j + 1) % len(loop)]
            share = np.clip(((corner - a) * np.conj(b - a)).real / abs(b - a) ** 2, 0, 1)
            foot = a + share * (b - a)
            width = abs(foot - corner)
            if 0 < width < least and j not in (k, (k - 1) % len(loop)):
                shorter = [abs(z - foot) for z in steps(corner)] + [abs(corner - z) for z in steps(foot)]
                way = shapely.LineString(xy(corner + np.array([0.01, 0.99]) * (foot - corner)))
                if min(shorter) > width - 1e-7 and shapely.contains_properly(area, way):
                    least = width
    return least if least < within else np.inf


@pytest.mark.parametrize("seed", range(4))
def test_neck_agrees_with_its_definition(seed):
    """Rectangles laid over each other: necks at bars and between inner corners, none at corners that stick out."""
    random = np.random.default_rng(seed)
    boxes = [
        np.array([x + 1j * y, x + w + 1j * y, x + w + 1j * (y + h), x + 1j * (y + h)])
        for x, y, w, h in np.concatenate([random.integers(0, 14, (7, 2)), random.integers(1, 7, (7, 2))], axis=1)
    ]
    reported = []
    for outline, *holes in region.union(boxes):
        if not holes:
            loop = outline * np.exp(0.3j)
            reported.append(region.neck([loop], [len(loop)], 6.5))
            assert reported[-1] == pytest.approx(by_definition(loop, 6.5), rel=1e-9)
    assert reported


def regular(corners, radius, centre=0j):
    return centre + radius * np.exp(2j * np.pi * np.arange(corners) / corners)


@pytest.mark.parametrize("outer", [30.0, 0.0])
@pytest.mark.parametrize("seed", range(2))
def test_spacing_is_the_smallest_distance_of_all_pairs(seed, outer):
    """Circles and polygons in a disc or a square, against the distances of polygons of very many corners."""
    rng = np.random.default_rng(seed)
    places = 14 * np.exp(2j * np.pi * (np.arange(5) + rng.uniform(-0.2, 0.2, 5)) / 5) + rng.uniform(-2, 2, 5)
    radii = [*rng.uniform(1, 4, 3), 0.0, 0.0]
    holes = [np.array([z]) if r else regular(7, 2 + k, z) for k, (z, r) in enumerate(zip(places, radii))]
    outline = np.array([1 + 2j]) if outer else square(60, -30 - 30j)
    found = region.spacing([outline, *holes], [outer, *radii])
    fine = [regular(400, r, z) if r else hole for z, r, hole in zip(places, radii, holes)]
    fine.append(regular(900, outer, 1 + 2j) if outer else outline)
    pairs = [region.gap(a, b) for k, a in enumerate(fine) for b in fine[:k]]
    assert found == pytest.approx(min(pairs), abs=1e-3)
    # Each of them alone in the plate, too: the outline by itself.
    for k, (hole, radius) in enumerate(zip(holes, radii)):
        alone = region.spacing([outline, hole], [outer, radius])
        assert alone == pytest.approx(region.gap(fine[k], fine[-1]), abs=1e-3)
    assert region.spacing([outline], [outer]) == np.inf
    # Two circles that are nearer to each other than to all else.
    pair = [np.array([1 + 2j]), np.array([1 + 2j + 9 * np.exp(1j * seed)])]
    close = region.spacing([outline, *pair], [outer, 5.0, 3.0])
    assert close == pytest.approx(1.0)


def test_holds():
    plate = [square(10), square(4, 3 + 3j)[::-1]]
    corners = np.array([0.5 + 0.5j, 8.5 + 0.5j, 4.5 + 4.5j, 2.5 + 0.5j, 9.5 + 9.5j, 7.5 + 7.5j])
    boxes = corners[:, None] + square(1)
    assert region.holds(plate, boxes).tolist() == [True, True, False, True, False, True]
    lines = [np.array([8 + 0j, 10 + 2j]), np.array([0j, 0.6 + 0.6j])]
    assert region.holds(plate, boxes, lines).tolist() == [False, False, False, True, False, True]


def test_difference_and_selection_of_pieces():
    (left,) = region.without([square(10)], [square(4, 8 + 3j), square(2, 4 + 4j)])
    assert [round(signed_area(loop), 12) for loop in left] == [100 - 2 * 4, -4]
    halves = region.without([square(10)], [np.array([-1 + 4j, 11 + 4j, 11 + 6j, -1 + 6j])])
    assert [round(signed_area(loop), 12) for (loop,) in halves] == [40, 40]
    cut = [np.array([5 - 1j, 5 + 11j]), np.array([-1 + 2j, 11 + 2j])]
    for wanted, area in (
        (lambda z: z.real < 5, 50),
        (lambda z: z.imag > 2, 80),
        (lambda z: (z.real < 5) & (z.imag < 2), 10),
    ):
        ((kept,),) = region.where(square(10), cut, wanted)
        assert signed_area(kept) == pytest.approx(area)
    assert region.where(square(10), cut, lambda z: z.real > 20) == []


@pytest.mark.parametrize("tolerance", [0.05])
def test_thinned_polygon_stays_near_the_removed_points(tolerance):
    loop = disc(20.0, 1e-3)
    few = region.thinned(loop, tolerance)
    assert set(few.tolist()) <= set(loop.tolist()) and 3 < len(few) < len(loop) / 2
    away = shapely.distance(shapely.LinearRing(xy(few)), shapely.points(xy(loop)))
    assert 0.2 * tolerance < away.max() <= tolerance * (1 + 1e-9)
