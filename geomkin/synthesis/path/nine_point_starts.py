"""Makes the data file of all solutions of the nine-point equations for a random complex set of nine points.

    python -m geomkin.synthesis.path.nine_point_starts SEED FILE

Monodromy: one solution is followed along loops of the parameters, back to the same parameters, where it is usually
another solution. Loops of all known solutions are repeated until several in a row find nothing new. The number that is
found, 1442 classes of cognates, is that of Wampler, Morgan and Sommese (Journal of Mechanical Design 114, 1992).
"""

from __future__ import annotations

import sys

import numpy as np

from ...plane.vec import Complex
from .homotopy import Ends, follow
from .nine_point_equations import is_degenerate, is_repeated

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
