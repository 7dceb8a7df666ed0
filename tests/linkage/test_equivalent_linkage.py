"""Equivalent linkages against cams whose follower is known exactly, and against contacts found by search."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.linkage.instant.curvature import DirectContact
from geomkin.linkage.named_linkages import SliderCrank

PROGRAM = gk.Program(
    (gk.Dwell(end_deg=60), gk.Rise("cycloidal", rise=20, end_deg=180), gk.Return("3-4-5", end_deg=360))
)
ANGLES = np.radians(np.arange(1.3, 360, 4.0))


@pytest.mark.parametrize("direction", ["counterclockwise", "clockwise"])
@pytest.mark.parametrize(("offset", "rolled"), [(0.0, 10.0), (12.0, 0.0)])
def test_a_roller_on_a_cam_moves_as_its_programme_says(direction, offset, rolled):
    """The roller counted as part of the cam (its centre, the pitch curve) or as a follower's surface of its own."""
    cam = gk.Cam(gk.TranslatingRoller(10, offset), PROGRAM, 40, direction)
    sense = 1 if direction == "counterclockwise" else -1
    seen = np.exp(1j * sense * ANGLES)  # from the cam to the ground
    along = cam.pitch_curve.velocity(ANGLES) * seen
    # The pitch curve runs against the cam's turning, so outward is to its left or right.
    normal = 1j * sense * along / np.abs(along)
    radius = -sense / cam.pitch_curve.curvature(ANGLES)
    centre = cam.pitch_curve.point(ANGLES) * seen
    contact = DirectContact(centre - rolled * normal, normal, radius - rolled, rolled, follower_direction=1j)
    lift = PROGRAM.motion(ANGLES)
    assert np.abs(sense * contact.first - lift.velocity).max() < 1e-9
    assert np.abs(contact.second - lift.acceleration).max() < 1e-9
    assert np.abs(contact.driver_centre - (centre - radius * normal)).max() < 1e-9


def test_an_eccentric_disc_is_a_slider_crank_or_a_four_bar():
    """Disc of radius 40 about a centre 15 off its axis, roller of radius 10: crank 15, coupler 50."""
    centre = 15 * np.exp(1j * ANGLES)
    sliding = gk.move(SliderCrank(15, 50, 8), ANGLES)
    at = sliding.point("slider_pin")
    normal = (at.position - centre) / 50
    contact = DirectContact(centre + 40 * normal, normal, 40, 10, follower_direction=3)
    assert np.abs(contact.first - at.first.real).max() < 1e-12 * 50
    assert np.abs(contact.second - at.second.real).max() < 1e-12 * 50

    turning = gk.move(gk.FourBar(90, 15, 50, 70), ANGLES)
    at = turning.point("rocker_pin")
    normal = (at.position - centre) / 50
    contact = DirectContact(centre + 40 * normal, normal, 40, 10, follower_pivot=90)
    assert np.abs(contact.first - turning.rocker.first).max() < 1e-13
    assert np.abs(contact.second - turning.rocker.second).max() < 1e-13


def ellipse(angle, a=50.0, b=30.0):
    """Of an ellipse, by the direction of its normal: support function and its first two derivatives."""
    h = np.sqrt((a * np.cos(angle)) ** 2 + (b * np.sin(angle)) ** 2)
    slope = (b**2 - a**2) * np.sin(2 * angle) / (2 * h)
    return h, slope, (b**2 - a**2) * np.cos(2 * angle) / h - slope**2 / h


def test_a_flat_face_rises_by_the_support_function():
    """A sliding flat face on an ellipse that turns about its middle stands at the support function's height."""
    h, slope, bend = ellipse(np.pi / 2 - ANGLES)
    contact = DirectContact(1j * (h + 1j * slope), 1j, h + bend, np.inf, follower_direction=1j)
    assert np.abs(contact.first + slope).max() < 1e-12 * 50
    assert np.abs(contact.second - bend).max() < 1e-11 * 50
    assert not np.isfinite(contact.follower_centre).any() and np.isfinite(contact.driver_centre).all()


def derivatives(f, q, step):
    """First and second derivative by central differences of order 8."""
    y = np.array([f(q + k * step) for k in range(-4, 5)])
    one = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])
    two = np.array([-1 / 560, 8 / 315, -1 / 5, 8 / 5, -205 / 72, 8 / 5, -1 / 5, 8 / 315, -1 / 560])
    return np.tensordot(one, y, 1) / step, np.tensordot(two, y, 1) / step**2


def face_angle(q, pivot, off):
    """Direction of a face that turns about a pivot, `off` from it, and lies on the turning ellipse: by bisection."""

    def gap(psi):
        normal = psi + np.pi / 2  # from the ellipse into the face
        return np.cos(normal) * pivot + off - ellipse(normal - q)[0]

    low, high = np.full(np.shape(q), np.pi), np.full(np.shape(q), 1.5 * np.pi)
    for _ in range(60):
        middle = (low + high) / 2
        low, high = np.where(gap(middle) < 0, middle, low), np.where(gap(middle) < 0, high, middle)
    return middle


