"""The formulas of placements, written down once as they run, and run again over any frames without their Python.

A `Recorded` value goes through the placements in the drive's place and leaves a list of operations on the `Tape`:
each formula has one source, whoever runs it, and what does not depend on the drive is worked out while it is recorded.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import field
from typing import Any

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

from ...core.records import record
from ...plane.vec import Array, Complex, Mask, Real

# An operation takes its arguments and, last, the array that it writes.
Operation = Callable[..., Any]
COMPARISONS = {np.isfinite, np.greater, np.greater_equal, np.less, np.less_equal, np.logical_and, np.bitwise_and}


def chosen_from(mask: Mask, one: Array, other: Array, out: Array) -> None:
    """`np.where`, written into an array."""
    np.copyto(out, other)
    np.copyto(out, one, where=mask)


def paired(real: Real, imag: Real, out: Complex) -> None:
    """A complex number of its parts, written into an array."""
    out.real, out.imag = real, imag


def real_part(z: Complex) -> Real:
    """A view."""
    return z.real


def imag_part(z: Complex) -> Real:
    """A view."""
    return z.imag


def larger(one: Real, other: Real, out: Real) -> None:
    """`np.maximum`, which takes no third argument by its place."""
    np.maximum(one, other, out=out)


# What is recorded in the place of an operation.
INSTEAD: dict[Operation, Operation] = {np.maximum: larger}
# What shares the numbers of its argument.
VIEWS = {real_part, imag_part}


@record
class Step:
    """An operation on values by their numbers on the tape; kind: of the result, float, complex or bool.

    extent: 0 for one number, 1 for one at every frame, 2 where it differs from linkage to linkage besides.
    """

    operation: Operation
    of: tuple[int, ...]
    kind: type
    extent: int


@record(eq=False)
class Tape:
    """Operations in the order in which they ran, what they start from, and the constants among them, all by number."""

    steps: list[Step] = field(default_factory=list)
    constants: dict[int, Array] = field(default_factory=dict)
    given: dict[str, int] = field(default_factory=dict)
    known: dict[tuple[Any, ...], int] = field(default_factory=dict)

    def start(self, name: str, kind: type = float, extent: int = 1) -> Any:
        """What stands for a value that is to be given; who works with it takes it for an array."""
        self.given[name] = len(self.steps)
        self.steps.append(Step(np.positive, (), kind, extent))
        return Recorded(self, self.given[name], kind)

    def result(self, value: Any) -> int | Array:
        """The number of what was recorded, of a part of a value as a value of its own; or the constant that it is."""
        if not isinstance(value, Recorded):
            return np.asarray(value)
        parted = self.steps[value.number].operation in VIEWS
        return self.record(np.positive, (value,)).number if parted else value.number

    def number(self, value: Any) -> int:
        """Of a recorded value, or of a constant, which is put on the tape."""
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
        """The result of an operation, which is put on the tape unless it is there."""
        operation = INSTEAD.get(operation, operation)
        of = tuple([self.number(value) for value in inputs])
        if any(self.steps[k].kind is complex for k in of):
            # Told as complex numbers once, constants are not made so at every call.
            of = tuple([self.number(self.constants[k] + 0j) if k in self.constants else k for k in of])
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
    """A number of every frame that is not known yet: what is done with it goes on the tape."""

    __slots__ = ("kind", "number", "tape")
    ndim = 1
    # Like no array's: nothing is written over.
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
        raise TypeError("what is recorded is not known yet")

    @property
    def real(self) -> Recorded:
        return self.tape.record(real_part, (self,)) if self.kind is complex else self

    @property
    def imag(self) -> Any:
        return self.tape.record(imag_part, (self,)) if self.kind is complex else np.zeros(())
