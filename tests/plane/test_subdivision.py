"""Places spread so that all intervals have the same error, where the right answer is known in closed form."""

import numpy as np
import pytest

from geomkin.plane.flatten import MOST_TURN, Intervals, adaptive_subdivision

DENSITIES = {
    "even": lambda t: t,
    "wavy": lambda t: t + 0.9 * np.sin(t),
    "steep": lambda t: np.expm1(t) / 20,
    "a jump at a break": lambda t: np.where(t < np.pi, t, np.pi + 4 * (t - np.pi)),
}
BREAKS = np.array([0, np.pi, 2 * np.pi])


def design_checks(density, order):
    """Error of an interval: the order-th power of the density's integral over it; nothing turns."""

    def judge(intervals):
        low, high, _ = intervals
        return (density(high) - density(low)) ** order, np.zeros(len(low))

    return judge


@pytest.mark.parametrize("order", [2, 3])
@pytest.mark.parametrize("tolerance", [1e-4])
@pytest.mark.parametrize("name", DENSITIES)
def test_intervals_are_few_and_of_equal_error(name, tolerance, order):
    density = DENSITIES[name]
    judge = design_checks(density, order)
    (edges,) = adaptive_subdivision(judge, [BREAKS], tolerance, order)
    assert edges[0] == 0 and edges[-1] == 2 * np.pi and (np.diff(edges) > 0).all()
    error, _ = judge(Intervals(edges[:-1], edges[1:], np.array([0])))
    assert error.max() <= tolerance
    fewest = (density(BREAKS[-1]) - density(BREAKS[0])) / tolerance ** (1 / order)
    # An aim of 0.2 % below the tolerance, half a percent that looks are spared for, and whole numbers of intervals.
    assert len(error) <= np.ceil(fewest * 1.007) + 1
    shares = error ** (1 / order)
    assert shares.max() < 1.1 * shares.min() or len(error) < 5


@pytest.mark.parametrize("turn", [1.0, 50.0])
def test_pieces_without_error_are_divided_by_their_turn(turn):
    def judge(intervals):
        return np.zeros(len(intervals.low)), (intervals.high - intervals.low) * turn

    (edges,) = adaptive_subdivision(judge, [np.array([0.0, 1.0])], 1e-3, 2)
    assert len(edges) - 1 == np.ceil(turn / MOST_TURN)
    assert np.ptp(np.diff(edges)) < 1e-6


@pytest.mark.parametrize("tolerance", [1e-3])
def test_runs_together_equal_runs_one_by_one(tolerance):
    judge, looks = design_checks(DENSITIES["wavy"], 2), []

    def counted(intervals):
        looks.append(len(intervals.first))
        return judge(intervals)

    runs = [np.linspace(low, low + 0.3, 1 + count) for low, count in zip(np.arange(20) * 0.3, [1, 2, 3, 1] * 5)]
    together = adaptive_subdivision(counted, runs, tolerance, 2)
    alone = len(looks)
    for run, edges in zip(runs, together):
        assert np.array_equal(adaptive_subdivision(counted, [run], tolerance, 2)[0], edges)
    assert looks[0] == 20 and len(looks) - alone > 4 * alone
