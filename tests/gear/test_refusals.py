"""Refusals of gears word by word, and what they advise tried."""

import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import geomkin as gk

from .test_ring import cutting


def test_tips_of_a_ring_that_no_involute_reaches_are_told_with_what_would_help():
    rng, at_most, larger = np.random.default_rng(1), 0, 0
    while min(at_most, larger) < 10:
        cutter_teeth = int(rng.integers(4, 60))
        teeth = max(8, cutter_teeth + int(rng.integers(1, 60)))
        angle, height, own = float(rng.choice([14.5, 20, 30])), float(rng.uniform(0.5, 2)), float(rng.uniform(-2, 2))
        shift, addendum = float(rng.uniform(-4, 4)), round(float(rng.uniform(0.01, 1)), 3)
        try:
            cutter = gk.gear.PinionCutter(cutter_teeth, angle, height, 0.0, own)
            gk.RingGear(teeth, 2, shift, cutter, addendum)
            continue
        except gk.DesignError as error:
            refused = error
        if "makes involutes" not in refused.problem:
            continue
        made = SimpleNamespace(teeth=teeth, module=2, profile_shift=shift, cutter=cutter, addendum=addendum)
        base = [z * np.cos(np.radians(angle)) for z in (teeth, cutter_teeth)]
        # Where the line of action touches the cutter's base circle.
        line = np.sqrt(cutting(made) ** 2 - (base[0] - base[1]) ** 2)
        least, tip = np.hypot(base[0], line), 2 * (teeth / 2 + shift - addendum)
        assert refused.field == "addendum" and refused.problem == (
            f"found {addendum:g}, so the tips stand at {tip:.5g} mm, but a cutter of {cutter_teeth} teeth makes "
            f"involutes from {least:.5g} mm outwards"
        )
        room = teeth / 2 + shift - least / 2
        if room < 1e-3:
            assert refused.remedy == "give a larger profile_shift or cutter teeth"
            larger += 1
            continue
        named = re.fullmatch(r"give at most ([\d.e-]+) modules, or more profile_shift or cutter teeth", refused.remedy)
        assert float(named[1]) == pytest.approx(room, rel=1e-4)
        at_most += 1


def straight(addendum):
    gear = gk.gear.StraightSidedGear(40, 2, 20, 0.6, 1.2)
    return gk.conjugate(gear.cutter(0.0, 0.9), 40, 40.0, 20, addendum)


def pins_in_a_ring(addendum):
    pinion = gk.gear.LanternPinion(12, 4, 9)
    return gk.conjugate(pinion.cutter(0.0, 0.5), 12, 24.0, 18, addendum, True)


@pytest.mark.parametrize(("make", "much"), [(straight, 2.25), (pins_in_a_ring, 5.0)])
def test_teeth_that_a_tool_points_are_refused_with_the_height_that_leaves_them_a_tip(make, much):
    with pytest.raises(gk.DesignError) as caught:
        make(much)
    problem = f"found {much:g} mm, where the mate's flanks have met: its teeth are pointed"
    assert (caught.value.field, caught.value.problem) == ("addendum", problem)
    named = re.fullmatch(r"give at most ([\d.]+), or a gear with thinner teeth", caught.value.remedy)[1]
    mate = make(float(named))
    assert 0 < mate.tip_thickness < 0.01 and abs(mate.tip_radius - mate.pitch_radius) == pytest.approx(float(named))
    with pytest.raises(gk.DesignError, match="pointed"):
        make(float(named) * 1.0015)


FLANKS = {
    "in the middle of the next": (gk.plane.Segment(8 + 28j, 1 + 32j), 20),
    "across the middle": (gk.plane.Segment(1 + 28j, -1 + 32j), 20),
    "inside": (gk.plane.Segment(1 + 20j, 1 + 21j), 20),
    "closed": (gk.plane.Circle(30j, 2.0), 20),
    "far off": (gk.plane.Segment(1 + 28j, 1 + 125j), 20),
}
TOLD = {
    "in the middle of the next": (
        "it lies up to 15.95 deg from the middle of its tooth, beyond half a pitch",
        "keep it within 9 deg of +y: thinner teeth or fewer",
    ),
    "across the middle": ("it crosses the middle of its tooth", "give the side with x >= 0 and +y in the middle"),
    "inside": (
        "it runs from 20.025 to 21.024 mm from the axis, past no pitch circle of 30 mm",
        "give it from the bottom land out to the tip, across the pitch circle",
    ),
    "closed": ("it is closed, or not finite", "give one open side of a tooth"),
    "far off": (
        "it reaches 125 mm from the axis, with a pitch circle of 30 mm",
        "keep it within 119.999 mm of the axis",
    ),
}


