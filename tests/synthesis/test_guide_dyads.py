"""Linkages made of dyads: which are paired, which stay in the region, which are best; regions that nobody asked for."""

from itertools import permutations

import numpy as np
import pytest

import geomkin as gk
from geomkin.core.progress import Watch
from geomkin.synthesis import body_guides, dyads_through, poles
from geomkin.synthesis.guidance import guide_groups
from geomkin.synthesis.guidance import guide_groups as guide_dyads
from geomkin.synthesis.guidance.dyads import Dyads
from geomkin.synthesis.guidance.guide_groups import GuideRequest, best_pairs, held_pins, inside_box
from tests.synthesis.test_guidance import KINDS, KNOWN, THREE, poses_of, random_poses
from tests.synthesis.test_guide_search import body_of

SLIDER = gk.SliderCrank(30, 80, 10, 20 + 15j, origin=3 + 4j, ground_angle_deg=30)
FOUR = poses_of(KNOWN, np.array([0.4, 0.8, 1.2, 1.7]))


def asked(poses, kinds=("four-bar",), **changed):
    told = {"shuttle": True, "region": None, "either": False, "least_angle": 0.0, "largest_ratio": None}
    return GuideRequest(
        body=body_of(poses), kinds=kinds, rng=np.random.default_rng(0), watch=Watch(60, "looking"), **told | changed
    )


def some_dyads(rng, count):
    """Every third a crank, a slide, and a line of the body over a pivot, which is left out."""
    fixed, moving = (rng.normal(0, 50, count) + 1j * rng.normal(0, 50, count) for _ in range(2))
    way = np.exp(1j * rng.uniform(-3, 3, count))
    sort, nowhere, far = np.arange(count) % 3, complex(np.nan, np.nan), complex(np.inf, np.inf)
    return Dyads(
        np.where(sort == 1, far, fixed),
        np.where(sort == 2, far, moving),
        np.where(sort == 1, way, nowhere),
        np.where(sort == 2, way, nowhere),
        np.zeros(count),
        np.ones(count, dtype=bool),
        np.ones(count, dtype=bool),
    )


def test_dyads_that_have_a_pin_on_the_body_are_held():
    dyads, turned = some_dyads(np.random.default_rng(1), 20), [(z + 7 - 3j, t + 0.6) for z, t in FOUR]
    for most in (None, 3):
        held = held_pins(body_of(turned), dyads, most)
        cranks, slides = (np.arange(first, 20, 3)[:most] for first in (0, 1))
        assert held.cranks.tolist() == list(range(len(cranks)))
        assert held.slides.tolist() == list(range(len(cranks), len(cranks) + len(slides)))
        own = dyads.moving[np.concatenate([cranks, slides])]
        assert held.pins == pytest.approx(np.array([z + np.exp(1j * t) * own for z, t in turned]))
        assert (held.pivots[held.cranks] == dyads.fixed[cranks]).all()
        assert (held.rails[held.slides] == dyads.fixed_direction[slides]).all()


def test_every_two_dyads_that_make_a_linkage_of_a_kind_are_paired():
    held = held_pins(body_of(FOUR), some_dyads(np.random.default_rng(2), 11))
    cranks, slides = held.cranks.tolist(), held.slides.tolist()
    assert len(cranks) == len(slides) == 4
    wanted = {
        "four-bar": set(permutations(cranks, 2)),
        "crank-slider": {(i, j) for i in cranks for j in slides},
        "slider-crank": {(i, j) for i in cranks for j in slides},
        "elliptic-trammel": set(permutations(slides, 2)),
    }
    for kind in KINDS:
        one, other = held.each(kind)
        pairs = list(zip(one.tolist(), other.tolist()))
        assert set(pairs) == wanted[kind] and len(pairs) == len(wanted[kind])
        guides = held.paired(kind, kind == "slider-crank", one, other)
        assert (guides.first == held.pins[:, one]).all() and (guides.second == held.pins[:, other]).all()


