"""Where methods for gears fail: undercut that just begins, few teeth, pointed tips, pressure angles at their limits."""

from __future__ import annotations

from collections.abc import Callable
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
    """Where the path of the rack's rounded corner crosses the involute, by halves of the way between two sides."""
    slope, depth, rounding = ctx.pi / 9, ctx.mpf(1.25) - ctx.mpf(0.38) - shift, ctx.mpf(0.38)
    pitch = teeth / 2
    base = pitch * ctx.cos(slope)
    side = ctx.pi / 4 - (depth + shift) * ctx.tan(slope) - rounding / ctx.cos(slope)
    half = (ctx.pi / 2 + 2 * shift * ctx.tan(slope)) / teeth + _involute(ctx, ctx.tan(slope))
    # From the middle of the space to where the involute starts.
    ahead = half - ctx.pi / teeth + side / pitch

    def corner(lean: Any) -> Any:
        along = depth * ctx.tan(lean)
        return (ctx.mpc(pitch - depth, -along) - rounding * ctx.expj(lean)) * ctx.expj(along / pitch + ahead)

    def outside(lean: Any) -> Any:
        return abs(corner(lean)) - base

    def inside(lean: Any) -> Any:
        place = corner(lean)
        square = (abs(place) / base) ** 2 - 1
        return ctx.atan2(place.imag, place.real) - _involute(ctx, ctx.sqrt(max(square, ctx.mpf(0))))

    end = slope - ctx.pi / 2
    foot = _between(outside, ctx.mpf(0), end)
    return module * abs(corner(_between(inside, foot, end)))


def _between(f: Callable[[Any], Any], low: Any, high: Any) -> Any:
    """Where f changes sign: false position that halves a stale end."""
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


def _spur(teeth: float, module: float, shift: float) -> SpurGear:
    return SpurGear(int(teeth), module, shift, on_pointed_tip="cut")


def _limit() -> float:
    """The shift, modules, below which the rack undercuts twelve teeth."""
    slope = np.pi / 9
    return float(1.25 - 0.38 * (1 - np.sin(slope)) - TEETH / 2 * np.sin(slope) ** 2)


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


def _modules(power: int) -> Callable[[float], Sizes]:
    return lambda x: (TEETH, MODULE * x**power, 0.0)


def _pointed_shift() -> float:
    """The shift, modules, at which twelve teeth are pointed."""

    class Plain:
        pi, mpf, atan, cos, tan, sqrt = np.pi, float, np.arctan, np.cos, np.tan, np.sqrt

    return float(_between(lambda shift: _tip(Plain, 20.0, shift, 12, 1.0), 0.1, 1.2))


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


LIMIT, POINTED = _limit(), _pointed_shift()
# Sum of shifts, modules, with which two gears of 100 teeth would have a line of action square to their axes' line.
LEAST = -100 * float(1 - np.pi / 9 / np.tan(np.pi / 9))

CELLS = (
    Cell(
        "spur gear",
        "cut-in radius to the base circle",
        "form radius",
        "what the profile shift lacks to no undercut, of itself",
        lambda x: (TEETH, MODULE, LIMIT * (1 - x)),
        _form_radius,
        lambda *sizes: _spur(*sizes).form_radius,
        "all",
    ),
    Cell(
        "spur gear",
        "teeth to 4",
        "form radius",
        "1e-1 for 16 teeth, a tenth of it for one less",
        lambda x: (max(4.0, 17 + round(np.log10(x))), MODULE, 0.1 if x < 1e-10 else 0.0),
        _form_radius,
        lambda *sizes: _spur(*sizes).form_radius,
        "all",
    ),
    Cell(
        "spur gear",
        "tips nearly pointed",
        "tip thickness",
        "what the profile shift lacks to a pointed tip, of itself",
        # Nearer by some last bits, rounding decides whether a tip is pointed.
        lambda x: (20.0, POINTED * (1 - x - 3e-15)),
        lambda ctx, degrees, shift: _tip(ctx, degrees, shift, 12, 1.0),
        lambda degrees, shift: SpurGear(12, MODULE, shift, RackCutter(degrees)).tip_thickness,
        "sizes",
        "the thickness beside the tip radius",
    ),
    *(
        Cell(
            "spur gear",
            f"pressure angle to {limit:g} deg",
            "tip thickness",
            "what the angle lacks to the limit, of itself",
            _angles(limit),
            _tip,
            _thick,
            "all",
        )
        for limit in (5.0, 45.0)
    ),
    Cell(
        "gear pair",
        "pressure angle to its limits",
        "centre distance",
        "what the shifts lack to a working pressure angle of 0, of themselves",
        lambda x: (100.0, 100.0, MODULE, LEAST * (1 - x)),
        _distance,
        _pair,
        "refused",
    ),
    *(
        Cell(
            "spur gear",
            place,
            "form radius",
            distance,
            _modules(power),
            _form_radius,
            lambda *sizes: _spur(*sizes).form_radius,
            "all, refused",
        )
        for place, distance, power in (
            ("small sizes", "module over 2 mm", 1),
            ("large sizes", "2 mm over the module", -1),
        )
    ),
)
