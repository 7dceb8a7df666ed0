"""Common points of conics that were made to pass a known point, many of them nearly touching there."""

import numpy as np
import pytest

from geomkin.synthesis.guidance.constraint import common_points


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


@pytest.mark.parametrize(
    ("near", "allowed"), [(None, 1e-9), ((1e-4, 1e-1), 1e-7), ((1e-6, 1e-5), 1e-7), ((1e-12, 1e-6), 2e-6)]
)
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


def test_of_conics_that_share_any_line_two_of_its_points_are_told_and_the_one_besides():
    rng = np.random.default_rng(8)
    line, *others = rng.normal(size=(3, 300, 3))
    conics = [np.einsum("ni,nj->nij", line, one) + np.einsum("ni,nj->nij", one, line) for one in others]
    points, there = common_points(np.stack(conics, axis=1))
    whole = there[:, 2]
    assert whole.all() and not there[:, 3].any()
    off = np.abs(np.einsum("nki,ni->nk", points, line / np.linalg.norm(line, axis=1)[:, None]))
    assert there[:, 1].all() and off[:, :2].max() < 1e-9
    besides = np.cross(*others)
    besides /= np.linalg.norm(besides, axis=1)[:, None]
    assert np.abs(np.cross(points[whole, 2], besides[whole])).max() < 1e-9


def test_of_a_shared_line_that_meets_the_others_where_they_meet_two_points_are_told():
    rng = np.random.default_rng(9)
    line, one, share = *rng.normal(size=(2, 100, 3)), rng.normal(size=(100, 1))
    # Three lines through one point, and a shared line that counts twice in the second conic.
    for other in (one + share * line, line):
        conics = [np.einsum("ni,nj->nij", line, each) + np.einsum("ni,nj->nij", each, line) for each in (one, other)]
        points, there = common_points(np.stack(conics, axis=1))
        assert there.tolist() == [[True, True, False, False]] * 100
        assert np.abs(np.einsum("nki,ni->nk", points[:, :2], line)).max() < 1e-9
