"""The boundary of what a tooth sweeps in its mate: the sound pieces of all conjugate curves, walked along."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from ...core.errors import DesignError
from ...core.records import record
from ...plane.curve import AbstractCurve, SubCurve
from ...plane.flatten import smooth_runs
from ...plane.subdivision import CORNER, direction
from ...plane.vec import Complex, Mask, Real, Whole, cross
from .conjugate_curve import ConjugateCurve, ToothCorner, ToothRun

# Shares of a piece at which it is looked at: evenly, and ever closer towards its ends, where an undercut that has only
# just begun crosses within a millionth of them. Fewer let a crossing slip through.
_ENDS = 0.5 / 64 * 10.0 ** (-np.arange(0, 22) / 3)
GRID = np.unique(np.concatenate([np.linspace(0, 1, 65), _ENDS, 1 - _ENDS]))
# Ends of curves that differ by less than this share of the mate's size meet. Larger joins what an undercut parts,
# smaller lets rounding part what meets.
MEET = 1e-8
# Share of the pitch radius, squared, within which a normal at a break grazes the pitch circle. Larger splits curves
# that pass it smoothly, smaller lets rounding decide on which side a pin begins.
GRAZE = 1e-9
# Newton's steps towards a crossing: five from near by, more where two curves part at a sliver of an angle. Fewer lose
# such crossings, more only repeat what leads nowhere.
MOST_STEPS = 8
# Step of both parameters, which run over 1, below which the next one would be lost in rounding. Larger leaves a
# crossing off its place, smaller goes on where rounding alone moves it.
SETTLED = 1e-12
# Shares of an interval at which a change of sign is looked for at once: a call costs as much for many as for one.
SHARES = np.linspace(0, 1, 33)
# Curves that a walk follows before it is given up as going round in circles.
MOST_CURVES = 400


@record(eq=False)
class BoundaryPiece:
    """A conjugate curve from one of its parameters to another, in the direction walked."""

    curve: ConjugateCurve
    start: float
    end: float


@record(eq=False)
class Swept:
    """What one tooth, the material to its left, sweeps in its mate.

    curves: the sound pieces of every conjugate curve. sense: for each +1 where it runs along the tooth's
    tangent, so that what is swept lies to its left, -1 where against it.
    """

    curves: list[ConjugateCurve]
    sense: list[int]
    points: list[Complex]
    grids: list[Real]
    size: float

    def boundary(self, limit: float, rising: bool) -> list[BoundaryPiece]:
        """The boundary within the circle of radius `limit` about the mate, or outside it where not `rising`.

        Walked along the tooth's tangent, from the limit through the deepest point to the limit.
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
        """From a point of the boundary to the limit: at each crossing on to the curve that leads out of what is swept.

        Every curve lies in what is swept, so the boundary leaves one where another crosses it, and nowhere else.
        """
        steps: list[BoundaryPiece] = []
        while len(steps) < MOST_CURVES:
            curve, ahead = self.curves[at], along * self.sense[at]
            end = curve.end if ahead > 0 else curve.start
            out = self._exit(at, u, ahead, limit, sign)
            stop = end if out is None else out
            if found := self._crossing(at, u, stop, along):
                v, at, w = found
                steps.append(BoundaryPiece(curve, u, v))
                u = w
                continue
            steps.append(BoundaryPiece(curve, u, stop))
            if out is not None:
                return steps
            at = self._next(at, complex(curve.point(end)), along)
            curve = self.curves[at]
            u = curve.start if along * self.sense[at] > 0 else curve.end
        raise DesignError("tooth", "its sweep in the mate has no clear boundary", "give a tooth of smoother form")

    def _exit(self, at: int, u: float, ahead: int, limit: float, sign: int) -> float | None:
        """First parameter after u where the curve reaches the limiting circle."""
        grid, curve = self.grids[at], self.curves[at]
        t = np.concatenate([[u], grid[(grid - u) * ahead > 0][::ahead]])
        over = sign * (np.abs(curve.point(t)) - limit)
        beyond = np.flatnonzero((over[:-1] < 0) & (over[1:] >= 0))
        if not len(beyond):
            return None
        k = int(beyond[0])
        return float(first_change(lambda x: sign * (np.abs(curve.point(x)) - limit), t[k], t[k + 1]))

    def _next(self, at: int, place: complex, along: int) -> int:
        """The curve that begins where one has ended; of several the one that leads farthest out of what is swept."""
        near = MEET * self.size
        starts = {k: 0 if along * sense > 0 else -1 for k, sense in enumerate(self.sense)}
        found = [k for k, start in starts.items() if k != at and abs(self.points[k][start] - place) < near]
        if not found:
            raise DesignError(
                "tooth",
                f"what it leaves of the mate ends {abs(place):.5g} mm from the mate's axis",
                "give a tooth whose flanks go on deeper, or less addendum",
            )
        if len(found) == 1:
            return found[0]
        ahead = {k: self._ahead(k, place, starts[k]) for k in found}
        first = ahead[found[0]]
        return min(found, key=lambda k: along * float(np.angle(ahead[k] / first)))

    def _ahead(self, k: int, place: complex, start: int) -> complex:
        """The way from a place to where a curve that begins there is a thousandth of the mate's size off, or ends."""
        curve, step = self.curves[k], 1 if start == 0 else -1
        t, far = self.grids[k][::step], 1e-3 * self.size
        beyond = np.flatnonzero(np.abs(self.points[k][::step] - place) > far)
        if not len(beyond):
            return complex(curve.point(t[-1])) - place
        # All at one distance: curves that leave together part by less than a step of their grids.
        at = first_change(lambda x: np.abs(curve.point(x) - place) - far, t[beyond[0] - 1], t[beyond[0]])
        return complex(curve.point(at)) - place

    def _crossing(self, at: int, u: float, stop: float, along: int) -> tuple[float, int, float] | None:
        """The first crossing after u, before `stop`, with a curve that leads out there: parameter, curve, its own."""
        mine, first = self.curves[at], None
        inner = self.grids[at]
        inner = inner[(inner > min(u, stop)) & (inner < max(u, stop))]
        t = np.concatenate([[min(u, stop)], inner, [max(u, stop)]])
        middles, boxes = _middles(t), _boxes(t, mine)
        for k, other in enumerate(self.curves):
            if k == at:
                continue
            i, j = _near(boxes, self._boxes[k])
            # Nothing behind a crossing already found is used.
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
        """Whether two curves merely meet end to end at places."""
        away = [np.abs(self.points[k][[0, -1], None] - places).min(axis=0) for k in (one, other)]
        near: Mask = np.max(away, axis=0) < MEET * self.size
        return near


