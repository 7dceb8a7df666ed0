"""Six- and eight-bars for closed curves: chains against the general solver, derivatives, and curves that come back."""

from dataclasses import replace

import numpy as np
import pytest

import geomkin as gk
from geomkin.core.processes import Watch
from geomkin.synthesis.path import any_curve
from geomkin.synthesis.path.any_curve import ChainBounds, CurveSearch, CurveTask, Effort, lengths, matched, refined
from geomkin.synthesis.path.closed_lines import WantedLine, crossings, distances, evenly
from geomkin.synthesis.path.curve_library import (
    CurveLibrary,
    TimedPoints,
    closed_paths,
    curve_library,
    harmonics_of,
    target_curve,
)
from geomkin.synthesis.path.dyad_chains import extended, kinds_of, linkage_of, random_chains, traced

TURN = 2 * np.pi * np.arange(257) / 256
EIGHT = 40 * np.sin(TURN[:-1]) + 15j * np.sin(2 * TURN[:-1])


def one_of_each_kind(bars, seed=3):
    """A random chain of each kind."""
    chains = random_chains(bars, np.random.default_rng(seed), 300 * bars)
    rows = np.unique(chains.bodies.reshape(len(chains), -1), axis=0, return_index=True)[1]
    assert len(rows) >= 0.8 * len(kinds_of(bars))
    return chains[rows]


@pytest.fixture
def small(monkeypatch):
    """Searches of little work: a small library, few chains and no random changes."""

    def library(bars):
        chains = random_chains(bars, np.random.default_rng(bars), 800)
        return CurveLibrary(chains, harmonics_of(closed_paths(chains))[0].astype(np.complex64))

    monkeypatch.setattr(any_curve, "curve_library", library)
    monkeypatch.setattr(any_curve, "EFFORT", {4: Effort(8, 0, ()), 5: Effort(8, 0, ()), 6: Effort(8, 2, ())})
    few = [(samples, stages, kept) for (samples, stages, _), kept in zip(any_curve.ROUNDS, (4, 2, 1))]
    monkeypatch.setattr(any_curve, "ROUNDS", few)


