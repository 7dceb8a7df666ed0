"""Least squares where more is wanted than can be met: circles through points, dyads through more than five poses."""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations, islice
from typing import Annotated

import numpy as np

from ...core.arguments import Points, checked, whole_between
from ...core.errors import DesignError
from ...core.records import record
from ...plane.vec import Complex, Mask, Real, Whole
from .burmester import both_ways, slides_of
from .constraint import (
    FAR,
    Pairs,
    Relations,
    joined,
    missed,
    normalised,
    pairs_of_least,
    relations,
    sharpened,
    square_slides,
)
from .poses import PARALLEL, Poses, inverse, placed

# Sets of five poses from which fits start besides. Fewer may miss the best fit of poses that no dyad nearly meets;
# more cost time.
MOST_FIVES = 12
# Difference of two fits, in sizes, below which they are one: least squares are flat, and found to half the digits.
# Larger, and two are taken for one; smaller, and one is told twice.
SAME = 1e-4
# Singular value over the largest below which points are at two places only. Larger, and points close together get no
# circle; smaller, and the rounding of two places is taken for a third.
FEWER = 1e-12
# Steps at most, each for all starts together; a start that needs more creeps along a valley that ends at infinity.
STEPS = 300
# Gain of a step, as a share of the squares, below which a start has converged.
CONVERGED = 1e-13
# Largest unknown, of which sizes are about 1. Larger, and fourth powers overflow; smaller stops fits of far pivots.
FARTHEST = 1e12


def fitted_dyads(origins: Complex, directions: Complex) -> tuple[Pairs, Mask]:
    """Dyads at which the sum of squared distances missed is least, near by, best first, and which have converged.

    The others creep towards a dyad at infinity, and are where their steps ended.
    Starts: the dyads of the least three rows of all poses, and those of sets of five of them, evenly chosen.
    """
    z, middle, size = normalised(origins)
    sets = list(combinations(range(len(z)), 5)) if len(z) < 12 else _spread(len(z))
    chosen = np.array(sets)[np.unique(np.linspace(0, len(sets) - 1, MOST_FIVES).astype(int))]
    sets_of_all = relations(z, directions), relations(z[chosen], directions[chosen])
    starts = joined([found.at(there) for found, there in map(pairs_of_least, sets_of_all)])
    body = starts.moving_far | (~starts.fixed_far & (np.abs(starts.moving) > np.abs(starts.fixed)))
    on_ground, settled = _polished(z, directions, starts.at(~body))
    on_body, settled_too = _polished(*inverse(z, directions), starts.at(body).swapped)
    found, converged = joined([on_ground, on_body.swapped]), np.concatenate([settled, settled_too])
    order = np.argsort(missed(z, directions, found), kind="stable")
    order = order[_different(found.at(order))]
    return found.at(order).enlarged(middle, size), converged[order]


def _spread(count: int) -> list[tuple[int, ...]]:
    """Sets of five out of many, each evenly spread, from different firsts."""
    step = count // 5
    return [tuple(first + step * k for k in range(5)) for first in islice(range(step), MOST_FIVES)]


def _polished(z: Complex, u: Complex, starts: Pairs) -> tuple[Pairs, Mask]:
    """The same at their least squares, and which have come there; the pin on the body is no slide."""
    if not starts.fixed.size:
        return starts, np.zeros(0, dtype=bool)
    m = starts.moving[:, None]
    pins = z + u * m
    with np.errstate(invalid="ignore"):
        # |p - f|^2 - r^2 over the length of f, so that a far pivot is a line.
        reach = np.where(starts.fixed_far, 1.0, np.maximum(1.0, np.abs(starts.fixed)))
        bend = np.where(starts.fixed_far, 0.0, 1 / reach)[:, None]
        slope = np.where(starts.fixed_far, -1j * starts.fixed, -2 * starts.fixed / reach)[:, None]
    level = -(bend * np.abs(pins) ** 2 + (np.conj(slope) * pins).real).mean(axis=-1, keepdims=True)

    def cost(x: Real, _: Whole) -> tuple[Real, Real]:
        pins = z + u * (x[:, :1] + 1j * x[:, 1:2])
        away, by = distances(pins, x[:, 2:3], x[:, 3:4] + 1j * x[:, 4:5], x[:, 5:])
        by_x, by_y = by[4] * u.real + by[5] * u.imag, by[5] * u.real - by[4] * u.imag
        return away, np.stack([by_x, by_y, *by[:4]], axis=-1)

    start = np.concatenate([m.real, m.imag, bend, slope.real, slope.imag, level], axis=-1)
    x, converged = least_squares(cost, start)
    bend, slope = x[:, 2], x[:, 3] + 1j * x[:, 4]
    far = 2 * np.abs(bend) * FAR <= np.abs(slope)
    with np.errstate(divide="ignore", invalid="ignore"):
        fixed = np.where(far, 1j * slope / np.abs(slope), -slope / (2 * bend))
    return Pairs(fixed, x[:, 0] + 1j * x[:, 1], far, np.zeros(len(x), dtype=bool)), converged


