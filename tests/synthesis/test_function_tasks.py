"""The measures that searches for function generators use: errors by the motion, limits by the least angle, slopes
by central differences; and what they start from.
"""

import dataclasses

import numpy as np
import pytest

import geomkin as gk
from geomkin.synthesis.function.generators import FourBarGenerator, SliderGenerator

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


@pytest.mark.parametrize("way", [4.0])
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
        low, high = task.input_range(p[None])
        assert (low[0], high[0]) == pytest.approx((drive.min(), drive.max()))
    assert len(seen) >= 3


@tasks
def test_linkage_is_among_the_fits_of_its_own_function(task):
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
