"""Coupler curves and their dashes against points worked out one by one."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.linkage import coupler_curve
from geomkin.linkage.coupler_curve import coupler_curves, coupler_grid, dashes
from geomkin.linkage.named_linkages import SliderCrank

CRANK_ROCKER = gk.FourBar(100, 30, 90, 70)
STEPS = np.radians(np.arange(0, 361, 5))


def coupler_point(lengths, angle, local):
    """A point of a four-bar's coupler by the cosine rule, branch +1, crank angles in rad; nan where open."""
    ground, crank, coupler, rocker = lengths
    pin = crank * np.exp(1j * angle)
    to_pivot = ground - pin
    far = np.abs(to_pivot)
    cosine = (coupler**2 + far**2 - rocker**2) / (2 * coupler * far)
    with np.errstate(invalid="ignore"):
        return pin + local * to_pivot / far * np.exp(1j * np.arccos(cosine))


def distance(points, polyline):
    """Distance of points from a polyline."""
    a, b = polyline[:-1], polyline[1:]
    share = np.clip(np.real((points[:, None] - a) * np.conj(b - a)) / np.abs(b - a) ** 2, 0, 1)
    return np.abs(points[:, None] - a - share * (b - a)).min(axis=1)


@pytest.mark.parametrize("linkage", [CRANK_ROCKER, SliderCrank(30, 90, 10), gk.FourBar(3, 2, 2.5, 4)])
def test_curves_equal_points_moved_one_by_one(linkage):
    motion = gk.move(linkage, STEPS)
    grid = coupler_grid(80, 60, rows=2, columns=3, centre=20j)
    curves = coupler_curves(motion, grid)
    assert curves.shape == (2, 3, len(STEPS))
    for row, column in np.ndindex(2, 3):
        one = motion.coupler.point(complex(grid[row, column])).position
        assert np.array_equal(np.isnan(one), ~motion.assembled)
        assert np.nanmax(np.abs(curves[row, column] - one)) < 1e-13 * 100


@pytest.mark.parametrize("tolerance", [1.0, 1e-3])
def test_dashes_keep_the_tolerance_and_lie_on_the_curve(tolerance):
    points = [40 + 25j, -30 + 60j, 0j]
    drawn = dashes(CRANK_ROCKER, points, STEPS, tolerance)
    assert [len(runs) for runs in drawn] == [36] * 3
    for local, runs in zip(points, drawn):
        for k, run in enumerate(runs):
            first, last = STEPS[2 * k], STEPS[2 * k + 1]
            curve = coupler_point((100, 30, 90, 70), np.linspace(first, last, 4001), local)
            assert abs(run[0] - curve[0]) < 1e-12 * 100 and abs(run[-1] - curve[-1]) < 1e-12 * 100
            assert distance(curve, run).max() <= tolerance
            assert np.abs(run[:, None] - curve).min(axis=1).max() < np.abs(np.diff(curve)).max()


def test_dashes_end_at_the_limits_of_the_linkage():
    lengths = ground, crank, coupler, rocker = 3, 2, 2.5, 4
    steps = np.radians(np.arange(2, 363, 5))
    # The crank stops where the coupler folds back over the rocker, 26.4 deg, and there the dash from 22 to 27 begins.
    folded = np.arccos((ground**2 + crank**2 - (rocker - coupler) ** 2) / (2 * ground * crank))
    spans = [
        (max(first, folded), min(last, 2 * np.pi - folded))
        for first, last in zip(steps[:-1:2], steps[1::2])
        if last > folded and first < 2 * np.pi - folded
    ]
    assert spans[0][0] == folded and len(spans) == 32
    runs = dashes(gk.FourBar(*lengths), [1 + 1j], steps, 1e-4)[0]
    assert len(runs) == len(spans)
    pin = crank * np.exp(1j * folded)
    # Folded, the coupler points away from the rocker's pivot.
    assert abs(runs[0][0] - (pin - (1 + 1j) * (ground - pin) / abs(ground - pin))) < 1e-6
    for span, run in zip(spans, runs):
        curve = coupler_point(lengths, np.linspace(*span, 4001)[1:-1], 1 + 1j)
        assert distance(curve, run).max() <= 1e-4


def test_a_slider_may_drive():
    linkage = SliderCrank(30, 90, driver="slider")
    drive = np.arange(50.0, 131.0, 5.0)
    runs = dashes(linkage, [45 + 10j], drive, 1e-3)[0]
    x = np.linspace(60, 65, 2001)
    # Crank pin by the cosine rule; left of the line from crank pivot to slider pin.
    pin = 30 * np.exp(1j * np.arccos((30**2 + x**2 - 90**2) / (60 * x)))
    curve = pin + (45 + 10j) * (x - pin) / 90
    nearest = min(runs, key=lambda run: abs(run[0] - curve[0]))
    # The slider starts at its limit, where the curve runs off with infinite speed: rounding counts by its root.
    assert abs(nearest[0] - curve[0]) < 1e-5 and distance(curve, nearest).max() <= 1e-3
    assert len(runs) == 6  # those that begin at 60, 70, ..., 110 mm: before and after the slider is out of reach


