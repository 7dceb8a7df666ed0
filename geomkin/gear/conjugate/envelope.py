"""The boundary of the region that a tooth sweeps in its mate, traced along the valid pieces of conjugate curves."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from ...core.errors import DesignError
from ...core.records import record
from ...core.units import mm
from ...plane.curve import AbstractCurve, SubCurve
from ...plane.flatten import CORNER, direction, smooth_runs
from ...plane.vec import Complex, Mask, Real, Whole, cross
from .conjugate_curve import ConjugateCurve, ToothCorner, ToothRun

# Sample shares of a piece: evenly spaced, and denser towards its ends, where slight undercut causes crossings within a
# millionth of them. Fewer samples miss such crossings.
_ENDS = 0.5 / 64 * 10.0 ** (-np.arange(0, 22) / 3)
GRID = np.unique(np.concatenate([np.linspace(0, 1, 65), _ENDS, 1 - _ENDS]))
# Ends of curves coincide if they differ by less than this share of the mate's size. A larger value joins curves that an
# undercut separates; with a smaller one rounding separates coincident ends.
MEET = 1e-8
# A normal at a break is tangent to the pitch circle within this share of the squared pitch radius. A larger value
# splits curves that pass smoothly; with a smaller one rounding decides on which side a pin begins.
GRAZE = 1e-9
# Newton steps towards a crossing: five from a nearby start, more if two curves separate at a very small angle. Fewer
# lose such crossings; more have no benefit.
MOST_STEPS = 8
# Newton's method stops when the step of both parameters, of range 1, is below this. A larger value leaves an error;
# with a smaller one it does not stop, because of rounding.
SETTLED = 1e-12
# Shares of an interval at which a sign change is searched at once: one call costs the same for many points.
SHARES = np.linspace(0, 1, 33)
# Largest number of curves in a trace before it is regarded as endless.
MOST_CURVES = 400


@record(eq=False)
class BoundaryPiece:
    """A conjugate curve between two of its parameters, in the direction of the trace."""

    curve: ConjugateCurve
    start: float
    end: float


@record(eq=False)
class Swept:
    """The region that one tooth, with the material to its left, sweeps in its mate.

    curves: the valid pieces of all conjugate curves. sense: +1 for a curve in the direction of the tooth's tangent,
    with the swept region to its left, -1 for the opposite direction.
    """

    curves: list[ConjugateCurve]
    sense: list[int]
    points: list[Complex]
    grids: list[Real]
    size: float

    def boundary(self, limit: float, rising: bool) -> list[BoundaryPiece]:
        """The boundary inside the circle of radius `limit` about the mate, or outside it if not `rising`.

        It is traced along the tooth's tangent, from the circle through the deepest point to the circle.
        """
        sign = 1 if rising else -1
        depths = [sign * np.abs(p) for p in self.points]
        deepest = int(np.argmin([d.min() for d in depths]))
        seed = float(self.grids[deepest][depths[deepest].argmin()])
        back = self._walk(deepest, seed, -1, limit, sign)
        ahead = self._walk(deepest, seed, 1, limit, sign)
        middle = BoundaryPiece(self.curves[deepest], back[0].end, ahead[0].end)
        reversed_back = [BoundaryPiece(s.curve, s.end, s.start) for s in back[:0:-1]]
        return [*reversed_back, middle, *ahead[1:]]

    def _walk(self, at: int, u: float, along: int, limit: float, sign: int) -> list[BoundaryPiece]:
        """Trace from a point of the boundary to the limit.

        All curves are inside the swept region, so the boundary changes from one curve to another exactly where the
        other one crosses it outwards.
        """
        steps: list[BoundaryPiece] = []
        while len(steps) < MOST_CURVES:
            curve, ahead = self.curves[at], along * self.sense[at]
            end = curve.end if ahead > 0 else curve.start
            out = self._exit(at, u, ahead, limit, sign)
            stop = end if out is None else out
            if crossing := self._crossing(at, u, stop, along):
                v, at, w = crossing
                steps.append(BoundaryPiece(curve, u, v))
                u = w
                continue
            steps.append(BoundaryPiece(curve, u, stop))
            if out is not None:
                return steps
            at = self._next(at, complex(curve.point(end)), along)
            curve = self.curves[at]
            u = curve.start if along * self.sense[at] > 0 else curve.end
        raise DesignError("tooth", "the region it sweeps in the mate has no clear boundary", "give a smoother tooth")

    def _exit(self, at: int, u: float, ahead: int, limit: float, sign: int) -> float | None:
        """First parameter after u at which the curve reaches the limiting circle."""
        grid, curve = self.grids[at], self.curves[at]
        t = np.concatenate([[u], grid[(grid - u) * ahead > 0][::ahead]])
        over = sign * (np.abs(curve.point(t)) - limit)
        beyond = np.flatnonzero((over[:-1] < 0) & (over[1:] >= 0))
        if not len(beyond):
            return None
        k = int(beyond[0])
        return float(first_change(lambda x: sign * (np.abs(curve.point(x)) - limit), t[k], t[k + 1]))

    def _next(self, at: int, place: complex, along: int) -> int:
        """The curve that starts at the end of another; of several, the outermost."""
        near = MEET * self.size
        starts = {k: 0 if along * sense > 0 else -1 for k, sense in enumerate(self.sense)}
        candidates = [k for k, start in starts.items() if k != at and abs(self.points[k][start] - place) < near]
        if not candidates:
            problem = f"the mate's flank that it generates ends {mm(abs(place)):.5g} from the mate's axis"
            raise DesignError("tooth", problem, "give a tooth with deeper flanks, or a smaller addendum")
        if len(candidates) == 1:
            return candidates[0]
        directions = {k: self._direction(k, place, starts[k]) for k in candidates}
        first = directions[candidates[0]]
        return min(candidates, key=lambda k: along * float(np.angle(directions[k] / first)))

    def _direction(self, k: int, place: complex, start: int) -> complex:
        """Vector from a curve's start to its point at a distance of 1e-3 of the mate's size, or to its end."""
        curve, step = self.curves[k], 1 if start == 0 else -1
        t, far = self.grids[k][::step], 1e-3 * self.size
        beyond = np.flatnonzero(np.abs(self.points[k][::step] - place) > far)
        if not len(beyond):
            return complex(curve.point(t[-1])) - place
        # The same distance for all curves, which may separate by less than a step of their grids.
        at = first_change(lambda x: np.abs(curve.point(x) - place) - far, t[beyond[0] - 1], t[beyond[0]])
        return complex(curve.point(at)) - place

    def _crossing(self, at: int, u: float, stop: float, along: int) -> tuple[float, int, float] | None:
        """The first crossing between u and `stop` with a curve that leads outwards: parameter, curve, its parameter."""
        mine, first = self.curves[at], None
        inner = self.grids[at]
        inner = inner[(inner > min(u, stop)) & (inner < max(u, stop))]
        t = np.concatenate([[min(u, stop)], inner, [max(u, stop)]])
        middles, boxes = _middles(t), _boxes(t, mine)
        for k, other in enumerate(self.curves):
            if k == at:
                continue
            i, j = _near(boxes, self._boxes[k])
            # Parts beyond a crossing that is already known are skipped.
            near = (t[:-1] < stop)[i] if stop > u else (t[1:] > stop)[i]
            here, there = _crossing(mine, other, middles[i[near]], _middles(self.grids[k])[j[near]], self.size)
            keep = (here != u) & (here >= min(u, stop)) & (here <= max(u, stop))
            here, there = here[keep], there[keep]
            if not len(here):
                continue
            leads_out = along * cross(mine.velocity(here) * self.sense[at], other.velocity(there) * self.sense[k]) < 0
            keep = leads_out & ~self._are_joints(at, k, mine.point(here))
            if keep.any():
                here, there = here[keep], there[keep]
                nearest = int(np.abs(here - u).argmin())
                first = float(here[nearest]), k, float(there[nearest])
                stop = first[0]
        return first

    @cached_property
    def _boxes(self) -> list[Real]:
        return [_boxes(t, curve) for t, curve in zip(self.grids, self.curves)]

    def _are_joints(self, one: int, other: int, places: Complex) -> Mask:
        """Mask of the places at which two curves only meet end to end."""
        away = [np.abs(self.points[k][[0, -1], None] - places).min(axis=0) for k in (one, other)]
        near: Mask = np.max(away, axis=0) < MEET * self.size
        return near


def swept_region(tooth: AbstractCurve, step: complex, pitch_radius: float, mate_radius: float, turn: complex) -> Swept:
    """The region that one tooth sweeps. step: rotation to the next tooth; 1 for a closed curve."""
    curves = [c for side in _sides(tooth, step) for c in _valid_curves(side, pitch_radius, mate_radius, turn)]
    if not curves:
        raise DesignError("tooth", "none of its normals meets the pitch circle", "give another pitch_radius")
    # +1 if b has the sign that valid contact requires.
    sense = [-c.root * int(np.sign(c.k)) for c in curves]
    grids: list[Real] = [c.start + (c.end - c.start) * GRID for c in curves]
    points = [c.point(g) for c, g in zip(curves, grids)]
    return Swept(curves, sense, points, grids, abs(mate_radius))


def _sides(tooth: AbstractCurve, step: complex) -> list[ToothRun | ToothCorner]:
    """The tooth's stretches and its convex corners."""
    runs = smooth_runs(tooth)
    sides: list[ToothRun | ToothCorner] = []
    for k, run in enumerate(runs):
        sides.append(ToothRun(SubCurve(tooth, run)))
        last = k == len(runs) - 1
        after = complex(direction(tooth, runs[(k + 1) % len(runs)][:1], after=True)[0]) * (step if last else 1)
        before = complex(direction(tooth, run[-1:], after=False)[0])
        corner = float(np.angle(after / before))
        if corner > CORNER:
            sides.append(ToothCorner(complex(tooth.point(run[-1])), before, corner))
    return sides


