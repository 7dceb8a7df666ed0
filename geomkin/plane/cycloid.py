"""The curves of a point on a circle that rolls on a circle: epicycloid and hypocycloid."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import Positive, check_fields
from ..errors import DesignError
from .curve import AbstractCurve
from .vec import Array


@dataclass(frozen=True, eq=False)
class Cycloid(AbstractCurve):
    """The path of a rim point of a circle that rolls counterclockwise round a circle about the origin.

    radius r of the fixed circle, mm; `rolling` radius g, mm, above 0 outside it (epicycloid), below 0 inside
    it (hypocycloid; -r / 2 gives a diameter). t is the angle of the rolling contact, rad, from `start` to
    `end`; 0 at the cusp on +x, the next one at 2 pi |g| / r.
    """

    radius: Positive
    rolling: float
    start: float
    end: float

    def __post_init__(self) -> None:
        check_fields(self)
        if not self.rolling:
            raise DesignError("rolling", "found 0", "give a radius above 0 to roll outside, below 0 to roll inside")

    def point(self, t: ArrayLike) -> Array:
        t = np.asarray(t, dtype=float)
        return np.exp(1j * t) * (self.radius + self.rolling * (1 - np.exp(1j * t * self.radius / self.rolling)))

    def velocity(self, t: ArrayLike) -> Array:
        """The rim point turns about the rolling contact."""
        t = np.asarray(t, dtype=float)
        half = t * self.radius / (2 * self.rolling)
        return 2 * (self.radius + self.rolling) * np.sin(half) * np.exp(1j * (t + half))

    def curvature(self, t: ArrayLike) -> Array:
        r, g = self.radius, self.rolling
        speed = np.abs(2 * (r + g) * np.sin(np.asarray(t, dtype=float) * r / (2 * g)))
        with np.errstate(divide="ignore", invalid="ignore"):
            return (1 + r / (2 * g)) / speed

    @property
    def breaks(self) -> Array:
        return np.array([self.start, self.end])

    @property
    def closed(self) -> bool:
        return False
