"""Peak factors of laws and infinite jerk, against the handbooks' numbers and a fine walk over the motion."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.cam.program.laws import LAWS

pi, inf = np.pi, np.inf
# Between two dwells, as the handbooks of cam design print them.
FACTORS = {
    "uniform": (1, inf, inf),
    "parabolic": (2, 4, inf),
    "harmonic": (pi / 2, pi**2 / 2, inf),
    "cycloidal": (2, 2 * pi, 4 * pi**2),
    "modified-trapezoid": (2, 8 * pi / (2 + pi), 32 * pi**2 / (2 + pi)),
    "modified-sine": (4 * pi / (4 + pi), 4 * pi**2 / (4 + pi), 16 * pi**3 / (4 + pi)),
    "3-4-5": (15 / 8, 10 / np.sqrt(3), 60),
    "4-5-6-7": (35 / 16, 84 * np.sqrt(5) / 25, 52.5),
}


def dwelling(law, swings=False):
    lift = {"rise_deg" if swings else "rise": 12}
    return gk.Program([gk.Dwell(end_deg=40), gk.Rise(law, end_deg=110, **lift), gk.Dwell(end_deg=130),
                       gk.Dwell(end_deg=200), gk.Return("cycloidal", end_deg=360)])  # fmt: skip


@pytest.mark.parametrize(("law", "swings"), [(law, k % 2 == 0) for k, law in enumerate(LAWS)])
def test_factors_between_dwells_agree_with_handbooks(law, swings):
    peaks = dwelling(law, swings).peaks
    assert list(peaks) == [1, 4]
    assert peaks[1].factors == pytest.approx(FACTORS[law], rel=1e-9)
    assert peaks[4].factors == pytest.approx(FACTORS["cycloidal"], rel=1e-9)
    rise, angle = np.radians(12) if swings else 12, np.radians(70)
    sizes = [factor * rise / angle**k for k, factor in enumerate(FACTORS[law], 1)]
    assert [peaks[1].velocity, peaks[1].acceleration, peaks[1].jerk] == pytest.approx(sizes, rel=1e-9)


def test_a_harmonic_motion_without_dwells_has_a_finite_jerk():
    program = gk.Program([gk.Rise("harmonic", rise=12, end_deg=180), gk.Return("harmonic", end_deg=360)])
    assert [peaks.factors for peaks in program.peaks.values()] == 2 * [pytest.approx((pi / 2, pi**2 / 2, pi**3 / 2))]


def test_of_two_motions_that_meet_with_a_step_the_one_that_is_not_at_rest_has_the_infinite_jerk():
    program = gk.Program([gk.Rise("harmonic", rise=12, end_deg=180), gk.Return("cycloidal", end_deg=360)])
    assert [peaks.jerk == inf for peaks in program.peaks.values()] == [True, False]


@pytest.mark.parametrize("segment", [
    gk.cam.OptimisedSpline(12, rise=7, end_deg=120), gk.cam.OptimisedPolynomial(9, rise=7, end_deg=120),
    gk.cam.LiftPolynomial(rise=7, end_deg=120, start_velocity_per_rad=0, start_acceleration_per_rad2=0,
                          end_velocity_per_rad=0, end_acceleration_per_rad2=0, through=((60.0, 2.0),)),
])  # fmt: skip
def test_peaks_are_those_of_a_fine_walk(segment):
    program = gk.Program([gk.Dwell(end_deg=20), segment, gk.Return("4-5-6-7", end_deg=360)])
    motion = program.motion(np.radians(np.linspace(20, 120 - 1e-9, 200_001)))
    peaks = program.peaks[1]
    for name in ("velocity", "acceleration", "jerk"):
        assert getattr(peaks, name) == pytest.approx(np.abs(getattr(motion, name)).max(), rel=1e-7)


def test_a_segment_that_ends_where_it_starts_has_peaks_but_no_factors():
    points = tuple((float(k), 5 - 5 * np.cos(np.radians(k))) for k in range(0, 361, 30))
    peaks = gk.Program([gk.cam.LiftSpline(points=points)]).peaks[0]
    assert peaks.velocity == pytest.approx(5, rel=1e-3) and np.isnan(peaks.factors).all()


def steps_of(program, swings=False):
    follower = gk.OscillatingFlat(110) if swings else gk.TranslatingRoller(6)
    return {c.name: c for c in gk.cam.cam_checks(gk.Cam(follower, program, 60)) if c.name.startswith("jump in")}


@pytest.mark.parametrize(("law", "swings"), [(law, k % 2 == 0) for k, law in enumerate(LAWS)])
def test_a_step_of_acceleration_fails_a_check(law, swings):
    failed = steps_of(dwelling(law, swings), swings)
    _, acceleration, jerk = FACTORS[law]
    assert set(failed) == {name for name, infinite in (
        ("jump in velocity", acceleration == inf), ("jump in acceleration", jerk == inf and acceleration < inf),
    ) if infinite}  # fmt: skip
    if (step := failed.get("jump in acceleration")) is not None:
        size = np.radians(12) if swings else 12
        largest = 2 * acceleration if law == "parabolic" else acceleration
        assert step.value == pytest.approx(largest * size / np.radians(70) ** 2) and not step.passed


def test_the_table_has_infinite_rates_at_joints_with_a_step_and_nowhere_else():
    program = gk.Program([gk.Dwell(end_deg=40.5), gk.Rise("harmonic", rise=12, end_deg=110),
                          gk.Return("uniform", end_deg=360)])  # fmt: skip
    degrees = np.arange(0, 361, 0.5)
    table = gk.cam.cam_table(gk.Cam(gk.TranslatingRoller(6), program, 60), 2.0, np.radians(degrees))
    assert degrees[np.isinf(table["jerk"])].tolist() == [0, 40.5, 110, 360]
    assert degrees[np.isinf(table["acceleration"])].tolist() == [0, 110, 360]
    assert np.isfinite(table["velocity"]).all()
