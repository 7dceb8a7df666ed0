"""How near tips come to what they pass, by the corners of finished outlines followed through the mesh."""

import numpy as np
import pytest
import shapely

import geomkin as gk
from geomkin.plane import region
from tests.made import Made

LONG = {"profile_shift": -0.6, "addendum": 1.2}
PAIRS = Made({
    "thinned": lambda: gk.GearPair(gk.SpurGear(24, 2, tooth_thickness_allowance=0.1), gk.SpurGear(40, 2, tooth_thickness_allowance=0.05)),
    "far": lambda: gk.GearPair(gk.SpurGear(24, 2), gk.SpurGear(41, 2), 65.3),
    "digs in": lambda: gk.GearPair(gk.SpurGear(12, 2, 0.6), gk.SpurGear(60, 2, **LONG)),
    "digs in, chamfered": lambda: gk.GearPair(gk.SpurGear(12, 2, 0.6), gk.SpurGear(60, 2, tip_chamfer=0.1, **LONG)),
    "digs in, rounded": lambda: gk.GearPair(gk.SpurGear(60, 2, tip_rounding=0.1, **LONG), gk.SpurGear(13, 2, 0.6)),
    "ring, thinned": lambda: gk.GearPair(
        gk.SpurGear(20, 2, tooth_thickness_allowance=0.05), gk.RingGear(60, 2, addendum=0.8, tooth_thickness_allowance=0.1)
    ),
    "ring, near": lambda: gk.GearPair(gk.SpurGear(31, 2, tip_rounding=0.1), gk.RingGear(60, 2, addendum=0.8), 28.8),
    "ring that digs in": lambda: gk.GearPair(gk.SpurGear(20, 2), gk.RingGear(60, 2, addendum=1.1)),
})  # fmt: skip


def side(gear):
    """Radii, rising, and angles from the middle of a tooth of its finished side."""
    z = gk.flatten(gear.outline.piece, 1e-7)
    angle = np.arctan2(z.real, z.imag)
    z, angle = (a[(angle >= 0) & (angle <= np.pi / gear.teeth * (1 + 1e-12))] for a in (z, angle))
    order = np.argsort(np.abs(z), kind="stable")
    return np.abs(z)[order], angle[order]


def nearest(pair, one, other, poses):
    """Least distance along circles of the edge of `one`'s tip from the teeth of `other`, negative inside them."""
    end = one.flank.point(one.flank.breaks[-1:])
    edge = end if one.tip_edge is None else np.append(end, one.tip_edge.point(np.linspace(0, 1, 41)))
    radii, half = side(other)
    here, there = poses
    z = there.locate(here.place(edge[:, None]))
    radius, pitch = np.abs(z), 2 * np.pi / other.teeth
    away = np.abs(np.mod(np.arctan2(z.real, z.imag) + pitch / 2, pitch) - pitch / 2)
    meets = (radius > radii[0]) & (radius < radii[-1])
    return ((away - np.interp(radius, radii, half)) * radius)[meets].min()


@pytest.mark.parametrize("name", PAIRS)
def test_tips_come_as_near_as_reported(name):
    pair = PAIRS[name]
    poses = pair.poses(np.linspace(-2.5, 2.5, 8_001) * 2 * np.pi / pair.first.teeth)
    found = nearest(pair, pair.second, pair.first, poses[::-1]), nearest(pair, pair.first, pair.second, poses)
    assert pair.interference.tip_margins == pytest.approx(found, abs=5e-5 * pair.module)
    assert ("first root" in pair.interferences) == (found[0] < -1e-4)
    assert ("second root" in pair.interferences) == (found[1] < -1e-4)


