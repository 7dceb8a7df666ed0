"""The largest value of a function that is smooth between breaks: seen on samples, then climbed to."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..plane.vec import Real

# Places looked at in each stretch. What a segment's law does between two of them is one hill at most; fewer may miss
# a hill, more take as much longer.
SAMPLES = 256
# Where stretches are so many that all together would have more places than TOGETHER, each gets fewer, but no fewer than
# FEWEST. Less would see too little of a spline among many dwells, more takes seconds.
TOGETHER, FEWEST = 256 * 256, 48
# Each look narrows the hill to a sixteenth; after seven a cam angle is known to 1e-9 rad and, a hill being
# flat at its top, the value to rounding.
LOOKS, FINE = 7, 33


def samples(breaks: Real) -> Real:
    """Places (segments, SAMPLES or fewer) that see every segment finely and every joint from both sides."""
    return _samples_between(breaks[:-1], breaks[1:])


def _samples_between(low: Real, high: Real) -> Real:
    count = min(SAMPLES, max(FEWEST, TOGETHER // max(len(low), 1)))
    inside = low[:, None] + (high - low)[:, None] * np.linspace(0, 1, count)
    inside[:, -1] = np.nextafter(high, -np.inf)
    return inside


def highest(breaks: Real, f: Callable[[Real], Real]) -> tuple[Real, Real]:
    """The largest value of f in each segment, and where; at joints from the segment's own side."""
    return highest_between(breaks[:-1], breaks[1:], f)


def highest_between(low: Real, high: Real, f: Callable[[Real], Real]) -> tuple[Real, Real]:
    """The largest value of f, smooth there, between each `low` and `high`, and where; at `high` from below."""
    places = _samples_between(low, high)
    _, before, after = _hills(places, f(places))
    return climb(before, after, f)


def _hills(places: Real, values: Real) -> tuple[Real, Real, Real]:
    """Of each row of samples: what the hill at its highest sample stays below, and the places on both sides of it."""
    top = values.argmax(axis=1)[:, None]
    sides = np.maximum(top - 1, 0), np.minimum(top + 1, places.shape[1] - 1)
    one, other = (np.take_along_axis(values, side, 1)[:, 0] for side in sides)
    # A parabola through three samples rises above the middle one by an eighth of its fall to the sides at most: eight
    # times as much is allowed.
    most = np.take_along_axis(values, top, 1)[:, 0]
    before, after = (np.take_along_axis(places, side, 1)[:, 0] for side in sides)
    with np.errstate(invalid="ignore"):
        return 2 * most - np.minimum(one, other), before, after


def climb(low: Real, high: Real, f: Callable[[Real], Real]) -> tuple[Real, Real]:
    """The top of the one hill of f between each `low` and `high`: its value and its place."""
    for _ in range(LOOKS):
        # Rounding may put the last place beyond `high`, across a joint.
        places = np.minimum(low[:, None] + (high - low)[:, None] * np.linspace(0, 1, FINE), high[:, None])
        values = f(places)
        top = values.argmax(axis=1)[:, None]
        low = np.take_along_axis(places, np.maximum(top - 1, 0), 1)[:, 0]
        high = np.take_along_axis(places, np.minimum(top + 1, FINE - 1), 1)[:, 0]
    return np.take_along_axis(values, top, 1)[:, 0], np.take_along_axis(places, top, 1)[:, 0]


def exceeds(places: Real, values: Real, f: Callable[[Real], Real], limit: float) -> bool:
    """Whether f is above a limit anywhere, or unknown; places, values: its samples, as `samples` gives them."""
    if not values.max() <= limit:
        return True
    most, before, after = _hills(places, values)
    # Only those hills are climbed that may reach over the limit: most often none or one.
    may = ~(most <= limit)
    return bool(may.any()) and not climb(before[may], after[may], f)[0].max() <= limit


def largest(breaks: Real, f: Callable[[Real], Real]) -> tuple[float, float]:
    """The largest value of f over all segments, and where."""
    places = samples(breaks)
    values = f(places)
    most, before, after = _hills(places, values)
    # Most stretches are clearly lower: only those that may hold the largest value are climbed.
    may = ~(most < values.max())
    tops, where = climb(before[may], after[may], f)
    k = int(tops.argmax())
    return float(tops[k]), float(where[k])
