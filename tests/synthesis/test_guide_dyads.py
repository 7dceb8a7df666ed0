"""Linkages made of dyads: which are paired, which stay in the region, which are best; regions that nobody asked for."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.core.processes import Watch
from geomkin.synthesis import body_guides, dyads_through
from geomkin.synthesis.guidance import guide_groups as guide_dyads
from geomkin.synthesis.guidance.guide_groups import GuideRequest, best_pairs, held_pins, inside_box
from geomkin.synthesis.guidance.guide_search import Displacements
from tests.synthesis.test_guidance import KNOWN, THREE, poses_of

SLIDER = gk.SliderCrank(30, 80, 10, 20 + 15j, origin=3 + 4j, ground_angle_deg=30)
FOUR = poses_of(KNOWN, np.array([0.4, 0.8, 1.2, 1.7]))


def body_of(poses):
    return Displacements(np.array([z for z, _ in poses]), np.exp(1j * np.array([t for _, t in poses])))


def asked(poses, kinds=("four-bar",), **changed):
    reported = {"shuttle": True, "region": None, "either": False, "least_angle": 0.0, "largest_ratio": None}
    return GuideRequest(
        body=body_of(poses), kinds=kinds, rng=np.random.default_rng(0), watch=Watch(60, "looking"), **reported | changed
    )


@pytest.mark.parametrize("kind", ["four-bar"])
def test_the_best_pairs_of_dyads_are_those_that_brute_force_finds(kind, monkeypatch):
    if kind == "four-bar":
        # So few that their neighbours are needed besides.
        monkeypatch.setattr(guide_dyads, "PAIRED", 60)
    poses = FOUR if kind == "four-bar" else poses_of(SLIDER, np.array([0.2, 0.8, 1.3, 2.0]))
    region = (-150 - 150j, 250 + 250j)
    search = asked(poses, least_angle=np.radians(10), region=region).search(kind, 1.0)
    held = inside_box(held_pins(body_of(poses), dyads_through(poses, count=300)), *region)
    assert len(held.cranks) > 90
    every = held.each(kind)
    guides = held.paired(kind, False, *every)
    with np.errstate(all="ignore"):
        score, fits = search.score(guides), search.fits(guides)
    found = best_pairs(search, held, 6, np.random.default_rng(1), Watch(60, "pairing"))
    with np.errstate(all="ignore"):
        reported, sound = search.score(found), found.defects.none
    good = np.isfinite(reported)
    assert reported[0] == pytest.approx(score.max(), abs=1e-6) and np.degrees(reported[0]) > 20
    # The best first, then the defective, which the region holds, too; as many as are wanted of either.
    assert (np.diff(reported[good]) <= 0).all() and good.tolist() == sorted(good, reverse=True)
    assert 1 < good.sum() <= 6 and (~sound).sum() == guide_dyads.DEFECTIVE and not sound[~good].any()
    assert search.fits(found).all() and (fits & ~guides.defects.none).sum() > 5
    at = np.stack([found.first[0, good], found.second[0, good]], axis=1)
    apart = np.abs(at[:, None] - at).max(axis=2) + 1e9 * np.eye(len(at))
    assert apart.min() > guide_dyads.DISTINCT * abs(region[1] - region[0])


def test_a_region_that_was_given_has_its_lower_left_corner_first():
    for region in ((0j, -1 + 1j), (0j, 1 - 1j), (0j, 0 + 1j), (0j, 1 + 0j)):
        with pytest.raises(gk.DesignError):
            body_guides(THREE, region=region)
    assert asked(THREE, region=(-3 - 2j, 5 + 7j)).room == (-3 - 2j, 5 + 7j)


def joints_of(guide, poses):
    """Pins at all poses, which the body carries, and pivots, or where a trammel's slots cross."""
    bar = guide.linkage
    point, length = (bar.rod_point, bar.rod) if guide.kind == "elliptic-trammel" else (bar.coupler_point, bar.coupler)
    along = np.array([np.exp(1j * (t - np.radians(guide.body_angle_deg))) for _, t in poses])
    first = np.array([z for z, _ in poses]) - point * along
    ends = [bar.origin]
    if guide.kind == "four-bar":
        ends.append(bar.origin + bar.ground * np.exp(1j * np.radians(bar.ground_angle_deg)))
    return np.concatenate([first, first + length * along, ends])


