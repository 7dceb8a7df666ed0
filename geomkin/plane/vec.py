"""Points, directions and poses as complex numbers: x + iy in mm; a direction is a unit complex number."""

from __future__ import annotations

from typing import Any, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..core.arguments import AnyComplex, checked
from ..core.records import record

# Arrays of real numbers; of points, directions and vectors; of whole numbers; of yes and no. They hold float64,
# complex128, intp and bool; the wider names are what NumPy's own annotations give for `1j * x` or `abs(z)`.
Real = NDArray[np.floating[Any]]
Complex = NDArray[np.complexfloating[Any, Any]]
Whole = NDArray[np.integer[Any]]
Mask = NDArray[np.bool_]
# An array of any of these.
Array = NDArray[Any]
# Numbers in the middle between two roundings, such as those with few decimals in recipes, are rounded away from 0
# although the last bit of a processor's sine may be below the middle: the border is lower by this share of the largest
# number, far more than processors differ.
BESIDE_HALF = 2.0**-44
# Relative difference up to which two values count as equally large. With a smaller one rounding decides between the
# equally bad positions of a symmetric mechanism; with a larger one different values count as equal.
TIED = 1e-9
# Share of the size of numbers up to which their difference is a rounding error.
NOTHING = 1e-12


@checked
def xy(z: AnyComplex) -> Real:
    """Points as coordinates.

    Parameters
    ----------
    z : complex or array_like, shape (...,)
        Points.

    Returns
    -------
    array, shape (..., 2)
        x and y; a view if `z` is contiguous complex128.

    Examples
    --------
    >>> import geomkin as gk
    >>> gk.plane.xy([1 + 2j, 3j])
    array([[1., 2.],
           [0., 3.]])
    """
    z = np.ascontiguousarray(z, dtype=complex)
    return z.view(float).reshape(*z.shape, 2)


def unit(z: ArrayLike) -> Complex:
    """Direction of each vector; nan if the vector is zero."""
    z = np.asarray(z, dtype=complex)
    with np.errstate(invalid="ignore", divide="ignore"):
        directions: Complex = z / abs(z)
        return directions


def as_unit(direction: ArrayLike) -> Complex:
    """Directions scaled to length 1; those that already have it, except for rounding, keep their digits."""
    direction = np.asarray(direction, dtype=complex)
    with np.errstate(invalid="ignore"):
        return np.where(abs(abs(direction) - 1) < 1e-12, direction, unit(direction))[()]


def known(mask: Mask, values: Array) -> Array:
    """Values where a mask is true; elsewhere nan, in both parts of complex values."""
    return np.where(mask, values, complex(np.nan, np.nan) if np.iscomplexobj(values) else np.nan)


def without_rounding(value: float, size: float) -> float:
    """A difference of numbers of a size; 0 if it is not larger than their rounding errors."""
    return 0.0 if abs(value) <= NOTHING * size else float(value)


def root_mean_square(values: Array) -> float:
    """Root of the mean square of the sizes of the known values; nan if none is known."""
    sizes = np.abs(values)
    known = sizes[np.isfinite(sizes)]
    return float(np.sqrt(np.mean(known**2))) if known.size else np.nan


def first_largest(values: Real) -> int:
    """Index of the first value that equals the largest except for rounding, so that all processors give the same."""
    most = np.fmax.reduce(values)
    with np.errstate(invalid="ignore"):
        return int(np.argmax((values == most) | (values >= most - TIED * np.abs(most))))


def dot(a: ArrayLike, b: ArrayLike) -> Real:
    """Scalar product of vectors."""
    product: Complex = np.conj(a) * b
    return product.real


def cross(a: ArrayLike, b: ArrayLike) -> Real:
    """z of the vector product: positive if `b` is to the left of `a`."""
    product: Complex = np.conj(a) * b
    return product.imag


def spaced_directions(count: int) -> Complex:
    """So many directions at equal angles, counterclockwise from +x, shape (count,)."""
    return np.asarray(np.exp(2j * np.pi * np.arange(count) / count))


def direction_deg(angle: ArrayLike) -> Complex:
    """Direction at an angle in degrees, counterclockwise from +x; exact at multiples of 90."""
    angle = np.asarray(angle, dtype=float)
    quarters = np.rint(angle / 90.0)
    rest: Complex = np.exp(1j * np.radians(angle - 90.0 * quarters))
    whole: Complex = np.array([1, 1j, -1, -1j])[quarters.astype(int) % 4]
    return rest * whole


def box_of(points: Array) -> tuple[complex, complex]:
    """Lower left and upper right corner of the smallest upright box round points."""
    return complex(points.real.min(), points.imag.min()), complex(points.real.max(), points.imag.max())


@overload
def rounded(z: Real | float, decimals: int) -> Real: ...
@overload
def rounded(z: Complex | complex, decimals: int) -> Complex: ...
def rounded(z: ArrayLike, decimals: int) -> Array:
    """Values, real or complex, rounded to decimals, equal on every processor and never -0.0.

    A value half way between two roundings, within the last bits in which processors differ, is rounded away from 0.
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
    """A rigid placement: position of a body's origin and direction of its x axis.

    Parameters
    ----------
    origin : complex or array
        mm.
    direction : complex or array
        Of any length, stored with length 1. Arrays have the same shape.

    Examples
    --------
    >>> import geomkin as gk
    >>> pose = gk.plane.Pose(10 + 0j, 1j)
    >>> complex(pose.place(2.0))
    (10+2j)
    """

    origin: Complex | complex = 0j
    direction: Complex | complex = 1 + 0j

    def __post_init__(self) -> None:
        object.__setattr__(self, "direction", as_unit(self.direction))

    def place(self, z: ArrayLike) -> Complex:
        """Points of the body in the outer frame.

        Parameters
        ----------
        z : complex or array_like
            mm in the body's frame.

        Returns
        -------
        array of complex
            mm.
        """
        return np.asarray(self.origin + self.direction * np.asarray(z))

    def locate(self, z: ArrayLike) -> Complex:
        """Outer points in the body's frame: the inverse of `place`.

        Parameters
        ----------
        z : complex or array_like
            mm.

        Returns
        -------
        array of complex
            mm in the body's frame.
        """
        return (np.asarray(z) - self.origin) * np.conj(self.direction)
