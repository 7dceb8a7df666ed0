"""Linkages through four poses and more by points and regions that are given; many poses; what three poses leave."""

import json
import re

import numpy as np
import pytest

import geomkin as gk
from geomkin.synthesis import body_guides, circle_of_sliders, dyads_through, image_poles, poles
from geomkin.synthesis.guidance.guide_search import rail_of
from geomkin.synthesis.guidance.poses import SliderCircle
from tests.synthesis.test_guidance import KNOWN, THREE, check, has, poses_of

DRIVE = np.array([0.4, 0.8, 1.2, 1.7, 2.1, 2.6, 3.0])
PIVOTS = KNOWN.origin, KNOWN.origin + 100 * np.exp(1j * np.radians(20))
PINS = tuple(complex(z) for z in (np.array([0, 90]) - KNOWN.coupler_point) * np.exp(-0.3j))


@pytest.mark.parametrize("count", [3, 4, 5, 7])
@pytest.mark.parametrize("points", [{"moving_points": PINS}, {"fixed_points": PIVOTS}], ids=["moving", "fixed"])
def test_points_of_a_known_linkage_give_it_back_through_more_poses(count, points):
    poses = poses_of(KNOWN, DRIVE[:count])
    # The first point's dyad drives, or either of the two once.
    (only,) = body_guides(poses, **points)
    assert has([only], KNOWN, DRIVE[:count]) and only.linkage.crank == pytest.approx(35)
    found = body_guides(poses, **points, driving_point="either")
    assert has(found, KNOWN, DRIVE[:count]) and len(found) == 2
    assert sorted(round(guide.linkage.crank, 6) for guide in found) == [35, 70]
    for guide in found:
        check(guide, poses)
    # Points that are a little off are met as nearly as can be, and that is said.
    ((name, given),) = points.items()
    near = body_guides(poses, **{name: (given[0] + 0.01, given[1] - 0.01j)})
    assert (1e-6 if count > 3 else -1) < min(guide.pose_error for guide in near) < 0.5


@pytest.mark.parametrize("count", [4, 5])
def test_poses_of_an_exact_trammel_have_one(count):
    poses = [(60 * np.cos(t) + 0j, t) for t in (0, 0.3, 0.9, 1.7, 2.5)[:count]]
    guide = body_guides(poses, "elliptic-trammel")[0]
    assert guide.linkage.angle_deg == pytest.approx(90) and guide.linkage.rod == pytest.approx(60)
    assert not guide.defects and guide.pose_error < 1e-9
    # Its shuttle drives nearly as well as the best along any direction, by the rod's angles from the slot's normal.
    best = 90 - np.degrees(poses[-1][1]) / 2
    assert best - 2 < guide.transmission_angle_deg <= best + 1e-6


@pytest.mark.parametrize(("kind", "half"), [("four-bar", 20), ("crank-slider", None)])
def test_a_refusal_for_want_of_room_gives_a_region_that_is_large_enough(kind, half):
    rng, refused = np.random.default_rng(1), 0
    for _ in range(12):
        poses = [(complex(*rng.uniform(-50, 50, 2)), float(t)) for t in np.sort(rng.uniform(0, 2.5, 4))]
        region = None if half is None else (complex(-half, -half), complex(half, half))
        try:
            body_guides(poses, kind, region=region, time_limit=60)
        except gk.DesignError as error:
            refused += 1
            corners = re.search(r"\[(\[.*\]), (\[.*\])\]", error.remedy)
            low, high = (complex(*json.loads(corner)) for corner in corners.groups())
            guides = body_guides(poses, kind, region=(low, high), time_limit=60)
            assert guides and (half is None or high.real > half)
    assert refused >= 1
    # Five poses without a region lack no room.
    with pytest.raises(gk.DesignError) as refusal:
        body_guides([(60 * np.cos(t) + 0j, t) for t in (0, 0.3, 0.9, 1.7, 2.5)], "four-bar")
    assert "[" not in refusal.value.remedy


def joints_of(guide, poses):
    """Pins at all poses and pivots: the pins sit on the body, which tells where they are, whatever the branch."""
    bar, (z, turn) = guide.linkage, (np.array([p[0] for p in poses]), np.exp(1j * np.array([p[1] for p in poses])))
    ahead = np.exp(1j * np.radians(bar.ground_angle_deg))
    first = bar.origin + bar.crank * ahead * np.exp(1j * guide.drive[0])
    # From the pin that the crank carries to the coupler's other one along the coupler, as it stands on the body.
    along = turn * np.exp(-1j * np.radians(guide.body_angle_deg))
    pin = z - bar.coupler_point * along
    assert pin[0] == pytest.approx(first, abs=1e-6)
    return np.concatenate([pin, pin + bar.coupler * along, [bar.origin, bar.origin + bar.ground * ahead]])


