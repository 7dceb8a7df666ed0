"""All four followers by second roads: brute-force envelopes, 80 digits, a follower let down on the finished polygon."""

from decimal import Decimal, localcontext

import numpy as np
import pytest

import geomkin as gk
from geomkin.cam.followers.flat import OscillatingFlat, TranslatingFlat
from geomkin.cam.followers.roller import OscillatingRoller, TranslatingRoller
from geomkin.cam.measures import contact_travel

from .cams import CAMS, FOLLOWERS, LIFTS, SWINGS, depth, placed, programme, resting, rolls, seen_from_cam

each_cam = pytest.mark.parametrize("cam", CAMS, indirect=True)


@pytest.fixture
def cam(request):
    return CAMS[request.param]


DEGREES = np.radians(np.arange(0.5, 360, 4))


@each_cam
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
def test_each_position_of_the_follower_touches_the_profile_and_enters_it_nowhere(cam):
    angles = np.radians(np.arange(0, 360, 0.25))
    profile = cam.profile.point(angles)
    for k in range(0, len(angles), 48):
        inside = depth(cam, seen_from_cam(cam, angles[k : k + 1]), profile)
        assert abs(inside[k]) < 1e-12 * 65 and inside.max() < 1e-12 * 65


@each_cam
def test_the_contact_is_where_it_says_in_the_ground_and_on_the_cam(cam):
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
def test_no_follower_slips_into_the_cam_along_the_normal(cam):
    """The common normal of cam and follower: both surfaces move along it alike, whatever they do across it."""
    contact, h = cam.contact(DEGREES), 1e-6
    # Material points of both bodies that are at the contact now, a moment earlier and later.
    at_cam = contact.point * 1j * cam.sense
    before, after = (cam.follower_pose(DEGREES + step) for step in (-h, h))
    local = cam.follower_pose(DEGREES).locate(contact.point)
    at_follower = (after.place(local) - before.place(local)) / (2 * h)
    assert np.real(np.conj(contact.normal) * (at_cam - at_follower)) == pytest.approx(0, abs=1e-6)


@each_cam
def test_pressure_angle_is_between_the_normal_and_the_way_of_the_follower(cam):
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


@each_cam
def test_curves_keep_their_contract(cam):
    t, h = np.linspace(0.013, 6.27, 500), 1e-6
    t = t[np.abs(t[:, None] - cam.profile.breaks).min(axis=1) > 1e-4]
    for curve in (cam.profile, cam.pitch_curve) if rolls(cam) else (cam.profile,):
        slope = (curve.point(t + h) - curve.point(t - h)) / (2 * h)
        assert np.abs(slope - curve.velocity(t)).max() < 1e-6
        assert curve.curvature(t) == pytest.approx(gk.AbstractCurve.curvature(curve, t), rel=1e-6, abs=1e-9)
        assert curve.closed and abs(curve.point(0.0) - curve.point(2 * np.pi)) < 1e-12


@each_cam
@pytest.mark.parametrize("tolerance", [0.05, 0.005])
def test_a_follower_on_the_finished_polygon_gives_the_lift_back(cam, tolerance):
    """At every degree; along the follower's path a gap of the tolerance is longer by the pressure angle's cosine."""
    angles = np.radians(np.arange(360))
    lost = cam.program.motion(angles).lift - resting(cam, gk.flatten(cam.profile, tolerance), angles)
    pressure = gk.pressure_angle(cam, angles)
    if cam.follower.oscillates:
        pushed = placed(cam, cam.program.motion(angles).lift) if rolls(cam) else cam.contact(angles).point
        lost = lost * np.abs(pushed - cam.follower.pivot_distance)
    assert np.abs(lost * np.cos(pressure)).max() <= 1.01 * tolerance
    assert np.abs(lost).max() > 0.1 * tolerance


# 80 digits, of which differences of differences leave 20.
class Long:
    """Complex numbers of 80 digits, as far as the test below needs them."""

    def __init__(self, re, im=0):
        self.re, self.im = Decimal(re), Decimal(im)

    def __add__(self, other):
        return Long(self.re + other.re, self.im + other.im)

    def __sub__(self, other):
        return Long(self.re - other.re, self.im - other.im)

    def __mul__(self, other):
        return Long(self.re * other.re - self.im * other.im, self.re * other.im + self.im * other.re)

    def by(self, factor):
        return Long(self.re * factor, self.im * factor)

    def size(self):
        return (self.re**2 + self.im**2).sqrt()

    def cross(self, other):
        return self.re * other.im - self.im * other.re


def _turn(angle):
    """exp(i angle) by its series."""
    total, term, k = Long(1), Long(1), 0
    while term.size() > Decimal("1e-85"):
        k += 1
        term = term * Long(0, angle / k)
        total = total + term
    return total


