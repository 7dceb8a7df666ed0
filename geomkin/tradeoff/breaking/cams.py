"""Where methods for cams fail: rollers as large as the cam's curvature, least base circles, offsets, arms that end."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ...cam.base_circle import least_base_circle
from ...cam.cam import Cam
from ...cam.followers.flat import OscillatingFlat, TranslatingFlat
from ...cam.followers.roller import OscillatingRoller, TranslatingRoller
from ...cam.program.program import Program
from ...cam.program.segments import Dwell, Return, Rise
from ..cell import Cell, Sizes

# Lifts of 20 mm and of 0.3 rad, each by a cosine over half a turn; and of 40 mm, by one over a sixth of it.
HEIGHT, SWING, TALL = 20.0, 0.3, 40.0
SLOW = Program((Rise("harmonic", rise=HEIGHT, end_deg=180), Return("harmonic", end_deg=360)))
ARM = Program((Rise("harmonic", rise_deg=float(np.degrees(SWING)), end_deg=180), Return("harmonic", end_deg=360)))
STEEP = Program((Rise("harmonic", rise=TALL, end_deg=60), Return("harmonic", end_deg=120), Dwell(end_deg=360)))
QUINTIC = Program((Rise("3-4-5", rise=TALL, end_deg=60), Return("3-4-5", end_deg=120), Dwell(end_deg=360)))
# Cam angle on the steep rise, beyond its middle, where the cam is most convex; and one at which a face has no room.
STEEP_AT, QUINTIC_AT = 1.0, 0.8


def _lift(ctx: Any, angle: Any, height: Any, pace: int = 1) -> tuple[Any, Any, Any]:
    """Lift by half a cosine, and its first two derivatives by cam angle."""
    half = ctx.mpf(height) / 2
    turn = pace * angle
    return half * (1 - ctx.cos(turn)), pace * half * ctx.sin(turn), pace**2 * half * ctx.cos(turn)


def _roller(result: str, height: float = HEIGHT, pace: int = 1) -> Callable[..., Any]:
    """The textbook's cam with a translating roller that turns counterclockwise."""

    def formula(ctx: Any, base: Any, radius: Any, offset: Any, angle: Any, rise: Any = height) -> Any:
        prime = base + radius
        lift, velocity, acceleration = _lift(ctx, angle, rise, pace)
        up, aside = ctx.sqrt(prime * prime - offset * offset) + lift, velocity - offset
        far = ctx.sqrt(aside * aside + up * up)
        if result == "height":
            return up
        if result == "pressure angle":
            return ctx.atan2(aside, up)
        if result == "profile":
            return ctx.expj(-angle) * (ctx.mpc(offset, up) - radius * ctx.mpc(-aside, up) / far)
        bend = (up * up + aside * (aside + velocity) - up * acceleration) / far**3
        return bend / (1 - radius * bend)

    return formula


def _rolled(result: str, program: Program = SLOW) -> Callable[..., Any]:
    """The library's."""

    def library(base: float, radius: float, offset: float, angle: float, rise: float | None = None) -> Any:
        lifts = program
        if rise is not None:
            lifts = Program((Rise("harmonic", rise=rise, end_deg=180), Return("harmonic", end_deg=360)))
        cam = Cam(TranslatingRoller(radius, offset), lifts, base)
        if result == "height":
            return cam.follower_pose(angle).origin.imag
        if result == "pressure angle":
            return cam.contact(angle).pressure_angle
        return cam.profile.point(angle) if result == "profile" else -cam.profile.curvature(angle)

    return library


def _arm(result: str) -> Callable[..., Any]:
    """The textbook's arm with a roller."""

    def formula(ctx: Any, base: Any, radius: Any, pivot: Any, arm: Any, angle: Any) -> Any:
        prime = base + radius
        lift, velocity, _ = _lift(ctx, angle, SWING)
        psi = ctx.acos((pivot * pivot + arm * arm - prime * prime) / (2 * pivot * arm)) + lift
        if result == "arm's angle":
            return psi
        return ctx.atan2(arm * (1 + velocity) - pivot * ctx.cos(psi), pivot * ctx.sin(psi))

    return formula


def _armed(result: str) -> Callable[..., Any]:
    """The library's."""

    def library(base: float, radius: float, pivot: float, arm: float, angle: float) -> Any:
        follower = OscillatingRoller(radius, pivot, arm)
        if result == "arm's angle":
            direction = Cam(follower, ARM, base).follower_pose(angle).direction
            return np.angle(-np.conj(direction))
        return Cam(follower, ARM, base).contact(angle).pressure_angle

    return library


def _offset(angle: float) -> Callable[[float], Sizes]:
    return lambda x: (40.0, 10.0, 50 * (1 - x), angle)


def _reached(angle: float) -> Callable[[float], Sizes]:
    """An arm of 80 mm that stands 100 mm from the cam, and prime circles of 20 mm and more."""
    return lambda x: (20 * (1 + x) - 10, 10.0, 100.0, 80.0, angle)


def _sized(power: int) -> Callable[[float], Sizes]:
    return lambda x: (40 * x**power, 10 * x**power, 12 * x**power, 1.0, HEIGHT * x**power)


