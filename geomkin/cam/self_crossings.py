"""Where a closed curve crosses itself: roughly, by its chords, and then to rounding."""

from __future__ import annotations

import numpy as np

from ..plane.curve import AbstractCurve
from ..plane.vec import Complex, Real, Whole, cross

# Newton's steps before a crossing of chords is taken for no crossing of the curve. Where branches cross at an angle
# six are enough; where they touch each step only halves the gap, and fewer would lose that crossing.
STEPS = 60
# Pairs of chords looked at in one go: more takes more memory; fewer than a thousand take longer.
BLOCK = 1_000_000


def crossings(curve: AbstractCurve, start: Real, low: Real, high: Real) -> Real:
    """Parameters (n, 2) at which a closed curve is in the same place, near `start` (n, 2), between `low` and `high`.

    nan where there are none: where chords cross, the curve itself may pass by.
    """
    first, last = curve.breaks[[0, -1]].tolist()
    size = float(np.abs(curve.point(np.linspace(first, last, 65))).max())
    best, least = np.array(start, dtype=float), np.full(len(start), np.inf)
    live, t = np.arange(len(start)), best
    for _ in range(STEPS):
        apart, v = np.subtract(*curve.point(t).T), curve.velocity(t)
        nearer = np.abs(apart) < least[live]
        least[live[nearer]], best[live[nearer]] = np.abs(apart[nearer]), t[nearer]
        turned = cross(v[:, 0], v[:, 1])
        # At its limit Newton's step is rounding, and brings nothing nearer.
        going = (turned != 0) & (nearer | (least[live] > 1e-12 * size))
        live, t, apart, v, turned = live[going], t[going], apart[going], v[going], turned[going]
        if not len(live):
            break
        step = np.stack([cross(apart, v[:, 1]), cross(apart, v[:, 0])], axis=1) / -turned[:, None]
        t = np.clip(t + step, low[live], high[live])
    # Two parameters that have become one are no crossing.
    best[(least >= 1e-12 * size) | (np.abs(best[:, 0] - best[:, 1]) <= 1e-12 * (last - first))] = np.nan
    return best


def chord_crossings(z: Complex, reach: float = np.inf) -> tuple[Whole, Whole, Real, Real]:
    """Crossings of a closed polygon's chords: numbers i < j of the chords, and the share along each.

    Of chords that come nearer to the origin than `reach`; others may be left out.
    """
    # Turned by an odd angle: drawn shapes may have many upright chords at the same x, whose boxes would all meet.
    a = z * np.exp(0.7j)
    b = np.roll(a, -1)
    near = np.flatnonzero(np.minimum(np.abs(a), np.abs(b)) - np.abs(b - a) / 2 < reach)
    i, j = (near[k] for k in _boxes_that_meet(a[near], b[near]))
    i, j = np.minimum(i, j), np.maximum(i, j)
    apart = (j - i > 1) & (j - i < len(a) - 1)
    i, j = i[apart], j[apart]
    gap, one, other = a[j] - a[i], b[i] - a[i], b[j] - a[j]
    turned = cross(one, other)
    with np.errstate(divide="ignore", invalid="ignore"):
        s, t = cross(gap, other) / turned, cross(gap, one) / turned
        hit = (s >= 0) & (s < 1) & (t >= 0) & (t < 1)
    order = np.lexsort([j[hit], i[hit]])
    return i[hit][order], j[hit][order], s[hit][order], t[hit][order]


def _boxes_that_meet(a: Complex, b: Complex) -> tuple[Whole, Whole]:
    """Pairs of chords a to b whose upright boxes meet, once each.

    The chords are sorted along x within bands of y no higher than they are themselves, so that nearly all that
    are next to each other there do meet.
    """
    if not len(a):
        return np.zeros(0, int), np.zeros(0, int)
    left, right = np.minimum(a.real, b.real), np.maximum(a.real, b.real)
    low, high = np.minimum(a.imag, b.imag), np.maximum(a.imag, b.imag)
    # On average a chord lies in two bands; in a shape without height all lie in one.
    height = max(float((high - low).mean()), float(high.max() - low.min()) / len(a)) or 1.0
    first, last = (np.floor((y - low.min()) / height).astype(int) for y in (low, high))
    chord = np.repeat(np.arange(len(a)), last - first + 1)
    band = np.arange(len(chord)) - np.repeat(np.cumsum(last - first + 1) - (last - first + 1) - first, last - first + 1)
    order = np.lexsort([left[chord], band])
    chord, band = chord[order], band[order]
    # One rising number for band and place: bands lie farther apart than the shape is wide.
    width = 2 * float(right.max() - left.min()) or 1.0
    start, end = (band * width + (x[chord] - left.min()) for x in (left, right))
    ends = np.searchsorted(start, end + 1e-12 * (1 + band) * width, side="right")
    counts = np.maximum(ends - np.arange(1, len(chord) + 1), 0)
    total = np.cumsum(counts)
    found = []
    for since in range(0, int(total[-1]), BLOCK):
        k = np.arange(since, min(since + BLOCK, int(total[-1])))
        one = np.searchsorted(total, k, side="right")
        other = one + 1 + k - (total[one] - counts[one])
        i, j = chord[one], chord[other]
        # Two chords that share several bands are counted in the lowest of them.
        meet = (low[i] <= high[j]) & (low[j] <= high[i]) & (band[one] == np.maximum(first[i], first[j]))
        found.append(np.stack([i[meet], j[meet]]))
    i, j = np.concatenate([np.zeros((2, 0), int), *found], axis=1)
    return i, j
