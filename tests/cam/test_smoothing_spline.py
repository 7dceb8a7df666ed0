"""The smoothest lift in a band: by other solvers, by known laws given back, and reported if it is noise."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.cam.kinds.disk_cam import DiskCamRecipe
from geomkin.cam.program.given_lifts import TableFit, spline_through
from geomkin.cam.program.program import Program
from geomkin.cam.program.segments import LiftTable
from geomkin.cam.program.smoothing_spline import BandMatrix, smoothest_within
from tests.campaign import by_default

NOISE = 0.005
# Smooth all the way round.
TURN = np.linspace(0, 2 * np.pi, 361)


def law(angle):
    return 20 - 10 * np.cos(angle) - 3 * np.sin(2 * angle), 10 * np.cos(angle) + 12 * np.sin(2 * angle)


PEAK = np.abs(law(np.linspace(0, 2 * np.pi, 7001))[1]).max()


def rows(angles=TURN, noise=NOISE, decimals=3, seed=2, last=None):
    """A whole turn, whose last row is the first again unless another is given."""
    lifts = law(angles)[0] + np.random.default_rng(seed).uniform(-noise, noise, len(angles))
    lifts[-1] = lifts[0] if last is None else last
    return tuple(zip(np.degrees(angles).tolist(), np.round(lifts, decimals).tolist()))


def missed(program):
    angle = np.linspace(0, 2 * np.pi, 7001)
    return np.abs(program.motion(angle).acceleration - law(angle)[1]).max()


@pytest.mark.parametrize("ring", [False, True])
@pytest.mark.parametrize("size", [11, 40])
def test_narrow_bands_are_solved_as_whole_matrices_are(ring, size):
    rng = np.random.default_rng(size)
    numbers = (rng.integers(0, size if ring else size - 5, 300) + np.arange(6)[:, None]) % size
    basis, weights, right = rng.normal(size=(6, 300)), rng.uniform(1, 2, 300), rng.normal(size=size)
    free = np.ones(size, bool)
    if not ring:
        free[[0, 1, 2, -1]] = False
    dense = np.zeros((300, size))
    dense[np.arange(300), numbers] = basis
    whole = (dense * weights[:, None]).T @ dense
    found = BandMatrix.of(numbers, basis, weights, size, free).solve(right)
    assert found[free] == pytest.approx(np.linalg.solve(whole[np.ix_(free, free)], right[free]), rel=1e-10)
    assert not found[~free].any()


@pytest.mark.parametrize("ring", [False, True])
@pytest.mark.parametrize("size", [11])
def test_bands_that_are_not_positive_have_no_solution(ring, size):
    """Lowered until the least of their eigenvalues is just above 0, just below it, and until none is left above."""
    rng = np.random.default_rng(size)
    bands = rng.normal(size=(6, size))
    bands[0] += 20
    if not ring:
        for k in range(1, 6):
            bands[k, size - k :] = 0
    whole = np.zeros((size, size))
    for k, band in enumerate(bands):
        rows = (np.arange(size) + k) % size
        whole[rows, np.arange(size)], whole[np.arange(size), rows] = band, band
    right, values = rng.normal(size=size), np.linalg.eigvalsh(whole)
    for least in (0.05, -0.05, values[0] - 2 * values[-1], 0.0):
        lowered = bands.copy()
        lowered[0] -= values[0] - least
        found = BandMatrix(np.zeros((6, size)) if least == 0 else lowered, np.ones(size, bool)).solve(right)
        if least > 0:
            assert found == pytest.approx(np.linalg.solve(whole - (values[0] - least) * np.eye(size), right), rel=1e-9)
        else:
            assert np.isnan(found).all() and len(found) == size


def jerk_squared(spline):
    """Integral by x of the squared jerk, which is quadratic in each piece: Simpson's rule twice as fine as exact."""
    x = np.linspace(spline.knots[:-1], spline.knots[1:], 9, axis=1)
    x[:, -1] = np.nextafter(x[:, -1], 0)
    weights = np.array([1, 4, 2, 4, 2, 4, 2, 4, 1]) / 24
    return float(np.sum(np.diff(spline.knots) * np.sum(spline(x)[3] ** 2 * weights, axis=1)))


