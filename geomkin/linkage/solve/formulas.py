"""The formulas of a linkage and of its points, and their evaluation over frames."""

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
from .program import NOTHING, Batch, Formulas, Group, TapeProgram
from .tape import Recorded, Tape


@record(eq=False)
class Timing:
    """Speed and acceleration of the driver: rad/s and rad/s2, or mm/s and mm/s2 if a slider drives.

    Parameters
    ----------
    speed, acceleration : array
        One number, or one value for each frame.
    """

    speed: Real
    acceleration: Real

    def elapsed(self, drive: Real) -> Real:
        """Time since the first drive, s, (frames,); nan if the speed is 0 or changes."""
        constant = not self.speed.ndim and self.speed != 0 and not np.any(self.acceleration)
        # + 0.0 turns the -0.0 of a clockwise driver into 0.0.
        return (drive - drive[:1]) / (self.speed if constant else np.nan) + 0.0

    @property
    def steady(self) -> bool:
        """Whether the speed is one constant number."""
        return not self.acceleration.ndim and not self.acceleration.item()

    def rate(self, first: Numbers) -> Numbers:
        """d/dt of a quantity, from its first kinematic coefficient."""
        with np.errstate(invalid="ignore"):
            return first * self.speed

    def second_rate(self, first: Numbers, second: Numbers) -> Numbers:
        """d2/dt2 of a quantity, from its first and second kinematic coefficients."""
        with np.errstate(invalid="ignore", over="ignore"):
            rate = second * self.speed**2
            return rate if self.steady else rate + first * self.acceleration

    @property
    def given(self) -> dict[str, Array]:
        """Speed and acceleration by the names of the formulas' inputs."""
        return {"speed": self.speed, "acceleration": self.acceleration}


def first_of(arm: Complex, theta_prime: Real, origin: Complex) -> Complex:
    """First coefficient of a point at the end of an arm, from those of the arm's angle and origin."""
    return arm * theta_prime * 1j + origin


def second_of(arm: Complex, theta_prime: Real, theta_second: Real, origin: Complex) -> Complex:
    """Its second coefficient, from both coefficients of the angle and the second one of the origin."""
    return paired(-(theta_prime**2), theta_second) * arm + origin


def is_recordable(placements: Sequence[Placement], signs: Mapping[str, Whole | int | FollowedBranch]) -> bool:
    """Whether formulas cover everything: nothing iterates, and no branch depends on the drive."""
    iterates = any(isinstance(placement, Loops) for placement in placements)
    return not iterates and not any(isinstance(sign, FollowedBranch) for sign in signs.values())


def linkage_formulas(
    linkage: Linkage, placements: Sequence[Placement], signs: Mapping[str, Any], timing: Timing
) -> Formulas:
    """Record the formulas of placements on these branches; `timing` only says which of its numbers are constant.

    Groups of results: "direction" of all bodies, and whether they are assembled; "first" and "second" coefficients of
    their angles, "omega" and "alpha"; "angle", the transmission angle; (quantity, body) for a point of a body, with the
    quantities of `PointMotion`, and (quantity, body, name) for a named point. Inputs are the drive, speed, acceleration
    and, for a point without a name, its position `local`.
    """
    tape, ground = Tape(), linkage.ground
    p0 = Poses({ground: np.zeros((), complex)}, {ground: np.ones((), complex)}, tape.start("drive"))
    p1, p2 = (Coefficients({ground: np.zeros((), complex)}, {ground: np.zeros(())}) for _ in range(2))
    times = tape.start("speed", float, int(timing.speed.ndim > 0)), tape.start("acceleration")
    timing = Timing(times[0], np.zeros(()) if timing.steady else times[1])
    local = tape.start("local", complex, 2 if linkage.is_batch else 0)
    with np.errstate(all="ignore"):
        for placement in placements:
            placement.place(p0, signs[placement.joint] if isinstance(placement, Dyad) else 1)
        for placement in placements:
            placement.first(p0, p1)
        for placement in placements:
            placement.second(p0, p1, p2)
        reached = [np.isfinite(closure) for placement in placements if (closure := placement.reached(p0)) is not None]
        angles = [angle for placement in placements if (angle := placement.transmission_angle(p0)) is not None]
        directions = {body: p0.direction[body] * linkage.ground_direction for body in linkage.bodies}
        rates = {body: _rates(timing, turn, p2.theta_prime[body]) for body, turn in p1.theta_prime.items()}
        tables: dict[Any, dict[str, Any]] = {
            "direction": {**directions, "": reduce(np.logical_and, reached) if reached else np.True_},
            "first": p1.theta_prime,
            "second": p2.theta_prime,
            "omega": {body: omega for body, (omega, _) in rates.items()},
            "alpha": {body: alpha for body, (_, alpha) in rates.items()},
            "angle": {"": reduce(np.fmin, angles) if angles else np.nan},
        }
        origins = {
            body: tuple([p.origin[body] * linkage.ground_direction for p in (p0, p1, p2)]) for body in linkage.bodies
        }
    moved = BodyFormulas(linkage, directions, origins, p1.theta_prime, p2.theta_prime, timing)
    groups: dict[Any, Mapping[str, Any]] = {
        group: {k: tape.result(v) for k, v in table.items()} for group, table in tables.items()
    }
    for body in linkage.bodies:
        groups |= {(what, body): {body: tape.result(value)} for what, value in moved.point(body, local).items()}
    return Formulas(tape, groups, moved)


