"""Every number named in a refusal: it works at first go, at every size, and a little more is refused again."""

import re

import pytest

import geomkin as gk


def ring(teeth=60, module=2, cutter=24, **sizes):
    return gk.RingGear(teeth, module, cutter=gk.gear.PinionCutter(cutter), **sizes)


def flank_gear(m):
    return gk.gear.StraightSidedGear(40, m, 25, 0.8, 1.2)


def mate(m, addendum, internal=False, clearance=0.0):
    gear = flank_gear(m)
    return gk.conjugate(gear.cutter(clearance * m), 40, gear.pitch_radius, 64, addendum, internal)


def pinion_of_ring(m, addendum):
    gear = ring(module=m)
    return gk.conjugate(
        gk.plane.Reversed(gk.plane.Reversed(gear.outline.piece)), 60, gear.pitch_radius, 24, addendum, True
    )


# What is made of a module and a size, a size that is too much or too little, and in which unit: of 1 or of modules.
AT_MOST = {
    "spur tooth_thickness_allowance": (lambda m, x: gk.SpurGear(24, m, tooth_thickness_allowance=x), 3.0, True, "tooth_thickness_allowance"),
    "spur rounding": (lambda m, x: gk.SpurGear(24, m, tip_rounding=x), 2.0, False, "tip_rounding"),
    "spur chamfer": (lambda m, x: gk.SpurGear(24, m, tip_chamfer=x), 2.0, False, "tip_chamfer"),
    "spur shift": (lambda m, x: gk.SpurGear(24, m, x), 2.5, False, "profile_shift"),
    "rack rounding": (lambda m, x: gk.gear.RackCutter(tip_radius=x), 0.5, False, "tip_radius"),
    "rack rounding of a deep rack": (lambda m, x: gk.gear.RackCutter(25, 1.0, 1.2, x), 1.0, False, "tip_radius"),
    "rack dedendum": (lambda m, x: gk.gear.RackCutter(dedendum=x, tip_radius=0), 3.0, False, "dedendum"),
    "cutter addendum": (lambda m, x: gk.gear.PinionCutter(12, addendum=x, tip_radius=0), 3.0, False, "addendum"),
    "cutter rounding": (lambda m, x: gk.gear.PinionCutter(12, tip_radius=x), 1.0, False, "tip_radius"),
    "ring tooth_thickness_allowance": (lambda m, x: ring(module=m, tooth_thickness_allowance=x), 3.0, True, "tooth_thickness_allowance"),
    "ring addendum": (lambda m, x: ring(36, m, 12, addendum=x), 2.0, False, "addendum"),
    "gear rack tooth_thickness_allowance": (lambda m, x: gk.gear.GearRack(5, m, tooth_thickness_allowance=x), 1.5, True, "tooth_thickness_allowance"),
    "straight addendum": (lambda m, x: gk.gear.StraightSidedGear(40, m, 25, x), 3.0, False, "addendum"),
    "straight dedendum": (lambda m, x: gk.gear.StraightSidedGear(40, m, 25, 1, x), 2.0, False, "dedendum"),
    "flank backlash": (lambda m, x: flank_gear(m).cutter(0.1 * m, x), 2.0, True, "backlash"),
    "flank clearance": (lambda m, x: flank_gear(m).cutter(x), 3.0, True, "clearance"),
    "lantern backlash": (lambda m, x: gk.gear.LanternPinion(12, m, 1.4 * m).cutter(0, x), 3.0, True, "backlash"),
    "mate's depth": (lambda m, x: mate(m, x, True), 2.0, True, "addendum"),
    "depth of a ring's mate": (pinion_of_ring, 2.0, True, "addendum"),
    "point tooth reach": (lambda m, x: gk.gear.PointToothGear(24, m, (m * (1 + 11j), m * 0.01 + 1j * x)), 60, True, "points"),
    "flank reach": (lambda m, x: gk.gear.FlankGear(gk.plane.Segment(m * (1 + 11j), m * 0.01 + 1j * x), 24, 12 * m), 60, True, "flank"),
}  # fmt: skip
AT_LEAST = {
    "spur shift": (lambda m, x: gk.SpurGear(6, m, x), -1.0, False, "profile_shift"),
    "straight dedendum": (lambda m, x: gk.gear.StraightSidedGear(8, m, 10, 1, x), 0.02, False, "dedendum"),
    "gear rack height": (lambda m, x: gk.gear.GearRack(5, m, height=x), 1.0, False, "height"),
    "rack and pinion too near": (lambda m, x: gk.gear.RackPair(gk.SpurGear(24, m), gk.gear.GearRack(9, m), x), 11.9, True, ""),
    "pair too near": (lambda m, x: gk.GearPair(gk.SpurGear(24, m), gk.SpurGear(30, m), x), 26.9, True, ""),
    "thinned pair too near": (lambda m, x: gk.GearPair(gk.SpurGear(24, m, tooth_thickness_allowance=0.1 * m), gk.SpurGear(30, m), x), 26.5, True, ""),
    "ring's shift beside its pinion": (lambda m, x: gk.GearPair(gk.SpurGear(20, m, 0.5), ring(60, m, profile_shift=x, addendum=0.6)), -0.5, False, ""),
}  # fmt: skip
MODULES = [0.7]