@pytest.mark.parametrize("name", PAIRS)
def test_the_involute_ends_where_the_line_of_action_touches_its_base_circle(name):
    """From there to the other's tip circle, along that line, towards the pitch point."""
    pair = PAIRS[name]
    one, two = pair.first, pair.second
    axis = pair.poses(0.0)[1].origin
    # A common tangent of both base circles: the axes lie on one side of it in a ring, on two sides outside.
    across = two.base_radius if pair.is_internal else -two.base_radius
    normal = axis / abs(axis) * np.exp(1j * np.arccos((one.base_radius - across) / abs(axis)))
    foot = one.base_radius * normal
    towards = (1j * pair.working_radii[0] - foot) / abs(1j * pair.working_radii[0] - foot)
    assert abs(np.real(np.conj(normal) * towards)) < 1e-12
    middle = np.real(np.conj(towards) * (axis - foot))
    tip = abs(two.flank.point(two.flank.breaks[-1]))
    places = middle + np.sqrt(tip**2 - two.base_radius**2) * np.array([-1, 1])
    assert pair.interference.involute_margin == pytest.approx(min(places, key=abs), abs=1e-9)


@pytest.mark.parametrize(
    ("teeth", "ring_teeth", "closer"), [(20, 60, 0.0), (45, 60, 0.2), (52, 60, 0.0), (54, 60, 0.2), (30, 50, 0.2)]
)
def test_tips_of_an_internal_pair_pass_at_the_reported_distance(teeth, ring_teeth, closer):
    """Where a pinion's corner comes through the ring's tip circle, how far the ring's own corner is on: in the mesh,
    and on the pinion's way out along a radius, from each place that it may have. Flanks touch on that side.
    """
    one, two = gk.SpurGear(teeth, 2), gk.RingGear(ring_teeth, 2, addendum=0.8)
    pair = gk.GearPair(one, two, ring_teeth - teeth - closer)
    turns = np.linspace(0, np.pi / 2, 20_001)
    axis = pair.poses(0.0)[1].origin
    # The left corner of the pinion's tooth on +y runs ahead, to the right one of a tooth of the ring.
    mine = -np.conj(one.flank.point(one.flank.breaks[-1])) * np.exp(1j * turns)
    his = two.flank.point(two.flank.breaks[-1]) * pair.poses(turns)[1].direction
    leaves = int(np.argmax(np.abs(mine - axis) < two.tip_radius))
    pitch = 2 * np.pi / ring_teeth
    his = his * np.exp(1j * pitch * np.round(np.angle((mine - axis)[leaves] / his[leaves]) / pitch))
    touching = pair.backlash / 2 / pair.working_radii[0]

    def passes(through, k):
        return np.angle(his[k] / through) * ring_teeth / teeth - touching

    assert pair.interference.trochoid_margin == pytest.approx(passes((mine - axis)[leaves], leaves), abs=1e-5)
    drawn = mine.real + 1j * np.sqrt(two.tip_radius**2 - mine.real**2)
    assert pair.interference.trimming_margin == pytest.approx(passes(drawn, slice(None)).min(), abs=1e-7)
    assert ("trochoid" in pair.interferences) == (pair.interference.trochoid_margin < 0)
    assert ("trimming" in pair.interferences) == (pair.interference.trimming_margin < 0)
    outside = gk.GearPair(one, one)
    assert outside.interference.trochoid_margin == outside.interference.trimming_margin == np.inf


def internal(teeth, ring_teeth, addendum, ring_shift=0.0, ring_addendum=0.8, cutter_teeth=20):
    cutter = gk.gear.PinionCutter(teeth=cutter_teeth)
    ring = gk.RingGear(ring_teeth, 2, ring_shift, cutter, addendum=ring_addendum)
    return gk.GearPair(gk.SpurGear(teeth, 2, addendum=addendum), ring)


def shared(pair, poses):
    """The pieces of the pinion outside the hole of its ring, each as points on its edge."""
    one, ring = (pose.place(gk.flatten(g.outline, 2e-3)) for pose, g in zip(poses, (pair.first, pair.second)))
    over = shapely.Polygon(np.column_stack([one.real, one.imag])).difference(
        shapely.Polygon(np.column_stack([ring.real, ring.imag]))
    )
    pieces = [np.array(piece.exterior.coords) for piece in getattr(over, "geoms", [over]) if piece.area > 1e-3]
    return [piece @ [1, 1j] for piece in pieces]


