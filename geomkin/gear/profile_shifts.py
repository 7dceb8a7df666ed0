"""Profile shifts chosen for a purpose."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from ..arguments import Count, between, checked, whole_between
from ..errors import DesignError
from ..plane.roulettes import inverse_involute, involute_function, roll_at
from .cutters import RackCutter

# Shifts looked at, modules. Gears outside have neither teeth nor use.
LEAST, MOST = -2.0, 3.0
Teeth = Annotated[int, whole_between(4, 10_000)]
Total = Annotated[float, between(-20, 20, "modules")]


@checked
def undercut_free_shift(teeth: Count, rack: RackCutter | None = None) -> float:
    """The least profile shift, 0 or more, modules, with which a rack does not undercut a gear of `teeth` teeth.

    The end of the rack's straight flank must meet the line of action outside the base circle: h - z sin^2(alpha) / 2
    for a flank that is straight down to h below the reference line (Colbourne, The Geometry of Involute Gears).
    """
    rack = RackCutter() if rack is None else rack
    least = rack.flank_depth - teeth / 2 * float(np.sin(rack.pressure_angle)) ** 2
    # Just beyond the limit, where rounding cannot call it undercut.
    return max(0.0, least + 1e-12 * (1 + abs(least)))


@checked
def balanced_shifts(
    first: Teeth, second: Teeth, rack: RackCutter | None = None, total: Total = 0.0
) -> tuple[float, float]:
    """Profile shifts, modules, of a pair of spur gears whose flanks slide equally at the two ends of contact.

    first, second: numbers of teeth; total: sum of the shifts; 0 keeps the centre distance of gears without.
    The largest specific sliding of each gear, at the tips of the other, becomes the same. Teeth reach the
    rack's addendum above their shifted reference lines. Derived here. Raises DesignError where tips of either gear meet
    the line of action outside the base circles whatever the shifts.
    """
    rack = RackCutter() if rack is None else rack
    slope = float(np.tan(rack.pressure_angle))
    base_1, base_2 = (z / 2 * float(np.cos(rack.pressure_angle)) for z in (first, second))
    angle = involute_function(slope) + 2 * slope * total / (first + second)
    if angle <= 0:
        raise DesignError("total", f"found {total:g}, with which the teeth cannot mesh", "give more")
    between = (base_1 + base_2) * inverse_involute(angle)

    def ends(x: float) -> tuple[float, float]:
        """Lengths of the line of action left of the ends of contact, beside each base circle; negative outside."""
        tips = (
            base * roll_at(z / 2 + rack.addendum + shift, base)
            for z, base, shift in ((first, base_1, x), (second, base_2, total - x))
        )
        reach_1, reach_2 = tips
        return between - reach_2, between - reach_1

    def excess(x: float) -> float:
        """Positive where the first gear slides more: its sliding is 1 - (z1 / z2) (between - s) / s at s."""
        one, two = ends(x)
        if one <= 0 or two <= 0:
            return float(np.sign(two - one))
        return first / second * (between - one) / one - second / first * (between - two) / two

    low, high = LEAST, MOST
    for _ in range(100):
        middle = 0.5 * (low + high)
        # More shift of the first takes its contact away from its base circle.
        low, high = (middle, high) if excess(middle) > 0 else (low, middle)
    x = 0.5 * (low + high)
    if min(ends(x)) <= 0 or not LEAST + 1e-6 < x < MOST - 1e-6:
        raise DesignError(
            "teeth",
            f"found {first} and {second}: at no profile shifts both gears keep contact outside their base circles",
            "give more teeth, a smaller addendum or a larger total",
        )
    return x, total - x
