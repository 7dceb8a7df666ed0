"""The formulas of a linkage, and those of its points, as they are worked out over frames."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from typing import Any

import numpy as np

from ...brief import one_line
from ...plane.vec import Array, Complex, Real, Whole
from ..linkage import Linkage
from .branch import FollowedBranch
from .dyads import Dyad
from .loops import Loops
from .placement import Coefficients, Numbers, Placement, Poses, paired
from .program import Formulas
from .tape import Recorded, Tape


@dataclass(frozen=True, eq=False)
class Timing:
    """The driver's speed and acceleration: rad/s and rad/s2, or mm/s and mm/s2 where a slider drives."""

    speed: Real
    acceleration: Real

    __repr__ = one_line

    def elapsed(self, drive: Real) -> Real:
        """Time since the first of the drives, s, (frames,); nan where the speed is 0 or changes."""
        constant = not self.speed.ndim and self.speed != 0 and not np.any(self.acceleration)
        # A zero less the minus that a clockwise driver would give it.
        return (drive - drive[:1]) / (self.speed if constant else np.nan) + 0.0

    @property
    def steady(self) -> bool:
        """Whether the speed is one number that stays."""
        return not self.acceleration.ndim and not self.acceleration.item()

    def rate(self, first: Numbers) -> Numbers:
        """d/dt of what has the first kinematic coefficient `first`."""
        with np.errstate(invalid="ignore"):
            return first * self.speed

    def gain(self, first: Numbers, second: Numbers) -> Numbers:
        """d2/dt2 of what has these first and second kinematic coefficients."""
        with np.errstate(invalid="ignore", over="ignore"):
            gain = second * self.speed**2
            return gain if self.steady else gain + first * self.acceleration

    @property
    def given(self) -> dict[str, Array]:
        """By the names that formulas start from."""
        return {"speed": self.speed, "acceleration": self.acceleration}


def first_of(arm: Complex, turn: Real, origin: Complex) -> Complex:
    """First coefficient of a point at the end of an arm, by that of the arm's angle and that of its origin."""
    return arm * turn * 1j + origin


def second_of(arm: Complex, turn: Real, turn_2: Real, origin_2: Complex) -> Complex:
    """Its second coefficient, by both of the angle and the second one of the origin."""
    return paired(-(turn**2), turn_2) * arm + origin_2


def tell_all(placements: Sequence[Placement], signs: Mapping[str, Whole | int | FollowedBranch]) -> bool:
    """Whether formulas tell all: nothing iterates, and no branch hangs on the drive."""
    iterates = any(isinstance(one, Loops) for one in placements)
    return not iterates and not any(isinstance(sign, FollowedBranch) for sign in signs.values())


def linkage_formulas(
    linkage: Linkage, placements: Sequence[Placement], signs: Mapping[str, Any], timing: Timing
) -> Formulas:
    """Of placements on these branches, where formulas tell all; timing tells no more than which of its numbers stay.

    By group: "direction" of all bodies and whether they are "closed"; "first" and "second" coefficients of their
    angles, "omega" and "alpha"; "angle", of transmission; and (what, body) for a point of a body, `what` as of a
    `PointMotion`, (what, body, name) for one that the linkage names. They start from the drive, speed, acceleration
    and, of a point without a name, its place `local`.
    """
    tape, ground = Tape(), linkage.ground
    p0 = Poses({ground: np.zeros((), complex)}, {ground: np.ones((), complex)}, tape.start("drive"))
    p1, p2 = (Coefficients({ground: np.zeros((), complex)}, {ground: np.zeros(())}) for _ in range(2))
    times = tape.start("speed", float, int(timing.speed.ndim > 0)), tape.start("acceleration")
    timing = Timing(times[0], np.zeros(()) if timing.steady else times[1])
    local = tape.start("local", complex, 2 if linkage.many else 0)
    with np.errstate(all="ignore"):
        for one in placements:
            one.place(p0, signs[one.joint] if isinstance(one, Dyad) else 1)
        for one in placements:
            one.first(p0, p1)
        for one in placements:
            one.second(p0, p1, p2)
        reached = [np.isfinite(told) for one in placements if (told := one.reached(p0)) is not None]
        angles = [angle for one in placements if (angle := one.transmission_angle(p0)) is not None]
        directions = {body: p0.turn[body] * linkage.ahead for body in linkage.bodies}
        rates = {body: _rates(timing, turn, p2.turn[body]) for body, turn in p1.turn.items()}
        found: dict[Any, dict[str, Any]] = {
            "direction": {**directions, "": reduce(np.logical_and, reached) if reached else np.True_},
            "first": p1.turn,
            "second": p2.turn,
            "omega": {body: omega for body, (omega, _) in rates.items()},
            "alpha": {body: alpha for body, (_, alpha) in rates.items()},
            "angle": {"": reduce(np.fmin, angles) if angles else np.nan},
        }
        origins = {body: tuple([p.origin[body] * linkage.ahead for p in (p0, p1, p2)]) for body in linkage.bodies}
    moved = Moved(linkage, directions, origins, p1.turn, p2.turn, timing)
    groups: dict[Any, Mapping[str, Any]] = {
        group: {k: tape.result(v) for k, v in table.items()} for group, table in found.items()
    }
    for body in linkage.bodies:
        groups |= {(what, body): {body: tape.result(value)} for what, value in moved.point(body, local).items()}
    return Formulas(tape, groups, moved)


def _rates(timing: Timing, turn: Any, turn_2: Any) -> tuple[Any, Any]:
    """omega and alpha of a body by its coefficients; what is zero whatever the drive is not worked out."""
    none, none_2 = (not isinstance(one, Recorded) and not np.any(one) for one in (turn, turn_2))
    even = none_2 and (timing.steady or none)
    return turn if none else timing.rate(turn), turn_2 if even else timing.gain(turn, turn_2)


@dataclass(frozen=True, eq=False)
class Moved:
    """How bodies move, by their names, as values on a tape: directions, origins, derivatives of both by the drive."""

    linkage: Linkage
    directions: Mapping[str, Any]
    origins: Mapping[str, tuple[Any, ...]]
    first: Mapping[str, Any]
    second: Mapping[str, Any]
    timing: Timing

    __repr__ = one_line

    def named(self, body: str, name: str) -> dict[str, Any]:
        """Of a point that the linkage names, all that a `PointMotion` tells of it."""
        place = self.linkage.bodies[body][name]
        return self.point(body, np.asarray(place, dtype=complex))

    def point(self, body: str, local: Any) -> dict[str, Any]:
        """The same of a body's point at a place of its own."""
        linkage, turn, turn_2 = self.linkage, self.first[body], self.second[body]
        with np.errstate(all="ignore"):
            arm, (origin, origin_1, origin_2) = self.directions[body] * local, self.origins[body]
            first, second = first_of(arm, turn, origin_1), second_of(arm, turn, turn_2, origin_2)
            return {
                "position": arm + (origin + linkage.origin if linkage.shifted else origin),
                "first": first,
                "second": second,
                "velocity": self.timing.rate(first),
                "acceleration": self.timing.gain(first, second),
            }
