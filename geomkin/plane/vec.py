"""Points, directions and poses as complex numbers: x + iy in mm; a direction is a unit complex number.

A pose is where a body is: the place of its origin and the direction of its x axis.
"""

from __future__ import annotations

from typing import Any, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..core.arguments import Numbers, checked
from ..core.records import record

# Arrays of real numbers; of points, directions and vectors; of whole numbers; of yes and no. They hold float64,
# complex128, intp and bool; the wider names are what NumPy's own annotations give for `1j * x` or `abs(z)`.
Real = NDArray[np.floating[Any]]
Complex = NDArray[np.complexfloating[Any, Any]]
Whole = NDArray[np.integer[Any]]
Mask = NDArray[np.bool_]
# Of whichever, where a function takes them alike.
Array = NDArray[Any]
# Share of the largest number by which the border between two roundings lies below half way. Processors differ by far
# less, and recipes give numbers of few decimals, which lie half way but not there. Smaller, and the last bit of a
# processor's sine decides about half; larger, and it shows in the last of ten digits.
BESIDE_HALF = 2.0**-44


@checked
def xy(z: Numbers) -> Real:
    """Points (...,) complex as coordinates (..., 2): a view where `z` is contiguous complex128."""
    z = np.ascontiguousarray(z, dtype=complex)
    return z.view(float).reshape(*z.shape, 2)


def unit(z: ArrayLike) -> Complex:
    """Direction of each vector; nan where the vector is zero."""
    z = np.asarray(z, dtype=complex)
    with np.errstate(invalid="ignore", divide="ignore"):
        ways: Complex = z / abs(z)
        return ways


def as_unit(direction: ArrayLike) -> Complex:
    """Directions of any length as unit ones; those of length 1, to rounding, keep their digits."""
    direction = np.asarray(direction, dtype=complex)
    with np.errstate(invalid="ignore"):
        return np.where(abs(abs(direction) - 1) < 1e-12, direction, unit(direction))[()]


def known(where: Mask, values: Array) -> Array:
    """Values where a mask is true; elsewhere nan, of complex values in both parts."""
    return np.where(where, values, complex(np.nan, np.nan) if np.iscomplexobj(values) else np.nan)


def dot(a: ArrayLike, b: ArrayLike) -> Real:
    """Scalar product of vectors."""
    product: Complex = np.conj(a) * b
    return product.real


def cross(a: ArrayLike, b: ArrayLike) -> Real:
    """z of the vector product: positive where `b` lies to the left of `a`."""
    product: Complex = np.conj(a) * b
    return product.imag


def direction_deg(angle: ArrayLike) -> Complex:
    """Direction at an angle in degrees, counterclockwise from +x; exact at multiples of 90."""
    angle = np.asarray(angle, dtype=float)
    quarters = np.rint(angle / 90.0)
    rest: Complex = np.exp(1j * np.radians(angle - 90.0 * quarters))
    whole: Complex = np.array([1, 1j, -1, -1j])[quarters.astype(int) % 4]
    return rest * whole


@overload
def rounded(z: Real | float, decimals: int) -> Real: ...
@overload
def rounded(z: Complex | complex, decimals: int) -> Complex: ...
def rounded(z: ArrayLike, decimals: int) -> Array:
    """Rounded to decimals, real or complex, to the same number on every processor, and never to -0.0.

    What lies half way between two roundings, to within the last bits that processors differ by, goes away from 0.
    """
    z = np.asarray(z)
    if z.dtype.kind == "c":
        parts = rounded(np.ascontiguousarray(z, dtype=complex).view(float), decimals)
        return parts.view(complex).reshape(z.shape)
    most = np.abs(z).max(initial=0.0)
    if not np.isfinite(most):
        most = np.abs(z[np.isfinite(z)]).max(initial=0.0)
    even: Real = np.round(z + np.copysign(BESIDE_HALF * most, z), decimals)
    return even + 0.0


@record(checked=True, eq=False)
class Pose:
    """A rigid placement: origin, mm, and direction, of any length, kept as a unit one; arrays of one shape."""

    origin: Complex | complex = 0j
    direction: Complex | complex = 1 + 0j

    def __post_init__(self) -> None:
        object.__setattr__(self, "direction", as_unit(self.direction))

    def place(self, z: ArrayLike) -> Complex:
        """A body's own points as seen from outside."""
        return np.asarray(self.origin + self.direction * np.asarray(z))

    def locate(self, z: ArrayLike) -> Complex:
        """Outside points in the body's own coordinates: the inverse of `place`."""
        return (np.asarray(z) - self.origin) * np.conj(self.direction)
