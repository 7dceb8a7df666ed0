"""One program for all linkages of one structure: the formulas of their motion, with sizes and drive as inputs.

The placements of the first linkage of a structure are recorded. What is requested of the motion is then written as a
Python function, compiled once, and run for all other linkages of the structure.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import field
from functools import lru_cache, reduce
from math import prod
from typing import Any

import numpy as np

from ...core.records import record
from ...plane.vec import Array, Complex, Real
from ..joints.joint import Joint
from ..linkage import Linkage
from .branch import BranchSpec
from .dyads import Crossed, Dyad, JointLines
from .loops import Loops
from .placement import (
    Coefficients,
    Placement,
    Poses,
    Recording,
    Symbol,
    Timing,
    compensated_sum,
    imag_part,
    paired,
    real_part,
)

# Frames times linkages that go through a program at once. With more, intermediate values leave the processor's cache;
# with fewer, calling the operations takes longer than the operations.
BLOCK = 16_384
# Functions of a program that are kept.
FUNCTIONS = 100
# Structures of which programs are kept, and programs of each for other conditions.
STRUCTURES, CONDITIONS = 256, 8
Planner = Callable[[Linkage], tuple[Placement, ...]]
# Group of results: a quantity of all bodies, or (quantity, body, name) of a named point.
Group = str | tuple[str, str, str]
Groups = frozenset[Group]
Function = Callable[[dict[int, Any]], None]
# Quantities of a point, in the order in which they are computed.
QUANTITIES = "position", "first", "second", "velocity", "acceleration"

NAMES = {name: value for name, value in vars(np).items() if not name.startswith("_")}
NAMES |= {"paired": paired, "compensated_sum": compensated_sum}
# Python text of operations; of all others it is a call.
TEXTS: dict[Any, str] = {
    np.add: "{} + {}",
    np.subtract: "{} - {}",
    np.multiply: "{} * {}",
    np.divide: "{} / {}",
    np.negative: "-{}",
    np.logical_and: "{} & {}",
    np.bitwise_and: "{} & {}",
    np.equal: "{} == {}",
    np.not_equal: "{} != {}",
    np.absolute: "abs({})",
    np.any: "{}.any()",
    np.all: "{}.all()",
    real_part: "{}.real",
    imag_part: "{}.imag",
}


@record(eq=False)
class LinkageProgram:
    """The recording of a structure and its results: groups of symbols or constants by body.

    inputs: numbers of the sizes that vary; times: of drive, speed and acceleration. joints: inner joints of the dyads,
    whose signs can be given; joint_lines: the members between which transmission angles lie. functions: cache, by the
    groups that were computed one after the other, each with the numbers of all values known after it. requested: only
    item, the groups requested of the motion evaluated last; the next motion evaluates them together with the first one
    that is requested.
    """

    recording: Recording
    inputs: tuple[int, ...]
    times: tuple[int, ...]
    groups: Mapping[Group, Mapping[str, Any]]
    joints: tuple[str, ...]
    joint_lines: tuple[JointLines, ...]
    functions: dict[tuple[Groups, ...], tuple[Function, set[int]]] = field(init=False, repr=False, default_factory=dict)
    requested: list[set[Group]] = field(init=False, repr=False, default_factory=lambda: [set()])

    def at(self, sizes: Iterable[Any]) -> dict[int, Any] | None:
        """Values that depend on sizes alone, by number; None if the conditions of the recording do not hold."""
        values = dict(zip(self.inputs, sizes, strict=True))
        self.function(())[0](values)
        for number, truth in self.recording.conditions.items():
            if bool(values[number]) != truth:
                return None
        # NumPy takes twice as long to combine an array with a number as with an array of one number.
        return {number: np.asarray(value) for number, value in values.items()}

    def _results(self, groups: Iterable[Group]) -> set[int]:
        """Numbers of the results of groups; those that are constants have none."""
        return {v.number for group in groups for v in self.groups[group].values() if isinstance(v, Symbol)}

    def function(self, done: tuple[Groups, ...]) -> tuple[Function, set[int]]:
        """What adds the last of these groups to the values left by those before, and the numbers of all values then.

        Without groups, what adds the values of sizes.
        """
        if done not in self.functions:
            if done:
                known = self.function(done[:-1])[1]
                wanted = self._results(done[-1])
                # Kept as well, since what is requested next mostly needs them.
                wanted |= self._results(("direction", "first", "second")) & self._needed(wanted, known)
            else:
                steps = self.recording.steps
                used = {n for step in steps for n in step.of if step.value is None} | self._results(self.groups)
                wanted = {k for k, step in enumerate(steps) if step.value is not None and k in used}
                wanted, known = wanted | self.recording.conditions.keys(), {*self.inputs, *self.times}
            if len(self.functions) > FUNCTIONS:
                self.functions.clear()
            self.functions[done] = self._function(wanted - known, known), known | wanted
        return self.functions[done]

    def _needed(self, wanted: set[int], known: set[int]) -> set[int]:
        """The steps that lead from known values to wanted ones."""
        needed: set[int] = set()
        waiting = list(wanted)
        while waiting:
            number = waiting.pop()
            if number not in needed and number not in known:
                needed.add(number)
                waiting += [n for n in self.recording.steps[number].of if isinstance(n, int)]
        return needed

    def _function(self, wanted: set[int], known: set[int]) -> Function:
        """A Python function that adds wanted values to known ones."""
        steps, needed = self.recording.steps, self._needed(wanted, known)
        order, namespace = sorted(needed), dict(NAMES)
        last = {n: number for number in order for n in steps[number].of if isinstance(n, int)}
        lines = [f"v{n} = values[{n}]" for n in sorted(last) if n not in needed]
        for number in order:
            step = steps[number]
            operands = [f"v{n}" if isinstance(n, int) else n for n in step.of]
            if step.value is None:
                # Constants are arrays of one number as well.
                for k, n in enumerate(step.of):
                    if isinstance(n, str):
                        operands[k] = f"c{number}_{k}"
                        namespace[operands[k]] = np.asarray(eval(n, NAMES))
            text = TEXTS.get(step.operation, f"{step.operation.__name__}({', '.join('{}' for _ in operands)})")
            lines.append(f"v{number} = {text.format(*operands)}")
            done = [
                f"v{n}"
                for n in dict.fromkeys(step.of)
                if isinstance(n, int) and last[n] == number and n in needed - wanted
            ]
            lines += [f"del {', '.join(done)}"] if done else []
        lines += [f"values[{n}] = v{n}" for n in order if n in wanted]
        exec("\n    ".join(["def function(values):", *lines, "return"]), namespace)
        function: Function = namespace["function"]
        return function

    def __reduce__(self) -> tuple[Any, ...]:
        # The functions cannot be pickled.
        return LinkageProgram, (self.recording, self.inputs, self.times, self.groups, self.joints, self.joint_lines)


class ProgramRun:
    """Results of a program for one linkage, or many, over frames; each group is computed on first use."""

    def __init__(self, program: LinkageProgram, values: dict[int, Any], frames: int, linkages: int):
        self.program, self.values, self.frames = program, values, frames
        self._rows = max(1, BLOCK // max(1, linkages))
        self._requested: set[Group] = set()
        self._done: tuple[Groups, ...] = ()
        self._evaluated: Groups = frozenset()

    def value(self, group: Group, body: str) -> Array:
        """A result of a group; one that is the same at all frames is a single number."""
        if group not in self._evaluated:
            self._evaluate(group)
        self._requested.add(group)
        result = self.program.groups[group][body]
        values: Array = self.values[result.number] if isinstance(result, Symbol) else result
        return values

    def _evaluate(self, group: Group) -> None:
        groups = frozenset((group,))
        if not self._done:
            before, self.program.requested[0] = self.program.requested[0], self._requested
            groups = frozenset(before) if group in before else groups
        self._done += (groups,)
        self._evaluated |= groups
        function = self.program.function(self._done)[0]
        with np.errstate(all="ignore"):
            if self.frames <= self._rows:
                function(self.values)
            else:
                self._run_in_blocks(function)

    def _run_in_blocks(self, function: Function) -> None:
        drive = self.values[self.program.times[0]]
        by_frame = [k for k, v in self.values.items() if v.ndim == drive.ndim and len(v) == self.frames]
        results: dict[int, Array] = {}
        for start in range(0, self.frames, self._rows):
            part = slice(start, start + self._rows)
            block = self.values | {k: self.values[k][part] for k in by_frame}
            function(block)
            for k in block.keys() - self.values.keys():
                if block[k].ndim < drive.ndim:
                    results[k] = block[k]
                else:
                    if k not in results:
                        results[k] = np.empty((self.frames, *block[k].shape[1:]), block[k].dtype)
                    results[k][part] = block[k]
        self.values |= results


@lru_cache(STRUCTURES)
def _programs(*_: Hashable) -> list[LinkageProgram | None]:
    """Programs of a structure and a branch, each for other conditions; None if it has none. Filled by `run_of`."""
    return []


def run_of(linkage: Linkage, drive: Real, timing: Timing, spec: BranchSpec, plan: Planner) -> ProgramRun | None:
    """The program of a linkage over drives, (frames,); None if poses need iteration or a branch depends on the drive.

    plan: finds the placements of a linkage.
    """
    if spec.follow or spec.branch_points:
        return None
    key = spec.default, tuple(sorted(spec.branch.items())), timing.steady
    if key not in linkage.programs:
        linkage.programs[key] = _program_of(linkage, timing, spec, plan, key)
    program, sizes = linkage.programs[key]
    if program is None:
        return None
    column = drive.reshape(-1, *(1,) * len(linkage.shape)) if linkage.is_batch else drive
    values = sizes | dict(zip(program.times, (column, timing.speed, timing.acceleration)))
    return ProgramRun(program, values, len(drive), prod(linkage.shape))


def _program_of(
    linkage: Linkage, timing: Timing, spec: BranchSpec, plan: Planner, key: Hashable
) -> tuple[LinkageProgram | None, dict[int, Any]]:
    """The program of the linkage's structure, and the values that depend on its sizes alone."""
    inputs = _inputs(linkage)
    sizes = [value for value, form in inputs if form]
    # Constant sizes are part of the formulas: 0, or a direction of 1.
    programs = _programs(linkage.structure, tuple([form or value for value, form in inputs]), key)
    for program in programs:
        values = program.at(sizes) if program else {}
        if values is not None:
            return program, values
    programs.append(_recorded(linkage, inputs, timing, spec, plan))
    del programs[:-CONDITIONS]
    return _program_of(linkage, timing, spec, plan, key)


