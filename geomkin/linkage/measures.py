"""What designers judge a linkage by."""

from __future__ import annotations

import numpy as np

from ..plane.vec import Array
from .four_bar import FourBar


def transmission_angle(coupler: Array, rocker: Array) -> Array:
    """Acute angle between coupler and rocker at their pin, rad, from their directions.

    Below about 40 deg the coupler pushes the rocker along itself rather than turning it.
    """
    between = rocker * np.conj(coupler)
    return np.arctan2(np.abs(between.imag), np.abs(between.real))


def grashof_type(linkage: FourBar) -> str:
    """Which links turn fully: by the shortest link if shortest + longest is no more than the other two.

    crank-rocker, double-crank, rocker-crank, double-rocker (the coupler turns), change-point (the sums
    are equal, to rounding), triple-rocker.
    """
    lengths = {name: getattr(linkage, name) for name in ("ground", "crank", "coupler", "rocker")}
    by_length = sorted(lengths, key=lengths.__getitem__)
    spare = lengths[by_length[1]] + lengths[by_length[2]] - lengths[by_length[0]] - lengths[by_length[3]]
    if abs(spare) <= 1e-12 * lengths[by_length[3]]:
        return "change-point"
    if spare < 0:
        return "triple-rocker"
    return {
        "crank": "crank-rocker",
        "ground": "double-crank",
        "rocker": "rocker-crank",
        "coupler": "double-rocker",
    }[by_length[0]]
