"""Whether the tips of a pinion and of the ring around it keep clear of each other."""

from __future__ import annotations

import numpy as np

from .involute import involute_function, roll_at


def trochoid_gap(
    pinion_teeth: float,
    ring_teeth: float,
    distance: float,
    pinion_tip: float,
    ring_tip: float,
    pinion_base: float,
    ring_base: float,
) -> float:
    """Angle, rad on the pinion, by which its tip passes clear of the ring's tip on its way out of the space.

    Negative where they hit: trochoid interference. All lengths in one unit; infinite where the tip circles do
    not cross. Where the pinion's tip corner stands on the ring's tip circle, the triangle of the two centres
    and the corner gives how far each gear has turned since the two corners' flanks touched at the pitch point.
    """
    # The angles at the two centres, of the corner from the line of centres.
    cosine = (ring_tip**2 - pinion_tip**2 - distance**2) / (2 * distance * pinion_tip)
    if abs(cosine) >= 1:
        return float("inf")
    at_pinion = np.arccos(cosine)
    at_ring = np.arccos((distance**2 + ring_tip**2 - pinion_tip**2) / (2 * distance * ring_tip))
    working = float(np.sqrt(max((distance / (ring_base - pinion_base)) ** 2 - 1, 0.0)))
    pinion = at_pinion + involute_function(roll_at(pinion_tip, pinion_base)) - involute_function(working)
    ring = at_ring + involute_function(roll_at(ring_tip, ring_base)) - involute_function(working)
    return float(pinion - ring * ring_teeth / pinion_teeth)


def trimming_gap(
    pinion_teeth: float,
    ring_teeth: float,
    distance: float,
    pinion_tip: float,
    ring_tip: float,
    pinion_base: float,
    ring_base: float,
) -> float:
    """Angle, rad on the pinion, by which its tips clear the ring's when it is moved in along a radius.

    Negative where they hit, so that the pinion can only be put in along its axis: trimming interference.
    """
    tip = pinion_base / pinion_tip / (ring_base / ring_tip)
    ratio = pinion_teeth / ring_teeth
    if tip >= 1 or ratio >= 1:
        return float("inf")
    first = np.sqrt((1 - tip**2) / (1 - ratio**2))
    second = np.sqrt((tip**-2 - 1) / (ratio**-2 - 1))
    if first > 1 or second > 1:
        return float("inf")
    working = float(np.sqrt(max((distance / (ring_base - pinion_base)) ** 2 - 1, 0.0)))
    pinion = np.arcsin(first) + involute_function(roll_at(pinion_tip, pinion_base)) - involute_function(working)
    ring = np.arcsin(second) + involute_function(roll_at(ring_tip, ring_base)) - involute_function(working)
    return float(pinion - ring * ring_teeth / pinion_teeth)
