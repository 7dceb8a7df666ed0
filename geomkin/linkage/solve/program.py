"""Evaluation of a tape over frames: only the requested results, in blocks that stay in the processor's cache."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from contextvars import Context
from dataclasses import field
from math import prod
from operator import itemgetter
from typing import Any, Protocol

import numpy as np

from ...core.records import record
from ...plane.vec import Array
from .tape import VIEWS, Operation, Step, Tape

# Frames times linkages that go through a program at once. With more, intermediate values leave the processor's cache;
# with fewer, calling the steps takes longer than the steps.
BLOCK = 4096

# Frames of one linkage up to which a program keeps a workspace; number of workspaces of a thread, and their frames
# together, each of which takes about 400 bytes. For more frames allocating arrays is cheap compared with arithmetic.
SMALL, WORKSPACES, ROOM = 4096, 16, 16_384

# Operations that take longer than writing their result to memory and reading it back.
EXPENSIVE = {np.cos, np.sin}

# Group of results: a quantity of all bodies, or (quantity, body) or (quantity, body, name) of a point.
Group = str | tuple[str, ...]
# Groups that are evaluated together.
Batch = frozenset[Group]
NOTHING: Batch = frozenset()
# A result: its number on the tape, or a constant.
Result = int | Array
# Type of an array: its NumPy letter, and its extent as in `Step`.
ArrayType = tuple[str, int]
LETTERS = {float: "d", complex: "D", bool: "?"}


class Points(Protocol):
    """Provides the quantities of named points."""

    def named(self, body: str, name: str) -> Mapping[str, Any]:
        """Quantities of a body's point, as values on the tape."""


@record(eq=False)
class Formulas:
    """A tape with named results, in groups, and programs for batches of these.

    points: adds the quantities of a named point to the tape when they are requested. requested: the groups requested
    last, of the linkage with its named points (key ""), and of other points by body; previous: the same as batches.
    """

    tape: Tape
    groups: dict[Group, Mapping[str, Result]]
    points: Points
    programs: dict[tuple[Batch, ...], TapeProgram] = field(default_factory=dict)
    requested: dict[str, set[Group]] = field(default_factory=dict)
    previous: dict[str, Batch] = field(default_factory=dict)

    def start(self, of: str) -> tuple[Batch, set[Group]]:
        """The groups requested last time, and an empty set in which to note those of this time."""
        before, previous = self.requested.get(of, NOTHING), self.previous.get(of, NOTHING)
        if before != previous:
            # Otherwise the same object is kept, which a dict finds ten times faster than an equal one.
            previous = self.previous[of] = frozenset(before)
        self.requested[of] = now = set[Group]()
        return previous, now

    def name(self, body: str, name: str) -> None:
        """Add the quantities of a named point to the tape, as groups (quantity, body, name)."""
        with _recording:
            values = self.points.named(body, name).items()
            self.groups.update({(quantity, body, name): {body: self.tape.result(value)} for quantity, value in values})

    def program(self, done: tuple[Batch, ...]) -> TapeProgram:
        """The program of the last of these batches, which reuses the values kept by the others."""
        if done not in self.programs:
            before: set[int] = set()
            for k in range(1, len(done)):
                before.update(self.program(done[:k]).kept)
            steps = self._leading(done[-1], before)
            # Expensive intermediate values, and those that later points need, are kept as well.
            keeping = {number for number in steps if self.tape.steps[number].operation in EXPENSIVE}
            # A copy, since another thread may add a group meanwhile.
            for name, group in self.groups.copy().items():
                if isinstance(name, str) or name in done[-1]:
                    keeping.update(number for number in group.values() if isinstance(number, int))
            self.programs[done] = TapeProgram.of(self.tape, sorted(steps), steps & keeping)
        return self.programs[done]

    def _leading(self, batch: Batch, before: set[int]) -> set[int]:
        """The steps needed for some groups, given those of before."""
        known = before.union(self.tape.constants, self.tape.given.values())
        needed: set[int] = set()
        waiting = [result for group in batch for result in self.groups[group].values() if isinstance(result, int)]
        while waiting:
            number = waiting.pop()
            if number not in needed and number not in known:
                needed.add(number)
                waiting += self.tape.steps[number].of
        return needed


