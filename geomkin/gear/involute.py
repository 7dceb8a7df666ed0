"""The involute function, its inverse, and the rounding that fits between an involute and a tip circle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..sizes import last_fit

# Roll angle below which the involute function is told by its series: its two terms are nearly equal there. Larger, and
# the series' terms run out before the digits do; smaller, and their difference has lost two of them.
NEAR_BASE, TERMS = 0.25, 14


def involute_function(roll: float) -> float:
    """inv(alpha) = tan(alpha) - alpha with roll = tan(alpha): the involute's polar angle at a roll (ISO 21771)."""
    if abs(roll) > NEAR_BASE:
        return float(roll - np.arctan(roll))
    return float(sum((-1) ** k * roll ** (2 * k + 3) / (2 * k + 3) for k in reversed(range(TERMS))))


def inverse_involute(angle: float) -> float:
    """Roll angle, the tangent of the pressure angle, whose involute function is `angle` >= 0; rad."""
    # The function is convex: from a start above the root, Newton's steps only fall towards it.
    t = float(np.cbrt(3 * angle)) + angle
    for _ in range(60):
        step = (involute_function(t) - angle) * (1 + t**2) / t**2 if t > 0 else 0.0
        t = float(t - step)
        if abs(step) <= 1e-16 * t:
            break
    return t


def roll_at(radius: float, base_radius: float) -> float:
    """Roll angle of the involute where it reaches a radius; 0 inside the base circle."""
    ratio = radius / base_radius
    return float(np.sqrt(max((ratio - 1) * (ratio + 1), 0.0)))


@dataclass(frozen=True)
class TipRounding:
    """The arc that rounds a tooth's tip.

    radius: distance of its centre from the gear's axis, mm; angle: of the centre from the tooth's middle, rad;
    roll: angle of the flank's involute where the rounding begins.
    """

    radius: float
    angle: float
    roll: float


def tip_rounding(base_radius: float, half_angle_at_base: float, tip_radius: float, rounding: float) -> TipRounding:
    """The arc of radius `rounding`, mm, that touches the flank and the tip circle from inside the tooth.

    Its centre lies on the parallel curve of the flank, which is the same involute turned by
    rounding / base_radius. The angle is negative where the two roundings of a tooth would overlap.
    Asks for rounding <= tip_radius - base_radius.
    """
    radius = tip_radius - rounding
    roll = roll_at(radius, base_radius)
    angle = half_angle_at_base - involute_function(roll) - rounding / base_radius
    return TipRounding(radius, angle, roll + rounding / base_radius)


def largest_rounding(base_radius: float, half_angle_at_base: float, tip_radius: float) -> float:
    """The largest rounding, mm, of a tooth's tip: where its two roundings, or its base circle, meet."""

    def fits(rounding: float) -> bool:
        return tip_rounding(base_radius, half_angle_at_base, tip_radius, rounding).angle >= 0

    high = tip_radius - base_radius
    return high if fits(high) else last_fit(fits, 0.0, high)