def _rates(timing: Timing, first: Any, second: Any) -> tuple[Any, Any]:
    """omega and alpha of a body from its coefficients; a constant zero is not recorded."""
    no_first, no_second = (not isinstance(value, Recorded) and not np.any(value) for value in (first, second))
    no_alpha = no_second and (timing.steady or no_first)
    return first if no_first else timing.rate(first), second if no_alpha else timing.second_rate(first, second)


@record(eq=False)
class BodyFormulas:
    """Directions and origins of bodies by name, and their derivatives by the drive, as values on a tape."""

    linkage: Linkage
    directions: Mapping[str, Any]
    origins: Mapping[str, tuple[Any, ...]]
    first: Mapping[str, Any]
    second: Mapping[str, Any]
    timing: Timing

    def named(self, body: str, name: str) -> dict[str, Any]:
        """All quantities of a `PointMotion`, for a point that the linkage names."""
        place = self.linkage.bodies[body][name]
        return self.point(body, np.asarray(place, dtype=complex))

    def point(self, body: str, local: Any) -> dict[str, Any]:
        """The same for any point of a body."""
        linkage, theta_prime, theta_second = self.linkage, self.first[body], self.second[body]
        with np.errstate(all="ignore"):
            arm, (origin, origin_1, origin_2) = self.directions[body] * local, self.origins[body]
            first, second = first_of(arm, theta_prime, origin_1), second_of(arm, theta_prime, theta_second, origin_2)
            return {
                "position": arm + (origin + linkage.origin if linkage.shifted else origin),
                "first": first,
                "second": second,
                "velocity": self.timing.rate(first),
                "acceleration": self.timing.second_rate(first, second),
            }


# Steps of a program times frames times linkages from which the compiled loop is faster than NumPy: if it is loaded,
# and if it must be loaded first, which takes a second.
WORTH_LOADED, WORTH_LOADING = 200_000, 1_000_000_000
# Frames of one linkage up to which the groups that were requested last time are evaluated together with the first one.
# With more frames, groups that are not requested this time cost time and memory.
PREFETCH_FRAMES = 16_384
COMPILED = f"{__package__}.compiled"


class LazyEvaluation:
    """Results of formulas for given inputs over frames; each group is evaluated on first use.

    With few frames the groups that were requested last time are evaluated at once, since each run of a program has a
    fixed cost.
    """

    __slots__ = ("_done", "_formulas", "_frames", "_known", "_linkages", "_previous", "_requested", "_values")

    def __init__(
        self, formulas: Formulas, frames: int, linkages: tuple[int, ...], given: Mapping[str, Array], of: str = ""
    ):
        """Inputs are (frames, linkages), (frames, 1) if equal for all linkages, or a number if constant.

        of: the body of an unnamed point; empty for the linkage.
        """
        self._formulas, self._frames, self._linkages = formulas, frames, linkages
        self._values = {formulas.tape.given[name]: value for name, value in given.items()}
        self._known = NOTHING
        self._done: tuple[Batch, ...] = ()
        self._previous, self._requested = formulas.start(of)
        if frames > PREFETCH_FRAMES or linkages:
            self._previous = NOTHING

    def at(self, body: str, name: str, value: Array) -> LazyEvaluation:
        """The same for a point of a body: one more input, and the results so far are shared."""
        other = LazyEvaluation(self._formulas, self._frames, self._linkages, {name: value}, body)
        other._values |= self._values
        other._done, other._known = self._done, self._known
        return other

    def value(self, group: Group, name: str) -> Array:
        """A result of a group."""
        if group not in self._formulas.groups:
            # The group is of a named point, which is recorded on first use.
            self._formulas.name(*group[1:])
        # Noted only once it is on the tape, since another motion may request it at once.
        self._requested.add(group)
        if group not in self._known:
            batch = self._previous if group in self._previous else self._previous.union((group,))
            if self._known:
                batch -= self._known
            self._known = batch.union(self._known) if self._known else batch
            self._done = (*self._done, batch)
            run(self._formulas.program(self._done), self._values, self._frames, self._linkages)
        result = self._formulas.groups[group][name]
        return self._values[result] if isinstance(result, int) else result


def run(program: TapeProgram, values: dict[int, Array], frames: int, linkages: tuple[int, ...]) -> None:
    """Run a program by NumPy or by the compiled loop, whichever is faster."""
    work = len(program.calls) * frames * prod(linkages)
    loaded = COMPILED in sys.modules
    if work >= (WORTH_LOADED if loaded else WORTH_LOADING) and find_spec("numba"):
        from . import compiled as compiled

        if compiled.runs(program):
            compiled.run(program, values, frames, linkages)
            return
    program.run(values, frames, linkages)