def _inputs(linkage: Linkage) -> list[tuple[Any, str]]:
    """Sizes as numbers, each with its type if it is an input, or "" if it is a constant."""
    sizes = [z for points in linkage.bodies.values() for z in points.values()]
    sizes += [getattr(joint, name) for joint in linkage.sized_joints for name in joint.program_sizes]
    return [_input(z) for z in (*sizes, linkage.origin, linkage.ground_direction)]


def _input(z: complex | Array) -> tuple[Any, str]:
    if isinstance(z, np.ndarray) and z.ndim:
        return (z, "complex array") if z.imag.any() else (z.real, "real array")
    z = complex(z)
    if z.imag:
        return np.complex128(z), "complex"
    return (z.real, "") if z.real in (0.0, 1.0) else (np.float64(z.real), "real")


def _recorded(
    linkage: Linkage, inputs: Sequence[tuple[Any, str]], timing: Timing, spec: BranchSpec, plan: Planner
) -> LinkageProgram | None:
    if any(isinstance(placement, Loops) for placement in plan(linkage)):
        return None
    recording = Recording()
    symbols = [recording.input(value, form.startswith("complex")) if form else value for value, form in inputs]
    linkage = _symbolic(linkage, iter(symbols))
    placements, ground = plan(linkage), linkage.ground
    times = [recording.input(None) for _ in range(3)]
    p0 = Poses({ground: np.zeros((), complex)}, {ground: np.ones((), complex)}, times[0])
    p1, p2 = (Coefficients({ground: np.zeros((), complex)}, {ground: np.zeros(())}) for _ in range(2))
    with np.errstate(all="ignore"):
        for placement in placements:
            placement.place(p0, spec.sign(placement.joint) if isinstance(placement, Dyad) else 1)
        for placement in placements:
            placement.first(p0, p1)
        for placement in placements:
            placement.second(p0, p1, p2)
        reached = [np.isfinite(closure) for placement in placements if (closure := placement.reached(p0)) is not None]
        angles = [angle for placement in placements if (angle := placement.transmission_angle(p0)) is not None]
        groups = _groups(linkage, (p0, p1, p2), Timing(times[1], np.zeros(()) if timing.steady else times[2]))
        groups["direction"][""] = reduce(np.logical_and, reached) if reached else np.True_
        groups["angle"] = {"": reduce(np.fmin, angles) if angles else np.asarray(np.nan)}
    joints = tuple(placement.joint for placement in placements if isinstance(placement, Dyad))
    lines = tuple(placement.joint_lines for placement in placements if isinstance(placement, Dyad | Crossed))
    numbers = tuple(symbol.number for symbol in symbols if isinstance(symbol, Symbol))
    return LinkageProgram(recording, numbers, tuple(symbol.number for symbol in times), groups, joints, lines)


