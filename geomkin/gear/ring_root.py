"""The root curve of an internal gear: what the rounded tip of a rolling pinion cutter leaves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..plane.curve import AbstractCurve
from ..plane.vec import Array


@dataclass(frozen=True, eq=False)
class RingTrochoid(AbstractCurve):
    """The envelope of a small circle on a wheel that rolls inside a ring.

    The wheel, of `wheel` radius w, rolls inside the ring of `radius` R > w about the origin, mm. The small
    circle, of radius `rounding` rho >= 0, has its centre at a distance w + `reach` from the wheel's centre;
    where the centre comes farthest out the wheel touches at +x.

    t = psi is the lean of the contact normal from the radius to the rolling point I, rad, counterclockwise,
    from `start` to `end`, inside (-pi/2, pi/2). By the law of gearing the normal passes I, at a distance
    d from the small circle's centre, with d^2 + 2 w d cos(psi) = (w + reach)^2 - w^2, negative where the
    centre lies inside the rolling circle. This parameter keeps its digits where `reach` vanishes and the
    whole corner is cut at one instant. Asks for w |sin(psi)| < w + reach.
    """

    radius: float
    wheel: float
    reach: float
    rounding: float
    start: float
    end: float

    def _away(self, t: Array) -> tuple[Array, Array]:
        """d, and q = d + w cos(psi), in the form that keeps the digits of a small reach."""
        w, c = self.wheel, self.wheel + self.reach
        q = np.sqrt((c - w * np.sin(t)) * (c + w * np.sin(t)))
        return self.reach * (c + w) / (w * np.cos(t) + q), q

    def _turned(self, t: Array, d: Array) -> Array:
        """Direction of the normal's frame in the ring: the ring turns by w / R of the wheel."""
        return np.exp(-1j * self.wheel / self.radius * np.angle(self.wheel + d * np.exp(1j * t)))

    def point(self, t: ArrayLike) -> Array:
        t = np.asarray(t, dtype=float)
        d, _ = self._away(t)
        return (self.radius + (d + self.rounding) * np.exp(1j * t)) * self._turned(t, d)

    def _bend(self, d: Array, q: Array) -> tuple[Array, Array]:
        """Turn of the tangent and speed along it, per lean of the normal."""
        k = self.wheel / self.radius
        turn = 1 - k * d / q
        return turn, self.rounding * turn + (1 - k) * d**2 / q

    def velocity(self, t: ArrayLike) -> Array:
        t = np.asarray(t, dtype=float)
        d, q = self._away(t)
        return 1j * self._bend(d, q)[1] * np.exp(1j * t) * self._turned(t, d)

    def curvature(self, t: ArrayLike) -> Array:
        turn, speed = self._bend(*self._away(np.asarray(t, dtype=float)))
        with np.errstate(divide="ignore"):
            return turn / np.abs(speed)

    @property
    def breaks(self) -> Array:
        return np.array([self.start, self.end])

    @property
    def closed(self) -> bool:
        return False
