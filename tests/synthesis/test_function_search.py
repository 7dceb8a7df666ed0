"""The search of function generators part by part: the least mean square, what is kept of it, and what is refused."""

import dataclasses
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest

import geomkin as gk
from geomkin.synthesis import chebyshev_points, slider_function_generator
from geomkin.synthesis.function import function as module
from geomkin.synthesis.function import search
from geomkin.synthesis.function.minimax import AbstractTask
from geomkin.synthesis.function.search import Optimum, fit, peaks

WISH = {"function": "log10(x)", "span": (1, 2)}
S = np.linspace(0, 1, 2001)[None]


@pytest.fixture
def quick(monkeypatch):
    """Few candidates, which are enough for an optimum, though not for the best."""
    for name, value in {"FITS": 400, "SPREAD": 1000, "FOLLOWED_FITS": 3, "FOLLOWED_SPREAD": 2}.items():
        monkeypatch.setattr(search, name, value)


@dataclass(frozen=True, eq=False)
class Decay(AbstractTask):
    """A toy: p0 exp(-p1 s) + p2 for 1/(1 + 4 s), the last unknown stays; p0 is `most` at most, and p0 + p2 1.02."""

    most: float = 10.0

    @property
    def free(self):
        return np.array([True, True, True, False])

    def error(self, p, s):
        with np.errstate(invalid="ignore"):
            return p[:, :1] * np.exp(-p[:, 1:2] * s) + p[:, 2:3] - 1 / (1 + 4 * s) + 0 * np.sqrt(p[:, 3:])

    def slopes(self, p, s):
        fall = np.exp(-p[:, 1:2] * s)
        return np.stack([fall, -s * p[:, :1] * fall, np.ones(fall.shape), np.zeros(fall.shape)], axis=2)

    def limits(self, p):
        values = np.stack([p[:, 0] - self.most, p[:, 0] + p[:, 2] - 1.02], axis=1)
        slopes = np.zeros((len(p), 2, 4))
        slopes[:, 0, 0] = slopes[:, 1, 0] = slopes[:, 1, 2] = 1
        return values, slopes


def least_by_grid(most):
    """The toy's least mean square error: for each rate and p0 the best p2, on a grid that narrows."""
    s = (np.arange(2000) + 0.5) / 2000
    wanted = 1 / (1 + 4 * s)
    rate, height, width = 3.0, 0.5, 1.5
    for _ in range(12):
        rates = np.clip(rate + width * np.linspace(-1, 1, 21), 0, None)
        heights = np.minimum(height + width * np.linspace(-1, 1, 21), most)
        fall = heights[None, :, None] * np.exp(-rates[:, None, None] * s)
        rest = np.minimum((wanted - fall).mean(axis=2), 1.02 - heights)
        mean = ((fall + rest[..., None] - wanted) ** 2).mean(axis=2)
        i, j = np.unravel_index(np.argmin(mean), mean.shape)
        rate, height, width = rates[i], heights[j], width / 3
    return np.array([height, rate, rest[i, j]]), np.sqrt(mean[i, j])


@pytest.mark.parametrize("exact", [False, True])
@pytest.mark.parametrize("most", [10.0, 0.6])
def test_the_least_mean_square_is_that_of_a_grid(exact, most):
    wanted, root = least_by_grid(most)
    starts = np.array([[0.5, 1.0, 0.3, 7.0], [2.0, 5.0, -1.0, 7.0], [0.1, 0.5, 0.0, 7.0], [0.5, 3.0, 0.2, -1.0]])
    task = Decay(most)
    p, found, step = fit(task, starts, exact)
    assert p[:3, :3] == pytest.approx(np.tile(wanted, (3, 1)), abs=2e-5) and (p[:3, 3] == 7).all()
    assert found[:3] == pytest.approx(root, rel=1e-5) and found[3] == np.inf
    assert (task.limits(p[:3])[0] < 1e-8).all() and (step[:3] < 1e-6).all()
    assert (starts[0] == [0.5, 1.0, 0.3, 7.0]).all()
    # A limit is stood upon: without it there would be less.
    assert (most == 10) == (wanted[0] < most - 1e-3)


