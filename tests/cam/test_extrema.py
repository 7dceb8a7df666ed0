"""Largest values between samples, against a closer look at all places."""

import numpy as np
import pytest

from geomkin.cam.program.laws import exceeds, highest, highest_between, largest, samples

BREAKS = np.array([0.0, 0.7, 1.1, 3.0, 2 * np.pi])


def hills(seed):
    """A smooth function with a hill or two in each stretch, and a jump at each break."""
    rng = np.random.default_rng(seed)
    jumps, rates, shifts = rng.uniform(-1, 1, (3, len(BREAKS)))

    def f(t):
        k = np.minimum(np.searchsorted(BREAKS, t, side="right") - 1, len(BREAKS) - 2)
        return jumps[k] + np.sin(9 * (1 + rates[k] / 3) * t + 4 * shifts[k]) + 0.3 * np.cos(3 * t)

    return f


@pytest.mark.parametrize("seed", range(2))
def test_largest_agrees_with_a_dense_sample(seed):
    f = hills(seed)
    top, where = largest(BREAKS, f)
    tops, places = highest(BREAKS, f)
    looked = []
    for low, high in zip(BREAKS, BREAKS[1:]):
        t = np.linspace(low, np.nextafter(high, low), 100_001)
        looked.append((f(t).max(), t[f(t).argmax()]))
    values, at = np.transpose(looked)
    assert (tops >= values).all() and tops == pytest.approx(values, abs=5e-8)
    assert np.abs(places - at).max() < 1e-4 and (BREAKS[:-1] <= places).all() and (places <= BREAKS[1:]).all()
    assert (top, where) == (tops.max(), places[tops.argmax()])
    turned = highest_between(BREAKS[1:3], BREAKS[2:4], f)
    assert turned[0].tolist() == tops[1:3].tolist()


@pytest.mark.parametrize("seed", range(2))
def test_exceeds(seed):
    f = hills(seed)
    top, _ = largest(BREAKS, f)
    places = samples(BREAKS)
    values = f(places)
    # Between the highest sample and the top only a closer look shows it.
    between = 0.5 * (values.max() + top)
    assert values.max() < between < top
    for limit, above in (
        (values.max() - 0.1, True), (between, True), (top - 1e-12, True), (top + 1e-12, False), (top + 1, False),
    ):  # fmt: skip
        assert exceeds(places, values, f, limit) is above
    unknown = np.where(np.arange(values.size).reshape(values.shape) == 5, np.nan, values)
    assert exceeds(places, unknown, f, top + 1)


@pytest.mark.parametrize(("stretches", "each"), [(256, 256), (512, 128), (5000, 48)])
def test_samples(stretches, each):
    breaks = np.linspace(0, 2 * np.pi, stretches + 1)
    places = samples(breaks)
    assert places.shape == (stretches, each)
    assert (places[:, 0] == breaks[:-1]).all()
    assert (places[:, -1] < breaks[1:]).all() and places[:, -1] == pytest.approx(breaks[1:], rel=1e-14)
    assert (np.diff(places, axis=1) > 0).all()
