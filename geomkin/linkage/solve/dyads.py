"""The dyads: two bodies joined to each other and to two that are placed.

A dyad is one loop equation with two unknowns, angles or slides, so that its derivatives are a pair of linear equations,
whatever its joints. Positions are solved in closed form.
"""

from __future__ import annotations

from abc import abstractmethod
from functools import reduce
from typing import Any

import numpy as np

from ...core.records import record
from ...plane.vec import Complex, Real, Whole, cross, dot
from .placement import Anchor, Coefficients, Placement, Poses, SlideAxis

# The two members between which a transmission angle lies: each the two points of a bar, or the name of a slider.
JointLines = tuple[tuple[str, str] | str, tuple[str, str] | str]
# Sine of the angle between two rails below which rounding alone decides where they cross.
PARALLEL = 1e-14
# Distance of two pins, in sizes of the linkage, below which rounding alone decides the direction between them. After
# two dyads rounding is 3e-16, and more by the error amplification of a dyad at a bad angle, WORST at most. With a
# larger value poses of few digits are lost; with a smaller one rounding counts as a pose.
MEETING, WORST = 1e-14, 1e8


@record(eq=False)
class Dyad(Placement):
    """A placement that can close on two branches. joint: name of its inner joint; leader: a body that it turns."""

    joint: str
    joint_lines: JointLines

    @property
    @abstractmethod
    def leader(self) -> str: ...

    @abstractmethod
    def gaps(self, p0: Poses) -> tuple[Real, ...]:
        """Lengths, mm, by which the dyad closes: negative where it cannot, zero where its branches meet."""

    def reached(self, p0: Poses) -> Complex | None:
        return p0.direction[self.leader]


@record(eq=False)
class RRR(Dyad):
    """Two bars pinned together: intersection of two circles.

    base_1 + L1 = base_2 + L2, with L the bars as `arm` of their bodies. Branch +1: the pin lies left of the line from
    base_1 to base_2. Factors instead of differences of squares keep the digits of the bases' positions (Kahan,
    Miscalculating Area and Angles of a Needle-like Triangle).
    """

    bodies: tuple[str, str]
    arms: tuple[complex | Complex, complex | Complex]
    bases: tuple[Anchor, Anchor]

    @property
    def leader(self) -> str:
        return self.bodies[0]

    def _bars(self, p0: Poses) -> tuple[Complex, Complex]:
        return p0.direction[self.bodies[0]] * self.arms[0], p0.direction[self.bodies[1]] * self.arms[1]

    def place(self, p0: Poses, branch: Whole | int) -> None:
        w = self.bases[1].at(p0) - self.bases[0].at(p0)
        b, c, s = np.abs(self.arms[0]), np.abs(self.arms[1]), np.abs(w)
        with np.errstate(invalid="ignore", divide="ignore"):
            outer, inner = (b + c - s) * (b + c + s), (s - (b - c)) * (s + (b - c))
            r = _root(branch, outer, inner)
            bar = (1j * r + (s * s + (b - c) * (b + c))) * w / (2 * s * s)
        p0.direction[self.bodies[0]] = bar / self.arms[0]
        p0.direction[self.bodies[1]] = (bar - w) / self.arms[1]

    def gaps(self, p0: Poses) -> tuple[Real, ...]:
        b, c = np.abs(self.arms[0]), np.abs(self.arms[1])
        s = np.abs(self.bases[1].at(p0) - self.bases[0].at(p0))
        return b + c - s, s - np.abs(b - c)

    def first(self, p0: Poses, p1: Coefficients) -> None:
        bars = self._bars(p0)
        right = self.bases[1].first(p0, p1) - self.bases[0].first(p0, p1)
        p1.theta_prime[self.bodies[0]], p1.theta_prime[self.bodies[1]] = two_unknowns(
            1j * bars[0], -1j * bars[1], right
        )

    def second(self, p0: Poses, p1: Coefficients, p2: Coefficients) -> None:
        bars = self._bars(p0)
        h = p1.theta_prime[self.bodies[0]], p1.theta_prime[self.bodies[1]]
        right = self.bases[1].second(p0, p1, p2) - self.bases[0].second(p0, p1, p2)
        right = right + h[0] ** 2 * bars[0] - h[1] ** 2 * bars[1]
        p2.theta_prime[self.bodies[0]], p2.theta_prime[self.bodies[1]] = two_unknowns(
            1j * bars[0], -1j * bars[1], right
        )

    def joint_directions(self, p0: Poses) -> tuple[Complex, Complex]:
        return p0.direction[self.bodies[0]] * self.arms[0], p0.direction[self.bodies[1]] * self.arms[1]


