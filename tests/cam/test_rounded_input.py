"""Angles and lifts that are meant to add up may miss by the last digit a person writes; tables by their band."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.cam.program.program import Program
from geomkin.cam.program.segments import LiftSpline, LiftTable

UP, BACK = gk.Rise("harmonic", rise=8, end_deg=180), gk.Return("harmonic", end_deg=360)
DEGREES = np.linspace(180, 360, 41)
LIFTS = 4 + 4 * np.cos(np.radians(DEGREES - 180))


def rows(first=0.0, last=0.0, angle=0.0, end=0.0):
    """Lifts from 8 down to 0 over the second half, ends moved by so much."""
    degrees, lifts = DEGREES.copy(), LIFTS.copy()
    degrees[0], degrees[-1], lifts[0], lifts[-1] = 180 + angle, 360 + end, 8 + first, last
    return tuple(zip(degrees.tolist(), lifts.tolist()))


def whole(first):
    """Lifts of a whole turn whose last is not just the first."""
    return ((0.0, 2.0 + first), (60.0, 3.0), (140.0, 5.0), (220.0, 4.5), (300.0, 3.0), (360.0, 2.0))


# From a slip to segments, the field that is refused where it is larger, and the largest slip.
SLIPS = {
    "start": (lambda e: [UP, gk.Return("harmonic", start_deg=180 + e, end_deg=360)], "program[1].start_deg", 1e-7),
    "end and duration": (
        lambda e: [gk.Rise("harmonic", rise=8, end_deg=180, duration_deg=180 + e), BACK],
        "program[0].end_deg",
        1e-7,
    ),
    "first angle of a spline": (lambda e: [UP, LiftSpline(points=rows(angle=e))], "program[1].points[0]", 1e-7),
    "first lift of a spline": (lambda e: [UP, LiftSpline(points=rows(first=e))], "program[1].points[0]", 1e-7),
    "last lift": (lambda e: [UP, gk.Return("harmonic", end_lift=abs(e), end_deg=360)], "program", 1e-7),
    "last lift of a spline": (lambda e: [UP, LiftSpline(points=rows(last=abs(e)))], "program", 1e-7),
    "spline alone": (lambda e: [LiftSpline(points=whole(e))], "program", 1e-7),
    "first lift of a table": (lambda e: [UP, LiftTable(3, rows=rows(first=e))], "program[1].rows[0]", 0.75e-3),
    "last lift of a table": (lambda e: [UP, LiftTable(3, rows=rows(last=abs(e)))], "program", 0.75e-3),
    "lift of a table below 0": (lambda e: [UP, LiftTable(3, rows=rows(last=-abs(e)))], "program[1].rows[40]", 0.75e-3),
    "first lift of a table with a band": (
        lambda e: [UP, LiftTable(within=0.02, rows=rows(first=e))],
        "program[1].rows[0]",
        0.02,
    ),
    "first lift of a table that is met": (lambda e: [UP, LiftTable(12, rows=rows(first=e))], "program[1].rows[0]", 1e-7),
}  # fmt: skip


@pytest.mark.parametrize("name", SLIPS)
def test_small_mismatch_is_accepted_and_a_larger_one_refused(name):
    made, field, largest = SLIPS[name]
    meant = Program(made(0.0))
    angle = np.linspace(0, 2 * np.pi, 99)
    for sign in (-1, 1):
        slipped = Program(made(0.99 * sign * largest))
        # Joints stand where they were meant, and nothing jumps there, not even by the slip.
        assert slipped.breaks == pytest.approx(meant.breaks, abs=2e-9) and slipped.breaks[-1] == 2 * np.pi
        assert (slipped.jumps.lift == 0).all()
        assert slipped.motion(angle).lift == pytest.approx(meant.motion(angle).lift, abs=2.5 * largest)
        with pytest.raises(gk.DesignError) as refused:
            Program(made(1.01 * sign * largest))
        assert refused.value.field == field


@pytest.mark.parametrize("short", [-0.99e-7, -1.01e-7])
def test_the_last_segment_ends_where_the_turn_does(short):
    for last in (gk.Return("harmonic", end_deg=360 + short), LiftSpline(points=rows(end=short))):
        if short > -1e-7:
            assert Program([UP, last]).breaks.tolist() == [0, np.pi, 2 * np.pi]
        else:
            with pytest.raises(gk.DesignError):
                Program([UP, last])


def test_segment_without_duration_is_refused():
    for duration in (0.99e-7, -5.0, 0.0):
        with pytest.raises(gk.DesignError) as refused:
            Program([UP, gk.Dwell(duration_deg=duration), BACK])
        assert refused.value.field == "program[1].end_deg"
    assert len(Program([UP, gk.Dwell(duration_deg=1.01e-7), BACK]).breaks) == 4


@pytest.mark.parametrize(("miss", "left_out"), [(0.0, True), (1e-5, True), (4e-4, False)])
def test_last_row_of_equal_steps_may_be_left_out(miss, left_out):
    """To a millionth of a step, as thirds of a turn are written."""
    degrees = np.arange(0, 360, 30.0)
    degrees[5] += miss * (1 if left_out else 30)
    lifts = 3 - 3 * np.cos(np.radians(degrees))
    table = LiftTable(6, rows=tuple(zip(degrees.tolist(), lifts.tolist())))
    if left_out:
        assert Program([table]).motion(2 * np.pi - 1e-9).lift == pytest.approx(0, abs=1e-6)
    else:
        with pytest.raises(gk.DesignError):
            Program([table])


# Refusals of one of several fields, with the unit that was meant.
@pytest.mark.parametrize(
    ("make", "field"),
    [
        (
            lambda: [gk.Rise("harmonic", rise=8, end_deg=90), gk.Return("harmonic", end_lift=9, end_deg=360)],
            "[1].end_lift",
        ),
        (
            lambda: [gk.Rise("harmonic", rise=8, end_deg=90), gk.Return("harmonic", end_lift=-1, end_deg=360)],
            "[1].end_lift",
        ),
        (lambda: [UP, gk.cam.OptimisedSpline(end_lift=-2, end_deg=360)], "[1].end_lift"),
        (lambda: [UP, gk.cam.OptimisedSpline(rise=-10, end_deg=360)], "[1].rise"),
        (
            lambda: [gk.Rise("harmonic", rise_deg=8, end_deg=180), gk.cam.LiftPolynomial(rise_deg=-10, end_deg=360)],
            "[1].rise_deg",
        ),
        (lambda: [UP, gk.Rise("harmonic", end_lift=8, end_deg=360)], "[1].end_lift"),
        (lambda: [gk.Dwell(end_deg=90), gk.Rise("harmonic", rise=8, start_deg=91, end_deg=180), BACK], "[1].start_deg"),
        (lambda: [gk.Dwell(end_deg=90), gk.Rise("harmonic", rise=8, start_deg=89, end_deg=180), BACK], "[1].start_deg"),
        (lambda: [UP, LiftSpline(points_deg=rows())], ""),
        (lambda: [gk.Rise("harmonic", rise_deg=8, end_deg=180), gk.Dwell(end_deg=360)], ""),
        (lambda: [UP, LiftSpline(points=rows(first=0.5))], "[1].points[0]"),
        (lambda: [UP, LiftSpline(points=rows(angle=1.0))], "[1].points[0]"),
        (lambda: [UP, LiftSpline(points=(*rows()[:3], *rows()[2:]))], "[1].points[3]"),
        (lambda: [UP, LiftTable(rows=rows())], "[1].decimals"),
        (lambda: [UP, LiftSpline(points=(rows()[0],))], "[1].points"),
        (
            lambda: [UP, gk.cam.LiftPolynomial(rise=-8, end_deg=360, through=((200.0, 7.0), (360.0, 1.0)))],
            r"[1].through[1]",
        ),
        (
            lambda: [UP, gk.cam.LiftPolynomial(rise=-8, end_deg=360, through=((180.0, 7.0), (300.0, 1.0)))],
            r"[1].through[0]",
        ),
    ],
)
def test_segments_that_do_not_fit_together_are_refused(make, field):
    with pytest.raises(gk.DesignError) as refused:
        Program(make())
    assert refused.value.field == "program" + field


def test_a_polynomial_that_ends_the_turn_goes_through_its_places():
    last = gk.cam.LiftPolynomial(end_lift=9e-8, end_deg=360, through=((240.0, 5.0), (300.0, 2.5)))
    program = Program([UP, last])
    assert program.motion(np.radians([180, 240, 300])).lift == pytest.approx([8, 5, 2.5], abs=1e-12)
    assert (program.jumps.lift == 0).all()
