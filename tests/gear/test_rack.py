"""Racks by second roads: the limit of a large gear, outlines laid over each other."""

import numpy as np
import pytest
import shapely

import geomkin as gk
from geomkin.plane import region
from tests.made import Made


@pytest.mark.parametrize(
    "rack", [gk.gear.RackCutter(), gk.gear.RackCutter(tip_radius=0), gk.gear.RackCutter(25, 1, 1.2, 0.1)]
)
def test_a_rack_is_the_limit_of_a_gear_of_many_teeth(rack):
    """Ten times the teeth, a tenth of the difference: the outline of one tooth against the bar's."""
    bar = gk.gear.GearRack(3, 2, rack)
    off = []
    for teeth in (1000, 10_000):
        gear = gk.SpurGear(teeth, 2, rack=rack)
        z = gk.flatten(gear.outline.piece, 1e-3) - 1j * gear.pitch_radius
        z = z[np.abs(z.real) < np.pi * 0.99]
        off.append(gk.nearest(bar.outline, z)[1].max())
    assert off[0] < 0.02 and off[1] < 0.15 * off[0]


def test_outline_is_one_simple_counterclockwise_loop_with_a_tooth_on_the_axis():
    for teeth in (1, 2, 7):
        bar = gk.gear.GearRack(teeth, 2, tooth_thickness_allowance=0.1)
        polygon = gk.flatten(bar.outline, 1e-4)
        assert region.is_simple(polygon) and gk.plane.signed_area(bar.outline) > 0
        assert polygon.imag.max() == pytest.approx(2, abs=1e-12) and polygon.imag.min() == pytest.approx(-10, abs=1e-12)
        assert np.ptp(polygon.real) == pytest.approx(teeth * 2 * np.pi, rel=1e-12)
        line = polygon.imag[:-1] * polygon.imag[1:] < 0
        below, above = polygon[:-1][line], polygon[1:][line]
        crossings = np.sort((below - below.imag / (above - below).imag * (above - below)).real)
        middle = crossings[np.abs(crossings) < np.pi]
        assert middle == pytest.approx([-(np.pi - 0.1) / 2, (np.pi - 0.1) / 2], abs=1e-9)


def test_arcs_are_kept_as_arcs():
    bar = gk.gear.GearRack(5, 2)
    assert len(gk.to_arcs(bar.outline, 1e-6).vertices) == len(bar.outline.vertices) <= 5 * 6 + 6


PAIRS = Made({
    "even": lambda: gk.gear.RackPair(gk.SpurGear(24, 2), gk.gear.GearRack(9, 2)),
    "odd": lambda: gk.gear.RackPair(gk.SpurGear(19, 2), gk.gear.GearRack(9, 2)),
    "shifted": lambda: gk.gear.RackPair(gk.SpurGear(10, 2, 0.45), gk.gear.GearRack(9, 2)),
    "far": lambda: gk.gear.RackPair(gk.SpurGear(24, 2, tooth_thickness_allowance=0.05), gk.gear.GearRack(9, 2, tooth_thickness_allowance=0.1), 24.2),
})  # fmt: skip


@pytest.fixture
def pair(request):
    return PAIRS[request.param]


@pytest.mark.parametrize("pair", PAIRS, indirect=True)
def test_pinion_and_rack_share_nothing_through_a_pitch_and_do_when_pushed_beyond_the_backlash(pair):
    assert not pair.interferences
    one, two = (gk.flatten(g.outline, 1e-4) for g in (pair.pinion, pair.rack))

    def common(turn, extra=0.0):
        poses = pair.poses(turn)
        return region.overlap([poses[0].place(one)], [poses[1].place(two) + extra])

    for turn in np.linspace(0, 2 * np.pi / pair.pinion.teeth, 5):
        assert common(turn) < 2e-3
        for side in (1, -1):
            assert common(turn, side * 0.98 * max(0, pair.backlash) / 2) < 2e-3
            assert common(turn, side * (pair.backlash / 2 + 0.02)) > 4e-3


@pytest.mark.parametrize("pair", PAIRS, indirect=True)
def test_clearances_are_those_of_the_outlines(pair):
    """Of the pinion its nearest and farthest point; of the bar its top, and how high it is in the middle of a space."""
    radii = np.abs(gk.flatten(pair.pinion.outline, 1e-4))
    z = gk.flatten(pair.rack.outline, 1e-4)
    bar = shapely.Polygon(np.column_stack([z.real, z.imag]))
    middle = shapely.LineString([(np.pi, -1e3), (np.pi, 1e3)]).intersection(bar).bounds[3]
    wanted = pair.distance - z.imag.max() - radii.min(), pair.distance - middle - radii.max()
    assert pair.clearances == pytest.approx(wanted, abs=1e-3)


def test_contact_with_a_rack_is_the_limit_of_contact_with_a_large_gear():
    pinion = gk.SpurGear(20, 2)
    large = gk.GearPair(pinion, gk.SpurGear(10_000, 2))
    rack = gk.gear.RackPair(pinion, gk.gear.GearRack(9, 2))
    assert rack.contact_ratio == pytest.approx(large.contact_ratio, abs=1e-2)
    assert rack.contact_ratio > large.contact_ratio
    along = np.linspace(*rack.contact_lengths, 5)
    assert np.array(rack.sliding(along)) == pytest.approx(np.array(large.sliding(along)), abs=0.02)
    assert rack.travel == pytest.approx(2 * np.pi * pinion.pitch_radius)


@pytest.mark.parametrize(
    ("make", "field"),
    [
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
    ],
)
def test_impossible_racks_are_refused_by_name(make, field):
    with pytest.raises(gk.DesignError) as caught:
        make()
    assert caught.value.field == field and caught.value.remedy


@pytest.mark.parametrize("wrong", [23.9, 29.0])
def test_the_nearest_distance_named_in_a_refusal_meshes(wrong):
    parts = gk.SpurGear(24, 2), gk.gear.GearRack(9, 2)
    with pytest.raises(gk.DesignError) as caught:
        gk.gear.RackPair(*parts, wrong)
    named = float(caught.value.remedy.split(" mm")[0].split()[-1])
    pair = gk.gear.RackPair(*parts, named)
    assert pair.contact_ratio >= 1 and pair.backlash > -1e-9


@pytest.mark.parametrize("teeth", [1, 2, 3, 4, 7, 8])
def test_as_many_teeth_stand_left_of_the_axis_as_right_of_it_or_one_fewer(teeth):
    bar = gk.gear.GearRack(teeth, 2)
    z = gk.flatten(bar.outline, 1e-4)
    assert bar.ends == pytest.approx((z.real.min(), z.real.max()), abs=1e-9)
    left, right = -z.real.min() / (2 * np.pi) - 0.5, z.real.max() / (2 * np.pi) - 0.5
    assert (left, right) == pytest.approx(((teeth - 1) // 2, teeth // 2), abs=1e-9)
