"""Starts of path searches: random linkages moved, fits in closed form against plain least squares, curves laid over."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.core.progress import Watch
from geomkin.synthesis.path import starts
from geomkin.synthesis.path.coupler_paths import closing, points_of
from geomkin.synthesis.path.fits import squares
from tests.synthesis.test_path_fits import CROSSING, at, task_of

FULL = np.linspace(0, 2 * np.pi, 721)


@pytest.mark.parametrize("slides", [False, True])
def test_random_linkages_turn_fully_where_they_must_and_are_of_every_kind(slides):
    limits = {"slides": slides, "least_transmission": np.radians(25), "largest_ratio": 8.0}
    drawn = starts.random_linkages(task_of([0, 1], closed=True, **limits), np.random.default_rng(0), 400)
    assert drawn.shape == (400, 4) and (drawn[:, 1] == 1).all() and (drawn[:, 2:] > 0).all()
    if slides:
        motion = gk.move(gk.SliderCrank(1, drawn[:, 2], drawn[:, 0]), FULL)
        assert (np.abs(drawn[:, 0]) > 0.1).sum() > 200 and drawn[:, 0].min() < -0.5 < 0.5 < drawn[:, 0].max()
    else:
        ground, _, coupler, rocker = drawn.T
        motion = gk.move(gk.FourBar(ground, 1, coupler, rocker), FULL)
        # Of those that turn fully the shortest link is the crank or the ground, which then is another kind.
        shortest = np.argmin(drawn, axis=1)
        assert set(shortest.tolist()) == {0, 1} and 40 < (shortest == 0).sum() < 200
        spread = np.log(coupler / rocker)
        assert abs(np.median(spread)) < 0.3 and np.ptp(spread) > 2
    least = np.degrees(gk.least_transmission_angle(motion))
    fully = motion.assembled.all(axis=0)
    if slides:
        # A coupler too short for its crank is drawn as well, and turns nowhere.
        assert fully.mean() > 0.5 and least[fully].min() > 0 and (least[fully] > 24.99).mean() > 0.95
    else:
        assert fully.all() and least.min() > 24.99 and least.min() < 27
    # An open path may have one that swings.
    drawn = starts.random_linkages(task_of([0, 1], **limits), np.random.default_rng(0), 400)
    bar = gk.SliderCrank(1, drawn[:, 2], drawn[:, 0]) if slides else gk.FourBar(drawn[:, 0], 1, *drawn[:, 2:].T)
    assert 0.3 < gk.move(bar, FULL).assembled.all(axis=0).mean() < 0.9


def fitted(task, x, turns, branch):
    crank, coupler = closing(x, x[:, 9, None] + turns, branch, task.slides)
    return starts.linear_fit(task, x, crank, coupler), crank, coupler


@pytest.mark.parametrize("held", ["free", "pivot", "turn", "turn and pivot"])
@pytest.mark.parametrize("slides", [False, True])
def test_a_fit_in_closed_form_is_that_of_plain_least_squares(slides, held):
    rng, turns = np.random.default_rng(2), np.linspace(0, 4, 9)
    x = np.array([[0.3 if slides else 3, 1, 3, 2.5, 0, 0, 0, 0, 0, 0]]) * np.exp(0.1 * rng.normal(size=(12, 10)))
    x[:, 9] = rng.uniform(0, 6, 12)
    low, high = np.full(10, -1e3), np.full(10, 1e3)
    low[:4] = -1e3 if slides else 1e-6
    pivot = 0.4 - 0.7j
    if "pivot" in held:
        low[[6, 7]] = high[[6, 7]] = pivot.real, pivot.imag
    if "turn" in held:
        low[8], high[8] = 40.0, 40.5
    wanted = rng.normal(size=9) + 1j * rng.normal(size=9)
    task = task_of(wanted, turns=turns, slides=slides, low=low, high=high)
    (found, score), crank, coupler = fitted(task, x, turns, rng.choice([-1.0, 1.0], 12))
    seen = set()
    for row, one, two, c, b in zip(found, score, x, crank, coupler):
        free = [] if "pivot" in held else [np.ones(9)]
        target = wanted - pivot if "pivot" in held else wanted

        def left(columns, target=target):
            rows = np.stack(columns, axis=1)
            off = rows @ np.linalg.lstsq(rows, target)[0] - target
            return np.sum(np.abs(off) ** 2)

        best = left([two[1] * c, b, *free])
        angle = (row[8] - 40) % (2 * np.pi)
        if "turn" in held and (angle < 1e-9 or abs(angle - 0.5) < 1e-9):
            # At an end of what it may turn only its size is fitted: columns over real numbers.
            columns = [np.exp(1j * row[8]) * two[1] * c, b, 1j * b, *free, *(1j * v for v in free)]
            best = left([np.append(v.real, v.imag) for v in columns], np.append(target.real, target.imag))
            seen.add(round(row[8], 6))
        assert low[8] <= row[8] <= high[8] + 1e-9 or not np.isfinite(one)
        if np.isfinite(one):
            assert one == pytest.approx(best, rel=1e-9)
            if "pivot" in held:
                assert complex(row[6], row[7]) == pytest.approx(pivot)
            assert row[:3] / row[1] == pytest.approx(two[:3] / two[1]) and row[1] > 0
            assert row[3] / row[1] == pytest.approx(two[3] / two[1]) or slides
    assert np.isfinite(score).sum() >= (6 if "turn" in held else 12)
    assert "turn" not in held or seen == {40.0, 40.5}
    # What it gives is that linkage.
    good = np.isfinite(score)
    if held == "free":
        sides = np.where(
            np.abs(closing(x, x[:, 9, None] + turns, np.ones(12), slides)[1] - coupler).max(axis=1) < 1e-9, 1.0, -1
        )
        assert squares(task, found, np.zeros((12, 9)), sides)[good] == pytest.approx(score[good], rel=1e-9)


@pytest.mark.parametrize("asked", ["back", "closed"])
def test_a_curve_is_laid_over_the_points_wherever_and_however_large_it_is(asked):
    """A linkage among others, its path moved, turned and scaled: it is the most alike, and comes to lie on the points."""
    rng, closed = np.random.default_rng(7), "closed" in asked
    x = CROSSING * np.exp(0.15 * rng.normal(size=(5, 10)))
    x[2] = CROSSING
    x[:, 6:] = 0
    cranks = np.linspace(0, 2 * np.pi, 257) if closed else np.linspace(0.3, 3.4, 257)
    path = points_of(x, np.tile(cranks, (5, 1)), np.ones(5), False)
    moved = 2.5 * np.exp(2.2j) * path[2] + 4 - 3j
    if closed:
        # Points in the order of the curve, from anywhere on, as the tour finds them.
        wanted = np.roll(moved[:-1:4], 11)
        wanted = wanted[::-1] if "back" in asked else wanted
        placed, score, _ = starts._closed(task_of(wanted, closed=True), x, path)
        assert at(placed[2], cranks[:-1:4]) == pytest.approx(moved[:-1:4], abs=0.2)
    else:
        cranks, path = (cranks[::-1], path[:, ::-1]) if "back" in asked else (cranks, path)
        wanted = np.concatenate([moved[:100:2], moved[100::3], moved[-1:]])[:: -1 if "back" in asked else 1]
        placed, score, of = starts._open(task_of(wanted), x, path, np.tile(cranks, (5, 1)))
        assert at(placed[2], cranks) == pytest.approx(moved[:: -1 if "back" in asked else 1], abs=0.05)
        rows = np.array([4, 2])
        assert of(rows).shape == (2, len(wanted)) and at(placed[2], of(rows)[1]) == pytest.approx(wanted, abs=0.05)
    assert (
        np.argmin(score) == 2
        and score[2] < (8e-3 if closed else 1e-3)
        and (np.delete(score, 2) > 1.5 * score[2]).all()
        and ((score >= 0) & (score <= 1)).all()
    )
    ratios = placed[:, :6] / x[:, :6]
    assert ratios == pytest.approx(np.repeat(ratios[:, :1], 6, axis=1)) and ratios[2, 0] == pytest.approx(2.5, rel=0.01)


@pytest.mark.parametrize("asked", ["open", "closed", "slides"])
def test_starts_are_near_the_points_and_the_best_come_first(asked, monkeypatch):
    for name, value in {
        "TRIED": 1000,
        "TRIED_AT_ONCE": 500,
        "FITTED": 200,
        "SCORED": 2000,
        "SCORED_AT_ONCE": 500,
    }.items():
        monkeypatch.setattr(starts, name, value)
    drive = np.linspace(0.2, 6, 20)
    wanted = at(CROSSING, drive)
    wanted = (wanted - wanted.mean()) / np.sqrt(np.mean(np.abs(wanted - wanted.mean()) ** 2))
    timed = asked in ("timed", "slides")
    task = task_of(
        wanted, turns=drive - 0.2 if timed else None, closed=asked == "closed", slides=asked == "slides",
        low=np.array([-50.0 if asked == "slides" else 1e-6, 1e-6, 1e-6, 1e-6, -50, -50, -50, -50, -9, -9]),
    )  # fmt: skip
    told = []
    monkeypatch.setattr(Watch, "report", lambda self, share: told.append(share))
    rng = np.random.default_rng(8)
    if timed:
        x, branch = starts.timed_starts(task, rng, Watch(60, ""))
        t = np.zeros((len(x), 20))
    else:
        x, t, branch = starts.free_starts(task, rng, Watch(60, ""))
    off = squares(task, x, t, branch)
    assert x.shape == (len(off), 10) and t.shape == (len(off), 20) and set(branch.tolist()) == {1, -1}
    if asked == "open":
        # From end to end in one sense, wherever else the path comes near to the points.
        steps = np.diff(t, axis=1)
        assert ((steps > 0).all(axis=1) | (steps < 0).all(axis=1)).all()
    # No worse than all points in one place, and the first of them far better.
    assert 20 < len(off) <= starts.IMPROVED and (off < 20 + 1e-6).all() and off[:3].max() < 0.3 * 20
    assert np.median(off[:10]) < np.median(off[-10:])
    assert told == sorted(told) and told[0] == 0 and 0.1 < told[-1] < 0.3
    late = starts.timed_starts(task, rng, Watch(0, "")) if timed else starts.free_starts(task, rng, Watch(0, ""))
    assert [len(rows) for rows in late] == [0] * len(late)
