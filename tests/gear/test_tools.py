"""Tools as they are shown: a pinion cutter by its distance from each place, and both tools rolled past what they cut."""

import numpy as np
import pytest
import shapely

import geomkin as gk

from .test_ring import off_cutter

CUTTERS = {
    "sharp": gk.gear.PinionCutter(12, tip_radius=0),
    "few teeth": gk.gear.PinionCutter(6, 30, 0.8, 0.05),
    "hardly a root": gk.gear.PinionCutter(4, 25, 1.05, 0.0, -0.2),
    "shifted": gk.gear.PinionCutter(40, 20, 1.1, 0.3, 0.4),
}


def polygon(curve, tolerance=1e-5):
    return shapely.Polygon(gk.plane.xy(gk.flatten(curve, tolerance)))


@pytest.mark.parametrize("name", CUTTERS)
def test_a_pinion_cutter_is_shown_as_its_teeth_with_straight_sides_below_the_base_circle(name):
    cutter, module = CUTTERS[name], 3.0
    z = gk.flatten(cutter.edge(module), 1e-5)
    assert shapely.Polygon(gk.plane.xy(z)).is_valid and np.angle(z[1:] / z[:-1]).sum() > 0
    radius, base = np.abs(z), cutter.base_radius * module
    outer = module * (cutter.teeth / 2 + cutter.addendum + cutter.profile_shift)
    deep = outer - 2 * cutter.addendum * module
    assert radius.max() == pytest.approx(outer, rel=1e-9)
    assert radius.min() == pytest.approx(min(deep, base) if deep > 0 else base, rel=1e-4)
    cuts = radius > base * (1 + 1e-9)
    assert np.abs(off_cutter(cutter, module, z[cuts] / 1j)).max() < 1e-9
    # Below, each side is straight towards the axis.
    pitch = 2 * np.pi / cutter.teeth
    beside = np.abs(np.mod(np.angle(z[~cuts] / 1j) + pitch / 2, pitch) - pitch / 2)
    start = z[cuts][np.argmin(radius[cuts])]
    edge = np.abs(np.mod(np.angle(start / 1j) + pitch / 2, pitch) - pitch / 2)
    inside = (radius[~cuts] > radius.min() * (1 + 1e-3)) & (radius[~cuts] < base * (1 - 1e-3))
    assert beside[inside] == pytest.approx(edge, abs=1e-4) and beside.min() > edge - 1e-4
