"""Motion programmes by second roads: differences, exact fractions, other splines, what was asked for."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import geomkin as gk
from geomkin.cam.checks import tightest_convex
from geomkin.cam.program.program import Program
from geomkin.cam.program.segments import LiftPolynomial, LiftSpline, LiftTable, OptimisedPolynomial, OptimisedSpline

REST = {"start_velocity_per_rad": 0, "start_acceleration_per_rad2": 0, "end_velocity_per_rad": 0}
REST |= {"end_acceleration_per_rad2": 0}
ORDERS = ("lift", "velocity", "acceleration", "jerk")
CYCLOIDS = Program(
    [
        gk.Dwell(end_deg=90),
        gk.Rise("cycloidal", rise=20, end_deg=180),
        gk.Dwell(duration_deg=90),
        gk.Return("cycloidal", end_deg=360),
    ]
)


class Quick:
    """Half the way at speed 1.5, the rest at 0.5."""

    breaks = (0, 0.5, 1)

    def __call__(self, x):
        slow = x >= 0.5
        return np.stack([np.where(slow, 0.5 + 0.5 * x, 1.5 * x), np.where(slow, 0.5, 1.5), 0 * x, 0 * x])


def square(x):
    """A law without joints that jumps in velocity at its end."""
    return np.stack([x**2, 2 * x, 2 + 0 * x, 0 * x])


PROGRAMS = {
    "modified": [
        gk.Rise("modified-trapezoid", rise=20, end_deg=100),
        gk.Dwell(end_deg=180),
        gk.Return("modified-sine", end_deg=290),
        gk.Dwell(end_deg=360),
    ],
    "uniform": [gk.Rise("uniform", rise=9, end_deg=110), gk.Return("parabolic", end_deg=290), gk.Dwell(end_deg=360)],
    "own laws": [gk.Rise(Quick(), rise=9, end_deg=110), gk.Return(square, end_deg=360)],
    "polynomials": [
        LiftPolynomial(rise=20, end_deg=90, **REST, through=((30.0, 4.5), (50.0, 12.0))),
        LiftPolynomial(end_lift=0, end_deg=250, **REST | {"end_jerk_per_rad3": -5}),
        gk.Dwell(end_deg=360),
    ],
    "spline between": [
        gk.Dwell(end_deg=60),
        LiftSpline(points=((60, 0), (80, 3), (100, 9), (120, 14), (150, 20))),
        gk.Return("harmonic", end_deg=360),
    ],
    "spline alone": [LiftSpline(points=tuple((a, 9 - 9 * np.cos(np.radians(a))) for a in range(0, 361, 30)))],
    "optimised": [
        gk.Dwell(end_deg=30),
        OptimisedPolynomial(degree=9, rise=3, end_deg=60),
        gk.Rise("uniform", rise=10, end_deg=120),
        OptimisedSpline(intervals=9, rise=3, end_deg=150),
        gk.Return("harmonic", end_lift=8, end_deg=240),
        OptimisedPolynomial(degree=12, end_lift=0, end_deg=330, jerk_limit=250),
        gk.Dwell(end_deg=360),
    ],
    "arm": [
        gk.Rise("4-5-6-7", rise_deg=20, end_deg=100),
        LiftPolynomial(end_lift_deg=5, end_deg=200, **REST),
        OptimisedPolynomial(end_lift_deg=2, end_deg=250),
        LiftSpline(points_deg=((250, 2), (280, 3), (300, 2.5))),
        gk.Return("cycloidal", end_deg=360),
    ],
}
each_program = pytest.mark.parametrize("program", [Program(s) for s in PROGRAMS.values()], ids=list(PROGRAMS))


def orders_of(motion):
    return np.stack([getattr(motion, name) for name in ORDERS])


@each_program
def test_velocity_acceleration_and_jerk_are_derivatives_between_breaks(program):
    angle, h = np.linspace(0, 2 * np.pi, 4001), 1e-4
    angle = angle[np.abs(angle[:, None] - program.breaks).min(axis=1) > 3 * h]
    values = orders_of(program.motion(angle))
    slope = sum(w * orders_of(program.motion(angle + k * h)) for w, k in ((1, -2), (-8, -1), (8, 1), (-1, 2))) / (
        12 * h
    )
    for order in range(3):
        size = max(1, np.abs(values[order + 1]).max())
        # Rounding of the value over the step, and the knots of a spline, where the fifth derivative jumps.
        assert np.abs(slope[order] - values[order + 1]).max() < 1e-7 * size


@each_program
def test_nothing_jumps_but_at_breaks_and_as_much_as_said(program):
    breaks = program.breaks
    assert breaks[0] == 0 and breaks[-1] == pytest.approx(2 * np.pi, abs=1e-15) and (np.diff(breaks) > 0).all()
    h = 1e-7
    before = orders_of(program.motion(np.append(breaks[-1], breaks[1:-1]) - h))
    after = orders_of(program.motion(breaks[:-1] + h))
    for order, name in enumerate(ORDERS):
        jump = getattr(program.jumps, name)
        size = np.abs(orders_of(program.motion(np.linspace(0, 6.28, 999)))).max(axis=1)
        slope = size[order + 1] if order < 3 else 100 * size[3]
        assert jump == pytest.approx(after[order] - before[order], abs=3 * h * slope + 1e-9 * size[order])
    assert (program.jumps.lift == 0).all()


def test_an_arm_moves_in_radians_by_the_same_laws():
    by_angle = Program([gk.Rise("3-4-5", rise_deg=30, end_deg=90), gk.Return("cycloidal", end_deg=360)])
    by_mm = Program([gk.Rise("3-4-5", rise=np.radians(30), end_deg=90), gk.Return("cycloidal", end_deg=360)])
    angle = np.linspace(0, 6.28, 99)
    assert by_angle.oscillates and not by_mm.oscillates
    assert orders_of(by_angle.motion(angle)) == pytest.approx(orders_of(by_mm.motion(angle)), rel=1e-12, abs=1e-14)


def test_derivatives_of_an_arm_are_given_in_radians_per_radian():
    program = Program(
        [
            LiftPolynomial(
                end_lift_deg=30, end_deg=90, start_velocity_per_rad=0, end_velocity_per_rad=0.25, end_jerk_per_rad3=-2
            ),
            OptimisedPolynomial(rise_deg=5, end_deg=180),
            gk.Return("cycloidal", end_deg=360),
        ]
    )
    end = orders_of(program.motion(np.radians(90) - 1e-12))
    assert end[[0, 1, 3]] == pytest.approx([np.radians(30), 0.25, -2])
    # What meets it takes slope and curvature over.
    assert orders_of(program.motion(np.radians(90)))[1:3] == pytest.approx(end[1:3])


@pytest.mark.parametrize(("law", "conditions"), [("3-4-5", 2), ("4-5-6-7", 3)])
def test_a_polynomial_at_rest_at_both_ends_is_the_named_law(law, conditions):
    names = [f"{side}_{name}" for side in ("start", "end") for name in
             ("velocity_per_rad", "acceleration_per_rad2", "jerk_per_rad3")[:conditions]]  # fmt: skip
    own = LiftPolynomial(rise=20, end_deg=100, **dict.fromkeys(names, 0.0))
    angle = np.linspace(0, np.radians(99.99), 333)
    ways = [Program([rise, gk.Return("harmonic", end_deg=360)]) for rise in (own, gk.Rise(law, rise=20, end_deg=100))]
    named = orders_of(ways[1].motion(angle))
    assert np.abs(orders_of(ways[0].motion(angle)) - named).max(axis=1) == pytest.approx(
        np.zeros(4), abs=1e-12 * np.abs(named).max()
    )


@settings(deadline=None, max_examples=15)
@given(st.lists(st.one_of(st.none(), st.integers(-9, 9)), min_size=6, max_size=6), st.integers(0, 3))
def test_a_polynomial_meets_its_conditions_and_no_degree_more(given_, between):
    # Without the slopes nothing higher would be settled.
    given_[0], given_[3] = given_[0] or 0, given_[3] or 0
    names = [f"{side}_{n}" for side in ("start", "end") for n in ("velocity_per_rad", "acceleration_per_rad2",
             "jerk_per_rad3")]  # fmt: skip
    through = tuple((150 + 40.0 * k, 2000.0 + k) for k in range(between))
    program = Program(
        [
            LiftPolynomial(rise=2000, end_deg=80, **REST),
            LiftPolynomial(rise=3, end_deg=300, **dict(zip(names, given_)), through=through),
            gk.Return("harmonic", end_deg=360),
        ]
    )
    ends = orders_of(program.motion(np.radians([80, 300 - 1e-11])))[1:].T.ravel()
    for wanted, found in zip(given_, ends):
        assert wanted is None or found == pytest.approx(wanted, abs=1e-5)
    for angle, lift in through:
        assert program.motion(np.radians(angle)).lift == pytest.approx(lift, abs=1e-9)
    # The difference of order one above its degree vanishes, of equal steps, and that of its degree need not.
    count = 2 + sum(v is not None for v in given_) + between
    lifts = program.motion(np.radians(np.linspace(80, 300 - 1e-11, count + 1))).lift
    assert np.diff(lifts, count)[0] == pytest.approx(0, abs=1e-7)


def spline_by_fractions(x, y, start, end):
    """Slopes and curvatures at all knots of the quintic spline, exactly: by Gauss elimination on its equations."""
    n = len(x) - 1
    x, y = [Fraction(v) for v in x], [Fraction(v) for v in y]
    size = 6 * n
    rows = []

    def powers(u, order):
        row = []
        for p in range(6):
            factor = Fraction(1)
            for k in range(order):
                factor *= p - k
            row.append(factor * (u ** (p - order) if p >= order else 0))
        return row

    def add(parts, value):
        row = [Fraction(0)] * (size + 1)
        for piece, part, sign in parts:
            for p, v in enumerate(part):
                row[6 * piece + p] += sign * v
        row[size] = Fraction(value)
        rows.append(row)

    for i in range(n):
        h = x[i + 1] - x[i]
        add([(i, powers(Fraction(0), 0), 1)], y[i])
        add([(i, powers(h, 0), 1)], y[i + 1])
        if i:
            before = x[i] - x[i - 1]
            for order in range(1, 5):
                add([(i - 1, powers(before, order), 1), (i, powers(Fraction(0), order), -1)], 0)
    for order in (1, 2):
        add([(0, powers(Fraction(0), order), 1)], start[order - 1])
        add([(n - 1, powers(x[n] - x[n - 1], order), 1)], end[order - 1])
    for k in range(size):
        pivot = next(r for r in range(k, size) if rows[r][k])
        rows[k], rows[pivot] = rows[pivot], rows[k]
        rows[k] = [v / rows[k][k] for v in rows[k]]
        for r in range(size):
            if r != k and rows[r][k]:
                rows[r] = [a - rows[r][k] * b for a, b in zip(rows[r], rows[k])]
    return np.array([float(row[size]) for row in rows]).reshape(n, 6)


def test_a_spline_is_the_quintic_one_clamped_to_its_neighbours():
    points = ((60, 6), (75, 8), (100, 11), (110, 13), (150, 20))
    program = Program(
        [gk.Rise("uniform", rise=6, end_deg=60), LiftSpline(points=points), gk.Return("parabolic", end_deg=360)]
    )
    a = np.array(points, dtype=float)
    turn = 180 / np.pi  # slopes by degree here
    slope, bend = 6 / 60, -20 * 4 / 210**2
    exact = spline_by_fractions(a[:, 0], a[:, 1], (slope, 0), (0, bend))
    for k in range(4):
        u = np.linspace(0, a[k + 1, 0] - a[k, 0], 33)[:-1]
        for order, name in enumerate(ORDERS):
            poly = np.polynomial.Polynomial(exact[k])
            wanted = (poly.deriv(order) if order else poly)(u) * turn**order
            found = getattr(program.motion(np.radians(a[k, 0] + u)), name)
            assert found == pytest.approx(wanted, rel=1e-9, abs=1e-9 * np.abs(wanted).max())
    # Slope and curvature go on at both ends.
    assert (program.jumps.velocity[1:3] == 0).all() and (program.jumps.acceleration[1:3] == 0).all()


def test_a_spline_alone_closes_on_itself_and_nears_a_smooth_motion_by_the_sixth_power():
    def missed(count):
        angle = np.linspace(0, 360, count + 1)
        wanted = 10 - 6 * np.cos(np.radians(angle)) - 3 * np.sin(2 * np.radians(angle))
        program = Program([LiftSpline(points=tuple(zip(angle, np.append(wanted[:-1], wanted[0]))))])
        assert program.jumps.jerk == pytest.approx([0]) and (program.jumps.acceleration == 0).all()
        t = np.linspace(0, 6.28, 999)
        return np.abs(program.motion(t).lift - (10 - 6 * np.cos(t) - 3 * np.sin(2 * t))).max()

    assert missed(20) / missed(40) == pytest.approx(2**6, rel=0.3)
    assert missed(60) < 1e-7


TURN = np.arange(360.0)


def rounded(program, decimals, degrees=TURN):
    return tuple(zip(degrees, np.round(program.motion(np.radians(degrees)).lift, decimals)))


def missed(program, wanted, low=0.0, high=360.0):
    """Largest errors of lift, velocity, acceleration and jerk, as shares of the peaks."""
    angle = np.radians(np.linspace(low, high, 9001)[1:-1])
    right = orders_of(wanted.motion(angle))
    return np.abs(orders_of(program.motion(angle)) - right).max(axis=1) / np.abs(right).max(axis=1)


def test_a_table_gives_the_acceleration_back_from_rounded_rows_where_a_curve_through_them_does_not():
    dwell, back = gk.Dwell(end_deg=90), gk.Return("cycloidal", end_deg=360)
    degrees = np.linspace(90, 210, 361)
    whole = Program([dwell, gk.Rise("cycloidal", rise=20, end_deg=210), back])
    rows = rounded(whole, 3, degrees)
    near, through = (Program([dwell, LiftTable(decimals, rows=rows), back]) for decimals in (3, 15))
    assert missed(through, whole, 90, 210)[2] > 2  # the pitfall
    errors = missed(near, whole, 90, 210)
    assert errors[0] < 5e-5 and errors[1] < 1e-3 and errors[2] < 5e-3 and errors[3] < 3e-2
    angles, lifts = np.array(rows).T
    assert np.abs(near.motion(np.radians(angles)).lift - lifts).max() <= 0.75e-3
    assert np.abs(through.motion(np.radians(angles)).lift - lifts).max() < 1e-12


@pytest.mark.campaign
def test_a_table_comes_from_a_file_beside_the_recipe_with_other_columns_and_without_its_last_row(tmp_path):
    lines = ["cam_angle_deg, time_s,lift_mm "] + [f"{a:g},{a / 7:g},{lift}" for a, lift in rounded(CYCLOIDS, 4)]
    # As a spreadsheet saves it: a mark at the start, other line ends, an empty line at the end.
    (tmp_path / "lift.csv").write_bytes(("\ufeff" + "\r\n".join(lines) + "\r\n\r\n").encode())
    from_file = Program([LiftTable(4, file="lift.csv")], folder=str(tmp_path))
    inline = Program([LiftTable(4, rows=(*rounded(CYCLOIDS, 4), (360.0, 0.0)))])
    by_path = Program([LiftTable(4, file=str(tmp_path / "lift.csv"))])
    angle = np.linspace(0, 7, 99)
    assert (orders_of(from_file.motion(angle)) == orders_of(inline.motion(angle))).all()
    assert (orders_of(from_file.motion(angle)) == orders_of(by_path.motion(angle))).all()
    (tmp_path / "arm.csv").write_text("lift_deg,cam_angle_deg\n0,0\n10,180\n0,360\n")
    arm = Program([LiftTable(12, file="arm.csv")], str(tmp_path))
    assert arm.oscillates and arm.motion(np.pi).lift == pytest.approx(np.radians(10))


BACK = gk.Return("cycloidal", end_deg=360)
UP = {"rise": 3, "end_deg": 100}


@pytest.mark.parametrize(
    ("make", "field"),
    [
        (lambda: [gk.Rise("cycloidal", **UP), gk.Return("cycloidal", end_deg=200, end_lift_deg=1), BACK], ""),
        (lambda: [gk.Rise("cycloidal", **UP, rise_deg=3), BACK], "[0].rise"),
        (lambda: [gk.Rise("cycloidal", **UP), gk.Return("harmonic", 1, end_deg=200, end_lift_deg=1)], "[1].end_lift"),
        (lambda: [gk.Rise("cycloidal", **UP, rise_deg=3, end_lift=3), BACK], "[0].rise"),
        (lambda: [gk.Rise("cycloidal", rise_deg=-3, end_deg=100), BACK], "[0].rise_deg"),
        (lambda: [gk.Rise("cycloidal", rise=np.array([3.0, 4]), end_deg=100), BACK], "[0].rise"),
        (lambda: [gk.Rise("cycloid", **UP), BACK], "[0].law"),
        (lambda: [gk.Rise(lambda x: x, **UP), BACK], "[0].law"),
        (lambda: ["dwell"], "[0]"),
        (lambda: [LiftPolynomial(**UP, start_jerk_per_rad3=1, end_jerk_per_rad3=1), BACK], "[0]"),
        (lambda: [LiftPolynomial(**UP, through=((120, 3),)), BACK], "[0].through[0]"),
        (lambda: [LiftPolynomial(**UP, through=((50, 1), (50, 2))), BACK], "[0]"),
        (lambda: [LiftPolynomial(**UP, start_velocity_per_rad=-5), BACK], "[0]"),
        (lambda: [LiftPolynomial(rise=-3, end_deg=100), BACK], "[0].rise"),
        (lambda: [gk.Dwell(end_deg=90), LiftSpline(points=((80, 0), (360, 0)))], "[1].points[0]"),
        (lambda: [gk.Dwell(end_deg=90), LiftSpline(points=((95, 0), (360, 0)))], "[1].points[0]"),
        (lambda: [gk.Dwell(end_deg=90), LiftSpline(points=((90, 1), (360, 0)))], "[1].points[0]"),
        (lambda: [LiftSpline(points=((0, 0), (90, 20), (95, 20), (130, 0), (360, 0)))], "[0]"),
        (lambda: [LiftSpline(points=((0, 0), (90, 3), (350, 0)))], ""),
        (lambda: [LiftSpline(points=((0, 0), (90, 3), (360, 1)))], ""),
        (lambda: [LiftSpline()], "[0].points"),
        (lambda: [LiftSpline(points=((0, 0),))], "[0].points"),
        (lambda: [LiftSpline(points=((0, 0, 1), (360, 0, 1)))], "[0].points"),
        (lambda: [LiftTable(3, rows=((0, 0), (360, 0)), file="x.csv")], "[0].rows"),
        (lambda: [LiftTable(3.5, rows=((0, 0), (360, 0)))], "[0].decimals"),
        (lambda: [LiftTable(3, rows=((0, 0), (100, 3), (300, 1)))], ""),
        (lambda: [OptimisedPolynomial(4, **UP), BACK], "[0].degree"),
        (lambda: [OptimisedPolynomial(6, **UP, match_jerk=True), BACK], "[0].degree"),
        (lambda: [OptimisedPolynomial(9, **UP, jerk_limit=20), BACK], "[0].jerk_limit"),
        (lambda: [OptimisedSpline(20, **UP, jerk_limit=31.9), BACK], "[0].jerk_limit"),
        (lambda: [OptimisedSpline(2, **UP), BACK], "[0].intervals"),
        (lambda: [OptimisedSpline(rise=0, end_deg=100), gk.Dwell(end_deg=360)], "[0].rise"),
        (lambda: [OptimisedSpline(end_deg=100), gk.Dwell(end_deg=360)], "[0].rise"),
        (
            lambda: [gk.Rise("uniform", **UP), OptimisedSpline(rise=0, duration_deg=100, jerk_limit=50), BACK],
            "[1].jerk_limit",
        ),
    ],
)
def test_invalid_programs_are_refused(make, field):
    with pytest.raises(gk.DesignError) as refused:
        Program(make())
    assert refused.value.field in ("program" + field, field.rsplit(".")[-1])


CLASSIC = gk.Program(
    [
        gk.Dwell(end_deg=90),
        gk.Rise("cycloidal", rise=20, end_deg=180),
        gk.Dwell(duration_deg=90),
        gk.Return("harmonic", end_deg=360),
    ]
)


def test_lifts_and_accelerations_at_joints():
    degrees = np.radians([0, 45, 90, 135, 180, 200, 269, 360])
    assert CLASSIC.motion(degrees).lift[[0, 1, 2, 4, 5, 6, 7]] == pytest.approx([0, 0, 0, 20, 20, 20, 0])
    assert CLASSIC.motion(degrees).lift[3] == pytest.approx(10)
    # The harmonic return jumps in acceleration at its joint: the piece that starts there answers.
    joint = np.radians(270)
    assert CLASSIC.motion(np.nextafter(joint, 0)).acceleration == 0
    assert CLASSIC.motion(joint).acceleration == pytest.approx(-20 * 2)
    assert CLASSIC.motion(joint + 4 * np.pi).lift == pytest.approx(20)


def test_the_largest_roller_is_where_the_profile_starts_to_cross_itself():
    cam = gk.Cam(gk.TranslatingRoller(0), CLASSIC, 40)
    least, _ = tightest_convex(cam)

    def crosses(radius):
        from geomkin.plane.region import is_simple

        # A larger roller on a smaller base circle: the same pitch curve.
        return not is_simple(gk.flatten(gk.Cam(gk.TranslatingRoller(radius), CLASSIC, 40 - radius).profile, 1e-5))

    assert not crosses(0.99 * least)
    assert least > 39 or crosses(1.02 * least)
