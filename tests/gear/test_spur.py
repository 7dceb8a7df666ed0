"""Spur gears by second roads: the rack rolled by brute force, meshing outlines, independent geometry."""

from functools import partial

import numpy as np
import pytest

import geomkin as gk
from geomkin.plane import region
from tests.campaign import by_default
from tests.made import Made

GEARS = [(4, -0.3), (5, 0.0), (8, 0.4), (12, 0.0), (17, 1.0), (18, -0.3), (24, 0.0), (100, 0.4), (1000, 0.0), (40, 1.5)]
MADE = Made({f"{z},{x}": partial(gk.SpurGear, z, 2, x) for z, x in GEARS})


@pytest.fixture
def gear(request):
    return (FEATURES if request.param in FEATURES else MADE)[request.param]


def clearance(gear, z, rolled):
    """Signed distance of points of the gear from the rack, negative inside, when it has rolled by an angle.

    The rack's tooth is a wedge with its corners rounded: the distance to the wedge between the rounding's
    centres, less the rounding. Seen from the rack, the gear's points turn and slide along it.
    """
    m, rack = gear.module, gear.rack
    a, rho = rack.pressure_angle, rack.tip_radius * m
    deep = rack.dedendum * m - rho
    side = np.pi * m / 4 - deep * np.tan(a) - rho / np.cos(a) + gear.tooth_thickness_allowance / 2
    seen = z * np.exp(1j * rolled) + gear.pitch_radius * rolled
    # Distance from the middle of the nearest rack tooth; the gear's tooth on +y stands in a space of the rack.
    pitch = np.pi * m
    u = np.abs(np.mod(seen.real, pitch) - pitch / 2)
    v = seen.imag - gear.pitch_radius - gear.profile_shift * m
    below, beside = -deep - v, (u - side) * np.cos(a) - (v + deep) * np.sin(a)
    # Where the nearest point of the wedge is its corner: between the normals of its two faces.
    at_corner = (u > side) & ((v + deep) * np.cos(a) + (u - side) * np.sin(a) < 0)
    return np.where(at_corner, np.hypot(u - side, v + deep), np.maximum(below, beside)) - rho


def rolled_distance(gear):
    """Points along a tooth and its space, and the least distance of each from the rack as it rolls."""
    tooth = gear.outline.piece
    t = np.concatenate([np.linspace(b0, b1, 25)[1:-1] for b0, b1 in zip(tooth.breaks, tooth.breaks[1:])])
    z = tooth.point(t)[:, None]
    a = gear.rack.pressure_angle
    # As far as contact at the tips may be from the middle, along the line of action.
    middle, reach = np.zeros_like(z, dtype=float), (4 + 6 / np.sin(a)) / gear.teeth
    for _ in range(6):
        rolled = middle + reach * np.linspace(-1, 1, 2001)
        near = clearance(gear, z, rolled)
        middle = np.take_along_axis(rolled, near.argmin(axis=1)[:, None], 1)
        reach /= 500
    return z[:, 0], near.min(axis=1)


def is_cut(gear, z):
    """Which points are the rack's work: not those of the tip circle or of a broken edge."""
    return np.abs(z) < np.abs(gear.flank.point(gear.flank.breaks[-1])) * (1 - 1e-9)


@pytest.mark.parametrize("gear", by_default(MADE, slice(0, None, 3)), indirect=True)
def test_the_rolling_rack_never_enters_the_tooth_and_touches_it_everywhere(gear):
    z, least = rolled_distance(gear)
    assert least.min() > -1e-10 * gear.module
    assert np.abs(least[is_cut(gear, z)]).max() < 1e-10 * gear.module


FEATURES = Made({
    "thinned": lambda: gk.SpurGear(20, 2, tooth_thickness_allowance=0.2),
    "thinned, undercut": lambda: gk.SpurGear(9, 2, tooth_thickness_allowance=0.1),
    "rounded": lambda: gk.SpurGear(20, 2, tip_rounding=0.25),
    "chamfered": lambda: gk.SpurGear(20, 2, 0.3, tip_chamfer=0.2),
    "full round tip": lambda: gk.SpurGear(20, 2, tip_rounding=0.4596),
    "cut at the point": lambda: gk.SpurGear(10, 2, 0.9, on_pointed_tip="cut"),
    "short": lambda: gk.SpurGear(20, 2, addendum=0.6),
    "inches": lambda: gk.SpurGear(20, diametral_pitch=12),
    "14.5 deg": lambda: gk.SpurGear(14, 2, rack=gk.gear.RackCutter(14.5, 1, 1.157, 0.209)),
    "10 deg": lambda: gk.SpurGear(30, 2, -0.4, gk.gear.RackCutter(10)),
    "35 deg": lambda: gk.SpurGear(7, 2, -0.2, gk.gear.RackCutter(35, 0.7, 0.9, 0.1)),
})  # fmt: skip


