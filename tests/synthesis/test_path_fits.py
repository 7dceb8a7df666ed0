"""What fits of paths are held within, and how they are brought to it: limits against linkages that are moved finely."""

import dataclasses

import numpy as np
import pytest

import geomkin as gk
from geomkin.core.processes import Watch
from geomkin.synthesis.path import search
from geomkin.synthesis.path.coupler_paths import points_of
from geomkin.synthesis.path.fits import PathTask, nearest_angles, nearest_from, polished_starts, refined_starts, squares
from geomkin.synthesis.path.search import _cranks_for_all_points
from geomkin.synthesis.path.starts import random_linkages

WIDE = np.array([1e-6, 1e-6, 1e-6, 1e-6, -50, -50, -50, -50, -9, -9]), np.full(10, 50.0)
# Its coupler point crosses its own path.
CROSSING = np.array([3.0, 1, 3, 2.5, 1.5, -1.6, 0, 0, 0.4, 0])


def task_of(wanted, **changed):
    plain = PathTask(np.asarray(wanted, dtype=complex), None, False, False, np.radians(0.1), np.inf, *WIDE)
    return dataclasses.replace(plain, **changed)


def at(x, cranks, branch=1.0, slides=False):
    return points_of(x[None], np.asarray(cranks)[None], np.array([branch]), slides)[0]


def linkage_of(x, slides):
    lengths = {"crank": x[1], "coupler": x[2], "coupler_point": complex(x[4], x[5])}
    return gk.SliderCrank(offset=x[0], **lengths) if slides else gk.FourBar(ground=x[0], rocker=x[3], **lengths)


@pytest.mark.parametrize("asked", ["open", "closed", "timed"])
@pytest.mark.parametrize("slides", [False, True])
def test_limit_violation_agrees_with_the_motion(slides, asked):
    """Ways of random linkages, moved finely: whether they close, their least transmission angle, their lengths."""
    rng, seen = np.random.default_rng(3), []
    turns = np.array([0, 0.4, 2.0]) * rng.uniform(0.1, 3) if asked == "timed" else None
    task = task_of(
        np.ones(3), turns=turns, closed=asked == "closed", slides=slides,
        least_transmission=np.radians(35), largest_ratio=2.5,
    )  # fmt: skip
    for _ in range(60):
        x = np.array([*np.exp(rng.uniform(-0.7, 0.7, 4)), *rng.normal(size=6)])
        if slides:
            x[0], x[2] = rng.uniform(-1, 1), x[2] + 1
        t = rng.uniform(-7, 7) + rng.uniform(0, 6) * np.array([0.3, 1, 0])
        cranks = task.cranks(x[None], t[None])
        assert cranks[0] == pytest.approx(t if turns is None else x[9] + turns)
        span = (0, 2 * np.pi) if asked == "closed" else (cranks.min(), cranks.max())
        motion = gk.move(linkage_of(x, slides), np.linspace(*span, 2001))
        lengths = [x[1], x[2]] if slides else x[:4]
        long = np.log(max(lengths) / min(lengths) / 2.5)
        passed = float(task.passed(x[None], cranks)[0])
        if motion.assembled.all():
            folded = np.cos(gk.least_transmission_angle(motion)) - np.cos(task.least_transmission)
            assert passed == pytest.approx(max(folded, long), abs=1e-5)
            seen.append("long" if long > folded else "folded")
        else:
            # What does not close is beyond the limit by what is missing to a toggle, at least.
            assert passed > 1 - np.cos(task.least_transmission) - 1e-9
            seen.append("open")
    assert len(set(seen)) == 3
    lost = np.array([[0.0 if slides else 1, 1, 0, 1, 0, 0, 0, 0, 0, 0]])
    with np.errstate(all="ignore"):
        assert task.passed(lost, np.zeros((1, 3))) == np.inf


@pytest.mark.parametrize("brought", [polished_starts, refined_starts])
def test_cranks_of_an_open_path_stay_on_their_part_of_it_where_it_crosses_itself(brought):
    turn = np.linspace(0, 2 * np.pi, 721)[:-1]
    path = at(CROSSING, turn)
    apart = np.abs((turn[:, None] - turn + np.pi) % (2 * np.pi) - np.pi) > 0.6
    here, other = np.unravel_index(np.argmin(np.where(apart, np.abs(path[:, None] - path), np.inf)), apart.shape)
    assert abs(path[here] - path[other]) < 0.02
    drive = turn[here] + np.linspace(-0.6, 5.4, 51)
    # One point beside the crossing lies on the other part of the path, by which an open one comes at another time.
    wanted, beside = at(CROSSING, drive), np.argmin(np.abs(drive - turn[here])) + 2
    wanted[beside] = min(path[other + 12], path[other - 12], key=lambda place: abs(place - wanted[beside]))
    task = task_of(wanted)
    x, t, _ = brought(task, CROSSING[None], drive[None], np.ones(1), Watch(60, ""))
    assert t[0] == pytest.approx(drive, abs=0.3)
    assert squares(task, x, t, np.ones(1)) <= squares(task, CROSSING[None], drive[None], np.ones(1))


