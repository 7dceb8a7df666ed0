"""Curves traced by a line that rolls on a circle: the involute, and the trochoid under a rounded corner."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import Positive, check_fields
from .curve import AbstractCurve
from .vec import Array


@dataclass(frozen=True, eq=False)
class Involute(AbstractCurve):
    """The path of the end of a taut string unwound counterclockwise from a circle about the origin.

    base_radius, mm; t is the roll angle in rad from `start` to `end` (0 <= start), 0 at the cusp on
    +x. The radius at t is base_radius sqrt(1 + t^2), and t is the tangent of the pressure angle there.
    """

    base_radius: Positive
    start: float
    end: float

    def __post_init__(self) -> None:
        check_fields(self)

    def point(self, t: ArrayLike) -> Array:
        t = np.asarray(t, dtype=float)
        return self.base_radius * (1 - 1j * t) * np.exp(1j * t)

    def velocity(self, t: ArrayLike) -> Array:
        t = np.asarray(t, dtype=float)
        return self.base_radius * t * np.exp(1j * t)

    def curvature(self, t: ArrayLike) -> Array:
        with np.errstate(divide="ignore"):
            return 1 / (self.base_radius * np.asarray(t, dtype=float))

    @property
    def breaks(self) -> Array:
        return np.array([self.start, self.end])

    @property
    def closed(self) -> bool:
        return False


@dataclass(frozen=True, eq=False)
class Trochoid(AbstractCurve):
    """What the rounded corner of a rolling rack leaves: the envelope of a small circle on a rolling line.

    A line rolls outside a circle of `radius` r about the origin, mm. The small circle, of radius
    `rounding` rho >= 0, has its centre `depth` D below the line, that is, towards the origin; where
    the centre passes closest to the origin the line has rolled nowhere and touches at +x. With rho = 0
    this is the trochoid of a point: D = 0 the involute's cusp, D < 0 a point outside the line.

    t = psi is the lean of the contact normal from the radius to the touching point, rad, counterclockwise,
    from `start` to `end`, inside (-pi/2, pi/2). By the law of gearing the normal passes the rolling
    point, a distance D tan(psi) along the line. This parameter keeps its digits where D vanishes and
    the whole corner is cut at one instant, which the roll angle does not.
    """

    radius: Positive
    depth: float
    rounding: float
    start: float
    end: float

    def __post_init__(self) -> None:
        check_fields(self)

    def point(self, t: ArrayLike) -> Array:
        t = np.asarray(t, dtype=float)
        along = self.depth * np.tan(t)
        corner = self.radius - self.depth - 1j * along - self.rounding * np.exp(1j * t)
        return corner * np.exp(1j * along / self.radius)

    def velocity(self, t: ArrayLike) -> Array:
        t = np.asarray(t, dtype=float)
        return -1j * self._speed(t) * np.exp(1j * (t + self.depth * np.tan(t) / self.radius))

    def _turning(self, t: Array) -> Array:
        """Turn of the rolling line per lean of the normal."""
        return self.depth / (self.radius * np.cos(t) ** 2)

    def _speed(self, t: Array) -> Array:
        """Signed speed along the tangent: the centre turns about the rolling point, the contact about it."""
        turning = self._turning(t)
        return turning * self.depth / np.cos(t) + self.rounding * (1 + turning)

    def curvature(self, t: ArrayLike) -> Array:
        t = np.asarray(t, dtype=float)
        with np.errstate(divide="ignore"):
            return (1 + self._turning(t)) / np.abs(self._speed(t))

    @property
    def breaks(self) -> Array:
        return np.array([self.start, self.end])

    @property
    def closed(self) -> bool:
        return False