def refusal(make, m, x):
    with pytest.raises(gk.DesignError) as caught:
        make(m, x)
    return caught.value


@pytest.mark.parametrize("m", MODULES)
@pytest.mark.parametrize("name", AT_MOST)
def test_suggested_maximum_works_and_more_is_refused(name, m):
    make, wrong, in_mm, field = AT_MOST[name]
    unit = m if in_mm else 1.0
    error = refusal(make, m, wrong * unit)
    assert field in (error.field, "")
    named = float(re.search(r"(?:at most|within|give) ([\d.e+-]+)", error.remedy)[1])
    make(m, named)
    # Shifts are advised in thousandths.
    refusal(make, m, named * (1 + 1e-4) + 1e-3 * (name == "spur shift"))


@pytest.mark.parametrize("m", MODULES)
@pytest.mark.parametrize("name", AT_LEAST)
def test_suggested_minimum_works_and_less_is_refused(name, m):
    make, wrong, in_mm, field = AT_LEAST[name]
    unit = m if in_mm else 1.0
    error = refusal(make, m, wrong * unit)
    assert field in (error.field, "")
    found = re.search(r"(at least|more than) (-?[\d.e+-]+)", error.remedy)
    named = float(found[2]) * (1 + 1e-12 * (found[1] == "more than"))
    make(m, named)
    refusal(make, m, named - 1e-4 * abs(named) - 1e-3 * (name == "spur shift"))


@pytest.mark.parametrize("m", MODULES)
def test_the_farthest_distance_named_has_a_contact_ratio_of_one(m):
    for make, wrong in (
        (lambda x: gk.gear.RackPair(gk.SpurGear(24, m), gk.gear.GearRack(9, m), x), 14.5 * m),
        (lambda x: gk.GearPair(gk.SpurGear(24, m), gk.SpurGear(30, m), x), 29.5 * m),
    ):
        with pytest.raises(gk.DesignError) as caught:
            make(wrong)
        named = re.search(r"at most ([\d.e+-]+) mm", caught.value.remedy)[1]
        assert 1 <= make(float(named)).contact_ratio < 1 + 1e-4


@pytest.mark.parametrize("m", MODULES)
def test_the_range_of_an_internal_pair_s_distance_works_at_both_ends(m):
    def make(distance):
        return gk.GearPair(gk.SpurGear(20, m), ring(60, m, addendum=0.8), distance)

    with pytest.raises(gk.DesignError) as caught:
        make(20.5 * m)
    least, most = (float(n) for n in re.search(r"from ([\d.e+-]+) to ([\d.e+-]+)", caught.value.remedy).groups())
    assert make(most).contact_ratio > 1 and most > least
    with pytest.raises(gk.DesignError):
        make(most * 1.0001)


