"""What a dyad asks of poses, as numbers: coefficients, the dyads that they are, and what dyads miss."""

import numpy as np
import pytest

from geomkin.synthesis.guidance.constraint import (
    SIDE,
    Pairs,
    common_points,
    joined,
    missed,
    normalised,
    pairs_of,
    relations,
    rows,
)


def places(rng, *shape):
    return rng.normal(size=shape) + 1j * rng.normal(size=shape)


def turns(rng, *shape):
    return np.exp(1j * rng.uniform(-np.pi, np.pi, shape))


def coefficients(w, a, b, c, d):
    """In the order of their real parts, (..., 8)."""
    return np.stack([w, a.real, a.imag, b.real, b.imag, c.real, c.imag, d], axis=-1)


def of_pins(w, pivot, pin, rest):
    return coefficients(w, 2 * w * pin, -2 * w * pivot, -2 * w * np.conj(pivot) * pin, rest)


def test_coefficients_of_a_pin_give_its_squared_distance():
    rng = np.random.default_rng(1)
    z, u, pivot, pin = places(rng, 50), turns(rng, 50), places(rng, 7), places(rng, 7)
    w = rng.uniform(-3, 3, 7)
    rest = w * (abs(pin) ** 2 + abs(pivot) ** 2)
    reported = rows(z, u) @ of_pins(w, pivot, pin, rest).T
    assert reported == pytest.approx(w * np.abs(z[:, None] + u[:, None] * pin - pivot) ** 2, abs=1e-12)


def test_the_two_side_conditions_are_those_of_the_coefficients():
    rng = np.random.default_rng(2)
    w, d, (a, b, c) = rng.normal(size=40), rng.normal(size=40), places(rng, 3, 40)
    reported = coefficients(w, a, b, c, d)
    values = np.einsum("ni,kij,nj->kn", reported, SIDE, reported)
    wanted = 2 * w * c - a * np.conj(b)
    assert values[0] + 1j * values[1] == pytest.approx(wanted, abs=1e-12)
    assert (SIDE == SIDE.swapaxes(1, 2)).all()


def test_coefficients_are_converted_to_their_dyads():
    rng = np.random.default_rng(3)
    w, pivot, pin, rest = rng.uniform(0.1, 3, 30), places(rng, 30), places(rng, 30), rng.normal(size=30)
    found, good = pairs_of(of_pins(w, pivot, pin, rest))
    assert good.all() and not found.fixed_far.any() and not found.moving_far.any()
    assert found.fixed == pytest.approx(pivot) and found.moving == pytest.approx(pin)
    # A pin that slides: c is conj(b) times the pin; and a line of the body over a pivot: 2 w c = a conj(b) with b = 0.
    way, none, nothing = turns(rng, 30), np.zeros(30), np.zeros(30, dtype=complex)
    found, good = pairs_of(coefficients(none, nothing, way, np.conj(way) * pin, rest))
    assert good.all() and found.fixed_far.all() and not found.moving_far.any()
    assert found.moving == pytest.approx(pin) and found.fixed == pytest.approx(1j * way)
    found, good = pairs_of(coefficients(none, way, nothing, -way * np.conj(pivot), rest))
    assert good.all() and found.moving_far.all() and not found.fixed_far.any()
    assert found.fixed == pytest.approx(pivot) and np.abs((found.moving / way).real).max() < 1e-12
    # What only forbids turning is none.
    assert not pairs_of(coefficients(none, nothing, nothing, way, rest))[1].any()
    assert not pairs_of(coefficients(none, nothing, nothing, nothing, rest))[1].any()


def test_dyads_of_slides_hold_the_poses_that_their_coefficients_are_met_by():
    """A pin on a line of the ground, and a line of the body over a pivot, made and seen by the coefficients alone."""
    rng = np.random.default_rng(4)
    u, pin, way, pivot = turns(rng, 9), places(rng), turns(rng), places(rng)
    for on_ground in (True, False):
        if on_ground:
            z = 2 + 1j + way * rng.normal(size=9) - u * pin
        else:
            # The pivot, seen from the body, is on a line of it.
            z = pivot - u * (0.3 - 0.7j + way * rng.normal(size=9))
        reported = relations(z, u).vectors[-1]
        found, good = pairs_of(reported[None])
        middle, size = normalised(z)[1:]
        found = found.enlarged(middle, size)
        assert good.all() and bool(found.fixed_far[0]) == on_ground and bool(found.moving_far[0]) == (not on_ground)
        assert missed(z, u, found)[0] < 1e-12
        if on_ground:
            assert found.moving[0] == pytest.approx(pin) and abs((found.fixed[0] / way).imag) < 1e-12
        else:
            assert found.fixed[0] == pytest.approx(pivot) and abs((found.moving[0] / way).imag) < 1e-12


