"""Newton-Raphson, and continuation of poses along a path, past the limits of the driver.

A path is parametrised by its own length and not by the drive (pseudo-arclength continuation: Keller, Numerical solution
of bifurcation and nonlinear eigenvalue problems, 1977).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from ...core.arguments import AnyFloat, checked
from ...core.errors import DesignError, shown
from ...core.records import record
from ...plane.vec import Mask, Real

# From points (k, n + 1), n unknowns and the drive, to conditions (k, n) and their slopes (k, n, n + 1).
Equations = Callable[[Real], tuple[Real, Real]]

# Longest step, and the largest rotation of the path in one, rad; with larger ones a step may land on a nearby path.
LONGEST, MOST_TURN = 0.1, 0.15
# Steps this short pass straight over a point where paths cross, if the path turns by no more than STRAIGHT, rad, in
# them. With shorter ones rounding hides the path's direction; with longer ones paths that only pass each other would
# count as crossing. So sizes meet a change point to about 1e-12.
CROSSED, STRAIGHT = 3e-5, 1e-3
# Steps this short are as small as rounding and end the path. This occurs only at the limit of a dyad before the loops.
SHORTEST = 1e-13
# Newton's last step towards the path, as a share of the step along it; the remaining error is its square. If the drive
# moves by less than SLOW of the path's length, the direction determines the limit, and steps go on to rounding.
NEAR_ENOUGH, SLOW = 1e-5, 1e-3
# Accuracy of a position between two points, as a share of their distance, and the number of steps: it is only a first
# guess.
CLOSE, HALVINGS = 1e-9, 30
# Steps of an iteration: it needs three or four, or near a singular point one for each bit.
STEPS = 60
# Upper limit of the unknowns of `newton_raphson`: their matrix takes 0.2 GB.
MOST_UNKNOWNS = 5_000
# Size of Newton's last step, relative to the unknowns. The error after it is its square, below rounding.
SETTLED = 3e-9
# Largest number of points of a path in one direction: half of them cover forty turns.
MOST = 12_000
# Error, as a share of the linkage's size, below which Newton's steps are not damped: each then squares the error.
NEAR = 1e-2
# Shortest damped step, as a share of the whole one, before the iteration gives up.
SHORTEST_SHARE = 1e-3


@record(eq=False)
class Root:
    """Result of `newton_raphson`.

    Parameters
    ----------
    value : array, shape (n,)
        The last iterate.
    converged : bool
        Whether the last step was within the tolerance.
    residual : float
        Largest |f| at `value`.
    path : array, shape (steps + 1, n)
        All iterates, the estimate first.
    """

    value: Real
    converged: bool
    residual: float
    path: Real


@checked
def newton_raphson(
    f: Callable[[Real], ArrayLike],
    jacobian: Callable[[Real], ArrayLike],
    estimate: AnyFloat,
    tolerance: float = 1e-13,
    steps: int = 50,
) -> Root:
    """Solve f(x) = 0 by Newton's method in several unknowns, without damping.

    Parameters
    ----------
    f : callable
        Takes x, (n,), and returns n numbers.
    jacobian : callable
        Takes x and returns df/dx, (n, n).
    estimate : float or array_like, shape (n,)
        Start of the iteration; at most 5000 unknowns.
    tolerance : float
        Converged if a step is at most this share of the size of x (of 1 near zero).
    steps : int
        Largest number of steps.

    Returns
    -------
    Root
        If J is singular or f is not finite the iteration stops with `converged` False, and `value` is the point at
        which that happened.

    Raises
    ------
    DesignError
        If the estimate has another shape, or a function returns something else.

    Notes
    -----
    Press and others, Numerical Recipes, section 9.6.

    Examples
    --------
    >>> import geomkin as gk
    >>> root = gk.linkage.newton_raphson(lambda x: x**2 - 2, lambda x: 2 * x, 1.0)
    >>> root.converged, float(root.value[0].round(6))
    (True, 1.414214)
    """
    if np.ndim(estimate) > 1 or not np.size(estimate):
        raise DesignError("estimate", f"found shape {np.shape(estimate)}", "give a number or a row (n,)", "wrong-type")
    if (count := np.size(estimate)) > MOST_UNKNOWNS:
        raise DesignError("estimate", f"found {count:,} unknowns", f"give at most {MOST_UNKNOWNS:,}", "too-much-work")
    x = np.atleast_1d(np.asarray(estimate, dtype=float)).copy()
    path = [x]
    converged = False
    for _ in range(steps):
        value = _numbers("f", f(x), (count,))
        slope = _numbers("jacobian", jacobian(x), (count, count))
        try:
            step = np.linalg.solve(slope, value)
        except np.linalg.LinAlgError:
            break
        if not np.isfinite(step).all():
            break
        x = x - step
        path.append(x)
        if np.abs(step).max() <= tolerance * max(1.0, float(np.abs(x).max())):
            converged = True
            break
    return Root(x, converged, float(np.abs(_numbers("f", f(x), (count,))).max()), np.array(path))


def _numbers(name: str, given: ArrayLike, shape: tuple[int, ...]) -> Real:
    """The result of a caller's function as an array; DesignError, named after the function, if that is not possible."""
    try:
        return np.asarray(given, dtype=float).reshape(shape)
    except (TypeError, ValueError):
        wanted = " x ".join(map(str, shape))
        raise DesignError(name, f"returned {shown(given)}", f"return {wanted} real numbers", "wrong-type") from None


