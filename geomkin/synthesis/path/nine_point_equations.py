"""The equations of four-bars through nine points, over the complex numbers; which solutions are the same linkage.

A solution is a row of 16 numbers: z, Z, w, W of the first dyad, y, Y, b, B of the second, and the rotations of the
coupler at points 1 to 8 as unit directions (1 at point 0). Point 0 is the origin; z is the dyad's pin and w its ground
pivot at point 0. Capitals are the complex conjugates, treated as independent numbers. Parameters are rows of 16 too:
the displacements d from point 0 to points 1 to 8, and their conjugates D.
"""

from __future__ import annotations

import numpy as np

from ...plane.vec import Array, Complex, Mask, Real
from .double_double import ComplexDoubleDouble

# Coefficients of a solution's key, any complex numbers.
KEY = np.array([0.83 + 0.41j, -0.37 + 0.72j, 0.21 - 0.55j, 0.48 + 0.16j, -0.62 - 0.27j])
# Relative difference of the keys of cognates.
SAME = 1e-7
# Relative difference of two coordinates below which they may be equal.
EQUAL = 1e-6


def residuals(x: Complex, p: Complex) -> Complex:
    """The two dyads' equations at the eight points, (s, 2, 8), of solutions x (s, 16) for parameters p (s, 16).

    The distance from a dyad's pin to its ground pivot is the same at all points: P e + Q + R / e = 0.
    """
    z, Z, w, W, e, d, D = _named(x, p)
    values: Complex = (z * (D - W) * e + d * (D - W) - w * D + z * W + w * Z) * e + Z * (d - w)
    return values


def precise_residuals(x: Complex, x_low: Complex, p: Complex, p_low: Complex) -> Complex:
    """`residuals` of x + x_low for p + p_low, computed in double-double."""
    z, Z, w, W, e, d, D = (ComplexDoubleDouble.of(high, low) for high, low in zip(_named(x, p), _named(x_low, p_low)))
    values = (z * (D - W) * e + d * (D - W) - w * D + z * W + w * Z) * e + Z * (d - w)
    return values.parts[0]


def slopes(x: Complex, p: Complex) -> tuple[Complex, Complex, Complex, Complex]:
    """Derivatives of `residuals`: by a dyad's coordinates (s, 2, 8, 4), by e, by d and by D (s, 2, 8)."""
    z, Z, w, W, e, d, D = _named(x, p)
    out, back = D - W, d - w
    by_place = np.empty((len(x), 2, 8, 4), dtype=complex)
    by_place[..., 0] = (out * e + W) * e
    by_place[..., 1] = w * e + back
    by_place[..., 2] = (Z - D) * e - Z
    by_place[..., 3] = ((1 - e) * z - d) * e
    by_rotation = 2 * z * out * e + d * out - w * D + z * W + w * Z
    return by_place, by_rotation, out * e + Z, (z * e + back) * e


def solve(by_place: Complex, by_rotation: Complex, right: Complex) -> Complex:
    """Changes (s, 16) of solutions that change their residuals by `right` (s, 2, 8).

    Each rotation occurs in two equations only, so that it is eliminated from them: an 8 x 8 system remains.
    """
    f, g = by_rotation[:, 0], by_rotation[:, 1]
    rows = np.concatenate([g[..., None] * by_place[:, 0], -f[..., None] * by_place[:, 1]], axis=-1)
    sizes = np.sqrt(np.einsum("sjk,sjk->sj", rows.real, rows.real) + np.einsum("sjk,sjk->sj", rows.imag, rows.imag))
    values = (g * right[:, 0] - f * right[:, 1]) / sizes
    rows /= sizes[..., None]
    try:
        places = np.linalg.solve(rows, values[..., None])[..., 0]
    except np.linalg.LinAlgError:  # one of them is exactly singular; such a path is given up by its step control
        places = np.linalg.solve(rows + 1e-15 * np.eye(8), values[..., None])[..., 0]
    rest = right - (by_place @ places.reshape(-1, 2, 4, 1))[..., 0]
    rotations = np.sum(np.conj(by_rotation) * rest, axis=1) / np.sum(np.abs(by_rotation) ** 2, axis=1)
    return np.concatenate([places, rotations], axis=1)


