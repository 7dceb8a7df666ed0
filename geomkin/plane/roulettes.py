"""Curves traced by rolling: involute, trochoid of a rounded corner, epi- and hypocycloid; the involute function."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..core.arguments import PositiveFloat
from ..core.errors import DesignError
from ..core.records import record
from .curve import AbstractCurve
from .vec import Complex, Real

# Roll angle below which the involute function is computed by its series, since its two terms are nearly equal there,
# and the number of terms.
NEAR_BASE, TERMS = 0.25, 14


class Traced(AbstractCurve):
    """A curve traced by rolling from one roll angle to another: open and smooth."""

    start: float
    end: float

    @property
    def breaks(self) -> Real:
        return np.array([self.start, self.end])

    closed = False


@record(checked=True, eq=False)
class Involute(Traced):
    """Involute of a circle about the origin: the path of the end of a taut string unwound counterclockwise.

    t is the roll angle, rad, 0 at the cusp on +x. The radius at t is base_radius sqrt(1 + t^2), and t is the tangent of
    the pressure angle there (ISO 21771).

    Parameters
    ----------
    base_radius : float
        mm; above 0.
    start, end : float
        First and last roll angle, rad; start at least 0.
    """

    base_radius: PositiveFloat
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
    """inv(alpha) = tan(alpha) - alpha with roll = tan(alpha): the involute's polar angle (ISO 21771)."""
    if abs(roll) > NEAR_BASE:
        return float(roll - np.arctan(roll))
    return float(sum((-1) ** k * roll ** (2 * k + 3) / (2 * k + 3) for k in reversed(range(TERMS))))


def inverse_involute(angle: float) -> float:
    """Roll angle, the tangent of the pressure angle, whose involute function is `angle` >= 0; rad."""
    # The function is convex: from a start above the root, Newton's steps decrease towards it.
    t = float(np.cbrt(3 * angle)) + angle
    for _ in range(60):
        step = (involute_function(t) - angle) * (1 + t**2) / t**2 if t > 0 else 0.0
        t = float(t - step)
        if abs(step) <= 1e-16 * t:
            break
    return t


def roll_at(radius: float, base_radius: float) -> float:
    """Roll angle at which the involute reaches a radius; 0 inside the base circle."""
    ratio = radius / base_radius
    return float(np.sqrt(max((ratio - 1) * (ratio + 1), 0.0)))


@record(checked=True, eq=False)
class Trochoid(Traced):
    """The fillet cut by a rounded corner of a rolling rack: the envelope of a small circle on a rolling line.

    A line rolls outside a circle of `radius` r about the origin. The small circle, of radius `rounding` rho, has its
    centre at `depth` D below the line, that is, towards the origin; when the centre is closest to the origin the line
    touches at +x. With rho = 0 this is the trochoid of a point: D = 0 gives the involute's cusp, D < 0 a point outside
    the line. rho > 0 is a rounded tip of the rack, touched on the side towards the origin, rho < 0 a fillet, touched on
    the far side.

    Parameters
    ----------
    radius : float
        r, mm; above 0.
    depth : float
        D, mm.
    rounding : float
        rho, mm.
    start, end : float
        First and last parameter, rad, inside (-pi/2, pi/2).

    Notes
    -----
    t = psi is the angle from the radius at the touching point to the contact normal, rad, counterclockwise.
    By the law of gearing the normal passes through the rolling point, a distance D tan(psi) along the line. Unlike the
    roll angle, this parameter keeps its digits if D vanishes and the whole corner is cut at one instant. Derived here.
    """

    radius: PositiveFloat
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
        """Rotation of the rolling line per rotation of the normal."""
        return self.depth / (self.radius * np.cos(t) ** 2)

    def speed(self, t: float) -> float:
        """Signed speed along the tangent."""
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
    """Path of a rim point of a circle that rolls counterclockwise around a circle about the origin.

    t is the angle of the rolling contact, rad; 0 at the cusp on +x, the next cusp at 2 pi |g| / r.

    Parameters
    ----------
    radius : float
        r of the fixed circle, mm; above 0.
    rolling : float
        g of the rolling circle, mm; above 0 outside (epicycloid), below 0 inside (hypocycloid; -r / 2 gives a
        diameter).
    start, end : float
        First and last angle of the contact, rad.

    Raises
    ------
    DesignError
        If `rolling` is 0.

    Notes
    -----
    Derived here.
    """

    radius: PositiveFloat
    rolling: float
    start: float
    end: float

    def __post_init__(self) -> None:
        if not self.rolling:
            raise DesignError(
                "rolling", "found 0", "give a radius above 0 to roll outside, below 0 to roll inside", "out-of-range"
            )

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
