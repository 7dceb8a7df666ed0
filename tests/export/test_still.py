"""What a picture of a scene takes its sizes from: the scene's own size, the frames that it has room for, the driver."""

import re

import numpy as np
import pytest
import shapely

import geomkin as gk
from geomkin.export.still import MOST_POINTS, SCREEN, Still, frame_at, some_points
from geomkin.model.scene import Scene, SceneBody, SceneCurve, SceneMark
from geomkin.model.table import Column, Table
from geomkin.plane.curve import Moved, Reversed
from geomkin.plane.vec import Pose, xy
from tests.export.test_film import ALONG, FRAMES, scene_of

ONE = np.ones(FRAMES, dtype=complex)


def plate(wide, high, *holes, at=0j):
    corners = at + np.array([0, wide, wide + 1j * high, 1j * high])
    return gk.Part("plate", gk.plane.Polyline(corners), holes, 3.0)


def driven(values, cyclic=True):
    table = Table((Column("lift", "mm", "of the driver", np.asarray(values, dtype=float)),))
    return Scene(table, np.arange(float(len(values))), np.ones(len(values), dtype=bool), (), cyclic=cyclic)


@pytest.mark.parametrize("start", [0.0, 100.0, -180.0])
@pytest.mark.parametrize("way", [1, -1])
def test_the_driver_stands_at_a_share_of_its_own_range_wherever_that_begins(start, way):
    values = start + way * np.arange(101.0)
    assert frame_at(driven(values), None) == 13 and frame_at(driven(values, cyclic=False), None) == 50
    assert frame_at(driven(values), start + 70.4 * way) == 70


def test_a_driver_of_one_frame_is_there_and_nowhere_else():
    assert frame_at(driven([5.0]), 5.0) == frame_at(driven([5.0]), None) == 0
    with pytest.raises(gk.DesignError, match=re.escape("found 5.5 mm, outside the range of the driver; give 5 to 5")):
        frame_at(driven([5.0]), 5.5)


@pytest.mark.parametrize("k", [1e-3, 0.2, 1.0, 70.0])
def test_sizes_and_digits_grow_with_what_is_shown(k):
    far = k * (1000 - 2000j)
    alone = Still(scene_of(bodies=[SceneBody("a", (plate(30 * k, 40 * k, at=far),), 0 * ONE, ONE)]), np.array([0]))
    assert alone.size == pytest.approx(70 * k)
    gone = SceneMark("pin", k * (np.linspace(-60, 60, FRAMES) - 80j * np.linspace(-1, 1, FRAMES)), "construction")
    moving = Still(scene_of(gone), np.array([0]))
    assert moving.size == pytest.approx(200 * k)
    for still in (alone, moving):
        assert still.tolerance == pytest.approx(SCREEN * still.size)
        # The last decimal is a half of what a screen shows, or up to ten times finer.
        assert 0.05 * still.tolerance <= 10.0**-still.digits * (1 + 1e-9) <= 0.51 * still.tolerance


@pytest.mark.parametrize("k", [0.02, 1.0, 30.0])
def test_a_pin_is_as_wide_as_its_hole_whatever_the_scale(k):
    place = 40 * k * np.exp(1j * np.arange(FRAMES))
    arm = gk.Part("arm", gk.plane.Circle(0j, 60 * k), tuple(gk.plane.Circle(40 * k, r * k) for r in (0.4, 0.7)), 3.0)
    beside = SceneMark("pin", place + k, "construction")
    pin = SceneMark("pin", place, "construction")
    still = Still(scene_of(pin, beside, bodies=[SceneBody("arm", (arm,), 0 * ONE, place / (40 * k))]), np.array([3]))
    assert still.hole_radii == {pin: pytest.approx(0.7 * k)}


def test_a_picture_of_many_frames_has_room_for_what_moves_at_each_and_shows_what_comes_and_goes():
    coming = 30j + ALONG.astype(complex)
    coming[[0, 1, 2]] = np.nan
    bodies = [
        SceneBody("base", (plate(20, 20),), 0 * ONE, ONE, fixed=True),
        SceneBody("goes", (plate(8, 4),), 2 * ALONG - 9j, np.exp(0.5j * np.pi * np.arange(FRAMES))),
        SceneBody("comes", (plate(5, 5),), coming, ONE),
    ]
    marks = [SceneMark("circle", 1j * ALONG, "contact", radius=3.0 * np.arange(FRAMES))]
    for frames in ([0], [8], [0, 4, 8], [2, 5]):
        still = Still(scene_of(*marks, bodies=bodies), np.array(frames))
        seen = [np.array([0, 20 + 20j])]
        for k in frames:
            corners = np.array([0, 8, 8 + 4j, 4j]) * 1j**k + 20 * k - 9j
            seen += [corners, 10j * k + 3 * k * np.array([1 + 1j, -1 - 1j])]
            seen += [coming[k] + np.array([0, 5 + 5j])] * (k > 2)
        places = np.concatenate(seen)
        low, high = still.bounds
        assert low == pytest.approx(complex(places.real.min(), places.imag.min()))
        assert high == pytest.approx(complex(places.real.max(), places.imag.max()))
        there = {"base", "goes", "comes"} if max(frames) > 2 else {"base", "goes"}
        assert {body.name for body in still.bodies} == there


@pytest.mark.parametrize("way", [1, 1j, -1, -1j])
def test_what_runs_off_is_followed_by_a_share_of_the_picture_on_its_own_side_alone(way):
    """Three tenths of the width to the sides, of the height up and down: 60 and 12 of 200 by 40."""
    curve = SceneCurve(gk.plane.Segment(100 + 20j, 100 + 20j + 5000 * way), "centrode")
    still = Still(scene_of(bodies=[SceneBody("a", (plate(200, 40),), 0 * ONE, ONE)], curves=(curve,)), np.array([0]))
    low, high = still.bounds
    more = {1: (0, 60), 1j: (0, 12j), -1: (-60, 0), -1j: (-12j, 0)}[way]
    assert (low, high) == pytest.approx((more[0], 200 + 40j + more[1]))


@pytest.mark.parametrize("k", [0.01, 1.0, 100.0])
def test_few_points_stand_for_an_outline_in_its_own_order(k):
    gear = Moved(gk.SpurGear(90, 2 * k).outline, Pose(k * (50 - 20j)))
    tall = gk.plane.rounded_hull([0, 300j * k], 2 * k)
    for curve in (gear, Reversed(gear), tall, gk.plane.Polyline(k * np.array([0, 9, 9 + 50j]))):
        points = some_points(curve)
        size = np.ptp(points.real) + np.ptp(points.imag)
        assert 3 <= len(points) <= MOST_POINTS
        assert points[0] == pytest.approx(complex(curve.point(curve.breaks[0])), abs=1e-9 * size)
        assert np.sign(np.imag(np.conj(points) * np.roll(points, -1)).sum()) == np.sign(gk.plane.signed_area(curve))
        fine = gk.flatten(curve, 1e-4 * size)
        off = shapely.distance(shapely.LinearRing(xy(points)), shapely.points(xy(fine)))
        assert off.max() < (0.03 if len(fine) > MOST_POINTS else 0.0021) * size
    assert len(some_points(gk.plane.Circle(0j, k))) == len(some_points(gk.plane.Circle(0j, 1.0))) > 15
