"""Four-bars through nine points: the equations, the stored solutions, the paths, and each linkage moved by the solver."""

from fractions import Fraction

import numpy as np
import pytest

import geomkin as gk
from geomkin.linkage.cognate_linkages import cognates
from geomkin.synthesis.path import nine_point_equations
from geomkin.synthesis.path.nine_point_equations import (
    ComplexDoubleDouble,
    cognates_of,
    follow,
    is_degenerate,
    is_repeated,
    keys_of,
    may_be_degenerate,
    precise_residuals,
    refine,
    residuals,
    rotations_of,
    slopes,
    solve,
)
from geomkin.synthesis.path.nine_points import cranks_and_branches, special, starts_of, through_nine, with_cognates
from tests.speed.synthesis_path import NINE

KNOWN = gk.FourBar(90, 30, 80, 70, 40 + 45j, origin=10 - 20j, ground_angle_deg=25)
DRIVE = np.linspace(0.3, 5, 9)
SEEN = gk.move(KNOWN, DRIVE).point("coupler_point").position
MIDDLE = SEEN.mean()
SIZE = np.sqrt(np.mean(np.abs(SEEN - MIDDLE) ** 2))
POINTS = (SEEN - MIDDLE) / SIZE
OFFSETS = (POINTS - POINTS[0])[1:]
PARAMETERS = np.concatenate([OFFSETS, np.conj(OFFSETS)])[None]


def joints(cognate):
    """Pins and pivots (8,) from the first point, as the general solver has them there."""
    bar = cognate.linkage
    motion = gk.move(bar, DRIVE + cognate.drive_offset, cognate.branch)
    far = motion.coupler.origin.position[0] + bar.coupler * motion.coupler.direction[0]
    pivot = bar.origin + bar.ground * np.exp(1j * np.radians(bar.ground_angle_deg))
    return (np.array([motion.coupler.origin.position[0], bar.origin, far, pivot]) - SEEN[0]).view(float) / SIZE


THREE = np.array([joints(one) for one in cognates(KNOWN)])


def bar_of(sizes):
    *lengths, x, y, origin_x, origin_y, turn, start = sizes.tolist()
    assert start == 0
    origin = complex(origin_x, origin_y)
    return gk.FourBar(*lengths, complex(x, y), origin=origin, ground_angle_deg=np.degrees(turn))


def is_through(row, points):
    """Moved by the general solver, it and both its cognates reach each point at the reported crank angles and branches."""
    for sizes in with_cognates(row, complex(points[0])):
        cranks, sides = cranks_and_branches(sizes, points)
        assert set(sides.tolist()) <= {1, -1}
        for side in (1, -1):
            moved = gk.move(bar_of(sizes), cranks[sides == side], side).point("coupler_point").position
            if not np.abs(moved - points[sides == side]).max(initial=0) < 1e-6 * (1 + np.abs(row).max()):
                return False
    return True


def as_solution(row):
    """Pins and pivots (8,) of a real linkage as a solution of the equations (1, 16)."""
    places = row.view(complex)
    dyads = np.stack([places, np.conj(places)], axis=1).reshape(1, 8)
    return np.concatenate([dyads, rotations_of(dyads, PARAMETERS)], axis=1)


SOLUTIONS = np.concatenate([as_solution(row) for row in THREE])
P3 = np.repeat(PARAMETERS, 3, axis=0)


def ignored(share):
    pass


def random_complex(seed, *shape):
    rng = np.random.default_rng(seed)
    return rng.normal(size=shape) + 1j * rng.normal(size=shape)


def test_double_doubles_hold_what_exact_fractions_give():
    a, a_low, b, b_low = random_complex(0, 4, 50)
    a_low, b_low = 1e-17 * a_low, 1e-17 * b_low
    one, other = ComplexDoubleDouble.of(a, a_low), ComplexDoubleDouble.of(b, b_low)
    for result, exact in (
        (one * other, lambda p, q, r, s: (p * r - q * s, p * s + q * r)),
        (one + other, lambda p, q, r, s: (p + r, q + s)),
        (one - other, lambda p, q, r, s: (p - r, q - s)),
    ):
        for k in range(50):
            parts = [
                Fraction(high) + Fraction(low)
                for z, z_low in ((a[k], a_low[k]), (b[k], b_low[k]))
                for high, low in ((z.real, z_low.real), (z.imag, z_low.imag))
            ]
            high, low = (part[k] for part in result.parts)
            for got, wanted in zip(
                (Fraction(high.real) + Fraction(low.real), Fraction(high.imag) + Fraction(low.imag)), exact(*parts)
            ):
                assert abs(got - wanted) < 1e-30 * (1 + abs(a[k])) * (1 + abs(b[k]))