def _different(found: Pairs) -> Whole:
    kept: list[int] = []
    for k in range(found.fixed.size):
        near = [
            j
            for j in kept
            if all(
                far[j] == far[k] and abs(place[j] - place[k]) <= SAME * (1 + abs(place[k]))
                for far, place in ((found.fixed_far, found.fixed), (found.moving_far, found.moving))
            )
        ]
        if not near and np.isfinite(found.fixed[k]) and np.isfinite(found.moving[k]):
            kept.append(k)
    return np.array(kept, dtype=int)


def fitted_circles(points: Complex) -> tuple[Complex, Mask]:
    """Centres (k,) of rows of points (k, n), mm, and which are at infinity: then the line's direction, unit complex.

    The best circle or line in the sense of least squares of distances, through three points exactly. nan where the
    points are at two places: many circles pass them; their own place where they are all at one.
    """
    middle = points.mean(axis=-1, keepdims=True)
    size = np.abs(points - middle).max(axis=-1, keepdims=True)
    still = size[:, 0] <= 1e-14 * np.abs(points).max(axis=-1)
    p = (points - middle) / np.where(size == 0, 1.0, size)
    square = np.abs(p) ** 2
    told = np.stack([square - square.mean(axis=-1, keepdims=True), p.real, p.imag], axis=-1)
    _, sizes, ways = np.linalg.svd(told, full_matrices=False)
    few = sizes[:, 1] <= FEWER * sizes[:, 0]
    bend: Real = ways[:, 2, 0]
    slope: Complex = ways[:, 2, 1] + 1j * ways[:, 2, 2]
    level = -(bend[:, None] * square + (np.conj(slope)[:, None] * p).real).mean(axis=-1)
    if points.shape[-1] > 3 and (sizes[:, 2] > FEWER * sizes[:, 0]).any():
        bend, slope, level = _refined(p, bend, slope, level)
    far = 2 * np.abs(bend) * FAR <= np.abs(slope)
    with np.errstate(divide="ignore", invalid="ignore"):
        centre = np.where(far, 1j * slope / np.abs(slope), middle[:, 0] - size[:, 0] * slope / (2 * bend))
    centre[few] = complex(np.nan, np.nan)
    return np.where(still, middle[:, 0], centre), far & ~few & ~still


def distances(
    p: Complex, bend: Real, slope: Complex, level: Real
) -> tuple[Real, tuple[Real, Real, Real, Real, Real, Real]]:
    """Signed distances (..., n) of points from bend |p|^2 + Re(conj(slope) p) + level = 0, and their derivatives.

    The coefficients (..., 1), of any common scale. Derivatives by bend, slope x, slope y, level, then by p x and p y.
    Chernov, Circular and Linear Regression, 2010, section 3.2, has the distance in this form, that holds for lines too.
    """
    value = bend * np.abs(p) ** 2 + (np.conj(slope) * p).real + level
    # A circle without a radius counts as a point.
    terms = np.abs(slope) ** 2 + 4 * np.abs(bend * level) + 1e-300
    size = np.sqrt(np.maximum(np.abs(slope) ** 2 - 4 * bend * level, 1e-28 * terms))
    out = 2 * bend * p + slope
    far = np.maximum(np.abs(out), 1e-14 * np.sqrt(terms))
    total = size + far
    away = 2 * value / total

    def slid(value_by: Real, square_by: Real, far_square_by: Real) -> Real:
        # Of the value, of size^2 and of far^2.
        change: Real = (2 * value_by - away * (square_by / (2 * size) + far_square_by / (2 * far))) / total
        return change

    zero = np.zeros_like(away)
    by_bend = slid(np.abs(p) ** 2 + zero, -4 * level + zero, 4 * (np.conj(p) * out).real)
    by_x = slid(p.real, 2 * slope.real + zero, 2 * out.real)
    by_y = slid(p.imag, 2 * slope.imag + zero, 2 * out.imag)
    by_level = slid(zero + 1, -4 * bend + zero, zero)
    # Along the way out from the circle a distance grows as the way does.
    return away, (by_bend, by_x, by_y, by_level, out.real / far, out.imag / far)


