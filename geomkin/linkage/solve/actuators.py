"""Dyads one bar of which is a linear actuator: a cylinder and its rod, as one bar of driven length.

Nothing but the ground can stand before the actuator moves, so the dyad's two bases stand still and all of its motion
is in closed form by the place x of the rod: no angle of the drive is needed.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import ClassVar

import numpy as np

from ...core.errors import DesignError
from ...core.records import record
from ...plane.vec import Complex, Real, Whole, cross, dot
from .closing_roots import StrokeRoot, gap_of
from .dyads import RRP, RRR
from .input_dyads import DriverPoints, InputDyad
from .placement import Coefficients, Placement, Poses


@record(eq=False)
class Stroked:
    """A bar of driven length in the frame of the body at its outer pin: `start` + q `along`, along unit complex.

    Seen along the slide it is x + i n with x = q + ahead: n, left, is how far the slide passes by the outer pin.
    """

    start: complex | Complex
    along: complex | Complex

    @cached_property
    def ahead(self) -> Real:
        """x at q = 0, mm."""
        return dot(self.along, np.asarray(self.start))

    @cached_property
    def left(self) -> Real:
        """n, mm."""
        return cross(self.along, np.asarray(self.start))


@record(eq=False)
class ActuatedRRR(InputDyad):
    """An actuator and a bar pinned to it, on two points that stand still: a triangle with one driven side.

    With w from the actuator's base to the bar's, s = |w|, b the bar, c^2 = x^2 + n^2 the actuator's square:
    L_bar = w (c^2 - s^2 - b^2 + i r) / 2s^2, r = 4 times the triangle's area with the branch's sign, so
    r^2 = ((s + b)^2 - c^2) (c^2 - (s - b)^2). For a step of the rod the bar turns by -2 x / r, the actuator by
    (n - 2 x (L_bar . L) / r) / c^2. Derived here.
    """

    period: ClassVar[float] = 0.0
    dyad: RRR
    which: int
    arm: Stroked
    still: complex | Complex

    def __post_init__(self) -> None:
        if np.any(self.still == 0):
            raise DesignError(
                "bodies",
                f"the actuator and the bar that meet in {self.joint} stand on one place, so its stroke turns nothing",
                "move their other pins apart",
            )

    @property
    def leader(self) -> str:
        return self.dyad.bodies[self.which]

    @property
    def _side(self) -> int:
        """A branch is told from the first body's base: seen from the other end left is right."""
        return -1 if self.which else 1

    @cached_property
    def _sizes(self) -> tuple[Complex, Real, Real, Complex]:
        """w, the squares b^2 - s^2 and s^2 + b^2, and the bar in its body, seen along w."""
        w = np.asarray(self.still) * self._side
        s, b = np.abs(w), np.abs(self.dyad.arms[1 - self.which])
        return w, gap_of(self.follow, b, -s) * (b + s), s * s + b * b, w / self.dyad.arms[1 - self.which]

    @cached_property
    def _ends(self) -> tuple[Real, Real]:
        """x^2 at the utmost and at the least reach; what may vanish is exact."""
        s, b, n = np.abs(self.still), np.abs(self.dyad.arms[1 - self.which]), self.arm.left
        most = gap_of(self.follow, s, b, -n) * gap_of(self.follow, s, b, n)
        return most, gap_of(self.follow, s, -b, -n) * gap_of(self.follow, s, -b, n)

    def roots(self, p0: Poses, branch: Whole | int) -> StrokeRoot:
        return StrokeRoot(p0.drive + self.arm.ahead, *self._ends, branch, self.follow)

    def limits(self) -> list[float]:
        return [x - float(self.arm.ahead) for x in self.roots(Poses(), 1).limits()]

    def gaps(self, p0: Poses) -> tuple[Real, ...]:
        """Lengths, mm, by which it closes: what the actuator lacks to its utmost, and has over its least, length."""
        s, b = np.abs(self.still), np.abs(self.dyad.arms[1 - self.which])
        length = np.hypot(p0.drive + self.arm.ahead, self.arm.left)
        return s + b - length, length - np.abs(s - b)

    def place(self, p0: Poses, branch: Whole | int) -> None:
        (w, _, squares, bar_turn), root = self._sizes, self.roots(p0, branch)
        square = root.x**2 + self.arm.left**2
        over = 0.5 / np.abs(w) ** 2
        bar = (square - squares + 1j * self._side * root.r) * over
        p0.kept[self] = root, square
        p0.turn[self.dyad.bodies[1 - self.which]] = bar * bar_turn
        p0.turn[self.leader] = w * (1 + bar) / (self.arm.along * (root.x + 1j * self.arm.left))

    def _rates(self, p0: Poses) -> tuple[Real, Real, Real]:
        """L_bar . L, and the first coefficients of bar and actuator."""
        root, square = p0.kept[self]
        along = 0.5 * (square + self._sizes[1])
        bar = -2 * self._side * root.branch * root.share / root.f1
        return along, bar, (bar * along + self.arm.left) / square

    def first(self, p0: Poses, p1: Coefficients) -> None:
        _, p1.turn[self.dyad.bodies[1 - self.which]], p1.turn[self.leader] = self._rates(p0)

    def second(self, p0: Poses, p1: Coefficients, p2: Coefficients) -> None:
        (root, square), (along, bar, actuator) = p0.kept[self], self._rates(p0)
        gain = (root.share_rate + root.share * root.x / root.f1**2) / root.f1
        bar_2 = -2 * self._side * root.branch * gain
        p2.turn[self.dyad.bodies[1 - self.which]] = bar_2
        p2.turn[self.leader] = (bar_2 * along + root.x * (bar - 2 * actuator)) / square

    def meeting(self, p0: Poses) -> tuple[Complex, Complex]:
        bar = p0.turn[self.dyad.bodies[1 - self.which]] * self.dyad.arms[1 - self.which]
        return self._sizes[0] + bar, bar


