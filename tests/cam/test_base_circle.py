"""Pressure angles, tightest places and least base circles, by sampling, by other formulas and by published numbers."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.cam import base_circle
from geomkin.cam.base_circle import least_base_circle
from geomkin.cam.checks import segment_limits, tightest_convex
from geomkin.cam.followers.flat import OscillatingFlat, TranslatingFlat
from geomkin.cam.followers.roller import OscillatingRoller, TranslatingRoller
from geomkin.cam.program.laws import samples
from geomkin.cam.undercut import undercut
from tests.campaign import by_default

from .cams import CAMS, LIFTS, SWINGS, programme

HARMONIC = gk.Program([gk.Rise("harmonic", rise=2, end_deg=180), gk.Return("harmonic", end_deg=360)])


@pytest.fixture
def cam(request):
    return CAMS[request.param]


def test_harmonic_lift_equal_to_the_prime_radius_has_the_limits_of_the_worked_case():
    """alpha_max = asin(1/3) at 70.5288 deg; pitch radius 4 at 0, 3.2 at 180, least 2 sqrt 2."""
    cam = gk.Cam(TranslatingRoller(0.5), HARMONIC, 1.5)
    limits = segment_limits(cam)
    assert limits.pressure_angle == pytest.approx([np.arcsin(1 / 3), -np.arcsin(1 / 3)], rel=1e-14)
    assert np.degrees(limits.pressure_angle_at) == pytest.approx([70.5288, 360 - 70.5288], abs=5e-5)
    assert limits.convex_radius == pytest.approx(2 * np.sqrt(2) - 0.5, rel=1e-14)
    assert tightest_convex(cam)[0] == pytest.approx(2 * np.sqrt(2), rel=1e-14)


@pytest.mark.parametrize("cam", list(CAMS)[::2], indirect=True)
def test_the_worst_of_each_segment_is_worse_than_any_sample_and_hardly(cam):
    limits, breaks = segment_limits(cam), cam.program.breaks
    for k in range(len(breaks) - 1):
        inside = np.linspace(breaks[k], np.nextafter(breaks[k + 1], 0), 20001)
        leaning = np.abs(gk.pressure_angle(cam, inside)).max()
        convex = (-cam.sense * cam.profile.curvature(inside)).max()
        assert leaning <= abs(limits.pressure_angle[k]) * (1 + 1e-14) <= leaning * (1 + 1e-6)
        assert convex * (1 - 1e-14) <= (1 / limits.convex_radius[k] if np.isfinite(limits.convex_radius[k]) else 0)
        assert convex <= 0 or 1 / limits.convex_radius[k] < convex * (1 + 1e-6) + 1e-12
        at = limits.pressure_angle_at[k], limits.convex_radius_at[k]
        assert all(breaks[k] <= angle <= breaks[k + 1] for angle in at)
        assert gk.pressure_angle(cam, at[0]) == pytest.approx(limits.pressure_angle[k], abs=1e-15)


def test_acceleration_that_jumps_at_a_joint_counts_on_its_own_side():
    """A harmonic rise ends with its largest deceleration, a return starts with it, and the dwell between has none."""
    rise, rest = gk.Rise("harmonic", rise=10, end_deg=60), gk.Dwell(end_deg=180)
    program = gk.Program([rise, rest, gk.Return("harmonic", end_deg=360)])
    limits = segment_limits(gk.Cam(TranslatingFlat(), program, 40))
    # rho = base + lift + s'', with s'' = -h / 2 (pi / beta)^2 at the top.
    assert limits.convex_radius == pytest.approx([40 + 10 - 5 * 9, 50, 40 + 10 - 5], rel=1e-12)
    assert np.degrees(limits.convex_radius_at[0]) == pytest.approx(60)


# least base circles


def good(follower, program, direction, limit_deg, least_radius, radius):
    """Whether a base radius keeps the limits, on samples."""
    try:
        cam = gk.Cam(follower, program, radius, direction)
    except gk.DesignError:
        return False
    limits = segment_limits(cam)
    return np.degrees(np.abs(limits.pressure_angle).max()) <= limit_deg and limits.convex_radius.min() >= least_radius


CASES = {
    "pressure": (TranslatingRoller(10, 12), LIFTS, 30, 0),
    "undercut by roller": (TranslatingRoller(60, 2), programme(12, ends=(60, 100, 110, 160)), 60, 0),
    "blunt": (TranslatingRoller(10), LIFTS, 45, 60),
    "flat": (TranslatingFlat(), LIFTS, 30, 0),
    "flat with radius": (TranslatingFlat(-12), LIFTS, 30, 5),
    "roller on arm": (OscillatingRoller(10, 100, 80), SWINGS, 30, 0),
    "roller on arm below": (OscillatingRoller(30, 100, 80, "below"), SWINGS, 30, 12),
    "flat on arm": (OscillatingFlat(110, 8), SWINGS, 20, 0),
    "flat on arm below": (OscillatingFlat(110, -8, "below"), SWINGS, 20, 10),
}


@pytest.mark.parametrize("name", by_default(list(CASES)[::2], ["pressure", "flat with radius"]))
def test_the_least_base_circle_is_good_and_a_smaller_one_is_not(name):
    case, direction = CASES[name], "clockwise" if len(name) % 2 else "counterclockwise"
    follower, program, limit_deg, least_radius = case
    found = least_base_circle(follower, program, direction, limit_deg, least_radius)
    rest = follower, program, direction, limit_deg, least_radius
    assert good(*rest, found.radius * (1 + 1e-9)) and not good(*rest, found.radius * (1 - 1e-9))
    assert found.limit in ("pressure angle", "undercut")
    # The rule that it names is the one at its limit, at the angle that it names.
    cam = gk.Cam(follower, program, found.radius, direction)
    limits = segment_limits(cam)
    if found.limit == "pressure angle":
        assert np.degrees(abs(gk.pressure_angle(cam, found.cam_angle))) == pytest.approx(limit_deg, abs=1e-6)
    else:
        assert limits.convex_radius.min() == pytest.approx(least_radius, abs=1e-6)
    top = min(found.largest, 20 * found.radius)
    assert all(good(*rest, r) for r in np.linspace(found.radius, top, 23)[1:-1])
    assert found.largest == np.inf or not good(*rest, found.largest * (1 + 1e-9))


def test_least_base_radius_of_a_roller_has_its_closed_form():
    """tan(alpha) = (s' - sgn e) / (H + s) with H^2 = Rp^2 - e^2, so H >= max(|s' - sgn e| / tan(alpha) - s)."""
    motion = LIFTS.motion(np.linspace(0, 2 * np.pi, 500_001))
    for sense, direction in ((1, "counterclockwise"), (-1, "clockwise")):
        height = (np.abs(motion.velocity - sense * 12) / np.tan(np.radians(30)) - motion.lift).max()
        found = least_base_circle(TranslatingRoller(10, 12), LIFTS, direction)
        assert found.radius == pytest.approx(np.hypot(height, 12) - 10, abs=1e-9)
        assert found.limit == "pressure angle" and found.largest == np.inf


def test_least_base_radius_of_a_flat_face_has_its_closed_form():
    """rho = base + s + s'': the worked case's min(s + s'') is -7.835302 (printed -7.835296, from samples)."""
    motion = LIFTS.motion(np.linspace(np.radians(150), np.radians(154), 50_001))
    least = (motion.lift + motion.acceleration).min()
    assert least == pytest.approx(-7.835302, abs=5e-7)
    assert TranslatingFlat().least_base_radius(LIFTS, 0) == pytest.approx(-least, abs=1e-11)
    assert TranslatingFlat().least_base_radius(LIFTS, 3) == pytest.approx(3 - least, abs=1e-11)
    found = least_base_circle(TranslatingFlat(), LIFTS)
    assert found.radius == TranslatingFlat().least_base_radius(LIFTS, 0) and found.limit == "undercut"
    # What the face carries is the whole lift, what the cam sees of it the part along its normal.
    cosine = np.cos(np.radians(25))
    assert TranslatingFlat(25).least_base_radius(LIFTS, 0) == pytest.approx(-least * cosine, abs=1e-11)