def sweep(tooth: AbstractCurve, step: complex, pitch_radius: float, mate_radius: float, turn: complex) -> Swept:
    """Everything that one tooth sweeps. step: direction in which the next tooth follows it, 1 for a closed curve."""
    curves = [c for side in _sides(tooth, step) for c in _sound(side, pitch_radius, mate_radius, turn)]
    if not curves:
        raise DesignError("tooth", "no normal of it meets the pitch circle", "give another pitch_radius")
    # Along the tangent where b has the sign that a sound touch asks for.
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
        bend = float(np.angle(after / before))
        if bend > CORNER:
            sides.append(ToothCorner(complex(tooth.point(run[-1])), before, bend))
    return sides


def _sound(
    side: ToothRun | ToothCorner, pitch_radius: float, mate_radius: float, turn: complex
) -> list[ConjugateCurve]:
    """The parts of a side's two conjugate curves along which it touches the mate without cutting it."""
    b = side.breaks
    grid = np.unique(np.concatenate([b0 + (b1 - b0) * GRID for b0, b1 in pairwise(b)]))

    def reach(t: Real) -> Real:
        touch = side.touch(t)
        foot = np.real(np.conj(touch.tangent) * touch.point) / pitch_radius
        return (1 - foot) * (1 + foot)

    found = []
    # Where a normal only grazes the pitch circle, the roots touch and part again: a pin's or a cycloid's beginning.
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
                ways = np.diff(whole.point(np.array([start, 0.5 * (start + end), end])))
                # Where the roots touch, rounding makes slivers.
                if whole.sound(np.array(0.5 * (start + end))) < 0 and np.abs(ways).sum() > 0.1 * MEET * abs(
                    mate_radius
                ):
                    found.append(replace(whole, start=start, end=end))
    return found


def _is_fold(side: ToothRun | ToothCorner, t: float, pitch_radius: float) -> bool:
    """Whether the foot of the gear's axis on the normals passes the pitch circle here, and does not just touch it."""
    touch = side.touch(np.array(t))
    seen = complex(np.conj(touch.tangent) * touch.point)
    grows = abs(float(touch.speed + touch.turning * seen.imag))
    size = float(touch.speed + abs(touch.turning) * pitch_radius)
    return abs(abs(seen.real) - pitch_radius) < 1e-12 * pitch_radius and grows > 1e-6 * size


def _changes(f: Callable[[Real], Real], grid: Real) -> list[float]:
    """The grid's two ends and the places between where f changes its sign, to rounding."""
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
    """Where f first changes its sign between pairs of parameters (...,), to rounding; a jump counts."""
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
    """Box (4, n - 1) about the curve between neighbouring parameters: low x, low y, high x, high y."""
    z, middle = curve.point(t), curve.point(_middles(t))
    # As far again as the middle stands off the chord, which is more than a smooth piece bulges.
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
    """Parameters where two curves cross, by Newton's steps from near by; none for steps that lead nowhere."""
    u, v, moving = u.copy(), v.copy(), np.arange(len(u))
    for _ in range(MOST_STEPS):
        if not len(moving):
            break
        here, mine = a.course(u[moving])
        there, theirs = b.course(v[moving])
        with np.errstate(divide="ignore", invalid="ignore"):
            turn = cross(mine, theirs)
            du, dv = cross(there - here, theirs) / turn, cross(there - here, mine) / turn
        sure = np.isfinite(du) & np.isfinite(dv)
        u[moving[~sure]] = np.nan
        moving, du, dv = moving[sure], du[sure], dv[sure]
        before = u[moving], v[moving]
        u[moving], v[moving] = np.clip(before[0] + du, a.start, a.end), np.clip(before[1] + dv, b.start, b.end)
        moving = moving[np.abs(u[moving] - before[0]) + np.abs(v[moving] - before[1]) > SETTLED]
    sure = np.isfinite(u)
    u, v = u[sure], v[sure]
    met = np.abs(b.point(v) - a.point(u)) < 1e-11 * size
    return u[met], v[met]
