"""A cam's outline at equal angles, as a dividing head or an inspector wants it."""

from __future__ import annotations

import numpy as np

from ..arguments import Reals, checked
from ..plane.curve import AbstractCurve
from ..plane.vec import Array

# Points looked at in each smooth piece of the outline: fewer may miss that it passes a direction three times.
LOOKS = 129
# Newton's steps from a bracket a hundredth of a piece wide: five reach the last digit, one is spare.
STEPS = 6


@checked
def polar_radius(outline: AbstractCurve, angle: Reals) -> Array:
    """Distance from the origin to a closed outline about it, mm, in the directions of `angle`, rad; any shape.

    Where the outline passes a direction more than once, the farthest point counts: what a probe from outside meets.
    """
    directions = np.exp(1j * np.asarray(angle, dtype=float).ravel())
    breaks = outline.breaks
    t = np.concatenate([np.linspace(a, b, LOOKS)[:-1] for a, b in zip(breaks[:-1], breaks[1:])] + [breaks[-1:]])
    z = outline.point(t)
    seen = z * np.conj(directions)[:, None]
    ahead = (seen[:, :-1].real > 0) | (seen[:, 1:].real > 0)
    passing = ahead & (seen[:, :-1].imag * seen[:, 1:].imag <= 0)
    far = np.where(passing, np.maximum(np.abs(z[:-1]), np.abs(z[1:])), -1.0)
    k = np.argmax(far, axis=1)
    low, high = t[k], t[k + 1]
    place = 0.5 * (low + high)
    for _ in range(STEPS):
        here = outline.point(place) * np.conj(directions)
        slope = np.imag(outline.velocity(place) * np.conj(directions))
        with np.errstate(divide="ignore", invalid="ignore"):
            step = np.where(slope == 0, 0.0, here.imag / slope)
        place = np.clip(place - step, low, high)
    return np.abs(outline.point(place)).reshape(np.shape(angle))