def solved(matrices: Real, right: Real) -> Real:
    """x with matrix x = right for all (k, n, n) and (k, n); nan where a matrix is singular or not finite."""
    solution = np.full(right.shape, np.nan)
    if np.isfinite(matrices).all() and np.isfinite(right).all():
        try:
            return np.linalg.solve(matrices, right[..., None])[..., 0]
        except np.linalg.LinAlgError:
            pass
    regular: Mask = np.logical_and(np.isfinite(matrices).all(axis=(1, 2)), np.isfinite(right).all(axis=1))
    # A sign of zero means a pivot of zero, for which `solve` would refuse all matrices.
    regular[regular] = np.linalg.slogdet(matrices[regular])[0] != 0
    solution[regular] = np.linalg.solve(matrices[regular], right[regular][..., None])[..., 0]
    return solution


def polished_points(equations: Equations, points: Real, known: tuple[Real, Real] | None = None) -> Real:
    """Unknowns, (k, n), at the drives of points near a path, (k, n + 1), to rounding; nan where the iteration fails.

    known: values and slopes of the equations at the points, if available.
    """
    points = points.copy()
    active, last, missed = np.arange(len(points)), np.full(len(points), np.inf), np.full(len(points), np.inf)
    converged = np.zeros(len(points), bool)
    for _ in range(STEPS):
        (value, slopes), known = known or equations(points[active]), None
        step = solved(slopes[..., :-1], value)
        size, missed[active] = np.abs(step).max(axis=1), np.abs(value).max(axis=1)
        # Steps that no longer shrink are rounding. Close to a limit they only halve.
        shrinking = np.isfinite(size) & ((size < 0.9 * last) | (missed[active] > 1e-12))
        active, size = active[shrinking], size[shrinking]
        points[active, :-1] -= step[shrinking]
        rough = size > SETTLED * np.maximum(1, np.abs(points[active]).max(axis=1))
        converged[active[~rough]] = True
        active, last = active[rough], size[rough]
        if not active.size:
            break
    return np.where((converged | (missed <= 1e-10))[:, None], points[:, :-1], np.nan)


def approached(equations: Equations, point: Real) -> Real:
    """Unknowns, (1, n), at the drive of a point, (1, n + 1), far from a path; nan if the iteration fails.

    Newton's steps are halved until the error decreases: undamped steps may go far away and come back, and then the last
    bit of a processor's arithmetic decides between two poses.
    """
    known = value, slopes = equations(point)
    for _ in range(STEPS):
        missed, share = np.linalg.norm(value), 1.0
        if missed < NEAR or not np.isfinite(step := solved(slopes[..., :-1], value)).all():
            break
        while share > SHORTEST_SHARE:
            trial = np.append(point[:, :-1] - share * step, point[:, -1:], axis=1)
            value, slopes = equations(trial)
            if np.linalg.norm(value) < missed:
                break
            share *= 0.5
        else:
            break
        point, known = trial, (value, slopes)
    return polished_points(equations, point, known)


