"""Gear pairs by second roads: finished outlines laid over each other, published pairs, motion by differences."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.plane import region
from tests.campaign import by_default
from tests.made import Made
from tests.tables import gears as tables

TOLERANCE = 1e-4


def common(pair, turn, extra=0.0):
    """Area, mm2, that the two bodies share when the first has turned by `turn` and the second by `extra` more."""
    shapes = [gk.flatten(g.outline, TOLERANCE) for g in (pair.first, pair.second)]
    poses = pair.poses(turn)
    one = poses[0].place(shapes[0])
    two = gk.plane.Pose(poses[1].origin, poses[1].direction * np.exp(1j * extra)).place(shapes[1])
    if not pair.is_internal:
        return region.overlap([one], [two])
    # What of the pinion lies outside the ring's hole.
    z = one - one[0]
    area = 0.5 * np.imag(np.conj(z) * np.roll(z, -1)).sum()
    return area - region.overlap([one], [two])


PAIRS = Made({
    "standard": lambda: gk.GearPair(gk.SpurGear(24, 2), gk.SpurGear(40, 2)),
    "shifted": lambda: gk.GearPair(gk.SpurGear(12, 3, 0.6), gk.SpurGear(24, 3, 0.36)),
    "undercut": lambda: gk.GearPair(gk.SpurGear(11, 2), gk.SpurGear(24, 2)),
    "far": lambda: gk.GearPair(gk.SpurGear(24, 2), gk.SpurGear(40, 2), 64.3),
    "thinned": lambda: gk.GearPair(gk.SpurGear(24, 2, tooth_thickness_allowance=0.1), gk.SpurGear(40, 2, tooth_thickness_allowance=0.05)),
    "rounded": lambda: gk.GearPair(gk.SpurGear(20, 2, tip_rounding=0.2), gk.SpurGear(30, 2, tip_chamfer=0.1)),
    "ring": lambda: gk.GearPair(gk.SpurGear(20, 2), gk.RingGear(60, 2, addendum=0.8)),
    "ring, thinned": lambda: gk.GearPair(gk.SpurGear(20, 2, tooth_thickness_allowance=0.05), gk.RingGear(60, 2, addendum=0.8, tooth_thickness_allowance=0.1)),
    "ring, shifted": lambda: gk.GearPair(gk.SpurGear(20, 2, 0.2), gk.RingGear(60, 2, 0.5, addendum=0.8)),
    "ring, near": lambda: gk.GearPair(gk.SpurGear(30, 2), gk.RingGear(60, 2, addendum=0.8), 29.8),
    "ring, one apart": lambda: gk.GearPair(
        gk.SpurGear(49, 1, addendum=0.7), gk.RingGear(50, 1, 1.0, gk.gear.PinionCutter(24), addendum=0.7)
    ),
})  # fmt: skip


@pytest.fixture
def pair(request):
    return PAIRS[request.param]


@pytest.mark.parametrize("pair", by_default(PAIRS, slice(0, None, 3)), indirect=True)
def test_meshed_outlines_share_nothing_through_a_pitch_and_do_when_turned_beyond_the_backlash(pair):
    assert not set(pair.interferences) - {"trimming"}
    r2 = pair.working_radii[1]
    # Flanks that touch may share slivers of the tolerance's depth along each contact.
    sliver = 10 * TOLERANCE * pair.first.module
    for turn in np.linspace(0, 2 * np.pi / pair.first.teeth, 4)[:-1]:
        assert common(pair, turn) < sliver
        for side in (1, -1):
            assert common(pair, turn, side * 0.98 * max(pair.backlash, 0) / 2 / r2) < sliver
            beyond = (pair.backlash / 2 + 0.01 * pair.first.module) / r2
            assert common(pair, turn, side * beyond) > 2 * sliver


def play(pair, side):
    """Angle, rad, by which the second body turns to one side until it digs into the first, by bisection."""
    free, stuck = 0.0, side * np.pi / pair.second.teeth
    for _ in range(20):
        middle = 0.5 * (free + stuck)
        # Above rounding of the areas; a flank has then gone in by less than a thousandth of a millimetre.
        free, stuck = (free, middle) if common(pair, 0.1, middle) > 1e-6 else (middle, stuck)
    return abs(free)


@pytest.mark.parametrize("pair", PAIRS, indirect=True)
def test_clearances_are_those_of_the_outlines(pair):
    """By the nearest and the farthest point of each from its axis: along the line of the axes, tip from root."""
    one, two = (np.abs(gk.flatten(g.outline, TOLERANCE)) for g in (pair.first, pair.second))
    a = pair.centre_distance
    wanted = a - two.max() - one.min(), a - one.max() - two.min()
    if pair.is_internal:
        wanted = two.min() - a - one.min(), two.max() - a - one.max()
    assert pair.clearances == pytest.approx(wanted, abs=1e-3)


@pytest.mark.parametrize("name", by_default(["thinned", "ring, thinned", "ring, near"], ["ring, thinned"]))
def test_the_backlash_is_the_play_of_the_finished_outlines(name):
    pair = PAIRS[name]
    measured = (play(pair, 1) + play(pair, -1)) * pair.working_radii[1]
    assert measured == pytest.approx(pair.backlash, abs=1e-3 * pair.first.module)
    if pair.centre_distance == pair.tight_distance:
        assert measured == pytest.approx(
            pair.first.tooth_thickness_allowance + pair.second.tooth_thickness_allowance, abs=1e-3 * pair.first.module
        )


@pytest.mark.parametrize(
    ("build", "names"),
    [
        # A ring's full teeth reach below the flank that the rack leaves on the pinion.
        (lambda: gk.GearPair(gk.SpurGear(24, 2), gk.RingGear(60, 2)), {"first root"}),
        (
            lambda: gk.GearPair(gk.SpurGear(54, 2), gk.RingGear(60, 2, addendum=0.8)),
            {"trochoid", "trimming"},
        ),
        (lambda: gk.GearPair(gk.SpurGear(12, 2, 0.6), gk.SpurGear(60, 2, -0.6, addendum=1.4)), {"first root"}),
    ],
)
def test_interfering_teeth_are_named_and_overlap(build, names):
    pair = build()
    assert set(pair.interferences) >= names
    turns = np.linspace(0, 2 * np.pi / pair.first.teeth, 7)
    assert max(common(pair, turn) for turn in turns) > 1e-3 * pair.first.module


@pytest.mark.parametrize(("teeth", "ratio"), tables.CONTACT_RATIO.items())
def test_contact_ratio_of_standard_pairs_is_the_published_one(teeth, ratio):
    pair = gk.GearPair(gk.SpurGear(teeth[0], 2), gk.SpurGear(teeth[1], 2))
    assert pair.contact_ratio == pytest.approx(ratio, abs=6e-5)


@pytest.mark.parametrize("pair", PAIRS, indirect=True)
def test_flanks_touch_on_the_line_of_action_at_the_reported_sliding(pair):
    """The two flanks' points that meet, followed by differences: their speeds along the common tangent."""
    start, end = pair.contact_lengths
    along = np.linspace(start, end, 7)[1:-1]
    rb1, rb2 = pair.first.base_radius, pair.second.base_radius
    h = 1e-5
    # A flank's point at a tangent length s moves along the flank by s ds / rb while its gear turns by ds / rb.
    way1 = np.array([gk.length(gk.plane.Involute(rb1, (s - h) / rb1, (s + h) / rb1)) for s in along])
    r1, r2 = pair.working_radii
    across = np.sqrt(r2**2 - rb2**2) + (along - np.sqrt(r1**2 - rb1**2)) * (1 if pair.is_internal else -1)
    way2 = np.array([gk.length(gk.plane.Involute(rb2, (s - h) / rb2, (s + h) / rb2)) for s in across])
    first, second = pair.sliding(along)
    assert first == pytest.approx((way1 - way2) / way1, rel=1e-6, abs=1e-6)
    assert second == pytest.approx((way2 - way1) / way2, rel=1e-6, abs=1e-6)
    pitch_point = np.sqrt(r1**2 - rb1**2)
    assert np.abs(pair.sliding(pitch_point)).max() < 1e-9


