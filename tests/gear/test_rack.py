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


BARS = {
    "usual": gk.gear.GearRack(4, 2),
    "thinned": gk.gear.GearRack(3, 3, gk.gear.RackCutter(25, 0.9, 1.2, 0.15), 4.0, 0.2),
    "sharp": gk.gear.GearRack(5, 1, gk.gear.RackCutter(14.5, 1.1, 1.3, 0.0), 1.6),
}


@pytest.mark.parametrize("name", BARS)
def test_sizes_of_a_bar_are_those_of_its_outline(name):
    bar = BARS[name]
    z = gk.flatten(bar.outline, 1e-7)
    right = z[(z.real >= 0) & (z.real < bar.pitch / 2) & (z.imag > -bar.root_depth - 1e-9)]
    right = right[np.argsort(right.imag)]
    # The right-hand side of the tooth on +y, downwards as far as it is straight.
    top = right[np.abs(right.imag - bar.tip_height) < 1e-9]
    assert z.imag.max() == pytest.approx(bar.tip_height) and top.real.max() == pytest.approx(bar.tip_thickness / 2)
    straight = bar.thickness / 2 - right.imag * np.tan(bar.pressure_angle)
    off = np.abs(right.real - straight)
    assert right.imag[off < 1e-6].min() == pytest.approx(-bar.form_depth, abs=1e-3)
    assert bar.thickness == pytest.approx(np.pi * bar.module / 2 - bar.tooth_thickness_allowance)
    assert -z.imag.min() == pytest.approx(bar.height * bar.module)
    assert bar.solid_rim == pytest.approx(bar.height * bar.module - bar.root_depth)
    assert right.imag.min() == pytest.approx(-bar.root_depth)
    assert np.ptp(z.real) == pytest.approx(bar.teeth * bar.pitch) and bar.hole_room == 0


SLIDING = {
    "usual": lambda: gk.gear.RackPair(gk.SpurGear(20, 2), gk.gear.GearRack(9, 2)),
    "shifted": lambda: gk.gear.RackPair(gk.SpurGear(14, 3, 0.4), gk.gear.GearRack(9, 3), 22.4),
}


@pytest.mark.parametrize("name", SLIDING)
def test_sliding_is_the_difference_of_speeds_along_the_flanks(name):
    pair = SLIDING[name]()
    pinion, a = pair.pinion, pair.pinion.pressure_angle
    along = np.linspace(*pair.contact_lengths, 7)
    # As the pinion turns by 1 rad, contact runs along the line of action by the base radius, the bar by the pitch
    # radius; a place on an involute moves along it as fast as the line of action is long.
    seen = pinion.base_radius * np.exp(1j * a) - pinion.pitch_radius
    fast, bar = along, np.real(seen / (-1j * np.exp(1j * a)))
    assert abs(np.imag(seen / (-1j * np.exp(1j * a)))) < 1e-12
    first, second = pair.sliding(along)
    assert first == pytest.approx((fast - abs(bar)) / fast) and second == pytest.approx((abs(bar) - fast) / abs(bar))
    start, end = pair.contact_lengths
    assert pair.contact_ratio == pytest.approx((end - start) / pinion.base_pitch)
    # It begins at the bar's tips and ends at the pinion's, or where a flank does.
    height = pair.distance - pinion.base_radius * np.cos(a) - along * np.sin(a)
    assert height.max() <= pair.rack.tip_height + 1e-9 and -height.min() <= pair.rack.form_depth + 1e-9
    assert np.hypot(pinion.base_radius, along).max() <= pinion.tip_radius * (1 + 1e-12)
    assert pair.travel == pytest.approx(2 * np.pi * pinion.pitch_radius)


def test_reported_interference_overlaps_and_all_else_is_clear():
    """Pinions of many sizes over bars of many, near and far: outlines laid over each other through a pitch."""
    rng, seen = np.random.default_rng(3), {}
    while len(seen) < 4 or min(seen.values()) < 2:
        teeth, shift = int(rng.integers(9, 40)), round(float(rng.uniform(-0.3, 0.6)), 2)
        long, deep = rng.choice([0.8, 1.0, 1.2, 1.35]), rng.choice([1.0, 1.25, 1.4])
        try:
            pinion = gk.SpurGear(
                teeth, 2, shift, gk.gear.RackCutter(20, 1.0, deep, 0.2), float(rng.choice([0.8, 1.0, 1.2]))
            )
            bar = gk.gear.GearRack(5, 2, gk.gear.RackCutter(20, float(long), 1.25, 0.38))
            pair = gk.gear.RackPair(pinion, bar)
        except gk.DesignError:
            continue
        key = pair.interferences
        if seen.get(key, 0) >= 3:
            continue
        one, two = (gk.flatten(g.outline, 1e-4) for g in (pinion, bar))
        shared = max(
            region.overlap([poses[0].place(one)], [poses[1].place(two)])
            for poses in map(pair.poses, np.linspace(0, 2 * np.pi / teeth, 8))
        )
        assert shared > 1e-3 if key else shared == 0
        # Tips that reach the bottom hit it, wherever the flanks end.
        assert all(name in key for name, room in zip(("pinion root", "rack root"), pair.clearances) if room < -1e-9)
        seen[key] = seen.get(key, 0) + 1


def test_a_bar_with_full_round_spaces_has_no_edges_of_no_length():
    a = np.radians(20)
    largest = (np.pi / 4 - 1.25 * np.tan(a)) * np.cos(a) / (1 - np.sin(a)) * (1 - 1e-15)
    for rack in (gk.gear.RackCutter(tip_radius=largest), gk.gear.RackCutter(tip_radius=0)):
        bar = gk.gear.GearRack(3, 2, rack)
        vertices = np.asarray(bar.outline.vertices)
        assert np.abs(vertices - np.roll(vertices, 1)).min() > 1e-6
        assert len(bar.outline.bulges) == len(vertices)
        assert region.is_simple(gk.flatten(bar.outline, 1e-4))