def test_it_is_the_smoothest_of_all_motions_in_the_band():
    """Of all curves through given values the quintic spline has the least jerk, so the least over all values in the
    band is the least there is; it is found here value by value, each to its best in turn."""
    x, ends = np.linspace(0, 1, 12), ((0.0, 0.0), (0.0, 0.0))
    rng = np.random.default_rng(5)
    wanted, within = x**2 * (3 - 2 * x) + rng.uniform(-0.02, 0.02, 12) * (x % 1 > 0), 0.02
    free = np.eye(12)[1:-1]
    base = np.where(np.isin(x, [0, 1]), wanted, 0)
    places = np.linspace(0, 1, 4001)
    base_jerk = spline_through(x, base, ends)(places)[3]
    jerks = np.array([spline_through(x, unit, ends)(places)[3] for unit in free])
    step = np.append(np.full(4000, 1 / 4000), 1 / 4000)
    step[[0, -1]] /= 2
    matrix, pull = (jerks * step) @ jerks.T, (jerks * step) @ base_jerk
    low, high = wanted[1:-1] - within, wanted[1:-1] + within
    v = wanted[1:-1].copy()
    for _ in range(20_000):
        before = v.copy()
        for k in range(10):
            v[k] = min(max(v[k] - (matrix[k] @ v + pull[k]) / matrix[k, k], low[k]), high[k])
        if np.abs(v - before).max() < 1e-13:
            break
    values = base.copy()
    values[1:-1] = v
    best = jerk_squared(spline_through(x, values, ends))
    found = smoothest_within(x, wanted, ends, within)
    assert np.abs(found(x)[0] - wanted).max() <= within * (1 + 1e-9)
    assert best * (1 - 1e-3) < jerk_squared(found) < 1.05 * best
    assert jerk_squared(spline_through(x, wanted, ends)) > 3 * best


@pytest.mark.campaign
def test_noisy_rows_of_a_known_law_give_its_acceleration_back():
    near, by_decimals = (Program([LiftTable(**how, rows=rows())]) for how in ({"within": 0.006}, {"decimals": 3}))
    assert missed(near) < 0.01 * PEAK
    assert missed(by_decimals) > 3 * PEAK  # the pitfall
    for program, within in ((near, 0.006), (by_decimals, 0.75e-3)):
        angles, lifts = np.array(rows()).T
        # The last row is the first again.
        assert np.abs(program.motion(np.radians(angles)).lift - lifts)[:-1].max() <= within * (1 + 1e-9)


@pytest.mark.parametrize(("count", "size"), [(90, 1e-6), (180, 1e6)])
def test_any_size_and_any_number_of_rows(count, size):
    x = np.linspace(0, 1, count + 1)
    lifts = size * (law(2 * np.pi * x)[0] + np.random.default_rng(1).uniform(-NOISE, NOISE, count + 1))
    lifts[-1] = lifts[0]
    found = smoothest_within(x, lifts, None, 1.1 * NOISE * size)
    assert np.abs(found(x)[0] - lifts)[:-1].max() <= 1.1 * NOISE * size * (1 + 1e-9)
    places = np.linspace(0, 1, 3000)
    assert found(places)[2] == pytest.approx(size * (2 * np.pi) ** 2 * law(2 * np.pi * places)[1], abs=size * 39.5)
    for order in range(4):
        assert found(np.array([0.0]))[order] == pytest.approx(
            found(np.array([1.0]))[order], abs=size * 0.1**7 * 400**order
        )


def test_rows_between_others_meet_them_and_stay_in_the_band():
    angles = np.radians(np.linspace(60, 180, 121))
    rise = Program(
        [gk.Dwell(end_deg=60), gk.Rise("4-5-6-7", rise=20, end_deg=180), gk.Return("cycloidal", end_deg=360)]
    )
    lifts = rise.motion(angles).lift + np.random.default_rng(3).uniform(-NOISE, NOISE, 121)
    lifts[[0, -1]] = 0, 20
    table = LiftTable(within=NOISE, rows=tuple(zip(np.degrees(angles).tolist(), lifts.tolist())))
    program = Program([gk.Dwell(end_deg=60), table, gk.Return("cycloidal", end_deg=360)])
    assert (program.jumps.lift == 0).all() and (program.jumps.velocity == 0).all()
    assert (program.jumps.acceleration == 0).all()
    inside = angles[:-1]
    assert np.abs(program.motion(inside).lift - lifts[:-1]).max() <= NOISE * (1 + 1e-9)
    between = np.linspace(angles[0], angles[-1] - 1e-9, 4000)
    wrong = np.abs(program.motion(between).acceleration - rise.motion(between).acceleration).max()
    assert wrong < 0.04 * rise.motion(between).acceleration.max()


def test_a_table_may_end_as_far_from_its_start_as_the_band_is_wide():
    given = rows(np.radians(np.arange(0, 361, 2)), last=10.003)
    assert abs(given[0][1] - given[-1][1]) > 1e-3
    program = Program([LiftTable(within=0.01, rows=given)])
    assert (program.jumps.lift == 0).all() and missed(program) < 0.5
    with pytest.raises(gk.DesignError):
        Program([LiftTable(within=1e-4, rows=given)])


@pytest.mark.parametrize(("how", "room"), [({"within": 0.2}, 0.2), ({"decimals": 1}, 0.075), ({"decimals": 12}, 1e-7)])
def test_table_may_start_within_its_band_of_the_segment_before(how, room):
    """Its lift at the start is then that of the segment before: nothing jumps."""

    def program(off):
        lifts = 2 + off, *(2 + 3 * np.sin(np.pi * k / 12) ** 2 for k in range(1, 12)), 2.0
        table = LiftTable(rows=tuple((180.0 + 10 * k, float(lift)) for k, lift in enumerate(lifts)), **how)
        rest = (gk.Dwell(end_deg=330), gk.Return("cycloidal", end_deg=360))
        return Program([gk.Rise("cycloidal", rise=2, end_deg=180), table, *rest])

    for off in (0.5 * room, -0.5 * room):
        assert np.abs(program(off).jumps.lift).max() == 0
        assert program(off).motion(np.pi).lift == pytest.approx(2, abs=1e-12)
    for off in (1.5 * room, -1.5 * room):
        with pytest.raises(gk.DesignError):
            program(off)


