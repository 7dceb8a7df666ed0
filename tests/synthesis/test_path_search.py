"""The search for linkages of paths part by part: many points, nine of them, defects, refusals, what it starts from."""

import dataclasses
from itertools import permutations, product

import numpy as np
import pytest

import geomkin as gk
from geomkin.linkage.coupler_curve import cognates
from geomkin.synthesis.path import search
from geomkin.synthesis.path.fits import Fit, Linearised, PathTask, least_squares
from geomkin.synthesis.path.nine_points import PathCount
from geomkin.synthesis.path.path import _turns
from geomkin.synthesis.path.search import crank_motion
from geomkin.synthesis.path.starts import loop, short_tour
from tests.synthesis.test_nine_points import KNOWN, POINTS, SEEN, SIZE, THREE

SLIDER = gk.SliderCrank(30, 90, 12, 50 + 20j, origin=5 + 5j, ground_angle_deg=-20)


def traced(linkage, drive, branch=1):
    return gk.move(linkage, drive, branch).point("coupler_point").position


def in_units(linkage, points, start=0.0):
    """A linkage as the search has it: (10,) about the points' middle, in units of their size."""
    slides = isinstance(linkage, gk.SliderCrank)
    middle = points.mean()
    size = np.sqrt(np.mean(np.abs(points - middle) ** 2))
    ends = (linkage.offset, size) if slides else (linkage.ground, linkage.rocker)
    place, arm = linkage.origin - middle, linkage.coupler_point
    lengths = [ends[0], linkage.crank, linkage.coupler, ends[1], arm.real, arm.imag, place.real, place.imag]
    return np.array([*(np.array(lengths) / size), np.radians(linkage.ground_angle_deg), start])


def is_least(found, points, timed):
    """No size and no crank is off its best by a thousandth of its step: sums of squares to either side of each."""

    def total(linkage, drive):
        return np.sum(np.abs(traced(linkage, drive, found.branch) - points) ** 2)

    bar, here = found.linkage, total(found.linkage, found.drive)
    names = ["crank", "coupler", *(["offset"] if isinstance(bar, gk.SliderCrank) else ["ground", "rocker"])]
    steps = [(name, 0.05) for name in (*names, "ground_angle_deg")]
    steps += [(name, step) for name in ("coupler_point", "origin") for step in (0.05, 0.05j)]
    sides = [
        [total(dataclasses.replace(bar, **{name: getattr(bar, name) + sign * step}), found.drive) for sign in (1, -1)]
        for name, step in steps
    ]
    if timed:
        sides.append([total(bar, found.drive + sign * 1e-3) for sign in (1, -1)])
    else:
        at = 1e-3 * np.eye(len(points))[[0, 7, -1]]
        sides += [[total(bar, found.drive + sign * one) for sign in (1, -1)] for one in at]
    return all(abs(up - down) < 1e-2 * (up + down - 2 * here) for up, down in sides)


