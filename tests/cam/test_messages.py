"""What is wrong with a programme, a cam or a limit, word by word."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.cam.program.laws import law_of

from .cams import LIFTS, SWINGS, programme

UP = gk.Rise("harmonic", rise=2, end_deg=90)
ONE = "give one of them, in mm or in degrees"
OTHER = "give {}, or a follower of the other sort"
BASE = "with any that the follower allows, {} is beyond its limit (pressure angle {} deg)"
BASE_REMEDY = "give longer segments, another follower or a larger pressure angle"


def rise(**given):
    return gk.Program([gk.Rise("harmonic", **given), gk.Return("harmonic", end_deg=360)])


def then(segment):
    return gk.Program([UP, segment])


def least(follower, program, angle, radius=0.0):
    return gk.cam.least_base_circle(follower, program, pressure_angle_deg=angle, least_radius=radius)


WRONG = {
    "both": (
        lambda: rise(rise=2, end_lift=2, end_deg=90),
        ("program[0].rise", "of rise and end_lift found both", ONE),
    ),
    "neither": (lambda: rise(end_deg=90), ("program[0].rise", "of rise and end_lift found neither", ONE)),
    "mm and deg": (
        lambda: rise(rise=2, rise_deg=2, end_deg=90),
        ("program[0].rise", "of rise and end_lift found both", ONE),
    ),
    "three": (
        lambda: rise(rise=2, rise_deg=2, end_lift=2, end_deg=90),
        ("program[0].rise", "of rise and end_lift found more", ONE),
    ),
    "no end": (
        lambda: rise(rise=2),
        ("program[0].end_deg", "of end_deg and duration_deg found neither", "give one of them"),
    ),
    "two ends": (
        lambda: rise(rise=2, end_deg=90, duration_deg=80),
        ("program[0].end_deg", "of end_deg and duration_deg found two that disagree", "give one of them"),
    ),
    "back": (
        lambda: then(gk.Dwell(end_deg=80)),
        ("program[1].end_deg", "the segment runs from 90 to 80 deg", "give an end after its start"),
    ),
    "two lifts": (
        lambda: then(gk.Return("harmonic", end_lift=1, end_lift_deg=0, end_deg=360)),
        ("program[1].end_lift", "of end_lift and end_lift_deg found both", "give one of them"),
    ),
    "open": (
        lambda: gk.Program([UP]),
        ("program", "the segments end at 90 deg", "make the last one end at 360 deg"),
    ),
    "high": (
        lambda: then(gk.Dwell(end_deg=360)),
        ("program", "the lift ends at 2 mm, not at 0", "add a return, or correct its end_lift"),
    ),
    "dips": (
        lambda: then(gk.cam.LiftPolynomial(end_lift=0, end_deg=360, through=((180, -4.0), (270, 0.0)))),
        (
            "program[1]",
            # (x - 2/3) (x - 1) (3 - 63 x), looked at in 1024 steps.
            "the lift falls to -4.084 mm at 168.838 deg, below the base circle",
            "give other values there, or more lift and a smaller base_radius",
        ),
    ),
    "no segment": (lambda: gk.Program([3]), ("program[0]", "found 3", "give a segment, such as Dwell or Rise")),
    "arm's lifts": (
        lambda: gk.Cam(gk.TranslatingRoller(5), SWINGS, 40),
        (
            "program",
            "its lifts are in degrees, but the follower is of the translating roller sort, which moves along a line",
            OTHER.format("the lifts in mm"),
        ),
    ),
    "lifts of a face": (
        lambda: gk.Cam(gk.OscillatingFlat(100), LIFTS, 60),
        (
            "program",
            "its lifts are in mm, but the follower is of the oscillating flat sort, which swings about a pivot",
            OTHER.format("the lifts in degrees"),
        ),
    ),
    "offset": (
        lambda: gk.Cam(gk.TranslatingRoller(5, -30), LIFTS, 20),
        (
            "follower.offset",
            "found -30 mm, but the roller's centre starts 25 mm from the axis",
            "give an offset below 25 mm or a larger base_radius",
        ),
    ),
    "arm": (
        lambda: gk.Cam(gk.OscillatingRoller(10, 100, 80), SWINGS, 5),
        (
            "follower.arm_length",
            # 14 deg short of straight away from the axis, 180 deg at most.
            "found 80 mm with pivot_distance 100 mm and lifts up to 14 deg: the arm reaches cams with a base_radius "
            f"above 10 and below {abs(100 + 80 * np.exp(1j * np.radians(14))) - 10:.4g} mm, not 5",
            "change arm_length, pivot_distance or base_radius",
        ),
    ),
    "face": (
        lambda: gk.Cam(gk.OscillatingFlat(100, 8), SWINGS, 150),
        (
            "follower.pivot_distance",
            "found 100 mm with face_offset 8 mm and lifts up to 14 deg: the face reaches cams with a base_radius "
            f"above 0 and below {8 + 100 * np.cos(np.radians(14)):.4g} mm, not 150",
            "change pivot_distance, face_offset or base_radius",
        ),
    ),
    "face that runs": (
        # Back by 40 deg in 20 deg, a cycloid's peak of twice the mean.
        lambda: gk.Cam(gk.OscillatingFlat(100, 8), programme(40, True, ends=(60, 90, 100, 120)), 60),
        (
            "program",
            "at 110 deg the face turns with the cam, and 4 times as fast: no profile can move it so",
            "give a longer segment or a smaller lift there",
        ),
    ),
    "always leans": (
        lambda: least(gk.TranslatingFlat(31), LIFTS, 30),
        ("base_radius", BASE.format("pressure angle", 30), BASE_REMEDY),
    ),
    "leans or is sharp": (
        lambda: least(gk.OscillatingRoller(10, 100, 80), programme(25, True), 30, 60),
        ("base_radius", BASE.format("one of pressure angle and undercut", 30), BASE_REMEDY),
    ),
    "both always": (
        lambda: least(gk.OscillatingRoller(10, 100, 80), programme(25, True), 10, 1000),
        ("base_radius", BASE.format("pressure angle and undercut", 10), BASE_REMEDY),
    ),
    "shape": (
        lambda: law_of(lambda x: np.stack([x, 1 + 0 * x, 0 * x])),
        ("law", "it returns the shape (3, 16, 8) for (16, 8)", "return f, f', f'', f''' stacked"),
    ),
    "shape at the ends": (
        lambda: law_of(lambda x: np.zeros((4, *x.shape)) if x.ndim == 2 else np.zeros(4)),
        ("law", "it returns the shape (4, 16, 8) for (16, 8)", "return f, f', f'', f''' stacked"),
    ),
    "infinite at the end": (
        lambda: law_of(lambda x: np.stack([x, np.where(x == 1, np.inf, 1.0), 0 * x, 0 * x])),
        ("law", "it is not finite everywhere in 0 to 1", "give finite derivatives"),
    ),
    "late": (
        lambda: law_of(lambda x: np.stack([x + 1e-5, 1 + 0 * x, 0 * x, 0 * x])),
        ("law", "it runs from 1e-05 to 1.00001", "make it run from 0 to 1"),
    ),
    "short": (
        lambda: law_of(lambda x: np.stack([x * 0.5, 0.5 + 0 * x, 0 * x, 0 * x])),
        ("law", "it runs from 0 to 0.5", "make it run from 0 to 1"),
    ),
    "slope": (
        lambda: law_of(lambda x: np.stack([x, 1.0001 + 0 * x, 0 * x, 0 * x])),
        (
            "law",
            "its row 1 is not the derivative of its row 0",
            "correct it, or name the places of its jumps in its attribute `breaks`",
        ),
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_is_wrong_is_told_word_by_word(name):
    make, told = WRONG[name]
    with pytest.raises(gk.DesignError) as caught:
        make()
    assert (caught.value.field, caught.value.problem, caught.value.remedy) == told


@pytest.mark.parametrize(
    ("follower", "low", "high"),
    [
        (gk.OscillatingRoller(10, 100, 80), 10.0, 168.0),
        (gk.OscillatingRoller(5, 60, 100, "below"), 35.0, 153.0),
        (gk.OscillatingFlat(60, 110), 50.0, 168.0),
        (gk.OscillatingFlat(90, -8, "below"), 0.0, 79.0),
    ],
)
def test_arms_reach_cams_between_two_sizes_that_are_told(follower, low, high):
    """Low: the pivot's distance less what is on the arm; high: a little less than all of it in line, or square."""
    least, most = follower.base_radius_range(np.radians(14))
    assert least == pytest.approx(low) and high < most < high + 1
    for base in (least * (1 + 1e-6) + 1e-6, most * (1 - 1e-6)):
        place = gk.Cam(follower, SWINGS, base).follower_pose(np.linspace(0, 2 * np.pi, 99))
        assert np.isfinite(place.direction).all()
    for base in [most, most * (1 + 1e-6), *([least] if least else [])]:
        with pytest.raises(gk.DesignError, match="reaches cams with a base_radius above"):
            gk.Cam(follower, SWINGS, base)