@pytest.mark.parametrize(
    "sizes",
    [
        (47, 48, 0.8),
        (42, 44, 0.6),
        (42, 44, 0.8, 0.4),
        (54, 60, 1.0, 0.0, 0.8, 24),
        (42, 50, 1.5, 0.4),
        (20, 60, 1.0, 0.0, 1.1, 24),
    ],
    ids=str,
)
def test_interferences_of_internal_pairs_are_named_by_what_overlaps(sizes):
    pair, names = internal(*sizes), set()
    for turn in np.linspace(0, 2 * np.pi / pair.first.teeth, 5)[:-1]:
        poses = pair.poses(turn)
        for z in shared(pair, poses):
            own, other = (np.abs(pose.locate(z)) for pose in poses)
            at = {
                "first root": own.min() < pair.first.form_radius - 1e-2,
                "second root": other.max() > pair.second.form_radius + 1e-2,
            }
            names |= {name for name, occurs in at.items() if occurs} or {"trochoid"}
    assert set(pair.interferences) - {"trimming", "involute"} == names
    assert (pair.interference.trochoid_margin < 0) == ("trochoid" in names)


@pytest.mark.parametrize("sizes", [(47, 48, 0.6, 0.4, 0.6), (42, 44, 0.8, 0.4), (45, 60, 1.0)], ids=str)
def test_a_pinion_larger_than_the_hole_of_its_ring_is_not_put_in_along_a_radius(sizes):
    pair = internal(*sizes)
    turns = np.linspace(0, 2 * np.pi / (pair.first.teeth * pair.second.teeth), 5)
    ring = pair.poses(0.0)[1]
    concentric = [(type(ring)(ring.origin, np.exp(1j * turn)), ring) for turn in turns]
    fits = any(not shared(pair, poses) for poses in concentric)
    assert fits == (pair.first.tip_radius < pair.second.tip_radius)
    assert ("trimming" in pair.interferences) != fits
    assert "trochoid" not in pair.interferences


def test_pairs_that_interfere_overlap_and_others_do_not():
    """Gears of many sizes, thinned so that flanks alone share nothing, laid over each other through a pitch."""
    rng, seen, reported = np.random.default_rng(4), {}, set()
    while min(seen.get(key, 0) for key in (True, False)) < 6:
        teeth, shifts = rng.integers(8, 40, 2), rng.uniform(-0.5, 0.8, 2).round(2)
        heights = rng.choice([0.8, 1.0, 1.2, 1.3], 2)
        try:
            pair = gk.GearPair(*(
                gk.SpurGear(int(z), 2, float(x), addendum=float(height), tooth_thickness_allowance=0.02)
                for z, x, height in zip(teeth, shifts, heights)
            ))  # fmt: skip
        except gk.DesignError:
            continue
        key = bool(pair.interferences)
        reported |= set(pair.interferences)
        # What a tip meets beside the involute, it digs into.
        assert "involute" not in pair.interferences or pair.interference.tip_margins[0] < 0
        # Few that hardly touch: what they share is lost in the chords.
        if seen.get(key, 0) >= 8 or (key and min(pair.interference.tip_margins) > -0.05):
            continue
        shapes = [gk.flatten(gear.outline, 1e-3) for gear in (pair.first, pair.second)]
        turns = np.linspace(0, 2 * np.pi / pair.first.teeth, 8)
        shared = max(region.overlap(*([p.place(z)] for p, z in zip(pair.poses(t), shapes))) for t in turns)
        assert shared > 1e-3 if key else shared == 0
        for name, room in zip(("first root", "second root"), pair.clearances):
            assert name in pair.interferences or room > 0
        seen[key] = seen.get(key, 0) + 1
    assert reported == {"first root", "second root", "involute"}
