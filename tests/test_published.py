"""Examples in print, each with its source; where the print is wrong the table says so."""

import numpy as np
import pytest

import geomkin as gk
from tests.tables import four_bars, gears, iterations, slider_cranks


def degrees(direction):
    return np.degrees(np.angle(direction))


@pytest.mark.parametrize("crank_deg", four_bars.EXAMPLE_25_1)
def test_theory_of_machines_example_25_1(crank_deg):
    linkage = gk.FourBar(ground=600, crank=300, coupler=360, rocker=360)
    m = gk.move(linkage, [np.radians(crank_deg)], speed=10, acceleration=-30)
    got = degrees(m.rocker.direction), degrees(m.coupler.direction), m.rocker.omega, m.coupler.omega
    got = [v[0] for v in (*got, m.rocker.alpha, m.coupler.alpha)]
    assert got == pytest.approx(four_bars.EXAMPLE_25_1[crank_deg], abs=0.0051)


def test_theory_of_machines_example_25_1_does_not_close_from_120_to_240():
    linkage = gk.FourBar(ground=600, crank=300, coupler=360, rocker=360)
    assert not gk.move(linkage, np.radians([120, 150, 180, 210, 240])).assembled.any()


def test_ame_352_four_bar_and_its_coupler_point():
    linkage = gk.FourBar(5, 2, 6, 4, coupler_point=5.5 * np.exp(1j * np.radians(22.5)))
    m = gk.move(linkage, [np.radians(120)], speed=1, acceleration=-1)
    got = [degrees(m.coupler.direction)[0], degrees(m.rocker.direction)[0], m.coupler.omega[0], m.rocker.omega[0]]
    assert got == pytest.approx(four_bars.AME_352, abs=5.1e-4)
    assert [m.coupler.alpha[0], m.rocker.alpha[0]] == pytest.approx(four_bars.AME_352_ALPHA, abs=5.1e-7)
    point = m.point("coupler_point")
    got = [point.position[0], point.velocity[0], point.acceleration[0]]
    assert got == pytest.approx(four_bars.AME_352_POINT, abs=8e-5)


def test_theory_of_machines_example_25_1_mirrors_on_the_other_branch():
    linkage = gk.FourBar(ground=600, crank=300, coupler=360, rocker=360)
    for crank_deg, row in four_bars.EXAMPLE_25_1.items():
        m = gk.move(linkage, [-np.radians(crank_deg)], branch=-1, speed=-10, acceleration=30)
        got = [degrees(m.rocker.direction)[0], degrees(m.coupler.direction)[0], m.rocker.omega[0], m.coupler.alpha[0]]
        assert got == pytest.approx([-row[0], -row[1], -row[2], -row[5]], abs=0.0051)


def example_25_2(crank_deg):
    linkage = gk.SliderCrank(crank=200, coupler=750, offset=50)
    return gk.move(linkage, [np.radians(crank_deg)], speed=20, acceleration=10)


@pytest.mark.parametrize("crank_deg", slider_cranks.EXAMPLE_25_2)
def test_theory_of_machines_example_25_2(crank_deg):
    m = example_25_2(crank_deg)
    slide = m.slide("slide")
    got = [degrees(m.coupler.direction)[0], slide.velocity[0] / 1000, m.coupler.omega[0]]
    assert got == pytest.approx(slider_cranks.EXAMPLE_25_2[crank_deg], abs=0.0051)
    right = slider_cranks.EXAMPLE_25_2_SLIDER_ACCELERATION[crank_deg]
    assert slide.acceleration[0] / 1000 == pytest.approx(right, abs=0.0051)
    rod = slider_cranks.EXAMPLE_25_2_ROD_ACCELERATION.get(crank_deg)
    assert rod is None or m.coupler.alpha[0] == pytest.approx(rod, abs=0.0051)


@pytest.mark.parametrize("crank_deg", slider_cranks.EXAMPLE_25_2_ROD)
def test_theory_of_machines_example_25_2_prints_wrong_rod_velocities(crank_deg):
    m = example_25_2(crank_deg)
    assert m.coupler.omega[0] == pytest.approx(slider_cranks.EXAMPLE_25_2_ROD[crank_deg], abs=0.0051)
    # What the print has is the right value times the square of cos(beta).
    printed = slider_cranks.EXAMPLE_25_2_PRINTED_ROD[crank_deg]
    assert m.coupler.omega[0] * m.coupler.direction[0].real ** 2 == pytest.approx(printed, abs=0.0051)
    wrong = slider_cranks.EXAMPLE_25_2_SLIDER_PRINTED.get(crank_deg)
    assert wrong is None or abs(m.slide("slide").acceleration[0] / 1000 - wrong) > 0.1


