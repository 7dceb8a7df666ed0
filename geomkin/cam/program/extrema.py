"""The largest value of a function that is smooth between breaks, and the peaks of a segment's motion."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...core.records import record
from ...plane.vec import TIED, Real, first_largest

# Samples in each stretch. A segment's law has at most one peak between two of them. Fewer may miss a peak; more take
# proportionally longer.
SAMPLES = 256
# If all stretches together would have more than TOGETHER samples, each gets fewer, but at least FEWEST. Smaller values
# miss detail of a spline among many dwells; larger ones take seconds.
TOGETHER, FEWEST = 256 * 256, 48
# Each refinement narrows the interval of a peak to one sixteenth. After seven the cam angle is exact to 1e-9 rad and
# the value, which is stationary at a peak, to rounding.
REFINEMENTS, FINE = 7, 33


def samples(breaks: Real) -> Real:
    """Parameters, shape (segments, SAMPLES or fewer), that resolve every segment and both sides of every joint."""
    return _samples_between(breaks[:-1], breaks[1:])


def _samples_between(low: Real, high: Real) -> Real:
    count = min(SAMPLES, max(FEWEST, TOGETHER // max(len(low), 1)))
    inside = low[:, None] + (high - low)[:, None] * np.linspace(0, 1, count)
    inside[:, -1] = np.nextafter(high, -np.inf)
    return inside


def highest(breaks: Real, f: Callable[[Real], Real]) -> tuple[Real, Real]:
    """The largest value of f in each segment and its parameter; at a joint the segment's own side counts."""
    return highest_between(breaks[:-1], breaks[1:], f)


def highest_between(low: Real, high: Real, f: Callable[[Real], Real]) -> tuple[Real, Real]:
    """The largest value of f, and its parameter, between each `low` and `high` (excluded), where f is smooth."""
    places = _samples_between(low, high)
    _, before, after = _peak_bounds(places, f(places))
    return refine_peak(before, after, f)


def _peak_bounds(places: Real, values: Real) -> tuple[Real, Real, Real]:
    """For each row of samples: an upper bound of its peak, and the samples before and after the highest one."""
    top = values.argmax(axis=1)[:, None]
    most = np.take_along_axis(values, top, 1)
    with np.errstate(invalid="ignore"):
        tied = values >= most - TIED * np.abs(most)
    # The first of equally high ones, so that all processors give the same.
    top = np.where(tied.any(axis=1, keepdims=True), tied.argmax(axis=1)[:, None], top)
    sides = np.maximum(top - 1, 0), np.minimum(top + 1, places.shape[1] - 1)
    left, right = (np.take_along_axis(values, side, 1)[:, 0] for side in sides)
    # A parabola through three samples exceeds the middle one by at most an eighth of the drop to the sides; eight times
    # that is allowed for.
    highest_sample = np.take_along_axis(values, top, 1)[:, 0]
    before, after = (np.take_along_axis(places, side, 1)[:, 0] for side in sides)
    with np.errstate(invalid="ignore"):
        return 2 * highest_sample - np.minimum(left, right), before, after


def refine_peak(low: Real, high: Real, f: Callable[[Real], Real]) -> tuple[Real, Real]:
    """Value and parameter of the single peak of f between each `low` and `high`."""
    for _ in range(REFINEMENTS):
        # Rounding may put the last sample beyond `high`, across a joint.
        places = np.minimum(low[:, None] + (high - low)[:, None] * np.linspace(0, 1, FINE), high[:, None])
        values = f(places)
        top = values.argmax(axis=1)[:, None]
        low = np.take_along_axis(places, np.maximum(top - 1, 0), 1)[:, 0]
        high = np.take_along_axis(places, np.minimum(top + 1, FINE - 1), 1)[:, 0]
    return np.take_along_axis(values, top, 1)[:, 0], np.take_along_axis(places, top, 1)[:, 0]


def exceeds(places: Real, values: Real, f: Callable[[Real], Real], limit: float) -> bool:
    """Whether f exceeds a limit or is nan anywhere; `places` and `values` are its samples, as of `samples`."""
    if not values.max() <= limit:
        return True
    bounds, before, after = _peak_bounds(places, values)
    # Only peaks that may exceed the limit are refined: usually none or one.
    may = ~(bounds <= limit)
    return bool(may.any()) and not refine_peak(before[may], after[may], f)[0].max() <= limit


def largest(breaks: Real, f: Callable[[Real], Real]) -> tuple[float, float]:
    """The largest value of f over all segments, and its parameter."""
    places = samples(breaks)
    values = f(places)
    bounds, before, after = _peak_bounds(places, values)
    # Most stretches are clearly lower: only those that may hold the largest value are refined.
    most = values.max()
    with np.errstate(invalid="ignore"):
        may = ~(bounds < most - TIED * np.abs(most))
    tops, where = refine_peak(before[may], after[may], f)
    return float(tops.max()), float(where[first_largest(tops)])


@record(eq=False)
class SegmentPeaks:
    """Largest sizes of a segment's velocity, acceleration and jerk by cam angle, its joints included.

    Parameters
    ----------
    velocity, acceleration, jerk : float
        mm/rad, mm/rad2 and mm/rad3; for an oscillating follower rad/rad, rad/rad2 and rad/rad3. The acceleration is inf
        if the velocity jumps inside the segment or at one of its ends, the jerk if velocity or acceleration does. A
        jump at an end counts only for a segment whose value there is not 0: a dwell next to a harmonic rise has none,
        nor has a cycloidal return that follows it.
    rise : float
        Lift at its end less that at its start, mm or rad.
    angle : float
        Range of cam angles of the segment, rad.

    Notes
    -----
    Source: the factors are those of VDI 2143 Blatt 1 (1980) and of Norton, Cam Design and Manufacturing Handbook.
    """

    velocity: float
    acceleration: float
    jerk: float
    rise: float
    angle: float

    @property
    def factors(self) -> tuple[float, float, float]:
        """Cv, Ca, Cj: the peaks as multiples of rise / angle, rise / angle^2 and rise / angle^3; nan without a rise."""
        if not self.rise:
            return np.nan, np.nan, np.nan
        by = abs(self.rise)
        peaks = self.velocity, self.acceleration, self.jerk
        cv, ca, cj = (peak * self.angle**k / by for k, peak in enumerate(peaks, 1))
        return cv, ca, cj
