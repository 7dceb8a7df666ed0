"""Random linkages within limits on transmission angle and ratio: what searches start from."""

from __future__ import annotations

import numpy as np

from ...plane.vec import Real, Whole
from .coupler_paths import ARM_X, ARM_Y, COUPLER, ROCKER
from .fits import PathTask

# Share of linkages whose crank turns fully, where it need not.
TURNING = 0.6
# Least transmission angle, rad, of random linkages: nearer to a toggle, least squares hardly get away from it.
LEAST = np.radians(5)
# Ratio of lengths within which random linkages are, at most: beyond it they hardly differ from one that slides.
WIDEST = 40.0
# Linkages whose lengths, as logarithms, and arms differ by no more are of one kind. Larger leaves kinds out, smaller
# lets one kind crowd out the others.
NEAR = 0.3


def random_linkages(task: PathTask, rng: np.random.Generator, count: int) -> Real:
    """Lengths (count, 4): ground, crank, coupler, rocker with the crank 1; of a slider-crank offset, crank, coupler, 1.

    Every four-bar whose crank turns fully is known by coupler, rocker and its two extreme transmission angles, which
    are drawn between the limits; others are drawn by their lengths. Derived here.
    """
    least, ratio = max(task.least_transmission, LEAST), min(task.largest_ratio, WIDEST)
    spread = np.log(ratio)
    turning = np.ones(count, dtype=bool) if task.closed else rng.random(count) < TURNING
    if task.slides:
        coupler = np.exp(rng.uniform(-0.3, 1, count) * spread * 0.7)
        reach = coupler * np.cos(least)
        offset = rng.uniform(-1, 1, count) * np.where(turning, np.maximum(reach - 1, 0.0), reach + 1)
        return np.stack([offset, np.ones(count), coupler, np.ones(count)], axis=1)
    b, c = np.exp(rng.uniform(-0.5, 0.5, (2, count)) * spread)
    first, second = np.sort(rng.uniform(least, np.pi - least, (2, count)), axis=0)
    near, far = (np.sqrt(b**2 + c**2 - 2 * b * c * np.cos(angle)) for angle in (first, second))
    ends = np.stack([far + near, far - near]) / 2
    ends = np.where(rng.random(count) < 0.75, ends, ends[::-1])
    made = np.stack([ends[0], ends[1], b, c], axis=1)
    drawn = np.exp(rng.uniform(-0.5, 0.5, (count, 4)) * spread)
    lengths = np.where(turning[:, None], made, drawn)
    return lengths / lengths[:, 1:2]


def unlike(x: Real, branch: Real, score: Real, count: int) -> Whole:
    """The best of each kind: many that are near each other would all come to the same linkage."""
    traits = np.concatenate(
        [
            np.log(np.abs(x[:, : ROCKER + 1]) + 1e-9),
            x[:, [ARM_X, ARM_Y]] / np.abs(x[:, COUPLER, None]),
            branch[:, None],
        ],
        axis=1,
    )
    left: Whole = np.argsort(score, kind="stable")
    chosen: list[int] = []
    left = left[np.isfinite(score[left])]
    while len(left) and len(chosen) < count:
        chosen.append(int(left[0]))
        left = left[np.abs(traits[left] - traits[left[0]]).max(axis=1) > NEAR]
    return np.array(chosen, dtype=int)