@record(eq=False)
class ActuatedRRP(InputDyad):
    """An actuator on a point that stands still, pinned to a body that slides on a rail that does.

    Seen along the rail the actuator is r + i k, r^2 = c^2 - k^2, c^2 = x^2 + n^2: it turns by (n - k x / r) / c^2.
    Derived here.
    """

    period: ClassVar[float] = 0.0
    dyad: RRP
    arm: Stroked
    still: complex | Complex
    rail: complex | Complex

    @property
    def leader(self) -> str:
        return self.dyad.body

    @cached_property
    def _left(self) -> Real:
        """k, mm."""
        return cross(self.rail, np.asarray(self.still))

    def roots(self, p0: Poses, branch: Whole | int) -> StrokeRoot:
        k, n = self._left, self.arm.left
        least = gap_of(self.follow, k, -n) * gap_of(self.follow, k, n)
        return StrokeRoot(p0.drive + self.arm.ahead, np.asarray(np.inf), least, branch, self.follow)

    def limits(self) -> list[float]:
        return [x - float(self.arm.ahead) for x in self.roots(Poses(), 1).limits()]

    def gaps(self, p0: Poses) -> tuple[Real, ...]:
        """Length, mm, by which it closes: what the actuator has over its distance from the rail."""
        return (np.hypot(p0.drive + self.arm.ahead, self.arm.left) - np.abs(self._left),)

    def place(self, p0: Poses, branch: Whole | int) -> None:
        root = p0.kept[self] = self.roots(p0, branch)
        actuator = self.arm.along * (root.x + 1j * self.arm.left)
        p0.turn[self.leader] = (root.r + 1j * self._left) * self.rail / actuator

    def first(self, p0: Poses, p1: Coefficients) -> None:
        root = p0.kept[self]
        turning = self.arm.left - root.branch * root.share * self._left
        p1.turn[self.leader] = turning / (root.x**2 + self.arm.left**2)

    def second(self, p0: Poses, p1: Coefficients, p2: Coefficients) -> None:
        root, turn = p0.kept[self], p1.turn[self.leader]
        turning = -root.branch * root.share_rate * self._left - 2 * root.x * turn
        p2.turn[self.leader] = turning / (root.x**2 + self.arm.left**2)

    def meeting(self, p0: Poses) -> tuple[Complex, Complex]:
        actuator = self.arm.along * (p0.drive + self.arm.ahead + 1j * self.arm.left)
        return 1j * p0.turn[self.leader] * actuator, p0.turn[self.dyad.rail.body] * self.dyad.rail.direction


def actuated_dyad(
    dyad: RRR | RRP, which: int, arm: Stroked, ground: str, placed: Sequence[Placement], follow: bool
) -> InputDyad | None:
    """The dyad with its bar `which` as an actuator, on points that stand still; None where they do not.

    Of an RRP the only bar is 0.
    """
    points = DriverPoints(ground, placed)
    ends = [points.at(base) for base in (dyad.bases if isinstance(dyad, RRR) else (dyad.base, dyad.start))]
    if ends[0] is None or ends[1] is None:
        return None
    still = ends[1][0] - ends[0][0]
    if isinstance(dyad, RRR):
        return ActuatedRRR(dyad.joint, follow, dyad, which, arm, still)
    rail = points.turns.get(dyad.rail.body)
    return None if rail is None else ActuatedRRP(dyad.joint, follow, dyad, arm, still, rail[0] * dyad.rail.direction)
