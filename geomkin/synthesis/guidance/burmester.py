"""Burmester curves of four poses: the possible pivots on the ground, the possible pins on the body, and their pairs."""

from __future__ import annotations

from functools import cached_property
from itertools import permutations

import numpy as np
from numpy.typing import ArrayLike

from ...core.arguments import PositiveFloat, checked
from ...core.errors import DesignError
from ...core.records import record
from ...plane.curve import AbstractCurve
from ...plane.vec import Complex, Mask, Real
from .circular_cubic import Cubic, CubicBranch, intervals_inside
from .constraint import FAR, Pairs, missed, normalised
from .poses import Poses, distinct_poses, inverse

# Default extent of the curves, in sizes of the poses.
DEFAULT_EXTENT = 10.0
# Largest coefficient of a cubic, in unit sizes, that counts as rounding: then every point of the plane is on the curve.
ROUNDING = 1e-13
# Largest error of an accepted slide, in sizes. A smaller value loses slides of far pins to rounding.
MISSED = 1e-5
# Samples of a loop for its crossings of the limit; with fewer a short excursion is missed.
SAMPLES = 2000


@record(eq=False)
class FourPoses:
    """Four poses (n,) and the cubic of the possible pivots, in unit sizes about their middle.

    For poses of the ground as seen from the body the pivots are pins on the body, and their partners are ground pivots,
    measured from `partner_origin`, mm.
    """

    origins: Complex
    directions: Complex
    partner_origin: complex = 0j

    @cached_property
    def scaled(self) -> tuple[Complex, complex, float]:
        """Origins in unit sizes, their middle, mm, and the size, mm."""
        z, middle, size = normalised(self.origins)
        return z, complex(middle[0]), float(size[0])

    @cached_property
    def cubic(self) -> Cubic:
        """The cubic from the determinant that makes the four positions of a pivot on the body lie on a circle."""
        z, u = self.scaled[0], np.conj(self.directions)
        step, turn = z[1:] - z[0], u[1:] - u[0]
        shift = u[1:] * z[1:] - u[0] * z[0]
        # |g|^2, g x and g y with g = conj(u) (f - z), each less its value at the first pose.
        forms = np.array(
            [
                [-2 * step.real, -2 * step.imag, np.abs(z[1:]) ** 2 - abs(z[0]) ** 2],
                [turn.real, -turn.imag, -shift.real],
                [turn.imag, turn.real, -shift.imag],
            ]
        )
        tensor: Real = np.zeros((3, 3, 3))
        for order in permutations(range(3)):
            sign = np.linalg.det(np.eye(3)[list(order)])
            tensor += sign * np.einsum("a,b,c->abc", *(forms[order[k], :, k] for k in range(3)))
        tensor = np.mean([np.transpose(tensor, order) for order in permutations(range(3))], axis=0)
        size = np.prod([np.linalg.norm(forms[:, :, k]) for k in range(3)])
        if np.abs(tensor).max() <= ROUNDING * size:
            why = "every point is a pin of some dyad: they are parallel on one circle, or rotated about one point"
            raise DesignError("poses", why, "give other poses, or use `dyads_through` with fixed or moving")
        return Cubic(tensor / np.abs(tensor).max())

    def point(self, place: Complex, weight: Real) -> Complex:
        """Points place / weight, given in unit sizes, in mm."""
        _, middle, size = self.scaled
        with np.errstate(divide="ignore", invalid="ignore"):
            points: Complex = middle + size * (place / weight)
        return points

    def partner(self, place: Complex, weight: Real) -> Complex:
        """Pins on the body, mm, of the pivots place / weight in unit sizes; weight 0 is at infinity."""
        return self.partner_origin + self._solve(*self._conditions(place, weight)) * self.scaled[2]

    def partner_rate(self, place: Complex, weight: Real, place_rate: Complex, weight_rate: Real) -> Complex:
        """Rates of these pins from the rates of their pivots."""
        factor, right = self._conditions(place, weight)
        m = self._solve(factor, right)
        factor_rate, right_rate = self._conditions(place_rate, weight_rate)
        return self._solve(factor, right_rate - (factor_rate * m[..., None]).real) * self.scaled[2]

    def _conditions(self, place: Complex, weight: Real) -> tuple[Complex, Real]:
        """Conditions Re(factor m) = right at each pose, both less their mean, which leaves the distance from the pivot
        free.
        """
        z, u = self.scaled[0], self.directions
        f, w = place[..., None], weight[..., None]
        factor = 2 * u * np.conj(w * z - f)
        right = 2 * (np.conj(f) * z).real - w * np.abs(z) ** 2
        return factor - factor.mean(axis=-1, keepdims=True), right - right.mean(axis=-1, keepdims=True)

    @staticmethod
    def _solve(factor: Complex, right: Real) -> Complex:
        """Least squares along the two principal directions, which loses few digits."""
        half = np.exp(-0.5j * np.angle(np.sum(factor**2, axis=-1)))
        along = factor * half[..., None]
        with np.errstate(divide="ignore", invalid="ignore"):
            x = np.sum(along.real * right, axis=-1) / np.sum(along.real**2, axis=-1)
            y = -np.sum(along.imag * right, axis=-1) / np.sum(along.imag**2, axis=-1)
        pin: Complex = (x + 1j * y) * half
        return pin


