"""What formulas make of given values, each when it is first asked for, by the engine that is done first."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from importlib.util import find_spec
from math import prod

from ...plane.vec import Array
from .program import NOTHING, Batch, Formulas, Group, Program

# Steps of a program times frames times linkages from which the compiled loop is done before NumPy: where it is loaded,
# and where it is to be loaded, which takes a second. Fewer, and its start takes longer than it saves; more, and what it
# would save is not saved.
WORTH_LOADED, WORTH_LOADING = 200_000, 1_000_000_000
# Frames of one linkage up to which what was asked for the last time comes with what is asked for first. More, and what
# is not asked for this time takes time and room; fewer, and what several results go on from is worked out for each.
USUAL = 16_384
COMPILED = f"{__package__}.compiled"


class Worked:
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
        if frames > USUAL or linkages:
            self._usual = NOTHING

    def at(self, body: str, name: str, value: Array) -> Worked:
        """The same of a point of a body, with one more value given, and what is worked out so far."""
        other = Worked(self._formulas, self._frames, self._linkages, {name: value}, body)
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
        from ..solve import compiled

        if compiled.runs(program):
            compiled.run(program, values, frames, linkages)
            return
    program.run(values, frames, linkages)