@pytest.mark.parametrize("name", FLANKS)
def test_a_flank_that_makes_no_tooth_is_told_word_by_word(name):
    flank, teeth = FLANKS[name]
    with pytest.raises(gk.DesignError) as caught:
        gk.gear.FlankGear(flank, teeth, 30.0)
    assert (caught.value.field, caught.value.problem, caught.value.remedy) == ("flank", *TOLD[name])


def test_a_flank_that_fills_its_half_pitch_or_ends_in_the_middle_makes_a_tooth():
    edge = 28 * np.exp(1j * (np.pi / 2 - np.pi / 20))
    gear = gk.gear.FlankGear(gk.plane.Segment(edge, 32j), 20, 30.0)
    assert gear.most_backlash == pytest.approx(0, abs=1e-9) and gear.tip_thickness == pytest.approx(0, abs=1e-12)
    assert (gear.root_radius, gear.tip_radius, gear.module) == pytest.approx((28, 32, 3))


def test_the_pin_on_top_is_a_whole_circle_from_its_innermost_point():
    pinion = gk.gear.LanternPinion(9, 5, 4)
    pin = pinion.pin
    t = np.linspace(pin.breaks[0], pin.breaks[-1], 81)
    z = pin.point(t) - 22.5j
    assert np.abs(z) == pytest.approx(2) and z[0] == pytest.approx(-2j) and gk.area(pin) == pytest.approx(4 * np.pi)
    assert len(pin.breaks) == 5 and np.angle(z[1:] / z[:-1]).min() > 0
    assert pinion.circles[0].centre == pytest.approx(22.5j)


@pytest.mark.parametrize("internal", [False, True])
def test_a_flank_drawn_on_beyond_its_tip_may_go_as_far_as_its_mirror_image(internal):
    """The straight line through the flank meets the tooth's middle: room is the way from the tip circle to there."""
    gear = gk.gear.StraightSidedGear(40, 3, 25, 0.8, 1.2)
    root, tip = gear.flank.point(np.array([0.0, 1.0]))
    apex = tip.imag + tip.real * (tip.imag - root.imag) / (root.real - tip.real)
    room = apex - gear.tip_radius
    with pytest.raises(gk.DesignError) as caught:
        gear.cutter(room * 1.001)
    assert caught.value.problem == (
        f"found {room * 1.001:.5g} mm, but the flanks drawn on beyond the tip meet after {room:.5g}"
    )
    assert caught.value.remedy == f"give at most {room * (1 - 1e-5):.6g}"
    drawn = gear.cutter(room * 0.5, 0.2 * internal)
    assert np.abs(drawn.point(np.linspace(drawn.breaks[0], drawn.breaks[-1], 4001))).max() == pytest.approx(
        gear.tip_radius + room / 2
    )