class Trace:
    """All poses that a continuous motion reaches from `start`, (n + 1,): n unknowns and, last, the drive.

    The path is followed in both directions to the driver's limits, no further than requested. Its points depend only on
    the start, so the limits do as well. Unknowns and drive should be of similar magnitude.
    """

    def __init__(self, equations: Equations, start: Real):
        self._equations = equations
        _, slopes = equations(start[None])
        # At a limit of a dyad before the loops the direction is unknown: the path ends there in both directions.
        along = np.linalg.svd(slopes[0])[2][-1] if np.isfinite(slopes).all() else np.zeros(len(start))
        along = along * np.copysign(1.0, along[-1])
        side = _side(slopes[0], along)
        self._arms = [_Arm(equations, start, sense * side, sense * along, sense) for sense in (-1, 1)]

    def at(self, drive: Real) -> Real:
        """Unknowns, (frames, n), at drives (frames,); nan beyond the limits."""
        for arm in self._arms:
            arm.follow(float(np.max(arm.sense * drive)))
        back, forth = self._arms
        points = np.array([*back.points[:0:-1], *forth.points])
        directions = np.array([*(-t for t in back.directions[:0:-1]), *forth.directions])
        inside = (points[0, -1] <= drive) & (drive <= points[-1, -1])
        unknowns = np.full((len(drive), points.shape[1] - 1), np.nan)
        unknowns[inside] = polished_points(self._equations, _between(points, directions, drive[inside]))
        return unknowns


class _Arm:
    """One half of the path, `sense` +1 with rising drives: points, and the unit directions of the path there."""

    def __init__(self, equations: Equations, start: Real, side: float, along: Real, sense: int):
        self.points, self.directions, self.sense = [start], [along], sense
        self._equations = equations
        self._side = side
        self._step = LONGEST
        # Curvature of the path in the last step, perpendicular to it.
        self._curvature = np.zeros(len(start))
        self._ended = along[-1] == 0

    def follow(self, farthest: float) -> None:
        """Add points up to the first one at or beyond sense * drive = farthest, or to the limit."""
        while not self._ended and self.sense * self.points[-1][-1] < farthest:
            self._advance()

    def _advance(self) -> None:
        """One step of the largest length that stays on the path; the last one ends at the limit."""
        last, along = self.points[-1], self.directions[-1]
        corrected = self._corrected(last + self._step * (along + 0.5 * self._step * self._curvature), along)
        side = 0.0 if corrected is None else _side(corrected[1], corrected[2])
        if corrected is not None and self._is_next(corrected[0], corrected[2], side):
            self._side = side
            is_straight = np.abs(corrected[2] - along).max() < 0.3 * MOST_TURN
            if self.sense * corrected[2][-1] <= 0:
                corrected, self._ended = self._limit(corrected), True
            # A start at the limit itself may be beyond it by rounding.
            if self.sense * corrected[0][-1] > self.sense * last[-1]:
                rate = (corrected[2] - along) / _length(corrected[0] - last)
                self._curvature = rate - (rate @ corrected[2]) * corrected[2]
                self.points.append(corrected[0])
                self.directions.append(corrected[2])
            self._step = min(LONGEST, self._step * (2.0 if is_straight else 1.0))
        else:
            self._step *= 0.5
            self._ended = self._step < SHORTEST or len(self.points) > MOST

    def _is_next(self, point: Real, along: Real, side: float) -> bool:
        """Whether a point, with the path's direction and side there, is the next one of this path."""
        step = point - self.points[-1]
        length, before = _length(step), self.directions[-1]
        rotation = _length(along - before)
        if rotation > MOST_TURN or _length(step - self._step * before) > MOST_TURN * self._step:
            return False
        # Neighbouring paths have opposite sides; the side of one path changes only where two cross.
        if side != self._side and (self._step > CROSSED or rotation > STRAIGHT):
            return False
        # The drive may have reversed twice within the step: check the least slope of the cubic through both ends.
        ends = self.sense * before[-1], self.sense * along[-1]
        middle = 1.5 * self.sense * step[-1] / length - 0.25 * (ends[0] + ends[1])
        return bool(ends[1] <= 0 or (middle > 0 and self.sense * step[-1] > 0))

    def _corrected(self, guess: Real, along: Real) -> tuple[Real, Real, Real] | None:
        """The point of the path nearest to a guess, its slopes and the path's direction; None without convergence."""
        point, last, right = guess, np.inf, np.zeros((len(guess), 2))
        right[-1, 1] = 1
        for _ in range(10):
            value, slopes = self._equations(point[None])
            right[:-1, 0], right[-1, 0] = -value[0], along @ (guess - point)
            try:
                step, tangent = np.linalg.solve(_over(slopes[0], along), right).T
            except np.linalg.LinAlgError:
                return None
            size = float(np.abs(step).max())
            if not size <= 1:
                return None
            # Near a crossing of paths rounding is amplified, and the steps end there.
            ended = size > 0.5 * last and size < 1e-3 * self._step
            point, last = point + step * (not ended), size
            tangent = tangent / _length(tangent)
            if ended or size <= (1e-10 if abs(tangent[-1]) < SLOW else max(1e-10, NEAR_ENOUGH * self._step)):
                return (point, slopes[0], tangent) if np.isfinite(tangent).all() else None
        return None

    def _limit(self, beyond: tuple[Real, Real, Real]) -> tuple[Real, Real, Real]:
        """The point at which the drive turns back, between the last point and one beyond.

        The drive is stationary there: a position on the path accurate to 1e-9 gives it to rounding.
        """
        last, along = self.points[-1], self.directions[-1]
        low, high = 0.0, float(along @ (beyond[0] - last))
        ends = self.sense * along[-1], self.sense * beyond[2][-1]
        limit = beyond
        for _ in range(STEPS):
            place = (low * ends[1] - high * ends[0]) / (ends[1] - ends[0])
            middle = self._corrected(last + place * along, along)
            if middle is None:
                break
            limit, slope = middle, self.sense * middle[2][-1]
            if abs(slope) <= 1e-10 or high - low <= 1e-13:
                break
            # The end that stays is given half its weight, so that both ends move (Illinois algorithm).
            if slope > 0:
                low, ends = place, (slope, 0.5 * ends[1])
            else:
                high, ends = place, (0.5 * ends[0], slope)
        return limit


