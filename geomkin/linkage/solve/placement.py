"""Poses and kinematic coefficients of bodies, and the placements that involve no choice of branch.

A placement computes the poses of its bodies and their first and second kinematic coefficients: derivatives by the drive
q, which do not depend on the driver's speed (Uicker, Pennock, Shigley, Theory of Machines and Mechanisms, chapters 3,
4).

The operations of placements can be recorded. A `Symbol` goes through them in place of a number and leaves a list of
operations on the `Recording`, so that each formula has one source. A symbol that depends on sizes alone also has its
value: if the Python code decides by it, as by whether a length is zero, the decision becomes a condition under which
the recording is valid.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import field
from functools import cached_property
from math import fsum
from typing import Any, TypeVar

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

from ...core.records import record
from ...plane.vec import Complex, Real, Whole, cross, dot

Numbers = TypeVar("Numbers", Real, Complex)


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


@record(eq=False)
class Coefficients:
    """Kinematic coefficients of one order over the frames, in the fixed body's frame.

    origin: derivatives of the bodies' origins, mm per unit of drive to that order; theta_prime: of their angles, rad.
    """

    origin: dict[str, Complex] = field(default_factory=dict)
    theta_prime: dict[str, Real] = field(default_factory=dict)


@record(eq=False)
class Poses:
    """Poses of bodies over the frames, in the fixed body's frame.

    origin: positions, mm, of the bodies' origins; direction: of their x axes, unit complex. drive: q, rad or mm. cache:
    intermediate results of a placement. elsewhere: poses and first coefficients at other drives, of the placements
    before one that needs poses between the frames.
    """

    origin: dict[str, Complex] = field(default_factory=dict)
    direction: dict[str, Complex] = field(default_factory=dict)
    drive: Real = field(default_factory=lambda: np.zeros(()))
    cache: dict[Placement, Any] = field(default_factory=dict)
    elsewhere: Callable[[Real], tuple[Poses, Coefficients]] | None = None

    @cached_property
    def half(self) -> tuple[Real, Real]:
        """Cosine and sine of q/2, computed once, as they are the most expensive numbers of a frame."""
        half = 0.5 * self.drive
        return np.cos(half), np.sin(half)


@record(eq=False)
class Anchor:
    """A point of a placed body plus arms that turn with bodies: origin + direction place + sum(direction arm)."""

    body: str
    place: complex | Complex
    arms: tuple[tuple[str, complex | Complex], ...] = ()

    @cached_property
    def _arms(self) -> list[tuple[str, complex | Complex]]:
        return [(b, z) for b, z in ((self.body, self.place), *self.arms) if np.any(z != 0)]

    def at(self, p0: Poses) -> Complex:
        """Position, mm."""
        return _sum(p0.origin[self.body], [p0.direction[b] * z for b, z in self._arms])

    def first(self, p0: Poses, p1: Coefficients) -> Complex:
        """First derivative of the position."""
        arms = [1j * p1.theta_prime[b] * (p0.direction[b] * z) for b, z in self._arms]
        return _sum(p1.origin[self.body], arms)

    def second(self, p0: Poses, p1: Coefficients, p2: Coefficients) -> Complex:
        """Second derivative of the position."""
        arms = [(1j * p2.theta_prime[b] - p1.theta_prime[b] ** 2) * (p0.direction[b] * z) for b, z in self._arms]
        return _sum(p2.origin[self.body], arms)


def _sum(origin: Complex, arms: list[Complex]) -> Complex:
    """The sum; an origin at zero, as of most grounds, is not added to every frame."""
    if arms and np.ndim(origin) == 0 and origin == 0:
        origin, *arms = arms
    for arm in arms:
        origin = origin + arm
    return origin


@record(eq=False)
class SlideAxis:
    """A direction that turns with a body."""

    body: str
    direction: complex | Complex

    def at(self, p0: Poses) -> Complex:
        """The direction in the fixed body's frame."""
        return p0.direction[self.body] * self.direction


class Placement(ABC):
    """Places one or two bodies, or all remaining ones, on those that are placed already."""

    @abstractmethod
    def place(self, p0: Poses, branch: Whole | int) -> None:
        """Compute the poses, on one branch of a dyad; nan where it cannot close."""

    def reached(self, p0: Poses) -> Complex | None:
        """An array that is nan where the bodies cannot be placed; None if they always can."""
        return None

    @abstractmethod
    def first(self, p0: Poses, p1: Coefficients) -> None:
        """Compute the first derivatives by the drive."""

    @abstractmethod
    def second(self, p0: Poses, p1: Coefficients, p2: Coefficients) -> None:
        """Compute the second derivatives by the drive."""

    def joint_directions(self, p0: Poses) -> tuple[Complex, Complex] | None:
        """Directions, of any length, in which a joint's two members let it move: parallel at a dead centre; or None."""
        return None

    def transmission_angle(self, p0: Poses) -> Real | None:
        """Smallest acute angle between the directions in which two members let their joint move, rad; or None."""
        directions = self.joint_directions(p0)
        return None if directions is None else np.arctan2(np.abs(cross(*directions)), np.abs(dot(*directions)))