def _valid_curves(
    side: ToothRun | ToothCorner, pitch_radius: float, mate_radius: float, turn: complex
) -> list[ConjugateCurve]:
    """The parts of a side's two conjugate curves with contact but without undercut."""
    b = side.breaks
    grid = np.unique(np.concatenate([b0 + (b1 - b0) * GRID for b0, b1 in pairwise(b)]))

    def reach(t: Real) -> Real:
        touch = side.touch(t)
        foot = np.real(np.conj(touch.tangent) * touch.point) / pitch_radius
        return (1 - foot) * (1 + foot)

    curves = []
    # Where a normal is tangent to the pitch circle, the roots touch and separate again, as at the start of a pin.
    grazing = b[np.abs(reach(b)) < GRAZE]
    near = 1e-6 * (b[-1] - b[0])
    limits = sorted({*(t for t in _changes(reach, grid) if (np.abs(t - grazing) > near).all()), *grazing, b[0], b[-1]})
    for first, last in pairwise(limits):
        if reach(np.array(0.5 * (first + last))) <= 0:
            continue
        folds = (_is_fold(side, first, pitch_radius), _is_fold(side, last, pitch_radius))
        for root in (-1, 1):
            whole = ConjugateCurve(side, pitch_radius, mate_radius, root, first, last, folds, turn)
            inner = whole.breaks
            t = np.unique(np.concatenate([b0 + (b1 - b0) * GRID for b0, b1 in pairwise(inner)]))
            edges = _changes(whole.sound, t)
            for start, end in pairwise(edges):
                chords = np.diff(whole.point(np.array([start, 0.5 * (start + end), end])))
                # Where the roots touch, rounding creates pieces without length.
                has_length = np.abs(chords).sum() > 0.1 * MEET * abs(mate_radius)
                if whole.sound(np.array(0.5 * (start + end))) < 0 and has_length:
                    curves.append(replace(whole, start=start, end=end))
    return curves


