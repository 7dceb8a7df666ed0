"""What is on a tape run over frames: no more than is asked for, in blocks that stay in the processor's cache."""

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

# Frames times linkages that go through a program at once. More, and the values between its steps leave the cache next
# to the processor; fewer, and calling the steps takes longer than they do.
BLOCK = 4096

# Frames of one linkage up to which a program keeps a bench; how many benches a thread has, and of how many frames in
# all, each of which takes some 400 bytes. More, and finding the arrays anew is nothing beside their arithmetic; fewer
# in all, and the programs of a motion drive each other out.
SMALL, BENCHES, ROOM = 4096, 16, 16_384

# Operations that take longer than to write their result to memory and to read it back.
DEAR = {np.cos, np.sin}

# Results by what they tell: of all bodies, or as (what, body) or (what, body, name) of a point.
Group = str | tuple[str, ...]
# What is worked out together.
Batch = frozenset[Group]
NOTHING: Batch = frozenset()
# A result: its number on the tape, or the constant that it is.
Result = int | Array
# The kind of a value by its letter, and its extent.
ArgumentType = tuple[str, int]
LETTERS = {float: "d", complex: "D", bool: "?"}


class Points(Protocol):
    """What tells of points that have names."""

    def named(self, body: str, name: str) -> Mapping[str, Any]:
        """What is known of a body's point, as values on the tape."""


@record(eq=False)
class Formulas:
    """A tape with names for its results, in groups, and programs for batches of these.

    points: what tells of named points, of which the tape takes those that are asked for. asked: which groups were asked
    for last, of the linkage with its named points, and of any other point of each body; usual: the same as a batch.
    """

    tape: Tape
    groups: dict[Group, Mapping[str, Result]]
    points: Points
    programs: dict[tuple[Batch, ...], Program] = field(default_factory=dict)
    asked: dict[str, set[Group]] = field(default_factory=dict)
    usual: dict[str, Batch] = field(default_factory=dict)

    def start(self, of: str) -> tuple[Batch, set[Group]]:
        """What was asked for the last time, and where what is asked for from now on is noted."""
        before, usual = self.asked.get(of, NOTHING), self.usual.get(of, NOTHING)
        if before != usual:
            # Else it stays the same thing, which is found among the programs in a tenth of the time of an equal one.
            usual = self.usual[of] = frozenset(before)
        self.asked[of] = now = set[Group]()
        return usual, now

    def name(self, body: str, name: str) -> None:
        """Put what is told of a named point on the tape, by groups (what, body, name)."""
        with _recording:
            told = self.points.named(body, name).items()
            self.groups.update({(what, body, name): {body: self.tape.result(value)} for what, value in told})

    def program(self, done: tuple[Batch, ...]) -> Program:
        """That of the last of these batches, after all others, which goes on from what they keep."""
        if done not in self.programs:
            before: set[int] = set()
            for k in range(1, len(done)):
                before.update(self.program(done[:k]).kept)
            own = self._leading(done[-1], before)
            # Of what was worked out on the way, what is dear and what points go on from is kept as well, and no points.
            wanted = {one for one in own if self.tape.steps[one].operation in DEAR}
            # A copy: of a list of pairs, another thread may add one half way.
            for name, group in self.groups.copy().items():
                if isinstance(name, str) or name in done[-1]:
                    wanted.update(one for one in group.values() if isinstance(one, int))
            self.programs[done] = Program.of(self.tape, sorted(own), own & wanted)
        return self.programs[done]

    def _leading(self, batch: Batch, before: set[int]) -> set[int]:
        """The steps that lead to some groups from what was made before."""
        known = before.union(self.tape.constants, self.tape.given.values())
        found: set[int] = set()
        waiting = [one for group in batch for one in self.groups[group].values() if isinstance(one, int)]
        while waiting:
            number = waiting.pop()
            if number not in found and number not in known:
                found.add(number)
                waiting += self.tape.steps[number].of
        return found


