"""Newton-Raphson, and paths of poses that are followed by it, past which a driver's limit is a point like any other.

A path is followed by its own length and not by the drive (pseudo-arclength continuation: Keller, Numerical solution of
bifurcation and nonlinear eigenvalue problems, 1977).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from ...core.arguments import Extended, checked
from ...core.errors import DesignError, shown
from ...core.records import record
from ...plane.vec import Mask, Real

# From points (k, n + 1), n unknowns and the drive, to conditions (k, n) and their slopes (k, n, n + 1).
Equations = Callable[[Real], tuple[Real, Real]]

# Longest step, and the most that the path may turn in one, rad: more, and a step may land on another path beside.
LONGEST, MOST_TURN = 0.1, 0.15
# Steps this short go straight over a point where paths cross, if the path turns by no more than this, rad, in them:
# nearer by, rounding over the square of the distance hides the path's direction; farther, and paths that only pass
# each other would be taken for crossing. So sizes meet a change point to some 1e-12.
CROSSED, STRAIGHT = 3e-5, 1e-3
# Steps this short end the path: rounding of the points is as large. Only at the limit of a dyad before the loops.
SHORTEST = 1e-13
# The last of Newton's steps beside a path, as a share of the step along it, and how slow the drive may be there, of the
# path's own length: what is missed after it is its square. Longer, and the path's direction is told worse than a cubic
# between two points is; where the drive turns back the direction tells the limit, and steps go on to rounding.
NEAR_ENOUGH, SLOW = 1e-5, 1e-3
# Share of the way between two points that a place there is found to, and in how many steps at most: it is a guess, and
# they go on to a millionth of its own error.
CLOSE, HALVINGS = 1e-9, 30
# Steps of an iteration: it needs three or four, or beside a singular point one for each bit. Fewer lose those.
STEPS = 60
# Unknowns of `newton_raphson` at most: their matrix takes 0.2 GB.
MOST_UNKNOWNS = 5_000
# A step of Newton's, by the size of the unknowns, that is the last one. It misses its square by how bent the equations
# are over how steep; rounding over the same steepness is ten times that, beside a limit as anywhere. Longer, and digits
# are lost; shorter, and what has converged is looked at once more.
SETTLED = 3e-9
# Points of a path one way: half of them lead round forty turns. More only where rounding stands in for a path.
MOST = 12_000
# Where Newton's whole steps begin, as a share of the linkage's size: nearer, each squares what is missed. Larger, and
# they may go astray.
NEAR = 1e-2
# The shortest of the steps that are tried before it is given up: shorter ones hardly move.
SHORTEST_SHARE = 1e-3


@record(eq=False)
class Root:
    """Where the iteration stopped. value: (n,); converged; residual: largest |f| there; path: (steps + 1, n)."""

    value: Real
    converged: bool
    residual: float
    path: Real


@checked
def newton_raphson(
    f: Callable[[Real], ArrayLike],
    jacobian: Callable[[Real], ArrayLike],
    estimate: Extended,
    tolerance: float = 1e-13,
    steps: int = 50,
) -> Root:
    """Solve f(x) = 0 from an estimate, (n,) or a number, by x - J^-1 f with the jacobian J = df/dx, (n, n).

    Newton's method in several unknowns (e.g. Press and others, Numerical Recipes, section 9.6), without damping.
    Converged when a step is at most `tolerance` of the size of x (of 1 near zero). Where J is singular or f is
    not finite it stops, not converged, and the value is where that happened: never trust it without looking.
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
    """What a function of the caller's returned, refused by the function's name if it is something else."""
    try:
        return np.asarray(given, dtype=float).reshape(shape)
    except (TypeError, ValueError):
        wanted = " x ".join(map(str, shape))
        raise DesignError(name, f"returned {shown(given)}", f"return {wanted} real numbers") from None


def solved(matrices: Real, right: Real) -> Real:
    """x with matrix x = right for every one of (k, n, n) and (k, n); nan where a matrix is singular or not finite."""
    found = np.full(right.shape, np.nan)
    if np.isfinite(matrices).all() and np.isfinite(right).all():
        try:
            return np.linalg.solve(matrices, right[..., None])[..., 0]
        except np.linalg.LinAlgError:
            pass
    known: Mask = np.logical_and(np.isfinite(matrices).all(axis=(1, 2)), np.isfinite(right).all(axis=1))
    # A sign of zero is a pivot of zero, which `solve` would refuse all of them for.
    known[known] = np.linalg.slogdet(matrices[known])[0] != 0
    found[known] = np.linalg.solve(matrices[known], right[known][..., None])[..., 0]
    return found


