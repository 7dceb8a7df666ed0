"""Roller cams by second roads: the roller's brute-force envelope, differences, a roller on the finished polygon."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import geomkin as gk
from geomkin.cam.measures import tightest_convex
from geomkin.cam.program.laws import LAWS

CLASSIC = gk.Program(
    [
        gk.Dwell(end_deg=90),
        gk.Rise("cycloidal", rise=20, end_deg=180),
        gk.Dwell(duration_deg=90),
        gk.Return("harmonic", end_deg=360),
    ]
)


CAMS = [
    gk.Cam(gk.TranslatingRoller(radius, offset), CLASSIC, 40, direction)
    for radius, offset, direction in [
        (10, 5, "clockwise"), (10, 5, "counterclockwise"), (10, -12, "clockwise"), (0, 0, "counterclockwise")
    ]
]  # fmt: skip
each_cam = pytest.mark.parametrize("cam", CAMS, ids=["offset", "turned", "minus", "knife"])


# The uniform law has no rest at its ends, the parabolic one a jump in its middle.
@pytest.mark.parametrize("law", sorted(set(LAWS) - {"uniform", "parabolic"}))
def test_laws_go_from_0_to_1_and_their_derivatives_are_derivatives(law):
    x, h = np.linspace(0.01, 0.99, 99), 1e-5
    values, before, after = LAWS[law](x), LAWS[law](x - h), LAWS[law](x + h)
    for order in range(3):
        slope = (after[order] - before[order]) / (2 * h)
        assert np.abs(slope - values[order + 1]).max() < 1e-6 * max(1, np.abs(values[order + 1]).max())
    ends = LAWS[law](np.array([0.0, 1.0]))
    assert ends[0] == pytest.approx([0, 1]) and ends[1] == pytest.approx([0, 0], abs=1e-12)


@pytest.mark.parametrize(
    ("law", "peaks"),
    [
        ("cycloidal", (2, 2 * np.pi, 4 * np.pi**2)),
        ("harmonic", (np.pi / 2, np.pi**2 / 2, np.pi**3 / 2)),
        ("3-4-5", (15 / 8, 10 / np.sqrt(3), 60)),
    ],
)
def test_laws_have_the_peaks_of_the_handbooks(law, peaks):
    values = LAWS[law](np.linspace(0, 1, 100_001))
    assert np.abs(values[1:]).max(axis=1) == pytest.approx(peaks, rel=1e-8)


def test_program_holds_what_was_asked_and_is_smooth_where_it_should_be():
    degrees = np.radians([0, 45, 90, 135, 180, 200, 269, 360])
    assert CLASSIC.motion(degrees).lift[[0, 1, 2, 4, 5, 6, 7]] == pytest.approx([0, 0, 0, 20, 20, 20, 0])
    assert CLASSIC.motion(degrees).lift[3] == pytest.approx(10)
    # The harmonic return jumps in acceleration at its joint: the piece that starts there answers.
    joint = np.radians(270)
    assert CLASSIC.motion(np.nextafter(joint, 0)).acceleration == 0
    assert CLASSIC.motion(joint).acceleration == pytest.approx(-20 * 2)
    assert CLASSIC.motion(joint + 4 * np.pi).lift == pytest.approx(20)


@each_cam
def test_profile_is_the_envelope_of_the_moving_roller(cam):
    """Every roller position touches the profile from outside: nearest distance to its centre is its radius."""
    angles = np.linspace(0, 2 * np.pi, 721)[:-1]
    # The roller placed by hand: turn the ground against the cam.
    lift = CLASSIC.motion(angles).lift
    height = np.sqrt((40 + cam.follower.roller_radius) ** 2 - cam.follower.offset**2) + lift
    centres = (cam.follower.offset + 1j * height) * np.exp(-1j * cam.sense * angles)
    assert np.abs(cam.pitch_curve.point(angles) - centres).max() < 1e-12
    profile = cam.profile.point(np.linspace(0, 2 * np.pi, 40_001))
    for centre in centres[::60]:
        away = np.abs(profile - centre)
        # The curve is sampled every 0.01 mm, which shows in full only at a knife edge.
        assert away.min() == pytest.approx(cam.follower.roller_radius, abs=1e-5 if cam.follower.roller_radius else 0.01)
    assert np.abs(np.abs(cam.profile.point(angles) - centres) - cam.follower.roller_radius).max() < 1e-12


@each_cam
def test_curves_keep_their_contract(cam):
    t, h = np.linspace(0.013, 6.27, 500), 1e-6
    t = t[np.abs(t[:, None] - cam.pitch_curve.breaks).min(axis=1) > 1e-4]
    for curve in (cam.pitch_curve, cam.profile):
        slope = (curve.point(t + h) - curve.point(t - h)) / (2 * h)
        assert np.abs(slope - curve.velocity(t)).max() < 1e-6
        assert curve.curvature(t) == pytest.approx(gk.AbstractCurve.curvature(curve, t), rel=1e-7, abs=1e-9)
        assert curve.closed and abs(curve.point(0.0) - curve.point(2 * np.pi)) < 1e-12


@each_cam
def test_pressure_angle_is_between_path_and_normal(cam):
    angles = np.linspace(0, 2 * np.pi, 99)
    normal = 1j * cam.pitch_curve.velocity(angles) * np.exp(1j * cam.sense * angles)
    leaning = np.abs(np.arctan(normal.real / normal.imag))
    assert np.abs(gk.pressure_angle(cam, angles)) == pytest.approx(leaning, abs=1e-12)


def test_offset_towards_the_rise_helps_it_and_harms_the_return():
    angles = np.linspace(0, 2 * np.pi, 2001)
    velocity = CLASSIC.motion(angles).velocity
    plain, helped = (
        np.abs(gk.pressure_angle(gk.Cam(gk.TranslatingRoller(10, e), CLASSIC, 40), angles)) for e in (0, 8)
    )
    assert helped[velocity > 0].max() < plain[velocity > 0].max()
    assert helped[velocity < 0].max() > plain[velocity < 0].max()


@pytest.mark.parametrize("tolerance", [0.05, 0.005])
def test_a_roller_on_the_finished_polygon_gives_the_lift_back(tolerance):
    cam = CAMS[0]
    polygon = gk.flatten(cam.profile, tolerance)
    for degree in range(0, 360, 7):
        turned = polygon * np.exp(1j * cam.sense * np.radians(degree))
        assert _rest(turned, cam) == pytest.approx(CLASSIC.motion(np.radians(degree)).lift, abs=2 * tolerance)


def _rest(polygon, cam):
    """Lift of a roller let down along its line until it touches the polygon, by bisection on its distance."""
    start = np.sqrt(cam.prime_radius**2 - cam.follower.offset**2)
    low, high = -5.0, 25.0
    a, b = polygon, np.roll(polygon, -1)
    for _ in range(40):
        lift = 0.5 * (low + high)
        centre = cam.follower.offset + 1j * (start + lift)
        along = np.clip(np.real(np.conj(b - a) * (centre - a)) / np.abs(b - a) ** 2, 0, 1)
        touching = np.abs(a + along * (b - a) - centre).min() < cam.follower.roller_radius
        low, high = (lift, high) if touching else (low, lift)
    return 0.5 * (low + high)


def test_the_largest_roller_is_where_the_profile_starts_to_cross_itself():
    cam = gk.Cam(gk.TranslatingRoller(0), CLASSIC, 40)
    least, _ = tightest_convex(cam)

    def crosses(radius):
        from geomkin.plane.region import is_simple

        # A larger roller on a smaller base circle: the same pitch curve.
        return not is_simple(gk.flatten(gk.Cam(gk.TranslatingRoller(radius), CLASSIC, 40 - radius).profile, 1e-5))

    assert not crosses(0.99 * least)
    assert least > 39 or crosses(1.02 * least)


@given(st.floats(1, 40), st.floats(1, 359))
def test_two_of_start_end_and_duration_are_enough(rise, middle):
    by_end = gk.Program([gk.Rise("3-4-5", rise=rise, end_deg=middle), gk.Return("3-4-5", end_deg=360)])
    by_duration = gk.Program(
        [gk.Rise("3-4-5", end_lift=rise, duration_deg=middle), gk.Return("3-4-5", duration_deg=360 - middle)]
    )
    angles = np.linspace(0, 6.28, 50)
    assert by_end.motion(angles).lift == pytest.approx(by_duration.motion(angles).lift, abs=1e-9)


@pytest.mark.parametrize(
    ("segments", "words"),
    [
        ([gk.Dwell(end_deg=300)], "300"),
        ([gk.Rise("harmonic", rise=2, end_deg=360)], "return"),
        ([gk.Dwell(end_deg=90), gk.Dwell(start_deg=100, end_deg=360)], "gap"),
        ([gk.Dwell(end_deg=90), gk.Dwell(start_deg=80, end_deg=360)], "overlap"),
        ([gk.Dwell(end_deg=0), gk.Dwell(end_deg=360)], "end after its start"),
        ([gk.Dwell()], "neither"),
        ([gk.Dwell(end_deg=360, duration_deg=100)], "disagree"),
        ([gk.Rise("harmonic", rise=-2, end_deg=90), gk.Dwell(end_deg=360)], "not above"),
        ([gk.Rise("harmonic", end_deg=90), gk.Dwell(end_deg=360)], "neither"),
        ([gk.Return("harmonic", end_lift=-2, end_deg=90), gk.Dwell(end_deg=360)], "below the base"),
        ([gk.Return("harmonic", end_lift=2, end_deg=90), gk.Dwell(end_deg=360)], "not below"),
        ([], "360"),
    ],
)
def test_programmes_that_do_not_add_up_say_where(segments, words):
    with pytest.raises(gk.DesignError, match=words):
        gk.Program(segments)


def test_impossible_cams_are_refused():
    with pytest.raises(gk.DesignError, match="offset"):
        gk.Cam(gk.TranslatingRoller(10, 50), CLASSIC, 40)
    with pytest.raises(gk.DesignError, match="direction"):
        gk.Cam(gk.TranslatingRoller(10), CLASSIC, 40, "left")
    with pytest.raises(gk.DesignError, match="base_radius"):
        gk.Cam(gk.TranslatingRoller(10), CLASSIC, -40)
