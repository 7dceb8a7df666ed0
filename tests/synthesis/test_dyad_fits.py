"""Least squares of circles and dyads: distances by plain geometry, slopes by differences, the least by looking about."""

import numpy as np
import pytest

from geomkin.synthesis.guidance import dyads as dyad_fits
from geomkin.synthesis.guidance.constraint import Pairs
from geomkin.synthesis.guidance.dyads import distances, fitted_circles, fitted_dyads, least_squares


def places(rng, *shape):
    return rng.normal(size=shape) + 1j * rng.normal(size=shape)


def test_distances_from_circles_and_lines_have_their_sign():
    rng = np.random.default_rng(1)
    p, centre, radius, scale = (
        places(rng, 6, 5),
        places(rng, 6, 1),
        rng.uniform(0.2, 2, (6, 1)),
        rng.uniform(-3, 3, (6, 1)),
    )
    away, _ = distances(p, scale, -2 * scale * centre, scale * (np.abs(centre) ** 2 - radius**2))
    assert away == pytest.approx(np.sign(scale) * (np.abs(p - centre) - radius))
    way, off = np.exp(1j * rng.uniform(-3, 3, (6, 1))), rng.normal(size=(6, 1))
    away, _ = distances(p, np.zeros((6, 1)), np.abs(scale) * way, np.abs(scale) * off)
    assert away == pytest.approx((p * np.conj(way)).real + off)
    # A circle without a radius, which no point is inside of.
    away, _ = distances(p, np.ones((6, 1)), -2 * centre, np.abs(centre) ** 2)
    assert away == pytest.approx(np.abs(p - centre), rel=1e-5)


def test_slopes_of_distances_are_those_of_differences():
    rng = np.random.default_rng(2)
    p, bend, slope, level = places(rng, 4, 5), rng.normal(size=(4, 1)), places(rng, 4, 1), rng.normal(size=(4, 1))
    # Circles that have a radius.
    level = np.where(np.abs(slope) ** 2 - 4 * bend * level > 0.1, level, -level)
    assert (np.abs(slope) ** 2 - 4 * bend * level > 0.1).all()
    _, told = distances(p, bend, slope, level)
    h = 1e-6
    for k, step in enumerate(
        [(0, h, 0, 0), (0, 0, h, 0), (0, 0, 1j * h, 0), (0, 0, 0, h), (h, 0, 0, 0), (1j * h, 0, 0, 0)]
    ):
        ahead, behind = (
            distances(p + s * step[0], bend + s * step[1], slope + s * step[2], level + s * step[3])[0] for s in (1, -1)
        )
        assert told[k] == pytest.approx((ahead - behind) / (2 * h), abs=1e-6), k


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e5])
def test_circles_through_three_points_and_nearest_to_more(size):
    rng = np.random.default_rng(3)
    centre, radius = 4 * places(rng, 20, 1) + 3, rng.uniform(0.5, 3, (20, 1))
    for count in (3, 6):
        points = size * (centre + radius * np.exp(1j * rng.uniform(-3, 3, (20, count))))
        found, far = fitted_circles(points)
        assert not far.any() and found == pytest.approx(size * centre[:, 0], rel=1e-5)
    points += size * 0.05 * places(rng, 20, 6)
    found, far = fitted_circles(points)
    assert not far.any()

    def squares(at):
        reach = np.abs(points - at[:, None])
        return np.sum((reach - reach.mean(axis=1, keepdims=True)) ** 2, axis=1)

    for step in 1e-3 * size * np.exp(2j * np.pi * np.arange(8) / 8):
        assert (squares(found + step) > squares(found)).all()


def test_lines_are_told_by_their_direction_and_what_fits_many_circles_by_none():
    rng = np.random.default_rng(4)
    way = np.exp(1j * rng.uniform(-3, 3, 10))
    for count in (3, 5):
        found, far = fitted_circles(places(rng, 10, 1) + way[:, None] * rng.normal(size=(10, count)))
        assert far.all() and np.abs((found / way).imag).max() < 1e-6 and np.abs(found) == pytest.approx(1)
    # Two places, which many circles pass, between three that have one, a circle, and a point that stays.
    rows = np.array([[1, 2j, 1, 2j], [0, 1, 1j, 1 + 1j], [3 + 1j] * 4, [0, 1, 2, 3]])
    found, far = fitted_circles(rows)
    assert np.isnan(found[0]) and found[1:3] == pytest.approx([0.5 + 0.5j, 3 + 1j]) and abs(found[3].imag) < 1e-9
    assert far.tolist() == [False, False, False, True]


def test_a_place_in_the_middle_of_the_others_is_one_of_them():
    way = np.exp(0.7j)
    # Along a line, and of a cross of which the circle through the ends is as good as any other about its middle.
    found, far = fitted_circles(np.array([3 + way * np.array([-1, 0, 1]), 3 + way * np.array([-2, 0, 2])]))
    assert far.all() and np.abs((found / way).imag).max() < 1e-9
    found, far = fitted_circles(np.array([[5 + 2, 5 - 1 + 3j, 5 - 1 - 3j, 5]]))
    assert not far.any() and abs(found[0] - 5) > 1