@pytest.mark.parametrize("off", [0.0, 6.0])
def test_a_turning_flat_face_found_by_bisection(off):
    pivot = 120.0
    psi = face_angle(ANGLES, pivot, off)
    normal = 1j * np.exp(1j * psi)  # from the ellipse into the face
    h, slope, bend = ellipse(np.angle(normal) - ANGLES)
    contact = DirectContact(normal * (h + 1j * slope), normal, h + bend, np.inf, follower_pivot=pivot)
    first, second = derivatives(lambda q: face_angle(q, pivot, off), ANGLES, 0.01)
    assert np.abs(np.real(np.conj(normal) * (contact.point - pivot)) - off).max() < 1e-9
    assert np.abs(contact.first - first).max() < 1e-9
    assert np.abs(contact.second - second).max() < 1e-7


def test_a_straight_flank_lifts_a_roller():
    """A line through the driver's pivot under a roller of 12 mm on the line x = 70, and on an arm."""
    q = np.linspace(-0.6, 0.9, 31)
    height = 70 * np.tan(q) + 12 / np.cos(q)
    normal = 1j * np.exp(1j * q)
    contact = DirectContact(70 + 1j * height - 12 * normal, normal, np.inf, 12, follower_direction=1j)
    sec, tan = 1 / np.cos(q), np.tan(q)
    assert contact.first == pytest.approx(70 * sec**2 + 12 * sec * tan)
    assert contact.second == pytest.approx(140 * sec**2 * tan + 12 * sec * tan**2 + 12 * sec**3)

    def arm(t):
        """Angle of an arm of 50 mm about 80 whose roller lies on the line: its centre 12 above the line."""
        return t + np.pi - np.arcsin((12 + 80 * np.sin(t)) / 50)

    q = np.linspace(-0.5, 0.2, 31)
    roller, normal = 80 + 50 * np.exp(1j * arm(q)), 1j * np.exp(1j * q)
    contact = DirectContact(roller - 12 * normal, normal, np.inf, 12, follower_pivot=80)
    first, second = derivatives(arm, q, 0.01)
    assert contact.first == pytest.approx(first, abs=1e-9) and contact.second == pytest.approx(second, abs=1e-7)
    # The roller's middle moves along the line, and its surface turns about that; left of the normal is backwards.
    on_line = derivatives(lambda t: np.real(np.exp(-1j * t) * (80 + 50 * np.exp(1j * arm(t)))), q, 0.01)[0]
    assert contact.sliding == pytest.approx(-on_line - 12 * (first - 1), abs=1e-8)


CASES = {
    "four-bar": {"driver_radius": 40.0, "follower_radius": 15.0, "follower_pivot": 95 - 12j},
    "four-bar, hollow follower": {"driver_radius": 40.0, "follower_radius": -90.0, "follower_pivot": 95 - 12j},
    "slider-crank": {"driver_radius": 40.0, "follower_radius": 15.0, "follower_direction": -1 + 2j},
    "slider-crank the other way": {"driver_radius": 40.0, "follower_radius": 15.0, "follower_direction": 1 - 2j},
    "slider on the follower": {"driver_radius": 40.0, "follower_radius": np.inf, "follower_pivot": 95 - 12j},
    "Scotch yoke": {"driver_radius": 40.0, "follower_radius": np.inf, "follower_direction": -1 + 2j},
    "slider on the driver": {"driver_radius": np.inf, "follower_radius": 15.0, "follower_pivot": 95 - 12j},
    "double slider": {"driver_radius": np.inf, "follower_radius": 15.0, "follower_direction": -1 + 2j},
}


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("point", [20 - 50j])
@pytest.mark.parametrize("normal", [1 + 2j, -3 + 0.4j])
def test_equivalent_linkage_moves_as_the_contact(case, point, normal):
    contact = DirectContact(point, normal, driver_pivot=3 + 1j, **CASES[case])
    motion = gk.move(contact.linkage, [0.0], contact.branch)
    follower = motion.follower
    if contact.follower_direction is None:
        found = follower.first[0], follower.second[0]
        assert follower.direction[0] == pytest.approx(1)
    else:
        slide = motion.slide("guide")
        found = slide.velocity[0], slide.acceleration[0]
        assert slide.displacement[0] == pytest.approx(0, abs=1e-10)
    assert found == pytest.approx((contact.first, contact.second))
    for name, centre in (("driver_centre", contact.driver_centre), ("follower_centre", contact.follower_centre)):
        if np.isfinite(centre):
            assert motion.point(name).position[0] == pytest.approx(complex(centre))


def test_a_follower_that_cannot_give_way_has_no_finite_velocity():
    contact = DirectContact(10j, 1, 20.0, 5.0, follower_direction=1j)
    with np.errstate(all="raise"):
        assert not np.isfinite(contact.first) and not np.isfinite(contact.second)


@pytest.mark.parametrize(
    ("field", "change"),
    [
        ("follower_pivot", {"follower_direction": 1j}),
        ("follower_pivot", {"follower_pivot": None}),
        ("follower_radius", {"driver_radius": np.inf, "follower_radius": np.array([1.0, np.inf])}),
    ],
)
def test_invalid_contacts_are_refused(field, change):
    given = {"point": 10j, "normal": 1j, "driver_radius": 5, "follower_radius": 5, "follower_pivot": 50} | change
    with pytest.raises(gk.DesignError) as caught:
        DirectContact(**given)
    assert caught.value.field == field
