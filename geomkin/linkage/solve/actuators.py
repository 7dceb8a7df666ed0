"""Dyads with a linear actuator as one bar: a cylinder and its rod form a bar of driven length.

Only the ground can be placed before the actuator moves, so the dyad's two bases are fixed and its whole motion is in
closed form by the rod's displacement x: no angle of the drive is needed.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from ...core.errors import DesignError
from ...core.records import record
from ...plane.vec import Complex, Real, Whole, cross, dot
from .dyads import RRP, RRR
from .input_dyads import DriverPoints, InputDyad, StrokeRoot, gap_of
from .placement import Coefficients, Placement, Poses


@record(eq=False)
class ActuatorBar:
    """A bar of driven length in the frame of the body at its outer pin: `start` + q `along`, along unit complex.

    Relative to the slide it is x + i n with x = q + offset: n, left, is the distance of the slide line from the outer
    pin.
    """

    start: complex | Complex
    along: complex | Complex

    @cached_property
    def offset(self) -> Real:
        """x at q = 0, mm."""
        return dot(self.along, self.start)

    @cached_property
    def left(self) -> Real:
        """n, mm."""
        return cross(self.along, self.start)


@record(eq=False)
class ActuatedRRR(InputDyad):
    """An actuator and a bar pinned to it, on two fixed points: a triangle with one driven side.

    With w from the actuator's base to the bar's, s = |w|, b the bar, c^2 = x^2 + n^2 the actuator's square: L_bar = w
    (c^2 - s^2 - b^2 + i r) / 2s^2, r = 4 times the triangle's area with the branch's sign, so r^2 = ((s + b)^2 - c^2)
    (c^2 - (s - b)^2). The angle of the bar has the derivative -2 x / r by x, that of the actuator (n - 2 x (L_bar . L)
    / r) / c^2. Derived here.
    """

    period: ClassVar[float] = 0.0
    dyad: RRR
    which: int
    arm: ActuatorBar
    constant: complex | Complex

    def __post_init__(self) -> None:
        if np.any(self.constant == 0):
            problem = f"the actuator and the bar that meet in {self.joint} have the same fixed pivot, so nothing turns"
            raise DesignError("bodies", problem, "move their other pins apart")

    @property
    def leader(self) -> str:
        return self.dyad.bodies[self.which]

    @property
    def _side(self) -> int:
        """A branch is defined from the first body's base: from the other end left is right."""
        return -1 if self.which else 1

    @cached_property
    def _sizes(self) -> tuple[Complex, Real, Real, Complex]:
        """w, the squares b^2 - s^2 and s^2 + b^2, and the bar in its body, relative to w."""
        w: Any = self.constant * self._side
        s, b = np.abs(w), np.abs(self.dyad.arms[1 - self.which])
        return w, gap_of(self.follow, b, -s) * (b + s), s * s + b * b, w / self.dyad.arms[1 - self.which]

    @cached_property
    def _ends(self) -> tuple[Real, Real]:
        """x^2 at the largest and at the least length; exact if they may vanish."""
        s, b, n = np.abs(self.constant), np.abs(self.dyad.arms[1 - self.which]), self.arm.left
        most = gap_of(self.follow, s, b, -n) * gap_of(self.follow, s, b, n)
        return most, gap_of(self.follow, s, -b, -n) * gap_of(self.follow, s, -b, n)

    def roots(self, p0: Poses, branch: Whole | int) -> StrokeRoot:
        return StrokeRoot(p0.drive + self.arm.offset, *self._ends, branch, self.follow)

    def limits(self) -> list[float]:
        return [x - float(self.arm.offset) for x in self.roots(Poses(), 1).limits()]

    def gaps(self, p0: Poses) -> tuple[Real, ...]:
        """Lengths, mm, by which the dyad closes: largest length less the actuator's, and the latter less the least."""
        s, b = np.abs(self.constant), np.abs(self.dyad.arms[1 - self.which])
        length = np.hypot(p0.drive + self.arm.offset, self.arm.left)
        return s + b - length, length - np.abs(s - b)

    def place(self, p0: Poses, branch: Whole | int) -> None:
        (w, _, squares, bar_turn), root = self._sizes, self.roots(p0, branch)
        square = root.x**2 + self.arm.left**2
        over = 0.5 / np.abs(w) ** 2
        bar = (square - squares + 1j * self._side * root.r) * over
        p0.cache[self] = root, square
        p0.direction[self.dyad.bodies[1 - self.which]] = bar * bar_turn
        p0.direction[self.leader] = w * (1 + bar) / (self.arm.along * (root.x + 1j * self.arm.left))

    def _rates(self, p0: Poses) -> tuple[Real, Real, Real]:
        """L_bar . L, and the first coefficients of bar and actuator."""
        root, square = p0.cache[self]
        along = 0.5 * (square + self._sizes[1])
        bar = -2 * self._side * root.branch * root.share / root.f1
        return along, bar, (bar * along + self.arm.left) / square

    def first(self, p0: Poses, p1: Coefficients) -> None:
        _, p1.theta_prime[self.dyad.bodies[1 - self.which]], p1.theta_prime[self.leader] = self._rates(p0)

    def second(self, p0: Poses, p1: Coefficients, p2: Coefficients) -> None:
        (root, square), (along, bar, actuator) = p0.cache[self], self._rates(p0)
        rate = (root.share_rate + root.share * root.x / root.f1**2) / root.f1
        bar_2 = -2 * self._side * root.branch * rate
        p2.theta_prime[self.dyad.bodies[1 - self.which]] = bar_2
        p2.theta_prime[self.leader] = (bar_2 * along + root.x * (bar - 2 * actuator)) / square

    def joint_directions(self, p0: Poses) -> tuple[Complex, Complex]:
        bar = p0.direction[self.dyad.bodies[1 - self.which]] * self.dyad.arms[1 - self.which]
        return self._sizes[0] + bar, bar


