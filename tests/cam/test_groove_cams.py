"""Groove cams: walls against the distance from the pitch curve, play against rollers between the plates as cut."""

import numpy as np
import pytest
import shapely

import geomkin as gk
from geomkin.core.errors import RecipeError
from tests.gallery import recipe

PROGRAM = [
    {"kind": "dwell", "end_deg": 60},
    {"kind": "rise", "law": "3-4-5", "rise": 20, "end_deg": 180},
    {"kind": "return", "law": "cycloidal", "end_deg": 360},
]
ROLLER = {"kind": "translating-roller", "roller_radius": 6, "offset": 4}
STRAIGHT = {"base_radius": 40, "follower": ROLLER, "program": PROGRAM}
STEM = {"bar_width": 10, "stem_length": 110}


def groove_cam(**more):
    cam = {**STRAIGHT, **more.pop("cam", {})}
    return gk.load({"kind": "groove-cam", "cam": cam, **more})


def polygon(part):
    def points(curve):
        z = gk.flatten(curve, 1e-3)
        return np.column_stack([z.real, z.imag])

    return shapely.Polygon(points(part.outline), [points(hole) for hole in part.holes])


def check(recipe, id):
    return next(check for check in recipe.checks if check.id == id)


@pytest.mark.parametrize("direction", ["counterclockwise", "clockwise"])
@pytest.mark.parametrize("is_arm", [False, True])
def test_a_roller_passes_the_plates_as_cut_and_meets_them_by_its_play(direction, is_arm):
    arm = {"kind": "oscillating-roller", "roller_radius": 6, "pivot_distance": 110, "arm_length": 95}
    lifts = [{k.replace("rise", "rise_deg"): v for k, v in s.items()} if "rise" in s else s for s in PROGRAM]
    turned = {"direction": direction, **({"follower": arm, "program": lifts} if is_arm else {})}
    own = groove_cam(cam=turned, groove={"clearance": 0.2}, drive={"step_deg": 5})
    parts = {part.name: polygon(part) for part in own.parts}
    material = shapely.union_all([parts["cam"], parts["ring"]])
    shapely.prepare(material)
    angle = np.radians(own.table["cam_angle"])
    contact = own.cam.contact(angle)
    centre = contact.point + 6 * contact.normal
    aside = np.cos(contact.pressure_angle)
    # The direction of the path, by a small change of the lift.
    pose = own.cam.follower.pose(own.cam.program.motion(angle).lift + 1e-6, own.cam.base_radius)
    moved = np.asarray(pose.place(95.0 if is_arm else 0.0)) - centre
    path = moved / np.abs(moved)
    for shift, meets in (
        (0.0, False),
        (0.096 / aside, False),
        (-0.096 / aside, False),
        (0.104 / aside, True),
        (-0.104 / aside, True),
    ):
        z = (centre + shift * path) * np.exp(-1j * own.cam.sense * angle)
        distance = shapely.distance(material, shapely.points(z.real, z.imag))
        assert ((distance < 6) == meets).all()
    assert own.table["play"] == pytest.approx(0.2 / aside, rel=0.02)
    assert check(own, "play").value == pytest.approx(own.table["play"].max(), rel=0.01)


def test_the_outer_wall_is_half_the_width_of_the_groove_from_the_pitch_curve():
    own = recipe("groove-cam")
    wall = own.made.outer_wall.point(np.linspace(0, 2 * np.pi, 60, endpoint=False))
    pitch = own.cam.pitch_curve.point(np.linspace(0, 2 * np.pi, 20001))
    assert np.abs(wall[:, None] - pitch).min(axis=1) == pytest.approx(8.05, abs=1e-5)
    assert (np.abs(wall) > 48).all()


SHARP = [
    {"kind": "polynomial", "rise": 20, "end_deg": 120, "start_velocity_per_rad": 0, "end_velocity_per_rad": 25},
    {"kind": "polynomial", "rise": 2, "end_deg": 130, "start_velocity_per_rad": 25, "end_velocity_per_rad": 0},
    {"kind": "return", "law": "cycloidal", "end_deg": 360},
]


