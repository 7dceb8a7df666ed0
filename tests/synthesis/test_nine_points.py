"""Four-bars through nine points: the equations, what is solved and followed, and each linkage moved by the solver."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.core.progress import Watch, shown
from geomkin.linkage.coupler_curve import cognates
from geomkin.synthesis.path.nine_points import _Nine, reached, through_nine, with_cognates
from tests.speed.synthesis_path import NINE

KNOWN = gk.FourBar(90, 30, 80, 70, 40 + 45j, origin=10 - 20j, ground_angle_deg=25)
DRIVE = np.linspace(0.3, 5, 9)
SEEN = gk.move(KNOWN, DRIVE).point("coupler_point").position
MIDDLE = SEEN.mean()
SIZE = np.sqrt(np.mean(np.abs(SEEN - MIDDLE) ** 2))
POINTS = (SEEN - MIDDLE) / SIZE
NO_KEYS = np.zeros((0, 3), dtype=complex)


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
    """Moved by the general solver, it and both its cognates are at each point at the cranks and branches told."""
    for sizes in with_cognates(row, complex(points[0])):
        cranks, sides = reached(sizes, points)
        assert set(sides.tolist()) <= {1, -1}
        for side in (1, -1):
            moved = gk.move(bar_of(sizes), cranks[sides == side], side).point("coupler_point").position
            if not np.abs(moved - points[sides == side]).max(initial=0) < 1e-6 * (1 + np.abs(row).max()):
                return False
    return True


def test_the_equations_hold_of_a_known_linkage_and_its_cognates_only():
    nine = _Nine(POINTS)
    assert np.abs(nine(THREE)[0]).max() < 1e-12
    rng = np.random.default_rng(1)
    other, _ = nine(THREE + 0.1 * rng.normal(size=THREE.shape))
    assert (np.abs(other).max(axis=1) > 1e-3).all() and np.abs(other).max() <= 1


def test_nearby_starts_converge_to_the_linkage():
    nine, rng = _Nine(POINTS), np.random.default_rng(2)
    starts = np.repeat(THREE, 5, axis=0) + 1e-2 * rng.normal(size=(15, 8))
    found = nine.solved(starts, 40, Watch(60, ""))
    assert len(found) == 15 and [np.abs(found - one).max(axis=1).min() < 1e-9 for one in THREE] == [True] * 3
    assert np.abs(nine(found)[0]).max() < 1e-12
    # In so many steps some of random starts come to a solution, and no row is anything else; the rest is given up.
    found = nine.solved(np.vstack([THREE, np.full(8, np.nan), rng.normal(size=(200, 8))]), 150, Watch(60, ""))
    assert len(found) > 10 and np.abs(nine(found)[0]).max() < 1e-12
    # One step when time is over, which is enough for what is there.
    late = Watch(0, "")
    assert len(nine.solved(np.vstack([THREE, rng.normal(size=(50, 8))]), 150, late)) == 3 and late.cut


def test_cognates_count_once_and_degenerate_solutions_not_at_all():
    nine, rng = _Nine(POINTS), np.random.default_rng(3)
    for order in ([0, 1, 2], [2, 0, 1], [1, 2, 0]):
        # Either of its two sides first.
        sides = np.concatenate([THREE[order], THREE[order][:, [4, 5, 6, 7, 0, 1, 2, 3]]])
        new, keys = nine.new(sides + 1e-9 * rng.normal(size=(6, 8)), NO_KEYS)
        assert len(new) == 1 == len(keys) and np.abs(new[0] - THREE[order[0]]).max() < 1e-7
        again, more = nine.new(THREE[order], keys)
        assert len(again) == 0 and len(more) == 1
    apart, keys = nine.new(THREE[:1] + 1e-2 * rng.normal(size=(4, 8)), keys)
    assert len(apart) == 4 and len(keys) == 5
    # Pin, pivot, other pin, other pivot; the coupler point is at 0.
    assert nine.real(np.array([1, 2j, 1 + 2j, 3]).view(float)[None]).all()
    for none in (
        [0, 2j, 1 + 2j, 3], [1, 2j, 0, 3], [1, 2j, 1, 3], [1, 1, 1 + 2j, 3], [1, 2j, 1 + 2j, 1 + 2j],
        [1, 2j, 1 + 2j, 2j], [1, 2e3, 1 + 2j, 3], [np.nan, 2j, 1 + 2j, 3],
    ):  # fmt: skip
        row = np.array(none, dtype=complex).view(float)[None]
        assert not nine.real(row).any() and len(nine.new(row, NO_KEYS)[0]) == 0


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
        assert np.exp(1j * (reached(sizes, SEEN)[0] + sizes[8])) == pytest.approx(crank, abs=1e-6)


def test_random_starts_find_linkages_through_points_anywhere(monkeypatch):
    for name, value in {"STARTS": 20, "AT_ONCE": 200, "IDLE": 2}.items():
        monkeypatch.setattr(f"geomkin.synthesis.path.nine_points.{name}", value)
    points, told = (NINE - NINE.mean()) / 0.8, []
    with shown(lambda share, what: told.append((share, what))):
        rows = through_nine(points, np.random.default_rng(0), Watch(600, "of nine"))
    assert len(rows) > 5 and all(is_through(row, points) for row in rows)
    pivots = [with_cognates(row, complex(points[0])) for row in rows]
    threes = {frozenset(complex(round(x[6], 4), round(x[7], 4)) for x in three) for three in pivots}
    assert len(threes) == len(rows)
    shares = [share for share, _ in told]
    assert shares == sorted(shares) and shares[0] < shares[-1] <= 1 and {what for _, what in told} == {"of nine"}
    # With no time it says what it came to.
    assert len(through_nine(points, np.random.default_rng(0), Watch(0, ""))) < len(rows)


@pytest.mark.campaign
def test_other_seeds_find_nearly_the_same_linkages(monkeypatch):
    """Of a set with 80 real linkages in several families, of which one seed found 27 and another one."""
    monkeypatch.setattr("geomkin.synthesis.path.nine_points.IDLE", 2)
    drive = np.sort(np.random.default_rng(12).uniform(0.2, 5.5, 9))
    points = gk.move(gk.FourBar(100, 35, 90, 70, 40 + 30j), drive).point("coupler_point").position
    points = points - points.mean()
    points = points / np.sqrt(np.mean(np.abs(points) ** 2))
    first, second = (through_nine(points, np.random.default_rng(seed), Watch(600, "")) for seed in (0, 1))
    assert len(first) > 25 and len(second) > 25
    assert all(is_through(row, points) for row in (*first, *second))
    problem, start = _Nine(points), np.tile([points[0].real, points[0].imag], 4)
    _, keys = problem.new(first - start, NO_KEYS)
    missing, _ = problem.new(second - start, keys)
    assert len(second) - len(missing) > 0.8 * max(len(first), len(second))
