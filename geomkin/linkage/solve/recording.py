"""Records the operations of placements, with the sizes of the linkage and the drive as symbols.

A `Symbol` goes through the placements in place of a number and leaves a list of operations on the `Recording`, so that
each formula has one source. A symbol that depends on sizes alone also has its value: if the Python code decides by it,
as by whether a length is zero, the decision becomes a condition under which the recording is valid.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import field
from math import fsum
from typing import Any

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

from ...core.records import record
from ...plane.vec import Complex, Real

Operation = Callable[..., Any]


def paired(real: Real, imag: Real) -> Complex:
    """Complex numbers from their parts; real + 1j * imag would be wrong for parts that are not finite."""
    for part in (real, imag):
        if isinstance(part, Symbol):
            recorded: Complex = part.recording.record(paired, (real, imag))
            return recorded
    z: Complex = np.empty(np.broadcast(real, imag).shape, dtype=complex)
    z.real, z.imag = real, imag
    return z


def compensated_sum(*terms: Real) -> Real:
    """The sum of numbers as if added exactly and rounded about once, by adding the rounding errors back."""
    if all(isinstance(term, float) for term in terms):
        rounded: Real = np.asarray(fsum(terms))[()]
        return rounded
    for term in terms:
        if isinstance(term, Symbol):
            recorded: Real = term.recording.record(compensated_sum, terms)
            return recorded
    total: Real = np.asarray(terms[0], dtype=float)
    lost: Real = np.zeros(())
    for term in terms[1:]:
        new = total + term
        back = new - total
        lost = lost + ((total - (new - back)) + (term - back))
        total = new
    total = total + lost
    return total


def real_part(z: Complex) -> Real:
    """The real part, as an operation."""
    return z.real


def imag_part(z: Complex) -> Real:
    """The imaginary part, as an operation."""
    return z.imag


@record(eq=False)
class Step:
    """An operation on values: numbers of earlier steps, or constants as text. value: known if it has no drive."""

    operation: Operation
    of: tuple[int | str, ...]
    is_complex: bool
    value: Any


COMPLEX = {paired}
REAL = {np.absolute, real_part, imag_part}
# Constants that change nothing; of differences, on the right.
NEUTRAL = {np.add: 0.0, np.subtract: 0.0, np.multiply: 1.0}


@record(eq=False)
class Recording:
    """Operations in the order in which they ran, after the inputs; conditions: truth of values, by number."""

    steps: list[Step] = field(default_factory=list)
    known: dict[tuple[Any, ...], int] = field(default_factory=dict)
    conditions: dict[int, bool] = field(default_factory=dict)

    def input(self, value: Any, is_complex: bool = False) -> Any:
        """A symbol for an input: a size of this value, or the drive if it is None."""
        self.steps.append(Step(np.positive, (), is_complex, value))
        return Symbol(self, len(self.steps) - 1)

    def record(self, operation: Operation, inputs: Sequence[Any]) -> Any:
        """The result of an operation, which is added unless it is there already."""
        steps = [self.steps[value.number] if isinstance(value, Symbol) else None for value in inputs]
        if operation is np.power and steps[1] is None and inputs[1] == 2:
            operation, inputs, steps = np.square, inputs[:1], steps[:1]
        if len(inputs) == 2 and None in steps:
            constant, other = inputs[steps.index(None)], inputs[1 - steps.index(None)]
            changes_type = np.iscomplexobj(constant) and not other.is_complex
            on_right = other is inputs[0] or operation is not np.subtract
            if operation in NEUTRAL and np.all(constant == NEUTRAL[operation]) and on_right and not changes_type:
                return other
            if operation is np.multiply and np.all(constant == 0) and other.is_size:
                return np.zeros(())
        of = tuple([value.number if isinstance(value, Symbol) else literal(value) for value in inputs])
        key = (operation, *of)
        if key not in self.known:
            is_complex = operation in COMPLEX or (
                operation not in REAL
                and any(np.iscomplexobj(v) if step is None else step.is_complex for v, step in zip(inputs, steps))
            )
            is_size = all(step is None or step.value is not None for step in steps)
            values = [value if step is None else step.value for value, step in zip(inputs, steps)]
            self.known[key] = len(self.steps)
            self.steps.append(Step(operation, of, is_complex, operation(*values) if is_size else None))
        return Symbol(self, self.known[key])


def literal(value: Any) -> str:
    """A constant as Python text; the names are those of NumPy."""
    number = np.asarray(value).item()
    # Python's complex numbers refuse to divide by zero, and turn NumPy's real ones into their own.
    return f"complex128({number!r})" if isinstance(number, complex) else repr(number)


class Symbol(NDArrayOperatorsMixin):
    """A value that is a size, a function of sizes, or differs from frame to frame. Operations on it are recorded."""

    __slots__ = ("number", "recording")
    ndim = 1
    # Unlike the shape of any array, so that nothing is written in place.
    shape = (-1,)

    def __init__(self, recording: Recording, number: int):
        self.recording, self.number = recording, number

    @property
    def is_size(self) -> bool:
        """Whether it does not depend on the drive."""
        return self.recording.steps[self.number].value is not None

    @property
    def is_complex(self) -> bool:
        return self.recording.steps[self.number].is_complex

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **_: Any) -> Any:
        if method != "__call__":
            return NotImplemented
        if ufunc is np.conjugate and not self.is_complex:
            return self
        return self.recording.record(ufunc, inputs)

    def __array_function__(self, function: Any, _: Any, args: Any, kwargs: Any) -> Any:
        if function is np.ndim:
            return self.ndim
        if function in (np.any, np.all) and self.is_size and not np.ndim(self.recording.steps[self.number].value):
            return self
        return self.recording.record(function, args) if function in (np.where, np.any, np.all) else NotImplemented

    def __bool__(self) -> bool:
        if not self.is_size:
            raise TypeError("a value that depends on the drive decides nothing")
        truth = bool(self.recording.steps[self.number].value)
        self.recording.conditions[self.number] = truth
        return truth

    def conjugate(self) -> Any:
        """The complex conjugate."""
        return np.conjugate(self)

    @property
    def real(self) -> Any:
        return self.recording.record(real_part, (self,)) if self.is_complex else self

    @property
    def imag(self) -> Any:
        return self.recording.record(imag_part, (self,)) if self.is_complex else np.zeros(())