@pytest.mark.parametrize("bars", [4, 5, 6, 7, 8])
def test_chains_move_as_the_general_linkages_made_of_them(bars):
    """The solver of linkages knows nothing of chains; each kind of chain has one branch, +1 but for four-bars."""
    chains = one_of_each_kind(bars)
    points = traced(chains, np.tile(TURN, (len(chains), 1)), derivatives=False).point
    for k in range(0, len(chains), 1 + len(chains) // 16):
        linkage, branch = linkage_of(chains, k, 2.0, 3 + 4j)
        drive = TURN + np.angle(chains.pins[k, 0, 0]) - np.radians(linkage.ground_angle_deg)
        motion = gk.move(linkage, drive, branch)
        assert np.abs(motion.point("coupler_point").position - (2 * points[k] + 3 + 4j)).max() < 1e-10
        general = linkage.linkage
        assert sum(len(points) > 1 for points in general.bodies.values()) == bars
        assert len(general.meshes) == (0 if bars % 2 == 0 else 1 + (chains.ratios[k, 0] > 0))


@pytest.mark.parametrize("bars", [7, 8])
def test_derivatives_agree_with_central_differences(bars):
    chains, step = one_of_each_kind(bars)[:8], 1e-6
    cranks = np.random.default_rng(1).uniform(0, 6, (len(chains), 5))
    moved, (_, by, _, here) = traced(chains, cranks), lengths(chains)
    for k in range(chains.x.shape[1]):
        shift = step * (np.arange(chains.x.shape[1]) == k)
        ends = [replace(chains, x=chains.x + sign * shift) for sign in (1, -1)]
        first, second = (traced(end, cranks, derivatives=False) for end in ends)
        scale = np.abs(moved.by).max()
        assert np.abs((first.point - second.point) / (2 * step) - moved.by[:, 1 + k]).max() < 1e-6 * scale
        assert (
            np.abs((first.folding - second.folding) / (2 * step) - moved.folding_by[:, :, 1 + k]).max() < 1e-6 * scale
        )
        difference = (lengths(ends[0])[0] - lengths(ends[1])[0]) / (2 * step)
        assert np.abs(difference - by[..., k])[here].max() < 1e-5


@pytest.mark.parametrize("bars", [6, 7])
def test_a_mirrored_and_turned_chain_traces_the_mirrored_and_turned_curve(bars):
    chains, cranks = one_of_each_kind(bars), np.linspace(0, 6, 9)[None]
    cranks = np.repeat(cranks, len(chains), axis=0)
    factor, shift = np.full(len(chains), 2 * np.exp(0.4j)), np.full(len(chains), 5 - 1j)
    before = traced(chains, cranks, derivatives=False).point
    for is_mirrored in (False, True):
        placed = chains.placed(factor, shift, np.full(len(chains), is_mirrored))
        after = traced(placed, -cranks if is_mirrored else cranks, derivatives=False).point
        assert np.abs(after - (factor[:, None] * (before.conj() if is_mirrored else before) + 5 - 1j)).max() < 1e-12


@pytest.mark.parametrize("bars", [4, 5])
def test_growth_changes_no_curve(bars):
    chains = one_of_each_kind(bars).placed(
        np.ones(1, dtype=complex), np.zeros(1, dtype=complex), np.zeros(1, dtype=bool)
    )
    chains = chains[np.zeros(40, dtype=int)]
    pair = np.tile([2, 0], (40, 1))
    grown, rows = extended(chains, pair, np.random.default_rng(0), chains.x[:, -2] + 1j * chains.x[:, -1])
    assert len(rows) > 3 and grown.bars == bars + 2
    assert np.abs(closed_paths(grown) - closed_paths(chains[rows])).max() < 1e-12


def test_distances_of_two_curves_are_those_of_brute_force():
    """An arc that is run there and back is near a loop that holds it, and not the other way round."""
    half, loop = np.exp(1j * np.linspace(0, np.pi, 60)), np.exp(1j * TURN)
    there_and_back = np.concatenate([half, half[-2:0:-1]])
    wanted = WantedLine.through(there_and_back)
    forward, largest, rms = wanted.both_ways(loop)
    fine = np.exp(1j * np.linspace(0, 2 * np.pi, 4001))
    back = np.abs(fine[:, None] - np.append(half, 1)).min(axis=1)
    assert forward.max() < 1e-3
    assert largest == pytest.approx(back.max(), rel=1e-2)
    assert rms == pytest.approx(np.sqrt(np.mean(back**2) / 2), rel=2e-2)
    assert distances(np.array([3 + 0j, 0j]), loop) == pytest.approx([2, np.cos(np.pi / 256)])


def test_known_linkages_are_found_at_once():
    """The curve of a chain of the library, run backwards from another point, mirrored, turned and scaled."""
    library = CurveLibrary(chains := one_of_each_kind(6), harmonics_of(closed_paths(chains))[0].astype(np.complex64))
    curve = 7 * np.exp(2j) * closed_paths(chains[4:5], 400)[0, ::-1].conj() + 50
    target = target_curve(np.append(np.roll(curve[:-1], 57), np.roll(curve[:-1], 57)[0]))
    nearest, likeness = library.nearest(target, 2)
    assert likeness[0] > 0.99 and (nearest.bodies[0] == chains.bodies[4]).all()
    path = closed_paths(nearest[:1], 400)[0]
    assert (
        distances(target.points, path).max() < 4
        and distances(path, np.append(target.points, target.points[0])).max() < 4
    )


@pytest.mark.parametrize(("bars", "part"), [(6, 1.0), (7, 1.0), (8, 1.0), (6, 0.6)])
def test_the_curve_of_a_chain_is_found_again_from_changed_sizes(bars, part):
    """Below 0.1 % of its size, by position analysis of the general solver; or a part of it, the rest being moved aside."""
    known = curve_of_known(bars)
    line, rest = closed_paths(known, 1024)[0], np.arange(1025) > 1024 * part
    aside = np.sin(np.pi * np.clip((np.arange(1025) / 1024 - part) / max(1 - part, 1e-9), 0, 1)) ** 2
    target = target_curve(line + 0.1 * np.ptp(line.real) * aside, (~rest).astype(float))
    fitted = known.placed(
        np.full(1, 1 / target.scale + 0j), np.full(1, -target.middle / target.scale), np.zeros(1, bool)
    )
    near = replace(fitted, x=fitted.x * (1 + 0.01 * np.cos(np.arange(fitted.x.shape[1]))))
    task = CurveTask(target, 5.0, 100.0, ChainBounds())
    state, _ = refined(task, matched(task, near, 80), 10, 0.25, 100.0)
    state, _ = refined(task, matched(task, state.chains, 256), 30, 0.03, 100.0)
    linkage, branch = linkage_of(state.chains, 0, target.scale, target.middle)
    path = gk.move(linkage, 2 * np.pi * np.arange(1025) / 1024, branch).point("coupler_point").position
    size = abs(complex(np.ptp(line.real), np.ptp(line.imag)))
    assert distances(line[~rest], path).max() < 1e-3 * size and (
        rest.any() or distances(path, line).max() < 1e-3 * size
    )


def curve_of_known(bars):
    """A random chain with good transmission and a curve without tips."""
    chains = one_of_each_kind(bars, seed=8)
    folding = traced(chains, np.tile(TURN, (len(chains), 1)), derivatives=False).folding
    steps = np.diff(evenly(closed_paths(chains, 512), 128)[0], axis=1)
    sharp = np.abs(np.angle(steps[:, 1:] / steps[:, :-1])).max(axis=1)
    best = int(np.argmin(sharp + 10 * (np.abs(folding).max(axis=(1, 2)) > 0.9)))
    return chains[best : best + 1]


@pytest.mark.campaign
def test_the_front_has_the_best_in_each_respect(small):
    """In bars, distance, angle and size: for each linkage that is left out one that is kept is as good within 2 %."""
    found = gk.path_generator(EIGHT[::4], closed=True, bars=5, geared=True)

    def size(one):
        motion = gk.move(one.linkage, TURN, one.branch)
        places = np.ravel([motion.point(name).position for name in (*motion.linkage.pins, "coupler_point")])
        return np.hypot(np.ptp(places.real), np.ptp(places.imag))

    sound = [one for one in found.ranked if not one.defects]
    costs = np.array([(one.bars, one.largest_distance, -one.transmission_angle_deg, size(one)) for one in sound])
    front = np.array([one in found.front for one in sound])
    nearly = costs[front] - 0.025 * np.abs(costs[front])
    as_good = (nearly[None] <= costs[:, None]).all(axis=2)
    assert 1 < front.sum() < len(sound) and as_good.any(axis=1).all()
    assert (costs[front].min(axis=0) <= costs.min(axis=0) + 0.025 * np.abs(costs.min(axis=0))).all()


@pytest.mark.campaign
def test_a_search_keeps_its_limits(small):
    limits = {"least_transmission_angle_deg": 25, "largest_ratio": 8}
    found = gk.path_generator(EIGHT[::4], closed=True, bars=5, geared=True, **limits)
    assert 5 in {one.bars for one in found.ranked} <= {4, 5}
    size = np.hypot(80, 30)
    for one in found.ranked:
        motion = gk.move(one.linkage, TURN, one.branch)
        path = motion.point("coupler_point").position
        back = distances(path, np.append(EIGHT, EIGHT[0])).max()
        assert np.degrees(gk.least_transmission_angle(motion)) >= 25 and one.ratio <= 8
        assert max(distances(EIGHT, path).max(), back) == pytest.approx(one.largest_distance, abs=2e-3 * size)


@pytest.mark.campaign
def test_open_paths_are_met_in_order_by_a_part_of_the_turn(small):
    """By position analysis of the linkages alone; the way back counts nothing."""
    points = EIGHT[10:120:2]
    found = gk.path_generator(points, bars=6)
    assert {one.bars for one in found.ranked} == {4, 6}
    for one in found.ranked:
        steps = np.diff(one.drive)
        assert ((steps >= 0).all() or (steps <= 0).all()) and np.ptp(one.drive) < 2 * np.pi
        motion = gk.move(one.linkage, one.drive, one.branch)
        off = np.abs(motion.point("coupler_point").position - points)
        assert off.max() == pytest.approx(one.largest_distance) and not one.closed
        turn = gk.move(one.linkage, np.sort(np.append(TURN, one.drive)), one.branch)
        assert np.degrees(gk.least_transmission_angle(turn)) >= 20
        # No place of the path between its ends is much nearer than that at the stated angle.
        between = gk.move(one.linkage, np.linspace(one.drive[0], one.drive[-1], 2000), one.branch)
        nearest = np.abs(between.point("coupler_point").position - points[:, None]).min(axis=1)
        assert np.median(off - nearest) < 1e-3 * 80


@pytest.mark.campaign
@pytest.mark.parametrize("closed", [False, True])
def test_timed_points_are_traced_at_their_crank_angles(small, closed):
    """By position analysis of the linkages alone, over the full turn too; falling angles, and a heavy part."""
    points, angles = EIGHT[:200:10], -15.0 * np.arange(20)
    weights = np.where(np.arange(20) < 8, 30.0, 1.0)
    found = gk.path_generator(points, angles, closed, bars=5, geared=True, weights=weights)
    assert {one.bars for one in found.ranked} == {4, 5}
    for one in found.ranked:
        assert np.degrees(one.drive - one.drive[0]) == pytest.approx(angles)
        off = np.abs(gk.move(one.linkage, one.drive, one.branch).point("coupler_point").position - points)
        assert one.square_error == pytest.approx(np.sum(off**2))
        if not closed:
            assert one.largest_distance == pytest.approx(off.max())
            assert one.weighted_rms_distance == pytest.approx(np.sqrt(np.average(off**2, weights=weights)))
        turn = gk.move(one.linkage, TURN, one.branch)
        assert turn.assembled.all() and np.degrees(gk.least_transmission_angle(turn)) >= 20 and one.ratio <= 10


def test_chains_that_pass_timed_points_are_found_at_once():
    """Those of a chain of the library that is mirrored, turned and scaled, at angles between its own from any start."""
    chains = one_of_each_kind(6)
    library = CurveLibrary(chains, harmonics_of(closed_paths(chains))[0])
    placed = chains[5:6].placed(np.full(1, 3 * np.exp(2j)), np.full(1, 50 - 8j), np.ones(1, bool))
    turns = np.array([0, 0.31, 0.8, 1.2, 2.2, 3.0, 3.3, 4.1])
    points = traced(placed, 1.7 + turns[None], derivatives=False).point[0]
    nearest, starts = TimedPoints(points, turns, np.ones(8)).nearest(library, 3)
    off = traced(nearest[:1], starts[:1, None] + turns, derivatives=False).point[0] - points
    assert (nearest.bodies[0] == placed.bodies[0]).all() and np.abs(off).max() < 0.1 * np.ptp(points.real)


@pytest.mark.campaign
@pytest.mark.parametrize("bars", [6, 7])
def test_timed_points_of_random_chains_are_met_again(bars):
    """Few points that four bars do not meet; by whatever linkage."""
    known, turns = curve_of_known(bars), np.array([0, 20, 45, 60, 90, 110])
    points = 30 * traced(known, np.radians(turns)[None], derivatives=False).point[0]
    found = gk.path_generator(points, turns, bars=bars, geared=bars == 7, time_limit=300)
    path = gk.move(found.linkage, found.drive[0] + np.radians(turns), found.branch).point("coupler_point").position
    assert np.abs(path - points).max() < 1e-5 * np.ptp(np.abs(points - points[0]))


def test_a_search_is_repeatable(small):
    task = CurveTask(target_curve(np.append(EIGHT, EIGHT[0])), 20.0, 10.0, ChainBounds())
    one, again, other = (CurveSearch(task, 4, False, 1, seed, Watch(60, "")) for seed in (4, 4, 5))
    for search in (one, again):
        known = matched(task, any_curve.curve_library(4).nearest(task.target, 2)[0], 80)
        search.best[4] = search.halved(search.hopped(known, 0.05, 6))[0]
    assert len(one.best[4]) and (one.best[4].chains.x == again.best[4].chains.x).all()
    assert other.rng.random() != CurveSearch(task, 4, False, 1, 4, Watch(60, "")).rng.random()


def test_the_nearest_linkages_are_laid_over_a_stroke():
    ellipse = 500 + 30 * np.cos(TURN[:-1:8]) + 20j * np.sin(TURN[:-1:8])
    nearest = gk.synthesis.nearest_linkages(ellipse, bars=4, count=3)
    for linkage, branch in nearest:
        path = gk.move(linkage, TURN, branch).point("coupler_point").position
        assert max(distances(ellipse, path).max(), distances(path, np.append(ellipse, ellipse[0])).max()) < 3
    with pytest.raises(gk.DesignError):
        gk.synthesis.nearest_linkages([1, 1, 1])


@pytest.mark.campaign
def test_ground_pivots_stay_in_their_boxes(small):
    bounds = {"origin_x": (-60, -50), "origin_y": (0, 0), "pivots_y": (-30, 30)}
    found = gk.path_generator(EIGHT[::4], closed=True, bars=6, bounds=bounds)
    for one in found.ranked:
        general = one.linkage.linkage
        pivots = gk.move(general, [0.0], one.branch)
        assert -60 - 1e-9 <= general.origin.real <= -50 + 1e-9 and abs(general.origin.imag) < 1e-9
        for name in general.bodies[general.ground]:
            assert abs(pivots.point(name).position[0].imag) <= 30 + 1e-9


@pytest.mark.campaign
def test_links_far_shorter_than_the_path_are_refused(small):
    path = np.array([0, 20 + 3j, 40 + 2j, 60, 72 + 12j, 75 + 28j, 70 + 45j])
    with pytest.raises(gk.DesignError) as refused:
        gk.path_generator(path, closed=False, bars=6, bounds={"links": (1e-6, 1e-5)})
    assert refused.value.field == "bounds"


@pytest.mark.parametrize("bars", [4, pytest.param(6, marks=pytest.mark.campaign)])
def test_links_stay_within_their_bounds(small, bars):
    found = gk.path_generator(EIGHT[::4], closed=True, bars=bars, bounds={"links": (15, 90)})
    for one in found.ranked:
        for points in one.linkage.linkage.bodies.values():
            pins = [complex(place) for name, place in points.items() if name != "coupler_point"]
            assert abs(pins[0] - pins[1]) >= 15 and max(abs(a - b) for a in pins for b in pins) <= 90


@pytest.mark.parametrize(
    ("given", "field"),
    [
        ({"slides": True}, "slides"),
        ({"drive_deg": 6.0 * np.arange(64)}, "drive_deg"),
        ({"drive_deg": np.arange(63.0)}, "drive_deg"),
        ({"bounds": {"crank": (1, 2)}}, "bounds"),
        ({"bounds": {"pivots_x": (2, 1)}}, "bounds"),
        ({"bounds": {"origin_x": (400, 500)}}, "bounds"),
        ({"bounds": {"origin_x": (90, 500), "links": (1, 60)}}, "bounds"),
        ({"bounds": {"links": (300, 400)}}, "bounds"),
        ({"bounds": {"links": (-2, 0)}}, "bounds"),
        ({"bounds": {"links": (1, 60)}, "bars": 4, "closed": False}, "bounds"),
        ({"bounds": {"links": (1, 60), "crank": (1, 60)}, "bars": 4}, "bounds"),
        ({"bars": 5}, "bars"),
        ({"bars": 4, "closed": False, "effort": 2}, "effort"),
        ({"effort": 0}, "effort"),
        ({"bars": 9, "geared": True}, "bars"),
        ({"bars": 4, "geared": True}, "bars"),
    ],
)
def test_conditions_that_only_four_bars_take_are_refused(given, field):
    with pytest.raises(gk.DesignError) as refusal:
        gk.path_generator(EIGHT[::4], **{"closed": True, "bars": 6, **given})
    assert refusal.value.field == field


def test_samples_are_interpolated_along_the_turn():
    """Half as many samples of an exact curve are nearly every second one, also where crank angles pass a full turn."""
    known = curve_of_known(6)
    wanted = closed_paths(known, 1024)[0]
    for line in (wanted, np.roll(wanted[:-1], 300)[::-1]):
        target = target_curve(np.append(line, line[0]))
        fitted = known.placed(
            np.full(1, 1 / target.scale + 0j), np.full(1, -target.middle / target.scale), np.zeros(1, bool)
        )
        task = CurveTask(target, 20.0, 10.0, ChainBounds())
        fine = matched(task, fitted, 512)
        few, many = fine.resampled(128), fine.resampled(128).resampled(512)
        for state in (fine, few, many):
            off = traced(state.chains, state.cranks, derivatives=False).point - target.at(state.places)[0]
            assert np.abs(off).max() < 2
        assert np.abs(np.exp(1j * few.cranks) - np.exp(1j * fine.cranks[:, ::4])).max() < 1e-9


def test_crossings_of_a_closed_curve_are_counted():
    """A figure eight has one, a rose of five petals ten, an ellipse and a stroke there and back none."""
    turn = np.linspace(0, 2 * np.pi, 2001)
    star = np.exp(2j * np.pi * np.array([0, 2, 4, 1, 3, 0]) / 5)
    assert crossings(np.append(EIGHT, EIGHT[0])) == 1
    assert crossings(40 * np.exp(2j * turn) + 60 * np.exp(-3j * turn)) == 10
    assert crossings(star) == 5
    assert crossings(3 * np.cos(turn) + 2j * np.sin(turn)) == crossings(np.cos(turn) + 2j * np.cos(turn)) == 0


@pytest.mark.parametrize(
    ("points", "used", "number"),
    [
        ([0, 60, 30 + 40j], 3, 3),
        (40 * np.exp(2j * TURN[:-1]) + 60 * np.exp(-3j * TURN[:-1]), 256, 10),
        (
            np.interp(np.linspace(0, 256, 100_000, endpoint=False), np.arange(257), np.append(EIGHT, EIGHT[0])),
            1000,
            100_000,
        ),
        (np.repeat(EIGHT[::4], 2), 64, 128),
        (EIGHT[::4], 64, None),
    ],
    ids=["polygon", "rose", "many", "twice", "ordinary"],
)
def test_what_is_odd_about_a_curve_is_stated_with_its_number(small, points, used, number):
    found = gk.path_generator(points, closed=True, time_limit=0.05)
    assert len(found.points) == used
    assert found.remarks == () if number is None else any(f"{number:,} " in remark for remark in found.remarks)


ROSE = 40 * np.cos(2.5 * 2 * TURN[:-1:2]) * np.exp(2j * TURN[:-1:2])


@pytest.mark.campaign
@pytest.mark.parametrize("points", [[0, 60, 30 + 40j], ROSE, 30 * np.cos(TURN[:-1:8]) + 0j], ids=["3", "rose", "line"])
def test_curves_that_no_linkage_follows_get_the_nearest_one_with_its_true_distance(small, points):
    found = gk.path_generator(points, closed=True, bars=6)
    path = gk.move(found.linkage, TURN, found.branch).point("coupler_point").position
    assert np.isfinite(path).all()
    assert found.largest_distance > distances(np.asarray(points, dtype=complex), path).max() - 0.05


@pytest.mark.campaign
@pytest.mark.parametrize("step_deg", [None, 7.0, 1e-9])
def test_open_paths_and_timed_points_may_rest_at_the_ends(small, step_deg):
    """Points that are given twice have no direction; angles that hardly differ have no linkage."""
    points = np.repeat(EIGHT[10:90:8], 2)
    drive = None if step_deg is None else step_deg * np.arange(20)
    if step_deg == 1e-9:
        with pytest.raises(gk.DesignError) as refusal:
            gk.path_generator(points, drive, bars=6)
        assert refusal.value.field == "points"
        return
    found = gk.path_generator(points, drive, bars=5, geared=True)
    off = np.abs(gk.move(found.linkage, found.drive, found.branch).point("coupler_point").position - points)
    assert off.max() == pytest.approx(found.largest_distance)


@pytest.mark.parametrize("points", [[0, 0, 0, 0], [1, 2], [0, 1e-320, 0, 0]])
def test_points_that_are_no_curve_are_refused(points):
    with pytest.raises(gk.DesignError) as refusal:
        gk.path_generator(points, closed=True, bars=8)
    assert refusal.value.field == "points"


@pytest.mark.campaign
def test_of_a_closed_path_a_loop_away_from_it_counts():
    """Few points of a narrow bean: the four-bar of the least squares of the points alone makes a large loop."""
    bean = 30 * np.cos(TURN[:-1:4]) + 1j * (15 * np.sin(TURN[:-1:4]) + 10 * np.cos(TURN[:-1:4]) ** 2)
    found = gk.path_generator(bean, closed=True)
    path = gk.move(found.linkage, TURN, found.branch).point("coupler_point").position
    assert distances(path, np.append(bean, bean[0])).max() < 0.02 * 65 and found.largest_distance < 0.02 * 65


@pytest.mark.campaign
@pytest.mark.parametrize("bars", [6, 7, 8])
def test_curves_of_random_chains_are_found_again(bars):
    """By whatever linkage, below 0.1 % of the size."""
    known = curve_of_known(bars)
    wanted = closed_paths(known, 400)[0]
    found = gk.path_generator(wanted[:-1], closed=True, bars=bars, geared=bars % 2 == 1, time_limit=300)
    path = gk.move(found.linkage, np.linspace(0, 2 * np.pi, 2001), found.branch).point("coupler_point").position
    size = abs(complex(np.ptp(wanted.real), np.ptp(wanted.imag)))
    assert max(distances(wanted, path).max(), distances(path, wanted).max()) < 1e-3 * size


@pytest.mark.campaign
def test_the_library_answers_at_once():
    assert all(len(curve_library(n).chains) > 10_000 for n in (4, 5, 6, 7, 8))
    task = CurveTask(target_curve(np.append(EIGHT, EIGHT[0])), 20.0, 10.0, ChainBounds())
    watch = Watch(0.3, "")
    assert curve_library(8).nearest(task.target, 12)[1][0] > 0.99 and not watch.over()
    assert CurveSearch(task, 4, False, 1, 0, Watch(60, "")).run()[4].chains.bars == 4
