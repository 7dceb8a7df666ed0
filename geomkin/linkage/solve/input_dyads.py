"""Dyads that only the driver moves, in a form that stays accurate at a toggle.

The textbook forms use the diagonal's square a^2 + d^2 - 2 a d cos t and lose half the digits of position, and all of
those of velocity, as the linkage nears a toggle. Here every quantity that vanishes at a toggle is a product of factors,
and the constants among them are exact.

The roots decide whether a loop closes: they are real where it closes, and zero where its two branches meet, at a
limit of the driver or a change point.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from functools import cached_property
from typing import ClassVar, Protocol

import numpy as np

from ...core.records import record
from ...plane.vec import Complex, Mask, Real, Whole
from .dyads import RRP, RRR, Dyad
from .placement import (
    AlignedBody,
    Anchor,
    Coefficients,
    PinnedBody,
    Placement,
    Poses,
    RevoluteInput,
    compensated_sum,
    paired,
)


class ClosingRoot(Protocol):
    """The root of a loop over the frames."""

    @property
    def r(self) -> Real:
        """nan where the loop cannot close, zero at a limit and at a change point; its sign is the branch."""


@record(eq=False)
class Gaps:
    """Constants of a loop's two roots: f1^2 = d1 + k^2 cos^2 v and f2^2 = d2 + k^2 sin^2 v, v half the angle t.

    g1 and g2 are d1 + k^2 and d2 + k^2, exact. If a limit of v is nearer to the point where the cosine (sine) is 1 than
    to its zero, f^2 = g - k^2 sin^2 v (cos^2 v) has the smaller terms; far_1, far_2: for which linkages this is so. d1
    or d2 is zero if the linkage has a change point. If followed, the root then is k cos v or k sin v with its sign, and
    runs smoothly through zero; change_1, change_2: for which linkages this is so.
    """

    d1: Real
    d2: Real
    g1: Real
    g2: Real
    k: Real
    far_1: Mask | bool
    far_2: Mask | bool
    change_1: Mask | bool
    change_2: Mask | bool

    @classmethod
    def of(cls, d1: Real, d2: Real, g1: Real, g2: Real, k: Real, follow: bool) -> Gaps:
        """Gaps with their masks; False, the usual case, saves work later."""
        far = [mask if np.any(mask) else False for mask in (g1 < -d1, g2 < -d2)]
        changes = [d == 0 if follow and np.any(d == 0) else False for d in (d1, d2)]
        return cls(d1, d2, g1, g2, k, *far, *changes)


@record(eq=False)
class Roots:
    """The two roots over the frames. x = k cos v, y = k sin v; r = branch f1 f2, nan where the loop cannot close."""

    gaps: Gaps
    x: Real
    y: Real
    branch: Whole | int

    @cached_property
    def square_1(self) -> Real:
        """f1^2."""
        square = self.x * self.x + self.gaps.d1
        return square if self.gaps.far_1 is False else np.where(self.gaps.far_1, self.gaps.g1 - self.y * self.y, square)

    @cached_property
    def square_2(self) -> Real:
        """f2^2."""
        square = self.y * self.y + self.gaps.d2
        return square if self.gaps.far_2 is False else np.where(self.gaps.far_2, self.gaps.g2 - self.x * self.x, square)

    @cached_property
    def f1(self) -> Real:
        root = np.sqrt(self.square_1)
        return root if self.gaps.change_1 is False else np.where(self.gaps.change_1, self.x, root)

    @cached_property
    def f2(self) -> Real:
        root = np.sqrt(self.square_2)
        return root if self.gaps.change_2 is False else np.where(self.gaps.change_2, self.y, root)

    @cached_property
    def p1(self) -> Real:
        """x / f1, 1 at a change point."""
        ratio = self.x / self.f1
        return ratio if self.gaps.change_1 is False else np.where(self.gaps.change_1, 1.0, ratio)

    @cached_property
    def p2(self) -> Real:
        """y / f2, 1 at a change point."""
        ratio = self.y / self.f2
        return ratio if self.gaps.change_2 is False else np.where(self.gaps.change_2, 1.0, ratio)

    @cached_property
    def r(self) -> Real:
        return self.branch * (self.f1 * self.f2)

    @cached_property
    def tau(self) -> Real:
        """x y / r."""
        return self.branch * (self.p1 * self.p2)

    def tau_rate(self) -> Real:
        """Derivative of tau by t."""
        one = self.p1 * self.x * (self.branch * 0.5 * self.gaps.d2) / (self.square_2 * self.f2)
        two = self.p2 * self.y * (self.branch * 0.5 * self.gaps.d1) / (self.square_1 * self.f1)
        # A term with a constant of zero is zero in the limit, but 0/0 at the point itself.
        one = one if self.gaps.change_2 is False else np.where(self.gaps.change_2, 0.0, one)
        two = two if self.gaps.change_1 is False else np.where(self.gaps.change_1, 0.0, two)
        return one - two


@record(eq=False)
class StrokeRoot:
    """r = branch f1 f2 of an actuator's dyad, f1^2 = most - x^2 and f2^2 = x^2 - least; most may be infinite.

    change: if least is zero and followed, f2 is x with its sign, and r runs smoothly through zero.
    """

    x: Real
    most: Real
    least: Real
    branch: Whole | int
    follow: bool

    @cached_property
    def change(self) -> Mask | bool:
        return self.least == 0 if self.follow and np.any(self.least == 0) else False

    @cached_property
    def f1(self) -> Real:
        # Without an upper limit f1 is 1.
        bounded = np.isfinite(self.most)
        with np.errstate(invalid="ignore"):
            return np.sqrt(np.where(bounded, self.most - self.x * self.x, 1.0))

    @cached_property
    def f2(self) -> Real:
        with np.errstate(invalid="ignore"):
            root = np.sqrt(self.x * self.x - self.least)
        return root if self.change is False else np.where(self.change, self.x, root)

    @cached_property
    def r(self) -> Real:
        return self.branch * (self.f1 * self.f2)

    @cached_property
    def share(self) -> Real:
        """x / f2, 1 at a change point."""
        with np.errstate(all="ignore"):
            ratio = self.x / self.f2
        return ratio if self.change is False else np.where(self.change, 1.0, ratio)

    @cached_property
    def share_rate(self) -> Real:
        """Derivative of `share` by x."""
        with np.errstate(all="ignore"):
            rate = -self.least / (self.f2 * self.f2 * self.f2)
        return rate if self.change is False else np.where(self.change, 0.0, rate)

    def limits(self) -> list[float]:
        """Displacements x at which r vanishes; none at a change point."""
        squares = [float(self.most), float(self.least)]
        ends = [float(np.sqrt(square)) for square in squares if 0 < square < np.inf]
        return [x for end in ends for x in (end, -end)]


def half_limits(gaps: Gaps) -> list[float]:
    """Angles v, rad, over a period of t, at which one of the roots vanishes; none at a change point."""
    limits: list[float] = []
    for d, g, sine, cosine in ((gaps.d1, gaps.g1, gaps.g1, -gaps.d1), (gaps.d2, gaps.g2, -gaps.d2, gaps.g2)):
        if d < 0 <= g:
            v = float(np.arctan2(np.sqrt(sine), np.sqrt(cosine)))
            limits += [v, -v]
    return limits


def gap_of(follow: bool, *terms: Real) -> Real:
    """An exact sum of lengths; if followed, a sum that is only rounding is zero."""
    gap = compensated_sum(*terms)
    if not follow:
        return gap
    # 8 units in the last place, so that lengths such as 0.1 + 0.2 and 0.3 count as equal.
    return np.where(np.abs(gap) <= 8 * np.finfo(float).eps * sum(map(np.abs, terms)), 0.0, gap)


@record(eq=False)
class InputDyad(Dyad):
    """A dyad that only the driver moves. `follow`: whether it runs smoothly through change points.

    period: of the drive, rad; 0 if the driver slides.
    """

    period: ClassVar[float] = 2 * np.pi
    follow: bool

    @abstractmethod
    def roots(self, p0: Poses, branch: Whole | int) -> ClosingRoot:
        """The root of the loop at the drives of `p0`."""

    @abstractmethod
    def limits(self) -> list[float]:
        """Drives, within one period, at which the loop is fully stretched or folded and the driver turns back."""

    def sign_from(self, q: Real, sign: int) -> Whole:
        """The branch for which the followed root r starts with `sign`; at a change point it starts just after it."""
        if not q.size:
            return np.asarray(sign)
        later = q[0] + 1e-3 * (q[-1] - q[0] if q[-1] != q[0] else 1.0)
        with np.errstate(invalid="ignore"):
            r = [np.sign(self.roots(Poses(drive=np.asarray(t)), 1).r) for t in (q[0], later)]
        start = np.where(r[0] == 0, r[1], r[0])
        return np.where(np.isfinite(start) & (start != 0), start, 1) * sign


@record(eq=False)
class CrankDriven(InputDyad):
    """A dyad between points of the ground and of a driver that turns.

    The vector from its first base to its second is C + K e^{iq}: constant C and rotating K, mm.
    """

    constant: complex | Complex
    rotating: complex | Complex
    dyad: RRR | RRP

    @property
    def leader(self) -> str:
        return self.dyad.leader

    def gaps(self, p0: Poses) -> tuple[Real, ...]:
        return self.dyad.gaps(p0)

    def joint_directions(self, p0: Poses) -> tuple[Complex, Complex]:
        return self.dyad.joint_directions(p0)


@record(eq=False)
class DrivenRRR(CrankDriven):
    """Two bars on points of the ground and the driver: L1 - L2 = C + K e^{iq} for the drive q, a four-bar.

    In the textbook's letters, relative to C: b e3 - c e4 = u = d - a e^{it}, t = q + arg(-K / C). With s = |u|^2:
    b e3 = (p + i r / 2s) u, p = (s + b^2 - c^2) / 2s. The derivatives of the angles of e3 and e4 are
    h3 = psi' - p1 tau and h4 = psi' + p tau, psi' the derivative of the angle of u, tau = 2 a d sin t / r, p1 = 1 - p.
    """

    dyad: RRR

    @cached_property
    def _sizes(self) -> _Sizes:
        a, b, c, d = np.abs(self.rotating), np.abs(self.dyad.arms[0]), np.abs(self.dyad.arms[1]), np.abs(self.constant)
        d1 = gap_of(self.follow, b, c, -a, -d) * (a + b + c + d)
        d2 = gap_of(self.follow, d, -a, -b, c) * gap_of(self.follow, d, -a, b, -c)
        g1 = gap_of(self.follow, b, c, d, -a) * gap_of(self.follow, b, c, -d, a)
        g2 = gap_of(self.follow, d, a, -b, c) * gap_of(self.follow, d, a, b, -c)
        nearest, unequal = gap_of(self.follow, d, -a), gap_of(self.follow, b, -c)
        kite = (nearest == 0) & (unequal == 0)
        c_direction = self.constant / d
        half_turn = np.sqrt(-self.rotating * np.conj(self.constant) / (a * d) + 0j)
        return _Sizes(
            gaps=Gaps.of(d1, d2, g1, g2, 2 * np.sqrt(a * d), self.follow),
            half_turn=half_turn,
            straight=bool(np.all(half_turn == 1)),
            a=a,
            d=d,
            nearest=nearest,
            squares=0.5 * unequal * (b + c),
            difference=nearest * (a + d),
            directions=(c_direction / self.dyad.arms[0], c_direction / self.dyad.arms[1]),
            kite=kite if np.any(kite) else False,
        )

    def roots(self, p0: Poses, branch: Whole | int) -> Roots:
        half_turn, k, (cosine, sine) = self._sizes.half_turn, self._sizes.gaps.k, p0.half
        if not self._sizes.straight:
            cosine, sine = (
                half_turn.real * cosine - half_turn.imag * sine,
                half_turn.real * sine + half_turn.imag * cosine,
            )
        return Roots(self._sizes.gaps, k * cosine, k * sine, branch)

    def limits(self) -> list[float]:
        offset = 2 * float(np.angle(self._sizes.half_turn))
        return [2 * v - offset for v in half_limits(self._sizes.gaps)]

    def place(self, p0: Poses, branch: Whole | int) -> None:
        sizes, roots = self._sizes, self.roots(p0, branch)
        x, y = roots.x, roots.y
        square = y * y
        over = 0.5 / (square + sizes.nearest**2)  # 1 / 2s
        u = paired(square * (0.5 / sizes.d) + sizes.nearest, x * y * (-0.5 / sizes.d))
        p, r = 0.5 + 2 * sizes.squares * over, roots.r * over
        p0.cache[self] = roots, over, p
        bar = paired(p, r) * u
        if sizes.kite is not False:
            # Both circles coincide where u vanishes: r u / 2s has a limit there, from either side.
            limit = 0.5 * u + 0.25j * branch * roots.f1 / roots.p2 * (y - 1j * x) / sizes.d
            bar = np.where(sizes.kite, limit, bar)
        other = bar - u
        p0.direction[self.dyad.bodies[0]] = bar * sizes.directions[0]
        p0.direction[self.dyad.bodies[1]] = other * sizes.directions[1]

    def first(self, p0: Poses, p1: Coefficients) -> None:
        sizes, (roots, over, p) = self._sizes, p0.cache[self]
        psi = (roots.y * roots.y - 2 * sizes.a * sizes.nearest) * over
        if sizes.kite is not False:
            p, psi = np.where(sizes.kite, 0.5, p), np.where(sizes.kite, 0.5, psi)
        tau = roots.tau
        p1.theta_prime[self.dyad.bodies[0]], p1.theta_prime[self.dyad.bodies[1]] = (psi - (1 - p) * tau, p * tau + psi)

    def second(self, p0: Poses, p1: Coefficients, p2: Coefficients) -> None:
        sizes, (roots, over, p) = self._sizes, p0.cache[self]
        rate = roots.tau_rate()
        # (a d sin t / s)(1 - 2 psi' + (p1 - p) tau), whose bracket is zero for a kite.
        shared = (roots.x * roots.y) * (over * over) * (2 * sizes.difference - 4 * sizes.squares * roots.tau)
        if sizes.kite is not False:
            p, shared = np.where(sizes.kite, 0.5, p), np.where(sizes.kite, 0.0, shared)
        p2.theta_prime[self.dyad.bodies[0]], p2.theta_prime[self.dyad.bodies[1]] = (
            shared - (1 - p) * rate,
            p * rate + shared,
        )


@record(eq=False)
class _Sizes:
    """Constants of a four-bar, exact if they may vanish: nearest d - a, squares (b^2 - c^2) / 2, difference d^2 - a^2.

    half_turn: half the rotation from q to t; straight: whether it is zero. directions: from the bars relative to C to
    their bodies' directions. kite: whether both nearest and squares vanish.
    """

    gaps: Gaps
    half_turn: Complex
    straight: bool
    a: Real
    d: Real
    nearest: Real
    squares: Real
    difference: Real
    directions: tuple[Complex, Complex]
    kite: Mask | bool


@record(eq=False)
class DrivenRRP(CrankDriven):
    """A bar from a point of the driver to a slide on the ground: the slider-crank of that driver.

    Relative to the rail, L = x + C + K e^{iq} = r + i n with n = c + k sin t, t = q + arg K, and
    r^2 = (l - n)(l + n). The derivative of the angle of L is tau = k cos t / r.
    """

    dyad: RRP

    @cached_property
    def _sizes(self) -> tuple[Gaps, Real, Complex]:
        """Gaps, c, and the rotation from q to t, unit complex."""
        rail = np.conj(self.dyad.rail.direction)
        c, k, length = (rail * self.constant).imag, np.abs(self.rotating), np.abs(self.dyad.arm)
        rotation = rail * self.rotating / k
        d1, d2 = gap_of(self.follow, length, -c, -k), gap_of(self.follow, length, c, -k)
        g1, g2 = gap_of(self.follow, length, -c, k), gap_of(self.follow, length, c, k)
        return Gaps.of(d1, d2, g1, g2, np.sqrt(2 * k), self.follow), c, rotation

    def _turned(self, q: Real) -> tuple[Real, Real]:
        """Cosine and sine of t; the cosine keeps its digits near zero."""
        rotation, cosine, sine = self._sizes[2], np.cos(q), np.sin(q)
        if np.all(rotation == 1):
            return cosine, sine
        return rotation.real * cosine - rotation.imag * sine, rotation.real * sine + rotation.imag * cosine

    def roots(self, p0: Poses, branch: Whole | int) -> Roots:
        gaps, (cosine, sine) = self._sizes[0], self._turned(p0.drive)
        k = 0.5 * gaps.k**2
        # v = t/2 + pi/4: k^2 cos^2 v is k (1 - sin t). 1 - |sin t| is computed from the cosine, which keeps its digits.
        one_plus = 1 + np.abs(sine)
        one_minus = cosine * cosine / one_plus
        x, y = (
            np.sqrt(k * np.where(sine > 0, one_minus, one_plus)),
            np.sqrt(k * np.where(sine > 0, one_plus, one_minus)),
        )
        if gaps.change_1 is False and gaps.change_2 is False:
            return Roots(gaps, x, np.copysign(y, cosine), branch)
        # If followed, each needs its own sign: first the one that is far from zero, the other from the product.
        v = 0.5 * (p0.drive + np.angle(self._sizes[2])) + 0.25 * np.pi
        sign = np.copysign(1.0, np.where(sine > 0, np.sin(v), np.cos(v)))
        other = np.copysign(sign, sign * cosine)
        return Roots(gaps, x * np.where(sine > 0, other, sign), y * np.where(sine > 0, sign, other), branch)

    def limits(self) -> list[float]:
        return [2 * v - 0.5 * np.pi - float(np.angle(self._sizes[2])) for v in half_limits(self._sizes[0])]

    def place(self, p0: Poses, branch: Whole | int) -> None:
        gaps, c, _ = self._sizes
        roots = p0.cache[self] = self.roots(p0, branch)
        n = c + 0.5 * gaps.k**2 * self._turned(p0.drive)[1]
        if gaps.far_1 is not False or gaps.far_2 is not False:
            # The squares of the roots are l - n and l + n, whose terms are then smaller than c and k.
            n = np.where(gaps.far_1 | gaps.far_2, 0.5 * (roots.square_2 - roots.square_1), n)
        p0.direction[self.dyad.body] = paired(roots.r, n) * (self.dyad.rail.direction / self.dyad.arm)

    def first(self, p0: Poses, p1: Coefficients) -> None:
        p1.theta_prime[self.dyad.body] = p0.cache[self].tau

    def second(self, p0: Poses, p1: Coefficients, p2: Coefficients) -> None:
        p2.theta_prime[self.dyad.body] = p0.cache[self].tau_rate()


def driver_dyad(dyad: RRR | RRP, ground: str, placed: Sequence[Placement], follow: bool) -> InputDyad | None:
    """The dyad as one that only the driver moves; None if it is not. placed: the placements before it."""
    points = DriverPoints(ground, placed)
    if isinstance(dyad, RRR):
        ends = [points.at(base) for base in dyad.bases]
    elif dyad.rail.body == ground:
        ends = [points.at(dyad.base), points.at(dyad.start)]
    else:
        return None
    if ends[0] is None or ends[1] is None:
        return None
    constant, rotating = ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]
    if np.any(rotating == 0):
        return None
    if isinstance(dyad, RRP):
        return DrivenRRP(dyad.joint, dyad.joint_lines, follow, constant, rotating, dyad)
    return None if np.any(constant == 0) else DrivenRRR(dyad.joint, dyad.joint_lines, follow, constant, rotating, dyad)


# C and K of a point or direction C + K e^{iq} for the drive q: K = 0 if it is fixed, C = 0 if it turns with the driver.
DriverTerms = tuple[complex | Complex, complex | Complex]


class DriverPoints:
    """Points that are C + K e^{iq}: those of the ground and of a driver that turns on it."""

    def __init__(self, ground: str, placed: Sequence[Placement]):
        # Directions and origins of the bodies that are fixed or turn with the driver.
        self.directions: dict[str, DriverTerms] = {ground: (1, 0)}
        self.origins: dict[str, DriverTerms] = {ground: (0, 0)}
        for placement in placed:
            if isinstance(placement, RevoluteInput):
                self.directions[placement.body] = (0, 1)
            elif isinstance(placement, AlignedBody) and placement.with_body in self.directions:
                constant, rotating = self.directions[placement.with_body]
                self.directions[placement.body] = (constant * placement.rotation, rotating * placement.rotation)
            elif isinstance(placement, PinnedBody) and placement.body in self.directions:
                pin = self.at(placement.pin)
                if pin is not None:
                    constant, rotating = self.directions[placement.body]
                    self.origins[placement.body] = (
                        pin[0] - constant * placement.local,
                        pin[1] - rotating * placement.local,
                    )

    def at(self, anchor: Anchor) -> DriverTerms | None:
        """A point as C and K; None if it moves otherwise."""
        arms = ((anchor.body, anchor.place), *anchor.arms)
        if anchor.body not in self.origins or any(body not in self.directions for body, _ in arms):
            return None
        constant, rotating = self.origins[anchor.body]
        for body, local in arms:
            constant, rotating = (
                constant + self.directions[body][0] * local,
                rotating + self.directions[body][1] * local,
            )
        return constant, rotating
