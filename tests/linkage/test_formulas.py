"""Motions by formulas that were written down against the placements themselves, and against 60 digits, on each engine."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import geomkin as gk
from geomkin.linkage.solve import formulas as worked
from geomkin.linkage.solve import program, solution
from tests.linkage.exact import four_bar
from tests.linkage.examples import ALL, FEW

NEVER = 10**18


def results_of(linkage, drive, **how):
    """All results of a motion, the last one first."""
    motion = gk.move(linkage, drive, **how)
    found = [motion.assembled, motion.transmission_angle]
    for body in motion.bodies.values():
        found += [body.alpha, body.omega, body.direction, body.second, body.first]
        for point in (body.origin, body.point(3 - 2j)):
            found += [point.acceleration, point.position, point.velocity, point.second, point.first]
    return motion, found


def same(one, other):
    for a, b in zip(one, other, strict=True):
        assert a.shape == b.shape and a.dtype == b.dtype
        # As large as rounding is in the sums that each value stands in.
        np.testing.assert_allclose(a, b, rtol=1e-12, atol=1e-12 * np.nanmax(np.abs(b), initial=1.0))


@pytest.fixture(params=["benches", "whole", "blocks", "compiled", "compiled blocks"])
def formulas(request, monkeypatch):
    """Formulas from the first motion on: NumPy on arrays kept for it, over all frames at once, or in blocks; numba."""
    if "compiled" in request.param:
        pytest.importorskip("numba")
    for name in ("WORTH_LOADED", "WORTH_LOADING"):
        monkeypatch.setattr(worked, name, 0 if "compiled" in request.param else NEVER)
    monkeypatch.setattr(program, "BLOCK", 7 if "blocks" in request.param else 4096)
    monkeypatch.setattr(program, "SMALL", 4096 if request.param == "benches" else 0)
    monkeypatch.setattr(worked, "PREFETCH_FRAMES", 16_384 if request.param == "benches" else 0)
    return lambda on: monkeypatch.setattr(solution, "WORTH", 0 if on else NEVER)


def fresh(linkage):
    linkage.linkage.formulas.clear()
    return linkage


@pytest.mark.parametrize("name", FEW)
def test_formulas_equal_placements(name, formulas):
    linkage, drive, branch = ALL[name]
    how = {"branch": branch, "speed": np.linspace(1, 3, len(drive)), "acceleration": 0.7}
    for turn in ({"branch": branch}, how):
        formulas(False)
        plain, one = results_of(fresh(linkage), drive, **turn)
        formulas(True)
        motion, other = results_of(fresh(linkage), drive, **turn)
        assert plain.solution.evaluation is None
        iterates = name in ("loops", "actuator between moving bars")
        assert (motion.solution.evaluation is None) == iterates
        same(other, one)


def test_formulas_are_those_of_the_branch_the_speed_and_the_sizes(formulas):
    """One linkage moves in many ways after each other, which are not to be taken for each other."""
    drive = np.linspace(0, 2 * np.pi, 30)
    rng = np.random.default_rng(4)
    many = gk.FourBar(
        *(v + 5 * rng.random(6) for v in (100.0, 30.0, 90.0, 70.0)), coupler_point=20 + 9j * rng.random(6)
    )
    ways = [
        {"branch": 1},
        {"branch": -1},
        {"branch": -1, "speed": 3.0},
        {"branch": -1, "speed": np.linspace(0, 1, 30)},
        {"branch": -1, "speed": 2.0, "acceleration": 1.5},
        {"branch": {"rocker_pin": -1}, "speed": 2.0, "acceleration": np.linspace(0, 1, 30)},
        {"branch": {"rocker_pin": 60 - 40j}},
        {"branch": "follow"},
    ]
    for linkage in (gk.FourBar(100, 30, 90, 70, 40 + 25j), gk.FourBar(70, 50, 60, 55, 9j, "crank", 3 - 2j, 40.0), many):
        formulas(True)
        found = [results_of(linkage, drive, **how)[1] for how in ways]
        formulas(False)
        for how, one in zip(ways, found):
            same(one, results_of(fresh(linkage), drive, **how)[1])


@pytest.mark.parametrize("power", [0, 6, 15])
def test_formulas_keep_all_digits_at_a_toggle(power, formulas):
    formulas(True)
    sizes = (3.0, 1.0, 4.0 - 10.0**-power, 2.0)
    drive = np.array([min(1.0, away * 10 ** (-power / 2)) for away in (0.1, 0.3, 1.0, 3.0, 10.0)])
    motion = gk.move(gk.FourBar(*sizes), drive)
    assert motion.solution.evaluation is not None
    for k, angle in enumerate(drive):
        for what, exact in zip(("direction", "first", "second"), four_bar(*sizes, float(angle), 1)):
            got = np.array([getattr(motion.bodies[body], what)[k] for body in ("coupler", "rocker")])
            assert np.abs(got - exact).max() <= 1.5e-15 * max(1.0, *np.abs(exact))


def test_a_change_point_is_passed_by_formulas(formulas):
    parallelogram = gk.FourBar(100, 40, 100, 40)
    formulas(True)
    motion = gk.move(parallelogram, np.linspace(0.1, 6.2, 200), "follow")
    assert motion.solution.evaluation is not None
    assert np.abs(motion.coupler.direction - 1).max() < 1e-12


def test_results_do_not_depend_on_order_or_threads():
    """Groups in any order, motions of other drives and points between, threads at once: each result is its own."""
    linkage, rng = gk.FourBar(100, 30, 90, 70, coupler_point=40 + 25j), np.random.default_rng(4)
    drives = [np.linspace(0, 6, frames) + shift for frames in (5, 90, 1500) for shift in (0, 0.3)]
    asks = {
        f"{body} {what}": lambda m, b=body, w=what: getattr(m.bodies[b], w)
        for body in ("crank", "coupler", "rocker")
        for what in ("direction", "first", "second", "omega", "alpha")
    }
    for what in ("position", "first", "second", "velocity", "acceleration"):
        asks[f"pen {what}"] = lambda m, w=what: getattr(m.point("coupler_point"), w)
        asks[f"hand {what}"] = lambda m, w=what: getattr(m.rocker.point(3 - 4j), w)
    asks |= {"angle": lambda m: m.transmission_angle, "closed": lambda m: m.assembled}
    # Moved by the placements alone.
    alone = [{name: ask(gk.move(gk.FourBar(100, 30, 90, 70, coupler_point=40 + 25j), q, speed=3.0)).copy()
              for name, ask in asks.items()} for q in drives]  # fmt: skip
    for _ in range(12):
        _ = gk.move(linkage, drives[1], speed=3.0).assembled

    def some(seed):
        own, found = np.random.default_rng(seed), []
        for _ in range(30):
            k = int(own.integers(len(drives)))
            motion = gk.move(linkage, drives[k], speed=3.0)
            names = own.permutation(list(asks))[: int(own.integers(1, 8))]
            found += [(k, name, asks[name](motion)) for name in names]
        return found

    with ThreadPoolExecutor(3) as threads:
        for found in threads.map(some, rng.integers(1000, size=6)):
            for k, name, value in found:
                np.testing.assert_allclose(value, alone[k][name], rtol=1e-12, atol=1e-12 * np.abs(value).max())


def test_branches_given_by_places_keep_their_own_formulas(monkeypatch):
    """One linkage moved by turns on both branches, each results_of by where a pin is, again and again."""
    monkeypatch.setattr(solution, "WORTH", 0)
    turn = np.linspace(0, 2 * np.pi, 25)
    bar = gk.FourBar(100, 30, 90, 70)
    pins = {side: complex(gk.move(bar, turn[:1], side).point("rocker_pin").position[0]) for side in (1, -1)}
    linkage = bar.linkage
    for side in (1, -1, 1, -1):
        moved = gk.move(linkage, turn, {"rocker_pin": pins[side]})
        wanted = gk.move(gk.FourBar(100, 30, 90, 70), turn, side)
        for body in ("coupler", "rocker"):
            assert moved.bodies[body].direction == pytest.approx(wanted.bodies[body].direction, abs=1e-12)
            assert moved.bodies[body].first == pytest.approx(wanted.bodies[body].first, abs=1e-12)