@pytest.mark.parametrize("gear", by_default(FEATURES, slice(0, None, 3)), indirect=True)
def test_the_rack_also_fits_teeth_that_are_thinned_broken_or_cut_otherwise(gear):
    z, least = rolled_distance(gear)
    assert least.min() > -1e-10 * gear.module
    assert np.abs(least[is_cut(gear, z)]).max() < 1e-10 * gear.module
    polygon = gk.flatten(gear.outline, 1e-4)
    assert region.is_simple(polygon)
    assert np.abs(polygon).max() == pytest.approx(gear.tip_radius, rel=1e-9)


def test_a_rounded_tip_touches_flank_and_tip_circle_along_their_tangents():
    gear = gk.SpurGear(20, 2, 0.2, tip_rounding=0.3)
    edge, flank = gear.tip_edge, gear.flank
    assert abs(edge.curvature(0.5)) == pytest.approx(1 / 0.6)
    assert abs(np.angle(edge.velocity(0) / flank.velocity(flank.breaks[-1]))) < 1e-12
    assert abs(np.angle(edge.velocity(1) / (1j * edge.point(1)))) < 1e-12
    assert abs(edge.point(1)) == pytest.approx(gear.tip_radius, rel=1e-14)
    assert gear.tip_land == pytest.approx(2 * gear.tip_radius * np.angle(1j / edge.point(1)), rel=1e-12)


def test_a_chamfer_takes_its_size_off_the_radius_and_off_the_tip():
    sharp, gear = gk.SpurGear(20, 2), gk.SpurGear(20, 2, tip_chamfer=0.2)
    edge = gear.tip_edge
    assert abs(edge.point(0)) == pytest.approx(sharp.tip_radius - 0.4)
    assert gear.tip_land == pytest.approx(sharp.tip_thickness - 0.8)
    assert gk.nearest(sharp.flank, edge.point(0))[1] < 1e-12


def test_pointed_teeth_are_cut_where_their_flanks_meet():
    gear = gk.SpurGear(10, 2, 0.9, on_pointed_tip="cut")
    z = gear.flank.point(gear.flank.breaks[-1])
    assert abs(z.real) < 1e-12 and z.imag == pytest.approx(gear.tip_radius, rel=1e-14)
    assert gear.tip_radius < 10 + 2 * 1.9
    # Where nothing is pointed, nothing is cut.
    assert gk.SpurGear(20, 2, on_pointed_tip="cut").tip_radius == gk.SpurGear(20, 2).tip_radius


def test_the_share_of_the_involute_lost_is_that_of_its_length():
    gear = gk.SpurGear(8, 2)
    whole = gk.length(gk.plane.Involute(gear.base_radius, 0, gear.flank.breaks[-1]))
    assert gear.involute_lost == pytest.approx(1 - gk.length(gear.flank) / whole, rel=1e-9)
    assert gear.involute_lost > 0.01 and gk.SpurGear(24, 2).involute_lost == 0