def _refined(p: Complex, bend: Real, slope: Complex, level: Real) -> tuple[Real, Complex, Real]:
    """Coefficients of the circles from which the points' distances are least; damped steps, Levenberg-Marquardt."""

    def cost(x: Real, rows: Whole) -> tuple[Real, Real]:
        away, by = distances(p[rows], x[:, :1], x[:, 1:2] + 1j * x[:, 2:3], x[:, 3:])
        return away, np.stack(by[:4], axis=-1)

    best, _ = least_squares(cost, np.stack([bend, slope.real, slope.imag, level], axis=-1))
    return best[:, 0], best[:, 1] + 1j * best[:, 2], best[:, 3]


def least_squares(cost: Callable[[Real, Whole], tuple[Real, Real]], start: Real) -> tuple[Real, Mask]:
    """Unknowns (k, q) at which the squares of residuals are least, each from its own start (Levenberg-Marquardt).

    Besides, which of them, (k,), came to rest within `STEPS`.

    cost: from unknowns (k, q), and which of the starts they are of, to residuals (k, n) and their derivatives
    (k, n, q). Unknowns that have a scale in common may be among them: the damping keeps what the residuals do not
    tell. Levenberg 1944, Marquardt 1963.
    """
    best = np.array(start)
    rows = np.arange(len(start))
    x, damping, eye = best, np.full(len(start), 1e-3), np.eye(best.shape[-1])
    away, slopes = cost(x, rows)
    for _ in range(STEPS):
        if not len(rows):
            break
        squares = np.sum(away**2, axis=-1)
        normal = np.einsum("kni,knj->kij", slopes, slopes)
        right = np.einsum("kni,kn->ki", slopes, away)
        trace = np.trace(normal, axis1=-2, axis2=-1)[:, None, None]
        damped = normal + (damping[:, None, None] + 1e-14) * (trace + 1e-300) * eye
        tried = x - np.linalg.solve(damped, right[..., None])[..., 0]
        new_away, new_slopes = cost(tried, rows)
        new_squares = np.sum(new_away**2, axis=-1)
        # What runs away has its least at infinity, where numbers end.
        better = (new_squares < squares) & (np.abs(tried).max(axis=-1) < FARTHEST)
        done = np.where(better, squares - new_squares <= CONVERGED * squares, damping > 1e6)
        x = np.where(better[:, None], tried, x)
        away, slopes = np.where(better[:, None], new_away, away), np.where(better[:, None, None], new_slopes, slopes)
        damping = np.clip(np.where(better, damping * 0.1, damping * 5), 1e-15, 1e12)
        best[rows] = x
        left = ~done
        x, away, slopes, damping, rows = x[left], away[left], slopes[left], damping[left], rows[left]
    return best, ~np.isin(np.arange(len(start)), rows)


# Largest miss of a dyad, in sizes of the poses and of its pin's way, that is called exact: what rounding leaves of
# dyads whose roots lie close together. Larger, and fits are called exact; smaller, and true dyads are not.
EXACT = 1e-9
# Distance, in sizes of the poses, from which a pivot may be one of rounding, and a slide is tried for it.
REMOTE = 1e6
# Largest miss beyond which a root is none. Smaller, and true dyads that nearly coincide with another are lost.
MISSED = 1e-5
# Share of the coordinates that rounding of poses makes, in units of EXACT. Smaller, and dyads of poses close together,
# or far from the origin, are told as missing them.
ROUNDING = 1e-5


