"""What formulas make of given values, each when it is first asked for, by the engine that is done first."""

from __future__ import annotations

import sys
from collections.abc import Hashable, Mapping
from importlib.util import find_spec
from math import prod

import numpy as np

from ...plane.vec import Array
from .program import BLOCK, Formulas, Program

# Steps of a program times frames times linkages from which the compiled loop is done before NumPy: where it is loaded,
# and where it is to be loaded, which takes a second. Fewer, and its start takes longer than it saves; more, and what it
# would save is not saved.
WORTH_LOADED, WORTH_LOADING = 200_000, 1_000_000_000


class Worked:
    """What formulas make of given values over frames: each group when it is first asked for."""

    __slots__ = ("_done", "_formulas", "_frames", "_linkages", "_values")

    def __init__(self, formulas: Formulas, frames: int, linkages: tuple[int, ...], given: Mapping[str, Array]):
        """Given are (frames, linkages), (frames, 1) where alike for all, or a number where alike at every frame."""
        self._formulas, self._frames, self._linkages = formulas, frames, linkages
        self._values = {formulas.tape.given[name]: value for name, value in given.items()}
        self._done: tuple[Hashable, ...] = ()

    def at(self, name: str, value: Array) -> Worked:
        """The same with one more value given, and what is worked out so far."""
        other = Worked(self._formulas, self._frames, self._linkages, {name: value})
        other._values |= self._values
        other._done = self._done
        return other

    def value(self, group: Hashable, name: str = "") -> Array:
        """A result of a group."""
        if group not in self._done:
            self._done = (*self._done, group)
            program = self._formulas.program(self._done, self._frames * prod(self._linkages) <= BLOCK)
            with np.errstate(all="ignore"):
                run(program, self._values, self._frames, self._linkages)
        result = self._formulas.groups[group][name]
        return self._values[result] if isinstance(result, int) else result


def run(program: Program, values: dict[int, Array], frames: int, linkages: tuple[int, ...]) -> None:
    """Run a program by the engine that is done with it first."""
    work = len(program.calls) * frames * prod(linkages)
    loaded = f"{__package__}.compiled" in sys.modules
    if work >= (WORTH_LOADED if loaded else WORTH_LOADING) and find_spec("numba"):
        from . import compiled

        if compiled.runs(program):
            compiled.run(program, values, frames, linkages)
            return
    program.run(values, frames, linkages)
