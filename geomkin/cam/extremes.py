"""The largest value of a function that is smooth between breaks."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..plane.vec import Array

# Places looked at in each segment. What a segment's law does between two of them is one hill at most.
SAMPLES = 256
# Each look narrows the hill to a sixteenth; after seven a cam angle is known to 1e-9 rad and, a hill being
# flat at its top, the value to rounding.
LOOKS, FINE = 7, 33


def samples(breaks: Array) -> Array:
    """Places (segments, SAMPLES) that see every segment finely and every joint from both sides."""
    return _samples_between(breaks[:-1], breaks[1:])


def _samples_between(low: Array, high: Array) -> Array:
    inside = low[:, None] + (high - low)[:, None] * np.linspace(0, 1, SAMPLES)
    inside[:, -1] = np.nextafter(high, -np.inf)
    return inside


def highest(breaks: Array, f: Callable[[Array], Array]) -> tuple[Array, Array]:
    """The largest value of f in each segment, and where; at joints from the segment's own side."""
    return highest_between(breaks[:-1], breaks[1:], f)


def highest_between(low: Array, high: Array, f: Callable[[Array], Array]) -> tuple[Array, Array]:
    """The largest value of f, smooth there, between each `low` and `high`, and where; at `high` from below."""
    places = _samples_between(low, high)
    values = f(places)
    top = values.argmax(axis=1)[:, None]
    return climb(
        np.take_along_axis(places, np.maximum(top - 1, 0), 1)[:, 0],
        np.take_along_axis(places, np.minimum(top + 1, SAMPLES - 1), 1)[:, 0],
        f,
    )


def climb(low: Array, high: Array, f: Callable[[Array], Array]) -> tuple[Array, Array]:
    """The top of the one hill of f between each `low` and `high`: its value and its place."""
    for _ in range(LOOKS):
        # The last of them may round to beyond `high`, where a joint lies.
        places = np.minimum(low[:, None] + (high - low)[:, None] * np.linspace(0, 1, FINE), high[:, None])
        values = f(places)
        top = values.argmax(axis=1)[:, None]
        low = np.take_along_axis(places, np.maximum(top - 1, 0), 1)[:, 0]
        high = np.take_along_axis(places, np.minimum(top + 1, FINE - 1), 1)[:, 0]
    return np.take_along_axis(values, top, 1)[:, 0], np.take_along_axis(places, top, 1)[:, 0]


def largest(breaks: Array, f: Callable[[Array], Array]) -> tuple[float, float]:
    """The largest value of f over all segments, and where."""
    values, places = highest(breaks, f)
    k = int(values.argmax())
    return float(values[k]), float(places[k])
