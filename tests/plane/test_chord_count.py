"""Few chords: against a greedy walker, who always steps as far as the tolerance lets one."""

import numpy as np
import pytest

from geomkin.plane.flatten import flatten

from .curves import Flower, examples, flank, off_chord


def reach(curve, start, tolerance, guess):
    """Farthest parameter to which one chord from `start` keeps the tolerance, by bisection."""
    end = curve.breaks[-1]

    def kept(t):
        probes = start + (t - start) * np.linspace(0, 1, 34)[1:-1]
        return off_chord(curve.point(start), curve.point(t), curve.point(probes)).max() <= tolerance

    low, high = start, min(start + guess, end)
    while kept(high):
        if high == end:
            return end
        low, high = high, min(start + 1.3 * (high - start), end)
    for _ in range(18):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if kept(middle) else (low, middle)
    return low


def fewest_chords(curve, tolerance):
    """Chords of a greedy walker, who always steps as far as the tolerance lets one: none can do with fewer."""
    t, count, step = curve.breaks[0], 0, np.ptp(curve.breaks) / 50
    while t < curve.breaks[-1]:
        after = reach(curve, t, tolerance, step)
        t, count, step = after, count + 1, after - t
    return count


@pytest.mark.parametrize(
    "curve, tolerances",
    [
        (flank(), (1e-2,)),
        (examples()["bezier"], (1e-2,)),
        (Flower(3.0, 1), (1e-3,)),
        (examples()["offset outline"], (1e-3,)),
    ],
    ids=["flank", "zigzag", "flower", "slot"],
)
def test_no_more_chords_than_needed(curve, tolerances):
    for tolerance in tolerances:
        chords = len(flatten(curve, tolerance)) - (not curve.closed)
        # The flower has ten inflections, where how far a chord reaches depends on where it starts.
        assert chords <= (1.08 if isinstance(curve, Flower) else 1.03) * fewest_chords(curve, tolerance) + 1