def polished(equations: Equations, points: Real, told: tuple[Real, Real] | None = None) -> Real:
    """Unknowns, (k, n), at the drives of points beside a path, (k, n + 1), to rounding; nan where none are found.

    told: what the equations say of the points, where that is known.
    """
    points = points.copy()
    moving, last, missed = np.arange(len(points)), np.full(len(points), np.inf), np.full(len(points), np.inf)
    found = np.zeros(len(points), bool)
    for _ in range(STEPS):
        (value, slopes), told = told or equations(points[moving]), None
        step = solved(slopes[..., :-1], value)
        size, missed[moving] = np.abs(step).max(axis=1), np.abs(value).max(axis=1)
        # Steps that no longer shrink are rounding and would go on to the last. Close to a limit they only halve.
        on = np.isfinite(size) & ((size < 0.9 * last) | (missed[moving] > 1e-12))
        moving, size = moving[on], size[on]
        points[moving, :-1] -= step[on]
        rough = size > SETTLED * np.maximum(1, np.abs(points[moving]).max(axis=1))
        found[moving[~rough]] = True
        moving, last = moving[rough], size[rough]
        if not moving.size:
            break
    return np.where((found | (missed <= 1e-10))[:, None], points[:, :-1], np.nan)


def approached(equations: Equations, point: Real) -> Real:
    """Unknowns, (1, n), at the drive of a point, (1, n + 1), however far from a path; nan where none are found.

    From far off steps of Newton's are halved until the conditions are missed by less: whole ones go astray and come
    back, and then the last bit of a processor's arithmetic decides between two poses.
    """
    told = value, slopes = equations(point)
    for _ in range(STEPS):
        missed, share = np.linalg.norm(value), 1.0
        if missed < NEAR or not np.isfinite(step := solved(slopes[..., :-1], value)).all():
            break
        while share > SHORTEST_SHARE:
            there = np.append(point[:, :-1] - share * step, point[:, -1:], axis=1)
            value, slopes = equations(there)
            if np.linalg.norm(value) < missed:
                break
            share *= 0.5
        else:
            break
        point, told = there, (value, slopes)
    return polished(equations, point, told)


class Trace:
    """All poses that a motion without a stop leads to from `start`, (n + 1,): n unknowns and, last, the drive.

    The path is followed both ways to the driver's limits, no further than what was asked for. Its points depend on
    the start alone, so the limits do as well. Unknowns and drive are to be of like size.
    """

    def __init__(self, equations: Equations, start: Real):
        self._equations = equations
        _, slopes = equations(start[None])
        # At a limit of a dyad before the loops no direction is known: there the path ends both ways.
        along = np.linalg.svd(slopes[0])[2][-1] if np.isfinite(slopes).all() else np.zeros(len(start))
        along = along * np.copysign(1.0, along[-1])
        side = _side(slopes[0], along)
        self._arms = [_Arm(equations, start, way * side, way * along, way) for way in (-1, 1)]

    def at(self, drive: Real) -> Real:
        """Unknowns, (frames, n), at drives (frames,); nan beyond the limits."""
        for arm in self._arms:
            arm.follow(float(np.max(arm.way * drive)))
        back, forth = self._arms
        points = np.array([*back.points[:0:-1], *forth.points])
        ways = np.array([*(-t for t in back.ways[:0:-1]), *forth.ways])
        inside = (points[0, -1] <= drive) & (drive <= points[-1, -1])
        found = np.full((len(drive), points.shape[1] - 1), np.nan)
        found[inside] = polished(self._equations, _between(points, ways, drive[inside]))
        return found


