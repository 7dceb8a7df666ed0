"""Refusals of gears word by word, and what they advise tried."""

import re
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