def test_the_equations_hold_for_a_moved_linkage_and_its_cognates_only():
    motion = gk.move(KNOWN, DRIVE)
    assert np.abs(residuals(SOLUTIONS, P3)).max() < 1e-11
    assert SOLUTIONS[0, 8:] == pytest.approx((motion.coupler.direction / motion.coupler.direction[0])[1:], abs=1e-9)
    off = np.abs(residuals(SOLUTIONS + 0.1 * random_complex(1, 3, 16), P3)).max(axis=(1, 2))
    assert (off > 1e-2).all()
    low = np.zeros_like(SOLUTIONS)
    assert precise_residuals(SOLUTIONS, low, P3, 0 * P3) == pytest.approx(residuals(SOLUTIONS, P3), abs=1e-12)


def test_derivatives_agree_with_central_differences():
    x, p, step = random_complex(2, 4, 16), random_complex(3, 4, 16), 1e-6
    by_place, by_rotation, by_d, by_conjugate = slopes(x, p)

    def difference(k, of_parameters=False):
        shift = step * np.eye(16)[k]
        if of_parameters:
            return (residuals(x, p + shift) - residuals(x, p - shift)) / (2 * step)
        return (residuals(x + shift, p) - residuals(x - shift, p)) / (2 * step)

    for k in range(8):
        dyad = k // 4
        assert by_place[:, dyad, :, k % 4] == pytest.approx(difference(k)[:, dyad], abs=1e-6)
        assert by_rotation[..., k] == pytest.approx(difference(8 + k)[..., k], abs=1e-6)
        assert by_d[..., k] == pytest.approx(difference(k, True)[..., k], abs=1e-6)
        assert by_conjugate[..., k] == pytest.approx(difference(8 + k, True)[..., k], abs=1e-6)
    right = random_complex(4, 4, 2, 8)
    change = solve(by_place, by_rotation, right)
    moved = (residuals(x + step * change, p) - residuals(x - step * change, p)) / (2 * step)
    assert moved == pytest.approx(right, abs=1e-5)


def test_cognates_are_one_class():
    for k in range(3):
        for cognate in cognates_of(SOLUTIONS[k : k + 1], PARAMETERS):
            assert np.abs(residuals(cognate, PARAMETERS)).max() < 1e-9
            # The same linkage as one of the three, with its dyads in either order.
            swapped = cognate[:, [4, 5, 6, 7, 0, 1, 2, 3]]
            off = [np.abs(SOLUTIONS[:, :8] - row).max(axis=1).min() for row in (cognate[:, :8], swapped)]
            assert min(off) < 1e-9
    assert is_repeated(SOLUTIONS).tolist() == [False, True, True]
    others = SOLUTIONS * (1 + 1e-3 * random_complex(5, 3, 16))
    assert not is_repeated(np.concatenate([SOLUTIONS[:1], others])).any()
    assert keys_of(SOLUTIONS) == pytest.approx(keys_of(SOLUTIONS)[0], rel=1e-9)


def test_degenerate_sets_are_recognised():
    assert not may_be_degenerate(SOLUTIONS).any() and not is_degenerate(SOLUTIONS).any()
    for capital in (0, 1):
        x = random_complex(6, 5, 16)
        x[:, [capital, 2 + capital, 4 + capital, 6 + capital]] = random_complex(7, 5, 1)
        assert is_degenerate(x).all() and may_be_degenerate(x).all()
    x = SOLUTIONS[:1].copy()
    x[0, 2] = x[0, 0] * (1 + 1e-9)
    assert may_be_degenerate(x).all() and not is_degenerate(x).any()


@pytest.mark.parametrize("number", [1, 2])
def test_each_stored_set_has_the_published_number_of_solutions(number):
    """1442: Wampler, Morgan and Sommese 1992."""
    x, parameters = starts_of(number)
    assert len(x) == 1442 and not is_repeated(x).any() and not may_be_degenerate(x).any()
    sizes = np.abs(slopes(x, np.broadcast_to(parameters, x.shape))[1])
    assert (np.abs(residuals(x, np.broadcast_to(parameters, x.shape))) < 1e-11 * (1 + sizes)).all()