def test_least_squares_are_found_from_every_start_by_itself():
    """The valley of Rosenbrock from many starts; a line's two numbers; and one that has its least at infinity."""
    starts = np.array([[-1.2, 1.0], [3.0, -2.0], [0.0, 0.0], [1.0, 1.0]])
    asked = []

    def valley(x, rows):
        asked.append(rows.tolist())
        away = np.stack([10 * (x[:, 1] - x[:, 0] ** 2), 1 - x[:, 0]], axis=-1)
        none, ones = np.zeros(len(x)), np.ones(len(x))
        by = np.stack([np.stack([-20 * x[:, 0], 10 * ones], -1), np.stack([-ones, none], -1)], axis=1)
        return away, by

    assert least_squares(valley, starts)[0] == pytest.approx(np.ones((4, 2)), abs=1e-6)
    # What has converged is not asked for again.
    assert asked[0] == [0, 1, 2, 3] and len(asked[-1]) < 4 and all(set(b) <= set(a) for a, b in zip(asked, asked[1:]))
    rng = np.random.default_rng(5)
    t, told = np.linspace(0, 3, 7), rng.normal(size=(2, 7))

    def line(x, rows):
        by = np.broadcast_to(np.stack([np.ones(7), t], axis=-1), (len(x), 7, 2))
        return x[:, :1] + x[:, 1:] * t - told[rows], by

    wanted = [np.polyfit(t, row, 1)[::-1] for row in told]
    assert least_squares(line, np.zeros((2, 2)))[0] == pytest.approx(np.array(wanted), abs=1e-8)
    gone, converged = least_squares(lambda x, rows: (np.exp(-x), -np.exp(-x)[..., None]), np.array([[0.0]]))
    assert np.isfinite(gone).all() and gone[0, 0] > 5
    assert least_squares(valley, np.zeros((0, 2)))[0].shape == (0, 2)
    # What has its least at infinity has not come to rest when the steps end.
    assert not converged.any() and least_squares(valley, starts)[1].all()


@pytest.mark.parametrize("count", [6, 11, 12, 17, 60])
def test_fits_of_any_number_of_poses_are_different_and_the_best_first(count):
    rng = np.random.default_rng(count)
    angle = np.linspace(0, 2.5, count)
    z, u = (
        30 * np.exp(0.7j * angle) + 0.5 * places(rng, count) + 100,
        np.exp(1j * (angle**1.2 + 0.02 * rng.normal(size=count))),
    )
    found, converged = fitted_dyads(z, u)
    away = np.where(
        found.fixed_far,
        np.ptp((np.conj(found.fixed) * (z[:, None] + u[:, None] * found.moving)).imag, axis=0),
        np.ptp(np.abs(z[:, None] + u[:, None] * found.moving - found.fixed), axis=0),
    )
    pinned = ~found.moving_far
    assert pinned.sum() >= 1 and (np.diff(away[pinned]) > -1e-6).all()
    at = np.stack([found.fixed, found.moving], axis=1)[pinned]
    apart = np.abs(at[:, None] - at).max(axis=2) + 1e9 * np.eye(len(at))
    assert apart.min() > 1e-3

    # Nothing near by is better in the sum of squares, but for what creeps towards a dyad at infinity, or fits badly.
    seen = 0

    def squares(fixed, moving):
        reach = np.abs(z + u * moving - fixed)
        return np.sum((reach - reach.mean()) ** 2)

    for fixed, moving in at[~found.fixed_far[pinned] & converged[pinned]]:
        least = squares(fixed, moving)
        # Of remote pins the squares change by less than rounding.
        if abs(fixed - 100) < 1e4 and abs(moving) < 1e4 and least < 20:
            seen += 1
            for step in 0.03 * np.exp(2j * np.pi * np.arange(6) / 6):
                assert squares(fixed + step, moving) > least and squares(fixed, moving + step) > least
    assert seen


def test_fits_are_one_where_both_of_their_points_are():
    fixed = np.array([1 + 1j, 1 + 1j, 1 + 1.00001j, 2j, 1 + 1j, np.inf, 1j, 1j])
    moving = np.array([5j, 6j, 5.00001j, 5j, 5j, 0, 5j, 5j])
    far = np.array([0, 0, 0, 0, 1, 0, 0, 0], dtype=bool)
    body_far = np.array([0, 0, 0, 0, 0, 0, 0, 1], dtype=bool)
    # The third is the first; the fifth is a slide in the first one's place, the sixth nowhere.
    assert dyad_fits._different(Pairs(fixed, moving, far, body_far)).tolist() == [0, 1, 3, 4, 6, 7]


@pytest.mark.parametrize("count", [12, 14, 17, 60, 200])
def test_sets_of_five_out_of_many_are_spread_over_all(count):
    sets = np.array(dyad_fits._spread(count))
    assert len(sets) == min(count // 5, dyad_fits.MOST_FIVES) == len(np.unique(sets[:, 0]))
    assert (np.diff(sets, axis=1) == count // 5).all() and sets.min() == 0 and sets.max() < count
