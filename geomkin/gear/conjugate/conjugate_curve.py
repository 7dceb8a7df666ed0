"""The curve that a piece of a tooth generates in a rolling mate: the law of gearing, point by point."""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ...core.records import record
from ...plane.curve import AbstractCurve, SubCurve
from ...plane.vec import Complex, Mask, Real, unit

# Distance from a piece's end, as a share of the piece, at which a velocity is computed if the end is a cusp of the
# tooth or a point where two roots touch. A smaller value is lost in rounding, a larger one belongs to another point.
INSIDE = 1e-5
# Squared share of the pitch radius below which the two roots count as equal. A smaller value leaves the square root of
# the rounding error, a gap of 1e-8 between curves that meet.
ONE_ROOT = 1e-14
# Squared share below which a velocity close to a fold is replaced by its limit: there both have an error of 1e-5.
NEAR_FOLD = 1e-11


class TangentPoint(NamedTuple):
    """Points of a tooth with unit tangents and the material to their left; both may depend on a parameter.

    point (...,) mm. tangent (...,). speed (...,): of the point along the tangent, mm, and turning (...,): rotation of
    the tangent, rad, per unit of the parameter.
    """

    point: Complex
    tangent: Complex
    speed: Real
    turning: Real


@record(eq=False)
class ToothRun:
    """A stretch of a tooth without a corner."""

    curve: SubCurve

    @property
    def breaks(self) -> Real:
        """Parameters between which the stretch is smooth."""
        return self.curve.breaks

    def touch(self, t: Real) -> TangentPoint:
        """Points of the curve; at a cusp with the tangent just inside."""
        v = self.curve.velocity(t)
        # Close to a cusp the velocity underflows.
        at_cusp, inner = np.abs(v) < np.finfo(float).tiny, t
        if at_cusp.any():
            b = self.breaks
            k = np.clip(np.searchsorted(b, t, side="right") - 1, 0, len(b) - 2)
            inner = np.where(at_cusp, t + INSIDE * (0.5 * (b[k] + b[k + 1]) - t), t)
            v = np.where(at_cusp, self.curve.velocity(inner), v)
        speed = np.abs(v)
        return TangentPoint(self.curve.point(t), unit(v), speed, self.curve.curvature(inner) * speed)


@record(eq=False)
class ToothCorner:
    """A convex corner: one point, whose tangent rotates left from `tangent` by `sweep`, rad."""

    place: complex
    tangent: complex
    sweep: float

    @property
    def breaks(self) -> Real:
        """Start and end of the tangent's rotation, rad."""
        return np.array([0.0, self.sweep])

    def touch(self, t: Real) -> TangentPoint:
        """The corner at rotations of its tangent, rad."""
        one = np.ones(np.shape(t))
        return TangentPoint(np.full(one.shape, self.place), self.tangent * np.exp(1j * t), 0 * one, one)


@record(eq=False)
class ToothContact:
    """Contacts of points of a tooth with its mate; arrays of one shape, nan for points that never touch.

    Parameters
    ----------
    angle : ndarray
        Rotation of the gear, rad counterclockwise; 0 when its tooth is on +y.
    place : ndarray of complex
        Contact in the fixed frame, mm, with the gear about the origin and the pitch point on +y.
    tooth, mate : ndarray of complex
        Contact in the frames of gear and mate, mm.
    sliding : ndarray
        Sliding of the gear on its mate along the tooth's tangent, mm per rad of the gear.
    pressure_angle : ndarray
        Angle between the common normal and the tangent of the pitch circles, rad.
    """

    angle: Real
    place: Complex
    tooth: Complex
    mate: Complex
    sliding: Real
    pressure_angle: Real


class Meeting(NamedTuple):
    """A point of the tooth, and the pitch point on its normal at contact.

    b, q: position of the pitch point along the normal, mm, from the foot of the perpendicular from the gear's axis, and
    from the tooth's point. direction: from the gear's axis to the pitch point.
    """

    touch: TangentPoint
    b: Real
    q: Real
    direction: Complex


