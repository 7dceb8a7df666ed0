"""The program of a structure against the placements themselves: any sizes, branches, timings and blocks of frames."""

import pickle
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

import geomkin as gk
from geomkin.linkage.solve import program
from tests.campaign import by_default
from tests.linkage.examples import ALL, TURN

ITERATED = {"loops", "actuator between moving bars"}


def by_placements(motion):
    return replace(motion, solution=replace(motion.solution, run=None))


def results_of(motion):
    """All that a motion reports, the last quantities first."""
    results = [motion.assembled, motion.transmission_angle]
    for body in motion.bodies.values():
        results += [body.alpha, body.omega, body.direction, body.second, body.first]
        points = body.origin, body.point(3 - 2j), *map(motion.point, motion.linkage.bodies[body.name])
        for point in points:
            results += [point.acceleration, point.position, point.velocity, point.second, point.first]
    return results


def assert_alike(motion):
    for one, other in zip(results_of(motion), results_of(by_placements(motion)), strict=True):
        assert one.shape == other.shape and one.dtype == other.dtype
        # As large as rounding is in the sums that each value is part of.
        np.testing.assert_allclose(one, other, rtol=1e-12, atol=1e-12 * np.nanmax(np.abs(other), initial=1.0))


@pytest.mark.parametrize("name", by_default(ALL, slice(0, None, 2)))
def test_programs_equal_placements(name, monkeypatch):
    monkeypatch.setattr(program, "BLOCK", 7)
    linkage, drive, branch = ALL[name]
    changing = {"speed": np.linspace(1, 3, len(drive)), "acceleration": np.linspace(-1, 2, len(drive))}
    for timing in ({"speed": 3.0}, changing):
        motion = gk.move(linkage, drive, branch, **timing)
        assert (motion.solution.run is None) == (name in ITERATED)
        assert_alike(motion)


@pytest.mark.campaign
def test_sizes_of_one_structure_that_need_other_formulas_are_not_confused():
    """Kites, change points, zero offsets and points on an axis take formulas of their own, in any order."""
    four_bars = [(100, 30, 90, 70), (70, 70, 90, 90), (100, 40, 100, 40), (100.5, 31, 91, 71), (70, 70, 80, 80)]
    linkages = [gk.FourBar(*sizes, coupler_point=z) for z in (40 + 25j, 40, 0, 3j) for sizes in four_bars]
    linkages += [gk.SliderCrank(30, 90, offset) for offset in (0.0, 5.0, 0.0, -4.0)]
    linkages += [
        gk.FourBar(100, 30, 90, 70, origin=z, ground_angle_deg=a) for z, a in ((0, 0), (2j, 0), (0, 90), (1, 30))
    ]
    order = np.random.default_rng(2).permutation(len(linkages))
    for k in (*order, *order[::-1]):
        assert_alike(gk.move(linkages[k], TURN, (-1) ** int(k), speed=2.0))


def test_arrays_of_sizes_equal_single_linkages(monkeypatch):
    """Among them one whose offset is zero and one that cannot be assembled; in blocks, too."""
    monkeypatch.setattr(program, "BLOCK", 1000)
    rng = np.random.default_rng(4)
    sizes = [v + 5 * rng.random(6) for v in (100.0, 30.0, 90.0, 70.0)]
    sizes[2][3] = 30.0
    points = 20 + 9j * np.array([0, 0.3, 1, 0.7, 0, -2])
    many = gk.move(gk.FourBar(*sizes, coupler_point=points), np.tile(TURN, 20), speed=2.0)
    assert_alike(many)
    for k in range(6):
        if k != 3:
            alone = gk.move(gk.FourBar(*(v[k] for v in sizes), coupler_point=points[k]), TURN, speed=2.0)
            other, one = (m.point("coupler_point").acceleration for m in (many, alone))
            np.testing.assert_allclose(other[: len(TURN), k], one, rtol=1e-12, atol=1e-10)
    assert not many.assembled[:, 3].all() and many.assembled[:, 0].all()


@pytest.mark.campaign
def test_requests_in_any_order_from_threads_give_the_same_results(monkeypatch):
    monkeypatch.setattr(program, "BLOCK", 4000)
    requests = [
        lambda m: m.rocker.alpha,
        lambda m: m.point("coupler_point").velocity,
        lambda m: m.coupler.direction,
        lambda m: m.transmission_angle,
        lambda m: m.coupler.point(3j).acceleration,
        lambda m: m.assembled,
    ]
    linkages = [gk.FourBar(100 + k, 30, 90, 70, 40 + 25j) for k in range(5)]
    drives = [np.linspace(0, 6, frames) for frames in (5, 90, 9000)]
    expected = [
        [[request(by_placements(gk.move(linkage, drive))) for request in requests] for drive in drives]
        for linkage in linkages
    ]

    def compare(seed):
        rng = np.random.default_rng(seed)
        for _ in range(60):
            k, d = rng.integers(5), rng.integers(3)
            motion = gk.move(linkages[k] if rng.random() < 0.5 else replace(linkages[k]), drives[d])
            for r in rng.permutation(len(requests))[: rng.integers(1, 6)]:
                wanted = expected[k][d][r]
                np.testing.assert_allclose(requests[r](motion), wanted, rtol=1e-12, atol=1e-12 * np.abs(wanted).max())
        return True

    with ThreadPoolExecutor(3) as threads:
        assert all(threads.map(compare, range(4)))


def test_results_do_not_change_with_the_number_of_frames():
    drive = np.linspace(0, 20, 40_001)
    linkage = ALL["walking leg"][0]
    whole, part = (gk.move(linkage, q, {"B": -1, "G": -1}, speed=2.0) for q in (drive, drive[39_000:]))
    for one, other in zip(results_of(whole), results_of(part)):
        np.testing.assert_allclose(one[39_000:], other, rtol=1e-12, atol=1e-12 * np.nanmax(np.abs(other)))


def test_a_motion_can_be_pickled():
    motion = gk.move(gk.FourBar(100, 30, 90, 70, 40 + 25j), TURN)
    assert motion.assembled.all()
    copy = pickle.loads(pickle.dumps(motion))
    assert np.array_equal(copy.rocker.alpha, motion.rocker.alpha)
    assert np.array_equal(copy.point("coupler_point").acceleration, motion.point("coupler_point").acceleration)


@pytest.mark.campaign
def test_caches_are_bounded():
    """Requests in ever other orders, and sizes under ever other conditions, keep a limited number of functions."""
    rng = np.random.default_rng(1)
    asked = [f"{body} {what}" for body in ("crank", "coupler", "rocker") for what in ("omega", "alpha", "direction")]
    linkage = gk.WattSixBar(gk.FourBar(100, 30, 90, 70, 40 + 25j), 40 + 10j, 80, 60, 160 + 10j)
    for _ in range(3 * program.FUNCTIONS):
        motion = gk.move(linkage, [0.3])
        for name in rng.permutation([*asked, *motion.linkage.pins])[:4]:
            body, _, what = name.partition(" ")
            _ = getattr(motion.bodies[body], what) if what else motion.point(name).acceleration
    assert len(motion.solution.run.program.functions) <= program.FUNCTIONS + 2
