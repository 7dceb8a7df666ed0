"""Where methods for cams and gears fail: base circles, arms at limits; undercut, pointed tips, few teeth."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from ..cam.base_circle import least_base_circle
from ..cam.cam import Cam
from ..cam.followers.flat import OscillatingFlat, TranslatingFlat
from ..cam.followers.roller import OscillatingRoller, TranslatingRoller
from ..cam.program.program import Program
from ..cam.program.segments import Dwell, Return, Rise
from ..gear.cutters import RackCutter
from ..gear.pair import GearPair
from ..gear.spur import SpurGear
from .family import Cell, Sizes, for_each

# Names of results with their values.
Results = Iterator[tuple[str, Any]]
# Lifts of 20 mm and of 0.3 rad, each by a cosine over half a turn; and of 40 mm, by one over a sixth of it.
HEIGHT, SWING, TALL = 20.0, 0.3, 40.0


def _slow(rise: float) -> Program:
    return Program((Rise("harmonic", rise=rise, end_deg=180), Return("harmonic", end_deg=360)))


def _fast(rise: float, law: Any = "harmonic") -> Program:
    return Program((Rise(law, rise=rise, end_deg=60), Return(law, end_deg=120), Dwell(end_deg=360)))


SLOW, STEEP, QUINTIC = _slow(HEIGHT), _fast(TALL), _fast(TALL, "3-4-5")
ARM = Program((Rise("harmonic", rise_deg=float(np.degrees(SWING)), end_deg=180), Return("harmonic", end_deg=360)))
# Cam angle on the steep rise, beyond its middle, where the cam is most convex; and one at which a face has no room.
STEEP_AT, QUINTIC_AT = 1.0, 0.8


def _lift(ctx: Any, angle: Any, height: Any, pace: int = 1) -> tuple[Any, Any, Any]:
    """Lift by half a cosine, and its first two derivatives by cam angle."""
    half, phase = ctx.mpf(height) / 2, pace * angle
    return half * (1 - ctx.cos(phase)), pace * half * ctx.sin(phase), pace**2 * half * ctx.cos(phase)


def roller(ctx: Any, base: Any, radius: Any, offset: Any, angle: Any, rise: Any = HEIGHT, pace: int = 1) -> Results:
    """A cam with a translating roller that turns counterclockwise."""
    prime = base + radius
    lift, velocity, acceleration = _lift(ctx, angle, rise, pace)
    up, across = ctx.sqrt(prime * prime - offset * offset) + lift, velocity - offset
    yield "height", up
    yield "pressure angle", ctx.atan2(across, up)
    far = ctx.sqrt(across * across + up * up)
    yield "profile", ctx.expj(-angle) * (ctx.mpc(offset, up) - radius * ctx.mpc(-across, up) / far)
    curvature = (up * up + across * (across + velocity) - up * acceleration) / far**3
    yield "curvature", curvature / (1 - radius * curvature)


def rolled(base: float, radius: float, offset: float, angle: float, rise: float = HEIGHT, law: Any = _slow) -> Results:
    """The library's cam with a translating roller."""
    cam = Cam(TranslatingRoller(radius, offset), law(rise), base)
    yield "height", cam.follower_pose(angle).origin.imag
    yield "pressure angle", cam.contact(angle).pressure_angle
    yield "profile", cam.profile.point(angle)
    yield "curvature", -cam.profile.curvature(angle)


def arm(ctx: Any, base: Any, radius: Any, pivot: Any, length: Any, angle: Any) -> Results:
    """A cam with a roller on an arm."""
    prime = base + radius
    lift, velocity, _ = _lift(ctx, angle, SWING)
    psi = ctx.acos((pivot * pivot + length * length - prime * prime) / (2 * pivot * length)) + lift
    yield "arm's angle", psi
    yield "pressure angle", ctx.atan2(length * (1 + velocity) - pivot * ctx.cos(psi), pivot * ctx.sin(psi))


def armed(base: float, radius: float, pivot: float, length: float, angle: float) -> Results:
    """The library's cam with a roller on an arm."""
    cam = Cam(OscillatingRoller(radius, pivot, length), ARM, base)
    yield "arm's angle", np.angle(-np.conj(cam.follower_pose(angle).direction))
    yield "pressure angle", cam.contact(angle).pressure_angle


def _offset(angle: float, x: float) -> Sizes:
    return 40.0, 10.0, 50 * (1 - x), angle


def _extended(angle: float, x: float) -> Sizes:
    """An arm of 80 mm, pivoted 100 mm from the cam, and prime circles of 20 mm and more."""
    return 20 * (1 + x) - 10, 10.0, 100.0, 80.0, angle


def _sized(power: int, x: float) -> Sizes:
    return 40 * x**power, 10 * x**power, 12 * x**power, 1.0, HEIGHT * x**power


