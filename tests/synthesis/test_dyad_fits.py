"""Least squares of circles and dyads: distances by plain geometry, slopes by differences, the least by looking about."""

import numpy as np
import pytest

from geomkin.synthesis.guidance.dyads import curve_distances, fitted_circles, fitted_dyads


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
    away, _ = curve_distances(p, scale, -2 * scale * centre, scale * (np.abs(centre) ** 2 - radius**2))
    assert away == pytest.approx(np.sign(scale) * (np.abs(p - centre) - radius))
    way, off = np.exp(1j * rng.uniform(-3, 3, (6, 1))), rng.normal(size=(6, 1))
    away, _ = curve_distances(p, np.zeros((6, 1)), np.abs(scale) * way, np.abs(scale) * off)
    assert away == pytest.approx((p * np.conj(way)).real + off)
    # A circle without a radius, which no point is inside of.
    away, _ = curve_distances(p, np.ones((6, 1)), -2 * centre, np.abs(centre) ** 2)
    assert away == pytest.approx(np.abs(p - centre), rel=1e-5)


def test_slopes_of_distances_are_those_of_differences():
    rng = np.random.default_rng(2)
    p, bend, slope, level = places(rng, 4, 5), rng.normal(size=(4, 1)), places(rng, 4, 1), rng.normal(size=(4, 1))
    # Circles that have a radius.
    level = np.where(np.abs(slope) ** 2 - 4 * bend * level > 0.1, level, -level)
    assert (np.abs(slope) ** 2 - 4 * bend * level > 0.1).all()
    _, reported = curve_distances(p, bend, slope, level)
    h = 1e-6
    for k, step in enumerate(
        [(0, h, 0, 0), (0, 0, h, 0), (0, 0, 1j * h, 0), (0, 0, 0, h), (h, 0, 0, 0), (1j * h, 0, 0, 0)]
    ):
        ahead, behind = (
            curve_distances(p + s * step[0], bend + s * step[1], slope + s * step[2], level + s * step[3])[0]
            for s in (1, -1)
        )
        assert reported[k] == pytest.approx((ahead - behind) / (2 * h), abs=1e-6), k


@pytest.mark.parametrize("size", [1e-6])
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


def test_lines_have_a_direction_and_coincident_points_have_none():
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


@pytest.mark.parametrize("count", [6, 17])
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
