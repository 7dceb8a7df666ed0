"""All four-bars through nine points of a path, by continuation from all solutions for nine complex points.

    python -m geomkin.synthesis.path.nine_points SEED FILE

makes the data file of those solutions by monodromy: one solution is followed along loops of the parameters, back to
the same parameters, where it is usually another solution. Loops of all known solutions are repeated until several in a
row find nothing new. The number that is found, 1442 classes of cognates, is that of Wampler, Morgan and Sommese
(Journal of Mechanical Design 114, 1992).
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import cache
from itertools import combinations
from pathlib import Path

import numpy as np

from ...core.records import record
from ...plane.vec import Complex, Real, Whole
from .nine_point_equations import (
    Ends,
    cognates_of,
    follow,
    is_degenerate,
    is_repeated,
    may_be_degenerate,
    refine,
    rotations_of,
)

# Relative distance from a line or circle below which points count as lying on it. With a smaller one the search would
# take the whole time limit for points that nearly do.
ON_CURVE = 1e-9
# Largest difference of a coordinate from the conjugate of its partner, as a share of its size, in a real linkage. The
# number of real linkages is the same from 1e-10 to 1e-5 in 199 of 200 random sets of points.
REAL = 1e-8
# Largest number of missing solutions for which the second set of starts is tried. More are missing only if the points
# are special and have fewer solutions.
FEW_MISSING = 10
# Shares of the progress: all paths, and the doubtful ones.
MAIN_SHARE, DOUBTFUL_SHARE = 0.7, 0.25


@record
class PathCount:
    """Number of paths of the continuation by where they ended.

    Parameters
    ----------
    real : int
        At a real four-bar.
    not_real : int
        At a solution with complex coordinates, which is no linkage.
    repeated : int
        At a solution at which another path ended.
    lost : int
        Nowhere: given up. Points in special positions have fewer solutions, so that such paths tend to no linkage.
    """

    real: int
    not_real: int
    repeated: int
    lost: int

    @property
    def total(self) -> int:
        """Number of paths."""
        return self.real + self.not_real + self.repeated + self.lost

    @property
    def is_complete(self) -> bool:
        """Whether each path ended at a solution of its own, so that no linkage is missing."""
        return self.repeated + self.lost == 0


def through_nine(points: Complex, report: Callable[[float], None]) -> tuple[Real, PathCount]:
    """All four-bars through nine points, one of each three cognates.

    Parameters
    ----------
    points : array of complex, shape (9,)
        Points that do not coincide and are not `special`.
    report : callable
        Called with the share of the work that is done.

    Returns
    -------
    rows : array, shape (s, 8)
        x, y of crank pin, crank pivot, rocker pin and rocker pivot with the coupler point at the first point.
    count : PathCount
        Where the paths ended.

    Notes
    -----
    There are 1442 classes of three cognates over the complex numbers (Wampler, Morgan and Sommese, Complete solution of
    the nine-point path synthesis problem for four-bar linkages, Journal of Mechanical Design 114, 1992). Those of two
    random complex sets of points are stored; `nine_point_starts` makes them. Each is followed while its points move
    along straight lines to the wanted ones. Doubtful ends are followed again in double-double, by all three cognates.
    """
    offsets: Complex = (points - points[0])[1:]
    size = float(np.sqrt(np.mean(np.abs(offsets) ** 2)))
    offsets = offsets / size
    target = np.concatenate([offsets, np.conj(offsets)])
    solutions, lost = _solutions(1, target, report)
    total = len(starts_of(1)[0])
    if 0 < total - len(solutions) <= FEW_MISSING:
        others, others_lost = _solutions(2, target, report)
        both = np.concatenate([solutions, others])
        solutions, lost = both[~is_repeated(both)], min(lost, others_lost)
    capitals, small = solutions[:, 1:8:2], solutions[:, 0:8:2]
    real = np.all(np.abs(capitals - np.conj(small)) < REAL * (1 + np.abs(small)), axis=1)
    lost = min(lost, total - len(solutions))
    count = PathCount(int(real.sum()), int((~real).sum()), total - len(solutions) - lost, lost)
    return (size * small[real] + points[0]).copy().view(float), count


def special(points: Complex) -> str:
    """The special arrangement of nine points that has no isolated four-bars; empty if they have none.

    A coupler curve has degree 6, so that no line has seven points of it, unless the curve contains the line.
    """
    size = np.abs(points - points.mean()).max()
    scaled = (points - points.mean()) / size
    if np.abs(scaled[:, None] - scaled + 2 * np.eye(len(scaled))).min() < ON_CURVE:
        return "two are equal"
    for i, j in combinations(range(len(scaled)), 2):
        direction = (scaled[j] - scaled[i]) / abs(scaled[j] - scaled[i])
        if np.sum(np.abs((np.conj(direction) * (scaled - scaled[i])).imag) < ON_CURVE) >= 7:
            return "seven or more lie on a line"
    conditions = np.stack([np.abs(scaled) ** 2, scaled.real, scaled.imag, np.ones(len(scaled))], axis=1)
    return "all lie on a circle" if np.linalg.svd(conditions)[1][-1] < ON_CURVE else ""


@cache
def starts_of(number: int) -> tuple[Complex, Complex]:
    """A stored set: one solution (s, 16) of each class, and its parameters (16,)."""
    stored = np.load(Path(__file__).with_name(f"nine_points_{number}.npy")).astype(complex)
    parameters, places = stored[:2].ravel(), stored[2:]
    rotations = rotations_of(places, np.broadcast_to(parameters, (len(places), 16)))
    return refine(np.concatenate([places, rotations], axis=1), parameters).x, parameters


def _solutions(number: int, target: Complex, report: Callable[[float], None]) -> tuple[Complex, int]:
    """Distinct solutions (s, 16) for the parameters `target` (16,), and how many paths were lost."""
    starts, parameters = starts_of(number)
    before = 0.0 if number == 1 else MAIN_SHARE + DOUBTFUL_SHARE

    def report_from(first: float, share: float) -> Callable[[float], None]:
        return lambda done: report(before + (1 - before) * (first + share * done))

    ends = follow(starts, parameters, target, report_from(0, MAIN_SHARE))
    x = ends.x
    doubtful = ~ends.reached | may_be_degenerate(x) | is_repeated(x) | is_repeated(x[::-1])[::-1]
    sure = x[~doubtful]
    if not doubtful.any():
        return sure, 0
    again = starts[doubtful]
    all_three = np.concatenate([again, *cognates_of(again, np.broadcast_to(parameters, again.shape))])
    all_three = refine(all_three, parameters).x
    ends = follow(all_three, parameters, target, report_from(MAIN_SHARE, DOUBTFUL_SHARE), precise=True)
    good = ends.reached & ~is_degenerate(ends.x)
    together = np.concatenate([sure, ends.x[good]])
    return together[~is_repeated(together)], int(np.sum(~good.reshape(3, -1).any(axis=0)))


def cranks_and_branches(sizes: Real, wanted: Complex) -> tuple[Real, Whole]:
    """Crank angles (n,) from the ground line and branches (n,) at which a four-bar's coupler point is at each point.

    `sizes` are (9,) in the order of `coupler_paths.NAMES`. Of the two angles that reach a point the one consistent with
    the rocker's length is taken.
    """
    ground, crank, coupler, rocker, x, y, origin_x, origin_y, turn = sizes[:9]
    point = (wanted - complex(origin_x, origin_y)) * np.exp(-1j * turn)
    arm = complex(x, y)
    along = (np.abs(point) ** 2 + crank**2 - abs(arm) ** 2) / (2 * np.abs(point))
    across = np.sqrt(np.maximum(crank**2 - along**2, 0.0))
    pins = point / np.abs(point) * (along + 1j * across * np.array([[1.0], [-1.0]]))
    direction = (point - pins) / arm
    ends = pins + coupler * direction / np.abs(direction)
    off = np.abs(np.abs(ends - ground) - rocker)
    best = np.argmin(off, axis=0)
    pin, end = (np.take_along_axis(v, best[None], axis=0)[0] for v in (pins, ends))
    side = np.where((np.conj(ground - pin) * (end - pin)).imag >= 0, 1, -1)
    return np.angle(pin), side


def with_cognates(places: Real, point: complex) -> list[Real]:
    """A linkage by its pins and pivots (8,) and its cognates as rows (10,), as in `linkage.cognates`."""
    pin, pivot, other, other_pivot = (complex(z) for z in places.view(complex))
    crank, coupler, rocker, ground = pin - pivot, other - pin, other - other_pivot, other_pivot - pivot
    share = (point - pin) / coupler
    third = pivot + share * ground
    rest = 1 - share
    links = (
        (pivot, ground, crank, coupler, rocker),
        (pivot, share * ground, share * coupler, share * crank, share * rocker),
        (third, rest * ground, rest * crank, -rest * rocker, -rest * coupler),
    )
    rows = []
    for origin, d, a, b, c in links:
        arm = (point - origin - a) * np.conj(b) / abs(b)
        lengths = [abs(d), abs(a), abs(b), abs(c)]
        rows.append(np.array([*lengths, arm.real, arm.imag, origin.real, origin.imag, np.angle(d), 0.0]))
    return rows


# Loops in a row without a new solution after which the search ends.
IDLE = 3


def a_solution(rng: np.random.Generator) -> tuple[Complex, Complex]:
    """A random four-bar over the complex numbers, x (16,), and points (16,) that it goes through.

    For given places and rotations the equations have the products d D; their difference is linear in d and D.
    """
    x = _random(rng)
    z, Z, w, W = x[:8].reshape(2, 4).T[:, :, None]
    e = x[8:]
    by_d, by_conjugate = Z / e - W, z * e - w
    rest = z * W + w * Z - z * W * e - w * Z / e
    # D = slope d + shift, and then d D + by_d d + by_conjugate D + rest = 0.
    slope = -(by_d[0] - by_d[1]) / (by_conjugate[0] - by_conjugate[1])
    shift = -(rest[0] - rest[1]) / (by_conjugate[0] - by_conjugate[1])
    linear = shift + by_d[0] + by_conjugate[0] * slope
    d = (-linear + np.sqrt(linear**2 - 4 * slope * (by_conjugate[0] * shift + rest[0]))) / (2 * slope)
    return x, np.concatenate([d, slope * d + shift])


def all_solutions(base: Complex, rng: np.random.Generator) -> Complex:
    """One solution (s, 16) of each class of cognates for the parameters `base` (16,)."""
    start, there = a_solution(rng)
    known = with_new(follow(start[None], there, base, _ignore), np.zeros((0, 16), dtype=complex))
    idle = 0
    while idle < IDLE:
        x, here = known, base
        for corner in (_random(rng), _random(rng), base):
            ends = follow(x, here, corner, _ignore)
            x, here = ends.x[ends.reached], corner
        before = len(known)
        known = with_new(ends, known)
        idle = 0 if len(known) > before else idle + 1
        print(f"{len(known)} solutions", flush=True)
    return known


def with_new(ends: Ends, known: Complex) -> Complex:
    """The known solutions and those of `ends` that are not cognates of them or of each other."""
    together = np.concatenate([known, ends.x[ends.reached & ~is_degenerate(ends.x)]])
    return together[~is_repeated(together)]


def _ignore(share: float) -> None: ...


def _random(rng: np.random.Generator) -> Complex:
    numbers: Complex = rng.normal(size=16) + 1j * rng.normal(size=16)
    return numbers


if __name__ == "__main__":
    generator = np.random.default_rng(int(sys.argv[1]))
    # Rounded first, so that the file states the parameters exactly.
    parameters = _random(generator).astype(np.complex64)
    solutions = all_solutions(parameters.astype(complex), generator)
    np.save(sys.argv[2], np.concatenate([parameters.reshape(2, 8), solutions[:, :8].astype(np.complex64)]))
