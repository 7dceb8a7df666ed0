"""How a walker stands on its feet: support polygon, tilt of its frame, and the forces between feet and ground."""

from __future__ import annotations

from itertools import combinations, permutations

import numpy as np

from ..plane.vec import Complex, Real, cross, dot

# Relative differences below which feet are in line or in one plane.
ROUNDING = 1e-9
# Gap below a foot, as a share of the size of the walker, up to which it stands, and share of the weight and of the
# largest speed that count as rounding.
STANDING, NOTHING = 1e-7, 1e-9


def support_margin(feet: Complex, centre: complex | Complex) -> Real:
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


def ground_slopes(feet: Complex, height: Real, centre: complex | Complex) -> Complex:
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
        with np.errstate(invalid="ignore"):
            gradient = 1j * ((yc - ya) * (b - a) - (yb - ya) * (c - a)) / area
        above = (height - ya - dot(gradient, feet - a)).min(axis=0)
        carries = is_between & (above >= -ROUNDING * (size + np.ptp(height, axis=0)))
        steeper = carries & ~(np.abs(gradient) <= np.abs(slope))
        slope = np.where(steeper, gradient, slope)
    return slope


def foot_shares(feet: Complex, height: Real, centre: complex | Complex, slope: Complex) -> Real:
    """Share of the weight that each foot carries, (feet, frames); nan if the walker falls over.

    Three feet carry the weight by statics. If more stand, their forces have the least sum of squares, as on equal
    springs. slope: of the ground, as returned by `ground_slopes`; feet, height and centre: as there.
    """
    apart = feet - centre
    size = np.abs(apart).max()
    gap = height - dot(slope, apart)
    with np.errstate(invalid="ignore"):
        stands = gap - gap.min(axis=0) <= STANDING * size
    # Sum of the forces, and their moments about the centre: (frames, 3, feet).
    equations = np.stack([np.ones(feet.shape), apart.real / size, apart.imag / size]).transpose(2, 0, 1)
    shares = np.zeros(feet.shape)
    for _ in range(len(feet)):
        shares = np.linalg.pinv(equations * stands.T[:, None, :])[..., 0].T
        if not (pulled := shares < -NOTHING).any():
            break
        stands &= ~pulled
    return np.where(np.isfinite(slope), np.maximum(shares, 0.0), np.nan)


def foot_slip(shares: Real, velocity: Real) -> tuple[Real, Real]:
    """Direction of the friction on each foot, from -1 to 1, (feet, frames), and the speed of the frame, (frames,).

    Feet that move at different speeds in the frame cannot all stand still on the ground. The frame then moves so that
    the frictions balance: at the opposite of the median speed of the feet, weighted by the forces that they carry. A
    foot with that speed stands still and takes the rest. velocity: of the feet in the frame along the path, mm/s.
    """
    order = np.argsort(velocity, axis=0, kind="stable")
    passed = np.cumsum(np.take_along_axis(shares, order, axis=0), axis=0)
    middle = (
        np.take_along_axis(order, np.argmax(half, axis=0)[None], axis=0)
        for half in (passed >= 0.5 - NOTHING, passed > 0.5 + NOTHING)
    )
    lower, upper = (np.take_along_axis(velocity, foot, axis=0)[0] for foot in middle)
    frame = -(lower + upper) / 2
    slip = velocity + frame
    senses = np.where(np.abs(slip) > NOTHING * np.abs(velocity).max(), np.sign(slip), 0.0)
    friction = -senses * shares
    still = np.where(senses == 0, shares, 0.0)
    held = still.sum(axis=0)
    return friction - friction.sum(axis=0) * still / np.where(held > 0, held, 1.0), frame