def _face(ctx: Any, base: Any, angle: Any) -> Any:
    """Radius of curvature of a cam with a flat face on the quintic rise."""
    width = ctx.pi / 3
    x = angle / width
    lift = TALL * (10 * x**3 - 15 * x**4 + 6 * x**5)
    return base + lift + TALL * (60 * x - 180 * x**2 + 120 * x**3) / width**2


def _steepest(ctx: Any, degrees: Any) -> Any:
    """Base radius with this largest pressure angle of a knife edge on the slow lift: A / sin - A, A half the lift."""
    return ctx.mpf(HEIGHT) / 2 * (1 / ctx.sin(degrees * ctx.pi / 180) - 1)


def _least(degrees: float) -> float:
    found = least_base_circle(TranslatingRoller(0.0), SLOW, pressure_angle_deg=degrees)
    return found.radius if found.limit == "pressure angle" else np.nan


# Radius of curvature of the pitch curve there, mm, for a prime radius of 50 mm; and the base radius that leaves none.
RADIUS = -1 / float(Cam(TranslatingRoller(0.0), STEEP, 50.0).profile.curvature(STEEP_AT))
NO_ROOM = -float(QUINTIC.motion(QUINTIC_AT).lift + QUINTIC.motion(QUINTIC_AT).acceleration)
# Accuracy of the pressure angle in the search for the least base circle, relative.
ACCURACY, SEARCH = 1e-12, "the accuracy of the search, 1e-12 of the angle"
ROLLER = "cam with a roller"
STEEP_CELL = Cell(
    ROLLER, "roller radius to curvature radius", "", "gap of roller radius to curvature radius, relative",
    lambda x: (50 - RADIUS * (1 - x), RADIUS * (1 - x), 0.0, STEEP_AT), partial(roller, rise=TALL, pace=3),
    partial(rolled, rise=TALL, law=_fast), "all")  # fmt: skip
OFFSET_CELL = Cell(
    ROLLER, "offset to the prime radius", "", "gap of offset to prime radius, relative", partial(_offset, 0.01),
    roller, rolled, "all")  # fmt: skip
ARM_CELL = Cell(
    "cam with an arm and a roller", "base circle to its least", "",
    "excess of the prime circle over its least, relative", partial(_extended, 0.01), arm, armed, "all")  # fmt: skip

CAM_CELLS = (
    *for_each(["curvature"], replace(
        STEEP_CELL, answer="sizes", reported_by="the radius of curvature, compared with the roller's")),
    *for_each(["profile"], STEEP_CELL),
    *for_each(["height"], replace(OFFSET_CELL, sizes=partial(_offset, 0.0))),
    *for_each(["pressure angle", "curvature", "profile"], OFFSET_CELL),
    *for_each(["pressure angle"], Cell(
        ROLLER, "pressure angle to its limits", "", "base radius over 10 mm, with a knife edge",
        lambda x: (10 * x, 0.0, 0.0, (2 * x) ** 0.5), roller, rolled, "all, refused")),
    *for_each(["profile"], Cell(
        ROLLER, "angles of many turns", "", "one over the number of turns",
        lambda x: (40.0, 10.0, 0.0, 1 + 2 * np.pi * round(1 / x)), roller, rolled, "sizes",
        "the angle's own last digit")),
    *for_each(["profile"], Cell(
        ROLLER, "small sizes", "", "sizes over 20 mm", partial(_sized, 1), roller, rolled, "all, refused")),
    *for_each(["profile"], Cell(
        ROLLER, "large sizes", "", "20 mm over sizes", partial(_sized, -1), roller, rolled, "all, refused")),
    *for_each(["arm's angle"], replace(ARM_CELL, sizes=partial(_extended, 0.0))),
    *for_each(["pressure angle"], ARM_CELL),
    Cell(
        "cam with an arm and a flat face", "base circle to its largest", "arm's angle",
        "gap to a face perpendicular to the line of axes, relative", lambda x: (100 * (1 - x) + 10, 10.0, 100.0),
        lambda ctx, base, offset, pivot: ctx.asin((base - offset) / pivot),
        lambda base, offset, pivot: OscillatingFlat(pivot, offset).start_angle(base), "all"),
    Cell(
        "cam with a flat face", "base circle to its least", "radius of curvature",
        "excess of the base circle over its least, relative", lambda x: (NO_ROOM * (1 + x), QUINTIC_AT), _face,
        lambda base, angle: 1 / np.abs(Cam(TranslatingFlat(), QUINTIC, base).profile.curvature(angle)), "sizes",
        "the radius of curvature, compared with the base radius"),
    Cell(
        "least base circle", "pressure angle to its limits", "least base radius", "pressure angle over 30 deg",
        lambda x: (30 * x,), _steepest, _least, "sizes, refused", SEARCH, share=ACCURACY),
    Cell(
        "least base circle", "base circle to its least", "least base radius",
        "gap of the pressure angle to 90 deg, relative", lambda x: (90 * (1 - x),), _steepest, _least, "sizes, nan",
        f"{SEARCH}; `limit` is empty if any circle is large enough", share=ACCURACY),
)  # fmt: skip


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

GEAR_CELLS = (
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