def test_on_its_way_it_tells_how_far_it_last_stepped(monkeypatch):
    monkeypatch.setattr("geomkin.synthesis.function.search.MEAN_SQUARE_ROUNDS", 1)
    monkeypatch.setattr("geomkin.synthesis.function.search.MEAN_SQUARE_STEPS", 1)
    far = np.array([[0.5, 1.0, 0.3, 7.0], [0.5, 9.0, 8.0, 7.0]])
    p, _, step = fit(Decay(), far, False)
    # No unknown goes farther than half of one at a time.
    assert np.abs(p - far).max() == 0.5 and step[1] > 0.5 and step[0] > 1e-3
    # A step that makes nothing better is not taken.
    before, after = (np.mean(Decay().error(q, S) ** 2, axis=1) for q in (far, p))
    assert after[1] < before[1] and after[0] <= before[0]


@pytest.mark.parametrize(("call", "way"), [(gk.function_generator, 90), (slider_function_generator, 50)])
def test_least_squares_is_a_least_and_its_others_come_by_it(call, way, quick):
    found = call("sin(x)", (0, np.pi / 2), 90, way, method="least-squares")
    assert np.isnan(found.certificate) and not found.active_limits
    assert all(np.isnan(peak.multiplier) for peak in found.alternation)
    told = found.proof()
    assert told["active_limits"] == {} and [peak["multiplier"] for peak in told["alternation"]].count(None) > 2
    x, means = np.linspace(0, np.pi / 2, 2001), []
    for one in (found, *found.others):
        means.append(np.mean(one.error(x) ** 2))
        task, p = one.task, one.unknowns
        here, limits = np.mean(task.error(p[None], S) ** 2), task.limits(p[None])[0][0]
        assert limits.max() < 1e-7
        # No small change of the sizes makes the mean less within the limits.
        for step in 1e-3 * np.vstack([np.eye(6)[:5], -np.eye(6)[:5]]):
            beyond = np.maximum(task.limits((p + step)[None])[0][0], 0).max()
            assert np.mean(task.error((p + step)[None], S) ** 2) + beyond > here
    assert means == sorted(means) and len(means) > 1
    assert means[0] < np.mean(call("sin(x)", (0, np.pi / 2), 90, way).error(x) ** 2)


def test_of_fits_the_resting_are_kept_by_their_mean(monkeypatch):
    task = SimpleNamespace(limits=lambda q: (q[:, [2, 1]] - 1, None), angles=[3, 4])
    p = np.zeros((6, 6))
    p[:, 2] = [0, 0.1, 0.2, 0.3, 5.0, 0.1 + 1e-5]
    value = np.array([3.0, 1.0, 2.0, 4.0, 0.5, 1.1])
    seen = []

    def given(task, q, exact):
        seen.append((exact, len(q)))
        # The best is on its way yet, and so is the next; the fifth breaks a limit.
        at = [int(np.argmin(np.abs(p[:, 2] - one))) for one in q[:, 2]]
        step = np.array([0.0, 1.0, 1e-3, 1e-5, 0.0, 0.0])
        return q, value[at], step[at]

    monkeypatch.setattr(search, "fit", given)
    kept = search._fitted(task, p)
    assert seen == [(False, 6), (True, 5)]
    assert kept[:, 2].tolist() == [0.1, 0.0, 0.3, 5.0]


def test_a_least_angle_in_the_way_is_told_with_one_that_works(quick):
    asked = WISH | {"method": "points", "points": 4, "input_start_deg": 100}
    with pytest.raises(gk.DesignError, match="found 30") as refusal:
        gk.function_generator(**asked)
    assert refusal.value.field == "least_transmission_angle_deg"
    most = float(refusal.value.remedy.split("give at most ")[1].split(",")[0])
    found = gk.function_generator(**asked, least_transmission_angle_deg=most)
    assert 5 < most <= found.transmission_angle_deg < most + 0.1
    assert np.abs(found.error(chebyshev_points((1, 2), 4))).max() < 1e-6
    with pytest.raises(gk.DesignError, match="give at most"):
        gk.function_generator(**asked, least_transmission_angle_deg=most + 0.5)


def test_points_that_no_linkage_meets_are_told(quick, monkeypatch):
    """At the start crank and rocker lie along the ground: errors there are steep without end."""
    monkeypatch.setattr(search, "ROUNDS", 1)
    asked = {"method": "points", "input_start_deg": 0, "output_start_deg": 0, "largest_ratio": 1.1}
    with pytest.raises(gk.DesignError, match="points: no linkage was found that meets these 3 within the limits"):
        gk.function_generator(**WISH, **asked)


