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
    directions = unit(np.concatenate([across, *normals, *(-n for n in normals)], axis=-1))[..., None]
    strip = dot(directions, b[..., None, :]).min(axis=-1) - dot(directions, a[..., None, :]).max(axis=-1)
    # Points that fall together have no direction between them.
    widest: Real = np.where(np.isfinite(strip), strip, -np.inf).max(axis=-1)
    return widest


def _pairs(z: Complex) -> Complex:
    """Differences of all pairs of points."""
    one, two = np.triu_indices(z.shape[-1], 1)
    return z[..., two] - z[..., one]