def test_an_arm_that_would_lean_too_much_on_any_cam_is_refused():
    with pytest.raises(gk.DesignError) as caught:
        least_base_circle(OscillatingRoller(10, 100, 80), programme(40, True), pressure_angle_deg=10)
    assert caught.value.field == "base_radius" and caught.value.remedy
    with pytest.raises(gk.DesignError):
        least_base_circle(TranslatingFlat(31), LIFTS)
    assert least_base_circle(TranslatingFlat(30), LIFTS).limit == "undercut"


def test_a_velocity_that_jumps_down_undercuts_a_cam_of_any_size():
    with pytest.raises(gk.DesignError):
        least_base_circle(TranslatingFlat(), programme(10, laws=("uniform", "cycloidal")))
    with pytest.raises(gk.DesignError):
        least_base_circle(
            OscillatingRoller(2, 200, 190), programme(2, True, laws=("uniform", "cycloidal")), pressure_angle_deg=90
        )
    # A knife edge leaves the corner as it is.
    assert least_base_circle(TranslatingRoller(0), programme(10, laws=("uniform", "cycloidal"))).radius > 0


@pytest.mark.parametrize(
    ("sizes", "field"),
    [({"pressure_angle_deg": 0}, "pressure_angle_deg"), ({"pressure_angle_deg": 91}, "pressure_angle_deg"),
     ({"least_radius": -1}, "least_radius"), ({"least_radius": np.inf}, "least_radius"),
     ({"program": SWINGS}, "program"), ({"direction": "left"}, "direction")],
)  # fmt: skip
def test_limits_that_are_none_are_refused(sizes, field):
    with pytest.raises(gk.DesignError) as caught:
        least_base_circle(**({"follower": TranslatingRoller(10), "program": LIFTS} | sizes))
    assert caught.value.field == field