def test_an_undercut_core_leaves_play_and_an_undercut_ring_is_refused():
    more = {"stock": {"bore": 0}, "groove": {"dowel": 0}}
    own = groove_cam(**more, cam={"base_radius": 8, "program": SHARP, "follower": {**ROLLER, "roller_radius": 30}})
    assert check(own, "play").value > 0.5 and check(own, "pitch_radius").value < 1
    assert all(polygon(part).is_valid for part in own.parts)
    program = [
        {"kind": "rise", "law": "cycloidal", "rise": 30, "end_deg": 60},
        {"kind": "return", "law": "cycloidal", "end_deg": 360},
    ]
    tight = {"base_radius": 18, "program": program, "follower": {**ROLLER, "roller_radius": 12}}
    with pytest.raises(RecipeError) as caught:
        groove_cam(cam=tight)
    (problem,) = caught.value.problems
    assert problem.key == "cam.follower.roller_radius"
    groove_cam(cam={**tight, "follower": {**ROLLER, "roller_radius": float(problem.value)}})


def test_the_force_on_the_roller_is_that_of_its_mass_and_changes_the_wall():
    loads = {"follower": {"mass_kg": 0.5}, "gravity_m_per_s2": [0, 0]}
    own = groove_cam(loads=loads, drive={"speed_rpm": 300}, stock={"material": "POM"})
    table, step = own.table, np.radians(1)
    time = step / own.drive.speed
    acceleration = np.gradient(np.gradient(table["lift"], time), time)[3:-3]
    force = 1e-3 * 0.5 * acceleration
    along = (table["contact_force"] * np.cos(np.radians(table["pressure_angle"])))[3:-3]
    assert along == pytest.approx(force, abs=0.05 * np.abs(force).max())
    torque = force * np.gradient(table["lift"], step)[3:-3]
    assert table["camshaft_torque"][3:-3] == pytest.approx(torque, abs=0.02 * np.abs(torque).max())
    assert "follower_contact" not in {check.id for check in own.checks}
    changes = own.notes["loads"]["wall_changes_at_deg"]
    rows = np.flatnonzero(np.diff(np.sign(np.where(np.abs(along) < 1e-9, 0, along)))) + 4
    assert len(changes) >= 2 and all(np.abs(rows - angle).min() <= 1 for angle in changes)
    # The ring is flatter to the roller than the core.
    ring = table["contact_force"] < -1
    assert (table["contact_pressure"][ring] > 0).all()


def test_a_stem_stands_beyond_the_disc_with_the_length_that_is_advised():
    with pytest.raises(RecipeError) as caught:
        groove_cam(base={}, stock={**STEM, "stem_length": 60}).parts
    value = caught.value.problems[0].value
    own = groove_cam(base={}, stock={**STEM, "stem_length": value})
    stem = next(part for part in own.parts if part.name == "follower")
    pins = [hole.centre for hole in stem.holes[1:]]
    pose = own.cam.follower_pose(np.radians(own.table["cam_angle"]))
    lowest = min(np.abs(np.asarray(pose.place(pin))).min() for pin in pins)
    assert lowest - 3 >= own.made.disc_radius


@pytest.mark.parametrize(
    "more, key",
    [
        ({"cam": {"follower": {"kind": "translating-flat"}}}, "cam.follower"),
        ({"cam": {"follower": {**ROLLER, "roller_radius": 0}}}, "cam.follower"),
        ({"groove": {"rim": 3}}, "groove.dowel"),
        ({"groove": {"clearance": 0}}, "groove.clearance"),
        (
            {
                "cam": {
                    "program": [
                        {"kind": "rise", "law": "uniform", "rise": 9, "end_deg": 180},
                        {"kind": "return", "law": "cycloidal", "end_deg": 360},
                    ]
                }
            },
            "cam.program",
        ),
    ],
)
def test_what_no_groove_has_is_refused_by_name(more, key):
    with pytest.raises(RecipeError) as caught:
        groove_cam(**more)
    assert [problem.key for problem in caught.value.problems] == [key]