@pytest.mark.parametrize("far", [1e9])
def test_a_distance_at_which_no_flanks_meet_is_refused_at_once_with_the_nearest(far, monkeypatch):
    """Each distance looked at must not look for one in its turn: sixty to the power of thirty."""
    made = []
    settle = gk.GearPair.__post_init__
    monkeypatch.setattr(gk.GearPair, "__post_init__", lambda pair: (made.append(pair), settle(pair)))
    with pytest.raises(gk.DesignError) as caught:
        gk.GearPair(gk.SpurGear(24, 2), gk.SpurGear(24, 2), far)
    assert len(made) == 1
    most = float(caught.value.remedy.split("at most ")[1].split()[0])
    pair = gk.GearPair(gk.SpurGear(24, 2), gk.SpurGear(24, 2), most)
    assert pair.contact_ratio == pytest.approx(1, abs=1e-5) and pair.contact_ratio >= 1


@pytest.mark.parametrize(
    ("mate", "teeth", "distance"), [(gk.SpurGear, 33, 50), (gk.SpurGear, 20, 37), (gk.RingGear, 60, 43.95)]
)
def test_the_shift_without_backlash_leaves_none(mate, teeth, distance):
    """The backlash is measured by the thickness of the teeth at the working pitch circles."""

    def pair(shift):
        return gk.GearPair(gk.SpurGear(16, 2), mate(teeth, 2, shift, addendum=0.6), distance)

    assert pair(0.0).backlash > 0.03
    shift = pair(0.0).shift_without_backlash
    assert pair(shift - 1e-9 * np.sign(shift)).backlash == pytest.approx(0, abs=1e-7)
