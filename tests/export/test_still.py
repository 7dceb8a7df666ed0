"""What a picture of a scene takes its sizes from: the scene's own size, the frames that it has room for, the driver."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.export.still import Still
from geomkin.model.scene import SceneBody, SceneCurve, SceneMark
from tests.export.test_animated_marks import ALONG, FRAMES, scene_of

ONE = np.ones(FRAMES, dtype=complex)


def plate(wide, high, *holes, at=0j):
    corners = at + np.array([0, wide, wide + 1j * high, 1j * high])
    return gk.Part("plate", gk.plane.Polyline(corners), holes, 3.0)


def test_picture_has_room_for_all_frames():
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
def test_picture_is_extended_on_the_side_of_a_distant_body(way):
    """Three tenths of the width to the sides, of the height up and down: 60 and 12 of 200 by 40."""
    curve = SceneCurve(gk.plane.Segment(100 + 20j, 100 + 20j + 5000 * way), "centrode")
    still = Still(scene_of(bodies=[SceneBody("a", (plate(200, 40),), 0 * ONE, ONE)], curves=(curve,)), np.array([0]))
    low, high = still.bounds
    more = {1: (0, 60), 1j: (0, 12j), -1: (-60, 0), -1j: (-12j, 0)}[way]
    assert (low, high) == pytest.approx((more[0], 200 + 40j + more[1]))
