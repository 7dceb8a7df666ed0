"""What is on a tape run over frames: no more than is asked for, in blocks that stay in the processor's cache."""

from __future__ import annotations

import threading
from collections.abc import Hashable, Mapping
from dataclasses import dataclass, field
from math import prod
from operator import itemgetter
from typing import Any

import numpy as np

from ...brief import one_line
from ...plane.vec import Array
from .tape import VIEWS, Operation, Step, Tape

# Frames times linkages that go through a program at once. More, and the values between its steps leave the cache next
# to the processor; fewer, and calling the steps takes longer than they do.
BLOCK = 4096

# Frames of one linkage up to which a program keeps a bench, and how many benches there are. More frames, and finding
# the arrays anew is nothing beside their arithmetic; fewer benches, and a motion's programs drive each other out.
SMALL, BENCHES = 1024, 16

# Operations that take longer than to write their result to memory and to read it back.
DEAR = {np.cos, np.sin}

# What is worked out together.
Batch = frozenset[Hashable]
# A result: its number on the tape, or the constant that it is.
Result = int | Array
# The kind of a value by its letter, and its extent.
Sort = tuple[str, int]
LETTERS = {float: "d", complex: "D", bool: "?"}


@dataclass(frozen=True, eq=False)
class Formulas:
    """A tape with names for its results, in groups, and programs for batches of these.

    asked: which groups were asked for last, of the linkage and of a point of each body.
    """

    tape: Tape
    groups: Mapping[Hashable, Mapping[str, Result]]
    programs: dict[tuple[Hashable, ...], Program] = field(default_factory=dict)
    asked: dict[str, set[Hashable]] = field(default_factory=dict)

    __repr__ = one_line

    def program(self, done: tuple[Batch, ...], keeping: bool) -> Program:
        """That of the last of these batches, after all others.

        keeping: what other groups go on from as well; otherwise they work it out again, but for what is dear.
        """
        key = keeping, *done
        if key not in self.programs:
            before: set[int] = set()
            for k in range(1, len(done)):
                earlier = self.program(done[:k], keeping)
                before.update(earlier.steps if keeping else earlier.kept)
            own = self._leading(done[-1], before)
            if keeping:
                after = set().union(*(self._leading(frozenset([group]), before | own) for group in self.groups))
                wanted = {base(self.tape, one) for number in after for one in self.tape.steps[number].of}
            else:
                wanted = {one for one in own if self.tape.steps[one].operation in DEAR}
            # Of what was worked out on the way, what points go on from is kept as well, and no points.
            named = [
                group for name, group in self.groups.items() if keeping or isinstance(name, str) or name in done[-1]
            ]
            wanted = wanted.union(one for group in named for one in group.values() if isinstance(one, int))
            self.programs[key] = Program.of(self.tape, sorted(own), own & wanted)
        return self.programs[key]

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


@dataclass(frozen=True, eq=False)
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
    kept_sorts: list[tuple[Sort, int]]
    made_sorts: list[tuple[Sort, int]]
    views: list[tuple[int, Operation]]
    calls: list[tuple[Operation, Any]]
    prepared: dict[Any, Any] = field(default_factory=dict)

    __repr__ = one_line

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
            bench = _own.benches.pop((self, frames), None) or Bench(self, frames)
            bench.run(values)
            _own.benches[self, frames] = bench
            if len(_own.benches) > BENCHES:
                del _own.benches[next(iter(_own.benches))]
            return
        constants = [self.tape.constants[number] for number in self.fixed]
        full = _arrays(self.kept_sorts, frames, linkages)
        values.update(zip(self.kept, full))
        full = [*[values[number] for number in self.given], *full]
        rows = max(1, min(frames, BLOCK // max(1, prod(linkages))))
        made = _arrays(self.made_sorts, rows, linkages)
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


class Bench:
    """A program with arrays for all that it works with, which its operations are told once and not at every run."""

    def __init__(self, program: Program, frames: int):
        on = program.tape.steps
        given = [_arrays([(_sort(on[number]), 1)], frames, ())[0] for number in program.given]
        self._given = list(zip(program.given, given))
        self._kept, own, first = [], list[Array](), 0
        for (letter, extent), count in program.kept_sorts:
            block = np.empty((count, frames if extent else 1), letter)
            self._kept.append((program.kept[first : first + count], block))
            own, first = [*own, *block], first + count
        constants = [program.tape.constants[number] for number in program.fixed]
        places = [*constants, *given, *own, *_arrays(program.made_sorts, frames, ())]
        for place, part in program.views:
            places.append(part(places[place]))
        self._calls = [(operation, arguments(places)) for operation, arguments in program.calls]

    def run(self, values: dict[int, Array]) -> None:
        """Add what is kept to the values, as arrays of their own."""
        for number, array in self._given:
            array[...] = values[number]
        for operation, arguments in self._calls:
            operation(*arguments)
        for numbers, block in self._kept:
            values.update(zip(numbers, block.copy()))


class _Own(threading.local):
    """The benches of a thread, the oldest first."""

    def __init__(self) -> None:
        self.benches: dict[tuple[Program, int], Bench] = {}


_own = _Own()


def shared(tape: Tape, steps: list[int], place: Mapping[int, int]) -> tuple[list[Sort], dict[int, int]]:
    """Arrays that are written over and over by what has no place, by sort, and which of them holds each value."""
    last = {base(tape, one): number for number in steps for one in tape.steps[number].of}
    arrays: list[Sort] = []
    free: dict[Sort, list[int]] = {}
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


def _sort(step: Step) -> Sort:
    return LETTERS[step.kind], step.extent


def _arrays(sorts: list[tuple[Sort, int]], rows: int, linkages: tuple[int, ...]) -> list[Array]:
    """So many arrays of each sort."""
    found: list[Array] = []
    for (letter, extent), count in sorts:
        columns = linkages if extent == 2 else (1,) * len(linkages)
        found.extend(np.empty((count, rows if extent else 1, *columns), letter))
    return found