def test_which_limit_is_in_the_way(monkeypatch, quick):
    """Of what the search may come to: nothing, what keeps a lower angle, what misses the points, what meets them."""
    good = gk.function_generator("x**1.5", (1, 3), 90, 90, method="points", points=3)
    s, calls = np.zeros(1), []

    def one(p, broken):
        return Optimum(np.asarray(p, dtype=float), 0.1, s, s, broken)

    def comes_to(first, looser=()):
        def searched(task, squares):
            calls.append((np.degrees(task.least_transmission), squares))
            return looser if len(calls) % 2 == 0 else first

        monkeypatch.setattr(module, "searched", searched)

    def refusal(**asked):
        calls.clear()
        with pytest.raises(gk.DesignError) as refused:
            gk.function_generator("x**1.5", (1, 3), 90, 90, **asked)
        return refused.value

    comes_to(())
    assert refusal().field == "input_start_deg" and calls == [pytest.approx((30, False))]
    comes_to((one(good.unknowns, 1e-6),))
    told = refusal(method="least-squares", largest_ratio=7)
    assert told.field == "largest_ratio" and "found 7," in str(told)
    assert calls == [pytest.approx((30, True)), pytest.approx((5, True))]
    # What meets the points has another limit in its way; what misses them has not.
    assert refusal(method="points").field == "largest_ratio"
    assert refusal(method="points", points=[1.1, 2, 2.8]).field == "points"
    # Of those that keep the lower angle the one with the greatest tells which, rounded down.
    parallel = [0, 0, 0, np.radians(45), 0, -1]
    unlike = [0, 0, 0, np.radians(20), 0, -1]
    comes_to((one(good.unknowns, 1),), (one(unlike, 0), one(parallel, 0), one(good.unknowns, 1e-3)))
    told = refusal()
    least, most = (np.degrees(good.task.transmission(np.array([p]))[0]) for p in (unlike, parallel))
    advised = float(told.remedy.split("give at most ")[1].split(",")[0])
    assert told.field == "least_transmission_angle_deg" and "found 30," in str(told)
    assert least < advised <= most < advised + 0.1 and most < good.transmission_angle_deg
    # One that keeps all limits and does not close is no answer.
    comes_to((Optimum(good.unknowns, np.nan, s, s, -1.0),))
    assert refusal().field == "largest_ratio"


def test_many_precision_points_are_refused():
    assert len(chebyshev_points((0, 1), 100)) == 100
    with pytest.raises(gk.DesignError, match="count: found 101; give at most 100"):
        chebyshev_points((0, 1), 101)


def test_the_output_may_go_as_far_as_a_refusal_says():
    wanted = module.wanted_function("sin(x)", (0, 3))
    with pytest.raises(gk.DesignError, match="output_deg: found -90, with which the output would go 637.7") as refusal:
        module._check_output_range(wanted, -90)
    most = float(refusal.value.remedy.split("give at most ")[1].split(" ")[0])
    # From nought to 1 and back to sin 3.
    assert most == pytest.approx(359 * np.sin(3), rel=1e-4)
    for sign in (1, -1):
        module._check_output_range(wanted, sign * most)
        with pytest.raises(gk.DesignError, match="output_deg"):
            module._check_output_range(wanted, sign * 1.001 * most)


@pytest.mark.parametrize(
    ("call", "starts"), [(gk.function_generator, (277.7, 340.3)), (slider_function_generator, (339.7, 61.7))]
)
def test_starts_that_are_given_are_told_as_they_were_given(call, starts, monkeypatch):
    # What is found need not be the best.
    for name in ("FOLLOWED_FITS", "FOLLOWED_SPREAD", "ROUNDS", "STEPS"):
        monkeypatch.setattr(search, name, 1)
    monkeypatch.setattr(search, "FITS", 100)
    monkeypatch.setattr(search, "SPREAD", 1000)
    for given in ((starts[0], None), (None, starts[1])):
        kept = {
            "input_start_deg": given[0],
            ("output_start_deg" if call is gk.function_generator else "output_start_mm"): given[1],
        }
        found = call("log10(x)", (1, 2), **kept, method="points")
        told = found.starts_deg if call is gk.function_generator else (found.start_deg, found.start_mm)
        assert [one for one, asked in zip(told, given) if asked is not None] == [
            one for one in given if one is not None
        ]
        assert (given[0] or abs(told[0]) <= 180) and found.drive[0] == pytest.approx(np.radians(told[0]))
        # There the linkage stands at the start of the function, but for its error.
        motion = gk.move(found.linkage, found.drive[:1], found.branch)
        if call is gk.function_generator:
            out = np.degrees(np.angle(motion.rocker.direction[0])) - told[1]
            assert abs((out + 180) % 360 - 180) == pytest.approx(abs(found.error(1.0)), abs=1e-9)
        else:
            assert motion.slider.origin.position.real[0] - told[1] == pytest.approx(found.error(1.0), abs=1e-9)


