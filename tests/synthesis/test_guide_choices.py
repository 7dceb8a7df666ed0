"""Linkages through four poses and more by points and regions that are given; many poses; what three poses leave."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.synthesis import body_guides, circle_of_sliders, dyads_through, image_poles, poles
from geomkin.synthesis.guidance.poses import SliderCircle
from tests.synthesis.test_guidance import KNOWN, THREE, check, has, poses_of

DRIVE = np.array([0.4, 0.8, 1.2, 1.7, 2.1, 2.6, 3.0])
PIVOTS = KNOWN.origin, KNOWN.origin + 100 * np.exp(1j * np.radians(20))
PINS = tuple(complex(z) for z in (np.array([0, 90]) - KNOWN.coupler_point) * np.exp(-0.3j))


@pytest.mark.parametrize("count", [4, 7])
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


@pytest.mark.parametrize("count", [5])
def test_poses_of_an_exact_trammel_have_one(count):
    poses = [(60 * np.cos(t) + 0j, t) for t in (0, 0.3, 0.9, 1.7, 2.5)[:count]]
    guide = body_guides(poses, "elliptic-trammel")[0]
    assert guide.linkage.angle_deg == pytest.approx(90) and guide.linkage.rod == pytest.approx(60)
    assert not guide.defects and guide.pose_error < 1e-9
    # Its shuttle drives nearly as well as the best along any direction, by the rod's angles from the slot's normal.
    best = 90 - np.degrees(poses[-1][1]) / 2
    assert best - 2 < guide.transmission_angle_deg <= best + 1e-6


@pytest.mark.parametrize("count", [12])
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
        with pytest.raises(gk.DesignError):
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
    with pytest.raises(gk.DesignError):
        circle_of_sliders([*THREE, (7j, 2.0)])
    with pytest.raises(gk.DesignError):
        circle_of_sliders([(0j, 0.2), (40 + 0j, 0.2), (60 + 30j, 0.2 + 2 * np.pi)])
