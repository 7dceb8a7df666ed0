"""Cam plates, rollers, flat followers and arms: measured, and put together at every angle."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

import geomkin as gk
from geomkin.cam.checks import contact_travel
from geomkin.cam.followers.flat import OscillatingFlat
from geomkin.cam.followers.roller import OscillatingRoller, TranslatingRoller
from geomkin.cam.parts import CamStock, cam_parts
from geomkin.cam.undercut import undercut
from tests.cam.cams import CAMS, LIFTS, SWINGS, UNDERCUT

EVERYTHING = CamStock(bore=12, keyway_width=4, keyway_depth=1.8, timing_mark=True, bar_width=10, pivot_bore=5)
ALL = [*CAMS, *(f"undercut {name}" for name in UNDERCUT if name != "roller, tip lost")]
each_cam = pytest.mark.parametrize("cam", ALL[::5], indirect=True)


@pytest.fixture
def cam(request):
    name = request.param
    return CAMS[name] if name in CAMS else UNDERCUT[name.removeprefix("undercut ")]


def parts_of(cam, stock=EVERYTHING):
    return {part.name: part for part in cam_parts(cam, stock)}


def polygon(curve):
    return shapely.Polygon(gk.plane.xy(gk.flatten(curve, 1e-4)))


def moved(shape, pose):
    z = pose.place(shapely.get_coordinates(shape.exterior).view(complex)[:, 0])
    return shapely.Polygon(gk.plane.xy(z))


@each_cam
def test_the_plates_in_the_cams_plane_touch_it_and_no_more(cam):
    """Face or roller placed at every angle: they rest on the plate, or come down to it where lift is lost."""
    parts, lost = parts_of(cam), undercut(cam).lost_lift
    plate = polygon(parts["cam"].outline)
    rider = parts.get("roller") or parts.get("follower") or parts.get("arm")
    if rider is None:
        return
    shape = polygon(rider.outline)
    if rider.name == "arm":
        # The boss round the pivot stays clear of it too.
        assert np.abs(shapely.get_coordinates(plate.exterior).view(complex)).max() < cam.follower.pivot_distance - 5
    for angle in np.radians(np.arange(3, 360, 13)):
        turned = moved(plate, gk.plane.Pose(0, np.exp(1j * cam.sense * angle)))
        lift = cam.program.motion(angle).lift - lost(angle)
        pose = cam.follower.pose(lift, cam.base_radius)
        if rider.name == "roller" and isinstance(cam.follower, OscillatingRoller):
            pose = gk.plane.Pose(pose.place(cam.follower.arm_length))
        there = moved(shape, pose)
        assert turned.intersection(there).area < 1e-3
        assert turned.distance(there) < 1e-3


@pytest.mark.parametrize("name", ["flat, clockwise", "tilted, counterclockwise", "flat on arm, clockwise"])
def test_the_face_runs_beyond_the_contact_by_the_overhang(name):
    cam = CAMS[name]
    stock = replace(EVERYTHING, overhang=3)
    z = gk.flatten(cam_parts(cam, stock)[1].outline, 1e-4)
    face = z.imag.min() if "arm" not in name else -cam.follower.face_offset
    low, high = contact_travel(cam)
    on_face = z[np.abs(z.imag - face) < 1e-9].real
    # Of the overhang of 3 mm the last is the rounded corner.
    assert on_face.min() <= low - 2 + 1e-9 and on_face.max() >= high + 2 - 1e-9
    # No more than that where neither stem nor boss needs it.
    assert on_face.max() == pytest.approx(high + 2) or "tilted" in name
    assert z.real.max() == pytest.approx(high + 3) or "tilted" in name


@each_cam
def test_the_keyed_bore_is_a_circle_and_a_slot(cam):
    part = parts_of(cam)["cam"]
    (hole,) = part.holes
    towards = cam.profile.point(0.0) / abs(cam.profile.point(0.0))
    slot = shapely.box(0, -2, 6 + 1.8, 2)
    expected = shapely.union(shapely.Point(0, 0).buffer(6, quad_segs=4000), slot)
    expected = moved(expected, gk.plane.Pose(0, complex(towards)))
    assert polygon(hole).symmetric_difference(expected).area < 0.01
    assert polygon(part.outline).contains(polygon(hole))


@each_cam
def test_mark_points_to_the_first_contact_and_the_sense_of_rotation(cam):
    part = parts_of(cam)["cam"]
    line, arc, head = part.marks
    start, end = line.point(np.array([0.0, 1.0]))
    contact = cam.profile.point(0.0)
    assert np.angle(np.array([start, end]) / contact) == pytest.approx([0, 0], abs=1e-12)
    # Between bore and rim, so that it can be seen.
    assert (
        6 + 1.8
        < abs(start)
        < abs(end)
        < np.abs(part.outline.point(np.linspace(*part.outline.breaks[[0, -1]], 999))).min()
    )
    assert np.sign(np.angle(arc.point(1.0) / arc.point(0.0))) == cam.sense
    assert np.abs(np.asarray(head.vertices) - arc.point(1.0)).min() < 1e-12
    # The barbs lie behind the tip.
    assert (cam.sense * np.angle(np.asarray(head.vertices)[[0, 2]] / arc.point(1.0)) < 0).all()


def test_arms_have_their_holes_as_far_apart_as_the_arm_is_long():
    arm = parts_of(CAMS["roller on arm, clockwise"])["arm"]
    assert [(h.centre, h.radius) for h in arm.holes] == [(0, 2.5), (80, 2)]
    assert len(parts_of(gk.Cam(OscillatingRoller(0, 100, 80), SWINGS, 45))["arm"].holes) == 1


@pytest.mark.parametrize(("offset", "side"), [(-20, "above"), (-5, "below"), (0, "above"), (5, "below"), (20, "above")])
def test_arms_with_a_face_are_sound_wherever_the_face_lies(offset, side):
    cam = gk.Cam(OscillatingFlat(120, offset, side), SWINGS, 65)
    arm = parts_of(cam)["arm"]
    shape = polygon(arm.outline)
    assert shape.is_valid and shape.contains(shapely.Point(0, 0).buffer(4.99))
    assert shape.area > 10 * (contact_travel(cam)[1] - contact_travel(cam)[0])


def test_sizes_that_do_not_fit_are_refused_with_their_key():
    for cam, sizes, field, words in [
        ("roller", {"bore": 90}, "stock.bore", "less than"),
        ("roller", {"keyway_depth": 0}, "stock.keyway_depth", "neither"),
        ("roller", {"keyway_width": 0}, "stock.keyway_width", "neither"),
        ("roller", {"keyway_width": 12}, "stock.keyway_width", "narrower"),
        ("roller", {"keyway_depth": 39}, "stock.keyway_depth", "shallower"),
        ("roller", {"roller_bore": 20}, "stock.roller_bore", "less than 20"),
        ("flat", {"stem_length": 14}, "stock.stem_length", "more than 15"),
        ("flat", {"pivot_bore": 10}, "stock.pivot_bore", "less than 10"),
        ("roller on arm", {"roller_bore": 10}, "stock.roller_bore", "less than 10"),
        ("flat on arm", {"bar_width": 180}, "stock.bar_width", "narrower"),
        ("flat on arm", {"overhang": 500}, "stock.bar_width", "overhang"),
    ]:
        with pytest.raises(gk.DesignError, match=words) as caught:
            cam_parts(CAMS[f"{cam}, clockwise"], replace(EVERYTHING, **sizes))
        assert caught.value.field == field and caught.value.remedy


def test_a_key_without_a_bore_is_refused():
    cam = gk.Cam(TranslatingRoller(10), LIFTS, 40)
    with pytest.raises(gk.DesignError, match="keyway"):
        cam_parts(cam, CamStock(bore=0, keyway_width=4, keyway_depth=2))
    assert cam_parts(cam, CamStock(bore=0))[0].holes == ()


def test_a_rollers_arm_is_a_bar_of_the_width_asked_for_from_pivot_to_roller():
    arm = parts_of(CAMS["roller on arm, clockwise"], CamStock(bar_width=14))["arm"]
    left, low, right, high = polygon(arm.outline).bounds
    length = CAMS["roller on arm, clockwise"].follower.arm_length
    assert (left, low, right, high) == pytest.approx((-7, -7, length + 7, 7), abs=1e-3)
