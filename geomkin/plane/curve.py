"""The contract of all curves, and curves derived from another one: moved, reversed, mirrored, shortened, parallel.

A curve is a point that depends on a parameter. All code that measures, flattens or writes a curve uses only this
contract, so that a cam profile, a gear tooth and a bar are treated alike.
"""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import ArrayLike

from ..core.fields import one_line, still_picture
from ..core.records import record
from .vec import Complex, Pose, Real, cross, unit


class AbstractCurve(ABC):
    """A plane curve: a point, mm, that depends on a parameter t, and on nothing else.

    A subclass defines `point`, `velocity`, `breaks` and `closed`, and may define `curvature` if a closed form is known.
    All functions for curves (`flatten`, `to_arcs`, `length`, `area`, `nearest`, `Moved`, `Offset`, the outline of a
    `Part`) need no more. The domain is breaks[0] <= t <= breaks[-1]; outside it the results are undefined. At a break
    velocity and curvature are those of the piece that starts there, at the last break those of the piece that ends.
    Curves compare by identity and results are cached, so a curve must not change after its creation.

    See Also
    --------
    flatten, length, area, curvature, nearest, to_arcs
    """

    __repr__ = one_line

    @abstractmethod
    def point(self, t: ArrayLike) -> Complex:
        """Points of the curve.

        Parameters
        ----------
        t : float or array_like
            Parameters of any shape.

        Returns
        -------
        array of complex
            mm, in the shape of t; continuous over the whole domain.
        """

    @abstractmethod
    def velocity(self, t: ArrayLike) -> Complex:
        """Derivative dP/dt, exact and not by differences.

        Parameters
        ----------
        t : float or array_like
            Parameters of any shape.

        Returns
        -------
        array of complex
            mm per unit of t, in the shape of t; 0 only at cusps.
        """

    @property
    @abstractmethod
    def breaks(self) -> Real:
        """Rising parameters (n,), n > 1: the ends of the domain, and each corner, cusp or jump of curvature within it.

        Between them all derivatives are continuous. Additional breaks do no harm.
        """

    @property
    @abstractmethod
    def closed(self) -> bool:
        """Whether the curve ends at its start and is an outline, in either direction."""

    def _repr_svg_(self) -> str | None:
        return still_picture(self, (self,))

    def curvature(self, t: ArrayLike) -> Real:
        """Signed curvature, positive if the curve turns left along rising t.

        Parameters
        ----------
        t : float or array_like
            Parameters of any shape.

        Returns
        -------
        array
            1/mm, in the shape of t; not finite at a cusp.

        Notes
        -----
        By default it is computed from the velocity: the derivative of the polynomial of degree 8 through
        nine neighbours within the same smooth piece, accurate to about 1e-9 of the largest value if the piece is smooth
        on a scale of a sixteenth of its length (derived here).
        """
        t, breaks = np.asarray(t, dtype=float), self.breaks
        piece = np.clip(np.searchsorted(breaks, t, side="right") - 1, 0, len(breaks) - 2)
        start, end = breaks[piece], breaks[piece + 1]
        # Half the window: a wider one is less smooth, a narrower one loses digits to rounding.
        half = (end - start) / 32
        middle = np.clip(t, start + half, end - half)
        # 0.999 keeps the outer neighbours off a break, at which the velocity is that of the next piece.
        nodes = 0.999 * np.cos(np.pi * np.arange(8.5, 0, -1) / 9)
        v = self.velocity(middle[..., None] + half[..., None] * nodes)
        x = ((t - middle) / half)[..., None]
        powers = np.linalg.inv(np.vander(nodes, increasing=True))
        slope = np.concatenate([x**0 * 0, *[k * x ** (k - 1) for k in range(1, 9)]], axis=-1) @ powers
        value = np.concatenate([x**k for k in range(9)], axis=-1) @ powers
        return curvature_from_derivatives(np.sum(value * v, axis=-1), np.sum(slope * v, axis=-1) / half)


