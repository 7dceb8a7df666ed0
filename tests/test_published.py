"""Cases worked by hand or by brute force; those in print are in `docs/published.toml`."""

import numpy as np
import pytest

import geomkin as gk
from tests.tables import gears


def test_the_other_branch_mirrors_a_linkage_and_both_end_where_it_does_not_close():
    linkage = gk.FourBar(ground=600, crank=300, coupler=360, rocker=360)
    drive = np.radians([0, 30, 60, 90, 270, 300, 330, 120, 150, 180, 210, 240])
    one, other = gk.move(linkage, drive, 1, 10, -30), gk.move(linkage, -drive, -1, -10, 30)
    assert one.assembled.tolist() == other.assembled.tolist() == 7 * [True] + 5 * [False]
    for body in ("coupler", "rocker"):
        first, second = one[body], other[body]
        assert second.direction[:7] == pytest.approx(first.direction[:7].conj())
        assert second.omega[:7] == pytest.approx(-first.omega[:7])
        assert second.alpha[:7] == pytest.approx(-first.alpha[:7])


@pytest.mark.parametrize(("teeth", "radius"), gears.FORM_RADIUS.items())
def test_form_radius_of_module_2_gears(teeth, radius):
    gear = gk.SpurGear(teeth, 2)
    assert gear.form_radius == pytest.approx(radius, rel=2e-15)
    assert gear.is_undercut == (teeth < 17.0973)


@pytest.mark.parametrize(("teeth", "thickness"), gears.TIP_THICKNESS.items())
def test_tip_thickness_in_modules(teeth, thickness):
    assert gk.SpurGear(teeth, 1).tip_thickness == pytest.approx(thickness, abs=5.1e-5)


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