@pytest.mark.parametrize("m", MODULES)
@pytest.mark.parametrize("gear", [(20, 0.0), (31, 0.4), (60, -0.2)])
def test_suggested_measures_work(gear, m):
    """A span as near to the one asked for as there is, radii on the involute, a pin that fits."""
    gear = gk.SpurGear(gear[0], m, gear[1])
    spanned = []
    for teeth in range(1, gear.teeth):
        try:
            spanned.append(gk.gear.span(gear, teeth).teeth)
        except gk.DesignError:
            continue
    for teeth in (1, gear.teeth - 1, gear.teeth + 50):
        if teeth in spanned:
            continue
        with pytest.raises(gk.DesignError) as caught:
            gk.gear.span(gear, teeth)
        named = int(caught.value.remedy.removeprefix("give "))
        assert named in spanned and abs(named - teeth) == min(abs(n - teeth) for n in spanned)
    with pytest.raises(gk.DesignError) as caught:
        gk.gear.chord(gear, 3 * gear.tip_radius)
    low, high = (float(n) for n in re.search(r"give ([\d.e+-]+) to ([\d.e+-]+)", caught.value.remedy).groups())
    assert gk.gear.chord(gear, low).arc > gk.gear.chord(gear, high).arc > 0
    for beyond in (low * (1 - 1e-5), high * (1 + 1e-5)):
        with pytest.raises(gk.DesignError):
            gk.gear.chord(gear, beyond)
    with pytest.raises(gk.DesignError) as caught:
        gk.gear.over_pins(gear, 9 * m)
    assert gk.gear.over_pins(gear, float(re.search(r"about ([\d.e+-]+)", caught.value.remedy)[1])).radius > 0


def test_whole_numbers_named_in_refusals_work():
    with pytest.raises(gk.DesignError) as caught:
        ring(24)
    assert "25" in caught.value.remedy
    assert ring(40, cutter=25, addendum=0.3).teeth == 40
    with pytest.raises(gk.DesignError) as caught:
        gk.GearPair(gk.SpurGear(60, 2), ring(60, addendum=0.5))
    assert "61" in caught.value.remedy
    with pytest.raises(gk.DesignError) as caught:
        gk.conjugate(flank_gear(2).outline.piece, 40, 40.0, 40, 1.0, True)
    named = int(caught.value.remedy.split()[-1])
    assert gk.conjugate(flank_gear(2).outline.piece, 40, 40.0, named, 0.3, True).teeth == named


@pytest.mark.parametrize(("teeth", "cutter"), [(26, 24), (30, 24), (40, 36)])
def test_suggested_cutter_or_shift_makes_a_ring(teeth, cutter):
    """The shift or the cutter named makes the ring at first go, though cutters nearly as large as it hit its tips."""
    with pytest.raises(gk.DesignError) as caught:
        ring(teeth, 2, cutter, profile_shift=-2.0, addendum=0.5)
    shift, smaller = (re.search(p, caught.value.remedy) for p in (r"at least (-?[\d.e+-]+)", r"of (\d+) teeth"))
    if shift:
        assert ring(teeth, 2, cutter, profile_shift=float(shift[1]), addendum=0.5)
    elif smaller:
        assert ring(teeth, 2, int(smaller[1]), profile_shift=-2.0, addendum=0.5)


def test_the_diametral_pitches_named_make_gears_and_those_beyond_do_not():
    with pytest.raises(gk.DesignError) as caught:
        gk.SpurGear(24, diametral_pitch=1e-9)
    low, high = (float(word) for word in re.search(r"give ([\d.e+-]+) to ([\d.e+-]+)", caught.value.remedy).groups())
    assert gk.SpurGear(24, diametral_pitch=low).module == pytest.approx(1e5)
    assert gk.SpurGear(24, diametral_pitch=high).module == pytest.approx(25.4e-5)
    with pytest.raises(gk.DesignError):
        gk.SpurGear(24, diametral_pitch=low * (1 - 1e-4))
