"""Scenes of cams as a script asks for them, without parts."""

import numpy as np
import pytest

import geomkin as gk
from tests.cam.cams import CAMS
from tests.gallery import marks, recipe


def scene_of(cam, **more):
    return gk.cam.cam_scene(cam, gk.cam.cam_table(cam, 10.0, np.radians(np.arange(0, 361, 3.0))), **more)


@pytest.mark.parametrize("name", list(CAMS)[::4])
def test_a_cam_by_itself_shows_the_follower_in_lines(name):
    cam = CAMS[name]
    scene, follower = scene_of(cam), cam.follower
    (contact,) = marks(scene, "point", "contact")
    pins = {mark.label: mark.place for mark in scene.marks if mark.sort.endswith("pin")}
    assert ("pivot" in pins) == follower.oscillates and ("roller" in pins) == bool(follower.roller_radius)
    assert scene.cyclic and scene.assembled.all() and not any(body.parts for body in scene.bodies)
    if follower.roller_radius:
        # Where it touches is a roller's radius from its centre, all the time.
        assert np.abs(pins["roller"] - contact.place) == pytest.approx(np.full(121, follower.roller_radius))
    if follower.oscillates:
        (arm,) = marks(scene, "line", "arm")
        assert (arm.place == pins["pivot"]).all() and not marks(scene, "slide")
        if follower.roller_radius:
            assert np.abs(arm.place + arm.vector - pins["roller"]).max() < 1e-9
    else:
        (stem,), (guide,) = marks(scene, "line", "follower"), marks(scene, "slide", "guide")
        way = stem.vector / np.abs(stem.vector)
        # The stem goes along itself through the guide, which stands still, and never leaves it.
        assert np.ptp(guide.place.real) == np.ptp(guide.place.imag) == 0 and np.abs(way - way[0]).max() < 1e-12
        share = np.real((guide.place - stem.place) / stem.vector)
        assert 0 < share.min() and share.max() < 1
        assert np.abs(np.imag((guide.place - stem.place) / way)).max() < 1e-9


def test_undercut_is_found_where_it_is_not_reported():
    cam = recipe("undercut-cam").cam
    told, found = scene_of(cam, cut=gk.undercut(cam)), scene_of(cam)
    for one, other in zip(told.marks, found.marks, strict=True):
        np.testing.assert_array_equal(one.place, other.place)
    assert [curve.label for curve in told.curves] == [curve.label for curve in found.curves]
