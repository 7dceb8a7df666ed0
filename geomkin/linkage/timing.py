"""Speed and acceleration of the driver, by which kinematic coefficients become rates."""

from __future__ import annotations

from typing import TypeVar

import numpy as np

from ..core.records import record
from ..plane.vec import Complex, Real

Numbers = TypeVar("Numbers", Real, Complex)


@record(eq=False)
class Timing:
    """Speed and acceleration of the driver: rad/s and rad/s2, or mm/s and mm/s2 if a slider drives.

    Parameters
    ----------
    speed, acceleration : array
        One number, or one value for each frame.
    """

    speed: Real
    acceleration: Real

    def elapsed(self, drive: Real) -> Real:
        """Time since the first drive, s, (frames,); nan if the speed is 0 or changes."""
        constant = not self.speed.ndim and self.speed != 0 and not np.any(self.acceleration)
        # + 0.0 turns the -0.0 of a clockwise driver into 0.0.
        return (drive - drive[:1]) / (self.speed if constant else np.nan) + 0.0

    @property
    def steady(self) -> bool:
        """Whether the speed is one constant number."""
        return not self.acceleration.ndim and not self.acceleration.item()

    def rate(self, first: Numbers) -> Numbers:
        """d/dt of a quantity, from its first kinematic coefficient."""
        with np.errstate(invalid="ignore"):
            return first * self.speed

    def second_rate(self, first: Numbers, second: Numbers) -> Numbers:
        """d2/dt2 of a quantity, from its first and second kinematic coefficients."""
        with np.errstate(invalid="ignore", over="ignore"):
            rate = second * self.speed**2
            return rate if self.steady else rate + first * self.acceleration
