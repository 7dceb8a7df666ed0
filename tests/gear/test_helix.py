"""Helices against a published gear, the identities of the normal section, and contact counted section by section."""

import numpy as np
import pytest

import geomkin as gk

# A gear pair of handbooks (KHK, Gear Technical Reference, helical gears in the normal system): normal module 3, normal
# pressure angle 20 deg, helix angle 30 deg, 12 and 60 teeth, normal shifts 0.09809 and 0, centre distance 125.
BETA = np.radians(30)
RACK = gk.gear.RackCutter(pressure_angle_deg=22.79588, addendum=np.cos(BETA), dedendum=1.25 * np.cos(BETA))
MODULE, SHIFT = 3 / np.cos(BETA), 0.09809 * np.cos(BETA)
PINION, WHEEL = gk.SpurGear(12, MODULE, SHIFT, RACK), gk.SpurGear(60, MODULE, 0, RACK)
HELIX = gk.gear.Helix(30)


def test_a_published_pair_has_its_sizes():
    pair = gk.GearPair(PINION, WHEEL)
    assert HELIX.normal_module(MODULE) == pytest.approx(3)
    assert np.degrees(HELIX.normal_pressure_angle(PINION)) == pytest.approx(20, abs=1e-5)
    assert [2 * g.base_radius for g in (PINION, WHEEL)] == pytest.approx([38.322, 191.611], abs=1e-3)
    assert [2 * g.pitch_radius for g in (PINION, WHEEL)] == pytest.approx([41.569, 207.846], abs=1e-3)
    assert pair.centre_distance == pytest.approx(125, abs=1e-3)
    assert np.degrees(pair.working_pressure_angle) == pytest.approx(23.1126, abs=1e-4)


@pytest.mark.parametrize("angle", [5, 20, 45])
def test_the_base_helix_follows_from_the_normal_section(angle):
    """sin of the base helix angle is sin of the helix angle times cos of the normal pressure angle."""
    helix = gk.gear.Helix(angle, "left")
    normal = helix.normal_pressure_angle(WHEEL)
    assert np.sin(helix.base_angle(WHEEL)) == pytest.approx(np.sin(np.radians(angle)) * np.cos(normal))
    # On any cylinder a tooth gets as far along the axis in a turn.
    assert 2 * np.pi * WHEEL.base_radius / np.tan(helix.base_angle(WHEEL)) == pytest.approx(helix.lead(WHEEL))


@pytest.mark.parametrize("herringbone", [False, True])
def test_total_contact_ratio_counts_all_sections_of_a_pair_of_teeth(herringbone):
    """A pair of teeth is in contact while any of its sections is: the lower ones of a right hand come later."""
    pair, width = gk.GearPair(PINION, WHEEL), 40.0
    helix = gk.gear.Helix(30, "right", herringbone)
    (part,) = gk.gear.gear_parts(PINION, gk.gear.GearStock(thickness=width), helix=helix)
    turned = np.angle(part.twist.at(np.linspace(0, 1, 1001)).direction)
    start, end = np.array(pair.contact_lengths) / PINION.base_radius
    total = (end - turned.min() - (start - turned.max())) / (2 * np.pi / PINION.teeth)
    assert pair.contact_ratio + helix.overlap_ratio(MODULE, width) == pytest.approx(total)


def test_hands_fit():
    assert HELIX.mate.hand == "left" and HELIX.mate.mate == HELIX
    assert gk.gear.Helix(0).lead(PINION) == np.inf
    with pytest.raises(gk.DesignError, match="herringbone: found true with straight teeth; give a helix_angle_deg"):
        gk.gear.Helix(0, "right", True)