def _symbolic(linkage: Linkage, symbols: Iterator[Any]) -> Linkage:
    """The linkage with symbols for its sizes; they are not checked again."""
    bodies = {body: {point: next(symbols) for point in points} for body, points in linkage.bodies.items()}

    def symbolised(joint: Joint) -> Joint:
        return joint.with_sizes({name: next(symbols) for name in joint.program_sizes})

    joints = linkage.with_joints(symbolised)
    symbolic = object.__new__(Linkage)
    symbolic.__dict__.update(bodies=bodies, driver=linkage.driver, estimate={}, **joints)
    symbolic.__dict__.update(shape=linkage.shape, origin=next(symbols), ground_direction=next(symbols))
    return symbolic


def _groups(
    linkage: Linkage, orders: tuple[Poses, Coefficients, Coefficients], timing: Timing
) -> dict[Group, dict[str, Any]]:
    """Results by group and body: directions, origins and their coefficients, rates, and the same of named points."""
    p0, p1, p2 = orders
    directions = {body: _complex(p0.direction[body] * linkage.ground_direction) for body in linkage.bodies}
    groups: dict[Group, dict[str, Any]] = {
        "direction": {**directions},
        "first": {**p1.theta_prime},
        "second": {**p2.theta_prime},
        "omega": {body: timing.rate(first) for body, first in p1.theta_prime.items()},
        "alpha": {body: timing.second_rate(first, p2.theta_prime[body]) for body, first in p1.theta_prime.items()},
    }
    for k, origins in enumerate((p0.origin, p1.origin, p2.origin)):
        shift = linkage.origin if k == 0 else 0.0
        groups[f"origin {k}"] = {b: _complex(z * linkage.ground_direction + shift) for b, z in origins.items()}
    for body, points in linkage.bodies.items():
        origin, origin_1, origin_2 = (groups[f"origin {k}"][body] for k in range(3))
        for name, place in points.items():
            arm = directions[body] * place
            first = first_of(arm, p1.theta_prime[body], origin_1)
            second = second_of(arm, p1.theta_prime[body], p2.theta_prime[body], origin_2)
            rates = timing.rate(first), timing.second_rate(first, second)
            values = zip(QUANTITIES, (arm + origin, first, second, *rates))
            groups |= {(quantity, body, name): {body: _complex(value)} for quantity, value in values}
    return groups


def _complex(z: Any) -> Any:
    """A result as a complex number, though no operation made it one."""
    if isinstance(z, Symbol):
        return z if z.is_complex else z.recording.record(paired, (z, 0.0))
    return np.asarray(z, dtype=complex)


def first_of(arm: Complex, theta_prime: Real, origin: Complex) -> Complex:
    """First coefficient of a point at the end of an arm, from those of the arm's angle and origin."""
    return arm * theta_prime * 1j + origin


def second_of(arm: Complex, theta_prime: Real, theta_second: Real, origin: Complex) -> Complex:
    """Its second coefficient, from both coefficients of the angle and the second one of the origin."""
    return paired(-(theta_prime**2), theta_second) * arm + origin
