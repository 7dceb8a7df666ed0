"""Whatever is given to a public call of the gears that it cannot use is refused by name, without raw errors."""

import math

import numpy as np
import pytest

import geomkin as gk

GEAR, RACK = gk.SpurGear(24, 2), gk.gear.GearRack(12, 2)
POINTS = (3.55 + 32.6j, 2.95 + 34.4j, 2.35 + 36j, 1.75 + 37.4j, 0.75 + 39j)


@pytest.mark.parametrize(
    ("make", "field"),
    [
        (lambda: gk.SpurGear(24, 2, on_pointed_tip=math.nan), "on_pointed_tip"),
        (lambda: gk.SpurGear(24, 2, on_pointed_tip="maybe"), "on_pointed_tip"),
        (lambda: gk.GearPair(1, 2), "first"),
        (lambda: gk.GearPair(gk.RingGear(60, 2), GEAR), "first"),
        (lambda: gk.SpurGear(24, 5e-324), "module"),
        (lambda: gk.SpurGear(24, diametral_pitch=1e-9), "diametral_pitch"),
        (lambda: gk.gear.span(gk.RingGear(60, 2)), "gear"),
        (lambda: gk.gear.FlankGear(gk.plane.Segment(3 + 33j, 1 + 2.5e8j), 24, 36.0), "flank"),
    ],
)
def test_refusals_name_the_field(make, field):
    with pytest.raises(gk.DesignError) as caught:
        make()
    assert caught.value.field == field


@pytest.mark.parametrize("unit", [1e-7, 1e5])
def test_outline_scales_with_the_module(unit):
    one, large = gk.SpurGear(17, 1.0, tip_rounding=0.1), gk.SpurGear(17, unit, tip_rounding=0.1)
    t = np.linspace(0, 17, 200)
    assert np.abs(large.outline.point(t) / unit - one.outline.point(t)).max() < 1e-10


@pytest.mark.parametrize("place", [1.75 + 2.5e8j, 145 + 0j])
def test_points_far_off_the_pitch_circle_are_refused_with_a_reach_that_is_looked_at(place):
    with pytest.raises(gk.DesignError) as caught:
        gk.gear.PointToothGear(24, 3, (*POINTS[:3], place, POINTS[4]))
    assert caught.value.field == "points"
    named = float(caught.value.remedy.split(" mm")[0].split()[-1])

    def tall(reach):
        return gk.gear.PointToothGear(24, 3, (3 + 33j, 2 + 60j, 0.1 + 1j * reach))

    assert tall(named - 1e-3).tip_radius == pytest.approx(named, rel=1e-4)
    with pytest.raises(gk.DesignError):
        tall(named * 1.0001)


def test_more_points_than_a_flank_can_use_are_refused_with_the_most():
    def flank(count):
        return tuple(complex(3.5 - 2.7 * s, 32.6 + 6.4 * s) for s in np.linspace(0, 1, count).tolist())

    with pytest.raises(gk.DesignError) as caught:
        gk.gear.PointToothGear(24, 3, flank(101))
    most = int(caught.value.remedy.split()[-1])
    assert most == 100 and len(gk.gear.PointToothGear(24, 3, flank(most)).points) == most