def rotations_of(places: Complex, p: Complex) -> Complex:
    """The coupler's rotations (s, 8) of solutions of which only the places (s, 8) are known."""
    z, Z, w, W, _, d, D = _named(np.concatenate([places, np.ones_like(places)], axis=1), p)
    P, Q, R = z * (D - W), d * (D - W) - w * D + z * W + w * Z, Z * (d - w)
    rotations: Complex = (R[:, 0] * Q[:, 1] - Q[:, 0] * R[:, 1]) / (P[:, 0] * R[:, 1] - R[:, 0] * P[:, 1])
    return rotations


def cognates_of(x: Complex, p: Complex) -> tuple[Complex, Complex]:
    """The two cognates of each solution (s, 16): its first, and its second ground pivot with the third one."""
    places = x[:, :8]
    swapped = places[:, [4, 5, 6, 7, 0, 1, 2, 3]]
    rows = []
    for one in (places, swapped):
        other = np.empty_like(one)
        for k in (0, 1):
            z, w, y, b = one[:, k], one[:, 2 + k], one[:, 4 + k], one[:, 6 + k]
            share = z / (z - y)
            third = w + share * (b - w)
            other[:, k], other[:, 2 + k], other[:, 4 + k], other[:, 6 + k] = w - z, w, third + share * (y - b), third
        rows.append(np.concatenate([other, rotations_of(other, p)], axis=1))
    return rows[0], rows[1]


def keys_of(x: Complex) -> Complex:
    """A number for each solution that cognates share: a symmetric function of their three ground pivots."""
    keys = np.zeros(len(x), dtype=complex)
    with np.errstate(all="ignore"):
        z, w, y, b = (x[:, 2 * k : 2 * k + 2] for k in range(4))
        for q in (w, b, w + z / (z - y) * (b - w)):
            keys += q @ KEY[:2] + q**2 @ KEY[2:4] + KEY[4] * q[:, 0] * q[:, 1]
    return keys


def is_repeated(x: Complex) -> Mask:
    """Whether an earlier solution is the same one or a cognate of it."""
    keys = keys_of(x)
    with np.errstate(invalid="ignore"):
        same = np.abs(keys[:, None] - keys) < SAME * (1 + np.abs(keys))
    repeated: Mask = np.any(np.tril(same, -1), axis=1)
    return repeated


def may_be_degenerate(x: Complex) -> Mask:
    """Whether two coordinates that differ in every proper four-bar are nearly equal."""
    z, Z, w, W, y, Y, b, B = x[:, :8].T
    pairs = np.array([[z, w], [Z, W], [y, b], [Y, B], [z, y], [Z, Y], [w, b], [W, B]])
    apart: Real = np.abs(pairs[:, 0] - pairs[:, 1])
    near: Mask = np.any(apart < EQUAL * np.abs(pairs).sum(axis=1), axis=0)
    return near


def is_degenerate(x: Complex) -> Mask:
    """Whether a solution belongs to the family Z = W = Y = B or to its mirror, which meet all points as no linkage."""
    found = np.zeros(len(x), dtype=bool)
    for k in (0, 1):
        four = x[:, [k, 2 + k, 4 + k, 6 + k]]
        found |= np.ptp(four.real, axis=1) + np.ptp(four.imag, axis=1) < EQUAL * np.abs(four).max(axis=1)
    return found


def _named(x: Complex, p: Complex) -> tuple[Array, ...]:
    """z, Z, w, W (s, 2, 1), and e, d, D (s, 1, 8)."""
    dyads = x[:, :8].reshape(-1, 2, 4)
    z, Z, w, W = (dyads[:, :, k, None] for k in range(4))
    return z, Z, w, W, x[:, None, 8:], p[:, None, :8], p[:, None, 8:]
