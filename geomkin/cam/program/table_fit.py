"""A curve near the rows of a table, and whether what it makes of them is motion or their scatter."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...plane.vec import Array
from .laws import Law
from .smoothest import smoothest_within
from .spline import Ends, spline_through

# Neighbouring rows held against a polynomial of the fifth degree: fewer take the motion for scatter, more see less.
WINDOW = 7
# Rows below which their scatter cannot be told.
FEWEST = 24
# A band of so many standard deviations holds nearly all rows.
WIDE = 3.0
# Where every second row scatters so many times as much, it is the motion that is seen, in too few rows.
MOTION = 3.0
# Rows looked at between rows for the largest acceleration.
LOOKS = 8


@dataclass(frozen=True, eq=False)
class TableFit:
    """Lifts (n,), mm or deg, at rising x (n,) from 0 to 1, and how far a curve may stay from them.

    ends: slope and curvature by x at both ends, None where it closes on itself. within: 0 for a curve through all.
    """

    x: Array
    lifts: Array
    ends: Ends
    within: float

    @cached_property
    def law(self) -> Law:
        """The smoothest curve within the band; through all rows where there is none, or no spline is found in it."""
        return self._near(self.within)

    def _near(self, within: float) -> Law:
        smooth = smoothest_within(self.x, self.lifts, self.ends, within) if within > 0 else None
        return smooth or spline_through(self.x, self.lifts, self.ends)

    @cached_property
    def scatter(self) -> float:
        """Standard deviation, mm or deg, by which the rows scatter about a smooth motion.

        By what rows next to each other miss polynomials of the fifth degree. nan where that cannot be told: of
        few rows, or of rows so far apart that the motion itself does not look smooth in them.
        """
        if len(self.x) < FEWEST:
            return np.nan
        fine, coarse = (_scatter(self.x[::k], self.lifts[::k]) for k in (1, 2))
        return fine if coarse <= MOTION * fine or fine <= 1e-12 * float(np.ptp(self.lifts)) else np.nan

    @property
    def wide(self) -> float:
        """A band, mm or deg, in which a curve need not follow the scatter."""
        return WIDE * self.scatter

    @cached_property
    def noise(self) -> float:
        """How much of the acceleration is scatter of the rows, as a share of the motion's peak.

        The largest difference from the smoothest curve in a band as wide as the rows scatter. nan as for `scatter`.
        """
        if not self.wide > self.within:
            return 0.0 * self.scatter
        step = np.diff(self.x)[:, None] * np.arange(LOOKS) / LOOKS
        places = (self.x[:-1, None] + step).ravel()
        motion, curve = (np.asarray(law(places))[2] for law in (self._near(self.wide), self.law))
        peak = float(np.abs(motion).max())
        return float(np.abs(curve - motion).max()) / peak if peak > 0 else np.nan


def _scatter(x: Array, lifts: Array) -> float:
    """Standard deviation of what no polynomial of the fifth degree explains: of the upper quarter of all windows.

    Half of the rows may be a dwell that is known exactly, and joints of the motion are few.
    """
    number = np.arange(len(x) - WINDOW + 1)[:, None] + np.arange(WINDOW)
    at = x[number] - x[number[:, :1]]
    at = at / at[:, -1:]
    apart = at[:, :, None] - at[:, None, :] + np.eye(WINDOW)
    # Divided differences, which leave nothing of such a polynomial; their squares add up to 1.
    weights = 1 / np.prod(apart, axis=2)
    weights /= np.sqrt(np.sum(weights**2, axis=1))[:, None]
    missed = np.abs(np.sum(weights * lifts[number], axis=1))
    # Three quarters of normal errors are below 1.1503 standard deviations.
    return float(np.quantile(missed, 0.75)) / 1.1503
