"""Largest velocity, acceleration and jerk of a segment, and as multiples of its rise and angle: Cv, Ca, Cj."""

from __future__ import annotations

import numpy as np

from ...core.records import record


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
