"""Where methods for gears fail: undercut that just begins, few teeth, pointed tips, pressure angles at their limits."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from ...gear.cutters import RackCutter
from ...gear.pair import GearPair
from ...gear.spur import SpurGear
from ..cell import Cell, Sizes

TEETH, MODULE = 12.0, 2.0
# A rack that fits teeth of every pressure angle.
LOW = {"addendum": 0.4, "dedendum": 0.6, "tip_radius": 0.0}


def _involute(ctx: Any, roll: Any) -> Any:
    return roll - ctx.atan(roll)


def _form_radius(ctx: Any, teeth: Any, module: Any, shift: Any) -> Any:
    """Radius at which the path of the rack's rounded corner crosses the involute, by halving of an interval."""
    slope, depth, rounding = ctx.pi / 9, ctx.mpf(1.25) - ctx.mpf(0.38) - shift, ctx.mpf(0.38)
    pitch = teeth / 2
    base = pitch * ctx.cos(slope)
    side = ctx.pi / 4 - (depth + shift) * ctx.tan(slope) - rounding / ctx.cos(slope)
    half = (ctx.pi / 2 + 2 * shift * ctx.tan(slope)) / teeth + _involute(ctx, ctx.tan(slope))
    # From the middle of the space to the start of the involute.
    ahead = half - ctx.pi / teeth + side / pitch

    def corner(incline: Any) -> Any:
        along = depth * ctx.tan(incline)
        return (ctx.mpc(pitch - depth, -along) - rounding * ctx.expj(incline)) * ctx.expj(along / pitch + ahead)

    def outside(incline: Any) -> Any:
        return abs(corner(incline)) - base

    def inside(incline: Any) -> Any:
        z = corner(incline)
        square = (abs(z) / base) ** 2 - 1
        return ctx.atan2(z.imag, z.real) - _involute(ctx, ctx.sqrt(max(square, ctx.mpf(0))))

    end = slope - ctx.pi / 2
    foot = _between(outside, ctx.mpf(0), end)
    return module * abs(corner(_between(inside, foot, end)))


def _between(f: Callable[[Any], Any], low: Any, high: Any) -> Any:
    """Zero of f: false position that halves a stale end."""
    at_low, at_high = f(low), f(high)
    for _ in range(200):
        if at_low == at_high or abs(high - low) < abs(high) * 1e-70:
            break
        middle = high - at_high * (high - low) / (at_high - at_low)
        here = f(middle)
        if (here > 0) != (at_high > 0):
            low, at_low = high, at_high
        else:
            at_low /= 2
        high, at_high = middle, here
    return high


def _formed(teeth: float, module: float, shift: float) -> float:
    return SpurGear(int(teeth), module, shift, on_pointed_tip="cut").form_radius


def _tip(ctx: Any, degrees: Any, shift: Any, teeth: int = 40, addendum: float = 0.4) -> Any:
    """Thickness of a tooth of module 2 along the tip circle."""
    slope = degrees * ctx.pi / 180
    base, tip = teeth * ctx.cos(slope), 2 * (ctx.mpf(teeth) / 2 + ctx.mpf(addendum) + shift)
    half = (ctx.pi / 2 + 2 * shift * ctx.tan(slope)) / teeth + _involute(ctx, ctx.tan(slope))
    return 2 * tip * (half - _involute(ctx, ctx.sqrt((tip / base) ** 2 - 1)))


def _thick(degrees: float, shift: float) -> float:
    return SpurGear(40, MODULE, shift, RackCutter(pressure_angle_deg=degrees, **LOW)).tip_thickness


def _angles(limit: float) -> Callable[[float], Sizes]:
    """Pressure angles towards a limit from inside, deg, and a profile shift."""
    return lambda x: (limit * (1 + (x if limit < 10 else -x)), 0.1)


def _modules(power: int, x: float) -> Sizes:
    return TEETH, MODULE * x**power, 0.0


def _distance(ctx: Any, first: Any, second: Any, module: Any, shift: Any) -> Any:
    """Centre distance of a pair whose shifts have this sum, by Newton's method on the involute function."""
    slope = ctx.tan(ctx.pi / 9)
    involute = _involute(ctx, slope) + 2 * slope * shift / (first + second)
    roll = ctx.cbrt(3 * involute)
    for _ in range(12):
        roll -= (_involute(ctx, roll) - involute) * (1 + roll**2) / roll**2
    return module * (first + second) / 2 * ctx.cos(ctx.pi / 9) * ctx.sqrt(1 + roll**2)


def _pair(first: float, second: float, module: float, shift: float) -> float:
    one, two = (SpurGear(int(teeth), module, shift / 2) for teeth in (first, second))
    return float(GearPair(one, two).centre_distance)


# The shifts, modules, below which the rack undercuts twelve teeth, and at which they are pointed.
LIMIT = float(1.25 - 0.38 * (1 - np.sin(np.pi / 9)) - TEETH / 2 * np.sin(np.pi / 9) ** 2)
POINTED = 0.8202038929083826
# Sum of shifts, modules, with which two gears of 100 teeth would have a working pressure angle of 0.
LEAST = -100 * float(1 - np.pi / 9 / np.tan(np.pi / 9))

SPUR = "spur gear"

CELLS = (
    Cell(
        SPUR, "cut-in radius to the base circle", "form radius", "gap of the profile shift to no undercut, relative",
        lambda x: (TEETH, MODULE, LIMIT * (1 - x)), _form_radius, _formed, "all"),
    Cell(
        SPUR, "teeth to 4", "form radius", "1e-1 for 16 teeth, a tenth for each tooth fewer",
        lambda x: (max(4.0, 17 + round(np.log10(x))), MODULE, 0.1 if x < 1e-10 else 0.0), _form_radius, _formed, "all"),
    Cell(
        SPUR, "tips nearly pointed", "tip thickness", "gap of the profile shift to a pointed tip, relative",
        # Nearer by some last bits, rounding decides whether a tip is pointed.
        lambda x: (20.0, POINTED * (1 - x - 3e-15)), lambda ctx, degrees, shift: _tip(ctx, degrees, shift, 12, 1.0),
        lambda degrees, shift: SpurGear(12, MODULE, shift, RackCutter(degrees)).tip_thickness, "sizes",
        "the thickness, compared with the tip radius"),
    *(
        Cell(SPUR, f"pressure angle to {limit:g} deg", "tip thickness", "gap of the angle to the limit, relative",
             _angles(limit), _tip, _thick, "all")
        for limit in (5.0, 45.0)
    ),
    Cell(
        "gear pair", "pressure angle to its limits", "centre distance",
        "gap of the shifts to a working pressure angle of 0, relative",
        lambda x: (100.0, 100.0, MODULE, LEAST * (1 - x)), _distance, _pair, "refused"),
    *(
        Cell(SPUR, place, "form radius", distance, partial(_modules, power), _form_radius, _formed, "all, refused")
        for place, distance, power in (
            ("small sizes", "module over 2 mm", 1), ("large sizes", "2 mm over the module", -1))
    ),
)  # fmt: skip