SPUR, RACK, BAR = gk.SpurGear, gk.gear.RackCutter, gk.gear.GearRack
TWENTY = SPUR(20, 2)
WORDS = {
    "module: found neither module nor diametral_pitch; give one of them": lambda: SPUR(24),
    "module: found 2 mm, but a diametral_pitch of 10 makes it 2.54 mm; give one of them": lambda: SPUR(
        24, 2, diametral_pitch=10
    ),
    "diametral_pitch: found 0.0001, which makes a module of 254000 mm; give 0.000254 to 1e5": lambda: SPUR(
        24, diametral_pitch=1e-4
    ),
    "profile_shift: found -3, which leaves no tooth outside its base and root circles; "
    "give at least -1.632, or more teeth or a smaller addendum": lambda: SPUR(24, 2, -3),
    "profile_shift: found 2.5, with which the flanks meet below the tip circle: the teeth are pointed; "
    "give at most 1.392, or a smaller addendum or on_pointed_tip = cut": lambda: SPUR(24, 2, 2.5),
    "profile_shift: found -0.6: with 4 teeth the rack's tips cut the teeth off; "
    "give at least -0.281, or more teeth or a smaller addendum": lambda: SPUR(4, 2, -0.6, RACK(tip_radius=0.1)),
    "tooth_thickness_allowance: found 3 mm, which leaves no tooth; give at most 1.321": lambda: SPUR(
        24, 2, tooth_thickness_allowance=3
    ),
    "tip_chamfer: found 0.1 beside a tip_rounding; give one of them": lambda: SPUR(
        24, 2, tip_rounding=0.1, tip_chamfer=0.1
    ),
    "tip_chamfer: found 1e-07, too small to be told from none; give 0 or at least 1e-06": lambda: SPUR(
        24, 2, tip_chamfer=1e-7
    ),
    "tip_chamfer: found 0.5, but the tips have room for 0.3578 modules; give at most 0.3577752": lambda: SPUR(
        24, 2, tip_chamfer=0.5
    ),
    "tip_rounding: found 0.6, but the tips have room for 0.5755 modules; give at most 0.5754546": lambda: SPUR(
        24, 2, tip_rounding=0.6
    ),
    "dedendum: found 3, but the rack's flanks meet at 2.158 modules; "
    "give at most 2.157863, or a smaller pressure_angle_deg": lambda: RACK(dedendum=3),
    "tip_radius: found 0.6, but the rack's tip is too narrow for more than 0.4719 modules; "
    "give at most 0.4719106, or a smaller dedendum": lambda: RACK(tip_radius=0.6),
    "addendum: found 3 with 12 teeth, whose flanks meet below the tip or never begin; "
    "give at most 1.402338 modules, or other teeth or profile_shift": lambda: gk.gear.PinionCutter(
        12, addendum=3, tip_radius=0
    ),
    "tip_radius: found 1, but the cutter's tips have room for 0.2501 modules; "
    "give at most 0.2501265, or a smaller addendum": lambda: gk.gear.PinionCutter(12, tip_radius=1),
    "second.module: found 3 mm beside 2 mm; give 2": lambda: gk.GearPair(TWENTY, SPUR(20, 3)),
    "second.rack.pressure_angle_deg: found 25 deg beside 20 deg; give both tools the same": lambda: gk.GearPair(
        TWENTY, SPUR(20, 2, rack=RACK(25, tip_radius=0.2))
    ),
    "centre_distance: found 39 mm, at which the teeth jam; give at least 40 mm": lambda: gk.GearPair(
        TWENTY, TWENTY, 39
    ),
    "centre_distance: found 60 mm, at which no flanks meet; "
    "give at most 41.24034 mm, where the contact ratio is 1": lambda: gk.GearPair(TWENTY, TWENTY, 60),
    "second.profile_shift: found -0.9 with -0.9: no distance brings the teeth together; "
    "give at least -0.7174253": lambda: gk.GearPair(SPUR(40, 2, -0.9), SPUR(40, 2, -0.9)),
    "centre_distance: found 40.5 mm, at which the teeth jam; give from 37.58771 to 40 mm": lambda: gk.GearPair(
        TWENTY, gk.RingGear(60, 2, addendum=0.8), 40.5
    ),
    "second.teeth: found a ring of 50 teeth around 60; give at least 61": lambda: gk.GearPair(
        SPUR(60, 2), gk.RingGear(50, 2)
    ),
    "distance: found 29 mm, at which no flanks meet; give at most 25.59804 mm, where the contact ratio is 1": lambda: (
        gk.gear.RackPair(SPUR(24, 2), BAR(9, 2), 29)
    ),
    "distance: found 25 mm, at which no flanks meet; give taller teeth": lambda: gk.gear.RackPair(
        SPUR(24, 2, addendum=0.05), BAR(9, 2, RACK(addendum=0.05)), 25
    ),
    "height: found 1 modules, no more than the teeth are deep; give more than 1.25": lambda: BAR(5, 2, height=1),
    "tooth_thickness_allowance: found 2 mm, which points the teeth; give at most 1.68569": lambda: BAR(
        5, 2, tooth_thickness_allowance=2
    ),
    "rack.addendum: the flanks meet below the tips; give a rack with a smaller addendum": lambda: BAR(
        5, 2, RACK(addendum=2.5)
    ),
}


@pytest.mark.parametrize("words", WORDS)
def test_what_cannot_be_is_told_word_by_word(words):
    with pytest.raises(gk.DesignError) as caught:
        WORDS[words]()
    assert str(caught.value) == words


def test_the_smallest_cutter_there_is_may_be_the_one_that_is_named():
    cutter = gk.gear.PinionCutter(5, 20, 0.54, 0.0, 0.22)
    with pytest.raises(gk.DesignError) as caught:
        gk.RingGear(12, 2, 0.08, cutter, 0.38)
    assert str(caught.value) == (
        "cutter.teeth: found 5: on their way out of the spaces the cutter's tips cut the tips of 12 teeth; "
        "give 4, or a smaller addendum"
    )
    gk.RingGear(12, 2, 0.08, replace(cutter, teeth=4), 0.38)
    wide = gk.gear.PinionCutter(5, 25, 0.27, 0.0, -0.29)
    with pytest.raises(gk.DesignError, match="does not fit between the teeth; give a cutter of 4 teeth"):
        gk.RingGear(37, 2, -1.35, wide, 0.36)
    gk.RingGear(37, 2, -1.35, replace(wide, teeth=4), 0.36)


def test_spaces_of_straight_teeth_that_reach_past_the_axis_are_told_how_deep_they_may_be():
    with pytest.raises(gk.DesignError, match="found 4.5, at which neighbouring teeth run into each other") as caught:
        gk.gear.StraightSidedGear(8, 2, 25, 1, 4.5)
    named = float(re.match(r"give at most ([\d.]+), or a smaller flank_angle_deg", caught.value.remedy)[1])
    gk.gear.StraightSidedGear(8, 2, 25, 1, named)
    with pytest.raises(gk.DesignError, match="neighbouring teeth"):
        gk.gear.StraightSidedGear(8, 2, 25, 1, named * (1 + 1e-4))
