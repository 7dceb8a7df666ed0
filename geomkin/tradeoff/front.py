"""The Pareto front: what nothing else beats in both speed and accuracy."""

from __future__ import annotations

import numpy as np

from ..arguments import Extended, checked
from ..errors import DesignError
from ..plane.vec import Mask


@checked
def pareto_front(seconds: Extended, errors: Extended) -> Mask:
    """Which of these points (n,) no other one beats: as fast and as accurate, and better in one of the two.

    Equal points stand on the front together; a point that is nan or infinite in either is never on it.
    """
    cost, miss = np.asarray(seconds, dtype=float), np.asarray(errors, dtype=float)
    if cost.ndim != 1 or cost.shape != miss.shape:
        raise DesignError("errors", f"found shapes {cost.shape} and {miss.shape}", "give two rows of one length")
    front = np.zeros(cost.shape, dtype=bool)
    known = np.flatnonzero(np.isfinite(cost) & np.isfinite(miss))
    least = np.inf
    # From the fastest on, a point is on the front where it errs less than all that are as fast.
    for time in np.unique(cost[known]):
        here = known[cost[known] == time]
        best = miss[here].min()
        if best < least:
            front[here[miss[here] == best]] = True
            least = best
    return front
