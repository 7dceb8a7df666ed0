"""Ring gears by second roads: the pinion cutter rolled by brute force, meshing outlines, limits."""

import dataclasses
import re

import numpy as np
import pytest

import geomkin as gk
from geomkin.plane import region
from tests.campaign import by_default
from tests.made import Made

RINGS = Made(
    {
        "40,0.0,24": lambda: gk.RingGear(40, 2),
        "60,0.0,24": lambda: gk.RingGear(60, 2),
        "41,0.5,24": lambda: gk.RingGear(41, 2, 0.5),
        "60,-0.3,30": lambda: gk.RingGear(60, 2, -0.3, gk.gear.PinionCutter(30, profile_shift=0.1), 0.8),
        "25,1.0,24": lambda: gk.RingGear(25, 2, 1.0, addendum=0.3),
        "50,0.0,26": lambda: gk.RingGear(50, 2, 0.0, gk.gear.PinionCutter(26, tip_radius=0)),
        "50,0.2,20": lambda: gk.RingGear(50, 2, 0.2, gk.gear.PinionCutter(20, 25, 1.2, 0.1), 0.9),
        "48,0.0,18": lambda: gk.RingGear(48, 2, 0.0, gk.gear.PinionCutter(18, 20, 1.25, 0.2), 0.7),
        "200,0.0,30": lambda: gk.RingGear(200, 2, 0.0, gk.gear.PinionCutter(30)),
        "1000,0.0,30": lambda: gk.RingGear(1000, 2, 0.0, gk.gear.PinionCutter(30)),
        "12,0.6,6": lambda: gk.RingGear(12, 2, 0.6, gk.gear.PinionCutter(6, 30, 0.8, 0.05), 0.4),
        "30,1.5,27": lambda: gk.RingGear(30, 2, 1.5, gk.gear.PinionCutter(27, 20, 1.25, 0.1), 0.6),
        "60, thinned by 0.1": lambda: gk.RingGear(60, 2, tooth_thickness_allowance=0.1),
        "50, thinned by 0.3": lambda: gk.RingGear(
            50, 2, 0.2, gk.gear.PinionCutter(26, tip_radius=0), tooth_thickness_allowance=0.3
        ),
        # Thinned by more than the cutter's tips are wide.
        "40, thinned by 0.6": lambda: gk.RingGear(40, 2, tooth_thickness_allowance=0.6),
    }
)


@pytest.fixture
def ring(request):
    return RINGS[request.param]


def off_cutter(cutter, module, z):
    """Signed distance of points from the nearest tooth of a cutter about the origin, a tooth on +x, negative inside.

    The tooth less its rounding is bounded by two involutes and the tip circle; from that shape the distance
    is taken, less the rounding. A point's distance from an involute is its angle from it times the base radius.
    """
    base, rho = cutter.base_radius * module, cutter.tip_radius * module
    tip = (cutter.teeth / 2 + cutter.addendum + cutter.profile_shift) * module - rho
    a = np.radians(cutter.pressure_angle_deg)
    half = (np.pi / 2 + 2 * cutter.profile_shift * np.tan(a)) / cutter.teeth + np.tan(a) - a - rho / base
    pitch = 2 * np.pi / cutter.teeth
    angle = np.abs(np.mod(np.angle(z) + pitch / 2, pitch) - pitch / 2)
    radius = np.abs(z)
    alpha = np.arccos(np.minimum(base / radius, 1))
    beside = base * (angle - half + np.tan(alpha) - alpha)
    tip_alpha = np.arccos(base / tip)
    corner = half - np.tan(tip_alpha) + tip_alpha
    foot = base * np.tan(alpha) - beside
    at_corner = (foot > base * np.tan(tip_alpha)) & (angle > corner)
    away = np.abs(radius * np.exp(1j * angle) - tip * np.exp(1j * corner))
    return np.where(at_corner, away, np.maximum(beside, radius - tip)) - rho