def _is_fold(side: ToothRun | ToothCorner, t: float, pitch_radius: float) -> bool:
    """Whether the normals cross the pitch circle's tangent here, and do not just touch it."""
    touch = side.touch(np.array(t))
    local = complex(np.conj(touch.tangent) * touch.point)
    rate = abs(float(touch.speed + touch.turning * local.imag))
    size = float(touch.speed + abs(touch.turning) * pitch_radius)
    return abs(abs(local.real) - pitch_radius) < 1e-12 * pitch_radius and rate > 1e-6 * size


def _changes(f: Callable[[Real], Real], grid: Real) -> list[float]:
    """The grid's two ends and the sign changes of f between them, to rounding."""
    positive = f(grid) > 0
    changes = np.flatnonzero(positive[1:] != positive[:-1])
    inner = first_change(f, grid[changes], grid[changes + 1]).tolist()
    span = 1e-12 * (grid[-1] - grid[0])
    limits = [float(grid[0])]
    for t in inner:
        if t - limits[-1] > span:
            limits.append(t)
    if grid[-1] - limits[-1] > span or len(limits) == 1:
        limits.append(float(grid[-1]))
    else:
        limits[-1] = float(grid[-1])
    return limits


def first_change(f: Callable[[Real], Real], low: ArrayLike, high: ArrayLike) -> Real:
    """First sign change of f between pairs of parameters (...,), to rounding; a jump counts."""
    low, high = np.asarray(low, dtype=float)[..., None], np.asarray(high, dtype=float)[..., None]
    above = f(high) > 0
    for _ in range(12):  # sixty halvings
        t = low + (high - low) * SHARES
        beyond = (f(t) > 0) == above
        beyond[..., 0], beyond[..., -1] = False, True
        k = beyond.argmax(axis=-1)[..., None]
        before, (low, high) = (low, high), (np.take_along_axis(t, k - 1, -1), np.take_along_axis(t, k, -1))
        if (low == before[0]).all() and (high == before[1]).all():
            break
    middle: Real = (0.5 * (low + high))[..., 0]
    return middle


