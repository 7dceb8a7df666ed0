"""Burmester's curves of four poses: where pivots on the ground and pins on the body may lie, and which go together."""

from __future__ import annotations

from functools import cached_property
from itertools import permutations

import numpy as np
from numpy.typing import ArrayLike

from ...core.arguments import Positive, checked
from ...core.errors import DesignError
from ...core.records import record
from ...plane.curve import AbstractCurve
from ...plane.vec import Complex, Mask, Real
from .circular_cubic import Cubic, Loop, crossings
from .constraint import FAR, Pairs, missed, normalised
from .poses import Poses, inverse, placed

# What a curve is cut off at unless it is said, in sizes of the poses.
REACH = 10.0
# Largest coefficient of a cubic, of unit sizes, that is rounding: then every point of the plane is one of the curve.
NOTHING = 1e-13
# Miss of a slide, in sizes, beyond which it is none. Smaller, and slides of pins far away are lost to rounding.
MISSED = 1e-5
# Places of a loop that are looked at for where it leaves its reach. Fewer, and a curve that peeps in or out is missed.
LOOKED_AT = 2000


@record(eq=False)
class FourPoses:
    """Four poses (n,) and the cubic of the places that are pivots, in unit sizes about their middle.

    Where the body sees these as poses of the ground the pivots are pins on the body, and their pins its pivots, which
    have their places from `partner_origin`, mm.
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
        """The four places of a pivot on the body lie on a circle: the determinant that says so."""
        z, u = self.scaled[0], np.conj(self.directions)
        step, turn = z[1:] - z[0], u[1:] - u[0]
        shift = u[1:] * z[1:] - u[0] * z[0]
        # Of each pose, in its difference to the first: |g|^2, g x and g y, with g = conj(u) (f - z).
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
        if np.abs(tensor).max() <= NOTHING * size:
            why = "every point is a pin of some dyad: they are parallel on one circle, or turned about one point"
            raise DesignError("poses", why, "give other poses, or take `dyads_through` with fixed or moving")
        return Cubic(tensor / np.abs(tensor).max())

    def point(self, place: Complex, weight: Real) -> Complex:
        """Places place / weight in unit sizes, mm."""
        _, middle, size = self.scaled
        with np.errstate(divide="ignore", invalid="ignore"):
            points: Complex = middle + size * (place / weight)
        return points

    def partner(self, place: Complex, weight: Real) -> Complex:
        """The pins on the body that pivots place / weight, in unit sizes, belong to, mm; weight 0 is at infinity."""
        return self.partner_origin + self._solved(*self._asked(place, weight)) * self.scaled[2]

    def partner_rate(self, place: Complex, weight: Real, place_rate: Complex, weight_rate: Real) -> Complex:
        """How fast these move, from the rates of their pivots."""
        factor, right = self._asked(place, weight)
        m = self._solved(factor, right)
        factor_rate, right_rate = self._asked(place_rate, weight_rate)
        return self._solved(factor, right_rate - (factor_rate * m[..., None]).real) * self.scaled[2]

    def _asked(self, place: Complex, weight: Real) -> tuple[Complex, Real]:
        """At each pose Re(factor m) = right, both less their mean: the distance from the pivot is left open."""
        z, u = self.scaled[0], self.directions
        f, w = place[..., None], weight[..., None]
        factor = 2 * u * np.conj(w * z - f)
        right = 2 * (np.conj(f) * z).real - w * np.abs(z) ** 2
        return factor - factor.mean(axis=-1, keepdims=True), right - right.mean(axis=-1, keepdims=True)

    @staticmethod
    def _solved(factor: Complex, right: Real) -> Complex:
        """Least squares along the two ways that do not disturb each other, so that few digits are lost."""
        half = np.exp(-0.5j * np.angle(np.sum(factor**2, axis=-1)))
        along = factor * half[..., None]
        with np.errstate(divide="ignore", invalid="ignore"):
            x = np.sum(along.real * right, axis=-1) / np.sum(along.real**2, axis=-1)
            y = -np.sum(along.imag * right, axis=-1) / np.sum(along.imag**2, axis=-1)
        pin: Complex = (x + 1j * y) * half
        return pin


@record(checked=True, eq=False)
class BurmesterCurve(AbstractCurve):
    """A piece of a centre-point or circle-point curve; t from `start` to `end`, whose unit has no meaning.

    `partner` gives the point of the other curve that belongs to each: the pin on the body to a pivot on the ground,
    or the pivot to a pin; pivots in mm on the ground, pins in mm in the body's own frame. A branch that runs through
    infinity is cut where it leaves its reach, and so are its pieces. Its velocity is nan where it crosses itself.
    """

    poses: FourPoses
    loop: Loop
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
        """The point of the other curve that belongs to this one, mm; very large where it is at infinity."""
        place, weight, _, _ = self._run(t)
        return self.poses.partner(place, weight)

    def partner_velocity(self, t: ArrayLike) -> Complex:
        """How fast that one runs, mm per unit of t."""
        return self.poses.partner_rate(*self._run(t))

    def _run(self, t: ArrayLike) -> tuple[Complex, Real, Complex, Real]:
        return self.poses.cubic.run(self.loop, np.asarray(t, dtype=float))

    @property
    def breaks(self) -> Real:
        # None are needed; between them curves are looked at in so many places, and a loop may have tight bends.
        return np.linspace(self.start, self.end, 9)

    @property
    def closed(self) -> bool:
        return self.end - self.start >= 2 * np.pi


@record(eq=False)
class Burmester:
    """Both curves of four poses, whole within their reach, and the two slides, which have one end at infinity.

    fixed: pieces of the centre-point curve, on the ground. moving: pieces of the circle-point curve, in the body's own
    frame. Every point of either has its partner on the other one, so that each curve alone tells all dyads.
    slides: of the curves' points at infinity: the pin of the body that runs along a straight line through its four
    places, and the pivot that a straight line of the body runs through; each only where there is one.
    """

    fixed: tuple[BurmesterCurve, ...]
    moving: tuple[BurmesterCurve, ...]
    slides: Pairs


@checked
def burmester_curves(poses: Poses, reach: Positive | None = None) -> Burmester:
    """Centre-point and circle-point curve of four poses (origin x + yj in mm, angle in rad): circular cubics.

    reach: how far from the middle of the poses' origins, on the ground, and of the places in which the body sees that
    middle, they are drawn, mm; ten times the farthest of these origins unless given. Two, three or more pieces
    each, none of which runs through infinity. Parallel poses among the four put poles at infinity, and are as good as
    others. DesignError where there is no curve, as every point of the plane would do: all four parallel, or turned
    about one point. Burmester, Lehrbuch der Kinematik, 1888; Bottema and Roth, Theoretical Kinematics, 1979, chapter
    VIII; how they are traced is derived here.
    """
    z, u = placed(poses, 4, 4)
    ground, body = both_ways(z, u)
    return Burmester(_pieces(ground, reach), _pieces(body, reach), slides_of(ground, body))


def both_ways(z: Complex, u: Complex) -> tuple[FourPoses, FourPoses]:
    """Four poses as the ground sees them, and as the body does, from the middle of their origins."""
    middle = complex(z.mean())
    return FourPoses(z, u), FourPoses(*inverse(z - middle, u), middle)


def _pieces(poses: FourPoses, reach: float | None) -> tuple[BurmesterCurve, ...]:
    cubic, far = poses.cubic, REACH if reach is None else reach / poses.scaled[2]
    found = []
    for loop in cubic.loops:

        def inside(t: Real, loop: Loop = loop) -> Real:
            place, weight, _, _ = cubic.run(loop, t)
            return far * np.abs(weight) - np.abs(place)

        grid = 2 * np.pi * np.arange(LOOKED_AT) / LOOKED_AT
        near = np.geomspace(1e-12, 0.1, 60)
        for t in loop.at(cubic.infinity):
            grid = np.concatenate([grid, [t], t - near, t + near])
        for start, end in crossings(inside, grid):
            # A piece of no length is where the curve touches its reach.
            if end - start > 1e-9:
                found.append(BurmesterCurve(poses, loop, start, end))
    return tuple(found)


def slides_of(ground: FourPoses, body: FourPoses) -> Pairs:
    """The dyad whose pivot, then that whose pin is at infinity; none where both of its ends are."""
    way = 1j * ground.cubic.axis, 1j * body.cubic.axis
    pin = ground.partner(np.array([way[0]]), np.zeros(1))
    pivot = body.partner(np.array([way[1]]), np.zeros(1))
    far: Mask = np.array([True, False])
    # A line runs square to where its centre is.
    fixed: Complex = np.array([1j * way[0], pivot[0]])
    moving: Complex = np.array([pin[0], 1j * way[1]])
    # Of poses parallel in pairs, and the like, such a pin or pivot is at infinity too: then it is no dyad.
    slides = Pairs(fixed, moving, far, ~far)
    near = np.abs([pin[0], pivot[0]]) < FAR * np.array([ground.scaled[2], body.scaled[2]])
    return slides.at(near & (missed(ground.origins, ground.directions, slides) <= MISSED * ground.scaled[2]))