def test_ame_352_slider_crank():
    m = gk.move(gk.SliderCrank(crank=0.12, coupler=0.26), [np.radians(65)], speed=1.6)
    slide = m.slide("slide")
    got = [degrees(m.coupler.direction), slide.displacement, m.coupler.omega, slide.velocity]
    got = [v[0] for v in (*got, m.coupler.alpha, slide.acceleration)]
    assert got == pytest.approx(slider_cranks.AME_352, abs=5.1e-4)


@pytest.mark.parametrize("estimate", iterations.CUBIC)
def test_newton_raphson_on_a_cubic(estimate):
    root = gk.linkage.newton_raphson(lambda x: x**3 - 3 * x**2 - 10 * x + 24, lambda x: 3 * x**2 - 6 * x - 10, estimate)
    wanted = iterations.CUBIC[estimate]
    assert root.converged and root.path[1 : len(wanted) + 1, 0] == pytest.approx(wanted, abs=5.1e-5)


def test_newton_raphson_on_the_loop_of_a_four_bar():
    crank = 2 * np.exp(1j * np.radians(120))

    def loop(x):
        z = crank + 6 * np.exp(1j * x[0]) - 5 - 4 * np.exp(1j * x[1])
        return [z.real, z.imag]

    def jacobian(x):
        return [[-6 * np.sin(x[0]), 4 * np.sin(x[1])], [6 * np.cos(x[0]), -4 * np.cos(x[1])]]

    root = gk.linkage.newton_raphson(loop, jacobian, np.radians([30, 90]))
    assert root.path[1] - root.path[0] == pytest.approx(iterations.FOUR_BAR_STEP, abs=5.1e-5)
    assert root.converged and np.degrees(root.path[4]) == pytest.approx(four_bars.AME_352[:2], abs=5.1e-4)


@pytest.mark.parametrize(("teeth", "radius"), gears.FORM_RADIUS.items())
def test_form_radius_of_module_2_gears(teeth, radius):
    gear = gk.SpurGear(teeth, 2)
    assert gear.form_radius == pytest.approx(radius, rel=2e-15)
    assert gear.is_undercut == (teeth < 17.0973)


@pytest.mark.parametrize(("teeth", "thickness"), gears.TIP_THICKNESS.items())
def test_tip_thickness_in_modules(teeth, thickness):
    assert gk.SpurGear(teeth, 1).tip_thickness == pytest.approx(thickness, abs=5.1e-5)


@pytest.mark.parametrize(("angle", "limit"), gears.UNDERCUT_LIMIT.items())
def test_undercut_limit_of_sharp_deep_racks_lies_between_two_tooth_counts(angle, limit):
    # A rack whose straight flank reaches one module deep, as the textbook limit assumes.
    rounding = 0.2
    depth = 1 + rounding * (1 - np.sin(np.radians(angle)))
    rack = gk.gear.RackCutter(pressure_angle_deg=angle, dedendum=depth, tip_radius=rounding)
    below, above = int(np.floor(limit)), int(np.ceil(limit))
    assert gk.SpurGear(below, 1, rack=rack).is_undercut
    assert not gk.SpurGear(above, 1, rack=rack).is_undercut


def test_cam_worked_case_with_offset():
    """Offset 12, counterclockwise, base 40, roller 10, rise 20: profile, pressure angle, pitch radius."""
    program = gk.Program(
        [
            gk.Dwell(end_deg=60),
            gk.Rise("3-4-5", rise=20, end_deg=180),
            gk.Dwell(end_deg=210),
            gk.Return("cycloidal", end_deg=360),
        ]
    )
    cam = gk.Cam(gk.TranslatingRoller(10, 12), program, 40, "counterclockwise")
    angles = np.radians([90, 250])
    profile = [40.616209122 - 11.619222011j, -56.485225210 - 10.920662631j]
    assert cam.profile.point(angles) == pytest.approx(profile, abs=6e-10)
    assert np.degrees(gk.pressure_angle(cam, angles)) == pytest.approx([-2.182224728, -17.115454754], abs=6e-10)
    assert 1 / gk.plane.convexity(cam.pitch_curve, angles) == pytest.approx([104.124385915, 53.972778506], abs=6e-10)


def test_cam_worked_case_of_a_harmonic_lift_equal_to_the_prime_radius():
    program = gk.Program([gk.Rise("harmonic", rise=2, end_deg=180), gk.Return("harmonic", end_deg=360)])
    cam = gk.Cam(gk.TranslatingRoller(1), program, base_radius=1)
    angles = np.linspace(0, 2 * np.pi, 20001)
    leaning = np.abs(gk.pressure_angle(cam, angles))
    assert leaning.max() == pytest.approx(np.arcsin(1 / 3), abs=1e-8)
    assert np.degrees(angles[:10001][leaning[:10001].argmax()]) == pytest.approx(70.5288, abs=0.02)
    radius = 1 / gk.plane.convexity(cam.pitch_curve, angles)
    assert [radius[0], radius[10000]] == pytest.approx([4, 3.2])
    assert radius.min() == pytest.approx(2 * np.sqrt(2), abs=1e-7)