@pytest.mark.parametrize(
    ("field", "change"),
    [
        ("tolerance", {"tolerance": 0}),
        pytest.param("tolerance", {"tolerance": 1e-14}, marks=pytest.mark.campaign),
        ("drive", {"drive": [1.0, 0.5]}),
        ("points", {"points": [[0j]]}),
        ("points", {"points": [np.nan]}),
        ("branch", {"branch": "follow"}),
        ("body", {"body": "arm"}),
    ],
)
def test_invalid_arguments_are_refused(field, change):
    asked = {"points": [40 + 25j], "drive": STEPS, "tolerance": 0.01} | change
    with pytest.raises(gk.DesignError) as caught:
        dashes(CRANK_ROCKER, **asked)
    assert caught.value.field == field


def test_dashes_end_closed_at_the_limits_of_any_linkage():
    """Of random bars that do not turn fully, their limits at either end of a dash; at a limit rounding decides."""
    rng, limits = np.random.default_rng(1), 0
    for _ in range(25):
        lengths = rng.uniform(1, 4, 4)
        if 2 * lengths.max() > 0.95 * lengths.sum():
            continue
        linkage = gk.FourBar(*lengths, coupler_point=1j)
        for steps in ((0.0, 7.0), (-7.0, 0.0), (-0.2, 0.1, 0.9, 2.2, 3.5, 7.0)):
            parts = gk.driver_limits(linkage, span=(steps[0], steps[-1]))
            cut = [(max(a, low), min(b, high)) for a, b in zip(steps[::2], steps[1::2]) for low, high in parts]
            cut = [pair for pair in cut if pair[0] < pair[1]]
            (runs,) = dashes(linkage, [1j], steps, 0.01)
            assert len(runs) == len(cut)
            limits += len({q for part in parts for q in part} - {steps[0], steps[-1]})
            for run, pair in zip(runs, cut):
                ends = gk.move(linkage, np.array(pair) * (1 - 1e-12) + 1e-12 * np.mean(pair)).point("coupler_point")
                assert np.abs(run[[0, -1]] - ends.position).max() < 1e-4
    assert limits > 20


def test_suggested_tolerance_works_and_a_smaller_one_is_refused(monkeypatch):
    monkeypatch.setattr(coupler_curve, "MOST_POINTS", 3000)
    asked = CRANK_ROCKER, [40 + 25j, 10j], STEPS[:12]
    with pytest.raises(gk.DesignError) as caught:
        dashes(*asked, 1e-9)
    advised = float(caught.value.remedy.split()[3])
    assert all(len(runs) == 6 for runs in dashes(*asked, advised))
    with pytest.raises(gk.DesignError):
        dashes(*asked, 0.998 * advised)


def test_a_curve_whose_branch_is_followed_is_followed_from_its_start():
    """A parallelogram that starts beyond half a turn on the left branch is a crossed one, and stays so."""
    bars, span = gk.FourBar(100, 40, 100, 40, coupler_point=30 + 10j), (4.0, 4.0 + 2 * np.pi)
    curve = gk.CouplerCurve(bars, "coupler_point", "follow", span)
    drive = np.array([9.0, 4.5, 7.0])
    crossed = gk.move(bars, np.append(4.0, np.sort(drive)), "follow").point("coupler_point")
    for reported, row in ((curve.point(drive), crossed.position), (curve.velocity(drive), crossed.first)):
        assert reported == pytest.approx(row[1:][[2, 0, 1]], abs=1e-9)
    straight = gk.move(bars, np.append(0.0, drive), "follow").point("coupler_point").position[1:]
    assert np.abs(curve.point(drive) - straight).min() > 0.1


@pytest.mark.parametrize("tolerance", [1e-3])
@pytest.mark.parametrize("coupler", [90, 53])
def test_dashes_of_a_path_that_turns_back_reach_its_ends(coupler, tolerance):
    """A slider's pin goes out and back on a line: its dashes must not be cut off between two of their points."""
    linkage = gk.SliderCrank(30, coupler)
    steps = [-1, 1.2, 2, 3.9]
    (runs,) = gk.linkage.dashes(linkage, [coupler], steps, tolerance)
    for run, low, high in zip(runs, steps[::2], steps[1::2]):
        fine = gk.move(linkage, np.linspace(low, high, 20_001)).point("slider_pin").position.real
        assert abs(run.real.max() - fine.max()) <= tolerance and abs(run.real.min() - fine.min()) <= tolerance