def test_a_region_holds_all_joints_of_what_five_poses_have():
    poses = poses_of(KNOWN, DRIVE[:5])
    every = [guide for guide in body_guides(poses) if guide.kind == "four-bar"]
    assert has(every, KNOWN, DRIVE[:5])
    spans = []
    for guide in every:
        z = joints_of(guide, poses)
        low, high = complex(z.real.min(), z.imag.min()), complex(z.real.max(), z.imag.max())
        spans.append((low, high))
        region = (low - 1e-3 * (1 + 1j), high + 1e-3 * (1 + 1j))
        held = body_guides(poses, region=region)
        assert any(np.allclose(joints_of(one, poses), z, atol=1e-6) for one in held if one.kind == "four-bar")
        # All that is given lies inside, and a little less leaves this one out.
        for one in held:
            if one.kind == "four-bar":
                inside = joints_of(one, poses)
                assert (inside.real > region[0].real).all() and (inside.imag > region[0].imag).all()
                assert (inside.real < region[1].real).all() and (inside.imag < region[1].imag).all()
        for less in ((low + 1e-3, high), (low + 1e-3j, high), (low, high - 1e-3), (low, high - 1e-3j)):
            try:
                rest = body_guides(poses, region=less)
            except gk.DesignError as error:
                assert "found no four-bar or crank-slider" in str(error)
            else:
                assert not any(
                    np.allclose(joints_of(one, poses), z, atol=1e-6) for one in rest if one.kind == "four-bar"
                )


def test_pivots_that_the_body_sees_in_one_line_are_refused():
    """Three places in a line without a turn: no pin on the body keeps its distance from any pivot."""
    poses = [(0j, 0.0), (10 + 0j, 0.0), (25 + 0j, 0.0)]
    with pytest.raises(gk.DesignError, match="fixed_points:"):
        body_guides(poses, fixed_points=(7 + 3j, 50 + 0j))
    # Of one of the two alone: where the body's origin comes to it, and else passes it along a line.
    poses = [(0j, 0.0), (10 + 0j, 0.0), (7 + 0j, 0.5)]
    assert body_guides(poses, fixed_points=(7 + 3j, 50 + 3j))
    for pivots in ((7 + 0j, 50 + 3j), (50 + 3j, 7 + 0j)):
        with pytest.raises(gk.DesignError, match="fixed_points:"):
            body_guides(poses, fixed_points=pivots)


@pytest.mark.parametrize("count", [11, 12, 15, 24])
def test_many_poses_of_a_known_linkage_have_its_dyads(count):
    rng = np.random.default_rng(count)
    drive = np.linspace(0.1, 5.5, count)
    dyads = dyads_through(poses_of(KNOWN, drive))
    for pivot, pin in zip(PIVOTS, PINS):
        off = np.abs(dyads.fixed - pivot) + np.abs(dyads.moving - pin)
        assert np.nanmin(off) < 1e-6 and dyads.exact[np.nanargmin(off)]
    shaken = [(z + 0.02 * complex(*rng.normal(size=2)), t) for z, t in poses_of(KNOWN, drive)]
    near = dyads_through(shaken)
    for pivot, pin in zip(PIVOTS, PINS):
        assert np.nanmin(np.abs(near.fixed - pivot) + np.abs(near.moving - pin)) < 2
    assert not near.exact.any() and near.residual.min() < 0.1


def test_image_poles_of_a_pose_that_is_not_there_are_refused():
    last, two = image_poles(THREE, 2), [(3 + 1j, 0.4), (7 - 2j, 1.5)]
    # Of two poses the first counts unless another is asked for, and both see their own pole.
    assert image_poles(two)[0, 1].position == pytest.approx(poles(two)[0, 1].position)
    assert {k: v.position for k, v in image_poles(THREE).items()} == {
        k: v.position for k, v in image_poles(THREE, 0).items()
    }
    for pair, pole in poles(THREE).items():
        assert 2 not in pair or last[pair].position == pytest.approx(pole.position)
        # Where the body's point then is, at either pose of the pair.
        local = (last[pair].position - THREE[2][0]) * np.exp(-1j * THREE[2][1])
        for k in pair:
            assert THREE[k][0] + local * np.exp(1j * THREE[k][1]) == pytest.approx(pole.position)
    for reference in (-1, 3):
        with pytest.raises(gk.DesignError, match=f"reference: found {reference}; give 0 to 2"):
            image_poles(THREE, reference)