@record(eq=False)
class Program:
    """Some steps of a tape with a place for everything: constants, what is given, what is kept, what is written over.

    Last come the views, each by what it is of. fixed, given, kept: by number, fixed the constants; sorts: how many
    arrays of each; calls: the steps with the places of their arguments; prepared: what an engine made of it.
    """

    tape: Tape
    steps: list[int]
    fixed: list[int]
    given: list[int]
    kept: list[int]
    kept_sorts: list[tuple[ArgumentType, int]]
    made_sorts: list[tuple[ArgumentType, int]]
    views: list[tuple[int, Operation]]
    calls: list[tuple[Operation, Any]]
    prepared: dict[Any, Any] = field(default_factory=dict)

    @classmethod
    def of(cls, tape: Tape, steps: list[int], keeping: set[int]) -> Program:
        """The program of these steps that keeps some of the values."""
        own, on = set(steps), tape.steps
        used = {base(tape, one) for number in steps for one in on[number].of}
        constants = sorted(used & tape.constants.keys())
        given = sorted(used - own - tape.constants.keys())
        kept = sorted((n for n in keeping if on[n].operation not in VIEWS), key=lambda number: _sort(on[number]))
        place = {number: k for k, number in enumerate([*constants, *given, *kept])}
        arrays, holding = shared(tape, steps, place)
        # In the order in which they are made, one sort after the other.
        order = sorted(range(len(arrays)), key=arrays.__getitem__)
        first = len(place)
        place |= {number: first + order.index(array) for number, array in holding.items()}
        first += len(arrays)
        views: list[tuple[int, Operation]] = []

        def found(number: int) -> int:
            if on[number].operation not in VIEWS:
                return place[number]
            view = found(on[number].of[0]), on[number].operation
            if view not in views:
                views.append(view)
            return first + views.index(view)

        made = [n for n in steps if on[n].operation not in VIEWS]
        calls = [(on[n].operation, itemgetter(*map(found, on[n].of), place[n])) for n in made]
        kept_sorts, made_sorts = (
            [(sort, sorts.count(sort)) for sort in sorted(set(sorts))]
            for sorts in ([_sort(on[n]) for n in kept], arrays)
        )
        return cls(tape, steps, constants, given, kept, kept_sorts, made_sorts, views, calls)

    @property
    def made(self) -> list[int]:
        """The steps that are no views."""
        return [number for number in self.steps if self.tape.steps[number].operation not in VIEWS]

    def run(self, values: dict[int, Array], frames: int, linkages: tuple[int, ...]) -> None:
        """Add what is kept to the values, (frames,) or (frames, linkages), (frames, 1) where it is alike for all."""
        if frames <= min(SMALL, BLOCK) and not linkages:
            # Taken away while it is run, and put back as the youngest.
            bench = _own.benches.pop((self, frames), None)
            if bench is None:
                bench = Workspace(self, frames)
                _own.make_room(frames)
            bench.run(values)
            _own.benches[self, frames] = bench
            return
        constants = [self.tape.constants[number] for number in self.fixed]
        full = _arrays(self.kept_sorts, frames, linkages)
        values.update(zip(self.kept, full))
        full = [*[values[number] for number in self.given], *full]
        rows = max(1, min(frames, BLOCK // max(1, prod(linkages))))
        made = _arrays(self.made_sorts, rows, linkages)
        with np.errstate(all="ignore"):
            for start in range(0, frames, rows):
                end = min(frames, start + rows)
                if end - start == frames:
                    places = [*constants, *full, *made]
                else:
                    # What is alike at every frame is one number, or a row of one.
                    parts = [array[start:end] if array.ndim and len(array) == frames else array for array in full]
                    places = [*constants, *parts, *(made if end - start == rows else [a[: end - start] for a in made])]
                for place, part in self.views:
                    places.append(part(places[place]))
                for operation, arguments in self.calls:
                    operation(*arguments(places))


class Workspace:
    """A program with arrays for all that it works with, which its operations are told once and not at every run."""

    def __init__(self, program: Program, frames: int):
        on = program.tape.steps
        given = [_rooms(_sort(on[number]), 1, frames)[1][0] for number in program.given]
        self._given = list(zip(program.given, given))
        self._kept, own, first = [], list[Array](), 0
        for sort, count in program.kept_sorts:
            block, rows = _rooms(sort, count, frames)
            self._kept.append((program.kept[first : first + count], block))
            own, first = [*own, *rows], first + count
        constants = [program.tape.constants[number] for number in program.fixed]
        made = [row for sort, count in program.made_sorts for row in _rooms(sort, count, frames)[1]]
        places = [*constants, *given, *own, *made]
        for place, part in program.views:
            places.append(part(places[place]))
        self._calls = [(operation, arguments(places)) for operation, arguments in program.calls]
        # In which NumPy does not warn: to enter it takes a thirtieth of the time of a new errstate.
        self._quiet = Context()
        self._quiet.run(np.seterr, all="ignore")

    def run(self, values: dict[int, Array]) -> None:
        """Add what is kept to the values, as arrays of their own."""
        for number, array in self._given:
            array[...] = values[number]
        self._quiet.run(self._call)
        for numbers, block in self._kept:
            values.update(zip(numbers, block.copy()))

    def _call(self) -> None:
        for operation, arguments in self._calls:
            operation(*arguments)


def _rooms(sort: ArgumentType, count: int, frames: int) -> tuple[Array, list[Array]]:
    """A block of so many values over frames, and each of them; what is alike at every frame as an array of no axis.

    With such a one an operation takes half the time that it takes with a row of one.
    """
    letter, extent = sort
    block = np.empty((count, frames if extent else 1), letter)
    return block, [row if extent else row.reshape(()) for row in block]


class _Own(threading.local):
    """The benches of a thread, the oldest first."""

    def __init__(self) -> None:
        self.benches: dict[tuple[Program, int], Workspace] = {}

    def make_room(self, frames: int) -> None:
        """For another bench of so many frames."""
        while self.benches and (len(self.benches) >= BENCHES or frames + sum(each for _, each in self.benches) > ROOM):
            del self.benches[next(iter(self.benches))]


_own = _Own()
# Two threads that put steps on a tape at once would give them the same numbers.
_recording = threading.Lock()


def shared(tape: Tape, steps: list[int], place: Mapping[int, int]) -> tuple[list[ArgumentType], dict[int, int]]:
    """Arrays that are written over and over by what has no place, by sort, and which of them holds each value."""
    last = {base(tape, one): number for number in steps for one in tape.steps[number].of}
    arrays: list[ArgumentType] = []
    free: dict[ArgumentType, list[int]] = {}
    holding: dict[int, int] = {}
    held: list[int] = []
    for number in steps:
        if number in place or tape.steps[number].operation in VIEWS:
            continue
        for done in [one for one in held if last.get(one, one) < number]:
            held.remove(done)
            free.setdefault(_sort(tape.steps[done]), []).append(holding[done])
        sort = _sort(tape.steps[number])
        if not free.get(sort):
            free[sort] = [len(arrays)]
            arrays.append(sort)
        holding[number] = free[sort].pop()
        held.append(number)
    return arrays, holding


def base(tape: Tape, number: int) -> int:
    """What a view is of; otherwise the value itself."""
    while tape.steps[number].operation in VIEWS:
        number = tape.steps[number].of[0]
    return number


def _sort(step: Step) -> ArgumentType:
    return LETTERS[step.kind], step.extent


def _arrays(sorts: list[tuple[ArgumentType, int]], rows: int, linkages: tuple[int, ...]) -> list[Array]:
    """So many arrays of each sort."""
    found: list[Array] = []
    for (letter, extent), count in sorts:
        columns = linkages if extent == 2 else (1,) * len(linkages)
        found.extend(np.empty((count, rows if extent else 1, *columns), letter))
    return found
