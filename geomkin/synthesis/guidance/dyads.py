"""Dyads through poses: a pin or slide on the ground and one on the body, that let it go through all of them."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import Annotated

import numpy as np

from ...arguments import Points, checked, whole_between
from ...brief import one_line
from ...errors import DesignError
from ...plane.vec import Complex, Mask, Real
from .burmester import both_ways, slides_of
from .constraint import Pairs, Relations, joined, missed, pairs_of_least, relations, sharpened, square_slides
from .displacement_poles import PARALLEL
from .dyad_fits import fitted_circles, fitted_dyads
from .poses import Poses, inverse, placed

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


@dataclass(frozen=True, eq=False)
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

    __repr__ = one_line

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
