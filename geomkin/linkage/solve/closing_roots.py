"""The roots that decide whether a loop closes, accurate near a toggle or a change point.

A root is real where the loop closes, and zero where its two branches meet: at a limit of the driver or a change point.
"""

from __future__ import annotations

from functools import cached_property
from typing import Protocol

import numpy as np

from ...core.records import record
from ...plane.vec import Mask, Real, Whole
from .recording import compensated_sum


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
