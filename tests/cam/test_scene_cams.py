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
    assert ("pivot" in pins) == follower.oscillates and ("roller" in pins) == bool(follower.rounding)
    assert scene.cyclic and scene.assembled.all() and not any(body.parts for body in scene.bodies)
    if follower.rounding:
        # Where it touches is a roller's radius from its centre, all the time.
        assert np.abs(pins["roller"] - contact.place) == pytest.approx(np.full(121, follower.rounding))
    if follower.oscillates:
        (arm,) = marks(scene, "line", "arm")
        assert (arm.place == pins["pivot"]).all() and not marks(scene, "slide")
        if follower.rounding:
            assert np.abs(arm.place + arm.vector - pins["roller"]).max() < 1e-9
    else:
        (stem,), (guide,) = marks(scene, "line", "follower"), marks(scene, "slide", "guide")
        way = stem.vector / np.abs(stem.vector)
        # The stem goes along itself through the guide, which stands still, and never leaves it.
        assert np.ptp(guide.place.real) == np.ptp(guide.place.imag) == 0 and np.abs(way - way[0]).max() < 1e-12
        share = np.real((guide.place - stem.place) / stem.vector)
        assert 0 < share.min() and share.max() < 1
        assert np.abs(np.imag((guide.place - stem.place) / way)).max() < 1e-9


def test_undercut_is_found_where_it_is_not_told():
    cam = recipe("undercut-cam").cam
    told, found = scene_of(cam, cut=gk.undercut(cam)), scene_of(cam)
    for one, other in zip(told.marks, found.marks, strict=True):
        np.testing.assert_array_equal(one.place, other.place)
    assert [curve.label for curve in told.curves] == [curve.label for curve in found.curves]


SHARP = gk.Program(
    (gk.Rise("cycloidal", rise=10, end_deg=40), gk.Return("cycloidal", end_deg=80), gk.Dwell(end_deg=360))
)


@pytest.mark.parametrize("sort", ["circle", "line"])
def test_what_undercut_keeps_from_its_place_is_drawn_where_it_should_be(sort):
    """By the table: as far beyond the follower as lift is lost, along its way; nowhere else."""
    follower = gk.TranslatingRoller(12, 0) if sort == "circle" else gk.TranslatingFlat(0)
    cam = gk.Cam(follower, SHARP, 20)
    scene = scene_of(cam)
    (wished,) = [mark for mark in scene.marks if mark.label == "follower where it should be"]
    lost = np.asarray(scene.table["lost_lift"])
    (way,) = marks(scene, "line", "direction of motion")
    assert wished.sort == sort and (lost > 0).any() and np.array_equal(np.isfinite(wished.place), lost > 0)
    along = way.vector / np.abs(way.vector)
    here = lost > 0
    if sort == "circle":
        (pin,) = marks(scene, "pin", "roller")
        assert np.abs(wished.place - pin.place - lost * along)[here].max() < 1e-6
        assert (wished.radius == 12).all()
    else:
        # Square to the way, and through where the face would be by its lift.
        assert np.abs(np.real(wished.vector * np.conj(along)))[here].max() < 1e-9
        high = np.real(wished.place * np.conj(along))[here]
        assert high == pytest.approx(20 + np.asarray(scene.table["lift"])[here] + 0 * lost[here], abs=1e-6)