class _Arm:
    """One way along the path, `way` +1 with rising drives: points, and the unit directions of the path there."""

    def __init__(self, equations: Equations, start: Real, side: float, along: Real, way: int):
        self.points, self.ways, self.way = [start], [along], way
        self._equations = equations
        self._side = side
        self._step = LONGEST
        # How fast the path turned in the last step, square to it.
        self._bend = np.zeros(len(start))
        self._ended = along[-1] == 0

    def follow(self, farthest: float) -> None:
        """Points up to the first one at or beyond way * drive = farthest, or to the limit."""
        while not self._ended and self.way * self.points[-1][-1] < farthest:
            self._advance()

    def _advance(self) -> None:
        """One step, of the largest length that keeps to the path; the last one ends at the limit."""
        here, along = self.points[-1], self.ways[-1]
        found = self._corrected(here + self._step * (along + 0.5 * self._step * self._bend), along)
        side = 0.0 if found is None else _side(found[1], found[2])
        if found is not None and self._is_next(found[0], found[2], side):
            self._side = side
            grew = np.abs(found[2] - along).max() < 0.3 * MOST_TURN
            if self.way * found[2][-1] <= 0:
                found, self._ended = self._limit(found), True
            # A start at the limit itself may be a last bit beyond it.
            if self.way * found[0][-1] > self.way * here[-1]:
                turned = (found[2] - along) / _length(found[0] - here)
                self._bend = turned - (turned @ found[2]) * found[2]
                self.points.append(found[0])
                self.ways.append(found[2])
            self._step = min(LONGEST, self._step * (2.0 if grew else 1.0))
        else:
            self._step *= 0.5
            self._ended = self._step < SHORTEST or len(self.points) > MOST

    def _is_next(self, point: Real, along: Real, side: float) -> bool:
        """Whether a point, with the path's direction and its side there, is the next one of this path."""
        step = point - self.points[-1]
        length, before = _length(step), self.ways[-1]
        turn = _length(along - before)
        if turn > MOST_TURN or _length(step - self._step * before) > MOST_TURN * self._step:
            return False
        # Paths side by side run to different sides; the side changes only where two cross.
        if side != self._side and (self._step > CROSSED or turn > STRAIGHT):
            return False
        # A drive that turned back and forth again within the step: the least slope of the cubic through both ends.
        ends = self.way * before[-1], self.way * along[-1]
        middle = 1.5 * self.way * step[-1] / length - 0.25 * (ends[0] + ends[1])
        return bool(ends[1] <= 0 or (middle > 0 and self.way * step[-1] > 0))

    def _corrected(self, guess: Real, along: Real) -> tuple[Real, Real, Real] | None:
        """The point of the path straight beside a guess, its slopes and the path's direction; None if none is found."""
        point, last, right = guess, np.inf, np.zeros((len(guess), 2))
        right[-1, 1] = 1
        for _ in range(10):
            value, slopes = self._equations(point[None])
            right[:-1, 0], right[-1, 0] = -value[0], along @ (guess - point)
            try:
                step, ahead = np.linalg.solve(_over(slopes[0], along), right).T
            except np.linalg.LinAlgError:
                return None
            size = float(np.abs(step).max())
            if not size <= 1:
                return None
            # Beside a crossing steps end in rounding that is as many times larger as the crossing is near.
            ended = size > 0.5 * last and size < 1e-3 * self._step
            point, last = point + step * (not ended), size
            ahead = ahead / _length(ahead)
            if ended or size <= (1e-10 if abs(ahead[-1]) < SLOW else max(1e-10, NEAR_ENOUGH * self._step)):
                return (point, slopes[0], ahead) if np.isfinite(ahead).all() else None
        return None

    def _limit(self, beyond: tuple[Real, Real, Real]) -> tuple[Real, Real, Real]:
        """The point between the last one and one beyond where the drive turns back.

        The drive is stationary there: a place on the path known to 1e-9 gives it to rounding.
        """
        here, along = self.points[-1], self.ways[-1]
        low, high = 0.0, float(along @ (beyond[0] - here))
        ends = self.way * along[-1], self.way * beyond[2][-1]
        found = beyond
        for _ in range(STEPS):
            place = (low * ends[1] - high * ends[0]) / (ends[1] - ends[0])
            middle = self._corrected(here + place * along, along)
            if middle is None:
                break
            found, slope = middle, self.way * middle[2][-1]
            if abs(slope) <= 1e-10 or high - low <= 1e-13:
                break
            # The end that stays is given half its weight, or one of them would stay for ever (Illinois).
            if slope > 0:
                low, ends = place, (slope, 0.5 * ends[1])
            else:
                high, ends = place, (0.5 * ends[0], slope)
        return found


def _length(vector: Real) -> float:
    return float(np.sqrt(vector @ vector))


def _side(slopes: Real, along: Real) -> float:
    """+1 or -1, the sign of the determinant of slopes over the path's direction."""
    return float(np.linalg.slogdet(_over(slopes, along))[0])


def _over(slopes: Real, along: Real) -> Real:
    """Slopes over a direction, (n + 1, n + 1), in a third of the time that `vstack` takes."""
    square = np.empty((len(along), len(along)))
    square[:-1], square[-1] = slopes, along
    return square


def _between(points: Real, ways: Real, drive: Real) -> Real:
    """Points at drives by the cubics through neighbouring points, drive rising from point to point."""
    if len(points) == 1:
        return np.repeat(points, len(drive), axis=0)
    k = np.clip(np.searchsorted(points[:, -1], drive, side="right") - 1, 0, len(points) - 2)
    one, two = points[k], points[k + 1]
    length = np.linalg.norm(two - one, axis=1)[:, None]
    # By powers of the share s of the way: one + s (first + s (second + s third)).
    first = length * ways[k]
    second = 3 * (two - one) - 2 * first - length * ways[k + 1]
    third = (two - one) - first - second
    a, b, c = (power[:, -1] for power in (first, second, third))
    low, high, way = np.zeros(len(drive)), np.ones(len(drive)), drive - one[:, -1]
    s = way / (a + b + c)
    for _ in range(HALVINGS):
        missed = s * (a + s * (b + s * c)) - way
        low, high = np.where(missed < 0, s, low), np.where(missed < 0, high, s)
        with np.errstate(all="ignore"):
            there = s - missed / (a + s * (2 * b + 3 * s * c))
        # Where Newton's step leads out of what is left, as beside a limit, that is halved.
        there = np.where((low <= there) & (there <= high), there, 0.5 * (low + high))
        far, s = np.abs(there - s).max(initial=0.0), there
        if far < CLOSE:
            break
    s = s[:, None]
    found: Real = one + s * (first + s * (second + s * third))
    found[:, -1] = drive
    return found
