"""The search of function generators part by part: the least mean square, what is kept of it, and what is refused."""

from dataclasses import dataclass

import numpy as np
import pytest

import geomkin as gk
from geomkin.synthesis import chebyshev_points, slider_function_generator
from geomkin.synthesis.function import search
from geomkin.synthesis.function.minimax import AbstractTask
from geomkin.synthesis.function.search import fitted_candidates

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


@pytest.mark.parametrize("exact", [True])
@pytest.mark.parametrize("most", [10.0, 0.6])
def test_the_least_mean_square_is_that_of_a_grid(exact, most):
    wanted, root = least_by_grid(most)
    starts = np.array([[0.5, 1.0, 0.3, 7.0], [2.0, 5.0, -1.0, 7.0], [0.1, 0.5, 0.0, 7.0], [0.5, 3.0, 0.2, -1.0]])
    task = Decay(most)
    p, found, step = fitted_candidates(task, starts, exact)
    assert p[:3, :3] == pytest.approx(np.tile(wanted, (3, 1)), abs=2e-5) and (p[:3, 3] == 7).all()
    assert found[:3] == pytest.approx(root, rel=1e-5) and found[3] == np.inf
    assert (task.limits(p[:3])[0] < 1e-8).all() and (step[:3] < 1e-6).all()
    assert (starts[0] == [0.5, 1.0, 0.3, 7.0]).all()
    # A limit is stood upon: without it there would be less.
    assert (most == 10) == (wanted[0] < most - 1e-3)


@pytest.mark.campaign
@pytest.mark.parametrize(("call", "way"), [(slider_function_generator, 50)])
def test_least_squares_is_a_least_and_its_others_come_by_it(call, way, quick):
    found = call("sin(x)", (0, np.pi / 2), 90, way, method="least-squares")
    assert np.isnan(found.certificate) and not found.active_limits
    assert all(np.isnan(peak.multiplier) for peak in found.alternation)
    reported = found.proof()
    assert reported["active_limits"] == {} and [peak["multiplier"] for peak in reported["alternation"]].count(None) > 2
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


@pytest.mark.campaign
def test_least_angle_out_of_reach_is_refused_with_one_that_works(quick):
    asked = WISH | {"method": "points", "points": 4, "input_start_deg": 100}
    with pytest.raises(gk.DesignError) as refusal:
        gk.function_generator(**asked)
    assert refusal.value.field == "least_transmission_angle_deg"
    most = float(refusal.value.remedy.split("give at most ")[1].split(",")[0])
    found = gk.function_generator(**asked, least_transmission_angle_deg=most)
    assert 5 < most <= found.transmission_angle_deg < most + 0.1
    assert np.abs(found.error(chebyshev_points((1, 2), 4))).max() < 1e-6


@pytest.mark.parametrize("points", [6, [1, 1.5], "abc", None, [1, np.nan, 2]])
def test_what_are_no_precision_points_is_refused(points):
    with pytest.raises(gk.DesignError):
        gk.function_generator(**WISH, method="points", points=points)