def cutting(ring):
    """Distance of the cutter's axis, by bisection on the angle at which thicknesses and pitch agree."""
    cutter, a = ring.cutter, ring.cutter.pressure_angle
    difference = ring.teeth - cutter.teeth

    def room(distance):
        alpha = np.arccos(difference / 2 * np.cos(a) / distance)
        inv = np.tan(a) - a - np.tan(alpha) + alpha
        wide = (np.pi / 2 + 2 * ring.profile_shift * np.tan(a)) / ring.teeth + inv
        thick = (np.pi / 2 + 2 * cutter.profile_shift * np.tan(a)) / cutter.teeth + inv
        return wide * ring.teeth - thick * cutter.teeth

    low, high = difference / 2 * np.cos(a), 3 * difference
    for _ in range(200):
        middle = 0.5 * (low + high)
        # The space is wider than the tooth where the cutter stands too near the ring's axis.
        low, high = (middle, high) if room(middle) > 0 else (low, middle)
    return low * ring.module


def least_distance(ring, z):
    """Least distance of points of the ring from its cutter, over all the cutter's places and its turns for tooth_thickness_allowance."""
    turn = ring.tooth_thickness_allowance / (2 * ring.pitch_radius)
    turns = [-turn, 0, turn] if turn else [0]
    return np.min([_least_distance(ring, z * np.exp(1j * t)) for t in turns], axis=0)


def _least_distance(ring, z):
    distance, cutter = cutting(ring), ring.cutter
    z = z[:, None]
    middle, reach = np.zeros(z.shape), 0.75 * np.pi / cutter.teeth + 14 / ring.teeth
    for _ in range(7):
        orbit = middle + reach * np.linspace(-1, 1, 1001)
        # Seen from the ring the cutter's axis circles; the tooth on its outer side stands in the space cut.
        space = np.pi / 2 - np.pi / ring.teeth
        axis = distance * np.exp(1j * (space + orbit))
        spin = space + orbit * (1 - ring.teeth / cutter.teeth)
        near = off_cutter(cutter, ring.module, (z - axis) * np.exp(-1j * spin))
        middle = np.take_along_axis(orbit, near.argmin(axis=1)[:, None], 1)
        reach /= 300
    return near.min(axis=1)


@pytest.mark.parametrize("ring", by_default(RINGS, slice(0, None, 4)), indirect=True)
def test_the_rolling_cutter_never_enters_the_tooth_and_touches_it_everywhere(ring):
    piece = ring.outline.piece
    t = np.concatenate([np.linspace(b0, b1, 11)[1:-1] for b0, b1 in zip(piece.breaks, piece.breaks[1:])])
    z = piece.point(t)
    least = least_distance(ring, z)
    tip = np.abs(z) < ring.tip_radius * (1 + 1e-9)  # the tip is the blank's, not the cutter's
    assert least.min() > -1e-10 * ring.module
    assert np.abs(least[~tip]).max() < 1e-10 * ring.module