def test_a_circle_of_sliders_is_drawn_whole_or_as_a_line():
    away = [(z + 30 - 50j, t) for z, t in THREE]
    assert circle_of_sliders(away).centre == pytest.approx(circle_of_sliders(THREE).centre + 30 - 50j)
    circle = circle_of_sliders(away)
    whole = circle.curve(circle.radius * 1.01)
    assert np.abs(whole.point(np.linspace(*whole.breaks[[0, -1]], 9)) - circle.centre) == pytest.approx(circle.radius)
    # One that is larger than the reach, and that of two parallel poses, is its tangent at the nearest point.
    for line, reach in ((circle, 0.9 * circle.radius), (circle_of_sliders([*away[:2], (60 + 60j, 0.5)]), 30.0)):
        drawn = line.curve(reach)
        ends = drawn.point(drawn.breaks[[0, -1]])
        assert ends.mean() == pytest.approx(line.foot) and abs(ends[1] - ends[0]) == pytest.approx(2 * reach)
        assert (ends[1] - ends[0]) / line.direction / reach == pytest.approx(2)
    # About its own centre, from which no point is nearest, and one that is the centre alone.
    for level, radius in ((-4.0, 2.0), (0.0, 0.0)):
        about = SliderCircle(3 + 1j, 1.0, 0j, level)
        assert (about.centre, about.radius) == (3 + 1j, radius) and abs(about.foot - about.centre) == radius
        assert about.direction == 1j
    with pytest.raises(gk.DesignError, match="poses: found 4; give 3 of them"):
        circle_of_sliders([*THREE, (7j, 2.0)])
    with pytest.raises(gk.DesignError, match="poses: all three are parallel; turn one of them"):
        circle_of_sliders([(0j, 0.2), (40 + 0j, 0.2), (60 + 30j, 0.2 + 2 * np.pi)])


def test_points_of_a_circle_of_sliders_go_round_it_and_those_of_a_line_along_it():
    circle, shares = circle_of_sliders(THREE), np.array([[0, 0.25], [0.5, 0.75]])
    round_it = circle.point(shares) - circle.centre
    assert round_it / circle.radius == pytest.approx(np.array([[-1j, 1], [1j, -1]]))
    line = circle_of_sliders([*THREE[:2], (60 + 60j, 0.5)])
    along = (line.point([0.25, 0.5, 0.75]) - line.foot) / line.direction
    assert line.radius == np.inf and along == pytest.approx([-1, 0, 1])
    # Its ends are at infinity, which no place is.
    assert np.isnan(line.point([0, 1])).all() and np.isnan(line.centre)


def test_time_that_is_too_short_is_told_as_such():
    poses = poses_of(KNOWN, DRIVE[:4])
    with pytest.raises(gk.DesignError, match="seconds: found 0 s, too short for any answer; give 10 or more"):
        body_guides(poses, time_limit=0)
    # Five poses need no search; and where time is enough it is the poses that have none.
    assert has(body_guides(poses_of(KNOWN, DRIVE[:5]), time_limit=0), KNOWN, DRIVE[:5])
    with pytest.raises(gk.DesignError, match="poses: found no four-bar through them that keeps the limits"):
        body_guides(poses, "four-bar", least_transmission_angle_deg=89, largest_ratio=1.01, region=(0j, 1 + 1j))


def test_the_direction_of_a_rail_is_to_the_right_or_up():
    ahead = np.exp(1j * np.linspace(-np.pi, np.pi, 25))
    ahead = np.append(ahead, [1, -1, 1j, -1j])
    for shares in ([0, 1, 3], [3, 1, 0], [1, 3, 0]):
        way = rail_of(np.multiply.outer(shares, ahead) + 5 - 2j)
        assert np.abs(way) == pytest.approx(1) and (way / ahead).imag == pytest.approx(0, abs=1e-12)
        assert ((way.real > -1e-12) & ((np.abs(way.real) > 1e-12) | (way.imag > 0))).all()
