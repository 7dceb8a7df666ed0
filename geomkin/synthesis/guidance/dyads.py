"""Dyads through given poses, and least-squares fits: circles through points, dyads through more than five poses."""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations, islice
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from ...core.arguments import checked, whole_between
from ...core.errors import DesignError
from ...core.records import record
from ...plane.vec import Complex, Mask, Real, Whole
from .burmester import as_seen_by_ground_and_body, slides_of
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
from .poses import PARALLEL, Poses, distinct_poses, inverse

# Number of sets of five poses that give starts of a fit. Fewer may miss the best fit of poses that no dyad nearly
# meets; more cost time.
MOST_FIVES = 12
# Relative difference below which two fits are the same. Least squares are flat and found to half of the digits; a
# larger value merges distinct fits, a smaller one lists a fit twice.
SAME = 1e-4
# Ratio of singular values below which points are at two positions only. A larger value refuses circles through points
# close together; a smaller one takes rounding for a third position.
FEWER = 1e-12
# Largest number of steps, taken for all starts together; a start that needs more moves along a valley to infinity.
STEPS = 300
# Relative gain of a step below which a start has converged.
CONVERGED = 1e-13
# Largest unknown, in units of the size. Beyond it fourth powers overflow; a smaller limit stops fits of far pivots.
FARTHEST = 1e12


