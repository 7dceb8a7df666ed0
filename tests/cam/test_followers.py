"""All four followers by second roads: brute-force envelopes, 80 digits, a follower let down on the finished polygon."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.cam.checks import contact_travel
from geomkin.cam.followers.flat import OscillatingFlat, TranslatingFlat
from geomkin.cam.followers.roller import OscillatingRoller, TranslatingRoller
from tests.campaign import by_default

from .cams import CAMS, LIFTS, SWINGS, depth, placed, programme, rolls, seen_from_cam

each_cam = pytest.mark.parametrize("cam", CAMS, indirect=True)


@pytest.fixture
def cam(request):
    return CAMS[request.param]


DEGREES = np.radians(np.arange(0.5, 360, 4))


@pytest.mark.parametrize("cam", by_default(CAMS, slice(0, None, 3)), indirect=True)
def test_profile_is_the_envelope_of_the_moving_follower(cam):
    """Along a ray from the axis the cam ends where the first follower position begins, tried all the way round."""
    points = cam.profile.point(DEGREES)
    if rolls(cam) and cam.follower.roller_radius == 0:
        assert np.abs(points - seen_from_cam(cam, DEGREES)).max() < 1e-12
        return
    ray, low, high = points / np.abs(points), np.zeros(len(points)), np.full(len(points), 2 * np.pi)
    for count in (4001, *[33] * 8):
        tried = low[:, None] + (high - low)[:, None] * np.linspace(0, 1, count)
        hits = _first_hit(cam, seen_from_cam(cam, tried), ray[:, None])
        best = hits.argmin(axis=1)[:, None]
        low = np.take_along_axis(tried, np.maximum(best - 1, 0), 1)[:, 0]
        high = np.take_along_axis(tried, np.minimum(best + 1, count - 1), 1)[:, 0]
    assert np.abs(hits.min(axis=1) - np.abs(points)).max() < 1e-12 * np.abs(points).max()


def _first_hit(cam, where, ray):
    """Distance from the axis at which rays meet the follower, infinite where they miss it."""
    if rolls(cam):
        along, aside = np.real(np.conj(ray) * where), np.imag(np.conj(ray) * where)
        room = cam.follower.roller_radius**2 - aside**2
        return np.where((room > 0) & (along > 0), along - np.sqrt(np.maximum(room, 0)), np.inf)
    foot, normal = where
    facing = np.real(np.conj(normal) * ray)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(facing > 0, np.real(np.conj(normal) * foot) / facing, np.inf)


@each_cam
def test_contact_point(cam):
    contact, pose = cam.contact(DEGREES), cam.follower_pose(DEGREES)
    on_cam = contact.point * np.exp(-1j * cam.sense * DEGREES)
    assert np.abs(on_cam - cam.profile.point(DEGREES)).max() < 1e-12
    local = pose.locate(contact.point)
    follower = cam.follower
    if rolls(cam):
        centre = 0 if isinstance(follower, TranslatingRoller) else follower.arm_length
        assert np.abs(pose.place(centre) - placed(cam, cam.program.motion(DEGREES).lift)).max() < 1e-12
        assert np.abs(local - centre) == pytest.approx(follower.roller_radius, abs=1e-12)
    else:
        # On the face, which lies still in the follower's own frame.
        offset = getattr(follower, "face_offset", 0) * (-1 if getattr(follower, "side", "above") == "above" else 1)
        assert local.imag == pytest.approx(offset, abs=1e-11)
        foot, normal = placed(cam, cam.program.motion(DEGREES).lift)
        assert depth(cam, (foot, normal), contact.point) == pytest.approx(0, abs=1e-11)
    assert np.abs(np.abs(contact.normal) - 1).max() < 1e-14


@each_cam
def test_normal_velocities_of_cam_and_follower_agree(cam):
    """The common normal of cam and follower: both surfaces move along it alike, whatever they do across it."""
    contact, h = cam.contact(DEGREES), 1e-6
    # Material points of both bodies that are at the contact now, a moment earlier and later.
    at_cam = contact.point * 1j * cam.sense
    before, after = (cam.follower_pose(DEGREES + step) for step in (-h, h))
    local = cam.follower_pose(DEGREES).locate(contact.point)
    at_follower = (after.place(local) - before.place(local)) / (2 * h)
    assert np.real(np.conj(contact.normal) * (at_cam - at_follower)) == pytest.approx(0, abs=1e-6)


@each_cam
def test_pressure_angle_is_between_normal_and_follower_velocity(cam):
    contact, h = cam.contact(DEGREES), 1e-6
    local, lift = cam.follower_pose(DEGREES).locate(contact.point), cam.program.motion(DEGREES).lift
    way = cam.follower.pose(lift + h, cam.base_radius).place(local)
    way = way - cam.follower.pose(lift - h, cam.base_radius).place(local)
    if isinstance(cam.follower, OscillatingRoller):
        # The roller turns on its pin: what the arm is pushed by is the way of the pin.
        way = placed(cam, lift + h) - placed(cam, lift - h)
    leaning = np.angle(contact.normal / way)
    assert np.abs(gk.pressure_angle(cam, DEGREES)) == pytest.approx(np.abs(leaning), abs=1e-8)
    assert np.abs(leaning).max() < np.pi / 2
    if not cam.follower.oscillates:
        # Positive where the force leans the way the cam runs there, which is to the left for a counterclockwise one.
        is_twisted = -np.sign(contact.normal.real) * cam.sense
    else:
        # Positive where the force pulls the arm away from its pivot.
        arm = (placed(cam, lift) if rolls(cam) else contact.point) - cam.follower.pivot_distance
        is_twisted = np.sign(np.real(np.conj(arm) * contact.normal))
    seen = np.abs(leaning) > 1e-9
    assert (np.sign(gk.pressure_angle(cam, DEGREES)) == is_twisted)[seen].all()


def test_a_harmonic_lift_makes_a_circle_of_a_flat_faced_cam():
    """Lift 2 e up and down in half a turn each: a circle of radius base + e about a point e from the axis."""
    program = gk.Program([gk.Rise("harmonic", rise=16, end_deg=180), gk.Return("harmonic", end_deg=360)])
    cam = gk.Cam(TranslatingFlat(), program, 30)
    assert np.abs(cam.profile.point(DEGREES) + 8j) == pytest.approx(38, abs=1e-12)
    assert gk.plane.convexity(cam.profile, DEGREES) == pytest.approx(1 / 38, abs=1e-14)


def test_contact_travel_of_the_published_cam():
    """Worked case: base 40, 20 mm by 3-4-5 in 120 deg, cycloidal return in 150: 33.183806 mm."""
    low, high = contact_travel(gk.Cam(TranslatingFlat(), LIFTS, 40))
    assert high - low == pytest.approx(33.183806, abs=5e-7)
    # sgn s' to the right: the peaks of the two laws' velocities.
    assert (low, high) == pytest.approx((-2 * 20 / np.radians(150), 1.875 * 20 / np.radians(120)), rel=1e-12)


def test_a_flat_face_has_no_pitch_curve():
    for call in (lambda cam: cam.pitch_curve, lambda cam: contact_travel(gk.Cam(TranslatingRoller(5), LIFTS, 40))):
        with pytest.raises(gk.DesignError):
            call(gk.Cam(TranslatingFlat(), LIFTS, 40))


@pytest.mark.parametrize(
    ("follower", "program", "base", "field"),
    [
        (TranslatingRoller(10, 50), LIFTS, 40, "follower.offset"),
        (TranslatingRoller(10), SWINGS, 40, "program"),
        (OscillatingFlat(100), LIFTS, 40, "program"),
        (OscillatingRoller(10, 100, 30), SWINGS, 40, "follower.arm_length"),
        (OscillatingRoller(10, 40, 120), SWINGS, 40, "follower.arm_length"),
        (OscillatingRoller(10, 40, 10), SWINGS, 40, "follower.arm_length"),
        (OscillatingFlat(60, 10), SWINGS, 70, "follower.pivot_distance"),
        (OscillatingFlat(60, 110), SWINGS, 40, "follower.pivot_distance"),
        (OscillatingFlat(200), programme(40, True, (10, 20, 40, 360)), 40, "program"),
    ],
)
def test_impossible_cams_are_refused(follower, program, base, field):
    with pytest.raises(gk.DesignError) as caught:
        gk.Cam(follower, program, base, "clockwise")
    assert caught.value.field == field and caught.value.remedy


@pytest.mark.parametrize(
    ("follower", "low", "high"),
    [
        (gk.OscillatingRoller(10, 100, 80), 10.0, 168.0),
        (gk.OscillatingRoller(5, 60, 100, "below"), 35.0, 153.0),
        (gk.OscillatingFlat(60, 110), 50.0, 168.0),
        (gk.OscillatingFlat(90, -8, "below"), 0.0, 79.0),
    ],
)
def test_range_of_base_radii_of_an_arm(follower, low, high):
    """Low: the pivot's distance less the arm; high: a little less than all of it in line, or square."""
    least, most = follower.base_radius_range(np.radians(14))
    assert least == pytest.approx(low) and high < most < high + 1
    for base in (least * (1 + 1e-6) + 1e-6, most * (1 - 1e-6)):
        place = gk.Cam(follower, SWINGS, base).follower_pose(np.linspace(0, 2 * np.pi, 99))
        assert np.isfinite(place.direction).all()
    for base in [most, most * (1 + 1e-6), *([least] if least else [])]:
        with pytest.raises(gk.DesignError):
            gk.Cam(follower, SWINGS, base)


@pytest.mark.parametrize(
    ("kind", "sizes", "field"),
    [
        (TranslatingRoller, {"roller_radius": -1}, "roller_radius"),
        (TranslatingFlat, {"tilt_deg": 90}, "tilt_deg"),
        (OscillatingRoller, {"roller_radius": 5, "pivot_distance": 0, "arm_length": 5}, "pivot_distance"),
        (OscillatingRoller, {"roller_radius": 5, "pivot_distance": 50, "arm_length": 5, "side": "left"}, "side"),
        (OscillatingFlat, {"pivot_distance": np.nan}, "pivot_distance"),
        (OscillatingFlat, {"pivot_distance": 50, "side": "up"}, "side"),
    ],
)
def test_sizes_out_of_range_are_refused(kind, sizes, field):
    with pytest.raises(gk.DesignError) as caught:
        kind(**sizes)
    assert caught.value.field == field
