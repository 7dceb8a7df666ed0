"""Starts of path searches: random linkages moved, fits in closed form against plain least squares, curves laid over."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.synthesis.path import starts
from geomkin.synthesis.path.coupler_paths import closing
from geomkin.synthesis.path.fits import squares
from tests.synthesis.test_path_fits import task_of

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
