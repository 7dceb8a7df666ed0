"""Bars and their pinions: sizes measured on the outline, speeds of contact as vectors, interference as overlap."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.plane import region

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


PAIRS = {
    "usual": lambda: gk.gear.RackPair(gk.SpurGear(20, 2), gk.gear.GearRack(9, 2)),
    "shifted": lambda: gk.gear.RackPair(gk.SpurGear(14, 3, 0.4), gk.gear.GearRack(9, 3), 22.4),
}


@pytest.mark.parametrize("name", PAIRS)
def test_contact_slides_by_what_it_moves_faster_along_one_flank_than_along_the_other(name):
    pair = PAIRS[name]()
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


def test_what_hits_overlaps_and_what_does_not_is_clear():
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