def _middles(t: Real) -> Real:
    return 0.5 * (t[:-1] + t[1:])


def _boxes(t: Real, curve: ConjugateCurve) -> Real:
    """Boxes (4, n - 1) of the curve between adjacent parameters: low x, low y, high x, high y."""
    z, middle = curve.point(t), curve.point(_middles(t))
    # The margin is the middle's distance from the chord, more than a smooth piece can exceed the three points.
    room = np.abs(middle - 0.5 * (z[:-1] + z[1:]))
    low = np.minimum(z[:-1].real, z[1:].real) - room, np.minimum(z[:-1].imag, z[1:].imag) - room
    high = np.maximum(z[:-1].real, z[1:].real) + room, np.maximum(z[:-1].imag, z[1:].imag) + room
    return np.array([*low, *high])


def _near(a: Real, b: Real) -> tuple[Whole, Whole]:
    """Pairs of boxes that meet."""
    if (a[:2].min(axis=1) > b[2:].max(axis=1)).any() or (b[:2].min(axis=1) > a[2:].max(axis=1)).any():
        return np.array([], dtype=int), np.array([], dtype=int)
    meet = (a[:2, :, None] <= b[2:, None]).all(axis=0) & (b[:2, None] <= a[2:, :, None]).all(axis=0)
    rows, columns = np.nonzero(meet)
    return rows, columns


def _crossing(a: ConjugateCurve, b: ConjugateCurve, u: Real, v: Real, size: float) -> tuple[Real, Real]:
    """Parameters at which two curves cross, by Newton's method from nearby starts; diverging starts are dropped."""
    u, v, moving = u.copy(), v.copy(), np.arange(len(u))
    for _ in range(MOST_STEPS):
        if not len(moving):
            break
        here, mine = a.course(u[moving])
        there, theirs = b.course(v[moving])
        with np.errstate(divide="ignore", invalid="ignore"):
            turn = cross(mine, theirs)
            du, dv = cross(there - here, theirs) / turn, cross(there - here, mine) / turn
        finite = np.isfinite(du) & np.isfinite(dv)
        u[moving[~finite]] = np.nan
        moving, du, dv = moving[finite], du[finite], dv[finite]
        before = u[moving], v[moving]
        u[moving], v[moving] = np.clip(before[0] + du, a.start, a.end), np.clip(before[1] + dv, b.start, b.end)
        moving = moving[np.abs(u[moving] - before[0]) + np.abs(v[moving] - before[1]) > SETTLED]
    finite = np.isfinite(u)
    u, v = u[finite], v[finite]
    is_crossing = np.abs(b.point(v) - a.point(u)) < 1e-11 * size
    return u[is_crossing], v[is_crossing]
