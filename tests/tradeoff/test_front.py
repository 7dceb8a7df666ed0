"""The Pareto front against its definition, point by point."""

import numpy as np
import pytest

import geomkin as gk


def beaten(k, seconds, errors):
    """Whether some point is as good as the k-th in both and better in one."""
    known = np.isfinite(seconds) & np.isfinite(errors)
    as_good = known & (seconds <= seconds[k]) & (errors <= errors[k])
    return bool((as_good & ((seconds < seconds[k]) | (errors < errors[k]))).any())


@pytest.mark.parametrize("seed", range(4))
def test_front_is_the_set_of_undominated_points(seed):
    """Of whole numbers, so that points are equal in one or in both; some are unknown."""
    numbers = np.random.default_rng(seed)
    seconds, errors = numbers.integers(0, 8, (2, 30)).astype(float)
    errors[numbers.random(30) < 0.1] = np.nan
    seconds[numbers.random(30) < 0.1] = np.inf
    known = np.isfinite(seconds) & np.isfinite(errors)
    front = gk.tradeoff.pareto_front(seconds, errors)
    assert front.tolist() == [bool(known[k]) and not beaten(k, seconds, errors) for k in range(30)]
    assert front.any()
