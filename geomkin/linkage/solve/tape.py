"""Records the operations of a position solution once and replays them on arrays.

A `Recorded` value goes through the placements in place of the drive and leaves a list of operations on the `Tape`. So
each formula has one source, and constants are computed while recording.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import field
from typing import Any

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

from ...core.records import record
from ...plane.vec import Array, Complex, Mask, Real

# An operation takes its arguments and, last, its output array.
Operation = Callable[..., Any]
COMPARISONS = {np.isfinite, np.greater, np.greater_equal, np.less, np.less_equal, np.logical_and, np.bitwise_and}


def chosen_from(mask: Mask, one: Array, other: Array, out: Array) -> None:
    """`np.where` with an output array."""
    np.copyto(out, other)
    np.copyto(out, one, where=mask)


def paired(real: Real, imag: Real, out: Complex) -> None:
    """A complex number from its parts, with an output array."""
    out.real, out.imag = real, imag


def real_part(z: Complex) -> Real:
    """A view."""
    return z.real


def imag_part(z: Complex) -> Real:
    """A view."""
    return z.imag


def larger(one: Real, other: Real, out: Real) -> None:
    """`np.maximum`, whose output array is a keyword only."""
    np.maximum(one, other, out=out)


# Operations that are recorded as another one.
INSTEAD: dict[Operation, Operation] = {np.maximum: larger}
# Operations whose result shares the memory of the argument.
VIEWS = {real_part, imag_part}


@record
class Step:
    """An operation on values, given by their numbers on the tape; kind: of the result, float, complex or bool.

    extent: 0 for one number, 1 for one per frame, 2 if it also differs between linkages.
    """

    operation: Operation
    of: tuple[int, ...]
    kind: type
    extent: int


@record(eq=False)
class Tape:
    """Operations in the order in which they ran, their inputs and constants, all by number."""

    steps: list[Step] = field(default_factory=list)
    constants: dict[int, Array] = field(default_factory=dict)
    given: dict[str, int] = field(default_factory=dict)
    known: dict[tuple[Any, ...], int] = field(default_factory=dict)

    def start(self, name: str, kind: type = float, extent: int = 1) -> Any:
        """A symbolic value for an input; it behaves like an array."""
        self.given[name] = len(self.steps)
        self.steps.append(Step(np.positive, (), kind, extent))
        return Recorded(self, self.given[name], kind)

    def result(self, value: Any) -> int | Array:
        """The number of a recorded value, or the constant that it is; a view becomes a value of its own."""
        if not isinstance(value, Recorded):
            return np.asarray(value)
        is_view = self.steps[value.number].operation in VIEWS
        return self.record(np.positive, (value,)).number if is_view else value.number

    def number(self, value: Any) -> int:
        """The number of a recorded value, or of a constant, which is added to the tape."""
        if isinstance(value, Recorded):
            return value.number
        array = np.asarray(value)
        array = array.astype(float) if array.dtype.kind in "iu" else array
        key = (array.dtype.char, array.shape, array.tobytes())
        if key not in self.known:
            kind = {"c": complex, "b": bool}.get(array.dtype.kind, float)
            self.constants[len(self.steps)] = array
            self.known[key] = len(self.steps)
            self.steps.append(Step(np.positive, (), kind, 2 if array.ndim else 0))
        return self.known[key]

    def record(self, operation: Operation, inputs: Iterable[Any]) -> Recorded:
        """The result of an operation, which is added to the tape unless it is there already."""
        operation = INSTEAD.get(operation, operation)
        of = tuple([self.number(value) for value in inputs])
        if any(self.steps[k].kind is complex for k in of):
            # Constants are converted to complex once, instead of at every call; a mask stays one.
            numbers = [k for k in of if k in self.constants and self.steps[k].kind is not bool]
            of = tuple([self.number(self.constants[k] + 0j) if k in numbers else k for k in of])
        if operation is np.power and of[1] in self.constants and self.constants[of[1]] == 2:
            operation, of = np.square, of[:1]
        if operation is np.multiply:
            for one, other in (of, of[::-1]):
                if one in self.constants and np.ndim(self.constants[one]) == 0 and self.constants[one] == 1:
                    return Recorded(self, other, self.steps[other].kind)
        key = (operation, *of)
        if key not in self.known:
            steps = [self.steps[k] for k in of]
            self.known[key] = len(self.steps)
            self.steps.append(Step(operation, of, _kind(operation, steps), max(step.extent for step in steps)))
        number = self.known[key]
        return Recorded(self, number, self.steps[number].kind)


def _kind(operation: Operation, of: list[Step]) -> type:
    if operation in COMPARISONS:
        return bool
    if operation is paired:
        return complex
    if operation is np.absolute or operation in VIEWS:
        return float
    return complex if any(step.kind is complex for step in of) else float


class Recorded(NDArrayOperatorsMixin):
    """A symbolic value, one per frame. Operations on it are recorded."""

    __slots__ = ("kind", "number", "tape")
    ndim = 1
    # Unlike the shape of any array, so that nothing is written in place.
    shape = (-1,)

    def __init__(self, tape: Tape, number: int, kind: type):
        self.tape, self.number, self.kind = tape, number, kind

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **_: Any) -> Any:
        return self.tape.record(ufunc, inputs) if method == "__call__" else NotImplemented

    def __array_function__(self, function: Any, _: Any, args: Any, kwargs: Any) -> Any:
        if function is np.ndim:
            return self.ndim
        return self.tape.record(chosen_from, args) if function is np.where and not kwargs else NotImplemented

    def __bool__(self) -> bool:
        raise TypeError("a recorded value is not known yet")

    @property
    def real(self) -> Recorded:
        return self.tape.record(real_part, (self,)) if self.kind is complex else self

    @property
    def imag(self) -> Any:
        return self.tape.record(imag_part, (self,)) if self.kind is complex else np.zeros(())
