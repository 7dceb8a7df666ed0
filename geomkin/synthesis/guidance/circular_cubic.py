"""A plane cubic with a known point at infinity, traced completely: each real branch as a loop through infinity.

Lines through the known point meet the cubic in two more points, given by a square root: with (X, W) such a line,

    K = Y^2 L(X, W) + Y Q(X, W) + C(X, W),     Y = (-Q +- sqrt(Q^2 - 4 L C)) / 2 L,

and the real branches are where the quartic under the root is not negative: one loop for each interval of such lines,
out on one root and back on the other. If one such line is part of the cubic (that at infinity, or the axis of symmetry
of symmetrical poses), it is divided out, which leaves L, Q and C of one degree less. Derived here.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np

from ...core.records import record
from ...plane.vec import Complex, Real

# Relative size below which the coefficients of highest degree are rounding: the cubic is then a conic and the
# line at infinity. A larger value loses far points of a true cubic; a smaller one takes its direction from rounding.
CONIC = 1e-12
# Relative size of Q and C, where L is 0, below which that line is part of the cubic. A larger value reports a curve
# near a line and a circle as these; with a smaller one rounding makes the line an invisibly thin loop.
PART = 1e-10
# Squared slope below which the curve crosses itself. With a larger value points near a crossing keep their error; with
# a smaller one they are displaced at random.
CROSSING = 1e-8
# Argument below which (cos x - sinc x) / x is computed by its series, since the quotient loses digits.
FLAT = 1e-2


@record(eq=False)
class CubicBranch:
    """One real branch in homogeneous coordinates over 0 <= t <= 2 pi, where it closes.

    `middle`, `half`: the interval of directions psi of (X, W) = (sin psi, cos psi), run as middle - half cos t. half is
    nan for all directions: then psi is t times `turning`, on the root of one `sign`. `rest`: the quartic without the
    roots at the ends of the interval, by falling powers of X. If half is 0, the line itself is the branch.
    """

    middle: float
    half: float
    rest: Real
    sign: float = 1.0
    turning: float = 0.5

    def angle_and_root(self, t: Real) -> tuple[Real, Real, Real, Real]:
        """psi, its rate, the square root, and its rate, by t."""
        if np.isnan(self.half):
            psi, rate = self.turning * t, np.full_like(t, self.turning)
            ends, ends_rate = np.ones_like(t), np.zeros_like(t)
        else:
            h, sine, cosine = self.half, np.sin(t), np.cos(t)
            psi, rate = self.middle - h * cosine, h * sine
            # sin(psi - psi0) sin(psi1 - psi), whose root is smooth as sin t is.
            one, two = 2 * h * np.sin(0.5 * t) ** 2, 2 * h * np.cos(0.5 * t) ** 2
            product = np.sinc(one / np.pi) * np.sinc(two / np.pi)
            slope = (_sinc_rate(one) * np.sinc(two / np.pi) - np.sinc(one / np.pi) * _sinc_rate(two)) * rate
            root = np.sqrt(np.maximum(product, 1e-300))
            ends, ends_rate = h * sine * root, h * cosine * root + 0.5 * h * sine * slope / root
        value, change = _form(self.rest, psi)
        root = np.sqrt(np.maximum(value, 1e-300))
        total = self.sign * (ends_rate * root + 0.5 * ends * change * rate / root)
        return psi, rate, self.sign * ends * root, total

    def at(self, psi: float) -> list[float]:
        """The values of t, at most two, at which the lines have direction psi."""
        if self.half == 0:
            return [np.pi]
        if np.isnan(self.half):
            return [(psi + k * np.pi) / self.turning for k in (0, 1)]
        share = (self.middle - self.middle_near(psi)) / self.half
        return [float(np.arccos(share)), float(2 * np.pi - np.arccos(share))] if abs(share) <= 1 else []

    def middle_near(self, psi: float) -> float:
        """psi, changed by half turns to be nearest to the middle."""
        return float(psi - np.pi * np.rint((psi - self.middle) / np.pi))


@record(eq=False)
class Cubic:
    """K(v) = T(v, v, v) = 0 with v = (x, y, 1); tensor: (3, 3, 3), symmetric, circular: (x^2 + y^2)(l x + m y) + ..."""

    tensor: Real

    @cached_property
    def axis(self) -> complex:
        """The direction, unit complex, at right angles to that in which the curve goes to infinity."""
        # For a conic and the line at infinity every point there is on the curve, so any direction serves.
        return complex(np.exp(0.7j)) if self.is_conic else self._lead / abs(self._lead)

    @property
    def _lead(self) -> complex:
        return complex(self.tensor[0, 0, 0], self.tensor[1, 1, 1])

    @property
    def is_conic(self) -> bool:
        """Whether it is a conic and the line at infinity."""
        return bool(abs(self._lead) <= CONIC * np.abs(self.tensor).max())

    @cached_property
    def whole(self) -> tuple[Real, Real, Real]:
        """L, Q and C by falling powers of X, with y in the direction of infinity."""
        c, s = self.axis.real, self.axis.imag
        turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
        t = np.einsum("abc,ai,bj,ck->ijk", self.tensor, turn, turn, turn)
        line = 3 * np.array([t[0, 1, 1], t[1, 1, 2]])
        square = 3 * np.array([t[0, 0, 1], 2 * t[0, 1, 2], t[1, 2, 2]])
        return line, square, np.array([t[0, 0, 0], 3 * t[0, 0, 2], 3 * t[0, 2, 2], t[2, 2, 2]])

    @cached_property
    def line(self) -> float | None:
        """Direction psi of the line through the known point that is part of the cubic."""
        if self.is_conic:
            return 0.5 * np.pi
        line, square, cube = self.whole
        psi = float(np.arctan2(-line[1], line[0]))
        off = max(abs(_form(part, np.array(psi))[0]) for part in (square, cube))
        # Compared with both, since Q is only rounding for a curve that is symmetrical in the other direction too.
        return psi if off <= PART * np.abs([*square, *cube]).max() else None

    @cached_property
    def parts(self) -> tuple[Real, Real, Real]:
        """`whole` with that line divided out."""
        if self.line is None:
            return self.whole
        c, s = np.cos(self.line), np.sin(self.line)
        line, square, cube = (
            np.linalg.lstsq(c * np.eye(k, k - 1) - s * np.eye(k, k - 1, -1), part)[0]
            for k, part in zip((2, 3, 4), self.whole)
        )
        return line, square, cube

    @cached_property
    def loops(self) -> tuple[CubicBranch, ...]:
        """The real branches: one or two, or more where the curve crosses itself."""
        if self.line is None or self.is_conic:
            return self._curved
        return (CubicBranch(self.line, 0.0, np.ones(1)), *self._curved)

    @property
    def _curved(self) -> tuple[CubicBranch, ...]:
        line, square, cube = self.parts
        quartic = np.convolve(square, square) - 4 * np.convolve(line, cube)
        # The range of directions ends where the quartic is far from 0, so that no root is there.
        tries = np.pi * np.arange(9) / 9
        base = float(tries[np.argmax(np.abs(_form(quartic, tries)[0]))] - np.pi / 2)
        turned = _turned(quartic, base)
        if not np.abs(turned).max():
            return ()
        roots = np.roots(turned)
        real = np.sort(np.arctan(roots[roots.imag == 0].real)) + base
        if not len(real):
            if turned[0] <= 0:
                return ()
            # For a conic half a turn of the lines leads to the other root.
            if self.line is not None:
                return (CubicBranch(0.0, np.nan, quartic, turning=1.0),)
            return tuple(CubicBranch(0.0, np.nan, quartic, sign) for sign in (1.0, -1.0))
        ends = np.append(real, real[0] + np.pi)
        found = []
        for k, (start, end) in enumerate(zip(ends[:-1], ends[1:])):
            middle, half = 0.5 * (start + end), 0.5 * (end - start)
            value = float(_form(quartic, np.array([middle]))[0][0])
            if value <= 0 or half == 0:
                continue
            rest = np.ones(1)
            for psi in np.delete(real, [k, (k + 1) % len(real)]):
                rest = np.convolve(rest, [np.cos(psi), -np.sin(psi)])
            for pair in roots[roots.imag > 0]:
                factor = np.array([1.0, -2 * pair.real, abs(pair) ** 2])
                rest = np.convolve(rest, _turned(factor, -base))
            scale = value / (np.sin(half) ** 2 * float(_form(rest, np.array([middle]))[0][0]))
            found.append(CubicBranch(middle, half, scale * rest))
        return tuple(found)

    def run(self, loop: CubicBranch, t: Real) -> tuple[Complex, Real, Complex, Real]:
        """Homogeneous position x + iy, its weight, and the derivatives of both by t."""
        if loop.half == 0:
            along, across = np.sin(0.5 * t), np.cos(0.5 * t)
            x, w = np.sin(loop.middle), np.cos(loop.middle)
            return (
                self.axis * (x * across + 1j * along),
                w * across,
                0.5 * self.axis * (1j * across - x * along),
                -0.5 * w * along,
            )
        psi, rate, root, root_rate = loop.angle_and_root(t)
        x, w = np.sin(psi), np.cos(psi)
        (line, line_rate), (square, square_rate), (cube, cube_rate) = (_form(part, psi) for part in self.parts)
        line_rate, square_rate, cube_rate, x_rate, w_rate = (
            rate * each for each in (line_rate, square_rate, cube_rate, w, -x)
        )
        # Of two forms of the root, (-Q + r) / 2 L and 2 C / (-Q - r), the one without cancellation.
        near = root * square <= 0
        y = np.where(near, root - square, 2 * cube)
        y_rate = np.where(near, root_rate - square_rate, 2 * cube_rate)
        k = np.where(near, 2 * line, -square - root)
        k_rate = np.where(near, 2 * line_rate, -square_rate - root_rate)
        size = 1 / np.sqrt((x * k) ** 2 + y**2 + (w * k) ** 2 + 1e-300)
        place = size * self.axis * (x * k + 1j * y)
        place_rate = size * self.axis * (x_rate * k + x * k_rate + 1j * y_rate)
        return self._settled(place, size * w * k, place_rate, size * (w_rate * k + w * k_rate))

    def _settled(self, *run: Complex | Real) -> tuple[Complex, Real, Complex, Real]:
        """The results of `run` after a Newton step, since roots that nearly meet have only half of their digits."""
        place, weight, place_rate, weight_rate = run
        v = np.stack([place.real, place.imag, weight.real], axis=-1)
        rate = np.stack([place_rate.real, place_rate.imag, weight_rate.real], axis=-1)
        slope = 3 * np.einsum("abc,...a,...b->...c", self.tensor, v, v)
        value = np.einsum("...c,...c", slope, v) / 3
        steep = np.sum(slope**2, axis=-1)
        # At a self-crossing the slope is 0, and no step is taken.
        gain = np.divide(1.0, steep, out=np.zeros_like(steep), where=steep > CROSSING * np.abs(self.tensor).max() ** 2)
        v = v - slope * (value * gain)[..., None]
        rate = rate - slope * (np.sum(slope * rate, axis=-1) * gain)[..., None]
        return v[..., 0] + 1j * v[..., 1], v[..., 2], rate[..., 0] + 1j * rate[..., 1], rate[..., 2]

    @property
    def infinity(self) -> float:
        """The direction psi of the lines with a root at infinity."""
        if self.line is not None:
            return 0.5 * np.pi
        line = self.parts[0]
        return float(np.arctan2(-line[1], line[0]))


def _form(powers: Real, psi: Real) -> tuple[Real, Real]:
    """A form in (X, W) = (sin psi, cos psi) by falling powers of X, and its rate by psi."""
    x, w = np.sin(psi), np.cos(psi)
    degree = len(powers) - 1
    value, rate = np.zeros_like(x), np.zeros_like(x)
    for k, factor in enumerate(powers):
        i, j = degree - k, k
        value = value + factor * x**i * w**j
        rate = rate + factor * (
            (i * x ** (i - 1) * w ** (j + 1) if i else 0.0) - (j * x ** (i + 1) * w ** (j - 1) if j else 0.0)
        )
    return value, rate


def _turned(powers: Real, base: float) -> Real:
    """The form by directions from `base`: X = c X' + s W', W = -s X' + c W'."""
    c, s = np.cos(base), np.sin(base)
    total, degree = np.zeros(len(powers)), len(powers) - 1
    for k, factor in enumerate(powers):
        term = np.ones(1)
        for _ in range(degree - k):
            term = np.convolve(term, [c, s])
        for _ in range(k):
            term = np.convolve(term, [-s, c])
        total = total + factor * term
    return total


def _sinc_rate(x: Real) -> Real:
    """d/dx of sin x / x."""
    small = np.abs(x) < FLAT
    safe = np.where(small, 1.0, x)
    return np.where(small, -x / 3 + x**3 / 30 - x**5 / 840, (np.cos(safe) - np.sin(safe) / safe) / safe)


def intervals_inside(inside: Callable[[Real], Real], grid: Real) -> list[tuple[float, float]]:
    """Intervals of a loop over one turn, (start, end), in which `inside` is positive, found on a grid and by bisection.

    An interval across the loop's start ends beyond 2 pi. The whole turn is (0, 2 pi).
    """
    grid = np.unique(np.mod(grid, 2 * np.pi))
    good = inside(grid) > 0
    if good.all():
        return [(0.0, 2 * np.pi)]
    low, high = grid, np.append(grid[1:], grid[0] + 2 * np.pi)
    change = good != np.roll(good, -1)
    low, high, state = low[change], high[change], good[change]
    for _ in range(60):
        middle = 0.5 * (low + high)
        same = (inside(middle) > 0) == state
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    # The inner side of each border.
    border = np.where(state, low, high)
    starts, ends = border[~state], border[state]
    if not len(starts):
        return []
    if ends[0] < starts[0]:
        ends = np.append(ends[1:], ends[0] + 2 * np.pi)
    return [(float(a), float(b)) for a, b in zip(starts, ends)]