def fitted_dyads(origins: Complex, directions: Complex) -> tuple[Pairs, Mask]:
    """Local least-squares dyads, the best first, and which of them have converged.

    The others move towards a dyad at infinity and are given as they were after the last step. Starts are the dyads of
    the three smallest singular vectors of all poses, and those of evenly chosen sets of five poses.
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
    """Sets of five poses out of many, each evenly spread, with different first poses."""
    step = count // 5
    return [tuple(first + step * k for k in range(5)) for first in islice(range(step), MOST_FIVES)]


def _polished(z: Complex, u: Complex, starts: Pairs) -> tuple[Pairs, Mask]:
    """Starts improved by least squares, and which have converged; the pin on the body is no slide."""
    if not starts.fixed.size:
        return starts, np.zeros(0, dtype=bool)
    m = starts.moving[:, None]
    pins = z + u * m
    with np.errstate(invalid="ignore"):
        # |p - f|^2 - r^2 divided by |f|, so that a far pivot becomes a line.
        pivot_distance = np.where(starts.fixed_far, 1.0, np.maximum(1.0, np.abs(starts.fixed)))
        curvature = np.where(starts.fixed_far, 0.0, 1 / pivot_distance)[:, None]
        slope = np.where(starts.fixed_far, -1j * starts.fixed, -2 * starts.fixed / pivot_distance)[:, None]
    level = -(curvature * np.abs(pins) ** 2 + (np.conj(slope) * pins).real).mean(axis=-1, keepdims=True)

    def cost(x: Real, _: Whole) -> tuple[Real, Real]:
        pins = z + u * (x[:, :1] + 1j * x[:, 1:2])
        distance, by = curve_distances(pins, x[:, 2:3], x[:, 3:4] + 1j * x[:, 4:5], x[:, 5:])
        by_x, by_y = by[4] * u.real + by[5] * u.imag, by[5] * u.real - by[4] * u.imag
        return distance, np.stack([by_x, by_y, *by[:4]], axis=-1)

    start = np.concatenate([m.real, m.imag, curvature, slope.real, slope.imag, level], axis=-1)
    x, converged = separate_least_squares(cost, start)
    curvature, slope = x[:, 2], x[:, 3] + 1j * x[:, 4]
    is_far = 2 * np.abs(curvature) * FAR <= np.abs(slope)
    with np.errstate(divide="ignore", invalid="ignore"):
        fixed = np.where(is_far, 1j * slope / np.abs(slope), -slope / (2 * curvature))
    return Pairs(fixed, x[:, 0] + 1j * x[:, 1], is_far, np.zeros(len(x), dtype=bool)), converged


def _different(found: Pairs) -> Whole:
    distinct: list[int] = []
    for k in range(found.fixed.size):
        duplicates = [
            j
            for j in distinct
            if all(
                far[j] == far[k] and abs(place[j] - place[k]) <= SAME * (1 + abs(place[k]))
                for far, place in ((found.fixed_far, found.fixed), (found.moving_far, found.moving))
            )
        ]
        if not duplicates and np.isfinite(found.fixed[k]) and np.isfinite(found.moving[k]):
            distinct.append(k)
    return np.array(distinct, dtype=int)


def fitted_circles(points: Complex) -> tuple[Complex, Mask]:
    """Centres (k,) of rows of points (k, n), mm, and a mask of those at infinity.

    A centre at infinity is replaced by the direction of the line, unit complex.

    Each is the best circle or line by least squares of distances, exact through three points. The centre is nan if the
    points are at two positions, through which many circles pass, and the common position if they coincide.
    """
    middle = points.mean(axis=-1, keepdims=True)
    size = np.abs(points - middle).max(axis=-1, keepdims=True)
    is_single = size[:, 0] <= 1e-14 * np.abs(points).max(axis=-1)
    p = (points - middle) / np.where(size == 0, 1.0, size)
    square = np.abs(p) ** 2
    equations = np.stack([square - square.mean(axis=-1, keepdims=True), p.real, p.imag], axis=-1)
    _, sizes, directions = np.linalg.svd(equations, full_matrices=False)
    are_two = sizes[:, 1] <= FEWER * sizes[:, 0]
    curvature: Real = directions[:, 2, 0]
    slope: Complex = directions[:, 2, 1] + 1j * directions[:, 2, 2]
    level = -(curvature[:, None] * square + (np.conj(slope)[:, None] * p).real).mean(axis=-1)
    if points.shape[-1] > 3 and (sizes[:, 2] > FEWER * sizes[:, 0]).any():
        curvature, slope, level = _refined(p, curvature, slope, level)
    is_line = 2 * np.abs(curvature) * FAR <= np.abs(slope)
    with np.errstate(divide="ignore", invalid="ignore"):
        centre = np.where(is_line, 1j * slope / np.abs(slope), middle[:, 0] - size[:, 0] * slope / (2 * curvature))
    centre[are_two] = complex(np.nan, np.nan)
    return np.where(is_single, middle[:, 0], centre), is_line & ~are_two & ~is_single


def curve_distances(
    p: Complex, curvature: Real, slope: Complex, level: Real
) -> tuple[Real, tuple[Real, Real, Real, Real, Real, Real]]:
    """Signed distances (..., n) of points from curvature |p|^2 + Re(conj(slope) p) + level = 0, with their derivatives.

    The coefficients (..., 1) have any common scale. Derivatives are by curvature, slope x, slope y, level, then by p x
    and p y. Chernov, Circular and Linear Regression, 2010, section 3.2, has the distance in this form, which holds for
    lines too.
    """
    value = curvature * np.abs(p) ** 2 + (np.conj(slope) * p).real + level
    # A circle of zero or imaginary radius counts as a point.
    terms = np.abs(slope) ** 2 + 4 * np.abs(curvature * level) + 1e-300
    size = np.sqrt(np.maximum(np.abs(slope) ** 2 - 4 * curvature * level, 1e-28 * terms))
    gradient = 2 * curvature * p + slope
    gradient_size = np.maximum(np.abs(gradient), 1e-14 * np.sqrt(terms))
    total = size + gradient_size
    distance = 2 * value / total

    def derivative(value_by: Real, square_by: Real, far_square_by: Real) -> Real:
        # From the derivatives of the value, of size^2 and of gradient_size^2.
        change: Real = (
            2 * value_by - distance * (square_by / (2 * size) + far_square_by / (2 * gradient_size))
        ) / total
        return change

    zero = np.zeros_like(distance)
    by_curvature = derivative(np.abs(p) ** 2 + zero, -4 * level + zero, 4 * (np.conj(p) * gradient).real)
    by_x = derivative(p.real, 2 * slope.real + zero, 2 * gradient.real)
    by_y = derivative(p.imag, 2 * slope.imag + zero, 2 * gradient.imag)
    by_level = derivative(zero + 1, -4 * curvature + zero, zero)
    # The distance grows at unit rate along the outward normal.
    return distance, (by_curvature, by_x, by_y, by_level, gradient.real / gradient_size, gradient.imag / gradient_size)


def _refined(p: Complex, curvature: Real, slope: Complex, level: Real) -> tuple[Real, Complex, Real]:
    """Coefficients of the circles with the least distances from the points, by damped steps (Levenberg-Marquardt)."""

    def cost(x: Real, rows: Whole) -> tuple[Real, Real]:
        distance, by = curve_distances(p[rows], x[:, :1], x[:, 1:2] + 1j * x[:, 2:3], x[:, 3:])
        return distance, np.stack(by[:4], axis=-1)

    best, _ = separate_least_squares(cost, np.stack([curvature, slope.real, slope.imag, level], axis=-1))
    return best[:, 0], best[:, 1] + 1j * best[:, 2], best[:, 3]


def separate_least_squares(cost: Callable[[Real, Whole], tuple[Real, Real]], start: Real) -> tuple[Real, Mask]:
    """Unknowns (k, q) with the least sum of squared residuals, each from its own start, and which (k,) have converged.

    `cost` maps unknowns (k, q) and the indices of their starts to residuals (k, n) and derivatives (k, n, q). Unknowns
    with a common free scale are allowed, since the damping fixes it. Levenberg 1944, Marquardt 1963.
    """
    best = np.array(start)
    rows = np.arange(len(start))
    x, damping, eye = best, np.full(len(start), 1e-3), np.eye(best.shape[-1])
    residuals, slopes = cost(x, rows)
    for _ in range(STEPS):
        if not len(rows):
            break
        squares = np.sum(residuals**2, axis=-1)
        normal = np.einsum("kni,knj->kij", slopes, slopes)
        right = np.einsum("kni,kn->ki", slopes, residuals)
        trace = np.trace(normal, axis1=-2, axis2=-1)[:, None, None]
        damped = normal + (damping[:, None, None] + 1e-14) * (trace + 1e-300) * eye
        trial = x - np.linalg.solve(damped, right[..., None])[..., 0]
        new_residuals, new_slopes = cost(trial, rows)
        new_squares = np.sum(new_residuals**2, axis=-1)
        # A start that diverges has its minimum at infinity.
        better = (new_squares < squares) & (np.abs(trial).max(axis=-1) < FARTHEST)
        done = np.where(better, squares - new_squares <= CONVERGED * squares, damping > 1e6)
        x = np.where(better[:, None], trial, x)
        residuals, slopes = (
            np.where(better[:, None], new_residuals, residuals),
            np.where(better[:, None, None], new_slopes, slopes),
        )
        damping = np.clip(np.where(better, damping * 0.1, damping * 5), 1e-15, 1e12)
        best[rows] = x
        is_open = ~done
        x, residuals, slopes, damping, rows = (
            x[is_open],
            residuals[is_open],
            slopes[is_open],
            damping[is_open],
            rows[is_open],
        )
    return best, ~np.isin(np.arange(len(start)), rows)


# Largest error of an exact dyad, in sizes of the poses and of its pin's displacements: the rounding left in
# dyads whose roots lie close together. A larger value accepts fits as exact; a smaller one refuses true dyads.
EXACT = 1e-9
# Distance, in sizes of the poses, beyond which a pivot may be an effect of rounding; a slide is tried instead.
REMOTE = 1e6
# Largest error of an accepted root. A smaller value loses true dyads that nearly coincide with another.
MISSED = 1e-5
# Rounding of the poses as a share of their coordinates, in units of EXACT. With a smaller value dyads of poses close
# together, or far from the origin, do not count as exact.
ROUNDING = 1e-5


@record(eq=False)
class Dyads:
    """Dyads that guide a body through poses; every field has one entry per dyad.

    Parameters
    ----------
    fixed : array of complex, shape (dyads,)
        Pivots on the ground, mm. inf if the body's pin slides along a straight line of the ground, which passes through
        the pin's position at the first pose.
    moving : array of complex, shape (dyads,)
        Pins on the body, mm in its frame. inf if a straight line of the body slides over the pivot.
    fixed_direction : array of complex, shape (dyads,)
        Direction of the line on the ground, unit complex; nan without such a slide.
    moving_direction : array of complex, shape (dyads,)
        Direction of the line on the body in its frame, unit complex; nan without such a slide.
    residual : array, shape (dyads,)
        Largest distance of the pin from its circle or line at any pose, mm, with the radius or offset that makes it
        least.
    exact : array of bool, shape (dyads,)
        Whether the residual is only rounding; if not, the dyad is a least-squares fit.
    converged : array of bool, shape (dyads,)
        False for a fit that was still moving towards a dyad at infinity after the last step.
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
    fixed: None | complex | ArrayLike = None,
    moving: None | complex | ArrayLike = None,
    count: Annotated[int, whole_between(1, 100_000)] = 360,
) -> Dyads:
    """Find dyads that carry a body through three or more poses.

    Parameters
    ----------
    poses : sequence of (complex, float)
        Each pose is the position x + yj of the body's origin, mm, and its angle, rad, in this order.
    fixed : complex or array_like, optional
        Pivots on the ground, mm: the best pin on the body is found for each.
    moving : complex or array_like, optional
        Pins on the body in its frame, mm: the best pivot on the ground is found for each. It is nan if any pivot
        serves, as for a pin with only two positions.
    count : int
        Approximate number of dyads along the curves of four poses, 1 to 100000.

    Returns
    -------
    Dyads
        With `fixed` or `moving`: one dyad each, by least squares if no exact one exists. Otherwise for four poses the
        two slides and dyads along all branches of the curves that `burmester_curves` gives; for five poses all dyads,
        none to four; for six and more the local least-squares fits with exact ones among them, by rising residual.
        Poses with infinitely many slides, as of an elliptic trammel, give two slides at right angles: the one with the
        longest travel and its partner.

    Raises
    ------
    DesignError
        For fewer than three poses, equal poses, both `fixed` and `moving`, or neither if every point of the body is a
        solution: for three poses, and for more that are parallel or rotated about one point.

    See Also
    --------
    body_guides

    Notes
    -----
    Constraint: Bottema and Roth, Theoretical Kinematics, 1979, chapter VIII; its solution is derived here.

    Examples
    --------
    >>> import geomkin as gk
    >>> poses = [(0j, 0.0), (40 + 20j, 0.5), (60 + 60j, 1.4)]
    >>> gk.dyads_through(poses, moving=[0, 20]).exact.tolist()
    [True, True]
    """
    z, u = distinct_poses(poses, 3)
    if fixed is not None and moving is not None:
        raise DesignError("moving", "found both fixed and moving", "give one of them", "conflict")
    if moving is not None:
        return as_dyads(z, u, partners(z, u, _row("moving", moving)))
    if fixed is not None:
        return as_dyads(z, u, partners(*inverse(z, u), _row("fixed", fixed)).swapped)
    conditions = relations(z, u)
    freedom = conditions.freedom
    if freedom > 4 or np.abs(u - u[0]).max() <= PARALLEL:
        why = f"found {len(z)}, for which every point of the body is a solution"
        raise DesignError("poses", why, "give moving or fixed points too, or more poses that rotate the body")
    if freedom == 4:
        return as_dyads(z, u, _two_slides(z, u, conditions, _along_curves(z, u, count)))
    # More than five poses have exact dyads if their conditions have the rank of five.
    if freedom < 3:
        fits, converged = fitted_dyads(z, u)
        return as_dyads(z, u, _straightened(z, u, fits), converged=converged)
    found, there = pairs_of_least(conditions)
    found = found.at(there)
    # With only two different angles a further solution fixes the angle itself; it is no dyad and is left out.
    found = _straightened(z, u, sharpened(z, u, found) if len(z) == 5 else found)
    return as_dyads(z, u, _two_slides(z, u, conditions, found), MISSED)