@pytest.mark.parametrize("brought", [polished_starts, refined_starts])
def test_points_of_a_closed_path_find_their_places_on_it(brought):
    drive = np.random.default_rng(4).uniform(0, 2 * np.pi, 40)
    task = task_of(at(CROSSING, drive), closed=True)
    # With few points the other part of the path is reported, which is near them as well.
    start = np.where(np.arange(40) % 10 == 0, drive + 2.5, drive)[None]
    x, t, branch = brought(task, CROSSING[None] * 1.001, start, np.ones(1), Watch(60, ""))
    assert x.shape == (1, 10) and squares(task, x, t, branch)[0] < 1e-12


@pytest.mark.parametrize("closed", [False, True])
def test_cranks_of_many_points_come_to_the_nearest_places_of_the_path(closed, monkeypatch):
    rng = np.random.default_rng(6)
    drive = 0.2 + np.linspace(0, 5.8, 61)
    path = at(CROSSING, drive)
    off = 0.01 * (rng.normal(size=61) + 1j * rng.normal(size=61))
    task, x, branch = task_of(path + off, closed=closed), CROSSING[None], np.ones(1)
    found = nearest_from(task, x, drive[None] + 0.05 * rng.normal(size=(1, 61)), branch)
    # Brute force around each; nothing is left along the path.
    near = drive[:, None] + np.linspace(-0.15, 0.15, 3001)
    looked = np.abs(at(CROSSING, near.ravel()).reshape(near.shape) - (path + off)[:, None])
    assert found[0] == pytest.approx(near[np.arange(61), looked.argmin(axis=1)], abs=2e-4)
    ahead, behind = (np.abs(at(CROSSING, found[0] + side * 1e-4) - path - off) ** 2 for side in (1, -1))
    assert np.abs(ahead - behind).max() < 1e-9
    # From cranks of a few of the points: by their places along the path of an open one, by looks of a closed one.
    few = task.thinned(16)
    chosen = [int(np.flatnonzero(task.wanted == place)[0]) for place in few.wanted]
    t = _cranks_for_all_points(task, few, x, found[:, chosen], branch)
    more = np.abs(at(CROSSING, t[0]) - path - off) - looked.min(axis=1)
    # Where two parts of the path are near a point alike, either is taken of a closed one.
    assert t.shape == (1, 61) and more.max() < 0.01 and (more < 1e-6).mean() > (0.9 if closed else 0.999)
    assert closed or t[0] == pytest.approx(found[0], abs=1e-3)
    assert not _cranks_for_all_points(
        dataclasses.replace(task, turns=drive - 0.2), few, x, found[:, chosen], branch
    ).any()
    monkeypatch.setattr(search, "nearest_from", lambda task, x, t, branch: t)
    t = _cranks_for_all_points(task, few, x, found[:, chosen], branch)
    assert closed or (t[:, chosen] == pytest.approx(found[:, chosen]) and (np.diff(t) > 0).all())


def test_nearest_points_of_closed_paths_agree_with_brute_force():
    """Random crank-rockers, whose paths have tips and crossings, and points beside their paths."""
    rng = np.random.default_rng(5)
    fine, misses = np.linspace(0, 2 * np.pi, 6001), []
    task = task_of(np.ones(1), closed=True)
    for lengths in random_linkages(task, rng, 30):
        x = np.array([*lengths, *rng.normal(size=2) * lengths[2], 0, 0, 0, 0])
        path = at(x, fine)
        size = np.abs(path - path.mean()).max()
        wanted = rng.choice(path, 60) + 0.02 * size * (rng.normal(size=60) + 1j * rng.normal(size=60))
        few = dataclasses.replace(task, wanted=wanted)
        t = nearest_angles(few, x[None], rng.uniform(0, 2 * np.pi, (1, 60)), np.ones(1))[0]
        misses += list((np.abs(at(x, t) - wanted) - np.abs(path - wanted[:, None]).min(axis=1)) / size)
    assert max(misses) < 0.02 and np.mean(np.array(misses) < 1e-4) > 0.997


WEIGHED = np.array([0, 10 + 8j, 22 + 15j, 33 + 14j, 44 + 6j, 50 - 6j, 44 - 16j, 30 - 18j, 14 - 16j, 3 - 9j])
HEAVY = np.where(np.arange(10) < 5, 100.0, 1.0)


def away(linkage, result, timed):
    """Distances of the points from the path near the given angles, or from the places at these angles."""
    drive = result.drive[:, None] + (np.zeros(1) if timed else np.linspace(-0.02, 0.02, 4001))
    path = gk.move(linkage, drive.ravel(), result.branch).point("coupler_point").position
    return np.nanmin(np.abs(path.reshape(drive.shape) - result.points[:, None]), axis=1)


