"""What families choose among: the best linkage within limits, one by one by the library's own motion."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.tradeoff.families import function_synthesis as functions

WANTED = functions.problem()
PLACES = np.linspace(0, 1, functions.FEW)


def design_checks(a, b, c, start, output_start, branch):
    """Largest error, rad, and least transmission angle, deg, and ratio of links; None where it cannot be."""
    try:
        motion = gk.move(gk.FourBar(1.0, a, b, c), start + WANTED.swing * PLACES, int(branch))
    except gk.DesignError:
        return None
    if not motion.assembled.all():
        return None
    right = np.exp(1j * (output_start + WANTED.out * np.log2(1 + PLACES)))
    error = np.abs(np.angle(motion.rocker.direction / right)).max()
    links = (1.0, a, b, c)
    return error, np.degrees(np.min(motion.transmission_angle)), max(links) / min(links)


def drawn(seed, count):
    numbers = np.random.default_rng(seed)
    lengths = 10 ** numbers.uniform(-1.2, 0.6, (3, count))
    return np.concatenate([lengths, numbers.uniform(0, 2 * np.pi, (2, count)), numbers.choice([-1.0, 1.0], (1, count))])


@pytest.mark.parametrize("seed", range(2))
def test_of_many_four_bars_the_one_is_chosen_that_errs_least_within_the_limits(seed):
    found = drawn(seed, 120)
    known = [design_checks(*row) for row in found.T.tolist()]
    limits = [one is not None and (one[1] >= 30, one[2] <= 10) for one in known]
    kept = [k for k, one in enumerate(limits) if one and all(one)]
    best = min(kept, key=lambda k: known[k][0])
    assert functions._best(WANTED, found) == pytest.approx(found[:, best])
    # Each limit keeps some out, and the wider of both would choose otherwise in one draw or the other.
    assert any(one and not one[0] for one in limits) and any(one and not one[1] for one in limits)
    others = np.delete(np.arange(120), kept)
    assert np.isnan(functions._best(WANTED, found[:, others])).all()
    assert functions._best(WANTED, found[:, [*others, best]]) == pytest.approx(found[:, best])
