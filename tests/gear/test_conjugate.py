"""Conjugate teeth by second roads: known mates, the tooth swept by brute force, the finished outlines rolled."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.gear.conjugate.conjugate import conjugate
from geomkin.gear.conjugate.shaping_gears import FlankGear, PointToothGear, StraightSidedGear
from geomkin.plane import region
from geomkin.plane.roulettes import Cycloid
from tests.campaign import by_default

from .sweeping import inner_points, least_clearance


def mate_of(gear, teeth, addendum, clearance=0.0, internal=False):
    return conjugate(gear.cutter(clearance), gear.teeth, gear.pitch_radius, teeth, addendum, internal)


# Known mates


@pytest.mark.parametrize(
    ("working_radius", "teeth", "internal"), [(24.0, 40, False), (25.0, 60, True), (23.4, 40, False)]
)
def test_the_mate_of_an_involute_is_the_involute_at_any_centre_distance(working_radius, teeth, internal):
    """Every normal touches the base circle, and the points unwind from one: both to rounding."""
    gear = gk.SpurGear(24, 2)
    mate = conjugate(gear.outline.piece, 24, working_radius, teeth, 1.0, internal)
    piece = mate.outline.piece
    base, size = gear.base_radius * teeth / 24, mate.tip_radius
    t, involutes = gear.flank.breaks, 0
    for b0, b1 in zip(piece.breaks[:-2], piece.breaks[1:-1]):
        u = b0 + (b1 - b0) * np.linspace(0.02, 0.98, 15)
        z, tangent = piece.point(u), piece.velocity(u)
        foot = np.abs(np.real(np.conj(tangent / np.abs(tangent)) * z))
        if np.ptp(foot) > 1e-9 or np.ptp(np.abs(z)) < 1e-9:
            continue  # root curves and lands
        assert np.abs(foot - base).max() < 1e-12 * size
        string = np.sqrt(np.abs(z) ** 2 - base**2)
        leaves = np.unwrap(np.angle(z)) + np.arctan(string / base) * np.array([[1], [-1]])
        unwound = min(
            (np.abs(base * np.diff(a)) - np.abs(np.diff(string)) for a in leaves), key=lambda d: np.abs(d).max()
        )
        assert np.abs(unwound).max() < 1e-12 * size
        involutes += np.ptp(np.abs(z)) > 1e-6
    assert involutes == 2 and t[0] < t[1]


def test_the_pinion_that_a_ring_shapes_is_the_involute_pinion():
    ring, pinion = gk.RingGear(60, 2), gk.SpurGear(24, 2)
    mate = conjugate(ring.outline.piece, 60, 60.0, 24, 2.0, internal=True)
    z = mate.contact(np.linspace(*mate.tooth.breaks[[0, -1]], 600)).mate
    z = z[np.isfinite(z) & (np.abs(z) > 23.6)]
    assert len(z) > 50 and gk.nearest(pinion.outline, z)[1].max() < 1e-12 * 26
    assert not mate.is_ring and mate.distance == pytest.approx(36)


def cycloidal(teeth, radius, outer, inner, addendum, dedendum):
    """A gear with epicycloids of one circle above its pitch circle and hypocycloids of another below."""

    def reached(rolling, wanted, sign):
        low, high = 0.0, np.pi * abs(rolling) / radius
        for _ in range(80):
            t = 0.5 * (low + high)
            beyond = abs(abs(complex(Cycloid(radius, rolling, 0, 1).point(sign * t))) - radius) > wanted
            low, high = (low, t) if beyond else (t, high)
        return sign * low

    below = Cycloid(radius, -inner, reached(-inner, dedendum, -1), 0.0)
    above = Cycloid(radius, outer, 0.0, reached(outer, addendum, 1))
    pose = gk.plane.Pose(0j, 1j * np.exp(-0.5j * np.pi / teeth))
    return FlankGear(gk.plane.Path((gk.plane.Moved(below, pose), gk.plane.Moved(above, pose))), teeth, radius)


@pytest.mark.parametrize("internal", [False, True])
def test_the_mate_of_cycloids_is_made_of_cycloids_of_the_same_circles(internal):
    """Below the gear's pitch circle rolls a circle of 8 mm, above it one of 6 mm: so they do in the mate."""
    mate = mate_of(cycloidal(30, 30.0, 6.0, 8.0, 1.8, 2.2), 45, 1.5, internal=internal)
    cusp = complex(mate.contact(0.5).mate)
    assert abs(cusp) == pytest.approx(45, rel=1e-12)
    for t, rolling in ((np.linspace(0.02, 0.48, 40), 8.0), (np.linspace(0.52, 0.98, 40), 6.0)):
        z = mate.contact(t).mate
        z = z[np.isfinite(z)]
        assert len(z) > 20
        side = 1 if (t[0] < 0.5) != internal else -1
        angles = np.abs(np.angle(z / cusp))
        known = np.array([cycloid_angle(45.0, side * rolling, r) for r in np.abs(z)])
        # The cusp's own place is the cube root of rounding's business: all points share its error.
        assert np.ptp(angles - known) < 1e-12 and np.abs(angles - known).max() < 1e-8