@pytest.mark.parametrize(("known", "asked"), [(KNOWN, "open"), (SLIDER, "closed"), (SLIDER, "timed")])
def test_all_of_many_points_count_though_few_are_searched_with(known, asked, monkeypatch):
    """From starts nearby, which is what random ones would come to as well."""
    timed, rng = asked == "timed", np.random.default_rng(5)
    drive = 0.2 + np.linspace(0, 2 * np.pi if asked == "closed" else 4.3, 40, endpoint=asked != "closed")
    points = traced(known, drive) + 0.2 * (rng.normal(size=40) + 1j * rng.normal(size=40))
    starts = in_units(known, points, 0.2 * timed) * (1 + 0.01 * rng.normal(size=(4, 10)))
    seen = []

    def given(task, rng, watch):
        seen.append(task.wanted)
        few = np.interp(np.linspace(0, 39, 12), np.arange(40), drive)
        return (starts, np.ones(4)) if timed else (starts, np.tile(few, (4, 1)), np.ones(4))

    monkeypatch.setattr(search, "SEARCH_POINTS", 12)
    monkeypatch.setattr(search, "timed_starts" if timed else "free_starts", given)
    asked = {"timed": {"drive_deg": np.degrees(drive)}, "open": {}, "closed": {"closed": True}}[asked]
    found = gk.path_generator(points, slides=known is SLIDER, time_limit=60, **asked)
    wanted = (points - points.mean()) / np.sqrt(np.mean(np.abs(points - points.mean()) ** 2))
    assert len(seen[0]) == 12 and seen[0][[0, -1]] == pytest.approx(wanted[[0, -1]])
    assert np.isin(np.round(seen[0], 9), np.round(wanted, 9)).all()
    moved = traced(found.linkage, found.drive, found.branch)
    assert found.least_squares and not found.defects and not found.cut_short and not found.at_limits
    assert np.sum(np.abs(moved - points) ** 2) == pytest.approx(found.square_error, rel=1e-9)
    assert found.largest_distance == pytest.approx(np.abs(moved - points).max()) and found.largest_distance < 0.8
    assert found.square_error < np.sum(np.abs(traced(known, drive) - points) ** 2)
    assert is_least(found, points, timed) and "at_limits" not in found.summary()
    stands = dataclasses.replace(found, at_limits=("a ratio of links of 3",)).summary()
    assert stands["at_limits"] == ["a ratio of links of 3"]


@pytest.fixture
def nothing_else(monkeypatch):
    """A search that finds nothing from random starts; how often it was asked."""
    asked = []

    def searched(self, rng, watch):
        asked.append(len(self.task.wanted))
        return np.zeros((0, 10)), np.zeros((0, len(self.task.wanted))), np.zeros(0)

    monkeypatch.setattr(search.PathSearch, "searched", searched)
    return asked


def through(monkeypatch, rows):
    """Rows from the first of the points as all linkages through nine of them."""
    first, count = [POINTS[0].real, POINTS[0].imag], PathCount(len(rows), 0, 0, 0)
    monkeypatch.setattr(search, "through_nine", lambda wanted, watch: (np.asarray(rows) + np.tile(first, 4), count))


def test_the_best_of_three_cognates_through_nine_points_is_ranked(monkeypatch, nothing_else):
    bars = [one.linkage for one in cognates(KNOWN)]
    least = [np.degrees(gk.least_transmission_angle(gk.move(bar, np.linspace(0, 7, 2000)))) for bar in bars[:1]]
    # Whichever of the three is found; one that only comes near is not listed.
    for row in THREE:
        through(monkeypatch, [THREE[0] + 1e-3, row])
        found = gk.path_generator(SEEN)
        assert nothing_else == [] and not found.defects and found.square_error < 1e-16 * SIZE**2
        assert np.abs(traced(found.linkage, found.drive, found.branch) - SEEN).max() < 1e-7
        assert len(found.ranked) == 1 and found.path_count.is_complete and not found.special
        assert any(abs(found.linkage.crank - bar.crank) < 1e-6 for bar in bars)
        assert found.transmission_angle_deg >= least[0] - 1e-6


def test_a_coupler_point_at_a_pin_has_no_cognates(monkeypatch, nothing_else):
    through(monkeypatch, THREE[:1])
    found = gk.path_generator(SEEN)
    assert len(found.cognates) == 3
    for point in (0, found.linkage.coupler):
        assert (
            dataclasses.replace(found, linkage=dataclasses.replace(found.linkage, coupler_point=point)).cognates == ()
        )