def curvature_from_derivatives(velocity: ArrayLike, acceleration: ArrayLike) -> Real:
    """Curvature, positive to the left, from the first two derivatives by any parameter; nan if the point does not move.

    v x a / |v|^3 (do Carmo, Differential Geometry of Curves and Surfaces, section 1-5, exercise 12).
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        curvature: Real = cross(velocity, acceleration) / np.abs(velocity) ** 3
    return curvature


def just_before(t: Real, breaks: Real) -> Real:
    """Parameters, with those at a break moved before it by more than the rounding of breaks."""
    at_break = t == breaks[np.minimum(breaks.searchsorted(t), len(breaks) - 1)]
    return np.where(at_break, t - 64 * np.spacing(np.abs(breaks).max()), t) if at_break.any() else t


def extent(curve: AbstractCurve) -> float:
    """Largest distance of a coarse sample of the curve from its start, mm, as a scale for tolerances."""
    b = curve.breaks
    sample = curve.point(np.concatenate([b[:-1] + f * np.diff(b) for f in (0.0, 0.25, 0.5, 0.75)]))
    return float(np.abs(sample - sample[0]).max())


@record(checked=True, eq=False)
class Derived(AbstractCurve):
    """A curve made from another one, over the same parameters unless stated otherwise."""

    curve: AbstractCurve

    @property
    def breaks(self) -> Real:
        return self.curve.breaks

    @property
    def closed(self) -> bool:
        return self.curve.closed


@record(eq=False)
class Moved(Derived):
    """A curve placed by a pose.

    Parameters
    ----------
    curve : AbstractCurve
        The curve in its own frame.
    pose : Pose
        Position and direction of that frame.
    """

    pose: Pose

    def point(self, t: ArrayLike) -> Complex:
        return self.pose.place(self.curve.point(t))

    def velocity(self, t: ArrayLike) -> Complex:
        return self.pose.direction * self.curve.velocity(t)

    def curvature(self, t: ArrayLike) -> Real:
        return self.curve.curvature(t)


@record(eq=False)
class Reversed(Derived):
    """A curve in the opposite direction: t runs over the negated domain.

    Parameters
    ----------
    curve : AbstractCurve
        The curve.
    """

    def point(self, t: ArrayLike) -> Complex:
        return self.curve.point(-np.asarray(t, dtype=float))

    # The piece that starts at a break of the reversed curve is the one that ends there in the original.
    def velocity(self, t: ArrayLike) -> Complex:
        return -self.curve.velocity(just_before(-np.asarray(t, dtype=float), self.curve.breaks[1:]))

    def curvature(self, t: ArrayLike) -> Real:
        return -self.curve.curvature(just_before(-np.asarray(t, dtype=float), self.curve.breaks[1:]))

    @property
    def breaks(self) -> Real:
        return -self.curve.breaks[::-1]


@record(eq=False)
class Mirrored(Derived):
    """The mirror image of a curve in the y axis.

    Parameters
    ----------
    curve : AbstractCurve
        The curve.
    """

    def point(self, t: ArrayLike) -> Complex:
        return -np.conj(self.curve.point(t))

    def velocity(self, t: ArrayLike) -> Complex:
        return -np.conj(self.curve.velocity(t))

    def curvature(self, t: ArrayLike) -> Real:
        return -self.curve.curvature(t)


@record(eq=False)
class SubCurve(Derived):
    """The part of a curve between the first and last of `run`, its rising breaks; the curve may jump at the last."""

    run: Real

    def point(self, t: ArrayLike) -> Complex:
        return self.curve.point(self._inside(t))

    def velocity(self, t: ArrayLike) -> Complex:
        return self.curve.velocity(self._inside(t))

    def curvature(self, t: ArrayLike) -> Real:
        return self.curve.curvature(self._inside(t))

    def _inside(self, t: ArrayLike) -> Real:
        """At the last break the curve would use the piece beyond, so the parameter is moved before it."""
        t, end, breaks = np.asarray(t, dtype=float), self.run[-1], self.curve.breaks
        rounding = 64 * np.spacing(np.abs(breaks).max())
        return np.where(t == end, t - rounding, t) if (np.abs(breaks - end) <= rounding).any() else t

    @property
    def breaks(self) -> Real:
        return self.run

    @property
    def closed(self) -> bool:
        return False


@record(eq=False)
class Offset(Derived):
    """The parallel curve at a signed distance to the right of a curve; right is outside for a counterclockwise outline.

    It is exact and includes loops: if the distance exceeds the radius of curvature the parallel curve reverses, and
    nothing is trimmed. Corners of the curve leave gaps.

    Parameters
    ----------
    curve : AbstractCurve
        The curve.
    distance : float
        mm, positive to the right.
    """

    distance: float

    def point(self, t: ArrayLike) -> Complex:
        return self.curve.point(t) - 1j * self.distance * unit(self._moving(t)[1])

    def velocity(self, t: ArrayLike) -> Complex:
        t, v = self._moving(t)
        return v * (1 + self.distance * self.curve.curvature(t))

    def _moving(self, t: ArrayLike) -> tuple[Real, Complex]:
        """Parameters and velocities; at a cusp, where the velocity is zero, those just inside the piece."""
        t = np.asarray(t, dtype=float)
        v = self.curve.velocity(t)
        if (still := v == 0).any():
            b = self.breaks
            i = np.clip(np.searchsorted(b, t, side="right") - 1, 0, len(b) - 2)
            t = np.where(still, t + 1e-9 * (0.5 * (b[i] + b[i + 1]) - t), t)
            v = self.curve.velocity(t)
        return t, v

    def curvature(self, t: ArrayLike) -> Real:
        curvature = self.curve.curvature(t)
        with np.errstate(divide="ignore"):
            return curvature / abs(1 + self.distance * curvature)