@record(eq=False)
class Dyads:
    """Dyads that guide a body through poses; every part (dyads,).

    fixed: pins on the ground, mm; inf where the body's pin slides along a straight line of the ground, whose direction
    is then in `fixed_direction`, unit complex, and that passes through the pin's place at the first pose. moving: pins
    on the body, mm in its own frame; inf where a straight line of the body slides over the pin on the ground, with its
    direction in the body's frame in `moving_direction`. Directions are nan where there is no slide. residual: largest
    distance, mm, by which a pose is missed: of the pin from its circle or line, whose radius or offset is the one that
    makes this least. exact: whether that is no more than rounding; where not, it is a least-squares fit. converged:
    false of a fit that still creeps towards a dyad at infinity when its steps end, and misses less farther out.
    """

    fixed: Complex
    moving: Complex
    fixed_direction: Complex
    moving_direction: Complex
    residual: Real
    exact: Mask
    converged: Mask

    def __len__(self) -> int:
        return len(self.fixed)


@checked
def dyads_through(
    poses: Poses,
    fixed: Points | None = None,
    moving: Points | None = None,
    count: Annotated[int, whole_between(1, 100_000)] = 360,
) -> Dyads:
    """Dyads that take a body through poses (origin x + yj in mm, angle in rad), three or more, in this order.

    fixed: pivots on the ground, mm, one or a row, each to be given its pin on the body; or moving: pins on the body,
    mm in its own frame, each to be given its pivot on the ground; nan where any would do, as for a pin that has but two
    places. What cannot be met exactly, as is so for four poses off their curves, is met by least squares.

    Without either: of five poses all dyads there are, none to four. Of four poses the two slides, then about `count`
    dyads along all branches of the whole curves, which `burmester_curves` draws. Of six poses and more the dyads at
    which the sum of squared distances missed is least near by, by rising residual, exact ones among them. Of poses
    with infinitely many slides, as an elliptic trammel has, two that are square to each other: the one that is
    travelled farthest, and its partner.

    DesignError for fewer than three poses, equal ones, both fixed and moving, and neither where a dyad goes through
    every point of the plane: of three poses, and of such more as are parallel or turned about one point.
    Constraint: Bottema and Roth, Theoretical Kinematics, 1979, chapter VIII; how it is solved is derived here.
    """
    z, u = placed(poses, 3)
    if fixed is not None and moving is not None:
        raise DesignError("moving", "found both fixed and moving", "give one of them")
    if moving is not None:
        return told(z, u, partners(z, u, _row("moving", moving)))
    if fixed is not None:
        return told(z, u, partners(*inverse(z, u), _row("fixed", fixed)).swapped)
    asked = relations(z, u)
    free = asked.freedom
    if free > 4 or np.abs(u - u[0]).max() <= PARALLEL:
        why = f"found {len(z)}, for which every point of the body is as good as any other"
        raise DesignError("poses", why, "give moving or fixed points besides, or more poses that turn the body")
    if free == 4:
        return told(z, u, _two_slides(z, u, asked, _along_curves(z, u, count)))
    # More poses that leave as much open as five have exact dyads.
    if free < 3:
        fits, converged = fitted_dyads(z, u)
        return told(z, u, _straightened(z, u, fits), converged=converged)
    found, there = pairs_of_least(asked)
    found = found.at(there)
    # A body with two angles only is also held by what forbids it all others, which is no dyad.
    found = _straightened(z, u, sharpened(z, u, found) if len(z) == 5 else found)
    return told(z, u, _two_slides(z, u, asked, found), MISSED)


def _two_slides(z: Complex, u: Complex, asked: Relations, found: Pairs) -> Pairs:
    """The dyads with two slides in place of all, if any direction has one, on the ground or on the body."""
    ground = square_slides(z, u, asked)
    if ground is not None:
        found = joined([ground, found.at(~found.fixed_far | found.moving_far)])
    z, u = inverse(z, u)
    body = square_slides(z, u, relations(z, u))
    if body is not None:
        found = joined([body.swapped, found.at(~found.moving_far | found.fixed_far)])
    return found


