"""Rims of gears and rings, told in modules: the same for gears of one form whatever their size."""

import pytest

import geomkin as gk
from geomkin.gear.checks import gear_checks
from geomkin.gear.parts.gears import GearStock, Web


def value(checks, name):
    (found,) = [c for c in checks if c.name == name]
    assert found.unit == "modules" and found.limit == 1
    return found


@pytest.mark.parametrize("module", [0.1, 50.0])
def test_rim_under_the_teeth_is_reported_in_modules(module):
    """24 teeth and a dedendum of 1.25 modules: the roots lie at 10.75 modules, a bore of 18 leaves 1.75."""
    gear = gk.SpurGear(24, module)
    plain = value(gear_checks(gear, GearStock(bore=18 * module).rim_under(gear)), "rim under the teeth")
    assert plain.value == pytest.approx(1.75, rel=1e-12) and plain.passed
    thin = value(gear_checks(gear, GearStock(bore=20 * module).rim_under(gear)), "rim under the teeth")
    assert thin.value == pytest.approx(0.75, rel=1e-12) and not thin.passed
    web = Web(hub=8 * module, rim=1.5 * module, spoke_width=module)
    spoked = value(gear_checks(gear, GearStock(bore=4 * module, web=web).rim_under(gear)), "rim under the teeth")
    assert spoked.value == pytest.approx(1.5, rel=1e-12)


@pytest.mark.parametrize("module", [2.0, 50.0])
def test_rim_outside_a_ring_s_teeth_is_reported_in_modules(module):
    ring = gk.RingGear(60, module)
    for rim in (0.9, 1.1, 4.0):
        check = value(gear_checks(ring, rim * module), "rim outside the teeth")
        assert check.value == pytest.approx(rim, rel=1e-12) and check.passed == (rim >= 1)