def cycloid_angle(radius, rolling, at):
    """Polar angle from the cusp of the cycloid's point at a radius, by the triangle of the two centres."""
    centre = radius + rolling
    cosine = (centre**2 + rolling**2 - at**2) / (2 * centre * rolling)
    turned = np.arccos(np.clip(cosine, -1, 1)) * rolling / radius
    z = np.exp(1j * turned) * (centre - rolling * np.exp(1j * turned * radius / rolling))
    return abs(np.angle(z))


# The classic example: straight-sided, 100 teeth, diametral pitch 5 per foot, flanks at 25 deg, mate of 30 teeth.

CLASSIC = StraightSidedGear(100, 0.2, 25, 1.0, 1.2)


def test_the_classic_straight_sided_gear_has_its_published_sizes():
    mate = mate_of(CLASSIC, 30, 0.2, 0.04)
    assert mate.distance == pytest.approx(13)
    flank = CLASSIC.flank
    at_pitch = flank.start + (flank.end - flank.start) * 1.2 / 2.2
    assert 2 * at_pitch.real == pytest.approx(0.3142, abs=5e-5)
    assert at_pitch.imag == pytest.approx(10)
    assert CLASSIC.tip_thickness == pytest.approx(0.128, abs=5e-4)
    assert CLASSIC.root_thickness == pytest.approx(0.538, abs=5e-4)
    slope = np.angle(flank.end - flank.start)
    assert np.degrees(slope) == pytest.approx(90 + 25)


# The swept tooth

STRAIGHT = [
    pytest.param(100, 30, 25, 1.0, 2.0, 0.4, False, id="classic"),
    pytest.param(40, 18, 25, 1.0, 2.0, 0.4, False, id="undercut", marks=pytest.mark.campaign),
    pytest.param(12, 18, 15, 1.0, 2.0, 0.4, False, id="tips that no normal reaches", marks=pytest.mark.campaign),
    pytest.param(12, 30, 15, 1.0, 2.0, 0.4, True, id="ring undercut", marks=pytest.mark.campaign),
    pytest.param(100, 150, 25, 1.0, 2.0, 0.4, True, id="ring", marks=pytest.mark.campaign),
    pytest.param(40, 64, 25, 0.8, 1.6, 0.0, True, id="ring without clearance"),
    pytest.param(20, 21, 20, 0.5, 0.6, 0.1, True, id="ring with one tooth more", marks=pytest.mark.campaign),
    pytest.param(9, 87, 10, 0.5, 0.6, 0.5, False, id="steep"),
    pytest.param(20, 20, 0, 0.8, 1.0, 0.2, False, id="parallel sides", marks=pytest.mark.campaign),
]


def straight(teeth, mate_teeth, angle, height, addendum, clearance, internal):
    gear = StraightSidedGear(teeth, 2, angle, height, 1.2)
    return gear, mate_of(gear, mate_teeth, addendum, clearance, internal)


def off_straight_tooth(gear, clearance):
    """A function that is 0 on the tooth drawn out by the clearance, negative inside: its planes and its tip circle."""
    a = np.radians(gear.flank_angle_deg)
    side = gear.pitch_radius * np.sin(a) + np.pi * gear.module / 4 * np.cos(a)
    tip = abs(complex(gear.flank.end)) + clearance

    def clear(z):
        beside = np.abs(z.real) * np.cos(a) + z.imag * np.sin(a) - side
        return np.where(z.imag > 0, np.maximum(beside, np.abs(z) - tip), np.inf)

    return clear


@pytest.mark.parametrize(("teeth", "mate_teeth", "angle", "height", "addendum", "clearance", "internal"), STRAIGHT)
def test_the_swept_tooth_never_enters_its_mate_and_touches_it_everywhere(
    teeth, mate_teeth, angle, height, addendum, clearance, internal
):
    gear, mate = straight(teeth, mate_teeth, angle, height, addendum, clearance, internal)
    least = least_clearance(mate, inner_points(mate.outline.piece), off_straight_tooth(gear, clearance))
    assert least.min() > -1e-9 and np.abs(least).max() < 1e-9