@pytest.mark.parametrize(
    "points", [6, 2, True, [1, 1.5], [1, 1.2, 1.4, 1.6, 1.8, 2], "abc", None, [[1, 1.5, 2]], [1, np.nan, 2], [1j, 2, 3]]
)
def test_what_are_no_precision_points_is_refused(points):
    with pytest.raises(gk.DesignError, match="points: found .*; give 3, 4 or 5, or a row of so many places x"):
        gk.function_generator(**WISH, method="points", points=points)


@pytest.mark.parametrize(
    ("call", "function", "way"), [(gk.function_generator, "exp(x)", 90), (slider_function_generator, "x**3", -20)]
)
def test_multipliers_of_limits_are_how_fast_the_error_falls_with_them(call, function, way, monkeypatch):
    for name, value in {"FITS": 400, "SPREAD": 1000, "FOLLOWED_FITS": 1, "FOLLOWED_SPREAD": 1}.items():
        monkeypatch.setattr(search, name, value)
    found = call(function, (0, 1), 60, way, largest_ratio=3.0, least_transmission_angle_deg=40.0)
    assert found.active_limits and found.certificate < 1e-6
    unit, step = found.largest / np.abs(found.task.error(found.unknowns[None], S)).max(), 1e-4
    # An optimum nearby, where the limit is a little wider.
    monkeypatch.setattr(search, "ROUNDS", 3)
    for name in ("transmission angle", "ratio"):
        if name == "ratio":
            task = dataclasses.replace(found.task, largest_ratio=3.0 * np.exp(step))
        else:
            task = dataclasses.replace(found.task, least_transmission=np.arccos(np.cos(np.radians(40)) + step))
        p = search._finished(task, found.unknowns[None].copy())
        _, errors, _ = peaks(task, p, search.PEAKS, search.LOOKS)
        falls = (found.largest - unit * np.abs(errors).max()) / step
        assert falls == pytest.approx(found.active_limits.get(name, 0.0), rel=2e-2, abs=2e-3 * found.largest)


def test_those_that_are_distinct_are_the_best_of_their_likes_whole_turns_apart_or_not():
    rng, task = np.random.default_rng(3), SimpleNamespace(angles=[3, 4])
    p = rng.uniform(-1, 1, (60, 6))
    p[30:] = p[:30] + rng.uniform(-0.05, 0.05, (30, 6))
    p[30:, 3:5] += 2 * np.pi * rng.integers(-2, 3, (30, 2))
    p[45:, 2] += 2 * np.pi
    value = rng.permutation(60).astype(float)
    value[[3, 40]], p[3], p[40] = [np.inf, np.nan], 50.0, -50.0
    kept = []
    for k in np.argsort(value):
        gap = np.abs(p[kept] - p[k])
        gap[:, 3:5] = np.abs(np.angle(np.exp(1j * gap[:, 3:5])))
        if np.isfinite(value[k]) and (gap.max(axis=1, initial=0) > 0.3).all():
            kept.append(int(k))
    assert 25 < len(kept) < 50 and search._distinct(task, p, value, 60, 0.3) == kept
    assert search._distinct(task, p, value, 7, 0.3) == kept[:7]


@dataclass(frozen=True)
class Made:
    """What is made of an optimum."""

    worst: float
    others: tuple = ()


def test_others_whose_links_are_too_long_are_left_out(monkeypatch):
    optima = [Optimum(np.zeros(6), worst, np.zeros(1), np.zeros(1), -1.0) for worst in (0.1, 0.2, 0.3, 0.4)]
    monkeypatch.setattr(module, "searched", lambda task, squares: tuple(optima))

    def made(optimum):
        if optimum.worst == 0.3:
            raise gk.DesignError("ground", "found 9e+08 mm", "give less")
        return Made(optimum.worst)

    assert module._best(SimpleNamespace(), "minimax", made) == Made(0.1, (Made(0.2), Made(0.4)))
    # The best itself is told as it is.
    del optima[:2]
    with pytest.raises(gk.DesignError, match="ground: found 9e"):
        module._best(SimpleNamespace(), "minimax", made)