def test_defects_of_a_way():
    free = PathTask(POINTS[:4], None, False, False, 0.0, np.inf, np.zeros(10), np.zeros(10))
    sizes = in_units(KNOWN, SEEN)
    one, other = np.full(4, 1), np.array([1, 1, -1, 1])

    def way(cranks, branch=one, x=sizes, task=free):
        return crank_motion(task, x, np.array(cranks), branch)

    forward, back = way([0.2, 1.0, 2.0, 2.0 - 4 * np.pi]), way([6.0, 5.0, 4.0, 1.0])
    assert forward.defects == back.defects == ()
    assert forward.drive == pytest.approx([0.2, 1.0, 2.0, 2.0]) and back.drive == pytest.approx([6.0, 5.0, 4.0, 1.0])
    for found in (forward, back):
        motion = gk.move(KNOWN, np.linspace(found.drive[0], found.drive[-1], 5001))
        assert found.transmission == pytest.approx(gk.least_transmission_angle(motion), abs=1e-6)
    # A crank-rocker cannot change its branch; a double rocker can, at its dead places.
    assert way([0.2, 1.0, 2.0, 3.0], other).defects == ("circuit", "branch")
    rocking = in_units(gk.FourBar(90, 80, 40, 60, 40 + 45j), SEEN)
    assert way([0.5, 0.6, 0.7, 0.8], other, rocking).defects == ("branch",)
    assert np.isnan(way([0.5, 0.6, 0.7, 0.8], other, rocking).transmission)
    assert way([0.2, 2.0, 1.0, 3.0]).defects == ("order",)
    # Two circuits of one branch: a double rocker whose crank swings to either side of the ground line.
    apart = in_units(gk.FourBar(60, 90, 30, 70, 40 + 45j), SEEN)
    swings = np.linspace(-np.pi, np.pi, 721)
    closes = np.isfinite(gk.move(gk.FourBar(60, 90, 30, 70, 40 + 45j), swings).coupler.direction)
    up, down = swings[closes & (swings > 0.1)], swings[closes & (swings < -0.1)]
    assert way([up[3], up[20], up[20], up[9]], one, apart).defects == ("order",)
    assert "circuit" in way([up[3], up[9], down[-9], down[-3]], one, apart).defects
    # Of a closed path there is no order, of a timed one the angles are as they were given.
    closed = dataclasses.replace(free, closed=True)
    assert way([0.2, 2.0, 1.0, 3.0 + 2 * np.pi], task=closed).drive == pytest.approx([0.2, 2.0, 1.0, 3.0])
    assert way([0.2, 2.0, 1.0, 3.0], task=closed).defects == ()
    timed = dataclasses.replace(free, turns=np.array([0, 1, 2, 9.0]))
    assert way([0.2, 1.2, 2.2, 9.2], task=timed).drive.tolist() == [0.2, 1.2, 2.2, 9.2]


def test_circuits_of_a_way_are_those_of_the_motion():
    """Poses of random linkages, as the general rule tells them apart."""
    free = PathTask(POINTS[:2], None, False, False, 0.0, np.inf, np.zeros(10), np.zeros(10))
    rng, seen = np.random.default_rng(9), set()
    for _ in range(40):
        bar = gk.FourBar(*np.exp(rng.uniform(-0.5, 0.5, 4)), 0.5 + 0.3j)
        drive = rng.uniform(0, 2 * np.pi, 200)
        motions = [gk.move(bar, drive, side) for side in (1, -1)]
        circuits = [gk.linkage.circuits(bar, motion).tolist() for motion in motions]
        closed = np.flatnonzero(motions[0].assembled)
        for i, j, side in zip(closed[:-1:12], closed[1::12], rng.integers(0, 2, 50).tolist()):
            of = circuits[0][i], circuits[side][j]
            branch = np.array([1, -1 if side else 1])
            found = crank_motion(free, in_units(bar, np.array([-1, 1])), drive[[i, j]], branch).defects
            assert ("circuit" in found) == (of[0] != of[1])
            assert ("branch" in found) == side
            seen.add((of[0] != of[1], side, bool(motions[0].assembled.all())))
    assert len(seen) >= 6


