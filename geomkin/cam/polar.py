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
# rad; larger takes neighbours for chords that pass, smaller lets a direction slip between two.
ROUNDING = 1e-14


@checked
def polar_radius(outline: AbstractCurve, angle: Reals) -> Array:
    """Distance from the origin to a closed outline about it, mm, in the directions of `angle`, rad; any shape.

    Where the outline passes a direction more than once, the farthest point counts: what a probe from outside meets.
    """
    directions = np.exp(1j * np.asarray(angle, dtype=float).ravel())
    breaks = outline.breaks
    t = np.concatenate([np.linspace(a, b, LOOKS)[:-1] for a, b in zip(breaks[:-1], breaks[1:])] + [breaks[-1:]])
    k = _farthest(outline.point(t), directions)
    low, high = t[k], t[k + 1]
    place = 0.5 * (low + high)
    for _ in range(STEPS):
        here = outline.point(place) * np.conj(directions)
        slope = np.imag(outline.velocity(place) * np.conj(directions))
        with np.errstate(divide="ignore", invalid="ignore"):
            step = np.where(slope == 0, 0.0, here.imag / slope)
        place = np.clip(place - step, low, high)
    return np.abs(outline.point(place)).reshape(np.shape(angle))


def _farthest(z: Array, directions: Array) -> Array:
    """Of the chords of a polygon z (n + 1,) that pass directions (m,), the number of the farthest for each, (m,)."""
    order = np.argsort(np.angle(directions))
    rising = np.angle(directions)[order]
    # A chord lies within half a turn of its start, which lies within the middle one of three turns.
    turns = np.concatenate([rising - 2 * np.pi, rising, rising + 2 * np.pi])
    start = np.angle(z[:-1])
    end = start + np.angle(z[1:] / z[:-1])
    # A direction through a corner may pass both chords there by rounding.
    first = np.searchsorted(turns, np.minimum(start, end) - ROUNDING, side="left")
    counts = np.searchsorted(turns, np.maximum(start, end) + ROUNDING, side="right") - first
    chord = np.repeat(np.arange(len(start)), counts)
    passed = np.arange(len(chord)) - np.repeat(np.cumsum(counts) - counts - first, counts)
    passed = order[passed % len(order)]
    far = np.maximum(np.abs(z[:-1]), np.abs(z[1:]))[chord]
    # The last that is written stays: the farthest, and of equals the first along the outline.
    last = np.lexsort([-chord, far])
    found = np.zeros(len(directions), int)
    found[passed[last]] = chord[last]
    return found