@record(eq=False)
class ActuatedRRP(InputDyad):
    """An actuator on a fixed point, pinned to a body that slides on a fixed rail.

    Relative to the rail the actuator is r + i k, r^2 = c^2 - k^2, c^2 = x^2 + n^2; the derivative of its angle is
    (n - k x / r) / c^2. Derived here.
    """

    period: ClassVar[float] = 0.0
    dyad: RRP
    arm: ActuatorBar
    constant: complex | Complex
    rail: complex | Complex

    @property
    def leader(self) -> str:
        return self.dyad.body

    @cached_property
    def _left(self) -> Real:
        """k, mm."""
        return cross(self.rail, self.constant)

    def roots(self, p0: Poses, branch: Whole | int) -> StrokeRoot:
        k, n = self._left, self.arm.left
        least = gap_of(self.follow, k, -n) * gap_of(self.follow, k, n)
        return StrokeRoot(p0.drive + self.arm.offset, np.asarray(np.inf), least, branch, self.follow)

    def limits(self) -> list[float]:
        return [x - float(self.arm.offset) for x in self.roots(Poses(), 1).limits()]

    def gaps(self, p0: Poses) -> tuple[Real, ...]:
        """Length, mm, by which the dyad closes: the actuator's length less its base's distance from the rail."""
        return (np.hypot(p0.drive + self.arm.offset, self.arm.left) - np.abs(self._left),)

    def place(self, p0: Poses, branch: Whole | int) -> None:
        root = p0.cache[self] = self.roots(p0, branch)
        actuator = self.arm.along * (root.x + 1j * self.arm.left)
        p0.direction[self.leader] = (root.r + 1j * self._left) * self.rail / actuator

    def first(self, p0: Poses, p1: Coefficients) -> None:
        root = p0.cache[self]
        numerator = self.arm.left - root.branch * root.share * self._left
        p1.theta_prime[self.leader] = numerator / (root.x**2 + self.arm.left**2)

    def second(self, p0: Poses, p1: Coefficients, p2: Coefficients) -> None:
        root, theta_prime = p0.cache[self], p1.theta_prime[self.leader]
        numerator = -root.branch * root.share_rate * self._left - 2 * root.x * theta_prime
        p2.theta_prime[self.leader] = numerator / (root.x**2 + self.arm.left**2)

    def joint_directions(self, p0: Poses) -> tuple[Complex, Complex]:
        actuator = self.arm.along * (p0.drive + self.arm.offset + 1j * self.arm.left)
        return 1j * p0.direction[self.leader] * actuator, p0.direction[self.dyad.rail.body] * self.dyad.rail.direction


def actuated_dyad(
    dyad: RRR | RRP, which: int, arm: ActuatorBar, ground: str, placed: Sequence[Placement], follow: bool
) -> InputDyad | None:
    """The dyad with its bar `which` as an actuator, on fixed points; None if they are not fixed.

    The only bar of an RRP is 0.
    """
    points = DriverPoints(ground, placed)
    ends = [points.at(base) for base in (dyad.bases if isinstance(dyad, RRR) else (dyad.base, dyad.start))]
    if ends[0] is None or ends[1] is None:
        return None
    between = ends[1][0] - ends[0][0]
    if isinstance(dyad, RRR):
        return ActuatedRRR(dyad.joint, dyad.joint_lines, follow, dyad, which, arm, between)
    rail = points.directions.get(dyad.rail.body)
    return (
        None
        if rail is None
        else ActuatedRRP(dyad.joint, dyad.joint_lines, follow, dyad, arm, between, rail[0] * dyad.rail.direction)
    )
