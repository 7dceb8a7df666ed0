"""What searches for function generators are told of a linkage: errors by its motion, limits by its least angle, slopes
by central differences; and what they start from.
"""

import dataclasses
import itertools
import sys

import numpy as np
import pytest

import geomkin as gk
from geomkin.synthesis.function.generators import FourBarGenerator, SliderGenerator, evenly
from geomkin.synthesis.function.minimax import _least_return, _newton, certified

S = np.linspace(0, 1, 41)


def share(s):
    return (np.exp(s) - 1) / (np.e - 1)


COMMON = {"share": share, "starts": (np.nan, np.nan), "least_transmission": np.radians(25), "largest_ratio": 6.0}
TASKS = [
    FourBarGenerator(swing=1.1, out=0.8, ground=100.0, **COMMON),
    FourBarGenerator(swing=-2.3, out=-1.2, ground=7.0, **COMMON),
    SliderGenerator(swing=1.2, sense=1.0, length=50.0, **COMMON),
    SliderGenerator(swing=-2.1, sense=-1.0, length=3.0, **COMMON),
]
tasks = pytest.mark.parametrize("task", TASKS, ids=["four-bar", "four-bar back", "slider", "slider back"])


def some(task, count=40):
    """Candidates of either branch, their output's start where the search puts it."""
    p = task.centred(task.spread(400), S)
    return p[:: max(1, len(p) // count)]


@tasks
def test_slopes_are_those_of_central_differences(task):
    task = dataclasses.replace(task, through=(0.1, 0.5))
    p, step = some(task), 1e-6
    slopes, (limits, steep) = task.slopes(p, S[None]), task.limits(p)
    assert np.isfinite(slopes).all() and (p[:, 5] == 1).any() and (p[:, 5] == -1).any() and len(p) > 20
    assert limits.shape[1] == len(task.limit_names) + 4
    for k in range(5):
        ahead, behind = (p + side * step * np.eye(6)[k] for side in (1, -1))
        change = (task.error(ahead, S[None]) - task.error(behind, S[None])) / (2 * step)
        assert slopes[..., k] == pytest.approx(change, rel=1e-5, abs=1e-5)
        one, other = (task.limits(side)[0] for side in (ahead, behind))
        # Where an angle in line enters the way, its limit has no slope.
        smooth = np.abs(one + other - 2 * limits) < 1e-8
        assert smooth.mean() > 0.95
        assert steep[..., k][smooth] == pytest.approx(((one - other) / (2 * step))[smooth], rel=1e-5, abs=1e-5)
    assert (slopes[..., 5] == 0).all()


@pytest.mark.parametrize("way", [1, 4.0])
@tasks
def test_limits_are_kept_where_the_motion_keeps_them(task, way):
    # Four times as far they come by both angles in line, or square, on the way.
    task = dataclasses.replace(task, swing=np.sign(task.swing) * min(abs(way * task.swing), 5.6))
    loose = dataclasses.replace(task, least_transmission=np.radians(2), largest_ratio=30.0)
    seen = set()
    for p in some(loose):
        linkage, drive = task.linkage(p), p[3] + task.swing * np.linspace(0, 1, 4001)
        motion = gk.move(linkage, drive, int(p[5]))
        assert motion.assembled.all()
        angle = float(gk.least_transmission_angle(motion))
        assert float(task.transmission(p[None])[0]) == pytest.approx(angle, abs=1e-6)
        lengths = [
            linkage.crank,
            linkage.coupler,
            *([linkage.ground, linkage.rocker] if isinstance(linkage, gk.FourBar) else []),
        ]
        ratio = max(lengths) / min(lengths)
        # Of the names those whose limits are passed.
        passed = {name for name, value in zip(task.limit_names, task.bounds(p[None])[0][0], strict=True) if value > 0}
        wanted = {"transmission angle"} if angle < task.least_transmission else set()
        assert passed == wanted | ({"ratio"} if ratio > task.largest_ratio else set())
        seen.add(tuple(sorted(passed)))
        low, high = task.way(p[None])
        assert (low[0], high[0]) == pytest.approx((drive.min(), drive.max()))
    assert len(seen) >= 3


@tasks
def test_starts_lie_within_the_limits_and_their_largest_errors_are_alike(task):
    p = task.spread(500)
    assert (task.bounds(p)[0] <= 1e-9).all() and (np.diff([(p[:, 5] == side).sum() for side in (1, -1)]) < len(p)).all()
    centred = task.centred(p, S)
    error = task.error(centred, S[None])
    error = np.unwrap(error, axis=1) if isinstance(task, FourBarGenerator) else error
    assert error.max(axis=1) == pytest.approx(-error.min(axis=1))
    assert (centred[:, [0, 1, 2, 3, 5]] == p[:, [0, 1, 2, 3, 5]]).all()
    for k in (0, 1):
        given = tuple(0.3 if j == k else np.nan for j in (0, 1))
        held = dataclasses.replace(task, starts=given)
        assert (held.centred(held.spread(300), S)[:, 3 + k] == 0.3).all()
        assert held.free.tolist() == [True] * 3 + [k != 0, k != 1, False]


@tasks
def test_a_linkage_is_among_the_fits_of_what_it_does_itself(task):
    """Its starts are given: then the equation of the loop has one solution."""
    for side in (1, -1):
        p = next(row for row in some(task) if row[5] == side)
        places = task.error(p[None], S[None])[0] + (
            task.out if isinstance(task, FourBarGenerator) else task.sense
        ) * share(S)
        way = np.unwrap(places) if isinstance(task, FourBarGenerator) else places
        own = dataclasses.replace(
            task, starts=(p[3], p[4] + way[0]), share=lambda s: np.interp(s, S, (way - way[0]) / (way[-1] - way[0])),
            **({"out": way[-1] - way[0]} if isinstance(task, FourBarGenerator) else {"sense": 1.0}),
        )  # fmt: skip
        if not isinstance(task, FourBarGenerator):
            own = dataclasses.replace(own, share=lambda s: np.interp(s, S, way - way[0]))
        found = own.fitted(1, S)
        assert len(found) == 2
        near = found[found[:, 5] == side][0]
        assert near[:3] == pytest.approx(p[:3], rel=1e-5, abs=1e-5)
        assert np.abs(own.error(near[None], S[None])).max() < 1e-6


@tasks
def test_fits_are_least_squares_of_the_output_to_first_order(task):
    """What a linkage does itself, and a wave that none does: at the fit no size has a slope left in the true error."""
    wave, turning = 3e-4 * np.sin(9 * S), isinstance(task, FourBarGenerator)
    way_of = task.out if turning else task.sense
    for side, which in itertools.product((1, -1), (0, 3, 6)):
        p = [row for row in some(task) if row[5] == side][which]
        way = np.unwrap(task.error(p[None], S[None])[0] + way_of * share(S)) + wave
        swung = way[-1] - way[0]
        swing = {"out": swung} if turning else {"sense": 1.0}
        own = dataclasses.replace(
            task, starts=(p[3], p[4] + way[0]), **swing,
            share=lambda s, way=way, swung=swung: np.interp(s, S, way - way[0]) / (swung if turning else 1),
        )  # fmt: skip
        near = next(row for row in own.fitted(1, S) if row[5] == side)
        error, slopes = own.error(near[None], S[None])[0], own.slopes(near[None], S[None])[0][:, :3]
        assert 1e-5 < np.abs(error).max() < 1e-3
        step = np.linalg.lstsq(slopes, -error)[0]
        assert np.sum((slopes @ step) ** 2) < 1e-2 * np.sum(error**2)


@tasks
def test_fits_are_tried_from_as_many_starts_as_are_asked_for(task, monkeypatch):
    """Whichever of the starts are free; each is another, and a start that is given stays."""
    module = sys.modules[type(task).__module__]
    plain, seen = module.linear_fits, []
    monkeypatch.setattr(module, "linear_fits", lambda terms, *rest: (seen.append(terms), plain(terms, *rest))[1])
    for starts, tried in (((np.nan, np.nan), 144), ((0.3, np.nan), 144), ((np.nan, 0.3), 144), ((0.3, 0.3), 1)):
        found = dataclasses.replace(task, starts=starts).fitted(144, S)
        half = len(found) // 2
        assert (found[:half, :5] == found[half:, :5]).all()
        assert (found[:half, 5] == 1).all() and (found[half:, 5] == -1).all()
        assert len(np.unique(np.round(seen[-1].reshape(len(seen[-1]), -1), 9), axis=0)) == tried == len(seen.pop())
        for k in (0, 1):
            assert np.isnan(starts[k]) or (found[:, 3 + k] == 0.3).all()


@pytest.mark.parametrize("size", [1, 3, 4])
def test_places_are_spread_evenly(size):
    places = evenly(4096, size)
    assert places.shape == (4096, size) and (places >= 0).all() and (places < 1).all()
    # In any box about as many as its share.
    rng = np.random.default_rng(1)
    for _ in range(50):
        low, high = np.sort(rng.uniform(size=(2, size)), axis=0)
        inside = ((places >= low) & (places < high)).all(axis=1).mean()
        assert inside == pytest.approx(np.prod(high - low), abs=0.01)


@tasks
def test_what_is_rounded_is_told_in_few_digits_and_what_is_given_stays(task):
    p = some(task)
    near = task.rounded(p)
    assert np.abs(task.error(near, S[None]) - task.error(p, S[None])).max() < 1e-8 and (near[:, 5] == p[:, 5]).all()
    assert np.abs(near - p).max() < 1e-7 and (task.rounded(near) == pytest.approx(near, abs=1e-15))
    linkage = task.linkage(p[0])
    assert all(
        len(f"{float(f'{size:.15g}')!r}".strip("0").replace(".", "")) <= 14 for size in (linkage.crank, linkage.coupler)
    )
    degrees = np.degrees(near[:, 3])
    assert np.abs(degrees - np.round(degrees, 10)).max() < 1e-12
    for k in (0, 1):
        given = dataclasses.replace(task, starts=tuple(1 / 3 if j == k else np.nan for j in (0, 1)))
        p[:, 3 + k] = 1 / 3
        held = given.rounded(p)
        assert (held[:, 3 + k] == 1 / 3).all() and (held[:, :3] == near[:, :3]).all()


class Lines:
    """A task whose errors and limits are straight lines of two unknowns."""

    free = np.array([True, True])

    def __init__(self, slopes, bounds):
        self.rows, self.bounds = slopes, bounds

    def slopes(self, p, s):
        return self.rows[None]

    def limits(self, p):
        return np.array([[0.0 if near else -1.0 for _, near in self.bounds]]), np.array(
            [[row for row, _ in self.bounds]]
        )


@pytest.mark.parametrize("seed", range(8))
def test_multipliers_are_those_of_any_peaks_and_limits_that_balance(seed):
    """Of random peaks of one height: none is below nothing, they sum to 1, and what is left is the nearest to nothing."""
    rng = np.random.default_rng(seed)
    errors = np.array([1.0, -1.0, 1.0, -1.0, 0.9])
    slopes = rng.normal(size=(5, 2))
    bounds = [(rng.normal(size=2), True), (rng.normal(size=2), False)]
    found = certified(Lines(slopes, bounds), np.zeros(2), np.linspace(0, 1, 5), errors)
    assert (found.peaks >= 0).all() and (found.limits >= 0).all() and found.peaks[4] == found.limits[1] == 0
    columns = np.vstack([np.sign(errors)[:, None] * slopes, [row for row, _ in bounds]])
    rest = found.peaks @ columns[:5] + found.limits @ columns[5:]
    size = np.linalg.norm(np.append(rest, found.peaks.sum() - 1))
    # Every way to share one among the four highest, and some of the limit: on a grid, nothing comes much nearer.
    shares = np.array([row for row in np.ndindex(13, 13, 13) if sum(row) <= 12]) / 12
    shares = np.column_stack([shares, 1 - shares.sum(axis=1)])
    least = min(np.abs((shares @ columns[:4] + limit * columns[5]) @ [1, 1j]).min() for limit in np.linspace(0, 4, 41))
    assert size <= least + 1e-9
    weight = np.linalg.norm(columns, axis=1) @ np.concatenate([found.peaks, found.limits])
    assert found.left == pytest.approx(size / max(weight, 1), abs=1e-12)


def test_what_brings_rows_back_is_the_shortest_step():
    rng = np.random.default_rng(4)
    paid = np.array([[True, True, False, True, False], [True] * 5])
    held = rng.normal(size=(2, 5, 5)) * paid[..., None]
    back = _least_return(held, paid, 3)
    off = rng.normal(size=(2, 5)) * paid
    for rows, mask, wrong, step in zip(held, paid, off, np.einsum("kij,kj->ki", back, off)):
        # The last two unknowns, of which a hundredth counts, are as good as free.
        scale = np.array([1, 1, 1, 100, 100])
        least = scale * (np.linalg.pinv(rows[mask] * scale) @ wrong[mask])
        assert step == pytest.approx(least[:3], rel=5e-3, abs=1e-4)


def test_rows_that_tell_nothing_bring_nothing_back():
    held, paid = np.random.default_rng(5).normal(size=(2, 5, 5)), np.ones((2, 5), dtype=bool)
    assert np.abs(_least_return(held, paid, 3)).min() > 0
    held[1, 2] = 0
    back = _least_return(held, paid, 3)
    assert back.shape == (2, 3, 5) and (back == 0).all()


def test_newtons_step_ends_where_slopes_balance_on_the_rows_that_hold():
    rng = np.random.default_rng(6)
    half = rng.normal(size=(3, 3, 3))
    curvature, cost = half @ np.swapaxes(half, 1, 2) + np.eye(3), np.array([0, 0, 0, 1.0, 30])
    held, paid = rng.normal(size=(3, 5, 5)), np.array([[True, True, False, True, True]] * 3)
    # The largest error and what is broken: in each row less one of either, as in the programme.
    held[:, :3, 3:], held[:, 3:, 3:] = [-1, 0], [0, -1]
    held[~paid] = 0
    right = 0.01 * rng.normal(size=(3, 5)) * paid
    step = _newton(held, paid, right, curvature, cost)
    assert step.shape == (3, 3) and (np.abs(step) <= 1).all() and (np.abs(step).max(axis=1) < 1).any()
    for k in np.flatnonzero(np.abs(step).max(axis=1) < 1):
        # Along every direction that keeps the rows nothing is gained: with the last two unknowns that the rows tell.
        rows = held[k][paid[k]]
        point, *_ = np.linalg.lstsq(rows[:, 3:], right[k][paid[k]] - rows[:, :3] @ step[k])
        full = np.append(step[k], point)
        assert rows @ full == pytest.approx(right[k][paid[k]], abs=1e-9)
        slope = np.append(curvature[k] @ step[k], 0 * point) + cost
        along = np.linalg.svd(rows)[2][len(rows) :]
        assert along @ slope == pytest.approx(np.zeros(len(along)), abs=1e-9)