@record(eq=False)
class TapeProgram:
    """Some steps of a tape, with a place for each value: constants, inputs, kept results, and temporaries.

    Views come last. fixed, given, kept: numbers on the tape of constants, inputs and kept results; kept_types,
    made_types: how many arrays of each type; calls: the steps with the places of their arguments; prepared: cache of an
    engine.
    """

    tape: Tape
    steps: list[int]
    fixed: list[int]
    given: list[int]
    kept: list[int]
    kept_types: list[tuple[ArrayType, int]]
    made_types: list[tuple[ArrayType, int]]
    views: list[tuple[int, Operation]]
    calls: list[tuple[Operation, Any]]
    prepared: dict[Any, Any] = field(default_factory=dict)

    @classmethod
    def of(cls, tape: Tape, steps: list[int], keeping: set[int]) -> TapeProgram:
        """The program of these steps that keeps some of the values."""
        own_steps, tape_steps = set(steps), tape.steps
        used = {base(tape, argument) for number in steps for argument in tape_steps[number].of}
        constants = sorted(used & tape.constants.keys())
        given = sorted(used - own_steps - tape.constants.keys())
        kept = sorted(
            (n for n in keeping if tape_steps[n].operation not in VIEWS), key=lambda number: _type(tape_steps[number])
        )
        place = {number: k for k, number in enumerate([*constants, *given, *kept])}
        arrays, holding = shared(tape, steps, place)
        # In the order in which they are allocated, one type after the other.
        order = sorted(range(len(arrays)), key=arrays.__getitem__)
        first = len(place)
        place |= {number: first + order.index(array) for number, array in holding.items()}
        first += len(arrays)
        views: list[tuple[int, Operation]] = []

        def place_of(number: int) -> int:
            if tape_steps[number].operation not in VIEWS:
                return place[number]
            view = place_of(tape_steps[number].of[0]), tape_steps[number].operation
            if view not in views:
                views.append(view)
            return first + views.index(view)

        made = [n for n in steps if tape_steps[n].operation not in VIEWS]
        calls = [(tape_steps[n].operation, itemgetter(*map(place_of, tape_steps[n].of), place[n])) for n in made]
        kept_types, made_types = (
            [(array_type, types.count(array_type)) for array_type in sorted(set(types))]
            for types in ([_type(tape_steps[n]) for n in kept], arrays)
        )
        return cls(tape, steps, constants, given, kept, kept_types, made_types, views, calls)

    @property
    def made(self) -> list[int]:
        """The steps that are not views."""
        return [number for number in self.steps if self.tape.steps[number].operation not in VIEWS]

    def run(self, values: dict[int, Array], frames: int, linkages: tuple[int, ...]) -> None:
        """Add the kept results to the values: (frames,) or (frames, linkages); (frames, 1) if equal for all."""
        if frames <= min(SMALL, BLOCK) and not linkages:
            # Removed while it runs, and put back as the newest.
            workspace = _own.workspaces.pop((self, frames), None)
            if workspace is None:
                workspace = ProgramArrays(self, frames)
                _own.make_room(frames)
            workspace.run(values)
            _own.workspaces[self, frames] = workspace
            return
        constants = [self.tape.constants[number] for number in self.fixed]
        full = _arrays(self.kept_types, frames, linkages)
        values.update(zip(self.kept, full))
        full = [*[values[number] for number in self.given], *full]
        rows = max(1, min(frames, BLOCK // max(1, prod(linkages))))
        made = _arrays(self.made_types, rows, linkages)
        with np.errstate(all="ignore"):
            for start in range(0, frames, rows):
                end = min(frames, start + rows)
                if end - start == frames:
                    places = [*constants, *full, *made]
                else:
                    # Values that are equal at all frames are one number, or an array of length one.
                    parts = [array[start:end] if array.ndim and len(array) == frames else array for array in full]
                    places = [*constants, *parts, *(made if end - start == rows else [a[: end - start] for a in made])]
                for place, part in self.views:
                    places.append(part(places[place]))
                for operation, arguments in self.calls:
                    operation(*arguments(places))


class ProgramArrays:
    """Arrays for all values of a program; its operations are bound to them once, not at every run."""

    def __init__(self, program: TapeProgram, frames: int):
        steps = program.tape.steps
        given = [_rooms(_type(steps[number]), 1, frames)[1][0] for number in program.given]
        self._given = list(zip(program.given, given))
        self._kept, arrays, first = [], list[Array](), 0
        for array_type, count in program.kept_types:
            block, rows = _rooms(array_type, count, frames)
            self._kept.append((program.kept[first : first + count], block))
            arrays, first = [*arrays, *rows], first + count
        constants = [program.tape.constants[number] for number in program.fixed]
        made = [row for array_type, count in program.made_types for row in _rooms(array_type, count, frames)[1]]
        places = [*constants, *given, *arrays, *made]
        for place, part in program.views:
            places.append(part(places[place]))
        self._calls = [(operation, arguments(places)) for operation, arguments in program.calls]
        # A context without NumPy's warnings, thirty times faster to enter than a new errstate.
        self._quiet = Context()
        self._quiet.run(np.seterr, all="ignore")

    def run(self, values: dict[int, Array]) -> None:
        """Add the kept results to the values, as new arrays."""
        for number, array in self._given:
            array[...] = values[number]
        self._quiet.run(self._call)
        for numbers, block in self._kept:
            values.update(zip(numbers, block.copy()))

    def _call(self) -> None:
        for operation, arguments in self._calls:
            operation(*arguments)


def _rooms(array_type: ArrayType, count: int, frames: int) -> tuple[Array, list[Array]]:
    """A block of `count` arrays over frames, and each of them; a value that is equal at all frames has no axis.

    An operation on an array without axes takes half the time of one with a single element.
    """
    letter, extent = array_type
    block = np.empty((count, frames if extent else 1), letter)
    return block, [row if extent else row.reshape(()) for row in block]


class _Own(threading.local):
    """The workspaces of a thread, the oldest first."""

    def __init__(self) -> None:
        self.workspaces: dict[tuple[TapeProgram, int], ProgramArrays] = {}

    def make_room(self, frames: int) -> None:
        """Make room for another workspace of so many frames."""
        kept = self.workspaces
        while kept and (len(kept) >= WORKSPACES or frames + sum(each for _, each in kept) > ROOM):
            del kept[next(iter(kept))]


_own = _Own()
# Two threads that add steps to a tape at once would give them the same numbers.
_recording = threading.Lock()


def shared(tape: Tape, steps: list[int], place: Mapping[int, int]) -> tuple[list[ArrayType], dict[int, int]]:
    """Types of the arrays for temporaries, which are reused, and which of them holds each value."""
    last = {base(tape, argument): number for number in steps for argument in tape.steps[number].of}
    arrays: list[ArrayType] = []
    free: dict[ArrayType, list[int]] = {}
    holding: dict[int, int] = {}
    live: list[int] = []
    for number in steps:
        if number in place or tape.steps[number].operation in VIEWS:
            continue
        for done in [argument for argument in live if last.get(argument, argument) < number]:
            live.remove(done)
            free.setdefault(_type(tape.steps[done]), []).append(holding[done])
        array_type = _type(tape.steps[number])
        if not free.get(array_type):
            free[array_type] = [len(arrays)]
            arrays.append(array_type)
        holding[number] = free[array_type].pop()
        live.append(number)
    return arrays, holding


def base(tape: Tape, number: int) -> int:
    """The value that a view belongs to; otherwise the value itself."""
    while tape.steps[number].operation in VIEWS:
        number = tape.steps[number].of[0]
    return number


def _type(step: Step) -> ArrayType:
    return LETTERS[step.kind], step.extent


def _arrays(types: list[tuple[ArrayType, int]], rows: int, linkages: tuple[int, ...]) -> list[Array]:
    arrays: list[Array] = []
    for (letter, extent), count in types:
        columns = linkages if extent == 2 else (1,) * len(linkages)
        arrays.extend(np.empty((count, rows if extent else 1, *columns), letter))
    return arrays