def _face(ctx: Any, base: Any, angle: Any) -> Any:
    """Radius of curvature of a cam with a flat face on the quintic rise."""
    width = ctx.pi / 3
    x = angle / width
    lift = TALL * (10 * x**3 - 15 * x**4 + 6 * x**5)
    return base + lift + TALL * (60 * x - 180 * x**2 + 120 * x**3) / width**2


def _steepest(ctx: Any, degrees: Any) -> Any:
    """Base radius for which a knife edge on the slow lift leans by so much at most: A / sin - A, A half the lift."""
    return ctx.mpf(HEIGHT) / 2 * (1 / ctx.sin(degrees * ctx.pi / 180) - 1)


def _least(degrees: float) -> float:
    found = least_base_circle(TranslatingRoller(0.0), SLOW, pressure_angle_deg=degrees)
    return found.radius if found.limit == "pressure angle" else np.nan


# Radius of curvature of the pitch curve there, mm, for a prime radius of 50 mm; and the base radius that leaves none.
RADIUS = -1 / float(Cam(TranslatingRoller(0.0), STEEP, 50.0).profile.curvature(STEEP_AT))
NO_ROOM = -float(QUINTIC.motion(QUINTIC_AT).lift + QUINTIC.motion(QUINTIC_AT).acceleration)

# Share of the pressure angle that the search for the least base circle keeps it to.
KEPT = 1e-12

CELLS = (
    *(
        Cell(
            "cam with a roller",
            "roller radius to curvature radius",
            result,
            "what the roller is smaller, of itself",
            lambda x: (50 - RADIUS * (1 - x), RADIUS * (1 - x), 0.0, STEEP_AT),
            _roller(result, TALL, 3),
            _rolled(result, STEEP),
            answer,
            "the radius of curvature beside the roller's",
        )
        for result, answer in (("curvature", "sizes"), ("profile", "all"))
    ),
    *(
        Cell(
            "cam with a roller",
            "offset to the prime radius",
            result,
            "what the offset is smaller, of the prime radius",
            _offset(angle),
            _roller(result),
            _rolled(result),
            "all",
        )
        for result, angle in (("height", 0.0), ("pressure angle", 0.01), ("curvature", 0.01), ("profile", 0.01))
    ),
    Cell(
        "cam with a roller",
        "pressure angle to its limits",
        "pressure angle",
        "base radius over 10 mm, with a knife edge",
        lambda x: (10 * x, 0.0, 0.0, (2 * x) ** 0.5),
        _roller("pressure angle"),
        _rolled("pressure angle"),
        "all, refused",
    ),
    Cell(
        "cam with a roller",
        "angles of many turns",
        "profile",
        "one over the turns",
        lambda x: (40.0, 10.0, 0.0, 1 + 2 * np.pi * round(1 / x)),
        _roller("profile"),
        _rolled("profile"),
        "sizes",
        "the angle's own last digit",
    ),
    *(
        Cell(
            "cam with a roller",
            place,
            "profile",
            distance,
            _sized(power),
            _roller("profile"),
            _rolled("profile"),
            "all, refused",
        )
        for place, distance, power in (
            ("small sizes", "sizes over 20 mm", 1),
            ("large sizes", "20 mm over sizes", -1),
        )
    ),
    *(
        Cell(
            "cam with an arm and a roller",
            "base circle to its least",
            result,
            "what the prime circle is larger than the arm just reaches",
            _reached(angle),
            _arm(result),
            _armed(result),
            "all",
        )
        for result, angle in (("arm's angle", 0.0), ("pressure angle", 0.01))
    ),
    Cell(
        "cam with an arm and a flat face",
        "base circle to its largest",
        "arm's angle",
        "what the face lacks to stand square to the line of axes",
        lambda x: (100 * (1 - x) + 10, 10.0, 100.0),
        lambda ctx, base, offset, pivot: ctx.asin((base - offset) / pivot),
        lambda base, offset, pivot: OscillatingFlat(pivot, offset).start_angle(base),
        "all",
    ),
    Cell(
        "cam with a flat face",
        "base circle to its least",
        "radius of curvature",
        "what the base circle is larger, of itself",
        lambda x: (NO_ROOM * (1 + x), QUINTIC_AT),
        _face,
        lambda base, angle: 1 / np.abs(Cam(TranslatingFlat(), QUINTIC, base).profile.curvature(angle)),
        "sizes",
        "the radius of curvature beside the base radius",
    ),
    Cell(
        "least base circle",
        "pressure angle to its limits",
        "least base radius",
        "pressure angle over 30 deg",
        lambda x: (30 * x,),
        _steepest,
        _least,
        "sizes, refused",
        "kept to 1e-12 of the angle",
        share=KEPT,
    ),
    Cell(
        "least base circle",
        "base circle to its least",
        "least base radius",
        "what the pressure angle lacks to 90 deg, of itself",
        lambda x: (90 * (1 - x),),
        _steepest,
        _least,
        "sizes, nan",
        "kept to 1e-12 of the angle; `limit` is nothing where any circle will do",
        share=KEPT,
    ),
)