@record(eq=False)
class RRP(Dyad):
    """A bar pinned to a body that slides: intersection of a circle and a line.

    base + L = start + x g, g the direction of the rail. Branch +1: the pin lies on the side of the base towards which
    the rail points.
    """

    body: str
    arm: complex | Complex
    base: Anchor
    start: Anchor
    rail: SlideAxis

    @property
    def leader(self) -> str:
        return self.body

    def place(self, p0: Poses, branch: Whole | int) -> None:
        g = self.rail.at(p0)
        apart = np.conj(g) * (self.start.at(p0) - self.base.at(p0))
        length, n = np.abs(self.arm), apart.imag
        r = _root(branch, (length - n) * (length + n))
        p0.direction[self.body] = (r + 1j * n) * g / self.arm

    def gaps(self, p0: Poses) -> tuple[Real, ...]:
        n = cross(self.rail.at(p0), self.start.at(p0) - self.base.at(p0))
        return np.abs(self.arm) - n, np.abs(self.arm) + n

    def first(self, p0: Poses, p1: Coefficients) -> None:
        p1.theta_prime[self.body] = self._solve(p0, self._right(p0, p1))[0]

    def _right(self, p0: Poses, p1: Coefficients) -> Complex:
        rotation = 1j * p1.theta_prime[self.rail.body] * (self._slide(p0) * self.rail.at(p0))
        return self.start.first(p0, p1) - self.base.first(p0, p1) + rotation

    def _slide(self, p0: Poses) -> Real:
        bar = p0.direction[self.body] * self.arm
        return dot(self.rail.at(p0), self.base.at(p0) + bar - self.start.at(p0))

    def _solve(self, p0: Poses, right: Complex) -> tuple[Real, Real]:
        return two_unknowns(1j * p0.direction[self.body] * self.arm, -self.rail.at(p0), right)

    def second(self, p0: Poses, p1: Coefficients, p2: Coefficients) -> None:
        h, sliding = self._solve(p0, self._right(p0, p1))
        g = self.rail.at(p0)
        theta_prime, theta_second = p1.theta_prime[self.rail.body], p2.theta_prime[self.rail.body]
        right = self.start.second(p0, p1, p2) - self.base.second(p0, p1, p2)
        right = right + h**2 * (p0.direction[self.body] * self.arm)
        # 2 i theta' sliding is the Coriolis term.
        right = right + (2j * theta_prime * sliding + (1j * theta_second - theta_prime**2) * self._slide(p0)) * g
        p2.theta_prime[self.body] = self._solve(p0, right)[0]

    def joint_directions(self, p0: Poses) -> tuple[Complex, Complex]:
        return 1j * p0.direction[self.body] * self.arm, self.rail.at(p0)


@record(eq=False)
class RPR(Dyad):
    """Two bodies, each pinned, that slide on each other: a line through one point at a distance from another.

    base_2 - base_1 = (x + i n) f, f the direction of the slide, n the distance of base_2 to the left of the line
    through base_1. Branch +1: x above 0. rotations: each body's direction relative to f. size: of the linkage, mm;
    before: the dyads that were placed before. Where the bases meet the direction is not defined.
    """

    bodies: tuple[str, str]
    rotations: tuple[complex | Complex, complex | Complex]
    offset: float | Real
    bases: tuple[Anchor, Anchor]
    size: Real
    before: tuple[Dyad, ...]

    @property
    def leader(self) -> str:
        return self.bodies[0]

    def _apart(self, p0: Poses) -> Complex:
        return self.bases[1].at(p0) - self.bases[0].at(p0)

    def _rail(self, p0: Poses) -> Complex:
        return p0.direction[self.bodies[0]] * np.conj(self.rotations[0])

    def place(self, p0: Poses, branch: Whole | int) -> None:
        ends = self.bases[0].at(p0), self.bases[1].at(p0)
        w = ends[1] - ends[0]
        s, n = np.abs(w), self.offset
        with np.errstate(invalid="ignore", divide="ignore"):
            angles = [angle for dyad in self.before if (angle := dyad.transmission_angle(p0)) is not None]
            amplification = 1 / np.maximum(np.sin(reduce(np.fmin, angles, np.asarray(0.5 * np.pi))), 1 / WORST)
            # Rounding is proportional to the distance of the ends, as on a slide driven far.
            w = np.where(s <= MEETING * amplification * (self.size + np.abs(ends[1])), np.nan, w)
            x = _root(branch, (s - n) * (s + n))
            f = w / (x + 1j * n)
        p0.direction[self.bodies[0]], p0.direction[self.bodies[1]] = f * self.rotations[0], f * self.rotations[1]

    def gaps(self, p0: Poses) -> tuple[Real, ...]:
        return (np.abs(self._apart(p0)) - np.abs(self.offset),)

    def first(self, p0: Poses, p1: Coefficients) -> None:
        right = self.bases[1].first(p0, p1) - self.bases[0].first(p0, p1)
        h, _ = two_unknowns(1j * self._apart(p0), self._rail(p0), right)
        p1.theta_prime[self.bodies[0]] = p1.theta_prime[self.bodies[1]] = h

    def second(self, p0: Poses, p1: Coefficients, p2: Coefficients) -> None:
        w, f, h = self._apart(p0), self._rail(p0), p1.theta_prime[self.bodies[0]]
        right = self.bases[1].first(p0, p1) - self.bases[0].first(p0, p1)
        sliding = dot(f, right - 1j * h * w)
        right = self.bases[1].second(p0, p1, p2) - self.bases[0].second(p0, p1, p2)
        # 2 i h sliding is the Coriolis term.
        right = right + h**2 * w - 2j * h * sliding * f
        h_2, _ = two_unknowns(1j * w, f, right)
        p2.theta_prime[self.bodies[0]] = p2.theta_prime[self.bodies[1]] = h_2

    def joint_directions(self, p0: Poses) -> tuple[Complex, Complex]:
        return 1j * self._apart(p0), self._rail(p0)


