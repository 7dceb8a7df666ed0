"""Impossible gears, racks, pairs and measures are refused under the name of the argument, with a remedy."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.gear.conjugate.conjugate import conjugate
from geomkin.gear.conjugate.shaping_gears import FlankGear, LanternPinion, PointToothGear, StraightSidedGear

CLASSIC = StraightSidedGear(100, 0.2, 25, 1.0, 1.2)
PINION = LanternPinion(10, 4, 6.0)


@pytest.mark.parametrize(
    ("make", "field"),
    [
        (lambda: gk.SpurGear(0, 2), "teeth"),
        (lambda: gk.SpurGear(2.5, 2), "teeth"),
        (lambda: gk.SpurGear(10_000_000, 2), "teeth"),
        (lambda: gk.SpurGear(True, 2), "teeth"),
        (lambda: gk.SpurGear(24, -2), "module"),
        (lambda: gk.SpurGear(24, np.inf), "module"),
        (lambda: gk.SpurGear(8, 2, 1.2), "profile_shift"),
        (lambda: gk.SpurGear(8, 2, -3), "profile_shift"),
        (lambda: gk.SpurGear(5, 2, -0.6, gk.gear.RackCutter(20, 1, 1.2, 0.2)), "profile_shift"),
        (lambda: gk.SpurGear(24), "module"),
        (lambda: gk.SpurGear(24, 2, diametral_pitch=10), "module"),
        (lambda: gk.SpurGear(24, 2, tip_rounding=0.8), "tip_rounding"),
        (lambda: gk.SpurGear(24, 2, tip_chamfer=0.8), "tip_chamfer"),
        (lambda: gk.SpurGear(24, 2, tip_chamfer=0.1, tip_rounding=0.1), "tip_chamfer"),
        (lambda: gk.SpurGear(24, 2, tooth_thickness_allowance=9), "tooth_thickness_allowance"),
        (lambda: gk.gear.RackCutter(tip_radius=1), "tip_radius"),
        (lambda: gk.gear.RackCutter(dedendum=3), "dedendum"),
        (lambda: gk.RingGear(60, 2, tooth_thickness_allowance=2), "tooth_thickness_allowance"),
        (lambda: gk.RingGear(60, 2, tooth_thickness_allowance=-0.1), "tooth_thickness_allowance"),
        (lambda: gk.RingGear(20, 2), "teeth"),
        (lambda: gk.RingGear(24, 2), "teeth"),
        (lambda: gk.RingGear(60.5, 2), "teeth"),
        (lambda: gk.RingGear(60, 2, -3), "profile_shift"),
        (lambda: gk.RingGear(60, 2, cutter=gk.gear.PinionCutter(20)), "addendum"),
        (lambda: gk.RingGear(34, 2), "addendum"),
        (lambda: gk.RingGear(60, 2, cutter=gk.gear.PinionCutter(55)), "cutter.teeth"),
        (lambda: gk.gear.PinionCutter(tip_radius=1), "tip_radius"),
        (lambda: gk.gear.PinionCutter(addendum=4), "addendum"),
        (lambda: gk.gear.PinionCutter(teeth=3), "teeth"),
        (lambda: gk.gear.GearRack(0, 2), "teeth"),
        (lambda: gk.gear.GearRack(5, 2, height=1), "height"),
        (lambda: gk.gear.GearRack(5, 2, tooth_thickness_allowance=2), "tooth_thickness_allowance"),
        (lambda: gk.gear.RackPair(gk.SpurGear(24, 2), gk.gear.GearRack(9, 3)), "rack.module"),
        (
            lambda: gk.gear.RackPair(
                gk.SpurGear(24, 2), gk.gear.GearRack(9, 2, gk.gear.RackCutter(25, tip_radius=0.2))
            ),
            "rack.rack.pressure_angle_deg",
        ),
        (lambda: gk.gear.RackPair(gk.SpurGear(24, 2), gk.gear.GearRack(9, 2), 23.9), "distance"),
        (lambda: gk.gear.RackPair(gk.SpurGear(24, 2), gk.gear.GearRack(9, 2), 29), "distance"),
        (lambda: gk.GearPair(gk.SpurGear(20, 2), gk.SpurGear(20, 3)), "second.module"),
        (
            lambda: gk.GearPair(gk.SpurGear(20, 2), gk.SpurGear(20, 2, rack=gk.gear.RackCutter(25, tip_radius=0.2))),
            "second.rack.pressure_angle_deg",
        ),
        (
            lambda: gk.GearPair(gk.SpurGear(20, 2, rack=gk.gear.RackCutter(25, tip_radius=0.2)), gk.RingGear(60, 2)),
            "second.cutter.pressure_angle_deg",
        ),
        (lambda: gk.GearPair(gk.SpurGear(20, 2), gk.SpurGear(20, 2), 39), "centre_distance"),
        (lambda: gk.GearPair(gk.SpurGear(20, 2), gk.SpurGear(20, 2), 60), "centre_distance"),
        (lambda: gk.GearPair(gk.SpurGear(20, 2), gk.RingGear(60, 2), 40.5), "centre_distance"),
        (lambda: gk.GearPair(gk.SpurGear(20, 2), gk.RingGear(60, 2), 30), "centre_distance"),
        (lambda: gk.GearPair(gk.SpurGear(60, 2), gk.RingGear(60, 2)), "second.teeth"),
        (lambda: gk.GearPair(gk.SpurGear(40, 2, -0.9), gk.SpurGear(40, 2, -0.9)), "second.profile_shift"),
        (lambda: gk.GearPair(gk.SpurGear(20, 2), gk.SpurGear(20, 2), np.nan), "centre_distance"),
        (lambda: conjugate(CLASSIC.cutter(0), 100, 10.0, 30, -1), "addendum"),
        (lambda: conjugate(CLASSIC.cutter(0), 100, 10.0, 30, 5.0), "addendum"),
        (lambda: conjugate(CLASSIC.cutter(0), 100, np.nan, 30, 0.2), "pitch_radius"),
        (lambda: conjugate(CLASSIC.cutter(0), 100, 10.0, 30.5, 0.2), "mate_teeth"),
        (lambda: conjugate(CLASSIC.cutter(0), 100, 10.0, 100, 0.2, True), "mate_teeth"),
        (lambda: CLASSIC.cutter(1.0), "clearance"),
        (lambda: StraightSidedGear(40, 2, 45, 1.0), "addendum"),
        (lambda: StraightSidedGear(40, 2, 25, 0.8, 3.0), "dedendum"),
        (lambda: StraightSidedGear(3, 2), "teeth"),
        (lambda: FlankGear(gk.plane.Segment(1 + 20j, 1 + 21j), 20, 30.0), "flank"),
        (lambda: FlankGear(gk.plane.Segment(1 + 28j, -1 + 32j), 20, 30.0), "flank"),
        (lambda: FlankGear(gk.plane.Segment(8 + 28j, 1 + 32j), 20, 30.0), "flank"),
        (lambda: PointToothGear(24, 3, (3 + 33j,)), "points"),
        (lambda: PointToothGear(24, 3, (1 + 37j, 0.5 + 38j)), "points"),
        (lambda: LanternPinion(3, 4, 2), "pins"),
        (lambda: LanternPinion(10, 4, 13), "pin_diameter"),
        (lambda: LanternPinion(10, 4, 0), "pin_diameter"),
        (lambda: conjugate(PINION.cutter(0.0), 10, PINION.pitch_radius, 30, 9.0), "addendum"),
        (lambda: gk.gear.balanced_shifts(4, 5), "teeth"),
        (lambda: gk.gear.balanced_shifts(20, 20, total=-2), "total"),
        (lambda: gk.gear.span(gk.SpurGear(20, 2), 9), "teeth"),
        (lambda: gk.gear.over_pins(gk.SpurGear(20, 2), 0.5), "pin"),
        (lambda: gk.gear.over_pins(gk.SpurGear(20, 2), 50), "pin"),
        (lambda: gk.gear.chord(gk.SpurGear(20, 2), 30), "radius"),
    ],
)
def test_impossible_arguments_are_refused_by_name(make, field):
    with pytest.raises(gk.DesignError) as caught:
        make()
    assert caught.value.field == field and caught.value.remedy