def test_points_of_a_closed_curve_in_any_order_are_toured():
    rng = np.random.default_rng(6)
    for n in (4, 6, 7, 7, 7):
        points = rng.normal(size=n) + 1j * rng.normal(size=n)
        length = {order: np.abs(np.diff(points[[0, *order, 0]])).sum() for order in permutations(range(1, n))}
        order = short_tour(points)
        assert sorted(order.tolist()) == list(range(n))
        least, found = min(length.values()), np.abs(np.diff(points[np.append(order, order[0])])).sum()
        given = np.abs(np.diff(np.append(points, points[0]))).sum()
        # Without crossings, if it is not as given, which has to be nearly as short.
        assert found <= 1.15 * least or ((order == np.arange(n)).all() and given <= 1.5 * least)
    # Round a circle it is the circle, from wherever; an eight that is given in order stays.
    turn = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    order = short_tour(np.exp(1j * turn[rng.permutation(40)]))
    assert len(set(order.tolist())) == 40
    mixed = np.exp(1j * turn)[rng.permutation(40)]
    assert np.abs(np.diff(mixed[short_tour(mixed)])) == pytest.approx(np.abs(np.exp(1j * turn[1]) - 1))
    eight = np.sin(turn) + 0.5j * np.sin(2 * turn)
    assert short_tour(eight).tolist() == list(range(40))
    line = loop(mixed)
    assert line[0] == line[-1] and np.abs(np.abs(line) - 1).max() < 1e-3 and len(line) == 8 * 40 + 1
    assert np.abs(np.diff(line)).max() < 0.03


@pytest.mark.parametrize("asked", ["free", "timed", "closed"])
@pytest.mark.parametrize("known", [KNOWN, SLIDER])
def test_what_passes_limits_counts_and_falls_as_its_derivatives_say(known, asked):
    """All limits are passed, multipliers stand in them; central differences of every size and crank."""
    rng, slides = np.random.default_rng(12), known is SLIDER
    wanted, drive = traced(known, np.linspace(0.1, 4, 6)), np.linspace(0.1, 4, 6)
    x = in_units(known, wanted, 0.1) * (1 + 0.02 * rng.normal(size=(3, 10)))
    wanted = (wanted - wanted.mean()) / np.sqrt(np.mean(np.abs(wanted - wanted.mean()) ** 2))
    task = PathTask(
        wanted, drive - 0.1 if asked == "timed" else None, asked == "closed", slides, np.radians(85), 1.01,
        np.full(10, -9.0), np.full(10, 9.0),
    )  # fmt: skip
    fit, which = Fit(task, np.array([1.0, 1.0, 1.0])), np.array([2, 0, 1])
    x, t = x if asked == "timed" else x[:, :9], drive + 0.05 * rng.normal(size=(3, 6))
    whole = np.hstack([x[:, :9], np.full((3, 1), 0.1) if x.shape[1] == 9 else x[:, 9:]])
    plain = fit.limits(which, whole, task.cranks(whole, t))
    fit.at_points, fit.at_ends, fit.at_links = (
        np.abs(rng.normal(size=v.shape)) for v in (fit.at_points, fit.at_ends, fit.at_links)
    )
    held = fit.limits(which, whole, task.cranks(whole, t))
    for k, by in ((0, fit.at_points), (3, fit.at_ends), (5, fit.at_links)):
        inside = plain[k] != -1
        assert inside.any() and (held[k] - plain[k])[inside] == pytest.approx(by[which][inside])
        assert (held[k] == plain[k])[~inside].all()
    now = fit(which, x, t)
    assert ((now.rest > 0).sum(axis=1) >= 2).all() and (now.blocks[..., 2] > 0).any()
    step = 1e-6
    for k in range(x.shape[1]):
        ahead, behind = (fit(which, x + side * step * np.eye(x.shape[1])[k], t) for side in (1, -1))
        assert now.by_shared[..., k] == pytest.approx((ahead.blocks - behind.blocks) / (2 * step), abs=1e-5, rel=1e-6)
        assert now.rest_by_shared[..., k] == pytest.approx((ahead.rest - behind.rest) / (2 * step), abs=1e-5, rel=1e-6)
    assert (now.by_local is None) is (asked == "timed")
    if now.by_local is not None:
        ahead, behind = (fit(which, x, t + side * step) for side in (1, -1))
        assert now.by_local == pytest.approx((ahead.blocks - behind.blocks) / (2 * step), abs=1e-5, rel=1e-6)


