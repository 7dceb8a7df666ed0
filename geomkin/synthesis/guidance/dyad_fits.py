"""Dyads that miss more than five poses by as little as can be."""

from __future__ import annotations

from itertools import combinations, islice

import numpy as np

from ...plane.vec import Complex, Real, Whole
from .circle_fit import distances
from .constraint import FAR, Pairs, joined, missed, normalised, pairs_of_least, relations
from .least_squares import least_squares
from .poses import inverse

# Sets of five poses from which fits start besides. Fewer may miss the best fit of poses that no dyad nearly meets;
# more cost time.
MOST_FIVES = 12
# Difference of two fits, in sizes, below which they are one: least squares are flat, and found to half the digits.
# Larger, and two are taken for one; smaller, and one is told twice.
SAME = 1e-4


def fitted_dyads(origins: Complex, directions: Complex) -> Pairs:
    """Dyads at which the sum of squared distances missed is least, near by, best first.

    Starts: the dyads of the least three rows of all poses, and those of sets of five of them, evenly chosen.
    """
    z, middle, size = normalised(origins)
    sets = list(combinations(range(len(z)), 5)) if len(z) < 12 else _spread(len(z))
    chosen = np.array(sets)[np.unique(np.linspace(0, len(sets) - 1, MOST_FIVES).astype(int))]
    sets_of_all = relations(z, directions), relations(z[chosen], directions[chosen])
    starts = joined([found.at(there) for found, there in map(pairs_of_least, sets_of_all)])
    body = starts.moving_far | (~starts.fixed_far & (np.abs(starts.moving) > np.abs(starts.fixed)))
    on_ground = _polished(z, directions, starts.at(~body))
    on_body = _polished(*inverse(z, directions), starts.at(body).swapped).swapped
    found = joined([on_ground, on_body])
    found = found.at(np.argsort(missed(z, directions, found), kind="stable"))
    found = found.at(_different(found))
    return Pairs(
        np.where(found.fixed_far, found.fixed, middle + size * found.fixed),
        np.where(found.moving_far, found.moving, size * found.moving),
        found.fixed_far,
        found.moving_far,
    )


def _spread(count: int) -> list[tuple[int, ...]]:
    """Sets of five out of many, each evenly spread, from different firsts."""
    step = count // 5
    return [tuple(first + step * k for k in range(5)) for first in islice(range(step), MOST_FIVES)]


def _polished(z: Complex, u: Complex, starts: Pairs) -> Pairs:
    """The same at their least squares; the pin on the body is no slide."""
    if not starts.fixed.size:
        return starts
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
    x = least_squares(cost, start)
    bend, slope = x[:, 2], x[:, 3] + 1j * x[:, 4]
    far = 2 * np.abs(bend) * FAR <= np.abs(slope)
    with np.errstate(divide="ignore", invalid="ignore"):
        fixed = np.where(far, 1j * slope / np.abs(slope), -slope / (2 * bend))
    return Pairs(fixed, x[:, 0] + 1j * x[:, 1], far, np.zeros(len(x), dtype=bool))


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
