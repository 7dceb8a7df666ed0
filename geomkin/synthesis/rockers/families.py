"""Families of linkages with one free parameter that all solve the same problem, and the search for the best member."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import ClassVar

import numpy as np

from ...core.arguments import LARGEST
from ...core.errors import DesignError
from ...core.fields import FARTHEST, SMALLEST, rounded_down, to_digits
from ...core.records import record
from ...core.units import mm
from ...linkage.drive_limits import dead_centres
from ...linkage.linkage import AbstractLinkage
from ...linkage.measures import least_transmission_angle
from ...linkage.moving import move
from ...linkage.named_linkages import FourBar, SliderCrank
from ...plane.vec import Mask, Real
from ..found import Found, ten_digits

# Members listed, evenly spaced along the free angle without its ends, at which a length is 0 or infinite. More add
# nothing, since the best one is searched for separately.
MEMBERS = 179
# Samples along a family before the maximum is narrowed down. Nine samples miss the best of about one double rocker in a
# hundred, and of no crank-rocker or slider-crank.
LOOKS = 1025
# Default limits of the ratio of the longest link to the shortest. If both strokes take equally long, a linkage with a
# rotating crank improves without end as the ratio grows: 6 costs 0.8 of 45 deg of transmission angle at a swing of 90
# deg and 2.6 of 70 deg at 40 deg, and larger limits give linkages that cannot be built. The best double rocker has a
# finite ratio.
TURNING_RATIO, RATIO = 6.0, 100.0
# STEP is the step for slopes as a share of the family's range; ROUNDING is the loss of the function value that rounding
# of the position of the maximum may cause, rad. A smaller step leaves fewer digits of the position, a larger one
# distorts it; a larger loss mistakes a corner for a smooth maximum.
STEP = 1e-3
ROUNDING = 1e-13
LINKS = ("ground", "crank", "coupler", "rocker")


@record(eq=False, kw_only=True)
class Family:
    """All linkages that solve a problem, along the angle that stays free.

    Parameters
    ----------
    linkage : FourBar or SliderCrank
        One linkage whose sizes are arrays of shape (members,), mm.
    free_angle_deg : array, shape (members,)
        The free angle of each member, rising, without the ends of `range_deg`.
    transmission_angle_deg : array, shape (members,)
        Least transmission angle of each member over its motion; nan if it has a defect.
    range_deg : tuple of float
        Range of the free angle, deg; linkages exist strictly inside it.
    """

    linkage: AbstractLinkage
    free_angle_deg: Real
    transmission_angle_deg: Real
    range_deg: tuple[float, float]


@record(eq=False, kw_only=True)
class AbstractMember(Found):
    """A linkage chosen from a family, with its simulated motion.

    Parameters
    ----------
    free_angle_deg : float
        Position of the linkage in its family.
    largest_ratio : float
        Limit of the search for the ratio of the longest link to the shortest.
    at_largest_ratio : bool
        Whether the best linkage would be better with a larger limit.
    family : Family
        All linkages that solve the same problem.
    """

    # Fields measured by the simulation, in mm unless the name has a unit; summary.json lists them first.
    measured: ClassVar[tuple[str, ...]]

    free_angle_deg: float
    largest_ratio: float
    at_largest_ratio: bool
    family: Family

    def summary(self) -> Mapping[str, object]:
        values = {name: ten_digits(getattr(self, name)) for name in (*self.measured, "free_angle_deg")}
        named = {name if name.endswith("_deg") else f"{name}_mm": value for name, value in values.items()}
        limit = {"largest_ratio": ten_digits(self.largest_ratio), "at_largest_ratio": self.at_largest_ratio}
        return {**named, **super().summary(), **limit}


def member_angles(low: float, high: float) -> Real:
    """Free angles of the listed members, rad, between two ends."""
    return np.linspace(low, high, MEMBERS + 2)[1:-1]


def maximise(f: Callable[[Real], Real], low: float, high: float) -> float:
    """Position of the maximum of a vectorised function between two ends, to nine digits if the maximum is smooth."""
    angles, width = np.linspace(low, high, LOOKS), np.inf
    while True:
        top = int(np.argmax(f(angles)))
        best = float(angles[top])
        ends = angles[max(top - 1, 0)], angles[min(top + 1, len(angles) - 1)]
        if ends[1] - ends[0] >= width:
            break
        width = ends[1] - ends[0]
        angles = np.unique(np.append(np.linspace(*ends, 17), best))
    round_top = to_digits(_smooth_maximum(f, best, STEP * (high - low)))
    values = f(np.array([best, round_top]))
    return round_top if low <= round_top <= high and values[1] >= values[0] - ROUNDING else best


def _smooth_maximum(f: Callable[[Real], Real], best: float, step: float) -> float:
    """Maximum of a smooth function by Newton steps on its slope; values alone give only half of the digits."""
    for _ in range(3):
        values = f(best + step * np.arange(-2, 3))
        if not np.abs(values).max() < LARGEST:
            break
        slope, second_derivative = (
            float(np.dot(weights, values)) for weights in ([1, -8, 0, 8, -1], [-1, 16, -30, 16, -1])
        )
        if not abs(slope) < -second_derivative:
            break
        best -= step * slope / second_derivative
    return best


def given_choice(given: Mapping[str, float | None]) -> tuple[str, float] | None:
    """Name and value of the only argument that is given, or None; DesignError if several are given."""
    chosen = {name: value for name, value in given.items() if value is not None}
    if len(chosen) > 1:
        first, second, *_ = chosen
        raise DesignError(
            second, f"is given together with {first}", "give only one of them; the others follow from it", "conflict"
        )
    return next(iter(chosen.items()), None)


def turn_of(crank_turn_deg: float | None, time_ratio: float | None) -> float:
    """Crank rotation of a stroke, deg, given directly or as a time ratio; 180 by default."""
    if time_ratio is None:
        return 180.0 if crank_turn_deg is None else crank_turn_deg
    if crank_turn_deg is not None:
        raise DesignError("time_ratio", "is given together with crank_turn_deg", "give only one of them", "conflict")
    return 360 * time_ratio / (1 + time_ratio)


def scale_for_link(sizes: Mapping[str, float], name: str, length: float) -> float:
    """Factor that makes the link `name` as long as given; DesignError if another link becomes too long or too short."""
    scale = length / sizes[name]
    longest, shortest = max(sizes.values()), min(sizes.values())
    if longest * scale > FARTHEST:
        most = FARTHEST * sizes[name] / longest
        problem = f"found {mm(length):g}, which makes a link of {mm(longest * scale):g}"
        raise DesignError(name, problem, f"give {mm(most):down}", "out-of-range", rounded_down(most))
    if shortest * scale < SMALLEST:
        least = SMALLEST * sizes[name] / shortest
        found = f"found {mm(length):g}, which makes a link of {mm(shortest * scale):g}"
        raise DesignError(name, found, f"give at least {mm(least):up}", "out-of-range")
    return scale


def within_size_limits(*sizes: Real) -> Mask:
    """Mask of the members whose sizes are all within the limits of a linkage."""
    fit: Mask = np.all([(size <= FARTHEST) & (size >= SMALLEST) for size in sizes], axis=0)
    return fit


def four_bars(sizes: Mapping[str, Real]) -> FourBar:
    """Many four-bars as one, whose lengths are arrays."""
    ground, crank, coupler, rocker = (np.asarray(sizes[name], dtype=np.float64) for name in LINKS)
    return FourBar(ground, crank, coupler, rocker)


# Two dead centres closer than this, rad, are the same one, found on both sides of angle 0. The search steps by a
# quarter of a degree, so distinct ones are farther apart.
SAME_ANGLE = 1e-6
# Frames of the full turn besides the dead centres; they also show whether the linkage closes everywhere.
FRAMES = 361


@record(eq=False, kw_only=True)
class FullTurn:
    """Motion of a rocker or slider over one counterclockwise turn of the crank.

    All fields are nan if the linkage does not close everywhere or the output does not reverse exactly twice.

    Parameters
    ----------
    extent : float
        Travel of the output in one direction, rad or mm.
    start : float
        Crank angle, 0 to 2 pi, at which the output starts to move counterclockwise or towards +x, rad.
    turn : float
        Rotation of the crank from there until the output reverses, rad.
    least : float
        Least transmission angle, rad.
    """

    extent: float
    start: float
    turn: float
    least: float


def full_turn(linkage: FourBar | SliderCrank, branch: int = 1) -> FullTurn:
    """Simulate one turn. Derived here: dead centres are zeros of the output's first kinematic coefficient."""
    output = "rocker" if isinstance(linkage, FourBar) else "slider"
    # Slightly more than one turn, since a dead centre exactly at an end would show no change of sign.
    dead = _distinct_angles(dead_centres(linkage, output, branch, (-0.1, 2 * np.pi + 0.1)))
    frames = np.linspace(0, 2 * np.pi, FRAMES)
    # The transmission angle of a four-bar is least with crank and ground in line, that of a slider-crank with the
    # crank at right angles to the slide line. All these positions are frames.
    motion = move(linkage, frames, branch)
    if len(dead) != 2 or not motion.assembled.all():
        return FullTurn(extent=np.nan, start=np.nan, turn=np.nan, least=np.nan)
    body = move(linkage, dead, branch).bodies[output]
    if output == "rocker":
        at_dead_centres: Real = np.unwrap(np.angle(body.direction))
        displacement = np.unwrap(np.angle(motion.bodies[output].direction))
    else:
        at_dead_centres, displacement = body.origin.position.real, motion.bodies[output].origin.position.real
    turn = float(dead[1] - dead[0])
    start, turn = (
        (float(dead[0]), turn) if at_dead_centres[1] > at_dead_centres[0] else (float(dead[1]), 2 * np.pi - turn)
    )
    extent = max(float(np.ptp(at_dead_centres)), float(np.ptp(displacement)))
    return FullTurn(extent=extent, start=start, turn=turn, least=float(least_transmission_angle(motion)))


def _distinct_angles(angles: Real) -> Real:
    """Distinct angles on the circle, 0 to 2 pi and rising."""
    rising = np.sort(np.mod(angles, 2 * np.pi))
    before = np.roll(rising, 1) - 2 * np.pi * (np.arange(len(rising)) == 0)
    distinct: Real = rising[rising - before > SAME_ANGLE]
    return distinct