def test_dyads_outside_a_region_are_left_out():
    held = held_pins(body_of(FOUR), some_dyads(np.random.default_rng(3), 300))
    low, high = -60 - 50j, 150 + 120j
    kept = []
    for k in range(len(held.pivots)):
        joints = [*held.pins[:, k], *([held.pivots[k]] if k in held.cranks else [])]
        kept.append(all(low.real <= z.real <= high.real and low.imag <= z.imag <= high.imag for z in joints))
    found = inside_box(held, low, high)
    assert 20 < sum(kept) < 180 and (found.pins == held.pins[:, kept]).all()
    assert np.array_equal(found.pivots, held.pivots[kept]) and np.array_equal(found.rails, held.rails[kept], True)
    assert len(found.cranks) > 5 and len(found.slides) > 5


@pytest.mark.parametrize("kind", ["four-bar", "crank-slider"])
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
        told, sound = search.score(found), found.defects.none
    good = np.isfinite(told)
    assert told[0] == pytest.approx(score.max(), abs=1e-6) and np.degrees(told[0]) > 20
    # The best first, then the defective, which the region holds, too; as many as are wanted of either.
    assert (np.diff(told[good]) <= 0).all() and good.tolist() == sorted(good, reverse=True)
    assert 1 < good.sum() <= 6 and (~sound).sum() == guide_dyads.DEFECTIVE and not sound[~good].any()
    assert search.fits(found).all() and (fits & ~guides.defects.none).sum() > 5
    at = np.stack([found.first[0, good], found.second[0, good]], axis=1)
    apart = np.abs(at[:, None] - at).max(axis=2) + 1e9 * np.eye(len(at))
    assert apart.min() > guide_dyads.DISTINCT * abs(region[1] - region[0])


def test_pairing_ends_with_its_time_but_not_before_it_has_one():
    search = asked(FOUR, region=(-150 - 150j, 250 + 250j)).search("four-bar", 1.0)
    held = inside_box(held_pins(body_of(FOUR), dyads_through(FOUR, count=400)), search.low, search.high)
    found = [
        np.isfinite(search.score(best_pairs(search, held, 9, np.random.default_rng(1), Watch(time, "pairing")))).sum()
        for time in (0, 60)
    ]
    assert found[0] == 1 < found[1]


def test_a_region_that_nobody_asked_for_is_about_the_origins_and_poles_nearby():
    rng = np.random.default_rng(4)
    far = 0
    for count in (3, 4, 6):
        for spread in (0.05, 0.4, 3.0):
            poses = random_poses(rng, count, spread)
            # Two that are parallel have no pole.
            poses[1] = (poses[1][0], poses[0][1])
            origins = np.array([z for z, _ in poses])
            middle = origins.mean()
            extent = np.abs(origins - middle).max()
            at = np.array([complex(pole.position) for pole in poles(poses).values()])
            near = at[np.abs(at - middle) <= 3 * extent]
            far += len(at) - len(near) - 1
            z = np.concatenate([origins, near])
            half = max(z.real.max() - z.real.min(), z.imag.max() - z.imag.min())
            centre = complex(z.real.max() + z.real.min(), z.imag.max() + z.imag.min()) / 2
            ask = asked(poses)
            assert ask.room == pytest.approx((centre - half * (1 + 1j), centre + half * (1 + 1j)))
            for room in (1.0, 3.0):
                search = ask.search("four-bar", room)
                ends = (centre - room * half * (1 + 1j), centre + room * half * (1 + 1j))
                assert (search.low, search.high) == pytest.approx(ends)
    assert far > 10


def test_a_region_that_was_given_has_its_lower_left_corner_first():
    for region in ((0j, -1 + 1j), (0j, 1 - 1j), (0j, 0 + 1j), (0j, 1 + 0j)):
        with pytest.raises(gk.DesignError, match="region: found corners .*; give the lower left one first"):
            body_guides(THREE, region=region)
    assert asked(THREE, region=(-3 - 2j, 5 + 7j)).room == (-3 - 2j, 5 + 7j)


def test_what_is_asked_is_handed_to_the_search():
    ask = asked(THREE, least_angle=0.3, region=(0j, 40 + 20j))
    search = ask.search("four-bar", 2.0)
    assert (search.low, search.high) == (-20 - 10j, 60 + 30j)
    assert (search.kind, search.least_angle, search.largest_ratio, search.body) == ("four-bar", 0.3, 10.0, ask.body)
    assert asked(THREE, largest_ratio=4.0).search("four-bar", 1.0).largest_ratio == 4
    driven = {
        (kind, shuttle): asked(THREE, shuttle=shuttle).search(kind, 1.0).slides for kind in KINDS for shuttle in (0, 1)
    }
    assert [key for key, slides in driven.items() if slides] == [
        ("slider-crank", 0), ("slider-crank", 1), ("elliptic-trammel", 1)
    ]  # fmt: skip


