"""Curves made from one curve: moved, reversed, mirrored, cut to a stretch, parallel."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import check_fields
from .curve import AbstractCurve, just_before
from .vec import Complex, Pose, Real, unit


@dataclass(frozen=True, eq=False, repr=False)
class Derived(AbstractCurve):
    """What is made from one curve: over the same parameters, unless it says otherwise."""

    curve: AbstractCurve

    def __post_init__(self) -> None:
        check_fields(self)

    @property
    def breaks(self) -> Real:
        return self.curve.breaks

    @property
    def closed(self) -> bool:
        return self.curve.closed


@dataclass(frozen=True, eq=False, repr=False)
class Moved(Derived):
    """A curve seen from outside when its own frame stands at `pose`."""

    pose: Pose

    def point(self, t: ArrayLike) -> Complex:
        return self.pose.place(self.curve.point(t))

    def velocity(self, t: ArrayLike) -> Complex:
        return self.pose.direction * self.curve.velocity(t)

    def curvature(self, t: ArrayLike) -> Real:
        return self.curve.curvature(t)


@dataclass(frozen=True, eq=False, repr=False)
class Reversed(Derived):
    """The same points the other way round: t runs over the negated domain."""

    def point(self, t: ArrayLike) -> Complex:
        return self.curve.point(-np.asarray(t, dtype=float))

    # The piece that starts at a break here is the one that ends there in the curve itself.
    def velocity(self, t: ArrayLike) -> Complex:
        return -self.curve.velocity(just_before(-np.asarray(t, dtype=float), self.curve.breaks[1:]))

    def curvature(self, t: ArrayLike) -> Real:
        return -self.curve.curvature(just_before(-np.asarray(t, dtype=float), self.curve.breaks[1:]))

    @property
    def breaks(self) -> Real:
        return -self.curve.breaks[::-1]


@dataclass(frozen=True, eq=False, repr=False)
class Mirrored(Derived):
    """The mirror image of a curve in the y axis."""

    def point(self, t: ArrayLike) -> Complex:
        return -np.conj(self.curve.point(t))

    def velocity(self, t: ArrayLike) -> Complex:
        return -np.conj(self.curve.velocity(t))

    def curvature(self, t: ArrayLike) -> Real:
        return -self.curve.curvature(t)


@dataclass(frozen=True, eq=False, repr=False)
class Stretch(Derived):
    """The part of a curve over `run`, rising parameters of it; the curve may jump at the last."""

    run: Real

    def point(self, t: ArrayLike) -> Complex:
        return self.curve.point(self._inside(t))

    def velocity(self, t: ArrayLike) -> Complex:
        return self.curve.velocity(self._inside(t))

    def curvature(self, t: ArrayLike) -> Real:
        return self.curve.curvature(self._inside(t))

    def _inside(self, t: ArrayLike) -> Real:
        """At its end the curve would answer for the piece beyond."""
        return just_before(np.asarray(t, dtype=float), self.run[-1:])

    @property
    def breaks(self) -> Real:
        return self.run

    @property
    def closed(self) -> bool:
        return False


@dataclass(frozen=True, eq=False, repr=False)
class Offset(Derived):
    """The parallel curve at a signed distance, mm, to the right of a curve.

    Right is outside for a counterclockwise outline. Exact, loops included: where the distance
    exceeds the radius of curvature the parallel curve turns back on itself, and nothing trims it.
    Corners of the curve leave gaps.
    """

    distance: float

    def point(self, t: ArrayLike) -> Complex:
        return self.curve.point(t) - 1j * self.distance * unit(self._moving(t)[1])

    def velocity(self, t: ArrayLike) -> Complex:
        t, v = self._moving(t)
        return v * (1 + self.distance * self.curve.curvature(t))

    def _moving(self, t: ArrayLike) -> tuple[Real, Complex]:
        """Parameters and velocities; at a cusp, where the curve stands still, those just inside the piece."""
        t = np.asarray(t, dtype=float)
        v = self.curve.velocity(t)
        if (still := v == 0).any():
            b = self.breaks
            i = np.clip(np.searchsorted(b, t, side="right") - 1, 0, len(b) - 2)
            t = np.where(still, t + 1e-9 * (0.5 * (b[i] + b[i + 1]) - t), t)
            v = self.curve.velocity(t)
        return t, v

    def curvature(self, t: ArrayLike) -> Real:
        bend = self.curve.curvature(t)
        with np.errstate(divide="ignore"):
            return bend / abs(1 + self.distance * bend)