def _length(vector: Real) -> float:
    return float(np.sqrt(vector @ vector))


def _side(slopes: Real, along: Real) -> float:
    """Sign, +1 or -1, of the determinant of the slopes and the path's direction."""
    return float(np.linalg.slogdet(_over(slopes, along))[0])


def _over(slopes: Real, along: Real) -> Real:
    """Slopes above a direction, (n + 1, n + 1); three times faster than `vstack`."""
    square = np.empty((len(along), len(along)))
    square[:-1], square[-1] = slopes, along
    return square


def _between(points: Real, directions: Real, drive: Real) -> Real:
    """Points at drives, from cubics through neighbouring points; the drive rises from point to point."""
    if len(points) == 1:
        return np.repeat(points, len(drive), axis=0)
    k = np.clip(np.searchsorted(points[:, -1], drive, side="right") - 1, 0, len(points) - 2)
    one, two = points[k], points[k + 1]
    length = np.linalg.norm(two - one, axis=1)[:, None]
    # In powers of the share s of the interval: one + s (first + s (second + s third)).
    first = length * directions[k]
    second = 3 * (two - one) - 2 * first - length * directions[k + 1]
    third = (two - one) - first - second
    a, b, c = (power[:, -1] for power in (first, second, third))
    low, high, distance = np.zeros(len(drive)), np.ones(len(drive)), drive - one[:, -1]
    s = distance / (a + b + c)
    for _ in range(HALVINGS):
        missed = s * (a + s * (b + s * c)) - distance
        low, high = np.where(missed < 0, s, low), np.where(missed < 0, high, s)
        with np.errstate(all="ignore"):
            next_s = s - missed / (a + s * (2 * b + 3 * s * c))
        # If Newton's step leaves the remaining interval, as near a limit, the interval is halved.
        next_s = np.where((low <= next_s) & (next_s <= high), next_s, 0.5 * (low + high))
        change, s = np.abs(next_s - s).max(initial=0.0), next_s
        if change < CLOSE:
            break
    s = s[:, None]
    interpolated: Real = one + s * (first + s * (second + s * third))
    interpolated[:, -1] = drive
    return interpolated