class Straight:
    """Residuals that are linear in shared and local unknowns: what a step or two of least squares settles."""

    def __init__(self, rng, local):
        s, n, k, p, m = 4, 7, 3, 5, 6
        self.by_shared, self.by_local = rng.normal(size=(s, n, k, p)), rng.normal(size=(s, n, k)) if local else None
        self.at, self.rest, self.by_rest = (
            rng.normal(size=(s, n, k)),
            rng.normal(size=(s, m)),
            rng.normal(size=(s, m, p)),
        )

    def __call__(self, which, x, t):
        blocks = self.at[which] + np.einsum("snkp,sp->snk", self.by_shared[which], x)
        local = None if self.by_local is None else self.by_local[which]
        blocks = blocks if local is None else blocks + local * t[..., None]
        rest = self.rest[which] + np.einsum("smp,sp->sm", self.by_rest[which], x)
        return Linearised(blocks, self.by_shared[which], local, rest, self.by_rest[which])

    def settled(self, which, x, t):
        return t

    def least(self, one, low, high):
        """Of one of them, the least over all choices of what stands on which bound."""
        _, n, k, p = self.by_shared.shape
        rows = np.vstack([self.by_shared[one].reshape(n * k, p), self.by_rest[one]])
        if self.by_local is not None:
            own = np.zeros((n * k + len(self.rest[one]), n))
            own[np.arange(n * k), np.repeat(np.arange(n), k)] = self.by_local[one].ravel()
            rows = np.hstack([rows, own])
        right = -np.append(self.at[one], self.rest[one])
        best = np.inf
        for held in product((None, 0, 1), repeat=p):
            free = np.array([end is None for end in held] + [True] * (rows.shape[1] - p))
            x = np.zeros(rows.shape[1])
            x[:p] = [0 if end is None else (low, high)[end] for end in held]
            x[free] = np.linalg.lstsq(rows[:, free], right - rows[:, ~free] @ x[~free])[0]
            if (x[:p] >= low - 1e-12).all() and (x[:p] <= high + 1e-12).all():
                best = min(best, float(np.sum((rows @ x - right) ** 2)))
        return best


@pytest.mark.parametrize("local", [True])
@pytest.mark.parametrize("reach", [100.0, 0.1])
def test_straight_least_squares_are_had_in_few_steps(local, reach):
    task = Straight(np.random.default_rng(10), local)
    start = np.zeros((4, 5)), np.zeros((4, 7))
    x, t, sums = least_squares(task, *start, np.full(5, -reach), np.full(5, reach), 2 if reach > 1 else 4)
    assert (np.abs(x) <= reach).all() and (reach == 100) != (np.abs(x) == reach).any()
    assert sums == pytest.approx([task.least(one, -reach, reach) for one in range(4)], rel=1e-9)
    assert task(np.arange(4), x, t).sums == pytest.approx(sums) and not start[0].any() and not start[1].any()


def test_cranks_may_be_told_in_steps_of_less_than_a_degree_and_in_either_sense():
    for sense in (1, -1):
        told = 200 + sense * np.array([0, 0.5, 0.8, 1.7])
        assert np.degrees(_turns(told, 4)) == pytest.approx(told - 200, abs=1e-12)
        with pytest.raises(gk.DesignError):
            _turns(np.array([0, 0.5, 0.4]) * sense, 3)
