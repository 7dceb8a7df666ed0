"""The formulas of a linkage, and those of its points, as they are worked out over frames."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from functools import reduce
from importlib.util import find_spec
from math import prod
from typing import Any

import numpy as np

from ...core.records import record
from ...plane.vec import Array, Complex, Real, Whole
from ..linkage import Linkage
from .branch import FollowedBranch
from .dyads import Dyad
from .loops import Loops
from .placement import Coefficients, Numbers, Placement, Poses, paired
from .program import NOTHING, Batch, Formulas, Group, Program
from .tape import Recorded, Tape


@record(eq=False)
class Timing:
    """The driver's speed and acceleration: rad/s and rad/s2, or mm/s and mm/s2 where a slider drives."""

    speed: Real
    acceleration: Real

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
    local = tape.start("local", complex, 2 if linkage.is_batch else 0)
    with np.errstate(all="ignore"):
        for one in placements:
            one.place(p0, signs[one.joint] if isinstance(one, Dyad) else 1)
        for one in placements:
            one.first(p0, p1)
        for one in placements:
            one.second(p0, p1, p2)
        reached = [np.isfinite(told) for one in placements if (told := one.reached(p0)) is not None]
        angles = [angle for one in placements if (angle := one.transmission_angle(p0)) is not None]
        directions = {body: p0.turn[body] * linkage.ground_direction for body in linkage.bodies}
        rates = {body: _rates(timing, turn, p2.turn[body]) for body, turn in p1.turn.items()}
        found: dict[Any, dict[str, Any]] = {
            "direction": {**directions, "": reduce(np.logical_and, reached) if reached else np.True_},
            "first": p1.turn,
            "second": p2.turn,
            "omega": {body: omega for body, (omega, _) in rates.items()},
            "alpha": {body: alpha for body, (_, alpha) in rates.items()},
            "angle": {"": reduce(np.fmin, angles) if angles else np.nan},
        }
        origins = {
            body: tuple([p.origin[body] * linkage.ground_direction for p in (p0, p1, p2)]) for body in linkage.bodies
        }
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


@record(eq=False)
class Moved:
    """How bodies move, by their names, as values on a tape: directions, origins, derivatives of both by the drive."""

    linkage: Linkage
    directions: Mapping[str, Any]
    origins: Mapping[str, tuple[Any, ...]]
    first: Mapping[str, Any]
    second: Mapping[str, Any]
    timing: Timing

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


# Steps of a program times frames times linkages from which the compiled loop is done before NumPy: where it is loaded,
# and where it is to be loaded, which takes a second. Fewer, and its start takes longer than it saves; more, and what it
# would save is not saved.
WORTH_LOADED, WORTH_LOADING = 200_000, 1_000_000_000
# Frames of one linkage up to which what was asked for the last time comes with what is asked for first. More, and what
# is not asked for this time takes time and room; fewer, and what several results go on from is worked out for each.
DEFAULT_FORMATS = 16_384
COMPILED = f"{__package__}.compiled"


class LazyEvaluation:
    """What formulas make of given values over frames: each group when it is first asked for.

    Of few frames what was asked for the last time comes with it, since each run of a program takes its time.
    """

    __slots__ = ("_asked", "_done", "_formulas", "_frames", "_known", "_linkages", "_usual", "_values")

    def __init__(
        self, formulas: Formulas, frames: int, linkages: tuple[int, ...], given: Mapping[str, Array], of: str = ""
    ):
        """Given are (frames, linkages), (frames, 1) where alike for all, or a number where alike at every frame.

        of: the body of a point, or none.
        """
        self._formulas, self._frames, self._linkages = formulas, frames, linkages
        self._values = {formulas.tape.given[name]: value for name, value in given.items()}
        self._known = NOTHING
        self._done: tuple[Batch, ...] = ()
        self._usual, self._asked = formulas.start(of)
        if frames > DEFAULT_FORMATS or linkages:
            self._usual = NOTHING

    def at(self, body: str, name: str, value: Array) -> LazyEvaluation:
        """The same of a point of a body, with one more value given, and what is worked out so far."""
        other = LazyEvaluation(self._formulas, self._frames, self._linkages, {name: value}, body)
        other._values |= self._values
        other._done, other._known = self._done, self._known
        return other

    def value(self, group: Group, name: str) -> Array:
        """A result of a group."""
        if group not in self._formulas.groups:
            # Of a point that the linkage names.
            self._formulas.name(*group[1:])
        # Noted when it is on the tape: another motion may ask for it at once.
        self._asked.add(group)
        if group not in self._known:
            batch = self._usual if group in self._usual else self._usual.union((group,))
            if self._known:
                batch -= self._known
            self._known = batch.union(self._known) if self._known else batch
            self._done = (*self._done, batch)
            run(self._formulas.program(self._done), self._values, self._frames, self._linkages)
        result = self._formulas.groups[group][name]
        return self._values[result] if isinstance(result, int) else result


def run(program: Program, values: dict[int, Array], frames: int, linkages: tuple[int, ...]) -> None:
    """Run a program by the engine that is done with it first."""
    work = len(program.calls) * frames * prod(linkages)
    loaded = COMPILED in sys.modules
    if work >= (WORTH_LOADED if loaded else WORTH_LOADING) and find_spec("numba"):
        from . import compiled as compiled

        if compiled.runs(program):
            compiled.run(program, values, frames, linkages)
            return
    program.run(values, frames, linkages)
