"""Precision points: where a function is met exactly."""

from __future__ import annotations

import numpy as np

from ...arguments import Count, checked
from ...errors import DesignError
from ...plane.vec import Real


@checked
def chebyshev_points(span: tuple[float, float], count: Count = 3) -> Real:
    """Chebyshev's spacing of precision points from x0 to x1, (count,), rising.

    x = (x0 + x1)/2 - (x1 - x0)/2 cos((2 k - 1) pi/(2 count)), k = 1, 2, ...: the zeros of the polynomial of this degree
    that stays nearest to nothing over the range; an error with these zeros has nearly equal peaks (Hartenberg and
    Denavit, Kinematic Synthesis of Linkages, 1964, chapter 5). 1 to 3 with 3: 1.134, 2, 2.866.
    """
    x0, x1 = (float(x) for x in span)
    if not x0 < x1:
        raise DesignError("span", f"found {x0:g} to {x1:g}", "give a rising pair")
    if count > 100:
        raise DesignError("count", f"found {count}", "give at most 100")
    found: Real = 0.5 * (x0 + x1) - 0.5 * (x1 - x0) * np.cos((np.arange(count) + 0.5) * np.pi / count)
    return found
