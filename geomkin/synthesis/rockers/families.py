"""Linkages that all do what is wanted and differ in one free choice, and the best of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import ClassVar

import numpy as np

from ...core.arguments import LARGEST
from ...core.errors import DesignError
from ...core.fields import FARTHEST, SMALLEST, rounded_down, rounded_up
from ...core.records import record
from ...linkage.linkage import AbstractLinkage
from ...linkage.measures import dead_centres, least_transmission_angle
from ...linkage.moving import move
from ...linkage.named_linkages import FourBar, SliderCrank
from ...plane.vec import Mask, Real
from ..found import Found, ten_digits

# Members that are told, evenly along the free angle without its ends, at which a length vanishes or has no end. More
# tell nothing new: the best one is searched for by itself.
MEMBERS = 179
# Looks along a family before its best is narrowed. With nine, the best of one double rocker in some hundred is missed;
# of crank-rockers and slider-cranks none is.
LOOKS = 1025
# Longest link over the shortest where no limit is given. Those of cranks that turn fully get better without end as it
# grows where both strokes take alike long: 6 costs 0.8 of 45 deg of transmission angle at a swing of 90 deg and 2.6 of
# 70 deg at 40 deg, and larger limits give linkages that nobody can build. Of double rockers the best has an end.
TURNING_RATIO, RATIO = 6.0, 100.0
# Of a family's range, the step over which a slope is taken, and what f may lose by rounding the place of its top, rad.
# A smaller step leaves fewer digits of the place, a larger one bends it; a larger loss takes a corner for a round top.
STEP = 1e-3
ROUNDING = 1e-13
LINKS = ("ground", "crank", "coupler", "rocker")


@record(eq=False, kw_only=True)
class Family:
    """All linkages that do what is wanted, along the angle that stays free.

    linkage: one with arrays (members,) as its sizes, mm. free_angle_deg: (members,), rising, without the ends of
    `range_deg`, between which there are linkages. transmission_angle_deg: (members,) the least of each over its motion,
    nan where one has a defect.
    """

    linkage: AbstractLinkage
    free_angle_deg: Real
    transmission_angle_deg: Real
    range_deg: tuple[float, float]


@record(eq=False, kw_only=True)
class AbstractMember(Found):
    """A linkage that was chosen from a family, and what it does as it is moved.

    free_angle_deg: where in its family it is. largest_ratio: of the longest link over the shortest, beyond which none
    was looked for. at_largest_ratio: whether the best would be better still if one link could be longer.
    """

    # What the simulated motion does, in mm where no other unit is told: comes first in summary.json.
    measured: ClassVar[tuple[str, ...]]

    free_angle_deg: float
    largest_ratio: float
    at_largest_ratio: bool
    family: Family

    def summary(self) -> Mapping[str, object]:
        told = {name: ten_digits(getattr(self, name)) for name in (*self.measured, "free_angle_deg")}
        named = {name if name.endswith("_deg") else f"{name}_mm": value for name, value in told.items()}
        limit = {"largest_ratio": ten_digits(self.largest_ratio), "at_largest_ratio": self.at_largest_ratio}
        return {**named, **super().summary(), **limit}


def members(low: float, high: float) -> Real:
    """Free angles of the members that are told, rad, of a family between two ends."""
    return np.linspace(low, high, MEMBERS + 2)[1:-1]


def highest(f: Callable[[Real], Real], low: float, high: float) -> float:
    """Where f, of a row of places, is highest between two; where the top is round, to nine digits that are sure."""
    places, width = np.linspace(low, high, LOOKS), np.inf
    while True:
        top = int(np.argmax(f(places)))
        best = float(places[top])
        ends = places[max(top - 1, 0)], places[min(top + 1, len(places) - 1)]
        if ends[1] - ends[0] >= width:
            break
        width = ends[1] - ends[0]
        places = np.unique(np.append(np.linspace(*ends, 17), best))
    round_top = float(f"{_summit(f, best, STEP * (high - low)):.9g}")
    values = f(np.array([best, round_top]))
    return round_top if low <= round_top <= high and values[1] >= values[0] - ROUNDING else best


def _summit(f: Callable[[Real], Real], best: float, step: float) -> float:
    """The top of a smooth f near its best place, where its slope is 0: values alone tell half of the digits."""
    for _ in range(3):
        values = f(best + step * np.arange(-2, 3))
        if not np.abs(values).max() < LARGEST:
            break
        slope, bend = (float(np.dot(weights, values)) for weights in ([1, -8, 0, 8, -1], [-1, 16, -30, 16, -1]))
        if not abs(slope) < -bend:
            break
        best -= step * slope / bend
    return best


def the_choice(given: Mapping[str, float | None]) -> tuple[str, float] | None:
    """The one thing that is given of several that each tell the rest, by its name; None where none is."""
    told = {name: value for name, value in given.items() if value is not None}
    if len(told) > 1:
        first, second, *_ = told
        raise DesignError(second, f"is given besides {first}", "give one of them: the others follow")
    return next(iter(told.items()), None)


def turn_of(crank_turn_deg: float | None, time_ratio: float | None) -> float:
    """The crank's turn in a stroke, deg, from itself or from the ratio of times there and back; 180 from neither."""
    if time_ratio is None:
        return 180.0 if crank_turn_deg is None else crank_turn_deg
    if crank_turn_deg is not None:
        raise DesignError("time_ratio", "is given besides crank_turn_deg", "give one of them, which tells the other")
    return 360 * time_ratio / (1 + time_ratio)