@pytest.mark.campaign
@pytest.mark.parametrize("drive", [[0.2, 0.8, 1.3, 2.0, 2.6]], ids=len)
def test_region_excludes_exactly_the_linkages_outside_it(drive):
    poses = poses_of(SLIDER, np.array(drive))
    every = body_guides(poses)
    assert {guide.kind for guide in every} >= {"four-bar", "crank-slider", "slider-crank"}
    seen = set()
    for guide in every:
        z = joints_of(guide, poses)
        low, high = complex(z.real.min(), z.imag.min()), complex(z.real.max(), z.imag.max())
        for k, less in enumerate((0, 1, 1j, -1, -1j)):
            # Just large enough for this one, then too small on one side.
            grown = 1e-3 * (high - low)
            region = (low - grown + (2 * less * abs(grown) if k in (1, 2) else 0),
                      high + grown + (2 * less * abs(grown) if k in (3, 4) else 0))  # fmt: skip
            wanted = [
                one
                for one in every
                if all(
                    region[0].real <= at.real <= region[1].real and region[0].imag <= at.imag <= region[1].imag
                    for at in joints_of(one, poses)
                )
            ]
            try:
                found = body_guides(poses, region=region)
            except gk.DesignError:
                found = ()
            assert [one.kind for one in found] == [one.kind for one in wanted]
            assert [one.transmission_angle_deg for one in found] == pytest.approx(
                [one.transmission_angle_deg for one in wanted], nan_ok=True
            )
            seen.add((guide in wanted, len(wanted)))
    assert len(seen) > 3


@pytest.mark.campaign
def test_least_squares_keep_to_even_links_by_default():
    rng, drive = np.random.default_rng(5), np.linspace(0.4, 3.0, 6)
    shaken = [(z + complex(*rng.normal(0, 0.3, 2)), t) for z, t in poses_of(KNOWN, drive)]
    every = body_guides(shaken, largest_ratio=1e6)
    ratios = [guide.ratio for guide in every]
    assert min(ratios) < 4 and max(ratios) > 50
    for given, limit in (({}, 10), ({"largest_ratio": 4.0}, 4), ({"largest_ratio": 30.0}, 30)):
        found = body_guides(shaken, **given)
        assert [guide.ratio for guide in found] == pytest.approx([ratio for ratio in ratios if ratio <= limit])
    # Those without defects first, then what comes nearest to the poses.
    order = [(bool(guide.defects), guide.pose_error) for guide in every if np.isfinite(guide.pose_error)]
    assert order == sorted(order) and order[0][0] is False and order[-1][0] is True
    # How far the body is off, in place and in turn, is what moving the linkage shows.
    for guide in [guide for guide in every if not guide.defects][:3]:
        motion = gk.move(guide.linkage, guide.drive, guide.branch)
        turned = motion.coupler.direction * np.exp(1j * np.radians(guide.body_angle_deg))
        off = np.degrees(np.abs(np.angle(turned * np.exp(-1j * np.array([t for _, t in shaken])))))
        assert guide.angle_error_deg == pytest.approx(off.max(), rel=1e-6) and off.min() < 0.9 * off.max()
        away = np.abs(motion.point("coupler_point").position - [z for z, _ in shaken])
        assert guide.pose_error == pytest.approx(away.max(), rel=1e-6)
    # What meets the poses exactly is kept, however uneven it is.
    uneven = gk.FourBar(100, 6, 90, 70, coupler_point=40 + 30j)
    exact = body_guides(poses_of(uneven, drive))
    assert any(guide.ratio == pytest.approx(100 / 6) and guide.pose_error < 1e-6 for guide in exact)