def _long_placed(cam, t, start, span, rise):
    """As seen_from_cam, on a 3-4-5 rise, in 80 digits: the roller's centre, or (foot, normal) of the face."""
    f, base = cam.follower, Decimal(cam.base_radius)
    x = (t - start) / span
    lift = rise * x**3 * (10 + x * (6 * x - 15))
    back = _turn(-cam.sense * t)
    if isinstance(f, TranslatingRoller):
        height = ((base + Decimal(f.roller_radius)) ** 2 - Decimal(f.offset) ** 2).sqrt() + lift
        return Long(f.offset, height) * back
    if isinstance(f, TranslatingFlat):
        normal = Long(0, 1) * _turn(Decimal(f.tilt_deg) * _pi() / 180)
        return (normal.by(base) + Long(0, lift)) * back, normal * back
    c, side = Decimal(f.pivot_distance), 1 if f.side == "above" else -1
    turn = _turn(-side * lift)
    if isinstance(f, OscillatingRoller):
        prime = base + Decimal(f.roller_radius)
        along = (prime**2 - Decimal(f.arm_length) ** 2 + c**2) / (2 * c)
        return (Long(c) + (Long(along, side * (prime**2 - along**2).sqrt()) - Long(c)) * turn) * back
    cosine = (base - Decimal(f.face_offset)) / c
    normal = Long(cosine, side * (1 - cosine**2).sqrt()) * turn
    return (Long(c) + normal.by(Decimal(f.face_offset))) * back, normal * back


def _pi():
    """By Machin's formula."""

    def arctan_of_inverse(n):
        total, k, term = Decimal(0), 1, Decimal(1) / n
        while term > Decimal("1e-90"):
            total += term / k if k % 4 == 1 else -term / k
            term, k = term / n**2, k + 2
        return total

    return 16 * arctan_of_inverse(5) - 4 * arctan_of_inverse(239)


def _long_profile(cam, t, *law):
    """The envelope by its definition: on the follower, and standing still across its surface."""
    h = Decimal("1e-26")
    before, now, after = (_long_placed(cam, t + step, *law) for step in (-h, 0, h))
    if rolls(cam):
        velocity = (after - before).by(1 / (2 * h))
        outward = (velocity * Long(0, cam.sense)).by(1 / velocity.size())
        return now - outward.by(Decimal(cam.follower.roller_radius))
    (_, n0), (foot, n), (_, n1) = before, now, after
    p, rate = foot.re * n.re + foot.im * n.im, (n1 - n0).by(1 / (2 * h))
    p0, p1 = (f.re * m.re + f.im * m.im for f, m in (before, after))
    q, cross = (p1 - p0) / (2 * h), n.cross(rate)
    return Long((p * rate.im - q * n.im) / cross, (q * n.re - p * rate.re) / cross)


@each_cam
def test_curvature_agrees_with_fifty_digits(cam):
    with localcontext() as context:
        context.prec = 90
        degree = _pi() / 180
        rise = Decimal(14) * degree if cam.follower.oscillates else Decimal(20)
        for angle in (75, 100, 140, 168):
            h, t = Decimal("1e-12"), angle * degree
            before, now, after = (_long_profile(cam, t + k * h, 60 * degree, 120 * degree, rise) for k in (-1, 0, 1))
            velocity, bend = (after - before).by(1 / (2 * h)), (after - now - now + before).by(1 / h**2)
            expected = velocity.cross(bend) / velocity.size() ** 3
            # 24 digits are right: what is left is the angle, which differs by a rounding.
            assert cam.profile.curvature(np.radians(angle)) == pytest.approx(float(expected), rel=1e-12)
            assert abs(cam.profile.point(np.radians(angle)) - complex(now.re, now.im)) < 1e-13 * 65


def test_turning_the_other_way_with_everything_mirrored_gives_the_mirror_image():
    for follower, mirrored, program in [
        (TranslatingRoller(10, 12), TranslatingRoller(10, -12), LIFTS),
        (TranslatingFlat(15), TranslatingFlat(-15), LIFTS),
    ]:
        one, other = gk.Cam(follower, program, 65), gk.Cam(mirrored, program, 65, "clockwise")
        assert one.profile.point(DEGREES) == pytest.approx(-np.conj(other.profile.point(DEGREES)), abs=1e-12)
    for kind, sizes in [(OscillatingRoller, (10, 100, 80)), (OscillatingFlat, (110, 8))]:
        one, other = gk.Cam(kind(*sizes), SWINGS, 65), gk.Cam(kind(*sizes, "below"), SWINGS, 65, "clockwise")
        assert one.profile.point(DEGREES) == pytest.approx(np.conj(other.profile.point(DEGREES)), abs=1e-12)