@record(checked=True, eq=False)
class BurmesterCurve(AbstractCurve):
    """A piece of a centre-point or circle-point curve.

    A branch that passes through infinity is cut where it leaves the limit. The velocity is nan where the curve crosses
    itself.

    Parameters
    ----------
    poses : FourPoses
        The poses as seen from the ground (centre points) or from the body (circle points).
    loop : CubicBranch
        The loop of the cubic to which the piece belongs.
    start, end : float
        Range of the parameter t, whose unit has no meaning.
    """

    poses: FourPoses
    loop: CubicBranch
    start: float
    end: float

    def point(self, t: ArrayLike) -> Complex:
        place, weight, _, _ = self._run(t)
        return self.poses.point(place, weight)

    def velocity(self, t: ArrayLike) -> Complex:
        place, weight, place_rate, weight_rate = self._run(t)
        with np.errstate(divide="ignore", invalid="ignore"):
            at: Complex = place / weight
            rates: Complex = np.divide(place_rate - at * weight_rate, weight)
        return self.poses.scaled[2] * rates

    def partner(self, t: ArrayLike) -> Complex:
        """Partners on the other curve.

        Parameters
        ----------
        t : array_like
            Parameters of this curve.

        Returns
        -------
        array of complex
            The pin on the body (in its frame) for a pivot, or the pivot for a pin, mm; very large if it is at infinity.
        """
        place, weight, _, _ = self._run(t)
        return self.poses.partner(place, weight)

    def partner_velocity(self, t: ArrayLike) -> Complex:
        """Velocity of the partner.

        Parameters
        ----------
        t : array_like
            Parameters of this curve.

        Returns
        -------
        array of complex
            mm per unit of t.
        """
        return self.poses.partner_rate(*self._run(t))

    def _run(self, t: ArrayLike) -> tuple[Complex, Real, Complex, Real]:
        return self.poses.cubic.run(self.loop, np.asarray(t, dtype=float))

    @property
    def breaks(self) -> Real:
        # Breaks are not needed, but curves are sampled between them, and a loop may have tight bends.
        return np.linspace(self.start, self.end, 9)

    @property
    def closed(self) -> bool:
        return self.end - self.start >= 2 * np.pi


@record(eq=False)
class Burmester:
    """Both Burmester curves of four poses within a limit, and the two slides.

    Every point of one curve has its partner on the other, so each curve alone gives all dyads.

    Parameters
    ----------
    fixed : tuple of BurmesterCurve
        Pieces of the centre-point curve, on the ground, mm.
    moving : tuple of BurmesterCurve
        Pieces of the circle-point curve, in the body's frame, mm.
    slides : Pairs
        Dyads with one end at infinity: the pin of the body whose four positions are collinear, and the pivot over which
        a straight line of the body slides; each only if it exists.
    """

    fixed: tuple[BurmesterCurve, ...]
    moving: tuple[BurmesterCurve, ...]
    slides: Pairs