def checks(**how):
    cam = gk.Cam(gk.TranslatingRoller(10), Program([LiftTable(**how)]), 60)
    found = DiskCamRecipe(cam=cam).design_checks
    return [check for check in found if "scatter" in check.name]


@pytest.mark.campaign
def test_a_check_fails_for_noisy_rows_followed_too_closely_and_the_band_that_it_names_passes():
    given = rows(TURN[::2])
    (failed,) = checks(decimals=3, rows=given)
    assert not failed.passed and failed.value == pytest.approx(
        missed(Program([LiftTable(3, rows=given)])) / PEAK, rel=0.05
    )
    advised = float(failed.advice.split("at least ")[1].split()[0])
    assert NOISE < advised < 3 * NOISE
    assert all(check.passed for check in checks(within=advised, rows=given))
    assert not checks(within=advised / 10, rows=given)[0].passed


def test_the_scatter_is_reported_where_it_can_be_and_else_there_is_no_check():
    fine = np.linspace(0, 2 * np.pi, 1001)
    for noise in (1e-4, 1e-2):
        fit = Program([LiftTable(15, rows=rows(fine, noise, 12)[:-1])]).tables[0]
        assert fit.scatter == pytest.approx(noise / np.sqrt(3), rel=0.15)
    few = rows(np.linspace(0, 2 * np.pi, 13), 0)
    assert np.isnan(Program([LiftTable(3, rows=few)]).tables[0].noise) and not checks(decimals=3, rows=few)
    # Rows so coarse that the motion itself bends between them.
    x = np.linspace(0, 1, 41)
    assert np.isnan(TableFit(x, 20 - 10 * np.cos(8 * np.pi * x), None, 0.0).scatter)


def scattered(line, sigma=1e-3):
    """Rows in whole degrees that scatter about a function of the cam angle in deg."""
    angles = np.arange(0.0, 91.0)
    lifts = line(angles) + np.random.default_rng(4).normal(0, sigma, len(angles))
    lifts[[0, -1]] = line(angles[[0, -1]])
    return tuple(zip((angles + 90).tolist(), lifts.tolist()))


@pytest.mark.parametrize("slope", by_default([0, 0.05], [0.05]))
def test_rows_that_scatter_about_a_rest_or_a_steady_motion_are_nothing_but_noise(slope):
    """Their motion has no acceleration that the noise could be a share of."""
    up = {"end_velocity_per_rad": np.degrees(slope), "end_acceleration_per_rad2": 0}
    down = {"start_velocity_per_rad": np.degrees(slope), "start_acceleration_per_rad2": 0}
    rest = {f"{end}_{name}": 0 for end in ("start", "end") for name in ("velocity_per_rad", "acceleration_per_rad2")}

    def program(**entries):
        rows = scattered(lambda angles: 5 + slope * angles)
        return Program([gk.cam.LiftPolynomial(rise=5, end_deg=90, **(rest | up)), LiftTable(rows=rows, **entries),
                        gk.cam.LiftPolynomial(end_lift=0, end_deg=360, **(rest | down))])  # fmt: skip

    fit = program(within=1e-5).tables[1]
    assert fit.noise == np.inf
    check = next(
        c for c in gk.cam.cam_checks(gk.Cam(gk.TranslatingRoller(5), program(within=1e-5), 60)) if "scatter" in c.name
    )
    assert not check.passed and check.value == np.inf
    # As wide as advised, none of the noise is left.
    assert program(within=float(check.advice.split("at least ")[1].split()[0])).tables[1].noise == 0


@pytest.mark.parametrize("wrong", [np.nan, -1, "3", np.array([3.0, 4.0])])
@pytest.mark.parametrize(
    ("make", "field"),
    [
        (lambda v: gk.TranslatingRoller(v), "roller_radius"),
        (lambda v: gk.OscillatingRoller(10, v, 80), "pivot_distance"),
        (lambda v: gk.OscillatingFlat(v), "pivot_distance"),
        (lambda v: gk.Cam(gk.TranslatingFlat(), Program([gk.Dwell(end_deg=360)]), v), "base_radius"),
        (lambda v: gk.Cam(v, Program([gk.Dwell(end_deg=360)]), 40), "follower"),
        (lambda v: gk.Cam(gk.TranslatingFlat(), v, 40), "program"),
        (lambda v: Program(v), "segments"),
        (lambda v: Program([gk.Rise(v, rise=3, end_deg=90), gk.Return("harmonic", end_deg=360)]), "program[0].law"),
        (lambda v: Program([gk.Dwell(end_deg=v)]), "program[0].end_deg"),
    ],
)
def test_invalid_sizes_are_refused(make, field, wrong):
    with pytest.raises(gk.DesignError) as refused:
        make(wrong)
    assert refused.value.field in (field, "program[0]")
