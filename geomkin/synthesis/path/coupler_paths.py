"""Coupler points of many linkages at once, with their derivatives: what searches for paths differentiate.

A four-bar or a slider-crank as a row of numbers, in the order of `NAMES`. Of a slider-crank `ground` is the offset of
the slide line, and `rocker` stands for nothing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...plane.vec import Complex, Real, dot

NAMES = ("ground", "crank", "coupler", "rocker", "x", "y", "origin_x", "origin_y", "ground_angle", "start")
GROUND, CRANK, COUPLER, ROCKER, ARM_X, ARM_Y, ORIGIN_X, ORIGIN_Y, TURN, START = range(10)


@dataclass(frozen=True, eq=False)
class Paths:
    """Of s linkages at n cranks each: point (s, n) and folding, the cosine of the transmission angle with its sign.

    by_size: derivatives (s, n, 9) of the point by the first nine numbers; by_crank: (s, n) by the crank's angle;
    folding_by_size, folding_by_crank alike. nan where a linkage does not close.
    """

    point: Complex
    by_size: Complex
    by_crank: Complex
    folding: Real
    folding_by_size: Real
    folding_by_crank: Real


def closing(x: Real, cranks: Real, branch: Real, slides: bool) -> tuple[Complex, Complex]:
    """Directions (s, n) of crank and coupler from the ground line; the coupler's is nan where a linkage is open."""
    d, a, b, c = (x[:, k, None] for k in (GROUND, CRANK, COUPLER, ROCKER))
    crank: Complex = np.exp(1j * cranks)
    with np.errstate(invalid="ignore", divide="ignore"):
        if slides:
            sine = (d - a * crank.imag) / b
            return crank, branch[:, None] * np.sqrt(1 - sine**2) + 1j * sine
        across = d - a * crank
        square = np.abs(across) ** 2
        along = (square + b**2 - c**2) / (2 * b)
        coupler: Complex = across * (along + 1j * branch[:, None] * np.sqrt(square - along**2)) / square
    return crank, coupler


def points_of(x: Real, cranks: Real, branch: Real, slides: bool) -> Complex:
    """Coupler points (s, n), nan where a linkage is open."""
    crank, coupler = closing(x, cranks, branch, slides)
    arm = (x[:, ARM_X] + 1j * x[:, ARM_Y])[:, None]
    placed = x[:, CRANK, None] * crank + arm * coupler
    points: Complex = (x[:, ORIGIN_X] + 1j * x[:, ORIGIN_Y])[:, None] + np.exp(1j * x[:, TURN, None]) * placed
    return points


def along(x: Real, cranks: Real, branch: Real, slides: bool) -> tuple[Complex, Complex]:
    """Coupler points (s, n) and their derivatives by the crank's angle; nan where a linkage is open."""
    d, a, b = (x[:, k, None] for k in (GROUND, CRANK, COUPLER))
    crank, coupler = closing(x, cranks, branch, slides)
    arm = (x[:, ARM_X] + 1j * x[:, ARM_Y])[:, None]
    rocker = 1j * np.ones_like(crank) if slides else a * crank + b * coupler - d
    with np.errstate(invalid="ignore", divide="ignore"):
        swing = -a * dot(rocker, 1j * crank) / (b * dot(rocker, 1j * coupler))
    turn = np.exp(1j * x[:, TURN, None])
    origin = (x[:, ORIGIN_X] + 1j * x[:, ORIGIN_Y])[:, None]
    return origin + turn * (a * crank + arm * coupler), turn * (1j * a * crank + 1j * arm * coupler * swing)


def paths(x: Real, cranks: Real, branch: Real, slides: bool) -> Paths:
    """Coupler points and all first derivatives, by implicit differentiation of the loop. Derived here."""
    d, a, b, c = (x[:, k, None] for k in (GROUND, CRANK, COUPLER, ROCKER))
    crank, coupler = closing(x, cranks, branch, slides)
    arm = (x[:, ARM_X] + 1j * x[:, ARM_Y])[:, None]
    turn = np.exp(1j * x[:, TURN, None])
    with np.errstate(invalid="ignore", divide="ignore"):
        # The direction along which the coupler's far pin cannot give: the rocker's, or across the slide.
        rocker = np.full_like(crank, 1j) if slides else (a * crank + b * coupler - d) / c
        give = b * dot(rocker, 1j * coupler)
        ones = np.ones_like(give)
        by = (
            (ones if slides else rocker.real) / give,
            -dot(rocker, crank) / give,
            -dot(rocker, coupler) / give,
            0 * ones if slides else ones / give,
        )
        swing = -a * dot(rocker, 1j * crank) / give
    spin = 1j * arm * coupler
    zero = np.zeros_like(crank)
    sizes = [turn * v for v in (spin * by[0], crank + spin * by[1], spin * by[2], spin * by[3], coupler, 1j * coupler)]
    placed = turn * (a * crank + arm * coupler)
    by_size = np.stack([*sizes, zero + 1, zero + 1j, 1j * placed], axis=-1)
    by_crank = turn * (1j * a * crank + spin * swing)
    origin = (x[:, ORIGIN_X] + 1j * x[:, ORIGIN_Y])[:, None]
    return Paths(origin + placed, by_size, by_crank, *folding(x, cranks, slides))


def folded(x: Real, cranks: Real, slides: bool) -> Real:
    """Cosine of the transmission angle (s, n), with its sign; beyond 1 to either side the linkage does not close."""
    d, a, b, c = (x[:, k, None] for k in (GROUND, CRANK, COUPLER, ROCKER))
    if slides:
        sine: Real = (d - a * np.sin(cranks)) / b
        return sine
    cosine: Real = (b**2 + c**2 - (d - a) ** 2 - 2 * a * d * (1 - np.cos(cranks))) / (2 * b * c)
    return cosine


def folding(x: Real, cranks: Real, slides: bool) -> tuple[Real, Real, Real]:
    """The same with its derivatives by sizes (s, n, 9) and by crank (s, n)."""
    d, a, b, c = (x[:, k, None] for k in (GROUND, CRANK, COUPLER, ROCKER))
    cos, sin = np.cos(cranks), np.sin(cranks)
    value = folded(x, cranks, slides)
    by_size = np.zeros((*cranks.shape, 9))
    if slides:
        by_size[..., GROUND], by_size[..., CRANK], by_size[..., COUPLER] = 1 / b, -sin / b, -value / b
        return value, by_size, -a * cos / b
    by_size[..., GROUND], by_size[..., CRANK] = (a * cos - d) / (b * c), (d * cos - a) / (b * c)
    by_size[..., COUPLER], by_size[..., ROCKER] = 1 / c - value / b, 1 / b - value / c
    return value, by_size, -a * d * sin / (b * c)