@checked
def burmester_curves(poses: Poses, reach: PositiveFloat | None = None) -> Burmester:
    """Find the centre-point and circle-point curves of four poses, which are circular cubics.

    Parameters
    ----------
    poses : sequence of (complex, float)
        Four poses, each an origin x + yj in mm and an angle in rad; some may be parallel.
    reach : float, optional
        Largest distance of the curves from the middle of the poses' origins, on the ground and as the body sees it, mm;
        ten times the farthest origin by default.

    Returns
    -------
    Burmester
        Two or more pieces of each curve, none of which passes through infinity.

    Raises
    ------
    DesignError
        If every point of the plane is a solution: all four poses are parallel, or rotated about one point.

    Notes
    -----
    Burmester, Lehrbuch der Kinematik, 1888; Bottema and Roth, Theoretical Kinematics, 1979, chapter VIII; the tracing
    is derived here.

    Examples
    --------
    >>> from geomkin.synthesis import burmester_curves
    >>> curves = burmester_curves([(0j, 0.0), (40 + 20j, 0.5), (60 + 60j, 1.4), (40 + 90j, 1.9)])
    >>> all(curve.closed or curve.end > curve.start for curve in curves.fixed)
    True
    """
    z, u = distinct_poses(poses, 4, 4)
    ground, body = as_seen_by_ground_and_body(z, u)
    return Burmester(_pieces(ground, reach), _pieces(body, reach), slides_of(ground, body))


def as_seen_by_ground_and_body(z: Complex, u: Complex) -> tuple[FourPoses, FourPoses]:
    """Four poses as the ground sees them, and as the body does, from the middle of their origins."""
    middle = complex(z.mean())
    return FourPoses(z, u), FourPoses(*inverse(z - middle, u), middle)


def _pieces(poses: FourPoses, reach: float | None) -> tuple[BurmesterCurve, ...]:
    cubic, extent = poses.cubic, DEFAULT_EXTENT if reach is None else reach / poses.scaled[2]
    pieces = []
    for loop in cubic.loops:

        def inside(t: Real, loop: CubicBranch = loop) -> Real:
            place, weight, _, _ = cubic.run(loop, t)
            return extent * np.abs(weight) - np.abs(place)

        grid = 2 * np.pi * np.arange(SAMPLES) / SAMPLES
        near = np.geomspace(1e-12, 0.1, 60)
        for t in loop.at(cubic.infinity):
            grid = np.concatenate([grid, [t], t - near, t + near])
        for start, end in intervals_inside(inside, grid):
            # A piece of zero length is a point at which the curve touches the limit.
            if end - start > 1e-9:
                pieces.append(BurmesterCurve(poses, loop, start, end))
    return tuple(pieces)


def slides_of(ground: FourPoses, body: FourPoses) -> Pairs:
    """The dyad whose pivot is at infinity and the one whose pin is; without dyads whose both ends are at infinity."""
    directions = 1j * ground.cubic.axis, 1j * body.cubic.axis
    pin = ground.partner(np.array([directions[0]]), np.zeros(1))
    pivot = body.partner(np.array([directions[1]]), np.zeros(1))
    far: Mask = np.array([True, False])
    # The line is at right angles to the direction of its centre.
    fixed: Complex = np.array([1j * directions[0], pivot[0]])
    moving: Complex = np.array([pin[0], 1j * directions[1]])
    # For poses parallel in pairs such a pin or pivot can be at infinity too, which is no dyad.
    slides = Pairs(fixed, moving, far, ~far)
    is_finite = np.abs([pin[0], pivot[0]]) < FAR * np.array([ground.scaled[2], body.scaled[2]])
    return slides.at(is_finite & (missed(ground.origins, ground.directions, slides) <= MISSED * ground.scaled[2]))