@record(eq=False)
class Crossed(Placement):
    """A body of known direction whose origin lies on two lines: start_1 + x g1 = start_2 + y g2 = origin."""

    joint_lines: JointLines
    body: str
    starts: tuple[Anchor, Anchor]
    rails: tuple[SlideAxis, SlideAxis]

    def _rails(self, p0: Poses) -> tuple[Complex, Complex]:
        return self.rails[0].at(p0), self.rails[1].at(p0)

    def _slides(self, p0: Poses) -> tuple[Real, Real]:
        g = self._rails(p0)
        return two_unknowns(g[0], -g[1], self.starts[1].at(p0) - self.starts[0].at(p0))

    def _sliding(self, p0: Poses, p1: Coefficients) -> tuple[Real, Real]:
        g, (x, y) = self._rails(p0), self._slides(p0)
        rates = p1.theta_prime[self.rails[0].body], p1.theta_prime[self.rails[1].body]
        right = self.starts[1].first(p0, p1) - self.starts[0].first(p0, p1)
        return two_unknowns(g[0], -g[1], right + 1j * rates[1] * y * g[1] - 1j * rates[0] * x * g[0])

    def place(self, p0: Poses, branch: Whole | int) -> None:
        g = self._rails(p0)
        # Parallel rails do not determine a position: their computed crossing would be rounding.
        slide = np.where(np.abs(cross(*g)) > PARALLEL, self._slides(p0)[0], np.nan)
        p0.origin[self.body] = self.starts[0].at(p0) + slide * g[0]

    def reached(self, p0: Poses) -> Complex | None:
        return p0.origin[self.body]

    def first(self, p0: Poses, p1: Coefficients) -> None:
        g, x, theta_prime = self.rails[0].at(p0), self._slides(p0)[0], p1.theta_prime[self.rails[0].body]
        sliding = self._sliding(p0, p1)[0]
        p1.origin[self.body] = self.starts[0].first(p0, p1) + (sliding + 1j * theta_prime * x) * g

    def second(self, p0: Poses, p1: Coefficients, p2: Coefficients) -> None:
        g, slides, sliding = self._rails(p0), self._slides(p0), self._sliding(p0, p1)

        def rotation(k: int) -> Complex:
            """Contribution of a rail's rotation, its Coriolis term first."""
            theta_prime, theta_second = p1.theta_prime[self.rails[k].body], p2.theta_prime[self.rails[k].body]
            return (2j * theta_prime * sliding[k] + (1j * theta_second - theta_prime**2) * slides[k]) * g[k]

        starts = self.starts[0].second(p0, p1, p2), self.starts[1].second(p0, p1, p2)
        x_2, _ = two_unknowns(g[0], -g[1], starts[1] - starts[0] + rotation(1) - rotation(0))
        p2.origin[self.body] = starts[0] + rotation(0) + x_2 * g[0]

    def joint_directions(self, p0: Poses) -> tuple[Complex, Complex]:
        return self._rails(p0)


def _root(branch: Whole | int, *squares: Real) -> Real:
    """The product of square roots on one branch, nan where a square is negative; 0 where the branch is 0."""
    r: Any = branch
    for square in squares:
        r = r * np.sqrt(np.where(square >= 0, square, np.nan))
    root: Real = r if np.ndim(branch) == 0 else np.where(branch == 0, 0.0, r)
    return root


def two_unknowns(a: Complex, b: Complex, right: Complex) -> tuple[Real, Real]:
    """Real x and y with x a + y b = right; not finite where a and b are parallel."""
    with np.errstate(invalid="ignore", divide="ignore"):
        determinant = cross(a, b)
        return cross(right, b) / determinant, cross(a, right) / determinant