def _along_curves(z: Complex, u: Complex, count: int) -> Pairs:
    """The slides, then dyads along the curves of four poses, to which others, if any, add nothing."""
    four = next(list(k) for k in combinations(range(len(z)), 4) if relations(z[list(k)], u[list(k)]).freedom == 4)
    ground, body = both_ways(z[four], u[four])
    loops = ground.cubic.loops
    each = max(1, count // max(1, len(loops)))
    # Half a step from the start, where a loop of a line and a conic may be at infinity.
    t = 2 * np.pi * (np.arange(each) + 0.5) / each
    found = [slides_of(ground, body)]
    for loop in loops:
        place, weight, _, _ = ground.cubic.run(loop, t)
        fixed, moving = ground.point(place, weight), ground.partner(place, weight)
        near = np.zeros(each, dtype=bool)
        found.append(Pairs(fixed, moving, near, near).at(np.isfinite(fixed) & np.isfinite(moving)))
    return joined(found)


def partners(z: Complex, u: Complex, moving: Complex) -> Pairs:
    """For pins on the body (k,) the pivots on the ground, or the slides, that serve them best."""
    fixed, far = fitted_circles(z + u * moving[:, None])
    return Pairs(fixed, moving, far, np.zeros(len(far), dtype=bool))


def _straightened(z: Complex, u: Complex, found: Pairs) -> Pairs:
    """Dyads with slides for pivots so far away that a straight line does as well: rounding decided how far."""
    size = np.abs(z - z.mean()).max()
    if not (np.maximum(np.abs(found.fixed), np.abs(found.moving)) > REMOTE * size).any():
        return found
    body = _slide(found.moving_far, found.moving, np.conj(u) * (found.fixed[:, None] - z), size)
    ground = _slide(found.fixed_far, found.fixed, z + u * found.moving[:, None], size)
    pinned = ~(found.fixed_far | found.moving_far)
    ground_far = pinned & ground[0]
    body_far = pinned & body[0] & ~ground_far
    return Pairs(
        np.where(ground_far, ground[1], found.fixed),
        np.where(body_far, body[1], found.moving),
        found.fixed_far | ground_far,
        found.moving_far | body_far,
    )


def _slide(far: Mask, place: Complex, points: Complex, size: float) -> tuple[Mask, Complex]:
    """Whether the points (dyads, n) lie in a line although `place` is not at infinity, and that line's direction."""
    away = points - points.mean(axis=-1, keepdims=True)
    with np.errstate(invalid="ignore", over="ignore"):
        way = np.exp(0.5j * np.angle(np.sum(away**2, axis=-1)))
        across = np.abs((away * np.conj(way)[:, None]).imag).max(axis=-1)
        extent = np.abs(away).max(axis=-1)
    return ~far & (np.abs(place) > REMOTE * size) & (across <= EXACT * (extent + size)), way


def told(z: Complex, u: Complex, found: Pairs, most: float = np.inf, converged: Mask | None = None) -> Dyads:
    """Dyads (k,) with what they miss, those that miss by no more than `most` of their size."""
    off, size = missed(z, u, found), _size(z, u, found)
    kept = off <= most * size
    converged = kept[kept] if converged is None else converged[kept]
    found, off, size = found.at(kept), off[kept], size[kept]
    nowhere, far = complex(np.nan, np.nan), complex(np.inf, np.inf)
    return Dyads(
        np.where(found.fixed_far, far, found.fixed),
        np.where(found.moving_far, far, found.moving),
        np.where(found.fixed_far, found.fixed, nowhere),
        np.where(found.moving_far, found.moving, nowhere),
        off,
        off <= EXACT * size,
        converged,
    )


def _size(z: Complex, u: Complex, found: Pairs) -> Real:
    """What a dyad's miss is measured by, mm: the way of its pin, the spread of the poses, and what rounding costs."""
    pin, pivot = np.where(found.moving_far, 0, found.moving), np.where(found.fixed_far, 0, found.fixed)
    ways = [
        np.abs(way - way.mean(axis=-1, keepdims=True)).max(axis=-1)
        for way in (z + u * pin[:, None], np.conj(u) * (pivot[:, None] - z))
    ]
    way = np.where(found.moving_far, ways[1], ways[0]) + np.abs(z - z.mean()).max()
    size: Real = way + ROUNDING * (np.abs(pin) + np.abs(pivot) + np.abs(z).max())
    return size


def _row(name: str, given: Points) -> Complex:
    points = np.atleast_1d(np.asarray(given, dtype=complex))
    if points.ndim > 1:
        raise DesignError(name, f"found shape {points.shape}", "give one point or a row of them")
    return points