@record(eq=False)
class ConjugateCurve(AbstractCurve):
    """The curve that a piece of a tooth generates in its mate, in the mate's frame.

    The gear of pitch radius r rotates about the origin. Its mate, of pitch radius R, below 0 if one of the two is a
    ring, rotates about i (r + R) while the gear's +y is on the line of centres. By the law of gearing (Litvin and
    Fuentes, Gear Geometry and Applied Theory; the following forms are derived here) the normal at the contact point
    passes through the pitch point P = r e^{i phi}. With tangent T and normal i T: conj(T) P = a + i b with
    a = Re(conj(T) z), b = root sqrt(r^2 - a^2); there is no root if the normal misses the pitch circle. The point z is
    in contact when the pitch point is at phi in the gear's frame. With k = 1 + r / R the mate rotates by k per rad of
    phi about P, and the speed of its contact point along T is g / b, g = b s + k q (s - w q) for a tooth point of speed
    s whose tangent rotates by w. If g = 0 the curve has a cusp; beyond it, k g > 0, the two would cut each other.

    The parameter t is in [start, end] within 0 to 1, which is the tooth's piece from `first` to `last`. At a fold the
    two roots meet and the contact point reverses on the tooth; there t is the square root of the tooth's parameter, so
    that the curve is smooth. turn: direction of the mate's frame.
    """

    side: ToothRun | ToothCorner
    pitch_radius: float
    mate_radius: float
    root: int
    first: float
    last: float
    folds: tuple[bool, bool]
    turn: complex = 1 + 0j
    start: float = 0.0
    end: float = 1.0

    @property
    def k(self) -> float:
        """Rotation of the mate per rotation of the line of centres, both in the gear's frame."""
        return 1 + self.pitch_radius / self.mate_radius

    def tooth_parameter(self, t: ArrayLike) -> Real:
        """Parameter of the tooth's piece."""
        u, span = np.asarray(t, dtype=float), self.last - self.first
        match self.folds:
            case (True, True):
                return self.first + span * np.sin(np.pi / 2 * u) ** 2
            case (True, False):
                return self.first + span * u**2
            case (False, True):
                return self.last - span * (1 - u) ** 2
        return self.first + span * u

    def parameter_of(self, tooth_parameter: ArrayLike) -> Real:
        """The inverse of `tooth_parameter`."""
        share = np.clip((np.asarray(tooth_parameter, dtype=float) - self.first) / (self.last - self.first), 0, 1)
        match self.folds:
            case (True, True):
                return np.arcsin(np.sqrt(share)) * 2 / np.pi
            case (True, False):
                return np.sqrt(share)
            case (False, True):
                return 1 - np.sqrt(1 - share)
        return share

    def _rate(self, u: Real) -> Real:
        """d tooth_parameter / dt."""
        rate: Real
        match self.folds:
            case (True, True):
                rate = np.pi / 2 * np.sin(np.pi * u)
            case (True, False):
                rate = 2 * u
            case (False, True):
                rate = 2 * (1 - u)
            case _:
                rate = np.ones(np.shape(u))
        return (self.last - self.first) * rate

    def _meeting(self, u: Real) -> Meeting:
        touch = self.side.touch(self.tooth_parameter(u))
        r = self.pitch_radius
        local = np.conj(touch.tangent) * touch.point
        squared = (r - local.real) * (r + local.real)
        b = self.root * np.sqrt(np.where(squared > ONE_ROOT * r**2, squared, 0))
        return Meeting(touch, b, b - local.imag, unit(touch.tangent * (local.real + 1j * b)))

    def _phi(self, m: Meeting) -> Real:
        """Angle of the pitch point from +y in the gear's frame, rad."""
        phi: Real = np.angle(-1j * m.direction)
        return phi

    def _place(self, m: Meeting) -> Complex:
        """The point in the mate's frame."""
        return (m.touch.point - (self.pitch_radius + self.mate_radius) * m.direction) * self._turned(m)

    def _turned(self, m: Meeting) -> Complex:
        direction: Complex = self.turn * np.exp(-1j * self.k * self._phi(m))
        return direction

    def _g(self, m: Meeting) -> Real:
        s, w = m.touch.speed, m.touch.turning
        return m.b * s + self.k * m.q * (s - w * m.q)

    def sound(self, t: ArrayLike) -> Real:
        """Negative for contact without undercut, 0 at a cusp."""
        m = self._meeting(np.asarray(t, dtype=float))
        return self.k * self._g(m) / (m.touch.speed + np.abs(m.touch.turning) * self.pitch_radius)

    def point(self, t: ArrayLike) -> Complex:
        return self._place(self._meeting(np.asarray(t, dtype=float)))

    def velocity(self, t: ArrayLike) -> Complex:
        return self.course(t)[1]

    def course(self, t: ArrayLike) -> tuple[Complex, Complex]:
        """Point and velocity, from one evaluation."""
        u = np.asarray(t, dtype=float)
        at = self._meeting(u)
        u, m = self._inside(u, at)
        s, w, r = m.touch.speed, m.touch.turning, self.pitch_radius
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = self._rate(u) / m.b
        if any(self.folds):
            # Rate of a along the tooth: from the fold on, b^2 grows by 2 r times it.
            grows = np.abs(s + w * np.imag(np.conj(m.touch.tangent) * m.touch.point))
            stretch = np.pi / 2 if all(self.folds) else 1.0
            with np.errstate(divide="ignore"):
                limit = self.root * stretch * np.sqrt(2 * (self.last - self.first) / (r * grows))
            ratio = np.where((m.b**2 < NEAR_FOLD * r**2) & self._at_fold(u), limit, ratio)
        with np.errstate(invalid="ignore"):
            # Infinite for a piece whose points differ by rounding only.
            return self._place(at), m.touch.tangent * self._turned(m) * self._g(m) * ratio

    def curvature(self, t: ArrayLike) -> Real:
        u = np.asarray(t, dtype=float)
        _, m = self._inside(u, self._meeting(u))
        s, w = m.touch.speed, m.touch.turning
        with np.errstate(divide="ignore", invalid="ignore"):
            return self.root * (w * m.b + self.k * (s - w * m.q)) / np.abs(self._g(m))

    def _at_fold(self, u: Real) -> Mask:
        return ((u < 0.5) & self.folds[0]) | ((u >= 0.5) & self.folds[1])

    def _inside(self, u: Real, m: Meeting) -> tuple[Real, Meeting]:
        """The meeting m at u; just inside the piece if two roots touch at u without a fold."""
        # Closer to such a point the square root loses more digits than the step costs.
        lost = (np.abs(m.b) < INSIDE * self.pitch_radius) & ~self._at_fold(u)
        if lost.any():
            u = np.where(lost, np.clip(u, INSIDE, 1 - INSIDE), u)
            m = self._meeting(u)
        return u, m

    def contact(self, t: ArrayLike) -> ToothContact:
        """Contacts at these parameters."""
        m = self._meeting(np.asarray(t, dtype=float))
        phi = self._phi(m)
        place = m.touch.point * np.exp(-1j * phi)
        # In the mate's frame the gear rotates by k about the pitch point: i k (z - P), which is along T.
        angle = np.arccos(np.clip(np.abs(np.real(np.conj(m.touch.tangent) * m.direction)), 0, 1))
        return ToothContact(-phi, place, m.touch.point, self._place(m), self.k * m.q, angle)

    @cached_property
    def breaks(self) -> Real:
        inner = self.parameter_of(self.side.breaks)
        return np.concatenate([[self.start], inner[(inner > self.start) & (inner < self.end)], [self.end]])

    closed = False