@pytest.mark.campaign
@pytest.mark.parametrize(
    "given", [{}, {"drive_deg": 25.0 * np.arange(10)}, {"slides": True}], ids=["open", "timed", "slider"]
)
def test_points_with_weights_have_the_least_weighted_squares(given):
    """Against results without weights and sizes that are slightly changed, by position analysis alone."""
    timed = "drive_deg" in given
    plain, found = (gk.path_generator(WEIGHED, weights=of, largest_ratio=20, **given) for of in (None, HEAVY))

    def weighted(linkage, result):
        return float(np.average(away(linkage, result, timed) ** 2, weights=HEAVY))

    off, least = away(found.linkage, found, timed), weighted(found.linkage, found)
    assert found.square_error == pytest.approx(np.sum(off**2), rel=1e-3)
    assert found.weighted_rms_distance**2 == pytest.approx(least, rel=1e-3)
    assert found.weighted_largest_distance == pytest.approx((off * np.sqrt(HEAVY / 100)).max(), rel=1e-3)
    assert least < weighted(plain.linkage, plain) and plain.weighted_rms_distance is None
    for name in () if found.at_limits else ("crank", "coupler"):
        for factor in (0.999, 1.001):
            other = dataclasses.replace(found.linkage, **{name: getattr(found.linkage, name) * factor})
            assert weighted(other, found) > least


@pytest.mark.campaign
@pytest.mark.parametrize("bars", [4, 6])
def test_a_heavy_part_of_a_closed_path_is_met_more_exactly_both_ways(bars):
    """Distances by brute force; a curve with a straight side of 40 points."""
    arc = 40 * np.exp(1j * np.linspace(0, np.pi, 40))[1:-1]
    points = np.concatenate([np.linspace(-40, 40, 40), arc.real + 0.6j * arc.imag])
    heavy = np.where(np.arange(len(points)) < 40, 50.0, 1.0)
    worst = []
    for weights in (None, heavy):
        found = gk.path_generator(points, closed=True, bars=bars, weights=weights)
        path = gk.move(found.linkage, np.linspace(0, 2 * np.pi, 8001), found.branch).point("coupler_point").position
        off = np.abs(path[:, None] - points).min(axis=0)
        back = path[(path.imag < 5) & (np.abs(path.real) < 30)]
        worst.append(max(off[:40].max(), np.abs(back.imag).max()))
        if weights is not None:
            least = max((off * np.sqrt(heavy / 50)).max(), worst[-1])
            assert found.weighted_largest_distance == pytest.approx(least, rel=0.05)
            assert found.largest_distance == pytest.approx(off.max(), rel=0.05)
            assert found.weighted_rms_distance < found.rms_distance
    assert worst[1] < 0.7 * worst[0]


def test_fits_with_weights_have_the_least_weighted_squares():
    """From near the linkage of most points: a changed point counts little if the others are heavy."""
    known = gk.FourBar(100, 30, 90, 70, 60 + 45j)
    drive = np.linspace(0.3, 2.5, 12)
    points = gk.move(known, drive).point("coupler_point").position
    middle, size = points.mean(), np.sqrt(np.mean(np.abs(points - points.mean()) ** 2))
    wanted = (points - middle) / size + np.where(np.arange(12) == 6, 0.05, 0)
    x = np.array([[100, 30, 90, 70, 60, 45, -middle.real, -middle.imag, 0, 0]]) / size
    missed = []
    for heavy in (1.0, 100.0):
        weights = np.where(np.arange(12) == 6, 1.0, heavy)
        task = PathTask(wanted, None, False, False, np.radians(0.1), np.inf, *WIDE, weights)
        fitted, t, branch = refined_starts(task, x, drive[None], np.ones(1), Watch(60, ""))
        off = np.abs(points_of(fitted, t, branch, False)[0] - wanted)
        missed.append(np.delete(off, 6).max())
        least = np.sum(weights * off**2)
        for k in (0, 1, 2, 5):
            for step in (1e-4, -1e-4):
                other = fitted + step * (np.arange(10) == k)
                moved = nearest_from(task, other, t, branch)
                assert np.sum(weights * np.abs(points_of(other, moved, branch, False)[0] - wanted) ** 2) > least
    assert missed[1] < 0.2 * missed[0]


@pytest.mark.parametrize(
    "weights", [[1.0, 2.0], [0.0] * 10, [1e9] * 10, [np.nan] * 10], ids=["few", "zero", "large", "nan"]
)
def test_weights_out_of_range_are_refused(weights):
    with pytest.raises(gk.DesignError) as refused:
        gk.path_generator(WEIGHED, weights=weights)
    assert refused.value.field == "weights"