def test_error_of_a_dyad_is_half_the_variation_of_its_distance():
    rng = np.random.default_rng(5)
    z, u = 50 * places(rng, 6) + 300, turns(rng, 6)
    fixed, moving = 50 * places(rng, 12) + 300, 50 * places(rng, 12)
    fixed[:4], moving[4:8] = turns(rng, 4), turns(rng, 4)
    sort = np.arange(12) // 4
    pairs = Pairs(fixed, moving, sort == 0, sort == 1)
    reported = missed(z, u, pairs)
    for k in range(12):
        away = [
            (np.conj(fixed[k]) * (z + u * moving[k])).imag,
            (np.conj(moving[k]) * np.conj(u) * (fixed[k] - z)).imag,
            np.abs(z + u * moving[k] - fixed[k]),
        ][sort[k]]
        assert reported[k] == pytest.approx((away.max() - away.min()) / 2)
    # The same of several sets of poses at once, of some of them, and of what the body sees.
    both = missed(np.stack([z, z[::-1]]), np.stack([u, u[::-1]]), pairs)
    assert both == pytest.approx(np.stack([reported, reported]))
    kept = np.array([1, 5, 9, 10])
    assert missed(z, u, joined([pairs.at(kept[:2]), pairs.at(kept[2:])])) == pytest.approx(reported[kept])
    assert missed(-np.conj(u) * z, np.conj(u), pairs.swapped) == pytest.approx(reported)
    # A pivot so far away that its distance has no digits left of what the pin varies by.
    far = Pairs(np.array([1e14 + 0j]), moving[:1] * 0, sort[:1] > 0, sort[:1] > 0)
    assert missed(z, u, far)[0] == pytest.approx(np.ptp(z.real) / 2, rel=1e-3)


@pytest.mark.parametrize("size", [1e-6])
def test_few_poses_leave_free_dimensions(size):
    rng = np.random.default_rng(6)
    z, u = size * places(rng, 8), turns(rng, 8)
    for count in range(1, 9):
        assert relations(z[:count], u[:count]).freedom == 8 - count
    # Parallel ones give three conditions besides their direction; those about one point give three, too.
    assert relations(z, np.ones(8)).freedom == 4 and relations(np.ones(5, dtype=complex), u[:5]).freedom == 5
    scaled, middle, extent = normalised(z + 7 * size)
    assert middle[0] + extent[0] * scaled == pytest.approx(z + 7 * size)
    assert np.abs(scaled).max() == pytest.approx(1) and abs(scaled.mean()) < 1e-12
    assert normalised(np.full(3, 5 + 1j))[2].tolist() == [1.0]


def test_circles_that_do_not_meet_have_no_points_and_those_that_do_have_two():
    def circle(x, y, radius):
        return np.array([[1.0, 0, -x], [0, 1.0, -y], [-x, -y, x * x + y * y - radius**2]])

    for x, meets in ((1.5, True), (3.5, False), (0.5, False)):
        radius = 1.0 if x > 1 else 2.0
        points, there = common_points(np.array([[circle(0, 0, 1), circle(x, 0.2, radius)]]))
        apart = np.hypot(x, 0.2)
        assert (abs(1 - radius) < apart < 1 + radius) == meets and there.sum() == 2 * meets
        for point in points[there]:
            at = point[:2] / point[2]
            assert np.hypot(*at) == pytest.approx(1) and np.hypot(at[0] - x, at[1] - 0.2) == pytest.approx(radius)


def pairs(rng, count, apart):
    """Conics through a point each, the second's slope there that of the first but for `apart`."""
    first, second = (m + m.transpose(0, 2, 1) for m in rng.normal(size=(2, count, 3, 3)))
    x = rng.normal(size=(count, 3))
    x /= np.linalg.norm(x, axis=1)[:, None]

    def through(conics):
        return conics - np.einsum("ni,nij,nj->n", x, conics, x)[:, None, None] * x[:, :, None] * x[:, None]

    first, second = through(first), through(second)
    if apart is not None:
        slopes = [np.einsum("nij,nj->ni", conics, x) for conics in (first, second)]
        step = slopes[0] + apart[:, None] * rng.normal(size=(count, 3)) - slopes[1]
        step -= np.sum(step * x, axis=1)[:, None] * x
        second = through(second + step[:, :, None] * x[:, None] + x[:, :, None] * step[:, None])
    return first, second, x


@pytest.mark.parametrize(("near", "allowed"), [(None, 1e-9), ((1e-12, 1e-6), 2e-6)])
def test_the_known_point_is_found_and_all_are_true(near, allowed):
    rng = np.random.default_rng(3)
    apart = None if near is None else 10 ** rng.uniform(*np.log10(near), 3000)
    first, second, x = pairs(rng, 3000, apart)
    points, there = common_points(np.stack([first, second], axis=1))
    off = np.minimum(np.abs(points - x[:, None]).max(-1), np.abs(points + x[:, None]).max(-1))
    assert np.where(there, off, 9).min(axis=1).max() < allowed
    values = [np.abs(np.einsum("nki,nij,nkj->nk", points, m, points))[there] for m in (first, second)]
    assert np.max(values) < 1e-11
    if near is None or near[0] > 1e-3:
        # Real points come in pairs, also where two nearly meet.
        assert (there.sum(axis=1) % 2 == 0).all()


def test_conics_that_share_a_line():
    line, one, two = np.array([1.0, 2, 3]), np.array([1.0, -1, 0.5]), np.array([0.2, 1, 1])
    conics = [np.outer(line, each) + np.outer(each, line) for each in (one, two)]
    points, there = common_points(np.array([conics]))
    on_line = np.abs(points[0] @ line) < 1e-9
    assert there[0].tolist() == [True, True, True, False]
    assert on_line[:2].all() and not on_line[2]
    other = np.cross(one, two)
    assert np.abs(np.cross(points[0, 2], other / np.linalg.norm(other))).max() < 1e-9
