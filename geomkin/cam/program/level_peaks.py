"""The optimum to the last digit, from a solution that has found which of its peaks count."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev

from ...plane.vec import Array
from .boundary import condition_row, derive


@dataclass(frozen=True, eq=False)
class Level:
    """coefficients (n,); places of the peaks that count and their multipliers, as `least_peak.bound` takes them."""

    coefficients: Array
    places: Array
    weights: Array
    limited_places: Array
    shares: Array


def level_peaks(c: Array, equal: Array, values: Array, peaked: int, limited: int, limit: float, near: float) -> Level:
    """Newton's method on the conditions of an optimum, for a Chebyshev series with coefficients c.

    The derivative of order `peaked` has its peaks least, that of order `limited` is at most `limit`,
    infinite for none.
    At the optimum the peaks that count are of one height, the limited ones that count are at the
    limit, and their weights together pull c nowhere that equal c = values leaves free. A peak's
    height bends as its place moves with c: without that term the method would not converge where
    fewer peaks count than c has freedoms. near: how far below the highest, relative, a peak counts.
    """
    n, e = len(c), len(equal)
    weight: Array = np.zeros(0)
    # Quadratic from a percent off; an eighth step changes nothing.
    for _ in range(8):
        series = derive(c, peaked)
        places, signs, bend = _near(series, (1 - near) * peak(series))
        limited_places, limited_signs, limited_bend = _near(derive(c, limited), (1 - near) * limit)
        k, j = len(places), len(limited_places)
        if len(weight) != k + j:
            weight = np.concatenate([np.full(k, 1 / k), np.zeros(j)])
        active, moved = (
            np.vstack(
                [_rows(signs, places, peaked + up, n), _rows(limited_signs, limited_places, limited + up, n) / limit]
            )
            for up in (0, 1)
        )
        bends = np.maximum(weight, 0) * np.append(bend, limited_bend * limit)
        # Unknown: the step of c, the weights, the multipliers of the conditions, the height.
        a, m, t = slice(n, n + k + j), slice(n + k + j, n + k + j + e), n + k + j + e
        system, right = np.zeros((t + 1, t + 1)), np.zeros(t + 1)
        system[:n, :n] = moved.T @ (bends[:, None] * moved)
        system[a, :n], system[:n, a] = active, active.T
        system[m, :n], system[:n, m] = equal, equal.T
        system[n : n + k, t] = system[t, n : n + k] = -1
        right[a] = np.append(np.zeros(k), np.ones(j)) - active @ c
        right[m] = values - equal @ c
        right[t] = -1
        found = np.linalg.lstsq(system, right, rcond=1e-14)[0]
        c, weight = c + found[:n], found[a]
    return Level(c, places, signs * weight[:k], limited_places, limited_signs * weight[k:])


def _rows(signs: Array, places: Array, order: int, n: int) -> Array:
    return signs[:, None] * condition_row(places, order, n - 1).T


def _near(series: Array, least: float) -> tuple[Array, Array, Array]:
    """Places of the extremes of at least that size, their signs, and how fast each rises as its place may move.

    That is 1 / |second derivative|, or 0 at the ends, which do not move.
    """
    places = extremes(series)
    value, second = (chebyshev.chebval(2 * places - 1, derive(series, k)) for k in (0, 2))
    bend = np.zeros(len(places))
    # A peak so flat that it has no place gives a term that would drown the others: a smaller one only slows.
    bend[1:-1] = 1 / np.maximum(np.abs(second[1:-1]), 1e-3 * np.abs(second).max(initial=1e-300))
    near = np.abs(value) >= least
    return places[near], np.sign(value[near]), bend[near]


def peak(series: Array) -> float:
    """Largest size of a Chebyshev series over 0 <= x <= 1."""
    return float(np.abs(chebyshev.chebval(2 * extremes(series) - 1, series)).max())


def extremes(series: Array) -> Array:
    """Places in 0 <= x <= 1 where a Chebyshev series is extreme, the ends among them."""
    slope = chebyshev.chebder(series)
    # Leading coefficients that are rounding would send roots to infinity.
    slope = chebyshev.chebtrim(slope, 1e-13 * np.abs(slope).max())
    roots = chebyshev.chebroots(slope)
    # A double root comes out as a pair beside the axis, off it by the root of the rounding.
    real = np.real(roots)[(np.abs(np.imag(roots)) < 1e-6) & (np.abs(np.real(roots)) < 1)]
    return np.unique(np.concatenate([[0.0], (real + 1) / 2, [1.0]]))
