"""How a walker stands on its feet: the support polygon, and the tilt of its frame over a turn."""

from __future__ import annotations

from itertools import combinations, permutations

import numpy as np

from ..plane.vec import Complex, Real, cross, dot

# Relative differences below which feet are in line or in one plane.
ROUNDING = 1e-9


def support_margin(feet: Complex, centre: complex) -> Real:
    """Distance of the centre of weight inside the support polygon, mm, shape (frames,); negative if it falls over.

    The polygon is the convex hull of the feet as seen from above. feet: shape (feet, frames); both in mm, x along the
    path and y across it.
    """
    # The hull's support function, less that of the centre, is least at right angles to an edge of the hull.
    margins = np.full(feet.shape[1], np.inf)
    for one, two in permutations(feet, 2):
        length = np.abs(two - one)
        normal = np.where(length > 0, -1j * (two - one) / np.where(length > 0, length, 1), 1.0)
        margins = np.minimum(margins, dot(feet - centre, normal).max(axis=0))
    return margins


def ground_slopes(feet: Complex, height: Real, centre: complex) -> Complex:
    """Slope of the ground under the frame along and across the path, complex, shape (frames,); nan if it falls over.

    The frame rests on three feet that have the centre of weight between them and no foot below their plane, for small
    slopes. If the centre is exactly above the line of two feet, it can tilt to either side: the steeper slope counts.
    feet and centre: as in `support_margin`; height: of the feet in the frame, mm, shape (feet, frames).
    """
    slope = np.full(feet.shape[1], np.nan, dtype=complex)
    for three in combinations(range(len(feet)), 3):
        a, b, c = feet[list(three)]
        ya, yb, yc = height[list(three)]
        area = cross(b - a, c - a)
        size = np.abs(b - a) + np.abs(c - a)
        area = np.where(np.abs(area) <= ROUNDING * size**2, np.nan, area)
        at_b, at_c = cross(centre - a, c - a) / area, cross(b - a, centre - a) / area
        is_between = np.minimum(np.minimum(at_b, at_c), 1 - at_b - at_c) >= -ROUNDING
        # The gradient of the plane through the three feet.
        gradient = 1j * ((yc - ya) * (b - a) - (yb - ya) * (c - a)) / area
        above = (height - ya - dot(gradient, feet - a)).min(axis=0)
        carries = is_between & (above >= -ROUNDING * (size + np.ptp(height, axis=0)))
        steeper = carries & ~(np.abs(gradient) <= np.abs(slope))
        slope = np.where(steeper, gradient, slope)
    return slope