@pytest.mark.parametrize("ring", list(RINGS)[::2], indirect=True)
def test_outline_is_one_simple_loop_of_equal_teeth_that_point_inwards(ring):
    polygon = gk.flatten(ring.outline, 0.001 * ring.module)
    assert region.is_simple(polygon)
    assert np.abs(polygon).min() == pytest.approx(ring.tip_radius, rel=1e-6)
    assert np.abs(polygon).max() == pytest.approx(ring.root_radius, rel=1e-12)
    one = polygon[: len(polygon) // ring.teeth]
    one = one[np.abs(one) < ring.root_radius * (1 - 1e-9)]
    assert gk.nearest(ring.outline.piece, -np.conj(one))[1].max() < 1e-9 * ring.module
    # The tooth, not a space, stands on +y.
    assert np.abs(one[np.abs(np.angle(one / 1j)).argmin()]) < ring.pitch_radius + ring.profile_shift * ring.module


@pytest.mark.parametrize("ring", list(RINGS)[:4], indirect=True)
def test_velocity_and_curvature_of_the_root_agree_with_differences(ring):
    root = ring.root_curve
    t = np.linspace(root.breaks[0], root.breaks[-1], 9)[1:-1]
    h = 1e-5
    difference = (root.point(t + h) - root.point(t - h)) / (2 * h)
    assert np.abs(difference - root.velocity(t)).max() < 1e-8 * ring.module
    turn = np.angle(root.velocity(t + h) / root.velocity(t - h)) / (2 * h)
    assert turn / np.abs(root.velocity(t)) == pytest.approx(root.curvature(t), rel=1e-6)


def test_the_space_has_the_width_of_an_external_tooth_of_the_same_shift():
    ring, gear = gk.RingGear(60, 2, 0.2), gk.SpurGear(60, 2, 0.2)
    for radius in (59.0, 60.0, 61.0):
        assert ring.thickness(radius) + gear.thickness(radius) == pytest.approx(2 * np.pi * radius / 60, rel=1e-13)


def test_thinning_takes_its_amount_off_the_reference_circle_and_no_depth():
    for tooth_thickness_allowance in (0.0, 0.3):
        ring = gk.RingGear(60, 2, tooth_thickness_allowance=tooth_thickness_allowance)
        polygon = gk.flatten(ring.outline, 1e-5)
        assert np.abs(polygon).max() == pytest.approx(gk.RingGear(60, 2).root_radius, rel=1e-12)
        sides = polygon[: len(polygon) // 60]
        flank = sides[np.abs(np.abs(sides) - 60) < 1.5]
        right = flank[flank.real > 0]
        right = right[np.argsort(np.abs(right))]
        half = np.interp(60.0, np.abs(right), np.arctan2(right.real, right.imag))
        assert 2 * 60 * half == pytest.approx(np.pi - tooth_thickness_allowance, abs=1e-4)
        assert ring.thickness(60.0) == pytest.approx(np.pi - tooth_thickness_allowance, rel=1e-12)


def test_cutter_is_refused_if_and_only_if_its_tips_hit_the_teeth(monkeypatch):
    monkeypatch.setattr("geomkin.gear.interference.InternalMesh.trochoid_gap", 1.0)
    hit = {}
    for teeth in (50, 51, 52, 53):
        ring = gk.RingGear(60, 2, 0, gk.gear.PinionCutter(teeth))
        tip = ring.flank.point(ring.flank.breaks[-1])
        orbit = np.linspace(-9, 9, 20001)
        space = np.pi / 2 - np.pi / ring.teeth
        seen = (tip - cutting(ring) * np.exp(1j * (space + orbit))) * np.exp(-1j * (space + orbit * (1 - 60 / teeth)))
        hit[teeth] = off_cutter(ring.cutter, 2, seen).min() < -1e-3
    assert hit == {50: False, 51: False, 52: True, 53: True}
    monkeypatch.undo()
    for teeth, hits in hit.items():
        if hits:
            with pytest.raises(gk.DesignError) as caught:
                gk.RingGear(60, 2, 0, gk.gear.PinionCutter(teeth))
            assert "51" in caught.value.remedy
        else:
            assert gk.RingGear(60, 2, 0, gk.gear.PinionCutter(teeth))


# Rings for which no shift within reach makes room for the cutter, of teeth, shift, addendum and cutter.
CROWDED = [
    (25, -2.0, 1.0, gk.gear.PinionCutter(24, 45, 0.5, 0.3)),
    (40, -1.0, 1.5, gk.gear.PinionCutter(37, 30, 1, 0.2)),
    (55, -1.0, 1.0, gk.gear.PinionCutter(45, 40, 0.8, 0, 1)),
]


@pytest.mark.parametrize(("teeth", "shift", "addendum", "cutter"), CROWDED)
def test_a_smaller_cutter_that_is_named_is_the_largest_that_works(teeth, shift, addendum, cutter):
    with pytest.raises(gk.DesignError) as caught:
        gk.RingGear(teeth, 1, shift, cutter, addendum)

    def fits(z):
        try:
            return gk.RingGear(teeth, 1, shift, dataclasses.replace(cutter, teeth=z), addendum)
        except gk.DesignError:
            return None

    named = int(re.search(r"cutter of (\d+) teeth", caught.value.remedy)[1])
    assert named == max(z for z in range(4, cutter.teeth) if fits(z))