def scale_of(sizes: Mapping[str, float], name: str, length: float) -> float:
    """What makes `name` of the sizes as long as is given; DesignError where another gets too long or short for it."""
    scale = length / sizes[name]
    longest, shortest = max(sizes.values()), min(sizes.values())
    if longest * scale > FARTHEST:
        most = rounded_down(FARTHEST * sizes[name] / longest)
        raise DesignError(name, f"found {length:g} mm, which makes a link of {longest * scale:g} mm", f"give {most} mm")
    if shortest * scale < SMALLEST:
        least = rounded_up(SMALLEST * sizes[name] / shortest)
        found = f"found {length:g} mm, which makes a link of {shortest * scale:g} mm"
        raise DesignError(name, found, f"give at least {least} mm")
    return scale


def within_sizes(*sizes: Real) -> Mask:
    """Which members have all their sizes within what a linkage may have."""
    fit: Mask = np.all([(size <= FARTHEST) & (size >= SMALLEST) for size in sizes], axis=0)
    return fit


def four_bars(sizes: Mapping[str, Real]) -> FourBar:
    """Many at once, by the names of their links."""
    ground, crank, coupler, rocker = (np.asarray(sizes[name], dtype=np.float64) for name in LINKS)
    return FourBar(ground, crank, coupler, rocker)


# rad. Two dead centres that are nearer than this on the circle are one that was found from both sides of 0; of those
# that are looked for in steps of a quarter degree none are nearer.
ONE = 1e-6
# Frames of the turn, besides the dead centres; that it closes between them as well is seen from as many.
FRAMES = 361


@record(eq=False, kw_only=True)
class FullTurn:
    """A full turn of a crank, counterclockwise, and what it does to its rocker or slider.

    extent: how far the output goes there and back, rad or mm. start, turn: the crank's angle, 0 to 2 pi, where the
    output begins to go counterclockwise, or towards +x, and its turn until the output goes back, rad. least: the least
    transmission angle, rad. All nan where the linkage does not close all the way, or does not go there and back once.
    """

    extent: float
    start: float
    turn: float
    least: float


def full_turn(linkage: FourBar | SliderCrank, branch: int = 1) -> FullTurn:
    """The linkage moved once round. Derived here: dead centres as zeros of the output's first coefficient."""
    output = "rocker" if isinstance(linkage, FourBar) else "slider"
    # A little more than one turn: a dead centre at its very ends would show no change of sign.
    dead = _once(dead_centres(linkage, output, branch, (-0.1, 2 * np.pi + 0.1)))
    frames = np.linspace(0, 2 * np.pi, FRAMES)
    # Crank and ground in line are the two places at which the transmission angle of a four-bar is least; of a
    # slider-crank it is crank and slide line at right angles. All three are frames.
    motion = move(linkage, frames, branch)
    if len(dead) != 2 or not motion.assembled.all():
        return FullTurn(extent=np.nan, start=np.nan, turn=np.nan, least=np.nan)
    body = move(linkage, dead, branch).bodies[output]
    if output == "rocker":
        places: Real = np.unwrap(np.angle(body.direction))
        way = np.unwrap(np.angle(motion.bodies[output].direction))
    else:
        places, way = body.origin.position.real, motion.bodies[output].origin.position.real
    turn = float(dead[1] - dead[0])
    start, turn = (float(dead[0]), turn) if places[1] > places[0] else (float(dead[1]), 2 * np.pi - turn)
    extent = max(float(np.ptp(places)), float(np.ptp(way)))
    return FullTurn(extent=extent, start=start, turn=turn, least=float(least_transmission_angle(motion)))


def _once(turns: Real) -> Real:
    """Angles on the circle, 0 to 2 pi and rising, each told once."""
    rising = np.sort(np.mod(turns, 2 * np.pi))
    before = np.roll(rising, 1) - 2 * np.pi * (np.arange(len(rising)) == 0)
    once: Real = rising[rising - before > ONE]
    return once