@pytest.mark.parametrize(
    ("teeth", "mate_teeth", "angle", "height", "addendum", "clearance", "internal"), STRAIGHT[1::3]
)
def test_the_outline_is_one_simple_loop_of_equal_teeth_with_one_on_the_y_axis(
    teeth, mate_teeth, angle, height, addendum, clearance, internal
):
    _, mate = straight(teeth, mate_teeth, angle, height, addendum, clearance, internal)
    polygon = gk.flatten(mate.outline, 0.002)
    assert region.is_simple(polygon) and gk.plane.signed_area(mate.outline) > 0
    reach = np.abs(polygon)
    deepest, highest = (reach.max(), reach.min()) if internal else (reach.min(), reach.max())
    assert highest == pytest.approx(mate.tip_radius, rel=1e-5)
    assert deepest == pytest.approx(mate.root_radius, rel=1e-5)
    one = polygon[: len(polygon) // mate.teeth]
    assert gk.nearest(mate.outline, -np.conj(one))[1].max() < 1e-9
    top = complex(mate.outline.point(gk.nearest(mate.outline, 1j * mate.tip_radius)[0]))
    assert abs(top - 1j * mate.tip_radius) < 1e-9


@pytest.mark.parametrize(("teeth", "mate_teeth", "angle", "height", "addendum", "clearance", "internal"), STRAIGHT[::3])
def test_velocity_and_curvature_agree_with_differences(teeth, mate_teeth, angle, height, addendum, clearance, internal):
    piece = straight(teeth, mate_teeth, angle, height, addendum, clearance, internal)[1].outline.piece
    for b0, b1 in zip(piece.breaks, piece.breaks[1:]):
        t = b0 + (b1 - b0) * np.linspace(0.03, 0.97, 12)
        h = 1e-5 * (b1 - b0)
        v = piece.velocity(t)
        # Near a fold the square root of rounding enters: little, where such a piece is little.
        scale = np.abs(v).max() + 1e-2 * np.abs(piece.velocity(0.5)) * (b1 - b0)
        assert np.abs((piece.point(t + h) - piece.point(t - h)) / (2 * h) - v).max() < 2e-6 * scale + 1e-6
        turn = np.angle(piece.velocity(t + h) / piece.velocity(t - h)) / (2 * h * np.abs(v))
        bend = piece.curvature(t)
        assert np.abs(turn - bend).max() < 1e-5 * np.abs(bend).max() + 1e-6


# The law of gearing on the finished outlines


def contact_angle(gear_points, mate_points, centre, sign):
    """Least turn of the mate about its centre until its outline touches the gear's: both as chords.

    At every vertex of either, the angle to the other outline on the same circle about the centre.
    """
    a, b = gear_points - centre, mate_points - centre
    ra, rb = np.abs(a), np.abs(b)
    low, high = max(ra.min(), rb.min()), min(ra.max(), rb.max())
    pa, pb = np.unwrap(np.angle(a)), np.unwrap(np.angle(b))
    gaps = []
    for r, p, r2, p2, s in ((ra, pa, rb, pb, 1), (rb, pb, ra, pa, -1)):
        order = np.argsort(r2)
        inside = (r > low) & (r < high)
        gaps.append(s * (p[inside] - np.interp(r[inside], r2[order], p2[order])))
    every = (np.concatenate(gaps) + np.pi) % (2 * np.pi) - np.pi
    return sign * np.min(sign * every)


@pytest.mark.parametrize("kind", by_default(["straight", "ring", "points"], ["ring"]))
def test_the_finished_outlines_turn_at_a_constant_ratio(kind):
    """One pair of flanks as polygons: the gear is turned, the mate follows till they touch, over the contact."""
    if kind == "points":
        gear = PointToothGear(24, 3, (3.55 + 32.6j, 2.95 + 34.4j, 2.35 + 36j, 1.75 + 37.4j, 1.2 + 38.4j, 0.75 + 39j))
        mate = mate_of(gear, 32, 2.6, 0.5)
    else:
        gear = StraightSidedGear(40, 2, 25, 0.8, 1.2)
        mate = mate_of(gear, 64 if kind == "ring" else 50, 1.6, 0.2, internal=kind == "ring")
    found = mate.contact(np.linspace(0, 1, 2001))
    on = np.isfinite(found.angle)
    angles = np.linspace(found.angle[on].min(), found.angle[on].max(), 12)[1:-1]
    tolerance = 1e-8
    one = gk.flatten(gear.flank, tolerance) if kind == "points" else gear.flank.point(np.linspace(0, 1, 4001))
    whole = gk.flatten(mate.outline.piece, tolerance)
    # The mate's flank that meets the right-hand one, from its root to its tip, in the gear's frame at rest.
    centre, ratio = complex(mate.pose.origin), gear.teeth / mate.teeth * (1 if mate.is_ring else -1)
    pitch = 2 * np.pi / mate.teeth
    middle = found.mate[on].mean()
    turned = whole * np.exp(1j * pitch * np.round(np.angle(middle / whole.mean()) / pitch))
    near = [np.abs(turned - z).argmin() for z in (found.mate[on][0], found.mate[on][-1])]
    flank = mate.pose.place(turned[min(near) : max(near) + 1])
    follows = []
    for angle in angles:
        driven = one * np.exp(1j * angle)
        start = centre + (flank - centre) * np.exp(1j * ratio * angle)
        # The mate's tooth lies to the right of the gear's: about a centre above at greater angles, below at smaller.
        follows.append(contact_angle(driven, start, centre, 1 if mate.is_ring else -1))
    # The turn left over beside a constant ratio, rad, and its change per turn of the gear.
    assert np.abs(follows).max() < 1e-7
    assert np.abs(np.diff(follows) / np.diff(angles)).max() < 1e-6


@pytest.mark.parametrize("internal", [False, True])
def test_exported_outlines_do_not_overlap_through_a_pitch_and_do_when_turned(internal):
    gear = StraightSidedGear(40, 2, 25, 0.8, 1.2)
    mate = mate_of(gear, 64 if internal else 30, 1.6, 0.4, internal)
    tolerance = 1e-3
    one, two = gk.flatten(gear.outline, tolerance), gk.flatten(mate.outline, tolerance)
    centre = complex(mate.pose.origin)
    ratio = gear.teeth / mate.teeth * (1 if internal else -1)
    for angle in np.linspace(0, 2 * np.pi / gear.teeth, 7):

        def common(extra, angle=angle):
            first = one * np.exp(1j * angle)
            second = centre + mate.pose.direction * two * np.exp(1j * (ratio * angle + extra))
            both = region.overlap([first], [second])
            return gk.area(gear.outline) - both if internal else both

        flat = gk.area(gear.outline) - abs(gk.area(gk.plane.Polyline(one))) if internal else 0.0
        assert common(0.0) - flat < 20 * tolerance
        assert common(0.01 * np.pi / mate.teeth) - flat > 2 * (common(0.0) - flat) and common(0.002) - flat > 0.01


def test_contacts_obey_the_law_of_gearing():
    """The normal passes the pitch point, and the two bodies' velocities at the contact differ along the tangent."""
    gear = StraightSidedGear(40, 2, 25, 0.8, 1.2)
    mate = mate_of(gear, 30, 1.6, 0.2)
    t = np.linspace(0.3, 0.7, 9)
    c = mate.contact(t)
    normal = 1j * np.exp(1j * c.angle) * gear.flank.velocity(t)
    towards = 1j * gear.pitch_radius - c.place
    assert np.abs(np.imag(np.conj(normal / np.abs(normal)) * towards)).max() < 1e-12 * gear.pitch_radius
    assert np.abs(c.tooth * np.exp(1j * c.angle) - c.place).max() < 1e-12 * gear.pitch_radius
    turned = np.exp(-1j * c.angle * gear.teeth / mate.teeth)
    assert np.abs(mate.pose.origin + mate.pose.direction * c.mate * turned - c.place).max() < 1e-11
    own = 1j * c.place
    other = -1j * gear.teeth / mate.teeth * (c.place - mate.pose.origin)
    tangent = normal / np.abs(normal) / 1j
    assert np.abs((own - other) / tangent - c.sliding).max() < 1e-11
    pressure = np.arccos(np.abs(np.real(np.conj(normal / np.abs(normal)) * 1)))
    assert c.pressure_angle == pytest.approx(pressure, abs=1e-12)


# Points that never touch


def test_every_flank_point_touches_or_is_reported():
    gear = StraightSidedGear(40, 2, 25, 1.0, 1.2)
    mate = mate_of(gear, 18, 2.0, 0.4)
    t = np.linspace(0.0005, 0.9995, 1000)
    touches = np.isfinite(mate.contact(t).angle)
    reported = np.zeros(len(t), dtype=int)
    for u in mate.untouched:
        reported += (t > u.start) & (t < u.end)
        radius = np.abs(mate.tooth.point(np.linspace(u.start, u.end, 50)))
        assert u.inner_radius <= radius.min() * (1 + 1e-12) and radius.max() <= u.outer_radius * (1 + 1e-12)
    assert np.array_equal(touches, reported == 0) and reported.max() == 1
    assert 0.5 < touches.mean() < 0.9


# Any curve


# Bad input
