"""Lantern pinions by second roads: the epicycloid of the pins' centres, and pins rolled past the wheel."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.gear.conjugate.conjugate import conjugate
from geomkin.gear.conjugate.shaping_gears import LanternPinion
from geomkin.plane import region
from geomkin.plane.roulettes import Cycloid
from tests.campaign import by_default

from .sweeping import inner_points, least_clearance

CASES = [
    pytest.param(10, 30, 6.0, 4.0, 0.0, False, id="wheel"),
    pytest.param(10, 30, 6.0, 4.0, 1.0, False, id="wheel with room"),
    pytest.param(12, 48, 5.5, 7.0, 0.5, False, id="long teeth"),
    pytest.param(8, 8, 3.0, 4.0, 0.2, False, id="of one size"),
    pytest.param(10, 30, 6.0, 2.0, 0.5, True, id="ring"),
    pytest.param(6, 7, 2.0, 3.0, 0.0, True, id="ring with one tooth more"),
]


def wheel(pins, teeth, diameter, addendum, clearance, internal):
    pinion = LanternPinion(pins, 4, diameter)
    return pinion, conjugate(pinion.cutter(clearance), pins, pinion.pitch_radius, teeth, addendum, internal)


@pytest.mark.parametrize(("pins", "teeth", "diameter", "addendum", "clearance", "internal"), CASES[:4])
def test_flanks_are_parallel_to_the_epicycloid_of_the_pin_centres(pins, teeth, diameter, addendum, clearance, internal):
    pinion, mate = wheel(pins, teeth, diameter, addendum, clearance, internal)
    z = mate.contact(np.linspace(0.001, 0.999, 500)).mate
    z = z[np.isfinite(z)]
    # The pin on +y faces the wheel from its own space: half a pitch from the tooth on the wheel's +y.
    space = -1j * np.conj(mate.pose.direction)
    path = Cycloid(mate.pitch_radius, pinion.pitch_radius, -1.0, 1.0)
    off = gk.nearest(gk.plane.Moved(path, gk.plane.Pose(0j, space)), z)[1]
    assert len(z) > 20 and np.abs(off - diameter / 2).max() < 1e-12 * mate.tip_radius


@pytest.mark.parametrize(
    ("pins", "teeth", "diameter", "addendum", "clearance", "internal"), by_default(CASES, slice(0, None, 2))
)
def test_the_rolling_pin_never_enters_the_wheel_and_touches_it_everywhere(
    pins, teeth, diameter, addendum, clearance, internal
):
    pinion, mate = wheel(pins, teeth, diameter, addendum, clearance, internal)

    def off_slot(z):
        beyond = np.clip(z.imag - pinion.pitch_radius, 0, clearance)
        return np.abs(z - 1j * (pinion.pitch_radius + beyond)) - diameter / 2

    least = least_clearance(mate, inner_points(mate.outline.piece), off_slot)
    assert least.min() > -1e-9 and np.abs(least).max() < 1e-9


@pytest.mark.parametrize(
    ("pins", "teeth", "diameter", "addendum", "clearance", "internal"), by_default(CASES[1::3], slice(1))
)
def test_all_pins_clear_the_finished_wheel_through_a_pitch(pins, teeth, diameter, addendum, clearance, internal):
    pinion, mate = wheel(pins, teeth, diameter, addendum, clearance, internal)
    tolerance = 1e-4
    outline = gk.flatten(mate.outline, tolerance)
    assert region.is_simple(outline)
    circles = [gk.flatten(c, tolerance) for c in pinion.circles]
    ratio = pins / teeth * (1 if internal else -1)
    for angle in np.linspace(0, 2 * np.pi / pins, 6):

        def common(extra, angle=angle):
            body = mate.pose.origin + mate.pose.direction * outline * np.exp(1j * (ratio * angle + extra))
            both = [region.overlap([c * np.exp(1j * angle)], [body]) for c in circles]
            full = sum(abs(gk.area(gk.plane.Polyline(c))) for c in circles)
            return full - sum(both) if internal else sum(both)

        assert common(0.0) < 20 * tolerance
        assert max(common(0.003), common(-0.003)) > 20 * tolerance


def test_the_longest_teeth_named_in_the_refusal_leave_a_tip():
    with pytest.raises(gk.DesignError) as caught:
        wheel(10, 30, 6.0, 9.0, 0.0, False)
    most = float(caught.value.remedy.split("at most ")[1].split(",")[0])
    assert 0 < wheel(10, 30, 6.0, most, 0.0, False)[1].tip_thickness < 0.2


@pytest.mark.parametrize(("teeth", "addendum"), by_default([(20, 3.0), (48, 4.0)], slice(1)))
def test_pins_in_a_ring_always_touch_it_on_their_outer_sides_too(teeth, addendum):
    pinion, mate = wheel(12, teeth, 6.0, addendum, 0.0, True)
    assert mate.contact_ratio(0.0, 2.0) > max(1.0, mate.contact_ratio(0.0, 1.0))
    for turn in np.linspace(0, 2 * np.pi / 12, 4):
        centres = np.array([circle.centre for circle in pinion.circles]) * np.exp(1j * turn)
        turned = gk.plane.Pose(mate.pose.origin, mate.pose.direction * np.exp(1j * turn * 12 / teeth))
        away = gk.nearest(mate.outline, turned.locate(centres))[1] - 3.0
        assert away.min() > -1e-9 and np.sum(away < 1e-9) >= 2  # one on each side