@record(eq=False)
class RevoluteInput(Placement):
    """The driver if it is the angle of a body: its direction is e^{iq}."""

    body: str

    def place(self, p0: Poses, branch: Whole | int) -> None:
        cosine, sine = p0.half
        p0.direction[self.body] = paired((cosine - sine) * (cosine + sine), 2 * sine * cosine)

    def first(self, p0: Poses, p1: Coefficients) -> None:
        p1.theta_prime[self.body] = np.asarray(1.0)

    def second(self, p0: Poses, p1: Coefficients, p2: Coefficients) -> None:
        p2.theta_prime[self.body] = np.zeros(())


@record(eq=False)
class PrismaticInput(Placement):
    """The driver if it slides: a body of known direction whose point `local` is at `through` + q along `rail`."""

    body: str
    local: complex | Complex
    through: Anchor
    rail: SlideAxis

    @cached_property
    def _anchor(self) -> Anchor:
        return Anchor(self.through.body, self.through.place, ((self.body, -self.local),))

    def place(self, p0: Poses, branch: Whole | int) -> None:
        p0.origin[self.body] = self._anchor.at(p0) + p0.drive * self.rail.at(p0)

    def first(self, p0: Poses, p1: Coefficients) -> None:
        theta_prime = p1.theta_prime[self.rail.body]
        p1.origin[self.body] = self._anchor.first(p0, p1) + (1 + 1j * theta_prime * p0.drive) * self.rail.at(p0)

    def second(self, p0: Poses, p1: Coefficients, p2: Coefficients) -> None:
        theta_prime, theta_second = p1.theta_prime[self.rail.body], p2.theta_prime[self.rail.body]
        # 2 i theta' is the Coriolis term.
        coefficient = 2j * theta_prime + (1j * theta_second - theta_prime**2) * p0.drive
        p2.origin[self.body] = self._anchor.second(p0, p1, p2) + coefficient * self.rail.at(p0)


@record(eq=False)
class StrokeInput(Placement):
    """The drive as the position of an artificial body `name`, for loops that contain the actuator."""

    name: str

    def place(self, p0: Poses, branch: Whole | int) -> None:
        p0.origin[self.name], p0.direction[self.name] = paired(p0.drive, np.zeros(())), np.ones((), dtype=complex)

    def first(self, p0: Poses, p1: Coefficients) -> None:
        p1.origin[self.name], p1.theta_prime[self.name] = np.ones((), dtype=complex), np.zeros(())

    def second(self, p0: Poses, p1: Coefficients, p2: Coefficients) -> None:
        p2.origin[self.name], p2.theta_prime[self.name] = np.zeros((), dtype=complex), np.zeros(())


@record(eq=False)
class AlignedBody(Placement):
    """A body that turns with another one, at the constant angle of `rotation` from its x axis."""

    body: str
    with_body: str
    rotation: complex | Complex

    def place(self, p0: Poses, branch: Whole | int) -> None:
        p0.direction[self.body] = p0.direction[self.with_body] * self.rotation

    def first(self, p0: Poses, p1: Coefficients) -> None:
        p1.theta_prime[self.body] = p1.theta_prime[self.with_body]

    def second(self, p0: Poses, p1: Coefficients, p2: Coefficients) -> None:
        p2.theta_prime[self.body] = p2.theta_prime[self.with_body]


@record(eq=False)
class GearedBody(Placement):
    """A body that gears turn `ratio` times as fast as the driver; its angle, rad, is `start` where the drive is 0."""

    body: str
    ratio: float
    start: Real | float

    def place(self, p0: Poses, branch: Whole | int) -> None:
        angle = self.ratio * p0.drive + self.start
        p0.direction[self.body] = paired(np.cos(angle), np.sin(angle))

    def first(self, p0: Poses, p1: Coefficients) -> None:
        p1.theta_prime[self.body] = np.asarray(self.ratio)

    def second(self, p0: Poses, p1: Coefficients, p2: Coefficients) -> None:
        p2.theta_prime[self.body] = np.zeros(())


@record(eq=False)
class PinnedBody(Placement):
    """A body of known direction whose point `local` is pinned at a known point `pin`."""

    body: str
    local: complex | Complex
    pin: Anchor

    @cached_property
    def _anchor(self) -> Anchor:
        return Anchor(self.pin.body, self.pin.place, (*self.pin.arms, (self.body, -self.local)))

    def place(self, p0: Poses, branch: Whole | int) -> None:
        p0.origin[self.body] = self._anchor.at(p0)

    def first(self, p0: Poses, p1: Coefficients) -> None:
        p1.origin[self.body] = self._anchor.first(p0, p1)

    def second(self, p0: Poses, p1: Coefficients, p2: Coefficients) -> None:
        p2.origin[self.body] = self._anchor.second(p0, p1, p2)