@pytest.mark.campaign
def test_paths_lead_back_to_their_start():
    x, parameters = starts_of(1)
    corner = random_complex(8, 16)
    there = follow(x[:6], parameters, corner, ignored)
    assert there.reached.all()
    back = follow(there.x, corner, parameters, ignored, precise=True)
    assert back.reached.all() and back.x == pytest.approx(x[:6], rel=1e-9, abs=1e-9)
    near = refine(there.x * (1 + 1e-6), corner)
    assert near.reached.all() and near.x == pytest.approx(there.x, rel=1e-12, abs=1e-12)


def test_path_that_takes_too_many_steps_is_lost(monkeypatch):
    x, parameters = starts_of(1)
    monkeypatch.setattr(nine_point_equations, "MOST_STEPS", 3)
    assert not follow(x[:2], parameters, random_complex(8, 16), ignored).reached.any()


def test_cranks_and_branches_of_points_and_cognates_as_the_general_solver_has_them():
    row = (THREE[0].view(complex) * SIZE + SEEN[0]).view(float)
    assert is_through(row, SEEN)
    for sizes, cognate in zip(with_cognates(row, complex(SEEN[0])), cognates(KNOWN)):
        bar, other = bar_of(sizes), cognate.linkage
        for name in ("ground", "crank", "coupler", "rocker", "coupler_point", "origin"):
            assert getattr(bar, name) == pytest.approx(getattr(other, name), rel=1e-9)
        turn = np.exp(1j * np.radians(bar.ground_angle_deg - other.ground_angle_deg))
        assert turn == pytest.approx(1, abs=1e-9)
        crank = gk.move(other, DRIVE + cognate.drive_offset, cognate.branch).crank.direction / turn
        assert np.exp(1j * (cranks_and_branches(sizes, SEEN)[0] + sizes[8])) == pytest.approx(crank, abs=1e-6)


def test_points_in_special_positions_are_recognised():
    turn = np.exp(1j * np.sort(np.random.default_rng(0).uniform(0, 6, 9)))
    line = 3 + (2 - 1j) * np.linspace(0, 1, 9)
    for place in (1.0, 1e6 + 1j):
        assert special(place + turn) and special(place + line)
        assert special(place + np.where(np.arange(9) < 7, line, turn))
        assert not special(place + np.where(np.arange(9) < 6, line, turn))
    assert special(np.where(np.arange(9) == 4, POINTS[2], POINTS)) and not special(POINTS)


@pytest.mark.campaign
def test_all_real_linkages_of_the_published_problem_are_found():
    """64 of 1442: Wampler, Morgan and Sommese 1992, problem 3."""
    reports = []
    rows, count = through_nine(NINE, reports.append)
    assert (count.real, count.not_real, count.repeated, count.lost) == (64, 1378, 0, 0) and count.is_complete
    assert len(rows) == 64 and all(is_through(row, NINE) for row in rows)
    pivots = [with_cognates(row, complex(NINE[0])) for row in rows]
    assert len({frozenset(complex(round(x[6], 4), round(x[7], 4)) for x in three) for three in pivots}) == 64
    assert reports == sorted(reports) and reports[0] < reports[-1] <= 1


@pytest.mark.campaign
def test_the_linkage_that_the_points_come_from_is_found():
    """From a set with 80 real linkages, and from random crank-rockers."""
    rng = np.random.default_rng(12)
    bars = [gk.FourBar(100, 35, 90, 70, 40 + 30j)]
    while len(bars) < 4:
        bar = gk.FourBar(*rng.uniform(1, 3, 3), 3.0, complex(*rng.normal(size=2)))
        if gk.move(bar, np.linspace(0, 2 * np.pi, 361)).assembled.all():
            bars.append(bar)
    for k, bar in enumerate(bars):
        drive = np.sort((rng if k else np.random.default_rng(12)).uniform(0.2, 5.5, 9))
        points = gk.move(bar, drive).point("coupler_point").position
        rows, count = through_nine(points, ignored)
        assert count.is_complete and (k or count.real == 80)
        lengths = [x[:4] for row in rows for x in with_cognates(row, complex(points[0]))]
        either = ([bar.ground, bar.crank, bar.coupler, bar.rocker], [bar.ground, bar.rocker, bar.coupler, bar.crank])
        assert min(np.abs(four - order).max() for four in lengths for order in either) < 1e-6 * bar.ground
