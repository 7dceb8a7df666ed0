"""Where methods for poses fail: those that are nearly equal, or nearly parallel, whose poles are far away."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...linkage.moving import move
from ...linkage.named_linkages import FourBar
from ...synthesis.guidance.dyads import dyads_through
from ...synthesis.guidance.poses import circle_of_sliders, poles
from ..cell import Cell, Sizes
from .linkages import cross

PIN = 5 + 2j
# A four-bar whose coupler takes the poses, and its drives but the second.
GUIDE = FourBar(100.0, 30.0, 90.0, 70.0)
DRIVES = (0.4, 1.3, 2.1, 3.0)


def _poses(sizes: Sizes) -> list[tuple[complex, float]]:
    return [(complex(x, y), angle) for x, y, angle in zip(sizes[::3], sizes[1::3], sizes[2::3])]


def _placed(ctx: Any, sizes: Any) -> tuple[list[Any], list[Any]]:
    """Origins and directions."""
    return [ctx.mpc(x, y) for x, y in zip(sizes[::3], sizes[1::3])], [ctx.expj(angle) for angle in sizes[2::3]]


def _pole(ctx: Any, *sizes: Any) -> Any:
    (one, two), half = _placed(ctx, sizes)[0], (sizes[5] - sizes[2]) / 2
    return (one + two) / 2 + ctx.mpc(0, 1) * (two - one) / 2 * ctx.cos(half) / ctx.sin(half)


def _pivot(ctx: Any, *sizes: Any) -> Any:
    """Centre of the circle through a pin's three positions."""
    first, *others = (z + u * ctx.mpc(PIN.real, PIN.imag) for z, u in zip(*_placed(ctx, sizes)))
    a, b = (z - first for z in others)
    return first + ctx.mpc(0, 1) * (a * abs(b) ** 2 - b * abs(a) ** 2) / (2 * cross(a, b))


def _slider_centre(ctx: Any, *sizes: Any) -> Any:
    """Centre of the circle of pins whose three positions are collinear."""
    places, directions = _placed(ctx, sizes)
    a, b = (z - places[0] for z in places[1:])
    c, d = (u / directions[0] - 1 for u in directions[1:])
    return places[0] - ctx.mpc(0, 1) * (a * d.conjugate() - b * c.conjugate()) / (2 * cross(c, d))


def _guided(distance: float) -> Sizes:
    """Five poses of a four-bar's coupler, the second at this distance from the first."""
    coupler = move(GUIDE, np.array([DRIVES[0], DRIVES[0] + distance, *DRIVES[1:]])).coupler
    place, angle = coupler.origin.position, np.angle(coupler.direction)
    return tuple(float(v) for row in zip(place.real, place.imag, angle) for v in row)


def _pivot_near_known(ctx: Any, *sizes: Any) -> Any:
    """The pivot of the crank, by Newton's method from its known position."""
    places, directions = _placed(ctx, sizes)
    fixed, pin = ctx.mpc(0), ctx.mpc(0)
    for _ in range(9 if ctx.__class__.__name__ == "MPContext" else 6):
        arms = [z + u * pin - fixed for z, u in zip(places, directions)]
        # Squares of arms are equal: real unknowns are the displacements of the pivot and of the pin.
        rows, right = ctx.matrix(4, 4), ctx.matrix(4, 1)
        for k in range(4):
            parts = [(-(arms[j]), arms[j] * directions[j].conjugate()) for j in (k + 1, 0)]
            for column, (one, other) in enumerate(zip(*parts)):
                rows[k, 2 * column], rows[k, 2 * column + 1] = one.real - other.real, one.imag - other.imag
            right[k] = (abs(arms[0]) ** 2 - abs(arms[k + 1]) ** 2) / 2
        step = ctx.lu_solve(rows, right)
        fixed, pin = fixed + ctx.mpc(step[0], step[1]), pin + ctx.mpc(step[2], step[3])
    return GUIDE.crank + fixed


def _found(*sizes: float) -> Any:
    fixed = dyads_through(_poses(sizes)).fixed
    # With more, two poses count as one, and a whole curve of dyads goes through the rest.
    return GUIDE.crank + fixed[np.abs(fixed).argmin()] if len(fixed) <= 4 else np.nan


def _turned(x: float) -> Sizes:
    return 3.0, 4.0, 0.7, 13.0, -2.0, 0.7 + x


CELLS = (
    Cell("poles", "poles to infinity", "position", "angle between two poses, rad", _turned, _pole,
         lambda *sizes: poles(_poses(sizes))[0, 1].position, "all, nan", "`weight`, 0 if the pole is at infinity"),
    Cell("circle of sliders", "poles to infinity", "centre", "angle between two poses, rad",
         lambda x: (*_turned(x), -5.0, 10.0, 1.9), _slider_centre,
         lambda *sizes: circle_of_sliders(_poses(sizes)).centre, "all, nan",
         "`curvature`, 0 if the circle is a line"),
    Cell("dyad of a pin and three poses", "equal poses", "fixed pivot", "difference of two poses",
         lambda x: (3.0, 4.0, 0.7, 3 + 7 * x, 4 + 2 * x, 0.7 + 0.3 * x, -5.0, 10.0, 1.9), _pivot,
         lambda *sizes: dyads_through(_poses(sizes), moving=PIN).fixed, "sizes, refused",
         "the distance of the poses, which are refused from 1e-12 on"),
    Cell("dyads of five poses", "equal poses", "fixed pivot of a known crank", "drive between two poses, rad", _guided,
         _pivot_near_known, _found, "sizes, refused",
         "the distance of the poses; from 1e-10 on, dyads through four poses, each with its `residual`"),
)  # fmt: skip
