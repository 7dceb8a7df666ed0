"""Burmester curves of four poses: the possible pivots on the ground, the possible pins on the body, and their pairs.

Each is a plane cubic with a known point at infinity, traced completely: each real branch as a loop through infinity.
Lines through the known point meet the cubic in two more points, given by a square root: with (X, W) such a line,

    K = Y^2 L(X, W) + Y Q(X, W) + C(X, W),     Y = (-Q +- sqrt(Q^2 - 4 L C)) / 2 L,

and the real branches are where the quartic under the root is not negative: one loop for each interval of such lines,
out on one root and back on the other. If one such line is part of the cubic (that at infinity, or the axis of symmetry
of symmetrical poses), it is divided out, which leaves L, Q and C of one degree less. Derived here.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from itertools import permutations

import numpy as np
from numpy.typing import ArrayLike

from ...core.arguments import PositiveFloat, checked
from ...core.errors import DesignError
from ...core.records import record
from ...plane.curve import AbstractCurve
from ...plane.vec import Complex, Mask, Real
from .constraint import FAR, Pairs, missed, normalised
from .poses import Poses, distinct_poses, inverse

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
