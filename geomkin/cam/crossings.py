"""Where a closed curve crosses itself, to rounding."""

from __future__ import annotations

import numpy as np

from ..plane.curve import AbstractCurve
from ..plane.vec import Array, cross

# Newton's steps before a crossing of chords is taken for no crossing of the curve.
STEPS = 60


def crossings(curve: AbstractCurve, grid: Array) -> list[tuple[float, float]]:
    """Parameters (earlier, later) at which a closed curve is in the same place.

    grid: rising parameters whose chords already cross where the curve does. What does not cross in them is
    not found.
    """
    z = curve.point(grid)
    span, end = grid[-1] - grid[0], float(curve.breaks[-1])
    size = float(np.abs(z).max())
    found: list[tuple[float, float]] = []
    for i, j, s, t in zip(*(a.tolist() for a in chord_crossings(z))):
        following = np.append(grid, end)
        start = (grid[i] + s * (following[i + 1] - grid[i]), grid[j] + t * (following[j + 1] - grid[j]))
        limits = [(following[max(k - 1, 0)], following[min(k + 2, len(grid))]) for k in (i, j)]
        pair = _newton(curve, start, limits, size)
        if pair and all(max(abs(pair[0] - a), abs(pair[1] - b)) > 1e-12 * span for a, b in found):
            found.append(pair)
    return found


def _newton(
    curve: AbstractCurve, start: tuple[float, float], limits: list[tuple[float, float]], size: float
) -> tuple[float, float] | None:
    """The pair of parameters near `start` and within `limits` whose points agree, or None."""
    low, high = np.array(limits).T
    t = best = np.array(start)
    least = np.inf
    for _ in range(STEPS):
        apart = np.subtract(*curve.point(t))
        if abs(apart) < least:
            least, best = abs(apart), t
        v, w = curve.velocity(t)
        turned = cross(v, w)
        if turned == 0 or least == 0:
            break
        step = np.array([cross(apart, w), cross(apart, v)]) / -turned
        t = np.clip(t + step, low, high)
    return (float(best[0]), float(best[1])) if least < 1e-12 * size else None


def chord_crossings(z: Array) -> tuple[Array, Array, Array, Array]:
    """Crossings of a closed polygon's chords: numbers i < j of the chords, and the share along each."""
    # Turned, so that no chord of a drawn shape is likely to stand upright, among many at the same place.
    a = z * np.exp(0.7j)
    chord = np.roll(a, -1) - a
    low = np.minimum(a.real, (a + chord).real)
    order = np.argsort(low, kind="stable")
    ends = np.searchsorted(low[order], np.maximum(a.real, (a + chord).real)[order], side="right")
    counts = ends - np.arange(1, len(a) + 1)
    first = np.repeat(np.arange(len(a)), counts)
    later = np.arange(len(first)) - np.repeat(np.cumsum(counts) - counts, counts) + first + 1
    i, j = np.sort([order[first], order[later]], axis=0)
    apart = (j - i > 1) & (j - i < len(a) - 1)
    i, j = i[apart], j[apart]
    gap, turned = a[j] - a[i], cross(chord[i], chord[j])
    with np.errstate(divide="ignore", invalid="ignore"):
        s, t = cross(gap, chord[j]) / turned, cross(gap, chord[i]) / turned
        hit = (s >= 0) & (s < 1) & (t >= 0) & (t < 1)
    return i[hit], j[hit], s[hit], t[hit]
