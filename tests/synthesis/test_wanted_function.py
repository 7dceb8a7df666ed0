"""What function is wanted: its shares, its rows, its poles and jumps; and the peaks of an error, by dense samples."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.synthesis.function.search import AtPeaks, peaks
from geomkin.synthesis.function.wanted import wanted_function


@pytest.mark.parametrize("span", [(1, 4), (-2, -0.5), (1e6, 1e6 + 1)])
def test_shares_go_from_0_to_1_in_proportion(span):
    for f in ("3 - 2*x", lambda x: 3 - 2 * x, lambda x: float(3 - 2 * x), [(span[0], 7), (span[1], 5)]):
        wanted = wanted_function(f, span)
        s = np.array([[0, 0.25], [0.5, 1]])
        assert wanted.x(s) == pytest.approx(span[0] + s * (span[1] - span[0]))
        assert wanted.share(s) == pytest.approx(s, abs=1e-8)
    falling = wanted_function(np.cos, (0, 2))
    assert falling.share(np.array([0.0, 1.0])).tolist() == [0, 1] and (falling.y0, falling.y1) == (1, np.cos(2))
    assert falling.share(np.array(0.5)) == pytest.approx((1 - np.cos(1)) / (1 - np.cos(2)))


@pytest.mark.parametrize("scale", [1.0, 1e-6, 1e4])
def test_rows_of_a_cubic_give_that_cubic_back_wherever_they_lie(scale):
    def cubic(x):
        return scale * (x**3 - 4 * x**2 + x + 3)

    x = np.array([-1.0, -0.4, 0.3, 0.9, 2.0, 2.2])
    wanted = wanted_function(np.transpose([x, cubic(x)]), (-0.7, 2.1))
    at = np.linspace(-0.7, 2.1, 50)
    assert wanted.f(at) == pytest.approx(cubic(at), rel=1e-5, abs=1e-5 * scale)


@pytest.mark.parametrize(
    ("f", "span", "place"),
    [
        ("tan(x)", (0, 3), np.pi / 2), ("tan(x)", (1, 3), np.pi / 2), ("1/(x - 0.7)", (-1, 1), 0.7), ("1/(x - 0.3)**2", (-1, 1), 0.3),
        ("-1/(x - 0.3)**2", (0, 1), 0.3), (lambda x: np.floor(x), (0.5, 1.5), 1), (lambda x: -np.floor(3 * x), (0.5, 0.8), 2 / 3),
        (lambda x: x + 0.02 * (x > 0.41), (0, 1), 0.41), (lambda x: x - 0.02 * (x > 0.11), (0, 1), 0.11),
        (lambda x: x + 0.02 * (x >= 1), (0, 1), 1), (lambda x: x - 0.02 * (x <= 0), (0, 1), 0), (lambda x: np.sign(x) + x, (-1, 2), 0),
    ],
)  # fmt: skip
def test_poles_and_jumps_are_reported_with_their_position(f, span, place):
    with pytest.raises(gk.DesignError) as refused:
        wanted_function(f, span)
    reported = float(refused.value.problem.rpartition(" ")[2])
    assert reported == pytest.approx(place, abs=1e-4)


@pytest.mark.parametrize(
    ("f", "span", "field"),
    [
        ("log(x)", (0, 1), "function"),
        ("sqrt(0.5 - x)", (0, 1), "function"),
        (lambda x: 1 / (x - 1), (0, 1), "function"),
        (lambda x: [][int(x)], (0, 1), "function"),
        ("3 + 0*x", (0, 1), "function"),
        ("sin(x)", (0, 2 * np.pi), "function"),
        ("x", (1, 1), "span"),
        ("x", (2, 1), "span"),
        ("x", (1e9, 1e9 + 1e-4), "span"),
        ([(0, 1)], (0, 1), "function"),
        ([(0, 1), (1, 2), (1, 3), (2, 4)], (0, 1), "function"),
        ([(0, 1), (2, 2), (1, 3), (3, 4)], (0, 1), "function"),
        ([(0, 1), (1, 2)], (-0.1, 1), "span"),
        ([(0, 1), (1, 2), (3, 5)], (0, 3.1), "span"),
    ],
)
def test_invalid_function_is_refused(f, span, field):
    with pytest.raises(gk.DesignError) as refused:
        wanted_function(f, span)
    assert refused.value.field == field


class Waves:
    """Errors of three candidates: waves whose peaks rise, fall, or stand at the ends."""

    def error(self, p, s):
        return np.cos(p[:, :1] * s + p[:, 1:2]) * (1 + p[:, 2:] * s)


P = np.array([[17.0, 0.4, 0.5], [11.0, -1.3, -0.4], [2.0, -0.3, 0.0]])


@pytest.mark.parametrize("most", [2, 4, 9])
def test_peaks_are_the_largest_of_dense_samples_in_their_order(most):
    dense = np.linspace(0, 1, 200_001)
    place, error, real = peaks(Waves(), P, most, 200)
    assert place.shape == error.shape == real.shape == (3, most)
    assert Waves().error(P, place) == pytest.approx(error)
    for k, size in enumerate(np.abs(Waves().error(P, dense[None]))):
        padded = np.concatenate([[-1], size, [-1]])
        top = np.flatnonzero((size >= padded[:-2]) & (size > padded[2:]))
        largest = np.sort(top[np.argsort(-size[top])[:most]])
        assert real[k].sum() == len(largest)
        assert place[k][real[k]] == pytest.approx(dense[largest], abs=1e-5)
        assert np.abs(error[k][real[k]]) == pytest.approx(size[largest], rel=1e-9)
        assert (np.diff(place[k][real[k]]) > 0).all() and (place[k][~real[k]] == 0).all()


def test_places_move_to_their_peaks_but_for_those_that_are_fixed():
    task = AtPeaks(Waves(), 2)
    place, error, real = peaks(Waves(), P, 3, 200)
    assert real[:2].all()
    shifted = np.hstack([np.full((3, 2), [[0.1, 0.9]]), np.clip(place + 1.5e-3, 0, 1)])
    moved = task._moved(P, shifted)
    assert (moved[:, :2] == [[0.1, 0.9]]).all()
    assert moved[:2, 2:] == pytest.approx(place[:2], abs=1e-6)
    assert task.error(P, shifted)[:2, 2:] == pytest.approx(error[:2], rel=1e-9)
    assert task.error(P, np.array([[0.1, 0.9, 0.5]]))[:, :2] == pytest.approx(Waves().error(P, np.array([[0.1, 0.9]])))