def _two_slides(z: Complex, u: Complex, conditions: Relations, dyads: Pairs) -> Pairs:
    """The dyads, with all slides in a direction replaced by the two special ones if there are infinitely many."""
    ground = square_slides(z, u, conditions)
    if ground is not None:
        dyads = joined([ground, dyads.at(~dyads.fixed_far | dyads.moving_far)])
    z, u = inverse(z, u)
    body = square_slides(z, u, relations(z, u))
    if body is not None:
        dyads = joined([body.swapped, dyads.at(~dyads.moving_far | dyads.fixed_far)])
    return dyads


def _along_curves(z: Complex, u: Complex, count: int) -> Pairs:
    """The slides, and dyads along the curves of four of the poses; further poses, if any, add no condition."""
    four = next(list(k) for k in combinations(range(len(z)), 4) if relations(z[list(k)], u[list(k)]).freedom == 4)
    ground, body = as_seen_by_ground_and_body(z[four], u[four])
    loops = ground.cubic.loops
    per_loop = max(1, count // max(1, len(loops)))
    # Starts at half a step, since a loop of a line and a conic may be at infinity at 0.
    t = 2 * np.pi * (np.arange(per_loop) + 0.5) / per_loop
    dyads = [slides_of(ground, body)]
    for loop in loops:
        place, weight, _, _ = ground.cubic.run(loop, t)
        fixed, moving = ground.point(place, weight), ground.partner(place, weight)
        is_far = np.zeros(per_loop, dtype=bool)
        dyads.append(Pairs(fixed, moving, is_far, is_far).at(np.isfinite(fixed) & np.isfinite(moving)))
    return joined(dyads)


def partners(z: Complex, u: Complex, moving: Complex) -> Pairs:
    """The best pivots on the ground, or slides, for pins on the body (k,)."""
    fixed, far = fitted_circles(z + u * moving[:, None])
    return Pairs(fixed, moving, far, np.zeros(len(far), dtype=bool))


def _straightened(z: Complex, u: Complex, found: Pairs) -> Pairs:
    """Dyads with slides in place of pivots that are so far away that a straight line fits as well."""
    size = np.abs(z - z.mean()).max()
    if not (np.maximum(np.abs(found.fixed), np.abs(found.moving)) > REMOTE * size).any():
        return found
    body = _fitted_line(found.moving_far, found.moving, np.conj(u) * (found.fixed[:, None] - z), size)
    ground = _fitted_line(found.fixed_far, found.fixed, z + u * found.moving[:, None], size)
    pinned = ~(found.fixed_far | found.moving_far)
    ground_far = pinned & ground[0]
    body_far = pinned & body[0] & ~ground_far
    return Pairs(
        np.where(ground_far, ground[1], found.fixed),
        np.where(body_far, body[1], found.moving),
        found.fixed_far | ground_far,
        found.moving_far | body_far,
    )


def _fitted_line(far: Mask, place: Complex, points: Complex, size: float) -> tuple[Mask, Complex]:
    """Whether points (dyads, n) are collinear although `place` is finite, and the direction of the line."""
    offsets = points - points.mean(axis=-1, keepdims=True)
    with np.errstate(invalid="ignore", over="ignore"):
        direction = np.exp(0.5j * np.angle(np.sum(offsets**2, axis=-1)))
        across = np.abs((offsets * np.conj(direction)[:, None]).imag).max(axis=-1)
        extent = np.abs(offsets).max(axis=-1)
    return ~far & (np.abs(place) > REMOTE * size) & (across <= EXACT * (extent + size)), direction


def as_dyads(z: Complex, u: Complex, pairs: Pairs, most: float = np.inf, converged: Mask | None = None) -> Dyads:
    """Dyads (k,) with their errors; those whose error exceeds `most` of their size are left out."""
    errors, size = missed(z, u, pairs), _size(z, u, pairs)
    is_kept = errors <= most * size
    converged = is_kept[is_kept] if converged is None else converged[is_kept]
    pairs, errors, size = pairs.at(is_kept), errors[is_kept], size[is_kept]
    undefined, infinite = complex(np.nan, np.nan), complex(np.inf, np.inf)
    return Dyads(
        np.where(pairs.fixed_far, infinite, pairs.fixed),
        np.where(pairs.moving_far, infinite, pairs.moving),
        np.where(pairs.fixed_far, pairs.fixed, undefined),
        np.where(pairs.moving_far, pairs.moving, undefined),
        errors,
        errors <= EXACT * size,
        converged,
    )


def _size(z: Complex, u: Complex, found: Pairs) -> Real:
    """Reference length for the error of a dyad, mm.

    It depends on the displacement of its pin, the spread of the poses, and rounding.
    """
    pin, pivot = np.where(found.moving_far, 0, found.moving), np.where(found.fixed_far, 0, found.fixed)
    spreads = [
        np.abs(positions - positions.mean(axis=-1, keepdims=True)).max(axis=-1)
        for positions in (z + u * pin[:, None], np.conj(u) * (pivot[:, None] - z))
    ]
    positions = np.where(found.moving_far, spreads[1], spreads[0]) + np.abs(z - z.mean()).max()
    size: Real = positions + ROUNDING * (np.abs(pin) + np.abs(pivot) + np.abs(z).max())
    return size


def _row(name: str, given: complex | ArrayLike) -> Complex:
    points = np.atleast_1d(np.asarray(given, dtype=complex))
    if points.ndim > 1:
        raise DesignError(name, f"found shape {points.shape}", "give one point or a row of them", "wrong-type")
    return points
