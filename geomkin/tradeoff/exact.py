"""Points of linkages with velocities and accelerations to 50 digits, by intersection of circles in decimal arithmetic.

It shares no formula with the solver: the square of a distance is constant and is differentiated.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from decimal import Decimal, localcontext

import numpy as np

from ..core.records import record
from ..linkage.linkage import AbstractLinkage
from ..plane.vec import Array, Complex, Real

# Digits of results; computation uses more, since linkages near a toggle lose half of them.
DIGITS = 50
WORKING_DIGITS = 2 * DIGITS + 10


@contextmanager
def many_digits() -> Iterator[None]:
    """Decimal context with the digits that these functions need."""
    with localcontext() as context:
        context.prec = WORKING_DIGITS
        yield


@record
class DecimalVector:
    """A vector in decimals."""

    x: Decimal
    y: Decimal

    def __add__(self, other: DecimalVector) -> DecimalVector:
        return DecimalVector(self.x + other.x, self.y + other.y)

    def __sub__(self, other: DecimalVector) -> DecimalVector:
        return DecimalVector(self.x - other.x, self.y - other.y)

    def times(self, factor: Decimal) -> DecimalVector:
        return DecimalVector(self.x * factor, self.y * factor)

    def dot(self, other: DecimalVector) -> Decimal:
        return self.x * other.x + self.y * other.y

    def cross(self, other: DecimalVector) -> Decimal:
        return self.x * other.y - self.y * other.x

    @property
    def left(self) -> DecimalVector:
        """The vector rotated by a quarter turn."""
        return DecimalVector(-self.y, self.x)


ZERO = DecimalVector(Decimal(0), Decimal(0))


@record
class PointDerivatives:
    """Position of a point, and its first and second derivative by the drive."""

    at: DecimalVector
    first: DecimalVector
    second: DecimalVector

    def __sub__(self, other: PointDerivatives) -> PointDerivatives:
        return PointDerivatives(self.at - other.at, self.first - other.first, self.second - other.second)

    @property
    def turning(self) -> tuple[Decimal, Decimal]:
        """First and second derivative of the angle of a vector of constant length."""
        square = self.at.dot(self.at)
        return self.at.cross(self.first) / square, self.at.cross(self.second) / square


def fixed(x: float | Decimal, y: float = 0.0) -> PointDerivatives:
    """A point of the ground."""
    return PointDerivatives(DecimalVector(Decimal(x), Decimal(y)), ZERO, ZERO)


def circling(radius: float | Decimal, angle: float) -> PointDerivatives:
    """A point of a crank about the origin, at exactly the angle of the float, rad."""
    cosine, sine = cosine_sine(Decimal(angle))
    at = DecimalVector(cosine, sine).times(Decimal(radius))
    return PointDerivatives(at, at.left, at.times(Decimal(-1)))


def pinned(
    one: PointDerivatives, other: PointDerivatives, length: float | Decimal, length_2: float | Decimal, branch: int
) -> PointDerivatives:
    """The pin at given distances from two points; branch +1: to the left of the line from the first to the second."""
    b, c, apart = Decimal(length), Decimal(length_2), other.at - one.at
    square = apart.dot(apart)
    along = (square + b * b - c * c) / (2 * square)
    left = branch * ((b * b - along * along * square) / square).sqrt()
    at = one.at + apart.times(along) + apart.left.times(left)
    # (pin - base)^2 is constant for both bases: differentiated once and twice, two equations each.
    arms = [at - base.at for base in (one, other)]
    first = _solved(arms, [arm.dot(base.first) for arm, base in zip(arms, (one, other))])
    rates = [first - base.first for base in (one, other)]
    right = [arm.dot(base.second) - rate.dot(rate) for arm, base, rate in zip(arms, (one, other), rates)]
    return PointDerivatives(at, first, _solved(arms, right))


def sliding(one: PointDerivatives, length: float, height: float, branch: int) -> PointDerivatives:
    """The pin at a given distance from a point, on the line y = height; branch +1: on the +x side."""
    down = Decimal(height) - one.at.y
    across = branch * (Decimal(length) ** 2 - down * down).sqrt()
    arm = DecimalVector(across, down)
    first = DecimalVector(arm.dot(one.first) / across, Decimal(0))
    rate = first - one.first
    return PointDerivatives(
        one.at + arm, first, DecimalVector((arm.dot(one.second) - rate.dot(rate)) / across, Decimal(0))
    )


def carried(start: PointDerivatives, end: PointDerivatives, local: complex) -> PointDerivatives:
    """A point of the body whose x axis passes through two pins, at `local` from the first, mm."""
    axis = end - start
    length = axis.at.dot(axis.at).sqrt()
    x, y = Decimal(local.real) / length, Decimal(local.imag) / length
    return PointDerivatives(
        *(s + a.times(x) + a.left.times(y) for s, a in zip(
            (start.at, start.first, start.second), (axis.at, axis.first, axis.second)
        ))
    )  # fmt: skip


def coupler_point(lengths: Sequence[float | Decimal], local: complex, angle: float) -> PointDerivatives:
    """Coupler point at a crank angle, rad, of a four-bar on branch +1; lengths: ground, crank, coupler, rocker."""
    ground, crank, coupler, rocker = lengths
    crank_pin = circling(crank, angle)
    return carried(crank_pin, pinned(crank_pin, fixed(ground), coupler, rocker, 1), local)


def cosine_sine(angle: Decimal) -> tuple[Decimal, Decimal]:
    """Cosine and sine by their series, for an angle of a few turns."""
    cosine, sine, term, k = Decimal(1), Decimal(0), Decimal(1), 0
    while abs(term) > Decimal(10) ** -WORKING_DIGITS or k < abs(angle):
        k += 1
        term = term * angle / k
        if k % 2:
            sine += term if k % 4 == 1 else -term
        else:
            cosine += term if k % 4 == 0 else -term
    return cosine, sine


def _solved(rows: list[DecimalVector], right: list[Decimal]) -> DecimalVector:
    """The vector with given scalar products with two others."""
    one, two = rows
    share = one.cross(two)
    return DecimalVector((right[0] * two.y - right[1] * one.y) / share, (right[1] * one.x - right[0] * two.x) / share)


# Numbers of entries with which tables are tried.
ENTRIES = (100.0, 1000.0, 10000.0)


def linear(drive: Real, values: Callable[[Real], Array], entries: float) -> Callable[[], Array]:
    """Linear interpolation of values (..., n) at even steps of a turn, at drives (frames,) within one turn."""
    count = int(entries)
    here = values(np.arange(count) * (2 * np.pi / count))
    rise = np.roll(here, -1, axis=-1) - here

    def call() -> Array:
        k, s = _places(drive, count)
        found: Array = here[..., k] + s * rise[..., k]
        return found

    return call


def cubic(drive: Real, values: Callable[[Real], Array], entries: float) -> Callable[[], Array]:
    """Cubic (Lagrange) interpolation through the four nearest entries."""
    count = int(entries)
    here = values(np.arange(count) * (2 * np.pi / count))
    before, ahead, after = (np.roll(here, k, axis=-1) for k in (1, -1, -2))
    one = ahead - here / 2 - before / 3 - after / 6
    two, three = (before + ahead) / 2 - here, (here - ahead) / 2 + (after - before) / 6

    def call() -> Array:
        k, s = _places(drive, count)
        found: Array = here[..., k] + s * (one[..., k] + s * (two[..., k] + s * three[..., k]))
        return found

    return call


def _places(drive: Real, count: int) -> tuple[Array, Real]:
    """The entry before each drive, and the distance from it in entries."""
    place = drive * (count / (2 * np.pi))
    k = place.astype(np.intp)
    return k % count, place - k


FRAMES = 360


@record(eq=False)
class Track:
    """A linkage, its crank angles, rad, and the right values there, (frames,)."""

    linkage: AbstractLinkage
    drive: Real
    right: Complex

    @classmethod
    def of(cls, linkage: AbstractLinkage, exact: Callable[[float], DecimalVector]) -> Track:
        """The values that `exact` gives at a crank angle, in decimals."""
        drive = np.arange(FRAMES) * (2 * np.pi / FRAMES)
        with many_digits():
            found = [exact(angle) for angle in drive.tolist()]
        return cls(linkage, drive, np.array([complex(z.x, z.y) for z in found]))


def misses(track: Track, found: Array) -> Real:
    """Distance of each value from the right one."""
    off: Real = np.abs(found - track.right)
    return off


def count(_: Track, found: Array) -> int:
    """Number of values."""
    return len(found)
