"""How far convex hulls of points are apart."""

from __future__ import annotations

import numpy as np

from .vec import Complex, Real, dot, unit


def separation(a: Complex, b: Complex) -> Real:
    """Distance, mm, (...,), between the convex hulls of points a (..., n) and b (..., m); 0 or less where they meet.

    Two convex shapes are as far apart as the widest strip between them. Its sides stand square to the line
    between two corners, or lie along an edge, so that trying all pairs of points is exact.
    """
    across = (b[..., None, :] - a[..., :, None]).reshape(*a.shape[:-1], -1)
    normals = [1j * _pairs(a), 1j * _pairs(b)]
    directions = unit(np.concatenate([across, *normals, *(-n for n in normals)], axis=-1))
    upper, lower = np.full(directions.shape, np.inf), np.full(directions.shape, -np.inf)
    for k in range(b.shape[-1]):
        upper = np.minimum(upper, dot(directions, b[..., k, None]))
    for k in range(a.shape[-1]):
        lower = np.maximum(lower, dot(directions, a[..., k, None]))
    strip = upper - lower
    # Points that fall together have no direction between them.
    widest: Real = np.where(np.isfinite(strip), strip, -np.inf).max(axis=-1)
    return widest


def _pairs(z: Complex) -> Complex:
    """Differences of all pairs of points."""
    one, two = np.triu_indices(z.shape[-1], 1)
    return z[..., two] - z[..., one]