def rooms_of(monkeypatch, poses, *more, **changed):
    """The regions that were searched in the end, by their size, and how many of what was found is sound."""
    rooms, search = [], GuideRequest.search
    monkeypatch.setattr(GuideRequest, "search", lambda self, kind, room: rooms.append(room) or search(self, kind, room))
    try:
        found = body_guides(poses, *more, **changed)
    except gk.DesignError:
        found = ()
    monkeypatch.setattr(GuideRequest, "search", search)
    return rooms, sum(not guide.defects for guide in found), len(found)


def test_a_larger_region_is_tried_where_one_that_nobody_asked_for_has_nothing(monkeypatch):
    # The regions in which a refusal looks besides are left out.
    monkeypatch.setattr(guide_groups, "LARGER", 0)
    rng = np.random.default_rng(1)
    met = set()
    for k in range(11):
        poses = random_poses(rng, 4, 1.0)
        for kind in ("four-bar", "crank-slider"):
            if (k, kind) not in ((0, "four-bar"), (0, "crank-slider"), (2, "crank-slider"), (10, "four-bar")):
                continue
            rooms, sound, _ = rooms_of(monkeypatch, poses, kind)
            met.add(len(rooms))
            assert tuple(rooms) == guide_groups.ROOMS[: len(rooms)] and (len(rooms) == 3 or sound)
            # What a smaller one holds is asked for by itself: nothing.
            middle, half = (sum(asked(poses).room) / 2, np.subtract(*asked(poses).room[::-1]) / 2)
            for room in rooms[:-1]:
                region = (middle - room * half, middle + room * half)
                one, good, _ = rooms_of(monkeypatch, poses, kind, region=region)
                assert one == [1.0] and good == 0
    assert met == {1, 2, 3}
    assert rooms_of(monkeypatch, FOUR, "four-bar", time_limit=0)[0] == [1.0]
    # Of three poses the same.
    flat = [(0j, 0.0), (40 + 20j, 2.9), (60 - 10j, -2.9)]
    for poses, kind in ((THREE, "four-bar"), (flat, "elliptic-trammel")):
        rooms, sound, _ = rooms_of(monkeypatch, poses, kind)
        assert tuple(rooms) == guide_groups.ROOMS[: len(rooms)] and (len(rooms) == 3) == (not sound)
    assert len(rooms) == 3 and rooms_of(monkeypatch, flat, "elliptic-trammel", time_limit=0)[0] == [1.0]
    assert rooms_of(monkeypatch, flat, "elliptic-trammel", region=(-100 - 100j, 100 + 100j))[0] == [1.0]


def test_no_more_are_listed_than_differ():
    for poses, region in ((THREE, None), (FOUR, (-150 - 150j, 250 + 250j))):
        found = body_guides(poses, "four-bar", region=region)
        sound = [guide for guide in found if not guide.defects]
        assert len(sound) <= guide_groups.LISTED and len(found) - len(sound) <= guide_dyads.DEFECTIVE
    assert len(sound) == guide_groups.LISTED


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


@pytest.mark.parametrize("drive", [[0.2, 0.8, 1.3, 2.0, 2.6], [0.2, 0.7, 1.1, 1.5, 2.0, 2.6]], ids=len)
def test_a_region_leaves_out_what_is_not_in_it_and_nothing_else(drive):
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


def test_least_squares_keep_to_even_links_unless_told_otherwise():
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


def test_guides_of_three_poses_are_ranked_by_their_angle_then_by_even_links():
    found = body_guides(THREE)
    order = [(bool(g.defects), -round(np.nan_to_num(g.transmission_angle_deg, nan=-1), 2), g.ratio) for g in found]
    assert order == sorted(order) and order[0][0] is False and order[-1][0] is True
    assert any(np.isnan(guide.transmission_angle_deg) for guide in found)
    least = found[2].transmission_angle_deg
    kept = body_guides(THREE, least_transmission_angle_deg=least - 1e-3)
    assert kept[0].transmission_angle_deg > least - 0.01
    assert all(guide.defects or guide.transmission_angle_deg >= least - 2e-3 for guide in kept)
