"""Checks of gears are in modules: a larger set of the same form has the same checks."""

import dataclasses

import pytest

import geomkin as gk
from geomkin.gear.conjugate.conjugate import BEYOND, CUTS, MISSES, TRIMMED, Untouched


def gear(module):
    small = gk.SpurGear(8, module)
    return gk.gear.gear_checks(small, name="pinion"), gk.gear.gear_checks(small, rim=0.7 * module)


def ring(module):
    held = gk.RingGear(60, module, 0.1)
    return gk.gear.gear_checks(held), gk.gear.gear_checks(held, rim=1.5 * module, name="ring")


def pair(module):
    first, second = gk.SpurGear(11, module, 0.1), gk.SpurGear(30, module)
    return (gk.gear.mesh_checks(gk.GearPair(first, second, 20.7 * module), "a"),)


def rack(module):
    return (gk.gear.mesh_checks(gk.gear.RackPair(gk.SpurGear(9, module), gk.gear.GearRack(10, module))),)


def planets(module):
    sun, planet, outer = gk.SpurGear(12, module), gk.SpurGear(24, module), gk.RingGear(60, module)
    return tuple(gk.gear.planetary_checks(gk.gear.PlanetarySet(sun, planet, outer, count)) for count in (2, 3, 1))


def mate(module):
    tooth = gk.SpurGear(24, module).outline.piece
    held = gk.conjugate(tooth, 24, 12 * module, 7, 1.0 * module)
    return gk.gear.conjugate_checks(held, module), (gk.gear.touch_check(held, module),)


@pytest.mark.parametrize("made", [gear, ring, pair, rack, planets, mate])
def test_larger_all_over_is_judged_alike(made):
    small, large = (made(module) for module in (1.0, 5.0))
    for one, other in zip(small, large, strict=True):
        assert one and [c.name for c in one] == [c.name for c in other]
        assert [c.value for c in one] == pytest.approx([c.value for c in other], rel=1e-6, abs=1e-7)
    # It is no table of zeros that is compared.
    assert any(c.value and c.unit == "modules" for found in small for c in found) or made in (pair, rack)


def test_a_rim_is_reported_where_it_is_and_a_ring_by_itself_has_none():
    solid, thin = gear(2.0)
    assert {c.name: c.value for c in thin}["rim under the teeth"] == pytest.approx(0.7)
    assert "pinion rim under the teeth" in {c.name for c in solid} or gk.SpurGear(8, 2.0).solid_rim is None
    alone, held = ring(2.0)
    assert not any("rim" in c.name for c in alone)
    assert {c.name: c.value for c in held}["ring rim outside the teeth"] == pytest.approx(1.5)


def test_the_flank_that_cannot_touch_is_that_of_the_driving_side_which_the_mate_reaches():
    """The first stretch of the tooth's curve; what lies beyond the mate's tips is not wanted of it."""
    held = gk.conjugate(gk.SpurGear(24, 2).outline.piece, 24, 24.0, 36, 2.0)
    for stretches, lost in (
        ((), 0),
        (((0.0, 0.5, 10.0, 11.0, MISSES), (0.6, 1.0, 11.0, 11.5, CUTS)), 1.5),
        (((0.0, 0.5, 10.0, 11.0, TRIMMED), (0.6, 1.0, 11.0, 11.5, BEYOND)), 1.0),
        (((0.2, 0.5, 10.0, 10.25, MISSES), (1.0, 1.5, 9.0, 10.0, MISSES), (1.2, 2.0, 9.0, 10.0, BEYOND)), 0.25),
    ):
        spoilt = dataclasses.replace(held, untouched=tuple(Untouched(*one) for one in stretches))
        check = gk.gear.touch_check(spoilt, 2.0)
        assert check.value == pytest.approx(lost / 2) and check.passed == (not lost)