def test_a_harmonic_lift_makes_a_circle_of_a_flat_faced_cam():
    """Lift 2 e up and down in half a turn each: a circle of radius base + e about a point e from the axis."""
    program = gk.Program([gk.Rise("harmonic", rise=16, end_deg=180), gk.Return("harmonic", end_deg=360)])
    cam = gk.Cam(TranslatingFlat(), program, 30)
    assert np.abs(cam.profile.point(DEGREES) + 8j) == pytest.approx(38, abs=1e-12)
    assert gk.plane.convexity(cam.profile, DEGREES) == pytest.approx(1 / 38, abs=1e-14)


def test_a_tilted_face_is_the_upright_one_with_less_lift():
    """A cam does not know which way the face is carried, only how far it is from the axis."""
    tilted = gk.Cam(TranslatingFlat(40), programme(20 / np.cos(np.radians(40))), 65)
    upright = gk.Cam(TranslatingFlat(), programme(20), 65)
    turned = tilted.profile.point(DEGREES) * np.exp(-1j * np.radians(40))
    assert turned == pytest.approx(upright.profile.point(DEGREES), abs=1e-12)


def test_a_roller_on_a_very_long_arm_is_one_on_a_straight_line():
    """A pivot as far off as possible; above the axis the arm's end moves along y."""
    length = 1e6
    swings = programme(np.degrees(20 / length), swings=True)
    arm = gk.Cam(OscillatingRoller(10, np.hypot(length, 55), length), swings, 45)
    line = gk.Cam(TranslatingRoller(10), LIFTS, 45)
    # Arm and prime radius are square at lift 0: the pivot, which lies on the x axis, is a little above the roller.
    turned = arm.profile.point(DEGREES) * np.exp(1j * np.arctan2(55, length))
    assert np.abs(turned - line.profile.point(DEGREES)).max() < 1e-3


def test_width_of_the_face_is_what_the_contact_travels():
    """Worked case: base 40, 20 mm by 3-4-5 in 120 deg, cycloidal return in 150: 33.183806 mm."""
    low, high = contact_travel(gk.Cam(TranslatingFlat(), LIFTS, 40))
    assert high - low == pytest.approx(33.183806, abs=5e-7)
    # sgn s' to the right: the peaks of the two laws' velocities.
    assert (low, high) == pytest.approx((-2 * 20 / np.radians(150), 1.875 * 20 / np.radians(120)), rel=1e-12)


@pytest.mark.parametrize("name", ["tilted", "flat on arm", "flat on arm below"])
def test_contact_travel_covers_every_contact(name):
    follower, program = FOLLOWERS[name]
    cam = gk.Cam(follower, program, 65)
    angles = np.linspace(0, 2 * np.pi, 20001)
    along = cam.follower_pose(angles).locate(cam.contact(angles).point).real
    assert contact_travel(cam) == pytest.approx((along.min(), along.max()), abs=1e-5)
    assert along.min() - contact_travel(cam)[0] > -1e-12 and contact_travel(cam)[1] - along.max() > -1e-12
    with pytest.raises(gk.DesignError, match="no face"):
        contact_travel(gk.Cam(TranslatingRoller(5), LIFTS, 40))


def test_a_flat_face_has_no_pitch_curve():
    with pytest.raises(gk.DesignError, match="pitch curve"):
        gk.Cam(TranslatingFlat(), LIFTS, 40).pitch_curve


@pytest.mark.parametrize(
    ("follower", "program", "base", "field", "words"),
    [
        (TranslatingRoller(10, 50), LIFTS, 40, "follower.offset", "below 50"),
        (TranslatingRoller(10), SWINGS, 40, "program", "degrees"),
        (TranslatingFlat(), SWINGS, 40, "program", "degrees"),
        (OscillatingRoller(10, 100, 80), LIFTS, 40, "program", "mm"),
        (OscillatingFlat(100), LIFTS, 40, "program", "mm"),
        (OscillatingRoller(10, 100, 30), SWINGS, 40, "follower.arm_length", "above 60"),
        (OscillatingRoller(10, 40, 120), SWINGS, 40, "follower.arm_length", "above 70"),
        (OscillatingRoller(10, 40, 10), SWINGS, 40, "follower.arm_length", "below 39"),
        (OscillatingFlat(60, 10), SWINGS, 70, "follower.pivot_distance", "below 68"),
        (OscillatingFlat(60, 110), SWINGS, 40, "follower.pivot_distance", "above 50"),
        (OscillatingFlat(200), programme(40, True, (10, 20, 40, 360)), 40, "program", "turns with the cam"),
    ],
)
def test_what_cannot_ride_is_refused_with_the_field(follower, program, base, field, words):
    with pytest.raises(gk.DesignError, match=words) as caught:
        gk.Cam(follower, program, base, "clockwise")
    assert caught.value.field == field and caught.value.remedy


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
