"""Curves traced by rolling: the involute and its function, a rounded corner's trochoid, epi- and hypocycloids."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..core.arguments import Positive
from ..core.errors import DesignError
from ..core.records import record
from .curve import AbstractCurve
from .vec import Complex, Real

# Roll angle below which the involute function is told by its series: its two terms are nearly equal there. Larger, and
# the series' terms run out before the digits do; smaller, and their difference has lost two of them.
NEAR_BASE, TERMS = 0.25, 14


class Traced(AbstractCurve):
    """What rolling traces from one roll angle to another: open, and smooth all along."""

    start: float
    end: float

    @property
    def breaks(self) -> Real:
        return np.array([self.start, self.end])

    @property
    def closed(self) -> bool:
        return False


@record(checked=True, eq=False)
class Involute(Traced):
    """The path of the end of a taut string unwound counterclockwise from a circle about the origin.

    base_radius, mm; t is the roll angle in rad from `start` to `end` (0 <= start), 0 at the cusp on
    +x. The radius at t is base_radius sqrt(1 + t^2), and t is the tangent of the pressure angle there (ISO 21771).
    """

    base_radius: Positive
    start: float
    end: float

    def point(self, t: ArrayLike) -> Complex:
        t = np.asarray(t, dtype=float)
        return self.base_radius * (1 - 1j * t) * np.exp(1j * t)

    def velocity(self, t: ArrayLike) -> Complex:
        t = np.asarray(t, dtype=float)
        tangent: Complex = np.exp(1j * t)
        return self.base_radius * t * tangent

    def curvature(self, t: ArrayLike) -> Real:
        with np.errstate(divide="ignore"):
            return 1 / (self.base_radius * np.asarray(t, dtype=float))


def involute_function(roll: float) -> float:
    """inv(alpha) = tan(alpha) - alpha with roll = tan(alpha): the involute's polar angle at a roll (ISO 21771)."""
    if abs(roll) > NEAR_BASE:
        return float(roll - np.arctan(roll))
    return float(sum((-1) ** k * roll ** (2 * k + 3) / (2 * k + 3) for k in reversed(range(TERMS))))


def inverse_involute(angle: float) -> float:
    """Roll angle, the tangent of the pressure angle, whose involute function is `angle` >= 0; rad."""
    # The function is convex: from a start above the root, Newton's steps only fall towards it.
    t = float(np.cbrt(3 * angle)) + angle
    for _ in range(60):
        step = (involute_function(t) - angle) * (1 + t**2) / t**2 if t > 0 else 0.0
        t = float(t - step)
        if abs(step) <= 1e-16 * t:
            break
    return t


def roll_at(radius: float, base_radius: float) -> float:
    """Roll angle of the involute where it reaches a radius; 0 inside the base circle."""
    ratio = radius / base_radius
    return float(np.sqrt(max((ratio - 1) * (ratio + 1), 0.0)))


@record(checked=True, eq=False)
class Trochoid(Traced):
    """What the rounded corner of a rolling rack leaves: the envelope of a small circle on a rolling line.

    A line rolls outside a circle of `radius` r about the origin, mm. The small circle, of radius
    `rounding` rho, has its centre `depth` D below the line, that is, towards the origin; where
    the centre passes closest to the origin the line has rolled nowhere and touches at +x. With rho = 0
    this is the trochoid of a point: D = 0 the involute's cusp, D < 0 a point outside the line. rho > 0 is a rounded
    tip of the rack, whose circle is touched on its side towards the origin, rho < 0 a fillet, touched on the far one.

    t = psi is the lean of the contact normal from the radius to the touching point, rad, counterclockwise,
    from `start` to `end`, inside (-pi/2, pi/2). By the law of gearing the normal passes the rolling
    point, a distance D tan(psi) along the line. This parameter keeps its digits where D vanishes and
    the whole corner is cut at one instant, which the roll angle does not. Derived here.
    """

    radius: Positive
    depth: float
    rounding: float
    start: float
    end: float

    def point(self, t: ArrayLike) -> Complex:
        t = np.asarray(t, dtype=float)
        along = self.depth * np.tan(t)
        corner = self.radius - self.depth - 1j * along - self.rounding * np.exp(1j * t)
        point: Complex = corner * np.exp(1j * along / self.radius)
        return point

    def velocity(self, t: ArrayLike) -> Complex:
        t = np.asarray(t, dtype=float)
        tangent: Complex = np.exp(1j * (t + self.depth * np.tan(t) / self.radius))
        return -1j * self._speed(t) * tangent

    def _turning(self, t: Real) -> Real:
        """Turn of the rolling line per lean of the normal."""
        return self.depth / (self.radius * np.cos(t) ** 2)

    def speed(self, t: float) -> float:
        """Signed speed along the tangent: the centre turns about the rolling point, the contact about it."""
        return float(self._speed(np.asarray(t)))

    def _speed(self, t: Real) -> Real:
        turning = self._turning(t)
        return turning * self.depth / np.cos(t) + self.rounding * (1 + turning)

    def curvature(self, t: ArrayLike) -> Real:
        t = np.asarray(t, dtype=float)
        with np.errstate(divide="ignore"):
            return (1 + self._turning(t)) / np.abs(self._speed(t))


@record(checked=True, eq=False)
class Cycloid(Traced):
    """The path of a rim point of a circle that rolls counterclockwise round a circle about the origin.

    radius r of the fixed circle, mm; `rolling` radius g, mm, above 0 outside it (epicycloid), below 0 inside
    it (hypocycloid; -r / 2 gives a diameter). t is the angle of the rolling contact, rad, from `start` to
    `end`; 0 at the cusp on +x, the next one at 2 pi |g| / r. Derived here.
    """

    radius: Positive
    rolling: float
    start: float
    end: float

    def __post_init__(self) -> None:
        if not self.rolling:
            raise DesignError("rolling", "found 0", "give a radius above 0 to roll outside, below 0 to roll inside")

    def point(self, t: ArrayLike) -> Complex:
        t = np.asarray(t, dtype=float)
        contact: Complex = np.exp(1j * t)
        return contact * (self.radius + self.rolling * (1 - np.exp(1j * t * self.radius / self.rolling)))

    def velocity(self, t: ArrayLike) -> Complex:
        """The rim point turns about the rolling contact."""
        t = np.asarray(t, dtype=float)
        half = t * self.radius / (2 * self.rolling)
        tangent: Complex = np.exp(1j * (t + half))
        speed: Real = 2 * (self.radius + self.rolling) * np.sin(half)
        return speed * tangent

    def curvature(self, t: ArrayLike) -> Real:
        r, g = self.radius, self.rolling
        speed = np.abs(2 * (r + g) * np.sin(np.asarray(t, dtype=float) * r / (2 * g)))
        with np.errstate(divide="ignore", invalid="ignore"):
            return (1 + r / (2 * g)) / speed
