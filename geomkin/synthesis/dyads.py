"""Dyads through poses: a pin or slide on the ground and one on the body, that let it go through all of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arguments import Points, checked
from ..brief import one_line
from ..errors import DesignError
from ..plane.vec import Complex, Mask, Real
from .circle_fit import fitted_circles
from .constraint import Pairs, freedom, missed, pairs_of_least
from .dyad_fits import fitted_dyads
from .poses import Poses, inverse, placed

# Largest miss of a dyad, in sizes of the poses and of its pin's way, that is called exact: what rounding leaves of
# dyads whose roots lie close together. Larger, and fits are called exact; smaller, and true dyads are not.
EXACT = 1e-9


@dataclass(frozen=True, eq=False)
class Dyads:
    """Dyads that guide a body through poses; every part (dyads,).

    fixed: pins on the ground, mm; inf where the body's pin slides along a straight line of the ground, whose direction
    is then in `fixed_direction`, unit complex, and that passes through the pin's place at the first pose. moving: pins
    on the body, mm in its own frame; inf where a straight line of the body slides over the pin on the ground, with its
    direction in the body's frame in `moving_direction`. Directions are nan where there is no slide. residual: largest
    distance, mm, by which a pose is missed: of the pin from its circle or line, whose radius or offset is the one that
    makes this least. exact: whether that is no more than rounding; where not, it is a least-squares fit.
    """

    fixed: Complex
    moving: Complex
    fixed_direction: Complex
    moving_direction: Complex
    residual: Real
    exact: Mask

    __repr__ = one_line

    def __len__(self) -> int:
        return len(self.fixed)


@checked
def dyads_through(poses: Poses, fixed: Points | None = None, moving: Points | None = None) -> Dyads:
    """Dyads that take a body through poses (origin x + yj in mm, angle in rad), three or more, in this order.

    fixed: pivots on the ground, mm, one or a row, each to be given its pin on the body; or moving: pins on the body,
    mm in its own frame, each to be given its pivot on the ground; nan where any would do, as for a pin that has but two
    places. Without either: of five poses all dyads there are, none to four; of more, least squares of the distances
    missed, the best first, exact ones among them. Three poses are met by a dyad for every pin of the body, four by
    those of a curve, as is said by `burmester_curves`; there one of the two must be given, and of four poses
    what is given off the curve is met in the sense of least squares.

    DesignError for fewer than three poses, equal ones, both fixed and moving, and none of them where infinitely many
    dyads would do: of three or four poses, and of such more as are parallel or turned about one point.
    Constraint: Bottema and Roth, Theoretical Kinematics, 1979, chapter VIII; how it is solved is derived here.
    """
    z, u = placed(poses, 3)
    if fixed is not None and moving is not None:
        raise DesignError("moving", "found both fixed and moving", "give one of them")
    if moving is not None:
        return told(z, u, partners(z, u, _row("moving", moving)))
    if fixed is not None:
        return told(z, u, partners(*inverse(z, u), _row("fixed", fixed)).swapped)
    if freedom(z, u) > 3:
        why = f"found {len(z)}, which infinitely many dyads go through"
        raise DesignError("poses", why, "give fixed or moving points besides, or five poses of no such kind")
    if len(z) > 5:
        return told(z, u, fitted_dyads(z, u))
    found, there = pairs_of_least(z[None], u[None])
    return told(z, u, found.at(there))


def partners(z: Complex, u: Complex, moving: Complex) -> Pairs:
    """For pins on the body (k,) the pivots on the ground, or the slides, that serve them best."""
    fixed, far = fitted_circles(z + u * moving[:, None])
    return Pairs(fixed, moving, far, np.zeros(len(far), dtype=bool))


def told(z: Complex, u: Complex, found: Pairs) -> Dyads:
    """Dyads (k,) with what they miss."""
    off = missed(z, u, found)
    nowhere, far = complex(np.nan, np.nan), complex(np.inf, np.inf)
    ways = [
        np.abs(way - way.mean(axis=-1, keepdims=True)).max(axis=-1)
        for way in (
            z + u * np.where(found.moving_far, 0, found.moving)[:, None],
            np.conj(u) * (np.where(found.fixed_far, 0, found.fixed)[:, None] - z),
        )
    ]
    size = np.where(found.moving_far, ways[1], ways[0]) + np.abs(z - z.mean()).max()
    return Dyads(
        np.where(found.fixed_far, far, found.fixed),
        np.where(found.moving_far, far, found.moving),
        np.where(found.fixed_far, found.fixed, nowhere),
        np.where(found.moving_far, found.moving, nowhere),
        off,
        off <= EXACT * size,
    )


def _row(name: str, given: Points) -> Complex:
    points = np.atleast_1d(np.asarray(given, dtype=complex))
    if points.ndim > 1:
        raise DesignError(name, f"found shape {points.shape}", "give one point or a row of them")
    return points
