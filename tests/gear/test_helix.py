"""Helices against a published gear, the identities of the normal section, and contact counted section by section."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.recipe.load import to_toml

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


BETA = 30.0


def pair(first, second, **others):
    return gk.load({"kind": "gear-pair", "first": first, "second": second, "section": "normal", **others})


def test_published_pairs_need_no_conversion():
    # Teeth 31 and 30, normal module 3.5, 20 deg, helix angle 21 deg: shifts of 0.6518771312 together for 116.5 mm.
    one = {"teeth": 31, "module": 3.5, "profile_shift": 0.4}
    two = {"teeth": 30, "module": 3.5, "profile_shift": 0.6518771312 - 0.4}
    assert pair(one, two, helix_angle_deg=21.0).design.centre_distance == pytest.approx(116.5, abs=1e-6)
    # KHK, Gear Technical Reference: normal module 3, helix angle 30 deg, 12 and 60 teeth.
    one, two = {"teeth": 12, "module": 3, "profile_shift": 0.09809}, {"teeth": 60, "module": 3}
    recipe = pair(one, two, helix_angle_deg=30.0)
    found = recipe.design
    assert found.centre_distance == pytest.approx(125, abs=1e-4)
    assert np.degrees(found.working_pressure_angle) == pytest.approx(23.1126, abs=1e-4)
    assert [2 * g.base_radius for g in (found.first, found.second)] == pytest.approx([38.322, 191.611], abs=1e-3)
    # Heights in normal modules; the reference shortens the tips to 48.153 and 213.842 mm for the full clearance.
    assert [2 * g.tip_radius for g in (found.first, found.second)] == pytest.approx([48.158, 213.846], abs=1e-3)
    assert 2 * found.second.root_radius == pytest.approx(207.846 - 7.5, abs=1e-3)
    helix = recipe.notes["helix"]["first"]
    assert (helix["normal_module_mm"], helix["normal_profile_shift"]) == pytest.approx((3, 0.09809))
    assert gk.load(to_toml(recipe)) == recipe


def test_the_transverse_rack_is_the_normal_one_stretched_along_the_pitch_line():
    normal = gk.gear.RackCutter(tip_radius=0.3, fillet_radius=0.2)
    across = normal.transverse(BETA)
    z, t = normal.edge(3.0, 3), across.edge(3.0 / np.cos(np.radians(BETA)), 3)
    ends, stretched = (np.asarray(c.vertices) for c in (t, z))
    # The flanks end where they do, and lie on each other.
    assert np.allclose(ends.imag, stretched.imag)
    flank = [k for k in range(len(ends) - 1) if 0.1 < abs(ends[k + 1].imag - ends[k].imag) and not t.bulges[k]]
    for k in flank:
        slopes = [np.subtract(*v[[k + 1, k]]) for v in (ends, stretched)]
        assert slopes[0].real / slopes[0].imag == pytest.approx(
            slopes[1].real / slopes[1].imag / np.cos(np.radians(BETA))
        )
    middle = [
        np.mean(v[flank[0] : flank[0] + 2]).real * r for v, r in ((ends, np.cos(np.radians(BETA))), (stretched, 1))
    ]
    assert middle[0] == pytest.approx(middle[1])


RECIPES = {
    "spur-gear": {"gear": {"teeth": 20, "module": 2, "tip_chamfer": 0.1}},
    "ring-gear": {"gear": {"teeth": 60, "module": 2, "addendum": 0.8}},
    "rack-and-pinion": {"pinion": {"teeth": 20, "module": 2}, "rack": {"teeth": 12, "module": 2}},
    "planetary": {
        "gears": {
            "sun": {"teeth": 24, "module": 2},
            "planet": {"teeth": 18, "module": 2},
            "ring": {"teeth": 60, "module": 2, "addendum": 0.8},
        }
    },
}


INCHES = {
    "ring": lambda **size: gk.RingGear(60, **size),
    "rack": lambda **size: gk.gear.GearRack(12, **size),
    "straight": lambda **size: gk.gear.StraightSidedGear(40, **size),
    "lantern": lambda **size: gk.gear.LanternPinion(12, pin_diameter=2, **size),
    "points": lambda **size: gk.gear.PointToothGear(
        24, points=tuple(np.array([3.4 + 33.2j, 2.35 + 36j, 1.0 + 39j]) * 25.4 / 12 / 3), **size
    ),
}


@pytest.mark.parametrize("name", INCHES)
def test_a_diametral_pitch_stands_for_a_module(name):
    make = INCHES[name]
    assert make(diametral_pitch=12.0).module == pytest.approx(25.4 / 12)
    assert make(diametral_pitch=12.0).pitch_radius == make(module=25.4 / 12).pitch_radius
    for wrong in ({}, {"module": 2.0, "diametral_pitch": 12.0}):
        with pytest.raises(gk.DesignError) as refused:
            make(**wrong)
        assert refused.value.field == "module"
