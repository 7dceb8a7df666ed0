"""Bounds of a path search: which there are, and what they come to in the units of the search."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...errors import DesignError, shown
from ...plane.vec import Real
from .coupler_paths import CRANK, GROUND, ORIGIN_X, ROCKER, START, TURN

# What may be bounded, in the order of `coupler_paths.NAMES`: lengths and places in mm, angles in deg.
FOUR_BAR = (
    "ground",
    "crank",
    "coupler",
    "rocker",
    "coupler_point_x",
    "coupler_point_y",
    "origin_x",
    "origin_y",
    "ground_angle_deg",
    "start_deg",
)
# A slider-crank's offset takes the place of the ground, and it has no rocker.
SLIDER = ("offset", *FOUR_BAR[1:])
# Lengths, in units of the points' size: no link is shorter, none nor any place farther. A wider range takes a linkage
# at infinity, or one without a link, for an answer.
SHORTEST, LONGEST = 1e-6, 1e4
# Turns to either side that an angle without bounds may come to on the way.
FREE = 1e3


def bounds_of(
    bounds: Mapping[str, tuple[float, float]] | None, slides: bool, timed: bool, middle: complex, size: float
) -> tuple[Real, Real]:
    """Bounds low, high (10,) about `middle` in units of `size`; DesignError for what cannot be bounded, or is no range.

    Without times the crank has no start that could be bounded.
    """
    names = SLIDER if slides else FOUR_BAR
    allowed = [name for k, name in enumerate(names) if not (slides and k == ROCKER) and (timed or k != START)]
    low, high = np.full(10, -LONGEST), np.full(10, LONGEST)
    low[GROUND : ROCKER + 1] = SHORTEST
    low[[TURN, START]], high[[TURN, START]] = -FREE, FREE
    if slides:
        low[GROUND] = -LONGEST
        # It has no rocker: any length will do.
        low[ROCKER] = high[ROCKER] = 1.0
    for name, pair in (bounds or {}).items():
        if name not in allowed:
            untimed = "; start_deg needs drive_deg" if name == "start_deg" and not timed else ""
            raise DesignError("bounds", f"found {shown(name)}", f"give any of {', '.join(allowed)}{untimed}")
        least, most = float(pair[0]), float(pair[1])
        if not least <= most:
            raise DesignError("bounds", f"{name} from {least:g} to {most:g} is no range", "give the lower one first")
        k = names.index(name)
        is_length = CRANK <= k <= ROCKER or (k == GROUND and not slides)
        if is_length and most <= 0:
            raise DesignError("bounds", f"{name} is at most {most:g} mm", "give a length above 0")
        if name.endswith("_deg"):
            least, most = np.radians(least), np.radians(most)
        elif name.startswith("origin"):
            shift = middle.real if k == ORIGIN_X else middle.imag
            least, most = (least - shift) / size, (most - shift) / size
        else:
            least, most = least / size, most / size
        low[k], high[k] = max(low[k], least), min(high[k], most)
        if low[k] > high[k]:
            raise DesignError(
                "bounds",
                f"{name} is far from all {size:.3g} mm that the points are wide",
                "give bounds nearer to their size",
            )
    return low, high


def bound_all_links(bounds: Mapping[str, tuple[float, float]] | None, slides: bool) -> bool:
    """Whether each link has a greatest length: then no search runs to infinite ones."""
    links = ("crank", "coupler") if slides else FOUR_BAR[:4]
    return bounds is not None and all(link in bounds for link in links)