def test_where_flanks_cross_the_radius_found_is_the_least_without_undercut():
    """A corner that only a very large cam has room for: at the radius nothing is cut away, just below it something."""
    program = gk.Program([gk.Rise("harmonic", rise=10, end_deg=22), gk.Dwell(end_deg=42),
                          gk.Return("uniform", end_deg=78), gk.Dwell(end_deg=360)])  # fmt: skip
    follower = TranslatingRoller(2)
    found = least_base_circle(follower, program, pressure_angle_deg=60)
    assert found.limit == "undercut"
    assert not undercut(gk.Cam(follower, program, found.radius)).found
    smaller = undercut(gk.Cam(follower, program, found.radius * (1 - 1e-6)))
    assert smaller.found and found.cam_angle == pytest.approx(smaller.worst[1], abs=1e-3)


@pytest.mark.parametrize("tried", [121])
def test_a_hill_between_samples_limits_the_largest_base_radius_too(tried):
    """A limit that a radius that is tried keeps at all samples, and breaks between them: the largest is smaller."""
    follower, program = OscillatingRoller(10, 100, 80), SWINGS
    low, high = follower.base_radius_range(np.radians(14))
    radius = low + (high - low) * (tried + 0.5) / base_circle.TRIALS

    def leaning(radius, angles):
        return np.degrees(np.abs(follower.contact(program.motion(angles), radius, 1).pressure_angle)).max()

    comb = np.linspace(0, 2 * np.pi, 100_001)
    seen, whole = leaning(radius, samples(program.breaks)), leaning(radius, comb)
    assert whole > seen * (1 + 1e-9)
    limit = 0.5 * (seen + whole)
    found = gk.cam.least_base_circle(follower, program, pressure_angle_deg=limit)
    assert found.radius < found.largest < radius
    assert leaning(found.largest, comb) <= limit * (1 + 1e-9) < leaning(found.largest * (1 + 1e-5), comb)
