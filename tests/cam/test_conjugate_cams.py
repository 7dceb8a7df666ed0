"""Conjugate cams: rollers of the follower as cut between both cams as cut, and statics about the pivot."""

import numpy as np
import pytest
import shapely

import geomkin as gk
from geomkin.core.errors import RecipeError
from tests.cam.test_groove_cams import PROGRAM, ROLLER, check, polygon

ARM = {"kind": "oscillating-roller", "roller_radius": 6, "pivot_distance": 110, "arm_length": 95}
LIFTS = [{k.replace("rise", "rise_deg"): v for k, v in s.items()} if "rise" in s else s for s in PROGRAM]
SWUNG = {"base_radius": 40, "follower": ARM, "program": LIFTS}
STRAIGHT = {"base_radius": 40, "follower": ROLLER, "program": PROGRAM}
YOKE = {"bar_width": 12, "stem_length": 120}


def conjugate(cam, **more):
    return gk.load({"kind": "conjugate-cams", "cam": cam, **more})


@pytest.mark.parametrize("direction", ["counterclockwise", "clockwise"])
@pytest.mark.parametrize(
    "cam, second",
    [
        (SWUNG, {}),
        ({**SWUNG, "follower": {**ARM, "side": "below"}}, {"base_radius": 30, "arm_length": 85}),
        (STRAIGHT, {}),
        ({**STRAIGHT, "follower": {**ROLLER, "offset": -4}}, {"base_radius": 30}),
    ],
)
def test_rollers_pass_both_cams_as_cut_and_meet_them_by_the_play(cam, second, direction):
    own = conjugate({**cam, "direction": direction}, second={"clearance": 0.2, **second}, drive={"step_deg": 10})
    parts = {part.name: part for part in own.parts}
    cams = [polygon(parts[name]) for name in ("cam", "second")]
    bar = parts.get("arm") or parts["follower"]
    pins = [hole.centre for hole in bar.holes if getattr(hole, "radius", 0) == pytest.approx(2)]
    angle = np.radians(own.table["cam_angle"])
    reach = 95 if "arm" in parts else 1.0

    def rooms(shift):
        pose = own.cam.follower.pose(own.cam.program.motion(angle).lift + shift / reach, own.cam.base_radius)
        places = [np.asarray(pose.place(pin)) * np.exp(-1j * own.cam.sense * angle) for pin in pins]
        return [shapely.distance(cut, shapely.points(z.real, z.imag)) - 6 for cut, z in zip(cams, places, strict=True)]

    aligned = [room for shift in (0.0, 0.09, -0.09) for room in rooms(shift)]
    assert min(room.min() for room in aligned) > 0
    # Towards the axis the first cam stops it, away from the axis the second one does.
    assert (rooms(-0.2)[0] < 0).all() and (rooms(0.2)[1] < 0).all()
    assert all((room > 0).all() for room in (rooms(-0.2)[1], rooms(0.2)[0]))
    aside = np.cos(np.radians(own.table["pressure_angle"])), np.cos(np.radians(own.table["second_pressure_angle"]))
    longer = 95 / second.get("arm_length", 95) if "arm" in parts else 1.0
    assert own.table["play"] == pytest.approx(0.1 / aside[0] + 0.1 * longer / aside[1], rel=0.02)


def test_the_second_cam_carries_the_arm_where_its_mass_pulls_it_off_the_first():
    loads = {"follower": {"mass_kg": 0.3, "centre": [70, 0]}, "gravity_m_per_s2": [0, 0]}
    own = conjugate(SWUNG, loads=loads, drive={"speed_rpm": 300}, stock={"material": "POM"})
    table, made = own.table, own.made
    angle = np.radians(table["cam_angle"])
    time = np.radians(1) / own.drive.speed
    swing = np.radians(table["lift"])
    torque = 1e-3 * 0.3 * 70**2 * np.gradient(np.gradient(swing, time), time)
    # Moments of both contacts about the pivot, positive away from the axis; the arm above turns clockwise for that.
    moments = []
    for cam in (made.cam, made.other):
        contact = cam.contact(angle)
        moments.append(-(np.conj(contact.point - 110) * contact.normal).imag)
    force = table["contact_force"]
    moment = np.where(force < 0, np.abs(force) * moments[1], force * moments[0])
    assert moment[3:-3] == pytest.approx(torque[3:-3], abs=0.05 * np.abs(torque).max())
    assert (force < -1).any() and (table["contact_pressure"][np.abs(force) > 1] > 0).all()
    power = torque * np.gradient(swing, np.radians(1))
    assert table["camshaft_torque"][3:-3] == pytest.approx(power[3:-3], abs=0.05 * np.abs(power).max())
    assert len(own.notes["loads"]["wall_changes_at_deg"]) >= 2


def test_a_yoke_has_room_for_the_shaft_and_its_pins_stand_beyond_the_first_cam():
    own = conjugate(STRAIGHT, base={}, stock=YOKE)
    yoke = polygon(next(part for part in own.parts if part.name == "follower"))
    pose = own.cam.follower_pose(np.radians(own.table["cam_angle"]))
    axis = np.asarray(pose.locate(0j))
    assert shapely.distance(yoke, shapely.points(axis.real, axis.imag)).min() >= 8
    with pytest.raises(RecipeError) as caught:
        conjugate(STRAIGHT, base={}, stock={**YOKE, "stem_length": 40})
    (problem,) = caught.value.problems
    assert problem.key == "stock.stem_length"
    conjugate(STRAIGHT, base={}, stock={**YOKE, "stem_length": problem.value})


def test_plates_of_arm_and_yoke_are_simple_and_both_cams_share_their_bore():
    for cam, stock in ((SWUNG, {"bore_form": "D"}), (STRAIGHT, {**YOKE, "bore_form": "D"})):
        own = conjugate(cam, base={}, stock=stock)
        assert all(polygon(part).is_valid for part in own.parts)
        first, second = (next(part for part in own.parts if part.name == name) for name in ("cam", "second"))
        z = [gk.flatten(part.holes[0], 1e-3) for part in (first, second)]
        assert z[0] == pytest.approx(z[1], abs=1e-9)
        assert check(own, "play").passed and check(own, "least_play").passed


@pytest.mark.parametrize(
    "cam, more, key",
    [
        ({**SWUNG, "follower": {**ARM, "pivot_distance": 50, "arm_length": 50}}, {}, "cam.follower.pivot_distance"),
        (STRAIGHT, {"second": {"arm_length": 80}}, "second.arm_length"),
        (SWUNG, {"second": {"base_radius": 300}}, "second.base_radius"),
        ({**STRAIGHT, "follower": {"kind": "translating-flat"}}, {}, "cam.follower"),
        (
            STRAIGHT,
            {"loads": {"follower": {"mass_kg": 1}, "friction": {"coefficient": 0.1, "length": 90, "overhang": 40}}},
            "loads.friction",
        ),
    ],
)
def test_what_conjugate_cams_cannot_have_is_refused_by_name(cam, more, key):
    with pytest.raises(RecipeError) as caught:
        conjugate(cam, **more)
    assert [problem.key for problem in caught.value.problems] == [key]