@pytest.mark.parametrize("gear", MADE, indirect=True)
def test_outline_is_one_simple_loop_of_equal_teeth(gear):
    polygon = gk.flatten(gear.outline, 0.001 * gear.module)
    assert region.is_simple(polygon)
    assert np.abs(polygon).max() == pytest.approx(gear.tip_radius, rel=1e-12)
    assert np.abs(polygon).min() == pytest.approx(gear.root_radius, rel=1e-6)
    turned = polygon * np.exp(2j * np.pi / gear.teeth)
    assert np.abs(np.roll(polygon, -len(polygon) // gear.teeth) - turned).max() < 1e-12 * gear.tip_radius
    # A tooth is centred on +y: mirrored points of the tooth lie on the tooth.
    one = polygon[: len(polygon) // gear.teeth]
    assert gk.nearest(gear.outline.piece, -np.conj(one))[1].max() < 1e-9 * gear.module


@pytest.mark.parametrize("gear", MADE, indirect=True)
def test_joints_are_smooth_unless_the_tooth_is_undercut(gear):
    root, flank = gear.root_curve, gear.flank
    assert abs(root.point(root.breaks[-1]) - flank.point(flank.breaks[0])) < 1e-9 * gear.module
    before, after = root.velocity(root.breaks[-1] - 1e-9), flank.velocity(flank.breaks[0] + 1e-9)
    bend = abs(np.angle(after / before))
    assert (bend < 1e-4) == (not gear.is_undercut)


def test_thickness_at_the_pitch_circle_is_half_a_pitch_and_grows_with_the_shift():
    for shift in (0.0, 0.3):
        gear = gk.SpurGear(30, 2, shift)
        half = np.pi * 2 / 2 + 2 * shift * 2 * np.tan(np.radians(20))
        assert gear.thickness(gear.pitch_radius) == pytest.approx(half, rel=1e-12)
        polygon = gk.flatten(gear.outline, 1e-5)
        near = polygon[(np.abs(np.angle(polygon / 1j)) < np.pi / 30) & (polygon.real > 0)]
        order = np.argsort(np.abs(near))
        angle = np.interp(gear.pitch_radius, np.abs(near)[order], np.angle(1j / near)[order])
        assert 2 * angle * gear.pitch_radius == pytest.approx(half, abs=1e-4)


@pytest.mark.parametrize(("a", "b"), [(18, 40)])
def test_two_gears_mesh_without_overlap_and_overlap_when_turned(a, b):
    """At the nominal distance without backlash, outlines touch; turned by a hundredth of a tooth they overlap."""
    tolerance = 1e-4
    first, second = gk.SpurGear(a, 2), gk.SpurGear(b, 2)
    outline = [gk.flatten(g.outline, tolerance) for g in (first, second)]
    distance = first.pitch_radius + second.pitch_radius
    for step in np.linspace(0, 1, 5):
        turn = 2 * np.pi / a * step
        one = outline[0] * np.exp(1j * turn)
        # Opposite a tooth of the first on +y stands a space of the second.
        two = outline[1] * np.exp(1j * (np.pi + np.pi / b - turn * a / b)) + 1j * distance
        # The rounding of the roots cuts below where the mate's tips reach, so only flanks can touch.
        assert region.overlap([one], [two]) < 20 * tolerance
        assert (
            region.overlap([one], [(two - 1j * distance) * np.exp(0.01j * np.pi / b) + 1j * distance]) > 40 * tolerance
        )


@pytest.mark.parametrize(("teeth", "angle", "shift"), [(5, 10, -0.6)])
def test_teeth_that_the_rack_cuts_off_are_refused_and_the_least_shift_named_leaves_a_neck(teeth, angle, shift):
    rack = gk.gear.RackCutter(angle, 1, 1.2, 0.2)
    with pytest.raises(gk.DesignError) as caught:
        gk.SpurGear(teeth, 2, shift, rack)
    least = float(caught.value.remedy.split("at least ")[1].split(",")[0])
    gear = gk.SpurGear(teeth, 2, least, rack)
    assert region.is_simple(gk.flatten(gear.outline, 1e-4))
    neck = np.abs(gk.flatten(gear.root_curve, 1e-5).real).min()
    assert 0 < neck < 0.01 * gear.module


@pytest.mark.parametrize("pointed", by_default(["refuse", "cut"], ["refuse"]))
@pytest.mark.parametrize(
    "rack", [gk.gear.RackCutter(), gk.gear.RackCutter(tip_radius=0), gk.gear.RackCutter(35, 0.8, 0.9, 0.1)]
)
def test_the_nearest_shift_named_in_a_refusal_makes_a_gear(rack, pointed):
    refused = 0
    for teeth in (4, 24):
        for shift in (-9.0, 1.5):
            try:
                gk.SpurGear(teeth, 2, shift, rack, on_pointed_tip=pointed)
                continue
            except gk.DesignError as error:
                assert error.field == "profile_shift"
                way, found = error.remedy.split("give at ")[1].split(",")[0].split()
            refused += 1
            gk.SpurGear(teeth, 2, float(found), rack, on_pointed_tip=pointed)
            with pytest.raises(gk.DesignError):
                gk.SpurGear(teeth, 2, float(found) + (-0.01 if way == "least" else 0.01), rack, on_pointed_tip=pointed)
    assert refused > 1


@pytest.mark.parametrize("name", ["tip_rounding", "tip_chamfer"])
def test_a_tip_edge_that_reaches_an_undercut_is_refused_with_one_that_does_not(name):
    rack = gk.gear.RackCutter(20, 0.7)
    with pytest.raises(gk.DesignError) as caught:
        gk.SpurGear(5, 2, -0.4, rack, **{name: 0.44})
    assert caught.value.field == name
    largest = float(caught.value.remedy.split("at most ")[1])
    gear = gk.SpurGear(5, 2, -0.4, rack, **{name: largest})
    assert gear.form_radius < abs(gear.flank.point(gear.flank.breaks[-1])) < gear.form_radius + 0.01
