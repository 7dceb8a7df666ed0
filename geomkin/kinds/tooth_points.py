"""Counts the points that the teeth of a recipe's gears will be drawn by, before anything is drawn."""

from __future__ import annotations

from collections.abc import Callable

from ..errors import DesignError
from ..plane.curve import AbstractCurve
from ..plane.flatten import flatten
from ..plane.joined import Ring
from ..recipe.settings import Files
from ..sizes import WIDEST

# Points of all teeth together. More take over five seconds, or a gigabyte, to write and to fill with triangles.
MOST = 200_000
# What a point round a hole takes beside one of an outline: triangles between a ring's teeth and its rim are slower.
IN_A_RING = 2
# Step from one tolerance to the next that is looked at, and how many: to a thousand times the one given.
WIDER, LOOKS = 1.25, 31


def check_tooth_points(files: Files, gears: list[AbstractCurve], rings: list[AbstractCurve] | None = None) -> None:
    """Raise DesignError where outlines of gears, and holes of rings, take more points than can be drawn in time."""
    if not files.wants_parts:
        return
    weights = [(curve, 1) for curve in gears] + [(curve, IN_A_RING) for curve in rings or []]
    # What is larger than any sheet is refused for that.
    toothed = [(c, weight) for c, weight in weights if isinstance(c, Ring) and abs(c.point(0.0)) < WIDEST / 2]

    def points(tolerance: float) -> int:
        # Each pitch ends where the next begins.
        return sum(weight * curve.count * (len(flatten(curve.piece, tolerance)) - 1) for curve, weight in toothed)

    if (count := points(files.tolerance)) > MOST:
        teeth = sum(curve.count for curve, _ in toothed)
        raise DesignError(
            "tolerance",
            f"found {files.tolerance:g} mm, with which {teeth:,} teeth take the work of {count:,} points; "
            f"{MOST:,} can be drawn",
            # Gears of fewer teeth have more bend to each.
            _remedy(files.tolerance, points, teeth * MOST // count * 9 // 10),
        )


def _remedy(tolerance: float, points: Callable[[float], int], teeth: int) -> str:
    """The least tolerance, of some, with which so many teeth can be drawn, and the teeth that can be with this one."""
    for k in range(1, LOOKS + 1):
        wider = float(f"{tolerance * WIDER**k:.3g}")
        if points(wider) <= MOST:
            return f"give at least {wider:g} mm, or at most {teeth:,} teeth"
    return f"give at most {teeth:,} teeth"
